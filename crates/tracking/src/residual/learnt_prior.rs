//! Poses and steps that motion files know: E of every part of the body, see [`prior`](crate::prior).
//!
//! A direction x = Fᵀ d is that of a limb, d = R v in the world, in a frame F of the trunk. A column of the state that turns the
//! limb by ω and the frame by ω′ moves it by
//!
//! ∂x = Fᵀ ((ω − ω′) × d),
//!
//! and with the part's force f = −½ ∂E/∂x and curvature C the normal equations get Jᵀρ += w Jᵀf, JᵀJ += w `JᵀCJ`, cost += w E.
//! The gradient is exact. Steps are the same about the directions of the pose that the fit began with, where a motion led there.

use std::sync::Arc;

use glam::{DMat3, DVec3};
use nalgebra::{Cholesky, DMatrix, DVector};

use crate::body::{Kinematics, Model, MovingColumn, Parameters, Pose, Sides};
use crate::optimize::NormalEquations;
use crate::prior::{BodyDirection, PosePrior, Pull, TrunkFrame};

/// Names of the limbs that pelvis and chest turn with, of the full body and of the upper body.
const PELVIS: [&str; 2] = ["spine", "torso"];
const CHEST: [&str; 2] = ["chest", "torso"];

/// A prior, and how much it counts.
#[derive(Debug, Clone, PartialEq)]
pub struct LearntPrior {
    /// What was learnt.
    pub statistics: Arc<PosePrior>,
    /// Weight of a unit of the poses' energy, in 255² squared grey levels at stride 1.
    pub pose_weight: f64,
    /// Weight of a unit of the steps' energy, likewise.
    pub step_weight: f64,
    /// How long the step was that led to where a fit begins, seconds; without a motion there is none. A tracker sets it.
    pub step_seconds: Option<f64>,
}

impl LearntPrior {
    /// A prior with the weights that were measured to be best.
    pub fn new(statistics: Arc<PosePrior>) -> Self {
        Self { statistics, pose_weight: 3.0, step_weight: 0.0, step_seconds: None }
    }
}

/// A limb, and how a direction of it or a frame at it lies at rest.
#[derive(Debug, Clone, Copy)]
struct LimbFixed<T> {
    limb: usize,
    rest: T,
}

/// How unlikely a part of the body is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PartEnergy {
    /// The rotations whose directions it has.
    pub(crate) rotations: Vec<usize>,
    /// E, −2 ln of the density over the peaks'.
    pub(crate) energy: f64,
}

/// A prior that knows which limbs of a body its directions are of.
#[derive(Debug, Clone)]
pub struct BoundPrior {
    prior: LearntPrior,
    pelvis: LimbFixed<DMat3>,
    chest: LimbFixed<DMat3>,
    /// Of each part whose limbs the body has.
    parts: Vec<BoundPart>,
}

#[derive(Debug, Clone)]
struct BoundPart {
    index: usize,
    directions: Vec<(TrunkFrame, LimbFixed<DVec3>)>,
    /// Where the fit began.
    reference: Option<DVector<f64>>,
}

impl BoundPrior {
    /// For a body and a fit that begins at a pose. Parts that the body does not have are left out; `None` if it has none, or no
    /// sides by which to tell left from right.
    pub fn new(prior: &LearntPrior, model: &Model, reference: &Pose) -> Option<Self> {
        let rest = Kinematics::new(model, &Pose::rest(model));
        let left = Sides::of(model, &rest)?.left;
        let frame = |names: [&str; 2]| {
            let limb = names.iter().find_map(|name| model.limb_index(name))?;
            let along = model.limbs()[limb].direction;
            let up = along.reject_from_normalized(left).try_normalize()?;
            Some(LimbFixed { limb, rest: DMat3::from_cols(left, left.cross(up), up) })
        };
        let (pelvis, chest) = (frame(PELVIS)?, frame(CHEST)?);
        let direction = |direction: &BodyDirection| {
            let at = match (direction, direction.limb()) {
                (_, Some(name)) => {
                    let limb = model.limb_index(&name)?;
                    LimbFixed { limb, rest: model.limbs()[limb].direction }
                }
                // A trunk in one piece has no chest that turns.
                _ if chest.limb == pelvis.limb => return None,
                (BodyDirection::ChestLeft, None) => LimbFixed { limb: chest.limb, rest: left },
                (_, None) => LimbFixed { limb: chest.limb, rest: chest.rest.z_axis },
            };
            Some((direction.frame(), at))
        };
        let parts = prior.statistics.parts.iter().enumerate().filter_map(|(index, part)| {
            let directions: Option<Vec<_>> = part.directions.iter().map(direction).collect();
            Some(BoundPart { index, directions: directions?, reference: None })
        });
        let mut bound = Self { prior: prior.clone(), pelvis, chest, parts: parts.collect() };
        if prior.step_seconds.is_some() && prior.step_weight > 0.0 {
            let kinematics = Kinematics::new(model, reference);
            for index in 0..bound.parts.len() {
                bound.parts[index].reference = Some(bound.numbers(&kinematics, model, &bound.parts[index]));
            }
        }
        (!bound.parts.is_empty()).then_some(bound)
    }

