//! A section of the right panel that folds into one line; the line says its state in grey.

use egui::collapsing_header::CollapsingState;
use egui::{Align2, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::Icon;
use super::button::focus_ring;
use crate::style::theme;
use crate::style::theme::{size, space};

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

fn paint_head(ui: &Ui, rect: Rect, response: &egui::Response, title: &str, summary: &str, is_open: bool) {
    let palette = theme::palette(ui);
    let chevron =
        Rect::from_center_size(pos2(rect.left() + size::ICON / 2.0, rect.center().y), vec2(14.0, 14.0));
    let icon = if is_open { Icon::ChevronDown } else { Icon::ChevronRight };
    let colour = if response.hovered() { palette.text } else { palette.text2 };
    icon.paint_scaled(ui.painter(), chevron, colour, 0.8);
    let left = pos2(chevron.right() + TITLE_GAP, rect.center().y);
    let title_rect = ui.painter().text(
        left,
        Align2::LEFT_CENTER,
        title,
        TextStyle::Heading.resolve(ui.style()),
        palette.text,
    );
    let room = rect.right() - title_rect.right() - space::GROUP;
    let font = TextStyle::Small.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(summary.to_owned(), font, palette.text3);
    job.wrap = egui::text::TextWrapping::truncate_at_width(room.max(0.0));
    let galley = ui.painter().layout_job(job);
    let at = pos2(rect.right() - galley.size().x, rect.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, palette.text3);
    focus_ring(ui, response);
}
