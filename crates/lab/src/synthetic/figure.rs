//! The figure: a clothed person as a smooth union of solids that are not the model's capsules.
//!
//! The joints are the model's, so the truth is known; the flesh is round cones, ellipsoids, slabs and frusta
//! beside the axes, and over it lies cloth that stands off the body. Each solid is given in the rest frame of
//! one rotation (x subject's right, y forward, z up) about one joint. Solids of one material melt together;
//! different materials meet at an edge. Metres.

use backlit_tracking::body::{Kinematics, Model, Pose};
use glam::{DMat3, DVec3};

use super::hulls::Hulls;
use super::solid::smooth_min;

/// How much of [`Figure::distance`] a ray may walk: the solids' functions overrate by at most its inverse.
pub(super) const STEP: f64 = 0.8;
/// A part farther off than this beyond the nearest one cannot shape the surface: wider than any fillet.
pub(super) const REACH: f64 = 0.08;

/// Size of the head, of an average adult's.
pub(super) const HEAD: f64 = 1.05;
/// Thickness of the hair, metres.
pub(super) const HAIR: f64 = 0.014;

/// How one person's clothes differ from another's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Build {
    /// How far cloth stands off the body, 1 for a loose T-shirt and slim trousers.
    pub cloth: f64,
    /// Height of the folds in the cloth, metres.
    pub folds: f64,
    /// Contrast of a pattern of blotches all over skin and clothes, as of a patterned long sleeve; 0 for none.
    pub pattern: f64,
}

impl Default for Build {
    fn default() -> Self {
        Self { cloth: 1.0, folds: 0.0035, pattern: 0.0 }
    }
}

/// What a point of the figure's surface is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Material {
    Skin,
    Shirt,
    Trousers,
    /// Shoes and socks.
    Shoe,
    Hair,
}

/// A point of the figure's surface with what is needed to colour it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Touch {
    pub(super) material: Material,
    /// The point in the frame of the part, where textures live.
    pub(super) local: DVec3,
    pub(super) part: Part,
}

/// A part of the body that is skipped as a whole when it is far off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Head,
    Trunk,
    /// Upper arm, forearm and hand: 0 right, 1 left.
    Arm(usize),
    /// Thigh, calf and foot: 0 right, 1 left.
    Leg(usize),
}

impl Part {
    pub(super) const ALL: [Self; 6] =
        [Self::Head, Self::Trunk, Self::Arm(0), Self::Arm(1), Self::Leg(0), Self::Leg(1)];

    /// Its place among [`ALL`](Self::ALL).
    pub(super) fn index(self) -> usize {
        match self {
            Self::Head => 0,
            Self::Trunk => 1,
            Self::Arm(side) => 2 + side,
            Self::Leg(side) => 4 + side,
        }
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) origin: DVec3,
    local_from_world: DMat3,
}

impl Frame {
    pub(super) fn local(&self, point: DVec3) -> DVec3 {
        self.local_from_world * (point - self.origin)
    }

    pub(super) fn world(&self, local: DVec3) -> DVec3 {
        self.origin + self.local_from_world.transpose() * local
    }
}

/// One limb's frames from trunk to tip, its solids mirrored for the left.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chain {
    pub(super) upper: Frame,
    pub(super) lower: Frame,
    pub(super) end: Frame,
    pub(super) mirror: f64,
    pub(super) upper_length: f64,
    pub(super) lower_length: f64,
}

/// What rays side by side meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum BundleHit {
    /// None of them meets the figure.
    None,
    /// All of them meet it.
    All,
    /// Some of them may meet it, none before these metres.
    Some(f64),
}

/// A posed figure. Cheap to make; [`distance`](Self::distance) is safe to ask from many threads.
#[derive(Debug, Clone)]
pub struct Figure {
    pub(super) build: Build,
    pub(super) head: Frame,
    /// Centre of the pelvis.
    pub(super) pelvis: Frame,
    /// End of the spine.
    pub(super) chest: Frame,
    pub(super) clavicles: [Frame; 2],
    pub(super) arms: [Chain; 2],
    pub(super) legs: [Chain; 2],
    /// Neck joint and right and left shoulder joints, in the chest's frame.
    pub(super) collar: [DVec3; 3],
    pub(super) hulls: Hulls,
}

/// Distances to the five materials of one part or of all.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layers(pub(super) [f64; 5]);

/// Most steps along a ray.
const STEPS: usize = 160;
/// Farther off than anything that is looked at.
pub(super) const FAR: f64 = 1e3;

