//! A quick drawing of a body on coarse grids, for sifting thousands of candidates before any is fitted.
//!
//! Every camera's picture is reduced until the thinnest limb is about a pixel thick. A limb is a flat segment
//! of two radii there, its grey level linear in the pixel's distance from it; the data have the same ramp by
//! the mask's distance field. What a limb would change in the cost is summed over its own box alone, so a
//! candidate costs well under a microsecond.

use glam::{DMat3, DQuat, DVec2, DVec3};
use pulp::{Arch, Simd, WithSimd};

use crate::body::{Model, Pose};
use crate::fit::{Evidence, FitView};
use crate::geometry::rotation::raw_matrix;
use crate::render::BACKGROUND;
use crate::silhouette::{Label, SignedDistance};

/// Widths of the sketch's ramp inside and outside a limb's surface, coarse pixels. The outer one forgives
/// directions that are tried only every n degrees.
const INNER_PX: f32 = 1.0;
const OUTER_PX: f32 = 2.5;
/// Widest inner half of the ramp, as a fraction of the radius.
const WIDEST_INNER: f32 = 0.9;
/// Limbs nearer to the camera plane than this (metres) are not drawn.
const NEAREST: f64 = 0.05;

/// Pixels at a time.
const LANES: usize = 8;
/// Points along a limb that the first sieve looks at.
const SIEVE_POINTS: usize = 4;

/// Where all limbs are, without derivatives.
#[derive(Debug, Clone)]
pub(super) struct LimbPositions {
    pub(super) starts: Vec<DVec3>,
    pub(super) ends: Vec<DVec3>,
    world: Vec<DMat3>,
}

impl LimbPositions {
    pub(super) fn new(model: &Model, pose: &Pose) -> Self {
        let limbs = model.limbs().len();
        let mut this = Self {
            starts: vec![pose.root; limbs],
            ends: vec![pose.root; limbs],
            world: vec![DMat3::IDENTITY; model.rotation_count()],
        };
        for &rotation in model.rotations_parents_first() {
            this.turn(model, rotation, pose.rotations[rotation]);
        }
        for index in 0..limbs {
            this.place(model, index, pose.root);
        }
        this
    }

    fn turn(&mut self, model: &Model, rotation: usize, q: DQuat) {
        let parent = model.rotation_parents()[rotation].map_or(DMat3::IDENTITY, |parent| self.world[parent]);
        self.world[rotation] = parent * raw_matrix(q);
    }

    fn place(&mut self, model: &Model, limb: usize, root: DVec3) {
        let part = &model.limbs()[limb];
        self.starts[limb] = part.parent.map_or(root, |parent| self.ends[parent]);
        self.ends[limb] = self.starts[limb] + self.world[part.rotation] * (part.direction * part.length);
    }

    /// Turns one rotation and moves the limbs that follow it directly.
    pub(super) fn set(&mut self, model: &Model, group: &[usize], rotation: usize, q: DQuat, root: DVec3) {
        self.turn(model, rotation, q);
        for &limb in group {
            self.place(model, limb, root);
        }
    }
}

/// One camera's coarse data.
#[derive(Debug, Clone)]
struct SketchView {
    width: usize,
    height: usize,
    /// Row length in memory, padded by a whole lane.
    pitch: usize,
    rotation: DMat3,
    translation: DVec3,
    focal: DVec2,
    centre: DVec2,
    /// D, 0 subject to 1 background, and weights.
    data: Vec<f32>,
    weights: Vec<f32>,
}

/// All cameras' coarse data.
#[derive(Debug, Clone)]
pub(super) struct Sketch {
    views: Vec<SketchView>,
    radii: Vec<f64>,
    arch: Arch,
}

/// Λ of the limbs drawn so far in all cameras, one after the other.
pub(super) type Canvas = Vec<f32>;

/// What drawing a limb changes: where it hides what it should not, and where it covers what it should.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CostChange {
    pub(super) spill: f32,
    pub(super) gain: f32,
}

