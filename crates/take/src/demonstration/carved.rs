//! A clothed figure before four cameras with its poses known: what a body of spheres is carved from.

use std::sync::Arc;

use backlit_formats::Take;
use backlit_lab::synthetic::silhouettes::silhouette;
use backlit_lab::synthetic::{Build, Figure, motion, squats};
use backlit_tracking::body::{Pose, builtin};
use backlit_tracking::camera::Camera;
use image::GrayImage;

use super::take::{Film, assemble, joints_of, picture_of};

/// Of the movement's frames every so manieth.
const EVERY: usize = 5;
/// Where the cameras stand, degrees to the subject's left of straight ahead.
const PLACES: [f64; 4] = [20.0, 110.0, 200.0, 290.0];
const SIZE_PX: [u64; 2] = [180, 240];

/// The true pose of a frame.
pub(super) fn truth(frame: usize) -> Pose {
    motion::pose(&builtin::full_body(), (frame * EVERY) as f64)
}

/// The take.
///
/// # Errors
/// None that a test does not find.
pub(super) fn take(name: &str) -> anyhow::Result<Take> {
    let model = builtin::full_body();
    let truths: Vec<Pose> = (0..motion::FRAMES.div_ceil(EVERY)).map(truth).collect();
    let figures = truths.iter().filter_map(|truth| Figure::new(&model, truth, Build::default()));
    let figures: Vec<Figure> = figures.collect();
    let film = |camera: Arc<Camera>| {
        let picture = |figure: &Figure| anyhow::Ok(picture_of(&silhouette(figure, &camera)?));
        let pictures = figures.iter().map(picture).collect::<anyhow::Result<Vec<GrayImage>>>()?;
        Ok(Film { camera: (*camera).clone(), pictures, masks: Vec::new(), keypoints: Vec::new() })
    };
    let cameras = squats::cameras_at(&PLACES, SIZE_PX)?;
    let films = cameras.into_iter().map(film).collect::<anyhow::Result<_>>()?;
    let joints = joints_of(&model, &truths);
    assemble(name, motion::FRAME_RATE / EVERY as f64, &model, &truths[0], films, Some(joints))
}
