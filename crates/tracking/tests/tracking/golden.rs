//! Values of an independent implementation of the 2004 report: Λ, Jacobian, cost and normal equations.
//!
//! `golden/golden.json` has nineteen cases: three renderers, one limb, a two-limb arm, the upper body; ordinary
//! views, end-on, an axis parallel to a ray, a limb behind the camera. Thesis ramp; λ to five decimals.

use backlit_tracking::body::{FORMAT, Kinematics, LimbSpec, Model, ModelSpec, Parameters, Pose};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use backlit_tracking::render::{Ramp, RendererKind, View, dense_jacobian, prediction};
use glam::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

use crate::fixtures::Failures;

/// Largest difference of λ, grey levels: half a unit of the file's last decimal, and a margin.
const LEVEL_TOLERANCE: f64 = 1e-4;
/// Largest difference of a Jacobian entry, relative to the largest entry of its column.
const JACOBIAN_TOLERANCE: f64 = 1e-5;

struct Case {
    name: String,
    model: Model,
    cameras: Vec<Camera>,
    renderer: RendererKind,
    pose: Pose,
    value: Value,
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

fn model(value: &Value) -> Model {
    let limbs = value["limbs"].as_array().unwrap();
    let name = |index: usize| limbs[index]["name"].as_str().unwrap().to_owned();
    let owner = |rotation: &Value| {
        limbs.iter().position(|limb| limb["own"] == Value::Bool(true) && &limb["rot"] == rotation).unwrap()
    };
    let specs = limbs.iter().map(|limb| LimbSpec {
        name: limb["name"].as_str().unwrap().to_owned(),
        parent: usize::try_from(limb["parent"].as_i64().unwrap()).ok().map(name),
        rigid_with: (limb["own"] == Value::Bool(false)).then(|| name(owner(&limb["rot"]))),
        direction: vector(&limb["v"]),
        length: limb["s"].as_f64().unwrap(),
        radius: limb["r"].as_f64().unwrap(),
        limits: None,
        spheres: Vec::new(),
        coarser: Vec::new(),
    });
    Model::new(&ModelSpec { format: FORMAT.into(), name: "golden".into(), limbs: specs.collect() }).unwrap()
}

fn camera(index: usize, value: &Value) -> Camera {
    let rows: Vec<DVec3> = value["R"].as_array().unwrap().iter().map(vector).collect();
    let rotation = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    let number = |key: &str| value[key].as_f64().unwrap();
    // There, the ray of pixel (row i, column j) goes through (j + ½, i + ½).
    let intrinsics =
        Intrinsics { fx: number("f"), fy: number("f"), cx: number("cx") - 0.5, cy: number("cy") - 0.5 };
    let place = CameraFromWorld { rotation, translation: -(rotation * vector(&value["c"])) };
    let size = [value["W"].as_u64().unwrap(), value["H"].as_u64().unwrap()];
    Camera::new(&format!("camera {index}"), size, intrinsics, Distortion::None, place).unwrap()
}

fn cases() -> Vec<Case> {
    let file: Value = serde_json::from_str(include_str!("../golden/golden.json")).unwrap();
    let cases = file["cases"].as_array().unwrap().iter().map(|value| {
        let model = model(&file["models"][value["model"].as_str().unwrap()]);
        let cameras = value["cameras"].as_array().unwrap();
        let renderer = match value["renderer"].as_str().unwrap() {
            "cylinder" => RendererKind::Cylinder,
            "hemi" => RendererKind::Capsule,
            _ => {
                // All limbs alike: the case's own count. Otherwise the natural one of each limb.
                let counts = numbers(&value["Ns"]);
                let alike = counts.iter().all(|&count| count == counts[0]);
                RendererKind::SphereTree { spheres: alike.then_some(counts[0] as usize) }
            }
        };
        Case {
            name: value["name"].as_str().unwrap().to_owned(),
            pose: Pose::from_state(&model, &numbers(&value["state"])).unwrap(),
            cameras: cameras.iter().enumerate().map(|(i, camera_value)| camera(i, camera_value)).collect(),
            model,
            renderer,
            value: value.clone(),
        }
    });
    cases.collect()
}

impl Case {
    fn views(&self, pose: &Pose) -> (Kinematics, Vec<View>) {
        let kinematics = Kinematics::new(&self.model, pose);
        let view = |camera| View::new(&self.model, &kinematics, camera, self.renderer, Ramp::Thesis);
        let views = self.cameras.iter().map(view).collect();
        (kinematics, views)
    }

    fn levels(&self, pose: &Pose) -> Vec<f64> {
        self.views(pose).1.iter().flat_map(prediction::levels).collect()
    }

