//! The view of a camera: what its tile is given of the document and the session, and its picture alone for an export.

use std::sync::Arc;

use backlit_document::frame_trust::FrameTrust;
use backlit_tracking::body::{Kinematics, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::Cue;
use backlit_tracking::people::PersonBox;
use backlit_tracking::posing::LimitedAngle;
use backlit_tracking::render::Ramp;
use backlit_tracking::residual::learnt_prior::BoundPrior;
use backlit_ui::drawing::{
    BoundedAngle, GhostMarks, JointId, LimitMark, PictureInput, ProjectedLimb, ProjectedSphere, RivalMarks,
    SideMarks, SightRay, SwayMarks, body_spheres, joined_outline, joint_position, limb_colours,
    project_joints, project_limbs, project_spheres, sight_ray,
};
use backlit_ui::style::theme::size;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::cut_off;
use egui::{Color32, Rect, Role, Ui, UiBuilder, WidgetInfo, pos2};
use glam::{DVec2, DVec3};

use super::tile::{SteeredSilhouette, TileLayout, TileState};
use super::{
    BodyMarks, CameraViewPreferences, CameraViews, Ellipses, TileEvent, TileInput, TileView, camera_tile,
    picture_view,
};
use crate::context::marks::{PictureAlone, ReferenceMark};
use crate::context::pane::Pane;
use crate::context::{Context, FeatureRequest, Requests, ShellRequest};
use crate::session::Session;
use crate::session::prediction::{ComposedPicture, Predicted};

/// The report's ramp is half grey at this many radii.
const THESIS_HALF: f64 = 1.118_034;

/// Where the subject is over the whole take, in a camera's pixels.
pub(super) fn subject(session: &Session, camera: usize) -> Option<Rect> {
    let [left, top, right, bottom] = session.subject.get(camera).copied().flatten()?;
    Some(Rect::from_min_max(pos2(left, top), pos2(right, bottom)))
}

/// Where a camera's tile stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TilePlace<'a> {
    pub(crate) camera: usize,
    /// It fills the centre.
    pub(crate) is_alone: bool,
    /// Panes that stand behind it.
    pub(crate) siblings: &'a [Pane],
}

impl CameraViews {
    /// Shows the view of a camera in all of the space that `ui` has; whether it is dragged away by its header.
    pub(crate) fn pane(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        place: TilePlace<'_>,
        requests: &mut Requests,
    ) -> bool {
        let Some(mut pane) = CameraPane::new(context, place.camera) else { return false };
        let tile = self.tiles(context.preferences.layout).get(place.camera).copied().unwrap_or_default();
        let full = self.full.of(place.camera, context.selection.frame);
        if self.picture_alone.is_some_and(|alone| !alone.marks) {
            let BodyMarks { spheres, likelier, sway, ghosts, ellipses, .. } = pane.marks;
            pane.marks = BodyMarks { spheres, likelier, sway, ghosts, ellipses, ..BodyMarks::default() };
        }
        let input = TileInput { full, ..pane.input(place, tile, self.preferences) };
        if let Some(alone) = self.picture_alone {
            self.legend_height = show_alone(ui, input, alone, self.legend_height);
            return false;
        }
        let response = camera_tile(ui, &input);
        if let Some(line) = response.drawn {
            requests.request(ShellRequest::Camera(place.camera));
            requests.request(FeatureRequest::DrawSilhouette(place.camera, line));
        }
        let before = self.shown.insert(place.camera, response.view);
        if !response.events.is_empty() {
            ui.ctx().request_repaint();
        }
        for event in &response.events {
            self.take_in(&pane, *event, before, requests);
        }
        let frame = context.session.shown_frame(context.selection.frame);
        let frame = frame.and_then(|frame| frame.cameras.get(place.camera));
        if let Some(problem) = frame.and_then(|frame| frame.problem.as_deref()) {
            strip(ui, problem);
        } else if let Some(px) = frame.map(|frame| frame.unsupported_px).filter(|px| *px > 0) {
            strip(ui, &format!("{} px that no other camera sees are unknown", format::count(px as i64)));
        }
        response.events.contains(&TileEvent::DragTile)
    }
}