impl Sketch {
    /// Reduces every picture. `pose` tells how large the body appears.
    pub(super) fn new(
        model: &Model,
        views: &[FitView],
        distances: &[Option<SignedDistance>],
        pose: &Pose,
    ) -> Self {
        let stride = Self::stride(model, views, pose);
        let views = views
            .iter()
            .zip(distances)
            .map(|(view, distance)| SketchView::new(view, distance.as_ref(), stride))
            .collect();
        Self { views, radii: model.limbs().iter().map(|limb| limb.radius).collect(), arch: Arch::new() }
    }

    /// Full pixels to a coarse one, so that the thinnest limb is about one thick in the smallest picture.
    fn stride(model: &Model, views: &[FitView], pose: &Pose) -> usize {
        let thinnest = model.limbs().iter().map(|limb| limb.radius).fold(f64::INFINITY, f64::min);
        let sizes = views.iter().map(|view| {
            let depth = view.camera.depth(pose.root).max(NEAREST);
            thinnest * view.camera.intrinsics().mean_focal_px() / depth
        });
        sizes.fold(f64::INFINITY, f64::min).clamp(1.0, 64.0).floor() as usize
    }

    /// How far the distance field must be exact, pixels.
    pub(super) fn reach_px(model: &Model, views: &[FitView], pose: &Pose) -> f64 {
        f64::from(OUTER_PX + 1.0) * Self::stride(model, views, pose) as f64
    }

    /// Nobody drawn yet.
    pub(super) fn blank(&self) -> Canvas {
        vec![1.0; self.views.iter().map(|view| view.data.len()).sum()]
    }

    /// Draws a limb.
    pub(super) fn draw(&self, canvas: &mut Canvas, skeleton: &LimbPositions, limb: usize) {
        let mut from = 0;
        for view in &self.views {
            let pixels = &mut canvas[from..from + view.data.len()];
            from += view.data.len();
            let Some(segment) = view.segment(skeleton, limb, self.radii[limb]) else { continue };
            self.arch.dispatch(LimbDrawing { pitch: view.pitch, pixels, segment: &segment });
        }
    }

    /// What drawing a limb would change.
    pub(super) fn change(&self, canvas: &Canvas, skeleton: &LimbPositions, limb: usize) -> CostChange {
        let mut change = CostChange::default();
        let mut from = 0;
        for view in &self.views {
            let pixels = &canvas[from..from + view.data.len()];
            from += view.data.len();
            let Some(segment) = view.segment(skeleton, limb, self.radii[limb]) else { continue };
            let by = self.arch.dispatch(LimbChange { view, pixels, segment: &segment });
            change.spill += by.spill;
            change.gain += by.gain;
        }
        change
    }

    /// Mean of D at points along a limb's axis: a first sieve of directions.
    pub(super) fn misses(&self, skeleton: &LimbPositions, limb: usize) -> f32 {
        let (start, end) = (skeleton.starts[limb], skeleton.ends[limb]);
        let mut sum = 0.0;
        for view in &self.views {
            for k in 1..=SIEVE_POINTS {
                sum += view.level_at(start.lerp(end, k as f64 / SIEVE_POINTS as f64));
            }
        }
        sum
    }

    /// Cost of a canvas.
    pub(super) fn cost(&self, canvas: &Canvas) -> f32 {
        let mut from = 0;
        let mut cost = 0.0;
        for view in &self.views {
            let pixels = &canvas[from..from + view.data.len()];
            from += view.data.len();
            for ((data, weight), pixel) in view.data.iter().zip(&view.weights).zip(pixels) {
                cost += weight * (data - pixel).powi(2);
            }
        }
        cost
    }
}

#[inline(always)]
fn lanes(from: &[f32]) -> &[f32; LANES] {
    match from.first_chunk() {
        Some(lanes) => lanes,
        None => &[0.0; LANES],
    }
}

