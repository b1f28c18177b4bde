//! `backlit compare`: a track beside recordings of other tools, truth, or other tracks.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::ensure;
use backlit_formats::atomic::{self, Fill};
use backlit_formats::recording::{self, RecordingOptions};
use backlit_runs::comparison::{
    ANGLE_TITLES, CameraOverlap, ComparedOverlap, ComparedReference, Figure, angle_figures, clock_words,
    compare_motion, compare_overlap, error_figures, error_titles, read_reference, to_json, world_words,
};
use backlit_runs::results::{self, TrackedMotion, read_tracked};
use backlit_tracking::metrics::comparison::{ComparisonOptions, TrackComparison};
use clap::Args;
use serde_json::{Value, json};

use super::interrupt::{self, Interrupted};
use super::numbers::within;
use super::output::{self, number};
use super::table::Table;
use super::take_options::{self, FrameSpan};

const AFTER_HELP: &str = "\
References are recordings (trc, c3d, bvh, mot, csv, npz), results of backlit track, or projects. Their clock, axes and \
unit are found from the motion, and told. Errors are millimetres: raw; placed, without where the tool puts its markers; \
root-aligned, without the place of the hips; Procrustes, without place, turn and size of each frame; PCK, the share of \
joints within a distance. Angles are degrees of flexion.

Writes to the folder of --out:
  comparison.json  all figures
  errors.csv       errors of every frame and joint
  angles.csv       both curves of every angle

Examples:
  backlit compare results reference.trc --take TAKE
  backlit compare results other_results truth.bvh markers.c3d --out compared
  backlit compare results points.csv --frame-rate 60 --joint knee_r=\"right knee\"";

/// What `backlit compare` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct CompareArguments {
    /// Track: the track.json that `backlit track` wrote, or its folder; or a project, NAME.backlit
    #[arg(value_name = "TRACK|PROJECT")]
    track: PathBuf,
    /// What it is compared with, one or several
    #[arg(value_name = "REFERENCE", required = true)]
    references: Vec<PathBuf>,
    /// Frames: A..B, A.., ..B, A..=B or one frame [default: all]
    #[arg(long, value_name = "FRAMES")]
    frames: Option<FrameSpan>,
    /// Seconds that the references are late, where it is known [-1000000 to 1000000] [default: found from the motion]
    #[arg(long, value_name = "SECONDS", value_parser = within(-1e6..=1e6))]
    offset: Option<f64>,
    /// Largest offset that is looked for, seconds [0 to 600]
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = within(0.0..=600.0))]
    most_offset: f64,
    /// The references have the take's own axes and metres: nothing is fitted
    #[arg(long)]
    same_world: bool,
    /// Frames a second of references that do not say it [0.01 to 100000]
    #[arg(long, value_name = "HZ", value_parser = within(0.01..=100_000.0))]
    frame_rate: Option<f64>,
    /// A joint that has another name in the references: NAME=JOINT, JOINT as `right knee`; may be given several times
    #[arg(long, value_name = "NAME=JOINT", value_parser = joint)]
    joint: Vec<(String, String)>,
    /// Body of the track: a built-in name or a body file [default: the body.toml beside the track, else the built-in
    /// body that the track names]
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Take that was tracked: track and references are laid over its silhouettes, in 30 frames
    #[arg(long, value_name = "TAKE")]
    take: Option<PathBuf>,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

/// A reference with what was found.
struct Compared {
    reference: ComparedReference,
    found: TrackComparison,
    overlap: Option<ComparedOverlap>,
}

impl Compared {
    fn to_json(&self) -> Value {
        to_json(&self.reference, &self.found, self.overlap.as_ref())
    }
}