/// What there is to see in the view of a camera.
pub(super) struct CameraPane<'a> {
    pub(super) context: &'a Context<'a>,
    /// The camera's.
    pub(super) index: usize,
    pub(super) camera: &'a Camera,
    pose: &'a Pose,
    limb_colours: Vec<Color32>,
    marks: BodyMarks,
}

impl<'a> CameraPane<'a> {
    fn new(context: &'a Context<'a>, index: usize) -> Option<Self> {
        let camera = context.session.take.as_ref()?.cameras.get(index)?;
        let limb_colours = limb_colours(&context.document().model);
        let marks = body_marks(context, index, camera);
        Some(Self { context, index, camera, pose: context.pictured().1, limb_colours, marks })
    }

    fn input(&self, place: TilePlace<'a>, tile: TileView, chosen: CameraViewPreferences) -> TileInput<'_> {
        let (context, session, index) = (self.context, self.context.session, self.index);
        let document = context.document();
        let predicted = session.predicted.as_ref().and_then(|predicted| predicted.cameras.get(index));
        let uses = document.cameras.get(index);
        let trust = document.trust_of(context.pictured().0, self.pose);
        let trust = trust.filter(|_| self.marks.ghosts.is_none());
        TileInput {
            index,
            is_active: context.selection.camera == index,
            is_expanded: place.is_alone,
            siblings: place.siblings,
            is_linked: chosen.linked_zoom,
            is_calibrated: true,
            tile,
            settings: chosen.settings,
            subject_px: subject(session, index),
            picture: self.picture(),
            composed: self.composed(),
            has_unknown_and_shadow: self.predicted_of_frame().and_then(|predicted| {
                Some(predicted.cameras.get(index)?.data.as_ref()?.has_unknown_and_shadow)
            }),
            full: None,
            generation: egui::util::hash((session.generation, context.pictured().0)),
            camera: Some(self.camera),
            raw_camera: session.take.as_ref().and_then(|take| take.take().rig().cameras().get(index)),
            body: &document.model,
            outlines: predicted.map_or(&[], |camera| &camera.outlines),
            marks: &self.marks,
            selected: Some(context.selection.joint),
            sized: Some(context.selection.sized_limb(&document.model)),
            // Four views need not say the same.
            says_limits: context.drag.camera.unwrap_or(context.selection.camera) == index,
            overlap: predicted.and_then(|camera| camera.overlap).filter(|_| self.marks.ghosts.is_none()),
            is_overlap_stale: session.is_stale,
            is_used: uses.is_some_and(|used| used.used),
            weight: uses.map_or(1.0, |used| used.weight),
            held: trust.map_or(&[], |trust| &trust.holds),
            doubts: trust.map_or(&[], FrameTrust::doubts),
            keypoints: match document.tracking.cues.cues().contains(&Cue::Keypoints) {
                true => session
                    .shown_frame(context.selection.frame)
                    .and_then(|frame| frame.cameras.get(index))
                    .map_or(&[], |camera| &camera.keypoints),
                false => &[],
            },
            is_behind: context.pictured().0 != context.selection.frame,
            steered: SteeredSilhouette {
                tool: context.silhouettes.tool,
                region: document.measurement.get(index).and_then(|own| own.region),
                steps: context.silhouettes.steps_of(index, context.pictured().0),
            },
            shows_hover_card: true,
        }
    }

    pub(super) fn size_px(&self) -> [usize; 2] {
        [self.camera.width(), self.camera.height()]
    }

    /// The prediction, if the posed body is shown.
    fn predicted(&self) -> Option<&Arc<Predicted>> {
        self.context.session.predicted.as_ref().filter(|_| self.marks.ghosts.is_none())
    }

    /// The same, where it is of the frame on the screen.
    fn predicted_of_frame(&self) -> Option<&Arc<Predicted>> {
        let (session, frame) = (self.context.session, self.context.selection.frame);
        self.predicted().filter(|predicted| session.is_of_shown_frame(predicted, frame))
    }

    fn picture(&self) -> PictureInput<'_> {
        let (session, frame) = (self.context.session, self.context.selection.frame);
        let of_frame = self.predicted_of_frame();
        if let Some(picture) =
            of_frame.and_then(|predicted| predicted.picture(self.index, &self.limb_colours))
        {
            return picture;
        }
        let pictures = session.shown_frame(frame).and_then(|frame| frame.cameras.get(self.index));
        let predicted = self.predicted().and_then(|predicted| predicted.cameras.get(self.index));
        PictureInput {
            frame: pictures.and_then(|frame| frame.image.as_deref()),
            mask: pictures.and_then(|frame| frame.mask.as_deref()),
            prediction: predicted.map(|camera| &camera.prediction),
            view: predicted.map(|camera| &camera.view),
            gradient: predicted.and_then(|camera| camera.gradient.as_ref()),
            jacobian: predicted.and_then(|camera| camera.jacobian.as_ref()),
            limb_colours: &self.limb_colours,
            ..PictureInput::empty(self.size_px())
        }
    }

