//! Options that all experiments share, and the files that they write.

use std::path::PathBuf;

use backlit_formats::atomic;
use backlit_lab::experiment::Simulation;
use backlit_plot::Theme;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::search::start::perturb;
use clap::Args;
use serde::Serialize;

use crate::fit_options::{Words, one_of};
use crate::numbers::within;
use crate::output;
use crate::take_options::StartNoise;

// Where the results go, and how they look; a doc comment would be the help of the experiment.
#[derive(Debug, Args)]
pub(crate) struct OutputArguments {
    /// Folder to write numbers and plots to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "experiments")]
    pub(crate) out: PathBuf,
    /// Print the numbers as JSON instead of a table
    #[arg(long)]
    pub(crate) json: bool,
    /// Colours of the plots
    #[arg(long, value_parser = one_of(THEMES), default_value = "light")]
    pub(crate) theme: Theme,
}

impl OutputArguments {
    /// Writes files, then prints the table and their names, or the numbers.
    ///
    /// # Errors
    /// The folder or a file cannot be written.
    pub(crate) fn finish(
        &self,
        files: impl IntoIterator<Item = (String, Vec<u8>)>,
        numbers: &str,
        table: &str,
    ) -> anyhow::Result<()> {
        output::make_folder(&self.out)?;
        let mut written = Vec::new();
        for (name, bytes) in files {
            let path = self.out.join(name);
            atomic::write(&path, &bytes)?;
            written.push(path.display().to_string());
        }
        if self.json {
            return output::print(numbers);
        }
        output::print(&format!("{table}\nWritten: {}\n", written.join(", ")))
    }
}

/// The random starts of an experiment, which gives them defaults of its own by `mut_arg`.
#[derive(Debug, Clone, Copy, Args, Serialize)]
pub(crate) struct Starts {
    /// Number of starts [1 to 1000]
    #[arg(long, value_name = "N", required = false, value_parser = within(1..=1000_usize))]
    pub(crate) starts: usize,
    /// Seed of the random starts [0 to 4294967295]
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = within(0..=4_294_967_295_u64))]
    pub(crate) seed: u64,
    /// How far every joint of a start is turned and its root moved [0 to 180deg, 0 to 100m]
    #[arg(long, value_name = "ANGLE,DISTANCE", required = false)]
    #[serde(flatten)]
    pub(crate) start_noise: StartNoise,
}

impl Starts {
    /// A start, counted from 0, off from a pose.
    pub(crate) fn from(&self, model: &Model, pose: &Pose, start: usize) -> Pose {
        let StartNoise { angle_rad, distance_m } = self.start_noise;
        perturb(model, pose, angle_rad, distance_m, self.seed.wrapping_add(start as u64))
    }

    /// In words.
    pub(crate) fn text(&self) -> String {
        let StartNoise { angle_rad, distance_m } = self.start_noise;
        format!("{} starts {:.0}° and {:.0} cm off", self.starts, angle_rad.to_degrees(), 100.0 * distance_m)
    }

    #[cfg(test)]
    pub(crate) fn new(starts: usize, degrees: f64, distance_m: f64) -> Self {
        Self { starts, seed: 1, start_noise: StartNoise { angle_rad: degrees.to_radians(), distance_m } }
    }
}

/// Colours of plots.
const THEMES: Words<Theme> = &[("dark", "For screens", Theme::Dark), ("light", "For paper", Theme::Light)];

/// What the simulated cameras see.
pub(crate) const SIMULATIONS: Words<Simulation> = &[
    (
        "prediction",
        "The renderer's own grey levels of the true pose, as in the report's simulations",
        Simulation::Prediction,
    ),
    ("mask", "Black-and-white silhouettes, as segmentation gives them", Simulation::Mask),
];

/// Reads pixels across and down.
pub(crate) fn picture_size(text: &str) -> Result<[u64; 2], &'static str> {
    let side = |text: &str| text.parse().ok().filter(|side| (1..=4096).contains(side));
    let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
    sides.ok_or("expected WIDTHxHEIGHT, 1 to 4096 pixels each")
}

/// An experiment as the command line gives it without any argument.
#[cfg(test)]
pub(crate) fn defaults<E: Args>() -> E {
    let command = E::augment_args(clap::Command::new("experiment"));
    E::from_arg_matches(&command.get_matches_from(["experiment"])).expect("defaults for all")
}
