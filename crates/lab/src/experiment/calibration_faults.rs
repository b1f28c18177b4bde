//! A person before cameras of a right calibration, and calibrations of the same cameras with one known fault.

use std::sync::Arc;

use backlit_tracking::body::builtin::KEYPOINT_LIMBS;
use backlit_tracking::body::{Kinematics, Model};
use backlit_tracking::camera::{Camera, CameraError, CameraFromWorld, Distortion, Intrinsics, up_of};
use backlit_tracking::diagnosis::{FaultKind, turned_for};
use backlit_tracking::geometry::NearestToLines;
use backlit_tracking::silhouette::Mask;
use backlit_tracking::statistics::normal_vector;
use backlit_tracking::synchronise::Recording;
use glam::{DMat3, DQuat, DVec2, DVec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;

use super::ExperimentError;
use crate::synthetic::{capsules, exercise, masks};

/// A fault of one camera, or of all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fault {
    /// What is wrong.
    pub kind: FaultKind,
    /// With which camera; `None`: with all.
    pub camera: Option<usize>,
    /// The camera that it is exchanged with.
    pub with: usize,
    /// How wrong, in the kind's unit: radians, metres, factors, shares of the picture's height, seconds.
    pub size: f64,
    /// Where to, for what has a direction.
    pub seed: u64,
}

/// Silhouettes of a person before cameras that are known.
#[derive(Debug, Clone)]
pub struct FilmedPerson {
    cameras: Vec<Camera>,
    recordings: Vec<Recording>,
    /// Who is filmed, and when; of real footage not known.
    simulated: Option<Simulation>,
}

#[derive(Debug, Clone)]
struct Simulation {
    model: Arc<Model>,
    seconds: Vec<f64>,
    /// Deviation of keypoints, pixels; `None`: there are none.
    keypoint_px: Option<f64>,
}

/// Share of wrong pixels along the edges of silhouettes.
const EDGE_NOISE: f64 = 0.2;
/// The person fills about this share of the pictures' height where a rig's own size does not suit a person.
const FILLS: f64 = 0.55;
/// Distances at which cameras film people, metres.
const PERSON_DISTANCES: std::ops::Range<f64> = 1.8..12.0;
/// The moment from which a moved camera is another, a share of the time.
const BUMPED_AT: f64 = 0.55;
/// About where the person of [`exercise`] is.
const TARGET: DVec3 = DVec3::new(0.0, -0.4, 0.9);

impl FilmedPerson {
    /// A person who walks, squats, signals and boxes, filmed with these cameras, whose pictures are brought to `height` pixels. A rig that is
    /// made for mice or in an unknown unit is scaled so that a person suits it. Keypoints are off by `keypoint_px`, half of it (of the
    /// variance) the same in all frames of a camera, as detectors are.
    ///
    /// # Errors
    /// The cameras look past one another, or cannot have pictures of that size.
    pub fn simulated(
        rig: &[Camera],
        model: &Arc<Model>,
        height: u64,
        frames: usize,
        keypoint_px: Option<f64>,
    ) -> Result<Self, ExperimentError> {
        let cameras = standing_about(rig, height)?;
        let step = exercise::SECONDS / frames.max(1) as f64;
        let seconds: Vec<f64> = (0..frames).map(|frame| frame as f64 * step).collect();
        let simulation = Simulation { model: Arc::clone(model), seconds, keypoint_px };
        let recordings =
            cameras.iter().enumerate().map(|(index, camera)| simulation.filmed(camera, camera, index));
        let recordings = recordings.collect::<Result<_, _>>()?;
        Ok(Self { cameras, recordings, simulated: Some(simulation) })
    }

    /// Real footage: its cameras, and what they recorded.
    #[must_use]
    pub fn real(cameras: Vec<Camera>, recordings: Vec<Recording>) -> Self {
        Self { cameras, recordings, simulated: None }
    }