pub(crate) fn run(arguments: &CompareArguments) -> anyhow::Result<()> {
    let mut tracked = read_tracked(&arguments.track, arguments.model.as_deref())?;
    if let Some(FrameSpan { first, past }) = arguments.frames {
        tracked.motion.poses.retain(|frame, _| *frame >= first && past.is_none_or(|past| *frame < past));
        ensure!(!tracked.motion.poses.is_empty(), "--frames: the track has none of these frames");
    }
    let reading =
        RecordingOptions { frame_rate: arguments.frame_rate, joints: arguments.joint.clone(), model: None };
    let options = ComparisonOptions {
        offset_s: arguments.offset,
        most_offset_s: arguments.most_offset,
        same_world: arguments.same_world,
    };
    let footage = arguments.take.as_deref().map(take_options::open).transpose()?;
    let cancel = interrupt::listen()?;
    let mut all = Vec::new();
    for path in &arguments.references {
        let reference = read_reference(path, &reading)?;
        let found = compare_motion(&tracked.motion, &reference, &options);
        ensure!(
            found.overall.is_some() || !found.angles.is_empty(),
            "{}: it has no joint and no angle in common with the track at the same time; see --offset and --most-offset",
            path.display()
        );
        let overlap = footage.as_ref().and_then(|footage| {
            compare_overlap(
                &tracked.motion,
                (&reference, &found),
                footage,
                footage.take().measurement(),
                &cancel,
            )
        });
        if cancel.is_cancelled() {
            return Err(Interrupted.into());
        }
        all.push(Compared { reference, found, overlap });
    }
    if let Some(out) = &arguments.out {
        write(out, &all)?;
    }
    if arguments.json {
        let values: Vec<_> = all.iter().map(Compared::to_json).collect();
        output::print_json(&json!({"overlap": tracked.overlap, "references": values}))
    } else {
        output::print(&text(&results::path_in(&arguments.track), &tracked, &all))
    }
}

/// Reads NAME=JOINT.
fn joint(text: &str) -> Result<(String, String), &'static str> {
    let expected = "expected NAME=JOINT, as r_knee=\"right knee\"; joints are left or right shoulder, elbow, wrist, hip, knee or ankle";
    let (name, joint) = text.split_once('=').ok_or(expected)?;
    let joint = recording::anatomical_name(joint).filter(|_| !name.is_empty()).ok_or(expected)?;
    Ok((name.to_owned(), joint))
}

/// One row of a table: a name and figures.
fn row<const N: usize>(name: &str, figures: &[Figure; N]) -> Vec<String> {
    let cells = figures.iter().map(|(value, digits)| number(*value, *digits));
    std::iter::once(name.to_owned()).chain(cells).collect()
}

/// A table with these titles behind the first.
fn table<T: AsRef<str>>(first: &str, titles: &[T], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let titles = titles.iter().map(|title| title.as_ref().to_owned());
    Table::of_rows(std::iter::once(first.to_owned()).chain(titles).collect(), rows).to_text()
}

fn text(track: &Path, tracked: &TrackedMotion, all: &[Compared]) -> String {
    let mut out = String::new();
    for Compared { reference, found, overlap } in all {
        let _ = writeln!(out, "{} beside {}", track.display(), reference.name);
        let (frames, joints) = (found.frames.len(), found.joints.len());
        let _ = writeln!(out, "  {frames} frames, {joints} joints, {} angles", found.angles.len());
        let _ = writeln!(out, "  clocks: {}", clock_words(found.clock));
        if !found.joints.is_empty() {
            let _ = writeln!(out, "  axes: {}", world_words(&found.world));
        }
        if let Some(overall) = &found.overall {
            let rows = found.by_joint.iter().map(|(joint, errors)| row(joint, &error_figures(errors)));
            let rows = rows.chain([row("all joints", &error_figures(overall))]);
            let _ = write!(out, "\n{}", table("joint error, mm", &error_titles(), rows));
        }
        if !found.angles.is_empty() {
            let _ = write!(out, "\n{}", angle_table(found));
        }
        if found.angles.iter().any(|angle| angle.is_turned) {
            out.push_str("* the reference counts the other way round, and was turned\n");
        }
        out.push_str(&match overlap {
            Some(measured) => measured_text(measured),
            None => overlap_text(tracked, reference),
        });
        out.push('\n');
    }
    if all.len() > 1 && all.iter().any(|compared| compared.found.overall.is_some()) {
        let rows = all.iter().filter_map(|Compared { reference, found, .. }| {
            Some(row(&reference.name, &error_figures(found.overall.as_ref()?)))
        });
        out.push_str(&table("all joints, mm", &error_titles(), rows));
    }
    out.trim_end().to_owned() + "\n"
}

