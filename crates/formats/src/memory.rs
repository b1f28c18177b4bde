//! How much memory pictures may need. It is counted from their sizes, before any of them is decoded.

use std::fmt;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use backlit_tracking::camera::Rig;
use thiserror::Error;

use crate::{FileError, FileProblem, Result};

/// Gigabytes that pictures may need unless something else is set.
pub const DEFAULT_GB: f64 = 4.0;
/// Bytes of a gigabyte.
const GIGABYTE: f64 = 1e9;
/// Bytes of a pixel while pictures are read: as it is on the disk, and as colours.
const READ_BYTES: u64 = 8;
/// Bytes of a pixel, once it is reduced, in what is kept: the background, the lens, and the frames that are read ahead.
const KEPT_BYTES: u64 = 90;
/// Bytes of a pixel of a picture that is held with its mask.
const HELD_BYTES: u64 = 5;

static BUDGET: AtomicU64 = AtomicU64::new((DEFAULT_GB * GIGABYTE) as u64);

/// Pictures need more memory than they may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("need about {} of memory; expected at most {}: raise that with --memory", Gigabytes(*.needed), Gigabytes(*.budget))]
pub struct MemoryShort {
    /// Bytes that they need.
    pub needed: u64,
    /// Bytes that they may need.
    pub budget: u64,
}

/// Sets how many gigabytes of 10⁹ bytes pictures may need, from now on.
pub fn set_budget_gb(gigabytes: f64) {
    BUDGET.store((gigabytes * GIGABYTE) as u64, Ordering::Relaxed);
}

/// Bytes that pictures may need.
pub(crate) fn budget() -> u64 {
    BUDGET.load(Ordering::Relaxed)
}

/// Refuses pictures that need more bytes than they may.
pub fn afford(needed: u64) -> Result<(), MemoryShort> {
    let budget = budget();
    if needed <= budget { Ok(()) } else { Err(MemoryShort { needed, budget }) }
}

/// How many pictures of so many pixels may be held at once with their masks: `most`, or fewer where memory is short; at least two.
pub(crate) fn held(pixels: usize, most: usize) -> usize {
    let each = HELD_BYTES * pixels.max(1) as u64;
    usize::try_from(budget() / each).unwrap_or(most).clamp(2, most)
}

/// Refuses a take whose cameras, all together, need more memory than they may.
pub(crate) fn afford_take(path: &Path, full: &Rig, reduced: &Rig) -> Result<()> {
    let pixels = |rig: &Rig| -> u64 {
        rig.cameras().iter().map(|camera| (camera.width() * camera.height()) as u64).sum()
    };
    let cameras = full.count();
    afford(READ_BYTES * pixels(full) + KEPT_BYTES * pixels(reduced))
        .map_err(|error| FileError::new(path, FileProblem::PicturesTooLarge { cameras, error }))
}

/// Bytes in gigabytes, rounded up: what is needed can be given as it is told.
struct Gigabytes(u64);

impl fmt::Display for Gigabytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} GB", (self.0 as f64 / GIGABYTE * 10.0).ceil() / 10.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_needed_is_told_with_the_option_that_allows_it() {
        let short = afford(budget() + 1).unwrap_err();
        assert_eq!(
            short.to_string(),
            "need about 4.1 GB of memory; expected at most 4 GB: raise that with --memory"
        );
        assert_eq!(afford(budget()), Ok(()));
        assert_eq!([held(640 * 480, 120), held(16 << 20, 120), held(1 << 40, 120)], [120, 47, 2]);
    }
}
