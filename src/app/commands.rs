//! Doing what menus, buttons, keys and the palette ask for.

use backlit_tracking::body::Pose;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::posing;

use super::App;
use super::state::{DialogKind, Opening};
use crate::context::action::Action;
use crate::context::command_button::dragged_until_now;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{PaneEvent, Requests, unavailable};
use crate::document::edit::Edit;
use crate::drawing::{JointId, ViewMode};
use crate::features::basin::BasinView;
use crate::features::camera_views::Comparison;
use crate::features::camera_views::zoom;
use crate::features::demonstration::demonstration_of;
use crate::features::export::dialog::Subject;
use crate::features::fit::Part;
use crate::features::fit::renderer::renderer_of;
use crate::features::fit::solver::preset_of;
use crate::features::observability::ObserveRequest;
use crate::features::pose::drag::nudge_of;
use crate::features::pose::panel::rotation_tree;
use crate::features::scene::panel as scene;
use crate::session::selection::Selection;
use crate::shell::Overlay;
use crate::shell::palette::Palette;
use crate::shell::toolbar::view_mode_of;
use crate::take::source::TakeSource;
use crate::widgets::Framing;

impl App {
    /// The commands whose keys were pressed. While something lies over the window, or the hand holds
    /// something, keys are theirs.
    pub(crate) fn read_keys(&mut self, ctx: &egui::Context) -> Requests {
        let mut requests = Requests::default();
        let is_moving = self.is_moving_tile(ctx);
        if self.shell.overlay.is_none()
            && self.features.pose.held.is_none()
            && !is_moving
            && !egui::Popup::is_any_open(ctx)
        {
            let of_scene = scene::keys::hold_back(ctx);
            requests.actions = Action::pressed(ctx);
            scene::keys::give_back(ctx, of_scene);
            requests.actions.extend(self.read_clipboard(ctx));
        }
        requests
    }

    /// Does a command, if it can be used now.
    pub(crate) fn act(&mut self, action: Action, ctx: &egui::Context) {
        let is_free =
            !self.features.laboratory.is_running || self.state.preferences.layout != Layout::Demonstrate;
        if action == Action::Stop && is_free && (self.put_back(ctx) || self.let_go()) {
            return;
        }
        if unavailable(action, &self.context()).is_some() {
            return;
        }
        if self.act_on_laboratory(action)
            || self.act_on_files(action, ctx)
            || self.act_on_pose(action, ctx)
            || self.act_on_view(action)
            || self.act_on_fit(action)
            || self.act_on_observing(action)
            || self.act_on_frames(action)
        {
            return;
        }
        self.shell.overlay = match action {
            Action::Palette => Some(Overlay::Palette(Palette::default())),
            Action::Shortcuts => Some(Overlay::Shortcuts(String::new())),
            Action::Messages => Some(Overlay::Messages),
            Action::About => Some(Overlay::About),
            Action::Tour => {
                self.begin_tour();
                None
            }
            _ => None,
        };
    }

    /// Esc while a slider or a field is dragged: what that has changed is as it was.
    fn put_back(&mut self, ctx: &egui::Context) -> bool {
        let Some(gesture) = dragged_until_now(ctx) else { return false };
        let before = self.state.history.revision();
        self.state.history.put_back(gesture);
        let is_back = self.state.history.revision() != before;
        if is_back {
            self.state.status = Some("Put back.".to_owned());
        }
        is_back
    }

    /// Esc: what runs is stopped first, then a body that sways; else a camera that fills the window goes back, else a
    /// step is left; else what is tried or written in the background is stopped.
    fn let_go(&mut self) -> bool {
        if !self.worker.is_idle() && (self.context().busy.fitting || self.context().busy.tracking) {
            return false;
        }
        if self.features.observability.is_swaying() {
            self.observe_request(ObserveRequest::StopSway);
            return true;
        }
        let alone = self.shell.docking.alone.take().is_some();
        if !alone && self.state.selection.step.take().is_none() {
            // What goes on behind all that is looked at comes last.
            if self.features.basin.running.is_some() {
                self.cancel_basin();
            } else {
                self.stop_export();
            }
        }
        true
    }

