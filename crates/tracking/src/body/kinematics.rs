//! Forward kinematics (4.11, 4.12, 4.15) and the map from the state's rates to a limb's motion.
//!
//! A limb is a rigid body: what a small change of the state does to it is a velocity v of its first joint,
//! a rotation rate ω and, for raw quaternions, a rate of scaling σ. A point q fixed in the limb then moves by
//! v + ω × (q − p0) + σ (q − p0). For the state's column c the seven numbers (v, ω, σ) are a column of the
//! limb's kinematic map K (7 × columns).
//!
//! Rotation j turns every bone m whose rotation follows j. The first joint of limb l is the root plus the
//! bones on its path, so with `ω = R_parent(j)* e`:  v = ω × c, c = Σ bones on the path that follow j.

use glam::{DMat3, DVec3};
use nalgebra::DMatrix;

use super::{Model, Parameters, Pose};
use crate::geometry::rotation::{raw_matrix, raw_rates};

/// Joint positions and world rotations of one pose. Reused without allocation by [`update`](Self::update).
#[derive(Debug, Clone)]
pub struct Kinematics {
    starts: Vec<DVec3>,
    ends: Vec<DVec3>,
    /// World matrix of each rotation; scaled by Π|q|² for raw quaternions.
    world: Vec<DMat3>,
    /// Frame in which each rotation's columns act: its parent's world rotation, without scale.
    frames: Vec<DMat3>,
    /// Per rotation and raw coefficient: rate of turn in the parent's frame, rate of scaling.
    raw: Vec<[(DVec3, f64); 4]>,
    /// For each limb, the rotations on its path and the lever c of its first joint.
    levers: Vec<Vec<Lever>>,
    branches: Option<Branches>,
}

/// One column of a limb's kinematic map: what a unit of a state's column does to the limb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingColumn {
    /// The state's column.
    pub index: usize,
    /// v, ω, σ in world axes, about the limb's first joint.
    pub motion: [f64; 7],
}

#[derive(Debug, Clone, Copy)]
struct Lever {
    rotation: usize,
    /// Σ of the bones before this limb that follow the rotation.
    arm: DVec3,
    /// Whether the limb itself turns with the rotation.
    turns: bool,
    /// The same rotation's lever of the limb that this one grows from.
    before: Option<usize>,
}

impl Kinematics {
    /// Joint positions of a pose.
    pub fn new(model: &Model, pose: &Pose) -> Self {
        let (limbs, rotations) = (model.limbs().len(), model.rotation_count());
        let mut this = Self {
            starts: vec![DVec3::ZERO; limbs],
            ends: vec![DVec3::ZERO; limbs],
            world: vec![DMat3::IDENTITY; rotations],
            frames: vec![DMat3::IDENTITY; rotations],
            raw: vec![[(DVec3::ZERO, 0.0); 4]; rotations],
            levers: vec![Vec::new(); limbs],
            branches: None,
        };
        for (index, limb) in model.limbs().iter().enumerate() {
            for rotation in 0..rotations {
                // What moves the limb that this one grows from moves this one's first joint.
                let of_parent = limb.parent.map(|parent| &this.levers[parent]);
                let before = of_parent.and_then(|levers| levers.iter().position(|l| l.rotation == rotation));
                let turns = model.rotation_follows(limb.rotation, rotation);
                if before.is_some() || turns {
                    this.levers[index].push(Lever { rotation, arm: DVec3::ZERO, turns, before });
                }
            }
        }
        this.branches = Branches::of(model, &this.levers);
        this.update(model, pose);
        this
    }

    /// The same for another pose of the same model.
    pub fn update(&mut self, model: &Model, pose: &Pose) {
        for &rotation in model.rotations_parents_first() {
            let q = pose.rotations[rotation];
            let parent =
                model.rotation_parents()[rotation].map_or(DMat3::IDENTITY, |parent| self.world[parent]);
            let scale = parent.x_axis.length();
            self.frames[rotation] = parent * (1.0 / scale);
            self.world[rotation] = parent * raw_matrix(q);
            self.raw[rotation] = raw_rates(q);
        }
        for (index, limb) in model.limbs().iter().enumerate() {
            let start = limb.parent.map_or(pose.root, |parent| self.ends[parent]);
            self.starts[index] = start;
            self.ends[index] = start + self.world[limb.rotation] * (limb.direction * limb.length);
        }
        for (index, limb) in model.limbs().iter().enumerate() {
            let Some(parent) = limb.parent else { continue };
            let bone = self.ends[parent] - self.starts[parent];
            // Parents stand before their children.
            let (before, after) = self.levers.split_at_mut(index);
            for lever in &mut after[0] {
                if let Some(slot) = lever.before {
                    let through = before[parent][slot];
                    lever.arm = through.arm + if through.turns { bone } else { DVec3::ZERO };
                }
            }
        }
    }

