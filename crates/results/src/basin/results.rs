//! What came of a basin's experiments.

use backlit_lab::experiment::basin_map::{self, Cell};
use backlit_lab::experiment::frame_basin::{self, Frame, Report, Trial};
use backlit_words::format;
use serde::Serialize;

/// What an experiment was about.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// The frame.
    pub frame: usize,
    /// The conditions in one line: frame, cameras, what was turned.
    pub conditions: String,
}

/// How many of an experiment's fits were made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct FitCount {
    /// Fits that were made.
    pub done: usize,
    /// Fits in all.
    pub total: usize,
}

impl FitCount {
    /// Whether none is missing.
    pub const fn is_whole(self) -> bool {
        self.done >= self.total
    }

    /// What is said of results that are not whole, in the window and in files.
    pub fn partial_text(self) -> Option<String> {
        let count = |count: usize| format::count(count as i64);
        (!self.is_whole()).then(|| format!("Partial: {} of {} fits", count(self.done), count(self.total)))
    }
}

/// Success over angle, as far as it has come.
#[derive(Debug, Clone)]
pub struct AnglesResult {
    /// What it was about.
    pub about: About,
    /// What was tried.
    pub options: frame_basin::Options,
    /// Every fit.
    pub trials: Vec<Trial>,
    /// What they say together.
    pub report: Report,
}

impl AnglesResult {
    /// How many fits were made.
    pub fn fits(&self) -> FitCount {
        FitCount { done: self.trials.len(), total: self.options.trials() }
    }
}

/// The map, as far as it has come.
#[derive(Debug, Clone)]
pub struct MapResult {
    /// What it was about.
    pub about: About,
    /// What was tried.
    pub options: basin_map::Options,
    /// The frame, so that a cell's start can be made again.
    pub frame: Frame,
    /// Names of the directions across and up.
    pub directions: [String; 2],
    /// By choice of fit, then by row, then by column; nothing where no fit has been.
    pub cells: Vec<Option<Cell>>,
}

impl MapResult {
    /// No cell is fitted yet.
    pub fn new(about: About, options: basin_map::Options, frame: Frame, directions: [String; 2]) -> Self {
        let cells = vec![None; options.trials()];
        Self { about, options, frame, directions, cells }
    }

    /// A cell that was fitted by a choice.
    pub fn cell(&self, choice: usize, place: [usize; 2]) -> Option<&Cell> {
        self.cells.get(self.index(choice, place))?.as_ref()
    }

    /// The cells of a choice, by row, then by column.
    pub fn cells_of(&self, choice: usize) -> &[Option<Cell>] {
        let each = self.options.cells * self.options.cells;
        self.cells.get(choice * each..(choice + 1) * each).unwrap_or_default()
    }

    /// Takes in a cell.
    pub fn add(&mut self, cell: Cell) {
        let index = self.index(cell.choice, cell.place);
        if let Some(slot) = self.cells.get_mut(index) {
            *slot = Some(cell);
        }
    }

    fn index(&self, choice: usize, [column, row]: [usize; 2]) -> usize {
        (choice * self.options.cells + row) * self.options.cells + column
    }

    /// Cells that a choice has fitted, and those that found the target.
    pub fn counts(&self, choice: usize) -> [usize; 2] {
        let tried = self.cells_of(choice).iter().flatten();
        let found = tried.clone().filter(|cell| cell.error_mm < self.options.success_mm).count();
        [tried.count(), found]
    }

    /// How many fits were made.
    pub fn fits(&self) -> FitCount {
        FitCount { done: self.cells.iter().flatten().count(), total: self.options.trials() }
    }
}
