//! One solid in camera axes, seen along a ray from the camera's centre.

use glam::{DVec2, DVec3};

use super::ramp::{RampSample, SolidRamp};
use super::renderer::RendererKind;
use super::wrench::Wrench;
use crate::body::Limb;
use crate::camera::Intrinsics;
use crate::geometry::ray_distance::{Candidate, Cap, ray_axis, ray_cap, ray_point};

/// The solid of a primitive, in camera axes, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Solid {
    /// The limb's two joints. About the first moments are taken, and the width of a ramp in pixels goes by the depth of both.
    pub joints: [DVec3; 2],
    /// What stands between or beside them.
    pub shape: SolidShape,
}

/// What a solid is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SolidShape {
    /// Axis and two hemispherical ends.
    Capsule,
    /// Axis and two flat caps.
    Cylinder,
    /// So many equal spheres, evenly spread from joint to joint; a single one sits in the middle.
    Spheres(usize),
    /// One sphere fixed in the limb, on its axis or off it, by its centre.
    Sphere(DVec3),
}

impl Solid {
    /// What stands for a whole limb between its joints; `None` where a sphere tree of its own does.
    pub(crate) fn of_limb(renderer: RendererKind, limb: &Limb, joints: [DVec3; 2]) -> Option<Self> {
        let shape = match renderer {
            RendererKind::Capsule => SolidShape::Capsule,
            RendererKind::Cylinder => SolidShape::Cylinder,
            RendererKind::SphereTree { spheres } => {
                SolidShape::Spheres(RendererKind::equal_spheres(limb, spheres)?)
            }
        };
        Some(Self { joints, shape })
    }

    /// The ends of its own axis: of a sphere its centre twice, else the joints.
    pub(crate) fn axis(&self) -> [DVec3; 2] {
        match self.shape {
            SolidShape::Sphere(centre) => [centre; 2],
            _ => self.joints,
        }
    }

    /// Whether the kernel in f32 lanes can take it where its axis keeps this distance from the camera's plane, metres.
    pub(crate) fn suits_lanes(&self, nearest: f64) -> bool {
        let [p0, p1] = self.axis();
        self.shape != SolidShape::Spheres(1) && p0.z.min(p1.z) > nearest
    }
}

/// A solid with its limb, its ramp and the pixels that it may touch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Primitive {
    /// Index of its limb.
    pub limb: usize,
    /// Of a sphere its number among those of its limb that stand for it.
    pub piece: usize,
    /// Its shape.
    pub solid: Solid,
    /// Its radius, metres.
    pub radius: f64,
    /// Its ramp.
    pub ramp: SolidRamp,
    /// Pixels outside this box are background to it.
    pub(crate) bounds: PixelBox,
}

/// A rectangle of pixels, ends excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct PixelBox {
    /// First column, and one past the last.
    pub(crate) columns: [usize; 2],
    /// First row, and one past the last.
    pub(crate) rows: [usize; 2],
}

/// What a ray sees of a primitive, with the gradient as a wrench on its limb.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelSample {
    /// λ, 0 to 255.
    pub level: f64,
    /// Squared distance of the ray, m².
    pub squared: f64,
    /// ∂λ as force and moment about the limb's first joint, camera axes; `None` where λ is clipped.
    pub wrench: Option<Wrench>,
}

impl Primitive {
    /// Whether its ramp is half grey at its surface.
    pub(crate) fn is_half_grey_at_surface(&self) -> bool {
        (self.ramp.unclipped(self.radius * self.radius) - 0.5).abs() < 1e-9
    }

    /// d² of the nearest candidate along the unit ray u; infinite for none.
    #[inline]
    pub(crate) fn squared(&self, u: DVec3) -> f64 {
        let [p0, p1] = self.solid.joints;
        match self.solid.shape {
            SolidShape::Capsule => capsule_squared(u, p0, p1),
            SolidShape::Sphere(centre) => point_squared(u, centre),
            SolidShape::Spheres(count) => sphere_fractions(count)
                .map(|fraction| point_squared(u, p0.lerp(p1, fraction)))
                .fold(f64::INFINITY, f64::min),
            SolidShape::Cylinder => self.candidate(u).map_or(f64::INFINITY, |candidate| candidate.squared),
        }
    }

    /// The nearest candidate along the unit ray u, with derivatives.
    pub(crate) fn candidate(&self, u: DVec3) -> Option<Candidate> {
        let nearer = |a: &Candidate, b: &Candidate| a.squared.total_cmp(&b.squared);
        let nearest = |candidates: [Option<Candidate>; 3]| candidates.into_iter().flatten().min_by(nearer);
        let [p0, p1] = self.solid.joints;
        match self.solid.shape {
            SolidShape::Capsule => {
                nearest([ray_axis(u, p0, p1), ray_point(u, p0, 0.0), ray_point(u, p1, 1.0)])
            }
            SolidShape::Cylinder => {
                nearest([ray_axis(u, p0, p1), ray_cap(u, p0, p1, Cap::Start), ray_cap(u, p0, p1, Cap::End)])
            }
            SolidShape::Spheres(count) => sphere_fractions(count)
                .filter_map(|fraction| ray_point(u, p0.lerp(p1, fraction), fraction))
                .min_by(nearer),
            SolidShape::Sphere(centre) => ray_point(u, centre, 0.0),
        }
    }