    /// First joint p0 of each limb, world metres.
    pub fn starts(&self) -> &[DVec3] {
        &self.starts
    }

    /// Second joint p1 of each limb, world metres.
    pub fn ends(&self) -> &[DVec3] {
        &self.ends
    }

    /// World matrix of each rotation (scaled, for raw quaternions that are not of unit length).
    pub fn world_rotations(&self) -> &[DMat3] {
        &self.world
    }

    /// World rotation of the frame that each rotation is given in: its parent's.
    pub fn parent_frames(&self) -> &[DMat3] {
        &self.frames
    }

    /// Number of limbs.
    pub fn limb_count(&self) -> usize {
        self.starts.len()
    }

    /// What each rotation carries, where that is a branch of the body.
    pub(crate) fn branches(&self) -> Option<&Branches> {
        self.branches.as_ref()
    }

    /// What a column of a rotation's block does to what the rotation carries: rate of turn, world axes, and rate of scaling.
    pub(crate) fn rate(&self, rotation: usize, column: usize, parameters: Parameters) -> (DVec3, f64) {
        let frame = self.frames[rotation];
        match parameters {
            Parameters::Tangent => (frame.col(column), 0.0),
            Parameters::Raw => {
                let (turn, scaling) = self.raw[rotation][column];
                (frame * turn, scaling)
            }
        }
    }

    /// The columns of the limb's kinematic map K that are not zero, with their index: v, ω, σ in world axes.
    pub fn moving_columns_into(&self, limb: usize, parameters: Parameters, columns: &mut Vec<MovingColumn>) {
        columns.clear();
        for (axis, unit) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            columns.push(MovingColumn { index: axis, motion: [unit.x, unit.y, unit.z, 0.0, 0.0, 0.0, 0.0] });
        }
        for lever in &self.levers[limb] {
            let first = parameters.first_column(lever.rotation);
            for column in 0..parameters.per_rotation() {
                let (turn, scaling) = self.rate(lever.rotation, column, parameters);
                let v = turn.cross(lever.arm) + scaling * lever.arm;
                let (w, s) = if lever.turns { (turn, scaling) } else { (DVec3::ZERO, 0.0) };
                columns
                    .push(MovingColumn { index: first + column, motion: [v.x, v.y, v.z, w.x, w.y, w.z, s] });
            }
        }
    }

    /// The limb's kinematic map K (7 × columns), rows v, ω, σ in world axes, about its first joint.
    ///
    /// `map` is overwritten; it must be 7 × [`Parameters::columns`].
    pub fn fill_map(&self, limb: usize, parameters: Parameters, map: &mut DMatrix<f64>) {
        map.fill(0.0);
        let mut columns = Vec::new();
        self.moving_columns_into(limb, parameters, &mut columns);
        for column in columns {
            map.column_mut(column.index).copy_from_slice(&column.motion);
        }
    }

    /// Derivative of the limb's second joint by the state, 3 × columns.
    pub fn end_jacobian(&self, limb: usize, parameters: Parameters) -> DMatrix<f64> {
        let bone = self.ends[limb] - self.starts[limb];
        let mut columns = Vec::new();
        self.moving_columns_into(limb, parameters, &mut columns);
        let mut jacobian = DMatrix::zeros(3, parameters.columns(self.world.len()));
        for MovingColumn { index, motion: [vx, vy, vz, wx, wy, wz, scaling] } in columns {
            let moved = DVec3::new(wx, wy, wz).cross(bone) + scaling * bone;
            jacobian.column_mut(index).copy_from_slice(&(DVec3::new(vx, vy, vz) + moved).to_array());
        }
        jacobian
    }
}

