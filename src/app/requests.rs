//! What features and shell have asked for is done.

use backlit_document::edit::Edit;
use backlit_ui::drawing::DragEvent;

use super::Inspector;
use crate::context::command::{Command, FitCommand, HistoryCommand, TrackingCommand, WindowCommand};
use crate::context::command_button::dragged_until_now;
use crate::context::preferences::Layout;
use crate::context::{DesktopRequest, FeatureRequest, Request, Requests, SessionRequest, ShellRequest};
use crate::shell::Overlay;
use crate::shell::docking::{Docking, Tiles};
use crate::shell::palette::Palette;

impl Inspector {
    /// Applies edits, then requests, then commands; what was asked for in this frame of the window is seen in the next.
    pub(crate) fn apply(&mut self, requests: Requests) {
        if !requests.is_empty() {
            self.state.egui.request_repaint();
        }
        self.apply_before_show(requests);
    }

    /// The same before the panels are shown, which see it in this frame of the window.
    pub(crate) fn apply_before_show(&mut self, requests: Requests) {
        let session = &mut self.state.session;
        if let Some(predicted) = requests.predicted {
            session.predicted = Some(predicted);
            session.generation += 1;
        }
        session.beliefs.extend(requests.beliefs);
        for frame in requests.frames {
            session.keep_frame(frame);
        }
        for (edit, gesture) in requests.edits {
            if matches!(edit, Edit::SetPose { .. }) {
                self.interrupt_fit();
            }
            self.state.edit(edit, gesture);
        }
        for request in requests.others {
            self.request(request);
        }
        for command in requests.commands {
            self.run(command);
        }
    }

    /// Hands a request to those who answer it.
    pub(crate) fn request(&mut self, request: impl Into<Request>) {
        match request.into() {
            Request::Session(request) => self.session_request(request),
            Request::Shell(request) => self.shell_request(request),
            Request::Feature(request) => {
                // What runs or plays stops for a drag.
                if matches!(request, FeatureRequest::Drag(_, DragEvent::Begin(_))) {
                    self.interrupt_fit();
                    self.state.playback.stop();
                }
                self.ask(|features, context, requests| {
                    features.all_mut().for_each(|feature| feature.answer(&request, context, requests));
                });
            }
            Request::Desktop(request) => {
                self.state.is_opening |= matches!(request, DesktopRequest::Open(_));
                self.errands.push(request);
            }
        }
    }

    fn session_request(&mut self, request: SessionRequest) {
        let state = &mut self.state;
        match request {
            SessionRequest::Frame(frame) => {
                self.interrupt_fit();
                self.session_request(SessionRequest::Visit(frame));
            }
            SessionRequest::Visit(frame) => {
                self.features.tracking.follows = false;
                state.go_to_frame(frame);
            }
            SessionRequest::Follow(frame) => state.go_to_frame(frame),
            SessionRequest::Joint(joint) => state.selection.joint = joint,
            SessionRequest::Part(part) => state.selection.part = Some(part),
            SessionRequest::LeaveStep => state.selection.step = None,
            SessionRequest::Step(step) => {
                if let Some(run) = state.history.runs().get(step.run) {
                    state.selection.frame = run.frame;
                    state.selection.step = Some(step);
                }
            }
            SessionRequest::Runs(change) => {
                state.history.change_runs(change);
                let runs = state.history.runs();
                state.selection.step.take_if(|step| runs.get(step.run).is_none());
            }
            SessionRequest::CancelGesture(gesture) => {
                state.history.cancel(gesture);
            }
            SessionRequest::Playback(change) => {
                let (here, count) = (state.selection.frame, state.session.frame_count());
                if let Some(from) = state.playback.change(change, here, count, state.now) {
                    self.session_request(SessionRequest::Frame(from));
                }
            }
        }
    }

