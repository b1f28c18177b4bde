//! What came of a basin's experiments, and what the pane shows of it.

use std::ops::Deref;

use backlit_lab::experiment::basin_map::Cell;
use backlit_lab::experiment::frame_basin::{Report, Trial};
use backlit_results::basin::{AnglesResult, FitCount, MapResult};

use crate::context::command::BasinView;

/// A map, and what is shown of it.
#[derive(Debug, Clone)]
pub struct ShownMap {
    pub(crate) result: MapResult,
    /// The one choice whose map is shown; `None` shows those of all, side by side.
    pub(crate) choice: Option<usize>,
    /// The cell whose start was taken.
    pub(crate) taken: Option<[usize; 2]>,
}

impl ShownMap {
    /// All choices are shown.
    pub(crate) const fn new(result: MapResult) -> Self {
        Self { result, choice: None, taken: None }
    }
}

impl Deref for ShownMap {
    type Target = MapResult;

    fn deref(&self) -> &MapResult {
        &self.result
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
    pub map: Option<ShownMap>,
    /// What is going on.
    pub running: Option<Running>,
}

impl BasinResults {
    /// How many fits were made of what a view shows, if that is not all of them and no more is to come.
    pub(crate) fn partial(&self, view: BasinView) -> Option<FitCount> {
        let fits = match view {
            BasinView::Angles => self.angles.as_ref().map(AnglesResult::fits),
            BasinView::Map => self.map.as_ref().map(|map| map.result.fits()),
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
            map.result.add(cell);
        }
        self.count();
    }

    fn count(&mut self) {
        if let Some(running) = &mut self.running {
            running.done += 1;
        }
    }
}
