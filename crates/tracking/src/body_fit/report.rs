//! What was found, and how well each size is seen.
//!
//! Posterior variances are the diagonal of (JᵀJ)⁻¹ with the priors in it, in units in which the prior of proportions
//! has its stated standard deviations. Divided by the prior's, 1 means that the silhouettes say nothing.

use nalgebra::DVector;

use super::options::BodyFitOptions;
use super::problem::BodyState;
use crate::body::{Model, ModelError, Pose, SizeKind, Sizes};
use crate::optimize::{NormalEquations, Termination};

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
}

impl SizeEstimate {
    /// Deviation over the prior's: 0 seen perfectly, 1 not seen at all.
    #[must_use]
    pub fn uncertainty(&self) -> f64 {
        self.deviation / self.prior_deviation
    }

    /// Whether the silhouettes hardly say anything about it.
    #[must_use]
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
    /// The body's size over the start's, as a factor.
    pub size: f64,
    /// The body's girth beside its size, as a factor.
    pub girth: f64,
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

/// Posterior standard deviations of the columns from `first` on.
pub(super) fn deviations(equations: &NormalEquations, unit: f64, first: usize) -> Vec<f64> {
    let columns = equations.columns();
    let mut matrix = &equations.jtj / unit;
    // Far below every prior: it only keeps directions without any from dividing by zero.
    for i in 0..columns {
        matrix[(i, i)] += 1e-9;
    }
    let Some(factor) = matrix.cholesky() else { return vec![f64::INFINITY; columns - first] };
    let variance = |column: usize| {
        let mut unit = DVector::zeros(columns);
        unit[column] = 1.0;
        factor.solve(&unit)[column]
    };
    (first..columns).map(|column| variance(column).max(0.0).sqrt()).collect()
}

#[expect(clippy::too_many_arguments, reason = "the parts of a result, before there is one")]
pub(super) fn summary(
    sizes: &Sizes,
    state: BodyState,
    deviations: &[f64],
    options: &BodyFitOptions,
    frames: Vec<usize>,
    rms: [f64; 2],
    iou: [Option<f64>; 2],
    iterations: usize,
    termination: Termination,
) -> Result<BodyFit, ModelError> {
    let model = sizes.model(&state.body.log_ratios, state.body.size)?;
    let estimate = |(index, parameter): (usize, &crate::body::SizeParameter)| {
        let found = sizes.metres(index, &model);
        SizeEstimate {
            name: parameter.name.clone(),
            kind: parameter.kind,
            start: sizes.metres(index, sizes.start()),
            found,
            deviation: found * deviations[index],
            prior_deviation: found * options.proportions.of(sizes, index),
        }
    };
    Ok(BodyFit {
        sizes: sizes.parameters().iter().enumerate().map(estimate).collect(),
        frames,
        poses: state.poses,
        size: state.body.size.exp(),
        girth: state.body.girth.exp(),
        rms,
        iou,
        iterations,
        termination,
        model,
    })
}
