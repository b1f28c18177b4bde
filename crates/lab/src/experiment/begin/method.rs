//! How each of them begins and ends.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitOptions, FitView, Preset, Stage};
use backlit_tracking::optimize::Iteration;
use backlit_tracking::particles::{Generation, Part, ParticleFilter};
use backlit_tracking::search::{
    Hypothesis, Rated, SearchOptions, WithoutStart, WithoutStartError, search, standing, without_start,
};
use backlit_tracking::templates::{TemplateError, TemplateOptions, TemplateStep, place};
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

/// What a method does on its way.
#[derive(Debug, Clone, Copy)]
pub enum Step<'a> {
    /// A fit begins to go downhill.
    Start {
        /// From here.
        pose: &'a Pose,
        /// Which start of how many, from 0 on.
        of: [usize; 2],
    },
    /// It has gone on by a step.
    Downhill {
        /// The step.
        record: &'a Iteration<Pose>,
        /// What the fit looks at.
        stage: &'a Stage,
    },
    /// Particles were sampled in a part of the body, and weighed.
    Particles {
        /// All of them.
        generation: &'a Generation,
        /// The part.
        part: &'a Part,
        /// How many layers there are.
        layers: usize,
    },
    /// A template has turned.
    Template(&'a TemplateStep),
    /// The search has refined a pose.
    Tried(&'a Hypothesis),
    /// The search without a start has ended a round, and these are left, best first.
    Round(&'a [Rated]),
}

/// Hears of every step, in order.
pub type Watch<'a> = &'a mut dyn FnMut(Step<'_>);

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
    begin_watched(method, from, options, cancel, &mut |_| {})
}

/// The same, and tells of every step. Templates and the search tell of theirs when they have ended.
///
/// # Errors
/// As [`begin`].
pub fn begin_watched(
    method: Method,
    from: &Beginning<'_>,
    options: &Options,
    cancel: &CancelToken,
    watch: Watch<'_>,
) -> Result<End, ExperimentError> {
    let end = match method {
        Method::Report => downhill(from, &FitOptions::preset(Preset::Report), cancel, watch),
        Method::Ramp => downhill(from, &FitOptions::default(), cancel, watch),
        Method::Particles => particles(from, options, cancel, watch),
        Method::Templates => templates(from, options, cancel, watch),
        Method::Search => searched(from, cancel, watch),
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
    watch: Watch<'_>,
) -> Result<End, ExperimentError> {
    let mut best: Option<(f64, Pose)> = None;
    let mut evaluations = 0;
    let starts = starts(from, cancel)?;
    let of = starts.len();
    for (index, start) in starts.into_iter().enumerate() {
        watch(Step::Start { pose: &start, of: [index, of] });
        let mut fit = Fit::new(Arc::clone(from.model), from.views.to_vec(), start, options.clone())?;
        let stages = fit.options().stages.clone();
        let summary =
            fit.run(cancel, |record| watch(Step::Downhill { record, stage: &stages[record.stage] }));
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
    watch: Watch<'_>,
) -> Result<End, ExperimentError> {
    let mut options = FitOptions::default().at_scale(from.model, from.views, &rough);
    options.stages.drain(..options.skip_when_tracking.min(options.stages.len() - 1));
    if from.views.len() > 1 {
        options.proximal_weight = 0.0;
    }
    let rough = Beginning { start: Some(&rough), ..*from };
    let end = downhill(&rough, &options, cancel, watch)?;
    Ok(End { before: rough.start.cloned(), evaluations: end.evaluations + evaluations, ..end })
}

fn particles(
    from: &Beginning<'_>,
    options: &Options,
    cancel: &CancelToken,
    watch: Watch<'_>,
) -> Result<End, ExperimentError> {
    let chosen = if from.start.is_some() { &options.particles } else { &options.particles_no_start };
    let starts = starts(from, cancel)?;
    let (model, views) = (Arc::clone(from.model), from.views.to_vec());
    let mut filter = ParticleFilter::new(model, views, &starts, chosen.clone())?;
    let parts = filter.parts().to_vec();
    let found = filter.run(cancel, |generation| {
        watch(Step::Particles { generation, part: &parts[generation.part], layers: chosen.layers });
    });
    refined(from, found.pose, found.evaluations, cancel, watch)
}

fn templates(
    from: &Beginning<'_>,
    options: &Options,
    cancel: &CancelToken,
    watch: Watch<'_>,
) -> Result<End, ExperimentError> {
    let options = TemplateOptions { heads: options.heads, ..TemplateOptions::default() };
    match place(from.model, from.views, &options, cancel) {
        Ok(placed) => {
            placed.steps.iter().for_each(|step| watch(Step::Template(step)));
            refined(from, placed.pose, placed.evaluations, cancel, watch)
        }
        Err(TemplateError::NowhereInside | TemplateError::Place(WithoutStartError::Apart { .. })) => {
            Ok(NOWHERE)
        }
        Err(error) => Err(error.into()),
    }
}

fn searched(from: &Beginning<'_>, cancel: &CancelToken, watch: Watch<'_>) -> Result<End, ExperimentError> {
    let (pose, evaluations) = if let Some(start) = from.start {
        let options = FitOptions::default().at_scale(from.model, from.views, start);
        let effort = SearchOptions::default();
        let mut found = search(from.model, from.views.to_vec(), start, &options, &effort, cancel)?;
        found.tried.iter().for_each(|tried| watch(Step::Tried(tried)));
        (found.found.swap_remove(0).pose, found.evaluations)
    } else {
        let mut found = without_start(from.model, from.views, &WithoutStart::default(), cancel)?;
        found.rounds.iter().for_each(|round| watch(Step::Round(round)));
        let last: Vec<Rated> = found.candidates.iter().map(|one| (one.cost, one.pose.clone())).collect();
        watch(Step::Round(&last));
        (found.candidates.swap_remove(0).pose, found.evaluations)
    };
    Ok(End { pose: Some(pose), before: None, evaluations })
}
