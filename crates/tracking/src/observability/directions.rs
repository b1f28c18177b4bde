//! The directions of a set of cameras' normal equations, from the best seen to those that nothing sees.

use std::sync::Arc;

use glam::DVec3;
use nalgebra::{DMatrix, DVector};

use super::cause::{Share, shares};
use super::information::{FrameInformation, Spectrum};
use super::uncertainty::{JointUncertainty, articulated_joints, joint_uncertainties};
use crate::body::{Model, Parameters, Pose};

/// A candidate for the basis of the null space lies in it if no more of its unit length is outside.
const OUTSIDE_NULL: f64 = 1e-4;
/// A candidate is new if at least this much of its unit length is not in the span of those before.
const NEW_IN_SPAN: f64 = 0.1;

/// One standard deviation moves no joint farther, metres, and turns none farther, radians: seen well.
const SEEN_WELL: [f64; 2] = [0.005, 0.05];
/// One standard deviation moves a joint at least so far, metres, or turns it, radians: hardly seen.
const HARDLY_SEEN: [f64; 2] = [0.03, 0.35];
/// A direction that moves no joint by this much for a radian moves none, metres.
const MOVES_NOTHING: f64 = 1e-6;

/// How the pixels err.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// σ: root mean square residual of the pixels on a ramp, less the freedom of the fit, grey levels.
    pub pixel_deviation: f64,
    /// κ, at least 1: by how much the variance is larger than that of independent pixels.
    pub together: f64,
}

impl Noise {
    /// Independent pixels of a known deviation, grey levels.
    #[must_use]
    pub fn white(pixel_deviation: f64) -> Self {
        Self { pixel_deviation, together: 1.0 }
    }

    /// σ√κ, grey levels: what a pixel's deviation would be if independent pixels erred as much in the pose.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.pixel_deviation * self.together.sqrt()
    }
}

/// How well a direction is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Not at all.
    Null,
    /// So little that a pose may be far off along it.
    Hardly,
    /// Somewhat.
    Somewhat,
    /// Well.
    Well,
}

/// A direction of the state.
#[derive(Debug, Clone)]
pub struct Direction {
    /// λ, the singular value of the scaled JᵀJ: squared grey levels per rad². Zero for null ones.
    pub value: f64,
    /// λ over the largest of all.
    pub relative: f64,
    /// Whether λ is nothing but rounding.
    pub is_null: bool,
    /// δ = D u, tangent columns: metres and radians, |u| = 1.
    pub step: DVector<f64>,
    /// How far the root moves for one unit of it, metres.
    pub root_move: DVec3,
    /// How far each joint moves for one unit of it, metres, by the limb whose second joint it is; see
    /// [`articulated_joints`].
    pub joint_moves: Vec<(usize, DVec3)>,
    /// Standard deviation along it, in units of `step`; infinite for null ones.
    pub deviation: f64,
    /// Why it is weak, or how it is seen: shares of its motion, the largest first.
    pub shares: Vec<Share>,
}

impl Direction {
    /// The joint that moves most, by the limb whose second joint it is (`None` is the root), and how far, metres.
    #[must_use]
    pub fn largest_move(&self) -> (Option<usize>, f64) {
        self.movers()[0]
    }

    /// The joints that move most, the first the most, with how far, metres: the root (`None`) and limbs' second joints.
    #[must_use]
    pub fn movers(&self) -> Vec<(Option<usize>, f64)> {
        let ends = self.joint_moves.iter().map(|(limb, by)| (Some(*limb), by.length()));
        let mut movers: Vec<_> = std::iter::once((None, self.root_move.length())).chain(ends).collect();
        movers.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        movers
    }

    /// The largest turn of a joint in one unit of it, radians.
    #[must_use]
    pub fn largest_turn(&self) -> f64 {
        let turns = self.step.as_slice()[3..].chunks_exact(3);
        turns.map(|turn| DVec3::from_slice(turn).length()).fold(0.0, f64::max)
    }

    /// How well it is seen, by what one standard deviation moves and turns.
    #[must_use]
    pub fn visibility(&self) -> Visibility {
        if self.is_null {
            return Visibility::Null;
        }
        let one = [self.deviation * self.largest_move().1, self.deviation * self.largest_turn()];
        if one[0] >= HARDLY_SEEN[0] || one[1] >= HARDLY_SEEN[1] {
            Visibility::Hardly
        } else if one[0] > SEEN_WELL[0] || one[1] > SEEN_WELL[1] {
            Visibility::Somewhat
        } else {
            Visibility::Well
        }
    }

    /// Whether no joint moves with it.
    #[must_use]
    pub fn moves_no_joint(&self) -> bool {
        self.largest_move().1 < MOVES_NOTHING
    }

