//! `backlit silhouettes`: the masks of a take as pictures; which are worst, and settings that suit it better.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::take::measurement_lines;
use backlit_formats::{Footage, calibration, images};
use backlit_runs::silhouettes::{PosedBody, TunedSettings, changes, tune, with_changes, worst};
use backlit_tracking::camera::Rig;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::Evidence;
use backlit_tracking::segment::SegmentOptions;
use clap::Args;
use image::DynamicImage;
use indicatif::ProgressBar;

use super::fit_options::one_of;
use super::numbers::within;
use super::output::{self, number};
use super::person::PersonArguments;
use super::progress;
use super::table::Table;
use super::take_options::{self, PartArguments, Segmentation};
use super::track::robust_track;
use crate::interrupt::{self, Interrupted};

const AFTER_HELP: &str = "\
Writes to the folder of --out:
  NAME/frame_000000.png  the silhouette of camera NAME: white subject, black background,
                         grey 128 unknown, shadow 32 (background) or 96 (weighs nothing)
  cameras.json           the cameras of these pictures, without lens distortion

--tune tracks up to 60 of the frames and tries z-score, shadow test, hysteresis, chroma apart, opening and closing one after
the other, by how well cameras and body agree. It prints the lines for the take's [measurement], and --out and --worst go by them.

Examples:
  backlit silhouettes TAKE --out masks --frames 0..10
  backlit silhouettes TAKE --worst 20
  backlit silhouettes TAKE --tune";

/// The most frames that are tracked to tune by.
const TRACKED_TO_TUNE: usize = 60;

/// What `backlit silhouettes` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct SilhouetteArguments {
    /// Take: its folder, its take.toml, or a project about it
    take: PathBuf,
    /// Folder for the silhouettes; made if it is not there
    #[arg(long, value_name = "DIR", required_unless_present_any = ["worst", "tune"])]
    out: Option<PathBuf>,
    /// List the worst silhouettes: what other cameras, neighbours in time and, with --tune, the body contradict [1 to 1000000]
    #[arg(long, value_name = "N", value_parser = within(1..=1_000_000_usize))]
    worst: Option<usize>,
    /// Choose the settings by how well cameras and body agree
    #[arg(long)]
    tune: bool,
    /// How they are made of the pictures
    #[arg(long, value_name = "HOW", value_parser = one_of(Segmentation::WORDS), default_value = "take")]
    segmentation: Segmentation,
    #[command(flatten)]
    part: PartArguments,
    #[command(flatten)]
    person: PersonArguments,
}

pub(crate) fn run(arguments: &SilhouetteArguments) -> anyhow::Result<()> {
    let cancel = interrupt::listen()?;
    let mut footage = take_options::open_segmented(&arguments.take, None, arguments.segmentation)?;
    let frames = arguments.part.frames(footage.take())?;
    let cameras = arguments.part.cameras(footage.take())?;
    footage = arguments.person.follow(footage, &cameras, &frames, &cancel)?;
    let mut body = None;
    if arguments.tune {
        let posed = tracked(&footage, &cameras, &frames, &cancel)?;
        let found = tuned(&footage, &posed, &cancel)?;
        let before = footage.take().measurement().first().cloned().unwrap_or_default();
        output::print(&tuned_text(&before, &found))?;
        let chosen = |own: &SegmentOptions, _| with_changes(own, &before, &found.options);
        footage = Arc::new(Footage::new(footage.take().clone().with_measurement(chosen)));
        body = Some(posed);
    }
    if let Some(out) = &arguments.out {
        write(out, &footage, &cameras, &frames)?;
    }
    match arguments.worst {
        Some(count) => {
            output::print(&worst_text(&footage, (&cameras, &frames), body.as_ref(), count, &cancel)?)
        }
        None => Ok(()),
    }
}

/// Writes the silhouettes and the cameras.
fn write(out: &Path, footage: &Footage, indices: &[usize], frames: &[usize]) -> anyhow::Result<()> {
    let cameras: Vec<_> = indices.iter().map(|&camera| (*footage.cameras[camera]).clone()).collect();
    for camera in &cameras {
        output::check_file_stem(camera.name())?;
        output::make_folder(&out.join(camera.name()))?;
    }
    calibration::backlit::write(&out.join("cameras.json"), &Rig::new(cameras)?)?;
    let progress = progress::bar(frames.len());
    for &frame in frames {
        for view in footage.fit_views(indices, frame)? {
            let Evidence::Mask(mask) = &view.evidence else { continue };
            let path = out.join(view.camera.name()).join(format!("frame_{frame:06}.png"));
            images::write_png(&path, &DynamicImage::ImageLuma8(mask.to_gray()))?;
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(())
}

/// The take's body, tracked through the first of these frames.
fn tracked(
    footage: &Arc<Footage>,
    cameras: &[usize],
    frames: &[usize],
    cancel: &CancelToken,
) -> anyhow::Result<PosedBody> {
    let frames = frames.iter().copied().take(TRACKED_TO_TUNE).collect();
    let report = robust_track(footage, cameras.to_vec(), frames, cancel)?;
    let poses = report.track.frames.into_iter().map(|(frame, estimate)| (frame, estimate.pose)).collect();
    Ok(PosedBody { model: Arc::clone(footage.take().model()), fit: Arc::default(), poses })
}

fn tuned(footage: &Footage, body: &PosedBody, cancel: &CancelToken) -> anyhow::Result<TunedSettings> {
    let bar = ProgressBar::new(1);
    let measurement = Arc::new(footage.take().measurement().to_vec());
    let found = tune(footage, &measurement, body, cancel, |[done, all]| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    if cancel.is_cancelled() {
        return Err(Interrupted.into());
    }
    Ok(found?)
}

/// What tuning changed, and the lines for the take's file.
fn tuned_text(before: &SegmentOptions, found: &TunedSettings) -> String {
    let share = |share: f64| number(share, 4);
    let changes = changes(before, &found.options);
    let mut text = format!(
        "cameras and body agree to {} with the take's settings; {} settings tried\n",
        share(found.before.mean()),
        found.tried
    );
    if changes.is_empty() {
        return text + "no other setting is better by more than chance\n";
    }
    text += &format!("to {} with: {}\n\n[measurement]\n", share(found.after.mean()), changes.join(", "));
    text + &measurement_lines(before, &found.options)
}

fn worst_text(
    footage: &Footage,
    (cameras, frames): (&[usize], &[usize]),
    body: Option<&PosedBody>,
    count: usize,
    cancel: &CancelToken,
) -> anyhow::Result<String> {
    let progress = progress::bar(frames.len());
    let measurement = Arc::new(footage.take().measurement().to_vec());
    let found = worst(footage, &measurement, frames, body, cancel, |done| progress.set_position(done as u64));
    progress.finish_and_clear();
    anyhow::ensure!(!cancel.is_cancelled(), Interrupted);
    if found.is_empty() {
        return Ok("nothing speaks against any silhouette\n".to_owned());
    }
    let mut table = Table::new(["frame", "camera", "subject, px", "badness", "why"]);
    for one in found.iter().filter(|one| cameras.contains(&one.camera)).take(count) {
        table.row([
            one.frame.to_string(),
            footage.cameras[one.camera].name().to_owned(),
            one.subject_px.to_string(),
            number(one.badness(), 2),
            one.reason(),
        ]);
    }
    Ok(table.to_text())
}
