//! The mathematics of drags, on a full body before a camera.

use backlit_tracking::body::{Kinematics, Parameters, builtin};
use proptest::prelude::*;

use super::*;

fn camera() -> std::sync::Arc<Camera> {
    let (from, to) = (DVec3::new(3.0, -1.0, 1.0), DVec3::ZERO);
    crate::app::testing::camera([272, 480], [420.0, 134.0, 238.0], from, to, DVec3::Z)
}

/// A pose near rest: every rotation turned by up to 0.2 rad about each axis, within the limits.
fn pose_near_rest(model: &Model, seed: &[f64]) -> Pose {
    let count = Parameters::Tangent.columns(model.rotation_count());
    let step: Vec<f64> = (0..count).map(|index| 0.2 * seed[index % seed.len()]).collect();
    let rest = Pose::rest(model);
    posing::within_limits(model, &rest, &rest.retract(Parameters::Tangent, &step))
}

fn pose_of(dragged: Option<Dragged>) -> Pose {
    match dragged {
        Some(Dragged::Pose(pose)) => pose,
        other => panic!("{other:?}"),
    }
}

fn is_within_limits(model: &Model, pose: &Pose) -> bool {
    model.rotation_owners().iter().zip(&pose.rotations).all(|(owner, rotation)| {
        let limb = &model.limbs()[*owner];
        let angles = limb.angles(*rotation);
        limb.limits.is_none_or(|limits| {
            limits.flexion.excess(angles.flexion).abs() < 1e-6
                && limits.sideways.excess(angles.sideways).abs() < 1e-6
                && limits.twist.excess(angles.twist).abs() < 1e-6
        })
    })
}

fn seed() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(-1.0..1.0_f64, 13)
}

#[test]
fn the_whole_body_moves_with_the_point_that_is_held() {
    let (model, camera) = (builtin::full_body(), camera());
    let base = Pose::rest(&model);
    let from_px = camera.project(DVec3::ZERO).unwrap();
    let to_px = from_px + DVec2::new(30.0, 10.0);
    let drag = Drag::Body { from_px, to_px, depth_m: camera.depth(DVec3::ZERO) };
    let pose = pose_of(dragged(&model, Held::default(), &base, &camera, drag));
    assert!(camera.project(pose.root).unwrap().distance(to_px) < 1e-6);
    assert_eq!(pose.rotations, base.rotations);
}

#[test]
fn a_limb_stops_at_its_limit_and_the_sentence_says_so() {
    let (model, camera) = (builtin::full_body(), camera());
    let base = Pose::rest(&model);
    let forearm = model.limb_index("right forearm").unwrap();
    let limits = model.limbs()[forearm].limits.unwrap();
    let rotation = model.limbs()[forearm].rotation;
    for angle_rad in [0.4, -0.4, 2.0, -2.0] {
        let drag = Drag::Twist { limb: forearm, angle_rad };
        let pose = pose_of(dragged(&model, Held::default(), &base, &camera, drag));
        let twist = model.limbs()[forearm].angles(pose.rotations[rotation]).twist;
        let wanted = angle_rad.clamp(limits.twist.0, limits.twist.1);
        assert!((twist - wanted).abs() < 1e-9, "{twist} {wanted}");
        let sentence = limit_sentence(&model, &base, &pose);
        assert_eq!(sentence.is_some(), wanted != angle_rad, "{sentence:?}");
        if let Some(sentence) = sentence {
            assert!(sentence.starts_with("Right forearm stops: its twist is at the limit of "), "{sentence}");
        }
    }
}

#[test]
fn a_pose_beyond_a_limit_may_come_back_but_is_not_drawn_in() {
    let (model, camera) = (builtin::full_body(), camera());
    let mut base = Pose::rest(&model);
    let forearm = model.limb_index("left forearm").unwrap();
    let limb = &model.limbs()[forearm];
    let limits = limb.limits.unwrap();
    let mut angles = limb.angles(base.rotations[limb.rotation]);
    angles.twist = limits.twist.1 + 0.2;
    base.rotations[limb.rotation] = limb.rotation_from_angles(angles);
    let twist_after = |angle_rad: f64| {
        let drag = Drag::Twist { limb: forearm, angle_rad };
        let pose = pose_of(dragged(&model, Held::default(), &base, &camera, drag));
        limb.angles(pose.rotations[limb.rotation]).twist - limits.twist.1
    };
    assert!((twist_after(0.1) - 0.2).abs() < 1e-9);
    assert!((twist_after(-0.05) - 0.15).abs() < 1e-9);
    let shoulder = JointId::End(model.limb_index("right clavicle").unwrap());
    let target_px = camera.project(joint_position(&model, &base, shoulder)).unwrap() + DVec2::new(1.0, 0.0);
    let drag = Drag::Joint { joint: shoulder, target_px };
    let pose = pose_of(dragged(&model, Held::default(), &base, &camera, drag));
    let other = limb.angles(pose.rotations[limb.rotation]).twist - limits.twist.1;
    assert!((other - 0.2).abs() < 0.02, "another drag does not jump: {other}");
}

