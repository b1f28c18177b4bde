//! `backlit recognise`: motions by name.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use backlit_formats::atomic;
use backlit_formats::motion::{self, JointTrack, Motion};
use backlit_recognition::augment::TrackerNoise;
use backlit_recognition::{
    Evaluation, JointMotion, LearnOptions, LeftOut, NamedMotion, Recognition, Recognizer, confusion_picture,
    evaluate, leave_out,
};
use backlit_runs::motions::{joint_motion, read_recognizer};
use clap::Args;
use glam::DVec3;
use indicatif::ProgressBar;
use serde_json::{Value, json};

use super::export::direction;
use super::table::Table;
use crate::numbers::within;
use crate::{output, track_files};

const AFTER_HELP: &str = "\
Names motions by what the joints do over time: in tracks of `backlit track`, in BVH files with the joint names \
of the CMU recordings, or in those that `backlit export` writes of the full body with its own names. Without --model it knows walking, running, jumping, boxing, dancing, gesturing, \
sitting and bending, from 72 recordings of the CMU motion capture database (mocap.cs.cmu.edu). A folder to \
learn from or to test on holds tracks or BVH files and a labels.csv with the columns file, class, subject \
and description.

Examples:
  backlit recognise results/track.json
  backlit recognise --train motions --out model.json
  backlit recognise --model model.json --test others --json
  backlit recognise --test motions --leave-subjects-out --confusion confusion.svg";

/// What `backlit recognise` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct RecogniseArguments {
    /// Tracks to name: track.json or its folder, or BVH files
    #[arg(value_name = "TRACK", required_unless_present_any = ["train", "test"], conflicts_with_all = ["train", "test"])]
    tracks: Vec<PathBuf>,
    /// Learn from the motions of this folder
    #[arg(long, value_name = "DIR", requires = "out", conflicts_with = "test")]
    train: Option<PathBuf>,
    /// File to write what was learnt to
    #[arg(long, value_name = "MODEL", requires = "train")]
    out: Option<PathBuf>,
    /// Leave single windows of the training motions out of the file; nearest neighbours then cannot be used
    #[arg(long, requires = "train")]
    statistics_only: bool,
    /// What was learnt [default: what comes with the program]
    #[arg(long, value_name = "MODEL", conflicts_with = "train")]
    model: Option<PathBuf>,
    /// Count how often the names of this folder's motions are right
    #[arg(long, value_name = "DIR")]
    test: Option<PathBuf>,
    /// With --test: name each subject's motions by what is learnt from all others'
    #[arg(long, requires = "test", conflicts_with = "model")]
    leave_subjects_out: bool,
    /// With --leave-subjects-out: of a class that would keep fewer than 4 motions only the recording that is named is left out
    #[arg(long, requires = "leave_subjects_out")]
    keep_classes: bool,
    /// With --test: name each class's motions by what is learnt from other people's of other classes: how often an unknown
    /// kind of motion is said to be unknown
    #[arg(long, requires = "test", conflicts_with_all = ["model", "leave_subjects_out"])]
    leave_classes_out: bool,
    /// With --test: add the noise of a tracker to the joints, this many millimetres (root mean square) [0 to 1000]
    #[arg(long, value_name = "MM", requires = "test", value_parser = within(0.0..=1000.0_f64))]
    noise: Option<f64>,
    /// With --test: draw the confusion matrix
    #[arg(long, value_name = "FILE.svg", requires = "test")]
    confusion: Option<PathBuf>,
    /// Body of the tracks: a built-in name or a body file [default: the body.toml beside a track, else the
    /// built-in body that it names]
    #[arg(long, value_name = "BODY")]
    body: Option<String>,
    /// Which way is up in the tracks' world: x, y, z, -x, -y, -z, or three numbers with commas between; BVH is y up
    #[arg(long, value_name = "AXIS", default_value = "z", allow_hyphen_values = true, value_parser = direction)]
    up: DVec3,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

/// Learns, tests or names.
///
/// # Errors
/// A file that cannot be read or written, or joints that are no motion.
pub(crate) fn run(arguments: &RecogniseArguments) -> anyhow::Result<()> {
    match (&arguments.train, &arguments.out, &arguments.test) {
        (Some(folder), Some(out), _) => train(folder, out, arguments),
        (_, _, Some(folder)) => test(folder, arguments),
        _ => name(arguments),
    }
}

