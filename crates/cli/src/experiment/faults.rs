//! Calibrations with one known fault, and what the check of the cameras says of them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result};
use backlit_formats::Footage;
use backlit_formats::calibration::{self, CalibrationOptions};
use backlit_formats::keypoints::joints::LOWEST_SCORE;
use backlit_formats::synchronise::record;
use backlit_lab::experiment::calibration_faults::{Fault, FilmedPerson};
use backlit_tracking::body::builtin;
use backlit_tracking::camera::{Camera, Distortion};
use backlit_tracking::diagnosis::{DiagnosisOptions, FaultKind, Finding, diagnose};
use backlit_tracking::statistics::upper_median;
use backlit_tracking::synchronise::Recording;
use clap::Args;
use glam::DVec2;
use serde::Serialize;

use super::{Experiment, Run};
use crate::numbers::within;
use crate::output::number;

/// Calibrations with one known fault, found by the silhouettes of a person
#[derive(Debug, Args, Serialize)]
pub(crate) struct CalibrationFaults {
    /// Calibrations of real rigs, before which a person is simulated, and takes; the built-in take's cameras always
    #[arg(long, value_name = "FILE", num_args = 1..)]
    calibrations: Vec<PathBuf>,
    /// Height of the pictures, pixels [120 to 2160]
    #[arg(long, value_name = "PIXELS", default_value_t = 480, value_parser = within(120..=2160_u64))]
    height: u64,
    /// Frames of the 12 seconds [20 to 1000]
    #[arg(long, value_name = "N", default_value_t = 186, value_parser = within(20..=1000_usize))]
    frames: usize,
    /// A fault is told where it explains so much more than none, nats [0 to 1000]
    #[arg(long, value_name = "NATS", default_value_t = DiagnosisOptions::default().least_evidence, value_parser = within(0.0..=1e3_f64))]
    least_evidence: f64,
    /// Keypoints of the simulated person are off by so much, pixels; there are none without it [0.1 to 100]
    #[arg(long, value_name = "PIXELS", value_parser = within(0.1..=100.0_f64))]
    keypoint_noise: Option<f64>,
    /// Keypoints of the takes: CSV of camera, frame, marker (`RKnee`), `u_WIDTH`, `v_HEIGHT`, confidence, in pictures of that size
    #[arg(long, value_name = "FILE")]
    keypoints: Option<PathBuf>,
    /// Only this kind of fault
    #[arg(long, value_name = "KIND", value_parser = clap::builder::PossibleValuesParser::new(FaultKind::ALL.map(FaultKind::name)))]
    only: Option<String>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Report {
    cases: Vec<Case>,
}

/// One fault of one rig.
#[derive(Debug, Serialize)]
struct Case {
    rig: String,
    /// `None`: nothing is wrong.
    kind: Option<&'static str>,
    camera: Option<usize>,
    size: f64,
    found: Vec<ToldFault>,
    took_s: f64,
}

#[derive(Debug, Serialize)]
struct ToldFault {
    kind: &'static str,
    camera: Option<usize>,
    with: Option<usize>,
    sizes: Vec<f64>,
    evidence: f64,
    apart_px: Option<[f64; 2]>,
    rivals: Vec<(Option<usize>, &'static str, f64)>,
}

/// Faults that are tried of every camera, with their sizes, in the kind's unit; `None` as camera: of all at once.
fn faults(cameras: &[Camera]) -> Vec<Fault> {
    use FaultKind as K;
    let mut all = Vec::new();
    for (camera, own) in cameras.iter().enumerate() {
        let seed = camera as u64;
        let with = (camera + 1) % cameras.len();
        let fault = |kind, size| Fault { kind, camera: Some(camera), with, size, seed };
        let sign = if camera % 2 == 0 { 1.0 } else { -1.0 };
        all.extend([
            fault(K::PictureTurned, 0.0),
            fault(K::PictureScaled, [2.0, 0.5][camera % 2]),
            fault(K::InvertedExtrinsics, 0.0),
            fault(K::Unit, [1000.0, 0.001][camera % 2]),
            fault(K::WorldAxes, 0.0),
            fault(K::CameraAxes, 0.0),
            fault(K::Swapped, 0.0),
            fault(K::Focal, 1.0 + 0.05 * sign),
            fault(K::PrincipalPoint, 0.04),
            fault(K::Turned, 0.5_f64.to_radians()),
            fault(K::Turned, 2.0_f64.to_radians()),
            fault(K::Shifted, 0.02),
            fault(K::Shifted, 0.1),
            fault(K::Offset, sign / 30.0),
            fault(K::Offset, 0.2 * sign),
            fault(K::Drift, 0.01 * sign),
            fault(K::FrameRate, [0.5, 1.2, 0.8][camera % 3]),
            fault(K::Bumped, 1.0_f64.to_radians()),
        ]);
        // Other lenses have no coefficients that tools write in different orders.
        if matches!(own.distortion(), Distortion::OpenCv { .. }) {
            all.push(fault(K::LensOrder, 0.0));
        }
    }
    let of_all = |kind, size| Fault { kind, camera: None, with: 0, size, seed: 0 };
    all.extend([
        of_all(K::InvertedExtrinsics, 0.0),
        of_all(K::CameraAxes, 0.0),
        of_all(K::Unit, 1000.0),
        of_all(K::Unit, 0.001),
    ]);
    all
}

/// `OpenPose`'s names of the joints of `KEYPOINT_LIMBS`.
const MARKERS: [&str; 12] = [
    "LShoulder",
    "RShoulder",
    "LElbow",
    "RElbow",
    "LWrist",
    "RWrist",
    "LHip",
    "RHip",
    "LKnee",
    "RKnee",
    "LAnkle",
    "RAnkle",
];

/// Gives recordings of all frames the keypoints of a file.
fn add_keypoints(path: &Path, footage: &Footage, recordings: &mut [Recording]) -> Result<()> {
    let mut reader = csv::Reader::from_path(path).with_context(|| path.display().to_string())?;
    let titles = reader.headers()?.clone();
    let size = |at: usize| titles.get(at)?.rsplit_once('_')?.1.parse::<f64>().ok();
    let size = size(3).zip(size(4)).with_context(|| {
        format!("{}: expected camera, frame, marker, u_WIDTH, v_HEIGHT, confidence", path.display())
    })?;
    let cameras = footage.take().rig().cameras();
    let mut pixels: Vec<Vec<[Option<DVec2>; 12]>> =
        recordings.iter().map(|recording| vec![[None; 12]; recording.frame_count()]).collect();
    for (line, row) in reader.deserialize().enumerate() {
        let row: (String, usize, String, f64, f64, f64) =
            row.with_context(|| format!("{}: line {}", path.display(), line + 2))?;
        let (name, frame, marker, u, v, confidence) = row;
        let camera = cameras.iter().position(|camera| camera.name() == name);
        let joint = MARKERS.iter().position(|own| *own == marker);
        let (Some(camera), Some(joint)) = (camera, joint) else { continue };
        let (lens, ideal) = (&cameras[camera], &footage.cameras[camera]);
        let scale = DVec2::new(lens.width() as f64 / size.0, lens.height() as f64 / size.1);
        let place = (DVec2::new(u, v) + 0.5) * scale - 0.5;
        let seen = lens.ray_in_world(place).and_then(|ray| ideal.project(ideal.centre() + ray));
        if let Some(slot) = pixels[camera].get_mut(frame) {
            slot[joint] = seen.filter(|_| confidence >= LOWEST_SCORE);
        }
    }
    for (recording, pixels) in recordings.iter_mut().zip(pixels) {
        pixels.iter().enumerate().for_each(|(frame, pixels)| recording.set_keypoints(frame, pixels));
    }
    Ok(())
}

impl Experiment for CalibrationFaults {
    const NAME: &'static str = "calibration-faults";
    type Report = Report;

