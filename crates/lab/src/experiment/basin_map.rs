//! The basin of one frame as a map: two angles of the body are set off on a grid, everything else stays, and every
//! cell is fitted.

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use serde::{Deserialize, Serialize};

use super::basin::leaf_error_mm;
use super::frame_basin::{Frame, Target, check_limit, targets};
use super::{ExperimentError, FitChoice};

/// Most cells across and down.
pub const MOST_CELLS: usize = 61;

/// One of a joint's three angles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Angle {
    /// About the joint's main axis.
    #[default]
    Flexion,
    /// To the side.
    Sideways,
    /// About the limb itself.
    Twist,
}

impl Angle {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Flexion, Self::Sideways, Self::Twist];
}

/// A direction of the map: an angle of a rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Direction {
    /// The rotation.
    pub rotation: usize,
    /// Which of its angles.
    pub angle: Angle,
}

impl Direction {
    /// The pose with this angle set off by so many radians.
    #[must_use]
    pub fn set_off(self, model: &Model, pose: &Pose, radians: f64) -> Pose {
        let limb = &model.limbs()[model.rotation_owners()[self.rotation]];
        let mut angles = limb.angles(pose.rotations[self.rotation]);
        match self.angle {
            Angle::Flexion => angles.flexion += radians,
            Angle::Sideways => angles.sideways += radians,
            Angle::Twist => angles.twist += radians,
        }
        let mut pose = pose.clone();
        // No turn at all is the same pose to the last bit.
        if radians != 0.0 {
            pose.rotations[self.rotation] = limb.rotation_from_angles(angles);
        }
        pose
    }
}

/// What to map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// How cells are fitted, side by side.
    pub choices: Vec<FitChoice>,
    /// What is set off across and up.
    pub directions: [Direction; 2],
    /// The farthest that is set off to either side, degrees.
    pub degrees: f64,
    /// Cells across and up; with an odd number the reference is one of them.
    pub cells: usize,
    /// Where fits are to end.
    pub target: Target,
    /// Below this mean distance a fit has found its target, millimetres.
    pub success_mm: f64,
}

impl Options {
    /// How far a column or a row is set off, degrees.
    #[must_use]
    pub fn offset_degrees(&self, place: usize) -> f64 {
        self.degrees * (2.0 * place as f64 / (self.cells - 1) as f64 - 1.0)
    }

    /// How many fits there are: every cell by every choice.
    #[must_use]
    pub fn trials(&self) -> usize {
        self.choices.len() * self.cells * self.cells
    }

    /// The cells in the order in which they are fitted, column and row: from the middle outwards.
    #[must_use]
    pub fn order(&self) -> Vec<[usize; 2]> {
        let from_middle = |place: usize| (2 * place + 1).abs_diff(self.cells);
        let mut order: Vec<[usize; 2]> =
            (0..self.cells).flat_map(|row| (0..self.cells).map(move |column| [column, row])).collect();
        order.sort_by_key(|[column, row]| from_middle(*column).max(from_middle(*row)));
        order
    }

    /// Where a cell's fit begins.
    #[must_use]
    pub fn start(&self, frame: &Frame, [column, row]: [usize; 2]) -> Pose {
        let places = [column, row];
        self.directions.iter().zip(places).fold(frame.reference.clone(), |pose, (direction, place)| {
            direction.set_off(&frame.model, &pose, self.offset_degrees(place).to_radians())
        })
    }

    fn check(&self, model: &Model) -> Result<(), ExperimentError> {
        if self.choices.is_empty() {
            return Err(ExperimentError::Option { option: "choices", value: 0.0, expected: "1 or more" });
        }
        if !(2..=MOST_CELLS).contains(&self.cells) {
            let value = self.cells as f64;
            return Err(ExperimentError::Option { option: "cells", value, expected: "2 to 61" });
        }
        if !(self.degrees > 0.0 && self.degrees <= 180.0) {
            let expected = "more than 0°, 180° at most";
            return Err(ExperimentError::Option { option: "degrees", value: self.degrees, expected });
        }
        for direction in &self.directions {
            if direction.rotation >= model.rotation_count() {
                let (value, expected) = (direction.rotation as f64, "a rotation of the body");
                return Err(ExperimentError::Option { option: "rotation", value, expected });
            }
        }
        check_limit(self.success_mm)
    }
}

/// What came of one cell by one choice.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cell {
    /// Index of the choice.
    pub choice: usize,
    /// Column and row, from the lowest offsets.
    pub place: [usize; 2],
    /// How far it was set off across and up, degrees.
    pub offsets_degrees: [f64; 2],
    /// Mean distance from the choice's target at the start, millimetres.
    pub start_mm: f64,
    /// The same at the end.
    pub error_mm: f64,
}

/// The map, ready to be fitted cell by cell.
#[derive(Debug, Clone)]
pub struct BasinMap {
    frame: Frame,
    options: Options,
    order: Vec<[usize; 2]>,
    /// Where each choice is to end.
    targets: Vec<Pose>,
}

