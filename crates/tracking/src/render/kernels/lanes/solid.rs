//! One solid's constants for a camera, and the columns that it may touch on each row.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

use super::grid::PixelGrid;
use crate::camera::Intrinsics;
use crate::render::primitive::{Footprint, Primitive, Solid};
use crate::render::ramp::{RampForm, SolidRamp};

/// The reach is taken this much larger than it is, relatively, where spans are cut.
const REACH_MARGIN: f64 = 1e-6;

/// A flat cap is looked at as if it reached this much farther than it does.
const WIDE: f64 = 1.1;
/// How many roundings of a ray's place on the plane z = 1 a distance is wrong by, at the most.
const ROUNDINGS: f64 = 2.0;

/// A solid in camera axes, ready for lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneSolid {
    /// Index of its limb.
    pub limb: usize,
    /// Its index in the view.
    pub primitive: usize,
    /// What is nearest to a ray.
    pub shape: Shape,
    /// First joint, from which t is counted.
    pub start: Joint,
    /// Second joint; used by flat caps.
    pub end: Joint,
    /// a = p1 − p0, metres.
    pub a: Vec3,
    /// a / z₀: the axis in units of the first joint's depth.
    pub axis: Vec3,
    /// ê₀ × axis.
    pub cross: Vec3,
    pub ramp: LaneRamp,
    /// Rows of the grid that it may touch, end excluded.
    pub rows: [usize; 2],
    edges: Edges,
    /// Where its spans begin in the list of all of them.
    pub spans: usize,
    /// No pixel of a flat cap is darker than background beyond this, squared, in units of the first joint's depth.
    pub cap_reach: f32,
    /// λ/255 of it is at most this wrong.
    pub error: f32,
    /// For a sphere fixed anywhere in its limb.
    pub anchor: Option<Anchor>,
}

/// Where a sphere sits in its limb, camera axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Anchor {
    /// From the limb's first joint, about which moments are taken, to the sphere's centre.
    pub arm: DVec3,
    /// The limb's own axis, whose ends share the pull of the depth.
    pub limb_axis: DVec3,
}

/// What of a solid a ray may be nearest to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// The axis, t clamped to its ends: a capsule, or a single sphere where the axis has no length.
    Capsule,
    /// Equal spheres at multiples of 1/gaps along the axis.
    Spheres { gaps: f32 },
    /// The axis without its ends, and two flat caps; each cap may be hit only in its columns and rows.
    Cylinder { caps: [GridBox; 2] },
}

/// A rectangle of the grid, ends excluded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GridBox {
    pub columns: [usize; 2],
    pub rows: [usize; 2],
}

/// A joint p = z ê with ê = (x, y, 1).
#[derive(Debug, Clone, Copy)]
pub(super) struct Joint {
    pub x: f32,
    pub y: f32,
    pub z: f32,
    /// axis · ê, in f64 before it was rounded.
    pub axis_along: f32,
}

/// λ/255 = slope · m + offset, with m = d² or d in units of the first joint's depth.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaneRamp {
    pub slope: f32,
    pub offset: f32,
    /// m is d and not d².
    pub is_linear: bool,
    /// ∂λ/∂z = constant + slope · λ/255 for ramps whose width follows the depth.
    pub by_depth: Option<[f32; 2]>,
    /// d = distance[0] + distance[1] · λ/255, metres, for linear ramps.
    pub distance: [f32; 2],
    /// ∂λ/∂q = factor · f, with f = δ for quadratic ramps and δ/d for linear ones.
    pub factor: f64,
}

/// The outline of the infinite cylinder around the axis: two straight lines, each `row · slope + start`.
#[derive(Debug, Clone, Copy)]
struct Edges {
    low: [f64; 2],
    high: [f64; 2],
    columns: [f64; 2],
}