    /// Pictures that were made beside the prediction, where it is of the frame on the screen.
    fn composed(&self) -> &[ComposedPicture] {
        let of_frame = self.predicted_of_frame();
        of_frame.and_then(|predicted| predicted.pictures.get(self.index)).map_or(&[], Vec::as_slice)
    }

    /// How far away the body is at a pixel, along the optical axis, metres; beside the body, its root's depth.
    pub(super) fn depth_at(&self, px: DVec2) -> f64 {
        let root = self.camera.depth(self.pose.root);
        let pixel = px.round();
        if pixel.x < 0.0 || pixel.y < 0.0 {
            return root;
        }
        let sample = self.picture().sample(pixel.x as usize, pixel.y as usize);
        let along_ray = sample.and_then(|sample| sample.depth_m);
        along_ray
            .zip(self.camera.ray_in_camera(px))
            .map_or(root, |(distance, ray)| f64::from(distance) * ray.z / ray.length())
    }
}

/// What a camera sees of the body on the screen, or of those in its place.
fn body_marks(context: &Context<'_>, index: usize, camera: &Camera) -> BodyMarks {
    let document = context.document();
    let (model, renderer, pose) = (&document.model, document.fit.renderer, context.pictured().1);
    let kinematics = Kinematics::new(model, pose);
    let sight_ray = ray_in(context, &kinematics, index, camera);
    if let Some(ghosts) = context.ghosts {
        let ghosts = Some(GhostMarks::new(ghosts, camera, renderer));
        let people = people(context, camera);
        return BodyMarks {
            ghosts,
            sight_ray,
            people,
            quick_outline: Some(Vec::new()),
            ..BodyMarks::default()
        };
    }
    let is_pinned = |joint: JointId| matches!(joint, JointId::End(limb) if document.pins.contains(&limb));
    let limbs = project_limbs(model, &kinematics, camera, renderer);
    let limit = |bounded| LimitMark::new(model, pose, &kinematics, camera, &bounded);
    let seen = context.observability;
    let known = seen.uncertainty.as_ref();
    BodyMarks {
        joints: project_joints(model, &kinematics, pose.root, camera, is_pinned),
        limits: limits(context, pose).into_iter().filter_map(limit).collect(),
        sides: context.views.side_marks.then(|| SideMarks::new(model, &kinematics, camera)),
        sight_ray,
        quick_outline: quick_outline(context, pose, &limbs),
        limbs,
        likelier: likelier(context, &kinematics, pose, camera),
        spheres: spheres(context, &kinematics, camera),
        sway: seen.swaying.as_ref().map(|body| SwayMarks::new(model, body, camera, renderer)),
        rivals: rivals(context, &kinematics, camera),
        ghosts: None,
        references: references(context, camera),
        people: people(context, camera),
        ellipses: Ellipses {
            joints: known.map_or_else(Vec::new, |known| known.ellipses(camera)),
            factor: seen.factor,
            is_stale: seen.is_stale,
            are_of_others: known.is_some_and(|known| known.is_of_others),
            are_believed: known.is_some_and(|known| known.is_believed),
        },
    }
}

