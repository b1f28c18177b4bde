//! A pose put together from templates, one after the other, where no start is known.
//!
//! After I. Mikić, M. Trivedi, E. Hunter and P. Cosman, "Human body model acquisition and tracking using voxel data", IJCV 53,
//! 2003, with pixels in the place of voxels:
//!
//! 1. **Head.** A ball of the skull's radius. Of all places inside the silhouettes that one is the head's at which the ball's
//!    outlines hold most border pixels, as shares of their lengths.
//! 2. **Trunk.** A template hangs from the neck. In every camera the centroid of the subject's pixels in it is taken; the point
//!    nearest to the rays of all centroids is q; the template turns about the neck to pass through q; and so on until it
//!    rests,
//!
//!    ```text
//!    q = argmin Σ m |(I − u uᵀ)(q − c)|² + ε Σm |q − middle|²,   d ← (q − neck)/|q − neck|
//!    ```
//!
//!    with a camera's centre c, its centroid's ray u and its pixels m; ε leaves the depth as it is where one camera alone sees it.
//!    Which way the trunk faces, its own limbs' Λ says.
//! 3. **Limbs.** Of the pixels that no template holds yet: thick limbs first, each from its joint, begun in the direction
//!    in which it holds most of the subject and least background, then turned as the trunk is; then the limb after it.
//!
//! The report's sizes of limbs are given here. Every turn is kept as a [`TemplateStep`]. The result is rough, the start of a fit.

mod body;
mod limbs;
mod pictures;

use std::sync::Arc;

use glam::DVec3;
use limbs::{HeadHypothesis, Limbs, heads};
use thiserror::Error;

use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{FitError, FitOptions, FitView, PreparedFit, Stage};
use crate::numbers::{AT_LEAST_ONE, OptionError, POSITIVE, check_options};
use crate::particles::{Likelihood, LikelihoodMemory};
use crate::search::{SubjectPlace, WithoutStartError, reduced};

pub(crate) use body::{Segment, TemplateBody};
pub(crate) use pictures::{Silhouettes, Template};

/// How to place templates.
#[derive(Debug, Clone, PartialEq)]
pub struct TemplateOptions {
    /// Up in world axes, of any length; `None` asks the cameras ([`up_of`](crate::camera::up_of)).
    pub up: Option<DVec3>,
    /// Places of the head that are gone on with, best first, at least one: 1 as Mikić et al. do it.
    pub heads: usize,
    /// Ways to face that are tried of a trunk, and how many of them limbs are put on; each at least one.
    pub headings: [usize; 2],
    /// Directions tried of a limb, evenly over the sphere.
    pub directions: usize,
    /// Most turns of one template.
    pub turns: usize,
    /// A template rests when it turns by less, radians.
    pub rest_rad: f64,
    /// By what whole bodies are judged.
    pub fit: FitOptions,
}

impl Default for TemplateOptions {
    fn default() -> Self {
        Self {
            up: None,
            heads: 3,
            headings: [16, 4],
            directions: 80,
            turns: 30,
            rest_rad: 0.01,
            fit: FitOptions::default(),
        }
    }
}

