//! Λ as a picture.

use super::View;
use super::footprint::Footprint;
use super::kernels::lanes::Lanes;
use super::kernels::scalar::RowWinners;
use super::primitive::SolidShape;
use super::ramp::BACKGROUND;
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
    let is_dark = |x: usize, y: usize| {
        let ray = view.ray(x, y);
        let mut near = view.primitives.iter().filter(|primitive| primitive.bounds.contains(x, y));
        near.any(|primitive| primitive.ramp.unclipped(primitive.squared(ray)) < 0.5)
    };
    Lanes::default().visit(view, |y, from, levels| {
        for (x, &level) in (from..).zip(levels) {
            let is_doubtful = (level - 0.5).abs() < DOUBT;
            if (is_doubtful && is_dark(x, y)) || (!is_doubtful && level < 0.5) {
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
    use crate::render::{Ramp, RendererKind};

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
                    assert_eq!(overlap(&view, &mask), Overlap::between(&mask, &lambda(&view)));
                }
            }
        }
        assert!(seen > 10_000, "{seen}");
    }
}
