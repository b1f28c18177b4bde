//! Clocks of cameras that are off, found from the motion of people's silhouettes.

use backlit_formats::{Footage, Take};
use backlit_lab::experiment::sync::{Case, Options, Setting, Trouble, run, run_take, table};
use backlit_tracking::cancel::CancelToken;

use crate::footage::footage;

fn cases(settings: &[Setting], troubles: &[Trouble]) -> Vec<Case> {
    let (settings, troubles) = (settings.to_vec(), troubles.to_vec());
    let options = Options { settings, troubles, trials: 1, size_px: [108, 144], ..Options::default() };
    run(&options, &CancelToken::new(), |_| {}).unwrap().cases
}

#[test]
fn clocks_are_found_whatever_is_wrong_with_the_masks() {
    let troubles = [Trouble::Nothing, Trouble::Wide(0.05), Trouble::Noise(0.3), Trouble::OtherRate(25.0)];
    for case in cases(&[Setting::Around], &troubles) {
        assert!(case.told() > 0.99 && case.errors_in_frames().iter().all(|error| *error < 0.25), "{case:#?}");
    }
}

#[test]
fn two_telephones_37_degrees_apart_are_enough() {
    for case in cases(&[Setting::Phones], &[Trouble::OneWide(0.05), Trouble::Noise(0.3)]) {
        assert!(case.told() > 0.99 && case.errors_in_frames()[0] < 0.25, "{case:#?}");
    }
}

#[test]
fn a_person_who_stands_still_is_refused() {
    for case in cases(&[Setting::Still], &[Trouble::Nothing, Trouble::Noise(0.3)]) {
        assert!(case.told() < 0.01, "{case:#?}");
        let is_said = |why: &str| why.starts_with("nothing moves enough to tell");
        assert!(case.found.iter().all(|found| found.why.as_deref().is_some_and(is_said)), "{case:#?}");
    }
}

#[test]
fn a_shift_of_real_footage_is_found() {
    let Some(folder) = footage() else { return };
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/takes/balancing");
    let _ = folder;
    let footage = Footage::new(Take::open(&path).unwrap());
    let report = run_take(&footage, &[0, 7, -12], &CancelToken::new(), |_| {}).unwrap();
    let all = report.cases.last().unwrap();
    assert_eq!((all.found.len(), all.wrong()), (9, 0), "{}", table(&report));
    assert!(all.told() > 0.99, "{}", table(&report));
}
