//! The rounds of the search, each with fewer candidates and a closer look.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::place::Place;
use super::stance::{self, Stance};
use super::{Candidate, Doubt, WithoutStart, WithoutStartError};
use crate::body::{Kinematics, Model, Pose, Sides};
use crate::cancel::CancelToken;
use crate::fit::{FitOptions, Objective, Prepared, Stage};
use crate::optimize::{LeastSquares, NormalEquations};
use crate::posing;
use crate::render::BACKGROUND;
use crate::search::SearchOptions;
use crate::search::hypotheses::{
    Hypothesis, LEAST_BETTER, LEAST_BETTER_PIXELS, Origin, Search, farthest_m, subject_pixels,
};
use crate::search::start;

/// Stages that all headings are refined by, and most iterations of each.
const COARSE_STAGES: usize = 2;
const COARSE_ITERATIONS: usize = 8;
/// Poses whose joints all lie this near to each other are one, metres: before the last round, and after it.
const SAME_EARLY_M: f64 = 0.10;
const SAME_M: f64 = 0.05;

/// Root heights are tried so far beyond those of a body on the hull's floor and of one under its top, metres.
const BEYOND_M: f64 = 0.10;
/// Steps between them, about, and the most of them.
const STEP_M: f64 = 0.07;
const MOST_STEPS: usize = 16;
/// Places along the ground that are tried beside the hull's middle.
const BESIDE_M: f64 = 0.07;
/// Where in the height above the root a slice of the hull is taken: within the trunk.
const TRUNK_HEIGHT: f64 = 0.25;
/// Trunks that lean, about the best that stand upright: how many, how far turned and moved at most.
const UPRIGHT: usize = 6;
const LEANING: usize = 120;
const LEAN_RAD: f64 = 0.4;
const LEAN_M: f64 = 0.08;

/// Cameras stand on one side of the subject where their directions add up to so much of their number.
const ONE_SIDED: f64 = 0.3;

/// A search in front of its pictures.
pub(super) struct Rounds<'a> {
    pub(super) model: &'a Arc<Model>,
    pub(super) prepared: &'a Prepared,
    /// At the pictures' scale.
    pub(super) options: &'a FitOptions,
    pub(super) choices: &'a WithoutStart,
    pub(super) place: &'a Place,
    pub(super) stance: Stance,
    pub(super) cancel: &'a CancelToken,
}

/// A pose and its cost by one stage.
type Rated = (f64, Pose);

