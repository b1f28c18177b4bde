//! A motion as classifiers see it: windows of two seconds, and short windows that follow each other.

use crate::features::{Channels, Normalised, window_measures};
use crate::joints::{JointMotion, MotionError};

/// A window, frames at [`crate::features::RATE`]: two seconds, so that what comes before and after a
/// punch is seen too.
pub const WINDOW: usize = 60;
/// A short window.
pub const SHORT: usize = 18;
/// Frames from one short window to the next.
pub const STEP: usize = 3;
/// Frames from one window to the next, where a motion is learnt from or counted.
pub const HOP: usize = 10;

/// What is measured of a motion.
#[derive(Debug, Clone)]
pub struct Observed {
    channels: Channels,
    normalised: Normalised,
    /// Measures of the short windows, one every [`STEP`] frames.
    pub short: Vec<Vec<f64>>,
    /// Frames at [`crate::features::RATE`].
    pub length: usize,
}

impl Observed {
    /// Measures a motion.
    ///
    /// # Errors
    /// The joints do not lie as a person's.
    pub fn new(motion: &JointMotion) -> Result<Self, MotionError> {
        let normalised = Normalised::new(motion)?;
        let channels = Channels::new(&normalised);
        let length = normalised.joints.len();
        let steps = length.saturating_sub(SHORT) / STEP + 1;
        let short = |step: usize| window_measures(&channels, step * STEP, (step * STEP + SHORT).min(length));
        Ok(Self { short: (0..steps).map(short).collect(), channels, normalised, length })
    }

    /// Measures of the window that begins at a frame; a motion shorter than that is measured whole.
    #[must_use]
    pub fn window(&self, first: usize) -> Vec<f64> {
        let first = first.min(self.length.saturating_sub(WINDOW));
        window_measures(&self.channels, first, (first + WINDOW).min(self.length))
    }

    /// Where windows begin that cover the motion, about [`HOP`] frames apart.
    #[must_use]
    pub fn window_starts(&self) -> Vec<usize> {
        let Some(room) = self.length.checked_sub(WINDOW).filter(|room| *room > 0) else { return vec![0] };
        let gaps = room.div_ceil(HOP);
        (0..=gaps).map(|index| (index * room + gaps / 2) / gaps).collect()
    }

    /// The short windows that lie within the window that begins at a frame.
    #[must_use]
    pub fn short_within(&self, first: usize) -> std::ops::Range<usize> {
        let from = first.div_ceil(STEP).min(self.short.len() - 1);
        let past = (first + WINDOW - SHORT) / STEP + 1;
        from..past.clamp(from + 1, self.short.len().max(from + 1))
    }

    /// Where the window begins in whose middle a short window lies.
    #[must_use]
    pub fn window_about(&self, step: usize) -> usize {
        (step * STEP + SHORT / 2).saturating_sub(WINDOW / 2)
    }

    /// The short window in whose middle a frame lies, or the nearest.
    #[must_use]
    pub fn step_of(&self, frame: usize) -> usize {
        ((frame + STEP / 2).saturating_sub(SHORT / 2) / STEP).min(self.short.len() - 1)
    }

    /// The numbers of every frame, for principal components.
    #[must_use]
    pub fn frames(&self) -> Vec<Vec<f64>> {
        self.normalised.frame_features()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::walker;

    #[test]
    fn windows_cover_a_motion_and_stay_within() {
        for frames in [12, 18, 44, 59, 60, 61, 74, 130] {
            let motion = walker(f64::from(frames) / 30.0, 1.0);
            let seen = Observed::new(&motion).unwrap();
            assert_eq!(seen.length, frames as usize);
            let starts = seen.window_starts();
            let last = seen.length.saturating_sub(WINDOW);
            assert_eq!((starts[0], starts[starts.len() - 1]), (0, last), "{frames}");
            assert!(starts.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] <= HOP));
            for start in starts {
                let short = seen.short_within(start);
                assert!(!short.is_empty() && short.end <= seen.short.len(), "{frames}: {short:?}");
                assert!(seen.window(start).iter().all(|x| x.is_finite()));
            }
            for frame in 0..seen.length {
                assert!(seen.step_of(frame) < seen.short.len());
            }
        }
    }
}
