//! The steps of a segmentation as pictures and in words.

use backlit_tracking::segment::{Segmentation, Stage};
use backlit_tracking::silhouette::{Label, Mask, PixelClass};
use egui::{Color32, ColorImage};

use crate::style::format;

/// A step's name, and what it does.
#[rustfmt::skip]
pub const fn stage_words(stage: Stage) -> (&'static str, &'static str) {
    match stage {
        Stage::Threshold => ("Threshold", "Pixels that differ from the background by more than the z-score"),
        Stage::Hysteresis => ("Hysteresis", "And those that differ by less and touch such pixels"),
        Stage::Region => ("Region", "Pixels outside the region of interest, or where the background is not known, go"),
        Stage::Shadow => ("Shadow", "Pixels that are only darker or brighter than the background go"),
        Stage::Morphology => ("Open, close", "Opening removes specks, closing fills gaps"),
        Stage::Components => ("Components", "Parts that are too small, by themselves or beside the largest, go"),
        Stage::Holes => ("Holes", "Small holes are filled"),
        Stage::Unknown => ("Unknown", "Shadow, and what is as dark as the background, is unknown"),
        Stage::Take => ("Lens, plate", "What the lens does not see is unknown; what a plate or keypoints know is added"),
        Stage::People => ("People", "Pixels of other people than the one who is followed are unknown"),
        Stage::OtherCameras => ("Other cameras", "Subject that no other camera sees is unknown"),
        Stage::Brush => ("By hand", "What was painted"),
    }
}

/// What decided a pixel, by its index: "by hand", "0.4× the threshold".
pub fn decision(steps: &Segmentation, index: usize) -> Option<String> {
    let mask = steps.mask()?;
    let [x, y] = [index % mask.width(), index / mask.width()];
    let class = mask.class(x, y)?;
    let excess = steps.excess.get(index).copied().unwrap_or(0.0);
    let off = || format!("{}× the threshold", format::number(f64::from(excess.min(99.0)), 1));
    Some(match (steps.decided_by(index)?, class) {
        (_, PixelClass::Shadow) => "a shadow".to_owned(),
        (Stage::Threshold, _) => off(),
        (Stage::Morphology, PixelClass::Subject) => "a gap, closed".to_owned(),
        (Stage::Morphology, _) => "a speck, opened".to_owned(),
        (Stage::Components, _) => "too small a part".to_owned(),
        (Stage::Holes, _) => "a hole, filled".to_owned(),
        (Stage::Shadow, _) => "shadow test".to_owned(),
        (Stage::Unknown, _) => "dark before dark".to_owned(),
        (stage, _) => format::uncapitalised(stage_words(stage).0),
    })
}

/// By how much pixels differ from the background: the threshold is in the middle between black and white.
pub fn excess_picture(steps: &Segmentation, [width, height]: [usize; 2]) -> ColorImage {
    let grey = |excess: &f32| Color32::from_gray((127.5 * excess.min(2.0)) as u8);
    ColorImage::new([width, height], steps.excess.iter().map(grey).collect())
}

/// A mask as a picture: white is subject, grey unknown, shadow between.
pub fn mask_picture(mask: &Mask) -> ColorImage {
    let grey = mask.to_gray();
    let pixels = grey.as_raw().iter().map(|level| Color32::from_gray(*level)).collect();
    ColorImage::new([mask.width(), mask.height()], pixels)
}

/// How many pixels a step has made subject, and how many are no subject any more.
pub fn subject_change(before: &Mask, after: &Mask) -> [usize; 2] {
    let both = || before.labels().iter().zip(after.labels());
    let changed = |from: fn(&Label) -> bool| both().filter(|(a, b)| from(a) && from(b) != from(a)).count();
    [changed(|label| *label != Label::Subject), changed(|label| *label == Label::Subject)]
}
