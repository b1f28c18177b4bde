//! Results of a basin as files: the same numbers as `backlit experiment basin` writes.

use backlit_tracking::experiment::basin_map::Cell;
use image::RgbaImage;
use serde::Serialize;

use super::{AnglesResult, MapResult};
use crate::plot::{Axis, Figure, HeatMap, Line};
use crate::theme::Theme;

/// Name and version of the files with the numbers.
pub const FORMAT: &str = "backlit-experiment 1";

/// A file of numbers.
#[derive(Debug, Serialize)]
struct Document<'a, O, R> {
    format: &'static str,
    experiment: &'a str,
    conditions: &'a str,
    options: &'a O,
    report: &'a R,
}

fn json<O: Serialize, R: Serialize>(
    experiment: &str,
    conditions: &str,
    options: &O,
    report: &R,
) -> anyhow::Result<Vec<u8>> {
    let document = Document { format: FORMAT, experiment, conditions, options, report };
    Ok((serde_json::to_string_pretty(&document)? + "\n").into_bytes())
}

fn csv(titles: &[&str], rows: impl Iterator<Item = Vec<String>>) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(titles)?;
    for row in rows {
        writer.write_record(&row)?;
    }
    Ok(writer.into_inner()?)
}

impl AnglesResult {
    /// Options and report.
    ///
    /// # Errors
    /// A number that is not one, which no experiment gives.
    pub fn json(&self) -> anyhow::Result<Vec<u8>> {
        json("basin of a frame", &self.about.conditions, &self.options, &self.report)
    }

    /// One row a fit.
    ///
    /// # Errors
    /// None that is known.
    pub fn csv(&self) -> anyhow::Result<Vec<u8>> {
        let titles = ["choice", "angle_deg", "root_m", "start", "error_mm", "found"];
        let rows = self.trials.iter().map(|trial| {
            let level = self.options.levels[trial.level];
            vec![
                self.options.choices[trial.choice].name.clone(),
                level.degrees.to_string(),
                level.metres.to_string(),
                trial.start.to_string(),
                trial.error_mm.to_string(),
                (trial.error_mm < self.options.success_mm).to_string(),
            ]
        });
        csv(&titles, rows)
    }

    /// The plot of success over angle.
    #[must_use]
    pub fn figure(&self) -> Figure {
        let line = |(style, choice): (usize, &backlit_tracking::experiment::frame_basin::ChoiceReport)| {
            let tried = choice.levels.iter().filter(|level| level.tried > 0);
            let points = tried
                .clone()
                .filter_map(|level| Some([f64::from(level.degrees), 100.0 * level.success?]))
                .collect();
            let bars = tried.map(|level| {
                let [low, high] = level.interval;
                [f64::from(level.degrees), 100.0 * low, 100.0 * high]
            });
            Line::of_points(&choice.name, style, points).with_bars(bars.collect())
        };
        let last = self.options.levels.last().map_or(1.0, |level| f64::from(level.degrees));
        Figure {
            title: format!("Basin: starts that end within {} mm", self.options.success_mm),
            subtitle: format!("{}; bars hold the true share 95 times of 100", self.about.conditions),
            x: Axis::linear("degrees that the start is off").within(0.0, last),
            y: Axis::linear("found, %").within(0.0, 100.0),
            lines: self.report.choices.iter().enumerate().map(line).collect(),
        }
    }
}

impl MapResult {
    /// Options and cells.
    ///
    /// # Errors
    /// A number that is not one, which no experiment gives.
    pub fn json(&self) -> anyhow::Result<Vec<u8>> {
        let cells: Vec<&Cell> = self.cells.iter().flatten().collect();
        json("basin map of a frame", &self.about.conditions, &self.options, &cells)
    }

    /// One row a cell that was fitted.
    ///
    /// # Errors
    /// None that is known.
    pub fn csv(&self) -> anyhow::Result<Vec<u8>> {
        let titles =
            ["column", "row", "across_deg", "up_deg", "start_mm", "error_mm", "found", "across", "up"];
        let rows = self.cells.iter().flatten().map(|cell| {
            vec![
                cell.place[0].to_string(),
                cell.place[1].to_string(),
                cell.offsets_degrees[0].to_string(),
                cell.offsets_degrees[1].to_string(),
                cell.start_mm.to_string(),
                cell.error_mm.to_string(),
                (cell.error_mm < self.options.success_mm).to_string(),
                self.directions[0].clone(),
                self.directions[1].clone(),
            ]
        });
        csv(&titles, rows)
    }

    /// The map as a picture, coloured by the error.
    #[must_use]
    pub fn picture(&self, theme: Theme) -> RgbaImage {
        let errors = self.cells.iter().map(|cell| cell.map(|cell| cell.error_mm)).collect();
        HeatMap {
            title: format!("Basin: distance at the end, dots are within {} mm", self.options.success_mm),
            subtitle: self.about.conditions.clone(),
            labels: self.directions.clone(),
            ends_degrees: self.options.degrees,
            columns: self.options.cells,
            values: errors,
            limit: self.options.success_mm,
        }
        .picture(theme)
    }
}
