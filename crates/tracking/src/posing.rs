//! Moving a body by hand. A dragged joint's chain follows through the same optimiser that fits silhouettes:
//! a point residual for the joint, one for every pin, and a proximal prior that shares the bend out.

mod follow;
mod turn_round;

use glam::{DQuat, DVec3};
use nalgebra::DVector;

use crate::body::{JointAngles, JointLimits, Kinematics, Limb, Model, Parameters, Pose, Range};
use crate::optimize::{LeastSquares, Method, NormalEquations, Solver, SolverOptions, Tolerances};
use crate::residual::point::PointTarget;
use crate::residual::{point, pose_prior};

pub use follow::Follower;
pub use turn_round::turn_round;

/// Weight of the dragged joint, per m².
const TARGET_WEIGHT: f64 = 1.0;
/// Weight of a pin, per m²: pins give way last.
const PIN_WEIGHT: f64 = 30.0;
/// Pull of every rotation towards where it was, per rad².
const STIFFNESS: f64 = 1e-4;
/// The same of the trunk in a drag: a limb's own chain bends before it. Half a radian of an elbow is to be cheaper than
/// the tenth of a radian by which a trunk moves a hand as far, thirty times over.
const TRUNK_STIFFNESS: f64 = 0.1;
/// The same of a rotation that turns the whole body.
const BODY_STIFFNESS: f64 = 1.0;
/// Pull of the root towards where it was, per m²: limbs bend before the body goes along.
const ROOT_STIFFNESS: f64 = 1.0;
/// All of these where the trunk is held.
const HELD_STIFFNESS: f64 = 1e5;
/// Weight of joint limits, per rad²: a hundredth of a radian stands for a tenth of a metre of the target.
const LIMIT_WEIGHT: f64 = 100.0;
/// Most iterations of one solve.
const ITERATIONS: usize = 40;
/// Most solves of one drag event. Each shifts the targets by what the priors have held back.
const CORRECTIONS: usize = 6;
/// A joint that is so near to where it was dragged is there, metres.
const ARRIVED_M: f64 = 1e-4;
/// An angle so near to its limit is at it, radians.
const AT_LIMIT_RAD: f64 = 1e-3;

struct Reach<'a> {
    model: &'a Model,
    reference: &'a Pose,
    targets: &'a [PointTarget],
    /// By rotation, per rad².
    stiffness: &'a [f64],
    /// Of the root, per m².
    root_stiffness: f64,
    kinematics: Kinematics,
}

impl LeastSquares for Reach<'_> {
    type Point = Pose;

    fn evaluate(&mut self, pose: &Pose, equations: &mut NormalEquations) {
        let &mut Self { model, reference, targets, stiffness, root_stiffness, ref mut kinematics } = self;
        let parameters = Parameters::Tangent;
        kinematics.update(model, pose);
        for target in targets {
            point::add(equations, parameters, kinematics, pose.root, target);
        }
        pose_prior::add_proximal_each(equations, parameters, pose, reference, stiffness, root_stiffness);
        pose_prior::add_limits(equations, parameters, model, pose, LIMIT_WEIGHT);
    }

    fn columns(&self) -> usize {
        Parameters::Tangent.columns(self.model.rotation_count())
    }

    fn retract(&self, pose: &Pose, step: &DVector<f64>) -> Pose {
        pose.retract(Parameters::Tangent, step.as_slice())
    }
}

/// Weight of a joint's place where all are given, per m²: far above the stiffness, below that of joint limits.
const PLACE_WEIGHT: f64 = 1.0;

/// Solves for the pose nearest to `reference` that puts joints where `targets` say.
#[must_use]
pub fn reach(model: &Model, reference: &Pose, targets: &[PointTarget]) -> Pose {
    let stiffness = vec![STIFFNESS; model.rotation_count()];
    reach_from(model, reference, reference.clone(), targets, (&stiffness, ROOT_STIFFNESS))
}