/// A limb in one picture.
struct ProjectedLimb {
    from: [f32; 2],
    along: [f32; 2],
    inverse: f32,
    radius: f32,
    widening: f32,
    reach: f32,
    columns: (usize, usize),
    rows: (usize, usize),
}

impl ProjectedLimb {
    /// Columns of a row within reach of the limb.
    #[inline]
    fn columns(&self, y: usize) -> (usize, usize) {
        // The strip about the endless axis, cut by the box.
        let [ax, ay] = self.along;
        if ay.abs() < 1e-3 {
            return self.columns;
        }
        let middle = self.from[0] + (y as f32 - self.from[1]) * ax / ay;
        let half = self.reach / (ay.abs() * self.inverse.sqrt());
        let low = ((middle - half).ceil() as usize).clamp(self.columns.0, self.columns.1);
        let high = ((middle + half + 1.0) as usize).clamp(low, self.columns.1);
        (low, high)
    }

    #[inline(always)]
    fn level(&self, x: f32, y: f32) -> f32 {
        let (dx, dy) = (x - self.from[0], y - self.from[1]);
        let t = ((dx * self.along[0] + dy * self.along[1]) * self.inverse).clamp(0.0, 1.0);
        let (ex, ey) = (dx - t * self.along[0], dy - t * self.along[1]);
        let radius = self.radius + t * self.widening;
        let inner = INNER_PX.min(WIDEST_INNER * radius);
        (((ex * ex + ey * ey).sqrt() - radius + inner) / (inner + OUTER_PX)).clamp(0.0, 1.0)
    }
}

/// What one limb changes in a picture, in the processor's widest vectors: a closure is not made part of what is compiled for them.
struct LimbChange<'a> {
    view: &'a SketchView,
    pixels: &'a [f32],
    segment: &'a ProjectedLimb,
}

impl WithSimd for LimbChange<'_> {
    type Output = CostChange;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> CostChange {
        self.view.change(self.pixels, self.segment)
    }
}

/// A limb drawn into a picture, in the same vectors.
struct LimbDrawing<'a> {
    pitch: usize,
    pixels: &'a mut [f32],
    segment: &'a ProjectedLimb,
}

impl WithSimd for LimbDrawing<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { pitch, pixels, segment } = self;
        for y in segment.rows.0..segment.rows.1 {
            let (x0, x1) = segment.columns(y);
            let row = y * pitch;
            for (x, pixel) in (x0..x1).zip(&mut pixels[row + x0..row + x1]) {
                *pixel = pixel.min(segment.level(x as f32, y as f32));
            }
        }
    }
}

impl SketchView {
    /// What one limb changes here.
    #[inline(always)]
    fn change(&self, pixels: &[f32], segment: &ProjectedLimb) -> CostChange {
        let (mut spill, mut gain) = ([0.0_f32; LANES], [0.0_f32; LANES]);
        for y in segment.rows.0..segment.rows.1 {
            let (x0, x1) = segment.columns(y);
            // Whole lanes: pixels past the limb's reach change nothing, and the data are padded.
            let mut x = x0;
            while x < x1 {
                let at = y * self.pitch + x;
                let old: &[f32; LANES] = lanes(&pixels[at..]);
                let data: &[f32; LANES] = lanes(&self.data[at..]);
                let weights: &[f32; LANES] = lanes(&self.weights[at..]);
                for k in 0..LANES {
                    let new = old[k].min(segment.level((x + k) as f32, y as f32));
                    let by = weights[k] * (new - old[k]) * (new + old[k] - 2.0 * data[k]);
                    spill[k] += by.max(0.0);
                    gain[k] += by.min(0.0);
                }
                x += LANES;
            }
        }
        CostChange { spill: spill.iter().sum(), gain: gain.iter().sum() }
    }

    /// D at a point; what lies outside the picture is neither.
    fn level_at(&self, point: DVec3) -> f32 {
        let p = self.rotation * point + self.translation;
        if p.z < NEAREST {
            return 0.5;
        }
        let pixel = self.centre + self.focal * p.truncate() / p.z + 0.5;
        let inside = pixel.x >= 0.0 && pixel.y >= 0.0;
        let (x, y) = (pixel.x as usize, pixel.y as usize);
        if inside && x < self.width && y < self.height { self.data[y * self.pitch + x] } else { 0.5 }
    }

