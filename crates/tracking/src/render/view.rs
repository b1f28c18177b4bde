//! All solids of one pose, prepared for one camera.
//!
//! For a pinhole every solid has a box of pixels outside which it is background, from the outlines of the spheres of its
//! ramp's reach about both ends. Nothing is approximated by that: a box may be too large, never too small. A solid that
//! reaches the camera's plane has the whole picture, one behind it none. Through a lens an outline is no conic, so there
//! every ray meets every solid.

use glam::{DVec2, DVec3};

use super::footprint::Footprint;
use super::primitive::{PixelBox, Primitive, Solid, SolidShape};
use super::ramp::SolidRamp;
use super::wrench::Wrench;
use super::{Ramp, RendererKind};
use crate::body::{Kinematics, Limb, LimbSphere, Model};
use crate::camera::{Camera, Intrinsics};

/// A joint nearer to the camera plane than this many reaches is left to the reference kernel.
const NEAREST_REACHES: f64 = 1.5;

/// A pose as one camera's renderer sees it: solids in camera axes with ramps and pixel boxes.
#[derive(Debug, Clone)]
pub struct View {
    /// Pixels across and down.
    pub size: [usize; 2],
    /// The solids that may be seen, in the order of their limbs.
    pub(crate) primitives: Vec<Primitive>,
    /// Solids that lie under one sphere of a tree, or by themselves: their places, and the rows that they may touch.
    groups: Vec<SolidGroup>,
    /// Scratch: which spheres of a level and of the level above are in the picture.
    seen: [Vec<bool>; 2],
    /// Unit rays of a distorted lens, row-major; empty for a pinhole.
    distorted_rays: Vec<DVec3>,
    pub(crate) pinhole: Intrinsics,
}

/// Solids that follow one another.
#[derive(Debug, Clone, Copy)]
struct SolidGroup {
    /// Limb, and sphere of the level above, that they lie under.
    under: Option<(usize, usize)>,
    first: usize,
    past: usize,
    /// Rows that any of them may touch.
    rows: [usize; 2],
}

/// What a ray sees of the limb that wins its pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenLimb {
    /// Index of the limb.
    pub limb: usize,
    /// Distance of the ray to the limb's axis over its radius.
    pub distance_over_radius: f64,
    /// Distance along the ray to the limb's closest point, metres.
    pub depth: f64,
}

/// What a pixel says of a limb: its level and how that changes as the limb moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelPull {
    /// Index of the limb.
    pub limb: usize,
    /// λ, 0 to 255.
    pub level: f64,
    /// ∂λ as force and moment about the limb's first joint, camera axes; `None` where λ is clipped.
    pub wrench: Option<Wrench>,
}

impl View {
    /// Prepares the limbs of a pose for a camera.
    ///
    /// A camera with distortion gets its own ray in every pixel and no pixel boxes: exact and slow. Fits use
    /// rectified pictures and [`Camera::without_distortion`].
    pub fn new(
        model: &Model,
        kinematics: &Kinematics,
        camera: &Camera,
        renderer: RendererKind,
        ramp: Ramp,
    ) -> Self {
        let mut view = Self {
            size: [camera.width(), camera.height()],
            primitives: Vec::with_capacity(model.limbs().len()),
            groups: Vec::with_capacity(model.limbs().len()),
            seen: Default::default(),
            distorted_rays: distorted_rays(camera),
            pinhole: *camera.intrinsics(),
        };
        view.prepare(model, kinematics, camera, renderer, ramp);
        view
    }

