//! What cues of the pictures say of limbs: keypoints, optic flow, edges, points in space. They stand beside the
//! silhouettes, D − Λ, and decide where those do not.
//!
//! A point fixed in a limb is p = p0 + R a, with a in the limb's rest frame (its `arm`), R the world rotation of the limb
//! and p0 its first joint. With π the pinhole and m metres a pixel at the limb's depth, all residuals are metres:
//!
//! | target | ρ | ∂(prediction)/∂p |
//! |---|---|---|
//! | pixel u | m (u − π(p)), two rows | m ∂π/∂p |
//! | line through the pixel u, unit normal n | m n·(u − π(p)) | m nᵀ ∂π/∂p |
//! | point x of the surface | r − \|x − q\|, q the axis's nearest point | −(x − q)/\|x − q\|, at q |
//!
//! ∂π/∂p = [fx/z, 0, −fx x/z²; 0, fy/z, −fy y/z²] `R_camera` with p = (x, y, z) in camera axes. The nearest point is
//! stationary along the axis, so that its own motion drops out. Each row is a force at a point of the limb, a
//! [wrench](crate::render::wrench): it is summed by limb and mapped to the state once a limb, as pixels are.
//!
//! The cost of a pull is w c(‖ρ‖²) with its [`Loss`] c in metres; JᵀJ and Jᵀρ are multiplied by w c′.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::loss::Loss;
use super::silhouette::WorldBlocks;
use crate::body::{Kinematics, Model};
use crate::camera::Camera;
use crate::render::wrench::Wrench;

/// Points nearer to a camera's plane than this are not pulled, metres.
const NEAREST: f64 = 0.05;

/// Kinds of evidence beside the silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cue {
    /// Two-dimensional keypoints of another tool.
    Keypoints,
    /// Points of the surface carried from the last frame by optic flow.
    Flow,
    /// Edges of the picture along a limb's outline.
    Edges,
    /// Points in space, from patches that neighbouring cameras see alike.
    Stereo,
}

impl Cue {
    /// All of them, in the order in which they are told.
    pub const ALL: [Self; 4] = [Self::Keypoints, Self::Flow, Self::Edges, Self::Stereo];

    /// Its word in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Keypoints => "keypoints",
            Self::Flow => "flow",
            Self::Edges => "edges",
            Self::Stereo => "stereo",
        }
    }
}

/// Where something of a limb was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CueTarget {
    /// A point of the limb is at a pixel.
    Pixel {
        /// Index into the set's cameras.
        camera: usize,
        /// The point, from the limb's first joint in its rest frame, metres.
        arm: DVec3,
        /// Pixels.
        pixel: DVec2,
    },
    /// A point of the limb's outline is on a line.
    Line {
        /// Index into the set's cameras.
        camera: usize,
        /// The point, from the limb's first joint in its rest frame, metres.
        arm: DVec3,
        /// A pixel of the line.
        pixel: DVec2,
        /// The line's unit normal.
        normal: DVec2,
    },
    /// The limb's surface goes through a point.
    Surface {
        /// World, metres.
        point: DVec3,
    },
}

/// One thing that was seen, and how much it counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CuePull {
    /// What saw it.
    pub cue: Cue,
    /// The limb that it pulls.
    pub limb: usize,
    /// Where it was seen.
    pub target: CueTarget,
    /// Metres a pixel at the limb's depth; 1 for points in space.
    pub metres_per_px: f64,
    /// Per m², in the unit of a fit's priors.
    pub weight: f64,
    /// Scale in metres.
    pub loss: Loss,
}

/// Everything that cues say of one frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CueSet {
    /// Ideal pinholes.
    pub cameras: Vec<Arc<Camera>>,
    /// What was seen. Limbs and cameras are of this set's body and cameras.
    pub pulls: Vec<CuePull>,
}

