//! Pictures for other people: what of the window is painted, how large, and the files it goes to. Who paints is the app's
//! business.
//!
//! | file | holds |
//! |---|---|
//! | `choices` | [`ExportChoices`]: what the card and the command line choose, kept from start to start |
//! | `dialog` | the card on which an export is put together |
//! | `order` | what is to be exported, and what paints it |
//! | `update` | asked for, begun, stopped, told |
//! | `job` | painting and writing, one picture a step |
//! | `motion`, `motion_card` | poses for other programs, BVH, TRC, C3D, glTF and others, and the card on which that is chosen |
//! | `series` | numbered PNGs, an animated PNG or a GIF from one picture after another |

pub(crate) mod choices;
mod dialog;
mod job;
mod motion;
mod motion_card;
mod order;
pub(crate) mod series;
#[cfg(test)]
mod tests;
mod update;

pub use choices::{ExportChoices, MotionChoices, Part, SeriesFormat};
pub(crate) use job::ExportJob;
pub(crate) use order::{ExportOrder, Painter, PictureOf, Shot, Subject};
pub(crate) use series::{ExportError, SeriesOptions, SeriesWriter};

use std::path::PathBuf;

use backlit_jobs::Task;

use crate::context::file_dialog::FileDialogs;
use crate::context::priority;

/// The feature.
#[derive(Debug)]
pub(crate) struct Export {
    /// What was chosen last, kept from start to start.
    pub(crate) preferences: ExportChoices,
    /// The card, while it lies over the window.
    card: Option<Card>,
    order: Option<ExportOrder>,
    running: Option<Running>,
    /// Folder of the last export.
    folder: Option<PathBuf>,
    task: Task<(), job::Exported>,
    dialogs: FileDialogs<()>,
}

/// A card over the window.
#[derive(Debug)]
enum Card {
    Pictures(Box<dialog::ExportDialog>),
    Motion(Box<motion_card::MotionCard>),
}

/// An export that is under way.
#[derive(Debug)]
struct Running {
    path: PathBuf,
    done: usize,
    total: usize,
    /// How it ends, once that is known.
    outcome: job::Exported,
}

impl Default for Export {
    fn default() -> Self {
        Self {
            preferences: ExportChoices::default(),
            card: None,
            order: None,
            running: None,
            folder: None,
            task: Task::new(priority::EXPORT),
            dialogs: FileDialogs::default(),
        }
    }
}

impl Export {
    /// How far an export is: pictures done, and in all.
    pub(crate) fn progress(&self) -> Option<(usize, usize)> {
        self.running.as_ref().map(|running| (running.done, running.total))
    }
}
