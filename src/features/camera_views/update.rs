//! The views' commands, and what the user did in a tile; where views are linked, all of them zoom and pan together.
//!
//! A zoom keeps a pixel in place. The point of the body that this pixel shows, or one as far away as the body, is
//! kept in place in the other views too, and they are magnified by the same factor. A pan moves the others by as much
//! as their pictures of the world's point in the middle move: along their own optical axis, that is nothing.

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_tracking::camera::Camera;
use backlit_ui::drawing::{ViewMode, point_at};
use backlit_ui::widgets::{Framing, ViewTransform};
use glam::{DVec2, DVec3};

use super::pane::{CameraPane, subject};
use super::{CameraViews, TileEvent, TileView, Tiles};
use crate::context::command::{Command, ViewCommand};
use crate::context::feature::Feature;
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, FeatureRequest, PaneEvent, Requests, SessionRequest, ShellRequest};
use crate::session::selection::Selection;

/// What one press of a zoom's key magnifies by.
const ZOOM_STEP: f32 = 1.25;

impl Feature for CameraViews {
    fn update(&mut self, context: &Context<'_>, _: &mut Requests) {
        self.full.update(context);
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::View(command) = command else { return false };
        let layout = context.preferences.layout;
        let settings = &mut self.preferences.settings;
        match command {
            ViewCommand::FitSubject | ViewCommand::WholePicture => {
                let is_whole = command == ViewCommand::WholePicture;
                let framing = if is_whole { Framing::Whole } else { Framing::Subject };
                self.tiles.of_mut(layout).iter_mut().for_each(|tile| tile.framing = framing);
            }
            ViewCommand::ZoomIn => self.zoom(ZOOM_STEP, context),
            ViewCommand::ZoomOut => self.zoom(1.0 / ZOOM_STEP, context),
            ViewCommand::LinkZoom => {
                self.preferences.linked_zoom ^= true;
                let what = if self.preferences.linked_zoom { "together" } else { "each by itself" };
                requests.status(format!("Views zoom and pan {what}."));
            }
            ViewCommand::CalibrationMarks => settings.calibration_marks ^= true,
            ViewCommand::SideMarks => settings.side_marks ^= true,
            ViewCommand::Rivals => settings.rivals ^= true,
            ViewCommand::PixelGrid => settings.pixel_grid ^= true,
            ViewCommand::SizeHandles => {
                settings.size_handles ^= true;
                let what =
                    "Drag the diamonds: at its end for the limb’s length, at its outline for its radius.";
                requests.request(ShellRequest::Status(settings.size_handles.then(|| what.to_owned())));
            }
            ViewCommand::Mode(mode) => self.choose_mode(mode, context, requests),
            ViewCommand::Compare(comparison) => {
                self.change(context, context.selection.camera, |tile| tile.toggle(comparison));
            }
            ViewCommand::CameraAlone(camera) => {
                requests.request(ShellRequest::Pane(Pane::Camera(camera), PaneEvent::ToggleAlone));
            }
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::View(command) = command else { return None };
        match command {
            ViewCommand::Compare(_) => no_take(context),
            ViewCommand::FitSubject
            | ViewCommand::WholePicture
            | ViewCommand::ZoomIn
            | ViewCommand::ZoomOut
            | ViewCommand::LinkZoom
            | ViewCommand::CalibrationMarks
            | ViewCommand::SideMarks
            | ViewCommand::Rivals
            | ViewCommand::PixelGrid
            | ViewCommand::SizeHandles
            | ViewCommand::Mode(_) => None,
            ViewCommand::CameraAlone(camera) => {
                let is_missing = camera >= context.session.camera_count();
                no_take(context).or(because(is_missing, "The take has fewer cameras"))
            }
        }
    }

    fn answer(&mut self, request: &FeatureRequest, _: &Context<'_>, _: &mut Requests) {
        match request {
            FeatureRequest::Views(settings) => self.preferences.settings = *settings,
            FeatureRequest::ShowMode(layout, mode) => self.show_mode(*layout, *mode),
            _ => {}
        }
    }

    fn reset(&mut self, footage: &Footage) {
        let tiles = Tiles::new(footage.cameras.len());
        *self = Self { preferences: self.preferences, tiles, ..Self::default() };
    }

    fn at_rest(&self) -> Self {
        self.clone()
    }
}

impl CameraViews {
    /// Shows a mode in all views. The Jacobian's, chosen again, goes on to its next axis.
    fn choose_mode(&mut self, mode: ViewMode, context: &Context<'_>, requests: &mut Requests) {
        let layout = context.preferences.layout;
        let is_shown = self.tiles(layout).iter().all(|tile| tile.mode == mode && tile.comparison.is_none());
        if is_shown && mode == ViewMode::JacobianColumn {
            let axis = &mut self.preferences.settings.axis;
            *axis = axis.next();
            requests.status(format!("Jacobian column: {}.", axis.label().to_lowercase()));
        }
        self.show_mode(layout, mode);
    }

