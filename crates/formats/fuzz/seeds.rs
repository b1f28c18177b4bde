//! Whole files that runs begin from: those of our own writers, and those in `corpus`, written by hand.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use backlit_formats::calibration::write::{self, Format};
use backlit_formats::export::resume_file::{self, Resume, WaitingFrames};
use backlit_formats::export::track_read::WrittenTrack;
use backlit_formats::export::{TrackExport, track_json};
use backlit_formats::motion::{self, Motion, MotionFormat, MotionOptions};
use backlit_formats::{model_file, pose_file, prior_file};
use backlit_tracking::body::{Parameters, Pose, builtin};
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics, Rig};
use backlit_tracking::cues::{Cue, CueMemory, LimbHold};
use backlit_tracking::filter::Belief;
use backlit_tracking::optimize::Termination;
use backlit_tracking::prior::{BodyDirection, PosePrior, PriorPart, StepStatistics, StudentComponent};
use backlit_tracking::silhouette::Overlap;
use backlit_tracking::track::{
    FilterMemory, FrameEstimate, KalmanOptions, LastFrame, LastResort, Lost, Track, TrackerMemory, UsualCost,
    WaitingFrame,
};
use glam::DVec3;
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgb, RgbImage, RgbaImage};

/// The kept files of a target that must be read, and those that were once a fault, which only must be answered.
pub(crate) fn kept(target: &str, is_found: bool) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let name_begins = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().starts_with("found-");
    paths.retain(|path| name_begins(path) == is_found);
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

pub(crate) fn models() -> Vec<Vec<u8>> {
    let bodies = [builtin::single_limb(), builtin::upper_body(), builtin::full_body()];
    bodies.iter().map(|model| model_file::to_text(model).into_bytes()).chain(kept("model", false)).collect()
}

fn turned(step: f64) -> Pose {
    let model = builtin::upper_body();
    let steps: Vec<f64> = (0..27).map(|i| (f64::from(i) * 1.7 + step).sin()).collect();
    Pose::rest(&model).retract(Parameters::Tangent, &steps)
}

pub(crate) fn poses() -> Vec<Vec<u8>> {
    let model = builtin::upper_body();
    [Pose::rest(&model), turned(0.0)]
        .iter()
        .map(|pose| pose_file::to_text(&model, pose).into_bytes())
        .collect()
}

/// A rig that every format of cameras can hold, but for its lens.
pub(crate) fn rig(lens: Distortion) -> Rig {
    let camera = |name, place| {
        let intrinsics = Intrinsics { fx: 9.0, fy: 9.5, cx: 3.5, cy: 2.5 };
        Camera::new(name, [8, 6], intrinsics, lens, place).unwrap()
    };
    let here = CameraFromWorld { rotation: glam::DMat3::IDENTITY, translation: DVec3::ZERO };
    let there = CameraFromWorld::looking_at(DVec3::new(2.0, 0.5, 1.0), DVec3::Y, DVec3::Z);
    Rig::new(vec![camera("cam0", here), camera("cam1", there)]).unwrap()
}

/// The formats that cameras are written in, of the lenses that they can hold.
fn calibrations(formats: &[Format]) -> Vec<Vec<u8>> {
    let lenses = [
        Distortion::None,
        Distortion::OpenCv { k1: 0.1, k2: -0.02, p1: 1e-3, p2: 0.0, k3: 0.0 },
        Distortion::Fisheye { k1: 0.1, k2: 0.0, k3: 0.0, k4: 1e-3 },
    ];
    let texts = lenses.iter().flat_map(|lens| {
        formats.iter().filter_map(|format| write::to_text(&rig(*lens), *format).ok()).flatten()
    });
    texts.map(String::into_bytes).collect()
}

pub(crate) fn own_cameras() -> Vec<Vec<u8>> {
    calibrations(&[Format::Backlit])
}

pub(crate) fn calibration_json() -> Vec<Vec<u8>> {
    let mut all = calibrations(&[Format::OpenCvJson, Format::Matrices, Format::Transforms]);
    all.extend(kept("calibration_json", false));
    all
}

pub(crate) fn calibration_yaml() -> Vec<Vec<u8>> {
    [calibrations(&[Format::OpenCvYaml, Format::Kalibr]), kept("calibration_yaml", false)].concat()
}

pub(crate) fn calibration_xml() -> Vec<Vec<u8>> {
    [calibrations(&[Format::OpenCvXml]), kept("calibration_xml", false)].concat()
}

