//! Predictions for the screen: Λ with its owners, how strongly each pixel pulls, how it changes along a motion.
//!
//! Where the fit's lanes can take a view they draw it: λ within [`MOST_ERROR`] of the oracle, owners the oracle's,
//! since pixels that f32 cannot decide are decided in f64. Other views (a lens, a limb across the camera's plane)
//! are drawn by the oracle itself. Either way on all threads, and to the bit the same on any number of them.
//!
//! The oracle is [`draw_plainly`]: one pixel and one solid at a time, in f64.

use std::ops::Range;

use rayon::prelude::*;

use super::footprint::Footprint;
use super::jacobian::BodyMotion;
use super::kernels::lanes;
use super::kernels::scalar::RowWinners;
use super::prediction::{NO_OWNER, Prediction};
use super::primitive::Primitive;
use super::ramp::BACKGROUND;
use super::wrench::Wrench;
use super::{Ramp, RendererKind, View};
use crate::body::{Kinematics, Model};
use crate::camera::Camera;
use crate::silhouette::{Label, Mask, MaskError};

/// λ/255 of a drawing is at most this far from the oracle's.
pub const MOST_ERROR: f32 = 1e-4;
/// Rows that a thread takes at once where the oracle draws.
const PLAIN_ROWS: usize = 8;

/// Which pictures are wanted beside λ and its owners.
#[derive(Debug, Clone, Copy, Default)]
pub struct DrawOptions<'a> {
    /// How strongly each pixel pulls.
    pub gradient: bool,
    /// How each pixel changes along this motion.
    pub motion: Option<&'a BodyMotion>,
}

/// One camera's pictures, row-major, height × width.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// λ and its owners.
    pub prediction: Prediction,
    /// |∂λ/∂q| of every pixel, q being the point of the limb that the pixel sees: grey levels a metre, zero where the
    /// ramp is clipped. Empty if it was not wanted.
    pub gradient: Vec<f32>,
    /// J v of every pixel. Empty if it was not wanted.
    pub change: Vec<f32>,
}

/// Draws the model's soft silhouette in one camera.
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
    /// The silhouette: subject where λ is below a half.
    ///
    /// # Errors
    /// If the picture is empty.
    pub fn to_mask(&self) -> Result<Mask, MaskError> {
        let label = |&level: &f32| if level < 127.5 { Label::Subject } else { Label::Background };
        Mask::new(self.width, self.height, self.lambda.iter().map(label).collect())
    }

    /// Draws a prepared view by the reference kernel, in f64. For the screen [`draw`] does the
    /// same many times faster.
    pub fn of(view: &View) -> Self {
        draw_plainly(view, DrawOptions::default()).prediction
    }
}

/// Draws a view as fast as may be.
pub fn draw(view: &View, wanted: DrawOptions<'_>) -> Drawing {
    draw_over(Drawing::default(), view, wanted)
}

/// The same in the memory of an earlier drawing. Where that has the same pictures of the same size, nothing is written
/// but the pixels that either body may touch.
pub fn draw_over(mut earlier: Drawing, view: &View, wanted: DrawOptions<'_>) -> Drawing {
    let stale = earlier.begin(view, wanted);
    if view.suits_lanes() {
        lanes::draw(view, wanted, &mut earlier, &stale);
    } else {
        earlier.draw_plainly(view, wanted, &stale);
    }
    earlier
}

/// Draws a view by the reference kernel.
pub fn draw_plainly(view: &View, wanted: DrawOptions<'_>) -> Drawing {
    let mut drawing = Drawing::default();
    let stale = drawing.begin(view, wanted);
    drawing.draw_plainly(view, wanted, &stale);
    drawing
}

impl Drawing {
    /// Makes pictures of the view's size, if these are not: of zeros, memory that nobody has touched yet, so that threads
    /// share that too. Says which pixels are not background yet.
    fn begin(&mut self, view: &View, wanted: DrawOptions<'_>) -> Footprint {
        let [width, height] = view.size;
        let pixels = width * height;
        let [gradient, change] =
            [wanted.gradient, wanted.motion.is_some()].map(|is_wanted| if is_wanted { pixels } else { 0 });
        let footprint = view.footprint();
        let Prediction { lambda, owner, .. } = &self.prediction;
        let has = [lambda.len(), owner.len(), self.gradient.len(), self.change.len()];
        let is_of_this_size = [self.prediction.width, self.prediction.height] == view.size;
        if is_of_this_size && has == [pixels, pixels, gradient, change] {
            return std::mem::replace(&mut self.prediction.footprint, footprint);
        }
        let (lambda, owner) = (vec![0.0; pixels], vec![0; pixels]);
        let prediction = Prediction { width, height, lambda, owner, footprint };
        *self = Self { prediction, gradient: vec![0.0; gradient], change: vec![0.0; change] };
        Footprint::whole(view.size)
    }