impl LaneSolid {
    /// Constants of a primitive; `None` if it touches no sampled pixel.
    pub(super) fn new(primitive: &Primitive, pinhole: &Intrinsics, grid: &PixelGrid) -> Option<Self> {
        let (p0, p1) = match primitive.solid {
            Solid::Capsule { p0, p1 } | Solid::Cylinder { p0, p1 } | Solid::Spheres { p0, p1, .. } => {
                (p0, p1)
            }
            Solid::Sphere { centre, .. } => (centre, centre),
        };
        let bounds = GridBox::new(&primitive.bounds, grid);
        if bounds.is_empty() {
            return None;
        }
        let reach = primitive.ramp.reach();
        let a = p1 - p0;
        let axis = a / p0.z;
        let shape = match primitive.solid {
            Solid::Capsule { .. } | Solid::Sphere { .. } => Shape::Capsule,
            Solid::Spheres { count, .. } => Shape::Spheres { gaps: (count - 1) as f32 },
            Solid::Cylinder { .. } => {
                Shape::Cylinder { caps: [p0, p1].map(|p| GridBox::around(p, reach, pinhole, grid)) }
            }
        };
        Some(Self {
            limb: primitive.limb,
            primitive: 0,
            shape,
            start: Joint::new(p0, axis),
            end: Joint::new(p1, axis),
            a: a.as_vec3(),
            axis: axis.as_vec3(),
            cross: (p0 / p0.z).cross(axis).as_vec3(),
            ramp: LaneRamp::new(primitive.ramp.form(), p0.z),
            rows: bounds.rows,
            edges: Edges::new(p0, a, reach * (1.0 + REACH_MARGIN), pinhole, grid, bounds.columns),
            spans: 0,
            cap_reach: (WIDE * reach / p0.z).powi(2) as f32,
            error: error(&primitive.ramp, p0, p1),
            anchor: match primitive.solid {
                Solid::Sphere { p0, p1, centre } => Some(Anchor { arm: centre - p0, limb_axis: p1 - p0 }),
                _ => None,
            },
        })
    }

    /// Its rows in a band.
    #[inline(always)]
    pub(super) fn rows_in(&self, band: &Range<usize>) -> Range<usize> {
        self.rows[0].max(band.start)..self.rows[1].min(band.end)
    }

    /// First column and one past the last that the solid may touch on a row; none where the first is not before
    /// the last.
    #[inline(always)]
    pub(super) fn span(&self, row: usize) -> [u32; 2] {
        let row = row as f64;
        let line = |line: [f64; 2]| line[0] * row + line[1];
        // Rounding half a column outwards cuts to whole columns: at most one too many on either side.
        let low = (line(self.edges.low) - 0.5).max(self.edges.columns[0]);
        let high = (line(self.edges.high) + 0.5).min(self.edges.columns[1]);
        [whole(low), whole(high.max(0.0))]
    }
}

/// How wrong f32 may be about λ/255 on the ramp of a solid: the ray's place and the joint's are rounded.
fn error(ramp: &SolidRamp, p0: DVec3, p1: DVec3) -> f32 {
    let rounding = 0.5 * f64::from(f32::EPSILON);
    let aside = |p: DVec3| p.x.abs().max(p.y.abs()).max(0.5 * p.z) + ramp.reach();
    let distance = ROUNDINGS * rounding * aside(p0).max(aside(p1));
    let (steepness, offset) = match ramp.form() {
        RampForm::Quadratic { alpha, beta, .. } => (2.0 * alpha * ramp.reach(), beta),
        RampForm::Linear { start, width, .. } => (1.0 / width, start / width),
    };
    (steepness * distance + ROUNDINGS * rounding * offset.abs().max(1.0)) as f32
}

/// The nearest whole number of one from 0 up to 2³² (smaller and larger ones do not occur here), in a way that
/// a processor does to many at once: from 2⁵² on, f64 are the whole numbers.
#[inline(always)]
fn whole(value: f64) -> u32 {
    (value + 4_503_599_627_370_496.0).to_bits() as u32
}

impl Joint {
    fn new(p: DVec3, axis: DVec3) -> Self {
        let unit = p / p.z;
        Self { x: unit.x as f32, y: unit.y as f32, z: p.z as f32, axis_along: axis.dot(unit) as f32 }
    }
}

