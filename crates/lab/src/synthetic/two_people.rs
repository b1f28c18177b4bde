//! Two people before four cameras: one walks past another, who signals with the arms. A take of masks, with both true poses.

use std::path::Path;
use std::sync::Arc;

use backlit_formats::{FileError, calibration, images};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::{Camera, CameraError, Rig};
use backlit_tracking::silhouette::{Label, Mask, MaskError};
use glam::DVec3;
use image::DynamicImage;

use super::figure::{Build, Figure};
use super::studio::pinhole;
use super::{exercise, masks, motion};

/// Number of frames.
pub const FRAMES: usize = 40;
/// Frames a second.
pub const FRAME_RATE: f64 = 20.0;

/// Where the cameras stand, degrees about the middle, and how far from it, metres.
const DEGREES: [f64; 4] = [25.0, 115.0, 200.0, 295.0];
const DISTANCE: f64 = 4.6;
const MIDDLE: DVec3 = DVec3::new(0.0, -0.5, 0.9);
/// The way of the walker beside the one of the exercise, and where the other stands.
const ASIDE: DVec3 = DVec3::new(-0.55, 0.0, 0.0);
const STANDS: DVec3 = DVec3::new(0.35, -0.6, 0.0);
/// So late in the exercise the walker is in all pictures, seconds.
const BEGINS: f64 = 1.2;
/// The movement of the other has 30 frames a second.
const OTHER_RATE: f64 = 30.0;

/// Four cameras around both.
///
/// # Errors
/// A size that no camera can have.
pub fn cameras(size_px: [u64; 2]) -> Result<Vec<Arc<Camera>>, CameraError> {
    let camera = |(index, degrees): (usize, &f64)| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let centre = MIDDLE + DVec3::new(DISTANCE * sine, DISTANCE * cosine, 1.0);
        pinhole(&format!("cam{}", index + 1), size_px, 1.05 * size_px[1] as f64, [centre, MIDDLE], DVec3::Z)
    };
    DEGREES.iter().enumerate().map(camera).collect()
}

/// The true poses of the one who walks and of the one who stands. `model` is to be the built-in full body.
#[must_use]
pub fn poses(model: &Model, frame: usize) -> [Pose; 2] {
    let seconds = frame as f64 / FRAME_RATE;
    let mut walks = exercise::pose(model, BEGINS + seconds);
    let mut stands = motion::pose(model, seconds * OTHER_RATE);
    walks.root += ASIDE;
    stands.root += STANDS;
    [walks, stands]
}

/// Why no take was written.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum TwoPeopleError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Rig(#[from] backlit_tracking::camera::RigError),
    #[error(transparent)]
    Mask(#[from] MaskError),
    #[error("{path}: {error}")]
    Folder { path: String, error: std::io::Error },
    #[error("the pose is not of the full body")]
    Figure,
}

/// What a camera sees of some figures.
fn silhouette(figures: &[Figure], camera: &Camera) -> Result<Mask, MaskError> {
    let mut all = Mask::filled(camera.width(), camera.height(), Label::Background)?;
    for figure in figures {
        let own = masks::silhouette(figure, camera)?;
        for (label, own) in all.labels_mut().iter_mut().zip(own.labels()) {
            *label = if *own == Label::Subject { Label::Subject } else { *label };
        }
    }
    Ok(all)
}

/// Writes the take of both, or of those of them, into a folder that is there: cameras, a mask a frame, no start.
///
/// # Errors
/// What cannot be written.
pub fn write(folder: &Path, model: &Model, size_px: [u64; 2], who: &[usize]) -> Result<(), TwoPeopleError> {
    let failed = |path: &Path| {
        let path = path.display().to_string();
        |error| TwoPeopleError::Folder { path, error }
    };
    let cameras = cameras(size_px)?;
    let rig = Rig::new(cameras.iter().map(|camera| (**camera).clone()).collect())?;
    calibration::backlit::write(&folder.join("cameras.json"), &rig)?;
    let mut text = format!(
        "format = \"backlit-take 1\"\nname = \"two people\"\nframe_rate = {FRAME_RATE}\nmodel = \"full_body\"\n\
         [cameras]\ncalibration = \"cameras.json\"\n"
    );
    for camera in rig.cameras() {
        let name = camera.name();
        text += &format!("[[camera]]\nname = \"{name}\"\nmasks = \"{name}/%02d.png\"\n");
        std::fs::create_dir_all(folder.join(name)).map_err(failed(&folder.join(name)))?;
    }
    for frame in 0..FRAMES {
        let poses = poses(model, frame);
        let figures: Option<Vec<Figure>> =
            who.iter().map(|&who| Figure::new(model, poses.get(who)?, Build::default())).collect();
        let figures = figures.ok_or(TwoPeopleError::Figure)?;
        for camera in rig.cameras() {
            let path = folder.join(camera.name()).join(format!("{frame:02}.png"));
            images::write_png(&path, &DynamicImage::ImageLuma8(silhouette(&figures, camera)?.to_gray()))?;
        }
    }
    let path = folder.join("take.toml");
    std::fs::write(&path, text).map_err(failed(&path))
}
