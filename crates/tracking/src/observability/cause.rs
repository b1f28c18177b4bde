//! Why a direction is weak: its motion shared out among what cameras can and cannot see of limbs.
//!
//! A step moves limb l of length s and radius r by velocities m = (v₀, v₁) of its joints and a turn τ about its own
//! axis. Energies, in m⁴ so that long limbs count more:
//!
//! ```text
//! twist   s r² τ²                   a round limb's silhouette does not change, in whatever camera
//! axis    s |m|² / 2 = s (|Pm|² + |m − Pm|²) / 2
//! ```
//!
//! P projects on the eigenvectors of G = Σ w G of the cameras (6 × 6, [`LimbSight::by_ends`]) whose eigenvalues are below
//! [`UNSEEN`] of its largest: motion of that limb of which its own pixels say next to nothing. Pm is named by what it is along:
//! the lines of sight of *every* camera that sees the limb, the limb's own axis, or the far end of a limb that points at
//! those cameras. A limb without pixels on a ramp is all unseen, and is named by what covers it.
//! The rest, m − Pm, is seen; if a direction is weak nevertheless, limbs make up for each other.

use glam::DVec3;
use nalgebra::{Matrix6, SVector, Vector6};

use super::information::{FrameInformation, LimbSight};
use crate::body::Parameters;

/// A limb's motion of which its pixels say less than this share of what they say of its best seen motion is unseen.
const UNSEEN: f64 = 0.02;
/// A camera with less than this share of what all say of a limb does not see it.
const SEES_SHARE: f64 = 0.02;
/// With fewer pixels on a ramp than this a limb is not seen.
const FEWEST_PIXELS: usize = 3;
/// Motion is along something if this share of its energy is.
const ALONG: f64 = 0.6;
/// A limb points at a camera within this cosine (26°).
const END_ON: f64 = 0.9;

/// What can be said of a part of a direction's motion.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The limb turns about its own axis.
    Twist,
    /// It moves along the lines of sight of the cameras that see it: by index.
    Depth(Vec<usize>),
    /// It points at the cameras that see it, and its far end moves.
    EndOn(Vec<usize>),
    /// It slides along its own axis.
    Along,
    /// Other limbs are darker wherever it is in a picture.
    Covered,
    /// It is the darkest limb at some pixels, none of which is on a ramp: it lies inside the silhouettes.
    Inside,
    /// No part of its axis is in any picture.
    OutOfPictures,
    /// Its pixels say next to nothing of this motion, for no reason that has a name.
    Unclear,
    /// Its pixels tell this motion.
    Seen,
}

/// A part of a direction's motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Share {
    /// Which limb moves: the one that owns the rotation it turns with.
    pub limb: usize,
    /// Why that is not seen, or that it is.
    pub cause: Cause,
    /// Of all energy, 0 to 1.
    pub share: f64,
}

/// The shares of a step's motion, the largest first; none for a step that moves nothing.
pub(super) fn shares(
    information: &FrameInformation,
    cameras: &[usize],
    step: &nalgebra::DVector<f64>,
) -> Vec<Share> {
    let (model, kinematics) = (&information.model, &information.kinematics);
    let mut shares: Vec<Share> = Vec::new();
    let mut columns = Vec::new();
    for (index, limb) in model.limbs().iter().enumerate() {
        kinematics.moving_columns_into(index, Parameters::Tangent, &mut columns);
        let moved = columns.iter().fold(SVector::<f64, 7>::zeros(), |sum, column| {
            sum + SVector::from(column.motion) * step[column.index]
        });
        let v0 = DVec3::new(moved[0], moved[1], moved[2]);
        let turn = DVec3::new(moved[3], moved[4], moved[5]);
        let axis = kinematics.ends()[index] - kinematics.starts()[index];
        let unit = axis.normalize();
        let owner = model.rotation_owners()[limb.rotation];
        let mut add = |cause: Cause, energy: f64| {
            if energy > 0.0 {
                match shares.iter_mut().find(|share| share.limb == owner && share.cause == cause) {
                    Some(share) => share.share += energy,
                    None => shares.push(Share { limb: owner, cause, share: energy }),
                }
            }
        };
        add(Cause::Twist, limb.length * (limb.radius * turn.dot(unit)).powi(2));
        let motion = AxisMotion { of_ends: [v0, v0 + turn.cross(axis)], axis: unit };
        for (cause, energy) in motion.causes(information, cameras, index) {
            add(cause, 0.5 * limb.length * energy);
        }
    }
    let total: f64 = shares.iter().map(|share| share.share).sum();
    if total <= 0.0 || !total.is_finite() {
        return Vec::new();
    }
    shares.iter_mut().for_each(|share| share.share /= total);
    shares.sort_by(|a, b| {
        b.share.total_cmp(&a.share).then(a.limb.cmp(&b.limb)).then_with(|| a.cause.cmp(&b.cause))
    });
    shares
}