/// The people to choose from, where all of their box is before the camera.
fn people(context: &Context<'_>, camera: &Camera) -> Vec<(usize, [DVec2; 8])> {
    let tracks = context.people.iter().enumerate();
    let mut boxes: Vec<(usize, PersonBox)> =
        tracks.filter_map(|(number, track)| Some((number, track.at(context.pictured().0)?.bounds))).collect();
    let depth = |person: &PersonBox| camera.depth(person.centre());
    boxes.sort_by(|(_, a), (_, b)| depth(b).total_cmp(&depth(a)));
    let corners = |person: PersonBox| {
        let seen: Vec<DVec2> = person.corners().iter().filter_map(|corner| camera.project(*corner)).collect();
        seen.try_into().ok()
    };
    boxes.into_iter().filter_map(|(number, person)| Some((number, corners(person)?))).collect()
}

/// Joints of references beside those of the body.
fn references(context: &Context<'_>, camera: &Camera) -> Vec<([DVec2; 2], usize)> {
    let marks = context.references.iter();
    let mark = |mark: &ReferenceMark| {
        Some(([camera.project(mark.ours)?, camera.project(mark.place)?], mark.reference))
    };
    marks.filter_map(mark).collect()
}

/// Poses that rival the one on the screen, where they are to be seen.
fn rivals(context: &Context<'_>, kinematics: &Kinematics, camera: &Camera) -> Vec<Option<RivalMarks>> {
    let rivals = context.rivals().into_iter();
    let marks = |(pose, weight): (&Pose, f64)| {
        RivalMarks::new(&Kinematics::new(&context.document().model, pose), weight, kinematics, camera)
    };
    rivals.map(marks).collect()
}

/// The spheres that stand for the body, where they are to be outlined.
fn spheres(context: &Context<'_>, kinematics: &Kinematics, camera: &Camera) -> Vec<ProjectedSphere> {
    if !context.views.spheres {
        return Vec::new();
    }
    let (document, level) = (context.document(), context.views.drawn_level());
    project_spheres(&body_spheres(&document.model, kinematics, document.fit.renderer, level), camera)
}

/// From the end of each limb to where a prior learnt from motion would have it, where the fit has one.
fn likelier(context: &Context<'_>, kinematics: &Kinematics, pose: &Pose, camera: &Camera) -> Vec<[DVec2; 2]> {
    let (model, fit) = (&context.document().model, &context.document().fit);
    let bound = fit.prior.as_ref().and_then(|prior| BoundPrior::new(prior, model, pose));
    let pulled = bound.map_or_else(Vec::new, |bound| bound.likelier(model, kinematics));
    let arrow = |(limb, direction): (usize, DVec3)| {
        let end = kinematics.starts()[limb] + direction * model.limbs()[limb].length;
        Some([camera.project(kinematics.ends()[limb])?, camera.project(end)?])
    };
    pulled.into_iter().filter_map(arrow).collect()
}

