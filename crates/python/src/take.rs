//! A take as Python sees it: of files, or of arrays.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::{Footage, Take};
use backlit_take::builtin;
use backlit_tracking::body::Model;
use backlit_tracking::silhouette::{Label, Mask};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::array_files::{ArrayFiles, CameraKeypoints};
use crate::arrays::{MaskShape, masks, numbers, owned, shape_text};
use crate::body::{BodyArgument, PyBody};
use crate::camera_group::PyCameraGroup;
use crate::errors::{raised, refused, wrong, wrong_type};
use crate::pose::PyPose;
use crate::work::{Job, interruptible};

/// Frames a second where nothing else is said.
const USUAL_FRAME_RATE: f64 = 30.0;
/// The name of a take of arrays.
const USUAL_NAME: &str = "arrays";

/// A recording: cameras, what they film, and what belongs to it.
///
/// Made of a folder by :meth:`load`, or of arrays by :meth:`from_arrays`. Pixels of its masks are on the ideal grid, with the lens
/// taken out, as fits use them.
#[pyclass(frozen, name = "Take", module = "backlit")]
#[derive(Debug, Clone)]
pub(crate) struct PyTake {
    pub(crate) footage: Arc<Footage>,
    pub(crate) source: TakeOrigin,
}

/// What a take is opened from, so that it can be opened with another body.
#[derive(Debug, Clone)]
pub(crate) enum TakeOrigin {
    BuiltIn,
    Disk(PathBuf),
    Arrays(Arc<ArrayFiles>),
}

impl TakeOrigin {
    /// Opens the take, with this body in place of its own if there is one.
    pub(crate) fn open(&self, model: Option<Model>) -> anyhow::Result<Take> {
        Ok(match (self, model) {
            (Self::BuiltIn, None) => builtin::open()?,
            (Self::BuiltIn, Some(model)) => builtin::open_with_model(model)?,
            (Self::Disk(path), None) => Take::open(path)?,
            (Self::Disk(path), Some(model)) => Take::open_with_model(path, model)?,
            (Self::Arrays(files), None) => Take::from_files(files.clone(), &ArrayFiles::take_path())?,
            (Self::Arrays(files), Some(model)) => {
                Take::from_files_with_model(files.clone(), &ArrayFiles::take_path(), model)?
            }
        })
    }
}

/// What a take of arrays is told besides cameras and masks.
#[derive(Debug, Default)]
pub(crate) struct ArrayTake<'a, 'py> {
    pub(crate) body: Option<BodyArgument<'py>>,
    pub(crate) fps: Option<f64>,
    pub(crate) keypoints: Option<&'a Bound<'py, PyAny>>,
    pub(crate) start: Option<&'a PyPose>,
    pub(crate) fits_sizes: bool,
    pub(crate) name: Option<String>,
    pub(crate) mask_values: Option<MaskValues>,
}

/// What the numbers of masks mean: a word, or the ids of the subject.
#[derive(Debug, FromPyObject)]
pub(crate) enum MaskValues {
    Word(String),
    Ids(Vec<u16>),
}

impl MaskValues {
    /// As a take file says it.
    fn text(values: Option<Self>) -> PyResult<String> {
        match values.unwrap_or_else(|| Self::Word("auto".to_owned())) {
            Self::Ids(ids) => Ok(format!("{{ ids = {ids:?} }}")),
            Self::Word(word) if ["auto", "grey", "nonzero", "classes"].contains(&word.as_str()) => {
                Ok(format!("{word:?}"))
            }
            Self::Word(word) => {
                let expected = "\"auto\", \"grey\", \"nonzero\", \"classes\" or a list of ids";
                Err(wrong("mask_values", expected, &format!("{word:?}")))
            }
        }
    }
}

impl ArrayTake<'_, '_> {
    pub(crate) fn open(
        self,
        py: Python<'_>,
        cams: &PyCameraGroup,
        arrays: &Bound<'_, PyAny>,
        shape: MaskShape,
    ) -> PyResult<PyTake> {
        if let Some(fps) = self.fps.filter(|fps| !(fps.is_finite() && *fps > 0.0)) {
            return Err(wrong("fps", "frames a second, above 0", &fps.to_string()));
        }
        let masks = masks(&cams.rig, arrays, shape)?;
        let frames = masks.first().map_or(0, |masks| masks.shape[0]);
        let model = match self.body {
            Some(body) => body.model()?,
            None => BodyArgument::Named(PathBuf::from("full_body")).model()?,
        };
        if let Some(start) = self.start {
            start.pose.check(&model).map_err(refused)?;
        }
        let keypoints = self.keypoints.map(|value| keypoints(value, cams.rig.count(), frames)).transpose()?;
        let files = ArrayFiles {
            rig: (*cams.rig).clone(),
            masks,
            mask_values: MaskValues::text(self.mask_values)?,
            keypoints,
            body: model,
            start: self.start.map(|start| start.pose.clone()),
            name: self.name.unwrap_or_else(|| USUAL_NAME.to_owned()),
            frame_rate: self.fps.unwrap_or(USUAL_FRAME_RATE),
            fits_sizes: self.fits_sizes,
        };
        let source = TakeOrigin::Arrays(Arc::new(files));
        let take = interruptible(py, None, None, |_: &Job| source.open(None))?.map_err(refused)?;
        Ok(PyTake { footage: Arc::new(Footage::new(take)), source })
    }
}

