//! What all silhouettes of several frames leave of each limb, carried back to the limb's rest frame.
//!
//! A place fixed in a limb is looked at in every frame, where that frame's pose puts it. In frames in which another limb is
//! nearer it says nothing: what is there may be that limb's. In the others it is in the hull or not. Its share of frames in
//! the hull, less the share that is asked for, is the field whose zero is the limb's surface. A hull of one frame holds
//! much that no camera could cut away; of many frames, which see the limb from many sides, what is left is the limb.

use glam::{DMat3, DVec3};

use super::PosedViews;
use super::options::SphereBodyOptions;
use crate::body::{Kinematics, Model, Pose};
use crate::fit::Evidence;
use crate::geometry::segments::distance;
use crate::silhouette::Label;

/// A limb's capsule in a frame.
#[derive(Debug, Clone, Copy)]
struct Capsule {
    start: DVec3,
    end: DVec3,
    radius: f64,
}

impl Capsule {
    /// Distance of a point from it, negative inside.
    fn distance(&self, point: DVec3) -> f64 {
        distance(point, self.start, self.end) - self.radius
    }
}

fn capsules(model: &Model, kinematics: &Kinematics) -> Vec<Capsule> {
    let joints = kinematics.starts().iter().zip(kinematics.ends());
    let all = joints.zip(model.limbs());
    all.map(|((&start, &end), limb)| Capsule { start, end, radius: limb.radius }).collect()
}

/// Frames made ready to be asked.
pub(super) struct Witnesses<'a> {
    frames: Vec<Witness<'a>>,
    model: &'a Model,
    rest: Vec<Capsule>,
}

struct Witness<'a> {
    views: &'a PosedViews,
    capsules: Vec<Capsule>,
    /// By rotation.
    rotations: Vec<DMat3>,
}

/// What a limb's field is asked of: where it is, and how large its surroundings are.
pub(super) struct LimbField<'a> {
    witnesses: &'a Witnesses<'a>,
    limb: usize,
    capsule: Capsule,
    options: &'a SphereBodyOptions,
}

impl<'a> Witnesses<'a> {
    pub(super) fn new(model: &'a Model, frames: &'a [PosedViews]) -> Self {
        let witness = |views: &'a PosedViews| {
            let kinematics = Kinematics::new(model, &views.pose);
            let rotations = kinematics.world_rotations().to_vec();
            Witness { views, capsules: capsules(model, &kinematics), rotations }
        };
        let rest = capsules(model, &Kinematics::new(model, &Pose::rest(model)));
        Self { frames: frames.iter().map(witness).collect(), model, rest }
    }

    /// The field of a limb. Its frame has the limb's first joint as origin and the axes of the body at rest.
    pub(super) fn field(&'a self, limb: usize, options: &'a SphereBodyOptions) -> LimbField<'a> {
        let Capsule { start, end, radius } = self.rest[limb];
        let capsule = Capsule { start: DVec3::ZERO, end: end - start, radius };
        LimbField { witnesses: self, limb, capsule, options }
    }
}

impl LimbField<'_> {
    /// Corners of a box that holds the limb's surroundings.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        let reach = DVec3::splat(self.capsule.radius + self.margin());
        [self.capsule.start.min(self.capsule.end) - reach, self.capsule.start.max(self.capsule.end) + reach]
    }

    fn margin(&self) -> f64 {
        (self.options.margin * self.capsule.radius).max(2.0 * self.options.step)
    }

    /// Distance from the limb's surface, about: negative inside.
    pub(super) fn value(&self, place: DVec3) -> f64 {
        let own = self.capsule.distance(place);
        // Deep within the capsule everything is the limb's; far from it nothing is.
        let core = own + self.options.core * self.capsule.radius;
        let beyond = own - self.margin();
        if core < 0.0 || beyond >= 0.0 {
            return if core < 0.0 { core } else { beyond };
        }
        let witnesses = self.witnesses;
        let at_rest = place + witnesses.rest[self.limb].start;
        let foreign = self.nearest_other(&witnesses.rest, at_rest);
        let border = own - foreign - self.options.overlap;
        if border >= 0.0 {
            return border.max(beyond);
        }
        let (mut inside, mut asked) = (0_u32, 0_u32);
        for witness in &witnesses.frames {
            let rotation = witness.rotations[witnesses.model.limbs()[self.limb].rotation];
            let point = witness.capsules[self.limb].start + rotation * place;
            if own > self.nearest_other(&witness.capsules, point) + self.options.overlap {
                continue;
            }
            if let Some(is_inside) = witness.views.holds(point) {
                asked += 1;
                inside += u32::from(is_inside);
            }
        }
        // Where no frame says anything the capsule stands.
        let hull = match asked {
            0 => own,
            _ => self.options.softness * (self.options.share - f64::from(inside) / f64::from(asked)),
        };
        hull.max(border).max(beyond).min(core)
    }

    /// Distance from the nearest other limb that is not one with this: limbs without a joint between them share a hull.
    fn nearest_other(&self, capsules: &[Capsule], point: DVec3) -> f64 {
        let others = capsules.iter().enumerate().filter(|(other, _)| *other != self.limb);
        others.map(|(_, capsule)| capsule.distance(point)).fold(f64::INFINITY, f64::min)
    }
}

impl PosedViews {
    /// Whether a place in the world is in the hull of this frame; `None` where fewer than two cameras can say.
    fn holds(&self, point: DVec3) -> Option<bool> {
        let mut witnesses = 0;
        for view in &self.views {
            let Evidence::Mask(mask) = &view.evidence else { continue };
            let Some(pixel) = view.camera.project(point) else { continue };
            let [x, y] = [pixel.x.round(), pixel.y.round()];
            if x < 0.0 || y < 0.0 {
                continue;
            }
            match mask.get(x as usize, y as usize) {
                Some(Label::Background) => return Some(false),
                Some(Label::Subject) => witnesses += 1,
                _ => {}
            }
        }
        (witnesses >= 2).then_some(true)
    }
}
