//! `backlit background`: plates learnt again without the tracked body.

use std::path::PathBuf;

use backlit_formats::Take;
use backlit_formats::motion::Motion;
use backlit_formats::plate::{self, plate_without_body};
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use crate::{output, take_options, track_files};

const AFTER_HELP: &str = "\
A background that was learnt from the footage has gaps where the subject was always near. Once a body is \
tracked, only the pixels of that body are left out, and more of the background is learnt. Writes one plate \
for each camera to the folder of --out. Name the plates as `background` in take.toml, or put them in the \
place of those that are there.

Example:
  backlit background TAKE --without results --out TAKE/background";

/// What `backlit background` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct BackgroundArguments {
    /// Take: its folder or its take.toml
    take: PathBuf,
    /// The track whose body is left out: the track.json that `backlit track` wrote, or its folder
    #[arg(long, value_name = "TRACK")]
    without: PathBuf,
    /// Folder for the plates; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Body of the track: a built-in name or a body file [default: the body.toml beside the track, else the built-in body
    /// that the track names]
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
}

/// Learns the plates of all cameras, writes them, and says what each of them knows now.
pub(crate) fn run(arguments: &BackgroundArguments) -> anyhow::Result<()> {
    let motion = Motion::of_written(track_files::read(&arguments.without, arguments.model.as_deref())?);
    let take = take_options::with_notes_shown(Take::open(&arguments.take)?);
    output::make_folder(&arguments.out)?;
    for (index, camera) in take.rig().cameras().iter().enumerate() {
        let name = camera.name();
        if take.footage()[index].has_masks() {
            output::complain(&format!(
                "{name}: its silhouettes were made elsewhere; no background is learnt"
            ));
            continue;
        }
        let learnt = plate_without_body(&take, index, &motion.model, &motion.poses, &CancelToken::new())?;
        learnt.write(&arguments.out.join(plate::file_name(name)))?;
        let unknown = 100.0 * (1.0 - learnt.known_share());
        output::complain(&format!(
            "{name}: the background was learnt again without the body; {unknown:.1} % of it is unknown"
        ));
    }
    Ok(())
}