    /// The cameras as they are.
    #[must_use]
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// What cameras with a fault record, and how they are calibrated.
    ///
    /// # Errors
    /// The fault makes no camera.
    pub fn with_fault(&self, fault: Option<Fault>) -> Result<(Vec<Recording>, Vec<Camera>), ExperimentError> {
        let mut lenses = self.cameras.clone();
        let mut recordings = self.recordings.clone();
        let Some(fault) = fault else { return Ok((recordings, lenses)) };
        let has_it = |index: usize| fault.camera.is_none_or(|camera| camera == index);
        for (index, own) in self.cameras.iter().enumerate() {
            if fault.kind == FaultKind::Bumped && has_it(index) {
                let [first, last] = recordings[index].span();
                let moved = Fault { kind: FaultKind::Moved, ..fault }.applied(own, own)?;
                let after = match &self.simulated {
                    Some(simulation) => simulation.filmed(&moved, own, index + 100)?,
                    None => recordings[index].with_calibration(own, &moved).outlines_only(),
                };
                recordings[index] =
                    recordings[index].continued_by(&after, first + BUMPED_AT * (last - first));
            } else if has_it(index) {
                recordings[index] = recordings[index].with_clock(|seconds| fault.clock(seconds));
                lenses[index] = fault.applied(own, &self.cameras[fault.with])?;
            } else if fault.kind == FaultKind::Swapped && index == fault.with {
                lenses[index] = fault.applied(own, &self.cameras[fault.camera.unwrap_or(0)])?;
            }
            recordings[index] = recordings[index].with_calibration(own, &lenses[index]);
        }
        Ok((recordings, lenses))
    }
}

impl Simulation {
    /// What `camera` films, by one who believes it to be `believed`.
    fn filmed(&self, camera: &Camera, believed: &Camera, seed: usize) -> Result<Recording, ExperimentError> {
        let Self { model, seconds, .. } = self;
        let ideal = camera.without_distortion();
        let mask = |(frame, &seconds): (usize, &f64)| {
            let exact = capsules::hard_mask(model, &exercise::pose(model, seconds), &ideal)?;
            let mut random = Pcg64Mcg::seed_from_u64((1000 * seed + frame) as u64);
            Ok(masks::noisy(&exact, EDGE_NOISE, 0.0, &mut random))
        };
        let masks: Vec<Mask> =
            seconds.par_iter().enumerate().map(mask).collect::<Result<_, ExperimentError>>()?;
        let mut recording = Recording::new(believed.without_distortion());
        for (seconds, mask) in seconds.iter().zip(&masks) {
            recording.push(*seconds, mask);
        }
        if let Some(deviation) = self.keypoint_px {
            self.add_keypoints(&mut recording, &ideal, deviation, seed % 100);
        }
        Ok(recording)
    }

    fn add_keypoints(&self, recording: &mut Recording, camera: &Camera, deviation: f64, seed: usize) {
        let mut random = Pcg64Mcg::seed_from_u64((1_000_000 + seed) as u64);
        let off = deviation / std::f64::consts::SQRT_2;
        let mut noise = || normal_vector(&mut random).truncate() * off;
        let constant = KEYPOINT_LIMBS.map(|_| noise());
        let size = DVec2::new(camera.width() as f64, camera.height() as f64);
        for (frame, &seconds) in self.seconds.iter().enumerate() {
            let joints = Kinematics::new(&self.model, &exercise::pose(&self.model, seconds));
            let mut pixels = Vec::new();
            for (name, constant) in KEYPOINT_LIMBS.iter().zip(constant) {
                let limb = self.model.limb_index(name);
                let place = limb.and_then(|limb| camera.project(joints.ends()[limb]));
                let place = place.map(|place| place + constant + noise());
                pixels.push(place.filter(|at| at.min_element() >= 0.0 && (size - *at).min_element() >= 1.0));
            }
            recording.set_keypoints(frame, &pixels);
        }
    }
}

/// The cameras in a world whose z is up, about a person.
fn standing_about(rig: &[Camera], height: u64) -> Result<Vec<Camera>, ExperimentError> {
    let refused = |value| ExperimentError::Option {
        option: "calibration",
        value,
        expected: "cameras that look at one place",
    };
    let up = up_of(rig).ok_or(refused(rig.len() as f64))?;
    let mut nearest = NearestToLines::default();
    for camera in rig {
        nearest.add(camera.centre(), camera.axis_in_world(), 1.0);
    }
    let middle = nearest.solve().ok_or(refused(rig.len() as f64))?;
    let mut distances: Vec<f64> = rig.iter().map(|camera| camera.centre().distance(middle)).collect();
    distances.sort_by(f64::total_cmp);
    let distance = distances[distances.len() / 2];
    let scale = if PERSON_DISTANCES.contains(&distance) {
        1.0
    } else {
        let suits = |camera: &Camera| {
            let sees = camera.height().min(camera.width()) as f64 / camera.intrinsics().mean_focal_px();
            1.75 / (FILLS * sees) / camera.centre().distance(middle)
        };
        rig.iter().map(suits).fold(0.0, f64::max)
    };
    let level = DMat3::from_quat(DQuat::from_rotation_arc(up, DVec3::Z));
    rig.iter()
        .map(|camera| {
            let rotation = camera.camera_from_world().rotation * level.transpose();
            let centre = TARGET + level * (camera.centre() - middle) * scale;
            let place = CameraFromWorld { rotation, translation: -(rotation * centre) };
            let size = [camera.width() as u64, camera.height() as u64];
            let camera = Camera::new(camera.name(), size, *camera.intrinsics(), *camera.distortion(), place)?;
            let width = (camera.width() as u64 * height).div_ceil(camera.height() as u64);
            camera.resized(width, height)
        })
        .collect::<Result<_, _>>()
        .map_err(ExperimentError::from)
}

