//! Directions of limbs in the frame of the trunk, and the joints that they are read from.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// Sides of a person, as pairs of joints count them.
const RIGHT: usize = 0;
const LEFT: usize = 1;

/// What a direction is seen from. Columns of either frame: the person's left, ahead, up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrunkFrame {
    /// Left along the hips, up along the spine.
    Pelvis,
    /// Up along the chest, left along the shoulders.
    Chest,
}

/// A direction of the body: a unit vector in a frame of the trunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the names say it")]
pub enum BodyDirection {
    ChestUp,
    ChestLeft,
    RightUpperArm,
    LeftUpperArm,
    RightForearm,
    LeftForearm,
    RightThigh,
    LeftThigh,
    RightCalf,
    LeftCalf,
    RightFoot,
    LeftFoot,
}

impl BodyDirection {
    /// All of them.
    pub const ALL: [Self; 12] = [
        Self::ChestUp,
        Self::ChestLeft,
        Self::RightUpperArm,
        Self::LeftUpperArm,
        Self::RightForearm,
        Self::LeftForearm,
        Self::RightThigh,
        Self::LeftThigh,
        Self::RightCalf,
        Self::LeftCalf,
        Self::RightFoot,
        Self::LeftFoot,
    ];

    /// What it is seen from: arms from the chest, all else from the pelvis.
    pub fn frame(self) -> TrunkFrame {
        if matches!(self as usize / 2, 1 | 2) { TrunkFrame::Chest } else { TrunkFrame::Pelvis }
    }

    /// The limb of a body that it is the direction of; `None` for the chest's own axes.
    pub fn limb(self) -> Option<String> {
        const LIMBS: [&str; 5] = ["upper arm", "forearm", "thigh", "calf", "foot"];
        let limb = LIMBS[(self as usize / 2).checked_sub(1)?];
        Some(format!("{} {limb}", ["right", "left"][self as usize % 2]))
    }
}

/// A person's joints at one moment, in any axes and any unit. Pairs are right, left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyPoints {
    /// Joints of the hips.
    pub hips: [DVec3; 2],
    /// Where the chest turns on the pelvis.
    pub waist: DVec3,
    /// The lower end of the neck.
    pub neck: DVec3,
    /// Joints of the upper arms.
    pub shoulders: [DVec3; 2],
    /// Elbows.
    pub elbows: [DVec3; 2],
    /// Wrists.
    pub wrists: [DVec3; 2],
    /// Knees.
    pub knees: [DVec3; 2],
    /// Ankles.
    pub ankles: [DVec3; 2],
    /// Where the toes begin.
    pub toes: [DVec3; 2],
}

impl BodyPoints {
    /// The columns of a frame of the trunk: the person's left, ahead, up. `None` where joints lie in one another or on one
    /// line.
    pub fn frame(&self, frame: TrunkFrame) -> Option<DMat3> {
        let middle = (self.hips[RIGHT] + self.hips[LEFT]) / 2.0;
        match frame {
            TrunkFrame::Pelvis => {
                let left = (self.hips[LEFT] - self.hips[RIGHT]).try_normalize()?;
                let up =
                    (self.waist - middle).try_normalize()?.reject_from_normalized(left).try_normalize()?;
                Some(DMat3::from_cols(left, left.cross(up), up))
            }
            TrunkFrame::Chest => {
                let up = (self.neck - self.waist).try_normalize()?;
                let across = (self.shoulders[LEFT] - self.shoulders[RIGHT]).try_normalize()?;
                let left = across.reject_from_normalized(up).try_normalize()?;
                Some(DMat3::from_cols(left, left.cross(up), up))
            }
        }
    }

    /// A direction as its frame sees it: a unit vector; `None` where joints lie in one another.
    pub fn direction(&self, direction: BodyDirection) -> Option<DVec3> {
        let along = |from: [DVec3; 2], to: [DVec3; 2]| {
            let side = direction as usize % 2;
            to[side] - from[side]
        };
        let in_world = match direction as usize / 2 {
            0 if direction == BodyDirection::ChestUp => self.frame(TrunkFrame::Chest)?.z_axis,
            0 => self.frame(TrunkFrame::Chest)?.x_axis,
            1 => along(self.shoulders, self.elbows),
            2 => along(self.elbows, self.wrists),
            3 => along(self.hips, self.knees),
            4 => along(self.knees, self.ankles),
            _ => along(self.ankles, self.toes),
        };
        Some(self.frame(direction.frame())?.transpose() * in_world.try_normalize()?)
    }

