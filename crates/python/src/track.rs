//! A track as Python sees it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::motion::{self, Motion, MotionFormat, MotionOptions};
use backlit_tracking::belief::{LimbTrust, Verdict};
use backlit_tracking::body::{Kinematics, Model, Pose, joint_names as anatomical_names};
use backlit_tracking::camera::{Camera, up_of};
use backlit_tracking::metrics::JointAngle;
use backlit_tracking::track::FrameEstimate;
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{numbers_of, owned};
use crate::body::{PyBody, joint_names, joints};
use crate::errors::{raised, wrong};
use crate::pose::{PyPose, quaternions};

/// Half of the points of a normal distribution in space lie within this many deviations of one direction.
const MEDIAN_DEVIATIONS: f64 = 1.538_172;
/// What a frame is called that is not trusted as a whole.
const LOST: &str = "lost";

/// What was found in every frame: T frames, J joints, C cameras. Metres in the take's world; arrays are made when they are asked for.
#[pyclass(frozen, name = "Track", module = "backlit")]
#[derive(Debug)]
pub(crate) struct PyTrack {
    pub(crate) model: Arc<Model>,
    pub(crate) name: String,
    pub(crate) frame_rate: f64,
    pub(crate) cameras: Vec<Camera>,
    /// By frame number.
    pub(crate) frames: BTreeMap<usize, FrameEstimate>,
    /// What was told on the way.
    pub(crate) notes: Vec<String>,
}

impl PyTrack {
    fn each<'a, const N: usize>(&'a self, of: impl Fn(&'a FrameEstimate) -> [f64; N]) -> Vec<f64> {
        self.frames.values().flat_map(of).collect()
    }

    /// What is told of every joint of every frame. The root is judged as the first limb, which begins there.
    fn trusted(&self, of: fn(&LimbTrust) -> f64) -> Vec<f64> {
        let limbs = self.model.limbs().len();
        let told = |estimate: &FrameEstimate, limb: usize| estimate.trust.get(limb).map_or(f64::NAN, of);
        let of_frame = |estimate: &FrameEstimate| {
            std::iter::once(0).chain(0..limbs).map(|limb| told(estimate, limb)).collect::<Vec<f64>>()
        };
        self.frames.values().flat_map(of_frame).collect()
    }

    fn by_joint<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
        owned(py, [self.frames.len(), self.model.limbs().len() + 1], values)
    }

    fn write(&self, path: &Path, format: MotionFormat, up: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let up = match up {
            Some(up) => DVec3::from_slice(&numbers_of("up", up, &[Some(3)], "three numbers")?),
            None => up_of(&self.cameras).unwrap_or(DVec3::Z),
        };
        let poses = self.frames.iter().map(|(&frame, estimate)| (frame, estimate.pose.clone())).collect();
        let trust = self.frames.iter().map(|(&frame, estimate)| (frame, estimate.trust.clone())).collect();
        let motion = Motion::of_poses(self.name.clone(), (*self.model).clone(), self.frame_rate, poses);
        let options = MotionOptions { up, ..MotionOptions::default() };
        motion::write(path, format, &motion.with_trust(trust), &options).map_err(raised)
    }
}

/// In a word how far a frame is believed: as its worst limb, or lost.
fn verdict(model: &Model, estimate: &FrameEstimate) -> &'static str {
    if estimate.is_lost() {
        return LOST;
    }
    let has_one = |verdict: Verdict| estimate.judged(model, verdict).next().is_some();
    let worst = [Verdict::Wrong, Verdict::Doubtful].into_iter().find(|verdict| has_one(*verdict));
    worst.unwrap_or(Verdict::Good).name()
}

