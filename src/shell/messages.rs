//! All that was said since the start.

use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space, title};
use backlit_ui::widgets::{Icon, card, primary_button};
use egui::{Align, Button, Label, Layout as Direction, RichText, ScrollArea, Sense, Ui, WidgetInfo, vec2};

use crate::context::notices::{Notices, Severity};
use crate::context::{Requests, ShellRequest};

/// Shows all messages, the newest first, and says whether they stay open.
pub(crate) fn messages(ui: &Ui, notices: &Notices, requests: &mut Requests) -> bool {
    let mut close = false;
    let modal = card(ui.ctx(), "messages").show(ui.ctx(), |ui| {
        let palette = theme::palette(ui);
        ui.set_width(580.0);
        ui.label(RichText::new("Messages").text_style(title()));
        ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
            for notice in notices.all().iter().rev() {
                let (icon, word, colour) = match notice.severity {
                    Severity::Info => (Icon::Info, "Note", palette.info),
                    Severity::Error => (Icon::Warning, "Error", palette.error),
                };
                ui.horizontal_top(|ui| {
                    let (rect, mark) = ui.allocate_exact_size(vec2(size::ICON, size::ROW), Sense::hover());
                    mark.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, word));
                    icon.paint_scaled(ui.painter(), rect, colour, 0.85);
                    let age = RichText::new(age(notices.now - notice.said)).monospace().color(palette.text3);
                    ui.allocate_ui_with_layout(
                        vec2(84.0, size::ROW),
                        Direction::left_to_right(Align::Center),
                        |ui| ui.label(age),
                    );
                    ui.add_space(space::ROW);
                    ui.add(Label::new(RichText::new(&notice.text).color(palette.text)).wrap());
                });
            }
            if notices.all().is_empty() {
                ui.label(RichText::new("No messages yet").color(palette.text3));
            }
        });
        ui.add_space(space::WIDGET);
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            close = primary_button(ui, "Close").clicked();
            let copy = Button::new("Copy all").min_size(vec2(0.0, size::BUTTON));
            if ui.add_enabled(!notices.all().is_empty(), copy).clicked() {
                let texts: Vec<&str> = notices.all().iter().map(|notice| notice.text.as_str()).collect();
                requests.request(ShellRequest::Copy("messages", texts.join("\n")));
            }
        });
    });
    !(close || modal.should_close())
}

/// How long ago something was, in words that do not change all the time.
fn age(seconds: f64) -> String {
    match seconds {
        s if s < 60.0 => "just now".to_owned(),
        s if s < 3600.0 => format!("{:.0} min ago", (s / 60.0).floor()),
        s => format!("{:.0} h ago", (s / 3600.0).floor()),
    }
}