/// Keypoints of each of these cameras: of an array (cameras, frames, keypoints, 3), or of a list.
fn keypoints(value: &Bound<'_, PyAny>, cameras: usize, frames: usize) -> PyResult<Vec<CameraKeypoints>> {
    let expected = format!("an array ({cameras}, {frames}, keypoints, 3) of x, y and score");
    let refuse = |found: String| wrong("keypoints", &expected, &found);
    let count = value.len().map_err(|_error| refuse("no array".to_owned()))?;
    if count != cameras {
        return Err(refuse(format!("those of {count} cameras")));
    }
    let of_camera = |index: usize| {
        let (numbers, shape) = numbers("keypoints", &value.get_item(index)?)?;
        match shape[..] {
            [found, count, 3] if found == frames => Ok(CameraKeypoints { count, numbers }),
            _ => Err(refuse(format!("the shape {} of camera {index}", shape_text(&shape)))),
        }
    };
    (0..cameras).map(of_camera).collect()
}

/// Cameras beside masks, or a take.
#[derive(Debug)]
pub(crate) enum CamerasOrTake<'py> {
    Take(Bound<'py, PyTake>),
    Cameras(Bound<'py, PyCameraGroup>),
}

impl<'py> FromPyObject<'_, 'py> for CamerasOrTake<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(take) = value.cast::<PyTake>() {
            return Ok(Self::Take(take.to_owned()));
        }
        match value.cast::<PyCameraGroup>() {
            Ok(cameras) => Ok(Self::Cameras(cameras.to_owned())),
            Err(_) => Err(wrong_type("cams", "a CameraGroup or a Take", &value)),
        }
    }
}

impl CamerasOrTake<'_> {
    /// The take that is named, or the one that the arrays make.
    pub(crate) fn take(
        &self,
        py: Python<'_>,
        arrays: Option<&Bound<'_, PyAny>>,
        shape: MaskShape,
        told: ArrayTake<'_, '_>,
    ) -> PyResult<PyTake> {
        match (self, arrays) {
            (Self::Cameras(cams), Some(arrays)) => told.open(py, cams.get(), arrays, shape),
            (Self::Cameras(_), None) => Err(wrong("masks", "arrays beside a CameraGroup", "None")),
            (Self::Take(_), Some(_)) => {
                Err(wrong("masks", "none beside a Take, which has its own", "arrays"))
            }
            (Self::Take(take), None) => {
                let ArrayTake { body, fps, keypoints, mask_values, .. } = told;
                let given = [
                    ("fps", fps.is_some()),
                    ("keypoints", keypoints.is_some()),
                    ("mask_values", mask_values.is_some()),
                ];
                if let Some((argument, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
                    return Err(wrong(argument, "none beside a Take, which says it itself", "a value"));
                }
                let take = take.get();
                match body {
                    None => Ok(take.clone()),
                    Some(body) => take.with_body(py, (*body.model()?).clone()),
                }
            }
        }
    }
}

impl PyTake {
    fn open(py: Python<'_>, source: TakeOrigin, model: Option<Model>) -> PyResult<Self> {
        let take = interruptible(py, None, None, |_: &Job| source.open(model))?.map_err(raised)?;
        Ok(Self { footage: Arc::new(Footage::new(take)), source })
    }

    /// The same with another body.
    fn with_body(&self, py: Python<'_>, model: Model) -> PyResult<Self> {
        Self::open(py, self.source.clone(), Some(model))
    }

    fn take(&self) -> &Take {
        self.footage.take()
    }
}

#[pymethods]
impl PyTake {
    /// Opens a take's folder or its ``take.toml``; without a path the built-in one: 4 cameras, 60 frames. ``body`` takes the place
    /// of its own. Raises :class:`FileError`.
    #[staticmethod]
    #[pyo3(signature = (path = None, *, body = None))]
    fn load(py: Python<'_>, path: Option<PathBuf>, body: Option<BodyArgument<'_>>) -> PyResult<Self> {
        let model = body.map(BodyArgument::model).transpose()?.map(|model| (*model).clone());
        Self::open(py, path.map_or(TakeOrigin::BuiltIn, TakeOrigin::Disk), model)
    }

