//! The cameras of a recording as Python sees them.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_cli::output::make_folder;
use backlit_formats::atomic;
use backlit_formats::calibration::write::{Format, to_text};
use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use glam::{DMat3, DVec2, DVec3};
use numpy::ndarray::IxDyn;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayDyn};
use pyo3::prelude::*;

use crate::arrays::{numbers, numbers_of, owned, points, rows, shape_text};
use crate::errors::{raised, refused, wrong};

/// How far the proportions of pictures may be from others of the same camera: a pixel or two of rounding.
const PROPORTION_TOLERANCE: f64 = 0.01;

/// Calibrated cameras: sizes of pictures, pinholes, lenses, and where they stand.
///
/// World lengths are metres. Camera axes are OpenCV's (x right, y down, z forward), pixel centres lie at integer coordinates, and
/// ``x_camera = rotation @ x_world + translation``.
#[pyclass(frozen, name = "CameraGroup", module = "backlit", eq)]
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PyCameraGroup {
    pub(crate) rig: Arc<Rig>,
    /// Cameras of the file that cannot be used, and why.
    left_out: Vec<(String, String)>,
}

/// A calibration's file, or several that belong together.
#[derive(Debug, FromPyObject)]
enum Paths {
    One(PathBuf),
    Several(Vec<PathBuf>),
}

impl PyCameraGroup {
    pub(crate) fn new(rig: Rig) -> Self {
        Self { rig: Arc::new(rig), left_out: Vec::new() }
    }

    /// Cameras that may not be a group.
    pub(crate) fn of(cameras: Vec<Camera>) -> PyResult<Self> {
        Rig::new(cameras).map(Self::new).map_err(refused)
    }

    fn each<const N: usize>(&self, of: impl Fn(&Camera) -> [f64; N]) -> Vec<f64> {
        self.rig.cameras().iter().flat_map(of).collect()
    }
}

#[pymethods]
impl PyCameraGroup {
    /// Reads a calibration of any format that ``backlit cameras`` reads: Backlit, OpenCV, Anipose, Qualisys, Vicon, Kalibr,
    /// COLMAP, ``Pose2Sim``, ``EasyMocap``, ``OpenCap`` and others. The format is told by the content.
    ///
    /// ``path`` is a file, a folder with one in it, or a list of files that hold a camera each. ``size`` is (width, height) of the
    /// pictures where the file does not say it; other cameras are scaled to it. ``metres_per_unit`` is for files that do not say
    /// their unit. Raises :class:`FileError`.
    #[staticmethod]
    #[pyo3(signature = (path, *, size = None, metres_per_unit = 1.0))]
    fn load(path: Paths, size: Option<(u64, u64)>, metres_per_unit: f64) -> PyResult<Self> {
        let options =
            CalibrationOptions { size: size.map(|(width, height)| [width, height]), metres_per_unit };
        let paths = match path {
            Paths::One(path) => vec![path],
            Paths::Several(paths) => paths,
        };
        let found = calibration::load_all(&paths, options).map_err(raised)?;
        let left_out = found.left_out.into_iter().map(|left| (left.name, left.reason)).collect();
        Ok(Self { rig: Arc::new(found.rig), left_out })
    }

