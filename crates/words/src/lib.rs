//! Numbers and names as Backlit writes them, on the screen and on the command line: [`mod@format`], the form of every
//! number; [`joint`], what people call a joint.

pub mod format;
pub mod joint;
