//! What was found, and how well each size is seen.
//!
//! Posterior variances are the diagonal of (JᵀJ)⁻¹ with the priors in it, in units in which the prior of proportions
//! has its stated standard deviations. Divided by the prior's, 1 means that the silhouettes say nothing.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::fit::Descent;
use super::frames::BodyFrame;
use super::options::BodyFitOptions;
use super::survey::LeftOut;
use super::widening::{self, Widening};
use crate::body::{Model, ModelError, Pose, SizeKind, Sizes};
use crate::optimize::{NormalEquations, StepMemory, Termination};

/// A size whose posterior deviation is above this share of its prior's is held by the prior.
const HELD_ABOVE: f64 = 0.7;

/// One size.
#[derive(Debug, Clone, PartialEq)]
pub struct SizeEstimate {
    /// The limb, without its side where both sides share the size.
    pub name: String,
    /// Length or radius.
    pub kind: SizeKind,
    /// What it was in the model that the fit began with, metres.
    pub start: f64,
    /// What was found, metres.
    pub found: f64,
    /// Standard deviation, metres, of what was found.
    pub deviation: f64,
    /// Standard deviation of what the proportions alone would say, metres, once the body's size is known.
    pub prior_deviation: f64,
    /// What the proportions alone would say for a body of this size and stoutness, metres.
    pub expected: f64,
}

impl SizeEstimate {
    /// Deviation over the prior's: 0 seen perfectly, 1 not seen at all.
    pub fn uncertainty(&self) -> f64 {
        self.deviation / self.prior_deviation
    }

    /// How far it is from what the proportions say for a body of this size and stoutness, as a logarithm in deviations.
    pub fn z_score(&self) -> f64 {
        (self.found / self.expected).ln() / (self.prior_deviation / self.found)
    }

    /// Whether the silhouettes hardly say anything about it.
    pub fn is_held_by_prior(&self) -> bool {
        self.uncertainty() > HELD_ABOVE
    }
}

/// A body that was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyFit {
    /// The body: names, structure, directions and limits are the start's.
    pub model: Model,
    /// Frames that counted.
    pub frames: Vec<usize>,
    /// Their poses.
    pub poses: Vec<Pose>,
    /// Silhouettes that cannot be a person's, and were left out.
    pub left_out: Vec<LeftOut>,
    /// The body's size over the start's, as a factor.
    pub size: f64,
    /// The body's girth beside its size, as a factor: how much stouter than the average.
    pub girth: f64,
    /// Standard deviation of the logarithm of people's girth, in the prior.
    pub girth_spread: f64,
    /// By how much the silhouettes are too wide; `None` where they were taken as they are.
    pub widening: Option<Widening>,
    /// Every free size: lengths, then radii.
    pub sizes: Vec<SizeEstimate>,
    /// Root of the mean squared residual per pixel before and after, grey levels, each by its own stage's measure.
    pub rms: [f64; 2],
    /// IoU before (scaled as a whole) and after; `None` without masks.
    pub iou: [Option<f64>; 2],
    /// Iterations of all stages, rejected ones included.
    pub iterations: usize,
    /// Why the last stage ended.
    pub termination: Termination,
}

impl BodyFit {
    /// The body that silhouettes show: stouter than the person by their widening, where that is believed. To be followed
    /// on such silhouettes.
    pub fn as_seen(&self) -> Model {
        match self.widening.filter(|widening| widening.is_believed) {
            Some(Widening { px, metres_per_px, .. }) => {
                widening::widened(&self.model, &vec![metres_per_px; self.model.limbs().len()], px)
                    .into_owned()
            }
            None => self.model.clone(),
        }
    }
}

/// Posterior standard deviations of some columns.
pub(super) fn deviations(equations: &NormalEquations, unit: f64, columns: Range<usize>) -> Vec<f64> {
    let covariance = covariance(equations, unit, columns);
    covariance.diagonal().iter().map(|variance| variance.max(0.0).sqrt()).collect()
}

/// Posterior covariance of some columns; infinite where the equations have none.
pub(super) fn covariance(equations: &NormalEquations, unit: f64, columns: Range<usize>) -> DMatrix<f64> {
    let mut factor = StepMemory::default();
    // Far below every prior: it only keeps directions without any from dividing by zero.
    if !factor.factor(&equations.jtj, |_| 1e-9 * unit) {
        return DMatrix::from_element(columns.len(), columns.len(), f64::INFINITY);
    }
    let mut found = DMatrix::zeros(columns.len(), columns.len());
    let (mut right, mut solution) =
        (DVector::zeros(equations.columns()), DVector::zeros(equations.columns()));
    for (at, column) in columns.clone().enumerate() {
        right[column] = unit;
        factor.solve(&right, &mut solution);
        right[column] = 0.0;
        found.column_mut(at).copy_from(&solution.rows(columns.start, columns.len()));
    }
    found
}

pub(super) fn summary(
    sizes: &Sizes,
    descent: Descent,
    options: &BodyFitOptions,
    frames: &[BodyFrame],
    iou: [Option<f64>; 2],
) -> Result<BodyFit, ModelError> {
    let Descent { state, deviations, widening, rms, iterations, termination, .. } = descent;
    let body = &state.body;
    let model = sizes.model(&body.log_ratios, body.size)?;
    let prior = options.proportions.prior(sizes);
    let estimate = |(index, parameter): (usize, &crate::body::SizeParameter)| {
        let (start, found) = (sizes.metres(index, &sizes.start), sizes.metres(index, &model));
        let spread = prior.spreads[index];
        SizeEstimate {
            name: parameter.name.clone(),
            kind: parameter.kind,
            start,
            found,
            deviation: found * deviations[index],
            prior_deviation: found * spread.deviation,
            expected: start * (spread.mean + body.size + spread.by_stoutness * body.girth).exp(),
        }
    };
    Ok(BodyFit {
        sizes: sizes.parameters.iter().enumerate().map(estimate).collect(),
        frames: frames.iter().map(|frame| frame.frame).collect(),
        size: body.size.exp(),
        girth: body.girth.exp(),
        girth_spread: prior.stoutness,
        widening,
        poses: state.poses,
        left_out: Vec::new(),
        rms,
        iou,
        iterations,
        termination,
        model,
    })
}
