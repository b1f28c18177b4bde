//! The commands and their help.

use clap::{Parser, Subcommand};

use super::{fit, render};

const ABOUT: &str = "Fits an articulated body to its silhouettes and shows how.";

const EXAMPLES: &str = "\
Examples:
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
#[expect(clippy::large_enum_variant, reason = "there is one, for a moment")]
pub enum Command {
    /// Draw the silhouettes that a pose predicts, one picture a camera
    Render(render::RenderArguments),
    /// Fit a pose to the silhouettes of one moment
    Fit(fit::FitArguments),
}
