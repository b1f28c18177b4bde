//! A track as a page to send: one HTML file that a browser shows without any network.
//!
//! [`Page`] holds what is shown, [`to_html`] writes it. Bodies are vectors: joints and radii, drawn by the page's own script
//! into every camera's view and into a scene, so ten thousand frames stay a few megabytes. Pictures are embedded for some frames only.
//!
//! | file | holds |
//! |---|---|
//! | `page` | what is shown |
//! | `html` | the page's parts that need no script: headings, tables, lists |
//! | `wire` | the numbers, as the script reads them |
//! | `packing` | joints quantised, base64 |
//! | `escape` | names that users chose, made harmless |
//! | `outline` | silhouettes as paths |
//! | `rrd` | a recording of the Rerun viewer instead, in programs with the feature of that name |
//! | `../assets` | the page's form, style and script |
//!
//! Nothing in the page is loaded from anywhere: a policy in its head forbids it.

mod escape;
mod html;
pub mod outline;
mod packing;
mod page;
#[cfg(feature = "rrd")]
mod rrd;
mod wire;

pub use html::to_html;
pub use page::{
    Bookmark, Cell, CommandLine, Curve, DoubtedLimb, FitStep, FitSteps, Frame, Page, PageCamera, PageLimb,
    Picture, Table,
};
#[cfg(feature = "rrd")]
pub use rrd::{RrdError, to_rrd};

#[cfg(test)]
mod tests;
