//! Ways to come by the first pose where it is hardly known or not at all (the report's 6.4), behind one trait.
//!
//! | [`InitialisationMethod`] | from a given start | without one |
//! |---|---|---|
//! | `report` | the 2004 method downhill: its ramp as it is | the same from a body standing in the hull, facing eight ways; the best by cost |
//! | `ramp-alone` | the 2004 method, whose ramp is softened and sharpened step by step, and nothing else | likewise |
//! | `ramp` | the robust preset: the softened ramp on distance data, with its solver and priors | likewise |
//! | `particles` | the partitioned, annealed particle filter | from those eight bodies |
//! | `templates` | head, trunk, limb after limb, whatever the start | the same |
//! | `search` | the program's own search for other hypotheses | its search from the hull |
//! | `body` | a body of unknown size, grown from nothing, whatever the start | the same |
//!
//! Poses of particles and templates are refined by the same fit downhill; [`InitialisationResult::before`] is the pose before
//! that. Evaluations are predictions Λ of a body in all cameras, with or without derivatives, in whatever coarseness; looks at
//! single limbs in the search's sketch and at single templates are not counted.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use serde::Serialize;
use thiserror::Error;

use crate::acquisition::{AcquireError, AcquireOptions, GrowthRound, acquire};
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{ApparentSize, DataView, Fit, FitError, FitOptions, FitView, Preset, Stage};
use crate::optimize::Iteration;
use crate::particles::{Generation, ParticleError, ParticleFilter, ParticleOptions, Partition};
use crate::search::{
    Hypothesis, Origin, SearchOptions, WithoutStartError, WithoutStartOptions, search, standing,
    without_start,
};
use crate::templates::{TemplateError, TemplateOptions, TemplateStep, place};

/// Ways to face of a body that stands in the hull.
const HEADINGS: usize = 8;

/// What there is to begin with.
#[derive(Debug, Clone, Copy)]
pub struct InitialisationInputs<'a> {
    /// The body.
    pub model: &'a Arc<Model>,
    /// What the cameras see.
    pub views: &'a [FitView],
    /// A start; `None` where none is known.
    pub start: Option<&'a Pose>,
    /// Stops whatever is tried.
    pub cancel: &'a CancelToken,
}