    /// The same for another pose, renderer or ramp, without new allocations.
    pub fn prepare(
        &mut self,
        model: &Model,
        kinematics: &Kinematics,
        camera: &Camera,
        renderer: RendererKind,
        ramp: Ramp,
    ) {
        self.primitives.clear();
        self.groups.clear();
        let place = camera.camera_from_world();
        let focal = self.pinhole.mean_focal_px();
        for (index, limb) in model.limbs().iter().enumerate() {
            let p0 = place.transform(kinematics.starts()[index]);
            let p1 = place.transform(kinematics.ends()[index]);
            let mid_depth = 0.5 * (p0.z + p1.z);
            let ramp_of = |radius: f64| ramp.for_solid(radius, mid_depth, focal);
            if let Some(solid) = Solid::of_limb(renderer, limb, [p0, p1]) {
                self.push((index, 0), solid, limb.radius, ramp_of(limb.radius), None);
                continue;
            }
            let turn = place.rotation * kinematics.world_rotations()[limb.rotation];
            let place = |sphere: &LimbSphere| p0 + (p1 - p0) * sphere.at + turn * sphere.offset;
            let level = limb.level_for(if mid_depth > 0.0 { mid_depth / focal } else { 0.0 });
            self.look_for_parents(limb, level, place, ramp_of);
            for (piece, sphere) in limb.level(level).iter().enumerate() {
                // A parent that misses the picture skips its children.
                if sphere.parent.is_none_or(|parent| self.seen[0][parent]) {
                    let solid = Solid { joints: [p0, p1], shape: SolidShape::Sphere(place(sphere)) };
                    self.push((index, piece), solid, sphere.radius, ramp_of(sphere.radius), sphere.parent);
                }
            }
        }
    }

    /// The pixels that the body may touch: all others are background.
    pub fn footprint(&self) -> Footprint {
        Footprint::of(self.primitives.iter().map(|primitive| primitive.bounds))
    }

    /// Leaves out the limbs for which `drawn` is false: as if the body did not have them, until it is prepared again.
    ///
    /// `drawn` has one entry a limb; what is missing is left out.
    pub fn keep_limbs(&mut self, drawn: &[bool]) {
        let is_drawn = |limb: usize| drawn.get(limb).is_some_and(|&is_drawn| is_drawn);
        let mut past = 0;
        // A group is of one limb.
        self.groups.retain_mut(|group| {
            let is_kept = is_drawn(self.primitives[group.first].limb);
            if is_kept {
                (group.first, group.past) = (past, past + group.past - group.first);
                past = group.past;
            }
            is_kept
        });
        self.primitives.retain(|primitive| is_drawn(primitive.limb));
    }

    /// Adds a limb's piece, under a sphere of the level above it, if any of it may be in the picture.
    fn push(
        &mut self,
        (limb, piece): (usize, usize),
        solid: Solid,
        radius: f64,
        ramp: SolidRamp,
        parent: Option<usize>,
    ) {
        let bounds = self.bounds(solid.axis(), ramp.reach);
        if bounds.is_empty() {
            return;
        }
        let (place, rows) = (self.primitives.len(), bounds.rows);
        let under = parent.map(|parent| (limb, parent));
        match self.groups.last_mut() {
            Some(group) if under.is_some() && group.under == under => {
                group.past = place + 1;
                group.rows = [group.rows[0].min(rows[0]), group.rows[1].max(rows[1])];
            }
            _ => self.groups.push(SolidGroup { under, first: place, past: place + 1, rows }),
        }
        self.primitives.push(Primitive { limb, piece, solid, radius, ramp, bounds });
    }

    /// Finds which spheres of the level above `level` may have children in the picture, level after level from the coarsest.
    fn look_for_parents(
        &mut self,
        limb: &Limb,
        level: usize,
        place: impl Fn(&LimbSphere) -> DVec3,
        ramp_of: impl Fn(f64) -> SolidRamp,
    ) {
        for above in &limb.coarser[..level] {
            let [found, before] = &mut self.seen;
            std::mem::swap(found, before);
            found.clear();
            for (sphere, &reach) in above.spheres.iter().zip(&above.reaches) {
                // No sphere below reaches farther, and no ramp of one rises farther beyond it than that of the largest.
                let beyond = (ramp_of(reach).reach - reach).max(0.0);
                let centre = place(sphere);
                let is_seen = sphere.parent.is_none_or(|parent| before[parent]);
                let around = || PixelBox::around(centre, centre, reach + beyond, &self.pinhole, self.size);
                found.push(is_seen && (!self.distorted_rays.is_empty() || !around().is_empty()));
            }
        }
    }

