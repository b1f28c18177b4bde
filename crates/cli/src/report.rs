//! `backlit report`: a track as one HTML page to send, or as a recording of the Rerun viewer.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, ensure};
use backlit_formats::recording::RecordingOptions;
use backlit_formats::{Footage, Take, atomic};
use backlit_runs::comparison::read_reference;
use backlit_runs::report::{PICTURES, ReportOptions, ReportSource};
use backlit_runs::results::{is_project, open_project};
use backlit_tracking::metrics::comparison::ComparisonOptions;
use clap::Args;

use crate::numbers::within;
use crate::take_options::{self, Segmentation};
use crate::{interrupt, output, track_files};

const AFTER_HELP: &str = "\
The page is one file that needs no network: every camera with the body over its picture, a slider over frames and \
one over the steps of a fit, a scene that turns, curves, joint errors, doubtful limbs, settings and commands. \
Keys and screen readers are provided for. The body is drawn in all frames, pictures and silhouettes are in some only.

A track names its take (summary.json); where that has moved, --take says where it is.

Example:
  backlit track TAKE --out results
  backlit report results --out page.html --compare reference.trc
  backlit report corrected.backlit --out page.html --pictures 60 --steps-of 12,40";

/// What `backlit report` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct ReportArguments {
    /// Track: the track.json that `backlit track` wrote, or its folder; or a project, NAME.backlit, whose poses are shown as they
    /// are, those set by hand included
    #[arg(value_name = "TRACK|PROJECT")]
    track: PathBuf,
    /// The page, an HTML file
    #[arg(long, value_name = "FILE", required_unless_present = "rrd")]
    out: Option<PathBuf>,
    /// The same as a recording of the Rerun viewer, an RRD file; for programs that were built with `--features rrd`
    #[arg(long, value_name = "FILE")]
    rrd: Option<PathBuf>,
    /// Take of the track: its folder or its take.toml [default: as the track or the project says]
    #[arg(long, value_name = "TAKE")]
    take: Option<PathBuf>,
    /// Body of the track: a built-in name or a body file [default: the body.toml beside the track, else the built-in
    /// body that the track names]
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Frames with a picture of each camera, spread over the track and at its most doubtful frames [0 to 1000]
    #[arg(long, value_name = "N", default_value_t = PICTURES, value_parser = within(0..=1000_usize))]
    pictures: usize,
    /// Recording, track or project that the track is compared with, as by `backlit compare`; may be given several times
    #[arg(long, value_name = "REFERENCE")]
    compare: Vec<PathBuf>,
    /// Frames that are fitted again to show every step, with commas between [0 to 999999] [default: the first and the most doubtful one]
    #[arg(long, value_name = "FRAMES", value_delimiter = ',', value_parser = within(0..=999_999_usize))]
    steps_of: Option<Vec<usize>>,
}

pub(crate) fn run(arguments: &ReportArguments) -> anyhow::Result<()> {
    let cancel = interrupt::listen()?;
    ensure!(
        arguments.rrd.is_none() || cfg!(feature = "rrd"),
        "--rrd: this program was built without Rerun; expected one of `cargo build --release --features rrd`"
    );
    [&arguments.out, &arguments.rrd]
        .into_iter()
        .flatten()
        .try_for_each(|file| output::check_folder_of(file))?;
    let track = track_files::path_in(&arguments.track);
    let mut source = if is_project(&track) {
        ensure!(arguments.model.is_none(), "--model is for tracks; a project has its body");
        of_project(&track, arguments.take.as_deref())?
    } else {
        of_track(arguments, &track)?
    };
    for path in &arguments.compare {
        let reference = read_reference(path, &RecordingOptions::default())?;
        source.compare(&reference, &ComparisonOptions::default());
    }
    let options = ReportOptions {
        pictures: arguments.pictures,
        steps_of: arguments.steps_of.clone(),
        command: Some(output::command_line()),
    };
    let page = source.page(&options, &cancel)?;
    page.notes.iter().for_each(|note| output::complain(&format!("note: {note}")));
    if let Some(file) = &arguments.out {
        atomic::write(file, backlit_report::to_html(&page).as_bytes())?;
    }
    #[cfg(feature = "rrd")]
    if let Some(file) = &arguments.rrd {
        atomic::write(file, &backlit_report::to_rrd(&page)?)?;
    }
    Ok(())
}

/// A track as it was written, with the take that it names if that is still there.
fn of_track(arguments: &ReportArguments, track: &Path) -> anyhow::Result<ReportSource> {
    let written = track_files::read(&arguments.track, arguments.model.as_deref())?;
    let making = track_files::making(track);
    let open =
        |take: &Path| take_options::open_with_body(take, Some(written.model.clone()), Segmentation::Take);
    let named = Some(making.take.clone()).filter(|take| !take.as_os_str().is_empty());
    let footage = match (&arguments.take, named) {
        (Some(take), _) => Some(open(take).context("--take")?),
        (None, Some(named)) => match open(&named) {
            Ok(footage) => Some(footage),
            Err(error) => {
                let told = "the page is without pictures; --take says where the take is";
                output::complain(&format!(
                    "note: the take that the track names cannot be opened: {error}; {told}"
                ));
                None
            }
        },
        (None, None) => {
            output::complain(
                "note: the track names no take; the page is without pictures unless --take says it",
            );
            None
        }
    };
    if let Some(take) = footage.as_ref().map(|footage| footage.take()) {
        ensure!(
            take.name() == written.name,
            "the track is of \"{}\"; the take is \"{}\"; expected --take of the same recording",
            written.name,
            take.name()
        );
    }
    Ok(ReportSource::of_written(written, footage, making))
}

/// The poses of a project, with the silhouettes as it steers them.
fn of_project(path: &Path, take: Option<&Path>) -> anyhow::Result<ReportSource> {
    let take = take.map(Take::open).transpose().context("--take")?;
    let (document, take) = open_project(path, take)?;
    let take = take_options::with_notes_shown(take);
    let footage = document.footage(&Footage::new(take));
    Ok(ReportSource::of_document(&document, Arc::new(footage)))
}