#[pymethods]
impl PyTrack {
    /// (T,) of int64: numbers of the frames.
    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let numbers: Vec<i64> = self.frames.keys().map(|frame| *frame as i64).collect();
        owned(py, [numbers.len()], &numbers)
    }

    /// (T,): seconds since frame 0.
    #[getter]
    fn seconds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let seconds: Vec<f64> = self.frames.keys().map(|frame| *frame as f64 / self.frame_rate).collect();
        owned(py, [seconds.len()], &seconds)
    }

    /// (T, J, 3): where the joints are, metres, in the order of ``joint_names``.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let places: Vec<f64> = self.frames.values().flat_map(|one| joints(&self.model, &one.pose)).collect();
        owned(py, [self.frames.len(), self.model.limbs().len() + 1, 3], &places)
    }

    /// Names of the J joints: the root, then each limb's, which is the joint at its end.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        joint_names(&self.model)
    }

    /// Names of the C cameras.
    #[getter]
    fn camera_names(&self) -> Vec<String> {
        self.cameras.iter().map(|camera| camera.name().to_owned()).collect()
    }

    /// (T, J): standard deviation of a joint along any one direction, metres, told from what is seen without knowing the truth: the
    /// error that half of such joints stay below, over 1.538. NaN where a frame was not judged. The root has that of the first limb.
    #[getter]
    fn sigma<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_joint(py, &self.trusted(|limb| limb.error_m / MEDIAN_DEVIATIONS))
    }

    /// (T, J): the error that 95 of 100 such joints stay below, metres.
    #[getter]
    fn error_95<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_joint(py, &self.trusted(|limb| limb.error_95_m))
    }

    /// (T, J): probability that a joint is more than 250 mm off.
    #[getter]
    fn wrong<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_joint(py, &self.trusted(|limb| limb.wrong))
    }

    /// T words: ``good``, ``doubtful`` or ``wrong`` as a frame's worst limb, ``lost`` where the frame is not trusted at all.
    #[getter]
    fn verdict(&self) -> Vec<&'static str> {
        self.frames.values().map(|estimate| verdict(&self.model, estimate)).collect()
    }

    /// (T, C): intersection over union of body and silhouette; NaN where a camera saw nobody.
    #[getter]
    fn iou<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let count = self.cameras.len();
        let of = |estimate: &FrameEstimate, camera: usize| {
            estimate
                .overlap
                .get(camera)
                .copied()
                .flatten()
                .and_then(|overlap| overlap.iou())
                .unwrap_or(f64::NAN)
        };
        let all: Vec<f64> =
            self.frames.values().flat_map(|one| (0..count).map(move |camera| of(one, camera))).collect();
        owned(py, [self.frames.len(), count], &all)
    }

    /// (T,): cost at the end of each fit, squared grey levels; NaN where nobody was seen.
    #[getter]
    fn cost<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        owned(py, [self.frames.len()], &self.each(|one| [one.cost.unwrap_or(f64::NAN)]))
    }

    /// T poses.
    #[getter]
    fn poses(&self) -> Vec<PyPose> {
        self.frames.values().map(|estimate| PyPose::new(estimate.pose.clone())).collect()
    }

    /// (T, R, 4): quaternions w x y z of the limbs that have a rotation of their own, relative to their parents', in the order of
    /// ``rotation_names``.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let poses: Vec<&Pose> = self.frames.values().map(|estimate| &estimate.pose).collect();
        let numbers: Vec<f64> = poses.iter().flat_map(|pose| quaternions(pose)).collect();
        owned(py, [poses.len(), self.model.rotation_count(), 4], &numbers)
    }

    /// Names of the R limbs that have a rotation of their own.
    #[getter]
    fn rotation_names(&self) -> Vec<String> {
        let limbs = self.model.limbs();
        self.model.rotation_owners().iter().map(|&limb| limbs[limb].name.clone()).collect()
    }

    /// The angles that clinicians read, by name as ``left knee flexion``: an array (T,) of degrees each, of the joints that the body
    /// has. Elbow and knee: 0 is straight. Hip and shoulder: flexion in the sagittal plane of the trunk, 0 is a limb that hangs,
    /// positive forwards; NaN where the limb points to the side.
    #[getter]
    fn angles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let names = anatomical_names(&self.model);
        let place = |ends: &[DVec3], name: &str| {
            names.iter().position(|other| other == name).and_then(|limb| ends.get(limb).copied())
        };
        let poses = self.frames.values().map(|one| Kinematics::new(&self.model, &one.pose).ends().to_vec());
        let frames: Vec<Vec<DVec3>> = poses.collect();
        let angles = PyDict::new(py);
        for angle in JointAngle::ALL {
            let degrees = |ends: &Vec<DVec3>| angle.measure(|name| place(ends, name)).map(f64::to_degrees);
            let measured: Vec<Option<f64>> = frames.iter().map(degrees).collect();
            if measured.iter().any(Option::is_some) {
                let degrees: Vec<f64> = measured.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
                angles.set_item(angle.label(), owned(py, [degrees.len()], &degrees)?)?;
            }
        }
        Ok(angles)
    }

    /// The body that was tracked, with its own sizes where they were found.
    #[getter]
    fn body(&self) -> PyBody {
        PyBody::new(Arc::clone(&self.model))
    }

    /// Frames a second.
    #[getter]
    fn fps(&self) -> f64 {
        self.frame_rate
    }

    /// What was told on the way: cameras that cannot be right, how a start was found, sizes.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Writes the joints as markers of ``OpenSim``. ``up`` is the world's direction upwards; default: what the cameras say.
    #[pyo3(signature = (path, *, up = None))]
    fn to_trc(&self, path: PathBuf, up: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        self.write(&path, MotionFormat::Trc, up)
    }

    /// Writes the motion for Blender and other programs of animation. ``up`` as in :meth:`to_trc`.
    #[pyo3(signature = (path, *, up = None))]
    fn to_bvh(&self, path: PathBuf, up: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        self.write(&path, MotionFormat::Bvh, up)
    }

    /// Writes the motion in the format that the path ends in: bvh, trc, mot, c3d, glb, npz or csv. ``up`` as in :meth:`to_trc`.
    #[pyo3(signature = (path, *, up = None))]
    fn save(&self, path: PathBuf, up: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().into_owned()).unwrap_or_default();
        let Some(format) = MotionFormat::of_extension(&ending) else {
            return Err(wrong(
                "path",
                "a name that ends in bvh, trc, mot, c3d, glb, npz or csv",
                &format!("{ending:?}"),
            ));
        };
        self.write(&path, format, up)
    }

    /// The arrays as an ``xarray.Dataset`` with coordinates frame, joint, camera and axis. Needs xarray.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("backlit._xarray")?.call_method1("of_track", (slf,))
    }

    fn __len__(&self) -> usize {
        self.frames.len()
    }

    fn __repr__(&self) -> String {
        format!("Track({:?}, {} frames, {} cameras)", self.name, self.frames.len(), self.cameras.len())
    }
}
