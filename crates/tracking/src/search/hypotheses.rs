//! More than one hypothesis: a fit that looks for other poses that the silhouettes allow, and ranks them.
//!
//! A fit goes downhill, and downhill ends wrong in few ways: an arm in front of the trunk that should be
//! behind it, a forearm along the other arm, a head where a hand should be. So, from the fit of the start:
//!
//! 1. **Trunks.** Samples about the start, by the sketch of the trunk alone, and the best of them. On each the
//!    free-hanging chains are put together one after the other, and the whole is refined.
//! 2. **Chains.** One arm, leg or head at a time is taken off and seeded again; the best places are refined,
//!    and the best of all hypotheses goes on. Sweeps over the chains end when one brings nothing.
//! 3. **Pairs.** Where the silhouettes are still ill explained, two chains are taken off at once: arms that
//!    have changed places, a head that has become a hand.
//! 4. **Turned round.** The best pose with the body facing the other way and its sides swapped, as it is and put
//!    together again, in a search of its own whose chains are swept where it is a rival in cost. Silhouettes hardly tell the two apart, and a fit never
//!    crosses over.
//!
//! Thousands of places are sifted by the sketch, which draws flat limbs on coarse pictures; some tens are
//! refined by the fit's last stages. Hypotheses are ranked by the last stage's cost, priors included. All of
//! it is the same in every run with the same seed.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::chains::Chains;
use super::reseed::Reseeder;
use super::sketch::Sketch;
use super::{SearchOptions, start};
use crate::body::{Kinematics, Model, Pose};
use crate::cancel::CancelToken;
use crate::fit::{Evidence, Fit, FitError, FitOptions, FitView, Objective, PreparedFit, Stage};
use crate::optimize::{LeastSquares, NormalEquations, Solver};
use crate::posing;
use crate::render::BACKGROUND;
use crate::silhouette::Label;

/// Hypotheses whose joints all lie this near to each other are one, metres.
const SAME_M: f64 = 0.05;
/// A sweep that lowers the best cost by less than this fraction was the last.
const LEAST_GAIN: f64 = 1e-3;
/// A body turned round whose cost is below this many of the best one's is worth a search of its own.
const RIVAL: f64 = 1.6;
/// The start knows which way the body faces: to be believed, a body turned round must explain the silhouettes better by so
/// much of the cost, and by so much of the subject's pixels. A body of capsules without limits looks the same both ways.
const LEAST_BETTER: f64 = 0.05;
const LEAST_BETTER_PIXELS: f64 = 1e-3;
/// Proposals are first refined by the stage this many before the last, the best of them by the ones after it.
const REFINING_STAGES: usize = 3;

/// Where a hypothesis comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Origin {
    /// The fit of the start.
    Start,
    /// Another trunk, all chains put together on it.
    Trunk,
    /// The body turned round, its sides swapped.
    TurnedRound,
    /// The visual hull, where no start was known.
    Hull,
    /// A chain seeded again.
    Chain {
        /// The chain's first limb.
        limb: String,
    },
    /// Two chains seeded again.
    Pair {
        /// The chains' first limbs.
        limbs: [String; 2],
    },
}

/// A pose that the silhouettes allow.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// The pose, refined.
    pub pose: Pose,
    /// Its cost by the last stage, priors included, squared grey levels.
    pub cost: f64,
    /// Where it comes from.
    pub origin: Origin,
}

/// What a search found and what it tried.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchResult {
    /// All that differ, best first; never empty.
    pub hypotheses: Vec<Hypothesis>,
    /// Every one that was refined to the end, worse ones and doubles too, in the order in which they were.
    pub tried: Vec<Hypothesis>,
    /// Evaluations of Λ with its derivatives: one an iteration, and one where each refinement begins.
    pub evaluations: usize,
}

/// Fits from a start and looks for poses that explain the silhouettes better. Cancelled, it returns what it
/// has.
///
/// # Errors
/// As [`Fit::new`].
pub fn search(
    model: &Arc<Model>,
    views: Vec<FitView>,
    start: &Pose,
    options: &FitOptions,
    effort: &SearchOptions,
    cancel: &CancelToken,
) -> Result<SearchResult, FitError> {
    effort.check()?;
    let prepared = PreparedFit::new(model, views, start, options, Sketch::reach_px)?;
    Ok(run(model, &prepared, options, effort, cancel))
}