    fn shell_request(&mut self, request: ShellRequest) {
        let (preferences, notices) = (&mut self.state.preferences, &mut self.state.notices);
        match request {
            ShellRequest::Camera(camera) => self.dock(|docking, tiles| docking.make_active(tiles, camera)),
            ShellRequest::SwitchCamera { from, to } => {
                self.dock(|docking, tiles| docking.switch_camera(tiles, from, to));
            }
            ShellRequest::Pane(pane, event) => {
                self.dock(|docking, tiles| docking.pane_event(tiles, pane, event));
            }
            ShellRequest::Arrange(tree) => self.dock(|_, tiles| tiles.arrange(*tree)),
            ShellRequest::ShowAllTiles => self.shell.docking.alone = None,
            ShellRequest::Layout(layout) => preferences.layout = layout,
            ShellRequest::OpenCard(card) => self.shell.overlay = Some(Overlay::Card(card)),
            ShellRequest::CloseCard => self.shell.overlay = None,
            ShellRequest::CloseNotices => notices.close_passing(),
            ShellRequest::CloseNotice(id) => notices.close(|notice| notice.id == id),
            ShellRequest::CloseNoticesAbout(beginning) => {
                notices.close(|notice| notice.text.starts_with(beginning));
            }
            ShellRequest::HoldNotice(id) => notices.hold(id),
            ShellRequest::Inform(text, next) => notices.info(text, next),
            ShellRequest::Complain(text, None) => notices.error(text),
            ShellRequest::Complain(text, Some(helps)) => notices.error_with(text, helps),
            ShellRequest::Status(text) => self.state.status = text,
            ShellRequest::Copy(what, text) => {
                self.state.egui.copy_text(text);
                notices.info(format!("Copied the {what}."), None);
            }
            ShellRequest::Used(command) => preferences.use_command(command.text()),
            ShellRequest::ForgetRecent(path) => preferences.recent.retain(|other| *other != path),
            ShellRequest::FramesMb(megabytes) => preferences.frames_mb = megabytes,
        }
    }

    /// Ends a fit that is going on, because its pose is about to change: what it has done stays as a run.
    pub(crate) fn interrupt_fit(&mut self) {
        self.ask(|features, _, requests| features.fit.interrupt(requests));
    }

    /// Does a command, or says why it cannot be used now. In the laboratory's layout some mean what they mean there.
    pub(crate) fn run(&mut self, command: Command) {
        let stops = command == Command::Fit(FitCommand::Stop);
        let is_free =
            !self.features.laboratory.is_running() || self.state.preferences.layout != Layout::Demonstrate;
        if stops && is_free && self.escape() {
            return;
        }
        if let Some(why) = self.features.unavailable(command, &self.context()) {
            // Esc is pressed for many things.
            if !stops {
                self.state.status = Some(format!("{} cannot be used now. {why}.", command.text()));
            }
            return;
        }
        // What was said was about the command before.
        self.state.status = None;
        if self.ask(|features, context, _| features.laboratory.takes(command, context)) {
            return;
        }
        if ends_fit(command) {
            self.interrupt_fit();
        }
        match command {
            Command::File(command) => self.errands.push(DesktopRequest::File(command)),
            Command::History(command) => self.history_command(command),
            Command::Window(command) if command != WindowCommand::ToggleTimeline => {
                self.window_command(command);
            }
            command => self.ask(|features, context, requests| {
                features.all_mut().any(|feature| feature.run(command, context, requests));
            }),
        }
    }

    /// Esc: what a dragged slider or field has changed is as it was; else what runs is stopped, then a body that sways; else a
    /// camera that fills the window goes back, else a step is left; else what is tried or written in the background is
    /// stopped. `false` leaves it to the fit and the tracker.
    fn escape(&mut self) -> bool {
        let state = &mut self.state;
        if dragged_until_now(&state.egui).is_some_and(|gesture| state.history.cancel(gesture)) {
            state.status = Some("Put back.".to_owned());
            return true;
        }
        let features = &mut self.features;
        if features.fit.is_running() || features.tracking.is_busy() {
            return false;
        }
        if features.observability.is_swaying() {
            features.observability.stop_sway();
        } else if features.beginnings.is_running() {
            features.beginnings.stop();
        } else if !(self.shell.docking.alone.take().is_some()
            || features.beginnings.leave()
            || state.selection.step.take().is_some())
        {
            // What goes on behind all that is looked at comes last.
            if features.basin.is_running() {
                features.basin.cancel();
            } else {
                features.export.stop();
            }
        }
        true
    }