/// Solves for the pose that puts the second joint of every limb where `place` says: round after round, each from the last one's
/// pose, whose priors hold less back.
pub(crate) fn reach_all(model: &Model, pose: &Pose, rounds: usize, place: impl Fn(usize) -> DVec3) -> Pose {
    let target = |limb| PointTarget { limb: Some(limb), target: place(limb), weight: PLACE_WEIGHT };
    let targets: Vec<PointTarget> = (0..model.limbs().len()).map(target).collect();
    (0..rounds).fold(pose.clone(), |pose, _| reach(model, &pose, &targets))
}

fn reach_from(
    model: &Model,
    reference: &Pose,
    start: Pose,
    targets: &[PointTarget],
    (stiffness, root_stiffness): (&[f64], f64),
) -> Pose {
    let kinematics = Kinematics::new(model, reference);
    let mut chain = Reach { model, reference, targets, stiffness, root_stiffness, kinematics };
    let options = SolverOptions {
        method: Method::LevenbergMarquardt,
        damping: 1e-3,
        least_scale: 0.0,
        max_iterations: ITERATIONS,
        tolerances: Tolerances::by_gain(Some(1e-6)),
        run_all: false,
    };
    let mut solver = Solver::new(&mut chain, start, options);
    while solver.step(&mut chain).is_some() {}
    solver.point.clone()
}

/// What stays where it is while a joint is dragged.
#[derive(Debug, Clone, Copy, Default)]
pub struct Held<'a> {
    /// Limbs whose second joints stay, if they can.
    pub pins: &'a [usize],
    /// Whether nothing but the chain that carries the joint moves: the joint stops where the chain ends.
    pub trunk: bool,
}

/// Drags a limb's second joint to a point of the world (metres); what is held stays.
///
/// Without pins the joint arrives, with them within a tenth of a millimetre where they and the limits let it: what the
/// priors hold back is added to the targets, again and again. `reference` is the pose in which the drag began: dragging back undoes itself. No
/// angle leaves its limits; one that was outside in `reference` may only come back.
#[must_use]
pub fn drag_limb_end(model: &Model, reference: &Pose, limb: usize, target: DVec3, held: Held<'_>) -> Pose {
    let kinematics = Kinematics::new(model, reference);
    let mut wanted = vec![PointTarget { limb: Some(limb), target, weight: TARGET_WEIGHT }];
    wanted.extend(held.pins.iter().filter(|&&pin| pin != limb).map(|&pin| PointTarget {
        limb: Some(pin),
        target: kinematics.ends()[pin],
        weight: PIN_WEIGHT,
    }));
    let lenient = widened(model, reference);
    let mut shifted = wanted.clone();
    let (stiffness, root_stiffness) = if held.trunk {
        (stiffness(model, limb, [HELD_STIFFNESS; 2]), HELD_STIFFNESS)
    } else if wanted.len() == 1 {
        (stiffness(model, limb, [TRUNK_STIFFNESS, BODY_STIFFNESS]), ROOT_STIFFNESS)
    } else {
        // Pins ask for the help of the whole body.
        (vec![STIFFNESS; model.rotation_count()], ROOT_STIFFNESS)
    };
    let stiffness = (&stiffness[..], root_stiffness);
    let mut pose = reach_from(&lenient, reference, reference.clone(), &shifted, stiffness);
    let mut left = f64::INFINITY;
    for _ in 1..CORRECTIONS {
        let ends = Kinematics::new(model, &pose);
        let misses = wanted.iter().map(|wanted| wanted.target - ends.ends()[wanted.limb.unwrap_or(limb)]);
        let misses: Vec<DVec3> = misses.collect();
        let largest = misses.iter().map(|miss| miss.length()).fold(0.0, f64::max);
        // What does not come nearer is out of reach: no pushing against a limit or a pin.
        if largest < ARRIVED_M || largest > 0.9 * left {
            break;
        }
        left = largest;
        for (target, miss) in shifted.iter_mut().zip(misses) {
            target.target += miss;
        }
        pose = reach_from(&lenient, reference, pose, &shifted, stiffness);
    }
    let mut pose = within_limits(model, reference, &pose);
    if held.trunk {
        pose.root = reference.root;
    } else if wanted.len() == 1 {
        // Nothing is pinned: the body goes along with what the limits have taken back.
        pose.root += target - Kinematics::new(model, &pose).ends()[limb];
    }
    pose
}

