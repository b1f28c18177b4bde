//! How each of them begins and ends.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, FitView, Preset};
use backlit_tracking::particles::ParticleFilter;
use backlit_tracking::search::{
    SearchOptions, WithoutStart, WithoutStartError, search, standing, without_start,
};
use backlit_tracking::templates::{TemplateError, TemplateOptions, place};
use serde::Serialize;

use super::Options;
use crate::experiment::ExperimentError;

/// Ways to face of a body that stands in the hull.
const HEADINGS: usize = 8;

/// A way to begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The 2004 method downhill.
    Report,
    /// The softened ramp, annealed, downhill.
    Ramp,
    /// The particle filter.
    Particles,
    /// Templates, one after the other.
    Templates,
    /// The program's own search.
    Search,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Report, Self::Ramp, Self::Particles, Self::Templates, Self::Search];

    /// Its name on the command line and in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Report => "report",
            Self::Ramp => "ramp",
            Self::Particles => "particles",
            Self::Templates => "templates",
            Self::Search => "search",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let all = || Self::ALL.map(Self::name).join(", ");
        let found = Self::ALL.into_iter().find(|method| method.name() == text);
        found.ok_or_else(|| format!("\"{text}\" is not a way to begin; expected some of {}", all()))
    }
}

/// What there is to begin with.
#[derive(Debug, Clone, Copy)]
pub struct Beginning<'a> {
    /// The body.
    pub model: &'a Arc<Model>,
    /// What the cameras see.
    pub views: &'a [FitView],
    /// A start; `None` where none is known.
    pub start: Option<&'a Pose>,
}

/// Where a method ended.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// The pose; `None` where silhouettes of a few pixels do not meet.
    pub pose: Option<Pose>,
    /// The pose before the last fit, of methods that are no fit themselves.
    pub before: Option<Pose>,
    /// Evaluations of Λ.
    pub evaluations: usize,
}

const NOWHERE: End = End { pose: None, before: None, evaluations: 0 };

/// Begins and ends.
///
/// # Errors
/// A fit that cannot begin, or `cancel`. Silhouettes that do not meet are an answer.
pub fn begin(
    method: Method,
    from: &Beginning<'_>,
    options: &Options,
    cancel: &CancelToken,
) -> Result<End, ExperimentError> {
    let end = match method {
        Method::Report => downhill(from, &FitOptions::preset(Preset::Report), cancel),
        Method::Ramp => downhill(from, &FitOptions::default(), cancel),
        Method::Particles => particles(from, options, cancel),
        Method::Templates => templates(from, options, cancel),
        Method::Search => searched(from, cancel),
    };
    match end {
        _ if cancel.is_cancelled() => Err(ExperimentError::Cancelled),
        Err(ExperimentError::WithoutStart(WithoutStartError::Apart { .. })) => Ok(NOWHERE),
        end => end,
    }
}

/// The given start, or a body that stands in the hull and faces every way.
fn starts(from: &Beginning<'_>, cancel: &CancelToken) -> Result<Vec<Pose>, ExperimentError> {
    match from.start {
        Some(start) => Ok(vec![start.clone()]),
        None => Ok(standing(from.model, from.views, None, HEADINGS, cancel)?),
    }
}

/// Downhill from every start; the best by cost.
fn downhill(
    from: &Beginning<'_>,
    options: &FitOptions,
    cancel: &CancelToken,
) -> Result<End, ExperimentError> {
    let mut best: Option<(f64, Pose)> = None;
    let mut evaluations = 0;
    for start in starts(from, cancel)? {
        let mut fit = Fit::new(Arc::clone(from.model), from.views.to_vec(), start, options.clone())?;
        let summary = fit.run(cancel, |_| {});
        evaluations += summary.iterations.len() + fit.options().stages.len();
        let cost = if summary.is_broken() { f64::INFINITY } else { summary.final_cost };
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, summary.pose));
        }
    }
    Ok(End { pose: best.map(|(_, pose)| pose), before: None, evaluations })
}

/// Refines a rough pose: all stages but the widest, without any pull to it where two cameras hold its depth.
fn refined(
    from: &Beginning<'_>,
    rough: Pose,
    evaluations: usize,
    cancel: &CancelToken,
) -> Result<End, ExperimentError> {
    let mut options = FitOptions::default().at_scale(from.model, from.views, &rough);
    options.stages.drain(..options.skip_when_tracking.min(options.stages.len() - 1));
    if from.views.len() > 1 {
        options.proximal_weight = 0.0;
    }
    let rough = Beginning { start: Some(&rough), ..*from };
    let end = downhill(&rough, &options, cancel)?;
    Ok(End { before: rough.start.cloned(), evaluations: end.evaluations + evaluations, ..end })
}

fn particles(from: &Beginning<'_>, options: &Options, cancel: &CancelToken) -> Result<End, ExperimentError> {
    let chosen = if from.start.is_some() { &options.particles } else { &options.particles_no_start };
    let starts = starts(from, cancel)?;
    let (model, views) = (Arc::clone(from.model), from.views.to_vec());
    let mut filter = ParticleFilter::new(model, views, &starts, chosen.clone())?;
    let found = filter.run(cancel, |_| {});
    refined(from, found.pose, found.evaluations, cancel)
}

fn templates(from: &Beginning<'_>, options: &Options, cancel: &CancelToken) -> Result<End, ExperimentError> {
    let options = TemplateOptions { heads: options.heads, ..TemplateOptions::default() };
    match place(from.model, from.views, &options, cancel) {
        Ok(placed) => refined(from, placed.pose, placed.evaluations, cancel),
        Err(TemplateError::NowhereInside | TemplateError::Place(WithoutStartError::Apart { .. })) => {
            Ok(NOWHERE)
        }
        Err(error) => Err(error.into()),
    }
}

fn searched(from: &Beginning<'_>, cancel: &CancelToken) -> Result<End, ExperimentError> {
    let (pose, evaluations) = if let Some(start) = from.start {
        let options = FitOptions::default().at_scale(from.model, from.views, start);
        let effort = SearchOptions::default();
        let mut found = search(from.model, from.views.to_vec(), start, &options, &effort, cancel)?;
        (found.found.swap_remove(0).pose, found.evaluations)
    } else {
        let mut found = without_start(from.model, from.views, &WithoutStart::default(), cancel)?;
        (found.candidates.swap_remove(0).pose, found.evaluations)
    };
    Ok(End { pose: Some(pose), before: None, evaluations })
}
