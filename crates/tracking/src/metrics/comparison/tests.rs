use glam::{DQuat, EulerRot};

use super::*;
use crate::body::{Kinematics, builtin};

/// A person who bends arms and legs while walking on, 50 frames a second.
fn motion(count: usize, phase: f64) -> (Model, BTreeMap<usize, Pose>) {
    let model = builtin::full_body();
    let poses = (0..count).map(|frame| {
        let t = 0.02 * frame as f64 + phase;
        let step = |column: usize| 0.35 * ((1.3 + 0.21 * column as f64) * t + 0.9 * column as f64).sin();
        let mut pose = crate::fixtures::stepped(&model, crate::body::Parameters::Tangent, step);
        pose.root = DVec3::new(0.6 * t, 0.1 * (2.0 * t).sin(), 0.9);
        (frame, pose)
    });
    let poses = poses.collect();
    (model, poses)
}

fn posed<'a>(model: &'a Model, poses: &'a BTreeMap<usize, Pose>) -> Posed<'a> {
    Posed { model, poses, frame_rate: 50.0 }
}

/// The same motion begun `late` seconds later, seen through `change`.
fn reference(late: f64, change: impl Fn(usize, usize, DVec3) -> DVec3) -> Trajectories {
    let (model, poses) = motion(150, late);
    let mut track = Trajectories::of_poses(&model, 50.0, &poses);
    for (frame, points) in track.points.iter_mut().enumerate() {
        for (joint, point) in points.iter_mut().enumerate() {
            *point = point.map(|point| change(frame, joint, point));
        }
    }
    track
}

#[test]
fn the_same_motion_has_no_errors() {
    let (model, poses) = motion(150, 0.0);
    let compared =
        compare(&posed(&model, &poses), &reference(0.0, |_, _, p| p), &ComparisonOptions::default());
    assert!(!compared.clock.is_measured && compared.clock.seconds == 0.0);
    assert_eq!(compared.world, WorldMap::SAME);
    let overall = compared.overall.unwrap();
    assert!(overall.raw.max < 1e-9 && overall.procrustes.unwrap().max < 1e-6);
    assert_eq!(overall.pck, [1.0; 3]);
    assert_eq!((compared.frames.len(), compared.angles.len()), (150, 8));
    assert!(compared.angles.iter().all(|angle| angle.rms < 1e-9 && angle.correlation.unwrap() > 0.999));
}

/// Clock, axes, unit and place of another tool are found, and what is left is what its markers are off by.
#[test]
fn clock_and_world_of_another_tool_are_found() {
    let (model, poses) = motion(150, 0.0);
    let turn = DQuat::from_euler(EulerRot::XYZ, 1.2, -0.4, 2.0);
    let theirs = |_, _, p: DVec3| 1000.0 * (turn * p + DVec3::new(2.0, 1.0, -3.0));
    // What it shows at t, the track shows 0.53 s later: half a frame more than 26, and between frames it goes straight.
    let compared = compare(&posed(&model, &poses), &reference(0.53, theirs), &ComparisonOptions::default());
    assert!(
        compared.clock.is_measured && (compared.clock.seconds + 0.53).abs() < 0.004,
        "{:?}",
        compared.clock
    );
    assert_eq!((compared.world.kind, compared.world.scale), (WorldMatch::Fitted, 0.001));
    let overall = compared.overall.unwrap();
    assert!(overall.raw.median < 2.0 && overall.raw.p95 < 10.0 && compared.frames.len() < 130, "{overall:?}");
    assert!(compared.angles.iter().all(|angle| angle.rms < 1.0 && angle.correlation.unwrap() > 0.99));
}

#[test]
fn what_is_off_stays_and_each_measure_leaves_out_what_it_says() {
    let (model, poses) = motion(150, 0.0);
    let aside = DVec3::new(0.0, 0.03, 0.04);
    let options = ComparisonOptions::default();
    let moved = compare(&posed(&model, &poses), &reference(0.0, |_, _, p| p + aside), &options);
    let overall = moved.overall.unwrap();
    assert!((overall.raw.mean - 50.0).abs() < 1e-6 && (overall.raw.max - 50.0).abs() < 1e-6);
    assert!(overall.root_aligned.unwrap().max < 1e-6 && overall.procrustes.unwrap().max < 1e-6);
    assert_eq!((overall.pck[1], moved.world.kind), (1.0, WorldMatch::Same));
    // A body that is larger by a tenth has another size in every frame, and is no other unit.
    let large = compare(&posed(&model, &poses), &reference(0.0, |_, _, p| 1.1 * p), &options);
    assert_eq!(large.world.scale, 1.0);
    let overall = large.overall.unwrap();
    assert!(overall.root_aligned.unwrap().mean > 20.0 && overall.procrustes.unwrap().max < 1e-6);
    // One joint beside its place by the same in its limb's axes: placed takes it off.
    let elbow = model.limb_index("left upper arm").unwrap();
    let shoulder = model.limbs()[elbow].parent.unwrap();
    let marker = |frame: usize, joint: usize, p: DVec3| {
        let kinematics = Kinematics::new(&model, &poses[&frame]);
        let along = (kinematics.ends()[elbow] - kinematics.ends()[shoulder]).normalize();
        if joint == elbow { p + 0.05 * along } else { p }
    };
    let placed = compare(&posed(&model, &poses), &reference(0.0, marker), &options);
    let of_elbow = &placed.by_joint["left elbow"];
    assert!((of_elbow.raw.mean - 50.0).abs() < 1e-6 && of_elbow.placed.unwrap() < 12.0, "{of_elbow:?}");
    assert!(placed.by_joint["left wrist"].raw.max < 1e-9);
}

#[test]
fn angles_alone_set_the_clock_and_hinges_may_count_downwards() {
    let (model, poses) = motion(150, 0.0);
    let joints = reference(0.4, |_, _, p| p);
    let curve = |angle: JointAngle| (angle, joints.angle_curve(angle));
    let mut angles: BTreeMap<JointAngle, Vec<Option<f64>>> =
        [JointAngle::LeftKnee, JointAngle::RightElbow, JointAngle::RightHip].into_iter().map(curve).collect();
    let knee = angles.get_mut(&JointAngle::LeftKnee).unwrap();
    knee.iter_mut().for_each(|angle| *angle = angle.map(|angle| 0.1 - angle));
    let recorded = Trajectories { times: joints.times, angles, ..Trajectories::default() };
    let compared = compare(&posed(&model, &poses), &recorded, &ComparisonOptions::default());
    assert!(compared.overall.is_none() && compared.frames.is_empty());
    let told: Vec<(JointAngle, bool)> = compared.angles.iter().map(|a| (a.angle, a.is_turned)).collect();
    let [hip, knee, elbow] = [JointAngle::RightHip, JointAngle::LeftKnee, JointAngle::RightElbow];
    assert_eq!(told, [(hip, false), (knee, true), (elbow, false)]);
    let knee = &compared.angles[1];
    assert!(knee.rms_without_offset < 1.0 && (knee.offset - 0.1_f64.to_degrees()).abs() < 0.5, "{knee:?}");
}
