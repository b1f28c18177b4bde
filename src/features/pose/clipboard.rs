//! Poses to and from the system's clipboard, as the JSON of a pose file: it can be pasted in a text editor and back.

use std::path::Path;

use backlit_formats::pose_file::{self, Quaternions};
use backlit_tracking::body::Pose;

use crate::app::App;
use crate::context::command::{Command, PoseCommand};
use crate::document::edit::Edit;

/// Frames of the window within which the system gives its clipboard, or not.
const FRAMES_TO_WAIT: u8 = 3;

/// What was copied here, and whether the system's clipboard was asked for.
#[derive(Debug, Default)]
pub(crate) struct Clipboard {
    /// The pose that was copied last: what is pasted where the system gives nothing.
    own: Option<Pose>,
    /// Text that the system gave.
    text: Option<String>,
    /// Frames to go on waiting for it.
    waits: Option<u8>,
}

impl App {
    /// Ctrl+C and Ctrl+V as a window's system tells them: not as keys. While text is typed they are the text's.
    pub(crate) fn read_clipboard(&mut self, ctx: &egui::Context) -> Vec<Command> {
        if ctx.text_edit_focused() {
            return Vec::new();
        }
        let mut commands = Vec::new();
        ctx.input(|input| {
            for event in &input.events {
                match event {
                    egui::Event::Copy => commands.push(Command::Pose(PoseCommand::Copy)),
                    egui::Event::Paste(text) => {
                        self.features.pose.clipboard.text = Some(text.clone());
                        commands.push(Command::Pose(PoseCommand::Paste));
                    }
                    _ => {}
                }
            }
        });
        match self.features.pose.clipboard.waits {
            Some(_) if commands.contains(&Command::Pose(PoseCommand::Paste)) => {
                self.features.pose.clipboard.waits = None
            }
            Some(0) => {
                // The system gave nothing.
                self.features.pose.clipboard.waits = None;
                self.paste_own();
            }
            Some(left) => {
                self.features.pose.clipboard.waits = Some(left - 1);
                ctx.request_repaint();
            }
            None => {}
        }
        commands
    }

    pub(crate) fn copy_pose(&mut self, ctx: &egui::Context) {
        let pose = self.shown_pose().clone();
        ctx.copy_text(pose_file::to_text(&self.document().model, &pose));
        self.features.pose.clipboard.own = Some(pose);
        self.state.status = Some("Copied the pose of this frame, also as text.".to_owned());
    }

    /// Pastes the text that the system gave, or asks for it.
    pub(crate) fn paste_pose(&mut self, ctx: &egui::Context) {
        let Some(text) = self.features.pose.clipboard.text.take() else {
            ctx.send_viewport_cmd(egui::ViewportCommand::RequestPaste);
            ctx.request_repaint();
            self.features.pose.clipboard.waits = Some(FRAMES_TO_WAIT);
            return;
        };
        let model = self.document().model.clone();
        let name = Path::new("The clipboard");
        match pose_file::parse(name, text.as_bytes(), &model, Quaternions::Normalised) {
            Ok(pose) => self.paste(pose),
            Err(error) => self.state.notices.error(format!(
                "{error}. Expected the JSON of a pose, as Copy pose makes it. The pose is as it was."
            )),
        }
    }

    fn paste_own(&mut self) {
        match self.features.pose.clipboard.own.clone() {
            Some(pose) if pose.check(&self.document().model).is_ok() => self.paste(pose),
            Some(_) => self.state.notices.error("The copied pose is of another body.".to_owned()),
            None => self.state.status = Some("There is no pose on the clipboard.".to_owned()),
        }
    }

    fn paste(&mut self, pose: Pose) {
        self.interrupt_fit();
        let edit = Edit::SetPose { frame: self.state.selection.frame, pose, what: "Paste pose".to_owned() };
        self.edit(edit, None);
        self.state.status = Some("Pasted the pose.".to_owned());
    }
}