/// One thing that was tried on the way, whatever tried it.
#[derive(Debug, Clone, Copy)]
pub enum Attempt<'a> {
    /// A fit begins to go downhill.
    Start {
        /// From here.
        pose: &'a Pose,
        /// Index of this start.
        index: usize,
        /// How many starts there are.
        count: usize,
    },
    /// The fit has gone on by an iteration.
    Iteration {
        /// The iteration.
        record: &'a Iteration<Pose>,
        /// What the fit looks at.
        stage: &'a Stage,
    },
    /// Particles were sampled in a partition of the body, and weighed.
    Generation {
        /// All of them.
        generation: &'a Generation,
        /// The partition.
        partition: &'a Partition,
        /// How many layers there are.
        layers: usize,
    },
    /// A template has turned.
    Template(&'a TemplateStep),
    /// The search has refined a pose.
    Hypothesis(&'a Hypothesis),
    /// The search without a start has ended a round, and these are left, best first.
    Round(&'a [Hypothesis]),
    /// The limbs of a body of unknown size were grown.
    Growth {
        /// Sizes before and after.
        round: &'a GrowthRound,
        /// Index of the round.
        index: usize,
        /// How many rounds there are.
        count: usize,
        /// What the given body was scaled by before it was grown.
        scale: f64,
    },
    /// The grown body was fitted a last time.
    Grown {
        /// The body.
        model: &'a Arc<Model>,
        /// Its pose.
        pose: &'a Pose,
        /// Sizes that were measured.
        measured: usize,
    },
}

/// Hears of every attempt, in order.
pub type OnAttempt<'a> = &'a mut dyn FnMut(Attempt<'_>);

/// Where a way to begin ended.
#[derive(Debug, Clone, PartialEq)]
pub struct InitialisationResult {
    /// The body that the poses are of: the given one, or one of the person's own sizes.
    pub model: Arc<Model>,
    /// Poses, best first; empty where silhouettes of a few pixels do not meet.
    pub hypotheses: Vec<Hypothesis>,
    /// The pose before the last fit, of ways that are no fit themselves.
    pub before: Option<Pose>,
    /// Evaluations of Λ, where they are counted.
    pub evaluations: Option<usize>,
}

impl InitialisationResult {
    /// The best pose.
    #[must_use]
    pub fn pose(&self) -> Option<&Pose> {
        self.hypotheses.first().map(|best| &best.pose)
    }
}

/// Why nothing could be tried.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum InitialisationError {
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    WithoutStart(#[from] WithoutStartError),
    #[error(transparent)]
    Particles(#[from] ParticleError),
    #[error(transparent)]
    Templates(#[from] TemplateError),
    #[error(transparent)]
    Acquire(#[from] AcquireError),
    #[error("the search for a first pose was stopped")]
    Cancelled,
}

/// What a way to begin gives.
pub type Initialised = Result<InitialisationResult, InitialisationError>;

/// A way to come by the first pose.
pub trait Initialisation {
    /// Looks for poses and tells of every attempt; templates, the search and growing tell of theirs when they have ended.
    ///
    /// # Errors
    /// Returns an error if nothing can be tried, or if it is cancelled.
    fn hypotheses(&self, inputs: &InitialisationInputs<'_>, on_attempt: OnAttempt<'_>) -> Initialised;
}

/// The ways to begin that the program knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum InitialisationMethod {
    /// The 2004 method downhill.
    Report,
    /// The 2004 method with the softened ramp, and nothing else of ours.
    RampAlone,
    /// The robust preset downhill: the softened ramp with all that was put beside it.
    Ramp,
    /// The particle filter.
    Particles,
    /// Templates, one after the other.
    Templates,
    /// The program's own search.
    Search,
    /// A body acquired from nothing: pose and sizes.
    Body,
}

impl InitialisationMethod {
    /// Those that look for the pose of a given body, and can be compared with one another.
    pub const COMPARED: [Self; 6] =
        [Self::Report, Self::RampAlone, Self::Ramp, Self::Particles, Self::Templates, Self::Search];

    /// Its name on the command line and in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Report => "report",
            Self::RampAlone => "ramp-alone",
            Self::Ramp => "ramp",
            Self::Particles => "particles",
            Self::Templates => "templates",
            Self::Search => "search",
            Self::Body => "body",
        }
    }
}

impl fmt::Display for InitialisationMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for InitialisationMethod {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let all = || Self::COMPARED.map(Self::name).join(", ");
        let known = Self::COMPARED.into_iter().find(|method| method.name() == text);
        known.ok_or_else(|| format!("\"{text}\" is not a way to begin; expected some of {}", all()))
    }
}

/// The choices of all methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InitialisationOptions {
    /// Particles from a given start.
    pub particles: ParticleOptions,
    /// Particles without one.
    pub particles_no_start: ParticleOptions,
    /// Places of the head that templates go on with; 1 as Mikić et al. do it.
    pub heads: usize,
}

impl Default for InitialisationOptions {
    fn default() -> Self {
        let particles = ParticleOptions::default();
        let particles_no_start = ParticleOptions {
            particles: 2 * particles.particles,
            trunk_turn_rad: 0.3,
            chain_turn_rad: 0.9,
            ..particles.clone()
        };
        Self { particles, particles_no_start, heads: 3 }
    }
}

impl InitialisationOptions {
    /// A method with these choices.
    #[must_use]
    pub fn method(&self, method: InitialisationMethod) -> Box<dyn Initialisation> {
        match method {
            InitialisationMethod::Report => Box::new(Downhill(FitOptions::preset(Preset::Report))),
            InitialisationMethod::RampAlone => Box::new(SoftenedRamp),
            InitialisationMethod::Ramp => Box::new(Downhill(FitOptions::default())),
            InitialisationMethod::Particles => Box::new(Particles(self.clone())),
            InitialisationMethod::Templates => {
                Box::new(TemplateOptions { heads: self.heads, ..TemplateOptions::default() })
            }
            InitialisationMethod::Search => Box::new(Search),
            InitialisationMethod::Body => Box::new(AcquireOptions::default()),
        }
    }

    /// Runs a method to its end. Silhouettes that do not meet are an answer: no hypothesis.
    ///
    /// # Errors
    /// Returns an error if nothing can be tried, or if it is cancelled.
    pub fn run(
        &self,
        method: InitialisationMethod,
        inputs: &InitialisationInputs<'_>,
        on_attempt: OnAttempt<'_>,
    ) -> Initialised {
        use InitialisationError as Error;
        let result = self.method(method).hypotheses(inputs, on_attempt);
        match result {
            _ if inputs.cancel.is_cancelled() => Err(Error::Cancelled),
            Err(
                Error::WithoutStart(WithoutStartError::Apart { .. })
                | Error::Templates(
                    TemplateError::NowhereInside | TemplateError::Place(WithoutStartError::Apart { .. }),
                ),
            ) => Ok(inputs.result(Vec::new(), 0)),
            result => result,
        }
    }
}

impl InitialisationInputs<'_> {
    /// The given start, or a body that stands in the hull and faces every way.
    fn starts(&self) -> Result<Vec<Pose>, WithoutStartError> {
        match self.start {
            Some(start) => Ok(vec![start.clone()]),
            None => standing(self.model, self.views, None, HEADINGS, self.cancel),
        }
    }

    fn result(&self, hypotheses: Vec<Hypothesis>, evaluations: usize) -> InitialisationResult {
        let (model, evaluations) = (Arc::clone(self.model), Some(evaluations));
        InitialisationResult { model, hypotheses, before: None, evaluations }
    }

    /// Refines a rough pose: all stages but the widest, without any pull to it where two cameras hold its depth.
    fn refined(&self, rough: Pose, evaluations: usize, on_attempt: OnAttempt<'_>) -> Initialised {
        let mut options = FitOptions::default().at_scale(self.model, self.views, &rough);
        options.stages.drain(..options.skip_when_tracking.min(options.stages.len() - 1));
        if self.views.len() > 1 {
            options.proximal_weight = 0.0;
        }
        let from_rough = InitialisationInputs { start: Some(&rough), ..*self };
        let result = Downhill(options).hypotheses(&from_rough, on_attempt)?;
        let evaluations = result.evaluations.map(|own| own + evaluations);
        Ok(InitialisationResult { before: Some(rough), evaluations, ..result })
    }
}