    /// The directions of each of its parts at a pose, with the part's index in the prior.
    pub fn all_numbers(&self, model: &Model, kinematics: &Kinematics) -> Vec<(usize, DVector<f64>)> {
        self.parts.iter().map(|part| (part.index, self.numbers(kinematics, model, part))).collect()
    }

    /// How unlikely each of its parts is at a pose.
    pub(crate) fn energies(&self, model: &Model, kinematics: &Kinematics) -> Vec<PartEnergy> {
        let of_part = |part: &BoundPart| {
            let x = self.numbers(kinematics, model, part);
            let rotations = part.directions.iter().map(|(_, at)| model.limbs()[at.limb].rotation);
            let energy = self.prior.statistics.parts[part.index].poses.pull(&x).energy;
            PartEnergy { rotations: rotations.collect(), energy }
        };
        self.parts.iter().map(of_part).collect()
    }

    /// Where the poses' distribution would have limbs: each with the direction, of unit length in the world, that a step on its part's
    /// energy alone leads to. Limbs of parts whose energy is flat there stay where they are.
    pub fn likelier(&self, model: &Model, kinematics: &Kinematics) -> Vec<(usize, DVec3)> {
        let mut limbs = Vec::new();
        for part in &self.parts {
            let x = self.numbers(kinematics, model, part);
            let pull = self.prior.statistics.parts[part.index].poses.pull(&x);
            let Some(curvature) = Cholesky::new(pull.curvature) else { continue };
            let numbers = x + curvature.solve(&pull.force);
            for (row, (frame, at)) in part.directions.iter().enumerate() {
                // To the left of the chest is no limb.
                if at.rest != model.limbs()[at.limb].direction {
                    continue;
                }
                let direction = DVec3::new(numbers[3 * row], numbers[3 * row + 1], numbers[3 * row + 2]);
                let (_, frame) = self.frame(kinematics, model, *frame);
                limbs.extend((frame * direction).try_normalize().map(|direction| (at.limb, direction)));
            }
        }
        limbs
    }

    /// Adds all parts, `unit` squared grey levels for a weight of 1.
    pub fn add(
        &self,
        equations: &mut NormalEquations,
        parameters: Parameters,
        model: &Model,
        kinematics: &Kinematics,
        unit: f64,
    ) {
        if self.prior.pose_weight <= 0.0 && self.parts.iter().all(|part| part.reference.is_none()) {
            return;
        }
        let mut memory = Vec::new();
        for part in &self.parts {
            let x = self.numbers(kinematics, model, part);
            let statistics = &self.prior.statistics.parts[part.index];
            let (columns, jacobian) = self.jacobian(kinematics, model, parameters, part, &mut memory);
            if self.prior.pose_weight > 0.0 {
                let pull = statistics.poses.pull(&x);
                add_pull(equations, &columns, &jacobian, &pull, unit * self.prior.pose_weight);
            }
            if let (Some(reference), Some(seconds)) = (&part.reference, self.prior.step_seconds) {
                let pull = statistics.step_pull(&(x - reference), seconds);
                add_pull(equations, &columns, &jacobian, &pull, unit * self.prior.step_weight);
            }
        }
    }

    fn frame(&self, kinematics: &Kinematics, model: &Model, frame: TrunkFrame) -> (usize, DMat3) {
        let at = match frame {
            TrunkFrame::Pelvis => self.pelvis,
            TrunkFrame::Chest => self.chest,
        };
        (at.limb, unscaled(kinematics.world_rotations()[model.limbs()[at.limb].rotation]) * at.rest)
    }