impl Rounds<'_> {
    /// All rounds: what was refined to the end, best first, and whether front and back are in doubt.
    pub(super) fn run(&self) -> Result<(Vec<Candidate>, Option<Doubt>), WithoutStartError> {
        let headings = (0..self.choices.headings).into_par_iter();
        let standing: Vec<Vec<Rated>> = headings.map(|heading| self.heading(heading)).collect();
        let first =
            self.best(standing.into_iter().flatten().collect(), self.choices.kept[0], SAME_EARLY_M)?;
        let second = first.par_iter().map(|(_, pose)| self.refine(pose, &self.choices.coarse)).collect();
        let second = self.best(second, self.choices.kept[1], SAME_EARLY_M)?;
        let last: Vec<Pose> = second.into_iter().flat_map(|(_, pose)| [self.turned(&pose), pose]).collect();
        let last = last.par_iter().map(|pose| self.refine(pose, &self.choices.fine)).collect();
        let last = self.best(last, usize::MAX, SAME_M)?;
        let last = last.par_iter().map(|(_, pose)| self.polish(pose)).collect();
        let last = self.best(last, usize::MAX, SAME_M)?;
        let candidates = last.into_iter().map(|(cost, pose)| Candidate {
            cost,
            ahead: self.stance.has_front.then(|| self.ahead(&pose)),
            pose,
        });
        Ok(self.judged(candidates.collect()))
    }

    /// The best that differ, best first.
    fn best(
        &self,
        mut rated: Vec<Rated>,
        count: usize,
        apart_m: f64,
    ) -> Result<Vec<Rated>, WithoutStartError> {
        if self.cancel.is_cancelled() {
            return Err(WithoutStartError::Cancelled);
        }
        rated.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut kept: Vec<Rated> = Vec::new();
        for (cost, pose) in rated {
            let is_new = kept.iter().all(|(_, other)| farthest_m(self.model, other, &pose) > apart_m);
            if is_new && kept.len() < count {
                kept.push((cost, pose));
            }
        }
        Ok(kept)
    }

    /// Candidates of one heading, by the last coarse stage.
    fn heading(&self, heading: usize) -> Vec<Rated> {
        if self.cancel.is_cancelled() {
            return Vec::new();
        }
        let place = self.place;
        let angle = TAU * heading as f64 / self.choices.headings as f64;
        let ahead = DQuat::from_axis_angle(place.up, angle) * place.to_cameras;
        let middle = place.middle();
        let begin = self.stance.pose(self.model, middle, place.up, ahead);
        let (from, stages) = (self.first_stage(), &self.options.stages);
        let coarse = |stage: &Stage| Stage { iterations: stage.iterations.min(COARSE_ITERATIONS), ..*stage };
        let stages = stages[from..].iter().take(COARSE_STAGES).map(coarse).collect();
        let options = FitOptions { stages, ..self.options.clone() };
        let mut search = self.search(&begin, &options, &self.choices.coarse);
        let chains = chains(&search);
        let trunks = self.trunks(&begin, &search, &chains);
        let whole = |trunk: Pose| {
            let whole = search.reseeder.assemble(&trunk, &chains);
            search.refine(&whole, 0)
        };
        trunks.into_iter().map(whole).collect()
    }

    /// The trunks of a heading that lie best in the silhouettes.
    fn trunks(&self, begin: &Pose, search: &Search<'_>, chains: &[usize]) -> Vec<Pose> {
        let place = self.place;
        let rated = |pose: Pose| (search.reseeder.cost(&pose, chains), pose);
        let (floor, top) = (place.bottom + self.stance.below, place.top - self.stance.above);
        let (low, high) = (floor.min(top) - BEYOND_M, floor.max(top) + BEYOND_M);
        let steps = (((high - low) / STEP_M).ceil() as usize).clamp(1, MOST_STEPS);
        let side = place.up.cross(place.to_cameras);
        let mut trunks: Vec<(f32, Pose)> = Vec::new();
        for step in 0..=steps {
            let height = low + (high - low) * step as f64 / steps as f64;
            let middle = place.middle_at(height + TRUNK_HEIGHT * self.stance.above);
            let root = middle + place.up * (height - middle.dot(place.up));
            for [x, y] in [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                let root = root + (place.to_cameras * x + side * y) * BESIDE_M;
                trunks.push(rated(Pose { root, ..begin.clone() }));
            }
        }
        trunks.sort_by(|a, b| a.0.total_cmp(&b.0));
        trunks.truncate(UPRIGHT);
        let upright: Vec<Pose> = trunks.iter().map(|(_, pose)| pose.clone()).collect();
        for sample in 0..LEANING {
            let size = (sample % 4 + 1) as f64 / 4.0;
            let about = &upright[sample % upright.len()];
            let seed = self.choices.coarse.seed.wrapping_add(sample as u64);
            trunks.push(rated(start::perturb(self.model, about, LEAN_RAD * size, LEAN_M * size, seed)));
        }
        trunks.sort_by(|a, b| a.0.total_cmp(&b.0));
        trunks.into_iter().take(self.choices.trunks).map(|(_, pose)| pose).collect()
    }

    /// Refined to the end, its chains seeded anew.
    fn refine(&self, pose: &Pose, effort: &SearchOptions) -> Rated {
        let (natural, options) = (self.natural(pose), self.natural_options());
        let mut search = self.search(&natural, &options, effort);
        let (cost, pose) = search.refine(pose, 0);
        search.keep(Hypothesis { pose, cost, origin: Origin::Start });
        search.sweep(&chains(&search), effort.pairs_above * self.subject());
        let best = search.found.swap_remove(0);
        (best.cost, best.pose)
    }

    /// Gone on with by the last stage until nothing is gained.
    fn polish(&self, pose: &Pose) -> Rated {
        let (natural, mut options) = (self.natural(pose), self.natural_options());
        options.stages.drain(..options.stages.len() - 1);
        options.stages[0].iterations *= 4;
        options.stages[0].tolerance = options.stages[0].tolerance.map(|gain| 0.1 * gain);
        self.search(&natural, &options, &self.choices.fine).refine(pose, 0)
    }

    /// The trunk of a pose with all that hangs on it at rest: what silhouettes do not show stays as people mostly are.
    fn natural(&self, pose: &Pose) -> Pose {
        let parents = self.model.rotation_parents().iter();
        let rotation =
            |(parent, turn): (&Option<usize>, &DQuat)| if parent.is_some() { DQuat::IDENTITY } else { *turn };
        Pose { root: pose.root, rotations: parents.zip(&pose.rotations).map(rotation).collect() }
    }

    /// All stages but the widest, with a weak pull to what is natural, and none on the root.
    fn natural_options(&self) -> FitOptions {
        let nat = std::env::var("NAT").map_or(0.1, |v| v.parse().unwrap());
        FitOptions {
            stages: self.options.stages[self.first_stage()..].to_vec(),
            proximal_weight: nat * self.options.proximal_weight,
            proximal_root_factor: 0.0,
            proximal_loss: crate::residual::Loss::Squares,
            ..self.options.clone()
        }
    }

    /// The body facing the other way. One with sides trades right and left; another has its limbs put on anew.
    fn turned(&self, pose: &Pose) -> Pose {
        if Sides::of(self.model, &Kinematics::new(self.model, pose)).is_some() {
            return posing::turn_round(self.model, pose);
        }
        let mut turned = pose.clone();
        let up = self.stance.up_of(self.model, pose);
        stance::turn_whole(self.model, &mut turned, DQuat::from_axis_angle(up, PI));
        let no_stages = FitOptions { stages: Vec::new(), ..self.options.clone() };
        let search = self.search(&turned, &no_stages, &self.choices.fine);
        search.reseeder.assemble(&turned, &chains(&search))
    }

    /// By cost, and the facing by where the cameras stand if costs do not tell.
    fn judged(&self, mut candidates: Vec<Candidate>) -> (Vec<Candidate>, Option<Doubt>) {
        let Some(ahead) = candidates[0].ahead else { return (candidates, None) };
        let enough = (1.0 + LEAST_BETTER) * candidates[0].cost + LEAST_BETTER_PIXELS * self.subject();
        let is_rival =
            |other: &Candidate| other.ahead.is_some_and(|to| to.dot(ahead) < 0.0) && other.cost < enough;
        let Some(rival) = candidates.iter().position(is_rival) else { return (candidates, None) };
        if self.place.one_sided < ONE_SIDED {
            return (candidates, Some(Doubt::FacingOpen));
        }
        let faces =
            |candidate: &Candidate| candidate.ahead.map_or(0.0, |ahead| ahead.dot(self.place.to_cameras));
        if faces(&candidates[rival]) > faces(&candidates[0]) {
            let rival = candidates.remove(rival);
            candidates.insert(0, rival);
        }
        (candidates, Some(Doubt::FacingAssumed))
    }

    fn ahead(&self, pose: &Pose) -> DVec3 {
        let sides = Sides::of(self.model, &Kinematics::new(self.model, pose));
        sides.map_or_else(|| self.stance.ahead_of(self.model, pose), |sides| sides.ahead)
    }

    /// The cost of a body that is nowhere.
    fn subject(&self) -> f64 {
        BACKGROUND * BACKGROUND * subject_pixels(&self.prepared.views)
    }

    /// The first stage of a body that is about in its place.
    fn first_stage(&self) -> usize {
        self.options.skip_when_tracking.min(self.options.stages.len() - 1)
    }

    fn search<'b>(
        &'b self,
        about: &'b Pose,
        options: &'b FitOptions,
        effort: &'b SearchOptions,
    ) -> Search<'b> {
        Search::about(about, self.model, self.prepared, options, effort, self.cancel)
    }
}

fn chains(search: &Search<'_>) -> Vec<usize> {
    (0..search.reseeder.parts.chains.len()).collect()
}
