//! Cards over the window, sections that fold, text fields, and labels that take the text for which there is room.

use std::sync::Arc;

use egui::collapsing_header::CollapsingState;
use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align, Align2, Color32, Context, CornerRadius, Event, Frame, Galley, Id, Label, Layout, Modal,
    ModalResponse, Pos2, Rect, Response, RichText, Role, Sense, TextEdit, TextStyle, Ui, UiBuilder, Vec2,
    WidgetInfo, pos2, vec2,
};

use super::Icon;
use super::buttons::focus_ring;
use crate::style::theme;
use crate::style::theme::{size, space};

/// Distance of a search card's upper edge from the window's, as a share of its height.
const FROM_TOP: f32 = 0.16;

/// A card over the window.
#[expect(missing_debug_implementations, reason = "egui has none for what it shows")]
pub struct Card {
    id: Id,
    modal: Modal,
}

impl Card {
    /// Shows it. A card is placed by the size that it had a frame before: where that has changed, another frame is drawn at once,
    /// so that nothing moves under the pointer later.
    pub fn show<T>(self, ctx: &Context, contents: impl FnOnce(&mut Ui) -> T) -> ModalResponse<T> {
        let shown = self.modal.show(ctx, contents);
        let (id, size) = (self.id.with("size"), shown.response.rect.size());
        let before: Option<Vec2> = ctx.data_mut(|data| data.get_temp(id));
        if before != Some(size) {
            ctx.data_mut(|data| data.insert_temp(id, size));
            ctx.request_repaint();
        }
        shown
    }
}

/// A card in the middle of the window.
pub fn card(ctx: &Context, name: &'static str) -> Card {
    let id = Id::unique(name);
    Card { id, modal: Modal::new(id).frame(Frame::window(&ctx.global_style())) }
}

/// A card that hangs from its upper edge: what is typed into stays where it is, however much is found.
pub fn search_card(ctx: &Context, name: &'static str) -> Card {
    let below = (ctx.content_rect().height() * FROM_TOP).round();
    let area = Modal::default_area(Id::unique(name)).anchor(Align2::CENTER_TOP, vec2(0.0, below));
    let Card { id, modal } = card(ctx, name);
    Card { id, modal: modal.area(area) }
}

/// The buttons at the lower right of a card, from the right to the left.
pub fn button_row<T>(ui: &mut Ui, buttons: impl FnOnce(&mut Ui) -> T) -> T {
    // In a row of its own: by itself it would be as high as the card was before.
    ui.horizontal(|ui| ui.with_layout(Layout::right_to_left(Align::Center), buttons).inner).inner
}

/// Space between the chevron and the title.
const TITLE_GAP: f32 = 8.0;

/// A section named `title` with its contents. `summary` stands at the right of its head: hints when it is
/// open, the state when it is shut. The head is a button of the title's name.
pub fn section<R>(
    ui: &mut Ui,
    title: &str,
    summary: &str,
    open_at_first: bool,
    contents: impl FnOnce(&mut Ui) -> R,
) -> Option<R> {
    named_section(ui, title, title, summary, open_at_first, contents)
}

/// A [`section`] whose title changes, while it stays open or shut by `key`.
pub fn named_section<R>(
    ui: &mut Ui,
    key: &str,
    title: &str,
    summary: &str,
    open_at_first: bool,
    contents: impl FnOnce(&mut Ui) -> R,
) -> Option<R> {
    let id = ui.make_persistent_id(("section", key));
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, open_at_first);
    let width = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(vec2(width, size::SECTION), Sense::click());
    if response.clicked() {
        state.set_open(!state.is_open());
    }
    state.store(ui.ctx());
    let is_open = state.is_open();
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::selected(Role::Button, enabled, is_open, title));
    paint_head(ui, rect, &response, title, summary, is_open);
    let result = is_open.then(|| {
        let inner = ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = space::ROW;
            contents(ui)
        });
        ui.add_space(space::WIDGET);
        inner.inner
    });
    let y = ui.cursor().top();
    let line = theme::palette(ui).hairline();
    ui.painter().hline(ui.max_rect().expand(space::PANEL_MARGIN).x_range(), y, line);
    result
}

