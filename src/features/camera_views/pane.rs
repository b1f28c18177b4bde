//! The views of all cameras: what each tile is given of the document and the session.

use std::hash::{DefaultHasher, Hash, Hasher};

use backlit_tracking::body::{Kinematics, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::posing::LimitedAngle;
use backlit_tracking::render::Ramp;
use egui::{Color32, Rect, Role, Ui, WidgetInfo, pos2};
use glam::DVec2;

use super::linked::follow;
use super::{CameraTileInput, ObservedMarks, PictureAlone, TileEvent, TileLook, camera_tile, stored_view};
use crate::context::command_button::dragged_until_now;
use crate::context::pane::Pane;
use crate::context::{Context, Request, Requests};
use crate::document::edit::Edit;
use crate::drawing::{
    BoundedAngle, JointId, LimitMark, PictureInput, ProjectedLimb, SightRay, SwayMarks, Swaying,
    joined_outline, limb_colours, project_joints, project_limbs, sight_ray,
};
use crate::features::observability::panel as observability;
use crate::style::theme;
use crate::style::theme::size;
use crate::widgets::{Framing, ViewTransform};

/// The report's ramp is half grey at this many radii.
const THESIS_HALF: f64 = 1.118_034;

/// What the cameras' views show, and what the hand does in them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CameraViews<'a> {
    /// By camera.
    pub(crate) tiles: &'a [TileLook],
    /// The camera that fills the centre.
    pub(crate) alone: Option<usize>,
    /// Whether something is dragged in one of the views.
    pub(crate) is_dragging: bool,
    /// The camera in whose view a joint is dragged, and the joint.
    pub(crate) dragged: Option<(usize, JointId)>,
    /// The limb that is twisted: no outline shows how far.
    pub(crate) twisted: Option<usize>,
    /// The pose in which what the hand does began: limits that are met since then are shown.
    pub(crate) turned_from: Option<&'a Pose>,
    /// One camera's picture and nothing else, for an export.
    pub(crate) picture_alone: Option<PictureAlone>,
}

/// The views of one frame of the window, with what they have in common.
pub(crate) struct CameraPanes<'a> {
    context: &'a Context<'a>,
    views: CameraViews<'a>,
    kinematics: Kinematics,
    pose: &'a Pose,
    /// Limits that the hand has met.
    limits: Vec<BoundedAngle>,
    colours: Vec<Color32>,
    /// Camera, pixel and depth of the joint that is dragged.
    ray: Option<(usize, DVec2, f64)>,
    /// The prediction on the screen is of another pose than the one that is shown.
    is_prediction_old: bool,
    /// The body on its way, if it sways.
    swaying: Option<Swaying>,
}

impl<'a> CameraPanes<'a> {
    pub(crate) fn new(context: &'a Context<'a>, views: CameraViews<'a>) -> Self {
        let document = context.document();
        let pose = context.session.shown_pose(document, context.selection);
        let kinematics = Kinematics::new(&document.model, pose);
        let ray = views.dragged.and_then(|(index, joint)| {
            let camera = context.session.take.as_ref()?.cameras.get(index)?;
            let point = match joint {
                JointId::Root => pose.root,
                JointId::End(limb) => *kinematics.ends().get(limb)?,
            };
            Some((index, camera.project(point)?, camera.depth(point)))
        });
        let predicted = context.session.predicted.as_ref();
        Self {
            context,
            views,
            kinematics,
            pose,
            limits: limits(context, views, pose),
            colours: limb_colours(&document.model),
            ray,
            swaying: context.observing.swaying(),
            is_prediction_old: predicted.is_some_and(|predicted| predicted.pose != *pose),
        }
    }

