//! Every choice of a fit, each of which can be switched by itself, and the two presets.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::body::Parameters;
use crate::numbers::Brief;
use crate::optimize::{Method, SolverOptions, Tolerances};
use crate::render::{Ramp, RendererKind};
use crate::residual::Loss;
use crate::residual::learnt_prior::LearntPrior;

/// Largest weight, prior or damping.
const LARGEST_WEIGHT: f64 = 1e12;
/// Widest grid of pixels: wider ones leave no pixel of any picture.
const MAX_STRIDE: usize = 4096;
/// Most iterations of a stage.
const MAX_ITERATIONS: usize = 100_000;

/// How the mask is looked at. The mask is the evidence; these are views of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum DataView {
    /// Black and white.
    #[default]
    Hard,
    /// Averaged over a square of (2 radius + 1)² pixels.
    Averaged {
        /// Pixels.
        radius_px: usize,
    },
    /// Grey by the distance to the border, with the widths of the stage's `distance` ramp.
    Distance,
}

/// One stage of the annealing: wide and coarse first, narrow and fine last.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// The prediction's ramp.
    pub ramp: Ramp,
    /// The data's view of the mask.
    pub data: DataView,
    /// Distance between samples, pixels, across and down.
    pub stride: usize,
    /// Most iterations of this stage.
    pub iterations: usize,
    /// Stop the stage when a step gains less than this fraction of the cost
    /// ([`Tolerances::gain`](crate::optimize::Tolerances::gain)).
    pub tolerance: Option<f64>,
    /// Factor on the weights of all priors and cues in this stage.
    #[serde(default = "full_weight")]
    pub priors: f64,
}

fn full_weight() -> f64 {
    1.0
}

impl Stage {
    /// How it is solved.
    pub(crate) fn solver_options(&self, method: Method, damping: f64, run_all: bool) -> SolverOptions {
        SolverOptions {
            method,
            damping,
            // What the pixels hardly see does not go farther than what they see. With less, a few more starts end in a wrong
            // pose.
            least_scale: 1.0,
            max_iterations: self.iterations,
            tolerances: Tolerances::by_gain(self.tolerance),
            run_all,
        }
    }

    /// One of the robust preset's: distances, whose ramp narrows outside only.
    pub(crate) fn robust(outer_px: f64, stride: usize, iterations: usize) -> Self {
        Self {
            ramp: Ramp::Distance { inner_px: ROBUST_INNER_PX, outer_px },
            data: DataView::Distance,
            stride,
            iterations,
            tolerance: Some(1e-3),
            priors: 1.0,
        }
    }
}

/// Every choice of a fit.
///
/// Prior weights are in 255² squared grey levels per rad² at stride 1; at stride s they are divided by s², as
/// the pixels are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FitOptions {
    /// The solid that stands for a limb.
    pub renderer: RendererKind,
    /// Raw coefficients or tangent update.
    pub parameters: Parameters,
    /// How steps are made.
    pub method: Method,
    /// Damping at the start of every stage, in units of mean(diag JᵀJ); with Levenberg-Marquardt in units of each column's
    /// own diagonal where that is larger.
    pub damping: f64,
    /// Stages of the first frame, from far away.
    pub stages: Vec<Stage>,
    /// Whether the stages are made to suit how large the body appears ([`at_scale`](Self::at_scale)): they are
    /// meant for a person of some hundred pixels.
    #[serde(default)]
    pub to_scale: bool,
    /// How many of the first stages a tracked frame skips: it starts near.
    pub skip_when_tracking: usize,
    /// Pull towards the pose that the fit began with.
    pub proximal_weight: f64,
    /// Weight of the root's position in that pull, per m², relative to a rotation's per rad².
    pub proximal_root_factor: f64,
    /// How that pull grows with a rotation's angle, radians: squares hold a far start back most, robust losses
    /// let go of what moved far.
    pub proximal_loss: Loss,
    /// How large a pixel's residual may be and be believed, in grey levels. Weights are renewed where each of the
    /// last two stages begins; a fit of one stage believes every pixel.
    pub pixel_loss: Loss,
    /// Pull of every limb's twist towards none.
    pub rest_weight: f64,
    /// Joint limits.
    pub limit_weight: f64,
    /// Limbs inside one another, in 255² squared grey levels per m² at stride 1; 0 leaves them.
    pub interpenetration_weight: f64,
    /// What motion files say of poses and steps. Files of choices do not hold it: it is a file of its own.
    #[serde(skip)]
    pub prior: Option<LearntPrior>,
    /// Longest turn of one joint in a step, radians; infinite steps are the report's.
    pub largest_turn: Option<f64>,
    /// Longest move of the root in a step, metres.
    pub largest_move: Option<f64>,
    /// Whether every stage runs all its iterations, whatever the cost does: for measuring times and for
    /// comparing solvers step by step.
    pub run_all: bool,
    /// Whether pixels are summed by the reference kernel, in f64: the fit is then the same to the bit whatever vectors the processor
    /// has, and many times slower. For what is decided at a threshold; files of choices do not hold it.
    #[serde(skip)]
    pub exact: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self::preset(Preset::Robust)
    }
}

