//! `backlit experiment basin`: how far off a start may be, and still end at the truth.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use backlit_formats::memory;
use backlit_formats::starts_file::{self, Start};
use backlit_lab::experiment::starts::Draw;
use backlit_plot::{Axis, Figure, FigureOrSheet, Line};
use backlit_runs::basin::{FitChoice, SUCCESS_MM, Subject, SuccessRate};
use backlit_tracking::fit::{FitView, Preset};
use backlit_tracking::render::RendererKind;
use backlit_tracking::search::SearchOptions;
use backlit_tracking::search::start::{LEVELS, Level};
use clap::Args;
use serde::Serialize;

use super::arguments::{OutputArguments, picture_size};
use super::frame_basin::FrameArguments;
use super::{Experiment, Run};
use crate::fit_options::solid_help;
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;

/// Most starts of an angle.
const MOST_STARTS: usize = 1000;
/// Bytes of a pixel that a drawn scene keeps.
const BYTES_A_PIXEL: u64 = 8;

/// How far off a start may be: share of starts that end at the truth, by distance and number of cameras
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Numbers of cameras [1 to 64]
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_values_t = [1, 2, 4], value_parser = within(1..=64_usize))]
    cameras: Vec<usize>,
    /// How far every joint of the starts is turned, degrees: of 5, 10, 20, 30 and 45, which go with 2, 5, 10,
    /// 15 and 20 cm of the root; with --take any whole degrees [1 to 180] [default: all five]
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', conflicts_with = "map", value_parser = within(1..=180_u32))]
    angles: Vec<u32>,
    /// Starts of every angle [1 to 1000]; or a file of starts with their truth and masks, of which all are taken
    #[arg(long, value_name = "N|FILE", default_value = "40", conflicts_with = "map")]
    starts: String,
    /// Seed of poses, cameras and starts that are drawn [0 to 4294967295]
    #[arg(long, value_name = "S", default_value_t = 1, conflicts_with = "map", value_parser = within(0..=4_294_967_295_u64))]
    seed: u64,
    /// Size of the pictures that are drawn, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = picture_size, default_value = "48x36")]
    size: [u64; 2],
    /// Set of choices: report (as in 2004) or robust
    #[arg(long, default_value_t = Preset::Robust)]
    preset: Preset,
    #[arg(long, value_name = "SOLID", help = solid_help(), default_value_t)]
    renderer: RendererKind,
    /// Go downhill from the start alone, without a search for other hypotheses
    #[arg(long)]
    downhill: bool,
    /// Ignore the starts: the search begins in the visual hull. On all cores
    #[arg(long, conflicts_with_all = ["downhill", "unscaled", "take"])]
    no_start: bool,
    /// Leave the preset's annealing as it is, whatever the size of the pictures
    #[arg(long)]
    unscaled: bool,
    #[command(flatten)]
    frame: FrameArguments,
    #[command(flatten)]
    output: OutputArguments,
}

/// Drawn scenes, or those of a file of starts.
#[derive(Debug, Serialize)]
struct Basins {
    cameras: Vec<usize>,
    preset: Preset,
    renderer: RendererKind,
    scaled: bool,
    hypotheses: Option<SearchOptions>,
    no_start: bool,
    starts: String,
    draw: Option<Draw>,
    #[serde(skip)]
    given: Vec<Start>,
    #[serde(skip)]
    choice: FitChoice,
}

/// One entry a number of cameras.
#[derive(Debug, Serialize)]
struct Report {
    basins: Vec<CameraBasin>,
}

/// The basin with one number of cameras.
#[derive(Debug, Serialize)]
struct CameraBasin {
    cameras: usize,
    /// Share of starts that found their truth, by degrees off.
    success: BTreeMap<u32, f64>,
    /// Median of the mean distances, by degrees off.
    median_mm: BTreeMap<u32, f64>,
    /// Mean wall time of a start, milliseconds.
    ms_per_start: f64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let (preset, renderer) = (self.preset, self.renderer);
        let mut choice = FitChoice::best_of(preset);
        choice.fit.renderer = renderer;
        let scaled = preset == Preset::Robust && !self.unscaled;
        choice.fit.to_scale &= scaled;
        choice.ignores_start = self.no_start;
        if self.downhill {
            choice.hypotheses = None;
        }
        if let Some(take) = &self.frame.take {
            return self.frame.run(take, (&self.angles, &self.starts, self.seed), choice, &self.output);
        }
        let (given, draw) = starts_of(&self.starts, &self.angles, (&self.cameras, self.size, self.seed))?;
        let (cameras, no_start, starts) = (self.cameras, self.no_start, self.starts);
        let hypotheses = choice.hypotheses.clone();
        Basins { cameras, preset, renderer, scaled, hypotheses, no_start, starts, draw, given, choice }
            .perform(&self.output)
    }
}

impl Experiment for Basins {
    const NAME: &'static str = "basin";
    type Report = Report;

