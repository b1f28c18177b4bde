//! The upper body of the report before its cameras: poses, a movement, and cameras around it.

use std::f64::consts::TAU;
use std::sync::Arc;

use backlit_tracking::body::{Model, Parameters, Pose};
use backlit_tracking::camera::{Camera, CameraError};
use backlit_tracking::fit::{DataView, FitOptions, Preset, Stage};
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::optimize::Method;
use backlit_tracking::render::Ramp;
use glam::DVec3;
use thiserror::Error;

use super::studio::pinhole;

/// Most cameras of [`cameras`].
pub const MOST_CAMERAS: usize = 4;
/// Frames a second of [`motion`].
pub const FRAME_RATE: f64 = 25.0;

/// Damping at the start of Levenberg-Marquardt on the report's cost, as the fit's options count it.
pub const LM_DAMPING: f64 = 0.01;

/// Where the cameras stand: degrees to the subject's left of straight ahead, and metres above the waist. The
/// first two are a quarter turn apart; the others look from behind, none straight opposite another.
const PLACES: [(f64, f64); MOST_CAMERAS] = [(38.0, 0.4), (-52.0, 0.5), (160.0, 1.3), (-118.0, 1.1)];
/// Metres from the waist, over the floor.
const DISTANCE: f64 = 2.8;
/// Focal length, in picture widths.
const FOCAL: f64 = 1.25;
/// What the cameras look at, metres above the root.
const TARGET: DVec3 = DVec3::new(0.0, 0.3, 0.0);

/// Why there are no cameras around the body.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum CamerasError {
    #[error("`cameras` is {0}; expected 1 to {MOST_CAMERAS}")]
    Count(usize),
    #[error(transparent)]
    Camera(#[from] CameraError),
}

/// How a joint moves: rotation vector at rest and the vectors that go with the sine and the cosine of the
/// movement's phase, radians; and how many times it swings in two seconds.
struct Swing {
    limb: &'static str,
    middle: DVec3,
    sine: DVec3,
    cosine: DVec3,
    times: f64,
}

const fn swing(limb: &'static str, middle: [f64; 3], sine: [f64; 3], cosine: [f64; 3], times: f64) -> Swing {
    Swing {
        limb,
        middle: DVec3::from_array(middle),
        sine: DVec3::from_array(sine),
        cosine: DVec3::from_array(cosine),
        times,
    }
}

/// Both arms are bent and swing, the torso sways and turns, the head nods.
const SWINGS: [Swing; 6] = [
    swing("torso", [0.05, 0.15, 0.0], [0.05, 0.25, 0.05], [0.05, 0.0, 0.08], 1.0),
    swing("right upper arm", [-0.5, 0.1, -0.7], [-0.4, 0.0, -0.25], [0.1, 0.0, 0.15], 1.0),
    swing("right forearm", [-0.9, 0.2, -0.1], [-0.3, 0.1, 0.0], [0.35, 0.0, 0.1], 1.0),
    swing("left upper arm", [-0.2, 0.0, 0.7], [0.35, 0.0, 0.2], [0.1, 0.0, -0.15], 1.0),
    swing("left forearm", [-0.8, -0.2, 0.1], [0.25, -0.1, 0.1], [0.3, 0.0, 0.0], 2.0),
    swing("head", [0.1, 0.0, 0.0], [0.12, 0.0, 0.0], [0.0, 0.15, 0.05], 1.0),
];

/// The true pose at a frame of a smooth movement of two seconds at [`FRAME_RATE`], which then repeats. Limbs that
/// the model lacks stay out.
#[must_use]
pub fn motion(model: &Model, frame: usize) -> Pose {
    let phase = TAU * frame as f64 / (2.0 * FRAME_RATE);
    let mut pose = Pose::rest(model);
    pose.root = DVec3::new(0.05 * phase.sin(), 0.02 * (2.0 * phase).sin(), 0.04 * phase.cos());
    for Swing { limb, middle, sine, cosine, times } in &SWINGS {
        if let Some(index) = model.limb_index(limb) {
            let (s, c) = (times * phase).sin_cos();
            pose.rotations[model.limbs()[index].rotation] = exp(*middle + *sine * s + *cosine * c);
        }
    }
    pose
}

/// The first `count` cameras around the upper body, none of which cuts a limb of [`motion`] off.
///
/// # Errors
/// A count of none or of more than [`MOST_CAMERAS`], or a size that no camera can have.
pub fn cameras(count: usize, size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, CamerasError> {
    if !(1..=MOST_CAMERAS).contains(&count) {
        return Err(CamerasError::Count(count));
    }
    let focal = FOCAL * size_px[0] as f64;
    let place = |(index, (degrees, height)): (usize, &(f64, f64))| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let centre = DVec3::new(DISTANCE * sine, *height, DISTANCE * cosine);
        Ok(pinhole(&format!("cam{:02}", index + 1), size_px, focal, [centre, TARGET], DVec3::Y)?)
    };
    PLACES[..count].iter().enumerate().map(place).collect()
}

/// The fit that goes down to the least cost of a ramp: tangent Levenberg-Marquardt without priors.
#[must_use]
pub fn least_cost_fit(ramp: Ramp, data: DataView) -> FitOptions {
    let stage = Stage { ramp, data, stride: 1, iterations: 200, tolerance: Some(1e-7), priors: 1.0 };
    FitOptions {
        parameters: Parameters::Tangent,
        method: Method::LevenbergMarquardt,
        damping: 1e-3,
        stages: vec![stage],
        ..FitOptions::preset(Preset::Report)
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Kinematics, builtin};
    use backlit_tracking::silhouette::Label;

    use super::*;
    use crate::synthetic::capsules::hard_mask;

    #[test]
    fn no_camera_cuts_the_body_off_and_the_movement_is_smooth() {
        let model = builtin::upper_body();
        let cameras = cameras(MOST_CAMERAS, [96, 72]).unwrap();
        let mut before: Option<Kinematics> = None;
        for frame in 0..=50 {
            let pose = motion(&model, frame);
            for camera in &cameras {
                let mask = hard_mask(&model, &pose, camera).unwrap();
                assert!(mask.count(Label::Subject) > 250, "{} frame {frame}", camera.name());
                let seen = mask.bounds().unwrap();
                let is_whole = seen.x_min.min(seen.y_min) > 0
                    && seen.x_max + 1 < mask.width()
                    && seen.y_max + 1 < mask.height();
                assert!(is_whole, "{} frame {frame}", camera.name());
            }
            let now = Kinematics::new(&model, &pose);
            if let Some(before) = &before {
                for (limb, (a, b)) in now.ends().iter().zip(before.ends()).enumerate() {
                    let speed = a.distance(*b) * FRAME_RATE;
                    assert!(speed < 3.5, "{} frame {frame}: {speed} m/s", model.limbs()[limb].name);
                }
            }
            before = Some(now);
        }
        assert!(super::cameras(5, [96, 72]).is_err());
    }
}