    fn history_command(&mut self, command: HistoryCommand) {
        if command == HistoryCommand::Redo || !self.state.history.undo_brings_runs_back() {
            self.interrupt_fit();
            self.state.selection.step = None;
        }
        let history = &mut self.state.history;
        let said = match command {
            HistoryCommand::Undo => history.undo(),
            HistoryCommand::Redo => history.redo(),
        };
        if said.is_some() {
            self.state.status = said;
        }
    }

    fn window_command(&mut self, command: WindowCommand) {
        let (preferences, egui, shell) = (&mut self.state.preferences, &self.state.egui, &mut self.shell);
        match command {
            WindowCommand::Layout(layout) => preferences.layout = layout,
            WindowCommand::ToggleTheme => preferences.theme = preferences.theme.toggled(),
            WindowCommand::TogglePanel => preferences.panel ^= true,
            // The timeline's own.
            WindowCommand::ToggleTimeline => {}
            WindowCommand::TogglePane(pane) => self.dock(|docking, tiles| docking.toggle_pane(tiles, pane)),
            WindowCommand::ArrangeTiles | WindowCommand::ResetLayout | WindowCommand::RestoreLayout => {
                self.change_layout(command);
            }
            WindowCommand::Enlarge => egui::gui_zoom::zoom_in(egui),
            WindowCommand::Shrink => egui::gui_zoom::zoom_out(egui),
            WindowCommand::NormalSize => egui.set_zoom_factor(1.0),
            WindowCommand::Palette => shell.overlay = Some(Overlay::Palette(Palette::default())),
            WindowCommand::Shortcuts => shell.overlay = Some(Overlay::Shortcuts(String::new())),
            WindowCommand::Messages => shell.overlay = Some(Overlay::Messages),
            WindowCommand::About => shell.overlay = Some(Overlay::About),
        }
    }

    /// Lets the docking work on what the tiles are arranged in.
    fn dock(&mut self, work: impl FnOnce(&mut Docking, &mut Tiles<'_>)) {
        let state = &mut self.state;
        let mut tiles = Tiles {
            preferences: &mut state.preferences,
            selection: &mut state.selection,
            session: &state.session,
        };
        work(&mut self.shell.docking, &mut tiles);
    }

    /// Puts the tiles where they give the largest pictures, or all of the layout back as it was at first; or takes back the
    /// last of the two.
    fn change_layout(&mut self, command: WindowCommand) {
        let mut settings = self.settings();
        if command == WindowCommand::RestoreLayout {
            if let Some(before) = self.layout_before.take() {
                self.apply_settings(before.with_memory_of(settings));
                self.state.status = Some("The layout is as it was.".to_owned());
            }
            return;
        }
        self.layout_before = Some(Box::new(settings.clone()));
        self.shell.docking.alone = None;
        let said = if command == WindowCommand::ArrangeTiles {
            let cameras = self.state.session.camera_count();
            self.state.preferences.kept.forget(self.state.preferences.layout, cameras);
            "Arranged the tiles."
        } else {
            settings.reset();
            self.apply_settings(settings);
            "Reset the layout."
        };
        self.state.notices.info(said, Some(Command::Window(WindowCommand::RestoreLayout)));
    }
}

/// Whether a command begins other work in the place of a fit.
fn ends_fit(command: Command) -> bool {
    match command {
        Command::Tracking(command) => command != TrackingCommand::Clear,
        Command::Fit(command) => {
            matches!(command, FitCommand::SearchPoses | FitCommand::FitBody | FitCommand::MakeSpheres)
        }
        _ => false,
    }
}
