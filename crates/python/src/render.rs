//! Predictions Λ and Jacobians ∂Λ/∂X of a pose.

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::prediction::levels;
use backlit_tracking::render::{Ramp, RendererKind, View, dense_jacobian};
use numpy::PyArray2;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::owned;
use crate::body::BodyArgument;
use crate::camera_group::PyCameraGroup;
use crate::errors::{BacklitError, refused};
use crate::options::{parameters_of, ramp_of, renderer_of};
use crate::pose::PyPose;
use crate::work::{Job, interruptible};

/// Largest Jacobian of one camera, bytes.
const MAX_JACOBIAN_BYTES: usize = 2 << 30;

/// A posed body, and how it is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DrawnBody<'a> {
    pub(crate) model: &'a Model,
    pub(crate) pose: &'a Pose,
    pub(crate) renderer: RendererKind,
    pub(crate) ramp: Ramp,
}

impl DrawnBody<'_> {
    /// The soft silhouette in each camera.
    pub(crate) fn predictions<'py>(
        &self,
        py: Python<'py>,
        threads: Option<usize>,
        cameras: &[&Camera],
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let kinematics = Kinematics::new(self.model, self.pose);
        let one =
            |camera: &&Camera| levels(&View::new(self.model, &kinematics, camera, self.renderer, self.ramp));
        let work = |_: &Job| cameras.par_iter().map(one).collect::<Vec<Vec<f64>>>();
        let pictures = interruptible(py, threads, None, work)?;
        let picture =
            |(camera, levels): (&&Camera, &Vec<f64>)| owned(py, [camera.height(), camera.width()], levels);
        cameras.iter().zip(&pictures).map(picture).collect()
    }

    /// Its derivative in each camera: pixels × columns.
    pub(crate) fn jacobians<'py>(
        &self,
        py: Python<'py>,
        threads: Option<usize>,
        cameras: &[&Camera],
        parameters: Parameters,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let columns = parameters.columns(self.model.rotation_count());
        for camera in cameras {
            let bytes = camera.width() * camera.height() * columns * size_of::<f64>();
            if bytes > MAX_JACOBIAN_BYTES {
                let message = format!(
                    "camera \"{}\": the Jacobian would be {} MiB; expected at most {} MiB: use smaller pictures",
                    camera.name(),
                    bytes >> 20,
                    MAX_JACOBIAN_BYTES >> 20
                );
                return Err(BacklitError::new_err(message));
            }
        }
        let kinematics = Kinematics::new(self.model, self.pose);
        let one = |camera: &&Camera| {
            let view = View::new(self.model, &kinematics, camera, self.renderer, self.ramp);
            // Column-major of the transpose is row-major.
            dense_jacobian(&view, &kinematics, camera, parameters).transpose()
        };
        let work = |_: &Job| cameras.par_iter().map(one).collect::<Vec<_>>();
        let all = interruptible(py, threads, None, work)?;
        all.iter().map(|jacobian| owned(py, [jacobian.ncols(), columns], jacobian.as_slice())).collect()
    }
}

/// Draws the soft silhouettes of a pose: what ``backlit render --npy`` writes.
///
/// Returns C arrays (H, W) of float64 grey levels, 0 subject to 255 background, in the pictures of ``cams`` with their lenses.
/// ``renderer`` is ``capsule``, ``cylinder`` or ``sphere_tree`` (with ``spheres`` a limb); ``ramp`` is ``half``, ``thesis``,
/// ``width=PX`` or ``distance=INNER,OUTER``. Quaternions are taken as they are. Raises :class:`InputError`.
#[pyfunction]
#[pyo3(signature = (cams, body, pose, *, renderer = "capsule", spheres = None, ramp = "half", n_threads = None))]
#[expect(clippy::too_many_arguments, reason = "each is an argument of Python's, most by name")]
pub(crate) fn render<'py>(
    py: Python<'py>,
    cams: &PyCameraGroup,
    body: BodyArgument<'_>,
    pose: &PyPose,
    renderer: &str,
    spheres: Option<usize>,
    ramp: &str,
    n_threads: Option<usize>,
) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
    let model = body.model()?;
    pose.pose.check(&model).map_err(refused)?;
    let (renderer, ramp) = (renderer_of(renderer, spheres)?, ramp_of(ramp)?);
    let scene = DrawnBody { model: &model, pose: &pose.pose, renderer, ramp };
    scene.predictions(py, n_threads, &cams.rig.cameras().iter().collect::<Vec<_>>())
}

/// The derivatives of the pictures of :func:`render`: C arrays (H · W, n), grey levels per metre or radian.
///
/// Columns are x y z of the root, then of each rotation three radians of a turn in its parent's frame (``parameters`` is
/// ``"tangent"``) or w x y z (``"raw"``). Rows of pixels without gradient are 0. Raises :class:`InputError`, and :class:`Error`
/// above 2 GiB a camera.
#[pyfunction]
#[pyo3(signature = (cams, body, pose, *, renderer = "capsule", spheres = None, ramp = "half", parameters = "tangent",
    n_threads = None))]
#[expect(clippy::too_many_arguments, reason = "each is an argument of Python's, most by name")]
pub(crate) fn jacobian<'py>(
    py: Python<'py>,
    cams: &PyCameraGroup,
    body: BodyArgument<'_>,
    pose: &PyPose,
    renderer: &str,
    spheres: Option<usize>,
    ramp: &str,
    parameters: &str,
    n_threads: Option<usize>,
) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
    let model = body.model()?;
    pose.pose.check(&model).map_err(refused)?;
    let (renderer, ramp) = (renderer_of(renderer, spheres)?, ramp_of(ramp)?);
    let scene = DrawnBody { model: &model, pose: &pose.pose, renderer, ramp };
    let cameras: Vec<&Camera> = cams.rig.cameras().iter().collect();
    scene.jacobians(py, n_threads, &cameras, parameters_of(parameters)?)
}