/// A fit that begins with a search for the best of many hypotheses ([`search`]) and goes on from there with the last
/// stage; and all that were found, best first.
///
/// # Errors
/// As [`Fit::new`].
pub fn fit_best(
    model: Arc<Model>,
    views: Vec<FitView>,
    start: &Pose,
    options: FitOptions,
    effort: &SearchOptions,
    cancel: &CancelToken,
) -> Result<(Fit, Vec<Hypothesis>), FitError> {
    effort.check()?;
    let options = options.at_scale(&model, &views, start);
    let prepared = PreparedFit::new(&model, views, start, &options, Sketch::reach_px)?;
    let hypotheses = run(&model, &prepared, &options, effort, cancel).hypotheses;
    let fit = Fit::at_last_stage(model, prepared, options, &hypotheses[0].pose);
    Ok((fit, hypotheses))
}

/// Other places of some chains of a pose: each chain is taken off by itself and seeded again, the best places are refined. Best
/// first; the pose itself is not among them.
///
/// # Errors
/// As [`Fit::new`].
pub(crate) fn reseeded(
    model: &Arc<Model>,
    views: &[FitView],
    pose: &Pose,
    options: &FitOptions,
    effort: &SearchOptions,
    chains: &[usize],
    cancel: &CancelToken,
) -> Result<Vec<Hypothesis>, FitError> {
    // The chain is to leave its place.
    let free = FitOptions { proximal_weight: 0.1 * options.proximal_weight, ..options.clone() };
    let prepared = PreparedFit::new(model, views.to_vec(), pose, &free, Sketch::reach_px)?;
    let mut search = Search::about(&prepared.start, model, &prepared, &free, effort, cancel);
    for &chain in chains {
        let proposals = search.reseeder.propose(&prepared.start, chain, &[]);
        let origin = Origin::Chain { limb: search.reseeder.name(chain) };
        for (_, pose) in proposals {
            if cancel.is_cancelled() {
                break;
            }
            let (cost, pose) = search.refine(&pose, search.refining_stage());
            search.keep(Hypothesis { pose, cost, origin: origin.clone() });
        }
    }
    search.hypotheses.retain(|hypothesis| farthest_m(model, &hypothesis.pose, pose) >= SAME_M);
    Ok(search.hypotheses)
}

/// A search in progress.
#[derive(Debug)]
pub(super) struct Search<'a> {
    model: &'a Arc<Model>,
    options: &'a FitOptions,
    effort: &'a SearchOptions,
    cancel: &'a CancelToken,
    pub(super) reseeder: Reseeder<'a>,
    pub(super) objectives: Vec<(Stage, Objective)>,
    pub(super) hypotheses: Vec<Hypothesis>,
    tried: Vec<Hypothesis>,
    pub(super) evaluations: usize,
}

/// All that is found from a prepared start and from the body that faces the other way.
fn run(
    model: &Arc<Model>,
    prepared: &PreparedFit,
    options: &FitOptions,
    effort: &SearchOptions,
    cancel: &CancelToken,
) -> SearchResult {
    let subject = BACKGROUND * BACKGROUND * subject_pixels(&prepared.views);
    let pairs_above = effort.pairs_above * subject;
    let mut search = Search::about(&prepared.start, model, prepared, options, effort, cancel);
    let (cost, pose) = search.refine(&prepared.start, 0);
    search.keep(Hypothesis { pose, cost, origin: Origin::Start });
    search.try_trunks(&prepared.start);
    search.sweep(pairs_above);
    if effort.turned && !cancel.is_cancelled() {
        search.try_the_other_way(prepared, subject);
    }
    search.hypotheses.truncate(effort.kept.max(1));
    let Search { hypotheses, tried, evaluations, .. } = search;
    SearchResult { hypotheses, tried, evaluations }
}

impl<'a> Search<'a> {
    /// A search in which nothing is found yet, and whose priors pull towards a pose.
    pub(super) fn about(
        start: &'a Pose,
        model: &'a Arc<Model>,
        prepared: &'a PreparedFit,
        options: &'a FitOptions,
        effort: &'a SearchOptions,
        cancel: &'a CancelToken,
    ) -> Self {
        let PreparedFit { views, distances, .. } = prepared;
        let objective = |&stage: &Stage| {
            let reference = start.clone();
            (stage, Objective::new(Arc::clone(model), views, distances, options, stage, reference))
        };
        let parts = Chains::new(model);
        let sketch = Sketch::new(model, views, distances, start);
        Self {
            model,
            options,
            effort,
            cancel,
            reseeder: Reseeder { model, parts, sketch, reference: start, effort },
            objectives: options.stages.iter().map(objective).collect(),
            hypotheses: Vec::new(),
            tried: Vec::new(),
            evaluations: 0,
        }
    }

