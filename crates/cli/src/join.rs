//! `backlit join`: tracks of pieces of a take that overlap, as one track.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use backlit_formats::export::track_read::WrittenTrack;
use backlit_formats::export::{self, TrackExport};
use backlit_formats::model_file;
use backlit_runs::track_summary::{Doubts, IouSummary, TrackMaking, why_doubtful};
use backlit_tracking::track::join::{Source, join};
use backlit_tracking::track::{FrameEstimate, Track};
use clap::Args;
use serde_json::{Value, json};

use super::program::Doubtful;
use super::table::Table;
use super::{output, track_files};

const AFTER_HELP: &str = "\
Each piece is the folder of a backlit track --frames of the same take and body. Where two overlap, the track changes over from the \
earlier to the later one where both poses are nearest to each other; between them nothing is made up. One piece alone is the whole. \
Writes track.json, the tables \
and summary.json to the folder of --out, as backlit track does.

Example:
  backlit track TAKE --frames 0..1100 --out a
  backlit track TAKE --frames 1000..2000 --out b
  backlit join a b --out whole";

/// What `backlit join` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct JoinArguments {
    /// Pieces: track.json files that backlit track wrote, or their folders, in any order
    #[arg(value_name = "TRACK", required = true)]
    pieces: Vec<PathBuf>,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Exit with 3 where pieces are farther apart than they may be where they meet, where a frame is lost, or a limb is doubtful in
    /// more than a tenth of the frames; the track is written all the same
    #[arg(long)]
    strict: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// Where two pieces were joined.
struct Seam {
    frame: usize,
    distance_m: f64,
    meets: bool,
}

pub(crate) fn run(arguments: &JoinArguments) -> anyhow::Result<()> {
    let mut pieces = Vec::new();
    for path in &arguments.pieces {
        let piece = track_files::read(path, None)?;
        ensure!(!piece.track.frames.is_empty(), "{}: the track has no frame", path.display());
        pieces.push((path.as_path(), piece));
    }
    pieces.sort_by_key(|(_, piece)| piece.track.frames.first_key_value().map(|(frame, _)| *frame));
    let making = track_files::making(&track_files::path_in(pieces[0].0));
    let (whole, seams) = join_all(pieces)?;
    let summary = summary(&whole, &seams, making);
    write(&arguments.out, &whole, &summary)?;
    if arguments.json {
        output::print_json(&summary)?;
    } else {
        output::print(&text(&whole, &seams))?;
    }
    let doubtful = summary["doubtful"].as_str().filter(|_| arguments.strict);
    doubtful.map_or(Ok(()), |why| Err(Doubtful(why.to_owned()).into()))
}

/// Why the whole is not to be trusted, if it is not.
fn why_whole_doubtful(
    frames: usize,
    lost: usize,
    limbs: &BTreeMap<String, Doubts>,
    seams: &[Seam],
) -> Option<String> {
    if let Some(Seam { frame, distance_m, .. }) = seams.iter().find(|seam| !seam.meets) {
        let apart = 1000.0 * distance_m;
        return Some(format!(
            "at frame {frame} the pieces are {apart:.0} mm apart: one of both has lost the body"
        ));
    }
    why_doubtful(frames, lost, limbs)
}

/// Joins pieces in the order of their first frames.
fn join_all(pieces: Vec<(&Path, WrittenTrack)>) -> anyhow::Result<(WrittenTrack, Vec<Seam>)> {
    let mut seams = Vec::new();
    let mut all = pieces.into_iter();
    let (mut before, mut whole) = all.next().context("there is no piece")?;
    for (path, piece) in all {
        let names = [before, path].map(|path| path.display().to_string());
        ensure!(piece.model == whole.model, "{} and {} are of different bodies", names[0], names[1]);
        ensure!(
            piece.frame_rate == whole.frame_rate && piece.cameras == whole.cameras,
            "{} and {} are of different takes: frame rates or cameras differ",
            names[0],
            names[1]
        );
        let tracks = [&whole.track, &piece.track];
        let found = join(&whole.model, whole.frame_rate, tracks, |_, _| None);
        let found =
            found.with_context(|| format!("{} and {} have no frame in common", names[0], names[1]))?;
        let frames = found.sources.iter().filter_map(|(frame, source)| {
            let [first, second] = tracks.map(|track| track.frames.get(frame));
            let one = match source {
                Source::Forward => first,
                Source::Backward => second,
                // A pose between both has no fit of its own: the nearer piece's is kept.
                Source::Blended(_) if *frame <= found.frame => first,
                Source::Blended(_) => second,
            };
            one.cloned()
        });
        let frames: Vec<FrameEstimate> = frames.collect();
        seams.push(Seam { frame: found.frame, distance_m: found.distance_m, meets: found.meets() });
        whole.track = Track { frames: frames.into_iter().map(|one| (one.frame, one)).collect() };
        before = path;
    }
    Ok((whole, seams))
}

fn summary(whole: &WrittenTrack, seams: &[Seam], making: TrackMaking) -> Value {
    let frames = || whole.track.frames.values();
    let (count, lost) = (frames().count(), frames().filter(|one| one.is_lost()).count());
    let iou = IouSummary::of(&whole.cameras, &whole.track);
    let doubts = Doubts::by_limb(&whole.model, &whole.track);
    let mut summary = json!({
        "frames": count,
        "lost": lost,
        "trust": doubts,
        "iou": iou,
        "seams": seams.iter().map(|seam| json!({
            "frame": seam.frame, "apart_mm": 1000.0 * seam.distance_m, "meets": seam.meets,
        })).collect::<Vec<_>>(),
    });
    if let Some(why) = why_whole_doubtful(count, lost, &doubts, seams) {
        summary["doubtful"] = why.into();
    }
    // The take is named by how the first piece was made.
    if making != TrackMaking::default() {
        summary["made"] = json!(TrackMaking { command: output::command_line(), ..making });
    }
    summary
}

fn write(out: &Path, whole: &WrittenTrack, summary: &Value) -> anyhow::Result<()> {
    output::make_folder(out)?;
    let cameras: Vec<&str> = whole.cameras.iter().map(String::as_str).collect();
    let export = TrackExport {
        name: &whole.name,
        frame_rate: whole.frame_rate,
        model: &whole.model,
        cameras: &cameras,
        track: &whole.track,
    };
    let summary = serde_json::to_string_pretty(summary)? + "\n";
    let body = model_file::to_text(&whole.model);
    let others = [(track_files::SUMMARY, summary.as_bytes()), (track_files::BODY, body.as_bytes())];
    Ok(export::write(out, &export, &others)?)
}

fn text(whole: &WrittenTrack, seams: &[Seam]) -> String {
    let frames = whole.track.frames.values();
    let lost = frames.clone().filter(|one| one.is_lost()).count();
    let mut table = Table::new(["joined at frame", "apart, mm", "one movement"]);
    for seam in seams {
        let meets = if seam.meets { "yes" } else { "no" };
        table.row([seam.frame.to_string(), format!("{:.1}", 1000.0 * seam.distance_m), meets.to_owned()]);
    }
    format!("{} frames, {lost} lost\n\n{}", frames.count(), table.to_text())
}
