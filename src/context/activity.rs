//! What is going on while the window is looked at.

use std::time::Instant;

use crate::session::playback::FrameRange;

/// Which kinds of work are under way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "kinds of work are independent of each other")]
pub(crate) struct Activity {
    /// A take is being opened.
    pub(crate) opening: bool,
    /// How much is done of what takes its time, where that can be told.
    pub(crate) share: Option<WorkShare>,
    /// The frame is being read and segmented.
    pub(crate) loading: bool,
    /// Whether reading the frame on the screen broke down.
    pub(crate) load_broke: bool,
    pub(crate) fitting: bool,
    /// The number of its run.
    pub(crate) fitted_run: Option<usize>,
    /// The tracker is running, or other poses or the body's own sizes are looked for in its place.
    pub(crate) tracking: bool,
    /// How far the tracker is.
    pub(crate) track: Option<TrackingProgress>,
    /// A basin is being tried.
    pub(crate) basin: bool,
    /// Pictures of an export that are done, and all of them.
    pub(crate) exporting: Option<(usize, usize)>,
}

impl Activity {
    /// Whether a bar under the toolbar says that something takes its time.
    pub(crate) fn is_long(self) -> bool {
        self.opening || self.fitting || self.tracking
    }
}

/// How much of some work is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct WorkShare {
    pub(crate) done: usize,
    pub(crate) total: usize,
}

impl WorkShare {
    /// From 0 to 1.
    pub(crate) fn value(self) -> f32 {
        self.done as f32 / self.total.max(1) as f32
    }
}

/// How far the tracker is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TrackingProgress {
    /// Frames done.
    pub(crate) done: usize,
    /// Frames to do in all.
    pub(crate) total: usize,
    /// Whether it goes towards the first frame.
    pub(crate) backwards: bool,
    /// The key poses between which it goes both ways, if it does.
    pub(crate) between: Option<(usize, usize)>,
    /// The frames that are tracked.
    pub(crate) range: FrameRange,
    pub(crate) began: Instant,
    /// Frames that were looked at for backgrounds that change, of how many, while that goes on.
    pub(crate) surveyed: Option<[usize; 2]>,
}

impl TrackingProgress {
    /// The frames that are still to come, as long as there are any. Between key poses every frame comes twice.
    pub(crate) fn frames_to_come(&self) -> Option<FrameRange> {
        let FrameRange { first, last } = self.range;
        if self.done >= self.total {
            return None;
        }
        let count = self.range.count();
        let (done, backwards) = match self.between {
            None => (self.done, self.backwards),
            Some(_) => (self.done % count, self.done >= count),
        };
        let range = FrameRange { first, last };
        Some(if backwards {
            FrameRange { last: last.saturating_sub(done).max(first), ..range }
        } else {
            FrameRange { first: (first + done).min(last), ..range }
        })
    }

    /// Frames a second so far, once there is something to tell.
    pub(crate) fn rate(&self) -> Option<f64> {
        let seconds = self.began.elapsed().as_secs_f64();
        (self.done > 2 && seconds > 0.0).then(|| self.done as f64 / seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_still_come_from_the_side_to_which_the_tracker_goes() {
        let tracking = |done: usize, backwards: bool, between: Option<(usize, usize)>| TrackingProgress {
            done,
            total: if between.is_some() { 12 } else { 6 },
            backwards,
            between,
            range: FrameRange { first: 4, last: 9 },
            began: Instant::now(),
            surveyed: None,
        };
        let to_come = |tracking: TrackingProgress| {
            tracking.frames_to_come().map(|FrameRange { first, last }| (first, last))
        };
        assert_eq!(to_come(tracking(0, false, None)), Some((4, 9)));
        assert_eq!(to_come(tracking(2, false, None)), Some((6, 9)));
        assert_eq!(to_come(tracking(2, true, None)), Some((4, 7)));
        assert_eq!(to_come(tracking(6, true, None)), None);
        assert_eq!(to_come(tracking(5, false, Some((4, 9)))), Some((9, 9)));
        assert_eq!(to_come(tracking(7, false, Some((4, 9)))), Some((4, 8)), "and from the other side");
    }
}
