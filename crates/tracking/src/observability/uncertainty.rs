//! How well the cameras know each joint: covariance in the world, and its ellipse in a picture.
//!
//! With p the joint, K = ∂p/∂δ, H⁺ the pseudo-inverse of the seen directions and N the null ones,
//!
//! ```text
//! Cov(p) = σ²κ K H⁺ Kᵀ       m², what is seen
//! U(p)   = K N Nᵀ Kᵀ         m², moves of the joint for a unit step of what is not seen: no bound
//! ```
//!
//! and in a picture A Cov Aᵀ and A U Aᵀ with A = ∂pixel/∂p.

use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};

use super::information::{FrameInformation, Spectrum};
use crate::body::{Kinematics, Model, Parameters, Pose};
use crate::camera::Camera;

/// A joint that null directions move by less than this for a unit step, metres, is not moved by them: rounding.
const MOVED_BY_NULL_M: f64 = 1e-6;

/// What is known of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointUncertainty {
    /// The limb whose second joint it is; `None` for the root.
    pub limb: Option<usize>,
    /// Where it is, world metres.
    pub at: DVec3,
    /// Covariance of what is seen of it, world m².
    pub covariance: Matrix3<f64>,
    /// K N Nᵀ Kᵀ: zero where every move of the joint is seen.
    pub unseen: Matrix3<f64>,
}

/// A joint's uncertainty in a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageEllipse {
    /// Where the joint is, pixels.
    pub centre: DVec2,
    /// Half axes of one standard deviation, pixels, the longer first.
    pub half_axes: [DVec2; 2],
    /// Unit vectors along which nothing bounds it: none, one, or both of the picture's.
    pub unseen: Vec<DVec2>,
}

impl JointUncertainty {
    /// Whether some move of the joint is not seen at all.
    #[must_use]
    pub fn is_unbounded(&self) -> bool {
        self.unseen.symmetric_eigenvalues().max() > MOVED_BY_NULL_M.powi(2)
    }

    /// Standard deviation in the worst direction, metres; infinite where nothing bounds it.
    #[must_use]
    pub fn worst_deviation_m(&self) -> f64 {
        if self.is_unbounded() {
            return f64::INFINITY;
        }
        self.covariance.symmetric_eigenvalues().max().max(0.0).sqrt()
    }

    /// eᵀ Cov⁻¹ e of the error e from where the joint truly is: χ² of three degrees of freedom if the covariance is honest. `None`
    /// where the covariance is certain of a direction.
    #[must_use]
    pub fn error_squared(&self, truth: DVec3) -> Option<f64> {
        let error = Vector3::from((truth - self.at).to_array());
        Some(error.dot(&self.covariance.cholesky()?.solve(&error)))
    }

    /// Standard deviations as a camera sees the joint, metres: in the worst direction across its sight ray, and along it.
    /// Infinite where nothing bounds it.
    #[must_use]
    pub fn deviations_from(&self, camera: &Camera) -> [f64; 2] {
        let ray = (self.at - camera.centre()).normalize_or(DVec3::Z);
        let ray = Vector3::new(ray.x, ray.y, ray.z);
        let aside = Matrix3::identity() - ray * ray.transpose();
        let parts = |matrix: &Matrix3<f64>| {
            let across = (aside * matrix * aside).symmetric_eigenvalues().max();
            [across, (ray.transpose() * matrix * ray)[0]]
        };
        let (seen, unseen) = (parts(&self.covariance), parts(&self.unseen));
        std::array::from_fn(|part| {
            let is_bounded = unseen[part] <= MOVED_BY_NULL_M.powi(2);
            if is_bounded { seen[part].max(0.0).sqrt() } else { f64::INFINITY }
        })
    }

    /// One standard deviation in a camera's picture, to first order, for an ideal pinhole. `None` behind the camera.
    #[must_use]
    pub fn ellipse(&self, camera: &Camera) -> Option<ImageEllipse> {
        let centre = camera.project(self.at)?;
        let by_point = pixel_by_point(camera, self.at);
        let [long, short] = axes(&(by_point * self.covariance * by_point.transpose()));
        let unseen = by_point * self.unseen * by_point.transpose();
        // A metre of the joint is this many pixels: rounding is measured by that.
        let least = MOVED_BY_NULL_M * camera.intrinsics().mean_focal_px() / camera.depth(self.at).max(1e-9);
        let unseen = axes(&unseen).into_iter().filter(|axis| axis.length() > least);
        Some(ImageEllipse {
            centre,
            half_axes: [long, short],
            unseen: unseen.map(DVec2::normalize).collect(),
        })
    }
}

