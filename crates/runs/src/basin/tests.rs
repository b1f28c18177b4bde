//! Basins of a small simulated upper body, and of drawn starts.

use std::sync::Arc;

use backlit_lab::experiment::starts::Draw;
use backlit_lab::synthetic::{capsules, upper_body};
use backlit_tracking::body::builtin;
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::search::start::Level;

use super::*;

/// The upper body before two small cameras.
fn subject() -> Subject {
    let model = Arc::new(builtin::upper_body());
    let reference = upper_body::motion(&model, 7);
    let view = |camera: &Arc<Camera>| {
        FitView::of_mask(camera.clone(), capsules::hard_mask(&model, &reference, camera).unwrap())
    };
    let views = upper_body::cameras(2, [48, 36]).unwrap().iter().map(view).collect();
    Subject { model, views, reference }
}

fn random() -> RandomStarts {
    let levels = vec![Level { degrees: 5, metres: 0.02 }, Level { degrees: 60, metres: 0.3 }];
    RandomStarts { rotation: None, levels, starts: 4, seed: 3 }
}

fn grid() -> StartGrid {
    let model = builtin::upper_body();
    let flexion = |name: &str| Direction {
        rotation: model.limbs()[model.limb_index(name).unwrap()].rotation,
        angle: Angle::Flexion,
    };
    let directions = ["right upper arm", "right forearm"].map(flexion);
    StartGrid { directions, degrees: 40.0, cells: 3 }
}

fn downhill(preset: Preset) -> FitChoice {
    FitChoice::downhill(preset.label(), FitOptions::preset(preset))
}

fn options(starts: Starts) -> BasinOptions {
    BasinOptions {
        choices: vec![downhill(Preset::Robust)],
        starts,
        target: Target::Fit,
        success_mm: SUCCESS_MM,
    }
}

fn result(options: BasinOptions) -> BasinResult {
    BasinResult::new(7, String::new(), options, subject())
}

#[test]
fn near_starts_find_home_and_far_ones_do_not_and_all_twice_the_same() {
    let all = || result(options(Starts::Random(random()))).run(&CancelToken::new(), |_| {}).unwrap().report;
    let report = all();
    let [near, far] = [0, 1].map(|level| &report.choices[0].levels[level].rate);
    assert_eq!((near.tried, near.found), (4, 4), "{near:?}");
    assert!(far.found < 4 && far.median_mm > near.median_mm, "{far:?}");
    assert!(near.interval[0] < 1.0 && near.interval[1] == 1.0);
    assert_eq!(report, all());
}

#[test]
fn one_joint_is_turned_alone_by_the_same_turn() {
    let subject = subject();
    let one = RandomStarts { rotation: Some(2), ..random() };
    let [start, alone] = [random(), one].map(|starts| Starts::Random(starts).pose(&subject, [0, 1]));
    assert_eq!((alone.root, alone.rotations[2]), (start.root, start.rotations[2]));
    for rotation in (0..subject.model.rotation_count()).filter(|rotation| *rotation != 2) {
        assert_eq!(alone.rotations[rotation], subject.reference.rotations[rotation]);
    }
}

#[test]
fn some_of_the_trials_are_a_report_too() {
    let mut result = result(options(Starts::Random(random())));
    for (start, error_mm) in [(2, 30.0), (0, 10.0)] {
        result.add(Trial { choice: 0, place: [1, start], start_mm: 0.0, error_mm });
    }
    let [none, two] = [0, 1].map(|level| &result.report.choices[0].levels[level].rate);
    assert_eq!((none.tried, none.success, none.median_mm), (0, None, None));
    assert_eq!((two.tried, two.found, two.success), (2, 1, Some(0.5)));
    assert_eq!(two.errors_mm, [10.0, 30.0]);
    assert_eq!((result.fits().done, result.counts(0)), (2, [2, 1]));
}

#[test]
fn the_middle_is_the_reference_and_comes_first() {
    let (subject, grid) = (subject(), grid());
    let starts = Starts::Grid(grid);
    let places = starts.places();
    assert_eq!((places.len(), places[0]), (9, [1, 1]));
    assert_eq!(grid.pose(&subject, [1, 1]), subject.reference);
    assert_eq!([0, 1, 2].map(|place| grid.offset_degrees(place)), [-40.0, 0.0, 40.0]);
    let turned = grid.pose(&subject, [2, 1]);
    let limb = &subject.model.limbs()[subject.model.limb_index("right upper arm").unwrap()];
    let flexion = |pose: &Pose| limb.angles(pose.rotations[limb.rotation]).flexion.to_degrees();
    assert!((flexion(&turned) - flexion(&subject.reference) - 40.0).abs() < 1e-6);

    let basin = Basin::new(subject, &options(starts), &CancelToken::new()).unwrap();
    let middle = basin.run(0, &CancelToken::new()).unwrap();
    assert_eq!((middle.place, middle.error_mm), ([1, 1], 0.0));
    let corner = basin.run(8, &CancelToken::new()).unwrap();
    assert!(corner.start_mm > 50.0 && corner == basin.run(8, &CancelToken::new()).unwrap());
}

