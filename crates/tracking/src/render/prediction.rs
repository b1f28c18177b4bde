//! Λ as a picture.

use pulp::{Simd, WithSimd};

use super::View;
use super::drawing;
use super::footprint::Footprint;
use super::kernels::lanes::Lanes;
use super::kernels::scalar::RowWinners;
use super::primitive::{Primitive, SolidShape};
use super::ramp::BACKGROUND;
use crate::processor;
use crate::silhouette::{Label, Mask, Overlap, OverlapError};

/// The owner of a pixel that no limb is near.
pub const NO_OWNER: u16 = u16::MAX;

/// A predicted silhouette with what made each pixel. Row-major, height × width. What a single pixel sees of its limb
/// is asked of its [`View`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// λ: 0 subject … 255 background.
    pub lambda: Vec<f32>,
    /// Index of the limb that wins the pixel, or [`NO_OWNER`].
    pub owner: Vec<u16>,
    /// Pixels outside of it are background.
    pub footprint: Footprint,
}

/// λ alone, as pictures hold it: for overlaps.
pub fn lambda(view: &View) -> Vec<f32> {
    levels(view).into_iter().map(|level| level as f32).collect()
}

/// λ/255 of the lanes this near to a half is looked at again in f64. Their error is a hundredth of it.
const DOUBT: f32 = 2e-3;

/// The same for a drawing.
const DRAWN_DOUBT: f32 = 2.0 * drawing::MOST_ERROR;

/// Which pixels the model covers: where λ of the view is below a half.
pub fn covered(view: &View) -> Vec<bool> {
    let mut covered = vec![false; view.size[0] * view.size[1]];
    visit_covered(view, |pixel| covered[pixel] = true);
    covered
}

/// How the pixels that the model covers overlap with a mask.
///
/// # Errors
/// If the mask has another size than the view.
pub fn overlap(view: &View, mask: &Mask) -> Result<Overlap, OverlapError> {
    let (labels, pixels) = (mask.labels(), view.size[0] * view.size[1]);
    if labels.len() != pixels {
        return Err(OverlapError { expected: labels.len(), found: pixels });
    }
    let mut counts = Overlap::default();
    visit_covered(view, |pixel| match labels[pixel] {
        Label::Subject => counts.agreement += 1,
        Label::Background => counts.spurious += 1,
        Label::Unknown => counts.unknown += 1,
    });
    Ok(Overlap { missing: mask.count(Label::Subject) - counts.agreement, ..counts })
}

/// The same, counted in a drawing of the view instead of rendering it again; `None` where the drawing cannot tell: where
/// a solid's ramp is not half grey at its surface, or a cylinder has flat caps. `subject` is the number of the mask's
/// subject pixels, which is the same for all poses.
///
/// # Errors
/// If the mask or the drawing has another size than the view.
pub fn overlap_of_drawing(
    view: &View,
    drawn: &Prediction,
    mask: &Mask,
    subject: usize,
) -> Result<Option<Overlap>, OverlapError> {
    let (labels, pixels) = (mask.labels(), view.size[0] * view.size[1]);
    if let Some(&expected) = [labels.len(), drawn.lambda.len()].iter().find(|&&other| other != pixels) {
        return Err(OverlapError { expected, found: pixels });
    }
    let can_tell =
        |solid: &Primitive| solid.solid.shape != SolidShape::Cylinder && solid.is_half_grey_at_surface();
    Ok(view.primitives.iter().all(can_tell).then(|| {
        let counts = processor::run(CountInDrawing { view, drawn, labels });
        Overlap { missing: subject.saturating_sub(counts.agreement), ..counts }
    }))
}

/// Counts the pixels of a drawing's footprint.
struct CountInDrawing<'a> {
    view: &'a View,
    drawn: &'a Prediction,
    labels: &'a [Label],
}

impl WithSimd for CountInDrawing<'_> {
    type Output = Overlap;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Overlap {
        let (half, doubt) = (BACKGROUND as f32 / 2.0, DRAWN_DOUBT * BACKGROUND as f32);
        let is_doubtful = |level: f32| (level - half).abs() < doubt;
        let (mut counts, mut levels) = (Overlap::default(), Vec::new());
        for y in self.drawn.footprint.rows() {
            let columns = self.drawn.footprint.columns(y);
            let start = y * self.view.size[0];
            let row = start + columns.start..start + columns.end;
            levels.clear();
            levels.extend_from_slice(&self.drawn.lambda[row.clone()]);
            if levels.iter().fold(false, |any, &level| any | is_doubtful(level)) {
                for (x, level) in columns.zip(&mut levels).filter(|(_, level)| is_doubtful(**level)) {
                    *level = if is_dark(self.view, x, y) { 0.0 } else { BACKGROUND as f32 };
                }
            }
            counts = counts.merge(Overlap::of_levels(&self.labels[row], &levels));
        }
        counts
    }
}

