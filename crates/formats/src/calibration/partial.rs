//! What a file tells of cameras, which may be only lenses or only places, and how two files make a rig.

use std::path::Path;

use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::{DMat3, DVec3};

use super::{Calibration, CalibrationOptions, MAX_CAMERAS, SkippedCamera, rig};
use crate::{FileProblem, Result};

/// Focal lengths and principal point, as a file has them.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pinhole {
    Pixels(Intrinsics),
    /// Half the picture's width over the focal length, and the same of its height; the axis meets the middle.
    HalfWidths([f64; 2]),
    /// As [`HalfWidths`](Self::HalfWidths) with square pixels: only that of the width is known.
    HalfWidth(f64),
}

impl Pinhole {
    fn intrinsics(self, [width, height]: [u64; 2]) -> Intrinsics {
        let (width, height) = (width as f64, height as f64);
        let middle = |fx, fy| Intrinsics { fx, fy, cx: width / 2.0 - 0.5, cy: height / 2.0 - 0.5 };
        match self {
            Self::Pixels(intrinsics) => intrinsics,
            Self::HalfWidths([x, y]) => middle(width / 2.0 / x, height / 2.0 / y),
            Self::HalfWidth(x) => middle(width / 2.0 / x, width / 2.0 / x),
        }
    }
}

/// What one file says of one camera.
#[derive(Debug, Clone)]
pub(super) struct PartialCamera {
    pub(super) name: String,
    /// What the lens is called in a file that holds lenses apart; the camera's name where it is `None`.
    pub(super) lens_name: Option<String>,
    pub(super) line: usize,
    pub(super) size: Option<[u64; 2]>,
    pub(super) lens: Option<(Pinhole, Distortion)>,
    /// Lengths in the file's own unit.
    pub(super) place: Option<CameraFromWorld>,
}

impl PartialCamera {
    pub(super) fn new(name: &str, line: usize) -> Self {
        Self { name: name.to_owned(), lens_name: None, line, size: None, lens: None, place: None }
    }
}

/// All that one file says of cameras.
#[derive(Debug, Clone)]
pub(super) struct PartialCameras {
    pub(super) cameras: Vec<PartialCamera>,
    pub(super) left_out: Vec<SkippedCamera>,
    /// Metres in the file's unit of length; `None` where the file does not say.
    pub(super) metres_per_unit: Option<f64>,
}

impl PartialCameras {
    pub(super) fn new(metres_per_unit: Option<f64>) -> Self {
        Self { cameras: Vec::new(), left_out: Vec::new(), metres_per_unit }
    }

    pub(super) fn push(&mut self, path: &Path, camera: PartialCamera) -> Result<()> {
        if self.cameras.len() >= MAX_CAMERAS {
            let problem = FileProblem::field("cameras", format!("more than {MAX_CAMERAS}"), "fewer");
            return Err(problem.at(path, camera.line));
        }
        self.cameras.push(camera);
        Ok(())
    }

    /// Whole cameras.
    pub(super) fn of_rig(rig: &Rig) -> Self {
        let of = |camera: &Camera| PartialCamera {
            size: Some([camera.width() as u64, camera.height() as u64]),
            lens: Some((Pinhole::Pixels(*camera.intrinsics()), *camera.distortion())),
            place: Some(*camera.camera_from_world()),
            ..PartialCamera::new(camera.name(), 1)
        };
        Self {
            cameras: rig.cameras().iter().map(of).collect(),
            left_out: Vec::new(),
            metres_per_unit: Some(1.0),
        }
    }

    /// Adds another file's cameras; lengths are metres then.
    pub(super) fn add(&mut self, other: Self, options: CalibrationOptions) {
        let unit = other.metres_per_unit.unwrap_or(options.metres_per_unit);
        self.metres_per_unit = Some(1.0);
        self.cameras.extend(other.cameras.into_iter().map(|camera| {
            let place =
                camera.place.map(|place| CameraFromWorld { translation: place.translation * unit, ..place });
            PartialCamera { place, ..camera }
        }));
        self.left_out.extend(other.left_out);
    }

