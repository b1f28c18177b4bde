//! Noticing that a track was lost: by overlap, and by a cost that is not the track's usual one.
//!
//! Overlap of the whole body is blind for one limb: a forearm in the wrong place costs a few hundredths of the IoU. Its
//! pixels are missing in one place and spurious in another, though, so that the mean squared residual, which changes by a
//! few per cent from frame to frame, rises by half.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::render::Ramp;
use crate::silhouette::Overlap;
use crate::statistics::upper_median;

/// A frame counts as lost below this overlap of model and silhouettes (IoU).
pub const LOST_BELOW_IOU: f64 = 0.4;

/// A frame counts as lost above this multiple of the track's usual RMS. Set on the balancing footage, where frames that were fitted
/// well stay below 1.14, with two cameras and with every sixth frame alone too; `lab/thresholds.rs` looks at other takes.
pub const LOST_ABOVE_RMS_RATIO: f64 = 1.35;

/// And only if it rose by this many grey levels: clean simulations leave hardly any, and twice that is no loss.
const LEAST_RISE: f64 = 4.0;

/// The usual RMS is the median of this many frames.
const REMEMBERED: usize = 10;

/// One of fewer cameras cannot be blamed.
const FEWEST_CAMERAS: usize = 3;

/// A camera is to blame for what is wrong if it has this many times its share of it.
const BLAMED_FROM: f64 = 1.6;

/// With fewer frames nothing is usual.
const FEWEST: usize = 3;

/// Why a frame counts as lost.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "reason", rename_all = "kebab-case")]
pub enum Lost {
    /// No camera sees anybody.
    Nobody,
    /// No start was given, and the silhouettes do not meet in space: none could be found.
    NoStart,
    /// The fit's numbers ran out of range, so that its pose says nothing.
    Numbers,
    /// The fit went farther away than the silhouettes allow. The pose is where the motion led.
    OutOfScene,
    /// Hardly any overlap of model and silhouettes.
    Overlap {
        /// IoU of all cameras together.
        iou: f64,
    },
    /// The residual is not the track's usual one: a limb is elsewhere, or something else is in the silhouette.
    Cost {
        /// RMS over the usual one.
        ratio: f64,
    },
}

/// The RMS of the last frames that were fitted well.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct UsualCost {
    /// Oldest first, ten at most, grey levels.
    pub last: VecDeque<f64>,
    /// Frames in a row whose cost was too high.
    pub too_high: usize,
    /// The ramp that these were measured by; `None` where nobody said.
    pub ramp: Option<Ramp>,
}

impl UsualCost {
    /// The same for costs by a ramp. Costs by another one are no measure: a person who comes nearer may be fitted by other stages.
    pub(super) fn by(&self, ramp: Ramp) -> Self {
        let known = if self.ramp.is_none_or(|own| own == ramp) { self.clone() } else { Self::default() };
        Self { ramp: Some(ramp), ..known }
    }

    /// A number that cannot have been remembered, and what can.
    pub(super) fn wrong(&self) -> Option<(f64, &'static str)> {
        let (count, too_high) = (self.last.len(), self.too_high);
        if count > REMEMBERED {
            return Some((count as f64, "ten numbers at most"));
        }
        if too_high >= REMEMBERED {
            return Some((too_high as f64, "fewer than ten frames too high"));
        }
        let wrong = self.last.iter().find(|rms| !(rms.is_finite() && **rms >= 0.0));
        wrong.map(|&rms| (rms, "a finite number, 0 or more"))
    }

    /// How a fitted frame is lost, if it is. `overlaps` are those of the cameras: where one picture alone is to blame for a cost, the body is
    /// not lost.
    pub(super) fn judge(&self, rms: f64, iou: Option<f64>, overlaps: &[Option<Overlap>]) -> Option<Lost> {
        match iou {
            _ if !rms.is_finite() => Some(Lost::Numbers),
            Some(iou) if iou < LOST_BELOW_IOU => Some(Lost::Overlap { iou }),
            _ => {
                let usual = self.usual()?;
                let ratio = rms / usual;
                if ratio * of_others(overlaps) <= LOST_ABOVE_RMS_RATIO {
                    return None;
                }
                (ratio > LOST_ABOVE_RMS_RATIO && rms - usual > LEAST_RISE).then_some(Lost::Cost { ratio })
            }
        }
    }

    /// Remembers a frame as it was judged. A cost that stays high becomes the usual one: the scene has changed.
    pub(super) fn remember(&mut self, rms: f64, lost: Option<Lost>) {
        match lost {
            None => self.too_high = 0,
            Some(Lost::Cost { .. }) if self.too_high + 1 >= REMEMBERED => {
                *self = Self { ramp: self.ramp, ..Self::default() }
            }
            Some(Lost::Cost { .. }) => {
                self.too_high += 1;
                return;
            }
            Some(_) => return,
        }
        if self.last.len() == REMEMBERED {
            self.last.pop_front();
        }
        self.last.push_back(rms);
    }