    /// Shows the view of a camera in all of the space that `ui` has, with the panes that stand behind it; whether it
    /// is dragged away by its header.
    pub(crate) fn show(&self, ui: &mut Ui, index: usize, siblings: &[Pane], requests: &mut Requests) -> bool {
        let (context, session) = (self.context, self.context.session);
        let document = context.document();
        let Some(camera) = session.take.as_ref().and_then(|take| take.cameras.get(index)) else {
            return false;
        };
        let frame = session.shown_frame(context.selection.frame).and_then(|frame| frame.cameras.get(index));
        let predicted = session.predicted.as_ref().and_then(|predicted| predicted.cameras.get(index));
        let limbs = project_limbs(&document.model, &self.kinematics, camera, document.fit.renderer);
        let is_pinned = |joint: JointId| matches!(joint, JointId::End(limb) if document.pins.contains(&limb));
        let joints = project_joints(&document.model, &self.kinematics, self.pose.root, camera, is_pinned);
        let limit = |bounded| LimitMark::new(&document.model, self.pose, &self.kinematics, camera, bounded);
        let limits: Vec<LimitMark> = self.limits.iter().filter_map(limit).collect();
        let ray = self.ray_in(index, camera);
        let marks = |body: &Swaying| SwayMarks::new(&document.model, body, camera, document.fit.renderer);
        let sway = self.swaying.as_ref().map(marks);
        let (ellipses, are_of_others) = observability::ellipses(context.observing, camera);
        let uses = document.cameras.get(index);
        let quick_outline = self.quick_outline(&limbs);
        let name = format!("Camera {}", index + 1);
        let input = CameraTileInput {
            index,
            name: &name,
            is_active: context.selection.camera == index,
            is_expanded: self.views.alone == Some(index),
            siblings,
            is_linked: context.preferences.linked_zoom,
            is_calibrated: true,
            look: self.views.tiles.get(index).copied().unwrap_or_default(),
            settings: context.preferences.views,
            subject_px: self.subject(index),
            picture: self.picture(index, camera),
            generation: self.generation(),
            camera: Some(camera),
            raw_camera: session.take.as_ref().and_then(|take| take.take().rig().cameras().get(index)),
            body: &document.model,
            outlines: predicted.map_or(&[], |camera| &camera.outlines),
            quick_outline: quick_outline.as_deref(),
            limbs: &limbs,
            joints: &joints,
            selected: Some(context.selection.joint),
            sized: Some(context.selection.sized_limb(&document.model)),
            sight_ray: ray.as_ref(),
            limits: &limits,
            overlap: predicted.and_then(|camera| camera.overlap),
            is_overlap_stale: session.is_stale,
            is_used: uses.is_some_and(|used| used.used),
            weight: uses.map_or(1.0, |used| used.weight),
            observed: ObservedMarks {
                sway: sway.as_ref(),
                ellipses: &ellipses,
                factor: context.observing.ellipse_factor(),
                is_stale: context.observing.is_stale(),
                are_of_others,
            },
            shows_hover_card: true,
        };
        if let Some(alone) = self.views.picture_alone {
            alone.ui(ui, &input);
            return false;
        }
        let before = stored_view(ui.ctx(), index);
        let events = camera_tile(ui, &input);
        let is_dragged = self.pass_on(ui, index, events, before, requests);
        if let Some(problem) = frame.and_then(|frame| frame.problem.as_deref()) {
            problem_strip(ui, problem);
        }
        is_dragged
    }

    /// Asks for what the user did in a view, which was `before` this frame; whether it is dragged away by its header.
    fn pass_on(
        &self,
        ui: &Ui,
        index: usize,
        events: Vec<TileEvent>,
        before: Option<ViewTransform>,
        requests: &mut Requests,
    ) -> bool {
        let mut is_dragged = false;
        for event in events {
            if event == TileEvent::DragTile {
                is_dragged = true;
                continue;
            }
            if let TileEvent::SetFraming(framing) = event
                && self.context.preferences.linked_zoom
            {
                self.link(ui, index, framing, before, requests);
            }
            if let TileEvent::SetWeight(weight) = event {
                let edit = Edit::WeighCamera { camera: index, weight };
                requests.edits.push((edit, dragged_until_now(ui.ctx())));
                continue;
            }
            requests.request(Request::Tile(index, event));
        }
        is_dragged
    }