    /// Fits all starts with each number of cameras, one after the other on one core; without starts on all cores.
    fn run(&mut self, run: &Run) -> Result<Report> {
        let total = self.cameras.len() * self.given.len();
        let mut basins = Vec::with_capacity(self.cameras.len());
        for (index, &cameras) in self.cameras.iter().enumerate() {
            let subject = |start: &Start| {
                let (views, reference) = (views_of(start, cameras)?.to_vec(), start.truth.clone());
                Ok(Subject { model: start.model.clone(), views, reference })
            };
            let subjects: Vec<Subject> = self.given.iter().map(subject).collect::<Result<_>>()?;
            let mut errors: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
            let mut seconds = 0.0;
            for (trial, (start, subject)) in self.given.iter().zip(&subjects).enumerate() {
                run.progress(index * self.given.len() + trial, total)?;
                let began = Instant::now();
                let error_mm = self.choice.error_mm(subject, &start.start, &subject.reference, &run.cancel);
                seconds += began.elapsed().as_secs_f64();
                run.check()?;
                errors.entry(start.degrees).or_default().push(error_mm?);
            }
            let rate = |(degrees, errors)| (degrees, SuccessRate::of(errors, SUCCESS_MM));
            let rates: Vec<(u32, SuccessRate)> = errors.into_iter().map(rate).collect();
            let by_degrees = |value: fn(&SuccessRate) -> Option<f64>| {
                rates.iter().map(|(degrees, rate)| (*degrees, value(rate).unwrap_or_default())).collect()
            };
            basins.push(CameraBasin {
                cameras,
                success: by_degrees(|rate| rate.success),
                median_mm: by_degrees(|rate| rate.median_mm),
                ms_per_start: 1e3 * seconds / self.given.len().max(1) as f64,
            });
        }
        Ok(Report { basins })
    }

    fn table(&self, report: &Report) -> String {
        let row = |basin| move |(degrees, success)| (basin, degrees, success);
        Table::of(
            report.basins.iter().flat_map(|basin| basin.success.iter().map(row(basin))),
            &[
                ("cameras, start off by", &|(basin, degrees, _): &(&CameraBasin, &u32, &f64)| {
                    format!("{}, {degrees}°", basin.cameras)
                }),
                ("found, %", &|(_, _, success)| number(100.0 * **success, 1)),
                ("median, mm", &|(basin, degrees, _)| {
                    number(basin.median_mm.get(degrees).copied().unwrap_or_default(), 1)
                }),
                ("ms a start", &|(basin, ..)| number(basin.ms_per_start, 1)),
            ],
        )
    }

    fn pictures(&self, report: &Report) -> Vec<(String, FigureOrSheet)> {
        let line = |(style, basin): (usize, &CameraBasin)| {
            let name = if basin.cameras == 1 { "one camera" } else { &format!("{} cameras", basin.cameras) };
            let points = basin.success.iter().map(|(&degrees, &found)| [f64::from(degrees), 100.0 * found]);
            Line::of_points(name, style, points.collect())
        };
        let figure = Figure {
            title: "Basin: starts that end within 20 mm of the truth".to_owned(),
            subtitle: format!("upper body, {} starts", self.given.len()),
            x: Axis::linear("degrees that every joint of the start is off"),
            y: Axis::linear("found, %"),
            lines: report.basins.iter().enumerate().map(line).collect(),
        };
        vec![("basin".to_owned(), FigureOrSheet::Figure(figure))]
    }

    /// One object a number of cameras: by itself if there is one, else a list.
    fn printed(&self, report: &Report, _numbers: &str) -> Result<String> {
        Ok(match report.basins.as_slice() {
            [one] => serde_json::to_string_pretty(one)?,
            several => serde_json::to_string_pretty(several)?,
        } + "\n")
    }
}

/// Starts by number or from a file, of some angles (none: of all). `scenes` has the cameras, pixels and seed of drawn ones.
///
/// # Errors
/// Returns an error if the file cannot be read, or if no start has one of the angles.
pub(super) fn starts_of(
    starts: &str,
    angles: &[u32],
    scenes: (&[usize], [u64; 2], u64),
) -> Result<(Vec<Start>, Option<Draw>)> {
    let (cameras, size_px, seed) = scenes;
    let wanted = |degrees: u32| angles.is_empty() || angles.contains(&degrees);
    let Some(count) = count_of(starts)? else {
        let mut found = starts_file::read(&PathBuf::from(starts))?;
        found.retain(|start| wanted(start.degrees));
        ensure!(!found.is_empty(), "{starts} has no start of --angles");
        return Ok((found, None));
    };
    let levels = if angles.is_empty() { LEVELS.to_vec() } else { levels_of(angles)? };
    let [width, height] = size_px;
    let pictures = count * levels.len() * cameras.iter().sum::<usize>();
    memory::afford(BYTES_A_PIXEL * width * height * pictures as u64)
        .context("--starts, --cameras and --size")?;
    let draw = Draw { starts: count, levels, cameras: cameras.to_vec(), size_px, seed };
    Ok((draw.draw()?, Some(draw)))
}

/// How many starts a word asks for; `None` where it names a file.
///
/// # Errors
/// The number is out of range.
pub(super) fn count_of(starts: &str) -> Result<Option<usize>> {
    if !starts.bytes().all(|letter| letter.is_ascii_digit()) {
        return Ok(None);
    }
    let count = starts.parse().ok().filter(|count| (1..=MOST_STARTS).contains(count));
    Ok(Some(
        count.with_context(|| {
            format!("--starts: expected a whole number from 1 to {MOST_STARTS}, or a file")
        })?,
    ))
}

/// What this many cameras see of a start's truth.
pub(super) fn views_of(start: &Start, cameras: usize) -> Result<&[FitView]> {
    let views = start.views.get(&cameras).with_context(|| {
        format!("`cameras` is {cameras}; expected a number of cameras that the starts have")
    })?;
    Ok(views)
}

/// How far starts of these angles are off.
pub(super) fn levels_of(angles: &[u32]) -> Result<Vec<Level>> {
    let wanted = |level: &Level| angles.contains(&level.degrees);
    let levels: Vec<Level> = LEVELS.into_iter().filter(wanted).collect();
    ensure!(!levels.is_empty(), "--angles: expected some of 5, 10, 20, 30 and 45");
    Ok(levels)
}
