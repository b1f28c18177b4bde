//! What a demonstration shows and what to try.

use backlit_take::demonstration::Demonstration;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{Icon, icon_button};
use egui::{
    Align, Button, Frame, Label, Layout as Direction, Margin, Panel, RichText, Role, Sense, Ui, WidgetInfo,
    vec2,
};

use super::next;
use crate::context::{Context, Requests};

/// The sentences with a button for each thing to try, as wide as the centre; whether they are closed.
pub(super) fn ui(ui: &mut Ui, which: Demonstration, context: &Context<'_>, requests: &mut Requests) -> bool {
    let mut is_closed = false;
    let palette = theme::palette(ui);
    let frame = Frame::NONE.fill(palette.raised).inner_margin(Margin::symmetric(10, 6));
    Panel::top("explanation").resizable(false).show_separator_line(true).frame(frame).show(ui, |ui| {
        ui.with_layout(Direction::right_to_left(Align::Min), |ui| {
            is_closed = icon_button(ui, Icon::Close, "Close explanation", "Close").clicked();
            ui.with_layout(Direction::left_to_right(Align::Min), |ui| {
                let (rect, mark) = ui.allocate_exact_size(vec2(size::ICON, size::BUTTON), Sense::hover());
                mark.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Explanation"));
                Icon::Info.paint(ui.painter(), rect, palette.info);
                ui.add_space(space::ROW);
                ui.vertical(|ui| {
                    ui.add(Label::new(RichText::new(which.explanation()).color(palette.text)).wrap());
                    ui.horizontal_wrapped(|ui| {
                        for try_next in next::of(which) {
                            let button = ui.add(Button::new(try_next.text));
                            if button.on_hover_text(try_next.tooltip).clicked() {
                                try_next.request(which, context, requests);
                            }
                        }
                    });
                });
            });
        });
    });
    is_closed
}