    /// Magnifies the active view about its middle, and the others with it where they are linked.
    fn zoom(&mut self, factor: f32, context: &Context<'_>) {
        let Some(take) = &context.session.take else { return };
        for (index, camera) in take.cameras.iter().enumerate() {
            if !self.preferences.linked_zoom && index != context.selection.camera {
                continue;
            }
            if let Some(view) = self.shown.get(&index) {
                let view = view.zoomed_at(view.rect.center(), factor);
                let size_px = [camera.width(), camera.height()];
                let framing = Framing::of(&view, size_px, subject(context.session, index));
                self.change(context, index, |tile| tile.framing = framing);
            }
        }
    }

    fn change(&mut self, context: &Context<'_>, camera: usize, change: impl FnOnce(&mut TileView)) {
        if let Some(tile) = self.tiles.of_mut(context.preferences.layout).get_mut(camera) {
            change(tile);
        }
    }

    /// Does what the user did in a tile, whose picture lay on the screen as `before` until then.
    pub(super) fn take_in(
        &mut self,
        pane: &CameraPane<'_>,
        event: TileEvent,
        before: Option<ViewTransform>,
        requests: &mut Requests,
    ) {
        let (context, camera) = (pane.context, pane.index);
        match event {
            TileEvent::Activate => requests.request(ShellRequest::Camera(camera)),
            TileEvent::SelectJoint(joint) => requests.request(SessionRequest::Joint(joint)),
            TileEvent::SelectLimb(limb) => {
                requests.request(SessionRequest::Joint(Selection::joint_of(&context.document().model, limb)));
                requests.request(SessionRequest::Part(limb));
            }
            TileEvent::Drag(event) => requests.request(FeatureRequest::Drag(camera, event)),
            TileEvent::SetView(view) => self.change(context, camera, |tile| {
                *tile = TileView { framing: tile.framing, ..view };
            }),
            TileEvent::SetSettings(settings) => self.preferences.settings = settings,
            TileEvent::SetUsed(used) => requests.edit(Edit::UseCamera { camera, used }),
            TileEvent::SetWeight(weight, drag) => {
                requests.edits.push((Edit::WeighCamera { camera, weight }, drag));
            }
            TileEvent::FollowPerson(number) => requests.request(FeatureRequest::FollowPerson(number)),
            TileEvent::TakeRival(rival) => {
                if let Some((pose, _)) = context.rivals().get(rival) {
                    requests.take_rival(context.selection.frame, pose);
                }
            }
            TileEvent::SetLinked(linked) => self.preferences.linked_zoom = linked,
            TileEvent::SetFraming(framing) => self.frame(pane, framing, before),
            TileEvent::ToggleExpanded => {
                requests.request(ShellRequest::Pane(Pane::Camera(camera), PaneEvent::ToggleAlone));
            }
            TileEvent::Switch(Pane::Camera(other)) => {
                requests.request(ShellRequest::SwitchCamera { from: camera, to: other });
            }
            TileEvent::Switch(other) => requests.request(ShellRequest::Pane(other, PaneEvent::Open)),
            TileEvent::Close => requests.request(ShellRequest::Pane(Pane::Camera(camera), PaneEvent::Close)),
            // That is its caller's.
            TileEvent::DragTile => {}
        }
    }

