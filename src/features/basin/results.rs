//! What came of a basin's experiments.

use backlit_lab::experiment::basin_map::{self, Cell};
use backlit_lab::experiment::frame_basin::{self, Frame, Report, Trial};
use backlit_ui::style::format;
use serde::Serialize;

use crate::context::command::BasinView;

/// What an experiment was about.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct About {
    pub(crate) frame: usize,
    /// The conditions in one line: frame, cameras, what was turned.
    pub(crate) conditions: String,
}

/// How many of an experiment's fits were made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct FitCount {
    /// Fits that were made.
    pub done: usize,
    /// Fits in all.
    pub(crate) total: usize,
}

impl FitCount {
    /// Whether none is missing.
    pub const fn is_whole(self) -> bool {
        self.done >= self.total
    }

    /// What is said of results that are not whole, in the window and in files.
    pub(crate) fn partial_text(self) -> Option<String> {
        let count = |count: usize| format::count(count as i64);
        (!self.is_whole()).then(|| format!("Partial: {} of {} fits", count(self.done), count(self.total)))
    }
}

/// Success over angle, as far as it has come.
#[derive(Debug, Clone)]
pub struct AnglesResult {
    pub(crate) about: About,
    /// What was tried.
    pub(crate) options: frame_basin::Options,
    /// Every fit.
    pub(crate) trials: Vec<Trial>,
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
    pub(crate) about: About,
    /// What was tried.
    pub options: basin_map::Options,
    /// The frame, so that a cell's start can be made again.
    pub frame: Frame,
    /// Names of the directions across and up.
    pub directions: [String; 2],
    /// By choice of fit, then by row, then by column; nothing where no fit has been.
    pub cells: Vec<Option<Cell>>,
    /// The one choice whose map is shown; `None` shows those of all, side by side.
    pub(crate) shown: Option<usize>,
    /// The cell whose start was taken.
    pub(crate) taken: Option<[usize; 2]>,
}

impl MapResult {
    /// No cell is fitted yet.
    pub(crate) fn new(
        about: About,
        options: basin_map::Options,
        frame: Frame,
        directions: [String; 2],
    ) -> Self {
        let cells = vec![None; options.trials()];
        Self { about, options, frame, directions, cells, shown: None, taken: None }
    }

    /// A cell that was fitted by a choice.
    pub fn cell(&self, choice: usize, place: [usize; 2]) -> Option<&Cell> {
        self.cells.get(self.index(choice, place))?.as_ref()
    }

    /// The cells of a choice, by row, then by column.
    pub(crate) fn cells_of(&self, choice: usize) -> &[Option<Cell>] {
        let each = self.options.cells * self.options.cells;
        self.cells.get(choice * each..(choice + 1) * each).unwrap_or_default()
    }

    /// Takes in a cell.
    pub(crate) fn add(&mut self, cell: Cell) {
        let index = self.index(cell.choice, cell.place);
        if let Some(slot) = self.cells.get_mut(index) {
            *slot = Some(cell);
        }
    }

    fn index(&self, choice: usize, [column, row]: [usize; 2]) -> usize {
        (choice * self.options.cells + row) * self.options.cells + column
    }

    /// Cells that a choice has fitted, and those that found the target.
    pub(crate) fn counts(&self, choice: usize) -> [usize; 2] {
        let tried = self.cells_of(choice).iter().flatten();
        let found = tried.clone().filter(|cell| cell.error_mm < self.options.success_mm).count();
        [tried.count(), found]
    }

    /// How many fits were made.
    pub fn fits(&self) -> FitCount {
        FitCount { done: self.cells.iter().flatten().count(), total: self.options.trials() }
    }
}

/// An experiment that is going on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Running {
    /// Which of the two.
    pub(crate) view: BasinView,
    /// Fits done.
    pub done: usize,
    /// Fits in all.
    pub(crate) total: usize,
    /// Seconds that are left, as far as can be told.
    pub seconds_left: Option<f64>,
}

/// All of it.
#[derive(Debug, Clone, Default)]
pub struct BasinResults {
    /// Success over angle.
    pub angles: Option<AnglesResult>,
    /// The map.
    pub map: Option<MapResult>,
    /// What is going on.
    pub running: Option<Running>,
}

impl BasinResults {
    /// How many fits were made of what a view shows, if that is not all of them and no more is to come.
    pub(crate) fn partial(&self, view: BasinView) -> Option<FitCount> {
        let fits = match view {
            BasinView::Angles => self.angles.as_ref().map(AnglesResult::fits),
            BasinView::Map => self.map.as_ref().map(MapResult::fits),
        };
        let is_coming = self.running.is_some_and(|running| running.view == view);
        fits.filter(|fits| !fits.is_whole() && !is_coming)
    }

    /// Nothing came of a view's experiment: it is as if it had not been begun.
    pub(crate) fn forget(&mut self, view: BasinView) {
        match view {
            BasinView::Angles => self.angles = None,
            BasinView::Map => self.map = None,
        }
    }

    /// Takes in a fit.
    pub(crate) fn add_trial(&mut self, trial: Trial) {
        if let Some(angles) = &mut self.angles {
            angles.trials.push(trial);
            angles.report = Report::of(&angles.options, &angles.trials);
        }
        self.count();
    }

    /// Takes in a cell of the map.
    pub(crate) fn add_cell(&mut self, cell: Cell) {
        if let Some(map) = &mut self.map {
            map.add(cell);
        }
        self.count();
    }

    fn count(&mut self) {
        if let Some(running) = &mut self.running {
            running.done += 1;
        }
    }
}
