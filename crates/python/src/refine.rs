//! `bl.refine`: cameras refined by the silhouettes of a person, as `backlit refine-cameras` does it.

use std::sync::Arc;

use anyhow::Context;
use backlit_formats::Footage;
use backlit_runs::camera_refinement::{self, to_json};
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::{
    CameraChoice, CameraRefinementOptions, CameraRefinementProgress, CameraRefinementStep, RefinedCameras,
};
use backlit_tracking::camera::Rig;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::search::{WithoutStartOptions, without_start};
use pyo3::prelude::*;

use crate::arrays::MaskShape;
use crate::body::{BodyArgument, PyBody};
use crate::camera_group::PyCameraGroup;
use crate::errors::{raised, refused, wrong};
use crate::fit::{camera_indices, frame_numbers, known_start};
use crate::pose::PyPose;
use crate::take::{ArrayTake, CamerasOrTake, MaskValues};
use crate::work::{Job, interruptible};

/// How many frames may be fitted to.
const FITTED: std::ops::RangeInclusive<usize> = 3..=64;

/// Cameras that were refined, and what was found on the way.
#[pyclass(frozen, name = "Refinement", module = "backlit", get_all)]
#[derive(Debug)]
pub(crate) struct PyRefinement {
    /// All cameras, the refined ones in the place of those given.
    cameras: Py<PyCameraGroup>,
    /// The body that was fitted with them.
    body: Py<PyBody>,
    /// What ``backlit refine-cameras --json`` prints: changes with their standard deviations, IoU before and after.
    report: Py<PyAny>,
}

#[pymethods]
impl PyRefinement {
    fn __repr__(&self) -> String {
        format!("Refinement({})", self.cameras.get().rig.count())
    }
}

/// Refines cameras by the silhouettes of a person: ``backlit refine-cameras``.
///
/// ``cams`` is a :class:`CameraGroup` beside ``masks`` (C, T, H, W), or a :class:`Take` alone. ``free`` lists what is free beside
/// every camera's turn and place: ``focal_length``, ``principal_point``, ``offset``, ``drift``. ``count`` frames, 3 to 64, are
/// fitted to. Where the whole rig stands and how large it is stays as given. ``body``, ``start``, ``fps``, ``frames``,
/// ``cameras``, ``mask_values``, ``n_threads`` and ``progress`` are as of :func:`fit`. Returns a :class:`Refinement`. Raises
/// :class:`InputError`, :class:`FileError` or :class:`Error`.
#[pyfunction]
#[pyo3(signature = (cams, masks = None, *, body = None, start = None, fps = None, free = Vec::new(), count = 16, frames = None,
    cameras = None, mask_values = None, n_threads = None, progress = None))]
#[expect(clippy::too_many_arguments, reason = "each is an argument of Python's, most by name")]
pub(crate) fn refine(
    py: Python<'_>,
    cams: CamerasOrTake<'_>,
    masks: Option<&Bound<'_, PyAny>>,
    body: Option<BodyArgument<'_>>,
    start: Option<&PyPose>,
    fps: Option<f64>,
    free: Vec<String>,
    count: usize,
    frames: Option<Vec<usize>>,
    cameras: Option<Vec<String>>,
    mask_values: Option<MaskValues>,
    n_threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<PyRefinement> {
    if !FITTED.contains(&count) {
        return Err(wrong("count", "3 to 64", &count.to_string()));
    }
    let choice = choice(&free)?;
    let told = ArrayTake { body, fps, mask_values, ..ArrayTake::default() };
    let footage = cams.take(py, masks, MaskShape::Recording, told)?.footage;
    let (frames, cameras) = (frame_numbers(&footage, frames)?, camera_indices(&footage, cameras)?);
    let start = start.map(|start| start.pose.clone());
    if let Some(start) = &start {
        start.check(footage.take().model()).map_err(refused)?;
    }
    let options = CameraRefinementOptions::new(FitOptions::default(), footage.take().frame_rate());
    let options = CameraRefinementOptions { choice, fitted: count, ..options };
    let work = |job: &Job| run(&footage, &cameras, start, &frames, &options, job);
    let (found, rig) = interruptible(py, n_threads, progress, work)?.map_err(raised)?;
    let report = to_json(&found).to_string();
    Ok(PyRefinement {
        cameras: Py::new(py, PyCameraGroup::new(rig))?,
        body: Py::new(py, PyBody::new(Arc::new(found.body.as_seen())))?,
        report: py.import("json")?.call_method1("loads", (report,))?.unbind(),
    })
}

fn choice(free: &[String]) -> PyResult<CameraChoice> {
    let mut choice = CameraChoice::default();
    for word in free {
        match word.as_str() {
            "focal_length" => choice.focal_length = true,
            "principal_point" => choice.principal_point = true,
            "offset" => choice.offset = true,
            "drift" => choice.drift = true,
            _ => {
                let expected = "focal_length, principal_point, offset or drift";
                return Err(wrong("free", expected, &format!("{word:?}")));
            }
        }
    }
    Ok(choice)
}

fn run(
    footage: &Footage,
    cameras: &[usize],
    start: Option<Pose>,
    frames: &[usize],
    options: &CameraRefinementOptions,
    job: &Job,
) -> anyhow::Result<(RefinedCameras, Rig)> {
    let first = frames[0];
    let start = match start.or_else(|| known_start(footage.take(), first)) {
        Some(start) => start,
        None => {
            let views = footage.fit_views(cameras, first)?;
            let choices =
                WithoutStartOptions { fit: options.person.fit.clone(), ..WithoutStartOptions::default() };
            let found = without_start(footage.take().model(), &views, &choices, &job.cancel);
            found.with_context(|| format!("frame {first}: no start can be found"))?.pose().clone()
        }
    };
    let tell = |at: CameraRefinementProgress| match at.step {
        CameraRefinementStep::Following(_) => job.tell(0, 0, "following the person"),
        CameraRefinementStep::Body(at) => job.tell(at.stage, at.stages, "poses and sizes"),
        CameraRefinementStep::Cameras(at) => job.tell(at.stage, at.stages, "cameras"),
        CameraRefinementStep::Judging(done, all) => job.tell(done, all, "frames judged"),
    };
    Ok(camera_refinement::refine(footage, cameras, (start, frames), options, &job.cancel, tell)?)
}