#[test]
fn choices_are_fitted_side_by_side_each_as_it_is_alone() {
    let basin = |choices: Vec<FitChoice>| {
        let options = BasinOptions { choices, ..options(Starts::Grid(grid())) };
        Basin::new(subject(), &options, &CancelToken::new()).unwrap()
    };
    let [robust, report] = [Preset::Robust, Preset::Report].map(downhill);
    let both = basin(vec![robust.clone(), report.clone()]);
    let [robust, report] = [robust, report].map(|choice| basin(vec![choice]));
    assert_eq!((both.trials(), robust.trials()), (18, 9));
    let run = |basin: &Basin, index| basin.run(index, &CancelToken::new()).unwrap();
    for cell in [0, 3, 8] {
        assert_eq!(run(&both, 2 * cell), run(&robust, cell));
        assert_eq!(run(&both, 2 * cell + 1), Trial { choice: 1, ..run(&report, cell) });
    }
}

#[test]
fn options_out_of_range_are_named() {
    let wrong =
        |options: &BasinOptions| Basin::new(subject(), options, &CancelToken::new()).unwrap_err().to_string();
    let mut turned = grid();
    turned.directions[1].rotation = 50;
    for (starts, word) in [
        (Starts::Random(RandomStarts { starts: 0, ..random() }), "starts"),
        (Starts::Random(RandomStarts { levels: Vec::new(), ..random() }), "angles"),
        (Starts::Random(RandomStarts { rotation: Some(99), ..random() }), "rotation"),
        (Starts::Grid(StartGrid { cells: 1, ..grid() }), "cells"),
        (Starts::Grid(StartGrid { degrees: 0.0, ..grid() }), "degrees"),
        (Starts::Grid(turned), "rotation"),
    ] {
        assert!(wrong(&options(starts)).contains(word), "{word}");
    }
    let whole = options(Starts::Random(random()));
    assert!(wrong(&BasinOptions { success_mm: f64::NAN, ..whole.clone() }).contains("within"));
    assert!(wrong(&BasinOptions { choices: Vec::new(), ..whole.clone() }).contains("choices"));
    let cancel = CancelToken::new();
    cancel.cancel();
    assert_eq!(result(whole).run(&cancel, |_| {}).unwrap_err(), BasinError::Cancelled);
}

/// The rate of starts that are so far off before four cameras.
fn drawn(starts: usize, level: Level, choice: FitChoice) -> SuccessRate {
    let draw = Draw { starts, levels: vec![level], cameras: vec![4], ..Draw::default() };
    let run = |drawn: backlit_formats::starts_file::Start| {
        let views = drawn.views[&4].clone();
        let subject = Subject { model: drawn.model, views, reference: drawn.truth };
        choice.error_mm(&subject, &drawn.start, &subject.reference, &CancelToken::new()).unwrap()
    };
    SuccessRate::of(draw.draw().unwrap().into_iter().map(run).collect(), SUCCESS_MM)
}

#[test]
fn hypotheses_find_what_going_downhill_does_not() {
    let level = Level { degrees: 30, metres: 0.15 };
    let choices = [downhill(Preset::Report), downhill(Preset::Robust), FitChoice::best_of(Preset::Robust)];
    let [report, downhill, search] = choices.map(|choice| drawn(8, level, choice).success.unwrap());
    assert!(report < downhill && downhill < search, "{report} {downhill} {search}");
    assert!(search > 0.85, "{search}");
}

#[test]
fn without_a_start_four_cameras_find_the_truth() {
    let choice = FitChoice { ignores_start: true, ..FitChoice::best_of(Preset::Robust) };
    let rate = drawn(4, Level { degrees: 45, metres: 0.2 }, choice);
    assert!(rate.success.unwrap() > 0.99, "{rate:?}");
}

#[test]
fn the_same_starts_give_the_same_numbers() {
    let rate = || drawn(2, Level { degrees: 20, metres: 0.1 }, FitChoice::best_of(Preset::Robust));
    assert_eq!(rate(), rate());
}
