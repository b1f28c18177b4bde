//! How far off a start may be, and still end where it should: poses × starts × choices of fit.
//!
//! A [`Subject`] is a body, what its cameras see, and the pose that starts are about. Where a subject comes from does not
//! matter: a frame of a take or a simulation. Its starts are drawn at random or stand on a grid ([`Starts`]). A fit succeeds
//! when root and leaf joints end within a limit of the target on average ([`leaf_error_mm`]).
//! Every trial can be made by itself, in any order, and gives the same numbers every time.

mod choice;
mod files;
mod result;
mod starts;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitError, FitView};
use backlit_tracking::metrics::leaf_error_mm;
use backlit_tracking::search::WithoutStartError;
use serde::Serialize;

pub use choice::{ComparedFit, ComparedMethod, FitChoice, MOST_COMPARED, ParseComparedError, name_choices};
pub use result::{BasinResult, ChoiceReport, FitCount, LevelReport, Report, SuccessRate};
pub use starts::{Angle, Direction, MOST_CELLS, RandomStarts, StartGrid, Starts};

/// Below this mean distance a fit has found its truth, millimetres.
pub const SUCCESS_MM: f64 = 20.0;

/// What is fitted.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The body.
    pub model: Arc<Model>,
    /// What the cameras see.
    pub views: Vec<FitView>,
    /// The pose that starts are about.
    pub reference: Pose,
}

/// Where a fit is to end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// At the reference, which is the truth.
    #[default]
    Reference,
    /// Where a fit that begins at the reference ends, each choice's own.
    Fit,
}

/// What to try on one subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BasinOptions {
    /// How starts are fitted, side by side.
    pub choices: Vec<FitChoice>,
    /// The starts.
    #[serde(flatten)]
    pub starts: Starts,
    /// Where fits are to end.
    pub target: Target,
    /// Below this mean distance a fit has found its target, millimetres.
    pub success_mm: f64,
}

impl BasinOptions {
    /// How many trials there are.
    #[must_use]
    pub fn trials(&self) -> usize {
        self.choices.len() * self.starts.count()
    }

    fn validate(&self, model: &Model) -> Result<(), BasinError> {
        at_least_one("choices", self.choices.len())?;
        self.starts.validate(model)?;
        let is_limit = self.success_mm.is_finite() && self.success_mm > 0.0;
        check(is_limit, "within", self.success_mm, "more than 0 mm")
    }
}

fn check(is_right: bool, option: &'static str, value: f64, expected: &'static str) -> Result<(), BasinError> {
    if is_right { Ok(()) } else { Err(BasinError::Option { option, value, expected }) }
}

fn at_least_one(option: &'static str, count: usize) -> Result<(), BasinError> {
    check(count > 0, option, count as f64, "1 or more")
}

/// Why a basin cannot be tried.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum BasinError {
    #[error("`{option}` is {value}; expected {expected}")]
    Option { option: &'static str, value: f64, expected: &'static str },
    #[error("the experiment was stopped")]
    Cancelled,
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    WithoutStart(#[from] WithoutStartError),
}

/// One fit from one start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Index of the choice.
    pub choice: usize,
    /// Where its start stands among the others: level and number, or column and row.
    pub place: [usize; 2],
    /// Mean distance from the choice's target at the start, millimetres.
    pub start_mm: f64,
    /// The same at the end; infinite where no pose was found.
    pub error_mm: f64,
}

/// All trials, ready to be made one by one.
#[derive(Debug, Clone)]
pub struct Basin {
    subject: Subject,
    /// Where each choice is to end.
    targets: Vec<Pose>,
    choices: Vec<FitChoice>,
    /// Where starts stand among the others, and they themselves.
    starts: Vec<([usize; 2], Pose)>,
}

impl Basin {
    /// Checks the options, makes the starts and finds the targets.
    ///
    /// # Errors
    /// Returns an error if an option is out of range, if a fit cannot begin, or if `cancel` was given.
    pub fn new(subject: Subject, options: &BasinOptions, cancel: &CancelToken) -> Result<Self, BasinError> {
        options.validate(&subject.model)?;
        let target = |choice: &FitChoice| match options.target {
            Target::Reference => Ok(subject.reference.clone()),
            Target::Fit => choice
                .end(&subject, &subject.reference, cancel)
                .map(|end| end.unwrap_or_else(|| subject.reference.clone())),
        };
        let targets = options.choices.iter().map(target).collect::<Result<_, _>>()?;
        let start = |place| (place, options.starts.pose(&subject, place));
        let starts = options.starts.places().into_iter().map(start).collect();
        Ok(Self { targets, choices: options.choices.clone(), starts, subject })
    }

    /// How many trials there are.
    #[must_use]
    pub fn trials(&self) -> usize {
        self.choices.len() * self.starts.len()
    }

    /// Makes one trial, counted so that all choices go on together.
    ///
    /// # Errors
    /// Returns an error if the fit cannot begin, or if `cancel` was given.
    pub fn run(&self, index: usize, cancel: &CancelToken) -> Result<Trial, BasinError> {
        let choice = index % self.choices.len();
        let (place, start) = &self.starts[index / self.choices.len()];
        let (subject, target) = (&self.subject, &self.targets[choice]);
        let start_mm = leaf_error_mm(&subject.model, start, target);
        let error_mm = self.choices[choice].error_mm(subject, start, target, cancel)?;
        Ok(Trial { choice, place: *place, start_mm, error_mm })
    }
}