    fn act_on_files(&mut self, action: Action, ctx: &egui::Context) -> bool {
        if let Some(which) = demonstration_of(action) {
            self.open(Opening::Take(TakeSource::Demonstration(which)));
            return true;
        }
        match action {
            Action::OpenTake => self.ask_for_file(DialogKind::Take),
            Action::OpenBuiltIn => self.open(Opening::Take(TakeSource::BuiltIn)),
            Action::OpenProject => self.ask_for_file(DialogKind::Project),
            Action::FindTake => self.ask_for_file(DialogKind::FindTake),
            Action::Save => self.save_project(),
            Action::SaveAs => self.ask_for_file(DialogKind::SaveAs),
            Action::ExportView => self.ask_for_export(Subject::View),
            Action::ExportWindow => self.ask_for_export(Subject::Window),
            Action::ExportSteps => self.ask_for_export(Subject::Steps),
            Action::ExportFrames => self.ask_for_export(Subject::Frames),
            Action::StopExport => self.stop_export(),
            Action::ShowExported => self.show_exported(),
            Action::UndoDiscard => self.undo_discard(),
            Action::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            _ => return false,
        }
        true
    }

    fn act_on_pose(&mut self, action: Action, ctx: &egui::Context) -> bool {
        if let Some(by_px) = nudge_of(action) {
            self.nudge(by_px);
            return true;
        }
        let model = self.document().model.clone();
        let limb = self.state.selection.limb(&model);
        let rotation = model.limbs()[limb].rotation;
        let name = model.limbs()[limb].name.clone();
        match action {
            Action::Undo if self.removed_runs_last() => self.restore_runs(),
            Action::Undo | Action::Redo => {
                self.interrupt_fit();
                self.state.selection.step = None;
                let what = if action == Action::Undo {
                    self.state.history.undo()
                } else {
                    self.state.history.redo()
                };
                if let Some(what) = what {
                    let verb = if action == Action::Undo { "Undid" } else { "Did again" };
                    self.state.status = Some(format!("{verb}: {what}."));
                }
            }
            Action::CopyPose => self.copy_pose(ctx),
            Action::PastePose => self.paste_pose(ctx),
            Action::MirrorPose => {
                let pose = posing::mirror(&model, self.shown_pose());
                self.set_pose(pose, "Mirror pose".to_owned());
            }
            Action::Mirror => {
                let pose = mirrored(&model, self.shown_pose(), rotation);
                self.set_pose(pose, format!("Mirror {name}"));
            }
            Action::PinJoint => {
                if let JointId::End(limb) = self.state.selection.joint {
                    let pinned = !self.document().pins.contains(&limb);
                    self.edit(Edit::Pin { limb, pinned }, None);
                }
            }
            Action::ResetLimb => {
                let mut pose = self.shown_pose().clone();
                pose.rotations[rotation] = Pose::rest(&model).rotations[rotation];
                self.set_pose(pose, format!("Reset {name}"));
            }
            Action::ResetBody => {
                let start = (*self.document().start).clone();
                let revision = self.state.history.revision();
                self.set_pose(start, "Reset body".to_owned());
                if self.state.history.revision() != revision {
                    let text = "The body has the start pose of the take again.";
                    self.state.notices.info(self.state.now, text, Some(Action::Undo));
                }
            }
            Action::NextJoint | Action::PreviousJoint => {
                // In the order of the tree in the Pose section.
                let rows = rotation_tree(&model);
                let here = rows.iter().position(|(row, _)| *row == rotation).unwrap_or(0);
                let by = if action == Action::NextJoint { 1 } else { rows.len() - 1 };
                let owner = model.rotation_owners()[rows[(here + by) % rows.len()].0];
                self.state.selection.joint = Selection::joint_of(&model, owner);
            }
            _ => return false,
        }
        true
    }

