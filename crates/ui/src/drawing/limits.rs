//! The limits of a joint as one camera sees them: the arc of all that one of its angles may be, and where it stops.
//!
//! An arc is drawn where the limb would be if only that angle changed: for flexion and sideways swing, places of a
//! point of the limb about its first joint; for twist, places of a point beside the limb about its axis.

use backlit_tracking::body::{JointAngles, Kinematics, Limb, Model, Pose, Range};
use backlit_tracking::camera::Camera;
use backlit_tracking::posing::LimitedAngle;
use glam::{DVec2, DVec3};

use super::{JointId, joint_name};
use crate::style::format;

/// Degrees from a limit within which it is shown, and its mark warns.
pub const WARN_WITHIN: f64 = 3.0;
/// An angle so near to its limit is at it, radians.
const AT_LIMIT_RAD: f64 = 1e-3;
/// Squared half sine of a turn below which a limb was not turned.
const NOT_TURNED: f64 = 1e-9;
/// Most limits that are shown at once: those of the limbs that turned most.
const MOST: usize = 3;
/// Points of an arc.
const ARC_POINTS: u32 = 40;
/// Radius of an arc, as a share of the limb's length; of a twist's, in radii of the limb.
const ARC_SHARE: f64 = 0.8;
const TWIST_RADII: f64 = 1.9;

/// An angle of a joint that may not be everything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedAngle {
    /// The limb that owns the rotation.
    pub limb: usize,
    /// Which of its angles it is.
    pub angle: LimitedAngle,
    /// What it may be, radians.
    pub range: Range,
    /// What it is, radians.
    pub value_rad: f64,
}

impl BoundedAngle {
    /// An angle of a limb in a pose; `None` where it has no limits, or cannot move at all.
    pub fn new(model: &Model, pose: &Pose, limb: usize, angle: LimitedAngle) -> Option<Self> {
        let owner = model.limbs().get(limb)?;
        let limits = owner.limits?;
        let now = owner.angles(*pose.rotations.get(owner.rotation)?);
        let (range, value_rad) = match angle {
            LimitedAngle::Flexion => (limits.flexion, now.flexion),
            LimitedAngle::Sideways => (limits.sideways, now.sideways),
            LimitedAngle::Twist => (limits.twist, now.twist),
        };
        (range.1 - range.0 > 2.0 * AT_LIMIT_RAD).then_some(Self { limb, angle, range, value_rad })
    }

    /// The angles at their limits, or within [`WARN_WITHIN`] of them, of limbs that have turned between two poses:
    /// first those that are there, then those of the limbs that turned most; three at most.
    pub fn met(model: &Model, before: &Pose, now: &Pose) -> Vec<Self> {
        let mut met: Vec<(f64, Self)> = Vec::new();
        for (rotation, &limb) in model.rotation_owners().iter().enumerate() {
            let turned = 1.0 - before.rotations[rotation].dot(now.rotations[rotation]).abs();
            if turned < NOT_TURNED {
                continue;
            }
            let angles = [LimitedAngle::Flexion, LimitedAngle::Sideways, LimitedAngle::Twist];
            let bounded = angles.into_iter().filter_map(|angle| Self::new(model, now, limb, angle));
            met.extend(bounded.filter(Self::is_near).map(|bounded| (turned, bounded)));
        }
        met.sort_by(|(a, first), (b, second)| {
            second.is_reached().cmp(&first.is_reached()).then(b.total_cmp(a))
        });
        met.into_iter().map(|(_, bounded)| bounded).take(MOST).collect()
    }

    /// How far it is from the nearer limit, radians; negative beyond.
    pub fn left_rad(&self) -> f64 {
        (self.value_rad - self.range.0).min(self.range.1 - self.value_rad)
    }

    /// Whether it is at a limit, or beyond.
    pub fn is_reached(&self) -> bool {
        self.left_rad() <= AT_LIMIT_RAD
    }

    fn is_near(&self) -> bool {
        self.left_rad() <= WARN_WITHIN.to_radians()
    }

    /// The nearer of the limits, radians.
    fn nearer_rad(&self) -> f64 {
        if self.value_rad - self.range.0 < self.range.1 - self.value_rad {
            self.range.0
        } else {
            self.range.1
        }
    }

    /// "right knee: limit, flexion 145°", or how far it is from there; far from it, what it may be.
    pub fn words(&self, model: &Model) -> String {
        let joint = joint_of(model, self.limb);
        let degrees = |angle: f64| format!("{}°", format::number(angle.to_degrees(), 0));
        let name = self.angle.name();
        match () {
            () if self.is_reached() => format!("{joint}: limit, {name} {}", degrees(self.nearer_rad())),
            () if self.is_near() => {
                let left = format::number(self.left_rad().to_degrees(), 1);
                format!("{joint}: {left}° to the limit of {name}, {}", degrees(self.nearer_rad()))
            }
            () => {
                let [low, high] = [self.range.0, self.range.1].map(degrees);
                format!("{joint}: {name} {}, may be {low} to {high}", degrees(self.value_rad))
            }
        }
    }
}

/// What people call the joint at which a limb turns; the limb itself where others turn there too, as at the neck.
fn joint_of(model: &Model, limb: usize) -> String {
    let Some(limb) = model.limbs().get(limb) else { return String::new() };
    let Some(parent) = limb.parent else { return limb.name.clone() };
    let turn_there = |other: &&Limb| other.has_own_rotation && other.parent == limb.parent;
    if model.limbs().iter().filter(turn_there).count() > 1 {
        return limb.name.clone();
    }
    joint_name(model, JointId::End(parent))
}

