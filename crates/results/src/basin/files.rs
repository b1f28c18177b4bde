//! Results of a basin as files, of the window and of `backlit experiment basin` alike. What is not whole says so: JSON
//! by `partial` and the count of its fits, a table by rows without a result, a picture below its title.

use std::collections::BTreeMap;

use backlit_lab::experiment::FitChoice;
use backlit_lab::experiment::basin_map::Cell;
use backlit_lab::experiment::frame_basin::ChoiceReport;
use backlit_plot::Theme;
use backlit_plot::{AsPicture, Axis, Figure, HeatMap, Line};
use image::RgbaImage;
use serde::Serialize;

use super::results::{AnglesResult, FitCount, MapResult};

/// Name and version of the files with the numbers.
pub const FORMAT: &str = "backlit-experiment 1";

/// The conditions, behind what is missing if anything is.
fn subtitle(fits: FitCount, conditions: &str) -> String {
    fits.partial_text().map_or_else(|| conditions.to_owned(), |partial| format!("{partial}. {conditions}"))
}

/// A file of numbers.
#[derive(Debug, Serialize)]
struct Document<'a, O, R> {
    format: &'static str,
    experiment: &'a str,
    conditions: &'a str,
    partial: bool,
    fits: FitCount,
    options: &'a O,
    report: &'a R,
}

fn json<O: Serialize, R: Serialize>(
    experiment: &str,
    conditions: &str,
    fits: FitCount,
    options: &O,
    report: &R,
) -> anyhow::Result<Vec<u8>> {
    let partial = !fits.is_whole();
    let document = Document { format: FORMAT, experiment, conditions, partial, fits, options, report };
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

/// A field of a table; empty where there is nothing.
fn text(value: Option<impl ToString>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

impl AnglesResult {
    /// Options and report.
    ///
    /// # Errors
    /// A number that is not one, which no experiment gives.
    pub fn json(&self) -> anyhow::Result<Vec<u8>> {
        json("basin of a frame", &self.about.conditions, self.fits(), &self.options, &self.report)
    }

    /// One row a fit; those that were not made have no result.
    ///
    /// # Errors
    /// None that is known.
    pub fn csv(&self) -> anyhow::Result<Vec<u8>> {
        let titles = ["choice", "angle_deg", "root_m", "start", "error_mm", "found"];
        let made: BTreeMap<[usize; 3], f64> = self
            .trials
            .iter()
            .map(|trial| ([trial.choice, trial.level, trial.start], trial.error_mm))
            .collect();
        let options = &self.options;
        let places = (0..options.choices.len()).flat_map(|choice| {
            let starts = move |level| (0..options.starts).map(move |start| [choice, level, start]);
            (0..options.levels.len()).flat_map(starts)
        });
        let rows = places.map(|place @ [choice, level, start]| {
            let error = made.get(&place).copied();
            let level = options.levels[level];
            vec![
                options.choices[choice].name.clone(),
                level.degrees.to_string(),
                level.metres.to_string(),
                start.to_string(),
                text(error),
                text(error.map(|error| error < options.success_mm)),
            ]
        });
        csv(&titles, rows)
    }

    /// The plot of success over angle.
    pub fn figure(&self) -> Figure {
        let line = |(style, choice): (usize, &ChoiceReport)| {
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
            subtitle: subtitle(
                self.fits(),
                &format!("{}; bars are 95 % confidence intervals", self.about.conditions),
            ),
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
        json("basin map of a frame", &self.about.conditions, self.fits(), &self.options, &cells)
    }

    /// One row a cell of each choice; those that were not fitted have no result.
    ///
    /// # Errors
    /// None that is known.
    pub fn csv(&self) -> anyhow::Result<Vec<u8>> {
        let titles = [
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
        ];
        let count = self.options.cells;
        let places = (0..self.options.choices.len())
            .flat_map(|choice| (0..count * count).map(move |cell| (choice, [cell % count, cell / count])));
        let rows = places.map(|(choice, place)| {
            let cell = self.cell(choice, place);
            let [column, row] = place;
            vec![
                self.options.choices[choice].name.clone(),
                column.to_string(),
                row.to_string(),
                self.options.offset_degrees(column).to_string(),
                self.options.offset_degrees(row).to_string(),
                text(cell.map(|cell| cell.start_mm)),
                text(cell.map(|cell| cell.error_mm)),
                text(cell.map(|cell| cell.error_mm < self.options.success_mm)),
                self.directions[0].clone(),
                self.directions[1].clone(),
            ]
        });
        csv(&titles, rows)
    }

    /// The map of every choice as one picture, coloured by the error.
    pub fn picture(&self, theme: Theme) -> RgbaImage {
        let map = |(index, choice): (usize, &FitChoice)| {
            let cells = self.cells_of(index).iter();
            let [tried, found] = self.counts(index);
            let name = format!("{}: {found} of {tried} found", choice.name);
            (name, cells.map(|cell| cell.map(|cell| cell.error_mm)).collect())
        };
        HeatMap {
            title: format!("Basin: distance at the end, dots are within {} mm", self.options.success_mm),
            subtitle: subtitle(self.fits(), &self.about.conditions),
            labels: self.directions.clone(),
            ends_degrees: self.options.degrees,
            columns: self.options.cells,
            maps: self.options.choices.iter().enumerate().map(map).collect(),
            limit: self.options.success_mm,
        }
        .picture(theme)
    }
}