    fn run(&mut self, run: &Run) -> Result<Report> {
        let model = std::sync::Arc::new(builtin::full_body());
        let mut rigs: Vec<(String, FilmedPerson)> = Vec::new();
        let studio = backlit_lab::synthetic::studio::cameras();
        rigs.push((
            "built-in".to_owned(),
            FilmedPerson::simulated(studio.cameras(), &model, self.height, self.frames, self.keypoint_noise)?,
        ));
        for path in &self.calibrations {
            let name = path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
            if path.is_dir() || path.ends_with("take.toml") {
                let footage = crate::take_options::open(path)?;
                let mut recordings = record(&footage, 1, &run.cancel, |_, _| {})?;
                if let Some(path) = &self.keypoints {
                    add_keypoints(path, &footage, &mut recordings)?;
                }
                rigs.push((name, FilmedPerson::real(footage.take().rig().cameras().to_vec(), recordings)));
                continue;
            }
            let rig = calibration::load(path, CalibrationOptions::default())?.rig;
            let person = FilmedPerson::simulated(
                rig.cameras(),
                &model,
                self.height,
                self.frames,
                self.keypoint_noise,
            )?;
            rigs.push((name, person));
        }
        let mut cases = Vec::new();
        for (at, (rig, person)) in rigs.iter().enumerate() {
            let mut all = vec![None];
            all.extend(faults(person.cameras()).into_iter().map(Some));
            if let Some(only) = &self.only {
                all.retain(|fault| fault.is_none_or(|fault| fault.kind.name() == only));
            }
            for (done, fault) in all.iter().enumerate() {
                run.progress(at * all.len() + done, rigs.len() * all.len())?;
                let (recordings, lenses) = person.with_fault(*fault)?;
                let begun = Instant::now();
                let options =
                    DiagnosisOptions { least_evidence: self.least_evidence, ..DiagnosisOptions::default() };
                let found = diagnose(&recordings, &lenses, &options, &run.cancel, |_, _| {})?;
                let one = |finding: &Finding| ToldFault {
                    kind: finding.kind.name(),
                    camera: finding.camera,
                    with: finding.with,
                    sizes: finding.sizes.iter().map(|size| size.value).collect(),
                    evidence: finding.evidence.min(1e9),
                    apart_px: finding.apart_px,
                    rivals: finding
                        .rivals
                        .iter()
                        .map(|rival| (rival.camera, rival.kind.name(), rival.behind))
                        .collect(),
                };
                cases.push(Case {
                    rig: rig.clone(),
                    kind: fault.map(|fault| fault.kind.name()),
                    camera: fault.and_then(|fault| fault.camera),
                    size: fault.map_or(0.0, |fault| fault.size),
                    found: found.findings.iter().map(one).collect(),
                    took_s: begun.elapsed().as_secs_f64(),
                });
            }
        }
        Ok(Report { cases })
    }

