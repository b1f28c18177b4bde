//! The laboratory in the window.

use crate::app::testing::{Breaks, open};
use crate::context::command::{Command, LaboratoryCommand};
use crate::context::preferences::Layout;

#[test]
fn a_laboratory_that_breaks_down_says_so_and_begins_again() {
    let mut app = open(Layout::Demonstrate);
    app.features.laboratory.comparison = None;
    app.update_features();
    app.break_down(|all, pool| all.features.laboratory.steps.begin(pool, (), |()| Breaks));
    let comparison = app.features.laboratory.comparison.as_ref().unwrap();
    assert!(comparison.has_begun() && comparison.problem().unwrap().contains("broke down"));
    app.does(Command::Laboratory(LaboratoryCommand::Restart));
    let comparison = app.features.laboratory.comparison.as_ref().unwrap();
    assert!(comparison.problem().is_none() && comparison.contestants.iter().all(|fit| !fit.steps.is_empty()));
    assert_eq!(app.errors(), ["The laboratory broke down: thirteen. Your work is unharmed."]);
}

#[test]
fn pictures_and_checks_that_break_down_are_said_once_and_not_tried_again_for_the_same_step() {
    let mut app = open(Layout::Demonstrate);
    let laboratory = &mut app.features.laboratory;
    let comparison = laboratory.comparison.as_mut().unwrap();
    for fit in &mut comparison.contestants {
        (fit.shown, fit.checked) = (None, None);
    }
    let wanted = super::update::unchecked(comparison);
    assert!(!wanted.is_empty());
    let lacking = super::Lacking { steps: wanted.clone(), push: None };
    app.break_down(|all, pool| {
        all.features.laboratory.looks.begin(pool, lacking, |_| Breaks);
        all.features.laboratory.checks.begin(pool, wanted, |_| Breaks);
    });
    let laboratory = &app.features.laboratory;
    assert!(laboratory.check_broke_down() && laboratory.looks.failure().is_some());
    assert_eq!(
        app.errors(),
        [
            "Drawing the laboratory’s pictures broke down: thirteen. Your work is unharmed.",
            "The check of the laboratory’s gradients broke down: thirteen. Your work is unharmed."
        ]
    );
}