fn paint_head(ui: &Ui, rect: Rect, response: &Response, title: &str, summary: &str, is_open: bool) {
    let palette = theme::palette(ui);
    let chevron =
        Rect::from_center_size(pos2(rect.left() + size::ICON / 2.0, rect.center().y), vec2(14.0, 14.0));
    let icon = if is_open { Icon::ChevronDown } else { Icon::ChevronRight };
    let colour = if response.hovered() { palette.text } else { palette.text2 };
    icon.paint_scaled(ui.painter(), chevron, colour, 0.8);
    let left = pos2(chevron.right() + TITLE_GAP, rect.center().y);
    let title_rect = paint_text(ui, left, Align2::LEFT_CENTER, title, TextStyle::Heading, palette.text);
    let room = rect.right() - title_rect.right() - space::GROUP;
    let galley = cut_off(ui, summary, TextStyle::Small, palette.text3, room.max(0.0));
    let at = pos2(rect.right() - galley.size().x, rect.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, palette.text3);
    focus_ring(ui, response);
}

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

/// Shows the first of the texts that fits into the width that is left, the longest first, and nothing where none does:
/// half a sentence is worse. The longest is the tooltip of a shorter one.
pub fn fitting_label(ui: &mut Ui, texts: &[&str], style: TextStyle, colour: Color32) -> Option<Response> {
    let text = first_that_fits(ui, texts, &style, ui.available_width())?;
    let label = ui.add(Label::new(RichText::new(text).text_style(style).color(colour)).extend());
    Some(if text == texts[0] { label } else { label.on_hover_text(texts[0]) })
}

/// Writes a text at a place. Returns where it stands.
pub fn paint_text(
    ui: &Ui,
    at: Pos2,
    align: Align2,
    text: impl ToString,
    style: TextStyle,
    colour: Color32,
) -> Rect {
    ui.painter().text(at, align, text, style.resolve(ui.style()), colour)
}

/// One line of a text, which is cut off where the room ends.
pub fn cut_off(ui: &Ui, text: &str, style: TextStyle, colour: Color32, room: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), style.resolve(ui.style()), colour);
    job.wrap = TextWrapping::truncate_at_width(room);
    ui.painter().layout_job(job)
}

/// A row with words at the left and at the right, and what screen readers call it.
pub fn two_words(ui: &mut Ui, height: f32, name: &str, words: [(&str, TextStyle, Color32); 2]) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, name));
    let places = [(rect.left_center(), Align2::LEFT_CENTER), (rect.right_center(), Align2::RIGHT_CENTER)];
    for ((at, align), (text, style, colour)) in places.into_iter().zip(words) {
        paint_text(ui, at, align, text, style, colour);
    }
    response
}

/// Fills a rectangle with what `add` shows.
pub fn within<R>(ui: &mut Ui, rect: Rect, layout: Layout, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.scope_builder(UiBuilder::new().max_rect(rect).layout(layout), add).inner
}

/// The first of the texts that is no wider than the room.
pub fn first_that_fits<'a>(ui: &Ui, texts: &[&'a str], style: &TextStyle, room: f32) -> Option<&'a str> {
    let font = style.resolve(ui.style());
    let lay_out =
        |text: &str| ui.painter().layout_no_wrap(text.to_owned(), font.clone(), Color32::PLACEHOLDER);
    texts.iter().copied().find(|text| lay_out(text).size().x <= room)
}

#[cfg(test)]
mod tests {
    use egui::CentralPanel;

    use super::*;

    #[test]
    fn the_longest_text_that_fits_is_shown() {
        let shown = |width: f32| {
            let mut seen = None;
            let mut window = egui_painter::Headless::new(width, 40.0, 1.0);
            window.run(2, Vec::new(), |ui| {
                CentralPanel::default().show(ui, |ui| {
                    let texts = ["a rather long sentence of words", "a short one"];
                    let label = fitting_label(ui, &texts, TextStyle::Body, Color32::WHITE);
                    seen = label.map(|label| label.rect.width());
                });
            });
            seen
        };
        let [long, short] = [shown(390.0).unwrap(), shown(120.0).unwrap()];
        assert!(long > 150.0 && short < 120.0, "{long} {short}");
        assert_eq!(shown(20.0), None);
    }
}
