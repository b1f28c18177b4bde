//! Doing what menus, buttons, keys and the palette ask for.

use backlit_tracking::body::Pose;
use backlit_tracking::track::{FitOptions, posing};

use super::App;
use super::state::{DialogKind, Opening};
use crate::context::command::{
    Command, ConvergenceCommand, FileCommand, FitCommand, HistoryCommand, PoseCommand, TrackingCommand,
    ViewCommand, WindowCommand,
};
use crate::context::command_button::dragged_until_now;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::{PaneEvent, Requests};
use crate::document::edit::Edit;
use crate::drawing::{JointId, ViewMode};
use crate::features::camera_views::zoom;
use crate::features::observability::ObserveRequest;
use crate::features::pose::panel::rotation_tree;
use crate::features::scene::panel as scene;
use crate::session::selection::Selection;
use crate::shell::Overlay;
use crate::shell::palette::Palette;
use crate::take::source::TakeSource;
use crate::widgets::Framing;

impl App {
    /// The commands whose keys were pressed. While something lies over the window, or the hand holds
    /// something, keys are theirs.
    pub(crate) fn read_keys(&mut self, ctx: &egui::Context) -> Requests {
        let mut requests = Requests::default();
        let is_moving = self.shell.docking.is_moving_tile(ctx, &self.state.preferences, &self.state.session);
        if self.shell.overlay.is_none()
            && self.features.pose.held.is_none()
            && !is_moving
            && !egui::Popup::is_any_open(ctx)
        {
            let of_scene = scene::keys::hold_back(ctx);
            requests.commands = Command::pressed(ctx);
            scene::keys::give_back(ctx, of_scene);
            requests.commands.extend(self.read_clipboard(ctx));
        }
        requests
    }

