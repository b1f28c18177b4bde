//! Results of a basin as files, of the window and of `backlit experiment basin` alike. What is not whole says so: JSON
//! by `partial` and the count of its fits, a table by rows without a result, a picture below its title.

use backlit_plot::{self as plot, AsPicture, Axis, Figure, HeatMap, Line, Theme};
use serde::Serialize;

use super::{BasinResult, ChoiceReport, FitChoice, FitCount, RandomStarts, StartGrid, Starts, Trial};

/// Name and version of the files with the numbers.
const FORMAT: &str = "backlit-experiment 1";

/// A file of numbers.
#[derive(Debug, Serialize)]
struct ResultFile<'a, R> {
    format: &'static str,
    experiment: &'a str,
    conditions: &'a str,
    partial: bool,
    fits: FitCount,
    options: &'a super::BasinOptions,
    report: R,
}

/// A cell of a grid, as it is written.
#[derive(Debug, Serialize)]
struct Cell {
    choice: usize,
    place: [usize; 2],
    offsets_degrees: [f64; 2],
    start_mm: f64,
    error_mm: f64,
}

/// A field of a table; empty where there is nothing.
fn text(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

impl BasinResult {
    /// Options and report.
    ///
    /// # Errors
    /// Returns an error if a number is not finite; no experiment gives one.
    pub fn json(&self) -> anyhow::Result<Vec<u8>> {
        match &self.options.starts {
            Starts::Random(_) => self.json_of("basin of a frame", &self.report),
            Starts::Grid(grid) => {
                let cell = |trial: &Trial| Cell {
                    choice: trial.choice,
                    place: trial.place,
                    offsets_degrees: trial.place.map(|index| grid.offset_degrees(index)),
                    start_mm: trial.start_mm,
                    error_mm: trial.error_mm,
                };
                let cells: Vec<Cell> = self.trials.iter().flatten().map(cell).collect();
                self.json_of("basin map of a frame", cells)
            }
        }
    }

    fn json_of(&self, experiment: &str, report: impl Serialize) -> anyhow::Result<Vec<u8>> {
        let file = ResultFile {
            format: FORMAT,
            experiment,
            conditions: &self.conditions,
            partial: !self.fits().is_whole(),
            fits: self.fits(),
            options: &self.options,
            report,
        };
        Ok((serde_json::to_string_pretty(&file)? + "\n").into_bytes())
    }

    /// One row a fit of each choice; those that were not made have no result.
    ///
    /// # Errors
    /// Returns an error if the table cannot be written to memory.
    pub fn csv(&self) -> anyhow::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let each = self.options.starts.count();
        let rows = self.trials.iter().enumerate();
        let rows = rows.map(|(index, trial)| (&self.options.choices[index / each].name, index % each, trial));
        match &self.options.starts {
            Starts::Random(random) => {
                writer.write_record(["choice", "angle_deg", "root_m", "start", "error_mm", "found"])?;
                for (name, index, trial) in rows {
                    let level = random.levels[index / random.starts];
                    writer.write_record([
                        name.clone(),
                        level.degrees.to_string(),
                        level.metres.to_string(),
                        (index % random.starts).to_string(),
                        text(trial.map(|trial| trial.error_mm)),
                        text(trial.map(|trial| self.is_found(&trial))),
                    ])?;
                }
            }
            Starts::Grid(grid) => {
                writer.write_record([
                    "choice",
                    "column",
                    "row",
                    "across_deg",
                    "up_deg",
                    "start_mm",
                    "error_mm",
                    "found",
                    "across",
                    "up",
                ])?;
                let [across, up] = self.directions(grid);
                for (name, index, trial) in rows {
                    let (column, row) = (index % grid.cells, index / grid.cells);
                    writer.write_record([
                        name.clone(),
                        column.to_string(),
                        row.to_string(),
                        grid.offset_degrees(column).to_string(),
                        grid.offset_degrees(row).to_string(),
                        text(trial.map(|trial| trial.start_mm)),
                        text(trial.map(|trial| trial.error_mm)),
                        text(trial.map(|trial| self.is_found(&trial))),
                        across.clone(),
                        up.clone(),
                    ])?;
                }
            }
        }
        Ok(writer.into_inner()?)
    }

    /// The plot of success over angle, or the map of every choice, as a PNG.
    ///
    /// # Errors
    /// Returns an error if the picture cannot be encoded.
    pub fn png(&self, theme: Theme) -> anyhow::Result<Vec<u8>> {
        Ok(match &self.options.starts {
            Starts::Random(random) => plot::png(self.figure(random).picture(theme))?,
            Starts::Grid(grid) => plot::png(self.heat_map(grid).picture(theme))?,
        })
    }

    /// Names of a grid's directions across and up.
    #[must_use]
    pub fn directions(&self, grid: &StartGrid) -> [String; 2] {
        grid.directions.map(|direction| direction.name(&self.subject.model))
    }

    /// The conditions, behind what is missing if anything is.
    fn subtitle(&self, conditions: &str) -> String {
        let partial = self.fits().partial_text();
        partial.map_or_else(|| conditions.to_owned(), |partial| format!("{partial}. {conditions}"))
    }

    /// Success over angle.
    #[must_use]
    pub fn figure(&self, random: &RandomStarts) -> Figure {
        let line = |(style, choice): (usize, &ChoiceReport)| {
            let tried = choice.levels.iter().filter(|level| level.rate.tried > 0);
            let degrees = |level: &super::LevelReport| f64::from(level.level.degrees);
            let points =
                tried.clone().filter_map(|level| Some([degrees(level), 100.0 * level.rate.success?]));
            let bars = tried.clone().map(|level| {
                let [low, high] = level.rate.interval;
                [degrees(level), 100.0 * low, 100.0 * high]
            });
            Line::of_points(&choice.name, style, points.collect()).with_bars(bars.collect())
        };
        let last = random.levels.last().map_or(1.0, |level| f64::from(level.degrees));
        Figure {
            title: format!("Basin: starts that end within {} mm", self.options.success_mm),
            subtitle: self.subtitle(&format!("{}; bars are 95 % confidence intervals", self.conditions)),
            x: Axis::linear("degrees that the start is off").within(0.0, last),
            y: Axis::linear("found, %").within(0.0, 100.0),
            lines: self.report.choices.iter().enumerate().map(line).collect(),
        }
    }

    fn heat_map(&self, grid: &StartGrid) -> HeatMap {
        let map = |(index, choice): (usize, &FitChoice)| {
            let [tried, found] = self.counts(index);
            let errors = self.trials_of(index).iter().map(|trial| trial.map(|trial| trial.error_mm));
            (format!("{}: {found} of {tried} found", choice.name), errors.collect())
        };
        HeatMap {
            title: format!("Basin: distance at the end, dots are within {} mm", self.options.success_mm),
            subtitle: self.subtitle(&self.conditions),
            labels: self.directions(grid),
            ends_degrees: grid.degrees,
            columns: grid.cells,
            maps: self.options.choices.iter().enumerate().map(map).collect(),
            limit: self.options.success_mm,
        }
    }
}