/// Why templates could not be placed.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum TemplateError {
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error(transparent)]
    Place(#[from] WithoutStartError),
    #[error(transparent)]
    Option(#[from] OptionError),
    #[error("the body \"{model}\" is one chain of limbs; expected a trunk with a head on it")]
    NoHead { model: String },
    #[error("no place inside all silhouettes can be the head")]
    NowhereInside,
    #[error("placing templates was stopped")]
    Cancelled,
}

impl TemplateOptions {
    /// Checks all but the fit's options.
    ///
    /// # Errors
    /// The first option that is out of range.
    pub fn check(&self) -> Result<(), OptionError> {
        check_options([
            ("heads", self.heads as f64, AT_LEAST_ONE),
            ("headings", self.headings[0].min(self.headings[1]) as f64, AT_LEAST_ONE),
            ("directions", self.directions as f64, AT_LEAST_ONE),
            ("turns", self.turns as f64, AT_LEAST_ONE),
            ("rest_rad", self.rest_rad, POSITIVE),
        ])
    }
}

/// One turn of one template.
#[derive(Debug, Clone, PartialEq)]
pub struct TemplateStep {
    /// "head", "trunk", or the limb's name.
    pub template: String,
    /// The body so far.
    pub pose: Pose,
    /// Per limb, whether it is placed: others are at rest and say nothing.
    pub placed: Vec<bool>,
    /// The ends of the template, world metres: both the same for a ball.
    pub ends: [DVec3; 2],
    /// Its radius, metres.
    pub radius: f64,
    /// The share of its pixels that are the subject's, those in other templates left out.
    pub held: f64,
    /// By how much it turns next, radians.
    pub turned_rad: f64,
    /// Whether it rests here.
    pub rests: bool,
}

impl TemplateStep {
    fn of(template: &str, pose: Pose, placed: Vec<bool>, ends: [DVec3; 2], radius: f64) -> Self {
        let template = template.to_owned();
        Self { template, pose, placed, ends, radius, held: 1.0, turned_rad: 0.0, rests: true }
    }
}

type Record = Vec<TemplateStep>;

/// A body put together.
#[derive(Debug, Clone, PartialEq)]
pub struct TemplateResult {
    /// The pose.
    pub pose: Pose,
    /// Its cost by the fit's last but one stage (the only one, if there is one), limits included.
    pub cost: f64,
    /// Evaluations of Λ: trunks that face every way, and whole bodies. Looks at single templates are not counted.
    pub evaluations: usize,
    /// The turns of its templates, in order.
    pub steps: Vec<TemplateStep>,
}

/// Looks for the body without a start.
///
/// # Errors
/// Returns an error if nobody is seen, if silhouettes do not meet, if there is no vertical or no head, if an option is out of
/// range, or if it is cancelled.
pub fn place(
    model: &Arc<Model>,
    views: &[FitView],
    options: &TemplateOptions,
    cancel: &CancelToken,
) -> Result<TemplateResult, TemplateError> {
    options.check()?;
    let frame =
        TemplateBody::new(model).ok_or_else(|| TemplateError::NoHead { model: model.name().to_owned() })?;
    let at_rest = Pose::rest(model);
    let seen = PreparedFit::new(model, views.to_vec(), &at_rest, &options.fit, |_, _, _| 0.0)?.views;
    let place = SubjectPlace::of(&seen, options.up, frame.stance.height(), cancel)?;
    let standing = frame.stance.pose(model, place.middle(), place.up, place.to_cameras);
    let seen = reduced(model, &seen, &standing);
    let fit = options.fit.clone().at_scale(model, &seen, &standing);
    let stage: Stage = fit.stages[fit.stages.len().saturating_sub(2)];
    let likelihood = Likelihood::new(Arc::clone(model), &seen, &fit, &stage);
    let [skull, _] = frame.skull_and_neck();
    let pictures = Silhouettes::new(&seen);
    let heads = heads(&pictures, &place, model.limbs()[skull].radius, options.heads);
    let memory = likelihood.memory();
    let mut placing = Placing { frame, pictures, options, likelihood, memory, evaluations: 0 };
    let mut best: Option<TemplateResult> = None;
    for head in heads {
        for placed in placing.bodies_at(head, &place, cancel)? {
            if best.as_ref().is_none_or(|best| placed.cost < best.cost) {
                best = Some(placed);
            }
        }
    }
    let evaluations = placing.evaluations;
    best.map(|best| TemplateResult { evaluations, ..best }).ok_or(TemplateError::NowhereInside)
}

struct Placing<'a> {
    frame: TemplateBody<'a>,
    pictures: Silhouettes,
    options: &'a TemplateOptions,
    likelihood: Likelihood,
    memory: LikelihoodMemory,
    evaluations: usize,
}

impl Placing<'_> {
    /// The bodies that one place of the head leads to, one a facing.
    fn bodies_at(
        &mut self,
        head: HeadHypothesis,
        place: &SubjectPlace,
        cancel: &CancelToken,
    ) -> Result<Vec<TemplateResult>, TemplateError> {
        let mut record = Record::new();
        let begin = (head.centre, place.up, place.to_cameras);
        let hung = body::hung(&self.frame, &self.pictures, self.options, begin, &mut record);
        if let Some(first) = record.first_mut() {
            first.held = head.held;
        }
        let drawn = self.frame.trunk_limbs();
        let facings = body::facings(&self.frame, &hung, head.centre, self.options.headings[0]);
        let mut facings: Vec<(f64, Pose)> =
            facings.into_iter().map(|pose| (self.cost(&pose, &drawn), pose)).collect();
        facings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut bodies = Vec::new();
        for (_, facing) in facings.into_iter().take(self.options.headings[1]) {
            if cancel.is_cancelled() {
                return Err(TemplateError::Cancelled);
            }
            let mut free = self.pictures.clone();
            free.claim(&self.frame.trunk_template(&facing));
            for segment in self.frame.segments(self.frame.head) {
                free.claim(&self.frame.template(&facing, &segment));
            }
            let radius = self.frame.model.limbs()[self.frame.skull_and_neck()[0]].radius;
            free.claim(&Template { from: head.centre, to: head.centre, radius });
            let (frame, drawn, record) = (&self.frame, drawn.clone(), record.clone());
            let mut limbs =
                Limbs { frame, options: self.options, pictures: free, pose: facing, drawn, record };
            limbs.place();
            let Limbs { pose, record: steps, .. } = limbs;
            let all = vec![true; self.frame.model.limbs().len()];
            let cost = self.cost(&pose, &all);
            bodies.push(TemplateResult { pose, cost, evaluations: 0, steps });
        }
        Ok(bodies)
    }

    fn cost(&mut self, pose: &Pose, drawn: &[bool]) -> f64 {
        self.evaluations += 1;
        self.likelihood.cost(&mut self.memory, pose, drawn)
    }
}