impl RecogniseArguments {
    fn read(&self, path: &Path) -> anyhow::Result<JointMotion> {
        let is_bvh = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("bvh"));
        let track = match is_bvh {
            true => motion::read_joints(path, None)?,
            false => {
                JointTrack::of_motion(&Motion::of_written(track_files::read(path, self.body.as_deref())?))
            }
        };
        joint_motion(&track, &track.frames, self.up).with_context(|| path.display().to_string())
    }

    /// The motions of a folder and what its labels.csv calls them.
    fn folder(&self, folder: &Path) -> anyhow::Result<Vec<NamedMotion>> {
        let table = folder.join("labels.csv");
        let labels = motion::read_labels(&table)?;
        if labels.is_empty() {
            bail!("{}: has no row; expected a motion at least", table.display());
        }
        let read = |label: motion::MotionLabel| -> anyhow::Result<NamedMotion> {
            let motion = self.read(&folder.join(&label.file))?;
            Ok(NamedMotion { name: label.file, class: label.class, subject: label.subject, motion })
        };
        labels.into_iter().map(read).collect()
    }
}

fn train(folder: &Path, out: &Path, arguments: &RecogniseArguments) -> anyhow::Result<()> {
    output::check_folder_of(out)?;
    let motions = arguments.folder(folder)?;
    let mut recognizer = Recognizer::learn(&motions, &LearnOptions::default())
        .with_context(|| folder.display().to_string())?;
    if arguments.statistics_only {
        recognizer.exemplars = None;
    }
    atomic::write(out, recognizer.to_text().as_bytes())?;
    let classes = recognizer.classes.join(", ");
    output::print(&format!("learnt {classes} from {} motions; wrote {}\n", motions.len(), out.display()))
}

fn test(folder: &Path, arguments: &RecogniseArguments) -> anyhow::Result<()> {
    if let Some(picture) = &arguments.confusion {
        output::check_folder_of(picture)?;
    }
    let motions = arguments.folder(folder)?;
    // Along each of three axes; half of the variance is smooth in time.
    let noise = arguments.noise.map(|mm| TrackerNoise {
        deviation: mm / 1000.0 / 3.0_f64.sqrt(),
        smooth: 0.5,
        memory_s: 0.25,
    });
    let left_out = match arguments {
        RecogniseArguments { keep_classes: true, .. } => Some(LeftOut::SubjectsKeepingClasses),
        RecogniseArguments { leave_subjects_out: true, .. } => Some(LeftOut::Subjects),
        RecogniseArguments { leave_classes_out: true, .. } => Some(LeftOut::Classes),
        _ => None,
    };
    let evaluation = if let Some(left_out) = left_out {
        let bar = ProgressBar::new(1);
        let found = leave_out(left_out, &motions, &LearnOptions::default(), noise, |done, total| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        });
        bar.finish_and_clear();
        found
    } else {
        let recognizer = read_recognizer(arguments.model.as_deref())?;
        evaluate(&recognizer, &motions, noise)
    };
    let evaluation = evaluation.with_context(|| folder.display().to_string())?;
    if let Some(picture) = &arguments.confusion {
        atomic::write(picture, confusion_picture::to_svg(&evaluation.confusion).as_bytes())?;
    }
    if arguments.json {
        return output::print_json(&evaluation_json(&evaluation));
    }
    output::print(&match left_out {
        Some(LeftOut::Classes) => unknown_text(&evaluation),
        _ => evaluation_text(&evaluation),
    })
}

fn evaluation_json(evaluation: &Evaluation) -> Value {
    let mut out = json!({
        "confusion": evaluation.confusion,
        "spread": {
            "clips": evaluation.spread[0],
            "windows": evaluation.spread[1],
            "in_context": evaluation.spread[2],
        },
        "unknown": evaluation.unknown,
        "clips": evaluation.clips,
    });
    for (method, score) in &evaluation.methods {
        out[*method] = json!(score);
    }
    out
}