/// A named set of choices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The 2004 report: raw coefficients, thesis ramp, smoothed silhouettes, capsule, fixed damping, 25 iterations.
    Report,
    /// Tangent Levenberg-Marquardt on annealed distance-transform data with priors and limits.
    #[default]
    Robust,
}

impl Preset {
    /// All presets, in the order in which they are offered.
    pub const ALL: [Self; 2] = [Self::Report, Self::Robust];

    /// Its name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Report => "Report 2004",
            Self::Robust => "Robust",
        }
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Report => "report",
            Self::Robust => "robust",
        })
    }
}

/// Text that is not a preset.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
#[error("\"{0}\" is not a preset; expected report or robust")]
pub struct ParsePresetError(String);

impl FromStr for Preset {
    type Err = ParsePresetError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::ALL.into_iter().find(|preset| preset.to_string() == text);
        found.ok_or_else(|| ParsePresetError(text.to_owned()))
    }
}

/// Iterations a frame in the report (chapter 5).
const REPORT_ITERATIONS: usize = 25;
/// The report smooths its silhouettes (section 4.3). By what is not known to us: this is the narrowest box there is, and
/// `backlit experiment fig5.5` shows wider ones beside it.
const REPORT_SMOOTHING: DataView = DataView::Averaged { radius_px: 1 };

/// Inner width of the robust preset's distance ramps, pixels. The annealing narrows the outer width only: a
/// prediction's inner width ends at its limb's radius and the data's does not, so inside the body the two mean
/// the same only where they are narrower than every limb.
const ROBUST_INNER_PX: f64 = 1.5;

impl FitOptions {
    /// The choices of a preset.
    pub fn preset(preset: Preset) -> Self {
        let robust = Self {
            renderer: RendererKind::Capsule,
            parameters: Parameters::Tangent,
            method: Method::LevenbergMarquardt,
            damping: 0.01,
            stages: [(24.0, 4), (12.0, 4), (6.0, 4), (3.0, 2), (1.5, 2)]
                .map(|(outer_px, stride)| Stage::robust(outer_px, stride, 12))
                .to_vec(),
            to_scale: true,
            skip_when_tracking: 1,
            proximal_weight: 30.0,
            proximal_root_factor: 11.0,
            proximal_loss: Loss::Squares,
            pixel_loss: Loss::Squares,
            rest_weight: 30.0,
            limit_weight: 300.0,
            interpenetration_weight: 0.0,
            prior: None,
            largest_turn: Some(0.3),
            largest_move: Some(0.15),
            run_all: false,
            exact: false,
        };
        match preset {
            Preset::Robust => robust,
            Preset::Report => Self {
                parameters: Parameters::Raw,
                method: Method::GaussNewton,
                damping: 0.1,
                stages: vec![Stage {
                    ramp: Ramp::Thesis,
                    data: REPORT_SMOOTHING,
                    stride: 1,
                    iterations: REPORT_ITERATIONS,
                    tolerance: None,
                    priors: 1.0,
                }],
                to_scale: false,
                skip_when_tracking: 0,
                proximal_weight: 0.0,
                rest_weight: 0.0,
                limit_weight: 0.0,
                largest_turn: None,
                largest_move: None,
                ..robust
            },
        }
    }

