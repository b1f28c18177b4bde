//! What two telephones see of squats: masks that are too wide, grey pictures, keypoints, and the truth.
//!
//! The figure wears loose, patterned clothes. Keypoints are true joints with an offset each, noise, and some that are nowhere near.

use std::sync::Arc;

use backlit_tracking::body::builtin::KEYPOINT_LIMBS;
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::{CameraCues, FrameCues, GreyPicture, JointKeypoint, WatchedCamera};
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::statistics::normal_vector;
use glam::{DVec2, DVec3};
use image::imageops::grayscale;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;

use super::masks::widened;
use super::{Build, Figure, Plate, Room, Sensor, squats};
use crate::experiment::ExperimentError;

/// Frames a second that are drawn.
pub const DRAWN_RATE: f64 = 60.0;
/// Seed of all noise.
pub const SEED: u64 = 1;
/// How much too wide masks are all round, as a share of the breadth of the shoulders.
const TOO_WIDE: f64 = 0.045;
/// Contrast of the pattern on the clothes.
const PATTERN: f64 = 0.5;

/// How far off keypoints are in each direction, in metres at the person's distance: a deviation from frame to frame, one that
/// a joint keeps, and a joint's from frame to frame that the camera does not see.
const NOISE_M: f64 = 0.012;
const OFFSET_M: f64 = 0.015;
const HIDDEN_NOISE_M: f64 = 0.025;
/// No part of the figure is farther from the capsules of its pose, pixels.
const CLOTH_PX: f64 = 12.0;
/// Share of the keypoints that are anywhere on the person.
const WRONG: f64 = 0.03;

/// One moment.
#[derive(Debug, Clone)]
pub struct FilmedFrame {
    /// The true pose.
    pub truth: Pose,
    /// The cameras with their masks.
    pub cameras: Vec<WatchedCamera>,
    /// Keypoints and pictures, by camera.
    pub cues: FrameCues,
}

/// Films squats for this many seconds at [`DRAWN_RATE`], every so manieth frame. `tell` hears how many pictures are drawn, and of how many.
///
/// # Errors
/// A size that no camera can have, or a body of other limbs.
pub fn film(
    model: &Model,
    seconds: f64,
    size_px: [u64; 2],
    every: usize,
    mut tell: impl FnMut(usize, usize),
) -> Result<Vec<FilmedFrame>, ExperimentError> {
    let build = Build { cloth: 1.12, folds: 0.006, pattern: PATTERN };
    let cameras = squats::cameras(size_px)?;
    let room = Room::default();
    let plates: Vec<Plate> = cameras.iter().map(|camera| Plate::new(&room, camera, 1)).collect();
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let offsets = KEYPOINT_LIMBS.map(|_| normal_vector(&mut random) * OFFSET_M);
    let count = (seconds * DRAWN_RATE).ceil() as usize;
    let total = count.div_ceil(every);
    let mut frames = Vec::with_capacity(total);
    for frame in (0..count).step_by(every) {
        let truth = squats::pose(model, frame as f64 / DRAWN_RATE);
        let Some(figure) = Figure::new(model, &truth, build) else {
            return Err(ExperimentError::Footage("the body has no limbs of that name".to_owned()));
        };
        let joints = Kinematics::new(model, &truth);
        // The same noise whatever frames are left out.
        let mut random = Pcg64Mcg::seed_from_u64(SEED + 1 + frame as u64);
        let mut watched = Vec::new();
        let mut cues = FrameCues::default();
        for (index, (camera, plate)) in cameras.iter().zip(&plates).enumerate() {
            tell(cameras.len() * frames.len() + index, cameras.len() * total);
            // Cloth stands off the body's capsules by less than this.
            let ramp = Ramp::Distance { inner_px: 1.0, outer_px: CLOTH_PX };
            let view = View::new(model, &joints, camera, RendererKind::Capsule, ramp);
            let near: Vec<bool> = prediction::lambda(&view).iter().map(|level| *level < 255.0).collect();
            let by_px = TOO_WIDE * breadth_px(model, &joints, camera);
            let (light, mask) = plate.with_unshaded_figure(&figure, |x, y| near[y * camera.width() + x])?;
            let mask = widened(mask, by_px)?;
            let seed = SEED + (2 * frame + index) as u64;
            let exposed = Sensor::default().expose(&light, 1.0, seed);
            let picture = GreyPicture::of_image(&grayscale(&exposed))
                .map_err(|error| ExperimentError::Footage(error.to_string()))?;
            let keypoints = keypoints(model, &joints, &figure, camera, &offsets, &mut random);
            cues.cameras.push(CameraCues { keypoints, picture: Some(Arc::new(picture)) });
            watched.push(WatchedCamera { camera: Arc::clone(camera), mask: Some(Arc::new(mask)) });
        }
        frames.push(FilmedFrame { truth, cameras: watched, cues });
    }
    Ok(frames)
}

/// The breadth of the shoulders in a picture's pixels, were they seen from the front.
fn breadth_px(model: &Model, joints: &Kinematics, camera: &Camera) -> f64 {
    let end = |name: &str| model.limb_index(name).map_or(DVec3::ZERO, |limb| joints.ends()[limb]);
    let [right, left] = ["right clavicle", "left clavicle"].map(end);
    let depth = camera.depth((right + left) / 2.0);
    right.distance(left) * camera.intrinsics().mean_focal_px() / depth
}

fn keypoints(
    model: &Model,
    joints: &Kinematics,
    figure: &Figure,
    camera: &Camera,
    offsets: &[DVec3; KEYPOINT_LIMBS.len()],
    random: &mut Pcg64Mcg,
) -> Vec<JointKeypoint> {
    let mut found = Vec::new();
    for (name, offset) in KEYPOINT_LIMBS.iter().zip(offsets) {
        let Some(limb) = model.limb_index(name) else { continue };
        let turn = joints.world_rotations()[model.limbs()[limb].rotation];
        let place = joints.ends()[limb] + turn * *offset;
        let (noise, is_wrong, doubt) =
            (normal_vector(random), random.random_bool(WRONG), random.random::<f64>());
        let anywhere = joints.ends()[random.random_range(0..joints.ends().len())];
        let Some(pixel) = camera.project(if is_wrong { anywhere } else { place }) else { continue };
        let is_hidden = hidden(figure, camera, place);
        let deviation = if is_hidden { HIDDEN_NOISE_M } else { NOISE_M };
        let px_per_m = camera.intrinsics().mean_focal_px() / camera.depth(place).max(0.1);
        let score = match (is_wrong, is_hidden) {
            (true, _) => 0.2 + 0.5 * doubt,
            (_, true) => 0.4 + 0.3 * doubt,
            _ => 0.7 + 0.3 * doubt,
        };
        found.push(JointKeypoint {
            limb,
            pixel: pixel + DVec2::new(noise.x, noise.y) * (deviation * px_per_m),
            score,
        });
    }
    found
}

/// Whether more than a limb's thickness of the figure lies before a joint.
fn hidden(figure: &Figure, camera: &Camera, joint: DVec3) -> bool {
    let way = joint - camera.centre();
    let hit = figure.intersect(camera.centre(), way.normalize());
    hit.is_some_and(|hit| hit < way.length() - 0.14)
}
