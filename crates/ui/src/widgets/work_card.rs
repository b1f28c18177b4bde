//! A card about one piece of long work: what it is about, how far it is or what came of it, and buttons that stop it or begin it again.

use egui::{Align2, Color32, Rect, RichText, Role, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::{button_row, hint, paint_camera_badge, paint_text, primary_button, text_button};
use crate::style::theme::{self, size, space};

/// Height of the bar that grows.
const BAR: f32 = 3.0;
/// Height of what stands below the results.
const BELOW: f32 = 64.0;

/// What was clicked below a piece of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorkAnswer {
    /// The work is to stop.
    Stop,
    /// It is to be done again, or for the first time.
    Again,
    /// The card is to be closed.
    Close,
}

/// The width of the card, as far as there is room, its title and what it is about.
pub fn work_head(ui: &mut Ui, width: f32, title: &str, about: &str) {
    ui.set_width(width.min(ui.ctx().content_rect().width() - 4.0 * space::GUTTER_MARGIN));
    ui.spacing_mut().item_spacing.y = space::ROW;
    ui.label(RichText::new(title).text_style(theme::title()));
    ui.label(RichText::new(about).color(theme::palette(ui).text2));
    ui.add_space(space::WIDGET);
}

/// What is being done, and how much of how much.
pub fn work_progress(ui: &mut Ui, text: impl Into<String>, [done, all]: [usize; 2]) {
    hint(ui, text);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), BAR), Sense::hover());
    let palette = theme::palette(ui);
    ui.painter().rect_filled(rect, 0.0, palette.widget);
    let share = done as f32 / all.max(1) as f32;
    let bar = Rect::from_min_size(rect.min, vec2(rect.width() * share, BAR));
    ui.painter().rect_filled(bar, 0.0, palette.accent);
}

/// What came of it, scrolled where the window is too low.
pub fn work_results(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let room = ui.ctx().content_rect().bottom() - ui.cursor().top() - BELOW;
    let scroll = ScrollArea::vertical().max_height(room).min_scrolled_height(room);
    scroll.auto_shrink([false, true]).show(ui, contents);
}

/// A row of results: badges of cameras, words, and numbers that end at `columns` from the right edge. Words without a badge stand below
/// those of a row with one.
pub fn work_row(
    ui: &mut Ui,
    (cameras, words): (&[usize], &str),
    (numbers, columns): (&[String], &[f32]),
    (style, colour): (TextStyle, Color32),
) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), size::ROW), Sense::hover());
    let said = format!("{words}: {}", numbers.join(", "));
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, said.as_str()));
    let mut left = rect.left_center();
    for &camera in cameras {
        let middle = left + vec2(size::BADGE / 2.0, 0.0);
        let badge = Rect::from_center_size(middle, vec2(size::BADGE, size::BADGE));
        paint_camera_badge(ui.painter(), badge, camera);
        left.x += size::BADGE + space::ROW;
    }
    if cameras.is_empty() && style == TextStyle::Body {
        left.x += size::BADGE + space::ROW;
    }
    paint_text(ui, left, Align2::LEFT_CENTER, words, style.clone(), colour);
    for (number, from_right) in numbers.iter().zip(columns) {
        let at = pos2(rect.right() - from_right, rect.center().y);
        paint_text(ui, at, Align2::RIGHT_CENTER, number, style.clone(), colour);
    }
}

/// *Cancel* while it is busy; else *Close*, the button that begins it, which stands out where results are of `before`, and what `also` adds.
pub fn work_buttons(
    ui: &mut Ui,
    is_busy: bool,
    (again, before): (&str, bool),
    also: impl FnOnce(&mut Ui),
) -> Option<WorkAnswer> {
    ui.add_space(space::ROW);
    button_row(ui, |ui| {
        if is_busy {
            return text_button(ui, "Cancel").clicked().then_some(WorkAnswer::Stop);
        }
        let close = text_button(ui, "Close").clicked().then_some(WorkAnswer::Close);
        let again = if before { primary_button(ui, again) } else { text_button(ui, again) };
        also(ui);
        close.or(again.clicked().then_some(WorkAnswer::Again))
    })
}
