//! `backlit experiment basin --take --map`: the map of two angles, as the window's Basin pane has it.

use std::fmt::Write as _;
use std::path::Path;
use std::str::FromStr;

use backlit_lab::experiment::FitChoice;
use backlit_lab::experiment::basin_map::{Angle, BasinMap, Direction, Options};
use backlit_results::basin::{MapResult, angle_name, direction_name};
use backlit_tracking::body::Model;
use backlit_tracking::cancel::CancelToken;

use super::arguments::OutputArguments;
use super::files::{self, ResultFiles};
use super::frame_basin::{FrameArguments, Subject, all_of, rotation_of};

/// Two angles of the body: across and up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MapAngles(pub(crate) [(String, Angle); 2]);

/// What is wrong with the words of a map.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected two angles as JOINT.AXIS,JOINT.AXIS, with flexion, sideways or twist for AXIS")]
pub(crate) struct ParseMapError;

impl FromStr for MapAngles {
    type Err = ParseMapError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let angle = |text: &str| {
            let (joint, axis) = text.trim().rsplit_once('.')?;
            let angle = Angle::ALL.into_iter().find(|angle| angle_name(*angle) == axis)?;
            (!joint.is_empty()).then(|| (joint.to_owned(), angle))
        };
        let (across, up) = text.split_once(',').ok_or(ParseMapError)?;
        match (angle(across), angle(up)) {
            (Some(across), Some(up)) => Ok(Self([across, up])),
            _ => Err(ParseMapError),
        }
    }
}

/// Fits the map, writes and prints.
///
/// # Errors
/// Options that make no sense, a take that cannot be read, or files that cannot be written.
pub(crate) fn run(
    arguments: &FrameArguments,
    path: &Path,
    choice: FitChoice,
    output: &OutputArguments,
) -> anyhow::Result<()> {
    let Subject { frame, target, about } = arguments.subject(path)?;
    let options = Options {
        choices: arguments.choices(choice)?,
        directions: directions(arguments, &frame.model)?,
        degrees: arguments.farthest,
        cells: arguments.cells,
        target,
        success_mm: arguments.within,
    };
    let map = BasinMap::new(frame.clone(), options.clone(), &CancelToken::new())?;
    let names = options.directions.map(|one| direction_name(&frame.model, one));
    let mut result = MapResult::new(about, options, frame, names);
    for cell in all_of(map.len(), |index| map.run(index, &CancelToken::new()))? {
        result.add(cell);
    }
    let png = backlit_plot::png(result.picture(output.theme.into()))?;
    let files = ResultFiles { json: result.json()?, csv: result.csv()?, png };
    files::finish_result(output, "basin-map", &files, &picture_of_letters(&result))
}

fn directions(arguments: &FrameArguments, model: &Model) -> anyhow::Result<[Direction; 2]> {
    let Some(MapAngles([across, up])) = &arguments.map else { anyhow::bail!("--map: expected two angles") };
    let direction = |(joint, angle): &(String, Angle)| {
        rotation_of(model, joint, "--map").map(|rotation| Direction { rotation, angle: *angle })
    };
    Ok([direction(across)?, direction(up)?])
}

/// Every choice's map in letters, and how many of its cells found home.
fn picture_of_letters(result: &MapResult) -> String {
    let options = &result.options;
    let mut text = format!(
        "Across: {}. Up: {}. Both from {} to {} degrees. o: ends within {} mm\n",
        result.directions[0], result.directions[1], -options.degrees, options.degrees, options.success_mm
    );
    for (index, choice) in options.choices.iter().enumerate() {
        let [tried, found] = result.counts(index);
        let _ = writeln!(text, "\n{}: {found} of {tried}", choice.name);
        for row in (0..options.cells).rev() {
            let letter = |column| match result.cell(index, [column, row]) {
                Some(cell) if cell.error_mm < options.success_mm => "o",
                _ => ".",
            };
            let letters: Vec<&str> = (0..options.cells).map(letter).collect();
            text += &(letters.join(" ") + "\n");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_angles_are_read() {
        let angles = |text: &str| text.parse::<MapAngles>();
        let expected = [("right forearm".to_owned(), Angle::Flexion), ("neck".to_owned(), Angle::Twist)];
        assert_eq!(angles("right forearm.flexion, neck.twist"), Ok(MapAngles(expected)));
        for wrong in ["", "neck.twist", "neck.twist,neck", "neck.turn,neck.twist", ".twist,neck.twist"] {
            assert_eq!(angles(wrong), Err(ParseMapError), "{wrong}");
        }
    }
}
