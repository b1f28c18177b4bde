//! Poses to and from the system's clipboard, as the JSON of a pose file: it can be pasted in a text editor and back.

use std::path::Path;

use backlit_document::edit::Edit;
use backlit_formats::pose_file::{self, Quaternions};
use backlit_tracking::body::Pose;

use super::Posing;
use crate::context::command::{Command, PoseCommand};
use crate::context::{Context, Requests};

/// Frames of the window within which the system gives its clipboard, or not.
const FRAMES_TO_WAIT: u8 = 3;

/// What was copied here, and whether the system's clipboard was asked for.
#[derive(Debug, Default)]
pub(super) struct Clipboard {
    /// The pose that was copied last: what is pasted where the system gives nothing.
    own: Option<Pose>,
    /// Text that the system gave.
    text: Option<String>,
    /// Frames to go on waiting for it.
    waits: Option<u8>,
}

impl Posing {
    /// Ctrl+C and Ctrl+V as a window's system tells them: not as keys. While text is typed they are the text's.
    pub(crate) fn read_clipboard(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if context.egui.text_edit_focused() {
            return;
        }
        let clipboard = &mut self.clipboard;
        let mut is_given = false;
        context.egui.input(|input| {
            for event in &input.events {
                match event {
                    egui::Event::Copy => requests.run(Command::Pose(PoseCommand::Copy)),
                    egui::Event::Paste(text) => {
                        is_given = true;
                        clipboard.text = Some(text.clone());
                        requests.run(Command::Pose(PoseCommand::Paste));
                    }
                    _ => {}
                }
            }
        });
        match clipboard.waits {
            Some(_) if is_given => clipboard.waits = None,
            Some(0) => {
                // The system gave nothing.
                clipboard.waits = None;
                self.paste_own(context, requests);
            }
            Some(left) => {
                clipboard.waits = Some(left - 1);
                context.egui.request_repaint();
            }
            None => {}
        }
    }

    pub(super) fn copy(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let pose = context.shown_pose().clone();
        context.egui.copy_text(pose_file::to_text(&context.document().model, &pose));
        self.clipboard.own = Some(pose);
        requests.status("Copied the pose of this frame, also as text.");
    }

    /// Pastes the text that the system gave, or asks for it.
    pub(super) fn paste(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let Some(text) = self.clipboard.text.take() else {
            context.egui.send_viewport_cmd(egui::ViewportCommand::RequestPaste);
            context.egui.request_repaint();
            self.clipboard.waits = Some(FRAMES_TO_WAIT);
            return;
        };
        let name = Path::new("The clipboard");
        match pose_file::parse(name, text.as_bytes(), &context.document().model, Quaternions::Normalised) {
            Ok(pose) => set_pose(pose, context, requests),
            Err(error) => requests.complain(format!(
                "{error}. Expected the JSON of a pose, as Copy pose makes it. The pose is as it was."
            )),
        }
    }

    fn paste_own(&self, context: &Context<'_>, requests: &mut Requests) {
        match self.clipboard.own.clone() {
            Some(pose) if pose.check(&context.document().model).is_ok() => set_pose(pose, context, requests),
            Some(_) => requests.complain("The copied pose is of another body."),
            None => requests.status("There is no pose on the clipboard."),
        }
    }
}

fn set_pose(pose: Pose, context: &Context<'_>, requests: &mut Requests) {
    requests.edit(Edit::SetPose { frame: context.selection.frame, pose, what: "Paste pose".to_owned() });
    requests.status("Pasted the pose.");
}