    /// The preset that these choices are, if they are one's to the letter.
    pub fn as_preset(&self) -> Option<Preset> {
        Preset::ALL.into_iter().find(|&preset| *self == Self::preset(preset))
    }

    /// The ramp of the last stage: what the result is judged and shown by.
    pub fn final_ramp(&self) -> Ramp {
        self.stages.last().map_or(Ramp::Half, |stage| stage.ramp)
    }

    /// The same with one stage of this ramp, as `--ramp` asks for. Distance ramps look at distance data; others at what
    /// the last stage looks at, or at the plain mask if that is distances.
    pub fn with_ramp(mut self, ramp: Ramp) -> Self {
        let last = self.stages.last().copied();
        let data = match last.map(|stage| stage.data) {
            _ if matches!(ramp, Ramp::Distance { .. }) => DataView::Distance,
            None | Some(DataView::Distance) => DataView::Hard,
            Some(data) => data,
        };
        let iterations = self.stages.iter().map(|stage| stage.iterations).sum::<usize>().max(1);
        let tolerance = last.and_then(|stage| stage.tolerance);
        self.stages = vec![Stage { ramp, data, stride: 1, iterations, tolerance, priors: 1.0 }];
        (self.to_scale, self.skip_when_tracking) = (false, 0);
        self
    }

    /// The same with this many iterations in all, shared equally among the stages, the first ones taking what
    /// is left over. Stages without a share are dropped.
    pub fn with_iterations(mut self, iterations: usize) -> Self {
        self.to_scale = false;
        let stages = self.stages.len().max(1);
        let (share, left_over) = (iterations / stages, iterations % stages);
        for (index, stage) in self.stages.iter_mut().enumerate() {
            stage.iterations = share + usize::from(index < left_over);
        }
        if iterations > 0 {
            self.stages.retain(|stage| stage.iterations > 0);
            self.skip_when_tracking = self.skip_when_tracking.min(self.stages.len().saturating_sub(1));
        }
        self
    }

    /// First thing wrong with the numbers, by field.
    ///
    /// # Errors
    /// A weight or damping that is negative or not finite; no stage; a stride of zero.
    pub fn check(&self) -> Result<(), OptionsError> {
        let weights = [
            ("damping", self.damping),
            ("proximal_weight", self.proximal_weight),
            ("proximal_root_factor", self.proximal_root_factor),
            ("rest_weight", self.rest_weight),
            ("limit_weight", self.limit_weight),
            ("interpenetration_weight", self.interpenetration_weight),
            ("prior.pose_weight", self.prior.as_ref().map_or(0.0, |prior| prior.pose_weight)),
            ("prior.step_weight", self.prior.as_ref().map_or(0.0, |prior| prior.step_weight)),
            ("largest_turn", self.largest_turn.unwrap_or(1.0)),
            ("largest_move", self.largest_move.unwrap_or(1.0)),
        ];
        if let Some(&(field, value)) = weights.iter().find(|(_, value)| !is_weight(*value)) {
            return Err(OptionsError::Number { field, value });
        }
        if self.stages.is_empty() {
            return Err(OptionsError::NoStages);
        }
        let losses = [("pixel_loss", self.pixel_loss), ("proximal_loss", self.proximal_loss)];
        if let Some(&(field, _)) = losses.iter().find(|(_, loss)| !loss.is_valid()) {
            return Err(OptionsError::Loss { field });
        }
        for (index, stage) in self.stages.iter().enumerate() {
            if !is_weight(stage.priors) {
                return Err(OptionsError::Number { field: "stages.priors", value: stage.priors });
            }
            if !(1..=MAX_STRIDE).contains(&stage.stride) {
                return Err(OptionsError::Stride { index, stride: stage.stride });
            }
            if stage.iterations > MAX_ITERATIONS {
                return Err(OptionsError::Iterations { index, iterations: stage.iterations });
            }
            if !stage.ramp.is_valid() {
                return Err(OptionsError::Ramp { index, ramp: stage.ramp });
            }
            if stage.data == DataView::Distance && !matches!(stage.ramp, Ramp::Distance { .. }) {
                return Err(OptionsError::DistanceData { index });
            }
        }
        Ok(())
    }
}

