//! Options that all experiments share.

use std::path::PathBuf;
use std::str::FromStr;

use backlit_lab::experiment::Simulation;
use backlit_plot::Theme;
use clap::{Args, ValueEnum};

use crate::take_options::StartNoise;

/// Where the results go, and how they look.
#[derive(Debug, Args)]
pub(crate) struct OutputArguments {
    /// Folder to write numbers and plots to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "experiments")]
    pub(crate) out: PathBuf,
    /// Print the numbers as JSON instead of a table
    #[arg(long)]
    pub(crate) json: bool,
    /// Colours of the plots
    #[arg(long, value_enum, default_value_t = ThemeWord::Light)]
    pub(crate) theme: ThemeWord,
}

/// The random starts of an experiment.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct StartArguments {
    /// Seed of the random starts
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of starts [default: the experiment's own]
    #[arg(long, value_name = "N")]
    pub(crate) starts: Option<usize>,
    /// How far every joint of a start is turned and its root moved, e.g. 5deg,3cm [default: the experiment's own]
    #[arg(long, value_name = "ANGLE,DISTANCE")]
    pub(crate) start_noise: Option<StartNoise>,
}

impl StartArguments {
    /// How many starts, or as many as the experiment has; and radians and metres that they are off, likewise.
    pub(crate) fn or(&self, starts: usize, angle_rad: f64, distance_m: f64) -> (usize, f64, f64) {
        let noise = self.start_noise.unwrap_or(StartNoise { angle_rad, distance_m });
        (self.starts.unwrap_or(starts), noise.angle_rad, noise.distance_m)
    }
}

/// Dark or light.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum ThemeWord {
    /// For screens.
    Dark,
    /// For paper.
    Light,
}

impl From<ThemeWord> for Theme {
    fn from(word: ThemeWord) -> Self {
        match word {
            ThemeWord::Dark => Self::Dark,
            ThemeWord::Light => Self::Light,
        }
    }
}

/// What the simulated cameras see.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum DataWord {
    /// The renderer's own grey levels of the true pose, as in the report's simulations
    Prediction,
    /// Black-and-white silhouettes, as segmentation gives them
    Mask,
}

impl From<DataWord> for Simulation {
    fn from(word: DataWord) -> Self {
        match word {
            DataWord::Prediction => Self::Prediction,
            DataWord::Mask => Self::Mask,
        }
    }
}

/// Pixels across and down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PictureSize(pub(crate) [u64; 2]);

impl FromStr for PictureSize {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let side = |text: &str| text.parse().ok().filter(|side| (1..=4096).contains(side));
        let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
        sides.map(Self).ok_or("expected WIDTHxHEIGHT, 1 to 4096 pixels each")
    }
}
