//! What a method tries, as bodies to draw and words.

use std::sync::Arc;

use backlit_document::fit_words::short_ramp;
use backlit_tracking::acquisition::GrowthRound;
use backlit_tracking::body::{Model, Pose, split_side};
use backlit_tracking::fit::Stage;
use backlit_tracking::initialisation::{Attempt, InitialisationMethod as Method};
use backlit_tracking::optimize::Iteration;
use backlit_tracking::particles::{Generation, Partition};
use backlit_tracking::render::Ramp;
use backlit_tracking::search::{Hypothesis, Origin};
use backlit_tracking::templates::TemplateStep;
use backlit_ui::drawing::{Ghosts, Template};
use backlit_ui::style::format;

use super::MethodWords;

/// A size that changes by less is the same.
const SAME: f64 = 0.005;
/// Most bodies that are drawn in a step.
pub(super) const MOST_BODIES: usize = 60;
/// A pose of a search that costs twice as much as the best weighs e to the power of minus this.
const FALL: f64 = 4.0;
/// What comes of each round of the search without a start.
const ROUNDS: [&str; 4] = [
    "Bodies stand up in the hull, facing eight ways, and limbs are added",
    "The best of them are fitted, each arm, leg and head found again",
    "The best of those are looked at closely, and each turned round too",
    "What is left is fitted to the end",
];

/// An attempt, or one of the limbs that grew in it.
#[derive(Debug, Clone)]
pub(super) struct ShownAttempt {
    pub(super) words: String,
    /// What is drawn, for the legend.
    pub(super) legend: String,
    pub(super) model: Arc<Model>,
    /// Poses with their weights: the one that it is about, then others, the heaviest first.
    pub(super) bodies: Vec<(Arc<Pose>, f64)>,
    /// Per limb: whether it has a place, and whether it is what the step is about.
    pub(super) placed: Vec<bool>,
    pub(super) marked: Vec<bool>,
    pub(super) template: Option<Template>,
}

impl ShownAttempt {
    /// A step about one whole body.
    pub(super) fn new(model: &Arc<Model>, pose: Pose, words: String) -> Self {
        let limbs = model.limbs().len();
        Self {
            words,
            legend: String::new(),
            model: Arc::clone(model),
            bodies: vec![(Arc::new(pose), 1.0)],
            placed: vec![true; limbs],
            marked: vec![false; limbs],
            template: None,
        }
    }

    /// The pose that it is about.
    pub(super) fn pose(&self) -> &Pose {
        &self.bodies[0].0
    }

    /// What is drawn of it.
    pub(super) fn ghosts(&self) -> Ghosts {
        let bodies = self.bodies.iter().map(|(pose, weight)| (&**pose, *weight));
        Ghosts {
            placed: self.placed.clone(),
            marked: self.marked.clone(),
            template: self.template,
            words: self.legend.clone(),
            ..Ghosts::new(&self.model, bodies)
        }
    }
}

/// Writes down what a method tries.
#[derive(Debug)]
pub(super) struct Recorder {
    method: Method,
    model: Arc<Model>,
    pub(super) steps: Vec<ShownAttempt>,
    /// Poses that the search has refined so far, with their costs.
    tried: Vec<(Arc<Pose>, f64)>,
    rounds: usize,
    /// Steps of the fit downhill since it began.
    downhill: usize,
}

impl Recorder {
    pub(super) fn new(method: Method, model: &Arc<Model>) -> Self {
        let model = Arc::clone(model);
        Self { method, model, steps: Vec::new(), tried: Vec::new(), rounds: 0, downhill: 0 }
    }

    /// Hears of an attempt.
    pub(super) fn record(&mut self, attempt: Attempt<'_>) {
        let shown = match attempt {
            Attempt::Start { pose, index, count } => self.start(pose, index, count),
            Attempt::Iteration { record, stage } => self.iteration(record, stage),
            Attempt::Generation { generation, partition, layers } => {
                self.generation(generation, partition, layers)
            }
            Attempt::Template(turn) => self.template(turn),
            Attempt::Hypothesis(tried) => self.hypothesis(tried),
            Attempt::Round(hypotheses) => self.round(hypotheses),
            Attempt::Growth { round, index, count, scale } => return self.growth(round, index, count, scale),
            Attempt::Grown { model, pose, measured } => {
                let words = format!(
                    "A fit turns all limbs a last time. {measured} lengths and radii were measured; the others follow these."
                );
                ShownAttempt::new(model, pose.clone(), words)
            }
        };
        self.push(shown);
    }