    fn numbers(&self, kinematics: &Kinematics, model: &Model, part: &BoundPart) -> DVector<f64> {
        let mut numbers = Vec::with_capacity(3 * part.directions.len());
        for (frame, at) in &part.directions {
            let (_, frame) = self.frame(kinematics, model, *frame);
            numbers.extend((frame.transpose() * in_world(kinematics, model, at)).to_array());
        }
        DVector::from_vec(numbers)
    }

    /// ∂x by the columns of the state that move it, and which those are.
    fn jacobian(
        &self,
        kinematics: &Kinematics,
        model: &Model,
        parameters: Parameters,
        part: &BoundPart,
        memory: &mut Vec<MovingColumn>,
    ) -> (Vec<usize>, DMatrix<f64>) {
        let mut columns: Vec<usize> = Vec::new();
        let mut entries: Vec<(usize, usize, DVec3)> = Vec::new();
        for (row, (frame, at)) in part.directions.iter().enumerate() {
            let (trunk, frame) = self.frame(kinematics, model, *frame);
            let d = in_world(kinematics, model, at);
            for (limb, sense) in [(at.limb, 1.0), (trunk, -1.0)] {
                kinematics.moving_columns_into(limb, parameters, memory);
                for MovingColumn { index, motion: [.., wx, wy, wz, _] } in memory.iter() {
                    let turn = DVec3::new(*wx, *wy, *wz);
                    if turn == DVec3::ZERO {
                        continue;
                    }
                    let place = columns.iter().position(|column| column == index).unwrap_or_else(|| {
                        columns.push(*index);
                        columns.len() - 1
                    });
                    entries.push((3 * row, place, frame.transpose() * (turn.cross(d) * sense)));
                }
            }
        }
        let mut jacobian = DMatrix::zeros(3 * part.directions.len(), columns.len());
        for (row, column, moved) in entries {
            for axis in 0..3 {
                jacobian[(row + axis, column)] += moved[axis];
            }
        }
        (columns, jacobian)
    }
}

/// A limb's direction in the world, of unit length.
fn in_world(kinematics: &Kinematics, model: &Model, at: &LimbFixed<DVec3>) -> DVec3 {
    unscaled(kinematics.world_rotations()[model.limbs()[at.limb].rotation]) * at.rest
}

/// Raw quaternions scale what they turn.
fn unscaled(rotation: DMat3) -> DMat3 {
    rotation * (1.0 / rotation.x_axis.length())
}

