//! Starts about a subject's reference: random by level, or on a grid of two angles.

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::search::start::{Level, perturb};
use serde::{Deserialize, Serialize};

use super::{BasinError, Subject, at_least_one, check};

/// Most cells of a grid across and up.
pub const MOST_CELLS: usize = 61;

/// The starts of a subject. Each has a place of two indices.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Starts {
    /// Drawn at random: the place is level and number.
    Random(RandomStarts),
    /// Two angles set off: the place is column and row, from the lowest offsets.
    Grid(StartGrid),
}

impl Starts {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Random(random) => random.levels.len() * random.starts,
            Self::Grid(grid) => grid.cells * grid.cells,
        }
    }

    /// Where a start is found in a list by level, then by number; or by row, then by column.
    #[must_use]
    pub fn index(&self, [first, second]: [usize; 2]) -> usize {
        match self {
            Self::Random(random) => first * random.starts + second,
            Self::Grid(grid) => second * grid.cells + first,
        }
    }

    /// All places in the order in which they are fitted: all levels go on together, a grid from the middle outwards.
    #[must_use]
    pub fn places(&self) -> Vec<[usize; 2]> {
        match self {
            Self::Random(random) => (0..random.starts)
                .flat_map(|start| (0..random.levels.len()).map(move |level| [level, start]))
                .collect(),
            Self::Grid(grid) => grid.places(),
        }
    }

    /// Where the fit at a place begins.
    #[must_use]
    pub fn pose(&self, subject: &Subject, place: [usize; 2]) -> Pose {
        match self {
            Self::Random(random) => random.pose(subject, place),
            Self::Grid(grid) => grid.pose(subject, place),
        }
    }

    /// # Errors
    /// Returns an error if there is nothing to try or an option is out of range.
    pub(super) fn validate(&self, model: &Model) -> Result<(), BasinError> {
        match self {
            Self::Random(random) => random.validate(model),
            Self::Grid(grid) => grid.validate(model),
        }
    }
}

/// Every rotation is turned by the level's angle about a random axis, or one alone is; the root is moved by the level's
/// distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RandomStarts {
    /// The one rotation that is turned; `None` turns all.
    pub rotation: Option<usize>,
    /// How far starts are off.
    pub levels: Vec<Level>,
    /// Starts of each level.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
}

impl RandomStarts {
    /// A start of a level. A rotation is turned in the same direction whether others are turned too or not.
    fn pose(&self, subject: &Subject, [level, start]: [usize; 2]) -> Pose {
        let Level { degrees, metres } = self.levels[level];
        let seed = self.seed.wrapping_mul(1_000_003).wrapping_add(start as u64 * 101);
        let seed = seed.wrapping_add(u64::from(degrees) * 7919);
        let angle = f64::from(degrees).to_radians();
        let all = perturb(&subject.model, &subject.reference, angle, metres, seed);
        let Some(rotation) = self.rotation else { return all };
        let mut one = subject.reference.clone();
        one.root = all.root;
        one.rotations[rotation] = all.rotations[rotation];
        one
    }

    fn validate(&self, model: &Model) -> Result<(), BasinError> {
        at_least_one("angles", self.levels.len())?;
        at_least_one("starts", self.starts)?;
        for Level { metres, .. } in &self.levels {
            check(metres.is_finite() && *metres >= 0.0, "root", *metres, "0 m or more")?;
        }
        self.rotation.map_or(Ok(()), |rotation| is_rotation(model, rotation))
    }
}

fn is_rotation(model: &Model, rotation: usize) -> Result<(), BasinError> {
    check(rotation < model.rotation_count(), "rotation", rotation as f64, "a rotation of the body")
}

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

    /// Its name, as the command line and the window say it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flexion => "flexion",
            Self::Sideways => "sideways",
            Self::Twist => "twist",
        }
    }
}

/// A direction of the grid: an angle of a rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Direction {
    /// The rotation.
    pub rotation: usize,
    /// Which of its angles.
    pub angle: Angle,
}

impl Direction {
    /// Its name: "right forearm, flexion".
    #[must_use]
    pub fn name(self, model: &Model) -> String {
        let owner = model.rotation_owners().get(self.rotation).and_then(|limb| model.limbs().get(*limb));
        format!("{}, {}", owner.map_or("", |limb| limb.name.as_str()), self.angle.name())
    }

    fn set_off(self, model: &Model, pose: &Pose, radians: f64) -> Pose {
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

/// Two angles of the body are set off on a grid, everything else stays.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StartGrid {
    /// What is set off across and up.
    pub directions: [Direction; 2],
    /// The farthest that is set off to either side, degrees.
    pub degrees: f64,
    /// Cells across and up; with an odd number the reference is one of them.
    pub cells: usize,
}

impl StartGrid {
    /// How far a column or a row is set off, degrees.
    #[must_use]
    pub fn offset_degrees(&self, index: usize) -> f64 {
        self.degrees * (2.0 * index as f64 / (self.cells - 1) as f64 - 1.0)
    }

    /// Where the fit of a cell begins.
    #[must_use]
    pub fn pose(&self, subject: &Subject, place: [usize; 2]) -> Pose {
        self.directions.iter().zip(place).fold(subject.reference.clone(), |pose, (direction, index)| {
            direction.set_off(&subject.model, &pose, self.offset_degrees(index).to_radians())
        })
    }

    fn places(&self) -> Vec<[usize; 2]> {
        let from_middle = |index: usize| (2 * index + 1).abs_diff(self.cells);
        let mut places: Vec<[usize; 2]> =
            (0..self.cells).flat_map(|row| (0..self.cells).map(move |column| [column, row])).collect();
        places.sort_by_key(|[column, row]| from_middle(*column).max(from_middle(*row)));
        places
    }

    fn validate(&self, model: &Model) -> Result<(), BasinError> {
        let is_size = (2..=MOST_CELLS).contains(&self.cells);
        check(is_size, "cells", self.cells as f64, "2 to 61")?;
        let is_angle = self.degrees > 0.0 && self.degrees <= 180.0;
        check(is_angle, "degrees", self.degrees, "more than 0°, 180° at most")?;
        self.directions.iter().try_for_each(|direction| is_rotation(model, direction.rotation))
    }
}