    /// All cameras' rows, one below the other.
    fn jacobian(&self, pose: &Pose, parameters: Parameters) -> DMatrix<f64> {
        let (kinematics, views) = self.views(pose);
        let blocks: Vec<DMatrix<f64>> = views
            .iter()
            .zip(&self.cameras)
            .map(|(view, camera)| dense_jacobian(view, &kinematics, camera, parameters))
            .collect();
        let rows: Vec<_> = blocks.iter().flat_map(|block| block.row_iter()).collect();
        DMatrix::from_rows(&rows)
    }
}

#[test]
fn joints_are_where_the_reference_has_them() {
    let mut failures = Failures::default();
    for case in cases() {
        let kinematics = Kinematics::new(&case.model, &case.pose);
        for (limb, expected) in numbers(&case.value["leaf_joints"]).chunks(3).enumerate() {
            let error = kinematics.ends()[limb].distance(DVec3::from_slice(expected));
            failures.expect(error <= 1e-10, format_args!("{}: limb {limb} is {error:.1e} m off", case.name));
        }
    }
}

#[test]
fn predictions_match() {
    let mut failures = Failures::default();
    for case in cases() {
        let expected = numbers(&case.value["lam"]);
        let found = case.levels(&case.pose);
        assert_eq!(found.len(), expected.len(), "{}", case.name);
        for (pixel, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let what = format_args!("{}: pixel {pixel}: λ", case.name);
            failures.near(what, *found, *expected, LEVEL_TOLERANCE);
        }
    }
}

#[test]
fn jacobians_match() {
    let mut failures = Failures::default();
    for case in cases() {
        let jacobian = case.jacobian(&case.pose, Parameters::Raw);
        let pixels: Vec<usize> = numbers(&case.value["jac_pixels"]).iter().map(|&x| x as usize).collect();
        for (column, values) in case.value["jac"].as_object().unwrap() {
            let column: usize = column.parse().unwrap();
            let values = numbers(values);
            let scale = values.iter().fold(1.0_f64, |largest, value| largest.max(value.abs()));
            for (&pixel, expected) in pixels.iter().zip(&values) {
                let what = format_args!("{}: pixel {pixel}, column {column}", case.name);
                failures.near(what, jacobian[(pixel, column)], *expected, JACOBIAN_TOLERANCE * scale);
            }
        }
        // No gradient where the reference has none.
        let excluded: Vec<usize> = numbers(&case.value["excluded"]).iter().map(|&x| x as usize).collect();
        for pixel in 0..jacobian.nrows() {
            let active = jacobian.row(pixel).iter().any(|&x| x != 0.0);
            let is_right = !active || pixels.contains(&pixel) || excluded.contains(&pixel);
            failures.expect(is_right, format_args!("{}: pixel {pixel} has a gradient here alone", case.name));
        }
    }
}

#[test]
fn costs_and_normal_equations_match() {
    let mut failures = Failures::default();
    let mut compared = 0;
    for case in cases().into_iter().filter(|case| case.value.get("state2").is_some()) {
        compared += 1;
        let data_pose = Pose::from_state(&case.model, &numbers(&case.value["state2"])).unwrap();
        let (data, prediction) = (case.levels(&data_pose), case.levels(&case.pose));
        let residual = DVector::from_iterator(data.len(), data.iter().zip(&prediction).map(|(d, l)| d - l));
        let cost = case.value["cost"].as_f64().unwrap();
        let what = format_args!("{}: cost", case.name);
        failures.near(what, residual.norm_squared(), cost, 1e-6 * cost);
        for (parameters, key) in [(Parameters::Raw, "g_raw"), (Parameters::Tangent, "g_tangent")] {
            let gradient = case.jacobian(&case.pose, parameters).transpose() * &residual;
            let expected = numbers(&case.value[key]);
            let scale = expected.iter().fold(1.0_f64, |largest, value| largest.max(value.abs()));
            for (column, (found, expected)) in gradient.iter().zip(&expected).enumerate() {
                let what = format_args!("{}: {key}[{column}]", case.name);
                failures.near(what, *found, *expected, 1e-4 * scale);
            }
        }
        let jacobian = case.jacobian(&case.pose, Parameters::Tangent);
        let mut eigenvalues: Vec<f64> =
            (jacobian.transpose() * &jacobian).symmetric_eigen().eigenvalues.iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        let expected = numbers(&case.value["JtJ_eigs_tangent"]);
        let scale = expected.iter().fold(0.0_f64, |largest, value| largest.max(*value));
        for (found, expected) in eigenvalues.iter().zip(&expected) {
            let what = format_args!("{}: eigenvalue", case.name);
            failures.near(what, *found, *expected, 1e-4 * expected.abs() + 1e-9 * scale);
        }
    }
    assert!(compared >= 6);
}