    /// Cameras from numbers, C of each: ``matrix`` (C, 3, 3) in pixels, ``rotation`` (C, 3, 3) and ``translation`` (C, 3) in metres
    /// from world to camera, ``size`` (C, 2) or (2,) as width and height, ``names`` (default ``cam1``, ``cam2`` …), ``distortion``
    /// (C, 0 to 8) in OpenCV's order: 5 or 8 coefficients, or 4 of a ``fisheye``. Raises :class:`InputError`.
    #[staticmethod]
    #[pyo3(signature = (matrix, rotation, translation, size, *, names = None, distortion = None, fisheye = false))]
    fn from_arrays(
        matrix: &Bound<'_, PyAny>,
        rotation: &Bound<'_, PyAny>,
        translation: &Bound<'_, PyAny>,
        size: &Bound<'_, PyAny>,
        names: Option<Vec<String>>,
        distortion: Option<&Bound<'_, PyAny>>,
        fisheye: bool,
    ) -> PyResult<Self> {
        let matrices = numbers_of("matrix", matrix, &[None, Some(3), Some(3)], "an array (cameras, 3, 3)")?;
        let count = matrices.len() / 9;
        let of = |argument: &str, value: &Bound<'_, PyAny>, sides: &[usize]| {
            let expected: Vec<Option<usize>> =
                std::iter::once(count).chain(sides.iter().copied()).map(Some).collect();
            let words = [&[count][..], sides].concat();
            numbers_of(argument, value, &expected, &format!("an array {}", shape_text(&words)))
        };
        let rotations = of("rotation", rotation, &[3, 3])?;
        let places = points(&of("translation", translation, &[3])?);
        let sizes = sizes(size, count)?;
        let names = names.unwrap_or_else(|| (1..=count).map(|number| format!("cam{number}")).collect());
        if names.len() != count {
            return Err(wrong("names", &format!("{count} names"), &names.len().to_string()));
        }
        let lenses = distortion
            .map_or_else(|| Ok(vec![Distortion::None; count]), |value| lenses(value, count, fisheye))?;
        let mut cameras = Vec::with_capacity(count);
        for (index, name) in names.iter().enumerate() {
            let &[fx, skew, cx, zero, fy, cy, ..] = &matrices[9 * index..9 * index + 9] else { continue };
            if skew != 0.0 || zero != 0.0 {
                return Err(wrong(
                    &format!("matrix[{index}]"),
                    "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]",
                    "a skew",
                ));
            }
            let rotation = DMat3::from_cols_slice(&rotations[9 * index..9 * index + 9]).transpose();
            let place = CameraFromWorld { rotation, translation: places[index] };
            let camera = Camera::new(name, sizes[index], Intrinsics { fx, fy, cx, cy }, lenses[index], place);
            cameras.push(camera.map_err(|error| {
                refused(anyhow::Error::from(error).context(format!("camera \"{name}\"")))
            })?);
        }
        Self::of(cameras)
    }

    /// Writes the cameras: as ``backlit``, ``opencv-yaml``, ``opencv-xml``, ``opencv-json``, ``pose2sim``, ``anipose``, ``kalibr``,
    /// ``easymocap`` (into a folder), ``matrices`` or ``transforms``. What a format cannot hold raises :class:`InputError`.
    #[pyo3(signature = (path, format = "backlit"))]
    fn save(&self, path: PathBuf, format: &str) -> PyResult<()> {
        let Some(format) = Format::from_name(format) else {
            return Err(wrong("format", &Format::ALL.map(Format::name).join(", "), &format!("{format:?}")));
        };
        let texts = to_text(&self.rig, format).map_err(refused)?;
        if let [intri, extri] = &texts[..] {
            make_folder(&path).map_err(raised)?;
            atomic::write(&path.join("intri.yml"), intri.as_bytes()).map_err(raised)?;
            return atomic::write(&path.join("extri.yml"), extri.as_bytes()).map_err(raised);
        }
        texts.iter().try_for_each(|text| atomic::write(&path, text.as_bytes())).map_err(raised)
    }

    /// Names of the cameras, C of them.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.rig.cameras().iter().map(|camera| camera.name().to_owned()).collect()
    }

    /// Name and reason of every camera of the file that cannot be used.
    #[getter]
    fn left_out(&self) -> Vec<(String, String)> {
        self.left_out.clone()
    }

    /// (C, 2) of int64: width and height in pixels.
    #[getter]
    fn size<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let cameras = self.rig.cameras().iter();
        let sizes: Vec<i64> =
            cameras.flat_map(|camera| [camera.width() as i64, camera.height() as i64]).collect();
        owned(py, [self.rig.count(), 2], &sizes)
    }

    /// (C, 3, 3): the pinholes, pixels.
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let numbers = self.each(|camera| {
            let k = camera.intrinsics();
            [k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0]
        });
        owned(py, [self.rig.count(), 3, 3], &numbers)
    }

    /// (C, 3, 3): rotations from world to camera.
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let numbers = self.each(|camera| rows(camera.camera_from_world().rotation));
        owned(py, [self.rig.count(), 3, 3], &numbers)
    }

    /// (C, 3): translations from world to camera, metres.
    #[getter]
    fn translation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        owned(
            py,
            [self.rig.count(), 3],
            &self.each(|camera| camera.camera_from_world().translation.to_array()),
        )
    }

    /// (C, 3): where the cameras stand in the world, metres.
    #[getter]
    fn centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        owned(py, [self.rig.count(), 3], &self.each(|camera| camera.centre().to_array()))
    }

    /// An array each camera: the lens's coefficients in OpenCV's order, 0, 4 (fisheye), 5 or 8 of them.
    #[getter]
    fn distortion<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
        let of = |camera: &Camera| {
            let numbers: Vec<f64> =
                camera.distortion().coefficients().iter().map(|(_, value)| *value).collect();
            owned(py, [numbers.len()], &numbers)
        };
        self.rig.cameras().iter().map(of).collect()
    }

    /// The cameras with these names, in this order. Raises :class:`InputError` for a name that there is not.
    fn select(&self, names: Vec<String>) -> PyResult<Self> {
        let one = |name: &String| self.rig.index(name).map(|index| self.rig.cameras()[index].clone());
        let cameras: Result<Vec<Camera>, _> = names.iter().map(one).collect();
        Self::of(cameras.map_err(refused)?)
    }

    /// The same cameras for pictures of another ``size`` (C, 2) or (2,), width and height: all pixel numbers scaled. Proportions must
    /// agree to 1 %. Raises :class:`InputError`.
    fn resized(&self, size: &Bound<'_, PyAny>) -> PyResult<Self> {
        let sizes = sizes(size, self.rig.count())?;
        let resize = |(camera, &[width, height]): (&Camera, &[u64; 2])| {
            let scales = [width as f64 / camera.width() as f64, height as f64 / camera.height() as f64];
            if (scales[0] / scales[1] - 1.0).abs() > PROPORTION_TOLERANCE {
                let expected = format!("the proportions of {} × {}", camera.width(), camera.height());
                return Err(wrong("size", &expected, &format!("{width} × {height}")));
            }
            camera.resized(width, height).map_err(refused)
        };
        let cameras: PyResult<Vec<Camera>> = self.rig.cameras().iter().zip(&sizes).map(resize).collect();
        Self::of(cameras?)
    }

    /// The pixels of world points: ``points`` (…, 3) in metres gives (C, …, 2), lens included. Points at or behind a camera's
    /// plane are NaN.
    fn project<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (numbers, shape) = numbers("points", points)?;
        let Some((3, sides)) = shape.split_last().map(|(last, sides)| (*last, sides)) else {
            return Err(wrong(
                "points",
                "an array (…, 3), metres",
                &format!("the shape {}", shape_text(&shape)),
            ));
        };
        let world: Vec<DVec3> = crate::arrays::points(&numbers);
        let pixels = py.detach(|| {
            let of = |camera: &Camera| {
                let pixel = |point: &DVec3| camera.project(*point).unwrap_or(DVec2::NAN).to_array();
                world.iter().flat_map(pixel).collect::<Vec<f64>>()
            };
            self.rig.cameras().iter().flat_map(of).collect::<Vec<f64>>()
        });
        let shape: Vec<usize> =
            std::iter::once(self.rig.count()).chain(sides.iter().copied()).chain([2]).collect();
        owned(py, IxDyn(&shape), &pixels)
    }

    fn __len__(&self) -> usize {
        self.rig.count()
    }

    fn __repr__(&self) -> String {
        format!("CameraGroup({})", self.names().join(", "))
    }
}