    fn act_on_view(&mut self, action: Action) -> bool {
        if let Some(mode) = view_mode_of(action) {
            self.show_mode(mode);
            return true;
        }
        if let Some(camera) = (0..8).find(|index| Action::camera_alone(*index) == Some(action)) {
            self.pane_event(Pane::Camera(camera), PaneEvent::ToggleAlone);
            return true;
        }
        let framing = |app: &mut Self, framing: Framing| {
            for tile in app.tiles_mut() {
                tile.framing = framing;
            }
        };
        match action {
            Action::LayoutPose => self.state.preferences.layout = Layout::Pose,
            Action::LayoutDebug => self.state.preferences.layout = Layout::Debug,
            Action::LayoutDemonstrate => self.state.preferences.layout = Layout::Demonstrate,
            Action::ToggleTheme => self.state.preferences.theme = self.state.preferences.theme.toggled(),
            Action::TogglePanel => self.state.preferences.panel = !self.state.preferences.panel,
            Action::ToggleTimeline => self.state.preferences.lanes = !self.state.preferences.lanes,
            Action::Wipe | Action::Blink => {
                let comparison = if action == Action::Wipe { Comparison::Wipe } else { Comparison::Blink };
                let camera = self.state.selection.camera;
                if let Some(tile) = self.tiles_mut().get_mut(camera) {
                    tile.toggle(comparison);
                }
            }
            Action::LinkZoom => {
                self.state.preferences.linked_zoom = !self.state.preferences.linked_zoom;
                let what = if self.state.preferences.linked_zoom { "together" } else { "each by itself" };
                self.state.status = Some(format!("Views zoom and pan {what}."));
            }
            Action::CalibrationMarks => self.state.preferences.views.calibration_marks ^= true,
            Action::PixelGrid => self.state.preferences.views.pixel_grid ^= true,
            Action::SizeHandles => {
                self.state.preferences.views.size_handles ^= true;
                if self.state.preferences.views.size_handles {
                    let what =
                        "Drag the diamonds: at its end for the limb's length, at its outline for its radius.";
                    self.state.status = Some(what.to_owned());
                } else {
                    self.state.status = None;
                }
            }
            Action::FitSubject => framing(self, Framing::Subject),
            Action::WholePicture => framing(self, Framing::Whole),
            Action::ZoomIn => self.zoom(zoom::STEP),
            Action::ZoomOut => self.zoom(1.0 / zoom::STEP),
            _ => return self.act_on_tiles(action),
        }
        true
    }

    /// Shows a mode in all views. The Jacobian's, chosen again, goes on to its next axis.
    fn show_mode(&mut self, mode: ViewMode) {
        let is_shown = self.tiles_mut().iter().all(|tile| tile.mode == mode && tile.comparison.is_none());
        if is_shown && mode == ViewMode::JacobianColumn {
            self.state.preferences.views.axis = self.state.preferences.views.axis.next();
            self.state.status = Some(format!(
                "Jacobian column: {}.",
                self.state.preferences.views.axis.label().to_lowercase()
            ));
        }
        for tile in self.tiles_mut() {
            (tile.mode, tile.comparison) = (mode, None);
        }
    }

    fn act_on_fit(&mut self, action: Action) -> bool {
        if let Some(renderer) = renderer_of(action) {
            self.set_renderer(renderer);
            return true;
        }
        if let Some(preset) = preset_of(action) {
            // The renderer is chosen by itself.
            let renderer = self.document().fit.renderer;
            let options = FitOptions { renderer, ..FitOptions::preset(preset) };
            self.set_preset(preset, options);
            return true;
        }
        match action {
            Action::Step => self.step(Some(1)),
            Action::Run => self.step(None),
            Action::Stop => self.stop(),
            Action::StepBack | Action::EarlierStep => self.look_at_neighbour(false),
            Action::LaterStep => self.look_at_neighbour(true),
            Action::Branch => self.branch(),
            Action::RefitLimb => self.refit(Part::Limb),
            Action::RefitChain => self.refit(Part::Chain),
            Action::RefitBody => self.refit(Part::Body),
            Action::FitBody => self.fit_body(),
            Action::ClearRuns => self.clear_runs(),
            Action::RunBasin => self.run_basin(BasinView::Angles),
            Action::RunBasinMap => self.run_basin(BasinView::Map),
            Action::CancelBasin => self.cancel_basin(),
            Action::RestoreRuns => self.restore_runs(),
            Action::ExportCurves => self.ask_for_file(DialogKind::Curves),
            Action::ExportPlot => self.ask_for_file(DialogKind::Plot),
            Action::TrackForward => self.track(false),
            Action::TrackBack => self.track(true),
            Action::TrackBetween => self.track_between_keys(),
            Action::SearchPoses => self.search_poses(),
            _ => return false,
        }
        true
    }