/// How a limb's axis moves.
struct AxisMotion {
    of_ends: [DVec3; 2],
    /// Unit length.
    axis: DVec3,
}

impl AxisMotion {
    /// What is seen and what is not, with energies in m².
    fn causes(&self, information: &FrameInformation, cameras: &[usize], limb: usize) -> Vec<(Cause, f64)> {
        let [a, b] = self.of_ends;
        let motion = Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z);
        let energy = motion.norm_squared();
        let sights: Vec<(usize, f64, &LimbSight)> = cameras
            .iter()
            .filter_map(|&camera| {
                let part = information.cameras.get(camera)?.as_ref()?;
                Some((camera, part.weight, &part.limbs[limb]))
            })
            .collect();
        if sights.iter().map(|(_, _, sight)| sight.on_ramp).sum::<usize>() < FEWEST_PIXELS {
            return vec![(unseen_limb(&sights), energy)];
        }
        let said: Matrix6<f64> = sights.iter().map(|(_, weight, sight)| sight.by_ends * *weight).sum();
        let unseen = projected_on_unseen(&said, &motion);
        let hidden = unseen.norm_squared();
        let total = said.trace();
        let seers: Vec<usize> = sights
            .iter()
            .filter(|(_, weight, sight)| weight * sight.by_ends.trace() > SEES_SHARE * total)
            .map(|(camera, ..)| *camera)
            .collect();
        let cause = self.named(information, seers, limb, &unseen);
        vec![(Cause::Seen, (energy - hidden).max(0.0)), (cause, hidden)]
    }

    /// What an unseen motion is along.
    fn named(
        &self,
        information: &FrameInformation,
        seers: Vec<usize>,
        limb: usize,
        unseen: &Vector6<f64>,
    ) -> Cause {
        let energy = unseen.norm_squared();
        if energy <= 0.0 {
            return Cause::Unclear;
        }
        let by_end = [0, 3].map(|at| DVec3::new(unseen[at], unseen[at + 1], unseen[at + 2]));
        let ends = [information.kinematics.starts()[limb], information.kinematics.ends()[limb]];
        let rays = |camera: usize| {
            let centre =
                information.cameras[camera].as_ref().map_or(DVec3::ZERO, |part| part.camera.centre());
            ends.map(|end| (end - centre).normalize())
        };
        let along = |[a, b]: [DVec3; 2]| (by_end[0].dot(a).powi(2) + by_end[1].dot(b).powi(2)) / energy;
        // What one camera sees of it is seen: it must be along every one's line of sight.
        let least = |of: &dyn Fn(usize) -> f64| seers.iter().map(|&camera| of(camera)).fold(1.0, f64::min);
        let depth = least(&|camera| along(rays(camera)));
        let pointing = least(&|camera| rays(camera).map(|ray| ray.dot(self.axis).abs())[0]);
        if depth >= ALONG && !seers.is_empty() {
            Cause::Depth(seers)
        } else if pointing >= END_ON && !seers.is_empty() {
            Cause::EndOn(seers)
        } else if along([self.axis; 2]) >= ALONG {
            Cause::Along
        } else {
            Cause::Unclear
        }
    }
}

/// The part of a motion in the eigenvectors of which next to nothing is said.
fn projected_on_unseen(said: &Matrix6<f64>, motion: &Vector6<f64>) -> Vector6<f64> {
    let eigen = said.symmetric_eigen();
    let least = UNSEEN * eigen.eigenvalues.max();
    let columns = eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter());
    columns
        .filter(|(_, value)| **value < least)
        .fold(Vector6::zeros(), |sum, (vector, _)| sum + vector * vector.dot(motion))
}

/// Why no pixel of a limb is on a ramp.
fn unseen_limb(sights: &[(usize, f64, &LimbSight)]) -> Cause {
    if !sights.iter().any(|(_, _, sight)| sight.in_picture) {
        Cause::OutOfPictures
    } else if sights.iter().all(|(_, _, sight)| sight.won == 0) {
        Cause::Covered
    } else {
        Cause::Inside
    }
}
