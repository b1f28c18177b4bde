//! A pose as Python sees it.

use std::path::PathBuf;

use backlit_formats::pose_file::{self, Quaternions};
use backlit_tracking::body::{Parameters, Pose};
use glam::{DQuat, DVec3};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{numbers_of, owned};
use crate::body::PyBody;
use crate::errors::{raised, wrong};
use crate::options::parameters_of;

/// A pose: ``Pose(root, rotations)``.
///
/// ``root`` (3,) is in metres, ``rotations`` (R, 4) are quaternions w x y z of the limbs that have one, relative to their parents', in
/// the order of :attr:`Body.rotation_names`. Raises :class:`InputError`.
#[pyclass(frozen, name = "Pose", module = "backlit", eq)]
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PyPose {
    pub(crate) pose: Pose,
}

impl PyPose {
    pub(crate) fn new(pose: Pose) -> Self {
        Self { pose }
    }
}

/// w x y z of every quaternion.
pub(crate) fn quaternions(pose: &Pose) -> impl Iterator<Item = f64> {
    pose.rotations.iter().flat_map(|q| [q.w, q.x, q.y, q.z])
}

#[pymethods]
impl PyPose {
    #[new]
    fn python_new(root: &Bound<'_, PyAny>, rotations: &Bound<'_, PyAny>) -> PyResult<Self> {
        let root = numbers_of("root", root, &[Some(3)], "three numbers, metres")?;
        let words = "an array (rotations, 4) of quaternions w x y z";
        let rotations = numbers_of("rotations", rotations, &[None, Some(4)], words)?;
        let quaternions = rotations.as_chunks::<4>().0.iter();
        let rotations = quaternions.map(|&[w, x, y, z]| DQuat::from_xyzw(x, y, z, w)).collect();
        Ok(Self { pose: Pose { root: DVec3::from_slice(&root), rotations } })
    }

    /// Reads a pose of a ``body``, ``backlit-pose 1``. Raises :class:`FileError`.
    #[staticmethod]
    fn load(path: PathBuf, body: &PyBody) -> PyResult<Self> {
        pose_file::read(&path, &body.model, Quaternions::Normalised).map(Self::new).map_err(raised)
    }

    /// Writes such a file. Raises :class:`FileError`.
    fn save(&self, path: PathBuf, body: &PyBody) -> PyResult<()> {
        pose_file::write(&path, &body.model, &self.pose).map_err(raised)
    }

    /// (3,): where the root is, metres.
    #[getter]
    fn root<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        owned(py, [3], &self.pose.root.to_array())
    }

    /// (R, 4): quaternions w x y z.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let numbers: Vec<f64> = quaternions(&self.pose).collect();
        owned(py, [self.pose.rotations.len(), 4], &numbers)
    }

    /// The pose after a step of the state: x y z of the root in metres, then of each rotation three radians of a turn in its parent's
    /// frame (``parameters`` is ``"tangent"``), or four numbers added to w x y z (``"raw"``). Raises :class:`InputError`.
    #[pyo3(signature = (step, parameters = "tangent"))]
    fn moved(&self, step: &Bound<'_, PyAny>, parameters: &str) -> PyResult<Self> {
        let parameters: Parameters = parameters_of(parameters)?;
        let columns = parameters.columns(self.pose.rotations.len());
        let step = numbers_of("step", step, &[Some(columns)], &format!("{columns} numbers"))?;
        if step.iter().all(|number| number.is_finite()) {
            return Ok(Self::new(self.pose.retract(parameters, &step)));
        }
        Err(wrong("step", "finite numbers", "some that are not"))
    }

    fn __repr__(&self) -> String {
        let [x, y, z] = self.pose.root.to_array();
        format!("Pose(root=({x:.3}, {y:.3}, {z:.3}) m, {} rotations)", self.pose.rotations.len())
    }
}
