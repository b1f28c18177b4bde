//! Trying again ever more rarely.

/// How many frames are waited at most, in a number and in words.
pub(super) type Rarest = (usize, &'static str);

/// When the visual hull is the last resort of a frame that stays lost: it takes as long as tens of frames.
pub(super) const LAST_RESORT: Rarest = (16, "16 frames at most");
/// When chains that silhouettes speak against are seeded again.
pub(super) const RESEEDING: Rarest = (16, "16 frames at most");
/// When poses that silhouettes confuse with the leading one are tried.
pub(super) const CONFUSION: Rarest = (60, "60 frames at most");

/// When something is tried while it is wanted: at once, and then ever more rarely.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Patience {
    /// Frames to wait.
    pub wait: usize,
    /// How many it was the last time.
    pub waited: usize,
}

impl Patience {
    /// A number that cannot have come of counting, and what can.
    pub(super) fn wrong(self, (rarest, expected): Rarest) -> Option<(f64, &'static str)> {
        if self.waited > rarest {
            return Some((self.waited as f64, expected));
        }
        (self.wait > self.waited).then_some((self.wait as f64, "no more frames than it waited the last time"))
    }

    /// Counts a frame. Where it is not wanted, the wait is forgotten.
    pub(super) fn is_due(&mut self, is_wanted: bool, (rarest, _): Rarest) -> bool {
        if !is_wanted {
            *self = Self::default();
        } else if self.wait == 0 {
            self.waited = (2 * self.waited).clamp(1, rarest);
            self.wait = self.waited;
            return true;
        } else {
            self.wait -= 1;
        }
        false
    }

    /// The same for what is wanted now and then: where it is not wanted, the wait gets shorter by halves.
    pub(super) fn is_due_fading(&mut self, is_wanted: bool, rarest: Rarest) -> bool {
        if is_wanted {
            return self.is_due(true, rarest);
        }
        if self.wait == 0 {
            self.waited /= 2;
        }
        self.wait = self.wait.saturating_sub(1);
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stays_wanted_is_tried_ever_more_rarely() {
        let mut resort = Patience::default();
        assert!(!resort.is_due(false, LAST_RESORT));
        let due: Vec<usize> = (0..60).filter(|_| resort.is_due(true, LAST_RESORT)).collect();
        assert_eq!(due, [0, 2, 5, 10, 19, 36, 53]);
        assert!(!resort.is_due(false, LAST_RESORT));
        assert!(resort.is_due(true, LAST_RESORT));
        let mut fading = Patience::default();
        let due: Vec<usize> = (0..30)
            .filter(|frame| fading.is_due_fading(frame % 2 == 0 || *frame > 20, LAST_RESORT))
            .collect();
        assert_eq!(due, [0, 2, 6, 10, 14, 18, 21, 26]);
        (0..40).for_each(|_| assert!(!fading.is_due_fading(false, LAST_RESORT)));
        assert!(fading.is_due_fading(true, LAST_RESORT), "forgotten");
        let mut sooner = Patience::default();
        let due: Vec<usize> = (0..30).filter(|_| sooner.is_due(true, (8, ""))).collect();
        assert_eq!(due, [0, 2, 5, 10, 19, 28]);
    }
}