pub(crate) fn calibration_toml() -> Vec<Vec<u8>> {
    [calibrations(&[Format::Pose2Sim, Format::Anipose]), kept("calibration_toml", false)].concat()
}

/// `intri.yml`; the places are `extri`.
pub(crate) fn easymocap() -> Vec<Vec<u8>> {
    write::to_text(&rig(Distortion::None), Format::EasyMocap)
        .unwrap()
        .drain(..1)
        .map(String::into_bytes)
        .collect()
}

pub(crate) fn extri() -> Vec<u8> {
    write::to_text(&rig(Distortion::None), Format::EasyMocap).unwrap().remove(1).into_bytes()
}

/// The instructions of one array of numbers, as Python writes them.
fn pickled(key: &str, shape: &[u8], code: &str, numbers: &[u8]) -> Vec<u8> {
    let mut out = vec![0x8c, key.len() as u8];
    out.extend(key.as_bytes());
    out.extend(b"cnumpy.core.multiarray\n_reconstruct\ncnumpy\nndarray\nK\x00\x85C\x01b\x87R(K\x01(");
    shape.iter().for_each(|side| out.extend([b'K', *side]));
    out.extend(b"tcnumpy\ndtype\nX\x02\x00\x00\x00");
    out.extend(code.as_bytes());
    out.extend(b"\x89\x88\x87R(K\x03X\x01\x00\x00\x00<NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tb\x89C");
    out.push(numbers.len() as u8);
    out.extend(numbers);
    out.extend(b"tb");
    out
}

pub(crate) fn pickles() -> Vec<Vec<u8>> {
    let floats =
        |numbers: &[f64]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let whole = |numbers: &[i32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let mut out = b"\x80\x04}(".to_vec();
    out.extend(pickled(
        "intrinsicMat",
        &[3, 3],
        "f8",
        &floats(&[900.0, 0.0, 360.5, 0.0, 901.0, 640.0, 0.0, 0.0, 1.0]),
    ));
    out.extend(pickled("distortion", &[1, 5], "f8", &floats(&[0.1, -0.2, 1e-3, 2e-3, 0.3])));
    out.extend(pickled("imageSize", &[2, 1], "i4", &whole(&[1280, 720])));
    out.extend(pickled("rotation", &[3, 3], "f8", &floats(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])));
    out.extend(pickled("translation", &[3, 1], "f8", &floats(&[100.0, 200.0, 3000.0])));
    out.extend(b"u.");
    vec![out]
}

/// A track as it is written.
pub(crate) fn track_text(written: &WrittenTrack) -> String {
    let cameras: Vec<&str> = written.cameras.iter().map(String::as_str).collect();
    track_json::to_text(&TrackExport {
        name: &written.name,
        frame_rate: written.frame_rate,
        model: &written.model,
        cameras: &cameras,
        track: &written.track,
    })
}

pub(crate) fn tracks() -> Vec<Vec<u8>> {
    let good = FrameEstimate {
        cost: Some(1234.5),
        rms: Some(20.25),
        overlap: vec![Some(Overlap { agreement: 90, missing: 10, spurious: 12 }), None],
        empty_cameras: vec!["right".to_owned()],
        iterations: 7,
        termination: Some(Termination::StepLimit { steps: 7 }),
        ..FrameEstimate::of_pose(3, turned(0.0))
    };
    let held = LimbHold { limb: 0, cameras: 1, by_silhouettes: false, cues: vec![Cue::Flow] };
    let lost = FrameEstimate {
        lost_because: Some(Lost::Cost { ratio: 1.5 }),
        holds: vec![held],
        ..FrameEstimate::of_pose(4, turned(0.1))
    };
    let written = WrittenTrack {
        name: "walk".to_owned(),
        model: builtin::upper_body(),
        frame_rate: 25.0,
        cameras: vec!["left".to_owned(), "right".to_owned()],
        track: Track { frames: BTreeMap::from([(3, good), (4, lost)]) },
    };
    vec![track_text(&written).into_bytes()]
}

