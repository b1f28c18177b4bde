//! Where a take comes from.

use std::path::{Path, PathBuf};

use backlit_formats::{Footage, Take};
use serde::{Deserialize, Serialize};

use super::builtin;
use super::demonstration::Demonstration;
use super::motion::{self, is_motion};

/// Where the footage of a document comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TakeSource {
    /// The take that comes with the program.
    BuiltIn,
    /// A simulated take, made again when it is opened.
    Demonstration(Demonstration),
    /// A folder with a `take.toml`, or the file itself, or the recording of a motion, which is a take without footage.
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
        self.open_telling(&mut |_, _| {})
    }

    /// The same. Simulated pictures and motions take their time: `tell` hears how many frames are made, and of how many.
    fn open_telling(&self, tell: &mut dyn FnMut(usize, usize)) -> anyhow::Result<Take> {
        match self {
            Self::BuiltIn => Ok(builtin::open()?),
            Self::Demonstration(which) => which.take(tell),
            Self::Path(path) if is_motion(path) => motion::open(path, tell),
            Self::Path(path) => Ok(Take::open(path)?),
        }
    }

    /// Opens the take with its footage. Simulated pictures take their time: `tell` hears how many are drawn, and of how many.
    pub fn footage(&self, tell: &mut dyn FnMut(usize, usize)) -> anyhow::Result<Footage> {
        let mut footage = Footage::new(self.open_telling(tell)?);
        footage.drawn = self.demonstration().and_then(Demonstration::drawn);
        Ok(footage)
    }

    /// The folder or file, if it is one.
    pub const fn path(&self) -> Option<&PathBuf> {
        if let Self::Path(path) = self { Some(path) } else { None }
    }

    /// Which demonstration this is, if it is one.
    pub const fn demonstration(&self) -> Option<Demonstration> {
        match self {
            Self::Demonstration(which) => Some(*which),
            _ => None,
        }
    }
}
