//! Notices as cards, bottom right above the timeline.

use backlit_ui::style::theme::{self, size, space};
use backlit_ui::widgets::{Icon, icon_button, text_button};
use egui::{Align, Area, Frame, Id, Layout as Direction, Margin, Order, RichText, Role, Sense, Ui, vec2};

use crate::context::command::{Command, HistoryCommand, WindowCommand};
use crate::context::notices::{Notice, Severity};
use crate::context::{Context, Requests, ShellRequest};

/// The cards, upwards from the corner `bottom_right`. Returns the cards under the pointer.
pub(crate) fn ui(
    ui: &Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    bottom_right: egui::Pos2,
) -> Vec<u64> {
    let mut held = Vec::new();
    let mut corner = bottom_right - vec2(space::GROUP, space::GROUP);
    let cards: Vec<&Notice> = context.notices.cards().collect();
    for notice in cards.into_iter().rev() {
        let area = Area::new(Id::unique(("notice", notice.id)))
            .order(Order::Foreground)
            .pivot(egui::Align2::RIGHT_BOTTOM)
            .fixed_pos(corner);
        let response = area.show(ui.ctx(), |ui| card(ui, notice, requests)).response;
        if response.contains_pointer() {
            held.push(notice.id);
        }
        corner.y = response.rect.top() - space::WIDGET;
    }
    held
}

/// A layout is taken back by its own command, which is *Undo* here.
fn word(command: Command) -> &'static str {
    if command == Command::Window(WindowCommand::RestoreLayout) {
        Command::History(HistoryCommand::Undo).text()
    } else {
        command.text()
    }
}

fn card(ui: &mut Ui, notice: &Notice, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let (edge, icon, colour) = match notice.severity {
        Severity::Info => (palette.line2, Icon::Info, palette.info),
        Severity::Error => (palette.error, Icon::Warning, palette.error),
    };
    let frame = palette.raised_frame(size::BUTTON_RADIUS, Margin::same(10));
    frame.stroke(egui::Stroke::new(size::HAIRLINE, edge)).show(ui, |ui| {
        ui.set_width(size::NOTICE - 20.0);
        ui.horizontal_top(|ui| {
            let (rect, mark) = ui.allocate_exact_size(vec2(size::ICON, size::BUTTON), Sense::hover());
            mark.widget_info(|| egui::WidgetInfo::labeled(Role::Image, true, "Notice"));
            icon.paint(ui.painter(), rect, colour);
            ui.with_layout(Direction::right_to_left(Align::Min), |ui| {
                if icon_button(ui, Icon::Close, "Close notice", "Close").clicked() {
                    requests.request(ShellRequest::CloseNotice(notice.id));
                }
                if let Some(command) = notice.command
                    && text_button(ui, word(command)).clicked()
                {
                    requests.run(command);
                    requests.request(ShellRequest::CloseNotice(notice.id));
                }
                ui.with_layout(Direction::left_to_right(Align::Min), |ui| {
                    let text = egui::Label::new(RichText::new(&notice.text).color(palette.text)).wrap();
                    // The first line stands level with the icon and the buttons.
                    let line = ui.text_style_height(&egui::TextStyle::Body);
                    let above = (0.5 * (size::BUTTON - line)).round() as i8;
                    Frame::NONE
                        .inner_margin(Margin { top: above, ..Margin::ZERO })
                        .show(ui, |ui| ui.add(text));
                });
            });
        });
    });
}
