//! The particle filter: its likelihood is the fit's cost, its parts move one after the other, and threads change nothing.

use std::sync::Arc;

use backlit_formats::starts_file::Start;
use backlit_lab::experiment::starts::Draw;
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{FitOptions, Objective};
use backlit_tracking::metrics::leaf_error_mm;
use backlit_tracking::optimize::{LeastSquares, NormalEquations};
use backlit_tracking::particles::{Generation, Likelihood, ParticleError, ParticleFilter, ParticleOptions};
use backlit_tracking::search::start::Level;

fn starts(degrees: u32, metres: f64, count: usize) -> Vec<Start> {
    let levels = vec![Level { degrees, metres }];
    Draw { starts: count, levels, cameras: vec![2], ..Draw::default() }.draw().unwrap()
}

fn start(degrees: u32, metres: f64) -> Start {
    starts(degrees, metres, 1).remove(0)
}

fn filter(start: &Start, options: ParticleOptions) -> ParticleFilter {
    let views = start.views[&2].clone();
    ParticleFilter::new(Arc::clone(&start.model), views, std::slice::from_ref(&start.start), options).unwrap()
}

fn all(mut filter: ParticleFilter) -> (Vec<Generation>, Pose) {
    let mut generations = Vec::new();
    let summary = filter.run(&CancelToken::new(), |generation| generations.push(generation.clone()));
    (generations, summary.pose)
}

#[test]
fn the_likelihood_is_the_fits_own_cost() {
    let start = start(20, 0.1);
    let views = &start.views[&2];
    let options = FitOptions { rest_weight: 0.0, proximal_weight: 0.0, ..FitOptions::default() };
    for stage in options.stages.clone() {
        let likelihood = Likelihood::new(Arc::clone(&start.model), views, &options, &stage);
        let distances: Vec<_> = views.iter().map(|view| view.distance(&options.stages)).collect();
        let model = Arc::clone(&start.model);
        let mut objective = Objective::new(model, views, &distances, &options, stage, start.start.clone());
        let mut equations = NormalEquations::zeros(objective.columns());
        objective.evaluate(&start.start, &mut equations);
        let drawn = vec![true; start.model.limbs().len()];
        let cost = likelihood.cost(&mut likelihood.memory(), &start.start, &drawn);
        let expected = equations.cost * (stage.stride * stage.stride) as f64;
        assert!((cost - expected).abs() <= 1e-6 * expected, "{cost} {expected}");
    }
}

/// Limbs that are not drawn are as if the body had none: the head alone covers less than the body.
#[test]
fn limbs_that_are_not_drawn_cover_nothing() {
    let start = start(5, 0.0);
    let options = FitOptions::default();
    let model = Arc::clone(&start.model);
    let likelihood = Likelihood::new(model, &start.views[&2], &options, &options.stages[4]);
    let mut memory = likelihood.memory();
    let mut cost = |drawn: &[bool]| likelihood.cost(&mut memory, &start.truth, drawn);
    let limbs = start.model.limbs().len();
    let mut head = vec![false; limbs];
    head[start.model.limb_index("head").unwrap()] = true;
    let [none, some, whole] = [cost(&vec![false; limbs]), cost(&head), cost(&vec![true; limbs])];
    assert!(whole < 0.3 * none && some < 0.97 * none && some > 0.7 * none, "{whole} {some} {none}");
}

#[test]
fn parts_move_one_after_the_other() {
    let start = start(20, 0.1);
    let options = ParticleOptions { particles: 40, layers: 2, ..ParticleOptions::default() };
    let filter = filter(&start, options);
    let parts = filter.parts().to_vec();
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["trunk", "head", "right shoulder", "left shoulder"]);
    let (generations, best) = all(filter);
    assert_eq!(generations.len(), 8);
    for (index, generation) in generations.iter().enumerate() {
        assert_eq!((generation.layer, generation.part), (index / 4, index % 4));
        let sum: f64 = generation.particles.iter().map(|particle| particle.weight).sum();
        assert!((sum - 1.0).abs() < 1e-9);
        assert!((generation.effective() / 40.0 - 0.25).abs() < 0.01, "{}", generation.effective());
        assert_eq!(generation.evaluations, 40 * (index + 1));
        assert_eq!(generation.drawn.iter().all(|&drawn| drawn), index >= 3, "{index}");
    }
    for two in generations.windows(2) {
        let part = &parts[two[1].part];
        for particle in &two[1].particles {
            let is_parent = |parent: &Pose| {
                let turned =
                    |rotation: &usize| parent.rotations[*rotation] == particle.pose.rotations[*rotation];
                let others = (0..parent.rotations.len()).filter(|r| !part.rotations.contains(r));
                others.collect::<Vec<_>>().iter().all(turned)
                    && (part.moves_root || parent.root == particle.pose.root)
            };
            let has_parent = two[0].particles.iter().any(|parent| is_parent(&parent.pose));
            assert!(has_parent, "only {} moves", part.name);
        }
    }
    assert_eq!(&best, &generations[7].best().pose);
}

#[test]
fn threads_change_nothing_and_seeds_do() {
    let start = start(30, 0.15);
    let options = ParticleOptions { particles: 60, layers: 4, ..ParticleOptions::default() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| all(filter(&start, options.clone())))
    };
    let one = on(1);
    assert_eq!(one, on(3));
    let other = ParticleOptions { seed: 2, ..options.clone() };
    assert_ne!(all(filter(&start, other)).1, one.1);
}

#[test]
fn far_starts_come_near_the_truth() {
    let [mut before, mut after] = [0.0; 2];
    for start in starts(20, 0.1, 4) {
        let found = all(filter(&start, ParticleOptions::default())).1;
        before += leaf_error_mm(&start.model, &start.start, &start.truth) / 4.0;
        after += leaf_error_mm(&start.model, &found, &start.truth) / 4.0;
    }
    assert!(before > 150.0 && after < 0.45 * before, "{before:.0} mm, then {after:.0} mm");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let start = start(5, 0.0);
    let views = start.views[&2].clone();
    let new = |model: Model, starts: &[Pose], options| {
        ParticleFilter::new(Arc::new(model), views.clone(), starts, options).unwrap_err()
    };
    let options = ParticleOptions::default;
    assert_eq!(new(builtin::upper_body(), &[], options()), ParticleError::NoStart);
    let other = Pose::rest(&builtin::full_body());
    assert!(new(builtin::upper_body(), &[other], options()).to_string().contains("quaternions"));
    let none = ParticleOptions { layers: 0, ..options() };
    let said = new(builtin::upper_body(), std::slice::from_ref(&start.start), none).to_string();
    assert!(said.contains("`layers` is 0"), "{said}");
    let cancelled = CancelToken::new();
    cancelled.cancel();
    let summary = filter(&start, options()).run(&cancelled, |_| {});
    assert!(summary.cancelled && summary.evaluations == 0);
    assert_eq!(summary.pose, start.start.normalized());
}
