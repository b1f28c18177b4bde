//! The steps of a segmentation, each with the mask that it leaves (the report's Fig. 4.9).

use image::RgbImage;

use super::background::Background;
use super::bit_image::BitImage;
use super::options::SegmentOptions;
use super::subtraction::{SegmentError, labels_of, run};
use crate::silhouette::{Label, Mask};

/// A step of the segmentation, in the order in which they are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// Which pixels differ from the background by more than the threshold.
    Threshold,
    /// Which differ by less and touch those.
    Hysteresis,
    /// Which lie in the region of interest, where the background is known.
    Region,
    /// Which are no shadow.
    Shadow,
    /// Opening takes specks out, closing fills gaps.
    Morphology,
    /// Components and groups of components that are too small go.
    Components,
    /// Holes are filled.
    Holes,
    /// What cannot be told is unknown: shadow, dark before dark, where neither background nor subject is known.
    Unknown,
    /// What is known of the take beside its pictures: the lens, pixels that are always subject, keypoints.
    Take,
    /// Other people are unknown.
    People,
    /// Subject that no other camera supports is unknown.
    OtherCameras,
    /// What was painted by hand.
    Brush,
}

/// A step and the mask after it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageMask {
    /// The step.
    pub stage: Stage,
    /// What it leaves.
    pub mask: Mask,
}

/// How a silhouette came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Segmentation {
    /// By how many thresholds each pixel differs from the background, row by row: above 1 is foreground.
    pub excess: Vec<f32>,
    /// The steps that were taken, in order; never empty.
    pub stages: Vec<StageMask>,
}

impl Segmentation {
    /// The step that gave a pixel the label that it has in the end.
    pub fn decided_by(&self, index: usize) -> Option<Stage> {
        let label = |at: usize| self.stages[at].mask.labels().get(index);
        let last = (1..self.stages.len()).rev().find(|&at| label(at) != label(at - 1));
        self.stages.get(last.unwrap_or(0)).map(|decisive| decisive.stage)
    }

    /// The mask after the last step.
    pub fn mask(&self) -> Option<&Mask> {
        self.stages.last().map(|last| &last.mask)
    }

    /// Adds a step that left this mask, if it changed anything.
    pub fn push(&mut self, stage: Stage, mask: &Mask) {
        if self.mask() != Some(mask) {
            self.stages.push(StageMask { stage, mask: mask.clone() });
        }
    }
}

/// The same as [`segment`](super::segment), and how it comes about: the last step leaves that mask.
///
/// # Errors
/// Those of [`segment`](super::segment).
pub fn segment_by_stages(
    frame: &RgbImage,
    background: &Background,
    options: &SegmentOptions,
) -> Result<Segmentation, SegmentError> {
    let (mut stages, mut excess) = (Vec::new(), Vec::new());
    let mask = run(frame, background, options, &mut |step| match step {
        Step::Compared(found) => excess = found(),
        Step::Subject(stage, subject) => {
            if let Ok(mask) = labels_of(subject, Label::Subject) {
                stages.push(StageMask { stage, mask });
            }
        }
    })?;
    stages.push(StageMask { stage: Stage::Unknown, mask });
    Ok(Segmentation { excess, stages })
}

/// What the segmentation tells while it runs.
pub(super) enum Step<'a> {
    /// By how many thresholds pixels differ, if that is asked for.
    Compared(&'a dyn Fn() -> Vec<f32>),
    /// Which pixels are subject after a step.
    Subject(Stage, &'a BitImage),
}

#[cfg(test)]
mod tests {
    use image::Rgb;
    use proptest::prelude::*;

    use super::*;
    use crate::segment::{ChromaOptions, segment};

    /// A wall with a subject that has a hole, a speck beside it, and a shadow.
    fn frame() -> (RgbImage, Background) {
        let wall = Rgb([120, 130, 110]);
        let plate = RgbImage::from_pixel(40, 30, wall);
        let mut frame = plate.clone();
        for (x, y, pixel) in frame.enumerate_pixels_mut() {
            let is_subject = (5..17).contains(&x) && (5..25).contains(&y) && (x, y) != (10, 12);
            if is_subject || (x, y) == (35, 3) {
                *pixel = Rgb([200, 60, 60]);
            } else if (25..35).contains(&x) && (10..20).contains(&y) {
                *pixel = Rgb(wall.0.map(|level| (f32::from(level) * 0.75).round() as u8));
            }
        }
        (frame, Background::from_plate(&plate))
    }

    #[test]
    fn each_pixel_knows_the_step_that_decided_it() {
        let (frame, background) = frame();
        let options = SegmentOptions { closing_px: 0, hysteresis_z: Some(3.0), ..SegmentOptions::default() };
        let found = segment_by_stages(&frame, &background, &options).unwrap();
        assert_eq!(found.stages.last().unwrap().mask, segment(&frame, &background, &options).unwrap());
        let at = |x: usize, y: usize| found.decided_by(y * 40 + x);
        assert_eq!(at(7, 10), Some(Stage::Threshold), "subject");
        assert_eq!(at(0, 0), Some(Stage::Threshold), "background");
        assert_eq!(at(35, 3), Some(Stage::Morphology), "a speck");
        assert_eq!(at(10, 12), Some(Stage::Holes), "a hole");
        assert_eq!(at(30, 15), Some(Stage::Unknown), "a shadow");
        assert!(found.excess[10 * 40 + 7] > 2.0 && found.excess[0] == 0.0);
    }

    proptest! {
        /// The pixels that exceed their threshold are those of the first step, however they are compared.
        #[test]
        fn excess_is_what_the_threshold_decides(
            levels in proptest::collection::vec(0..=255_u8, 3 * 48),
            means in proptest::collection::vec(0..=255_u8, 3 * 48),
            (grey, apart) in (any::<bool>(), any::<bool>()),
        ) {
            let picture = |levels: Vec<u8>| RgbImage::from_raw(8, 6, levels).unwrap();
            let chroma = apart.then(ChromaOptions::default);
            let options = SegmentOptions { grey, chroma, ..SegmentOptions::default() };
            let background = Background::from_plate(&picture(means));
            let found = segment_by_stages(&picture(levels), &background, &options).unwrap();
            for (label, excess) in found.stages[0].mask.labels().iter().zip(&found.excess) {
                prop_assert!((excess - 1.0).abs() < 1e-4 || (*label == Label::Subject) == (*excess > 1.0));
            }
        }
    }
}
