//! `backlit synth`: a motion of a file filmed by simulated cameras, as a take with its truth.

use std::path::PathBuf;

use anyhow::{bail, ensure};
use backlit_formats::model_file;
use backlit_formats::recording::RecordingOptions;
use backlit_lab::synthetic::take::{self, FilmError, FilmOptions, Filmed};
use backlit_lab::synthetic::{Build, Sensor};
use backlit_runs::imported_motion::read_motion;
use backlit_take::motion::FollowOptions;
use clap::{Args, ValueEnum};
use glam::DVec3;
use indicatif::ProgressBar;

use super::export::direction;
use super::interrupt::{self, Interrupted};
use super::numbers::within;
use super::output;
use super::take_options::FrameSpan;

const AFTER_HELP: &str = "\
The motion is a BVH, TRC, C3D, CSV or NumPy file of any tool, a track or a project. It is scaled to the body, stood upright \
with its feet on the floor, and followed limb by limb. The truth lies beside the take: truth.csv, which the take names as its \
reference, and truth/track.json.

Examples:
  backlit synth --motion walk.bvh --cameras 4 --size 640x480 --out TAKE
  backlit synth --motion walk.bvh --masks --wide 2 --frames 0..60 --out TAKE
  backlit track TAKE --out results
  backlit compare results TAKE/truth";

/// What the figure wears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Clothes {
    /// T-shirt and slim trousers.
    Usual,
    /// Wide clothes with folds.
    Loose,
    /// Wide clothes with a pattern.
    Patterned,
}

impl Clothes {
    fn build(self) -> Build {
        match self {
            Self::Usual => Build::default(),
            Self::Loose => Build { cloth: 1.3, folds: 0.009, pattern: 0.0 },
            Self::Patterned => Build { cloth: 1.12, folds: 0.006, pattern: 0.5 },
        }
    }
}

/// What `backlit synth` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct SynthArguments {
    /// Motion: bvh, trc, c3d, csv, npz, a track.json or its folder, or a project
    #[arg(long, value_name = "FILE")]
    motion: PathBuf,
    /// Folder for the take; made if it is not there, and must be empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Cameras in a ring around the motion [1 to 32]
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = within(1..=32_usize))]
    cameras: usize,
    /// Size of the pictures in pixels
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = size)]
    size: [u64; 2],
    /// Frames a second of the take [0.01 to 100000] [default: the motion's]
    #[arg(long, value_name = "HZ", value_parser = within(0.01..=100_000.0))]
    frame_rate: Option<f64>,
    /// Frames of the take that are filmed: A..B, A.., ..B, A..=B or one frame [default: all]
    #[arg(long, value_name = "FRAMES")]
    frames: Option<FrameSpan>,
    /// Body that moves: a built-in name or a body file with the limbs of the full body
    #[arg(long, value_name = "MODEL", default_value = "full_body")]
    model: String,
    /// Which way is up in the motion: x, y, z, -x, -y, -z [default: the axis along which the person is tallest]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = direction)]
    up: Option<DVec3>,
    /// Frames a second of a motion that does not say it [0.01 to 100000]
    #[arg(long, value_name = "HZ", value_parser = within(0.01..=100_000.0))]
    motion_rate: Option<f64>,
    /// Write exact masks, not pictures: some fifteen times as fast
    #[arg(long)]
    masks: bool,
    /// What the figure wears
    #[arg(long, value_enum, default_value_t = Clothes::Usual)]
    clothes: Clothes,
    /// Noise of the sensor, as a multiple of a usual one [0 to 20]
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = within(0.0..=20.0))]
    noise: f64,
    /// Draw without shadows: about six times as fast
    #[arg(long, conflicts_with = "masks")]
    no_shadows: bool,
    /// Pixels by which masks are too wide all round [0 to 50]
    #[arg(long, value_name = "PX", default_value_t = 0.0, requires = "masks", value_parser = within(0.0..=50.0))]
    wide: f64,
    /// Share of the pixels at the masks' edges that are wrong [0 to 1]
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, requires = "masks", value_parser = within(0.0..=1.0))]
    mask_noise: f64,
    /// A post before every camera, as a share of the picture's width [0 to 0.9]
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = within(0.0..=0.9))]
    occluder: f64,
    /// Seed of all noise [0 to 4294967295]
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = within(0..=u64::from(u32::MAX)))]
    seed: u64,
}

pub(crate) fn run(arguments: &SynthArguments) -> anyhow::Result<()> {
    let model = model_file::resolve(&arguments.model)?;
    let reading = RecordingOptions { frame_rate: arguments.motion_rate, ..RecordingOptions::default() };
    let options = FollowOptions { up: arguments.up, frame_rate: arguments.frame_rate };
    let mut motion = read_motion(&arguments.motion, &reading, &model, options)?;
    if let Some(FrameSpan { first, past }) = arguments.frames {
        motion.poses.retain(|frame, _| *frame >= first && past.is_none_or(|past| *frame < past));
        ensure!(!motion.poses.is_empty(), "--frames: the motion has none of these frames");
    }
    output::make_folder(&arguments.out)?;
    if std::fs::read_dir(&arguments.out).is_ok_and(|mut entries| entries.next().is_some()) {
        bail!("--out: {} is not empty; a take is not written over what is there", arguments.out.display());
    }
    let usual = Sensor::default();
    let options = FilmOptions {
        name: motion.name.clone(),
        cameras: arguments.cameras,
        size_px: arguments.size,
        frame_rate: motion.frame_rate,
        filmed: if arguments.masks { Filmed::Masks } else { Filmed::Pictures },
        build: arguments.clothes.build(),
        sensor: Sensor {
            read_noise: arguments.noise * usual.read_noise,
            shot_noise: arguments.noise.powi(2) * usual.shot_noise,
            ..usual
        },
        shadows: !arguments.no_shadows,
        wide_px: arguments.wide,
        mask_noise: arguments.mask_noise,
        occluder: arguments.occluder,
        seed: arguments.seed,
    };
    let cancel = interrupt::listen()?;
    let bar = ProgressBar::new(motion.poses.len() as u64);
    let written = take::write(&arguments.out, &motion.model, &motion.poses, &options, &cancel, |done| {
        bar.set_position(done as u64);
    });
    bar.finish_and_clear();
    match written {
        Err(FilmError::Cancelled) => Err(Interrupted.into()),
        Err(error) => Err(error.into()),
        Ok(hidden) => {
            let post = if arguments.occluder > 0.0 {
                let shares: Vec<String> =
                    hidden.iter().map(|share| format!("{:.0}", 100.0 * share)).collect();
                format!("the posts hide {} % of the person, by camera\n", shares.join(", "))
            } else {
                String::new()
            };
            output::print(&format!(
                "{} frames before {} cameras, in {}\n{post}",
                motion.poses.len(),
                arguments.cameras,
                arguments.out.display()
            ))
        }
    }
}

/// Reads `WxH`.
fn size(text: &str) -> Result<[u64; 2], &'static str> {
    let expected = "expected WIDTHxHEIGHT in pixels, each from 16 to 8192, as 640x480";
    let (width, height) = text.split_once(['x', '×']).ok_or(expected)?;
    let side = |text: &str| text.parse().ok().filter(|side| (16..=8192).contains(side)).ok_or(expected);
    Ok([side(width)?, side(height)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_two_sides() {
        assert_eq!(size("640x480"), Ok([640, 480]));
        for bad in ["640", "640x", "8x480", "axb", "640x99999"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
