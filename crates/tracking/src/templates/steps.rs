//! All of it: heads, trunks, facings and limbs, every turn kept.

use std::sync::Arc;

use glam::DVec3;

use super::frame::Frame;
use super::head::{Head, heads};
use super::options::{TemplateError, TemplateOptions};
use super::pictures::{Pictures, Template};
use super::{limbs, trunk};
use crate::body::{Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{FitView, PreparedFit, Stage};
use crate::particles::{Likelihood, LikelihoodMemory};
use crate::search::{Place, reduced};

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
    pub(super) fn of(template: &str, pose: Pose, placed: Vec<bool>, ends: [DVec3; 2], radius: f64) -> Self {
        let template = template.to_owned();
        Self { template, pose, placed, ends, radius, held: 1.0, turned_rad: 0.0, rests: true }
    }
}

pub(super) type Record = Vec<TemplateStep>;

/// A body put together.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The pose.
    pub pose: Pose,
    /// Its cost by the fit's last but one stage (the only one, if there is one), limits included.
    pub cost: f64,
    /// Evaluations of Λ: trunks that face every way, and whole bodies. Looks at single templates are not counted.
    pub evaluations: usize,
    /// Bodies that were put together; this is the one that costs least.
    pub bodies: usize,
    /// The turns of its templates, in order.
    pub steps: Vec<TemplateStep>,
}

/// Looks for the body without a start.
///
/// # Errors
/// Nobody is seen, silhouettes that do not meet, no vertical, a body without a head, numbers that make no sense, or `cancel`.
pub fn place(
    model: &Arc<Model>,
    views: &[FitView],
    options: &TemplateOptions,
    cancel: &CancelToken,
) -> Result<Placed, TemplateError> {
    options.check()?;
    let frame = Frame::new(model).ok_or_else(|| TemplateError::NoHead { model: model.name().to_owned() })?;
    let at_rest = Pose::rest(model);
    let seen = PreparedFit::new(model, views.to_vec(), &at_rest, &options.fit, |_, _, _| 0.0)?.views;
    let place = Place::of(&seen, options.up, frame.stance.height(), cancel)?;
    let standing = frame.stance.pose(model, place.middle(), place.up, place.to_cameras);
    let seen = reduced(model, &seen, &standing);
    let fit = options.fit.clone().at_scale(model, &seen, &standing);
    let stage: Stage = fit.stages[fit.stages.len().saturating_sub(2)];
    let likelihood = Likelihood::new(Arc::clone(model), &seen, &fit, &stage);
    let [skull, _] = frame.skull_and_neck();
    let pictures = Pictures::new(&seen);
    let heads = heads(&pictures, &place, model.limbs()[skull].radius, options.heads);
    let memory = likelihood.memory();
    let mut placing = Placing { frame, pictures, options, likelihood, memory, evaluations: 0, bodies: 0 };
    let mut best: Option<Placed> = None;
    for head in heads {
        for placed in placing.bodies_at(head, &place, cancel)? {
            if best.as_ref().is_none_or(|best| placed.cost < best.cost) {
                best = Some(placed);
            }
        }
    }
    let (evaluations, bodies) = (placing.evaluations, placing.bodies);
    best.map(|best| Placed { evaluations, bodies, ..best }).ok_or(TemplateError::NowhereInside)
}

struct Placing<'a> {
    frame: Frame<'a>,
    pictures: Pictures,
    options: &'a TemplateOptions,
    likelihood: Likelihood,
    memory: LikelihoodMemory,
    evaluations: usize,
    bodies: usize,
}

impl Placing<'_> {
    /// The bodies that one place of the head leads to, one a facing.
    fn bodies_at(
        &mut self,
        head: Head,
        place: &Place,
        cancel: &CancelToken,
    ) -> Result<Vec<Placed>, TemplateError> {
        let mut record = Record::new();
        let begin = (head.centre, place.up, place.to_cameras);
        let hung = trunk::hung(&self.frame, &self.pictures, self.options, begin, &mut record);
        if let Some(first) = record.first_mut() {
            first.held = head.held;
        }
        let drawn = trunk::trunk_limbs(&self.frame);
        let facings = trunk::facings(&self.frame, &hung, head.centre, self.options.headings[0]);
        let mut facings: Vec<(f64, Pose)> =
            facings.into_iter().map(|pose| (self.cost(&pose, &drawn), pose)).collect();
        facings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut bodies = Vec::new();
        for (_, facing) in facings.into_iter().take(self.options.headings[1]) {
            if cancel.is_cancelled() {
                return Err(TemplateError::Cancelled);
            }
            let mut steps = record.clone();
            let mut free = self.pictures.clone();
            free.claim(&self.frame.trunk_template(&facing));
            for segment in self.frame.segments(self.frame.head) {
                free.claim(&self.frame.template(&facing, &segment));
            }
            let radius = self.frame.model.limbs()[self.frame.skull_and_neck()[0]].radius;
            free.claim(&Template { from: head.centre, to: head.centre, radius });
            let (frame, options) = (&self.frame, self.options);
            let pose = limbs::placed(frame, &mut free, options, &facing, drawn.clone(), &mut steps);
            let all = vec![true; frame.model.limbs().len()];
            let cost = self.cost(&pose, &all);
            self.bodies += 1;
            bodies.push(Placed { pose, cost, evaluations: 0, bodies: 0, steps });
        }
        Ok(bodies)
    }

    fn cost(&mut self, pose: &Pose, drawn: &[bool]) -> f64 {
        self.evaluations += 1;
        self.likelihood.cost(&mut self.memory, pose, drawn)
    }
}
