//! What a demonstration shows and what to try, above the cameras' views, until it is closed.

use egui::{
    Align, Frame, Label, Layout as Direction, Margin, Panel, RichText, Role, Sense, Ui, WidgetInfo, vec2,
};

use crate::context::{Context, Request, Requests};
use crate::style::theme;
use crate::style::theme::{size, space};
use crate::widgets::{Icon, icon_button};

/// The sentences, as wide as the centre; nothing where there is nothing to explain.
pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let Some(text) = context.explanation else { return };
    let palette = theme::palette(ui);
    let frame = Frame::NONE.fill(palette.raised).inner_margin(Margin::symmetric(10, 6));
    Panel::top("explanation").resizable(false).show_separator_line(true).frame(frame).show(ui, |ui| {
        ui.with_layout(Direction::right_to_left(Align::Min), |ui| {
            if icon_button(ui, Icon::Close, "Close explanation", "Close").clicked() {
                requests.request(Request::CloseExplanation);
            }
            ui.with_layout(Direction::left_to_right(Align::Min), |ui| {
                let (rect, mark) = ui.allocate_exact_size(vec2(size::ICON, size::BUTTON), Sense::hover());
                mark.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Explanation"));
                Icon::Info.paint(ui.painter(), rect, palette.info);
                ui.add_space(space::ROW);
                ui.add(Label::new(RichText::new(text).color(palette.text)).wrap());
            });
        });
    });
}
