//! Options of the experiments that run on a sequence: a take, or the simulated upper body.

use std::path::PathBuf;

use anyhow::ensure;
use backlit_formats::Take;
use backlit_lab::experiment::fig55::Way;
use backlit_lab::experiment::looks::Look;
use backlit_lab::experiment::sequence::Sequence;
use backlit_tracking::fit::{DataView, FitOptions};
use clap::Args;
use serde::Serialize;

use crate::take_options::{self, PartArguments, StartArguments};

/// Cameras, as in the report.
const CAMERAS: usize = 2;

/// Which sequence.
#[derive(Debug, Args)]
pub(crate) struct SequenceArguments {
    /// A take instead of the simulated upper body: its folder or its take.toml
    #[arg(long, value_name = "TAKE")]
    take: Option<PathBuf>,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL", requires = "take")]
    model: Option<String>,
    /// Names of the take's cameras, with commas [default: the first two]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "take")]
    cameras: Option<Vec<String>>,
    /// Radius of the box over which the report's fit smooths its masks, pixels; 0: not at all
    #[arg(long, value_name = "PX", default_value_t = 1)]
    smoothing: usize,
}

/// What was run on, for the file with the numbers.
#[derive(Debug, Serialize)]
pub(crate) struct Conditions<'a, O> {
    #[serde(flatten)]
    pub(crate) options: &'a O,
    pub(crate) sequence: &'a str,
    pub(crate) cameras: Vec<&'a str>,
    pub(crate) size_px: [usize; 2],
    pub(crate) frames: usize,
}

impl<'a, O> Conditions<'a, O> {
    pub(crate) fn of(options: &'a O, sequence: &'a Sequence) -> Self {
        let views = sequence.moments.first().map(|moment| moment.views.as_slice()).unwrap_or_default();
        let size = |view: &backlit_tracking::fit::FitView| [view.camera.width(), view.camera.height()];
        Self {
            options,
            sequence: &sequence.name,
            cameras: views.iter().map(|view| view.camera.name()).collect(),
            size_px: views.first().map_or([0, 0], size),
            frames: sequence.moments.len(),
        }
    }

    /// In words.
    pub(crate) fn text(&self) -> String {
        let ([width, height], cameras) = (self.size_px, self.cameras.join(" and "));
        format!("{}, {cameras}, {width} × {height} pixels", self.sequence)
    }
}

impl SequenceArguments {
    /// The first frames, in pictures of this size.
    ///
    /// # Errors
    /// A take that cannot be read or does not have what is asked for.
    pub(crate) fn sequence(&self, size_px: [u64; 2], frames: usize) -> anyhow::Result<Sequence> {
        let Some(path) = &self.take else { return Ok(Sequence::simulated(size_px, CAMERAS, frames)?) };
        let footage = take_options::open_with_model(path, self.model.as_deref())?;
        let take: &Take = footage.take();
        ensure!(frames <= take.frame_count(), "--frames {frames}: the take has {}", take.frame_count());
        let names = PartArguments { frames: None, every: 1, cameras: self.cameras.clone() };
        let mut cameras = names.cameras(take)?;
        if self.cameras.is_none() {
            cameras.truncate(CAMERAS);
        }
        let start = StartArguments::none().pose(&footage, &cameras, 0, &FitOptions::default())?;
        Ok(Sequence::of_take(&footage, &cameras, frames, start, size_px)?)
    }

    /// The ways, the report's smoothed as asked for.
    pub(crate) fn smoothed(&self, mut ways: Vec<Way>) -> Vec<Way> {
        for stage in ways.iter_mut().flat_map(|way| &mut way.fit.stages) {
            if let DataView::Averaged { radius_px } = &mut stage.data {
                *radius_px = self.smoothing;
            }
        }
        ways
    }
}

/// What a reader must know of a sheet's pictures.
pub(crate) fn legend(columns: &[Vec<Look>]) -> &'static str {
    if columns.iter().flatten().any(|look| look.hides) { "; light grey in D: not known" } else { "" }
}

/// Rows of D and Λ, camera by camera, from the columns of a sheet.
pub(crate) fn rows(cameras: &[&str], columns: &[Vec<Look>]) -> Vec<(String, Vec<image::GrayImage>)> {
    let row = |name: String, picture: &dyn Fn(&Look) -> image::GrayImage, camera: usize| {
        (name, columns.iter().filter_map(|looks| looks.get(camera)).map(picture).collect())
    };
    let of_camera = |(camera, name): (usize, &&str)| {
        [
            row(format!("{name} D"), &|look| look.data.clone(), camera),
            row(format!("{name} Λ"), &|look| look.prediction.clone(), camera),
        ]
    };
    cameras.iter().enumerate().flat_map(of_camera).collect()
}

/// What a file of a way's pictures is called: its first word.
pub(crate) fn short_name(way: &str) -> String {
    way.split([' ', ',']).next().unwrap_or_default().to_lowercase()
}
