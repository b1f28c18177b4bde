//! The basin of one frame: how far off a start may be, and still end where it should, on a frame's own evidence.
//!
//! Starts are drawn about a reference pose: every rotation is turned by the level's angle about a random axis, or
//! one alone is, and the root is moved by the level's distance. Success is a mean distance of the leaf joints and
//! the root ([`leaf_error_mm`]) below a limit, from the reference or from where a fit of the reference itself ends.
//! Every trial can be made by itself, in any order, and gives the same numbers every time.

use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitView;
use backlit_tracking::search::start::perturb;
use backlit_tracking::statistics::Statistics;
use serde::Serialize;

use super::basin::leaf_error_mm;
use super::interval::{Z_95, wilson};
use super::starts::Level;
use super::{ExperimentError, FitChoice, Progress};

/// A frame, and the pose that its basin is about.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The body.
    pub model: Arc<Model>,
    /// What the cameras see.
    pub views: Vec<FitView>,
    /// The pose that starts are drawn about.
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

/// What to try.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// How starts are fitted, side by side.
    pub choices: Vec<FitChoice>,
    /// The one rotation that is turned; `None` turns all.
    pub rotation: Option<usize>,
    /// How far starts are off.
    pub levels: Vec<Level>,
    /// Starts of each level.
    pub starts: usize,
    /// Seed of the starts.
    pub seed: u64,
    /// Where fits are to end.
    pub target: Target,
    /// Below this mean distance a fit has found its target, millimetres.
    pub success_mm: f64,
}

/// One fit from one start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Trial {
    /// Index of the choice.
    pub choice: usize,
    /// Index of the level.
    pub level: usize,
    /// Which start of the level.
    pub start: usize,
    /// Mean distance from the target at the end, millimetres.
    pub error_mm: f64,
}

/// The experiment, ready to be tried.
#[derive(Debug, Clone)]
pub struct FrameBasin {
    frame: Frame,
    options: Options,
    /// Where each choice is to end.
    targets: Vec<Pose>,
}

impl FrameBasin {
    /// Checks the options and finds the targets.
    ///
    /// # Errors
    /// Options that make no sense, a fit that cannot begin, or `cancel`.
    pub fn new(frame: Frame, options: Options, cancel: &CancelToken) -> Result<Self, ExperimentError> {
        options.check(&frame.model)?;
        let targets = targets(&frame, &options.choices, options.target, cancel)?;
        Ok(Self { frame, options, targets })
    }

    /// How many trials there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.options.trials()
    }

    /// Whether there is nothing to try.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where a trial begins.
    #[must_use]
    pub fn start(&self, trial: usize) -> Pose {
        let [_, level, start] = self.options.place(trial);
        self.options.start(&self.frame, level, start)
    }

    /// Makes one trial, counted so that all levels and choices go on together.
    ///
    /// # Errors
    /// A fit that cannot begin, or `cancel`.
    pub fn run(&self, trial: usize, cancel: &CancelToken) -> Result<Trial, ExperimentError> {
        let [choice, level, start] = self.options.place(trial);
        let (model, views) = (&self.frame.model, self.frame.views.clone());
        let end = self.options.choices[choice].end(model, views, &self.start(trial), cancel)?;
        let error_mm = leaf_error_mm(model, &end, &self.targets[choice]);
        Ok(Trial { choice, level, start, error_mm })
    }
}

/// Where each choice of fit is to end.
pub(super) fn targets(
    frame: &Frame,
    choices: &[FitChoice],
    target: Target,
    cancel: &CancelToken,
) -> Result<Vec<Pose>, ExperimentError> {
    let end = |choice: &FitChoice| match target {
        Target::Reference => Ok(frame.reference.clone()),
        Target::Fit => choice.end(&frame.model, frame.views.clone(), &frame.reference, cancel),
    };
    choices.iter().map(end).collect()
}

impl Options {
    /// How many trials there are.
    #[must_use]
    pub fn trials(&self) -> usize {
        self.choices.len() * self.levels.len() * self.starts
    }