/// The sight ray of the joint that is dragged in another view, or was put in its place there.
fn ray_in(context: &Context<'_>, kinematics: &Kinematics, index: usize, camera: &Camera) -> Option<SightRay> {
    let dragged = context.drag.dragged_joint().filter(|(from, _)| *from != index);
    let placed = || {
        let (placement, selection) = (context.drag.placement.as_ref()?, context.selection);
        let at = joint_position(placement.joint, context.shown_pose().root, kinematics)?;
        let is_there = context.drag.is_dragging() || placement.holds(selection.frame, selection.joint, at);
        placement.cameras_but(index).next().filter(|_| is_there).map(|from| (from, placement.joint))
    };
    let (from, joint) = dragged.or_else(placed)?;
    let from_camera = context.session.take.as_ref()?.cameras.get(from)?;
    let point = joint_position(joint, context.shown_pose().root, kinematics)?;
    sight_ray(from_camera, from, from_camera.project(point)?, from_camera.depth(point), camera)
}

/// The limbs' own outline, while the prediction on the screen is of another pose or something is dragged.
fn quick_outline(
    context: &Context<'_>,
    pose: &Pose,
    limbs: &[Option<ProjectedLimb>],
) -> Option<Vec<Vec<DVec2>>> {
    let is_old = context.session.predicted.as_ref().is_some_and(|predicted| predicted.pose != *pose);
    if !(is_old || context.drag.is_dragging()) {
        return None;
    }
    let scale = match context.document().fit.final_ramp() {
        Ramp::Thesis => THESIS_HALF,
        Ramp::Half | Ramp::Width { .. } | Ramp::Distance { .. } => 1.0,
    };
    let limbs: Vec<ProjectedLimb> = limbs.iter().flatten().map(|limb| limb.widened(scale)).collect();
    Some(joined_outline(&limbs.iter().collect::<Vec<_>>()))
}

/// The limits that are shown: those of the angle that a panel looks at, or those that a drag has met.
fn limits(context: &Context<'_>, pose: &Pose) -> Vec<BoundedAngle> {
    let model = &context.document().model;
    if let Some(angle) = context.observability.angle {
        let limb = context.selection.limb(model);
        return BoundedAngle::new(model, pose, limb, angle).into_iter().collect();
    }
    let twist =
        context.drag.twisted.and_then(|limb| BoundedAngle::new(model, pose, limb, LimitedAngle::Twist));
    let met =
        context.drag.from.as_deref().map_or_else(Vec::new, |before| BoundedAngle::met(model, before, pose));
    let others = met.into_iter().filter(|met| twist.is_none_or(|twist| *met != twist));
    twist.into_iter().chain(others).collect()
}

/// Why a camera has no picture or no silhouette, or what of that is doubted, under its header.
fn strip(ui: &Ui, problem: &str) {
    let palette = theme::palette(ui);
    let tile = ui.max_rect();
    let top = tile.top() + size::TILE_HEADER;
    let strip = Rect::from_min_max(pos2(tile.left(), top), pos2(tile.right(), top + size::TILE_HEADER));
    let galley = cut_off(ui, problem, egui::TextStyle::Small, palette.warn, strip.width() - 16.0);
    ui.painter().rect_filled(strip, 0.0, palette.raised);
    let at = pos2(strip.left() + 8.0, strip.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, palette.warn);
    let response = ui.interact(strip, ui.scope_id().with("problem"), egui::Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, problem));
    response.on_hover_text(problem);
}

/// Shows the picture in all of the space that `ui` has, above a legend that was so high in the last frame. Gives the
/// legend's height in this one.
fn show_alone(ui: &mut Ui, mut input: TileInput<'_>, alone: PictureAlone, legend_height: f32) -> f32 {
    let picture = ui.max_rect();
    let layout = TileLayout {
        header: Rect::NOTHING,
        picture,
        gutter: None,
        reserved: legend_height,
        has_legend: alone.legend,
    };
    (input.shows_hover_card, input.steered.tool) = (false, None);
    if !alone.marks {
        (input.outlines, input.selected, input.steered.region) = (&[], None, None);
        input.settings.calibration_marks = false;
    }
    let id = ui.scope_id().with("picture alone");
    let mut state = TileState::default();
    ui.scope_builder(UiBuilder::new().max_rect(picture), |ui| {
        picture_view::show(ui, id, &layout, &input, &mut state);
    });
    state.legend_height
}
