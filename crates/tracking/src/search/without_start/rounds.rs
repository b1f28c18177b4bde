//! The rounds of the search, each with fewer candidates and a closer look.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DQuat, DVec3};
use rayon::prelude::*;

use super::place::{Stance, SubjectPlace, turn_whole};
use super::{Doubt, WithoutStartError, WithoutStartOptions};
use crate::body::{Kinematics, Model, Pose, Sides};
use crate::cancel::CancelToken;
use crate::fit::{FitOptions, PreparedFit, Stage};
use crate::geometry::rotation::log;
use crate::posing;
use crate::render::BACKGROUND;
use crate::search::hypotheses::{Hypothesis, Origin, Search, farthest_m, subject_pixels};
use crate::search::{SearchOptions, start};

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

/// The last stage goes on for this many times its iterations, down to so much of its least gain.
const POLISH_ITERATIONS: usize = 4;
const POLISH_GAIN: f64 = 0.1;
/// Costs within this fraction of the best one's do not tell poses apart. A body without limits has twins within 0.03 of each
/// other, most of them within 0.005; of real people the body turned round costs 0.07 more and beyond.
const SAME_COST: f64 = 0.03;
/// Among these, another hypothesis is preferred to the best if its penalty is smaller by this. Facing the other way counts 2,
/// and so does an arm that hangs on the wrong side of its trunk, turned by half a turn in two joints.
const LEAST_PENALTY_GAIN: f64 = 0.5;
/// Cameras stand on one side of the subject where their directions add up to so much of their number.
const ONE_SIDED: f64 = 0.3;

/// A search in front of its pictures.
pub(super) struct Rounds<'a> {
    pub(super) model: &'a Arc<Model>,
    pub(super) prepared: &'a PreparedFit,
    /// At the pictures' scale.
    pub(super) options: &'a FitOptions,
    pub(super) choices: &'a WithoutStartOptions,
    pub(super) place: &'a SubjectPlace,
    pub(super) stance: Stance,
    pub(super) cancel: &'a CancelToken,
    /// Evaluations of Λ in all searches, whatever their order.
    pub(super) evaluations: AtomicUsize,
}

/// What was refined to the end, best first, where each body looks, whether front and back are in doubt, and what came of each
/// round.
pub(super) struct Judged {
    pub(super) hypotheses: Vec<Hypothesis>,
    pub(super) facings: Vec<Option<DVec3>>,
    pub(super) doubt: Option<Doubt>,
    pub(super) rounds: Vec<Vec<Hypothesis>>,
}