    /// The median.
    fn usual(&self) -> Option<f64> {
        if self.last.len() < FEWEST {
            return None;
        }
        let mut sorted: Vec<f64> = self.last.iter().copied().collect();
        upper_median(&mut sorted).filter(|&usual| usual > 0.0)
    }
}

/// By which factor the RMS changes without the camera that disagrees most; 1 unless that camera has much more than its share, and there
/// are two others at least. Pixels that are wrong stand for squared residuals.
fn of_others(overlaps: &[Option<Overlap>]) -> f64 {
    let wrong: Vec<f64> =
        overlaps.iter().flatten().map(|overlap| (overlap.missing + overlap.spurious) as f64).collect();
    let (count, all) = (wrong.len() as f64, wrong.iter().sum::<f64>());
    let worst = wrong.iter().fold(0.0_f64, |worst, wrong| worst.max(*wrong)) / all;
    let is_blamed = wrong.len() >= FEWEST_CAMERAS && worst * count > BLAMED_FROM;
    if is_blamed { ((1.0 - worst) * count / (count - 1.0)).sqrt() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_whose_numbers_ran_out_of_range_is_lost_however_it_overlaps() {
        let mut usual = UsualCost::default();
        for rms in [f64::INFINITY, f64::NAN] {
            assert_eq!(usual.judge(rms, Some(0.95), &[]), Some(Lost::Numbers));
            assert_eq!(usual.judge(rms, None, &[]), Some(Lost::Numbers));
            usual.remember(rms, Some(Lost::Numbers));
        }
        // Nothing is learnt from it.
        (0..FEWEST).for_each(|_| usual.remember(10.0, None));
        assert_eq!(usual.usual(), Some(10.0));
    }

    #[test]
    fn a_cost_by_another_ramp_is_no_measure() {
        let mut usual = UsualCost::default().by(Ramp::Half);
        (0..FEWEST).for_each(|_| usual.remember(10.0, None));
        assert!(matches!(usual.by(Ramp::Half).judge(30.0, None, &[]), Some(Lost::Cost { .. })));
        assert_eq!(usual.by(Ramp::Thesis).judge(30.0, None, &[]), None);
    }

    #[test]
    fn a_cost_that_jumps_is_lost_and_one_that_stays_is_usual() {
        let mut usual = UsualCost::default();
        assert_eq!(usual.judge(100.0, Some(0.9), &[]), None, "nothing is usual yet");
        for frame in 0..20 {
            let rms = 20.0 + 0.3 * f64::from(frame);
            assert_eq!(usual.judge(rms, Some(0.9), &[]), None, "frame {frame}");
            usual.remember(rms, None);
        }
        assert!(matches!(usual.judge(36.0, Some(0.8), &[]), Some(Lost::Cost { ratio }) if ratio > 1.4));
        assert_eq!(usual.judge(36.0, Some(0.1), &[]), Some(Lost::Overlap { iou: 0.1 }));
        let mut lost = 0;
        for _ in 0..30 {
            let found = usual.judge(36.0, Some(0.8), &[]);
            lost += usize::from(found.is_some());
            usual.remember(36.0, found);
        }
        assert_eq!(lost, REMEMBERED);
    }

    /// A patch over one of four pictures is no loss; a limb that is elsewhere is wrong in several.
    #[test]
    fn one_picture_alone_is_no_loss() {
        let mut usual = UsualCost::default();
        (0..FEWEST).for_each(|_| usual.remember(20.0, None));
        let wrong = |pixels: &[usize]| -> Vec<Option<Overlap>> {
            let of = |&missing| Some(Overlap { agreement: 2000, missing, ..Overlap::default() });
            pixels.iter().map(of).collect()
        };
        assert_eq!(usual.judge(40.0, Some(0.8), &wrong(&[2000, 200, 200, 200])), None);
        assert!(usual.judge(40.0, Some(0.8), &wrong(&[700, 700, 200, 200])).is_some());
        // The others disagree as well, and of two nobody knows which.
        assert!(usual.judge(80.0, Some(0.8), &wrong(&[2000, 600, 600, 600])).is_some());
        assert!(usual.judge(40.0, Some(0.8), &wrong(&[2000, 200])).is_some());
        assert!(usual.judge(40.0, Some(0.8), &wrong(&[0, 0, 0])).is_some());
    }

    #[test]
    fn a_perfect_fit_is_no_measure() {
        let mut usual = UsualCost::default();
        (0..5).for_each(|_| usual.remember(0.0, None));
        assert_eq!(usual.judge(3.0, None, &[]), None);
    }
}
