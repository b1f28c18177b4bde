//! A body as Python sees it.

use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::model_file;
use backlit_tracking::body::{Kinematics, Model, Pose};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{numbers_of, owned};
use crate::errors::{raised, refused, wrong_type};
use crate::pose::PyPose;

/// The joint where the body begins.
const ROOT: &str = "root";

/// An articulated body: limbs with their lengths and radii, and the limits of their joints.
///
/// ``Body("full_body")``, also ``upper_body`` and ``single_limb``, or the path of a file. L limbs, J = L + 1 joints: a joint is named
/// after the limb that ends there, the first is the ``root``. R of the limbs have a rotation of their own.
#[pyclass(frozen, name = "Body", module = "backlit", eq)]
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PyBody {
    pub(crate) model: Arc<Model>,
}

/// A body, or its name or file.
#[derive(Debug)]
pub(crate) enum BodyArgument<'py> {
    Body(Bound<'py, PyBody>),
    Named(PathBuf),
}

impl<'py> FromPyObject<'_, 'py> for BodyArgument<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(body) = value.cast::<PyBody>() {
            return Ok(Self::Body(body.to_owned()));
        }
        let path = value.extract().map(Self::Named);
        path.map_err(|_error: PyErr| wrong_type("body", "a Body, a name or a path", &value))
    }
}

impl BodyArgument<'_> {
    pub(crate) fn model(self) -> PyResult<Arc<Model>> {
        match self {
            Self::Body(body) => Ok(Arc::clone(&body.get().model)),
            Self::Named(path) => named(path),
        }
    }
}

fn named(path: PathBuf) -> PyResult<Arc<Model>> {
    model_file::resolve(&path.to_string_lossy()).map(Arc::new).map_err(raised)
}

/// The names of a body's joints: the root, then the end of every limb.
pub(crate) fn joint_names(model: &Model) -> Vec<String> {
    let limbs = model.limbs().iter().map(|limb| limb.name.clone());
    std::iter::once(ROOT.to_owned()).chain(limbs).collect()
}

/// Where a pose's joints are, in the order of their names: three numbers each, metres.
pub(crate) fn joints(model: &Model, pose: &Pose) -> Vec<f64> {
    let kinematics = Kinematics::new(model, pose);
    std::iter::once(&pose.root).chain(kinematics.ends()).flat_map(|joint| joint.to_array()).collect()
}

impl PyBody {
    pub(crate) fn new(model: Arc<Model>) -> Self {
        Self { model }
    }

    fn sizes(&self, size: fn(&backlit_tracking::body::Limb) -> f64) -> Vec<f64> {
        self.model.limbs().iter().map(size).collect()
    }
}

#[pymethods]
impl PyBody {
    #[new]
    #[pyo3(signature = (name = PathBuf::from("full_body")))]
    fn python_new(name: PathBuf) -> PyResult<Self> {
        named(name).map(Self::new)
    }

    /// Reads a body's file, ``backlit-body 1``. Raises :class:`FileError`.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        model_file::read(&path).map(|model| Self::new(Arc::new(model))).map_err(raised)
    }

    /// Writes such a file. Raises :class:`FileError`.
    fn save(&self, path: PathBuf) -> PyResult<()> {
        model_file::write(&path, &self.model).map_err(raised)
    }

    /// What it is called.
    #[getter]
    fn name(&self) -> &str {
        self.model.name()
    }

    /// Names of the J joints.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        joint_names(&self.model)
    }

    /// Names of the L limbs.
    #[getter]
    fn limb_names(&self) -> Vec<String> {
        self.model.limbs().iter().map(|limb| limb.name.clone()).collect()
    }

    /// Names of the R limbs that have a rotation of their own.
    #[getter]
    fn rotation_names(&self) -> Vec<String> {
        let owners = self.model.rotation_owners().iter();
        owners.map(|&limb| self.model.limbs()[limb].name.clone()).collect()
    }

    /// L names: the limb at whose end each begins; None for the root.
    #[getter]
    fn parents(&self) -> Vec<Option<String>> {
        let limbs = self.model.limbs();
        limbs.iter().map(|limb| limb.parent.map(|parent| limbs[parent].name.clone())).collect()
    }

    /// (L,): lengths, metres.
    #[getter]
    fn lengths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        owned(py, [self.model.limbs().len()], &self.sizes(|limb| limb.length))
    }

    /// (L,): radii, metres.
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        owned(py, [self.model.limbs().len()], &self.sizes(|limb| limb.radius))
    }

    /// The same with these ``lengths`` and ``radii`` (L,), metres. Raises :class:`InputError`.
    fn with_sizes(&self, lengths: &Bound<'_, PyAny>, radii: &Bound<'_, PyAny>) -> PyResult<Self> {
        let count = self.model.limbs().len();
        let words = format!("{count} numbers, metres");
        let lengths = numbers_of("lengths", lengths, &[Some(count)], &words)?;
        let radii = numbers_of("radii", radii, &[Some(count)], &words)?;
        let model = self.model.with_sizes(|limb| [lengths[limb], radii[limb]]).map_err(refused)?;
        Ok(Self::new(Arc::new(model)))
    }

    /// The pose without any turn, the root at the origin.
    fn rest(&self) -> PyPose {
        PyPose::new(Pose::rest(&self.model))
    }

    /// (J, 3): where a pose's joints are, metres. Raises :class:`InputError` for a pose of another body.
    fn joints<'py>(&self, py: Python<'py>, pose: &PyPose) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pose.pose.check(&self.model).map_err(refused)?;
        owned(py, [self.model.limbs().len() + 1, 3], &joints(&self.model, &pose.pose))
    }

    fn __repr__(&self) -> String {
        format!("Body({:?}, {} limbs)", self.model.name(), self.model.limbs().len())
    }
}