impl Rounds<'_> {
    /// All rounds.
    pub(super) fn run(&self) -> Result<Judged, WithoutStartError> {
        let headings = (0..self.choices.headings).into_par_iter();
        let standing: Vec<Vec<Hypothesis>> = headings.map(|heading| self.heading(heading)).collect();
        let standing = self.best(standing.into_iter().flatten().collect(), SAME_EARLY_M)?;
        let first = &standing[..self.choices.kept[0].min(standing.len())];
        let second = first.par_iter().map(|one| self.refine(&one.pose, &self.choices.coarse)).collect();
        let second = self.best(second, SAME_EARLY_M)?;
        let closer = second.iter().take(self.choices.kept[1]);
        let last: Vec<Pose> = closer.flat_map(|one| [self.turned(&one.pose), one.pose.clone()]).collect();
        let last = last.par_iter().map(|pose| self.refine(pose, &self.choices.fine)).collect();
        let last = self.best(last, SAME_M)?;
        let polished = last.par_iter().map(|one| self.polish(&one.pose)).collect();
        let polished = self.best(polished, SAME_M)?;
        Ok(self.judged(polished, vec![standing, second, last]))
    }

    /// The best that differ, best first.
    fn best(&self, mut all: Vec<Hypothesis>, apart_m: f64) -> Result<Vec<Hypothesis>, WithoutStartError> {
        if self.cancel.is_cancelled() {
            return Err(WithoutStartError::Cancelled);
        }
        all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut kept: Vec<Hypothesis> = Vec::new();
        for one in all {
            if kept.iter().all(|other| farthest_m(self.model, &other.pose, &one.pose) > apart_m) {
                kept.push(one);
            }
        }
        Ok(kept)
    }

    /// Bodies of one heading, by the last coarse stage.
    fn heading(&self, heading: usize) -> Vec<Hypothesis> {
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
        let trunks = self.trunks(&begin, &search);
        let whole = |trunk: Pose| {
            let whole = search.reseeder.assemble(&trunk);
            of_hull(search.refine(&whole, 0))
        };
        let rated = trunks.into_iter().map(whole).collect();
        self.count(&search);
        rated
    }

    /// The trunks of a heading that lie best in the silhouettes.
    fn trunks(&self, begin: &Pose, search: &Search<'_>) -> Vec<Pose> {
        let place = self.place;
        let rated = |pose: Pose| (search.reseeder.trunk_cost(&pose), pose);
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

    /// Refined to the end, its chains seeded again.
    fn refine(&self, pose: &Pose, effort: &SearchOptions) -> Hypothesis {
        let options = self.free_options();
        let mut search = self.search(pose, &options, effort);
        let refined = search.refine(pose, 0);
        search.keep(of_hull(refined));
        search.sweep(effort.pairs_above * self.subject());
        self.count(&search);
        search.hypotheses.swap_remove(0)
    }

    /// Gone on with by the last stage until hardly anything is gained, so that costs can be compared.
    fn polish(&self, pose: &Pose) -> Hypothesis {
        let mut options = self.free_options();
        options.stages.drain(..options.stages.len() - 1);
        for last in &mut options.stages {
            last.iterations *= POLISH_ITERATIONS;
            last.tolerance = last.tolerance.map(|gain| POLISH_GAIN * gain);
        }
        let mut search = self.search(pose, &options, &self.choices.fine);
        let refined = search.refine(pose, 0);
        self.count(&search);
        of_hull(refined)
    }

    fn count(&self, search: &Search<'_>) {
        self.evaluations.fetch_add(search.evaluations, Ordering::Relaxed);
    }

    /// All stages but the widest, without any pull to where the search happens to be; one camera holds no depth without.
    fn free_options(&self) -> FitOptions {
        let pull = if self.prepared.views.len() > 1 { 0.0 } else { self.options.proximal_weight };
        let stages = self.options.stages[self.first_stage()..].to_vec();
        FitOptions { stages, proximal_weight: pull, ..self.options.clone() }
    }

    /// The body facing the other way. One with sides trades right and left; another has its limbs put on again.
    fn turned(&self, pose: &Pose) -> Pose {
        if Sides::of(self.model, &Kinematics::new(self.model, pose)).is_some() {
            return posing::turn_round(self.model, pose);
        }
        let mut turned = pose.clone();
        let up = self.stance.up_of(self.model, pose);
        turn_whole(self.model, &mut turned, DQuat::from_axis_angle(up, PI));
        let no_stages = FitOptions { stages: Vec::new(), ..self.options.clone() };
        let search = self.search(&turned, &no_stages, &self.choices.fine);
        search.reseeder.assemble(&turned)
    }

    /// By cost; where costs hardly differ, by how far joints are turned from rest and by the facing that is expected.
    fn judged(&self, mut hypotheses: Vec<Hypothesis>, rounds: Vec<Vec<Hypothesis>>) -> Judged {
        let mut facings: Vec<Option<DVec3>> = hypotheses.iter().map(|one| self.facing(&one.pose)).collect();
        let to_cameras = (self.place.one_sided >= ONE_SIDED).then_some(self.place.to_cameras);
        let expected = self.choices.faces.or(to_cameras);
        let enough = (1.0 + SAME_COST) * hypotheses[0].cost;
        let rivals = hypotheses.iter().take_while(|one| one.cost <= enough).count();
        let penalty = |(one, facing): (&Hypothesis, &Option<DVec3>)| {
            let faces = expected.zip(*facing).map_or(0.0, |(expected, facing)| facing.dot(expected));
            self.turned_from_rest(&one.pose) - faces
        };
        let penalties: Vec<f64> = hypotheses.iter().zip(&facings).take(rivals).map(penalty).collect();
        let least = penalties.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        if let Some((best, _)) = least.filter(|(_, penalty)| **penalty < penalties[0] - LEAST_PENALTY_GAIN) {
            hypotheses[..=best].rotate_right(1);
            facings[..=best].rotate_right(1);
        }
        let opposes = |other: &Option<DVec3>| other.zip(facings[0]).is_some_and(|(a, b)| a.dot(b) < 0.0);
        let doubt = if expected.is_some() { Doubt::FacingAssumed } else { Doubt::FacingOpen };
        let doubt = facings[..rivals].iter().any(opposes).then_some(doubt);
        Judged { hypotheses, facings, doubt, rounds }
    }

    /// How far joints are turned from rest: 1 for one that is turned by half a turn.
    fn turned_from_rest(&self, pose: &Pose) -> f64 {
        let own = self.model.rotation_parents().iter().zip(&pose.rotations);
        let turns = own.filter(|(parent, _)| parent.is_some()).map(|(_, turn)| log(*turn).length() / PI);
        turns.map(|halves| halves * halves).sum()
    }

    /// Where a body looks; `None` for one without front and back.
    fn facing(&self, pose: &Pose) -> Option<DVec3> {
        let sides = || Sides::of(self.model, &Kinematics::new(self.model, pose));
        let ahead = || sides().map_or_else(|| self.stance.ahead_of(self.model, pose), |sides| sides.ahead);
        self.stance.has_front.then(ahead)
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

fn of_hull((cost, pose): (f64, Pose)) -> Hypothesis {
    Hypothesis { pose, cost, origin: Origin::Hull }
}