    fn table(&self, report: &Report) -> String {
        let mut text = "| | faults | told | right camera | right kind | right, or a rival |\n|---|---|---|---|---|---|\n".to_owned();
        for kind in std::iter::once(None).chain(FaultKind::ALL.map(|kind| Some(kind.name()))) {
            text += &row(kind.unwrap_or("nothing"), report.cases.iter().filter(|case| case.kind == kind));
        }
        let mut rigs: Vec<&str> = report.cases.iter().map(|case| case.rig.as_str()).collect();
        rigs.dedup();
        for rig in rigs {
            text += &row(rig, report.cases.iter().filter(|case| case.rig == rig && case.kind.is_some()));
        }
        let mut seconds: Vec<f64> = report.cases.iter().map(|case| case.took_s).collect();
        let median = upper_median(&mut seconds);
        text + &format!("a check took {} s (median)\n", number(median, 2))
    }
}

impl Case {
    /// What the first finding has right: that there is one, the camera, the kind, the kind among it and its rivals.
    fn right(&self) -> [bool; 4] {
        let Some(first) = self.found.first() else { return [false; 4] };
        let is_exchanged = self.kind == Some("swapped") && first.with == self.camera;
        let is_camera = first.camera == self.camera || is_exchanged;
        let is_kind = Some(first.kind) == self.kind;
        let is_rival = first.rivals.iter().any(|rival| Some(rival.1) == self.kind);
        [true, is_camera, is_kind, is_kind || is_rival]
    }
}

/// A row of the table; nothing without cases.
fn row<'a>(name: &str, cases: impl Iterator<Item = &'a Case>) -> String {
    let mut counts = [0; 5];
    for case in cases {
        counts[0] += 1;
        for (count, is_right) in counts[1..].iter_mut().zip(case.right()) {
            *count += usize::from(is_right);
        }
    }
    let [all, told, camera, kind, rival] = counts;
    if all == 0 {
        String::new()
    } else {
        format!("| {name} | {all} | {told} | {camera} | {kind} | {rival} |\n")
    }
}