    fn picture(&self, index: usize, camera: &Camera) -> PictureInput<'_> {
        let (session, frame) = (self.context.session, self.context.selection.frame);
        let pictures = session.shown_frame(frame).and_then(|frame| frame.cameras.get(index));
        let predicted = session.predicted.as_ref();
        let is_of_frame = predicted.is_some_and(|predicted| session.is_of_shown_frame(predicted, frame));
        let predicted = predicted.and_then(|predicted| predicted.cameras.get(index));
        PictureInput {
            size: [camera.width(), camera.height()],
            frame: pictures.and_then(|frame| frame.image.as_deref()),
            mask: pictures.and_then(|frame| frame.mask.as_deref()),
            data: predicted.filter(|_| is_of_frame).and_then(|camera| camera.data.as_deref()),
            prediction: predicted.map(|camera| &camera.prediction),
            view: predicted.map(|camera| &camera.view),
            gradient: predicted.and_then(|camera| camera.gradient.as_ref()),
            jacobian: predicted.and_then(|camera| camera.jacobian.as_ref()),
            limb_colours: &self.colours,
        }
    }

    fn subject(&self, index: usize) -> Option<Rect> {
        let [left, top, right, bottom] = self.context.session.subject.get(index).copied().flatten()?;
        Some(Rect::from_min_max(pos2(left, top), pos2(right, bottom)))
    }

    fn ray_in(&self, index: usize, camera: &Camera) -> Option<SightRay> {
        let (from, px, depth_m) = self.ray.filter(|(from, ..)| *from != index)?;
        let from_camera = self.context.session.take.as_ref()?.cameras.get(from)?;
        sight_ray(from_camera, from, px, depth_m, camera)
    }

    /// The limbs' own outline while the prediction lags behind the pose: the hand sees the body at once.
    fn quick_outline(&self, limbs: &[Option<ProjectedLimb>]) -> Option<Vec<Vec<DVec2>>> {
        if !(self.is_prediction_old || self.views.is_dragging) {
            return None;
        }
        let scale = match self.context.document().fit.final_ramp() {
            Ramp::Thesis => THESIS_HALF,
            Ramp::Half | Ramp::Width { .. } | Ramp::Distance { .. } => 1.0,
        };
        let limbs: Vec<ProjectedLimb> = limbs.iter().flatten().map(|limb| limb.widened(scale)).collect();
        Some(joined_outline(&limbs.iter().collect::<Vec<_>>()))
    }

    /// The linked views go along with a change of framing in one of them.
    fn link(
        &self,
        ui: &Ui,
        index: usize,
        framing: Framing,
        before: Option<ViewTransform>,
        requests: &mut Requests,
    ) {
        let Some(take) = &self.context.session.take else { return };
        for (other, camera) in take.cameras.iter().enumerate().filter(|(other, _)| *other != index) {
            let size_px = [camera.width(), camera.height()];
            let followed = match framing {
                Framing::Subject | Framing::Whole => Some(framing),
                Framing::Free { .. } => before.and_then(|before| {
                    let from = &take.cameras[index];
                    let from_size = [from.width(), from.height()];
                    let after = framing.view(before.rect, from_size, self.subject(index));
                    let view = stored_view(ui.ctx(), other)?;
                    let depth = |px: DVec2| self.depth_at(index, from, px);
                    let view = follow(&before, &after, from, depth, camera, &view);
                    Some(Framing::of(&view, size_px, self.subject(other)))
                }),
            };
            if let Some(framing) = followed {
                requests.request(Request::Tile(other, TileEvent::SetFraming(framing)));
            }
        }
    }

    /// How far away the body is at a pixel, along the optical axis, metres; beside the body, its root's depth.
    fn depth_at(&self, index: usize, camera: &Camera, px: DVec2) -> f64 {
        let root = camera.depth(self.pose.root);
        let pixel = px.round();
        if pixel.x < 0.0 || pixel.y < 0.0 {
            return root;
        }
        let sample = self.picture(index, camera).sample(pixel.x as usize, pixel.y as usize);
        let along_ray = sample.and_then(|sample| sample.depth_m);
        along_ray
            .zip(camera.ray_in_camera(px))
            .map_or(root, |(distance, ray)| f64::from(distance) * ray.z / ray.length())
    }

    /// Changes with the pictures on the screen.
    fn generation(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.context.session.generation, self.context.selection.frame).hash(&mut hasher);
        hasher.finish()
    }
}

/// The limits that are shown: those of the angle that a panel looks at, or those that the hand has met.
fn limits(context: &Context<'_>, views: CameraViews<'_>, pose: &Pose) -> Vec<BoundedAngle> {
    let model = &context.document().model;
    if let Some(angle) = context.observing.angle() {
        let limb = context.selection.limb(model);
        return BoundedAngle::new(model, pose, limb, angle).into_iter().collect();
    }
    let twist = views.twisted.and_then(|limb| BoundedAngle::new(model, pose, limb, LimitedAngle::Twist));
    let met = views.turned_from.map_or_else(Vec::new, |before| BoundedAngle::met(model, before, pose));
    let others = met.into_iter().filter(|met| twist.is_none_or(|twist| *met != twist));
    twist.into_iter().chain(others).collect()
}

/// Why a camera has no picture or no silhouette, under its header.
fn problem_strip(ui: &Ui, problem: &str) {
    let palette = theme::palette(ui);
    let tile = ui.max_rect();
    let top = tile.top() + size::TILE_HEADER;
    let strip = Rect::from_min_max(pos2(tile.left(), top), pos2(tile.right(), top + size::TILE_HEADER));
    let font = egui::TextStyle::Small.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(problem.to_owned(), font, palette.warn);
    job.wrap = egui::text::TextWrapping::truncate_at_width(strip.width() - 16.0);
    let galley = ui.painter().layout_job(job);
    ui.painter().rect_filled(strip, 0.0, palette.raised);
    let at = pos2(strip.left() + 8.0, strip.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, palette.warn);
    let response = ui.interact(strip, ui.scope_id().with("problem"), egui::Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, problem));
    response.on_hover_text(problem);
}
