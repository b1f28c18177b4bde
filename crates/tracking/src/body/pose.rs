//! A pose X: where the root is and how every joint is turned.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::Model;
use crate::geometry::rotation::{exp, log};

/// A pose: the root's position in metres and one quaternion per rotation, relative to its parent's.
///
/// Quaternions are of unit length everywhere but inside a raw update (4.15).
#[derive(Debug, Clone, PartialEq)]
pub struct Pose {
    /// Root in the world, metres.
    pub root: DVec3,
    /// One quaternion per rotation of the model, in its order.
    pub rotations: Vec<DQuat>,
}

/// A root farther from the origin than this, metres, is a mistake of units.
pub const FARTHEST_ROOT: f64 = 1e6;

/// Why numbers are not a pose.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum PoseError {
    #[error(
        "`root` is [{:?}, {:?}, {:?}]; expected three numbers in metres, none beyond {FARTHEST_ROOT:e}",
        value.x, value.y, value.z
    )]
    Root { value: DVec3 },
    #[error("`rotations.{limb}` is [w x y z] = {value:?}; expected four finite numbers, not all zero")]
    Rotation { limb: String, value: [f64; 4] },
    #[error("`rotations` has {found} quaternions; the model has {expected}")]
    Count { found: usize, expected: usize },
}

impl Pose {
    /// Every rotation the identity, the root at the origin.
    pub fn rest(model: &Model) -> Self {
        Self { root: DVec3::ZERO, rotations: vec![DQuat::IDENTITY; model.rotation_count()] }
    }

    /// Checks a pose against its model.
    ///
    /// # Errors
    /// The first number that is not one, by field.
    pub fn check(&self, model: &Model) -> Result<(), PoseError> {
        if !self.root.abs().cmple(DVec3::splat(FARTHEST_ROOT)).all() {
            return Err(PoseError::Root { value: self.root });
        }
        if self.rotations.len() != model.rotation_count() {
            return Err(PoseError::Count { found: self.rotations.len(), expected: model.rotation_count() });
        }
        for (q, &owner) in self.rotations.iter().zip(model.rotation_owners()) {
            if !(1e-12..f64::INFINITY).contains(&q.length_squared()) {
                let limb = model.limbs()[owner].name.clone();
                return Err(PoseError::Rotation { limb, value: [q.w, q.x, q.y, q.z] });
            }
        }
        Ok(())
    }

    /// All quaternions brought to unit length.
    pub fn normalized(&self) -> Self {
        Self { root: self.root, rotations: self.rotations.iter().map(|q| q.normalize()).collect() }
    }

    /// Moves by a step of the state: X ⊕ δ. Raw steps are added, then renormalised.
    ///
    /// `step` has [`Parameters::columns`] entries.
    pub fn retract(&self, parameters: Parameters, step: &[f64]) -> Self {
        let root = self.root + DVec3::from_slice(&step[..3]);
        let blocks = step[3..].chunks_exact(parameters.per_rotation());
        let rotations = self.rotations.iter().zip(blocks).map(|(q, block)| match parameters {
            Parameters::Tangent => (exp(DVec3::from_slice(block)) * *q).normalize(),
            Parameters::Raw => {
                let moved = DQuat::from_xyzw(q.x + block[1], q.y + block[2], q.z + block[3], q.w + block[0]);
                // A step that lands on zero says nothing about the turn: stay.
                if moved.length_squared() > 1e-12 { moved.normalize() } else { *q }
            }
        });
        Self { root, rotations: rotations.collect() }
    }

    /// One column of the state moved by an offset and nothing else: raw coefficients are *not* renormalised.
    ///
    /// What differences of raw derivatives need; [`retract`](Self::retract) is the step of a fit.
    pub fn nudged(&self, parameters: Parameters, column: usize, offset: f64) -> Self {
        let mut moved = self.clone();
        if column < 3 {
            moved.root[column] += offset;
            return moved;
        }
        let (rotation, part) =
            ((column - 3) / parameters.per_rotation(), (column - 3) % parameters.per_rotation());
        let q = moved.rotations[rotation];
        moved.rotations[rotation] = match parameters {
            Parameters::Tangent => exp(DVec3::AXES[part] * offset) * q,
            Parameters::Raw => {
                // glam stores x, y, z, w.
                let mut numbers = q.to_array();
                numbers[(part + 3) % 4] += offset;
                DQuat::from_array(numbers)
            }
        };
        moved
    }