/// How hard each rotation is to turn when a limb's end is held: the chain that carries it is light as far as no other
/// chain grows from it, the trunk is not, and the whole body is heavy.
fn stiffness(model: &Model, limb: usize, [trunk, body]: [f64; 2]) -> Vec<f64> {
    let parents = model.rotation_parents();
    let mut stiffness: Vec<f64> =
        parents.iter().map(|parent| if parent.is_some() { trunk } else { body }).collect();
    let children = |rotation: usize| parents.iter().filter(|parent| **parent == Some(rotation)).count();
    let mut next = Some(model.limbs()[limb].rotation);
    while let Some(rotation) = next {
        stiffness[rotation] = STIFFNESS;
        next = parents[rotation].filter(|parent| children(*parent) == 1);
    }
    stiffness
}

/// An angle of a limb's own rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitedAngle {
    /// Swing about the flexion axis.
    Flexion,
    /// Swing about direction × flexion axis.
    Sideways,
    /// Turn about the limb itself.
    Twist,
}

impl LimitedAngle {
    /// What people call it: "flexion", "sideways swing", "twist".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flexion => "flexion",
            Self::Sideways => "sideways swing",
            Self::Twist => "twist",
        }
    }
}

/// An angle that is at its limit, or beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitReached {
    /// The limb that owns the rotation.
    pub limb: usize,
    /// Which of its angles.
    pub angle: LimitedAngle,
    /// The limit, radians.
    pub limit_rad: f64,
}

/// All angles of a pose that are within a thousandth of a radian of a limit, or beyond, in the order of rotations.
#[must_use]
pub fn limits_reached(model: &Model, pose: &Pose) -> Vec<LimitReached> {
    let mut reached = Vec::new();
    for (rotation, &limb) in model.rotation_owners().iter().enumerate() {
        let Some(limits) = model.limbs()[limb].limits else { continue };
        let angles = model.limbs()[limb].angles(pose.rotations[rotation]);
        for (angle, value, Range(low, high)) in [
            (LimitedAngle::Flexion, angles.flexion, limits.flexion),
            (LimitedAngle::Sideways, angles.sideways, limits.sideways),
            (LimitedAngle::Twist, angles.twist, limits.twist),
        ] {
            // An angle that cannot move at all is no news.
            let can_move = high - low > 2.0 * AT_LIMIT_RAD;
            if can_move && value <= low + AT_LIMIT_RAD {
                reached.push(LimitReached { limb, angle, limit_rad: low });
            } else if can_move && value >= high - AT_LIMIT_RAD {
                reached.push(LimitReached { limb, angle, limit_rad: high });
            }
        }
    }
    reached
}

/// The pose with every angle held to its limits; one that is outside in `reference` stays where it may come back from.
/// A rotation that is as in `reference` is left to the bit.
#[must_use]
pub fn within_limits(model: &Model, reference: &Pose, pose: &Pose) -> Pose {
    let mut held = pose.clone();
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        let limb = &model.limbs()[owner];
        if pose.rotations[rotation] == reference.rotations[rotation] {
            continue;
        }
        let Some(limits) = limits_of(limb, reference.rotations[rotation]) else { continue };
        let angles = limb.angles(pose.rotations[rotation]);
        let clamped = JointAngles {
            flexion: angles.flexion.clamp(limits.flexion.0, limits.flexion.1),
            sideways: angles.sideways.clamp(limits.sideways.0, limits.sideways.1),
            twist: angles.twist.clamp(limits.twist.0, limits.twist.1),
        };
        if clamped != angles {
            held.rotations[rotation] = limb.rotation_from_angles(clamped);
        }
    }
    held
}

