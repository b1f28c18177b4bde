//! Why a command cannot be used now.
//!
//! Each feature says it of its own commands; here is what is left. The app asks once a frame, before anything is shown, so
//! that whoever shows a command need not know which feature does it.

use super::Context;
use super::command::{Command, FileCommand, HistoryCommand, WindowCommand};
use super::preferences::Layout;

/// A sentence without its full stop; `None` if nothing stands in the way.
pub(crate) type Why = Option<&'static str>;

/// The commands that cannot be used in this frame of the window, each with why.
pub(crate) type Unavailable = Vec<(Command, &'static str)>;

/// Why a command that is shown cannot be used now, in a sentence without its full stop; `None` if it can.
pub(crate) fn unavailable(command: Command, context: &Context<'_>) -> Option<&'static str> {
    context.unavailable.iter().find(|(other, _)| *other == command).map(|(_, why)| *why)
}

/// The same for the commands that are no feature's: files, undo, the window.
pub(crate) fn window(command: Command, context: &Context<'_>) -> Why {
    match command {
        Command::File(FileCommand::FindTake) => {
            because(!context.lacks_take, "No project is missing its take")
        }
        Command::File(FileCommand::Save | FileCommand::SaveAs) => no_take(context),
        Command::History(HistoryCommand::Undo) => {
            because(!context.history.can_undo(), "There is nothing to undo")
        }
        Command::History(HistoryCommand::Redo) => {
            because(context.history.redo_text().is_none(), "There is nothing to redo")
        }
        Command::Window(WindowCommand::TogglePane(_) | WindowCommand::ArrangeTiles) => no_tiles(context),
        Command::Window(WindowCommand::NormalSize) => {
            because(context.egui.zoom_factor() == 1.0, "The window has its usual size")
        }
        Command::Window(WindowCommand::RestoreLayout) => {
            because(!context.can_restore_layout, "The layout was not reset")
        }
        _ => None,
    }
}

pub(crate) fn because(is_so: bool, why: &'static str) -> Why {
    is_so.then_some(why)
}

pub(crate) fn no_take(context: &Context<'_>) -> Why {
    because(context.session.take.is_none(), "Open a take first")
}

fn no_tiles(context: &Context<'_>) -> Why {
    no_take(context)
        .or(because(context.preferences.layout == Layout::Demonstrate, "This layout has no tiles"))
}

/// Where no camera that counts has a silhouette of this frame: what to do about it.
pub(crate) fn no_silhouette(context: &Context<'_>) -> Why {
    let frame = context.session.frames.get(context.selection.frame)?;
    let mut cameras = context.document().used_cameras().filter_map(|camera| frame.cameras.get(camera));
    because(
        cameras.all(|camera| camera.mask.is_none()),
        "No camera that counts has a silhouette of this frame: drop masks on the window, or name background \
         pictures in take.toml",
    )
}

pub(crate) fn no_fit(context: &Context<'_>) -> Why {
    let is_read = context.session.frames.get(context.selection.frame).is_some();
    no_camera(context).or(because(!is_read, "This frame is still being read")).or(no_body_fit(context))
}

/// Why no body can be fitted to several frames, which are read for that.
pub(crate) fn no_body_fit(context: &Context<'_>) -> Why {
    no_camera(context).or(no_silhouette(context)).or(because(context.busy.tracking, "The tracker is running"))
}

fn no_camera(context: &Context<'_>) -> Why {
    let is_none = context.document().used_cameras().next().is_none();
    no_take(context).or(because(is_none, "No camera is used in the fit: tick one beside its view"))
}

pub(crate) fn not_tracked(context: &Context<'_>) -> Why {
    because(context.document().estimates.is_empty(), "No frame is tracked yet")
}
