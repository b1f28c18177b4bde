//! How well a prediction covers a mask: pixel counts and intersection over union.

use super::mask::{Label, Mask};

/// A pixel is predicted to show the subject below this grey level: half of the ramp from 0 to 255.
const SUBJECT_BELOW: f32 = 127.5;

/// The prediction does not have one value for each pixel of the mask.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the prediction has {found} pixels, the mask {expected}")]
pub struct OverlapError {
    /// Pixels of the mask.
    pub expected: usize,
    /// Pixels of the prediction.
    pub found: usize,
}

/// Pixel counts of a comparison. Unknown pixels of the mask are no part of the ratio; those that the prediction covers are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlap {
    /// Subject in the mask and in the prediction.
    pub agreement: usize,
    /// Subject in the mask only.
    pub missing: usize,
    /// Subject in the prediction only.
    pub spurious: usize,
    /// Subject in the prediction where the mask is unknown.
    pub unknown: usize,
}

impl Overlap {
    /// Compares a mask with predicted grey levels λ (row by row, 0 subject to 255 background).
    ///
    /// # Errors
    /// If the prediction has another number of pixels than the mask.
    pub fn between(mask: &Mask, prediction: &[f32]) -> Result<Self, OverlapError> {
        let expected = mask.labels().len();
        if prediction.len() != expected {
            return Err(OverlapError { expected, found: prediction.len() });
        }
        Ok(Self::of_levels(mask.labels(), prediction))
    }

    /// The counts of labels and grey levels side by side.
    #[inline(always)]
    pub(crate) fn of_levels(labels: &[Label], prediction: &[f32]) -> Self {
        let mut counts = Self::default();
        // Runs that a byte can count: many of them are counted at once.
        const RUN: usize = u8::MAX as usize;
        for (labels, predicted) in labels.chunks(RUN).zip(prediction.chunks(RUN)) {
            let [mut agreement, mut missing, mut spurious, mut unknown] = [0_u8; 4];
            for (&label, predicted) in labels.iter().zip(predicted) {
                let predicted = *predicted < SUBJECT_BELOW;
                agreement += u8::from(label == Label::Subject) & u8::from(predicted);
                missing += u8::from(label == Label::Subject) & u8::from(!predicted);
                spurious += u8::from(label == Label::Background) & u8::from(predicted);
                unknown += u8::from(label == Label::Unknown) & u8::from(predicted);
            }
            counts.agreement += usize::from(agreement);
            counts.missing += usize::from(missing);
            counts.spurious += usize::from(spurious);
            counts.unknown += usize::from(unknown);
        }
        counts
    }

    /// Intersection over union, in [0, 1]; none if neither side shows the subject anywhere.
    pub fn iou(&self) -> Option<f64> {
        let union = self.agreement + self.missing + self.spurious;
        (union > 0).then(|| self.agreement as f64 / union as f64)
    }

    /// The share of the prediction's pixels that [`iou`](Self::iou) leaves out, in [0, 1]; none if it has no pixel.
    pub fn left_out(&self) -> Option<f64> {
        let covered = self.agreement + self.spurious + self.unknown;
        (covered > 0).then(|| self.unknown as f64 / covered as f64)
    }

    /// The counts of both together, as for several cameras of one frame.
    #[must_use]
    pub fn merge(self, other: Self) -> Self {
        Self {
            agreement: self.agreement + other.agreement,
            missing: self.missing + other.missing,
            spurious: self.spurious + other.spurious,
            unknown: self.unknown + other.unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_leaves_unknown_pixels_out_and_says_how_many() {
        let mask = Mask::from_ascii("##.?\n##.?").unwrap();
        let prediction = [0.0, 255.0, 127.0, 0.0, 127.4, 127.5, 255.0, 255.0];
        let overlap = Overlap::between(&mask, &prediction).unwrap();
        assert_eq!(overlap, Overlap { agreement: 2, missing: 2, spurious: 1, unknown: 1 });
        assert_eq!((overlap.iou(), overlap.left_out()), (Some(0.4), Some(0.25)));
        assert_eq!(overlap.merge(overlap), Overlap { agreement: 4, missing: 4, spurious: 2, unknown: 2 });
    }

    #[test]
    fn an_empty_union_has_no_ratio_and_another_size_is_an_error() {
        let mask = Mask::filled(2, 1, Label::Background).unwrap();
        assert_eq!(Overlap::between(&mask, &[255.0, 255.0]).unwrap().iou(), None);
        let wrong = OverlapError { expected: 2, found: 3 };
        assert_eq!(Overlap::between(&mask, &[0.0; 3]), Err(wrong));
    }
}
