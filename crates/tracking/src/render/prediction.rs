//! Λ as a picture.

use super::kernels::scalar::RowWinners;
use super::ramp::BACKGROUND;
use super::{Ramp, RendererKind, View};
use crate::body::{Kinematics, Model};
use crate::camera::Camera;

/// The owner of a pixel that no limb is near.
pub const NO_OWNER: u16 = u16::MAX;

/// A predicted silhouette with what made each pixel. Row-major, height × width.
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
    /// Distance of the ray to that limb over its radius; infinite for none.
    pub distance_over_radius: Vec<f32>,
    /// Distance along the ray to the limb's closest point, metres; infinite for none.
    pub depth: Vec<f32>,
}

/// Draws the model's soft silhouette in one camera.
#[must_use]
pub fn predict(
    model: &Model,
    kinematics: &Kinematics,
    camera: &Camera,
    renderer: RendererKind,
    ramp: Ramp,
) -> Prediction {
    Prediction::of(&View::new(model, kinematics, camera, renderer, ramp))
}

impl Prediction {
    /// Draws a prepared view.
    #[must_use]
    pub fn of(view: &View) -> Self {
        let (width, height) = (view.width(), view.height());
        let mut out = Self {
            width,
            height,
            lambda: vec![BACKGROUND as f32; width * height],
            owner: vec![NO_OWNER; width * height],
            distance_over_radius: vec![f32::INFINITY; width * height],
            depth: vec![f32::INFINITY; width * height],
        };
        let mut row = RowWinners::default();
        for y in 0..height {
            row.find(view, y, 1, 0);
            for x in row.touched() {
                let Some(winner) = row.winner(x) else { continue };
                let primitive = &view.primitives()[winner];
                let slot = y * width + x;
                out.lambda[slot] = (BACKGROUND * row.level(x).clamp(0.0, 1.0)) as f32;
                out.owner[slot] = primitive.limb as u16;
                if let Some(candidate) = primitive.candidate(view.ray(x, y)) {
                    out.distance_over_radius[slot] = (candidate.squared.sqrt() / primitive.radius) as f32;
                    out.depth[slot] = candidate.depth as f32;
                }
            }
        }
        out
    }
}

/// λ alone, as pictures hold it: for overlaps.
#[must_use]
pub fn lambda(view: &View) -> Vec<f32> {
    levels(view).into_iter().map(|level| level as f32).collect()
}

/// λ alone, in f64: for files that others compare.
#[must_use]
pub fn levels(view: &View) -> Vec<f64> {
    let (width, height) = (view.width(), view.height());
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
