//! `backlit check`: which camera of a take is wrong, and how, from what all cameras see of the person.

use std::path::{Path, PathBuf};

use backlit_formats::calibration::backlit::to_text;
use backlit_formats::synchronise::{USUAL_FRAMES, record};
use backlit_formats::{Take, atomic};
use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::diagnosis::{Diagnosis, DiagnosisOptions, FaultKind, Finding, Size, diagnose};
use clap::Args;
use glam::DVec2;
use indicatif::ProgressBar;
use serde_json::json;

use super::interrupt::{self, Interrupted};
use super::numbers::within;
use super::output::{self, number};
use super::table::Table;
use super::take_options;

const AFTER_HELP: &str = "\
A half-plane through two cameras that touches the person touches both silhouettes. Where cameras disagree on \
these, every usual fault is tried (extrinsics the wrong way round, units, axes, pictures turned or scaled, cameras \
exchanged, lens, focal length, principal point, a camera turned, shifted or moved half-way, clocks), and what explains \
the silhouettes best is told. The person must move. Two cameras show that something is wrong, but not in which.

Examples:
  backlit check TAKE
  backlit check TAKE --out cameras.json";

/// What `backlit check` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct CheckArguments {
    /// Take: its folder or its take.toml
    take: PathBuf,
    /// Most frames that are looked at; a longer take is thinned evenly [2 to 1000000]
    #[arg(long, value_name = "N", default_value_t = USUAL_FRAMES, allow_negative_numbers = true, value_parser = within(2..=1_000_000_usize))]
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
    let at = |done: usize, total: usize| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    };
    let take = footage.take();
    let every = take.frame_count().div_ceil(arguments.frames);
    let checked = record(&footage, every, &cancel, at).map_err(anyhow::Error::from).and_then(|recordings| {
        Ok(diagnose(&recordings, take.rig().cameras(), &DiagnosisOptions::default(), &cancel, at)?)
    });
    bar.finish_and_clear();
    if cancel.is_cancelled() {
        return Err(Interrupted.into());
    }
    let found = checked?;
    let written = match &arguments.out {
        Some(out) => write(out, take, &found)?,
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
    let is_repair = |finding: &&Finding| !finding.kind.is_clock() && finding.kind != FaultKind::Bumped;
    let Some(last) = found.findings.iter().rfind(is_repair) else {
        return Ok("nothing to write: nothing was found that other cameras repair\n".to_owned());
    };
    atomic::write(out, to_text(&full_size(take, &last.cameras)?).as_bytes())?;
    Ok(format!("wrote the repaired cameras to {}\n", out.display()))
}

/// Cameras of the working size, for pictures as large as on the disk.
fn full_size(take: &Take, cameras: &[Camera]) -> anyhow::Result<Rig> {
    let scale = DVec2::splat(f64::from(take.reduction()));
    let sizes =
        take.full_rig().cameras().iter().map(|camera| [camera.width() as u64, camera.height() as u64]);
    let full = cameras.iter().zip(sizes).map(|(camera, size)| camera.remapped(size, scale, DVec2::ZERO));
    Ok(Rig::new(full.collect::<Result<_, _>>()?)?)
}

fn name(take: &Take, camera: Option<usize>) -> &str {
    camera.map_or("every camera", |camera| take.rig().cameras()[camera].name())
}

/// "turn 0.52 ± 0.04 °, since 6.8 s".
fn sizes(finding: &Finding) -> String {
    let one = |size: &Size| {
        let digits = if size.value.abs() < 10.0 { 3 } else { 1 };
        let deviation =
            size.deviation.map_or(String::new(), |deviation| format!(" ± {}", number(deviation, digits)));
        format!("{} {}{deviation} {}", size.what, number(size.value, digits), size.unit).trim_end().to_owned()
    };
    let mut all: Vec<String> = finding.sizes.iter().map(one).collect();
    all.extend(finding.since_s.map(|seconds| format!("since {} s", number(seconds, 2))));
    all.join(", ")
}

fn text(take: &Take, found: &Diagnosis) -> String {
    let mut out = String::new();
    if found.findings.is_empty() {
        out += "nothing is wrong with the cameras, as far as their silhouettes tell\n";
    }
    for finding in &found.findings {
        out += &format!("{} {}", name(take, finding.camera), finding.kind.description());
        if let Some(with) = finding.with {
            out += &format!(" ({})", name(take, Some(with)));
        }
        let sizes = sizes(finding);
        out += &if sizes.is_empty() { "\n".to_owned() } else { format!(": {sizes}\n") };
        if let Some([before, after]) = finding.apart_px {
            let [before, after] = [before, after].map(|px| number(px, 2));
            out += &format!("  it and the others are {before} px apart, {after} px with that repaired\n");
        }
        for rival in &finding.rivals {
            let behind = number(rival.behind.exp(), 0);
            let (who, what) = (name(take, rival.camera), rival.kind.description());
            out += &format!("  or, {behind} times less likely: {who} {what}\n");
        }
        out += match finding.kind {
            FaultKind::Offset => "  backlit sync TAKE --write puts the offset into the take\n",
            FaultKind::Bumped => "  leave it out from then on, or calibrate it again\n",
            _ => "",
        };
    }
    let mut table = Table::new(["cameras", "apart, px", "repaired", "of the frames, %"]);
    for pair in &found.pairs {
        let [a, b] = pair.cameras.map(|camera| name(take, Some(camera)));
        let [before, after] = pair.apart_px.map(|px| number(px, 2));
        table.row([format!("{a}, {b}"), before, after, number(100.0 * pair.share, 0)]);
    }
    out += &table.to_text();
    if let Some(tall) = found.subject_m {
        out += &format!("the subject's largest extent is {} m\n", number(tall, 2));
    }
    out
}

fn to_json(take: &Take, found: &Diagnosis) -> serde_json::Value {
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
            "share": pair.share,
        })
    });
    json!({
        "findings": found.findings.iter().map(finding).collect::<Vec<_>>(),
        "pairs": pairs.collect::<Vec<_>>(),
        "subject_m": found.subject_m,
        "noise_px": found.noise_px,
    })
}
