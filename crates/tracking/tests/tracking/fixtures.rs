//! What tests of the core share, within the crate and outside it: cameras, poses, silhouettes, derivatives against differences.

#![allow(dead_code, reason = "the crate's own tests use some, those outside it others")]

use std::fmt::Arguments;
use std::sync::Arc;

use backlit_tracking::body::{Kinematics, LimbSphere, Model, Parameters, Pose};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::cues::GreyPicture;
use backlit_tracking::fit::FitView;
use backlit_tracking::optimize::NormalEquations;
use backlit_tracking::render::{Ramp, RendererKind, View, prediction};
use backlit_tracking::silhouette::{Label, Mask};
use glam::{DQuat, DVec3};
use nalgebra::{DMatrix, DVector};

/// Both parametrisations.
pub(crate) const BOTH: [Parameters; 2] = [Parameters::Raw, Parameters::Tangent];

/// All renderers, and trees of a single sphere.
pub(crate) fn renderers() -> impl Iterator<Item = RendererKind> {
    RendererKind::ALL.into_iter().chain([RendererKind::SphereTree { spheres: Some(1) }])
}

/// A lens that bends nothing, but is one.
pub(crate) const NO_BEND: Distortion = Distortion::OpenCv { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };

/// An ideal camera with these intrinsics, fx, fy, cx and cy, that looks from a place at another.
pub(crate) fn camera(
    size: [u64; 2],
    intrinsics: [f64; 4],
    from: impl Into<DVec3>,
    at: impl Into<DVec3>,
    up: DVec3,
) -> Camera {
    named_camera("camera", Distortion::None, size, intrinsics, from, at, up)
}

/// The same with a lens.
pub(crate) fn lens_camera(
    lens: Distortion,
    size: [u64; 2],
    intrinsics: [f64; 4],
    from: impl Into<DVec3>,
    at: impl Into<DVec3>,
    up: DVec3,
) -> Camera {
    named_camera("camera", lens, size, intrinsics, from, at, up)
}

/// The same with a name.
pub(crate) fn named_camera(
    name: &str,
    lens: Distortion,
    size: [u64; 2],
    [fx, fy, cx, cy]: [f64; 4],
    from: impl Into<DVec3>,
    at: impl Into<DVec3>,
    up: DVec3,
) -> Camera {
    let place = CameraFromWorld::looking_at(from.into(), at.into(), up);
    Camera::new(name, size, Intrinsics { fx, fy, cx, cy }, lens, place).unwrap()
}

/// Two cameras that look at the upper body, the principal point in the middle of the picture.
pub(crate) fn camera_pair(
    places: [(&str, DVec3); 2],
    size: [u64; 2],
    focal_px: f64,
    up: DVec3,
) -> [Arc<Camera>; 2] {
    let [cx, cy] = size.map(|side| 0.5 * (side as f64 - 1.0));
    let (middle, lens) = (DVec3::new(0.0, 0.25, 0.0), Distortion::None);
    let intrinsics = [focal_px, focal_px, cx, cy];
    places.map(|(name, at)| Arc::new(named_camera(name, lens, size, intrinsics, at, middle, up)))
}

/// From the left and from the right, in front of the upper body.
pub(crate) const LEFT_AND_RIGHT: [(&str, DVec3); 2] =
    [("left", DVec3::new(1.6, 0.4, 2.0)), ("right", DVec3::new(-1.9, 0.5, 1.7))];

/// From the front and from the right, at right angles.
pub(crate) const FRONT_AND_RIGHT: [(&str, DVec3); 2] =
    [("front", DVec3::new(0.0, 0.0, 3.2)), ("right", DVec3::new(3.2, 0.0, 0.0))];

/// A pose with every joint turned by up to `amount` radians, and the root moved.
pub(crate) fn bent(model: &Model, amount: f64, phase: f64) -> Pose {
    stepped(model, Parameters::Tangent, |i| amount * (i as f64 * 1.7 + phase).sin())
}

/// A pose with the root there and these limbs' own rotations.
pub(crate) fn posed(model: &Model, root: DVec3, turns: &[(&str, DQuat)]) -> Pose {
    let mut pose = Pose { root, ..Pose::rest(model) };
    for (limb, turn) in turns {
        pose.rotations[model.limbs()[model.limb_index(limb).unwrap()].rotation] = *turn;
    }
    pose
}

/// The pose that a step leads to from rest, given by its columns.
pub(crate) fn stepped(model: &Model, parameters: Parameters, step: impl Fn(usize) -> f64) -> Pose {
    let step: Vec<f64> = (0..parameters.columns(model.rotation_count())).map(step).collect();
    Pose::rest(model).retract(parameters, &step)
}

/// A bent pose, another for every phase, the root moved by up to so many metres; raw quaternions are not of unit length.
pub(crate) fn stretched(model: &Model, parameters: Parameters, [root, turn]: [f64; 2], phase: f64) -> Pose {
    let mut state = Pose::rest(model).to_state();
    for (i, value) in state.iter_mut().enumerate() {
        *value += if i < 3 { root } else { turn } * (i as f64 * 2.3 + phase).sin();
    }
    let pose = Pose::from_state(model, &state).unwrap();
    if parameters == Parameters::Raw { pose } else { pose.normalized() }
}

