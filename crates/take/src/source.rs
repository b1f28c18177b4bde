//! Where a take comes from.

use std::path::PathBuf;

use super::demonstration::Demonstration;

/// Where the footage of a document comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TakeSource {
    /// The take that comes with the program.
    BuiltIn,
    /// A simulated take, made anew when it is opened.
    Demonstration(Demonstration),
    /// A folder with a `take.toml`, or the file itself.
    Path(PathBuf),
}