    /// How much of it moves no joint farther than `move_m` metres and turns none farther than `turn` radians.
    #[must_use]
    pub fn amount_within(&self, move_m: f64, turn: f64) -> f64 {
        let by_move = move_m / self.largest_move().1.max(f64::MIN_POSITIVE);
        by_move.min(turn / self.largest_turn().max(f64::MIN_POSITIVE))
    }

    /// The pose moved by `amount` units of it.
    #[must_use]
    pub fn swayed(&self, pose: &Pose, amount: f64) -> Pose {
        pose.retract(Parameters::Tangent, (&self.step * amount).as_slice())
    }
}

/// What a set of cameras sees of a pose.
#[derive(Debug, Clone)]
pub struct Observability {
    /// The body.
    pub model: Arc<Model>,
    /// The pose.
    pub pose: Pose,
    /// The set of cameras, by index; those without data are left out.
    pub cameras: Vec<usize>,
    /// As many as the state has columns, the best seen first, null ones last.
    pub directions: Vec<Direction>,
    /// Relative to the largest singular value, what is not above this is null.
    pub null_below: f64,
    /// How the pixels err.
    pub noise: Noise,
    /// Root first, then [`articulated_joints`].
    pub joints: Vec<JointUncertainty>,
    /// L, metres: what a radian is worth for the root's position.
    pub lever_m: f64,
    /// Pixels on a ramp, all cameras together.
    pub ramp_pixels: usize,
}

impl Observability {
    /// Number of null directions.
    #[must_use]
    pub fn null_count(&self) -> usize {
        self.directions.iter().filter(|direction| direction.is_null).count()
    }

    /// The joint that is known worst, by the limb whose second joint it is, and its standard deviation in its worst
    /// direction, metres; infinite where nothing bounds it.
    #[must_use]
    pub fn worst_joint(&self) -> Option<(Option<usize>, f64)> {
        let joints = self.joints.iter().map(|joint| (joint.limb, joint.worst_deviation_m()));
        joints.reduce(|worst, next| if next.1 > worst.1 { next } else { worst })
    }
}

impl FrameInformation {
    /// What a set of cameras sees, with the noise estimated by its own residuals.
    #[must_use]
    pub fn observe(&self, cameras: &[usize]) -> Observability {
        self.observe_with_noise(cameras, None)
    }

    /// The same with the noise given; `None` estimates it.
    #[must_use]
    pub fn observe_with_noise(&self, cameras: &[usize], noise: Option<Noise>) -> Observability {
        let cameras: Vec<usize> =
            cameras.iter().copied().filter(|&camera| self.parts(&[camera]).next().is_some()).collect();
        let spectrum = self.spectrum(&cameras);
        let noise = noise.unwrap_or_else(|| self.noise(&cameras, &spectrum));
        let largest = spectrum.values.first().copied().unwrap_or_default().max(f64::MIN_POSITIVE);
        let mut directions: Vec<Direction> = (0..spectrum.rank)
            .map(|index| {
                let value = spectrum.values[index];
                let u = spectrum.vectors.column(index).into_owned();
                let deviation = noise.deviation() / value.sqrt();
                self.direction(&cameras, u, [value, value / largest, deviation])
            })
            .collect();
        directions.extend(
            self.null_basis(&spectrum).into_iter().map(|u| Direction {
                is_null: true,
                ..self.direction(&cameras, u, [0.0, 0.0, f64::INFINITY])
            }),
        );
        Observability {
            model: Arc::clone(&self.model),
            pose: self.pose.clone(),
            directions,
            null_below: spectrum.null_below,
            joints: joint_uncertainties(self, &spectrum, noise.deviation()),
            noise,
            lever_m: self.lever_m,
            ramp_pixels: self.parts(&cameras).map(|part| part.ramp_pixels).sum(),
            cameras,
        }
    }

    fn direction(
        &self,
        cameras: &[usize],
        u: DVector<f64>,
        [value, relative, deviation]: [f64; 3],
    ) -> Direction {
        // Of a vector and its opposite, the one whose largest entry is positive.
        let sign = if u[u.iamax()] < 0.0 { -1.0 } else { 1.0 };
        let mut step = u * sign;
        step.rows_mut(0, 3).scale_mut(self.lever_m);
        let end_move = |limb| {
            let moved = self.kinematics.end_jacobian(limb, Parameters::Tangent) * &step;
            (limb, DVec3::new(moved[0], moved[1], moved[2]))
        };
        let joint_moves = articulated_joints(&self.model).into_iter().map(end_move).collect();
        let shares = shares(self, cameras, &step);
        let root_move = DVec3::from_slice(&step.as_slice()[..3]);
        Direction { value, relative, is_null: false, step, root_move, joint_moves, deviation, shares }
    }

    /// How the pixels of all its cameras err.
    pub(crate) fn noise_of_all(&self) -> Noise {
        let all: Vec<usize> = (0..self.cameras.len()).collect();
        self.noise(&all, &self.spectrum(&all))
    }

