//! Applying what the panels asked for.

use backlit_document::edit::Edit;
use backlit_document::history::Gesture;

use super::Inspector;
use super::inspector::Errand;
use super::state::Opening;
use crate::context::{Context, Request, Requests};
use crate::features::Features;
use crate::shell::Overlay;

impl Inspector {
    /// Applies edits, then requests, then commands; what was asked for in this frame of the window is seen in the next.
    pub(crate) fn apply(&mut self, requests: Requests, ctx: &egui::Context) {
        if !(requests.edits.is_empty() && requests.others.is_empty() && requests.commands.is_empty()) {
            ctx.request_repaint();
        }
        self.apply_before_show(requests, ctx);
    }

    /// The same before the panels are shown, which see it in this frame of the window.
    fn apply_before_show(&mut self, requests: Requests, ctx: &egui::Context) {
        if let Some(predicted) = requests.predicted {
            self.show_prediction(predicted);
        }
        self.state.session.beliefs.extend(requests.beliefs);
        self.state.session.held.extend(requests.held);
        for frame in requests.frames {
            self.state.session.keep_frame(frame);
        }
        for write in requests.writes {
            self.write(write);
        }
        for (edit, gesture) in requests.edits {
            if matches!(edit, Edit::SetPose { .. }) {
                self.interrupt_fit();
            }
            self.edit(edit, gesture);
        }
        for request in requests.others {
            self.request(request);
        }
        for command in requests.commands {
            self.run(command, ctx);
        }
    }

    /// Lets a feature work on its own state, with what it reads and what it asks for, and does what it asked for.
    pub(crate) fn with<Feature: Default, Answer>(
        &mut self,
        feature: fn(&mut Features) -> &mut Feature,
        work: impl FnOnce(&mut Feature, &Context<'_>, &mut Requests) -> Answer,
    ) -> Answer {
        let (answer, requests) = self.lend_to(feature, work);
        let egui = self.state.egui.clone();
        self.apply(requests, &egui);
        answer
    }

    /// The same before the panels are shown: a tracker that is heard of needs one frame of the window, not two.
    pub(crate) fn update_feature<Feature: Default>(
        &mut self,
        feature: fn(&mut Features) -> &mut Feature,
        work: impl FnOnce(&mut Feature, &Context<'_>, &mut Requests),
    ) {
        let ((), requests) = self.lend_to(feature, work);
        let egui = self.state.egui.clone();
        self.apply_before_show(requests, &egui);
    }

    /// Lets a feature work, and says what it asked for.
    pub(crate) fn lend_to<Feature: Default, Answer>(
        &mut self,
        feature: fn(&mut Features) -> &mut Feature,
        work: impl FnOnce(&mut Feature, &Context<'_>, &mut Requests) -> Answer,
    ) -> (Answer, Requests) {
        let mut taken = std::mem::take(feature(&mut self.features));
        let mut requests = Requests::default();
        let answer = work(&mut taken, &self.context(), &mut requests);
        *feature(&mut self.features) = taken;
        (answer, requests)
    }

    /// Makes a change, and what follows from it for the selection.
    pub(crate) fn edit(&mut self, edit: Edit, gesture: Option<Gesture>) {
        let sets_pose = matches!(edit, Edit::SetPose { .. });
        let remeasures = matches!(edit, Edit::SetMeasurement(_));
        match self.state.history.apply(edit, gesture) {
            Ok(()) => {
                if sets_pose {
                    self.pause();
                    // The pose on the screen is now the document's again.
                    self.state.selection.step = None;
                }
                if remeasures {
                    self.state.session.frames.clear();
                }
            }
            Err(error) => self.state.notices.error(format!("That cannot be done: {error}.")),
        }
    }

    pub(crate) fn request(&mut self, request: Request) {
        match request {
            Request::Frame(frame) => {
                self.interrupt_fit();
                self.request(Request::Visit(frame));
            }
            Request::Visit(frame) => {
                self.features.tracking.stop_following();
                self.go_to_frame(frame);
            }
            Request::Follow(frame) => self.go_to_frame(frame),
            Request::LeaveStep => self.state.selection.step = None,
            Request::Joint(joint) => self.state.selection.joint = joint,
            Request::Part(part) => self.state.selection.part = Some(part),
            Request::ShowMode(layout, mode) => self.features.camera_views.show_mode(layout, mode),
            Request::Views(settings) => self.features.camera_views.preferences.settings = settings,
            Request::Camera(camera) => self.dock(|docking, window| docking.make_active(window, camera)),
            Request::Step(step) => {
                if let Some(run) = self.state.history.runs().get(step.run) {
                    self.state.selection.frame = run.frame;
                    self.state.selection.step = Some(step);
                }
            }
            Request::Runs(change) => {
                self.state.history.change_runs(change);
                let runs = self.state.history.runs();
                self.state.selection.step.take_if(|step| runs.get(step.run).is_none());
            }
            Request::InterruptFit => self.interrupt_fit(),
            Request::SwitchCamera { from, to } => {
                self.dock(|docking, window| docking.switch_camera(window, from, to));
            }
            Request::Drag(camera, event) => self.drag(camera, event),
            Request::CancelGesture(gesture) => {
                self.state.history.cancel(gesture);
            }
            Request::RunLaboratory { over, camera } => {
                self.features.laboratory.run_when_begun(over, camera);
            }
            Request::ShowAllTiles => self.shell.docking.alone = None,
            Request::Layout(layout) => self.state.preferences.layout = layout,
            Request::Pane(pane, event) => self.pane_event(pane, event),
            Request::Arrange(tree) => self.dock(|_, window| window.arrange(*tree)),
            Request::Open(source) => self.open(Opening::Take(source)),
            Request::CloseNotices => self.state.notices.close_all(),
            Request::CloseNotice(id) => self.state.notices.close(id),
            Request::CloseNoticesAbout(beginning) => self.state.notices.close_about(beginning),
            Request::HoldNotice(id) => self.state.notices.hold(id, self.state.now),
            Request::Playback(change) => self.change_playback(change),
            Request::Recover(decision) => self.with(
                |features| &mut features.recovery,
                |recovery, _, requests| recovery.decide(decision, requests),
            ),
            Request::OpenPath(_) | Request::OpenOutside(_) | Request::Export => {
                self.errands.push(Errand::Request(request));
            }
            Request::ForgetRecent(path) => self.state.preferences.recent.retain(|other| *other != path),
            Request::Copy(what, text) => {
                self.state.egui.copy_text(text);
                self.state.notices.info(self.state.now, format!("Copied the {what}."), None);
            }
            Request::Used(command) => self.state.preferences.use_command(command.text()),
            Request::RecoveryCard => self.shell.overlay = Some(Overlay::UnsavedWork),
            Request::NewTakeCard => self.shell.overlay = Some(Overlay::NewTake),
            Request::FramesMb(megabytes) => self.state.preferences.frames_mb = megabytes,
            Request::OffsetsCard => self.shell.overlay = Some(Overlay::Offsets),
            Request::CloseCard => self.shell.overlay = None,
            Request::ExportCard => self.shell.overlay = Some(Overlay::Export),
            Request::Status(text) => self.state.status = text,
            Request::Inform(text, next) => self.state.notices.info(self.state.now, text, next),
            Request::Complain(text, None) => self.state.notices.error(text),
            Request::Complain(text, Some(helps)) => self.state.notices.error_with(text, helps),
        }
    }
}