    /// Choice, level and start of a trial.
    fn place(&self, trial: usize) -> [usize; 3] {
        let (choices, levels) = (self.choices.len(), self.levels.len());
        [trial % choices, trial / choices % levels, trial / choices / levels]
    }

    /// A start of a level. All choices begin at the same ones; a rotation is turned in the same direction whether
    /// others are turned too or not.
    #[must_use]
    pub fn start(&self, frame: &Frame, level: usize, index: usize) -> Pose {
        let Level { degrees, metres } = self.levels[level];
        let seed = self.seed.wrapping_mul(1_000_003).wrapping_add(index as u64 * 101);
        let seed = seed.wrapping_add(u64::from(degrees) * 7919);
        let angle = f64::from(degrees).to_radians();
        let all = perturb(&frame.model, &frame.reference, angle, metres, seed);
        let Some(rotation) = self.rotation else { return all };
        let mut one = frame.reference.clone();
        one.root = all.root;
        one.rotations[rotation] = all.rotations[rotation];
        one
    }

    /// First thing wrong with the numbers.
    ///
    /// # Errors
    /// Nothing to try, a level or a limit that is no number, or a rotation that the body does not have.
    pub fn check(&self, model: &Model) -> Result<(), ExperimentError> {
        let counts =
            [("choices", self.choices.len()), ("angles", self.levels.len()), ("starts", self.starts)];
        for (option, value) in counts {
            if value == 0 {
                return Err(ExperimentError::Option { option, value: 0.0, expected: "1 or more" });
            }
        }
        for level in &self.levels {
            let value = level.metres;
            if !(value.is_finite() && value >= 0.0) {
                return Err(ExperimentError::Option { option: "root", value, expected: "0 m or more" });
            }
        }
        if let Some(rotation) = self.rotation.filter(|rotation| *rotation >= model.rotation_count()) {
            let expected = "a rotation of the body";
            return Err(ExperimentError::Option { option: "rotation", value: rotation as f64, expected });
        }
        check_limit(self.success_mm)
    }
}

/// A limit of success that is a number above zero.
pub(super) fn check_limit(value: f64) -> Result<(), ExperimentError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(ExperimentError::Option { option: "within", value, expected: "more than 0 mm" })
    }
}

/// What came of it: one entry a choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// In the order of the options.
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
    /// Turn of the joints, degrees.
    pub degrees: u32,
    /// Move of the root, metres.
    pub metres: f64,
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

impl Report {
    /// What the trials that were made say; they may be some of all, in any order.
    #[must_use]
    pub fn of(options: &Options, trials: &[Trial]) -> Self {
        let level = |choice: usize, index: usize, level: &Level| {
            let mut own: Vec<&Trial> =
                trials.iter().filter(|trial| trial.choice == choice && trial.level == index).collect();
            own.sort_by_key(|trial| trial.start);
            let errors_mm: Vec<f64> = own.iter().map(|trial| trial.error_mm).collect();
            let (tried, found) =
                (own.len(), errors_mm.iter().filter(|error| **error < options.success_mm).count());
            LevelReport {
                degrees: level.degrees,
                metres: level.metres,
                tried,
                found,
                success: (tried > 0).then(|| found as f64 / tried as f64),
                interval: wilson(found, tried, Z_95),
                median_mm: Statistics::of(&errors_mm).map(|all| all.median),
                errors_mm,
            }
        };
        let choice = |(index, choice): (usize, &FitChoice)| ChoiceReport {
            name: choice.name.clone(),
            levels: options.levels.iter().enumerate().map(|(at, one)| level(index, at, one)).collect(),
        };
        Self { choices: options.choices.iter().enumerate().map(choice).collect() }
    }
}

/// Makes all trials, one after the other on one core.
///
/// # Errors
/// As [`FrameBasin::new`] and [`FrameBasin::run`].
pub fn run(
    frame: Frame,
    options: Options,
    cancel: &CancelToken,
    mut on_progress: impl FnMut(Progress),
) -> Result<Report, ExperimentError> {
    let basin = FrameBasin::new(frame, options, cancel)?;
    let total = basin.len();
    let mut trials = Vec::with_capacity(total);
    for trial in 0..total {
        on_progress(Progress { done: trial, total });
        trials.push(basin.run(trial, cancel)?);
    }
    on_progress(Progress { done: total, total });
    Ok(Report::of(&basin.options, &trials))
}

