//! Where to put cameras: what they would see of a body anywhere on a floor, before anything is filmed.
//!
//! # What is computed
//!
//! At each place of a [`FloorArea`] a body stands, walks and reaches, turned all ways ([`people`]). For every camera
//! JᵀJ is summed over what the model itself predicts: no footage is needed, and silhouettes that agree with the model are the best that
//! there can be. For a set S of cameras the joints' covariances follow as in the module above,
//!
//! ```text
//! Cov(p) = σ²κ · K (Σ_{c∈S} J_cᵀJ_c)⁺ Kᵀ
//! deviation of p = √(largest eigenvalue of Cov(p)), metres; infinite where nothing bounds p
//! ```
//!
//! # What is assumed
//!
//! No prior, no motion so far: silhouettes of one moment alone. Twists of limbs, which no camera sees, move no joint and count
//! nowhere. σ√κ is given, the same for all cameras and places ([`PLANNED_NOISE`]). Silhouettes err by clothes and by
//! segmentation, which finer pictures do not mend: pictures in which the thinnest limb is thicker than the solver's stages are meant
//! for are reduced to that, coarser ones are taken as they are. Lenses are ideal, nothing stands in the way, the whole body is
//! one person of known sizes.
//!
//! A deviation is to first order: where it is some centimetres it can be believed, where it is larger than a limb is thick it
//! says no more than "not known". Each counts as [`LOST_M`] at most, so that means exist.

mod area;
mod bodies;
mod figures;

use std::sync::Arc;

use rayon::prelude::*;

pub use area::{Floor, FloorArea, camera_ring};
pub use bodies::people;
pub use figures::{PlaceFigures, PlannedSet};

use super::directions::Noise;
use super::information::FrameInformation;
use super::uncertainty::{articulated_joints, joint_uncertainties};
use crate::body::{Model, Pose};
use crate::camera::{Camera, CameraError};
use crate::fit::{FitOptions, MEANT_FOR_PX};
use crate::render::{Ramp, RendererKind};

/// σ√κ, grey levels, as `backlit observability` measures it on the balancing footage: 94 times 4.3.
pub const PLANNED_NOISE: f64 = 400.0;
/// A joint that is farther off is lost, metres: as tracks are judged.
pub const LOST_M: f64 = 0.25;
/// A camera nearer to the middle than this, metres, is taken to be so far away.
const NEAREST_M: f64 = 0.3;
/// The middle of a body, metres above the floor.
pub(super) const MIDDLE_M: f64 = 0.9;

/// Cameras, sets of them, and bodies on a floor.
#[derive(Debug, Clone)]
pub struct CameraPlan {
    model: Arc<Model>,
    /// At the floor's origin.
    bodies: Vec<Pose>,
    floor: Floor,
    cameras: Vec<Arc<Camera>>,
    sets: Vec<Vec<usize>>,
    noise: Noise,
    drawn: (RendererKind, Ramp),
}

impl CameraPlan {
    /// A plan for sets of these cameras, by their indices; the bodies are [`people`]. Of `fit`, the solid and the last stage's ramp
    /// count.
    ///
    /// # Errors
    /// A camera that cannot be reduced.
    pub fn new(
        model: &Arc<Model>,
        (floor, area): (Floor, &FloorArea),
        cameras: &[Arc<Camera>],
        sets: Vec<Vec<usize>>,
        noise: Noise,
        fit: &FitOptions,
    ) -> Result<Self, CameraError> {
        let thinnest = model.limbs().iter().map(|limb| limb.radius).fold(f64::INFINITY, f64::min);
        let middle = floor.point(area.middle, MIDDLE_M);
        let reduced = |camera: &Arc<Camera>| {
            let ideal = camera.without_distortion();
            let depth = ideal.centre().distance(middle).max(NEAREST_M);
            let scale = MEANT_FOR_PX * depth / (thinnest * ideal.intrinsics().mean_focal_px());
            if scale.is_finite() && scale < 1.0 {
                let size = [ideal.width(), ideal.height()].map(|side| (side as f64 * scale).ceil() as u64);
                return Ok(Arc::new(ideal.remapped(size, glam::DVec2::splat(scale), glam::DVec2::ZERO)?));
            }
            Ok(Arc::new(ideal))
        };
        let ramp = fit.stages.last().map_or_else(Ramp::default, |stage| stage.ramp);
        Ok(Self {
            bodies: people(model, &floor),
            cameras: cameras.iter().map(reduced).collect::<Result<_, CameraError>>()?,
            model: Arc::clone(model),
            drawn: (fit.renderer, ramp),
            floor,
            sets,
            noise,
        })
    }

    /// The same for other bodies, at the floor's origin: of a movement that is known.
    #[must_use]
    pub fn with_bodies(self, bodies: Vec<Pose>) -> Self {
        Self { bodies, ..self }
    }

    /// The sets of cameras, as they were given.
    #[must_use]
    pub fn sets(&self) -> &[Vec<usize>] {
        &self.sets
    }

    /// Number of bodies at each place.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// What each set of cameras sees of the bodies at a place on the floor. The same bits for any number of threads.
    #[must_use]
    pub fn at(&self, place: [f64; 2]) -> Vec<PlaceFigures> {
        let by = self.floor.point(place, 0.0) - self.floor.point([0.0; 2], 0.0);
        let of_body = |body: &Pose| {
            let pose = Pose { root: body.root + by, ..body.clone() };
            let seen = FrameInformation::of_prediction(&self.model, &self.cameras, self.drawn, &pose);
            self.sets.par_iter().map(|set| self.deviations(&seen, set)).collect::<Vec<_>>()
        };
        let by_body: Vec<Vec<Vec<f64>>> = self.bodies.iter().map(of_body).collect();
        let joints: Vec<Option<usize>> =
            std::iter::once(None).chain(articulated_joints(&self.model).into_iter().map(Some)).collect();
        let of_set = |set: usize| {
            let deviations: Vec<&[f64]> = by_body.iter().map(|sets| sets[set].as_slice()).collect();
            PlaceFigures::of(&joints, &deviations)
        };
        (0..self.sets.len()).map(of_set).collect()
    }

    /// By joint, the root first: metres.
    fn deviations(&self, seen: &FrameInformation, set: &[usize]) -> Vec<f64> {
        let spectrum = seen.spectrum(set);
        let joints = joint_uncertainties(seen, &spectrum, self.noise.deviation());
        joints.iter().map(super::JointUncertainty::worst_deviation_m).collect()
    }
}
