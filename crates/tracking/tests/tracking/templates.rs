//! Templates: the head is a ball among border pixels, every template turns until it rests, and the body that they make is near
//! enough for a fit.

use std::sync::Arc;

use backlit_lab::experiment::starts::Draw;
use backlit_tracking::body::Model;
use backlit_tracking::body::{Kinematics, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitError, FitOptions, FitView};
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::metrics::mean_joint_error_mm;
use backlit_tracking::search::start::Level;
use backlit_tracking::templates::{TemplateError, TemplateOptions, TemplateResult, place};
use glam::{DQuat, DVec3};

use crate::fixtures;

/// Somebody who stands with the arms away from the trunk and the feet apart, turned by some angle.
fn standing(model: &Model, heading: f64) -> Pose {
    let turns = [
        ("spine", DVec3::new(0.1, 0.05, 0.0)),
        ("right upper arm", DVec3::new(0.2, -1.1, 0.0)),
        ("left upper arm", DVec3::new(0.3, 0.8, 0.0)),
        ("right forearm", DVec3::new(0.5, 0.0, 0.0)),
        ("right thigh", DVec3::new(0.1, -0.2, 0.0)),
        ("left thigh", DVec3::new(0.25, 0.15, 0.0)),
    ];
    let turns = turns.map(|(limb, turn)| (limb, exp(turn)));
    let mut pose = fixtures::posed(model, DVec3::new(0.2, -0.1, 0.95), &turns);
    let root = model.limbs()[model.limb_index("spine").unwrap()].rotation;
    pose.rotations[root] = DQuat::from_rotation_z(heading) * pose.rotations[root];
    pose
}

fn views(model: &Model, pose: &Pose, count: usize) -> Vec<FitView> {
    let view = |index: usize| {
        let angle = 0.4 + 1.3 * index as f64;
        let from = DVec3::new(3.6 * angle.cos(), 3.6 * angle.sin(), 1.4);
        let (at, intrinsics) = (DVec3::new(0.15, 0.0, 0.95), [220.0, 220.0, 79.5, 79.5]);
        fixtures::fit_view(model, pose, fixtures::camera([160, 160], intrinsics, from, at, DVec3::Z))
    };
    (0..count).map(view).collect()
}

fn placed(model: &Arc<Model>, views: &[FitView], options: &TemplateOptions) -> TemplateResult {
    place(model, views, options, &CancelToken::new()).unwrap()
}

#[test]
fn a_standing_person_is_put_together_and_a_fit_does_the_rest() {
    let model = Arc::new(builtin::full_body());
    for heading in [0.3, 2.4] {
        let truth = standing(&model, heading);
        let views = views(&model, &truth, 4);
        let found = placed(&model, &views, &TemplateOptions::default());
        let error = mean_joint_error_mm(&model, &found.pose, &truth);
        assert!(error < 130.0, "heading {heading}: {error:.0} mm");
        let mut fit = Fit::new(Arc::clone(&model), views, found.pose, FitOptions::default()).unwrap();
        let fitted = fit.run(&CancelToken::new(), |_| {}).pose;
        let error = mean_joint_error_mm(&model, &fitted, &truth);
        assert!(error < 25.0, "heading {heading}: {error:.0} mm after the fit");
    }
}

#[test]
fn head_trunk_and_limbs_come_in_order_and_rest() {
    let model = Arc::new(builtin::full_body());
    let truth = standing(&model, 0.3);
    let found = placed(&model, &views(&model, &truth, 4), &TemplateOptions::default());
    let steps = &found.steps;
    assert_eq!((steps[0].template.as_str(), steps[1].template.as_str()), ("head", "trunk"));
    let skull = model.limb_index("skull").unwrap();
    let ball = Kinematics::new(&model, &truth).ends()[skull];
    assert!(steps[0].ends[0].distance(ball) < 0.05, "{} {ball}", steps[0].ends[0]);
    // Every template rests, once, before the next begins; nothing that was placed is taken away.
    for two in steps.windows(2) {
        assert_eq!(two[0].template != two[1].template, two[0].rests, "{}", two[0].template);
        let stays = two[0].placed.iter().zip(&two[1].placed).all(|(before, after)| *after || !before);
        assert!(stays || two[1].template == "trunk");
    }
    let trunk: Vec<f64> =
        steps.iter().filter(|step| step.template == "trunk").map(|step| step.turned_rad).collect();
    assert!(trunk.len() > 2 && trunk[trunk.len() - 1] < trunk[0], "it turns: {trunk:?}");
    assert!(steps[steps.len() - 1].placed.iter().all(|&placed| placed));
    assert_eq!(found, placed(&model, &views(&model, &truth, 4), &TemplateOptions::default()));
}

/// With one camera depth is what the body's height says; the places in the picture are found all the same.
#[test]
fn one_camera_is_enough_to_put_templates_into() {
    let model = Arc::new(builtin::full_body());
    let truth = standing(&model, 0.3);
    let views = views(&model, &truth, 1);
    let found = placed(&model, &views, &TemplateOptions::default());
    let skull = model.limb_index("skull").unwrap();
    let pixel = |pose| views[0].camera.project(Kinematics::new(&model, pose).ends()[skull]).unwrap();
    assert!(pixel(&found.pose).distance(pixel(&truth)) < 8.0);
}

#[test]
fn what_cannot_be_placed_is_said() {
    let start = Draw { starts: 1, levels: vec![Level { degrees: 5, metres: 0.0 }], ..Draw::default() };
    let start = start.draw().unwrap().remove(0);
    let options = TemplateOptions::default();
    let refused = |model: Model, views: &[FitView], options: &TemplateOptions| {
        place(&Arc::new(model), views, options, &CancelToken::new()).unwrap_err()
    };
    let views = &start.views[&2];
    assert!(matches!(refused(builtin::single_limb(), views, &options), TemplateError::NoHead { .. }));
    let nobody = refused(builtin::upper_body(), &[], &options);
    assert!(matches!(nobody, TemplateError::Fit(FitError::NoData { .. })), "{nobody}");
    let none = TemplateOptions { directions: 0, ..options.clone() };
    assert!(refused(builtin::upper_body(), views, &none).to_string().contains("`directions` is 0"));
    let cancelled = CancelToken::new();
    cancelled.cancel();
    assert!(place(&start.model, views, &options, &cancelled).is_err());
}