    pub(super) fn leave_out(&mut self, name: &str, reason: &str) {
        self.left_out.push(SkippedCamera { name: name.to_owned(), reason: reason.to_owned() });
    }

    /// Whether the file says where none of its cameras stands.
    pub(super) fn lacks_places(&self) -> bool {
        self.cameras.iter().all(|camera| camera.place.is_none())
    }

    /// Whether the file tells of none of its cameras' lenses.
    pub(super) fn lacks_lenses(&self) -> bool {
        self.cameras.iter().all(|camera| camera.lens.is_none())
    }

    /// Places, with the lenses and sizes of another file.
    pub(super) fn joined(places: Self, lenses: Self) -> Self {
        let single = places.cameras.len() == 1 && lenses.cameras.len() == 1;
        let mut out = Self {
            cameras: Vec::with_capacity(places.cameras.len()),
            left_out: places.left_out,
            metres_per_unit: places.metres_per_unit,
        };
        out.left_out.extend(lenses.left_out);
        let mut is_used = vec![false; lenses.cameras.len()];
        for mut camera in places.cameras {
            let wanted = camera.lens_name.as_deref().unwrap_or(&camera.name);
            let found = lenses.cameras.iter().position(|lens| lens.name == wanted || single);
            let Some(found) = found else {
                if camera.lens.is_some() {
                    out.cameras.push(camera);
                } else {
                    out.leave_out(&camera.name, "the other file has no lens of that name");
                }
                continue;
            };
            is_used[found] = true;
            let lens = &lenses.cameras[found];
            camera.lens = lens.lens.or(camera.lens);
            camera.size = lens.size.or(camera.size);
            if single && lens.name != camera.name && camera.lens_name.is_none() {
                camera.name.clone_from(&lens.name);
            }
            out.cameras.push(camera);
        }
        for (lens, is_used) in lenses.cameras.iter().zip(is_used) {
            if !is_used {
                out.leave_out(&lens.name, "the other file has no place of that name");
            }
        }
        out
    }

    /// The cameras that have all they need. A single camera without a place stands at the origin.
    pub(super) fn calibration(self, path: &Path, options: CalibrationOptions) -> Result<Calibration> {
        let Self { cameras, mut left_out, metres_per_unit } = self;
        let missing = |line: Option<usize>, camera: &str, key: &str, expected: &str| {
            Err(FileProblem::field(format!("cameras.{camera}{key}"), "missing", expected).at(path, line))
        };
        if let (true, Some(left)) = (cameras.is_empty(), left_out.first()) {
            let expected = format!("a camera that can be used ({})", left.reason);
            return missing(None, &left.name, "", &expected);
        }
        let lacks_places = cameras.iter().all(|camera| camera.place.is_none());
        if lacks_places && cameras.len() > 1 {
            let expected = "the cameras' places: they are in no file beside it; give that file too";
            return missing(Some(cameras[0].line), &cameras[0].name, ".rotation", expected);
        }
        let unit = metres_per_unit.unwrap_or(options.metres_per_unit);
        let mut whole = Vec::with_capacity(cameras.len());
        for camera in cameras {
            let Some((pinhole, distortion)) = camera.lens else {
                let expected = "the cameras' lenses: they are in no file beside it; give that file too";
                return missing(Some(camera.line), &camera.name, ".K", expected);
            };
            let identity = CameraFromWorld { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };
            let Some(place) = camera.place.or(lacks_places.then_some(identity)) else {
                let reason = "the file has no place of it".to_owned();
                left_out.push(SkippedCamera { name: camera.name, reason });
                continue;
            };
            let Some(size) = camera.size.or(options.size) else {
                let expected =
                    "the pictures' width and height, which the file does not say; --size WxH gives them";
                return missing(Some(camera.line), &camera.name, ".size", expected);
            };
            let place = CameraFromWorld { translation: place.translation * unit, ..place };
            let intrinsics = pinhole.intrinsics(size);
            let made = Camera::new(&camera.name, size, intrinsics, distortion, place);
            whole.push(made.map_err(|error| {
                FileProblem::Camera { camera: camera.name.clone(), error }.at(path, camera.line)
            })?);
        }
        Ok(Calibration { rig: rig(path, whole, options.size)?, left_out })
    }
}