/// Widths and heights of that many cameras: one for all, or of each.
fn sizes(value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<[u64; 2]>> {
    let (numbers, shape) = numbers("size", value)?;
    // What is no number of pixels is refused where a camera is made of it.
    let sizes = numbers.as_chunks::<2>().0.iter().map(|size| size.map(|side| side.max(0.0) as u64));
    match shape[..] {
        [2] => Ok(sizes.collect::<Vec<_>>().repeat(count)),
        [cameras, 2] if cameras == count => Ok(sizes.collect()),
        _ => Err(wrong(
            "size",
            &format!("an array (2,) or ({count}, 2)"),
            &format!("the shape {}", shape_text(&shape)),
        )),
    }
}

/// The lenses of that many cameras.
fn lenses(value: &Bound<'_, PyAny>, count: usize, fisheye: bool) -> PyResult<Vec<Distortion>> {
    let (numbers, shape) = numbers("distortion", value)?;
    let refuse = || {
        let expected = format!("an array ({count}, n) with n = 0, 5 or 8, or 4 with fisheye = True");
        wrong("distortion", &expected, &format!("the shape {}", shape_text(&shape)))
    };
    let &[cameras, each] = &shape[..] else { return Err(refuse()) };
    if cameras != count {
        return Err(refuse());
    }
    let lens = |index: usize| match (fisheye, &numbers[index * each..(index + 1) * each]) {
        (false, []) => Ok(Distortion::None),
        (false, &[k1, k2, p1, p2, k3]) => Ok(Distortion::OpenCv { k1, k2, p1, p2, k3 }),
        (false, &[k1, k2, p1, p2, k3, k4, k5, k6]) => {
            Ok(Distortion::Rational { k1, k2, p1, p2, k3, k4, k5, k6 })
        }
        (true, &[k1, k2, k3, k4]) => Ok(Distortion::Fisheye { k1, k2, k3, k4 }),
        _ => Err(refuse()),
    };
    (0..count).map(lens).collect()
}
