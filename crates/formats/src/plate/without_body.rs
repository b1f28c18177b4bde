//! A plate learnt again from a take's footage once its body is tracked: pixels near the body are left out.

use std::collections::BTreeMap;
use std::path::PathBuf;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::body_fit::survey::spread_numbers;
use backlit_tracking::camera::Camera;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::render::prediction::covered;
use backlit_tracking::render::{Ramp, RendererKind, View};
use backlit_tracking::segment::{BackgroundError, LearningFrame, LearningOptions};
use backlit_tracking::silhouette::{Label, Mask, MaskError};
use glam::DVec2;
use image::RgbImage;
use rayon::prelude::*;
use thiserror::Error;

use super::{Covered, MOST_FRAMES, Plate};
use crate::{FileError, Take, TakeError, memory};

/// A body is drawn stouter by so much to leave out clothes, hair and what the track is off by, metres.
const MARGIN_M: f64 = 0.05;
/// Within limbs of this share of their radius the subject is sure to be.
const CORE: f64 = 0.5;
/// A pixel is known if it is free of the body in this share of the frames: a wrong pose now and then teaches nothing.
const FREE_SHARE: f64 = 0.15;

/// Why a plate cannot be learnt, or kept.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum PlateError {
    #[error(transparent)]
    Take(#[from] TakeError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: the folder cannot be made: {error}", path.display())]
    Folder { path: PathBuf, error: std::io::Error },
    #[error("camera \"{camera}\", background: {error}")]
    Learning { camera: String, error: BackgroundError },
    #[error("the plate was not learnt: it was stopped")]
    Cancelled,
}

/// One frame: where the body may be, and where it is for sure.
type BodyMasks = (Mask, Vec<bool>);

/// Learns a camera's plate from the frames of a take in which the body's pose is known, spread over them. It is of the take's
/// reduced size, with the lens's distortion, as a take's plates are.
pub fn plate_without_body(
    take: &Take,
    camera: usize,
    model: &Model,
    poses: &BTreeMap<usize, Pose>,
    cancel: &CancelToken,
) -> Result<Plate, PlateError> {
    let no_camera = || TakeError::NoCamera { camera, count: take.rig().count() };
    let seen_by = take.rig().cameras().get(camera).ok_or_else(no_camera)?;
    let most = memory::held(seen_by.width() * seen_by.height(), MOST_FRAMES);
    let all: Vec<(&usize, &Pose)> = poses.iter().collect();
    let chosen: Vec<(usize, &Pose)> =
        spread_numbers(all.len(), most).map(|index| (*all[index].0, all[index].1)).collect();
    let resized = |radius: &dyn Fn(f64) -> f64| {
        let sizes = |limb: usize| {
            let limb = &model.limbs()[limb];
            [limb.length, radius(limb.radius)]
        };
        model.with_sizes(sizes).unwrap_or_else(|_| model.clone())
    };
    let (stout, core) = (resized(&|radius| radius + MARGIN_M), resized(&|radius| CORE * radius));
    let (ideal, places) = (seen_by.without_distortion(), ideal_places(seen_by));
    let drawn = |body: &Model, pose: &Pose| -> Vec<bool> {
        let kinematics = Kinematics::new(body, pose);
        let view = View::new(body, &kinematics, &ideal, RendererKind::Capsule, Ramp::Half);
        let covered = covered(&view);
        places.iter().map(|place| place.is_some_and(|place| covered[place])).collect()
    };
    let look = |&(_, pose): &(usize, &Pose)| -> Result<BodyMasks, TakeError> {
        let labels = drawn(&stout, pose).into_iter();
        let labels = labels.map(|near| if near { Label::Subject } else { Label::Background }).collect();
        let mask = Mask::new(seen_by.width(), seen_by.height(), labels);
        let mask = mask.map_err(|_error: MaskError| no_camera())?;
        Ok((mask, drawn(&core, pose)))
    };
    let pictures = pictures(take, camera, &chosen, cancel)?;
    let seen: Vec<Result<BodyMasks, TakeError>> = chosen.par_iter().map(look).collect();
    let seen = seen.into_iter().collect::<Result<Vec<BodyMasks>, TakeError>>()?;
    let mut always = Covered::default();
    seen.iter().for_each(|(_, sure)| always.add(sure.iter().copied()));
    let frames: Vec<LearningFrame<'_>> = pictures
        .iter()
        .zip(&seen)
        .map(|(picture, (mask, _))| LearningFrame { picture, subject: Some(mask) })
        .collect();
    let usual = LearningOptions::default();
    let free = (FREE_SHARE * frames.len() as f64).ceil() as usize;
    let options = LearningOptions { min_free_frames: usual.min_free_frames.max(free), ..usual };
    Plate::learn(&frames, &options, &always)
        .map_err(|error| PlateError::Learning { camera: take.footage()[camera].camera().to_owned(), error })
}

/// The pictures of these frames. Those of a video one after the other: to go back in it costs all frames from the key on.
fn pictures(
    take: &Take,
    camera: usize,
    frames: &[(usize, &Pose)],
    cancel: &CancelToken,
) -> Result<Vec<RgbImage>, PlateError> {
    let read = |&(frame, _): &(usize, &Pose)| match cancel.is_cancelled() {
        true => Err(PlateError::Cancelled),
        false => Ok(take.frame(camera, frame)?),
    };
    if take.footage()[camera].video().is_some() {
        return frames.iter().map(read).collect();
    }
    let pictures: Vec<Result<RgbImage, PlateError>> = frames.par_iter().map(read).collect();
    pictures.into_iter().collect()
}

/// For each pixel of a camera the index of the one at its place in a picture without distortion; `None` where that is outside.
fn ideal_places(camera: &Camera) -> Vec<Option<usize>> {
    let (width, height, pinhole) = (camera.width(), camera.height(), camera.intrinsics());
    let place = |index: usize| {
        let bent = pinhole.plane_from_pixel(DVec2::new((index % width) as f64, (index / width) as f64));
        let at = pinhole.pixel_from_plane(camera.distortion().undistort(bent)?).round();
        let is_inside = at.x >= 0.0 && at.y >= 0.0 && at.x < width as f64 && at.y < height as f64;
        is_inside.then(|| at.y as usize * width + at.x as usize)
    };
    (0..width * height).map(place).collect()
}
