use backlit_tracking::body::{Pose, builtin};
use glam::DQuat;

use super::*;
use crate::damaged::assert_refused;
use crate::motion::{Motion, MotionFormat, MotionOptions, Names, to_bytes};

fn motion() -> Motion {
    let model = builtin::full_body();
    let mut poses = BTreeMap::new();
    for frame in 0..12 {
        let mut pose = Pose::rest(&model);
        for (index, rotation) in pose.rotations.iter_mut().enumerate() {
            let angle = 0.3 * (0.4 * frame as f64 + 1.7 * index as f64).sin();
            *rotation = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), angle) * *rotation;
        }
        pose.root = DVec3::new(0.1 * frame as f64, 0.2, 0.9);
        poses.insert(frame, pose);
    }
    Motion::of_poses("a", model, 20.0, poses)
}

/// What we write in any format is read with the joints, the times and the lengths that it was written with.
#[test]
fn what_is_exported_is_read_again() {
    let motion = motion();
    let ours = Trajectories::of_poses(&motion.model, 20.0, &motion.poses);
    let options = RecordingOptions::default();
    let span = |of: &Trajectories, frame: usize, a: &str, b: &str| {
        let at = |joint: &str| of.points[frame][of.column(joint).unwrap()].unwrap();
        at(a).distance(at(b))
    };
    for format in MotionFormat::ALL {
        if matches!(format, MotionFormat::Glb | MotionFormat::Mot) {
            continue;
        }
        let path = Path::new("a").with_extension(format.extension());
        let bytes = to_bytes(format, &motion, &MotionOptions::default()).unwrap();
        let recording = parse(&path, &bytes, &options).unwrap_or_else(|error| panic!("{error}"));
        let read = recording.trajectories(&path, &options).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((read.joints.len(), read.times.len()), (12, 12), "{format:?}");
        assert!((read.times[11] - ours.times[11]).abs() < 1e-3, "{format:?}");
        let unit = if format == MotionFormat::Bvh { 100.0 } else { 1.0 };
        for (a, b) in
            [("left shoulder", "right knee"), ("left ankle", "right elbow"), ("left hip", "right hip")]
        {
            let [theirs, ours] = [span(&read, 7, a, b) / unit, span(&ours, 7, a, b)];
            assert!((theirs - ours).abs() < 1e-5, "{format:?}: {a} to {b}: {theirs} {ours}");
        }
    }
    let mot = to_bytes(
        MotionFormat::Mot,
        &motion,
        &MotionOptions { names: Some(Names::OpenSim), ..Default::default() },
    )
    .unwrap();
    let path = Path::new("a.mot");
    let read = parse(path, &mot, &options).unwrap().trajectories(path, &options).unwrap();
    assert_eq!((read.joints.len(), read.angles.len(), read.times.len()), (0, 8, 12));
}

const LONG: &str = "frame,marker,x,y,z\n0,RKnee,1,2,3\n0,LKnee,4,5,6\n2,LKnee,7,8,9\n2,nose,0,0,0\n";
const WIDE: &str = "fnum,RKnee_x,RKnee_y,RKnee_z,RKnee_error\n5,1,2,3,0.1\n6,1,,3,0.1\n";
const MOT: &str =
    "a\nversion=1\ninDegrees=yes\nendheader\ntime knee_angle_r pelvis_tx\n0.5 90 1.5\n0.6 45 1.6\n";

fn read_csv(text: &str) -> Result<Recording> {
    parse(
        Path::new("a.csv"),
        text.as_bytes(),
        &RecordingOptions { frame_rate: Some(10.0), ..Default::default() },
    )
}

#[test]
fn tables_have_a_row_a_joint_or_a_row_a_frame() {
    let long = read_csv(LONG).unwrap();
    assert_eq!(long.names, ["RKnee", "LKnee", "nose"]);
    assert_eq!(
        (long.times, &long.points[1][..2]),
        (vec![0.0, 0.2], &[None, Some(DVec3::new(7.0, 8.0, 9.0))][..])
    );
    let wide = read_csv(WIDE).unwrap();
    assert_eq!((wide.names, wide.times), (vec!["RKnee".to_owned()], vec![0.5, 0.6]));
    assert_eq!(wide.points, [vec![Some(DVec3::new(1.0, 2.0, 3.0))], vec![None]]);
    let mot = parse(Path::new("a.mot"), MOT.as_bytes(), &RecordingOptions::default()).unwrap();
    assert!((mot.angles["knee_angle_r"][0] - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!((mot.angles.len(), mot.times), (1, vec![0.5, 0.6]));
}

#[test]
fn what_is_wrong_is_told() {
    assert_refused(
        LONG,
        read_csv,
        "
        marker ⇒ what ⇒ a.csv, line 1: `columns`
        2,nose ⇒ x,nose ⇒ a.csv, line 5: `frame` is \"x\"
        \\n2,LKnee,7,8,9\\n2,nose,0,0,0 ⇒ ⇒ at least 2
        2,LKnee ⇒ -1,LKnee ⇒ seconds that grow
    ",
    );
    let mot = |text: &str| parse(Path::new("a.mot"), text.as_bytes(), &RecordingOptions::default());
    assert_refused(
        MOT,
        mot,
        "
        endheader ⇒ ⇒ endheader before the table
        time ⇒ when ⇒ line 5: `names`
        45 1.6 ⇒ 45 ⇒ line 7: `row` is 2
        45 1.6 ⇒ 45 x ⇒ line 7: `row` is \"x\"
    ",
    );
    let rateless =
        parse(Path::new("a.csv"), LONG.as_bytes(), &RecordingOptions::default()).unwrap_err().to_string();
    assert!(rateless.contains("--frame-rate"), "{rateless}");
    let options =
        RecordingOptions { joints: vec![("nose".to_owned(), "left wrist".to_owned())], ..Default::default() };
    let long = read_csv(LONG).unwrap();
    assert_eq!(long.trajectories(Path::new("a.csv"), &options).unwrap().joints.len(), 3);
    let options =
        RecordingOptions { joints: vec![("noes".to_owned(), "left wrist".to_owned())], ..Default::default() };
    let unknown = long.trajectories(Path::new("a.csv"), &options).unwrap_err().to_string();
    assert!(unknown.contains("noes") && unknown.contains("RKnee, LKnee, nose"), "{unknown}");
    let ending = read(Path::new("a.txt"), &options).unwrap_err().to_string();
    assert!(ending.contains("trc, c3d, bvh"), "{ending}");
    for cut in [3, 40, 511, 700] {
        let bytes = to_bytes(MotionFormat::C3d, &motion(), &MotionOptions::default()).unwrap();
        assert!(parse(Path::new("a.c3d"), &bytes[..cut], &options).is_err());
    }
}