/// What is wrong with a pull.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum CueError {
    #[error("pull {index} of the {cue} is at limb {limb}; the model has {limbs} limbs")]
    Limb { index: usize, cue: &'static str, limb: usize, limbs: usize },
    #[error("pull {index} of the {cue} is in camera {camera}; expected one of {cameras} cameras")]
    Camera { index: usize, cue: &'static str, camera: usize, cameras: usize },
    #[error("pull {index} of the {cue} has numbers that are not finite, or a weight or a loss below 0")]
    Number { index: usize, cue: &'static str },
    #[error("camera \"{camera}\" has lens distortion; expected rectified pictures and an ideal camera")]
    Distorted { camera: String },
}

/// A pull at one pose: ρ, and where and along what its rows push.
struct PullRows {
    /// As many as count.
    residuals: [f64; 2],
    forces: [DVec3; 2],
    /// From the limb's first joint, world axes.
    arm: DVec3,
}

impl PullRows {
    fn squared(&self) -> f64 {
        self.residuals[0] * self.residuals[0] + self.residuals[1] * self.residuals[1]
    }
}

impl CueSet {
    /// Checks that all pulls can be computed with.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self, model: &Model) -> Result<(), CueError> {
        if let Some(camera) = self.cameras.iter().find(|camera| !camera.distortion().is_none()) {
            return Err(CueError::Distorted { camera: camera.name().to_owned() });
        }
        for (index, pull) in self.pulls.iter().enumerate() {
            let cue = pull.cue.name();
            if pull.limb >= model.limbs().len() {
                return Err(CueError::Limb { index, cue, limb: pull.limb, limbs: model.limbs().len() });
            }
            let (camera, is_finite) = match pull.target {
                CueTarget::Surface { point } => (None, point.is_finite()),
                CueTarget::Pixel { camera, arm, pixel } => {
                    (Some(camera), arm.is_finite() && pixel.is_finite())
                }
                CueTarget::Line { camera, arm, pixel, normal } => {
                    (Some(camera), arm.is_finite() && pixel.is_finite() && normal.is_finite())
                }
            };
            let cameras = self.cameras.len();
            if let Some(camera) = camera.filter(|&camera| camera >= cameras) {
                return Err(CueError::Camera { index, cue, camera, cameras });
            }
            let numbers = [pull.weight, pull.metres_per_px];
            let are_good = numbers.iter().all(|number| number.is_finite() && *number >= 0.0);
            if !(is_finite && are_good && pull.loss.is_valid()) {
                return Err(CueError::Number { index, cue });
            }
        }
        Ok(())
    }

    /// Adds all pulls as wrenches, world axes, `unit` squared grey levels for a weight of 1; returns their cost.
    ///
    /// A point that lies behind its camera is left out.
    pub fn add(&self, model: &Model, kinematics: &Kinematics, unit: f64, blocks: &mut WorldBlocks) -> f64 {
        let mut cost = 0.0;
        for pull in &self.pulls {
            let Some(rows) = self.rows(pull, model, kinematics) else { continue };
            let (squared, weight) = (rows.squared(), unit * pull.weight);
            cost += weight * pull.loss.cost(squared);
            let believed = weight * pull.loss.weight(squared);
            if believed > 0.0 {
                for (residual, force) in rows.residuals.into_iter().zip(rows.forces) {
                    blocks.add_wrench(pull.limb, Wrench::at(force, rows.arm), believed, residual);
                }
            }
        }
        cost
    }

    /// How far a pull is from what was seen, metres, and how much its loss believes it, 0 to 1; `None` behind the camera.
    pub fn distance(&self, pull: &CuePull, model: &Model, kinematics: &Kinematics) -> Option<(f64, f64)> {
        let squared = self.rows(pull, model, kinematics)?.squared();
        Some((squared.sqrt(), pull.loss.weight(squared)))
    }

    fn rows(&self, pull: &CuePull, model: &Model, kinematics: &Kinematics) -> Option<PullRows> {
        let start = kinematics.starts()[pull.limb];
        let limb = &model.limbs()[pull.limb];
        match pull.target {
            CueTarget::Surface { point } => {
                let axis = kinematics.ends()[pull.limb] - start;
                let along = ((point - start).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
                let arm = axis * along;
                let off = point - start - arm;
                let distance = off.length();
                let out = off.try_normalize()?;
                Some(PullRows { residuals: [limb.radius - distance, 0.0], forces: [-out, DVec3::ZERO], arm })
            }
            CueTarget::Pixel { camera, arm, pixel } | CueTarget::Line { camera, arm, pixel, .. } => {
                let arm = kinematics.world_rotations()[limb.rotation] * arm;
                let camera = &self.cameras[camera];
                let place = camera.camera_from_world();
                let p = place.transform(start + arm);
                if p.z < NEAREST {
                    return None;
                }
                let pinhole = camera.intrinsics();
                let plane = DVec2::new(p.x / p.z, p.y / p.z);
                let off = (pixel - pinhole.pixel_from_plane(plane)) * pull.metres_per_px;
                let world_from_camera = place.rotation.transpose();
                let by = |row: DVec3| world_from_camera * (row * (pull.metres_per_px / p.z));
                let across = by(DVec3::new(pinhole.fx, 0.0, -pinhole.fx * plane.x));
                let down = by(DVec3::new(0.0, pinhole.fy, -pinhole.fy * plane.y));
                Some(match pull.target {
                    CueTarget::Line { normal, .. } => PullRows {
                        residuals: [normal.dot(off), 0.0],
                        forces: [across * normal.x + down * normal.y, DVec3::ZERO],
                        arm,
                    },
                    _ => PullRows { residuals: off.to_array(), forces: [across, down], arm },
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{Pose, builtin};
    use crate::fixtures::{self, BOTH, Failures, check_gradient, differences};
    use crate::optimize::NormalEquations;
    use crate::residual::silhouette::StateMap;

    fn set(model: &Model, loss: Loss) -> CueSet {
        let (size, intrinsics, middle) = ([64, 80], [90.0, 85.0, 31.0, 40.0], DVec3::new(0.1, 0.3, 0.0));
        let camera = |at| Arc::new(fixtures::camera(size, intrinsics, at, middle, DVec3::Y));
        let cameras = vec![camera(DVec3::new(0.6, 0.4, 2.6)), camera(DVec3::new(-1.2, 0.3, 2.3))];
        let mut pulls = Vec::new();
        for limb in 0..model.limbs().len() {
            let wave = |k: f64| (limb as f64 * 1.3 + k).sin();
            let arm = DVec3::new(0.05 * wave(0.0), 0.1 * wave(1.0), 0.04 * wave(2.0));
            let pixel = DVec2::new(31.0 + 9.0 * wave(3.0), 40.0 + 9.0 * wave(4.0));
            let target = match limb % 3 {
                0 => CueTarget::Pixel { camera: limb % 2, arm, pixel },
                1 => CueTarget::Line { camera: limb % 2, arm, pixel, normal: DVec2::from_angle(limb as f64) },
                _ => CueTarget::Surface { point: DVec3::new(wave(5.0), wave(6.0), wave(7.0)) * 0.4 },
            };
            let metres_per_px = if limb % 3 == 2 { 1.0 } else { 0.03 };
            pulls.push(CuePull {
                cue: Cue::Flow,
                limb,
                target,
                metres_per_px,
                weight: 40.0 + limb as f64,
                loss,
            });
        }
        CueSet { cameras, pulls }
    }

    /// Jᵀρ against differences of the cost, for every target, loss and parametrisation; JᵀJ of plain squares against
    /// differences of the residuals.
    #[test]
    fn derivatives_match_differences() {
        let model = builtin::upper_body();
        let mut failures = Failures::default();
        for loss in [Loss::Squares, Loss::Cauchy { scale: 0.1 }, Loss::Huber { scale: 0.1 }] {
            let set = set(&model, loss);
            for parameters in BOTH {
                let n = parameters.columns(model.rotation_count());
                let pose = fixtures::stepped(&model, parameters, |i| 0.4 * (1.7 * i as f64).sin());
                let cost = |pose: &Pose| {
                    let kinematics = Kinematics::new(&model, pose);
                    let mut blocks = WorldBlocks::new(model.limbs().len());
                    let mut equations = NormalEquations::zeros(n);
                    equations.cost = set.add(&model, &kinematics, 3.0, &mut blocks);
                    blocks.add_to(&kinematics, parameters, &mut StateMap::default(), &mut equations);
                    equations
                };
                let rows = |pose: &Pose| -> Vec<f64> {
                    let kinematics = Kinematics::new(&model, pose);
                    let of = |pull| {
                        let rows = set.rows(pull, &model, &kinematics).unwrap();
                        rows.residuals.map(|residual| (3.0 * pull.weight).sqrt() * residual)
                    };
                    set.pulls.iter().flat_map(of).collect()
                };
                let add = |equations: &mut NormalEquations, pose: &Pose| *equations = cost(pose);
                let name = format!("{loss:?}");
                let here = check_gradient(&name, parameters, &pose, add, 5e-6, &mut failures);
                if loss == Loss::Squares {
                    let jacobian = differences(parameters, &pose, rows);
                    let worst = (jacobian.tr_mul(&jacobian) - &here.jtj).amax() / here.jtj.amax();
                    failures
                        .expect(worst <= 1e-5, format_args!("{parameters:?}: JᵀJ differs by {worst:.1e}"));
                }
            }
        }
    }

    #[test]
    fn what_is_behind_a_camera_does_not_pull() {
        let model = builtin::single_limb();
        let mut set = set(&model, Loss::Squares);
        let mut pose = Pose::rest(&model);
        pose.root = set.cameras[0].centre() + (set.cameras[0].centre() - DVec3::ZERO);
        let kinematics = Kinematics::new(&model, &pose);
        let mut blocks = WorldBlocks::new(1);
        assert_eq!(set.add(&model, &kinematics, 1.0, &mut blocks), 0.0);
        assert!(blocks.is_empty());
        // Nor does a point on the very axis: it has no direction to push.
        set.pulls[0].target = CueTarget::Surface { point: pose.root };
        assert_eq!(set.add(&model, &kinematics, 1.0, &mut blocks), 0.0);
    }
}