    /// A take of arrays, which are borrowed: do not change them while the take is used.
    ///
    /// ``masks`` is bool or uint8 of the shape (C, T, H, W), or a list of C arrays (T, H, W) where sizes differ; height and width
    /// are those of the camera's pictures, lens and all. True is the subject; uint8 means what ``mask_values`` says:
    /// ``"nonzero"``, ``"grey"`` (above half is the subject), ``"classes"`` (0 background, 128 unknown, 255 subject), ids of the
    /// subject, or ``"auto"``, which looks. ``fps`` are frames a second (default 30). ``keypoints`` (C, T, K, 3) are x and y in
    /// pixels and a score from 0 to 1, NaN where there is none, in the order of COCO or of ``OpenPose``'s ``BODY_25``. ``start`` is the
    /// pose to begin with. ``sizes = "fit"`` has the person's own sizes found first. Raises :class:`InputError`.
    #[staticmethod]
    #[pyo3(signature = (cams, masks, *, body = None, fps = None, keypoints = None, start = None, sizes = "known", name = None,
        mask_values = None))]
    #[expect(clippy::too_many_arguments, reason = "each is an argument of Python's, most by name")]
    fn from_arrays(
        py: Python<'_>,
        cams: &PyCameraGroup,
        masks: &Bound<'_, PyAny>,
        body: Option<BodyArgument<'_>>,
        fps: Option<f64>,
        keypoints: Option<&Bound<'_, PyAny>>,
        start: Option<&PyPose>,
        sizes: &str,
        name: Option<String>,
        mask_values: Option<MaskValues>,
    ) -> PyResult<Self> {
        let fits_sizes = fits_sizes(Some(sizes))?.unwrap_or(false);
        let told = ArrayTake { body, fps, keypoints, start, fits_sizes, name, mask_values };
        told.open(py, cams, masks, MaskShape::Recording)
    }

    /// Writes a take of arrays into a folder: ``take.toml``, cameras, masks as PNG, keypoints as JSON. The command line then finds
    /// in it what Python does, to the bit. Raises :class:`InputError` for a take of files.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let TakeOrigin::Arrays(files) = &self.source else {
            return Err(wrong("save", "a take of arrays", "one of files, which are there already"));
        };
        let write = |job: &Job| files.write(&folder, |_| job.cancel.is_cancelled());
        interruptible(py, None, None, write)?.map_err(raised)
    }

    /// What it is called.
    #[getter]
    fn name(&self) -> &str {
        self.take().name()
    }

    /// Frames a second.
    #[getter]
    fn fps(&self) -> f64 {
        self.take().frame_rate()
    }

    /// Number of frames.
    #[getter]
    fn frame_count(&self) -> usize {
        self.take().frame_count()
    }

    /// Its body.
    #[getter]
    fn body(&self) -> PyBody {
        PyBody::new(Arc::clone(self.take().model()))
    }

    /// The pose that it begins with, if it has one.
    #[getter]
    fn start(&self) -> Option<PyPose> {
        self.take().start().cloned().map(PyPose::new)
    }

    /// Its cameras, for pictures as large as on the disk.
    #[getter]
    fn cameras(&self) -> PyCameraGroup {
        PyCameraGroup::new(self.take().full_rig().clone())
    }

    /// The same cameras as fits use them: reduced, and with the lens taken out.
    #[getter]
    fn ideal_cameras(&self) -> PyResult<PyCameraGroup> {
        PyCameraGroup::of(self.footage.cameras.iter().map(|camera| (**camera).clone()).collect())
    }

    /// What is missing or damaged in it, in words.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.take().notes()
    }

    /// The silhouettes of a frame: C arrays (H, W) of uint8, 0 background, 128 unknown, 255 subject. They are segmented where the take has pictures.
    fn masks<'py>(&self, py: Python<'py>, frame: usize) -> PyResult<Vec<Bound<'py, PyArray2<u8>>>> {
        let count = self.frame_count();
        if frame >= count {
            return Err(wrong("frame", &format!("a number below {count}"), &frame.to_string()));
        }
        let cameras: Vec<usize> = (0..self.take().rig().count()).collect();
        let found = interruptible(py, None, None, |_: &Job| self.footage.single_masks(&cameras, frame))?;
        let grey = |mask: &Mask| {
            let levels: Vec<u8> = mask.labels().iter().map(|label| grey_of(*label)).collect();
            owned(py, [mask.height(), mask.width()], &levels)
        };
        found.map_err(raised)?.iter().map(grey).collect()
    }

    fn __repr__(&self) -> String {
        let (cameras, frames) = (self.take().rig().count(), self.take().frame_count());
        format!("Take({:?}, {cameras} cameras, {frames} frames)", self.take().name())
    }
}

const fn grey_of(label: Label) -> u8 {
    match label {
        Label::Background => 0,
        Label::Unknown => 128,
        Label::Subject => 255,
    }
}

/// Whether the person's own sizes are asked for.
pub(crate) fn fits_sizes(sizes: Option<&str>) -> PyResult<Option<bool>> {
    match sizes {
        None => Ok(None),
        Some("known") => Ok(Some(false)),
        Some("fit") => Ok(Some(true)),
        Some(other) => Err(wrong("sizes", "\"known\" or \"fit\"", &format!("{other:?}"))),
    }
}
