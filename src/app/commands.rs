//! Doing what menus, buttons, keys and the palette ask for.

use backlit_document::history::Undone;
use backlit_document::runs::BROUGHT_BACK;
use backlit_tracking::body::Pose;

use super::Inspector;
use super::inspector::Errand;
use crate::context::Requests;
use crate::context::command::{
    BeginningCommand, Command, FitCommand, HistoryCommand, TrackingCommand, WindowCommand,
};
use crate::context::command_button::dragged_until_now;
use crate::context::preferences::Layout;
use crate::features::demonstrations::Demonstrations;
use crate::features::scene::panel as scene;
use crate::shell::Overlay;
use crate::shell::palette::Palette;

impl Inspector {
    /// The commands whose keys were pressed. While something lies over the window, or the hand holds
    /// something, keys are theirs.
    pub(crate) fn read_keys(&mut self, ctx: &egui::Context) -> Requests {
        let mut requests = Requests::default();
        let is_moving = self.shell.docking.is_moving_tile(ctx, &self.state.preferences, &self.state.session);
        if self.shell.overlay.is_none()
            && !self.context().drag.is_dragging()
            && !is_moving
            && !egui::Popup::is_any_open(ctx)
        {
            let of_scene = scene::keys::hold_back(ctx);
            requests.commands = Command::pressed(ctx);
            scene::keys::give_back(ctx, of_scene);
            self.with(
                |features| &mut features.pose,
                |posing, context, _| posing.read_clipboard(context, &mut requests),
            );
        }
        requests
    }

    /// Does a command, or says why it cannot be used now. In the laboratory's layout some mean what they mean there.
    pub(crate) fn run(&mut self, command: Command, ctx: &egui::Context) {
        let is_free =
            !self.features.laboratory.is_running() || self.state.preferences.layout != Layout::Demonstrate;
        if command == Command::Fit(FitCommand::Stop) && is_free && (self.cancel_drag(ctx) || self.escape()) {
            return;
        }
        if let Some(why) = self.unavailable(command) {
            // Esc is pressed for many things.
            if command != Command::Fit(FitCommand::Stop) {
                self.state.status = Some(format!("{} cannot be used now. {why}.", command.text()));
            }
            return;
        }
        // What was said was about the command before.
        self.state.status = None;
        if !self.with(|all| &mut all.laboratory, |laboratory, context, _| laboratory.takes(command, context))
        {
            self.hand_over(command);
        }
    }

    /// Hands a command to whom it belongs.
    fn hand_over(&mut self, command: Command) {
        match command {
            Command::File(command) => self.errands.push(Errand::Command(command)),
            Command::History(command) => self.history_command(command),
            Command::Recovery(command) => self.with(
                |features| &mut features.recovery,
                |recovery, context, requests| recovery.run(command, context, requests),
            ),
            Command::Export(command) => self.with(
                |features| &mut features.export,
                |export, context, requests| export.run(command, context, requests),
            ),
            Command::Pose(command) => self.with(
                |features| &mut features.pose,
                |posing, context, requests| posing.run(command, context, requests),
            ),
            Command::Window(command) => self.window_command(command),
            Command::View(command) => self.with(
                |features| &mut features.camera_views,
                |views, context, requests| views.run(command, context, requests),
            ),
            Command::Scene(command) => self.with(
                |features| &mut features.scene,
                |scene, context, requests| scene.run(command, context, requests),
            ),
            Command::Fit(FitCommand::SearchPoses) => {
                self.interrupt_fit();
                self.with(
                    |features| &mut features.tracking,
                    |tracking, context, _| tracking.search_poses(context),
                );
            }
            Command::Fit(command @ (FitCommand::FitBody | FitCommand::MakeSpheres)) => {
                self.interrupt_fit();
                self.with(
                    |features| &mut features.tracking,
                    |tracking, context, requests| tracking.make_body(command, context, requests),
                );
            }
            Command::Fit(command) => self.fit_command(command),
            Command::Convergence(command) => self.with(
                |features| &mut features.convergence,
                |convergence, context, requests| convergence.run(command, context, requests),
            ),
            Command::Basin(command) => self.with(
                |features| &mut features.basin,
                |basin, context, requests| basin.run(command, context, requests),
            ),
            Command::Beginning(command) => self.beginning_command(command),
            Command::Observability(command) => self.features.observability.run(command),
            Command::Tracking(command) => {
                if command != TrackingCommand::Clear {
                    self.interrupt_fit();
                }
                self.with(
                    |features| &mut features.tracking,
                    |tracking, context, requests| tracking.run(command, context, requests),
                );
            }
            Command::Timeline(command) => self.with(
                |features| &mut features.timeline,
                |timeline, context, requests| timeline.run(command, context, requests),
            ),
            Command::Demonstration(which) => self.with(
                |features| &mut features.demonstrations,
                |_, _, requests| Demonstrations::run(which, requests),
            ),
            Command::Laboratory(command) => self.features.laboratory.run(command),
            Command::Offsets => self.with(
                |features| &mut features.offsets,
                |offsets, context, requests| offsets.open(context, requests),
            ),
            Command::Tour => {
                self.with(
                    |features| &mut features.tour,
                    |tour, context, requests| tour.begin(context, requests),
                );
                self.shell.overlay = None;
            }
        }
    }

