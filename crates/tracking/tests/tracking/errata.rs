//! What the report has otherwise, or leaves unsaid, and what holds instead. `docs/report.md` lists all of it.

use std::sync::Arc;

use backlit_lab::synthetic::{single_limb, upper_body};
use backlit_tracking::body::{Kinematics, Model, ModelSpec, Parameters, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::optimize::NormalEquations;
use backlit_tracking::render::{Prediction, Ramp, RendererKind, View, dense_jacobian, predict};
use backlit_tracking::search::start::perturb;
use nalgebra::{DMatrix, DVector};

const SIZE: [u64; 2] = [96, 72];

/// The Jacobians of all cameras, one above the other, and D − Λ of the truth against a pose.
fn stacked(pose: &Pose, parameters: Parameters) -> (DMatrix<f64>, DVector<f64>) {
    let model = builtin::upper_body();
    let truth = upper_body::motion(&model, 0);
    let levels = |pose: &Pose, camera: &Camera| {
        let kinematics = Kinematics::new(&model, pose);
        predict(&model, &kinematics, camera, RendererKind::Capsule, Ramp::Thesis).lambda
    };
    let cameras = upper_body::cameras(4, SIZE).unwrap();
    let kinematics = Kinematics::new(&model, pose);
    let (mut rows, mut residuals) = (Vec::new(), Vec::new());
    for camera in &cameras {
        let view = View::new(&model, &kinematics, camera, RendererKind::Capsule, Ramp::Thesis);
        let jacobian = dense_jacobian(&view, &kinematics, camera, parameters);
        rows.extend(jacobian.row_iter().map(|row| row.into_owned()));
        let (data, here) = (levels(&truth, camera), levels(pose, camera));
        residuals.extend(data.iter().zip(&here).map(|(d, l)| f64::from(d - l)));
    }
    (DMatrix::from_rows(&rows), DVector::from_vec(residuals))
}

fn disturbed(model: &Model) -> Pose {
    perturb(model, &upper_body::motion(model, 0), 5f64.to_radians(), 0.03, 1)
}

/// The limb with the darkest λ owns a pixel, as the text about (4.19) says. The nearest one need not: radii differ. And the
/// greatest λ, which (4.19) writes, would leave of two limbs only what they have in common.
#[test]
fn the_darkest_limb_wins_not_the_nearest() {
    let text = "format = \"backlit-body 1\"\nname = \"two\"\n\
                [[limb]]\nname = \"thick\"\ndirection = [0, 1, 0]\nlength = 0.4\nradius = 0.2\n\
                [[limb]]\nname = \"thin\"\ndirection = [1, 0, 0]\nlength = 0.4\nradius = 0.03\n";
    let spec: ModelSpec = toml::from_str(text).unwrap();
    let model = Model::new(&spec).unwrap();
    let kinematics = Kinematics::new(&model, &Pose::rest(&model));
    let camera = single_limb::camera(3.0, SIZE).unwrap();
    let both = predict(&model, &kinematics, &camera, RendererKind::Capsule, Ramp::Thesis);
    let alone = |limb: usize| {
        let mut spec = model.to_spec();
        spec.limbs = vec![spec.limbs[limb].clone()];
        let one = Model::new(&spec).unwrap();
        let kinematics = Kinematics::new(&one, &Pose::rest(&one));
        View::new(&one, &kinematics, &camera, RendererKind::Capsule, Ramp::Thesis)
    };
    let views = [alone(0), alone(1)];
    let each = [Prediction::of(&views[0]), Prediction::of(&views[1])];
    let metres = |limb: usize, pixel: usize| {
        let sight = views[limb].seen_limb(pixel % both.width, pixel / both.width);
        sight.map_or(f64::INFINITY, |sight| sight.distance_over_radius * model.limbs()[limb].radius)
    };
    let (mut told_apart, mut lost) = (0, 0);
    for pixel in 0..both.lambda.len() {
        let [thick, thin] = [0, 1].map(|limb| each[limb].lambda[pixel]);
        assert_eq!(both.lambda[pixel], thick.min(thin), "pixel {pixel}");
        lost += usize::from(thick.min(thin) == 0.0 && thick.max(thin) == 255.0);
        let is_touched = thick < 255.0 && thin < 255.0 && thick != thin;
        let darkest = usize::from(thin < thick);
        let nearest = usize::from(metres(1, pixel) < metres(0, pixel));
        if is_touched && darkest != nearest {
            told_apart += 1;
            assert_eq!(usize::from(both.owner[pixel]), darkest, "pixel {pixel}");
        }
    }
    assert!(told_apart > 20, "only {told_apart} pixels tell the rules apart");
    assert!(lost > 100, "by the greatest λ only {lost} pixels of the subject would be background");
}

/// A limb that is round about its axis may turn about it, if its children turn back: no pixel changes. So JᵀJ of
/// (4.10) has no inverse: 7 of the upper body's 27 directions are null, however many cameras there are.
#[test]
fn twists_undone_by_the_children_are_null_directions() {
    let model = builtin::upper_body();
    let pose = disturbed(&model);
    let (jacobian, _) = stacked(&pose, Parameters::Tangent);
    let svd = jacobian.clone().svd(false, false);
    let largest = svd.singular_values.amax();
    let null = svd.singular_values.iter().filter(|value| **value < 1e-9 * largest).count();
    let least_seen =
        svd.singular_values.iter().copied().filter(|value| *value >= 1e-9 * largest).fold(f64::MAX, f64::min);
    assert_eq!((jacobian.ncols(), null), (27, 7));
    assert!(least_seen > 1e-4 * largest, "the gap is clear: {:.1e}", least_seen / largest);
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        let limb = &model.limbs()[owner];
        let mut step = DVector::zeros(27);
        let mut set = |rotation: usize, turn: glam::DVec3| {
            step.fixed_rows_mut::<3>(Parameters::Tangent.first_column(rotation))
                .copy_from_slice(&turn.to_array());
        };
        // Both in the frames of their parents, from the left.
        set(rotation, pose.rotations[rotation] * limb.direction);
        let children = model.rotation_parents().iter().enumerate();
        for (child, _) in children.filter(|(_, parent)| **parent == Some(rotation)) {
            set(child, -limb.direction);
        }
        let change = (&jacobian * &step).norm() / (largest * step.norm());
        // The torso's sides are rigid with it, beside its axis: its twist is seen.
        let is_null = limb.name != "torso";
        assert!((change < 1e-12) == is_null, "{}: {change:.1e}", limb.name);
    }
}