    /// Shows the pose that is meant, where it is not the last attempt's: of several starts the best.
    pub(super) fn end(&mut self, pose: &Pose) {
        if self.steps.last().is_none_or(|last| last.pose() != pose) {
            let words =
                format!("The end: the best pose that {} found.", MethodWords::of(self.method).lower_case);
            self.push(ShownAttempt::new(&self.model.clone(), pose.clone(), words));
        }
    }

    fn push(&mut self, mut shown: ShownAttempt) {
        if shown.legend.is_empty() {
            shown.legend = MethodWords::of(self.method).name.to_owned();
        }
        self.steps.push(shown);
    }

    fn start(&mut self, pose: &Pose, index: usize, count: usize) -> ShownAttempt {
        let is_refined = !self.steps.is_empty() && count == 1;
        self.downhill = 0;
        let words = match self.method {
            Method::Particles if is_refined => {
                "The best particle. From here the usual fit goes downhill.".to_owned()
            }
            _ if is_refined => "All limbs have a place. From here the usual fit goes downhill.".to_owned(),
            _ if count == 1 => "The start. The fit goes downhill from here.".to_owned(),
            _ => format!(
                "Start {} of {count}: the body stands in the hull and faces another way. The fit goes downhill from here.",
                index + 1
            ),
        };
        ShownAttempt::new(&self.model, pose.clone(), words)
    }

    fn iteration(&mut self, record: &Iteration<Pose>, stage: &Stage) -> ShownAttempt {
        self.downhill += 1;
        let ramp = match stage.ramp {
            Ramp::Thesis | Ramp::Half => format!("{} ramp", format::capitalised(&short_ramp(stage.ramp))),
            _ => format!("Ramp {} px wide", short_ramp(stage.ramp)),
        };
        let share = format::percent((record.actual_decrease / (record.cost + record.actual_decrease)).abs());
        let what = match (record.accepted, record.actual_decrease >= 0.0) {
            (true, true) => format!("the cost falls by {share}"),
            (true, false) => "the cost rises, and the step is taken all the same".to_owned(),
            (false, _) => "the cost would rise, so the body stays".to_owned(),
        };
        ShownAttempt::new(
            &self.model,
            record.point.clone(),
            format!("{ramp}, step {}: {what}.", self.downhill),
        )
    }