impl Layers {
    const ORDER: [Material; 5] =
        [Material::Skin, Material::Shirt, Material::Trousers, Material::Shoe, Material::Hair];
    /// Width of the fillet between solids of one material.
    const FILLET: [f64; 5] = [0.02, 0.05, 0.045, 0.012, 0.01];

    pub(super) fn nearest(self) -> (f64, Material) {
        let mut best = (f64::INFINITY, Material::Skin);
        for (distance, material) in self.0.into_iter().zip(Self::ORDER) {
            if distance < best.0 {
                best = (distance, material);
            }
        }
        best
    }

    fn join(&mut self, other: Self) {
        for ((mine, theirs), k) in self.0.iter_mut().zip(other.0).zip(Self::FILLET) {
            *mine = smooth_min(*mine, theirs, k);
        }
    }
}

impl Figure {
    /// The figure in a pose of the built-in full body, or of a body of other lengths with its limb names.
    ///
    /// `None` if the model lacks one of those limbs.
    #[must_use]
    pub fn new(model: &Model, pose: &Pose, build: Build) -> Option<Self> {
        let kinematics = Kinematics::new(model, pose);
        let limb = |name: &str| model.limb_index(name);
        let frame = |name: &str| {
            let index = limb(name)?;
            let world_from_local = kinematics.world_rotations()[model.limbs()[index].rotation];
            Some(Frame { origin: kinematics.starts()[index], local_from_world: world_from_local.transpose() })
        };
        let length = |name: String| -> Option<f64> { Some(model.limbs()[limb(&name)?].length) };
        let chain = |side: &str, upper: &str, lower: &str, end: &str| -> Option<Chain> {
            let whole = |limb: &str| -> Option<f64> {
                Some(
                    length(format!("{side} {limb}"))?
                        + length(format!("{side} lower {limb}")).unwrap_or_default(),
                )
            };
            Some(Chain {
                upper: frame(&format!("{side} {upper}"))?,
                lower: frame(&format!("{side} {lower}"))?,
                end: frame(&format!("{side} {end}"))?,
                mirror: if side == "right" { 1.0 } else { -1.0 },
                upper_length: whole(upper)?,
                lower_length: whole(lower)?,
            })
        };
        let (head, chest) = (frame("skull")?, frame("chest")?);
        let arms =
            [chain("right", "upper arm", "forearm", "hand")?, chain("left", "upper arm", "forearm", "hand")?];
        let legs = [chain("right", "thigh", "calf", "foot")?, chain("left", "thigh", "calf", "foot")?];
        let mut this = Self {
            build,
            head,
            pelvis: frame("spine")?,
            chest,
            clavicles: [frame("right clavicle")?, frame("left clavicle")?],
            collar: [
                chest.local(kinematics.starts()[limb("neck")?]),
                chest.local(arms[0].upper.origin),
                chest.local(arms[1].upper.origin),
            ],
            arms,
            legs,
            hulls: Hulls::default(),
        };
        this.hulls = Hulls::of(&this);
        Some(this)
    }