/// A limb's limits, wide enough for a rotation that it has.
fn limits_of(limb: &Limb, rotation: DQuat) -> Option<JointLimits> {
    let limits = limb.limits?;
    let now = limb.angles(rotation);
    let wide = |range: Range, angle: f64| Range(range.0.min(angle), range.1.max(angle));
    Some(JointLimits {
        flexion: wide(limits.flexion, now.flexion),
        sideways: wide(limits.sideways, now.sideways),
        twist: wide(limits.twist, now.twist),
        ..limits
    })
}

/// The model with limits that are wide enough for a pose: nothing is drawn in when a drag begins.
fn widened(model: &Model, pose: &Pose) -> Model {
    let mut spec = model.to_spec();
    for spec in &mut spec.limbs {
        // The specification has the file's order, the model parents first.
        let limb = model.limb_index(&spec.name).map(|index| &model.limbs()[index]);
        if let Some(limb) = limb.filter(|limb| limb.has_own_rotation) {
            spec.limits = limits_of(limb, pose.rotations[limb.rotation]);
        }
    }
    Model::new(&spec).unwrap_or_else(|_| model.clone())
}

/// Turns a limb about its first joint by a rotation given in world axes; what grows from it turns along.
///
/// A limb that is rigid with another turns that one's rotation.
#[must_use]
pub fn turn_limb(model: &Model, pose: &Pose, limb: usize, turn_in_world: DQuat) -> Pose {
    let kinematics = Kinematics::new(model, pose);
    let rotation = model.limbs()[limb].rotation;
    let frame = DQuat::from_mat3(&kinematics.parent_frames()[rotation]);
    let mut turned = pose.clone();
    turned.rotations[rotation] =
        (frame.inverse() * turn_in_world * frame * pose.rotations[rotation]).normalize();
    turned
}

/// Turns a limb about its own axis by an angle in radians.
#[must_use]
pub fn twist_limb(model: &Model, pose: &Pose, limb: usize, angle: f64) -> Pose {
    let kinematics = Kinematics::new(model, pose);
    let axis = (kinematics.ends()[limb] - kinematics.starts()[limb]).normalize();
    turn_limb(model, pose, limb, DQuat::from_axis_angle(axis, angle))
}

