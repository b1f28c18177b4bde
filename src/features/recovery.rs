//! Copies of unsaved work, for the next start.
//!
//! | file | holds |
//! |---|---|
//! | `copies` | [`Copies`]: the files, who may write which, and which are offered |
//! | `about` | [`About`]: what is written beside a copy |
//! | `left` | [`Left`]: a copy that a window has left, in words |
//! | `picture` | [`Picture`]: what a camera showed, small |

mod about;
mod copies;
mod left;
pub(crate) mod panel;
mod picture;
pub(crate) mod unsaved;

pub use about::About;
pub use copies::Copies;
pub use left::Left;
pub use picture::Picture;