    fn beginning_command(&mut self, command: BeginningCommand) {
        self.with(
            |features| &mut features.beginnings,
            |beginnings, context, requests| beginnings.run(command, context, requests),
        );
    }

    /// Esc while a slider or a field is dragged: what that has changed is as it was.
    fn cancel_drag(&mut self, ctx: &egui::Context) -> bool {
        let is_back = dragged_until_now(ctx).is_some_and(|gesture| self.state.history.cancel(gesture));
        if is_back {
            self.state.status = Some("Put back.".to_owned());
        }
        is_back
    }

    /// Esc: what runs is stopped first, then a body that sways; else a camera that fills the window goes back, else a
    /// step is left; else what is tried or written in the background is stopped.
    fn escape(&mut self) -> bool {
        if self.context().busy.fitting || self.context().busy.tracking {
            return false;
        }
        if self.features.observability.is_swaying() {
            self.features.observability.stop_sway();
            return true;
        }
        if self.features.beginnings.is_running() {
            self.features.beginnings.stop();
            return true;
        }
        let alone = self.shell.docking.alone.take().is_some() || self.features.beginnings.leave();
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

    fn history_command(&mut self, command: HistoryCommand) {
        if command == HistoryCommand::Redo || !self.state.history.undo_brings_runs_back() {
            self.interrupt_fit();
            self.state.selection.step = None;
        }
        let said = match command {
            HistoryCommand::Undo => self.state.history.undo().map(|undone| match undone {
                Undone::Edit(what) => format!("Undone: {what}."),
                Undone::RemovedRuns => BROUGHT_BACK.to_owned(),
            }),
            HistoryCommand::Redo => self.state.history.redo().map(|what| format!("Redone: {what}.")),
        };
        if said.is_some() {
            self.state.status = said;
        }
    }

    fn window_command(&mut self, command: WindowCommand) {
        match command {
            WindowCommand::Layout(layout) => self.state.preferences.layout = layout,
            WindowCommand::ToggleTheme => {
                self.state.preferences.theme = self.state.preferences.theme.toggled();
            }
            WindowCommand::TogglePanel => self.state.preferences.panel = !self.state.preferences.panel,
            WindowCommand::ToggleTimeline => self.features.timeline.shows_lanes ^= true,
            WindowCommand::TogglePane(pane) => self.dock(|docking, window| docking.toggle_pane(window, pane)),
            WindowCommand::ArrangeTiles => self.arrange_tiles(),
            WindowCommand::ResetLayout => self.reset_layout(),
            WindowCommand::RestoreLayout => self.restore_layout(),
            WindowCommand::Enlarge => egui::gui_zoom::zoom_in(&self.state.egui),
            WindowCommand::Shrink => egui::gui_zoom::zoom_out(&self.state.egui),
            WindowCommand::NormalSize => self.state.egui.set_zoom_factor(1.0),
            WindowCommand::Palette => self.shell.overlay = Some(Overlay::Palette(Palette::default())),
            WindowCommand::Shortcuts => self.shell.overlay = Some(Overlay::Shortcuts(String::new())),
            WindowCommand::Messages => self.shell.overlay = Some(Overlay::Messages),
            WindowCommand::About => self.shell.overlay = Some(Overlay::About),
        }
    }

    fn fit_command(&mut self, command: FitCommand) {
        match command {
            // The tracker's.
            FitCommand::SearchPoses | FitCommand::FitBody | FitCommand::MakeSpheres => return,
            FitCommand::Step | FitCommand::Run | FitCommand::RunAgain(_) | FitCommand::Refit(_) => {
                self.pause();
            }
            FitCommand::Stop => self.features.tracking.stop(),
            _ => {}
        }
        self.with(|features| &mut features.fit, |fit, context, requests| fit.run(command, context, requests));
    }

    /// The pose on the screen.
    pub fn shown_pose(&self) -> &Pose {
        self.context().shown_pose()
    }
}