    fn draw_plainly(&mut self, view: &View, wanted: DrawOptions<'_>, stale: &Footprint) {
        let strips = self.strips(PLAIN_ROWS, stale);
        strips.into_par_iter().for_each_init(RowWinners::default, |winners, mut strip| {
            for y in strip.rows() {
                winners.find(view, y, 1, 0);
                strip.clear(y, 0..0);
                for x in winners.touched() {
                    let Some(winner) = winners.winner(x) else { continue };
                    strip.put(view, wanted, (x, y), Some((&view.primitives[winner], winners.level(x))));
                }
            }
        });
    }

    /// All pictures cut into strips of `rows` rows. `stale` are the pixels that are not background yet.
    pub(in crate::render) fn strips<'a>(&'a mut self, rows: usize, stale: &'a Footprint) -> Vec<Strip<'a>> {
        let width = self.prediction.width;
        let entries = rows.max(1) * width;
        if entries == 0 {
            return Vec::new();
        }
        let mut gradients = self.gradient.chunks_mut(entries);
        let mut changes = self.change.chunks_mut(entries);
        let lambdas = self.prediction.lambda.chunks_mut(entries);
        let parts = lambdas.zip(self.prediction.owner.chunks_mut(entries)).enumerate();
        let strip = |(index, (lambda, owner))| {
            let gradient = gradients.next().unwrap_or_default();
            let change = changes.next().unwrap_or_default();
            let pixels = Pixels { lambda, owner, gradient, change };
            Strip { first_row: index * rows, width, stale, pixels }
        };
        parts.map(strip).collect()
    }
}

/// Some rows of all pictures of a drawing.
#[derive(Debug)]
pub(in crate::render) struct Strip<'a> {
    first_row: usize,
    width: usize,
    stale: &'a Footprint,
    pixels: Pixels<'a>,
}

/// Pixels of all pictures; those that are not wanted are empty.
#[derive(Debug)]
pub(in crate::render) struct Pixels<'a> {
    pub(in crate::render) lambda: &'a mut [f32],
    pub(in crate::render) owner: &'a mut [u16],
    pub(in crate::render) gradient: &'a mut [f32],
    pub(in crate::render) change: &'a mut [f32],
}

impl Strip<'_> {
    /// Its rows in the picture.
    pub(in crate::render) fn rows(&self) -> Range<usize> {
        self.first_row..self.first_row + self.pixels.lambda.len() / self.width
    }

    /// One row.
    #[inline(always)]
    pub(in crate::render) fn row(&mut self, y: usize) -> Pixels<'_> {
        let start = (y - self.first_row) * self.width;
        let row = start..start + self.width;
        let Pixels { lambda, owner, gradient, change } = &mut self.pixels;
        Pixels {
            lambda: &mut lambda[row.clone()],
            owner: &mut owner[row.clone()],
            gradient: gradient.get_mut(row.clone()).unwrap_or_default(),
            change: change.get_mut(row).unwrap_or_default(),
        }
    }

    /// Paints background where a row is not yet, but for these columns.
    #[inline(always)]
    pub(in crate::render) fn clear(&mut self, y: usize, but: Range<usize>) {
        let Range { start: from, end: to } = self.stale.columns(y);
        if from == to {
            return;
        }
        let row = self.row(y);
        for outside in [from..to.min(but.start), from.max(but.end)..to] {
            row.lambda.get_mut(outside.clone()).unwrap_or_default().fill(BACKGROUND as f32);
            row.owner.get_mut(outside.clone()).unwrap_or_default().fill(NO_OWNER);
            row.gradient.get_mut(outside.clone()).unwrap_or_default().fill(0.0);
            row.change.get_mut(outside).unwrap_or_default().fill(0.0);
        }
    }

    /// Paints one pixel as the oracle does.
    #[inline(never)]
    pub(in crate::render) fn put_exactly(
        &mut self,
        view: &View,
        wanted: DrawOptions<'_>,
        x: usize,
        y: usize,
    ) {
        self.put(view, wanted, (x, y), view.winner(x, y));
    }

    /// Paints one pixel that a solid has won at this λ/255.
    fn put(
        &mut self,
        view: &View,
        wanted: DrawOptions<'_>,
        (x, y): (usize, usize),
        winner: Option<(&Primitive, f64)>,
    ) {
        let row = self.row(y);
        let level = winner.map_or(1.0, |(_, level)| level);
        row.lambda[x] = (BACKGROUND * level.clamp(0.0, 1.0)) as f32;
        row.owner[x] = winner.map_or(NO_OWNER, |(primitive, _)| primitive.limb as u16);
        if row.gradient.is_empty() && row.change.is_empty() {
            return;
        }
        let wrench = winner.and_then(|(primitive, _)| {
            primitive.sample(view.ray(x, y)).wrench.map(|wrench| (primitive.limb, wrench))
        });
        let value = |of: &dyn Fn(usize, Wrench) -> f64| wrench.map_or(0.0, |(limb, wrench)| of(limb, wrench));
        if let Some(target) = row.gradient.get_mut(x) {
            *target = value(&|_, wrench| wrench.force.length()) as f32;
        }
        if let (Some(target), Some(motion)) = (row.change.get_mut(x), wanted.motion) {
            *target = value(&|limb, wrench| motion.change(limb, wrench)) as f32;
        }
    }
}