/// The report's fit, first on ramps as wide as the robust preset's, with D softened likewise, then on its own. Λ softened alone
/// leaves the silhouettes: a wide grey body costs least where nothing is dark.
struct SoftenedRamp;

impl Initialisation for SoftenedRamp {
    fn hypotheses(&self, inputs: &InitialisationInputs<'_>, on_attempt: OnAttempt<'_>) -> Initialised {
        let mut options = FitOptions::preset(Preset::Report);
        let (own, begin) = (options.stages[0], inputs.starts()?);
        let softer = begin.first().map(|start| ApparentSize::of(inputs.model, inputs.views, start).stages());
        let softer = softer.unwrap_or_default().into_iter().filter(|stage| stage.data == DataView::Distance);
        let softer = softer.map(|Stage { ramp, data, .. }| Stage { ramp, data, ..own });
        options.stages.splice(0..0, softer);
        Downhill(options).hypotheses(inputs, on_attempt)
    }
}

/// Downhill from every start; the best by cost.
struct Downhill(FitOptions);

impl Initialisation for Downhill {
    fn hypotheses(&self, inputs: &InitialisationInputs<'_>, on_attempt: OnAttempt<'_>) -> Initialised {
        let starts = inputs.starts()?;
        let count = starts.len();
        let (mut hypotheses, mut evaluations) = (Vec::with_capacity(count), 0);
        for (index, start) in starts.into_iter().enumerate() {
            on_attempt(Attempt::Start { pose: &start, index, count });
            let (model, views) = (Arc::clone(inputs.model), inputs.views.to_vec());
            let mut fit = Fit::new(model, views, start, self.0.clone())?;
            let stages = fit.options.stages.clone();
            let summary = fit.run(inputs.cancel, |record| {
                on_attempt(Attempt::Iteration { record, stage: &stages[record.stage] });
            });
            evaluations += summary.iterations.len() + stages.len();
            let cost = if summary.is_broken() { f64::INFINITY } else { summary.final_cost };
            hypotheses.push(Hypothesis { pose: summary.pose, cost, origin: Origin::Start });
        }
        // Of equals the first stays first, and what is no number comes last.
        hypotheses.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        Ok(inputs.result(hypotheses, evaluations))
    }
}

