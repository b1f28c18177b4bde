//! Where the markers or keypoints of a tool sit beside the joints of a body.
//!
//! A marker means another place than a joint of ours, always about the same one of the person: it is p + F o, with p the joint's
//! place, F (3 × 3, world from limb) the axes of its limb and o, metres, its offset. Offsets are kept per tool and taken off,
//! as landmarks are calibrated in the frame of a segment (Cappozzo et al., Clinical Biomechanics 10, 1995). `OpenPose` puts hips,
//! knees and ankles up to 30 mm and more from the joints in this way (Needham et al., Scientific Reports 11:20673, 2021).
//!
//! F is the axes of the body's first rotation, turned the shortest way until the limb's direction at rest is its direction now.
//! A limb's turn about itself is left out: cameras hardly see it, and what is not seen would scatter the offsets. Opposite to the
//! direction at rest (an arm straight up, on a body whose arms hang) such axes jump, as any without that turn must.
//!
//! An offset is the geometric median of what was seen, the place from which the mean distance is least (Weiszfeld, Tohoku
//! Mathematical Journal 43, 1937): the mean distance is what tables have, and one marker mistaken for another moves it little.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec3};

use crate::body::{Kinematics, Model};

/// Fewer frames than this say nothing of an offset, and cannot be divided into frames to learn from and to judge.
pub const FEWEST_FRAMES: usize = 8;
/// The frames of a track are divided into this many stretches: two are learnt from while the other two are judged.
const STRETCHES: usize = 4;
/// Weiszfeld's steps: the last ones move by far less than anything that is measured.
const STEPS: usize = 100;
/// A place nearer than this, metres, weighs no more.
const NEAR: f64 = 1e-5;

/// Where a tool puts its markers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MarkerPlacement {
    /// The tool, or its set of markers: COCO, `BODY_25`, `OpenCap` …
    pub tool: String,
    /// By the joint's name: a limb's, whose second joint is meant, or "root". A joint left out has no offset.
    pub offsets: BTreeMap<String, MarkerOffset>,
}

/// Where the marker of one joint is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarkerOffset {
    /// From the joint to its marker in the limb's axes, metres.
    pub offset: DVec3,
    /// Mean distance from there, metres, of the markers that it was learnt from.
    pub spread: f64,
    /// In how many frames they were seen.
    pub frames: usize,
}

impl MarkerOffset {
    /// Of markers' places beside their joint, one a frame, in the limb's axes, metres; `None` of fewer than
    /// [`FEWEST_FRAMES`] / 2.
    pub(super) fn learn(places: &[DVec3]) -> Option<Self> {
        let frames = places.len();
        if frames < FEWEST_FRAMES / 2 {
            return None;
        }
        let mut offset = places.iter().sum::<DVec3>() / frames as f64;
        for _ in 0..STEPS {
            let weights = || places.iter().map(|place| 1.0 / place.distance(offset).max(NEAR));
            let sum: DVec3 = places.iter().zip(weights()).map(|(place, weight)| weight * *place).sum();
            offset = sum / weights().sum::<f64>();
        }
        let spread = places.iter().map(|place| place.distance(offset)).sum::<f64>() / frames as f64;
        Some(Self { offset, spread, frames })
    }
}

/// Distances, in the unit of the places, from an offset learnt in other frames: of four equal stretches of the frames in their
/// order the first and the third judge what the others teach, and the other way round. Neighbouring frames are wrong alike, so that
/// single frames held out would flatter. `None` of fewer than [`FEWEST_FRAMES`].
pub(super) fn held_out(places: &[DVec3]) -> Option<Vec<f64>> {
    if places.len() < FEWEST_FRAMES {
        return None;
    }
    let part = |frame: usize| frame * STRETCHES / places.len() % 2;
    let learn = |of: usize| {
        let others = places.iter().enumerate().filter(|(frame, _)| part(*frame) != of);
        MarkerOffset::learn(&others.map(|(_, place)| *place).collect::<Vec<_>>())
    };
    let learnt = [learn(0)?, learn(1)?];
    let judged = places.iter().enumerate();
    Some(judged.map(|(frame, place)| place.distance(learnt[part(frame)].offset)).collect())
}

/// The axes in which a joint's marker stays where it is, F of the [module](self), and the place of the joint; `limb` is the joint's, or
/// `None` for the root.
pub(super) fn axes_of(model: &Model, kinematics: &Kinematics, limb: Option<usize>) -> (DMat3, DVec3) {
    let of = &model.limbs()[limb.unwrap_or(0)];
    let mut first = of.rotation;
    while let Some(parent) = model.rotation_parents()[first] {
        first = parent;
    }
    let trunk = unit(kinematics.world_rotations()[first]);
    let Some(limb) = limb else { return (trunk, kinematics.starts()[0]) };
    let now = unit(kinematics.world_rotations()[of.rotation]) * of.direction;
    let turn = DMat3::from_quat(DQuat::from_rotation_arc(trunk * of.direction, now));
    (turn * trunk, kinematics.ends()[limb])
}

/// Without the scale that raw quaternions give.
fn unit(rotation: DMat3) -> DMat3 {
    rotation * (1.0 / rotation.x_axis.length())
}
