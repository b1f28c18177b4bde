//! The basin of the frame on the screen: how far off a start may be, and still end where it should.
//!
//! The experiment itself is the lab's (`backlit_lab::experiment::{frame_basin, basin_map}`), the same that
//! `backlit experiment basin` runs. Here is what the window adds: settings as they are typed, results as they
//! arrive, and files of both.
//!
//! | file | holds |
//! |---|---|
//! | [`settings`] | [`BasinSettings`]: what is typed and chosen, and the options that follow |
//! | [`look`] | [`BasinLook`]: the settings and what is shown, kept from start to start |
//! | [`state`] | [`BasinState`]: what runs, and what came of it |
//! | [`request`] | [`BasinRequest`]: what the panels ask for |
//! | [`export`] | results as CSV, JSON and pictures |

pub mod export;
pub(crate) mod job;
pub mod look;
pub(crate) mod panel;
pub mod request;
pub mod settings;
pub mod state;
pub(crate) mod update;

pub use look::{BasinLook, BasinView, MapColour};
pub use request::{BasinRequest, FileKind};
pub use settings::{BasinSettings, Compared, ComparedWay, MapDirection, Reference};
pub use state::{About, AnglesResult, BasinState, FitCount, MapResult, Running};