/// Whether some solid makes a pixel darker than half, in f64.
fn is_dark(view: &View, x: usize, y: usize) -> bool {
    let ray = view.ray(x, y);
    let mut near = view.primitives.iter().filter(|primitive| primitive.bounds.contains(x, y));
    near.any(|primitive| primitive.ramp.unclipped(primitive.squared(ray)) < 0.5)
}

/// Calls `visit` with every pixel that the model covers, row by row.
///
/// The pixels of [`lambda`], but found by the fast kernel where that can: pixels about which f32 might be wrong are
/// decided by the plain one.
fn visit_covered(view: &View, mut visit: impl FnMut(usize)) {
    let [width, height] = view.size;
    // On the rim of a flat cap λ jumps, and f32 may jump elsewhere.
    let has_caps = view.primitives.iter().any(|primitive| primitive.solid.shape == SolidShape::Cylinder);
    if has_caps || !view.suits_lanes() {
        let mut row = RowWinners::default();
        for y in 0..height {
            row.find(view, y, 1, 0);
            row.touched().filter(|&x| row.level(x) < 0.5).for_each(|x| visit(y * width + x));
        }
        return;
    }
    Lanes::default().visit(view, |y, from, levels| {
        for (x, &level) in (from..).zip(levels) {
            let is_doubtful = (level - 0.5).abs() < DOUBT;
            if (is_doubtful && is_dark(view, x, y)) || (!is_doubtful && level < 0.5) {
                visit(y * width + x);
            }
        }
    });
}

/// λ alone, in f64: for files that others compare.
pub fn levels(view: &View) -> Vec<f64> {
    let [width, height] = view.size;
    let mut levels = vec![BACKGROUND; width * height];
    let mut row = RowWinners::default();
    for y in 0..height {
        row.find(view, y, 1, 0);
        for x in row.touched() {
            levels[y * width + x] = BACKGROUND * row.level(x).clamp(0.0, 1.0);
        }
    }
    levels
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::body::{Kinematics, Parameters, builtin};
    use crate::camera::Distortion;
    use crate::fixtures;
    use crate::render::{DrawOptions, Ramp, RendererKind, draw};

    /// All renderers, from far and from within the body, with and without a lens.
    #[test]
    fn covered_pixels_are_those_darker_than_half() {
        let model = builtin::upper_body();
        let k1 = Distortion::OpenCv { k1: -0.2, k2: 0.05, p1: 0.0, p2: 0.0, k3: 0.0 };
        let mut seen = 0;
        for (seed, distance) in [(0, 3.0), (1, 2.0), (2, 0.9), (3, 0.3), (4, 0.05)] {
            let step = |i: usize| 0.6 * ((seed * 7 + i * 3) as f64).sin();
            let pose = fixtures::stepped(&model, Parameters::Tangent, step);
            let kinematics = Kinematics::new(&model, &pose);
            for lens in [Distortion::None, k1] {
                let at = pose.root + DVec3::new(0.1, 0.2, distance);
                let intrinsics = [90.0, 85.0, 31.0, 40.0];
                let camera = fixtures::lens_camera(lens, [64, 80], intrinsics, at, pose.root, DVec3::NEG_Y);
                let three = RendererKind::SphereTree { spheres: Some(3) };
                for kind in RendererKind::ALL.map(|kind| if kind == three.plain() { three } else { kind }) {
                    let view = View::new(&model, &kinematics, &camera, kind, Ramp::Half);
                    let expected: Vec<bool> =
                        levels(&view).into_iter().map(|level| level < BACKGROUND / 2.0).collect();
                    seen += expected.iter().filter(|&&is_covered| is_covered).count();
                    assert!(covered(&view) == expected, "{kind} from {distance} m, {lens:?}");
                    let labels = [Label::Background, Label::Subject, Label::Unknown];
                    let label = |pixel: usize| labels[(seed + pixel / 7) % 3];
                    let mask = Mask::new(64, 80, (0..64 * 80).map(label).collect()).unwrap();
                    let expected = Overlap::between(&mask, &lambda(&view));
                    assert_eq!(overlap(&view, &mask), expected);
                    for ramp in SOFT {
                        let soft = View::new(&model, &kinematics, &camera, kind, ramp);
                        let drawn = draw(&soft, DrawOptions::default()).prediction;
                        let counted = overlap_of_drawing(&soft, &drawn, &mask, mask.count(Label::Subject));
                        let can_tell = kind != RendererKind::Cylinder && ramp != Ramp::Thesis;
                        let expected = expected.clone().map(|overlap| can_tell.then_some(overlap));
                        assert_eq!(counted, expected, "{kind} from {distance} m, {lens:?}, {ramp}");
                    }
                }
            }
        }
        assert!(seen > 10_000, "{seen}");
    }

    const SOFT: [Ramp; 4] =
        [Ramp::Half, Ramp::Width { px: 2.0 }, Ramp::Distance { inner_px: 0.5, outer_px: 0.5 }, Ramp::Thesis];
}