impl BasinMap {
    /// Checks the options and finds the targets.
    ///
    /// # Errors
    /// Options that make no sense, a fit that cannot begin, or `cancel`.
    pub fn new(frame: Frame, options: Options, cancel: &CancelToken) -> Result<Self, ExperimentError> {
        options.check(&frame.model)?;
        let targets = targets(&frame, &options.choices, options.target, cancel)?;
        let order = options.order();
        Ok(Self { frame, options, order, targets })
    }

    /// How many fits there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.options.trials()
    }

    /// Whether there is no fit: never.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Makes one fit, counted so that cells go from the middle outwards and all choices go on together.
    ///
    /// # Errors
    /// A fit that cannot begin, or `cancel`.
    pub fn run(&self, index: usize, cancel: &CancelToken) -> Result<Cell, ExperimentError> {
        let (choice, place) =
            (index % self.options.choices.len(), self.order[index / self.options.choices.len()]);
        let (model, views) = (&self.frame.model, self.frame.views.clone());
        let start = self.options.start(&self.frame, place);
        let end = self.options.choices[choice].end(model, views, &start, cancel)?;
        let target = &self.targets[choice];
        Ok(Cell {
            choice,
            place,
            offsets_degrees: place.map(|place| self.options.offset_degrees(place)),
            start_mm: leaf_error_mm(model, &start, target),
            error_mm: leaf_error_mm(model, &end, target),
        })
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::fit::{FitOptions, Preset};

    use super::*;
    use crate::experiment::frame_basin::tests::frame;

    fn options(model: &Model) -> Options {
        let rotation = |name: &str| model.limbs()[model.limb_index(name).unwrap()].rotation;
        let flexion = |name| Direction { rotation: rotation(name), angle: Angle::Flexion };
        Options {
            choices: vec![FitChoice::downhill("Robust", FitOptions::preset(Preset::Robust))],
            directions: [flexion("right upper arm"), flexion("right forearm")],
            degrees: 40.0,
            cells: 3,
            target: Target::Fit,
            success_mm: 20.0,
        }
    }

    #[test]
    fn the_middle_is_the_reference_and_comes_first() {
        let frame = frame();
        let options = options(&frame.model);
        let order = options.order();
        assert_eq!((order.len(), order[0]), (9, [1, 1]));
        assert_eq!(options.start(&frame, [1, 1]), frame.reference);
        assert_eq!([0, 1, 2].map(|place| options.offset_degrees(place)), [-40.0, 0.0, 40.0]);
        let turned = options.start(&frame, [2, 1]);
        let limb = &frame.model.limbs()[frame.model.limb_index("right upper arm").unwrap()];
        let flexion = |pose: &Pose| limb.angles(pose.rotations[limb.rotation]).flexion.to_degrees();
        assert!((flexion(&turned) - flexion(&frame.reference) - 40.0).abs() < 1e-6);

        let map = BasinMap::new(frame.clone(), options.clone(), &CancelToken::new()).unwrap();
        let middle = map.run(0, &CancelToken::new()).unwrap();
        assert_eq!((middle.place, middle.offsets_degrees, middle.error_mm), ([1, 1], [0.0; 2], 0.0));
        let corner = map.run(8, &CancelToken::new()).unwrap();
        assert!(corner.start_mm > 50.0 && corner == map.run(8, &CancelToken::new()).unwrap());
    }

    #[test]
    fn choices_are_fitted_side_by_side_each_as_it_is_alone() {
        let frame = frame();
        let one = options(&frame.model);
        let report = FitChoice::downhill("Report 2004", FitOptions::preset(Preset::Report));
        let both = Options { choices: vec![one.choices[0].clone(), report.clone()], ..one.clone() };
        let alone = Options { choices: vec![report], ..one.clone() };
        let map =
            |options: &Options| BasinMap::new(frame.clone(), options.clone(), &CancelToken::new()).unwrap();
        let [both, robust, report] = [&both, &one, &alone].map(map);
        assert_eq!((both.len(), robust.len()), (18, 9));
        let run = |map: &BasinMap, index| map.run(index, &CancelToken::new()).unwrap();
        for cell in [0, 3, 8] {
            assert_eq!(run(&both, 2 * cell), run(&robust, cell));
            assert_eq!(run(&both, 2 * cell + 1), Cell { choice: 1, ..run(&report, cell) });
        }
    }

    #[test]
    fn maps_that_make_no_sense_are_named() {
        let wrong = |change: fn(&mut Options)| {
            let frame = frame();
            let mut options = options(&frame.model);
            change(&mut options);
            BasinMap::new(frame, options, &CancelToken::new()).unwrap_err().to_string()
        };
        assert!(wrong(|options| options.cells = 1).contains("cells"));
        assert!(wrong(|options| options.degrees = 0.0).contains("degrees"));
        assert!(wrong(|options| options.directions[1].rotation = 50).contains("rotation"));
        assert!(wrong(|options| options.choices.clear()).contains("choices"));
    }
}
