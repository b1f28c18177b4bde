//! Every way to begin tells what it tries, and looking on changes nothing.

use backlit_lab::experiment::starts::Draw;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::initialisation::{
    Attempt, InitialisationInputs, InitialisationMethod as Method, InitialisationOptions,
};
use backlit_tracking::search::start::Level;

#[test]
fn every_attempt_is_told_and_telling_changes_nothing() {
    let levels = vec![Level { degrees: 10, metres: 0.1 }];
    let start = &Draw { starts: 1, levels, cameras: vec![2], ..Draw::default() }.draw().unwrap()[0];
    for given in [Some(&start.start), None] {
        for method in Method::COMPARED {
            let (options, cancel) = (InitialisationOptions::default(), CancelToken::new());
            let (model, views) = (&start.model, &start.views[&2]);
            let inputs = InitialisationInputs { model, views, start: given, cancel: &cancel };
            let (mut kinds, mut lowest) = ([0; 6], f64::INFINITY);
            let mut count = |attempt: Attempt<'_>| {
                let kind = match attempt {
                    Attempt::Start { .. } => 0,
                    Attempt::Iteration { .. } => 1,
                    Attempt::Generation { generation, .. } => {
                        let all: f64 = generation.particles.iter().map(|particle| particle.weight).sum();
                        assert!((all - 1.0).abs() < 1e-9, "{all}");
                        2
                    }
                    Attempt::Template(_) => 3,
                    Attempt::Hypothesis(tried) => {
                        lowest = lowest.min(tried.cost);
                        4
                    }
                    Attempt::Round(_) => 5,
                    Attempt::Growth { .. } | Attempt::Grown { .. } => panic!("{method} grows no body"),
                };
                kinds[kind] += 1;
            };
            let result = options.run(method, &inputs, &mut count).unwrap();
            assert_eq!(result, options.run(method, &inputs, &mut |_| {}).unwrap());
            let begins = if given.is_some() { 1 } else { 8 };
            let particles = if given.is_some() { &options.particles } else { &options.particles_no_start };
            let expected = match (method, given) {
                (Method::Report | Method::RampAlone | Method::Ramp, _) => {
                    kinds[0] == begins && kinds[1] >= begins * 10
                }
                (Method::Particles, _) => kinds[2] == particles.layers * 4 && kinds[0] == 1,
                (Method::Templates, _) => kinds[3] > 5 && kinds[0] == 1 && kinds[1] > 0,
                (Method::Search, Some(_)) => kinds[4] > 5 && kinds[..4] == [0; 4] && lowest.is_finite(),
                (Method::Search, None) => kinds == [0, 0, 0, 0, 0, 4],
                (Method::Body, _) => unreachable!("it is not compared"),
            };
            assert!(expected, "{method}: {kinds:?}");
        }
    }
}