/// In raw coefficients a quaternion's length scales its limb and all that hangs from it. That direction is not
/// null: Gauss-Newton stretches limbs with a part of its step, and the normalisation that follows throws it away.
#[test]
fn the_length_of_a_quaternion_is_no_null_direction_and_steps_are_spent_on_it() {
    let model = builtin::upper_body();
    let pose = disturbed(&model);
    let (jacobian, residual) = stacked(&pose, Parameters::Raw);
    let largest = jacobian.clone().svd(false, false).singular_values.amax();
    let column = |rotation| Parameters::Raw.first_column(rotation);
    let coefficients = |rotation: usize| {
        let q = pose.rotations[rotation];
        DVector::from_column_slice(&[q.w, q.x, q.y, q.z])
    };
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        let stretched = jacobian.columns(column(rotation), 4) * coefficients(rotation);
        let seen = stretched.norm() / largest;
        assert!(seen > 0.01, "{}: {seen:.1e}", model.limbs()[owner].name);
    }
    let mut equations = NormalEquations::zeros(jacobian.ncols());
    equations.jtj = jacobian.tr_mul(&jacobian);
    equations.jtr = jacobian.tr_mul(&residual);
    let step = equations.step(0.1);
    let (mut along, mut all) = (0.0, 0.0);
    for rotation in 0..model.rotation_count() {
        let part = step.rows(column(rotation), 4);
        along += part.dot(&coefficients(rotation)).powi(2);
        all += part.norm_squared();
    }
    let share = (along / all).sqrt();
    println!("{:.0} % of the step in the quaternions changes their lengths", 100.0 * share);
    assert!(share > 0.2, "{share}");
}

/// From the side a cylinder's silhouette does not change along its axis but at its ends, and there no pixel has a
/// gradient: the column of that direction is zero. A capsule's is not.
#[test]
fn a_cylinder_seen_from_the_side_has_no_gradient_along_its_axis() {
    let model = Arc::new(builtin::single_limb());
    let camera = single_limb::camera(1000.0, SIZE).unwrap();
    let kinematics = Kinematics::new(&model, &single_limb::start(0.1));
    let along = |renderer| {
        let view = View::new(&model, &kinematics, &camera, renderer, Ramp::Thesis);
        let jacobian = dense_jacobian(&view, &kinematics, &camera, Parameters::Tangent);
        // World x is the limb's axis, y across it in the picture.
        jacobian.column(0).norm() / jacobian.column(1).norm()
    };
    let [cylinder, capsule] = [RendererKind::Cylinder, RendererKind::Capsule].map(along);
    assert!(cylinder < 1e-3, "{cylinder}");
    assert!(capsule > 0.2, "{capsule}");
}