    /// σ and κ of the module's header.
    fn noise(&self, cameras: &[usize], spectrum: &Spectrum) -> Noise {
        let (mut cost, mut weight) = (0.0, 0.0);
        let columns = spectrum.values.len();
        let mut scatter = DMatrix::zeros(columns, columns);
        for part in self.parts(cameras) {
            cost += part.weight * part.equations.cost;
            weight += part.weight * part.ramp_weight;
            scatter += &part.scatter * (part.weight * part.weight);
        }
        let rank = spectrum.rank as f64;
        if weight <= rank || rank == 0.0 {
            return Noise::white(0.0);
        }
        let variance = cost / (weight - rank);
        for axis in 0..3 {
            scatter.row_mut(axis).scale_mut(self.lever_m);
            scatter.column_mut(axis).scale_mut(self.lever_m);
        }
        let seen = (0..spectrum.rank).map(|index| {
            let u = spectrum.vectors.column(index);
            u.dot(&(&scatter * u)) / spectrum.values[index]
        });
        let together = seen.sum::<f64>() / (rank * variance.max(f64::MIN_POSITIVE));
        Noise { pixel_deviation: variance.sqrt(), together: together.max(1.0) }
    }

    /// A basis of the null space whose vectors can be named as far as possible: twists of limbs that their children
    /// cancel, then turns of one limb and moves of the root, then whatever is left. Unit vectors of the scaled state.
    fn null_basis(&self, spectrum: &Spectrum) -> Vec<DVector<f64>> {
        let count = spectrum.values.len() - spectrum.rank;
        if count == 0 {
            return Vec::new();
        }
        let null = spectrum.vectors.columns(spectrum.rank, count);
        let mut basis: Vec<DVector<f64>> = Vec::new();
        let mut span: Vec<DVector<f64>> = Vec::new();
        for candidate in self.candidates() {
            let inside = null * null.tr_mul(&candidate);
            if basis.len() == count || (&candidate - inside).norm() > OUTSIDE_NULL {
                continue;
            }
            let rest = span.iter().fold(candidate.clone(), |rest, u| &rest - u * u.dot(&rest));
            if rest.norm() > NEW_IN_SPAN {
                span.push(rest.normalize());
                basis.push(candidate);
            }
        }
        for column in null.column_iter() {
            let rest = span.iter().fold(column.into_owned(), |rest, u| &rest - u * u.dot(&rest));
            // Twice, since the first time leaves rounding.
            let rest = span.iter().fold(rest, |rest, u| &rest - u * u.dot(&rest));
            if basis.len() < count && rest.norm() > NEW_IN_SPAN {
                let unit = rest.normalize();
                span.push(unit.clone());
                basis.push(unit);
            }
        }
        basis
    }

    /// Unit vectors of the scaled state that have a name.
    fn candidates(&self) -> Vec<DVector<f64>> {
        let columns = Parameters::Tangent.columns(self.model.rotation_count());
        let mut found = Vec::new();
        let axes: Vec<DVec3> = self.model.rotation_owners().iter().map(|&owner| self.axis(owner)).collect();
        for (rotation, &axis) in axes.iter().enumerate() {
            found.push(self.twist(rotation, axis));
        }
        for (rotation, &axis) in axes.iter().enumerate() {
            let (across, other) = axis.any_orthonormal_pair();
            for turn in [across, other, axis] {
                let mut u = DVector::zeros(columns);
                self.set_turn(&mut u, rotation, turn);
                found.push(u);
            }
        }
        for axis in 0..3 {
            let mut u = DVector::zeros(columns);
            u[axis] = 1.0;
            found.push(u);
        }
        found
    }

    /// A turn of one limb about its own axis, taken back by all that turns with it.
    pub(super) fn twist(&self, rotation: usize, axis: DVec3) -> DVector<f64> {
        let mut u = DVector::zeros(Parameters::Tangent.columns(self.model.rotation_count()));
        self.set_turn(&mut u, rotation, axis);
        for (child, parent) in self.model.rotation_parents().iter().enumerate() {
            if *parent == Some(rotation) {
                self.set_turn(&mut u, child, -axis);
            }
        }
        u.normalize()
    }

    /// Direction of a limb in the world.
    pub(super) fn axis(&self, limb: usize) -> DVec3 {
        (self.kinematics.ends()[limb] - self.kinematics.starts()[limb]).normalize()
    }

    /// Writes a turn given in world axes into a rotation's columns.
    fn set_turn(&self, u: &mut DVector<f64>, rotation: usize, turn: DVec3) {
        let turn = self.kinematics.parent_frames()[rotation].transpose() * turn;
        let first = Parameters::Tangent.first_column(rotation);
        u.as_mut_slice()[first..first + 3].copy_from_slice(&turn.to_array());
    }
}
