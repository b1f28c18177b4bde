//! What will happen to the files that are over the window.

use backlit_take::dropped::Dropped;
use backlit_ui::style::theme::{self, size};
use backlit_ui::widgets::Icon;
use egui::{Align2, Area, Id, Margin, Order, RichText, Role, Sense, StrokeKind, Ui, WidgetInfo};

use crate::context::Context;

/// How far the window is dimmed.
const DIM: f32 = 0.6;
/// From the window's edge to the frame.
const INSET: f32 = 10.0;

/// Says what will happen, over everything: a card in the middle of the dimmed window.
pub(crate) fn ui(ui: &Ui, context: &Context<'_>, dropped: &Dropped) {
    let (what, name) = dropped.explanation(context.selection.frame);
    let lacks_take = dropped.needs_take() && context.session.take.is_none();
    let is_possible = !lacks_take && !matches!(dropped, Dropped::Unknown(..));
    let what = if lacks_take { "Open a take first".to_owned() } else { what };
    let palette = theme::palette(ui);
    let window = ui.ctx().content_rect();
    let layer = egui::LayerId::new(Order::Foreground, Id::unique("drop dim"));
    let painter = ui.ctx().layer_painter(layer);
    painter.rect_filled(window, 0.0, palette.well.gamma_multiply(DIM));
    let colour = if is_possible { palette.accent_text } else { palette.error };
    let stroke = egui::Stroke::new(2.0, colour);
    painter.rect_stroke(window.shrink(INSET), f32::from(size::WINDOW_RADIUS), stroke, StrokeKind::Inside);
    let area = Area::new(Id::unique("drop card")).order(Order::Tooltip).interactable(false);
    area.pivot(Align2::CENTER_CENTER).fixed_pos(window.center()).show(ui.ctx(), |ui| {
        let shown = palette.raised_frame(size::WINDOW_RADIUS, Margin::symmetric(28, 20)).show(ui, |ui| {
            ui.vertical_centered(|ui| {
                ui.set_width(380.0);
                if !is_possible {
                    let (rect, _) = ui.allocate_exact_size(egui::vec2(20.0, 20.0), Sense::hover());
                    Icon::Warning.paint(ui.painter(), rect, palette.error);
                }
                ui.label(RichText::new(&what).text_style(theme::title()).color(palette.text));
                ui.label(RichText::new(name).color(palette.text2));
            });
        });
        let node = ui.interact(shown.response.rect, ui.scope_id().with("card"), Sense::hover());
        node.widget_info(|| WidgetInfo::labeled(Role::Group, true, format!("Drop: {what}")));
    });
}
