//! Squats before two phones: pictures, masks that are too wide, and keypoints, as the experiment on cues films them.

use backlit_formats::{Take, keypoints};
use backlit_lab::experiment::cues::{DRAWN_RATE, FilmedFrame, Options, film};
use backlit_lab::synthetic::occlusions::Occlusion;
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Mask};
use image::{GrayImage, Luma};

use super::take::{CameraFilm, assemble, joints_of};

/// Of the frames that the experiment draws, one of this many: 15 a second.
const EVERY: usize = 4;
/// Down, and the arms to the front.
const SECONDS: f64 = 1.7;
/// Small, so that it opens at once.
const SIZE_PX: [u64; 2] = [144, 256];
/// How far off it begins, radians and metres.
const START: (f64, f64) = (0.087, 0.03);

const MOVEMENT: Occlusion = Occlusion::Squats;

/// The true pose of a frame.
pub(super) fn truth(frame: usize) -> Pose {
    MOVEMENT.pose(&builtin::full_body(), (frame * EVERY) as f64 / DRAWN_RATE)
}

/// The take.
///
/// # Errors
/// Returns no error for its conditions, which is tested.
pub(super) fn take(name: &str) -> anyhow::Result<Take> {
    let model = builtin::full_body();
    let options = Options { seconds: SECONDS, size_px: SIZE_PX, ..Options::default() };
    let frames = film(&model, MOVEMENT, &options, EVERY, &CancelToken::new())?;
    let truths: Vec<Pose> = frames.iter().map(|frame| frame.truth.clone()).collect();
    let start = perturb(&model, &truths[0], START.0, START.1, options.seed);
    let films = MOVEMENT.cameras(SIZE_PX)?.into_iter().enumerate();
    let films = films.map(|(index, camera)| {
        let people = |frame: &FilmedFrame| {
            keypoints::to_text(&[keypoints::joints::person_of(&model, &frame.cues.cameras[index].keypoints)])
        };
        CameraFilm {
            camera: (*camera).clone(),
            pictures: frames.iter().filter_map(|frame| picture(frame, index)).collect(),
            masks: frames
                .iter()
                .filter_map(|frame| frame.cameras[index].mask.as_deref())
                .map(white)
                .collect(),
            keypoints: frames.iter().map(people).collect(),
        }
    });
    let joints = joints_of(&model, &truths);
    assemble(name, DRAWN_RATE / EVERY as f64, &model, &start, films.collect(), Some(joints))
}

/// What a camera saw in a frame.
fn picture(frame: &FilmedFrame, camera: usize) -> Option<GrayImage> {
    let grey = frame.cues.cameras[camera].picture.as_ref()?;
    let levels = grey.levels().iter().map(|level| level.round() as u8).collect();
    GrayImage::from_vec(grey.width() as u32, grey.height() as u32, levels)
}

/// The subject white, as tools write masks.
fn white(mask: &Mask) -> GrayImage {
    GrayImage::from_fn(mask.width() as u32, mask.height() as u32, |x, y| {
        Luma([if mask.get(x as usize, y as usize) == Some(Label::Subject) { u8::MAX } else { 0 }])
    })
}