/// The limits of an angle as one camera sees them, pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitMark {
    /// What the angle turns about.
    pub pivot: DVec2,
    /// All that it may be, from its lower limit to its upper.
    pub arc: Vec<DVec2>,
    /// Where the angle is now.
    pub now: DVec2,
    /// The limit that it is at.
    pub reached: Option<DVec2>,
    /// What it says in words.
    pub words: String,
}

impl LimitMark {
    /// Projects an angle of a posed body. `None` where some of the arc is behind the camera.
    pub fn new(
        model: &Model,
        pose: &Pose,
        kinematics: &Kinematics,
        camera: &Camera,
        bounded: &BoundedAngle,
    ) -> Option<Self> {
        let limb = model.limbs().get(bounded.limb)?;
        let frame = *kinematics.parent_frames().get(limb.rotation)?;
        let angles = limb.angles(*pose.rotations.get(limb.rotation)?);
        let start = *kinematics.starts().get(bounded.limb)?;
        let project = |point: DVec3| camera.project(point).filter(|px| px.is_finite());
        let pivot = match bounded.angle {
            LimitedAngle::Twist => 0.5 * (start + kinematics.ends()[bounded.limb]),
            LimitedAngle::Flexion | LimitedAngle::Sideways => start,
        };
        let at = |value: f64| project(pivot + frame * arm(limb, angles, bounded.angle, value));
        let Range(low, high) = bounded.range;
        let share = |point: u32| f64::from(point) / f64::from(ARC_POINTS);
        let arc: Option<Vec<DVec2>> =
            (0..=ARC_POINTS).map(|point| at(low + (high - low) * share(point))).collect();
        let reached = bounded.is_reached().then(|| at(bounded.nearer_rad())).flatten();
        Some(Self {
            pivot: project(pivot)?,
            arc: arc?,
            now: at(bounded.value_rad)?,
            reached,
            words: bounded.words(model),
        })
    }
}

/// From the pivot to the arc, in the parent's frame, with one of the angles as given.
fn arm(limb: &Limb, mut angles: JointAngles, angle: LimitedAngle, value: f64) -> DVec3 {
    match angle {
        LimitedAngle::Flexion => angles.flexion = value,
        LimitedAngle::Sideways => angles.sideways = value,
        LimitedAngle::Twist => angles.twist = value,
    }
    let turn = limb.rotation_from_angles(angles);
    if angle == LimitedAngle::Twist {
        turn * limb.swing_axes().0 * (TWIST_RADII * limb.radius)
    } else {
        turn * limb.direction * (ARC_SHARE * limb.length)
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin::full_body;

    use super::*;
    use crate::drawing::input::tests::camera;

    fn bent(degrees: f64) -> (Model, Pose, usize) {
        let model = full_body();
        let forearm = model.limb_index("right forearm").unwrap();
        let limb = &model.limbs()[forearm];
        let mut pose = Pose::rest(&model);
        pose.rotations[limb.rotation] = limb
            .rotation_from_angles(JointAngles { flexion: degrees.to_radians(), ..JointAngles::default() });
        (model, pose, forearm)
    }

    #[test]
    fn a_limit_is_named_by_its_joint_when_the_limb_has_turned_there() {
        let (model, rest, forearm) = bent(40.0);
        let range = model.limbs()[forearm].limits.unwrap().flexion;
        let at = |degrees: f64| BoundedAngle::met(&model, &rest, &bent(degrees).1);
        assert_eq!(at(40.0), [], "nothing has turned");
        assert_eq!(at(60.0).iter().filter(|met| met.angle == LimitedAngle::Flexion).count(), 0, "far away");
        let highest = range.1.to_degrees();
        let near = at(highest - 2.0)[0];
        assert!(!near.is_reached());
        assert!(near.words(&model).starts_with("right elbow: 2.0° to the limit of flexion"), "{near:?}");
        let there = at(highest)[0];
        assert_eq!(there.words(&model), format!("right elbow: limit, flexion {}°", highest.round()));
        let names =
            ["right clavicle", "right calf"].map(|limb| joint_of(&model, model.limb_index(limb).unwrap()));
        assert_eq!(names, ["right clavicle", "right knee"]);
        let free = BoundedAngle::new(&model, &rest, forearm, LimitedAngle::Flexion).unwrap();
        assert!(free.words(&model).contains("flexion 40°, may be "), "{}", free.words(&model));
    }

    #[test]
    fn the_arc_goes_through_the_limb_and_ends_at_its_limits() {
        let highest = {
            let (model, _, forearm) = bent(0.0);
            model.limbs()[forearm].limits.unwrap().flexion.1.to_degrees()
        };
        let (model, pose, forearm) = bent(highest);
        let kinematics = Kinematics::new(&model, &pose);
        let (start, end) = (kinematics.starts()[forearm], kinematics.ends()[forearm]);
        let from = start + DVec3::new(0.4, 0.3, 2.5);
        let camera = camera([120, 120], [100.0, 60.0, 60.0], from, start, DVec3::Y);
        for angle in [LimitedAngle::Flexion, LimitedAngle::Sideways, LimitedAngle::Twist] {
            let Some(bounded) = BoundedAngle::new(&model, &pose, forearm, angle) else { continue };
            let mark = LimitMark::new(&model, &pose, &kinematics, &camera, &bounded).unwrap();
            if angle != LimitedAngle::Flexion {
                continue;
            }
            let on_limb = camera.project(start.lerp(end, ARC_SHARE)).unwrap();
            assert!(mark.now.distance(on_limb) < 1e-6, "{} {on_limb}", mark.now);
            assert!(mark.reached.unwrap().distance(on_limb) < 0.2);
            assert!(mark.arc.last().unwrap().distance(on_limb) < 1e-6);
            assert!(mark.pivot.distance(camera.project(start).unwrap()) < 1e-9);
        }
    }
}
