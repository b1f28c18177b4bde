//! A prior as a whole: parts of the body with their poses and steps, checked once.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::accelerations::Accelerations;
use super::direction::BodyDirection;
use super::mixture::{StudentComponent, StudentMixture};
use crate::numbers::Brief;

/// Most parts, components of a part, and numbers of a direction.
const MOST_PARTS: usize = 64;
const MOST_COMPONENTS: usize = 1024;
const NUMBERS: usize = 3;
/// Steps over less than this, seconds, are taken as long as this; over more, likewise.
const SHORTEST: f64 = 1e-3;
const LONGEST: f64 = 1.0;

/// How far a part is from where its motion led, after a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepStatistics {
    /// The time that the covariance is of, seconds.
    pub seconds: f64,
    /// p: after a time t the covariance is (t/seconds)^p as large.
    pub exponent: f64,
    /// The lower triangle row after row, D (D + 1)/2 numbers.
    pub covariance: Vec<f64>,
}

/// A part of the body, whose directions are looked at together.
#[derive(Debug, Clone, PartialEq)]
pub struct PriorPart {
    /// What it is called.
    pub name: String,
    /// The directions whose numbers stand one after the other, three each.
    pub directions: Vec<BodyDirection>,
    /// The distribution of its poses.
    pub poses: StudentMixture,
    /// The distribution of its steps.
    pub step: StepStatistics,
    /// Of mean zero, for [`StepStatistics::seconds`].
    steps: StudentMixture,
}

/// What motion files say of poses and of steps from pose to pose.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePrior {
    /// What it was learnt from, and whom to thank for it.
    pub source: String,
    /// Its parts.
    pub parts: Vec<PriorPart>,
    /// How much joints' velocities change; `None` where that was not learnt.
    pub accelerations: Option<Accelerations>,
}

/// Why numbers are not a prior.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum PriorError {
    #[error("`parts` has {found} parts; expected 1 to {MOST_PARTS}")]
    Parts { found: usize },
    #[error("part \"{part}\": `directions` has {found}; expected 1 to 12, each once")]
    Directions { part: String, found: usize },
    #[error("part \"{part}\": `components` has {found}; expected 1 to {MOST_COMPONENTS}")]
    Components { part: String, found: usize },
    #[error(
        "part \"{part}\": `components[{index}]` is not a distribution; expected a share above 0, {size} numbers of a mean, \
         and the lower triangle of a positive definite covariance"
    )]
    Component { part: String, index: usize, size: usize },
    #[error("part \"{part}\": `degrees` is {}; expected a number above 0", Brief(*.value))]
    Degrees { part: String, value: f64 },
    #[error(
        "part \"{part}\": `step` is not a distribution; expected seconds from 0.001 to 1, an exponent from 0 to 8, and the \
         lower triangle of a positive definite covariance of {size} rows"
    )]
    Step { part: String, size: usize },
    #[error("`accelerations.{joint}` is {}; expected a number above 0", Brief(*.value))]
    Acceleration { joint: &'static str, value: f64 },
}

impl PriorPart {
    /// Checks a part. `degrees` is ν of its poses and its steps.
    ///
    /// # Errors
    /// The first thing that is wrong, by field.
    pub fn new(
        name: &str,
        directions: Vec<BodyDirection>,
        components: Vec<StudentComponent>,
        step: StepStatistics,
        degrees: f64,
    ) -> Result<Self, PriorError> {
        let part = || name.to_owned();
        let is_twice = directions.iter().enumerate().any(|(index, one)| directions[..index].contains(one));
        if directions.is_empty() || is_twice {
            return Err(PriorError::Directions { part: part(), found: directions.len() });
        }
        let size = NUMBERS * directions.len();
        if components.is_empty() || components.len() > MOST_COMPONENTS {
            return Err(PriorError::Components { part: part(), found: components.len() });
        }
        if !(degrees.is_finite() && degrees > 0.0) {
            return Err(PriorError::Degrees { part: part(), value: degrees });
        }
        let is_good = |component: &StudentComponent| {
            component.mean.len() == size && StudentMixture::new(vec![component.clone()], degrees).is_some()
        };
        let no_component = |index| PriorError::Component { part: part(), index, size };
        if let Some(index) = components.iter().position(|component| !is_good(component)) {
            return Err(no_component(index));
        }
        let poses = StudentMixture::new(components, degrees).ok_or_else(|| no_component(0))?;
        let no_step = || PriorError::Step { part: part(), size };
        if !((SHORTEST..=LONGEST).contains(&step.seconds) && (0.0..=8.0).contains(&step.exponent)) {
            return Err(no_step());
        }
        let at_zero =
            StudentComponent { share: 1.0, mean: vec![0.0; size], covariance: step.covariance.clone() };
        let steps = StudentMixture::new(vec![at_zero], degrees).ok_or_else(no_step)?;
        Ok(Self { name: name.to_owned(), directions, poses, step, steps })
    }

    /// How likely it is to be `off` from where its motion led, after `seconds`.
    pub(crate) fn step_pull(&self, off: &DVector<f64>, seconds: f64) -> super::mixture::Pull {
        // A covariance that is larger by a factor is a distance that is shorter by it.
        let ratio = seconds.clamp(SHORTEST, LONGEST) / self.step.seconds;
        let shrink = ratio.powf(-0.5 * self.step.exponent);
        let mut pull = self.steps.pull(&(off * shrink));
        pull.force *= shrink;
        pull.curvature *= shrink * shrink;
        pull
    }
}

impl PosePrior {
    /// Puts parts together. `source` says what they were learnt from.
    ///
    /// # Errors
    /// No part, or too many.
    pub fn new(source: &str, parts: Vec<PriorPart>) -> Result<Self, PriorError> {
        if parts.is_empty() || parts.len() > MOST_PARTS {
            return Err(PriorError::Parts { found: parts.len() });
        }
        Ok(Self { source: source.to_owned(), parts, accelerations: None })
    }

    /// The same that knows how much joints' velocities change.
    ///
    /// # Errors
    /// The first that is no number above 0.
    pub fn with_accelerations(self, accelerations: Accelerations) -> Result<Self, PriorError> {
        match accelerations.wrong() {
            Some((joint, value)) => Err(PriorError::Acceleration { joint, value }),
            None => Ok(Self { accelerations: Some(accelerations), ..self }),
        }
    }
}