    /// λ along the unit ray u, with its gradient.
    pub(crate) fn sample(&self, u: DVec3) -> PixelSample {
        let Some(candidate) = self.candidate(u) else {
            let level = super::ramp::BACKGROUND;
            return PixelSample { level, squared: f64::INFINITY, wrench: None };
        };
        let ramp = self.ramp.sample(candidate.squared);
        let active = ramp.by_squared > 0.0;
        PixelSample {
            level: ramp.level,
            squared: candidate.squared,
            wrench: active.then(|| self.wrench(&candidate, ramp)),
        }
    }

    /// ∂λ along the unit ray u of a pinhole's pixel by the logarithm of the focal lengths and by the principal point (per
    /// pixel).
    ///
    /// A ray that turns by ω sees what it sees where the solid turns by −ω: ∂(d²)/∂ω = −Σ p × ∂(d²)/∂p. Ramps in pixels
    /// are z/f wide, so that a longer focal length is to them as a smaller depth.
    pub(crate) fn by_pinhole(&self, u: DVec3, pinhole: &Intrinsics) -> [f64; 3] {
        let Some(candidate) = self.candidate(u) else { return [0.0; 3] };
        let ramp = self.ramp.sample(candidate.squared);
        let [q0, q1] = self.solid.axis();
        let torque = q0.cross(candidate.by_p0) + q1.cross(candidate.by_p1);
        // By the ray's place on the plane z = 1.
        let by_plane = u.z * ramp.by_squared * u.cross(torque).truncate();
        let [p0, p1] = self.solid.joints;
        let by_zoom = -by_plane.dot(u.truncate() / u.z) - 0.5 * (p0.z + p1.z) * ramp.by_depth;
        [by_zoom, -by_plane.x / pinhole.fx, -by_plane.y / pinhole.fy]
    }

    fn wrench(&self, candidate: &Candidate, ramp: RampSample) -> Wrench {
        let half_depth = DVec3::new(0.0, 0.0, 0.5 * ramp.by_depth);
        let [p0, p1] = self.solid.joints;
        if let SolidShape::Sphere(centre) = self.solid.shape {
            // The whole derivative of the distance is by the centre, wherever in the limb that is.
            let mut wrench = Wrench::at(candidate.by_p0 * ramp.by_squared, centre - p0);
            let mut depth = Wrench::at(half_depth, p1 - p0);
            depth.force += half_depth;
            wrench += depth;
            return wrench;
        }
        let mut wrench = Wrench::at(candidate.by_p1 * ramp.by_squared + half_depth, p1 - p0);
        wrench.force += candidate.by_p0 * ramp.by_squared + half_depth;
        wrench
    }
}

/// Where along a limb its equal spheres sit, 0 to 1.
pub fn sphere_fractions(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| if count == 1 { 0.5 } else { k as f64 / (count - 1) as f64 })
}

#[inline]
fn point_squared(u: DVec3, centre: DVec3) -> f64 {
    let depth = u.dot(centre);
    if depth > 0.0 { (centre - depth * u).length_squared() } else { f64::INFINITY }
}

#[inline]
fn capsule_squared(u: DVec3, p0: DVec3, p1: DVec3) -> f64 {
    let a = p1 - p0;
    let (b, c, along) = (u.dot(a), a.dot(p0), u.dot(p0));
    let denominator = a.length_squared() - b * b;
    let t = along * b - c; // times denominator
    if t >= 0.0
        && t <= denominator
        && denominator > 0.0
        && let Some(axis) = ray_axis(u, p0, p1)
    {
        return axis.squared;
    }
    point_squared(u, p0).min(point_squared(u, p1))
}

impl PixelBox {
    /// The whole picture.
    pub(crate) fn whole([width, height]: [usize; 2]) -> Self {
        Self { columns: [0, width], rows: [0, height] }
    }

    /// Whether a pixel is in it.
    pub(crate) fn contains(&self, x: usize, y: usize) -> bool {
        (self.columns[0]..self.columns[1]).contains(&x) && self.is_on_row(y)
    }

    /// Whether any of it may be on a row.
    pub(crate) fn is_on_row(&self, y: usize) -> bool {
        (self.rows[0]..self.rows[1]).contains(&y)
    }