/// A body all of whose rotations carry whole branches: some limbs that grow from one place, and all that grows from them.
///
/// What the rotation k carries moves about one point, its pivot, and what a rotation before it on the way to the root does
/// to the branch is a turn about another. So sums over a branch's limbs are made once and handed on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Branches {
    /// By limb, the rotation that it turns with.
    pub(crate) rotations: Vec<usize>,
    /// By rotation, the one that carries it.
    pub(crate) parents: Vec<Option<usize>>,
    /// By rotation, a limb that starts at its pivot.
    pub(crate) roots: Vec<usize>,
    /// All rotations, what they carry before themselves.
    pub(crate) leaves_first: Vec<usize>,
}

impl Branches {
    /// None where a file has a limb rigid with one that grows from another place, or one that is carried but does not turn.
    fn of(model: &Model, levers: &[Vec<Lever>]) -> Option<Self> {
        let limbs = model.limbs();
        let mut roots: Vec<Option<usize>> = vec![None; model.rotation_count()];
        for (index, limb) in limbs.iter().enumerate() {
            for lever in &levers[index] {
                let root = *roots[lever.rotation].get_or_insert(index);
                if !lever.turns || (lever.before.is_none() && limbs[root].parent != limb.parent) {
                    return None;
                }
            }
        }
        Some(Self {
            rotations: limbs.iter().map(|limb| limb.rotation).collect(),
            parents: model.rotation_parents().to_vec(),
            roots: roots.into_iter().collect::<Option<_>>()?,
            leaves_first: model.rotations_parents_first().iter().rev().copied().collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{ModelSpec, builtin};
    use crate::fixtures::{BOTH, stretched};
    use crate::optimize::gradient_check::{DifferenceOptions, check_jacobian};

    /// Every limb's second joint, by every column, against central differences, raw and tangent.
    #[test]
    fn joint_jacobians_match_differences() {
        for model in [builtin::upper_body(), builtin::full_body()] {
            let limbs = model.limbs();
            for parameters in BOTH {
                let pose = stretched(&model, parameters, [0.3, 0.3], 0.0);
                let here = Kinematics::new(&model, &pose);
                let mut jacobian =
                    DMatrix::zeros(3 * limbs.len(), parameters.columns(model.rotation_count()));
                for limb in 0..limbs.len() {
                    jacobian.rows_mut(3 * limb, 3).copy_from(&here.end_jacobian(limb, parameters));
                }
                let ends = |column, offset| -> Vec<f64> {
                    let moved = Kinematics::new(&model, &pose.nudged(parameters, column, offset));
                    moved.ends().iter().flat_map(|end| end.to_array()).collect()
                };
                let name =
                    |row: usize, column| format!("{parameters:?} {} column {column}", limbs[row / 3].name);
                let options =
                    DifferenceOptions { step: 1e-5, tolerance: 1e-7, ..DifferenceOptions::default() };
                let check = check_jacobian(&jacobian, ends, name, &options);
                assert!(check.passes() && check.skipped == 0, "{check}");
            }
        }
    }

    fn of(model: &Model) -> Option<Branches> {
        Kinematics::new(model, &Pose::rest(model)).branches().cloned()
    }

    #[test]
    fn built_in_bodies_are_of_branches() {
        for model in [builtin::single_limb(), builtin::upper_body(), builtin::full_body()] {
            let branches = of(&model).unwrap();
            for (rotation, &root) in branches.roots.iter().enumerate() {
                let owner = model.rotation_owners()[rotation];
                assert_eq!(model.limbs()[root].parent, model.limbs()[owner].parent);
            }
        }
    }

    #[test]
    fn limbs_that_only_lean_on_others_are_no_branches() {
        let model = |limbs: &str| {
            let text = format!("format = \"backlit-body 1\"\nname = \"body\"\nlimb = [{limbs}]");
            Model::new(&toml::from_str::<ModelSpec>(&text).unwrap()).unwrap()
        };
        let limb = |name: &str, more: &str| {
            format!("{{ name = \"{name}\", direction = [0, 1, 0], length = 0.3, radius = 0.1{more} }},")
        };
        let trunk = limb("trunk", "") + &limb("arm", ", parent = \"trunk\"");
        assert!(of(&model(&trunk)).is_some());
        // A hand that keeps the trunk's rotation while the arm between them turns.
        let hand = limb("hand", ", parent = \"arm\", rigid_with = \"trunk\"");
        assert_eq!(of(&model(&(trunk.clone() + &hand))), None);
        // Two limbs of one rotation at two places.
        let legs = limb("leg", "") + &limb("other", ", parent = \"trunk\", rigid_with = \"leg\"");
        assert_eq!(of(&model(&(trunk + &legs))), None);
    }
}