    fn generation(&self, generation: &Generation, partition: &Partition, layers: usize) -> ShownAttempt {
        let mut heaviest: Vec<_> = generation.particles.iter().collect();
        heaviest.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.cost.total_cmp(&b.cost)));
        heaviest.truncate(MOST_BODIES);
        let (count, alive) = (generation.particles.len(), generation.effective());
        let held: f64 = heaviest.iter().map(|particle| particle.weight).sum();
        let words = format!(
            "Layer {} of {layers}. {}: {count} particles are moved and weighed. About {} share the weight; only these have \
             children. The {} heaviest are drawn, {} of the weight.",
            generation.layer + 1,
            chain_words(&self.model, &partition.name),
            format::number(alive, 0),
            heaviest.len(),
            percent_of(held),
        );
        let legend = format!("{} of {count} particles", heaviest.len());
        let bodies = heaviest.into_iter().map(|particle| (Arc::new(particle.pose.clone()), particle.weight));
        let limbs = self.model.limbs().iter();
        ShownAttempt {
            words,
            legend,
            bodies: bodies.collect(),
            placed: generation.drawn.clone(),
            marked: limbs.map(|limb| partition.rotations.contains(&limb.rotation)).collect(),
            ..ShownAttempt::new(&self.model, Pose::rest(&self.model), String::new())
        }
    }

    fn template(&self, turn: &TemplateStep) -> ShownAttempt {
        let (name, held) = (format::capitalised(&turn.template), percent_of(turn.held));
        let words = match turn.template.as_str() {
            "head" => "Head: the ball whose outlines hold most border pixels of the silhouettes.".to_owned(),
            _ => {
                let turns = match turn.rests {
                    true => "rests".to_owned(),
                    false => {
                        format!("turns by {} to the middle of its pixels", format::degrees(turn.turned_rad))
                    }
                };
                let whose = if turn.template == "trunk" { "" } else { " and no other template’s" };
                format!("{name} {turns}. {held} of the pixels in it are the person’s{whose}.")
            }
        };
        // The head is placed first: what the trunk's step has more is the trunk.
        let before = self.steps.first().filter(|_| turn.template == "trunk");
        let model = &self.model;
        let owner = model.limb_index(&turn.template).map(|limb| model.limbs()[limb].rotation);
        let is_marked = |limb: usize| match owner {
            Some(rotation) => model.limbs()[limb].rotation == rotation,
            None => turn.placed[limb] && before.is_none_or(|head| !head.placed[limb]),
        };
        let marked = (0..model.limbs().len()).map(is_marked).collect();
        let template = Some(Template { ends: turn.ends, radius: turn.radius });
        let placed = turn.placed.clone();
        ShownAttempt { placed, marked, template, ..ShownAttempt::new(model, turn.pose.clone(), words) }
    }

    fn hypothesis(&mut self, tried: &Hypothesis) -> ShownAttempt {
        let best = self.tried.iter().map(|(_, cost)| *cost).fold(f64::INFINITY, f64::min);
        let what = match &tried.origin {
            Origin::Start => "The start, fitted".to_owned(),
            Origin::Trunk => "Trunk moved, limbs found again, fitted".to_owned(),
            Origin::TurnedRound => "The body turned round, fitted".to_owned(),
            Origin::Hull => "From the hull, fitted".to_owned(),
            Origin::Chain { limb } => format!("{} found again, fitted", chain_words(&self.model, limb)),
            Origin::Pair { limbs: [one, other] } => {
                format!("{}, and {other} likewise, found again, fitted", chain_words(&self.model, one))
            }
        };
        let how_good = if tried.cost < best * (1.0 - 1e-6) {
            "the best so far".to_owned()
        } else if tried.cost < best * 1.005 {
            "as good as the best".to_owned()
        } else if tried.cost < best * 2.0 {
            format!("{} above the best", percent_of(tried.cost / best - 1.0))
        } else {
            format!("{} times the best", format::number(tried.cost / best, 1))
        };
        let words = format!("{what}: cost {}, {how_good}.", format::cost(tried.cost));
        let pose = Arc::new(tried.pose.clone());
        let model = &self.model;
        let begins = |name: &String| model.limb_index(name).map(|limb| model.limbs()[limb].rotation);
        let chains: Vec<usize> = match &tried.origin {
            Origin::Chain { limb } => begins(limb).into_iter().collect(),
            Origin::Pair { limbs } => limbs.iter().filter_map(begins).collect(),
            _ => Vec::new(),
        };
        let is_marked = |rotation: usize| chains.iter().any(|&chain| model.rotation_follows(rotation, chain));
        let marked = model.limbs().iter().map(|limb| is_marked(limb.rotation)).collect();
        let least = best.min(tried.cost);
        let mut bodies = vec![(pose.clone(), likeness(tried.cost, least))];
        bodies.extend(weighed(&self.tried, least, MOST_BODIES - 1));
        self.tried.push((pose, tried.cost));
        let legend = format!("Search: {} poses", self.tried.len());
        ShownAttempt { bodies, marked, legend, ..ShownAttempt::new(model, tried.pose.clone(), words) }
    }

    fn round(&mut self, hypotheses: &[Hypothesis]) -> ShownAttempt {
        let all: Vec<_> = hypotheses.iter().map(|one| (Arc::new(one.pose.clone()), one.cost)).collect();
        let round = ROUNDS.get(self.rounds).copied().unwrap_or(ROUNDS[ROUNDS.len() - 1]);
        self.rounds += 1;
        let mut bodies = weighed(&all, all.first().map_or(0.0, |best| best.1), MOST_BODIES);
        if let Some(first) = all.first() {
            // What the search calls the best may cost a little more than a body that faces away.
            bodies.retain(|(pose, _)| !Arc::ptr_eq(pose, &first.0));
            bodies.insert(0, (first.0.clone(), 1.0));
        }
        let words = format!("Round {} of {}. {round}: {} poses.", self.rounds, ROUNDS.len(), all.len());
        let legend = format!("Search: {} poses", all.len());
        ShownAttempt { bodies, legend, ..ShownAttempt::new(&self.model, Pose::rest(&self.model), words) }
    }

    /// A round of growing: the pose that it began with, then limb after limb, each with the one on the other side.
    fn growth(&mut self, round: &GrowthRound, index: usize, count: usize, scale: f64) {
        let Some(pose) = round.poses.first() else { return };
        let found = match index {
            0 => format!(
                "The search finds the pose of a body {} times as large, and a fit turns all limbs",
                format::number(scale, 2)
            ),
            _ => "A fit turns all limbs of the grown body".to_owned(),
        };
        let words = format!("Round {} of {count}. {found}. Now every limb grows.", index + 1);
        self.push(ShownAttempt::new(&round.before, pose.clone(), words));
        let model = &round.before;
        for (limb, measured) in round.measured.iter().enumerate() {
            let other = model.mirrored_limb(limb);
            if other < limb || *measured == [false; 2] {
                continue;
            }
            let is_done = |index: usize| index.min(model.mirrored_limb(index)) <= limb;
            let name = &model.limbs()[limb].name;
            let name = match split_side(name) {
                (_, part) if other != limb => format!("Right and left {part}"),
                _ => format::capitalised(name),
            };
            let [length, radius] = round.factors(limb);
            let sizes =
                [(measured[0], length, ["longer", "shorter"]), (measured[1], radius, ["thicker", "thinner"])];
            let said =
                sizes.into_iter().filter(|size| size.0).map(|(_, factor, words)| change(factor, words));
            let words = format!("{name}: {}.", said.collect::<Vec<_>>().join(", "));
            let step = ShownAttempt::new(&round.partly(is_done), pose.clone(), words);
            let marked = (0..model.limbs().len()).map(|index| index == limb || index == other).collect();
            self.push(ShownAttempt { marked, ..step });
        }
        self.push(ShownAttempt::new(
            &round.after,
            pose.clone(),
            "What no background stops follows the limbs that were measured, or stays.".to_owned(),
        ));
    }
}

