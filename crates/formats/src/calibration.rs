//! Calibrations: several formats, one [`Rig`]. The format is told by the content.
//!
//! | file | format |
//! |---|---|
//! | [`backlit`] | `backlit-cameras 1`, our own JSON: read and written |
//! | [`matrices`] | JSON with OpenCV's matrices K, R, t a camera: read |
//! | [`qualisys`] | Qualisys Track Manager's `.qca.txt` XML: read |

use std::path::Path;

use backlit_tracking::camera::{Camera, CameraError, Rig};

use super::{DiskFiles, FileError, FileProblem, TakeFiles, text};

pub mod backlit;
pub mod matrices;
pub mod qualisys;

/// Largest calibration file that is read, bytes.
const MAX_BYTES: u64 = 8 << 20;
/// How far the new picture's proportions may be from the old ones': a pixel or two of rounding.
const PROPORTION_TOLERANCE: f64 = 0.01;

/// How a calibration is to be understood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationOptions {
    /// Width and height in pixels of the pictures that the cameras are for; `None`: as the file has them.
    pub size: Option<[u64; 2]>,
    /// Metres in one unit of a file that does not say its unit.
    pub metres_per_unit: f64,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        Self { size: None, metres_per_unit: 1.0 }
    }
}

/// Parses the content of a calibration of any of the formats; `path` is for the error's message.
///
/// # Errors
/// None of the formats, or not valid. The error names line, camera and field.
pub fn parse(path: &Path, bytes: &[u8], options: CalibrationOptions) -> Result<Rig, FileError> {
    let content = text::decode(path, bytes)?;
    match content.trim_start().chars().next() {
        Some('<') => qualisys::parse(path, content, options),
        Some('{') if says_its_format(content) => backlit::parse(path, content, options),
        Some('{') => matrices::parse(path, content, options),
        _ => Err(FileError::new(path, FileProblem::UnknownCalibration)),
    }
}

/// Reads a calibration of the disk.
///
/// # Errors
/// No such file, or as [`parse`].
pub fn read(path: &Path, options: CalibrationOptions) -> Result<Rig, FileError> {
    read_from(&DiskFiles, path, options)
}

pub(super) fn read_from(
    files: &dyn TakeFiles,
    path: &Path,
    options: CalibrationOptions,
) -> Result<Rig, FileError> {
    parse(path, &files.read(path, MAX_BYTES)?, options)
}

fn says_its_format(text: &str) -> bool {
    #[derive(serde::Deserialize)]
    struct Head {
        format: Option<serde::de::IgnoredAny>,
    }
    match serde_json::from_str::<Head>(text) {
        Ok(head) => head.format.is_some(),
        Err(_) => text.contains("\"backlit-cameras"),
    }
}

/// The camera for pictures of another size of the same proportions.
fn sized(camera: Camera, size: Option<[u64; 2]>) -> Result<Camera, SizeProblem> {
    let Some([width, height]) = size else { return Ok(camera) };
    if [width, height] == [camera.width() as u64, camera.height() as u64] {
        return Ok(camera);
    }
    let stretch = (width as f64 / camera.width() as f64) / (height as f64 / camera.height() as f64);
    if (stretch - 1.0).abs() > PROPORTION_TOLERANCE {
        return Err(SizeProblem::Proportions { found: [camera.width(), camera.height()] });
    }
    camera.resized(width, height).map_err(SizeProblem::Camera)
}

enum SizeProblem {
    Proportions { found: [usize; 2] },
    Camera(CameraError),
}

/// The error for a camera that does not come in the size asked for.
fn size_error(path: &Path, camera: &str, size: [u64; 2], problem: SizeProblem) -> FileError {
    let problem = match problem {
        SizeProblem::Camera(error) => FileProblem::Camera { camera: camera.to_owned(), error },
        SizeProblem::Proportions { found: [width, height] } => FileProblem::Field {
            field: format!("cameras.{camera}"),
            found: format!("for pictures of {width}×{height}"),
            expected: format!("the proportions of {}×{}", size[0], size[1]),
        },
    };
    FileError::new(path, problem)
}

/// The rig of these cameras, each for pictures of the size asked for.
fn rig(path: &Path, cameras: Vec<Camera>, size: Option<[u64; 2]>) -> Result<Rig, FileError> {
    let mut fitted = Vec::with_capacity(cameras.len());
    for camera in cameras {
        let name = camera.name().to_owned();
        let wanted = size.unwrap_or_default();
        fitted.push(sized(camera, size).map_err(|problem| size_error(path, &name, wanted, problem))?);
    }
    Rig::new(fitted).map_err(|error| FileError::new(path, FileProblem::Rig { error }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_calibration_is_said_so() {
        for bytes in [&b""[..], b"camera,1,2", b"[1, 2]"] {
            let message =
                parse(Path::new("c.csv"), bytes, CalibrationOptions::default()).unwrap_err().to_string();
            assert!(message.contains("c.csv: cannot be recognised as a calibration"), "{message}");
        }
    }
}
