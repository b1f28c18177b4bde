//! The laboratory in the window.

use crate::app::testing::{Breaks, errors, open, settle};
use crate::context::command::{Command, LaboratoryCommand};
use crate::context::preferences::Layout;

#[test]
fn a_laboratory_that_breaks_down_says_so_and_begins_again() {
    let (mut window, mut app) = open(Layout::Demonstrate);
    let pool = app.inspector.state.pool.clone();
    app.inspector.features.laboratory.comparison = None;
    app.inspector.update_features();
    app.inspector.features.laboratory.steps.begin(&pool, (), |()| Breaks);
    settle(&mut window, &mut app);
    let comparison = app.inspector.features.laboratory.comparison.as_ref().unwrap();
    assert!(comparison.has_begun() && comparison.problem().unwrap().contains("broke down"));
    app.run(Command::Laboratory(LaboratoryCommand::Restart));
    settle(&mut window, &mut app);
    let comparison = app.inspector.features.laboratory.comparison.as_ref().unwrap();
    assert!(comparison.problem().is_none() && comparison.contestants.iter().all(|fit| !fit.steps.is_empty()));
    assert_eq!(errors(&app), ["The laboratory broke down: thirteen. Your work is unharmed."]);
}

#[test]
fn pictures_and_checks_that_break_down_are_said_once_and_not_tried_again_for_the_same_step() {
    let (mut window, mut app) = open(Layout::Demonstrate);
    let pool = app.inspector.state.pool.clone();
    let laboratory = &mut app.inspector.features.laboratory;
    let comparison = laboratory.comparison.as_mut().unwrap();
    for fit in &mut comparison.contestants {
        (fit.shown, fit.checked) = (None, None);
    }
    let wanted = super::update::unchecked(comparison);
    assert!(!wanted.is_empty());
    let lacking = super::Lacking { steps: wanted.clone(), push: None };
    laboratory.looks.begin(&pool, lacking, |_| Breaks);
    laboratory.checks.begin(&pool, wanted, |_| Breaks);
    settle(&mut window, &mut app);
    let laboratory = &app.inspector.features.laboratory;
    assert!(laboratory.check_broke_down() && laboratory.looks.failure().is_some());
    assert_eq!(
        errors(&app),
        [
            "Drawing the laboratory’s pictures broke down: thirteen. Your work is unharmed.",
            "The check of the laboratory’s gradients broke down: thirteen. Your work is unharmed."
        ]
    );
}