/// A = ∂pixel/∂p of an ideal pinhole, pixels per metre.
fn pixel_by_point(camera: &Camera, point: DVec3) -> Matrix2x3<f64> {
    let place = camera.camera_from_world();
    let (k, p) = (camera.intrinsics(), place.transform(point));
    let by_camera = Matrix2x3::new(
        k.fx / p.z,
        0.0,
        -k.fx * p.x / (p.z * p.z),
        0.0,
        k.fy / p.z,
        -k.fy * p.y / (p.z * p.z),
    );
    // Columns one after the other: what nalgebra takes for columns too.
    by_camera * Matrix3::from_column_slice(&place.rotation.to_cols_array())
}

/// Half axes of a symmetric 2 × 2 matrix, the longer first.
fn axes(matrix: &Matrix2<f64>) -> [DVec2; 2] {
    let eigen = matrix.symmetric_eigen();
    let half = |index: usize| {
        let axis: Vector2<f64> = eigen.eigenvectors.column(index).into_owned();
        DVec2::new(axis[0], axis[1]) * eigen.eigenvalues[index].max(0.0).sqrt()
    };
    let (a, b) = (half(0), half(1));
    if a.length() >= b.length() { [a, b] } else { [b, a] }
}

/// The joints that are told of, by the limb whose second joint each is: where a limb with a rotation of its own grows, and
/// the end of every limb with one that carries no other. What lies between is rigid with them.
#[must_use]
pub fn articulated_joints(model: &Model) -> Vec<usize> {
    let limbs = model.limbs();
    let carries = |rotation: usize| {
        let mut grown = limbs.iter().filter(|limb| limb.has_own_rotation).filter_map(|limb| limb.parent);
        grown.any(|parent| limbs[parent].rotation == rotation)
    };
    let is_joint = |index: &usize| {
        let grows_here = limbs.iter().any(|limb| limb.has_own_rotation && limb.parent == Some(*index));
        grows_here || (limbs[*index].has_own_rotation && !carries(limbs[*index].rotation))
    };
    (0..limbs.len()).filter(is_joint).collect()
}

/// What a belief about a pose knows of the joints, root first: K P Kᵀ with P the covariance in tangent columns (n × n). Nothing is
/// without a bound.
#[must_use]
pub fn believed_joints(model: &Model, pose: &Pose, covariance: &DMatrix<f64>) -> Vec<JointUncertainty> {
    let kinematics = Kinematics::new(model, pose);
    let one = |limb: Option<usize>| {
        let by_step = by_step(&kinematics, limb, covariance.nrows());
        let spread = &by_step * covariance * by_step.transpose();
        let at = limb.map_or(pose.root, |limb| kinematics.ends()[limb]);
        let covariance = Matrix3::from_fn(|row, column| spread[(row, column)]);
        JointUncertainty { limb, at, covariance, unseen: Matrix3::zeros() }
    };
    of_joints(model, one)
}

/// K = ∂p/∂δ of a limb's second joint, or of the root.
fn by_step(kinematics: &Kinematics, limb: Option<usize>, columns: usize) -> DMatrix<f64> {
    limb.map_or_else(
        || DMatrix::identity(3, columns),
        |limb| kinematics.end_jacobian(limb, Parameters::Tangent),
    )
}

/// Root first, then the joints of [`articulated_joints`].
fn of_joints(model: &Model, one: impl Fn(Option<usize>) -> JointUncertainty) -> Vec<JointUncertainty> {
    std::iter::once(None).chain(articulated_joints(model).into_iter().map(Some)).map(one).collect()
}

/// Root first, then the joints of [`articulated_joints`].
pub(super) fn joint_uncertainties(
    information: &FrameInformation,
    spectrum: &Spectrum,
    deviation: f64,
) -> Vec<JointUncertainty> {
    let (kinematics, model) = (&information.kinematics, &information.model);
    let one = |limb: Option<usize>| {
        let mut by_step = by_step(kinematics, limb, spectrum.values.len());
        for axis in 0..3 {
            by_step.column_mut(axis).scale_mut(information.lever_m);
        }
        let moves = by_step * &spectrum.vectors;
        let (mut covariance, mut unseen) = (Matrix3::zeros(), Matrix3::zeros());
        for (index, column) in moves.column_iter().enumerate() {
            let by = Vector3::new(column[0], column[1], column[2]);
            if index < spectrum.rank {
                covariance += by * by.transpose() * (deviation * deviation / spectrum.values[index]);
            } else {
                unseen += by * by.transpose();
            }
        }
        let at = limb.map_or(information.pose.root, |limb| kinematics.ends()[limb]);
        JointUncertainty { limb, at, covariance, unseen }
    };
    of_joints(model, one)
}