    fn act_on_frames(&mut self, action: Action) -> bool {
        let here = self.state.selection.frame;
        let last = self.state.session.frame_count().saturating_sub(1);
        let frame = match action {
            Action::PreviousFrame => here.saturating_sub(1),
            Action::NextFrame => here + 1,
            Action::TenFramesBack => here.saturating_sub(10),
            Action::TenFramesOn => here + 10,
            Action::FirstFrame => 0,
            Action::LastFrame => last,
            Action::NextWorst | Action::PreviousWorst => {
                self.go_to_worst(action == Action::NextWorst);
                return true;
            }
            Action::SetKeyPose => {
                let is_key = self.document().keys.contains_key(&here);
                let edit = if is_key { Edit::ClearKey { frame: here } } else { Edit::SetKey { frame: here } };
                self.edit(edit, None);
                return true;
            }
            Action::ClearTrack => {
                let (tracked, keys) = (self.document().estimates.len(), self.document().keys.len());
                self.edit(Edit::ClearEstimates, None);
                let kept = match keys {
                    0 => String::new(),
                    1 => "; 1 key pose stays".to_owned(),
                    keys => format!("; {keys} key poses stay"),
                };
                let text = format!("Forgot the poses of {tracked} frames{kept}.");
                self.state.notices.info(self.state.now, text, Some(Action::Undo));
                return true;
            }
            Action::Play => {
                self.play_or_pause();
                return true;
            }
            _ if self.act_on_time(action) => return true,
            _ => return false,
        };
        self.features.tracking.follows_tracker = false;
        self.interrupt_fit();
        self.go_to_frame(frame.min(last));
        true
    }

    /// The pose on the screen.
    pub(crate) fn shown_pose(&self) -> &Pose {
        self.state.session.shown_pose(self.document(), &self.state.selection)
    }

    fn set_pose(&mut self, pose: Pose, what: String) {
        self.interrupt_fit();
        self.edit(Edit::SetPose { frame: self.state.selection.frame, pose, what }, None);
    }
}

/// The pose with the other side's limb, and all that hangs from it, turned as this side's is.
fn mirrored(model: &backlit_tracking::body::Model, pose: &Pose, rotation: usize) -> Pose {
    let all = posing::mirror(model, pose);
    let mut result = pose.clone();
    for (index, &owner) in model.rotation_owners().iter().enumerate() {
        let other = model.limbs()[model.mirrored_limb(owner)].rotation;
        // What follows the selected rotation on this side is copied to the other.
        if model.rotation_follows(other, rotation) && other != index {
            result.rotations[index] = all.rotations[index];
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Parameters, builtin};

    use super::*;

    #[test]
    fn mirroring_an_arm_moves_the_other_arm_only() {
        let model = builtin::full_body();
        let step: Vec<f64> = (0..48).map(|i| 0.3 * (f64::from(i) * 1.3).sin()).collect();
        let pose = Pose::rest(&model).retract(Parameters::Tangent, &step);
        let arm = model.limbs()[model.limb_index("right upper arm").unwrap()].rotation;
        let after = mirrored(&model, &pose, arm);
        let changed: Vec<&str> = model
            .rotation_owners()
            .iter()
            .enumerate()
            .filter(|(index, _)| after.rotations[*index] != pose.rotations[*index])
            .map(|(_, owner)| model.limbs()[*owner].name.as_str())
            .collect();
        assert_eq!(changed, ["left upper arm", "left forearm"]);
    }
}
