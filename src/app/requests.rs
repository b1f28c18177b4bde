//! Applying what the panels asked for.

use super::App;
use super::state::{DialogKind, Opening};
use crate::context::{Intents, Request};
use crate::document::edit::Edit;
use crate::document::history::Gesture;

impl App {
    /// Applies edits, then requests, then commands.
    pub(crate) fn apply(&mut self, intents: Intents, ctx: &egui::Context) {
        if !(intents.edits.is_empty() && intents.requests.is_empty() && intents.actions.is_empty()) {
            // What was asked for in this frame is seen in the next.
            ctx.request_repaint();
        }
        if self.observing.glance(intents.glance) {
            ctx.request_repaint();
        }
        if let Some(order) = intents.scene {
            self.draw_scene(*order);
        }
        for (edit, gesture) in intents.edits {
            if matches!(edit, Edit::SetPose { .. }) {
                self.interrupt_fit();
            }
            self.edit(edit, gesture);
        }
        for request in intents.requests {
            self.request(request);
        }
        for action in intents.actions {
            self.act(action, ctx);
        }
    }

    /// Makes a change, and what follows from it for the selection.
    pub(crate) fn edit(&mut self, edit: Edit, gesture: Option<Gesture>) {
        let sets_pose = matches!(edit, Edit::SetPose { .. });
        let remeasures = matches!(edit, Edit::SetMeasurement(_));
        match self.history.apply(edit, gesture) {
            Ok(()) => {
                if sets_pose {
                    self.pause();
                    // The pose on the screen is now the document's again.
                    self.selection.step = None;
                }
                if remeasures {
                    self.session.frames.clear();
                }
            }
            Err(error) => self.notices.error(format!("That cannot be done: {error}.")),
        }
    }

    pub(crate) fn request(&mut self, request: Request) {
        match request {
            Request::Frame(frame) => {
                self.follows_tracker = false;
                self.interrupt_fit();
                self.go_to_frame(frame);
            }
            Request::Joint(joint) => self.selection.joint = joint,
            Request::Part(part) => self.selection.part = Some(part),
            Request::Views(settings) => self.look.views = settings,
            Request::Camera(camera) => self.make_active(camera),
            Request::Step(step) => {
                if let Some(run) = self.session.runs.get(step.run) {
                    self.selection.frame = run.frame;
                    self.selection.step = Some(step);
                }
            }
            Request::ShowRun(run, is_shown) => {
                if let Some(run) = self.session.runs.get_mut(run) {
                    run.is_shown = is_shown;
                    self.name_runs();
                }
            }
            Request::Basin(request) => self.basin_request(request),
            Request::Curves(request) => self.curves_request(request),
            Request::Observe(request) => self.observe_request(request),
            Request::Tile(camera, event) => self.tile_event(camera, event),
            Request::Layout(layout) => self.look.layout = layout,
            Request::Pane(pane, event) => self.pane_event(pane, event),
            Request::Scene(look) => self.look.scene = look,
            Request::Arrange(tree) => self.arrange(*tree),
            Request::Open(source) => self.open(Opening::Take(source)),
            Request::CloseNotice(id) => self.notices.close(id),
            Request::CloseExplanation => self.explanation = None,
            Request::HoldNotice(id) => self.notices.hold(id, self.now),
            Request::Laboratory(request) => self.laboratory_request(request),
            Request::Timeline(event) => self.timeline_event(event),
            Request::ChoosePose(index) => self.choose_pose(index),
            Request::Recover(which) => self.recover(which),
            Request::OpenPath(path) => self.open_path(&path),
            Request::ForgetRecent(path) => self.look.recent.retain(|other| *other != path),
            Request::Copy(what, text) => {
                self.context.copy_text(text);
                self.notices.info(self.now, format!("Copied the {what}."), None);
            }
            Request::OpenPage(address) => self.open_outside(address.to_owned()),
            Request::Used(action) => self.look.use_command(action.text()),
            Request::Export(order) => self.begin_export(*order),
            Request::ChooseExportFile => self.ask_for_file(DialogKind::Export),
        }
    }
}
