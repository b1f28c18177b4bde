//! The cards of the Help menu: all messages since the start; version, licence and source of the method.

use backlit_ui::style::theme::{self, size, space, title};
use backlit_ui::widgets::{Icon, card, hint, primary_button, text_button};
use egui::{Align, Button, Label, Layout as Direction, RichText, ScrollArea, Sense, Ui, WidgetInfo, vec2};

use crate::context::notices::{Notices, Severity};
use crate::context::{DesktopRequest, Requests, ShellRequest};

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

/// The report whose method this is.
const CITATION: &str = "P. Kaimakis, “Markerless Motion Capture”, University of Cambridge, 2004.";
/// The same for a bibliography.
const BIBTEX: &str = "\
@techreport{kaimakis2004markerless,
  author      = {Kaimakis, P.},
  title       = {Markerless Motion Capture},
  institution = {University of Cambridge},
  year        = {2004}
}
";
/// Pages that belong to it.
const LINKS: [(&str, &str); 3] = [
    ("MIT licence", "https://opensource.org/license/mit"),
    ("Apache licence 2.0", "https://www.apache.org/licenses/LICENSE-2.0"),
    ("egui, the library of the window", "https://www.egui.rs"),
];

/// Shows what the program is and says whether that stays open.
pub(crate) fn about(ui: &Ui, requests: &mut Requests) -> bool {
    let mut close = false;
    let modal = card(ui.ctx(), "about").show(ui.ctx(), |ui| {
        let palette = theme::palette(ui);
        ui.set_width(470.0);
        ui.label(RichText::new("Backlit").text_style(title()));
        let version = format!("Version {}", env!("CARGO_PKG_VERSION"));
        ui.label(RichText::new(&version).monospace().color(palette.text2));
        ui.add_space(space::WIDGET);
        ui.label("Fits an articulated body to its silhouettes, and shows how.");
        ui.add_space(space::GROUP);
        hint(ui, "The method follows");
        ui.label(CITATION);
        ui.horizontal(|ui| {
            if text_button(ui, "Copy citation").on_hover_text("As it stands above").clicked() {
                requests.request(ShellRequest::Copy("citation", CITATION.to_owned()));
            }
            if text_button(ui, "Copy BibTeX").on_hover_text(BIBTEX).clicked() {
                requests.request(ShellRequest::Copy("BibTeX entry", BIBTEX.to_owned()));
            }
        });
        ui.add_space(space::GROUP);
        hint(ui, "Licence");
        ui.label("Free software: use, change and pass it on under the MIT licence or the Apache licence 2.0, as you like.");
        ui.add_space(space::ROW);
        for (text, address) in LINKS {
            if ui.link(text).on_hover_text(address).clicked() {
                requests.request(DesktopRequest::OpenOutside(address.to_owned()));
            }
        }
        ui.add_space(space::GROUP);
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            close = primary_button(ui, "Close").clicked();
            let system = format!("{version}, {} {}", std::env::consts::OS, std::env::consts::ARCH);
            if text_button(ui, "Copy version").on_hover_text(&system).clicked() {
                requests.request(ShellRequest::Copy("version", format!("Backlit {}", system.to_lowercase())));
            }
        });
    });
    !(close || modal.should_close())
}
