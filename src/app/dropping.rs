//! Files that are dragged over the window and dropped on it.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_formats::footage::replacement::{masks_of, read_calibration};
use backlit_formats::pose_file::Quaternions;
use backlit_formats::{Footage, model_file, pose_file};
use backlit_jobs::once;
use backlit_take::dropped::Dropped;
use backlit_tracking::body::Model;
use backlit_ui::style::format::file_name;

use super::Inspector;
use super::files::Files;
use super::open_job::Opening;
use crate::context::command::{Command, HistoryCommand};

impl Files {
    /// Looks what is dragged over the window, and takes what is dropped.
    pub(crate) fn take_dropped(&mut self, inspector: &mut Inspector, ctx: &egui::Context) {
        let (hovered, dropped): (Vec<PathBuf>, Vec<PathBuf>) = ctx.input(|input| {
            let hovered = input.raw.hovered_files.iter().filter_map(|file| file.path.clone());
            let dropped = input.raw.dropped_files.iter().map(|file| file.path().to_owned());
            (hovered.collect(), dropped.collect())
        });
        let hovering = &mut inspector.shell.hovering;
        if hovered.is_empty() {
            *hovering = None;
        } else if hovering.as_ref().is_none_or(|(paths, _)| *paths != hovered) {
            let what = Dropped::of(&hovered);
            *hovering = Some((hovered, what));
        }
        if dropped.is_empty() {
            return;
        }
        // Whatever lay over the window was about something else.
        inspector.shell.overlay = None;
        match Dropped::of(&dropped) {
            Dropped::Open(path) => self.open(inspector, Opening::of(&path)),
            Dropped::New(paths) => inspector.new_take(paths),
            Dropped::Unknown(path, why) => {
                inspector.state.notices.error(format!("{}: {why}.", path.display()));
            }
            dropped => {
                let Some(footage) = inspector.state.session.take.clone() else {
                    let (_, name) = dropped.explanation(0);
                    return inspector.state.notices.error(format!("{name}: open a take first."));
                };
                let (model, frame) = (inspector.document().model.clone(), inspector.state.selection.frame);
                let read = move |_: &_| read(&dropped, &footage, &model, frame);
                self.dropped.begin(&inspector.state.pool, (), |()| once(read));
            }
        }
    }

    /// What was dropped is read: it becomes a change that can be undone.
    pub(super) fn take_in_dropped(&mut self, inspector: &mut Inspector) {
        for read in inspector.state.notices.outputs("Reading the dropped files", &mut self.dropped) {
            let (edit, said) = match read {
                Ok(read) => read,
                Err(error) => {
                    inspector.state.notices.error(format!("{error:#}"));
                    continue;
                }
            };
            inspector.interrupt_fit();
            let state = &mut inspector.state;
            let revision = state.history.revision();
            state.edit(edit, None);
            let was_refused = |text: &str| text.starts_with("That cannot be done");
            if state.history.revision() != revision {
                state.notices.info(said, Some(Command::History(HistoryCommand::Undo)));
            } else if !state.notices.cards().any(|notice| was_refused(&notice.text)) {
                state.notices.info("Nothing changed: that is what is there already.", None);
            }
        }
    }
}

/// Reads dropped files: the change of the document, and what is said of it.
fn read(dropped: &Dropped, footage: &Footage, model: &Model, frame: usize) -> anyhow::Result<(Edit, String)> {
    Ok(match dropped {
        Dropped::Calibration(path) => {
            let calibration = read_calibration(path, footage.original().full_rig().cameras())?;
            let said = format!("The {} cameras now come from {}.", calibration.rig.count(), file_name(path));
            (Edit::SetCalibration(Some(Arc::new(calibration))), said)
        }
        Dropped::Masks(paths) => {
            let masks = masks_of(paths, footage.original().rig().cameras())?;
            let numbers: Vec<String> = masks.keys().map(|camera| (camera + 1).to_string()).collect();
            let plural = if numbers.len() == 1 { "" } else { "s" };
            let said = format!(
                "Replaced the silhouettes of frame {frame} in camera{plural} {}.",
                numbers.join(", ")
            );
            (Edit::SetMasks { frame, masks }, said)
        }
        Dropped::Pose(path) => {
            let pose = pose_file::read(path, model, Quaternions::Normalised)?;
            let said = format!("Frame {frame} now has the pose of {}.", file_name(path));
            (Edit::SetPose { frame, pose, what: "Drop pose".to_owned() }, said)
        }
        Dropped::Body(path) => {
            let model = model_file::read(path)?;
            let said = format!("The body now has the sizes of {}.", file_name(path));
            (Edit::SetBody(Arc::new(model)), said)
        }
        Dropped::New(_) | Dropped::Open(_) | Dropped::Unknown(..) => {
            anyhow::bail!("{}: it has nothing that can be used here", dropped.explanation(frame).1)
        }
    })
}
