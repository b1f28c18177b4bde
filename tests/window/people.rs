//! One of two people is chosen by a click in a view; the choice is kept in the project, and undone.

use backlit_document::project::read_project;
use backlit_lab::synthetic::two_people;
use backlit_tracking::body::builtin;
use backlit_tracking::silhouette::Label;
use egui_kittest::kittest::Queryable;

use crate::support::window::{Window, WindowState, at, click, command, save, undo};

/// How many pixels of a frame are unknown, all cameras together.
fn unknown(window: &Window) -> usize {
    let session = window.session();
    let frame = session.frames.get(window.selection().frame).unwrap();
    let masks = frame.cameras.iter().filter_map(|camera| camera.mask.as_ref());
    masks.map(|mask| mask.count(Label::Unknown)).sum()
}

#[test]
fn a_click_on_one_of_two_people_makes_the_other_unknown() {
    let folder = tempfile::tempdir().unwrap();
    two_people::write(folder.path(), &builtin::full_body(), [288, 288], &[0, 1]).unwrap();
    let mut window = at(folder.path()).open();
    assert_eq!(unknown(&window), 0);
    command(&mut window, "Follow one person");
    let said = window.last_said();
    assert!(said.starts_with("2 people are in view. Click the one to follow"), "{said}");
    click(&mut window, "Follow Person 2, Camera 1");
    assert!(window.query_by_label("Follow Person 1, Camera 1").is_none(), "it is chosen");
    let hidden = unknown(&window);
    assert!(hidden > 5000, "{hidden}");
    let project = folder.path().join("two.backlit");
    save(&mut window, &project);
    let kept = read_project(&project).unwrap().document.person;
    assert!(kept.is_some() && kept == window.document().person);
    assert_eq!(unknown(&at(&project).open()), hidden, "as it was, in another window");
    undo(&mut window);
    assert_eq!((window.document().person.clone(), unknown(&window)), (None, 0));
}
