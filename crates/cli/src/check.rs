//! `backlit check`: which camera of a take is wrong, and how, from what all cameras see of the person.

use std::path::{Path, PathBuf};

use backlit_formats::calibration::backlit::to_text;
use backlit_formats::synchronise::USUAL_FRAMES;
use backlit_formats::{Take, atomic};
use backlit_runs::camera_check::{CheckedCameras, FindingWords, NOTHING_WRONG, check, repaired};
use backlit_runs::changes::change_text;
use backlit_tracking::diagnosis::{Diagnosis, FaultKind, Finding, PairAgreement, Size};
use clap::Args;
use indicatif::ProgressBar;
use serde_json::json;

use super::interrupt::{self, Interrupted};
use super::numbers::within;
use super::output::{self, number};
use super::table::{Column, Table};
use super::take_options;

const AFTER_HELP: &str = "\
A half-plane through two cameras that touches the person touches both silhouettes. Where cameras disagree on \
these, every usual fault is tried (extrinsics the wrong way round, units, axes, pictures turned or scaled, cameras \
exchanged, lens, focal length, principal point, a camera turned, shifted or moved half-way, clocks), and what explains \
the silhouettes best is told. Keypoints are compared in the same way where the take has them. Backgrounds that change \
while the take is filmed are told too: a thing that was put down, other light, a knock. The person must move. Two \
cameras show that something is wrong, but not in which.

Examples:
  backlit check TAKE
  backlit check TAKE --out cameras.json";

/// What `backlit check` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct CheckArguments {
    /// Take: its folder, its take.toml, or a project about it
    take: PathBuf,
    /// Most frames that are looked at; a longer take is thinned evenly [2 to 1000000]
    #[arg(long, value_name = "N", default_value_t = USUAL_FRAMES, value_parser = within(2..=1_000_000_usize))]
    frames: usize,
    /// Write the cameras with what was found repaired, in Backlit's own format
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &CheckArguments) -> anyhow::Result<()> {
    let footage = take_options::open(&arguments.take)?;
    let cancel = interrupt::listen()?;
    let bar = ProgressBar::new(1);
    let checked = check(&footage, arguments.frames, &cancel, |_, [done, all]| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    if cancel.is_cancelled() {
        return Err(Interrupted.into());
    }
    let (take, found) = (footage.take(), checked?);
    let written = match &arguments.out {
        Some(out) => write(out, take, &found.diagnosis)?,
        None => String::new(),
    };
    if arguments.json {
        output::print_json(&to_json(take, &found))
    } else {
        output::print(&(text(take, &found) + &written))
    }
}

/// Writes the repaired cameras, and says whether there are any.
fn write(out: &Path, take: &Take, found: &Diagnosis) -> anyhow::Result<String> {
    let Some(rig) = found.findings.iter().rev().find_map(|finding| repaired(take, finding)) else {
        return Ok("nothing to write: nothing was found that other cameras repair\n".to_owned());
    };
    atomic::write(out, to_text(&rig).as_bytes())?;
    Ok(format!("wrote the repaired cameras to {}\n", out.display()))
}

fn text(take: &Take, CheckedCameras { diagnosis: found, changes }: &CheckedCameras) -> String {
    let mut out = String::new();
    if found.findings.is_empty() {
        out += &format!("{NOTHING_WRONG}\n");
    }
    let cameras = take.rig().cameras();
    for finding in &found.findings {
        let words = FindingWords::of(finding, cameras);
        let sizes = if words.sizes.is_empty() { String::new() } else { format!(": {}", words.sizes) };
        out += &format!("{}{sizes}\n", words.what);
        let sync = "backlit sync TAKE --write puts the offset into the take";
        let advice = words.advice.or((finding.kind == FaultKind::Offset).then_some(sync));
        let below = words.apart.into_iter().chain(words.rivals).chain(advice.map(str::to_owned));
        out.extend(below.map(|line| format!("  {line}\n")));
    }
    out.extend(changes.iter().map(|change| change_text(change, take) + "\n"));
    let name = |pair: &&PairAgreement| pair.cameras.map(|camera| cameras[camera].name()).join(", ");
    let columns: [Column<'_, &PairAgreement>; 6] = [
        ("cameras", &name),
        ("apart, px", &|pair| number(pair.apart_px[0], 2)),
        ("repaired", &|pair| number(pair.apart_px[1], 2)),
        ("of the frames, %", &|pair| number(100.0 * pair.share, 0)),
        ("keypoints, px", &|pair| number(pair.keypoints_apart_px[0], 2)),
        ("repaired", &|pair| number(pair.keypoints_apart_px[1], 2)),
    ];
    let shown = if found.keypoint_noise_px.is_some() { 6 } else { 4 };
    out += &Table::of(&found.pairs, &columns[..shown]);
    if let Some(tall) = found.subject_m {
        out += &format!("the subject's largest extent is {} m\n", number(tall, 2));
    }
    out
}

fn to_json(take: &Take, CheckedCameras { diagnosis: found, changes }: &CheckedCameras) -> serde_json::Value {
    let name = |camera: Option<usize>| camera.map(|camera| take.rig().cameras()[camera].name());
    let size = |size: &Size| json!({"what": size.what, "value": size.value, "deviation": size.deviation, "unit": size.unit});
    let finding = |finding: &Finding| {
        json!({
            "camera": name(finding.camera),
            "with": name(finding.with),
            "kind": finding.kind.name(),
            "sizes": finding.sizes.iter().map(size).collect::<Vec<_>>(),
            "since_seconds": finding.since_s,
            "evidence": finding.evidence.is_finite().then_some(finding.evidence),
            "apart_px": finding.apart_px,
            "keypoints_apart_px": finding.keypoints_apart_px,
            "unexplained_edges": finding.unexplained,
            "rivals": finding.rivals.iter().map(|rival| json!({
                "camera": name(rival.camera), "kind": rival.kind.name(), "evidence_less": rival.behind,
            })).collect::<Vec<_>>(),
            "clock": finding.clock.map(|clock| json!({"offset_seconds": clock.offset_s, "rate": clock.rate})),
        })
    };
    let pairs = found.pairs.iter().map(|pair| {
        json!({
            "cameras": pair.cameras.map(|camera| name(Some(camera))),
            "apart_px": pair.apart_px,
            "keypoints_apart_px": pair.keypoints_apart_px,
            "share": pair.share,
        })
    });
    json!({
        "frames": take.frame_count(),
        "findings": found.findings.iter().map(finding).collect::<Vec<_>>(),
        "pairs": pairs.collect::<Vec<_>>(),
        "background_changes": changes.iter().map(|change| change_text(change, take)).collect::<Vec<_>>(),
        "subject_m": found.subject_m,
        "noise_px": found.noise_px,
    })
}
