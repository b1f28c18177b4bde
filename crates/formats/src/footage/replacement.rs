//! What the user gives in place of a take's own: the cameras of another calibration, plates, and silhouettes of single frames.
//! The take's files stay as they are.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use backlit_tracking::camera::{Camera, Rectification, Rig};
use backlit_tracking::silhouette::{Label, Mask, MaskError};
use thiserror::Error;

use crate::calibration::{self, CalibrationOptions};
use crate::{FileError, images};

/// Cameras in the place of the take's.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The file they come from.
    pub path: PathBuf,
    /// As many as the take has, in its order, with its names and picture sizes.
    pub rig: Rig,
}

/// Pictures of silhouettes, white is the subject: by frame, then by camera.
pub type MaskFiles = BTreeMap<usize, BTreeMap<usize, PathBuf>>;

/// Pictures of what cameras see without the subject, by camera.
pub type PlateFiles = BTreeMap<usize, PathBuf>;

/// Why something cannot stand in the place of the take's own.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ReplacementError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: has {found}; the take has {expected}", path.display())]
    Count { path: PathBuf, found: String, expected: String },
    #[error(
        "{}: camera \"{camera}\" is for pictures of {}×{}; the take's are {}×{}",
        path.display(), found[0], found[1], expected[0], expected[1]
    )]
    CameraSize { path: PathBuf, camera: String, found: [usize; 2], expected: [usize; 2] },
    #[error("{}: has {}×{} pixels; the pictures of camera \"{camera}\" have {}×{}", path.display(), found[0], found[1], expected[0], expected[1])]
    MaskSize { path: PathBuf, camera: String, found: [usize; 2], expected: [usize; 2] },
    #[error("{}: {message}", path.display())]
    Content { path: PathBuf, message: String },
    #[error("{}: there is no PNG in it", path.display())]
    NoPictures { path: PathBuf },
    #[error("{}: no camera is called that; expected NAME.png for one of {known}, or one picture for each camera", path.display())]
    NoCamera { path: PathBuf, known: String },
    #[error("{} and {} are for the same camera", first.display(), second.display())]
    Twice { first: PathBuf, second: PathBuf },
}

fn content(path: &Path, error: &dyn std::fmt::Display) -> ReplacementError {
    ReplacementError::Content { path: path.to_owned(), message: error.to_string() }
}

/// Reads a calibration of any of the formats for cameras of a take: by their names if it has them all, else by their
/// order if it has as many.
pub fn read_calibration(path: &Path, cameras: &[Camera]) -> Result<Calibration, ReplacementError> {
    let size_of = |camera: &Camera| [camera.width(), camera.height()];
    let first = cameras.first().map(size_of);
    let same = first.filter(|first| cameras.iter().all(|camera| size_of(camera) == *first));
    let size = same.map(|size| size.map(|side| side as u64));
    let rig = calibration::read(path, CalibrationOptions { size, ..CalibrationOptions::default() })?;
    let by_name: Option<Vec<&Camera>> = cameras
        .iter()
        .map(|camera| rig.index(camera.name()).ok().map(|index| &rig.cameras()[index]))
        .collect();
    let found = match by_name {
        Some(found) => found,
        None if rig.count() == cameras.len() => rig.cameras().iter().collect(),
        None => {
            let named = |cameras: &[Camera]| {
                let names: Vec<&str> = cameras.iter().map(Camera::name).collect();
                let plural = if names.len() == 1 { "" } else { "s" };
                format!("{} camera{plural} ({})", names.len(), names.join(", "))
            };
            let (found, expected) = (named(rig.cameras()), named(cameras));
            return Err(ReplacementError::Count { path: path.to_owned(), found, expected });
        }
    };
    let mut fitted = Vec::with_capacity(cameras.len());
    for (camera, new) in cameras.iter().zip(found) {
        let (found, expected) = (size_of(new), size_of(camera));
        if found != expected {
            let (path, camera) = (path.to_owned(), camera.name().to_owned());
            return Err(ReplacementError::CameraSize { path, camera, found, expected });
        }
        let size = expected.map(|side| side as u64);
        let (lens, place) = (*new.distortion(), *new.camera_from_world());
        let camera = Camera::new(camera.name(), size, *new.intrinsics(), lens, place);
        fitted.push(camera.map_err(|error| content(path, &error))?);
    }
    let rig = Rig::new(fitted).map_err(|error| content(path, &error))?;
    Ok(Calibration { path: path.to_owned(), rig })
}

/// Tells which picture is for which camera: NAME.png by the cameras' names, or one for each in the order of their names.
pub fn masks_of(paths: &[PathBuf], cameras: &[Camera]) -> Result<BTreeMap<usize, PathBuf>, ReplacementError> {
    let mut pictures = Vec::new();
    for path in paths {
        if path.is_dir() {
            pictures.extend(pictures_in(path)?);
        } else {
            pictures.push(path.clone());
        }
    }
    pictures.sort();
    let camera_of = |path: &Path| {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy());
        cameras.iter().position(|camera| stem.as_deref() == Some(camera.name()))
    };
    let unknown = pictures.iter().find(|path| camera_of(path).is_none());
    let mut masks: BTreeMap<usize, PathBuf> = BTreeMap::new();
    match unknown {
        None => {
            for path in &pictures {
                let camera = camera_of(path).unwrap_or_default();
                if let Some(first) = masks.insert(camera, path.clone()) {
                    return Err(ReplacementError::Twice { first, second: path.clone() });
                }
            }
        }
        Some(_) if pictures.len() == cameras.len() => masks.extend(pictures.into_iter().enumerate()),
        Some(path) => {
            let names: Vec<String> = cameras.iter().map(|camera| format!("\"{}\"", camera.name())).collect();
            return Err(ReplacementError::NoCamera { path: path.clone(), known: names.join(", ") });
        }
    }
    for (camera, path) in &masks {
        read_mask(path, &cameras[*camera])?;
    }
    Ok(masks)
}

