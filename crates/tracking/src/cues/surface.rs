//! Points of a limb's surface that a camera sees, and points of its outline.
//!
//! About a point q of the axis the surface is a circle of the limb's radius. With e the way from the camera, n = a × e is
//! along the picture and f = n × a towards the camera: points q + r (s n + √(1 − s²) f) face the camera, s from −1 to 1, and
//! s = ±1 is the outline, but for the camera's nearness.

use glam::{DVec2, DVec3};

use crate::body::{Kinematics, Model};
use crate::camera::Camera;
use crate::render::View;

/// Limbs nearer to the camera's plane than this have no points, metres.
const NEAREST: f64 = 0.1;
/// A limb within this sine of a ray (14°) points at the camera and has no sides.
const END_ON: f64 = 0.25;
/// What lies nearer by less than this hides nothing, metres: limbs lie in one another.
const DEPTH_SLACK: f64 = 0.03;

/// A point of a limb's surface, as a camera sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfacePoint {
    /// From the limb's first joint, in its rest frame, metres.
    pub(super) arm: DVec3,
    /// World, metres.
    pub(super) world: DVec3,
    /// Pixels.
    pub(super) pixel: DVec2,
    /// Depth, metres.
    pub(super) depth: f64,
    /// Unit vectors in the world: outwards along the picture, along the limb, towards the camera.
    pub(super) aside: DVec3,
    pub(super) along: DVec3,
    pub(super) facing: DVec3,
}

/// A pose as one camera sees it.
pub(super) struct Seen<'a> {
    pub(super) model: &'a Model,
    pub(super) kinematics: &'a Kinematics,
    pub(super) camera: &'a Camera,
    /// With the `half` ramp.
    pub(super) view: &'a View,
}

impl Seen<'_> {
    /// The point of a limb's surface at a fraction of its length and s of its breadth; `None` for a limb that points at the
    /// camera or is too near to it.
    pub(super) fn point(&self, limb: usize, fraction: f64, s: f64) -> Option<SurfacePoint> {
        let [p0, p1] = [self.kinematics.starts()[limb], self.kinematics.ends()[limb]];
        let axis = p1 - p0;
        let on_axis = p0 + axis * fraction;
        let along = axis.try_normalize()?;
        let way = (on_axis - self.camera.centre()).try_normalize()?;
        let aside = along.cross(way);
        if aside.length() < END_ON {
            return None;
        }
        let aside = aside.normalize();
        let facing = aside.cross(along);
        let facing = if facing.dot(way) > 0.0 { -facing } else { facing };
        let rest = &self.model.limbs()[limb];
        let world = on_axis + (aside * s + facing * (1.0 - s * s).max(0.0).sqrt()) * rest.radius;
        let depth = self.camera.depth(world);
        if depth < NEAREST {
            return None;
        }
        let arm = self.kinematics.world_rotations()[rest.rotation].transpose() * (world - p0);
        Some(SurfacePoint {
            arm,
            world,
            pixel: self.camera.project(world)?,
            depth,
            aside: aside * if s < 0.0 { -1.0 } else { 1.0 },
            along,
            facing,
        })
    }

    /// Whether no limb that turns otherwise lies between the camera and a point of a limb.
    pub(super) fn is_visible(&self, limb: usize, point: &SurfacePoint) -> bool {
        let rotation = self.model.limbs()[limb].rotation;
        let place = self.camera.camera_from_world();
        let way = place.transform(point.world);
        let (ray, distance) = (way.normalize(), way.length());
        let px = point.pixel.round();
        if px.x < 0.0 || px.y < 0.0 {
            return false;
        }
        let (x, y) = (px.x as usize, px.y as usize);
        if x >= self.view.width() || y >= self.view.height() {
            return false;
        }
        !self.view.primitives().iter().any(|primitive| {
            let is_other = self.model.limbs()[primitive.limb].rotation != rotation;
            is_other && primitive.bounds.contains(x, y) && {
                primitive.candidate(ray).is_some_and(|candidate| {
                    let within = primitive.radius * primitive.radius - candidate.squared;
                    within > 0.0 && candidate.depth - within.sqrt() < distance - DEPTH_SLACK
                })
            }
        })
    }
}
