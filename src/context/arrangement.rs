//! How panes are arranged in the centre: a tree of splits and tabs.

mod automatic;
mod change;
mod kept;
mod snap;

pub(crate) use automatic::{Centre, automatic, has_strip};
pub(crate) use change::{close, is_open, open, panes_with};
pub(crate) use kept::Kept;
pub(crate) use snap::snap;

use crate::context::pane::Pane;

pub(crate) type Arrangement = egui_tiles::Tree<Pane>;