    /// The tangent step from `other` to this pose: `other.retract(Tangent, step) == self`.
    pub fn local(&self, other: &Self) -> Vec<f64> {
        let mut step = Vec::with_capacity(3 + 3 * self.rotations.len());
        step.extend((self.root - other.root).to_array());
        for (q, from) in self.rotations.iter().zip(&other.rotations) {
            step.extend(log(*q * from.inverse()).to_array());
        }
        step
    }

    /// The state as raw numbers: root, then w x y z per rotation.
    pub fn to_state(&self) -> Vec<f64> {
        let mut state = self.root.to_array().to_vec();
        for q in &self.rotations {
            state.extend([q.w, q.x, q.y, q.z]);
        }
        state
    }

    /// The inverse of [`to_state`](Self::to_state); coefficients are taken as they are.
    ///
    /// # Errors
    /// Wrong count, or a number that is not finite.
    pub fn from_state(model: &Model, state: &[f64]) -> Result<Self, PoseError> {
        let expected = model.rotation_count();
        if state.len() != 3 + 4 * expected {
            return Err(PoseError::Count { found: state.len().saturating_sub(3) / 4, expected });
        }
        let rotations =
            state[3..].chunks_exact(4).map(|q| DQuat::from_xyzw(q[1], q[2], q[3], q[0])).collect();
        let pose = Self { root: DVec3::from_slice(&state[..3]), rotations };
        pose.check(model)?;
        Ok(pose)
    }

    /// Part-way from this pose (0) to another (1): straight for the root, spherical for rotations.
    pub fn interpolate(&self, other: &Self, fraction: f64) -> Self {
        let rotations = self.rotations.iter().zip(&other.rotations);
        Self {
            root: self.root.lerp(other.root, fraction),
            rotations: rotations
                .map(|(a, b)| (exp(log(*b * a.inverse()) * fraction) * *a).normalize())
                .collect(),
        }
    }
}

/// The state's columns: three of the root, then one block per rotation in the order of the model file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Parameters {
    /// Four coefficients w x y z a rotation, as in the report (4.15): not held to unit length in a step.
    Raw,
    /// Three numbers ω a rotation, q ← exp(ω) q in the parent's frame.
    #[default]
    Tangent,
}

impl Parameters {
    /// Columns of one rotation's block.
    pub fn per_rotation(self) -> usize {
        match self {
            Self::Raw => 4,
            Self::Tangent => 3,
        }
    }

    /// Columns of the whole state.
    pub fn columns(self, rotations: usize) -> usize {
        3 + self.per_rotation() * rotations
    }

    /// First column of a rotation's block.
    pub fn first_column(self, rotation: usize) -> usize {
        3 + self.per_rotation() * rotation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;

    #[test]
    fn retract_undoes_local() {
        let model = builtin::upper_body();
        let step: Vec<f64> = (0..27).map(|i| 0.4 * (f64::from(i) * 1.7).sin()).collect();
        let from = Pose::rest(&model).retract(Parameters::Tangent, &step[..]);
        let other: Vec<f64> = step.iter().map(|x| x * -0.7 + 0.1).collect();
        let to = from.retract(Parameters::Tangent, &other);
        let again = to.local(&from);
        for (a, b) in again.iter().zip(&other) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn not_a_number_is_named() {
        let model = builtin::upper_body();
        let mut state = Pose::rest(&model).to_state();
        state[8] = f64::NAN;
        let message = Pose::from_state(&model, &state).unwrap_err().to_string();
        assert!(message.contains("rotations.right shoulder"), "{message}");
    }
}