/// Whether a weight or damping can be computed with: squares of larger ones run out of range.
fn is_weight(value: f64) -> bool {
    (0.0..=LARGEST_WEIGHT).contains(&value)
}

/// What is wrong with options.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum OptionsError {
    #[error("`{field}` is {}; expected a number from 0 to {LARGEST_WEIGHT:e}", Brief(*.value))]
    Number { field: &'static str, value: f64 },
    #[error("`{field}` has a scale that is not above 0; expected a finite number")]
    Loss { field: &'static str },
    #[error("`stages` is empty; expected at least one stage")]
    NoStages,
    #[error("`stages[{index}].stride` is {stride}; expected 1 to {MAX_STRIDE} pixels")]
    Stride { index: usize, stride: usize },
    #[error("`stages[{index}].iterations` is {iterations}; expected at most {MAX_ITERATIONS}")]
    Iterations { index: usize, iterations: usize },
    #[error("`stages[{index}].ramp` is {ramp}; expected widths of finite pixels above 0")]
    Ramp { index: usize, ramp: Ramp },
    #[error("`stages[{index}]`: data = \"distance\" needs a distance ramp, whose widths it takes")]
    DistanceData { index: usize },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_cannot_be_computed_with_are_named() {
        let with = |change: fn(&mut FitOptions)| {
            let mut options = FitOptions::default();
            change(&mut options);
            options.check().unwrap_err().to_string()
        };
        for (change, expected) in [
            ((|options| options.limit_weight = 1e308) as fn(&mut FitOptions), "limit_weight"),
            (|options| options.damping = f64::NAN, "damping"),
            (|options| options.stages[1].priors = f64::INFINITY, "stages.priors"),
            (|options| options.stages[0].stride = 1 << 32, "stages[0].stride"),
            (|options| options.stages[0].stride = 0, "stages[0].stride"),
            (|options| options.stages[2].iterations = usize::MAX, "stages[2].iterations"),
        ] {
            let said = with(change);
            assert!(said.contains(expected) && said.contains("expected"), "{said}");
        }
    }

    #[test]
    fn presets_are_valid_and_know_themselves() {
        for preset in Preset::ALL {
            let options = FitOptions::preset(preset);
            assert_eq!(options.check(), Ok(()));
            assert_eq!(options.as_preset(), Some(preset));
            let text = serde_json::to_string(&options).unwrap();
            assert_eq!(serde_json::from_str::<FitOptions>(&text).unwrap(), options);
        }
    }

    /// Section 4.3 smooths the silhouette, and a ramp that is asked for does not undo that.
    #[test]
    fn the_report_looks_at_smoothed_silhouettes() {
        let report = FitOptions::preset(Preset::Report);
        assert_eq!(report.stages[0].data, DataView::Averaged { radius_px: 1 });
        assert_eq!(report.clone().with_ramp(Ramp::Thesis), report);
        let distance = Ramp::Distance { inner_px: 1.0, outer_px: 2.0 };
        assert_eq!(report.with_ramp(distance).stages[0].data, DataView::Distance);
        let robust = FitOptions::preset(Preset::Robust).with_ramp(Ramp::Half);
        assert_eq!(robust.stages[0].data, DataView::Hard);
    }

    #[test]
    fn iterations_are_shared_out() {
        let shares = |iterations| -> Vec<usize> {
            let options = FitOptions::preset(Preset::Robust).with_iterations(iterations);
            assert_eq!(options.check(), Ok(()));
            options.stages.iter().map(|stage| stage.iterations).collect()
        };
        assert_eq!(shares(52), [11, 11, 10, 10, 10]);
        assert_eq!(shares(2), [1, 1]);
        assert_eq!(shares(0), [0; 5]);
    }
}