    /// The solids that may be seen on a row, in their order, with their places. A parent that misses the row skips its children.
    pub(crate) fn on_row(&self, y: usize) -> impl Iterator<Item = (usize, &Primitive)> {
        let groups = self.groups.iter().filter(move |group| (group.rows[0]..group.rows[1]).contains(&y));
        let all = groups.flat_map(|group| group.first..group.past);
        let solids = all.map(|place| (place, &self.primitives[place]));
        solids.filter(move |(_, primitive)| primitive.bounds.is_on_row(y))
    }

    fn bounds(&self, [p0, p1]: [DVec3; 2], reach: f64) -> PixelBox {
        if self.is_pinhole() {
            PixelBox::around(p0, p1, reach, &self.pinhole, self.size)
        } else {
            PixelBox::whole(self.size)
        }
    }

    /// Whether rays are a pinhole's: (x, y, 1) on the plane z = 1.
    pub(crate) fn is_pinhole(&self) -> bool {
        self.distorted_rays.is_empty()
    }

    /// The solid that wins a pixel, and λ/255 there before clipping; `None` for background. Ties go to the first.
    pub(crate) fn winner(&self, x: usize, y: usize) -> Option<(&Primitive, f64)> {
        let ray = self.ray(x, y);
        let mut darkest = None;
        for primitive in self.primitives.iter().filter(|primitive| primitive.bounds.contains(x, y)) {
            let level = primitive.ramp.unclipped(primitive.squared(ray));
            if level < darkest.map_or(1.0, |(_, level)| level) {
                darkest = Some((primitive, level));
            }
        }
        darkest
    }

    /// What the ray of a pixel sees of the limb that wins it; `None` for background and outside the picture.
    pub fn seen_limb(&self, x: usize, y: usize) -> Option<SeenLimb> {
        if x >= self.size[0] || y >= self.size[1] {
            return None;
        }
        let (primitive, _) = self.winner(x, y)?;
        let candidate = primitive.candidate(self.ray(x, y))?;
        Some(SeenLimb {
            limb: primitive.limb,
            distance_over_radius: candidate.squared.sqrt() / primitive.radius,
            depth: candidate.depth,
        })
    }

    /// One pixel by the formulas alone: the darkest of all solids, each of which is asked, with its gradient. The
    /// slowest way there is, for benches and tests to measure others by.
    pub fn pull_by_every_solid(&self, x: usize, y: usize) -> Option<PixelPull> {
        let ray = self.ray(x, y);
        let (mut darkest, mut winner) = (f64::INFINITY, None);
        for primitive in &self.primitives {
            let level = primitive.ramp.unclipped(primitive.squared(ray));
            if level < darkest {
                (darkest, winner) = (level, Some(primitive));
            }
        }
        winner.map(|primitive| {
            let sample = primitive.sample(ray);
            PixelPull { limb: primitive.limb, level: sample.level, wrench: sample.wrench }
        })
    }

    /// Whether the kernel in f32 lanes can take the view: all well in front of the camera, no lens. Other views are
    /// left to the reference kernel.
    pub fn suits_lanes(&self) -> bool {
        let suits =
            |primitive: &Primitive| primitive.solid.suits_lanes(NEAREST_REACHES * primitive.ramp.reach);
        self.is_pinhole() && self.primitives.iter().all(suits)
    }

    /// Unit ray of a pixel in camera axes. NaN where the lens has no inverse: no solid is seen there.
    #[inline]
    pub(crate) fn ray(&self, x: usize, y: usize) -> DVec3 {
        if self.distorted_rays.is_empty() {
            self.pinhole.ray(DVec2::new(x as f64, y as f64))
        } else {
            self.distorted_rays[y * self.size[0] + x]
        }
    }
}

fn distorted_rays(camera: &Camera) -> Vec<DVec3> {
    if camera.distortion().is_none() {
        return Vec::new();
    }
    let pixels = (0..camera.height()).flat_map(|y| (0..camera.width()).map(move |x| [x, y]));
    let ray = |[x, y]: [usize; 2]| camera.ray_in_camera(DVec2::new(x as f64, y as f64)).unwrap_or(DVec3::NAN);
    pixels.map(ray).collect()
}

#[cfg(test)]
mod footprints;