    /// The smallest rectangle that holds both.
    pub(crate) fn union(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return if self.is_empty() { other } else { self };
        }
        let both = |[from, to]: [usize; 2], other: [usize; 2]| [from.min(other[0]), to.max(other[1])];
        Self { columns: both(self.columns, other.columns), rows: both(self.rows, other.rows) }
    }

    /// Whether it holds no pixel.
    pub(crate) fn is_empty(&self) -> bool {
        self.pixels() == 0
    }

    /// How many pixels it holds.
    pub(crate) fn pixels(&self) -> usize {
        let side = |[from, to]: [usize; 2]| to.saturating_sub(from);
        side(self.columns) * side(self.rows)
    }

    /// Pixels whose ray may come within `reach` of the segment p0 p1 (camera axes): never too few.
    ///
    /// The box of the two end spheres' outlines, which holds everything between them as long as both lie in
    /// front of the camera; the whole picture if one reaches the camera plane; nothing if both are behind.
    pub(crate) fn around(p0: DVec3, p1: DVec3, reach: f64, pinhole: &Intrinsics, size: [usize; 2]) -> Self {
        if p0.z <= -reach && p1.z <= -reach {
            return Self::default();
        }
        // A margin keeps the tangents finite.
        let near = reach * 1.001 + 1e-9;
        if p0.z <= near || p1.z <= near {
            return Self::whole(size);
        }
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for p in [p0, p1] {
            let (x, y) = (tangents(p.x, p.z, reach), tangents(p.y, p.z, reach));
            low = low.min(pinhole.pixel_from_plane(DVec2::new(x.0, y.0)));
            high = high.max(pinhole.pixel_from_plane(DVec2::new(x.1, y.1)));
        }
        // Within the picture's whole numbers, where a conversion rounds down.
        let within = |value: f64, limit: usize| value.clamp(0.0, limit as f64);
        let first = |value: f64, limit: usize| {
            let value = within(value - 1e-6, limit);
            let below = value as usize;
            below + usize::from(value > below as f64)
        };
        let past = |value: f64, limit: usize| within(value + (1.0 + 1e-6), limit) as usize;
        let [width, height] = size;
        Self {
            columns: [first(low.x, width), past(high.x, width)],
            rows: [first(low.y, height), past(high.y, height)],
        }
    }
}

/// Slopes x/z of the two lines through the origin that touch the circle at (x, z), z > reach.
fn tangents(x: f64, z: f64, reach: f64) -> (f64, f64) {
    // (x z ± ρ √(x² + z² − ρ²)) / (z² − ρ²)
    let root = reach * (x * x + z * z - reach * reach).max(0.0).sqrt();
    let denominator = z * z - reach * reach;
    ((x * z - root) / denominator, (x * z + root) / denominator)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Every pixel whose ray comes within reach lies in the box, wherever the limb is.
        #[test]
        fn boxes_never_miss_a_pixel(
            p0 in (-2.0..2.0f64, -2.0..2.0f64, -1.0..4.0f64),
            p1 in (-2.0..2.0f64, -2.0..2.0f64, -1.0..4.0f64),
            reach in 0.01..0.5f64,
        ) {
            let (p0, p1) = (DVec3::from(p0), DVec3::from(p1));
            let pinhole = Intrinsics { fx: 20.0, fy: 22.0, cx: 15.0, cy: 11.5 };
            let bounds = PixelBox::around(p0, p1, reach, &pinhole, [32, 24]);
            for y in 0..24 {
                for x in 0..32 {
                    let u = pinhole.ray(DVec2::new(x as f64, y as f64));
                    if capsule_squared(u, p0, p1) < reach * reach {
                        prop_assert!(bounds.contains(x, y), "pixel {x} {y} outside {bounds:?}");
                    }
                }
            }
        }

        /// The quick distance is the candidates' distance.
        #[test]
        fn quick_distances_are_the_candidates(
            p0 in (-1.0..1.0f64, -1.0..1.0f64, -1.0..3.0f64),
            p1 in (-1.0..1.0f64, -1.0..1.0f64, -1.0..3.0f64),
            x in -0.5..0.5f64, y in -0.5..0.5f64,
        ) {
            let (p0, p1) = (DVec3::from(p0), DVec3::from(p1));
            let u = DVec3::new(x, y, 1.0).normalize();
            let primitive = Primitive {
                limb: 0,
                piece: 0,
                solid: Solid { joints: [p0, p1], shape: SolidShape::Capsule },
                radius: 0.1,
                ramp: super::super::Ramp::Half.for_solid(0.1, 1.0, 100.0),
                bounds: PixelBox::default(),
            };
            let candidate = primitive.candidate(u).map_or(f64::INFINITY, |c| c.squared);
            let quick = primitive.squared(u);
            prop_assert!(candidate == quick || (candidate - quick).abs() < 1e-12, "{candidate} {quick}");
        }
    }
}