fn add_pull(
    equations: &mut NormalEquations,
    columns: &[usize],
    jacobian: &DMatrix<f64>,
    pull: &Pull,
    weight: f64,
) {
    equations.cost += weight * pull.energy;
    let forces = jacobian.tr_mul(&pull.force);
    let products = jacobian.tr_mul(&(&pull.curvature * jacobian));
    for (i, &row) in columns.iter().enumerate() {
        equations.jtr[row] += weight * forces[i];
        for (j, &column) in columns.iter().enumerate() {
            equations.jtj[(row, column)] += weight * products[(i, j)];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;
    use crate::fixtures::{BOTH, Failures, bent, check_gradient};
    use crate::prior::{BodyPoints, PriorPart, StepStatistics, StudentComponent};

    /// Two poses of an arm, and one of a trunk and of a leg.
    fn prior() -> LearntPrior {
        let covariance = |size: usize, diagonal: f64| -> Vec<f64> {
            (0..size)
                .flat_map(|i| (0..=i).map(move |j| if i == j { diagonal } else { 0.1 * diagonal }))
                .collect()
        };
        let part = |name: &str, directions: Vec<BodyDirection>, means: &[&[f64]]| {
            let size = 3 * directions.len();
            let component = |mean: &&[f64]| StudentComponent {
                share: 0.5,
                mean: mean.to_vec(),
                covariance: covariance(size, 0.05),
            };
            let step = StepStatistics { seconds: 0.1, exponent: 2.0, covariance: covariance(size, 0.02) };
            PriorPart::new(name, directions, means.iter().map(component).collect(), step, 4.0).unwrap()
        };
        use BodyDirection as D;
        let parts = vec![
            part("trunk", vec![D::ChestUp, D::ChestLeft], &[&[0.0, 0.1, 1.0, 1.0, 0.0, 0.0]]),
            part(
                "right arm",
                vec![D::RightUpperArm, D::RightForearm],
                &[&[-0.2, 0.0, -0.9, -0.1, 0.5, -0.7], &[-0.3, 0.8, -0.2, 0.1, 0.9, 0.3]],
            ),
            part(
                "left leg",
                vec![D::LeftThigh, D::LeftCalf, D::LeftFoot],
                &[&[0.1, 0.1, -1.0, 0.1, -0.2, -0.9, 0.2, 0.8, -0.4]],
            ),
        ];
        let statistics = Arc::new(PosePrior::new("test", parts).unwrap());
        LearntPrior { statistics, pose_weight: 0.7, step_weight: 0.4, step_seconds: Some(0.05) }
    }

    /// With one component alone a step on the energy leads to its mean; with several, to something likelier.
    #[test]
    fn limbs_are_pulled_to_where_poses_are_likely() {
        let model = builtin::full_body();
        let pose = bent(&model, 0.3, 0.4);
        let kinematics = Kinematics::new(&model, &pose);
        let bound = BoundPrior::new(&prior(), &model, &pose).unwrap();
        let likelier = bound.likelier(&model, &kinematics);
        let names: Vec<&str> = likelier.iter().map(|(limb, _)| model.limbs()[*limb].name.as_str()).collect();
        let expected = ["chest", "right upper arm", "right forearm", "left thigh", "left calf", "left foot"];
        assert_eq!(names, expected);
        let (_, pelvis) = bound.frame(&kinematics, &model, BodyDirection::LeftCalf.frame());
        let mean = DVec3::new(0.1, -0.2, -0.9).normalize();
        assert!((pelvis.transpose() * likelier[4].1).abs_diff_eq(mean, 1e-9));
        let arm = prior().statistics.parts[1].poses.clone();
        let (_, chest) = bound.frame(&kinematics, &model, BodyDirection::RightForearm.frame());
        let moved: Vec<f64> = likelier[1..3]
            .iter()
            .flat_map(|(_, direction)| (chest.transpose() * *direction).to_array())
            .collect();
        let before = bound.numbers(&kinematics, &model, &bound.parts[1]);
        assert!(arm.pull(&DVector::from_vec(moved)).energy < arm.pull(&before).energy);
    }

    #[test]
    fn derivatives_match_differences() {
        let mut failures = Failures::default();
        for (model, count) in [(builtin::full_body(), 3), (builtin::upper_body(), 1)] {
            let (pose, reference) = (bent(&model, 0.5, 0.4), bent(&model, 0.35, 0.4));
            let bound = BoundPrior::new(&prior(), &model, &reference).unwrap();
            assert_eq!(bound.parts.len(), count, "{}", model.name());
            for parameters in BOTH {
                let add = |equations: &mut NormalEquations, pose: &Pose| {
                    bound.add(equations, parameters, &model, &Kinematics::new(&model, pose), 2.0);
                };
                let here = check_gradient(model.name(), parameters, &pose, add, 5e-7, &mut failures);
                assert!(here.cost > 1.0 && here.jtr.amax() > 0.1);
            }
        }
    }

    /// What is trained on joints in space and what a body's limbs give are the same numbers.
    #[test]
    fn limbs_and_joints_give_the_same_directions() {
        let model = builtin::full_body();
        let mut pose = bent(&model, 0.6, 0.4);
        // The joints' left of the chest is that of the shoulders: clavicles at rest.
        for name in ["right clavicle", "left clavicle"] {
            let limb = model.limb_index(name).unwrap();
            pose.rotations[model.limbs()[limb].rotation] = glam::DQuat::IDENTITY;
        }
        let kinematics = Kinematics::new(&model, &pose);
        let end = |name: &str| kinematics.ends()[model.limb_index(name).unwrap()];
        let pair = |name: &str| ["right", "left"].map(|side| end(&format!("{side} {name}")));
        let points = BodyPoints {
            hips: pair("hip"),
            waist: end("spine"),
            neck: end("chest"),
            shoulders: pair("clavicle"),
            elbows: pair("upper arm"),
            wrists: pair("forearm"),
            knees: pair("lower thigh"),
            ankles: pair("lower calf"),
            toes: pair("foot"),
        };
        let prior = prior();
        let bound = BoundPrior::new(&prior, &model, &pose).unwrap();
        for (index, found) in bound.all_numbers(&model, &kinematics) {
            let part = &prior.statistics.parts[index];
            let expected = DVector::from_vec(points.numbers(&part.directions).unwrap());
            let worst = (&found - &expected).amax();
            assert!(worst < 1e-9, "{}: {found} for {expected}", part.name);
        }
    }

    #[test]
    fn a_body_without_sides_has_no_prior() {
        let model = builtin::single_limb();
        assert!(BoundPrior::new(&prior(), &model, &Pose::rest(&model)).is_none());
    }
}
