//! What is shown of the basin, what runs, and what came of it.

use backlit_tracking::experiment::basin_map::{self, Cell};
use backlit_tracking::experiment::frame_basin::{self, Frame, Report, Trial};

use super::BasinSettings;

/// The two ways in which a basin is shown.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BasinView {
    /// Success over angle.
    #[default]
    Angles,
    /// A map of two directions.
    Map,
}

/// What the cells of the map are coloured by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum MapColour {
    /// How far from the target the fit ended.
    #[default]
    Error,
    /// Whether it found it.
    Success,
}

/// What an experiment was about.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// The frame.
    pub frame: usize,
    /// The conditions in one line: frame, cameras, what was turned.
    pub conditions: String,
}

/// Success over angle, as far as it has come.
#[derive(Debug, Clone)]
pub struct AnglesResult {
    /// What it is about.
    pub about: About,
    /// What was tried.
    pub options: frame_basin::Options,
    /// Every fit.
    pub trials: Vec<Trial>,
    /// What they say together.
    pub report: Report,
}

/// The map, as far as it has come.
#[derive(Debug, Clone)]
pub struct MapResult {
    /// What it is about.
    pub about: About,
    /// What was tried.
    pub options: basin_map::Options,
    /// The frame, so that a cell's start can be made again.
    pub frame: Frame,
    /// Names of the directions across and up.
    pub directions: [String; 2],
    /// By row, then by column; nothing where no fit has been.
    pub cells: Vec<Option<Cell>>,
    /// The cell whose start was taken.
    pub taken: Option<[usize; 2]>,
}

impl MapResult {
    /// A cell that was fitted.
    #[must_use]
    pub fn cell(&self, [column, row]: [usize; 2]) -> Option<&Cell> {
        self.cells.get(row * self.options.cells + column)?.as_ref()
    }

    /// Cells that were fitted, and those that found the target.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        let tried = self.cells.iter().flatten();
        let found = tried.clone().filter(|cell| cell.error_mm < self.options.success_mm).count();
        [tried.count(), found]
    }
}

/// An experiment that is going on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Running {
    /// Which of the two.
    pub view: BasinView,
    /// Fits done.
    pub done: usize,
    /// Fits in all.
    pub total: usize,
    /// Seconds that are left, as far as can be told.
    pub seconds_left: Option<f64>,
}

/// All of it.
#[derive(Debug, Clone, Default)]
pub struct BasinState {
    /// What is typed and chosen.
    pub settings: BasinSettings,
    /// What is shown.
    pub view: BasinView,
    /// What cells are coloured by.
    pub colour: MapColour,
    /// Success over angle.
    pub angles: Option<AnglesResult>,
    /// The map.
    pub map: Option<MapResult>,
    /// What is going on.
    pub running: Option<Running>,
    /// Why nothing could be begun, until something else is tried.
    pub problem: Option<String>,
}

impl BasinState {
    /// Forgets what is about another take; settings that count its joints are as at first.
    pub fn forget(&mut self) {
        let Self { settings, view, colour, .. } = std::mem::take(self);
        let directions = BasinSettings::default().directions;
        *self = Self { settings: BasinSettings { directions, ..settings }, view, colour, ..Self::default() };
    }

    /// Takes in a fit.
    pub fn add_trial(&mut self, trial: Trial) {
        if let Some(angles) = &mut self.angles {
            angles.trials.push(trial);
            angles.report = Report::of(&angles.options, &angles.trials);
        }
        self.count();
    }

    /// Takes in a cell of the map.
    pub fn add_cell(&mut self, cell: Cell) {
        if let Some(map) = &mut self.map {
            let [column, row] = cell.place;
            if let Some(slot) = map.cells.get_mut(row * map.options.cells + column) {
                *slot = Some(cell);
            }
        }
        self.count();
    }

    fn count(&mut self) {
        if let Some(running) = &mut self.running {
            running.done += 1;
        }
    }
}
