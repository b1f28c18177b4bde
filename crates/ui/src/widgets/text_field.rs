//! A line of text to be typed, with an edge that is seen on every ground.

use egui::{CornerRadius, Event, Response, TextEdit, Ui};

use crate::style::theme;
use crate::style::theme::size;

/// A field as wide as there is room. `name` is what screen readers call it; `hint` stands in it while it is empty.
pub fn text_field(ui: &mut Ui, name: &str, hint: &str, text: &mut String) -> Response {
    let palette = theme::palette(ui);
    let field = ui.scope(|ui| {
        let widgets = &mut ui.visuals_mut().widgets;
        for state in [&mut widgets.inactive, &mut widgets.hovered] {
            state.bg_stroke = palette.hairline();
            state.corner_radius = CornerRadius::same(size::FIELD_RADIUS);
        }
        ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY))
    });
    // `Ui::name_inputs` leaves out fields with a hint, and a hint is gone once something is typed.
    ui.ctx().accesskit_node_builder(field.inner.id, |node| node.set_label(name));
    field.inner
}

/// A field that holds the focus as long as it is shown. It takes it at the end of its first frame; what is typed
/// before, as in a slow frame, goes into the text all the same.
pub fn search_field(ui: &mut Ui, name: &str, hint: &str, text: &mut String) -> Response {
    let before = text.len();
    if !ui.ctx().text_edit_focused() {
        ui.input(|input| {
            let typed = input.events.iter().filter_map(|event| match event {
                Event::Text(typed) => Some(typed.as_str()),
                _ => None,
            });
            text.extend(typed);
        });
    }
    let has_grown = text.len() > before;
    let mut field = text_field(ui, name, hint, text);
    field.request_focus();
    if has_grown {
        field.mark_changed();
    }
    field
}
