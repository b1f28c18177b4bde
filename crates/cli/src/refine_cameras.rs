//! `backlit refine-cameras`: cameras refined by the silhouettes of a person.

use std::path::{Path, PathBuf};

use anyhow::Result;
use backlit_formats::calibration::backlit::to_text;
use backlit_formats::{atomic, model_file};
use backlit_runs::camera_refinement::{self, HELD, progress_text, refine, to_json};
use backlit_tracking::body_fit::{CameraChoice, CameraRefinementOptions, RefinedCameras};
use backlit_tracking::fit::FitOptions;
use clap::Args;
use serde::Serialize;

use super::fit_options::{Words, one_of};
use super::interrupt::{self, Interrupted};
use super::numbers::within;
use super::output::{self, number};
use super::progress;
use super::table::Table;
use super::take_options::{self, PartArguments, StartArguments};

const AFTER_HELP: &str = "\
The person is tracked with the cameras as they are. Then poses, body sizes and cameras are fitted together to the silhouettes \
of well-spread frames, three times. Where the whole rig stands, turns and how large it is stays as the calibration has it: \
silhouettes cannot tell. In frames held out, each camera in turn is predicted by the others, before and after.

Examples:
  backlit refine-cameras TAKE --out cameras.json
  backlit refine-cameras TAKE --free focal-length,offset --out cameras.json";

/// What `backlit refine-cameras` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct RefineCamerasArguments {
    /// Take: its folder, its take.toml, or a project about it
    take: PathBuf,
    #[command(flatten)]
    free: FreeNumbers,
    /// Frames that are fitted to [3 to 64]
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = within(3..=64_usize))]
    count: usize,
    #[command(flatten)]
    part: PartArguments,
    #[command(flatten)]
    start: StartArguments,
    /// Write the cameras to this file, in Backlit's own format
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the body that was fitted with them to this file
    #[arg(long, value_name = "MODEL.toml")]
    body_out: Option<PathBuf>,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

/// What of every camera is refined beside its turn and its place.
#[derive(Debug, Clone, Args, Serialize)]
pub(crate) struct FreeNumbers {
    /// What is free beside every camera's turn and place, with commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(FREE))]
    free: Vec<FreeNumber>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
enum FreeNumber {
    FocalLength,
    PrincipalPoint,
    Offset,
    Drift,
}

const FREE: Words<FreeNumber> = &[
    ("focal-length", "The focal length", FreeNumber::FocalLength),
    ("principal-point", "The principal point", FreeNumber::PrincipalPoint),
    ("offset", "By how much the clock is late", FreeNumber::Offset),
    ("drift", "By how much the clock goes slow", FreeNumber::Drift),
];

impl FreeNumbers {
    pub(crate) fn choice(&self) -> CameraChoice {
        let has = |number| self.free.contains(&number);
        CameraChoice {
            focal_length: has(FreeNumber::FocalLength),
            principal_point: has(FreeNumber::PrincipalPoint),
            offset: has(FreeNumber::Offset),
            drift: has(FreeNumber::Drift),
        }
    }
}

pub(crate) fn run(arguments: &RefineCamerasArguments) -> Result<()> {
    for out in arguments.out.iter().chain(&arguments.body_out) {
        output::check_folder_of(out)?;
    }
    let footage = take_options::open(&arguments.take)?;
    let take = footage.take();
    let (cameras, frames) = (arguments.part.cameras(take)?, arguments.part.frames(take)?);
    let mut options = CameraRefinementOptions::new(FitOptions::default(), take.frame_rate());
    options.choice = arguments.free.choice();
    options.fitted = arguments.count;
    let cancel = interrupt::listen()?;
    let start = arguments.start.pose(&footage, &cameras, frames[0], &options.person.fit)?;
    let spinner = progress::spinner();
    let found = refine(&footage, &cameras, (start, &frames), &options, &cancel, |at| {
        spinner.set_message(progress_text(at));
    });
    spinner.finish_and_clear();
    if cancel.is_cancelled() {
        return Err(Interrupted.into());
    }
    let (found, rig) = found?;
    if let Some(out) = &arguments.out {
        atomic::write(out, to_text(&rig).as_bytes())?;
    }
    if let Some(out) = &arguments.body_out {
        model_file::write(out, &found.body.as_seen())?;
    }
    let text = || text(&found, &options.choice, arguments.out.as_deref());
    output::print_result(arguments.json, &to_json(&found), text)
}

fn text(found: &RefinedCameras, choice: &CameraChoice, out: Option<&Path>) -> String {
    let mut changes = Table::new(["camera", "changed", "by", "±"]);
    let mut judged = Table::new(["camera held out", "IoU before", "after"]);
    for camera in &found.cameras {
        for (what, [by, deviation]) in camera_refinement::changes(camera, choice) {
            changes.row([camera.camera.name().to_owned(), what.to_owned(), by, deviation]);
        }
        let [before, after] = camera.held_out_iou.map(|iou| number(iou, 3));
        judged.row([camera.camera.name().to_owned(), before, after]);
    }
    let [before, after] = [&found.before, &found.body].map(|body| number(body.iou[1], 3));
    let mut text = changes.to_text() + &judged.to_text();
    text += &format!("IoU of all cameras in {} frames: {before} → {after}\n", found.body.frames.len());
    text += &format!("{HELD}\n");
    if let Some(out) = out {
        text += &format!("wrote the cameras to {}\n", out.display());
    }
    text
}
