//! What came of a basin, as far as it has come.

use backlit_tracking::cancel::CancelToken;
use backlit_tracking::search::start::Level;
use backlit_tracking::statistics::{Statistics, Z_95, wilson};
use backlit_words::format;
use serde::Serialize;

use super::{Basin, BasinError, BasinOptions, FitChoice, RandomStarts, StartGrid, Starts, Subject, Trial};

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
    #[must_use]
    pub const fn is_whole(self) -> bool {
        self.done >= self.total
    }

    /// What is said of results that are not whole, in the window and in files.
    #[must_use]
    pub fn partial_text(self) -> Option<String> {
        let count = |count: usize| format::count(count as i64);
        (!self.is_whole()).then(|| format!("Partial: {} of {} fits", count(self.done), count(self.total)))
    }
}

/// How many of some trials found their target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuccessRate {
    /// Starts that were tried.
    pub tried: usize,
    /// Starts that found their target.
    pub found: usize,
    /// The share of those, 0 to 1; nothing where none was tried.
    pub success: Option<f64>,
    /// Ends of the interval that holds the true share 95 times of 100.
    pub interval: [f64; 2],
    /// Median of the distances, millimetres.
    pub median_mm: Option<f64>,
    /// Distances in the order of the starts, millimetres.
    pub errors_mm: Vec<f64>,
}

impl SuccessRate {
    /// Of the distances at the end; those below `success_mm` have found their target.
    #[must_use]
    pub fn of(errors_mm: Vec<f64>, success_mm: f64) -> Self {
        let tried = errors_mm.len();
        let found = errors_mm.iter().filter(|error| **error < success_mm).count();
        Self {
            tried,
            found,
            success: (tried > 0).then(|| found as f64 / tried as f64),
            interval: wilson(found, tried, Z_95),
            median_mm: Statistics::of(&errors_mm).map(|all| all.median),
            errors_mm,
        }
    }
}

/// What came of random starts: one entry a choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// In the order of the options; none for a grid.
    pub choices: Vec<ChoiceReport>,
}

/// What came of one choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChoiceReport {
    /// Its name.
    pub name: String,
    /// In the order of the options.
    pub levels: Vec<LevelReport>,
}

/// What came of one level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelReport {
    /// How far its starts are off.
    #[serde(flatten)]
    pub level: Level,
    /// How many of them found their target.
    #[serde(flatten)]
    pub rate: SuccessRate,
}

/// The trials that were made, and what they say together.
#[derive(Debug, Clone)]
pub struct BasinResult {
    /// The frame that it was about.
    pub frame: usize,
    /// The conditions in one line: frame, cameras, what was turned.
    pub conditions: String,
    /// What was tried.
    pub options: BasinOptions,
    /// What was fitted, so that a start can be made again.
    pub subject: Subject,
    /// By choice, then as [`Starts::index`] has them; nothing where no fit has been.
    pub trials: Vec<Option<Trial>>,
    /// The rates of success of random starts.
    pub report: Report,
}

impl BasinResult {
    /// No fit was made yet.
    #[must_use]
    pub fn new(frame: usize, conditions: String, options: BasinOptions, subject: Subject) -> Self {
        let trials = vec![None; options.trials()];
        let levels = match &options.starts {
            Starts::Random(random) => random.levels.as_slice(),
            Starts::Grid(_) => &[],
        };
        let rate = SuccessRate::of(Vec::new(), options.success_mm);
        let level = |level: &Level| LevelReport { level: *level, rate: rate.clone() };
        let choice = |choice: &FitChoice| ChoiceReport {
            name: choice.name.clone(),
            levels: levels.iter().map(level).collect(),
        };
        let report = Report { choices: options.choices.iter().map(choice).collect() };
        Self { frame, conditions, options, subject, trials, report }
    }

    /// Makes all trials, one after the other; `on_progress` hears how many are done before each and at the end.
    ///
    /// # Errors
    /// Returns an error if an option is out of range, if a fit cannot begin, or if `cancel` was given.
    pub fn run(
        mut self,
        cancel: &CancelToken,
        mut on_progress: impl FnMut(FitCount),
    ) -> Result<Self, BasinError> {
        let basin = Basin::new(self.subject.clone(), &self.options, cancel)?;
        for trial in 0..basin.trials() {
            on_progress(self.fits());
            self.add(basin.run(trial, cancel)?);
        }
        on_progress(self.fits());
        Ok(self)
    }

    /// Takes in a trial.
    pub fn add(&mut self, trial: Trial) {
        let first = trial.choice * self.options.starts.count();
        let index = first + self.options.starts.index(trial.place);
        let Some(slot) = self.trials.get_mut(index) else { return };
        *slot = Some(trial);
        if let Starts::Random(random) = &self.options.starts {
            let level = trial.place[0];
            let first = first + level * random.starts;
            let made = self.trials[first..first + random.starts].iter().flatten();
            let errors_mm = made.map(|trial| trial.error_mm).collect();
            self.report.choices[trial.choice].levels[level].rate =
                SuccessRate::of(errors_mm, self.options.success_mm);
        }
    }

    /// The trials of a choice.
    #[must_use]
    pub fn trials_of(&self, choice: usize) -> &[Option<Trial>] {
        let each = self.options.starts.count();
        self.trials.get(choice * each..(choice + 1) * each).unwrap_or_default()
    }

    /// The trial of a choice at a place.
    #[must_use]
    pub fn trial(&self, choice: usize, place: [usize; 2]) -> Option<&Trial> {
        self.trials_of(choice).get(self.options.starts.index(place))?.as_ref()
    }

    /// Whether a trial has found its target.
    #[must_use]
    pub fn is_found(&self, trial: &Trial) -> bool {
        trial.error_mm < self.options.success_mm
    }

    /// How many trials of a choice were made, and how many found the target.
    #[must_use]
    pub fn counts(&self, choice: usize) -> [usize; 2] {
        let made = self.trials_of(choice).iter().flatten();
        [made.clone().count(), made.filter(|trial| self.is_found(trial)).count()]
    }

    /// How many fits were made.
    #[must_use]
    pub fn fits(&self) -> FitCount {
        FitCount { done: self.trials.iter().flatten().count(), total: self.trials.len() }
    }

    /// The random starts, if those were tried.
    #[must_use]
    pub fn random(&self) -> Option<&RandomStarts> {
        match &self.options.starts {
            Starts::Random(random) => Some(random),
            Starts::Grid(_) => None,
        }
    }

    /// The grid, if one was tried.
    #[must_use]
    pub fn grid(&self) -> Option<&StartGrid> {
        match &self.options.starts {
            Starts::Grid(grid) => Some(grid),
            Starts::Random(_) => None,
        }
    }
}