/// What is left of a track to go on from: by velocity, and smoothed.
pub(crate) fn resumes() -> Vec<Vec<u8>> {
    let belief = || Belief::from_numbers(vec![0.1; 6], (0..144).map(f64::from).collect()).unwrap();
    let pose = Pose::rest(&builtin::single_limb());
    let plain = TrackerMemory {
        last: LastFrame { frame: 7, pose: pose.clone(), lost: false, velocity: Some(vec![0.25; 6]) },
        usual: UsualCost { last: [20.25, 21.5].into(), too_high: 1 },
        last_resort: LastResort { wait: 1, waited: 2 },
        has_start: true,
        filter: None,
        cues: Some(CueMemory { offsets: vec![[0.5; 12]], before: Some(pose.clone()) }),
    };
    let filter = FilterMemory { noise: KalmanOptions::default(), pose: pose.clone(), belief: belief() };
    let filtered = TrackerMemory { filter: Some(filter), cues: None, ..plain.clone() };
    let waiting = |frame, belief| WaitingFrame { frame, pose: pose.clone(), belief, goes_on: true };
    let frames = vec![waiting(6, Some(belief())), waiting(7, None)];
    let smoothing = Some(WaitingFrames { lag: Some(3), frames });
    [Resume { memory: plain, smoothing: None }, Resume { memory: filtered, smoothing }]
        .iter()
        .map(|resume| resume_file::to_text(resume).into_bytes())
        .collect()
}

/// A body's motion as BVH, as we write it, and one written by hand.
pub(crate) fn motions() -> Vec<Vec<u8>> {
    let model = builtin::full_body();
    let poses = BTreeMap::from([(0, Pose::rest(&model)), (1, Pose::rest(&model))]);
    let motion = Motion { name: "rest".to_owned(), model, frame_rate: 25.0, poses };
    let ours = motion::to_bytes(MotionFormat::Bvh, &motion, &MotionOptions::default()).unwrap();
    [vec![ours], kept("bvh", false)].concat()
}

pub(crate) fn priors() -> Vec<Vec<u8>> {
    let lower = |diagonal: f64| -> Vec<f64> {
        (0..6).flat_map(|i| (0..=i).map(move |j| if i == j { diagonal } else { 0.0 })).collect()
    };
    let component = |y: f64| StudentComponent {
        share: 0.5,
        mean: vec![0.0, y, -0.8, 0.1, 0.7, -0.2],
        covariance: lower(0.04),
    };
    let step = StepStatistics { seconds: 0.0625, exponent: 1.5, covariance: lower(0.01) };
    let directions = vec![BodyDirection::RightThigh, BodyDirection::RightCalf];
    let part = PriorPart::new("right leg", directions, vec![component(0.1), component(0.4)], step, 4.0);
    let prior = PosePrior::new("a test", vec![part.unwrap()]).unwrap();
    vec![prior_file::to_text(&prior).unwrap().into_bytes()]
}

/// A small picture.
pub(crate) fn picture(format: ImageFormat) -> Vec<u8> {
    encoded(RgbImage::from_fn(8, 6, |x, y| Rgb([x as u8 * 30, y as u8 * 40, 9])).into(), format)
}

fn encoded(picture: DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

pub(crate) fn png() -> Vec<Vec<u8>> {
    vec![picture(ImageFormat::Png), masks().remove(0), encoded(RgbaImage::new(5, 3).into(), ImageFormat::Png)]
}

pub(crate) fn jpeg() -> Vec<Vec<u8>> {
    vec![picture(ImageFormat::Jpeg), encoded(GrayImage::new(17, 9).into(), ImageFormat::Jpeg)]
}

pub(crate) fn tiff() -> Vec<Vec<u8>> {
    vec![picture(ImageFormat::Tiff)]
}

pub(crate) fn webp() -> Vec<Vec<u8>> {
    vec![picture(ImageFormat::WebP)]
}

pub(crate) fn bmp() -> Vec<Vec<u8>> {
    vec![picture(ImageFormat::Bmp)]
}

/// Masks: grey levels, 0 and 1, two people's ids, 16 bits, with transparent pixels, and one reduced already.
pub(crate) fn masks() -> Vec<Vec<u8>> {
    let grey = |levels: [u8; 2]| GrayImage::from_fn(8, 6, |x, _| Luma([levels[usize::from(x > 3)]]));
    let deep = image::ImageBuffer::<Luma<u16>, Vec<u16>>::from_fn(8, 6, |x, _| Luma([x as u16 * 9000]));
    let clear = RgbaImage::from_fn(8, 6, |x, y| image::Rgba([9, 9, 9, (x * y * 7) as u8]));
    let all: [DynamicImage; 6] = [
        grey([0, 255]).into(),
        grey([0, 1]).into(),
        grey([0, 128]).into(),
        deep.into(),
        clear.into(),
        GrayImage::from_pixel(4, 3, Luma([255])).into(),
    ];
    all.into_iter().map(|mask| encoded(mask, ImageFormat::Png)).collect()
}