    /// Distance from the figure's surface, negative inside; far away, a lower bound.
    ///
    /// It may overrate by a factor of at most 1.25.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        self.layers(point).nearest().0
    }

    /// Centre and radius of a ball that holds the whole figure.
    #[must_use]
    pub fn bounding_ball(&self) -> (DVec3, f64) {
        (self.hulls.centre, self.hulls.radius)
    }

    /// Where a ray (unit `direction`) first meets the figure: metres along it.
    #[must_use]
    pub fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        self.intersect_from(origin, direction, 0.0)
    }

    /// Where a ray (unit `direction`) first meets the figure beyond `from` metres along it.
    pub(super) fn intersect_from(&self, origin: DVec3, direction: DVec3, from: f64) -> Option<f64> {
        const TOUCHING: f64 = 2e-4;
        let (start, end) = self.within_ball(origin, direction, 0.0)?;
        let mut t = start.max(from);
        for _ in 0..STEPS {
            let distance = self.distance(origin + direction * t);
            if distance < TOUCHING {
                return Some(t);
            }
            t += distance * STEP;
            if t > end {
                return None;
            }
        }
        None
    }

    /// What all rays meet from `from` on whose unit directions are within `spread` of this one.
    pub(super) fn intersect_all(&self, origin: DVec3, direction: DVec3, spread: f64, from: f64) -> BundleHit {
        // Rays that come as near as this are looked at one by one.
        const CLEARANCE: f64 = 2e-3;
        // Most steps within the figure, and the least of each, metres.
        const INNER_STEPS: usize = 12;
        const INNER_STEP: f64 = 4e-3;
        let Some((start, end)) = self.within_ball(origin, direction, spread) else { return BundleHit::None };
        let mut t = start.max(from);
        for _ in 0..STEPS {
            // The ball around this point that is surely empty, without what the rays are apart here.
            let clear = self.distance(origin + direction * t) * STEP - spread * t - CLEARANCE;
            if clear < CLEARANCE {
                break;
            }
            t += clear / (1.0 + spread);
            if t > end {
                return BundleHit::None;
            }
        }
        // Where the figure is thicker than the rays are apart, all of them meet it.
        let mut inner = t;
        for _ in 0..INNER_STEPS {
            let distance = self.distance(origin + direction * inner);
            let width = spread * inner + CLEARANCE;
            if -distance * STEP > width {
                return BundleHit::All;
            }
            if distance > width {
                break;
            }
            inner += (distance.abs() * STEP).max(INNER_STEP);
        }
        BundleHit::Some(t)
    }

    /// From where to where rays within `spread` of this one may be in the ball that holds the figure.
    fn within_ball(&self, origin: DVec3, direction: DVec3, spread: f64) -> Option<(f64, f64)> {
        let (centre, radius) = self.bounding_ball();
        let wide = radius + spread * (origin.distance(centre) + radius);
        let middle = (centre - origin).dot(direction);
        let half = wide * wide - (centre - origin - direction * middle).length_squared();
        (half >= 0.0).then(|| ((middle - half.sqrt()).max(0.0), middle + half.sqrt()))
    }

    /// Outward unit normal near the surface.
    #[must_use]
    pub fn normal(&self, point: DVec3) -> DVec3 {
        const H: f64 = 4e-4;
        let corners = [
            DVec3::new(1.0, -1.0, -1.0),
            DVec3::new(-1.0, -1.0, 1.0),
            DVec3::new(-1.0, 1.0, -1.0),
            DVec3::ONE,
        ];
        corners
            .iter()
            .map(|&corner| corner * self.distance(point + corner * H))
            .sum::<DVec3>()
            .normalize_or(DVec3::Z)
    }

    /// The nearest part and material, for colouring.
    pub(super) fn touch(&self, point: DVec3) -> Touch {
        let (_, material) = self.layers(point).nearest();
        let mut part = (f64::INFINITY, Part::Trunk);
        for candidate in Part::ALL {
            let own = self.part(candidate, point).0
                [Layers::ORDER.iter().position(|&other| other == material).unwrap_or_default()];
            if own < part.0 {
                part = (own, candidate);
            }
        }
        let frame = match part.1 {
            Part::Head => &self.head,
            Part::Trunk => &self.chest,
            Part::Arm(side) => nearest_frame(&self.arms[side], point),
            Part::Leg(side) if material == Material::Shoe => &self.legs[side].end,
            Part::Leg(side) => nearest_frame(&self.legs[side], point),
        };
        Touch { material, local: frame.local(point), part: part.1 }
    }

    fn layers(&self, point: DVec3) -> Layers {
        let mut own = [None; Part::ALL.len()];
        let mut bounds = self.hulls.bounds(point);
        let mut nearest = f64::INFINITY;
        // The part whose box is nearest is likely the nearest: the others that may count are few then.
        for _ in Part::ALL {
            let (index, bound) = least(&bounds);
            if bound > REACH.min(nearest + REACH) {
                break;
            }
            let layers = self.part(Part::ALL[index], point);
            nearest = nearest.min(layers.nearest().0);
            (own[index], bounds[index]) = (Some(layers), f64::INFINITY);
        }
        let mut all = Layers([FAR; 5]);
        own.into_iter().flatten().for_each(|layers| all.join(layers));
        // A part that was left out may still be the nearest, at more than its bound.
        all.0[0] = bounds.into_iter().fold(all.0[0], f64::min);
        all
    }

    pub(super) fn part(&self, part: Part, point: DVec3) -> Layers {
        match part {
            Part::Head => self.head_layers(point),
            Part::Trunk => self.trunk_layers(point),
            Part::Arm(side) => self.arm_layers(side, point),
            Part::Leg(side) => self.leg_layers(side, point),
        }
    }
}

/// The first of the least numbers, and its place.
fn least(numbers: &[f64]) -> (usize, f64) {
    let lower = |least: (usize, f64), (index, &number): (usize, &f64)| {
        if number < least.1 { (index, number) } else { least }
    };
    numbers.iter().enumerate().fold((0, f64::INFINITY), lower)
}

fn nearest_frame(chain: &Chain, point: DVec3) -> &Frame {
    let middle = |a: &Frame, b: &Frame| point.distance((a.origin + b.origin) * 0.5);
    if middle(&chain.upper, &chain.lower) < middle(&chain.lower, &chain.end) {
        &chain.upper
    } else {
        &chain.lower
    }
}
