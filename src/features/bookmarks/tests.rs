use backlit_document::bookmark::Bookmark;
use backlit_document::edit::Edit;
use backlit_take::source::TakeSource;
use backlit_words::joint::JointId;

use crate::app::testing::open_source;
use crate::context::command::{Command, HistoryCommand};
use crate::context::preferences::Layout;

#[test]
fn bookmarks_are_gone_to_and_undone() {
    let mut app = open_source(TakeSource::BuiltIn, Layout::Pose);
    let mark = Bookmark { frame: 7, camera: Some(2), joint: Some(JointId::End(4)), text: "here".to_owned() };
    app.state.edit(Edit::AddBookmark(mark.clone()), None);
    app.settle();
    assert_eq!(*app.document().bookmarks, *std::slice::from_ref(&mark));
    app.ask(|_, _, requests| requests.go_to(&mark));
    app.settle();
    let selection = &app.state.selection;
    assert_eq!((selection.frame, selection.camera, selection.joint), (7, 2, JointId::End(4)));
    app.does(Command::History(HistoryCommand::Undo));
    assert!(app.document().bookmarks.is_empty());
}
