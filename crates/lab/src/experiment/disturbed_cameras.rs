//! Cameras that are not where their calibration says, a person who moves before them, and how far a rig is from another.

use std::sync::Arc;

use backlit_tracking::body::Model;
use backlit_tracking::camera::{Camera, CameraChange};
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::geometry::{Similarity, umeyama};
use glam::{DVec2, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use super::ExperimentError;
use crate::synthetic::{capsules, exercise, masks};

/// By how much calibrations are wrong: every camera by as much, each in a direction of its own.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disturbance {
    /// Turn, radians.
    pub turn: f64,
    /// Move of the centre, metres.
    pub shift_m: f64,
    /// Focal length, as a share of it.
    pub focal_length: f64,
    /// The clock, seconds; the first camera's is right.
    pub offset_s: f64,
}

/// Share of wrong pixels along the edges of simulated silhouettes.
const EDGE_NOISE: f64 = 0.2;
/// How far before a camera the person is, metres.
const SUBJECT_M: f64 = 3.0;

impl Disturbance {
    /// What the calibration of a camera says, and by how many seconds the camera is late.
    ///
    /// # Errors
    /// The numbers make no camera.
    pub fn of(&self, camera: &Camera, index: usize, seed: u64) -> Result<(Camera, f64), ExperimentError> {
        let mut random = Pcg64Mcg::seed_from_u64(seed.wrapping_mul(1009).wrapping_add(index as u64));
        let mut direction = || loop {
            let at = DVec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0)));
            if (0.1..1.0).contains(&at.length()) {
                break at.normalize();
            }
        };
        let sign = if (index as u64 + seed).is_multiple_of(2) { 1.0 } else { -1.0 };
        let change = CameraChange {
            turn: self.turn * direction(),
            shift: self.shift_m * direction(),
            zoom: (1.0 + sign * self.focal_length).ln(),
            principal_px: DVec2::ZERO,
        };
        let late_s = if index == 0 { 0.0 } else { sign * self.offset_s };
        Ok((camera.changed(&change)?, late_s))
    }
}

/// What cameras see of a person who walks, squats, signals and boxes, at a moment of their own each, seconds.
///
/// # Errors
/// A camera has no pixels.
pub fn film(
    model: &Model,
    cameras: &[Arc<Camera>],
    late_s: &[f64],
    seconds: f64,
    seed: u64,
) -> Result<Vec<FitView>, ExperimentError> {
    let one = |(index, (camera, late_s)): (usize, (&Arc<Camera>, &f64))| {
        let exact = capsules::hard_mask(model, &exercise::pose(model, seconds + late_s), camera)?;
        let seed = seed.wrapping_mul(31).wrapping_add(index as u64) ^ seconds.to_bits();
        let mask = masks::noisy(&exact, EDGE_NOISE, 0.0, &mut Pcg64Mcg::seed_from_u64(seed));
        Ok(FitView { camera: Arc::clone(camera), evidence: Evidence::Mask(Arc::new(mask)), weight: 1.0 })
    };
    cameras.iter().zip(late_s).enumerate().map(one).collect()
}

/// How far cameras are from the true ones, once the whole rig lies as near to these as it can: what silhouettes cannot tell is
/// no error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigError {
    /// Mean turn, degrees.
    pub turn_deg: f64,
    /// Mean distance of the centres, millimetres.
    pub shift_mm: f64,
    /// Mean error of the focal lengths, per cent.
    pub focal_percent: f64,
    /// The true world from the cameras' own.
    pub alignment: Similarity,
}

impl RigError {
    /// `None` where the cameras have no extent.
    #[must_use]
    pub fn between(found: &[Camera], truth: &[Camera]) -> Option<Self> {
        // How large the rig is: silhouettes do not tell.
        let extent = |rig: &[Camera]| -> f64 {
            let middle = rig.iter().map(Camera::centre).sum::<DVec3>() / rig.len() as f64;
            rig.iter().map(|camera| camera.centre().distance_squared(middle)).sum::<f64>().sqrt()
        };
        // A place before the camera, and one beside it, turn with it and grow with the rig.
        let scale = extent(found) / extent(truth);
        let points = |(camera, unit): (&Camera, f64)| {
            let axes = camera.camera_from_world().rotation.transpose() * unit;
            let ahead = camera.centre() + SUBJECT_M * axes.z_axis;
            [camera.centre(), ahead, ahead + axes.x_axis, ahead + axes.y_axis]
        };
        let all = |(rig, unit): (&[Camera], f64)| -> Vec<DVec3> {
            rig.iter().map(|camera| (camera, unit)).flat_map(points).collect()
        };
        let [from, to] = [(found, scale), (truth, 1.0)].map(all);
        let alignment = umeyama(&from, &to)?;
        let (mut turn, mut shift, mut focal) = (0.0, 0.0, 0.0);
        for (found, truth) in found.iter().zip(truth) {
            let rotation = found.camera_from_world().rotation * alignment.rotation.transpose();
            let apart = rotation * truth.camera_from_world().rotation.transpose();
            let cosine = 0.5 * (apart.x_axis.x + apart.y_axis.y + apart.z_axis.z - 1.0);
            turn += cosine.clamp(-1.0, 1.0).acos().to_degrees();
            shift += 1e3 * alignment.apply(found.centre()).distance(truth.centre());
            focal += 100.0 * (found.intrinsics().fx / truth.intrinsics().fx - 1.0).abs();
        }
        let count = truth.len() as f64;
        let [turn_deg, shift_mm, focal_percent] = [turn, shift, focal].map(|sum| sum / count);
        Some(Self { turn_deg, shift_mm, focal_percent, alignment })
    }
}
