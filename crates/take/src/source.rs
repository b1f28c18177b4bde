//! Where a take comes from.

use std::path::{Path, PathBuf};

use backlit_formats::{Footage, Take};
use serde::{Deserialize, Serialize};

use super::builtin;
use super::demonstration::Demonstration;

/// Where the footage of a document comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TakeSource {
    /// The take that comes with the program.
    BuiltIn,
    /// A simulated take, made again when it is opened.
    Demonstration(Demonstration),
    /// A folder with a `take.toml`, or the file itself.
    Path(PathBuf),
}

impl TakeSource {
    /// As a project names it that lies here: a path that does not begin at the root is looked for beside the project first.
    #[must_use]
    pub fn named_by(self, project: &Path) -> Self {
        match self {
            Self::Path(take) if take.is_relative() => {
                let beside = project.parent().unwrap_or(Path::new("")).join(&take);
                Self::Path(if beside.exists() { beside } else { take })
            }
            source => source,
        }
    }

    /// Opens the take.
    pub fn open(&self) -> anyhow::Result<Take> {
        match self {
            Self::BuiltIn => Ok(builtin::open()?),
            Self::Demonstration(which) => which.take(&mut |_, _| {}),
            Self::Path(path) => Ok(Take::open(path)?),
        }
    }

    /// Opens the take with its footage. Simulated pictures take their time: `tell` hears how many are drawn, and of how many.
    pub fn footage(&self, tell: &mut dyn FnMut(usize, usize)) -> anyhow::Result<Footage> {
        let take = match self {
            Self::Demonstration(which) => which.take(tell)?,
            _ => self.open()?,
        };
        let mut footage = Footage::new(take);
        footage.drawn = self.demonstration().and_then(Demonstration::drawn);
        Ok(footage)
    }

    /// Which demonstration this is, if it is one.
    pub const fn demonstration(&self) -> Option<Demonstration> {
        match self {
            Self::Demonstration(which) => Some(*which),
            _ => None,
        }
    }
}
