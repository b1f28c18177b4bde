//! Places that somebody marked: a card that lists them, goes to them, adds, changes and removes them. They are the document's; the
//! timeline shows them too.

#[cfg(test)]
mod tests;

use backlit_document::bookmark::{Bookmark, LONGEST_TEXT};
use backlit_document::edit::Edit;
use backlit_ui::style::theme;
use backlit_ui::style::theme::space;
use backlit_ui::widgets::{button_row, card, checkbox, hint, primary_button, text_button, text_field};
use backlit_words::joint::joint_name;
use egui::{Key, RichText, ScrollArea, Ui};

use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, no_take};
use crate::context::{Context, FeatureCard, Requests, ShellRequest};

/// Width of the card, and height of the list at most.
const WIDTH: f32 = 460.0;
const LIST: f32 = 320.0;

#[derive(Debug, Default)]
pub(crate) struct Bookmarks {
    /// The text of a new one.
    text: String,
    with_camera: bool,
    with_joint: bool,
    /// The one whose text is being changed, and the text so far.
    changed: Option<(usize, String)>,
}

impl Feature for Bookmarks {
    fn run(&mut self, command: Command, _: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::Bookmarks;
        if is_own {
            *self = Self { with_camera: self.with_camera, with_joint: self.with_joint, ..Self::default() };
            requests.request(ShellRequest::OpenCard(FeatureCard::Bookmarks));
        }
        is_own
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        if command == Command::Bookmarks { no_take(context) } else { None }
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let modal = card(ui.ctx(), "bookmarks").show(ui.ctx(), |ui| {
            ui.set_width(WIDTH);
            ui.spacing_mut().item_spacing.y = 6.0;
            ui.label(RichText::new("Bookmarks").text_style(theme::title()));
            self.new_one(ui, context, requests);
            ui.add_space(space::ROW);
            let has_gone = self.list(ui, context, requests);
            has_gone | button_row(ui, |ui| text_button(ui, "Close").clicked())
        });
        !(modal.inner || modal.should_close())
    }
}

impl Bookmarks {
    /// The row that adds one at the frame on the screen.
    fn new_one(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let (selection, document) = (context.selection, context.document());
        let entered = ui
            .horizontal(|ui| {
                hint(ui, format!("Frame {}", selection.frame));
                let field = text_field(ui, "New bookmark", "What is to be seen here", &mut self.text);
                field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter))
            })
            .inner;
        shorten(&mut self.text);
        ui.horizontal(|ui| {
            if let Some(camera) = document.cameras.get(selection.camera) {
                checkbox(ui, &mut self.with_camera, &format!("Camera {}", camera.name));
            }
            let joint = joint_name(&document.model, selection.joint);
            checkbox(ui, &mut self.with_joint, &format!("Joint {joint}"));
            if primary_button(ui, "Add bookmark").clicked() || entered {
                let bookmark = Bookmark {
                    frame: selection.frame,
                    camera: self.with_camera.then_some(selection.camera),
                    joint: self.with_joint.then_some(selection.joint),
                    text: std::mem::take(&mut self.text),
                };
                requests.edit(Edit::AddBookmark(bookmark));
            }
        });
    }

    /// All of them, each with what can be done; whether one was gone to.
    fn list(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        let document = context.document();
        if document.bookmarks.is_empty() {
            hint(
                ui,
                "There are none yet. They are kept in the project, and stand on the timeline and in reports.",
            );
        }
        let mut has_gone = false;
        ScrollArea::vertical().max_height(LIST).show(ui, |ui| {
            for (index, bookmark) in document.bookmarks.iter().enumerate() {
                let place = bookmark.place(&document.model, &document.cameras);
                ui.horizontal(|ui| {
                    if text_button(ui, &place).on_hover_text("Go there").clicked() {
                        requests.go_to(bookmark);
                        has_gone = true;
                    }
                    if text_button(ui, "Remove").clicked() {
                        requests.edit(Edit::RemoveBookmark { index });
                        self.changed = None;
                    }
                });
                self.text_of(ui, index, bookmark, requests);
            }
        });
        has_gone
    }

    /// The text of one, which is changed when it loses the focus.
    fn text_of(&mut self, ui: &mut Ui, index: usize, bookmark: &Bookmark, requests: &mut Requests) {
        let mut text = match &self.changed {
            Some((changed, text)) if *changed == index => text.clone(),
            _ => bookmark.text.clone(),
        };
        let field = text_field(ui, &format!("Text of bookmark {}", index + 1), "No text", &mut text);
        shorten(&mut text);
        if field.changed() {
            self.changed = Some((index, text.clone()));
        }
        if field.lost_focus() {
            if text != bookmark.text {
                let bookmark = Bookmark { text, ..bookmark.clone() };
                requests.edit(Edit::ChangeBookmark { index, bookmark });
            }
            self.changed = None;
        }
    }
}

/// A text is one line, and not longer than a bookmark's may be.
fn shorten(text: &mut String) {
    if Bookmark::expected_of(text).is_some() {
        *text = text.chars().filter(|letter| !letter.is_control()).take(LONGEST_TEXT).collect();
    }
}