/// This many of the best, heaviest first.
fn weighed(all: &[(Arc<Pose>, f64)], least: f64, count: usize) -> Vec<(Arc<Pose>, f64)> {
    let weigh = |(pose, cost): &(Arc<Pose>, f64)| (pose.clone(), likeness(*cost, least));
    let mut bodies: Vec<_> = all.iter().map(weigh).collect();
    bodies.sort_by(|a, b| b.1.total_cmp(&a.1));
    bodies.truncate(count);
    bodies
}

/// 1 for the least cost, less for what costs more.
fn likeness(cost: f64, least: f64) -> f64 {
    let more = (cost / least - 1.0).max(0.0);
    if more.is_finite() { (-FALL * more).exp() } else { 0.0 }
}

/// A chain by its first limb: "Left shoulder and what hangs from it".
fn chain_words(model: &Model, first: &str) -> String {
    let rotation = model.limb_index(first).map(|limb| model.limbs()[limb].rotation);
    let has_more = rotation.is_some() && model.rotation_parents().contains(&rotation);
    format!("{}{}", format::capitalised(first), if has_more { " and what hangs from it" } else { "" })
}

fn percent_of(share: f64) -> String {
    format!("{} %", format::number(100.0 * share, 0))
}

/// "7 % longer", "as thick as before".
fn change(factor: f64, [more, less]: [&str; 2]) -> String {
    let by = format::number(100.0 * (factor - 1.0).abs(), 0);
    match factor {
        _ if (factor - 1.0).abs() < SAME => {
            format!("as {} as before", if more == "longer" { "long" } else { "thick" })
        }
        _ if factor > 1.0 => format!("{by} % {more}"),
        _ => format!("{by} % {less}"),
    }
}