/// The pose mirrored between right and left, about the body's own plane: "right …" and "left …" limbs trade
/// places, the root and the first rotation stay where they are.
#[must_use]
pub fn mirror(model: &Model, pose: &Pose) -> Pose {
    let mut mirrored = pose.clone();
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        if model.rotation_parents()[rotation].is_none() {
            continue;
        }
        let other = model.limbs()[model.mirrored_limb(owner)].rotation;
        // Mirroring x ↦ −x turns a rotation vector (x, y, z) into (x, −y, −z).
        let q = pose.rotations[other];
        mirrored.rotations[rotation] = DQuat::from_xyzw(q.x, -q.y, -q.z, q.w);
    }
    mirrored
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;

    #[test]
    fn a_dragged_wrist_arrives_and_pinned_feet_stay() {
        let model = builtin::full_body();
        let rest = Pose::rest(&model);
        let wrist = model.limb_index("right forearm").unwrap();
        let feet = ["right foot", "left foot"].map(|name| model.limb_index(name).unwrap());
        let before = Kinematics::new(&model, &rest);
        let target = before.ends()[wrist] + DVec3::new(0.15, 0.2, 0.25);
        let after = Kinematics::new(
            &model,
            &drag_limb_end(&model, &rest, wrist, target, Held { pins: &feet, trunk: false }),
        );
        assert!(after.ends()[wrist].distance(target) < 0.005, "{}", after.ends()[wrist].distance(target));
        for foot in feet {
            assert!(after.ends()[foot].distance(before.ends()[foot]) < 0.005);
        }
    }

    #[test]
    fn out_of_reach_the_joint_comes_as_near_as_it_can() {
        let model = builtin::full_body();
        let rest = Pose::rest(&model);
        let wrist = model.limb_index("left forearm").unwrap();
        let pose = drag_limb_end(&model, &rest, wrist, DVec3::new(-5.0, 3.0, 9.0), Held::default());
        assert_eq!(pose.check(&model), Ok(()));
    }

    /// A person with both elbows bent by a right angle.
    fn with_bent_elbows(model: &Model) -> Pose {
        let mut pose = Pose::rest(model);
        for side in ["right", "left"] {
            let limb = &model.limbs()[model.limb_index(&format!("{side} forearm")).unwrap()];
            pose.rotations[limb.rotation] =
                limb.rotation_from_angles(JointAngles { flexion: 1.5, ..JointAngles::default() });
        }
        pose
    }

    #[test]
    fn a_wrist_is_moved_by_its_own_arm_while_the_elbow_has_room() {
        let model = builtin::full_body();
        let pose = with_bent_elbows(&model);
        let [wrist, other] = ["right forearm", "left forearm"].map(|name| model.limb_index(name).unwrap());
        let before = Kinematics::new(&model, &pose);
        for by in [DVec3::new(0.1, 0.0, 0.0), DVec3::new(0.0, 0.1, 0.0), DVec3::new(-0.07, 0.0, 0.07)] {
            let target = before.ends()[wrist] + by;
            let after =
                Kinematics::new(&model, &drag_limb_end(&model, &pose, wrist, target, Held::default()));
            assert!(after.ends()[wrist].distance(target) < 1e-3, "{by}");
            let along = after.ends()[other].distance(before.ends()[other]);
            assert!(along < 0.005, "{by}: the other wrist went along by {along:.3} m");
        }
    }

    #[test]
    fn a_held_trunk_stays_and_the_joint_stops_where_the_arm_ends() {
        let model = builtin::full_body();
        let pose = with_bent_elbows(&model);
        let wrist = model.limb_index("right forearm").unwrap();
        let held = Held { pins: &[], trunk: true };
        for far in [0.1, 3.0] {
            let before = Kinematics::new(&model, &pose);
            let target = before.ends()[wrist] + DVec3::new(-0.5, 0.3, 0.8).normalize() * far;
            let after = drag_limb_end(&model, &pose, wrist, target, held);
            assert_eq!(after.check(&model), Ok(()));
            let ends = Kinematics::new(&model, &after);
            for (index, limb) in model.limbs().iter().enumerate() {
                let is_chain = limb.name.starts_with("right ")
                    && ["clavicle", "upper arm", "forearm"].iter().any(|part| limb.name.ends_with(part));
                let moved = ends.ends()[index].distance(before.ends()[index]);
                assert!(is_chain || limb.name.contains("hand") || moved < 1e-3, "{}: {moved:.4}", limb.name);
            }
            let missed = ends.ends()[wrist].distance(target);
            assert!(if far < 1.0 { missed < 2e-3 } else { missed > 1.0 }, "{far}: {missed}");
        }
    }

    #[test]
    fn turning_moves_only_what_grows_from_the_limb() {
        let model = builtin::upper_body();
        let rest = Pose::rest(&model);
        let arm = model.limb_index("left upper arm").unwrap();
        let turned = turn_limb(&model, &rest, arm, DQuat::from_rotation_z(0.7));
        let (before, after) = (Kinematics::new(&model, &rest), Kinematics::new(&model, &turned));
        for (index, limb) in model.limbs().iter().enumerate() {
            let moved = before.ends()[index].distance(after.ends()[index]) > 1e-9;
            let grows = ["left upper arm", "left forearm"].contains(&limb.name.as_str());
            assert_eq!(moved, grows, "{}", limb.name);
        }
        let expected = DQuat::from_rotation_z(0.7) * (before.ends()[arm] - before.starts()[arm]);
        assert!((after.ends()[arm] - after.starts()[arm]).distance(expected) < 1e-12);
    }

    #[test]
    fn mirroring_twice_changes_nothing() {
        let model = builtin::full_body();
        let pose = crate::fixtures::stepped(&model, Parameters::Tangent, |i| 0.3 * (i as f64 * 1.3).sin());
        let again = mirror(&model, &mirror(&model, &pose));
        assert!(again.local(&pose).iter().all(|x| x.abs() < 1e-12));
    }
}