    /// Other trunks, and all chains again on them and on the best one.
    fn try_trunks(&mut self, start: &Pose) {
        let best = self.hypotheses[0].pose.clone();
        let mut trunks: Vec<(f32, Pose)> = Vec::with_capacity(self.effort.trunk_samples);
        for sample in 0..self.effort.trunk_samples {
            // Small and large samples about the start and about what was found from it.
            let about = if sample % 2 == 0 { start } else { &best };
            let angle = self.effort.trunk_angle * (sample % 5 + 1) as f64 / 5.0;
            let distance = self.effort.trunk_distance * (sample % 3 + 1) as f64 / 3.0;
            let seed = self.effort.seed.wrapping_add(sample as u64);
            let pose = start::perturb(self.model, about, angle, distance, seed);
            trunks.push((self.reseeder.trunk_cost(&pose), pose));
        }
        trunks.sort_by(|a, b| a.0.total_cmp(&b.0));
        trunks.truncate(self.effort.trunks);
        for trunk in std::iter::once(best).chain(trunks.into_iter().map(|(_, pose)| pose)) {
            if self.cancel.is_cancelled() {
                return;
            }
            let whole = self.reseeder.assemble(&trunk);
            let (cost, pose) = self.refine(&whole, self.refining_stage());
            self.keep(Hypothesis { pose, cost, origin: Origin::Trunk });
        }
    }

    /// The best pose with the body facing the other way, in a search of its own.
    ///
    /// Its priors pull towards its own start, or the start's would hold it back by a whole turn. It is ranked as if
    /// it were as far from the start as the best of the others, and a little behind.
    fn try_the_other_way(&mut self, prepared: &PreparedFit, subject: f64) {
        let best = self.hypotheses[0].clone();
        let turned = posing::turn_round(self.model, &best.pose);
        let mut other = Search::about(&turned, self.model, prepared, self.options, self.effort, self.cancel);
        // As it is, and put together again.
        let whole = other.reseeder.assemble(&turned);
        for (pose, stage) in [(&turned, 0), (&whole, other.refining_stage())] {
            let (cost, pose) = other.refine(pose, stage);
            other.keep(Hypothesis { pose, cost, origin: Origin::TurnedRound });
        }
        let last = self.options.stages[self.options.stages.len() - 1];
        let free = FitOptions { proximal_weight: 0.0, ..self.options.clone() };
        let PreparedFit { views, distances, start, .. } = prepared;
        let mut judge = Objective::new(Arc::clone(self.model), views, distances, &free, last, start.clone());
        let mut judged = |pose: &Pose| {
            let mut equations = NormalEquations::zeros(judge.columns());
            judge.evaluate(pose, &mut equations);
            equations.cost
        };
        let of_best = judged(&best.pose);
        if judged(&other.hypotheses[0].pose) < RIVAL * of_best {
            other.sweep(self.effort.pairs_above * subject);
        }
        self.evaluations += other.evaluations;
        for hypothesis in other.hypotheses {
            let cost = (1.0 + LEAST_BETTER) * judged(&hypothesis.pose)
                + LEAST_BETTER_PIXELS * subject
                + (best.cost - of_best);
            self.keep(Hypothesis { cost, ..hypothesis });
        }
    }

    /// Sweeps over the chains, and the pairs where the fit is poor, until one brings nothing.
    pub(super) fn sweep(&mut self, pairs_above: f64) {
        for _ in 0..self.effort.sweeps {
            let before = self.hypotheses[0].cost;
            self.try_chains();
            if self.hypotheses[0].cost > pairs_above {
                self.try_pairs();
            }
            if self.hypotheses[0].cost > before * (1.0 - LEAST_GAIN) {
                break;
            }
        }
    }