#[cfg(test)]
pub(super) mod tests {
    use backlit_tracking::body::builtin;
    use backlit_tracking::fit::{Evidence, FitOptions, Preset};

    use super::*;
    use crate::synthetic::{capsules, upper_body};

    /// The upper body before two small cameras.
    pub(in crate::experiment) fn frame() -> Frame {
        let model = Arc::new(builtin::upper_body());
        let reference = upper_body::motion(&model, 7);
        let cameras = upper_body::cameras(2, [48, 36]).unwrap();
        let view = |camera: &Arc<backlit_tracking::camera::Camera>| FitView {
            camera: Arc::clone(camera),
            evidence: Evidence::Mask(Arc::new(capsules::hard_mask(&model, &reference, camera).unwrap())),
            weight: 1.0,
        };
        let views = cameras.iter().map(view).collect();
        Frame { model, views, reference }
    }

    fn options() -> Options {
        Options {
            choices: vec![FitChoice::downhill("Robust", FitOptions::preset(Preset::Robust))],
            rotation: None,
            levels: vec![Level { degrees: 5, metres: 0.02 }, Level { degrees: 60, metres: 0.3 }],
            starts: 4,
            seed: 3,
            target: Target::Fit,
            success_mm: 20.0,
        }
    }

    #[test]
    fn near_starts_find_home_and_far_ones_do_not_and_all_twice_the_same() {
        let all = || run(frame(), options(), &CancelToken::new(), |_| {}).unwrap();
        let report = all();
        let [near, far] = [0, 1].map(|level| &report.choices[0].levels[level]);
        assert_eq!((near.tried, near.found), (4, 4), "{near:?}");
        assert!(far.found < 4 && far.median_mm > near.median_mm, "{far:?}");
        assert!(near.interval[0] < 1.0 && near.interval[1] == 1.0);
        assert_eq!(report, all());
    }

    #[test]
    fn one_joint_is_turned_alone_by_the_same_turn() {
        let frame = frame();
        let all = options();
        let one = Options { rotation: Some(2), ..options() };
        let (start, alone) = (all.start(&frame, 0, 1), one.start(&frame, 0, 1));
        assert_eq!((alone.root, alone.rotations[2]), (start.root, start.rotations[2]));
        for rotation in (0..frame.model.rotation_count()).filter(|rotation| *rotation != 2) {
            assert_eq!(alone.rotations[rotation], frame.reference.rotations[rotation]);
        }
    }

    #[test]
    fn some_of_the_trials_are_a_report_too() {
        let options = options();
        let trial = |start, error_mm| Trial { choice: 0, level: 1, start, error_mm };
        let report = Report::of(&options, &[trial(2, 30.0), trial(0, 10.0)]);
        let [none, two] = [0, 1].map(|level| &report.choices[0].levels[level]);
        assert_eq!((none.tried, none.success, none.median_mm), (0, None, None));
        assert_eq!((two.tried, two.found, two.success), (2, 1, Some(0.5)));
        assert_eq!(two.errors_mm, [10.0, 30.0]);
    }

    #[test]
    fn options_that_make_no_sense_are_named() {
        let wrong = |options: Options| {
            FrameBasin::new(frame(), options, &CancelToken::new()).unwrap_err().to_string()
        };
        assert!(wrong(Options { starts: 0, ..options() }).contains("starts"));
        assert!(wrong(Options { levels: Vec::new(), ..options() }).contains("angles"));
        assert!(wrong(Options { rotation: Some(99), ..options() }).contains("rotation"));
        assert!(wrong(Options { success_mm: f64::NAN, ..options() }).contains("within"));
        let cancel = CancelToken::new();
        cancel.cancel();
        assert_eq!(run(frame(), options(), &cancel, |_| {}), Err(ExperimentError::Cancelled));
    }
}
