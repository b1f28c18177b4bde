//! The commands and their help.

use clap::{Parser, Subcommand};

use super::{fit, render, silhouettes, track};

const ABOUT: &str = "Fits an articulated body to its silhouettes and shows how.";

const EXAMPLES: &str = "\
Examples:
  backlit track TAKE --out results
  backlit fit TAKE --frame 12
  backlit render --model full_body --cameras cameras.json --pose pose.json --out pictures
  backlit fit --model full_body --cameras cameras.json --start pose.json --masks masks --out fitted.json

Lengths are metres, angles radians unless a unit is given; quaternions are w x y z; frames count from 0.";

/// The program's arguments.
#[derive(Debug, Parser)]
#[command(name = "backlit", version, about = ABOUT, after_help = EXAMPLES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// One thing to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw the silhouettes that a pose predicts, one picture a camera
    Render(render::RenderArguments),
    /// Fit a pose to the silhouettes of one moment
    Fit(fit::FitArguments),
    /// Fit frame after frame of a take; report joint errors, overlap and times
    Track(track::TrackArguments),
    /// Write the silhouettes of a take as pictures
    Silhouettes(silhouettes::SilhouetteArguments),
}