/// The PNGs of a folder.
fn pictures_in(folder: &Path) -> Result<Vec<PathBuf>, ReplacementError> {
    let entries = std::fs::read_dir(folder).map_err(|error| content(folder, &error))?;
    let is_png = |path: &PathBuf| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    let pictures: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_png(path)).collect();
    if pictures.is_empty() {
        return Err(ReplacementError::NoPictures { path: folder.to_owned() });
    }
    Ok(pictures)
}

/// Reads a silhouette and takes the lens out of it. Where the lens saw nothing it is unknown.
pub fn read_mask(path: &Path, camera: &Camera) -> Result<Mask, ReplacementError> {
    let picture = images::read_grey(path)?;
    let found = [picture.width() as usize, picture.height() as usize];
    let expected = [camera.width(), camera.height()];
    if found != expected {
        let (path, camera) = (path.to_owned(), camera.name().to_owned());
        return Err(ReplacementError::MaskSize { path, camera, found, expected });
    }
    let wrong = |error: MaskError| content(path, &error);
    let mask = Mask::from_gray(&picture).map_err(wrong)?;
    match Rectification::new(camera).nearest(mask.labels(), Label::Unknown) {
        Some(labels) => Mask::new(mask.width(), mask.height(), labels).map_err(wrong),
        None => Ok(mask),
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
    use glam::DVec3;
    use image::{DynamicImage, GrayImage, Luma};

    use super::*;
    use crate::calibration::backlit;

    fn camera(name: &str, side: u64, x: f64) -> Camera {
        let intrinsics = Intrinsics { fx: 50.0, fy: 50.0, cx: 15.5, cy: 11.5 };
        let place = CameraFromWorld::looking_at(DVec3::new(x, -2.0, 0.5), DVec3::ZERO, DVec3::Z);
        Camera::new(name, [side, 24], intrinsics, Distortion::None, place).unwrap()
    }

    fn take() -> Vec<Camera> {
        vec![camera("left", 32, -1.0), camera("right", 32, 1.0)]
    }

    fn write(folder: &Path, name: &str, cameras: Vec<Camera>) -> PathBuf {
        let path = folder.join(name);
        backlit::write(&path, &Rig::new(cameras).unwrap()).unwrap();
        path
    }

    #[test]
    fn cameras_are_told_by_name_or_by_order() {
        let folder = tempfile::tempdir().unwrap();
        let named = vec![camera("other", 32, 9.0), camera("right", 32, 3.0), camera("left", 32, -3.0)];
        let found = read_calibration(&write(folder.path(), "a.json", named), &take()).unwrap();
        assert!(found.rig.cameras()[0].centre().x < 0.0 && found.rig.cameras()[1].centre().x > 0.0);
        let ordered = vec![camera("one", 32, 3.0), camera("two", 32, -3.0)];
        let found = read_calibration(&write(folder.path(), "b.json", ordered), &take()).unwrap();
        assert_eq!(found.rig.cameras()[0].name(), "left");
        assert!(found.rig.cameras()[0].centre().x > 0.0);
    }

    #[test]
    fn another_number_or_size_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let path = write(folder.path(), "three.json", vec![camera("a", 32, 0.0)]);
        let message = read_calibration(&path, &take()).unwrap_err().to_string();
        assert!(
            message.contains("three.json: has 1 camera (a); the take has 2 cameras (left, right)"),
            "{message}"
        );
        let path = write(folder.path(), "wide.json", vec![camera("left", 48, 0.0), camera("right", 48, 1.0)]);
        let message = read_calibration(&path, &take()).unwrap_err().to_string();
        assert!(message.contains("wide.json") && message.contains("32×24"), "{message}");
        let message = read_calibration(&folder.path().join("none.json"), &take()).unwrap_err().to_string();
        assert!(message.contains("none.json"), "{message}");
    }

    fn picture(folder: &Path, name: &str, width: u32) -> PathBuf {
        let path = folder.join(name);
        let white = GrayImage::from_pixel(width, 24, Luma([255]));
        images::write_png(&path, &DynamicImage::ImageLuma8(white)).unwrap();
        path
    }

    #[test]
    fn silhouettes_are_told_by_name_or_one_for_each_camera() {
        let folder = tempfile::tempdir().unwrap();
        let right = picture(folder.path(), "right.png", 32);
        let masks = masks_of(std::slice::from_ref(&right), &take()).unwrap();
        assert_eq!(masks, BTreeMap::from([(1, right.clone())]));
        let other = tempfile::tempdir().unwrap();
        let [b, a] = ["b.png", "a.png"].map(|name| picture(other.path(), name, 32));
        let masks = masks_of(&[other.path().to_owned()], &take()).unwrap();
        assert_eq!(masks, BTreeMap::from([(0, a.clone()), (1, b)]));
        let message = masks_of(&[a], &take()).unwrap_err().to_string();
        assert!(
            message.contains("a.png: no camera is called that") && message.contains("\"left\""),
            "{message}"
        );
        let wide = picture(folder.path(), "left.png", 40);
        let message = masks_of(&[wide, right], &take()).unwrap_err().to_string();
        assert!(message.contains("left.png: has 40×24 pixels") && message.contains("32×24"), "{message}");
    }
}