fn angle_table(found: &TrackComparison) -> String {
    let rows = found.angles.iter().map(|angle| {
        let name = format!("{}{}", angle.angle.label(), if angle.is_turned { " *" } else { "" });
        row(&name, &angle_figures(angle))
    });
    table("angle, °", &ANGLE_TITLES, rows)
}

/// Measured overlap by camera.
fn measured_text(ComparedOverlap { frames, cameras }: &ComparedOverlap) -> String {
    let mut table = Table::new(["overlap (IoU)", "track", "reference"]);
    for CameraOverlap { camera, track, reference } in cameras {
        table.row([camera.clone(), number(Some(*track), 3), number(Some(*reference), 3)]);
    }
    format!("\nBodies over silhouettes, mean of {frames} frames:\n{}", table.to_text())
}

/// Overlap by camera as it was tracked, of both where the reference is a track.
fn overlap_text(tracked: &TrackedMotion, reference: &ComparedReference) -> String {
    if tracked.overlap.is_empty() {
        return String::new();
    }
    let mut table = Table::new(["overlap (IoU)", "track", "reference"]);
    for (camera, iou) in &tracked.overlap {
        let theirs = reference.overlap.get(camera).copied();
        table.row([camera.clone(), number(*iou, 3), number(theirs, 3)]);
    }
    format!("\n{}", table.to_text())
}

/// Writes all files: all of them, or none.
fn write(out: &Path, all: &[Compared]) -> anyhow::Result<()> {
    output::make_folder(out)?;
    let values: Vec<_> = all.iter().map(Compared::to_json).collect();
    let json = serde_json::to_string_pretty(&values)? + "\n";
    let mut errors = csv::Writer::from_writer(Vec::new());
    errors.write_record(["reference", "frame", "joint", "raw_mm", "root_aligned_mm", "procrustes_mm"])?;
    let mut angles = csv::Writer::from_writer(Vec::new());
    angles.write_record(["reference", "frame", "angle", "track_degrees", "reference_degrees"])?;
    let cell = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for Compared { reference, found, .. } in all {
        for frame in &found.frames {
            for (index, joint) in found.joints.iter().enumerate() {
                let numbers =
                    [frame.raw[index], frame.root_aligned[index], frame.procrustes[index]].map(cell);
                errors.write_record(
                    [&reference.name, &frame.frame.to_string(), joint].into_iter().chain(&numbers),
                )?;
            }
        }
        for angle in &found.angles {
            for (frame, pair) in found.numbers.iter().zip(&angle.curves) {
                let (frame, pair) = (frame.to_string(), pair.map(cell));
                let name = angle.angle.label().to_owned();
                angles.write_record([&reference.name, &frame, &name].into_iter().chain(&pair))?;
            }
        }
    }
    let [errors, angles] = [errors.into_inner()?, angles.into_inner()?];
    let files = [("comparison.json", json.as_bytes()), ("errors.csv", &errors), ("angles.csv", &angles)];
    let fill = |(name, bytes)| -> (&str, Fill<'_>) { (name, Box::new(move |file| file.write_all(bytes))) };
    Ok(atomic::write_all(out, files.into_iter().map(fill).collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_named_by_side_and_place() {
        assert_eq!(joint("r_knee=right_knee"), Ok(("r_knee".to_owned(), "right knee".to_owned())));
        for bad in ["knee", "=left knee", "a=knee", "a=left nose"] {
            assert!(joint(bad).is_err(), "{bad}");
        }
    }
}
