//! Derivatives by differences, and a person of odd shape found again from silhouettes.

use glam::DVec3;

use super::refine::Silhouettes;
use super::*;
use crate::body::{LimbSphere, Parameters, builtin};
use crate::fixtures::{self, Failures};
use crate::render::predict;
use crate::silhouette::{Label, Mask};

/// The upper body with limbs that are no capsules: three spheres each, off the axis.
fn odd_body(thicker: f64) -> Model {
    let model = builtin::upper_body();
    let sphere = |limb: &crate::body::Limb, at: f64, radius: f64, aside: f64| LimbSphere {
        at,
        radius: thicker * radius * limb.radius,
        offset: aside * limb.radius * limb.direction.any_orthonormal_vector(),
        parent: None,
    };
    let trees = model.limbs().iter().map(|limb| {
        let spheres =
            vec![sphere(limb, 0.1, 1.1, 0.3), sphere(limb, 0.5, 1.4, -0.4), sphere(limb, 0.9, 0.9, 0.2)];
        vec![SphereLevel { error: 0.0, spheres, reaches: Vec::new() }]
    });
    model.with_trees(trees.collect()).unwrap()
}

fn frames(body: &Model, count: usize, size: u64) -> Vec<PosedViews> {
    let frame = |frame: usize| {
        let step = |i: usize| 0.35 * ((5 * frame + 3 * i) as f64).sin();
        let pose = fixtures::stepped(body, Parameters::Tangent, step);
        let kinematics = Kinematics::new(body, &pose);
        let view = |index: usize| {
            let angle = 1.57 * index as f64 + 0.3;
            let centre = DVec3::new(2.2 * angle.sin(), 0.3, 2.2 * angle.cos());
            let (middle, focal) = (0.5 * (size as f64 - 1.0), 1.2 * size as f64);
            let intrinsics = [focal, focal, middle, middle];
            let camera = fixtures::camera([size, size], intrinsics, centre, DVec3::Y * 0.3, DVec3::Y);
            let drawn = predict(body, &kinematics, &camera, OWN, Ramp::Half);
            let label = |&level: &f32| if level < 127.5 { Label::Subject } else { Label::Background };
            let labels = drawn.lambda.iter().map(label).collect();
            FitView::of_mask(camera, Mask::new(size as usize, size as usize, labels).unwrap())
        };
        PosedViews { frame, views: (0..3).map(view).collect(), pose }
    };
    (0..count).map(frame).collect()
}

/// −2 Σ h ρ is the gradient of the cost, of every sphere's centre and log radius.
#[test]
fn sphere_gradients_match_differences() {
    let frames = frames(&odd_body(1.0), 1, 72);
    let body = odd_body(0.93);
    let silhouettes = Silhouettes::new(&body, &frames, 1);
    let (_, blocks) = silhouettes.blocks(&body);
    let scale = blocks.iter().map(|block| block.forces.amax()).fold(0.0, f64::max);
    let (mut failures, mut compared) = (Failures::default(), 0);
    let mut index = 0;
    for (limb_index, limb) in body.limbs().iter().enumerate() {
        for number in 0..limb.spheres.len() {
            for component in 0..4 {
                let cost = |h: f64| {
                    let changed = body.with_spheres(|limb, sphere, old| {
                        let mut new = *old;
                        if (limb, sphere) == (limb_index, number) {
                            match component {
                                3 => new.radius *= h.exp(),
                                axis => new.offset[axis] += h,
                            }
                        }
                        new
                    });
                    silhouettes.blocks(&changed).0
                };
                let h = 1e-6;
                let numeric = (cost(h) - cost(-h)) / (2.0 * h);
                let analytic = -2.0 * blocks[index].forces[component];
                compared += usize::from(analytic.abs() > 1e-3 * scale);
                // Where the winner of a pixel changes within the step the cost has a kink.
                let what = format_args!("{}, sphere {number}, {component}", limb.name);
                failures.near(what, numeric, analytic, 2e-3 * scale + 1e-3 * analytic.abs());
            }
            index += 1;
        }
    }
    assert!(compared > 40, "only {compared}");
}

#[test]
fn spheres_move_to_the_silhouettes() {
    let truth = odd_body(1.0);
    let frames = frames(&truth, 3, 96);
    let begin = odd_body(0.8);
    let options = SphereBodyOptions { stride: 1, ..SphereBodyOptions::default() };
    let (found, rms) = refine::refine(&begin, &begin, &frames, &options);
    let iou = |body: &Model| overlap(body, &frames, OWN).unwrap();
    assert!(rms[1] < 0.4 * rms[0], "{rms:?}");
    assert!(iou(&begin) < 0.8 && iou(&found) > 0.95, "{} {}", iou(&begin), iou(&found));
}

/// From silhouettes of an odd person and the poses: spheres are nearer to it than the capsules are, and have levels.
#[test]
fn a_person_is_carved_and_filled() {
    let truth = odd_body(1.0);
    let frames = frames(&truth, 4, 96);
    let model = builtin::upper_body();
    let options =
        SphereBodyOptions { spheres: 120, step: 0.02, rounds: 1, steps: 15, ..SphereBodyOptions::default() };
    let mut told = Vec::new();
    let tell = |at: SphereBodyProgress| told.push((at.doing, at.done, at.total));
    let body =
        sphere_body(&model, frames.clone(), &options, &FitOptions::default(), &CancelToken::new(), tell)
            .unwrap();
    let parts = ["carving limbs", "moving spheres", "moving coarser spheres"];
    assert_eq!(told, [0, 1, 2].map(|done| (parts[done], done, 3)));
    let [capsules, carved, end] = body.iou.unwrap();
    assert!(end > capsules + 0.05 && end > carved + 0.1 && end > 0.88, "{capsules} {carved} {end}");
    assert_eq!(body.spheres.len(), 2);
    assert!(body.spheres[0] < body.spheres[1] && body.spheres[1] <= 140, "{:?}", body.spheres);
    let coarse = body.model.at_level(0).unwrap();
    assert!(overlap(&coarse, &frames, OWN).unwrap() > 0.75);
    let none = sphere_body(&model, Vec::new(), &options, &FitOptions::default(), &CancelToken::new(), |_| {});
    assert!(none.unwrap_err().to_string().contains("no frame"));
}
