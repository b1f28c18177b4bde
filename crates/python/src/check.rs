//! `bl.check`: which camera is wrong, and how, as `backlit check` tells it.

use backlit_formats::synchronise::USUAL_FRAMES;
use backlit_runs::camera_check::{self, CheckStage, FindingWords, repaired};
use backlit_tracking::diagnosis::Finding;
use pyo3::prelude::*;

use crate::arrays::MaskShape;
use crate::camera_group::PyCameraGroup;
use crate::errors::{raised, wrong};
use crate::take::{ArrayTake, CamerasOrTake, MaskValues, PyTake};
use crate::work::{Job, interruptible};

/// A size of a fault: what, how large, its standard deviation if that is known, its unit.
type SizeTuple = (String, f64, Option<f64>, String);

/// One fault of a calibration or a clock.
#[pyclass(frozen, name = "Finding", module = "backlit", get_all)]
#[derive(Debug)]
pub(crate) struct PyFinding {
    /// Name of the camera; None where it is all of them.
    camera: Option<String>,
    /// Name of the camera that it is confused with, if it is.
    partner: Option<String>,
    /// The kind of fault, in a word: ``focal-length``, ``turned``, ``offset`` …
    kind: String,
    /// All sizes of it: (what, value, standard deviation or None, unit).
    sizes: Vec<SizeTuple>,
    /// The first of these; None where the fault has no size.
    size: Option<f64>,
    /// Its standard deviation.
    deviation: Option<f64>,
    /// How far the camera is from the others before and after the repair, pixels.
    apart_px: Option<(f64, f64)>,
    /// The same by keypoints; None without any.
    keypoints_apart_px: Option<(f64, f64)>,
    /// Share of its silhouette's edges that the hull of the others does not explain, before and after the repair; None with two cameras.
    unexplained_edges: Option<(f64, f64)>,
    /// What the command line says of it.
    text: String,
    /// All cameras with this fault and those before it repaired; None where other cameras repair nothing.
    cameras: Option<Py<PyCameraGroup>>,
}

#[pymethods]
impl PyFinding {
    fn __repr__(&self) -> String {
        format!("Finding({:?})", self.text)
    }
}

/// Checks cameras against one another by the silhouettes of a person who moves: ``backlit check``.
///
/// ``cams`` is a :class:`CameraGroup` beside ``masks`` (C, T, H, W), or a :class:`Take` alone. At most ``frames`` frames are looked
/// at. ``fps``, ``mask_values``, ``n_threads`` and ``progress`` are as of :func:`fit`. Returns a :class:`Finding` each fault, the
/// gravest first; an empty list where nothing is wrong as far as the recording tells. Two cameras show that something is wrong, but
/// not in which. Raises :class:`InputError`, :class:`FileError` or :class:`Error`.
#[pyfunction]
#[pyo3(signature = (cams, masks = None, *, fps = None, frames = USUAL_FRAMES, mask_values = None, n_threads = None,
    progress = None))]
#[expect(clippy::too_many_arguments, reason = "each is an argument of Python's, most by name")]
pub(crate) fn check(
    py: Python<'_>,
    cams: CamerasOrTake<'_>,
    masks: Option<&Bound<'_, PyAny>>,
    fps: Option<f64>,
    frames: usize,
    mask_values: Option<MaskValues>,
    n_threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<PyFinding>> {
    if frames < 2 {
        return Err(wrong("frames", "2 or more", &frames.to_string()));
    }
    let take =
        cams.take(py, masks, MaskShape::Recording, ArrayTake { fps, mask_values, ..ArrayTake::default() })?;
    let work = |job: &Job| {
        camera_check::check(&take.footage, frames, &job.cancel, |stage, [done, all]| {
            let text = match stage {
                CheckStage::Frames => "silhouettes",
                CheckStage::Faults => "faults",
                CheckStage::Backgrounds => "backgrounds",
            };
            job.tell(done, all, text);
        })
    };
    let found = interruptible(py, n_threads, progress, work)?.map_err(raised)?;
    found.diagnosis.findings.iter().map(|finding| PyFinding::new(py, &take, finding)).collect()
}

impl PyFinding {
    fn new(py: Python<'_>, take: &PyTake, finding: &Finding) -> PyResult<Self> {
        let take = take.footage.take();
        let cameras = take.rig().cameras();
        let words = FindingWords::of(finding, cameras);
        let sizes = if words.sizes.is_empty() { String::new() } else { format!(": {}", words.sizes) };
        let below = words.apart.into_iter().chain(words.rivals).chain(words.advice.map(str::to_owned));
        let text = std::iter::once(words.what + &sizes).chain(below).collect::<Vec<_>>().join("; ");
        let name = |camera: Option<usize>| camera.map(|camera| cameras[camera].name().to_owned());
        let size = |size: &backlit_tracking::diagnosis::Size| {
            (size.what.to_string(), size.value, size.deviation, size.unit.to_string())
        };
        let sizes: Vec<SizeTuple> = finding.sizes.iter().map(size).collect();
        let repaired = repaired(take, finding).map(|rig| Py::new(py, PyCameraGroup::new(rig))).transpose()?;
        Ok(Self {
            camera: name(finding.camera),
            partner: name(finding.with),
            kind: finding.kind.name().to_owned(),
            size: sizes.first().map(|size| size.1),
            deviation: sizes.first().and_then(|size| size.2),
            sizes,
            apart_px: finding.apart_px.map(Into::into),
            keypoints_apart_px: finding.keypoints_apart_px.map(Into::into),
            unexplained_edges: finding.unexplained.map(Into::into),
            text,
            cameras: repaired,
        })
    }
}