/// The silhouette of a body of capsules.
pub(crate) fn mask(model: &Model, pose: &Pose, camera: &Camera) -> Mask {
    let kinematics = Kinematics::new(model, pose);
    let view = View::new(model, &kinematics, camera, RendererKind::Capsule, Ramp::Half);
    let label = |is_in: bool| if is_in { Label::Subject } else { Label::Background };
    let labels = prediction::covered(&view).into_iter().map(label).collect();
    Mask::new(camera.width(), camera.height(), labels).unwrap()
}

/// Two spheres a limb, of other radii than the limb's and off its axis.
pub(crate) fn with_own_spheres(model: &Model) -> Model {
    let mut spec = model.to_spec();
    for limb in &mut spec.limbs {
        let sphere = |at, scale, x| LimbSphere {
            at,
            radius: scale * limb.radius,
            offset: DVec3::new(x, 0.02, -0.01) * limb.radius * 5.0,
            parent: None,
        };
        limb.spheres = vec![sphere(0.2, 1.1, 0.05), sphere(0.8, 0.8, -0.04)];
    }
    Model::new(&spec).unwrap()
}

/// A mask of pixels x, y.
pub(crate) fn painted([width, height]: [usize; 2], label: impl Fn(usize, usize) -> Label) -> Mask {
    let labels = (0..width * height).map(|i| label(i % width, i / width)).collect();
    Mask::new(width, height, labels).unwrap()
}

/// The same of subject and background.
pub(crate) fn covered(size: [usize; 2], is_in: impl Fn(usize, usize) -> bool) -> Mask {
    painted(size, |x, y| if is_in(x, y) { Label::Subject } else { Label::Background })
}

/// Grey levels of pixels x, y.
pub(crate) fn grey_picture([width, height]: [usize; 2], level: impl Fn(usize, usize) -> f64) -> GreyPicture {
    let levels = (0..width * height).map(|i| level(i % width, i / width) as f32).collect();
    GreyPicture::new(width, height, levels).unwrap()
}

/// What a camera that sees such a silhouette contributes to a fit.
pub(crate) fn fit_view(model: &Model, pose: &Pose, camera: impl Into<Arc<Camera>>) -> FitView {
    let camera = camera.into();
    let mask = mask(model, pose, &camera);
    FitView::of_mask(camera, mask)
}

/// What went wrong in a test that goes on nevertheless. The test fails where this ends, if there is anything, and tells all of it.
#[derive(Debug, Default)]
pub(crate) struct Failures(Vec<String>);

impl Failures {
    /// Remembers what is said if something is not as it should be.
    pub(crate) fn expect(&mut self, is_right: bool, otherwise: Arguments<'_>) {
        if !is_right {
            self.0.push(otherwise.to_string());
        }
    }

    /// Remembers a number that is farther than this from the one expected.
    pub(crate) fn near(&mut self, what: Arguments<'_>, found: f64, expected: f64, within: f64) {
        let is_near = (found - expected).abs() <= within;
        self.expect(is_near, format_args!("{what} is {found} instead of {expected}"));
    }
}

impl Drop for Failures {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let count = self.0.len();
            self.0.truncate(50);
            assert!(count == 0, "{count} failures:\n{}", self.0.join("\n"));
        }
    }
}

/// Rows of a function of the pose by central differences, a column for each of the state's.
pub(crate) fn differences(
    parameters: Parameters,
    pose: &Pose,
    function: impl Fn(&Pose) -> Vec<f64>,
) -> DMatrix<f64> {
    let (columns, h) = (parameters.columns(pose.rotations.len()), 1e-6);
    let column = |column: usize| {
        let at = |offset: f64| DVector::from_vec(function(&pose.nudged(parameters, column, offset)));
        (at(h) - at(-h)) / (2.0 * h)
    };
    DMatrix::from_columns(&(0..columns).map(column).collect::<Vec<_>>())
}

/// −2 Jᵀρ of what a residual adds against central differences of the cost, all columns reported at once. Returns what it adds.
pub(crate) fn check_gradient(
    name: &str,
    parameters: Parameters,
    pose: &Pose,
    add: impl Fn(&mut NormalEquations, &Pose),
    tolerance: f64,
    failures: &mut Failures,
) -> NormalEquations {
    let columns = parameters.columns(pose.rotations.len());
    let at = |pose: &Pose| {
        let mut equations = NormalEquations::zeros(columns);
        add(&mut equations, pose);
        equations
    };
    let (here, h) = (at(pose), 1e-6);
    for column in 0..columns {
        let cost = |offset: f64| at(&pose.nudged(parameters, column, offset)).cost;
        let numeric = -0.5 * (cost(h) - cost(-h)) / (2.0 * h);
        let what = format_args!("{name}, {parameters:?}, column {column}");
        failures.near(what, here.jtr[column], numeric, tolerance * here.jtr.amax());
    }
    here
}
