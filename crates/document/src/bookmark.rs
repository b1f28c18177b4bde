//! Places that somebody marked: a frame, and if wanted a camera and a joint, with a line of text.

use std::sync::Arc;

use backlit_tracking::body::Model;
use backlit_words::joint::{JointId, joint_name};

use crate::edit::{Edit, EditError};
use crate::{CameraUse, Document};

/// The longest text of a bookmark, letters.
pub const LONGEST_TEXT: usize = 200;

/// A marked place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bookmark {
    /// The frame.
    pub frame: usize,
    /// The camera, by its place in the take.
    pub camera: Option<usize>,
    /// The joint.
    pub joint: Option<JointId>,
    /// One line: what is to be seen there.
    pub text: String,
}

impl Bookmark {
    /// Where it is: "Frame 12, cam02, left elbow".
    pub fn place(&self, model: &Model, cameras: &[CameraUse]) -> String {
        let camera = self.camera.and_then(|camera| cameras.get(camera)).map(|camera| camera.name.clone());
        let joint = self.joint.map(|joint| joint_name(model, joint));
        let mut place = format!("Frame {}", self.frame);
        camera.into_iter().chain(joint).for_each(|part| place += &format!(", {part}"));
        place
    }

    /// What a text must be to be a bookmark's, where this one is not.
    pub fn expected_of(text: &str) -> Option<&'static str> {
        let is_line = text.chars().count() <= LONGEST_TEXT && !text.contains(char::is_control);
        (!is_line).then_some("one line of at most 200 letters, without control characters")
    }
}

impl Document {
    /// Makes an edit of bookmarks; any other changes nothing. They stay in the order of their frames.
    pub(crate) fn mark(&mut self, edit: Edit) -> Result<(), EditError> {
        let count = self.bookmarks.len();
        let none = |index: usize| EditError::NoBookmark { index, count };
        match edit {
            Edit::AddBookmark(bookmark) => {
                self.check_bookmark(&bookmark)?;
                Arc::make_mut(&mut self.bookmarks).push(bookmark);
            }
            Edit::ChangeBookmark { index, bookmark } => {
                self.check_bookmark(&bookmark)?;
                *Arc::make_mut(&mut self.bookmarks).get_mut(index).ok_or_else(|| none(index))? = bookmark;
            }
            Edit::RemoveBookmark { index } if index < count => {
                Arc::make_mut(&mut self.bookmarks).remove(index);
            }
            Edit::RemoveBookmark { index } => return Err(none(index)),
            _ => {}
        }
        if !self.bookmarks.is_sorted_by_key(|bookmark| bookmark.frame) {
            Arc::make_mut(&mut self.bookmarks).sort_by_key(|bookmark| bookmark.frame);
        }
        Ok(())
    }

    fn check_bookmark(&self, bookmark: &Bookmark) -> Result<(), EditError> {
        if let Some(camera) = bookmark.camera {
            self.check_camera(camera)?;
        }
        if let Some(JointId::End(limb)) = bookmark.joint {
            self.check_limb(limb)?;
        }
        match Bookmark::expected_of(&bookmark.text) {
            Some(expected) => Err(EditError::BookmarkText { expected }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    fn mark(frame: usize, text: &str) -> Bookmark {
        Bookmark { frame, camera: None, joint: Some(JointId::End(0)), text: text.to_owned() }
    }

    #[test]
    fn bookmarks_are_added_changed_and_removed_in_the_order_of_frames() {
        let mut document = Document::new(builtin::single_limb());
        document.apply(Edit::AddBookmark(mark(7, "late"))).unwrap();
        document.apply(Edit::AddBookmark(mark(2, "early"))).unwrap();
        assert_eq!(*document.bookmarks, [mark(2, "early"), mark(7, "late")]);
        document.apply(Edit::ChangeBookmark { index: 0, bookmark: mark(9, "later") }).unwrap();
        assert_eq!(*document.bookmarks, [mark(7, "late"), mark(9, "later")]);
        document.apply(Edit::RemoveBookmark { index: 0 }).unwrap();
        assert_eq!(*document.bookmarks, [mark(9, "later")]);

        let before = document.clone();
        for edit in [
            Edit::RemoveBookmark { index: 1 },
            Edit::ChangeBookmark { index: 1, bookmark: mark(1, "") },
            Edit::AddBookmark(mark(1, "two\nlines")),
            Edit::AddBookmark(mark(1, &"x".repeat(201))),
            Edit::AddBookmark(Bookmark { camera: Some(0), ..mark(1, "no camera") }),
            Edit::AddBookmark(Bookmark { joint: Some(JointId::End(5)), ..mark(1, "no limb") }),
        ] {
            assert!(document.apply(edit.clone()).is_err(), "{edit:?}");
        }
        assert_eq!(document, before);
        assert!(document.bookmarks[0].place(&document.model, &[]).starts_with("Frame 9, "));
    }
}