#[test]
fn sizes_follow_the_pointer() {
    let (model, camera) = (builtin::full_body(), camera());
    let pose = Pose::rest(&model);
    let forearm = model.limb_index("right forearm").unwrap();
    let kinematics = Kinematics::new(&model, &pose);
    let (start, end) = (kinematics.starts()[forearm], kinematics.ends()[forearm]);
    let [from_px, to_px] = [end, end + 0.1 * (end - start).normalize()].map(|p| camera.project(p).unwrap());
    let size = |drag| match dragged(&model, Held::default(), &pose, &camera, drag) {
        Some(Dragged::Size { length, radius, .. }) => [length, radius],
        other => panic!("{other:?}"),
    };
    let limb = &model.limbs()[forearm];
    let [length, radius] = size(Drag::Length { limb: forearm, from_px, to_px });
    assert!((length - limb.length - 0.1).abs() < 1e-9 && radius == limb.radius, "{length}");
    // A sideways pointer changes nothing of the length.
    let across = (to_px - from_px).perp();
    let [sideways, _] = size(Drag::Length { limb: forearm, from_px, to_px: from_px + 0.2 * across });
    assert!((sideways - limb.length).abs() < 0.02, "{sideways}");
    let middle = camera.project(start.lerp(end, 0.5)).unwrap();
    let beside = middle + across.normalize() * 20.0;
    let [length, radius] =
        size(Drag::Radius { limb: forearm, from_px: beside, to_px: beside + across.normalize() * 5.0 });
    let metres_per_px = camera.depth(start.lerp(end, 0.5)) / 420.0;
    assert!(length == limb.length && (radius - limb.radius - 5.0 * metres_per_px).abs() < 0.003, "{radius}");
    let [_, thinnest] = size(Drag::Radius { limb: forearm, from_px: beside, to_px: middle });
    assert_eq!(thinnest, *RADII_M.start());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_dragged_joint_is_seen_where_the_pointer_is_and_at_its_depth(
        seed in seed(), dx in -25.0..25.0_f64, dy in -25.0..25.0_f64, end in 0..4_usize,
    ) {
        let (model, camera) = (builtin::full_body(), camera());
        let base = pose_near_rest(&model, &seed);
        let name = ["right forearm", "left upper arm", "right calf", "left lower thigh"][end];
        let joint = JointId::End(model.limb_index(name).unwrap());
        let before = joint_position(&model, &base, joint);
        let target_px = camera.project(before).unwrap() + DVec2::new(dx, dy);
        let drag = Drag::Joint { joint, target_px };
        let pose = pose_of(dragged(&model, Held::default(), &base, &camera, drag));
        let after = joint_position(&model, &pose, joint);
        let missed = camera.project(after).unwrap().distance(target_px);
        prop_assert!(missed < 0.5, "{name}: {missed} px");
        prop_assert!((camera.depth(after) - camera.depth(before)).abs() < 0.005);
        prop_assert!(is_within_limits(&model, &pose));
        // Dragging back undoes itself.
        let back = Drag::Joint { joint, target_px: camera.project(before).unwrap() };
        let back = pose_of(dragged(&model, Held::default(), &base, &camera, back));
        let moved: f64 = back.local(&base).iter().map(|x| x.abs()).fold(0.0, f64::max);
        prop_assert!(moved < 1e-3, "{moved}");
    }

    #[test]
    fn depth_keeps_the_pixel(seed in seed(), ratio in 0.93..1.07_f64, is_root in any::<bool>()) {
        let (model, camera) = (builtin::full_body(), camera());
        let base = pose_near_rest(&model, &seed);
        let wrist = JointId::End(model.limb_index("left forearm").unwrap());
        let joint = if is_root { JointId::Root } else { wrist };
        let drag = Drag::Depth { joint, ratio };
        let pose = pose_of(dragged(&model, Held::default(), &base, &camera, drag));
        let [before, after] = [&base, &pose].map(|pose| joint_position(&model, pose, joint));
        let moved = camera.project(before).unwrap().distance(camera.project(after).unwrap());
        prop_assert!(moved < 0.5, "{moved} px");
        prop_assert!((camera.depth(after) / camera.depth(before) - ratio).abs() < 0.003);
    }

    #[test]
    fn a_twist_keeps_the_limbs_joints(seed in seed(), angle_rad in -1.0..1.0_f64, which in 0..3_usize) {
        let (model, camera) = (builtin::full_body(), camera());
        let base = pose_near_rest(&model, &seed);
        let limb = model.limb_index(["right upper arm", "left forearm", "right thigh"][which]).unwrap();
        let pose = pose_of(dragged(&model, Held::default(), &base, &camera, Drag::Twist { limb, angle_rad }));
        let [before, after] = [&base, &pose].map(|pose| Kinematics::new(&model, pose));
        prop_assert!(before.starts()[limb].distance(after.starts()[limb]) < 1e-9);
        prop_assert!(before.ends()[limb].distance(after.ends()[limb]) < 1e-9);
        prop_assert!(is_within_limits(&model, &pose));
    }

    #[test]
    fn a_turn_keeps_the_pivot_and_the_limits(seed in seed(), angle_rad in -2.5..2.5_f64) {
        let (model, camera) = (builtin::full_body(), camera());
        let base = pose_near_rest(&model, &seed);
        let limb = model.limb_index("left upper arm").unwrap();
        let start = Kinematics::new(&model, &base).starts()[limb];
        let drag = Drag::Turn { limb, pivot_px: camera.project(start).unwrap(), angle_rad };
        let pose = pose_of(dragged(&model, Held::default(), &base, &camera, drag));
        prop_assert!(Kinematics::new(&model, &pose).starts()[limb].distance(start) < 1e-9);
        prop_assert!(is_within_limits(&model, &pose));
    }
}
