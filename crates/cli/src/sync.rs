//! `backlit sync`: how far the cameras of a take were started apart, from the motion of the silhouettes.

use std::path::PathBuf;

use backlit_formats::Take;
use backlit_formats::synchronise::{self, OffsetShift, TakeClocks, USUAL_FRAMES};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::synchronise::{CameraOffset, PairCue, SynchroniseOptions};
use clap::Args;
use indicatif::ProgressBar;
use serde_json::json;

use super::numbers::within;
use super::output;
use super::table::Table;
use super::take_options;

const AFTER_HELP: &str = "\
Finds how far each camera of a take must be shifted against the first one, from the motion of its \
silhouettes: at the same moment, two cameras agree on the planes through both that touch the person. The \
cameras must be calibrated and the person must move. Where no offset can be found, the reason is printed. \
--write changes the offsets in take.toml and nothing else in it. The take holds whole frames; the rest of an \
offset is only printed.

Examples:
  backlit sync TAKE
  backlit sync TAKE --write";

/// What `backlit sync` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct SyncArguments {
    /// Take: its folder, its take.toml, or a project about it
    take: PathBuf,
    /// Write the offsets into take.toml, also of a project's take
    #[arg(long)]
    write: bool,
    /// Most time between the starts of two cameras, seconds [0 to 1000000] [default: as far as they overlap by three tenths]
    #[arg(long, value_name = "SECONDS", value_parser = within(0.0..=1e6_f64))]
    within: Option<f64>,
    /// Most frames that are looked at; a longer take is thinned evenly [1 to 1000000]
    #[arg(long, value_name = "N", default_value_t = USUAL_FRAMES, value_parser = within(1..=1_000_000_usize))]
    frames: usize,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &SyncArguments) -> anyhow::Result<()> {
    let footage = take_options::open(&arguments.take)?;
    let farthest_s = arguments.within.unwrap_or(f64::INFINITY);
    let options = SynchroniseOptions { farthest_s, ..SynchroniseOptions::default() };
    let bar = ProgressBar::new(1);
    let clocks =
        synchronise::find(&footage, arguments.frames, &options, &CancelToken::new(), |done, total| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        });
    bar.finish_and_clear();
    let clocks = clocks?;
    let told: Vec<OffsetShift> = clocks.shifts.iter().flatten().cloned().collect();
    let path = footage.take().path();
    let is_written = arguments.write && synchronise::shift_offsets(path, &told)?;
    if is_written {
        // The frames that all cameras have are others now.
        Take::open(path)?;
    }
    if arguments.json {
        return output::print_json(&to_json(footage.take(), &clocks, is_written));
    }
    let mut out = text(footage.take(), &clocks);
    if is_written {
        out += &format!("wrote the offsets into {}\n", footage.take().path().display());
    } else if told.iter().all(|shift| shift.frames == 0) {
        out += "nothing to write: no offset that was found comes to a whole frame\n";
    } else if !arguments.write {
        out += "--write puts the shifts into the take\n";
    }
    output::print(&out)
}

fn name(take: &Take, camera: usize) -> &str {
    take.rig().cameras()[camera].name()
}

fn text(take: &Take, clocks: &TakeClocks) -> String {
    let mut table = Table::new(["camera", "shift, frames", "seconds", "±", "probability"]);
    let mut reasons = String::new();
    for (camera, offset) in clocks.found.cameras.iter().enumerate() {
        let name = name(take, camera).to_owned();
        let frames =
            clocks.shifts[camera].as_ref().map_or("–".to_owned(), |shift| format!("{:+}", shift.frames));
        let [seconds, deviation, probability] = match offset {
            CameraOffset::Reference => ["0".to_owned(), "–".to_owned(), "–".to_owned()],
            CameraOffset::Found(offset) => [
                format!("{:+.4}", offset.seconds),
                format!("{:.4}", offset.deviation_s),
                format!("{:.3}", offset.probability),
            ],
            CameraOffset::Undecided(why) => {
                reasons += &format!("{name}: {why}\n");
                ["–".to_owned(), "–".to_owned(), "–".to_owned()]
            }
        };
        table.row([name, frames, seconds, deviation, probability]);
    }
    let mut out = table.to_text() + &reasons;
    for pair in clocks.found.pairs.iter().filter(|pair| !pair.is_used) {
        let [a, b] = pair.cameras.map(|camera| name(take, camera));
        out += &format!(
            "{a} and {b} by themselves give {:+.4} s more; this pair is not used\n",
            pair.residual_s
        );
    }
    if let Some(error) = clocks.found.loop_error_s {
        out += &format!("pairs of cameras agree to {error:.4} s\n");
    }
    if clocks.every > 1 {
        out += &format!("one frame in {} was looked at (--frames)\n", clocks.every);
    }
    out
}

fn to_json(take: &Take, clocks: &TakeClocks, is_written: bool) -> serde_json::Value {
    let camera = |(camera, offset): (usize, &CameraOffset)| {
        let shift = clocks.shifts[camera].as_ref();
        let mut value = json!({
            "camera": name(take, camera),
            "shift_frames": shift.map(|shift| shift.frames),
            "shift_seconds": shift.map(|shift| shift.seconds),
        });
        match offset {
            CameraOffset::Reference => value["reference"] = true.into(),
            CameraOffset::Found(offset) => {
                value["deviation_seconds"] = offset.deviation_s.into();
                value["probability"] = offset.probability.into();
                value["evidence"] = offset.evidence.into();
                value["rival"] =
                    json!(offset.rival.map(|(seconds, nats)| json!({"seconds": seconds, "evidence": nats})));
            }
            CameraOffset::Undecided(why) => value["undecided"] = why.to_string().into(),
        }
        value
    };
    let pairs = clocks.found.pairs.iter().map(|pair| {
        json!({
            "cameras": pair.cameras.map(|camera| name(take, camera)),
            "by": match pair.cue {
                PairCue::EpipolarTangents => "epipolar tangents",
                PairCue::HeightAndArea => "height and area",
            },
            "seconds": pair.seconds,
            "deviation_seconds": pair.deviation_s,
            "evidence": pair.evidence,
            "residual_seconds": pair.residual_s,
            "used": pair.is_used,
        })
    });
    json!({
        "cameras": clocks.found.cameras.iter().enumerate().map(camera).collect::<Vec<_>>(),
        "pairs": pairs.collect::<Vec<_>>(),
        "loop_error_seconds": clocks.found.loop_error_s,
        "every": clocks.every,
        "written": is_written,
    })
}