/// The particle filter, with other choices where there is no start.
struct Particles(InitialisationOptions);

impl Initialisation for Particles {
    fn hypotheses(&self, inputs: &InitialisationInputs<'_>, on_attempt: OnAttempt<'_>) -> Initialised {
        let Self(InitialisationOptions { particles, particles_no_start, .. }) = self;
        let options = if inputs.start.is_some() { particles } else { particles_no_start };
        let starts = inputs.starts()?;
        let (model, views) = (Arc::clone(inputs.model), inputs.views.to_vec());
        let mut filter = ParticleFilter::new(model, views, &starts, options.clone())?;
        let partitions = filter.parts().to_vec();
        let best = filter.run(inputs.cancel, |generation| {
            let partition = &partitions[generation.part];
            on_attempt(Attempt::Generation { generation, partition, layers: options.layers });
        });
        inputs.refined(best.pose, best.evaluations, on_attempt)
    }
}

impl Initialisation for TemplateOptions {
    fn hypotheses(&self, inputs: &InitialisationInputs<'_>, on_attempt: OnAttempt<'_>) -> Initialised {
        let placed = place(inputs.model, inputs.views, self, inputs.cancel)?;
        placed.steps.iter().for_each(|step| on_attempt(Attempt::Template(step)));
        inputs.refined(placed.pose, placed.evaluations, on_attempt)
    }
}

/// The program's own search: for other hypotheses than the start's, or from the hull.
struct Search;

impl Initialisation for Search {
    fn hypotheses(&self, inputs: &InitialisationInputs<'_>, on_attempt: OnAttempt<'_>) -> Initialised {
        let InitialisationInputs { model, views, start, cancel } = *inputs;
        let Some(start) = start else {
            let found = without_start(model, views, &WithoutStartOptions::default(), cancel)?;
            found.rounds.iter().for_each(|round| on_attempt(Attempt::Round(round)));
            on_attempt(Attempt::Round(&found.hypotheses));
            return Ok(inputs.result(found.hypotheses, found.evaluations));
        };
        let options = FitOptions::default().at_scale(model, views, start);
        let found = search(model, views.to_vec(), start, &options, &SearchOptions::default(), cancel)?;
        found.tried.iter().for_each(|tried| on_attempt(Attempt::Hypothesis(tried)));
        Ok(inputs.result(found.hypotheses, found.evaluations))
    }
}

impl Initialisation for AcquireOptions {
    fn hypotheses(&self, inputs: &InitialisationInputs<'_>, on_attempt: OnAttempt<'_>) -> Initialised {
        let acquired = acquire(inputs.model, inputs.views, self, inputs.cancel)?;
        let (count, scale) = (acquired.rounds.len(), acquired.scale);
        for (index, round) in acquired.rounds.iter().enumerate() {
            on_attempt(Attempt::Growth { round, index, count, scale });
        }
        let (model, measured) = (acquired.model, acquired.measured);
        for pose in &acquired.poses {
            on_attempt(Attempt::Grown { model: &model, pose, measured });
        }
        let best = |pose| Hypothesis { pose, cost: f64::NAN, origin: Origin::Hull };
        let hypotheses = acquired.poses.into_iter().map(best).collect();
        Ok(InitialisationResult { model, hypotheses, before: None, evaluations: None })
    }
}
