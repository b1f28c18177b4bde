//! Every choice of a body's fit.

use serde::{Deserialize, Serialize};

use crate::body::anthropometry::Anthropometry;
use crate::body::{Model, SizeChoice};
use crate::fit::{FitOptions, Stage};
use crate::residual::Proportions;

/// One stage: what the data look like, and how freely proportions may change in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyStage {
    /// Ramp, data, stride and iterations.
    pub stage: Stage,
    /// Multiplies the standard deviations of proportions; size and girth are always free.
    pub slack: f64,
}

/// Every choice of a body's fit. Weights are as in [`FitOptions`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BodyFitOptions {
    /// Which sizes are free.
    pub choice: SizeChoice,
    /// How far people's proportions spread.
    pub proportions: Proportions,
    /// Standard deviation of known joints about the body's, metres, against pixels that are off by their whole range.
    /// Like proportions, each counts once a picture: with this, joints say where bones end and silhouettes the rest.
    pub joint_deviation: f64,
    /// Weight of the proportions, in 255² squared grey levels a picture (a camera in a frame): with 1, a picture's
    /// pixels are taken to be off by their whole range. A body of capsules is off in the same way in every picture, so
    /// that more pictures do not make its sizes surer.
    pub shape_weight: f64,
    /// Weight of what calibrations are usually off by, as `shape_weight` is counted, where cameras are found too: a body of
    /// capsules is off in the same way in every picture, so that more pixels do not make cameras surer.
    pub camera_weight: f64,
    /// Standard deviation of a common widening of all silhouettes, metres where the body is; 0 takes them as they are. They
    /// are also taken as they are where radii are held, and for a body of which no survey knows the girths.
    pub widening: f64,
    /// Stages, from far away and as a whole to near and size by size.
    pub stages: Vec<BodyStage>,
    /// Damping at the start of every stage, as [`FitOptions::damping`] counts it.
    pub damping: f64,
    /// Pull of each frame towards the pose that it began with.
    pub proximal_weight: f64,
    /// Weight of the root's position in that pull, per m², relative to a rotation's per rad².
    pub proximal_root_factor: f64,
    /// Pull of every limb's twist towards none.
    pub rest_weight: f64,
    /// Joint limits.
    pub limit_weight: f64,
    /// Longest turn of one joint in a step, radians.
    pub largest_turn: f64,
    /// Longest move of a root in a step, metres.
    pub largest_move: f64,
    /// Largest change of a size's logarithm in a step.
    pub largest_growth: f64,
}

/// What the weight of the proportions is multiplied by for people in clothes of whom no joint is known: shorts and
/// shoes hide where bones end, the same way in all frames, and what silhouettes seem to say of it is wrong.
pub const CLOTHED: f64 = 14.0;

/// The same where joints are known, which say where bones end, and for simulated people that really are capsules: real
/// people's proportions have little to add.
pub const WELL_SEEN: f64 = 0.2;

/// Both for bodies of which no survey knows the proportions: the generic prior is three times as wide.
const GENERIC: [f64; 2] = [20.0, 1.0];

impl BodyFitOptions {
    /// The choices for a real person: how much proportions count depends on whether a survey knows them for this body, and
    /// on whether joints are known.
    pub fn for_people(model: &Model, joints_known: bool) -> Self {
        let known = Anthropometry::of(model).is_some();
        let [clothed, seen] = if known { [CLOTHED, WELL_SEEN] } else { GENERIC };
        Self::default().with_proportions(if joints_known { seen } else { clothed })
    }

    /// The same with proportions that count this many times as much.
    pub fn with_proportions(mut self, factor: f64) -> Self {
        self.shape_weight *= factor;
        self
    }
}

impl Default for BodyFitOptions {
    fn default() -> Self {
        let stages = [(24.0, 4, 0.1), (12.0, 4, 0.3), (6.0, 4, 1.0), (3.0, 2, 1.0), (1.5, 2, 1.0)];
        let stages = stages
            .map(|(outer_px, stride, slack)| BodyStage { stage: Stage::robust(outer_px, stride, 20), slack });
        let robust = FitOptions::default();
        Self {
            choice: SizeChoice::default(),
            proportions: Proportions::default(),
            joint_deviation: 0.01,
            shape_weight: 0.05,
            camera_weight: 0.03,
            widening: 0.02,
            stages: stages.to_vec(),
            damping: robust.damping,
            // Poses that began with another body's sizes are to give way.
            proximal_weight: 3.0,
            proximal_root_factor: robust.proximal_root_factor,
            rest_weight: robust.rest_weight,
            limit_weight: robust.limit_weight,
            largest_turn: 0.3,
            largest_move: 0.15,
            largest_growth: 0.2,
        }
    }
}
