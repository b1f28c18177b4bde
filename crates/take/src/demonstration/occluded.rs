//! Squats before two phones: pictures, masks that are too wide, and keypoints.

use backlit_formats::{Take, keypoints};
use backlit_lab::synthetic::filmed::{DRAWN_RATE, FilmedFrame, SEED, film};
use backlit_lab::synthetic::squats;
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::search::start::perturb;
use backlit_tracking::silhouette::{Label, Mask};
use image::{GrayImage, Luma};

use super::take::{CameraFilm, assemble, joints_of};

/// Of the frames that are drawn, one of this many: 15 a second.
const EVERY: usize = 4;
/// Down, and the arms to the front.
const SECONDS: f64 = 1.7;
/// Small, so that it opens at once.
const SIZE_PX: [u64; 2] = [144, 256];
/// How far off it begins, radians and metres.
const START: (f64, f64) = (0.087, 0.03);

pub(super) fn truth(frame: usize) -> Pose {
    squats::pose(&builtin::full_body(), (frame * EVERY) as f64 / DRAWN_RATE)
}

/// The take. Its conditions hold, which is tested.
pub(super) fn take(name: &str, tell: &mut dyn FnMut(usize, usize)) -> anyhow::Result<Take> {
    let model = builtin::full_body();
    let frames = film(&model, SECONDS, SIZE_PX, EVERY, tell)?;
    let truths: Vec<Pose> = frames.iter().map(|frame| frame.truth.clone()).collect();
    let start = perturb(&model, &truths[0], START.0, START.1, SEED);
    let films = squats::cameras(SIZE_PX)?.into_iter().enumerate();
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
    let joints = joints_of(&model, truths.iter().enumerate());
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