fn evaluation_text(evaluation: &Evaluation) -> String {
    let mut table = Table::new(["method", "clips", "windows", "in context", "joined"]);
    for (method, score) in &evaluation.methods {
        let parts = [score.clips, score.windows, score.in_context, score.joined];
        let [clips, windows, in_context, joined] = parts.map(|part| format!("{part:.3}"));
        table.row([(*method).to_owned(), clips, windows, in_context, joined]);
    }
    let [clips, windows, in_context] = evaluation.spread.map(|part| format!("±{part:.3}"));
    table.row(["with other people".to_owned(), clips, windows, in_context, String::new()]);
    let mut out = table.to_text();
    for clip in evaluation.clips.iter().filter(|clip| clip.class != clip.found) {
        let (name, class, found) = (&clip.name, &clip.class, &clip.found);
        out += &format!("{name}: {class}, was called {found} ({:.2})\n", clip.confidence);
    }
    out + &unknown_line(evaluation)
}

/// Of thresholds of strangeness, the one that is used among them.
const THRESHOLDS: [f64; 7] = [0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.5];

/// Which part of the clips is said to be unknown, and would be with other thresholds.
fn unknown_line(evaluation: &Evaluation) -> String {
    let at = |threshold: f64| {
        let found = evaluation.clips.iter().filter(|clip| clip.strangeness > threshold).count();
        format!("{threshold}: {:.3}", found as f64 / evaluation.clips.len().max(1) as f64)
    };
    let others = THRESHOLDS.map(at).join(", ");
    format!(
        "said to be unknown: {:.3} of the clips; at so many times the threshold {others}\n",
        evaluation.unknown
    )
}

/// How often clips of a class that was not learnt are said to be unknown, class by class.
fn unknown_text(evaluation: &Evaluation) -> String {
    let mut table = Table::new(["class that was not learnt", "clips", "said to be unknown"]);
    for class in &evaluation.confusion.classes {
        let own = || evaluation.clips.iter().filter(|clip| clip.class == *class);
        let unknown = own().filter(|clip| clip.unknown).count();
        table.row([class.clone(), own().count().to_string(), unknown.to_string()]);
    }
    table.to_text() + &unknown_line(evaluation)
}

fn name(arguments: &RecogniseArguments) -> anyhow::Result<()> {
    let recognizer = read_recognizer(arguments.model.as_deref())?;
    let mut all = Vec::new();
    for path in &arguments.tracks {
        let motion = arguments.read(path)?;
        let found = recognizer.recognise(&motion).with_context(|| path.display().to_string())?;
        all.push((path, found));
    }
    if arguments.json {
        let tracks: Vec<Value> = all.iter().map(|(path, found)| recognition_json(path, found)).collect();
        return output::print_json(&json!({ "tracks": tracks }));
    }
    let mut out = String::new();
    for (path, found) in &all {
        if all.len() > 1 {
            out += &format!("{}\n", path.display());
        }
        let mut table = Table::new(["from, s", "to, s", "frames", "motion", "confidence"]);
        for stretch in &found.stretches {
            let [from, to] = stretch.seconds.map(|seconds| format!("{seconds:.2}"));
            let frames = format!("{}–{}", stretch.frames.start(), stretch.frames.end());
            table.row([from, to, frames, class(found, stretch.class), format!("{:.2}", stretch.confidence)]);
        }
        out += &table.to_text();
    }
    output::print(&out)
}

fn class(found: &Recognition, class: Option<usize>) -> String {
    class.map_or("unknown", |class| &found.classes[class]).to_owned()
}

fn recognition_json(path: &Path, found: &Recognition) -> Value {
    let stretches = found.stretches.iter().map(|stretch| {
        json!({
            "class": class(found, stretch.class),
            "first_frame": stretch.frames.start(),
            "last_frame": stretch.frames.end(),
            "seconds": stretch.seconds,
            "confidence": stretch.confidence,
        })
    });
    let frames = found.frames.iter().map(|frame| {
        json!({
            "frame": frame.frame,
            "class": class(found, frame.class),
            "confidence": frame.confidence,
            "shares": frame.shares,
            "place": frame.place,
        })
    });
    json!({
        "track": path.display().to_string(),
        "stretches": stretches.collect::<Vec<_>>(),
        "frames": frames.collect::<Vec<_>>(),
    })
}