impl GridBox {
    fn new(bounds: &Footprint, grid: &PixelGrid) -> Self {
        Self {
            columns: [grid.index_from(bounds.x0, grid.columns), grid.index_from(bounds.x1, grid.columns)],
            rows: [grid.index_from(bounds.y0, grid.rows), grid.index_from(bounds.y1, grid.rows)],
        }
    }

    fn around(centre: DVec3, reach: f64, pinhole: &Intrinsics, grid: &PixelGrid) -> Self {
        let pixels = |count: usize| grid.pixel(count.saturating_sub(1)) + 1;
        let bounds =
            Footprint::around(centre, centre, reach, pinhole, pixels(grid.columns), pixels(grid.rows));
        Self::new(&bounds, grid)
    }

    fn is_empty(&self) -> bool {
        self.rows[0] >= self.rows[1] || self.columns[0] >= self.columns[1]
    }
}

impl LaneRamp {
    fn new(form: RampForm, depth: f64) -> Self {
        let (slope, offset, is_linear) = form.line();
        let by_level = |by_measure: [f32; 2]| match form {
            // m = (λ/255 − β)/α
            RampForm::Quadratic { alpha, beta, .. } => {
                let slope = f64::from(by_measure[1]) / alpha;
                [(f64::from(by_measure[0]) - slope * beta) as f32, slope as f32]
            }
            RampForm::Linear { .. } => by_measure,
        };
        let (unit, distance, factor) = match form {
            RampForm::Quadratic { alpha, .. } => {
                (depth * depth, [0.0; 2], -2.0 * crate::render::BACKGROUND * alpha)
            }
            RampForm::Linear { start, width, .. } => {
                (depth, [start as f32, width as f32], -crate::render::BACKGROUND / width)
            }
        };
        Self {
            slope: (f64::from(slope) * unit) as f32,
            offset,
            is_linear,
            by_depth: form.depth_line().map(|(constant, slope)| by_level([constant, slope])),
            distance,
            factor,
        }
    }
}

impl Edges {
    /// The planes through the camera's centre that touch the infinite cylinder of radius `reach` around the
    /// axis: with w the unit vector from the centre to the axis, at distance D, v = â × w and sin φ = reach/D,
    /// a ray e comes within reach where |e·v| cos φ < (e·w) sin φ.
    fn new(
        p0: DVec3,
        a: DVec3,
        reach: f64,
        pinhole: &Intrinsics,
        grid: &PixelGrid,
        columns: [usize; 2],
    ) -> Self {
        let columns = columns.map(|column| column as f64);
        let mut edges = Self { low: [0.0, f64::NEG_INFINITY], high: [0.0, f64::INFINITY], columns };
        let Some(along) = a.try_normalize() else { return edges };
        let across = p0 - along * p0.dot(along);
        let distance = across.length();
        if distance <= reach {
            return edges;
        }
        let w = across / distance;
        let v = along.cross(w);
        let sin = reach / distance;
        let cos = (1.0 - sin * sin).sqrt();
        for side in [1.0, -1.0] {
            // n · e < 0 within reach
            let n = v * (side * cos) - w * sin;
            let by_column = n.x * grid.stride as f64 / pinhole.fx;
            let by_row = n.y * grid.stride as f64 / pinhole.fy;
            let start = DVec2::splat(grid.offset as f64) - DVec2::new(pinhole.cx, pinhole.cy);
            let constant = n.x * start.x / pinhole.fx + n.y * start.y / pinhole.fy + n.z;
            let line = [-by_row / by_column, -constant / by_column];
            if !(line[0].is_finite() && line[1].is_finite()) {
                continue;
            }
            // Of two lines on one side the first is enough: a span may be too wide.
            let edge = if by_column > 0.0 { &mut edges.high } else { &mut edges.low };
            if edge[1].is_infinite() {
                *edge = line;
            }
        }
        edges
    }
}