    /// Every chain again, one after the other, each on the best pose so far.
    fn try_chains(&mut self) {
        for chain in 0..self.reseeder.parts.chains.len() {
            let proposals = self.reseeder.propose(&self.hypotheses[0].pose, chain, &[]);
            let origin = Origin::Chain { limb: self.reseeder.name(chain) };
            self.refine_best(proposals.into_iter().map(|(_, pose)| pose).collect(), &origin);
        }
    }

    /// Every two chains again: the places of one, with the other taken off, then the best place of that.
    fn try_pairs(&mut self) {
        let chains = &self.reseeder.parts.chains;
        let mut by_length: Vec<usize> = (0..chains.len()).collect();
        by_length.sort_by_key(|&chain| std::cmp::Reverse(chains[chain].len()));
        for (index, &first) in by_length.iter().enumerate() {
            for &second in &by_length[index + 1..] {
                if self.cancel.is_cancelled() {
                    return;
                }
                let base = &self.hypotheses[0].pose;
                let mut poses = Vec::new();
                for (_, half) in self.reseeder.propose(base, first, &[second]) {
                    poses.extend(self.reseeder.propose(&half, second, &[]).into_iter().next());
                }
                poses.sort_by(|a, b| a.0.total_cmp(&b.0));
                poses.truncate(self.effort.pairs);
                let limbs = [self.reseeder.name(first), self.reseeder.name(second)];
                let poses = poses.into_iter().map(|(_, pose)| pose).collect();
                self.refine_best(poses, &Origin::Pair { limbs });
            }
        }
    }

    /// Index of the first stage that proposals are refined by.
    pub(super) fn refining_stage(&self) -> usize {
        self.objectives.len().saturating_sub(REFINING_STAGES)
    }

    /// All poses by one stage, the best of them by the stages after it.
    fn refine_best(&mut self, poses: Vec<Pose>, origin: &Origin) {
        let stage = self.refining_stage();
        let mut refined = Vec::with_capacity(poses.len());
        for pose in poses {
            if self.cancel.is_cancelled() {
                return;
            }
            refined.push(self.refine_by(stage, pose));
        }
        let lowest = refined.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((cost, pose)) = lowest else { return };
        let (cost, pose) =
            if stage + 1 < self.objectives.len() { self.refine(&pose, stage + 1) } else { (cost, pose) };
        self.keep(Hypothesis { pose, cost, origin: origin.clone() });
    }

    /// Cost and pose after all stages from one on.
    pub(super) fn refine(&mut self, pose: &Pose, from: usize) -> (f64, Pose) {
        let mut refined = (f64::INFINITY, pose.clone());
        for stage in from..self.objectives.len() {
            refined = self.refine_by(stage, refined.1);
        }
        refined
    }

    pub(super) fn refine_by(&mut self, stage: usize, pose: Pose) -> (f64, Pose) {
        let (stage, objective) = &mut self.objectives[stage];
        let options = stage.solver_options(self.options.method, self.options.damping, false);
        let mut solver = Solver::new(objective, pose, options);
        self.evaluations += 1;
        while solver.step(objective).is_some() {
            self.evaluations += 1;
            if self.cancel.is_cancelled() {
                break;
            }
        }
        (solver.cost(), solver.point.clone())
    }

    /// Keeps a hypothesis, or the better one of two that are the same.
    pub(super) fn keep(&mut self, new: Hypothesis) {
        self.tried.push(new.clone());
        let is_same = |old: &&mut Hypothesis| farthest_m(self.model, &old.pose, &new.pose) < SAME_M;
        match self.hypotheses.iter_mut().find(is_same) {
            Some(old) if new.cost < old.cost => *old = new,
            Some(_) => {}
            None => self.hypotheses.push(new),
        }
        self.hypotheses.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    }
}

/// Largest distance between two poses' joints.
pub(crate) fn farthest_m(model: &Model, a: &Pose, b: &Pose) -> f64 {
    let (a, b) = (Kinematics::new(model, a), Kinematics::new(model, b));
    a.ends().iter().zip(b.ends()).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

/// Pixels of the subject in all cameras, weighted.
pub(super) fn subject_pixels(views: &[FitView]) -> f64 {
    let pixels = views.iter().map(|view| {
        let count = match &view.evidence {
            Evidence::Mask(mask) => mask.count(Label::Subject),
            Evidence::Measurement(data) => data.values().iter().filter(|&&value| value < 127.5).count(),
        };
        view.weight * count as f64
    });
    pixels.sum()
}