    /// Does a command, if it can be used now. In the laboratory's layout some mean what they mean there.
    pub(crate) fn run(&mut self, command: Command, ctx: &egui::Context) {
        let is_free =
            !self.features.laboratory.is_running || self.state.preferences.layout != Layout::Demonstrate;
        if command == Command::Fit(FitCommand::Stop) && is_free && (self.put_back(ctx) || self.let_go()) {
            return;
        }
        if self.unavailable(command).is_some() || self.laboratory_takes(command) {
            return;
        }
        match command {
            Command::File(command) => self.file_command(command, ctx),
            Command::History(command) => self.history_command(command),
            Command::Recovery(command) => self.with(
                |features| &mut features.recovery,
                |recovery, context, requests| recovery.run(command, context, requests),
            ),
            Command::Export(command) => self.with(
                |features| &mut features.export,
                |export, context, requests| export.run(command, context, requests),
            ),
            Command::Pose(command) => self.pose_command(command, ctx),
            Command::Window(command) => self.window_command(command),
            Command::View(command) => self.view_command(command),
            Command::Scene(command) => self.scene_command(command),
            Command::Fit(command) => self.fit_command(command),
            Command::Convergence(command) => self.convergence_command(command),
            Command::Basin(command) => self.with(
                |features| &mut features.basin,
                |basin, context, requests| basin.run(command, context, requests),
            ),
            Command::Observability(command) => self.observability_command(command),
            Command::Tracking(command) => self.tracking_command(command),
            Command::Timeline(command) => self.timeline_command(command),
            Command::Demonstration(which) => self.open(Opening::Take(TakeSource::Demonstration(which))),
            Command::Laboratory(command) => self.laboratory_command(command),
            Command::Tour => {
                self.begin_tour();
                self.shell.overlay = None;
            }
        }
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
            if self.features.basin.is_running() {
                self.features.basin.cancel();
            } else {
                self.features.export.stop();
            }
        }
        true
    }

    fn file_command(&mut self, command: FileCommand, ctx: &egui::Context) {
        match command {
            FileCommand::OpenTake => self.ask_for_file(DialogKind::Take),
            FileCommand::OpenBuiltIn => self.open(Opening::Take(TakeSource::BuiltIn)),
            FileCommand::OpenProject => self.ask_for_file(DialogKind::Project),
            FileCommand::FindTake => self.ask_for_file(DialogKind::FindTake),
            FileCommand::Save => self.save_project(),
            FileCommand::SaveAs => self.ask_for_file(DialogKind::SaveAs),
            FileCommand::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
        }
    }

    fn history_command(&mut self, command: HistoryCommand) {
        if command == HistoryCommand::Undo && self.removed_runs_last() {
            return self.restore_runs();
        }
        self.interrupt_fit();
        self.state.selection.step = None;
        let (what, verb) = match command {
            HistoryCommand::Undo => (self.state.history.undo(), "Undid"),
            HistoryCommand::Redo => (self.state.history.redo(), "Did again"),
        };
        if let Some(what) = what {
            self.state.status = Some(format!("{verb}: {what}."));
        }
    }

    fn pose_command(&mut self, command: PoseCommand, ctx: &egui::Context) {
        let model = self.document().model.clone();
        let limb = self.state.selection.limb(&model);
        let rotation = model.limbs()[limb].rotation;
        let name = model.limbs()[limb].name.clone();
        match command {
            PoseCommand::Copy => self.copy_pose(ctx),
            PoseCommand::Paste => self.paste_pose(ctx),
            PoseCommand::Mirror => {
                let pose = mirrored(&model, self.shown_pose(), rotation);
                self.set_pose(pose, format!("Mirror {name}"));
            }
            PoseCommand::MirrorAll => {
                let pose = posing::mirror(&model, self.shown_pose());
                self.set_pose(pose, "Mirror pose".to_owned());
            }
            PoseCommand::PinJoint => {
                if let JointId::End(limb) = self.state.selection.joint {
                    let pinned = !self.document().pins.contains(&limb);
                    self.edit(Edit::Pin { limb, pinned }, None);
                }
            }
            PoseCommand::ResetLimb => {
                let mut pose = self.shown_pose().clone();
                pose.rotations[rotation] = Pose::rest(&model).rotations[rotation];
                self.set_pose(pose, format!("Reset {name}"));
            }
            PoseCommand::ResetBody => self.reset_body(),
            PoseCommand::NextJoint | PoseCommand::PreviousJoint => {
                // In the order of the tree in the Pose section.
                let rows = rotation_tree(&model);
                let here = rows.iter().position(|(row, _)| *row == rotation).unwrap_or(0);
                let by = if command == PoseCommand::NextJoint { 1 } else { rows.len() - 1 };
                let owner = model.rotation_owners()[rows[(here + by) % rows.len()].0];
                self.state.selection.joint = Selection::joint_of(&model, owner);
            }
            PoseCommand::Nudge(nudge) => self.nudge(nudge.by_px()),
        }
    }

    fn reset_body(&mut self) {
        let start = (*self.document().start).clone();
        let revision = self.state.history.revision();
        self.set_pose(start, "Reset body".to_owned());
        if self.state.history.revision() != revision {
            let text = "The body has the start pose of the take again.";
            self.state.notices.info(self.state.now, text, Some(Command::History(HistoryCommand::Undo)));
        }
    }

    fn window_command(&mut self, command: WindowCommand) {
        match command {
            WindowCommand::Layout(layout) => self.state.preferences.layout = layout,
            WindowCommand::ToggleTheme => {
                self.state.preferences.theme = self.state.preferences.theme.toggled()
            }
            WindowCommand::TogglePanel => self.state.preferences.panel = !self.state.preferences.panel,
            WindowCommand::ToggleTimeline => self.state.preferences.lanes = !self.state.preferences.lanes,
            WindowCommand::TogglePane(pane) => self.dock(|docking, window| docking.toggle_pane(window, pane)),
            WindowCommand::ArrangeTiles => self.arrange_tiles(),
            WindowCommand::ResetLayout => self.reset_layout(),
            WindowCommand::RestoreLayout => self.restore_layout(),
            WindowCommand::Palette => self.shell.overlay = Some(Overlay::Palette(Palette::default())),
            WindowCommand::Shortcuts => self.shell.overlay = Some(Overlay::Shortcuts(String::new())),
            WindowCommand::Messages => self.shell.overlay = Some(Overlay::Messages),
            WindowCommand::About => self.shell.overlay = Some(Overlay::About),
        }
    }

    fn view_command(&mut self, command: ViewCommand) {
        let framing = |app: &mut Self, framing: Framing| {
            for tile in app.tiles_mut() {
                tile.framing = framing;
            }
        };
        match command {
            ViewCommand::FitSubject => framing(self, Framing::Subject),
            ViewCommand::WholePicture => framing(self, Framing::Whole),
            ViewCommand::ZoomIn => self.zoom(zoom::STEP),
            ViewCommand::ZoomOut => self.zoom(1.0 / zoom::STEP),
            ViewCommand::LinkZoom => {
                self.state.preferences.linked_zoom = !self.state.preferences.linked_zoom;
                let what = if self.state.preferences.linked_zoom { "together" } else { "each by itself" };
                self.state.status = Some(format!("Views zoom and pan {what}."));
            }
            ViewCommand::CalibrationMarks => self.state.preferences.views.calibration_marks ^= true,
            ViewCommand::PixelGrid => self.state.preferences.views.pixel_grid ^= true,
            ViewCommand::SizeHandles => {
                self.state.preferences.views.size_handles ^= true;
                let what =
                    "Drag the diamonds: at its end for the limb's length, at its outline for its radius.";
                self.state.status = self.state.preferences.views.size_handles.then(|| what.to_owned());
            }
            ViewCommand::Mode(mode) => self.show_mode(mode),
            ViewCommand::Compare(comparison) => {
                let camera = self.state.selection.camera;
                if let Some(tile) = self.tiles_mut().get_mut(camera) {
                    tile.toggle(comparison);
                }
            }
            ViewCommand::CameraAlone(camera) => {
                self.pane_event(Pane::Camera(camera), PaneEvent::ToggleAlone);
            }
        }
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

    fn fit_command(&mut self, command: FitCommand) {
        match command {
            FitCommand::Step => self.step(Some(1)),
            FitCommand::Run => self.step(None),
            FitCommand::Stop => self.stop(),
            FitCommand::StepBack | FitCommand::EarlierStep => self.look_at_neighbour(false),
            FitCommand::LaterStep => self.look_at_neighbour(true),
            FitCommand::Branch => self.branch(),
            FitCommand::Refit(part) => self.refit(part),
            FitCommand::SearchPoses => self.search_poses(),
            FitCommand::FitBody => self.fit_body(),
            FitCommand::Renderer(renderer) => self.set_renderer(renderer),
            FitCommand::Preset(preset) => {
                // The renderer is chosen by itself.
                let renderer = self.document().fit.renderer;
                let options = FitOptions { renderer, ..FitOptions::preset(preset) };
                self.set_preset(preset, options);
            }
        }
    }

    fn convergence_command(&mut self, command: ConvergenceCommand) {
        match command {
            ConvergenceCommand::ClearRuns => self.clear_runs(),
            ConvergenceCommand::RestoreRuns => self.restore_runs(),
            ConvergenceCommand::ExportCurves => self.ask_for_file(DialogKind::Curves),
            ConvergenceCommand::ExportPlot => self.ask_for_file(DialogKind::Plot),
        }
    }

    fn tracking_command(&mut self, command: TrackingCommand) {
        match command {
            TrackingCommand::Forward => self.track(false),
            TrackingCommand::Back => self.track(true),
            TrackingCommand::Between => self.track_between_keys(),
            TrackingCommand::Clear => self.clear_track(),
        }
    }

    fn clear_track(&mut self) {
        let (tracked, keys) = (self.document().estimates.len(), self.document().keys.len());
        self.edit(Edit::ClearEstimates, None);
        let kept = match keys {
            0 => String::new(),
            1 => "; 1 key pose stays".to_owned(),
            keys => format!("; {keys} key poses stay"),
        };
        let text = format!("Forgot the poses of {tracked} frames{kept}.");
        self.state.notices.info(self.state.now, text, Some(Command::History(HistoryCommand::Undo)));
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
