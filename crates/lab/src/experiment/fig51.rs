//! Fig. 5.1: one limb seen from the side, started off along its own axis, with three renderers.
//!
//! Moving along the axis changes only the ends of the limb's silhouette. A capsule's round ends and the spheres
//! of a sphere tree pull it home. A cylinder's flat cap, seen from the side, covers no pixel, and the distance to
//! its axis does not depend on where along the axis the ray passes: the pixels at the ends have no gradient, and
//! the fit stays where it began. A camera that is near looks at the caps from the front a little; there the
//! cylinder feels them.

use std::sync::Arc;

use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::render::RendererKind;
use glam::{DQuat, DVec3};
use serde::Serialize;

use super::curve::Curve;
use super::{ExperimentError, Progress, Simulation, scene};

/// The renderers, in the order of the report.
pub const RENDERERS: [RendererKind; 3] =
    [RendererKind::Cylinder, RendererKind::Capsule, RendererKind::SphereTree { spheres: None }];

/// What to vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// How far the camera is from the limb in each part of the experiment, metres. The limb is as large in all
    /// pictures.
    pub distances_m: Vec<f64>,
    /// How far along its axis the limb starts from the truth, metres.
    pub offset_m: f64,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// How the data are made: the same for all renderers, grey levels by the capsule.
    pub simulation: Simulation,
    /// The solver; its renderer is replaced by each of the three.
    pub fit: FitOptions,
}

impl Default for Options {
    fn default() -> Self {
        let mut fit = FitOptions::preset(Preset::Report);
        fit.run_all = true;
        Self {
            distances_m: vec![10.0, 0.8],
            offset_m: 0.1,
            size_px: [192, 144],
            simulation: Simulation::Prediction,
            fit,
        }
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// One part a distance of the camera.
    pub parts: Vec<Part>,
}

/// One distance of the camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Metres from the limb.
    pub distance_m: f64,
    /// One curve a renderer, named after it.
    pub curves: Vec<Curve>,
}

/// The limb's true pose: across the picture, its middle at the origin.
#[must_use]
pub fn truth() -> Pose {
    let model = builtin::single_limb();
    let limb = &model.limbs()[0];
    let across = DQuat::from_rotation_arc(limb.direction, DVec3::X);
    Pose { root: DVec3::NEG_X * (0.5 * limb.length), rotations: vec![across] }
}

/// Where the fit starts: `offset_m` along the axis.
#[must_use]
pub fn start(offset_m: f64) -> Pose {
    let mut pose = truth();
    pose.root += DVec3::X * offset_m;
    pose
}

/// A camera that sees the limb from the side; the limb takes half of the picture's width.
///
/// # Errors
/// A distance or a size that no camera can have.
pub fn camera(distance_m: f64, size_px: [u64; 2]) -> Result<Camera, ExperimentError> {
    let length = builtin::single_limb().limbs()[0].length;
    let focal = 0.5 * size_px[0] as f64 * distance_m / length;
    let [cx, cy] = size_px.map(|side| 0.5 * (side as f64 - 1.0));
    let place = CameraFromWorld::looking_at(DVec3::Z * distance_m, DVec3::ZERO, DVec3::Y);
    let intrinsics = Intrinsics { fx: focal, fy: focal, cx, cy };
    Ok(Camera::new("side", size_px, intrinsics, Distortion::None, place)?)
}

/// Runs all renderers from one start, for every distance of the camera.
///
/// # Errors
/// Options that make no sense, or `cancel`.
pub fn run(
    options: &Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    if !options.offset_m.is_finite() {
        let value = options.offset_m;
        return Err(ExperimentError::Option {
            option: "offset_m",
            value,
            expected: "a finite number of metres",
        });
    }
    let model = Arc::new(builtin::single_limb());
    let (truth, start) = (truth(), start(options.offset_m));
    let total = options.distances_m.len() * RENDERERS.len();
    let mut parts = Vec::new();
    for &distance_m in &options.distances_m {
        let camera = Arc::new(camera(distance_m, options.size_px)?);
        let mut curves = Vec::new();
        let ramp = options.fit.final_ramp();
        let view = scene::view(&model, &truth, &camera, options.simulation, RendererKind::Capsule, ramp)?;
        for renderer in RENDERERS {
            on_progress(Progress { done: parts.len() * RENDERERS.len() + curves.len(), total });
            let fit = FitOptions { renderer, ..options.fit.clone() };
            let views = vec![view.clone()];
            curves.push(Curve::of(renderer.name(), &model, &truth, views, &start, fit, cancel)?);
        }
        parts.push(Part { distance_m, curves });
    }
    on_progress(Progress { done: total, total });
    Ok(Report { parts })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Report {
        run(&Options::default(), &CancelToken::new(), |_| {}).unwrap()
    }

    #[test]
    fn from_afar_the_cylinder_stays_and_the_others_come_home() {
        let report = report();
        let percent: Vec<f64> = report.parts[0].curves.iter().map(Curve::final_percent).collect();
        assert!(percent[0] >= 99.0, "{percent:?}");
        assert!(percent[1] < 5.0 && percent[2] < 5.0, "{percent:?}");
        assert!(report.parts[0].curves[1].final_joint_error_mm() < 10.0);
    }

    #[test]
    fn near_by_the_cylinder_feels_its_caps() {
        let report = report();
        let percent: Vec<f64> = report.parts[1].curves.iter().map(Curve::final_percent).collect();
        assert!(percent[0] < 90.0, "{percent:?}");
    }
}