impl Fault {
    /// The camera with this fault; `other` is the one that it is exchanged with.
    fn applied(&self, camera: &Camera, other: &Camera) -> Result<Camera, CameraError> {
        let size = [camera.width() as u64, camera.height() as u64];
        let (mut k, mut lens) = (*camera.intrinsics(), *camera.distortion());
        let mut place = *camera.camera_from_world();
        let mut random = Pcg64Mcg::seed_from_u64(self.seed);
        let mut unit = || {
            let mut number = || random.random_range(-1.0..1.0_f64);
            DVec3::new(number(), number(), number()).normalize_or(DVec3::X)
        };
        let mut moved = |turn: f64, shift: f64| {
            let rotation = DMat3::from_quat(DQuat::from_axis_angle(unit(), turn)) * place.rotation;
            place =
                CameraFromWorld { rotation, translation: -(rotation * (place.centre() + shift * unit())) };
        };
        match self.kind {
            FaultKind::PictureTurned => return Ok(turned_for(camera, 2).unwrap_or(camera.clone())),
            FaultKind::PictureScaled => {
                let at = |x: f64| (x + 0.5) * self.size - 0.5;
                k = Intrinsics { fx: k.fx * self.size, fy: k.fy * self.size, cx: at(k.cx), cy: at(k.cy) };
            }
            FaultKind::InvertedExtrinsics => {
                let inverse = place.rotation.transpose();
                place = CameraFromWorld { rotation: inverse, translation: -(inverse * place.translation) };
            }
            FaultKind::Unit => place.translation *= self.size,
            FaultKind::WorldAxes => {
                let turns = [
                    DMat3::from_rotation_x(std::f64::consts::FRAC_PI_2),
                    DMat3::from_rotation_x(std::f64::consts::PI),
                    DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2),
                ];
                place.rotation *= turns[self.seed as usize % 3];
            }
            FaultKind::CameraAxes => {
                let flip = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
                place = CameraFromWorld {
                    rotation: flip * place.rotation,
                    translation: flip * place.translation,
                };
            }
            FaultKind::Swapped => {
                (k, lens, place) = (*other.intrinsics(), *other.distortion(), *other.camera_from_world());
            }
            FaultKind::LensOrder => {
                if let Distortion::OpenCv { k1, k2, p1, p2, k3 } = lens {
                    lens = Distortion::OpenCv { k1, k2, p1: k3, p2: p1, k3: p2 };
                }
            }
            FaultKind::Focal => k = Intrinsics { fx: k.fx * self.size, fy: k.fy * self.size, ..k },
            FaultKind::PrincipalPoint => {
                let offset = unit().truncate().normalize_or_zero() * self.size * camera.height() as f64;
                k = Intrinsics { cx: k.cx + offset.x, cy: k.cy + offset.y, ..k };
            }
            FaultKind::Turned => moved(self.size, 0.0),
            FaultKind::Shifted => moved(0.0, self.size),
            FaultKind::Moved => moved(self.size, 2.0 * self.size),
            _ => {}
        }
        Camera::new(camera.name(), size, k, lens, place)
    }

    /// What the camera's clock says at a time.
    fn clock(&self, seconds: f64) -> f64 {
        match self.kind {
            FaultKind::Offset => seconds + self.size,
            FaultKind::Drift => seconds * (1.0 + self.size),
            FaultKind::FrameRate => seconds * self.size,
            _ => seconds,
        }
    }
}