    fn new(view: &FitView, distance: Option<&SignedDistance>, stride: usize) -> Self {
        let camera = &view.camera;
        let (full_width, full_height) = (camera.width(), camera.height());
        let (width, height) = (full_width.div_ceil(stride), full_height.div_ceil(stride));
        let middle = (stride as f64 - 1.0) / 2.0;
        let pinhole = camera.intrinsics();
        let scale = stride as f64;
        let pitch = width + LANES;
        let mut data = Vec::with_capacity(pitch * height + LANES);
        let mut weights = Vec::with_capacity(pitch * height + LANES);
        for y in 0..height {
            for x in 0..width {
                let at = (y * stride + stride / 2).min(full_height - 1) * full_width
                    + (x * stride + stride / 2).min(full_width - 1);
                let (value, weight) = match (&view.evidence, distance) {
                    (Evidence::Measurement(grey), _) => {
                        (grey.values()[at] / BACKGROUND as f32, grey.weights()[at])
                    }
                    (Evidence::Mask(mask), Some(distance)) => {
                        // As the fit's data: the middle and the certainty of what unknown pixels leave open.
                        let level = |sd: f32| (sd / stride as f32 + INNER_PX) / (INNER_PX + OUTER_PX);
                        let [least, most] = distance.range(at).map(|sd| level(sd).clamp(0.0, 1.0));
                        let known = f32::from(mask.labels()[at] != Label::Unknown);
                        (0.5 * (least + most), known * (1.0 - (most - least).powi(2)))
                    }
                    (Evidence::Mask(mask), None) => {
                        let label = mask.labels()[at];
                        (f32::from(label != Label::Subject), f32::from(label != Label::Unknown))
                    }
                };
                data.push(value);
                weights.push(weight * view.weight as f32);
            }
            data.resize((y + 1) * pitch, 1.0);
            weights.resize((y + 1) * pitch, 0.0);
        }
        let place = camera.camera_from_world();
        Self {
            width,
            height,
            pitch,
            rotation: place.rotation,
            translation: place.translation,
            focal: DVec2::new(pinhole.fx, pinhole.fy) / scale,
            centre: (DVec2::new(pinhole.cx, pinhole.cy) - middle) / scale,
            data,
            weights,
        }
    }

    fn segment(&self, skeleton: &LimbPositions, limb: usize, radius: f64) -> Option<ProjectedLimb> {
        let p0 = self.rotation * skeleton.starts[limb] + self.translation;
        let p1 = self.rotation * skeleton.ends[limb] + self.translation;
        if p0.z < NEAREST || p1.z < NEAREST {
            return None;
        }
        let a = self.centre + self.focal * p0.truncate() / p0.z;
        let b = self.centre + self.focal * p1.truncate() / p1.z;
        let (r0, r1) = (radius * self.focal.x / p0.z, radius * self.focal.x / p1.z);
        let reach = r0.max(r1) + f64::from(OUTER_PX);
        let (low, high) = (a.min(b) - reach, a.max(b) + reach);
        // Casts of floats saturate: what is left of or above the picture is 0.
        let columns = (low.x.ceil() as usize, ((high.x + 1.0) as usize).min(self.width));
        let rows = (low.y.ceil() as usize, ((high.y + 1.0) as usize).min(self.height));
        if columns.0 >= columns.1 || rows.0 >= rows.1 {
            return None;
        }
        let along = b - a;
        Some(ProjectedLimb {
            from: [a.x as f32, a.y as f32],
            along: [along.x as f32, along.y as f32],
            inverse: (1.0 / along.length_squared().max(1e-9)) as f32,
            radius: r0 as f32,
            widening: (r1 - r0) as f32,
            reach: reach as f32,
            columns,
            rows,
        })
    }
}
