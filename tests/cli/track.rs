//! `backlit track`, `silhouettes` and `fit TAKE` on a small take: a body that waves before a wall.

use std::fs;
use std::path::{Path, PathBuf};

use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::{images, model_file, pose_file};
use backlit_tracking::body::{Kinematics, Parameters, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::{Ramp, RendererKind, predict};
use image::{DynamicImage, Rgb, RgbImage};
use serde_json::Value;

use crate::scene::{BUILT_IN, Scene};

const FRAMES: usize = 5;

const TAKE: &str = r#"format = "backlit-take 1"
name = "wave"
frame_rate = 30
model = "upper_body"
start = "start.json"
[cameras]
calibration = "../cameras.json"
[[camera]]
name = "front"
frames = "front/%02d.png"
background = "front/plate.png"
[[camera]]
name = "side"
frames = "side/%02d.png"
background = "side/plate.png"
[reference]
keypoints = "truth.csv"
[measurement]
shadow = false
dont_know = false
"#;

/// The scene's pose with an arm that goes down.
fn pose(scene: &Scene, frame: usize) -> Pose {
    let mut step = vec![0.0; Parameters::Tangent.columns(scene.model.rotation_count())];
    let arm = scene.model.limb_index("right upper arm").unwrap();
    let first = Parameters::Tangent.first_column(scene.model.limbs()[arm].rotation);
    step[first + 2] = 0.05 * frame as f64;
    scene.pose().retract(Parameters::Tangent, &step)
}

/// A wall with a pattern; before it, dark, the body.
fn picture(scene: &Scene, camera: &Camera, pose: Option<&Pose>) -> RgbImage {
    let lambda = pose.map(|pose| {
        let kinematics = Kinematics::new(&scene.model, pose);
        predict(&scene.model, &kinematics, camera, RendererKind::Capsule, Ramp::Half).lambda
    });
    RgbImage::from_fn(camera.width() as u32, camera.height() as u32, |x, y| {
        let is_subject =
            lambda.as_ref().is_some_and(|lambda| lambda[y as usize * camera.width() + x as usize] < 127.5);
        if is_subject { Rgb([90, 40, 60]) } else { Rgb([150 + (x % 7) as u8, 160, 170 + (y % 5) as u8]) }
    })
}

/// A scene with a take in `wave`.
pub(crate) fn take() -> Scene {
    let scene = Scene::new();
    let rig = calibration::read(&scene.path("cameras.json"), CalibrationOptions::default()).unwrap();
    for camera in rig.cameras() {
        let folder = scene.path("wave").join(camera.name());
        fs::create_dir_all(&folder).unwrap();
        let write = |name: &str, pose: Option<&Pose>| {
            let picture = DynamicImage::ImageRgb8(picture(&scene, camera, pose));
            images::write_png(&folder.join(name), &picture).unwrap();
        };
        write("plate.png", None);
        (0..FRAMES).for_each(|frame| write(&format!("{frame:02}.png"), Some(&pose(&scene, frame))));
    }
    let mut truth = "frame,joint,x,y,z\n".to_owned();
    for frame in 0..FRAMES {
        let kinematics = Kinematics::new(&scene.model, &pose(&scene, frame));
        for (limb, end) in scene.model.limbs().iter().zip(kinematics.ends()) {
            truth.push_str(&format!("{frame},{},{},{},{}\n", limb.name, end.x, end.y, end.z));
        }
    }
    scene.write("wave/truth.csv", &truth);
    scene.write("wave/take.toml", TAKE);
    pose_file::write(&scene.path("wave/start.json"), &scene.model, &pose(&scene, 0)).unwrap();
    scene
}

fn lines(path: PathBuf) -> Vec<String> {
    fs::read_to_string(path).unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn a_take_is_tracked() {
    let scene = take();
    let summary = scene.json("track wave --out out --start-noise 2deg,1cm --json");
    assert_eq!(summary, scene.read_json("out/summary.json"));
    assert_eq!((summary["frames"].as_u64(), summary["lost"].as_u64()), (Some(FRAMES as u64), Some(0)));
    assert!(summary["iou"]["mean"].as_f64().unwrap() > 0.8, "{summary}");
    assert!(summary["iou"]["by_camera"]["side"].as_f64().unwrap() > 0.8, "{summary}");
    assert!(summary["joint_error_mm"]["mean"].as_f64().unwrap() < 40.0, "{summary}");
    let of_joint = &summary["joint_error_mm"]["by_joint"]["right forearm"];
    assert!(of_joint["median"].as_f64() <= of_joint["max"].as_f64() && of_joint["max"].is_f64());
    assert!(summary["ms_per_frame"]["median"].as_f64().unwrap() > 0.0);

    let track = scene.read_json("out/track.json");
    let table = lines(scene.path("out/joints.csv"));
    assert_eq!(table.len(), 1 + FRAMES * (1 + scene.model.limbs().len()));
    for frame in 0..FRAMES {
        let found = &track["frames"][frame];
        assert_eq!(found["frame"], frame);
        assert_eq!(found["root"], found["joints"]["root"]);
        assert_eq!(found["rotations"].as_object().unwrap().len(), scene.model.rotation_count());
        assert!(found["iterations"].as_u64().unwrap() > 0 && found["iou"]["side"].as_f64().unwrap() > 0.7);
        // The same three numbers in the table.
        let [x, y, z] = [0, 1, 2].map(|i| found["joints"]["right forearm"][i].as_f64().unwrap());
        assert!(table.contains(&format!("{frame},right forearm,{x},{y},{z}")));
    }
    assert_eq!(lines(scene.path("out/frames.csv")).len(), 1 + FRAMES);
    assert_eq!(lines(scene.path("out/poses.csv")).len(), 1 + FRAMES);
}

#[test]
fn another_body_takes_the_place_of_the_take_s() {
    let scene = take();
    let mean = |options: &str| {
        let summary = scene.json(&format!("track wave --out out --json {options}"));
        summary["joint_error_mm"]["mean"].as_f64().unwrap()
    };
    let small = scene.model.scaled(0.8).unwrap();
    model_file::write(&scene.path("small.toml"), &small).unwrap();
    assert_eq!(mean("--model upper_body").to_bits(), mean("").to_bits());
    assert!(mean("--model small.toml") > 10.0 + mean(""));
    let wrong = scene.command("track wave --out out --model single_limb").output().unwrap();
    assert!(!wrong.status.success());
}

#[test]
fn many_starts_are_counted() {
    let scene = take();
    let command = "experiment footage wave --starts 6 --start-noise 40deg,10cm --seed 4 --frames 0..2";
    let held = |options: &str| {
        let numbers = scene.json(&format!("{command} --json {options}"));
        let starts = numbers["starts"].as_array().unwrap();
        let seeds: Vec<u64> = starts.iter().map(|start| start["seed"].as_u64().unwrap()).collect();
        assert_eq!(seeds, [4, 5, 6, 7, 8, 9]);
        let count = starts.iter().filter(|start| start["held"].as_bool().unwrap()).count();
        assert_eq!(numbers["held"].as_u64(), Some(count as u64));
        count
    };
    let (never, always) = (held("--search never"), held("--search"));
    assert!(never < always, "{never} of 6 without a search, {always} with one");
    let said = scene.ok(&format!("{command} --search"));
    assert!(said.contains(&format!("{always} of 6 starts stay within 150 mm everywhere")), "{said}");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let scene = take();
    let poses = |threads: &str| {
        let output =
            scene.command("track wave --out out").env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert!(output.status.success());
        fs::read(scene.path("out/track.json")).unwrap()
    };
    assert_eq!(poses("1"), poses("4"));
}

#[test]
fn parts_of_a_take() {
    let scene = take();
    let text = scene.ok("track wave --out out --frames 1.. --every 2 --cameras side --start reference");
    assert!(
        text.contains("2 frames tracked, none lost") && text.contains("side") && !text.contains("front"),
        "{text}"
    );
    let numbers: Vec<String> = lines(scene.path("out/frames.csv"))[1..]
        .iter()
        .map(|line| line.split(',').next().unwrap().to_owned())
        .collect();
    assert_eq!(numbers, ["1", "3"]);
    scene.fails("track wave --out out --frames 3..9", 1, &["--frames", "5 frames", "frame 8"]);
    scene.fails("track wave --out out --frames 3..3", 1, &["--frames", "no frame"]);
    scene.fails("track wave --out out --cameras side,back", 1, &["--cameras", "back", "front, side"]);
    scene.fails("track wave --out out --start-noise 5,3", 2, &["--start-noise", "5deg,3cm"]);
}

#[test]
fn one_frame_of_a_take_is_fitted() {
    let scene = take();
    let answer = scene.json(
        "fit wave --frame 3 --start reference --start-noise 3deg,1cm --seed 4 --json --out fitted.json",
    );
    assert!(answer["rms"].as_f64().is_some());
    assert!(scene.path("fitted.json").exists());
    scene.fails("fit wave --frame 7", 1, &["frame 7", "5"]);
    scene.fails("fit wave", 2, &["--frame"]);
}

#[test]
fn silhouettes_are_written_with_their_cameras() {
    let scene = take();
    scene.ok("silhouettes wave --out masks --frames 2");
    let mask = images::read_grey(&scene.path("masks/front/frame_000002.png")).unwrap();
    let rig = calibration::read(&scene.path("cameras.json"), CalibrationOptions::default()).unwrap();
    let truth = picture(&scene, &rig.cameras()[0], Some(&pose(&scene, 2)));
    let wrong =
        truth.pixels().zip(mask.pixels()).filter(|(pixel, mask)| (pixel[0] == 90) != (mask[0] == 255));
    // Opening and closing take corners off.
    let (wrong, subject) = (wrong.count(), truth.pixels().filter(|pixel| pixel[0] == 90).count());
    assert!(10 * wrong < subject, "{wrong} of {subject} pixels");
    let cameras =
        calibration::read(&scene.path("masks/cameras.json"), CalibrationOptions::default()).unwrap();
    assert!(cameras.cameras().iter().all(|camera| camera.distortion().is_none()));
}

/// A patch beside the body in one picture, and settings that suit no picture.
#[test]
fn the_worst_silhouettes_are_listed_and_settings_are_tuned() {
    let scene = take();
    let path = scene.path("wave/front/03.png");
    let mut spoilt = image::open(&path).unwrap().into_rgb8();
    let (width, height) = spoilt.dimensions();
    for (x, y) in (0..width / 4).flat_map(|x| (0..height / 2).map(move |y| (x, y))) {
        spoilt.put_pixel(x, y, Rgb([250, 20, 20]));
    }
    spoilt.save(&path).unwrap();
    let listed = scene.ok("silhouettes wave --worst 3");
    let first = listed.lines().nth(1).unwrap();
    assert!(first.starts_with("3 ") && first.contains("front") && first.contains('%'), "{listed}");
    let tuned = scene.ok("silhouettes wave --tune --frames 0..2");
    assert!(tuned.contains("cameras and body agree to 0."), "{tuned}");
    scene.fails("silhouettes wave", 2, &["--out"]);
    scene.fails("silhouettes wave --worst 0", 2, &["--worst"]);
}

#[test]
fn what_was_tracked_before_a_bad_picture_is_kept() {
    let scene = take();
    let path = scene.path("wave/side/03.png");
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    scene.fails(
        "track wave --out out",
        1,
        &["3 of 5 frames", "camera \"side\", frame 3", "side/03.png", "not a whole picture"],
    );
    assert_eq!(scene.read_json("out/track.json")["frames"].as_array().unwrap().len(), 3);
}

#[test]
fn bad_takes_are_explained() {
    let scene = take();
    let expect = |take: &str, expected: &[&str]| {
        scene.write("wave/take.toml", take);
        scene.fails("track wave --out out", 1, expected);
    };
    expect(&TAKE.replace("[measurement]", "[measurement]\nshadows = true"), &["take.toml, line ", "shadows"]);
    expect(&TAKE.replace("frame_rate", "framerate"), &["take.toml, line 3", "framerate"]);
    expect(&TAKE.replace("background = \"side/plate.png\"\n", ""), &["camera \"side\"", "background"]);
    expect(&TAKE.replace("name = \"side\"", "name = \"back\""), &["take.toml, line ", "back", "front, side"]);
    let elsewhere = TAKE.replace("model", "footage = \"${NOWHERE:-gone}/wave\"\nmodel");
    expect(&elsewhere, &["take.toml, line 4", "`footage`", "${NOWHERE:-gone}/wave", "cameras.json"]);
    assert!(!scene.path("out/track.json").exists());
    scene.write("wave/take.toml", TAKE);
    let replace = |name: &str, picture: Option<RgbImage>| {
        let path: &Path = &scene.path(name);
        match picture {
            Some(picture) => images::write_png(path, &DynamicImage::ImageRgb8(picture)).unwrap(),
            None => fs::remove_file(path).unwrap(),
        }
    };
    replace("wave/front/00.png", Some(RgbImage::new(64, 96)));
    scene.fails("track wave --out out", 1, &["camera \"front\", frame 0", "64×96", "128×96"]);
    replace("wave/side/02.png", None);
    scene.fails("track wave --out out", 1, &["side/02.png", "camera \"side\""]);
    scene.fails("track nowhere --out out", 1, &["nowhere"]);
    scene.fails("track wave/front --out out", 1, &["wave/front", "no take.toml"]);
}

#[test]
fn a_take_without_a_start_is_searched_for_one() {
    let scene = take();
    let (without, _) = TAKE.split_once("[reference]").unwrap();
    scene.write("wave/take.toml", &without.replace("start = \"start.json\"\n", ""));
    let summary = scene.json("track wave --out out --json");
    assert_eq!(summary["begun"]["searched"], true);
    assert_eq!(summary["frames"].as_u64(), Some(FRAMES as u64));
    assert!(summary["iou"]["mean"].as_f64().unwrap() > 0.8, "{summary}");
    // Where nobody is seen there is nothing to find.
    for camera in ["front", "side"] {
        let file = |name: &str| scene.path(&format!("wave/{camera}/{name}"));
        fs::copy(file("plate.png"), file("00.png")).unwrap();
    }
    scene.fails("track wave --out none", 1, &["no `start`", "frame 0", "--start POSE"]);
}

/// The silhouettes that the program writes are masks made elsewhere to another take, which needs no footage.
#[test]
fn masks_and_cameras_alone_are_tracked() {
    let scene = take();
    scene.ok("silhouettes wave --out masks");
    let mut text = TAKE.replace("../cameras.json", "../masks/cameras.json");
    for camera in ["front", "side"] {
        let beside = format!("frames = \"{camera}/%02d.png\"\nbackground = \"{camera}/plate.png\"");
        assert!(text.contains(&beside));
        text = text.replace(&beside, &format!("masks = \"../masks/{camera}/frame_%06d.png\""));
    }
    scene.write("wave/take.toml", &text);
    let summary = scene.json("track wave --out out --json");
    assert_eq!((summary["frames"].as_u64(), summary["lost"].as_u64()), (Some(FRAMES as u64), Some(0)));
    assert!(summary["joint_error_mm"]["mean"].as_f64().unwrap() < 40.0, "{summary}");
    scene.ok("fit wave --frame 1");
}

#[test]
fn silhouettes_that_cannot_be_right_are_told_before_anything_is_tracked() {
    let scene = take();
    scene.ok("silhouettes wave --out masks");
    let inverted = |camera: &str| {
        for frame in 0..FRAMES {
            let path = scene.path(&format!("masks/{camera}/frame_{frame:06}.png"));
            let mut picture = image::open(&path).unwrap().into_luma8();
            picture.pixels_mut().for_each(|pixel| pixel[0] = 255 - pixel[0]);
            images::write_png(&path, &picture.into()).unwrap();
        }
    };
    let mut text = TAKE.to_owned();
    for camera in ["front", "side"] {
        let plate = format!("background = \"{camera}/plate.png\"");
        text = text.replace(&plate, &format!("masks = \"../masks/{camera}/frame_%06d.png\""));
        inverted(camera);
    }
    scene.write("wave/take.toml", &text);
    let said = ["the silhouettes cannot be right", "camera \"front\", frame 0", "the subject covers"];
    scene.fails("track wave --out none", 1, &said);
    assert!(!scene.path("none/track.json").exists());
    scene.fails("fit wave --frame 1", 1, &["camera \"front\", frame 1", "the subject covers"]);
    inverted("side");
    scene.ok("track wave --out some");
}

#[test]
fn an_empty_frame_is_lost_and_the_track_goes_on() {
    let scene = take();
    for camera in ["front", "side"] {
        fs::copy(
            scene.path(&format!("wave/{camera}/plate.png")),
            scene.path(&format!("wave/{camera}/02.png")),
        )
        .unwrap();
    }
    let summary = scene.json("track wave --out out --json");
    assert_eq!((summary["frames"].as_u64(), summary["lost"].as_u64()), (Some(FRAMES as u64), Some(1)));
    assert_eq!(scene.read_json("out/track.json")["frames"][2]["lost"], true);
}

#[test]
fn a_picture_in_which_something_is_missing_is_an_error() {
    let scene = take();
    scene.ok("screenshot wave --frame 1 --iteration 3 --out whole.png");
    fs::write(scene.path("wave/front/02.png"), "no picture").unwrap();
    scene.fails(
        "screenshot wave --frame 2 --out torn.png",
        1,
        &["torn.png is written", "camera 1", "02.png"],
    );
    assert!(scene.path("torn.png").is_file());
}

#[test]
fn cues_are_told() {
    let scene = take();
    scene.ok("track wave --out out --cues flow,stereo");
    let track = scene.read_json("out/track.json");
    let frame = &track["frames"][FRAMES - 1];
    assert!(frame["held_by_cues"].is_object() && frame["unsure"].is_array(), "{frame}");
    scene.fails("track wave --out out --cues keypoints", 1, &["--cues keypoints", "has no keypoints"]);
    scene.fails("track wave --out out --cues touch", 2, &["keypoints, flow or stereo"]);
}

/// Stopped after some frames and gone on with, a track is the same to the byte, whatever carries the motion on.
#[test]
fn a_track_is_resumed() {
    let scene = take();
    scene.fails("track wave --out parts --resume", 1, &["--resume", "track.json", "no such file"]);
    for options in
        ["", " --motion kalman --noise 150,6,1.5", " --motion smoothed", " --motion smoothed --lag 2"]
    {
        scene.ok(&format!("track wave --out whole{options}"));
        assert!(!scene.path("whole/resume.json").exists(), "nothing is left to go on with");
        scene.ok(&format!("track wave --out parts{options} --frames 0..3"));
        let stopped = scene.read_json("parts/track.json");
        assert_eq!(stopped["frames"].as_array().unwrap().len(), 3);
        // The noise that the filter had is known: it is not estimated again, for which these are too few frames.
        let again = options.replace("--noise 150,6,1.5", "--tune");
        scene.ok(&format!("track wave --out parts{again} --resume"));
        for name in ["track.json", "poses.csv", "joints.csv", "frames.csv"] {
            let read = |folder: &str| fs::read_to_string(scene.path(&format!("{folder}/{name}"))).unwrap();
            assert_eq!(read("whole"), read("parts"), "{name}{options}");
        }
        assert!(!scene.path("parts/resume.json").exists());
        let mut summaries =
            ["whole", "parts"].map(|folder| scene.read_json(&format!("{folder}/summary.json")));
        for summary in &mut summaries {
            (summary["ms_per_frame"], summary["made"]["command"]) = (Value::Null, Value::Null);
        }
        assert_eq!(summaries[0], summaries[1], "{options}");
    }
}

#[test]
fn what_cannot_be_resumed_is_told() {
    let scene = take();
    scene.ok("track wave --out parts --frames 0..3 --motion smoothed");
    scene.fails("track wave --out parts --resume --cameras side", 1, &["front, side; expected side"]);
    scene.fails("track wave --out parts --resume --frames 1..5", 1, &["the same --frames"]);
    scene.fails("track wave --out parts --resume", 1, &["smoothed in another way", "--motion and --lag"]);
    let other_lag = "track wave --out parts --resume --motion smoothed --lag 3";
    scene.fails(other_lag, 1, &["smoothed in another way"]);
    scene.ok("track wave --out filtered --frames 0..3 --motion kalman");
    scene.fails("track wave --out filtered --resume", 1, &["--resume", "with a Kalman filter"]);
    let cued = "track wave --out filtered --resume --motion kalman --cues flow";
    scene.fails(cued, 1, &["--resume", "without cues"]);
    let resume = scene.path("filtered/resume.json");
    let text = fs::read_to_string(&resume).unwrap();
    fs::write(&resume, text.replace("\"frame\":2", "\"frame\":1")).unwrap();
    let again = "track wave --out filtered --resume --motion kalman";
    scene.fails(again, 1, &["resume.json is of frame 1; expected the last frame"]);
    fs::remove_file(&resume).unwrap();
    scene.fails(again, 1, &["--resume", "resume.json", "no such file"]);
}

/// The search of the first frame takes its time: Ctrl+C comes before a frame is done.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_track_in_order() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let scene = Scene::new();
    let mut command = scene.command(&format!("track {BUILT_IN} --search --out results"));
    let program = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
    let began = Instant::now();
    // It listens before it makes the folder.
    while !scene.path("results").is_dir() {
        assert!(began.elapsed() < Duration::from_secs(60), "the folder is not made");
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill").args(["-INT", &program.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()));
    let output = program.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("stopped by Ctrl+C"), "{said}");
    let left = fs::read_dir(scene.path("results")).unwrap().map(|file| file.unwrap().file_name());
    assert!(left.into_iter().all(|name| !name.to_string_lossy().ends_with(".part")));
}