    /// Frames a view, and the linked ones with it.
    fn frame(&mut self, pane: &CameraPane<'_>, framing: Framing, before: Option<ViewTransform>) {
        self.change(pane.context, pane.index, |tile| tile.framing = framing);
        let session = pane.context.session;
        let Some(take) = session.take.as_ref().filter(|_| self.preferences.linked_zoom) else { return };
        for (other, camera) in take.cameras.iter().enumerate().filter(|(other, _)| *other != pane.index) {
            let followed = match framing {
                Framing::Subject | Framing::Whole => Some(framing),
                Framing::Free { .. } => before.zip(self.shown.get(&other)).map(|(before, view)| {
                    let after = framing.view(before.rect, pane.size_px(), subject(session, pane.index));
                    let depth = |px: DVec2| pane.depth_at(px);
                    let view = follow(&before, &after, pane.camera, depth, camera, view);
                    Framing::of(&view, [camera.width(), camera.height()], subject(session, other))
                }),
            };
            if let Some(framing) = followed {
                self.change(pane.context, other, |tile| tile.framing = framing);
            }
        }
    }
}

/// A smaller relative change of magnification is a pan.
const SAME_SCALE: f32 = 1e-4;

/// The view of camera `into` after the view of camera `from` has changed from `before` to `after`. `depth` gives how far
/// away from `from` a pixel's point is, along the optical axis.
fn follow(
    before: &ViewTransform,
    after: &ViewTransform,
    from: &Camera,
    depth: impl Fn(DVec2) -> f64,
    into: &Camera,
    view: &ViewTransform,
) -> ViewTransform {
    let ratio = after.points_per_px / before.points_per_px;
    let centre = |view: &ViewTransform| DVec2::new(view.centre_px.x.into(), view.centre_px.y.into());
    let seen = |point: Option<DVec3>| point.and_then(|point| into.project(point)).filter(|px| px.is_finite());
    if (ratio - 1.0).abs() < SAME_SCALE {
        let (was, is) = (centre(before), centre(after));
        let depth = depth(was);
        let moved = seen(point_at(from, was, depth)).zip(seen(point_at(from, is, depth)));
        return moved.map_or(*view, |(was, is)| {
            let by = (is - was) * f64::from(view.points_per_px);
            view.panned(egui::vec2(-by.x as f32, -by.y as f32))
        });
    }
    let share = f64::from(ratio);
    let fixed = (centre(after) * share - centre(before)) / (share - 1.0);
    let at =
        seen(point_at(from, fixed, depth(fixed))).map_or(view.rect.center(), |px| view.screen_from_px(px));
    view.zoomed_at(at, ratio)
}

#[cfg(test)]
mod tests {
    use egui::{Rect, pos2, vec2};

    use super::*;

    fn camera(centre: DVec3, focal: f64) -> std::sync::Arc<Camera> {
        crate::app::testing::camera([320, 240], [focal, 160.0, 120.0], centre, DVec3::Z, DVec3::Z)
    }

    fn view(points_per_px: f32) -> ViewTransform {
        let rect = Rect::from_min_size(pos2(20.0, 30.0), vec2(400.0, 300.0));
        ViewTransform { rect, points_per_px, centre_px: pos2(160.0, 120.0) }
    }

    #[test]
    fn a_zoom_keeps_the_same_point_of_the_world_in_place_in_every_view() {
        let (front, side) =
            (camera(DVec3::new(0.0, -4.0, 1.0), 400.0), camera(DVec3::new(3.0, 0.5, 1.2), 300.0));
        let hand = DVec3::new(0.4, 0.1, 1.3);
        let (before, other) = (view(1.5), view(2.0));
        let at = before.screen_from_px(front.project(hand).unwrap());
        let after = before.zoomed_at(at, 1.7);
        let followed = follow(&before, &after, &front, |_| front.depth(hand), &side, &other);
        let seen = side.project(hand).unwrap();
        assert!(followed.screen_from_px(seen).distance(other.screen_from_px(seen)) < 0.05);
        assert!((followed.points_per_px / other.points_per_px - 1.7).abs() < 1e-4);
    }

    #[test]
    fn a_pan_moves_the_others_as_their_pictures_of_that_point_move() {
        let (front, opposite) =
            (camera(DVec3::new(0.0, -4.0, 1.0), 400.0), camera(DVec3::new(0.0, 4.0, 1.0), 400.0));
        let side = camera(DVec3::new(4.0, 0.0, 1.0), 400.0);
        let before = view(1.5);
        let after = before.panned(vec2(30.0, 0.0));
        let moved = |camera: &Camera| {
            let followed = follow(&before, &after, &front, |_| 4.0, camera, &view(1.5));
            followed.centre_px - view(1.5).centre_px
        };
        // What is at the left for one is at the right for the opposite camera, and nearer or farther from the side.
        assert!((moved(&opposite).x - 20.0).abs() < 0.1, "{:?}", moved(&opposite));
        assert!(moved(&side).length() < 0.1, "{:?}", moved(&side));
    }
}