    /// The numbers of several directions, one after the other.
    pub fn numbers(&self, directions: &[BodyDirection]) -> Option<Vec<f64>> {
        let mut numbers = Vec::with_capacity(3 * directions.len());
        for &direction in directions {
            numbers.extend(self.direction(direction)?.to_array());
        }
        Some(numbers)
    }

    /// The person as in a mirror: right is left.
    pub fn mirrored(&self) -> Self {
        let mut flipped = self.moved(|p| DVec3::new(-p.x, p.y, p.z));
        flipped.pairs_mut().into_iter().for_each(|pair| pair.swap(RIGHT, LEFT));
        flipped
    }

    /// Each joint moved.
    fn moved(&self, to: impl Fn(DVec3) -> DVec3) -> Self {
        let mut moved = Self { waist: to(self.waist), neck: to(self.neck), ..*self };
        moved.pairs_mut().into_iter().for_each(|pair| *pair = pair.map(&to));
        moved
    }

    fn pairs_mut(&mut self) -> [&mut [DVec3; 2]; 7] {
        let Self { hips, shoulders, elbows, wrists, knees, ankles, toes, .. } = self;
        [hips, shoulders, elbows, wrists, knees, ankles, toes]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Someone who stands, x right, y ahead, z up, arms hanging, with the right forearm raised ahead.
    pub(crate) fn standing() -> BodyPoints {
        let pair = |x: f64, y: f64, z: f64| [DVec3::new(x, y, z), DVec3::new(-x, y, z)];
        let mut points = BodyPoints {
            hips: pair(0.1, 0.0, 0.9),
            waist: DVec3::new(0.0, 0.0, 1.14),
            neck: DVec3::new(0.0, 0.0, 1.4),
            shoulders: pair(0.18, 0.0, 1.38),
            elbows: pair(0.18, 0.0, 1.08),
            wrists: pair(0.18, 0.0, 0.82),
            knees: pair(0.1, 0.0, 0.48),
            ankles: pair(0.1, 0.0, 0.06),
            toes: pair(0.1, 0.16, 0.0),
        };
        points.wrists[RIGHT] = points.elbows[RIGHT] + DVec3::Y * 0.26;
        points
    }

    #[test]
    fn directions_are_seen_from_the_trunk_wherever_it_is_and_mirrored_ones_change_sides() {
        let points = standing();
        assert!(points.direction(BodyDirection::RightForearm).unwrap().distance(DVec3::Y) < 1e-12);
        assert!(points.direction(BodyDirection::LeftThigh).unwrap().distance(-DVec3::Z) < 1e-12);
        assert!(points.direction(BodyDirection::ChestLeft).unwrap().distance(DVec3::X) < 1e-12);
        let turn = crate::geometry::rotation::exp(DVec3::new(0.4, -1.1, 0.3));
        let turned = points.moved(|p| 3.0 * (turn * p) + DVec3::new(4.0, 5.0, -6.0));
        let flip = |v: DVec3| DVec3::new(-v.x, v.y, v.z);
        for (index, direction) in BodyDirection::ALL.into_iter().enumerate() {
            let here = points.direction(direction).unwrap();
            assert!(turned.direction(direction).unwrap().distance(here) < 1e-12, "{direction:?}");
            // Of each pair the other one, mirrored; the chest's left points the same way again.
            let other = if index < 2 { direction } else { BodyDirection::ALL[index ^ 1] };
            let expected = if direction == BodyDirection::ChestLeft { -flip(here) } else { flip(here) };
            let mirrored = turned.mirrored().direction(other).unwrap();
            assert!(mirrored.distance(expected) < 1e-12, "{direction:?}: {mirrored} for {expected}");
        }
        let flat = BodyPoints { knees: points.hips, ..points };
        assert_eq!(flat.direction(BodyDirection::RightThigh), None);
    }
}
