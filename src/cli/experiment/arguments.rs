//! Options that all experiments share.

use std::path::PathBuf;

use backlit_tracking::experiment::Simulation;
use clap::{Args, ValueEnum};

use crate::theme::Theme;

/// Where the results go, and how they look.
#[derive(Debug, Args)]
pub struct OutputArguments {
    /// Folder to write numbers and plots to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "experiments")]
    pub out: PathBuf,
    /// Print the numbers as JSON instead of a table
    #[arg(long)]
    pub json: bool,
    /// Colours of the plots
    #[arg(long, value_enum, default_value_t = ThemeWord::Light)]
    pub theme: ThemeWord,
}

/// The random starts of an experiment.
#[derive(Debug, Clone, Copy, Args)]
pub struct StartArguments {
    /// Seed of the random starts
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// How many starts
    #[arg(long, value_name = "N")]
    pub starts: Option<usize>,
}

/// Dark or light.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum ThemeWord {
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
pub enum DataWord {
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
