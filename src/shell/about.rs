//! About: version, licence, and the method's source to be cited.

use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space, title};
use backlit_ui::widgets::{card, primary_button};
use egui::{Align, Button, Layout as Direction, RichText, Ui, vec2};

use crate::context::{DesktopRequest, Requests, ShellRequest};

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
        ui.label(RichText::new("The method follows").small().color(palette.text3));
        ui.label(CITATION);
        ui.horizontal(|ui| {
            if text_button(ui, "Copy citation", "As it stands above") {
                requests.request(ShellRequest::Copy("citation", CITATION.to_owned()));
            }
            if text_button(ui, "Copy BibTeX", BIBTEX) {
                requests.request(ShellRequest::Copy("BibTeX entry", BIBTEX.to_owned()));
            }
        });
        ui.add_space(space::GROUP);
        ui.label(RichText::new("Licence").small().color(palette.text3));
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
            if text_button(ui, "Copy version", &system) {
                requests.request(ShellRequest::Copy("version", format!("Backlit {}", system.to_lowercase())));
            }
        });
    });
    !(close || modal.should_close())
}

fn text_button(ui: &mut Ui, text: &str, tooltip: &str) -> bool {
    ui.add(Button::new(text).min_size(vec2(0.0, size::BUTTON))).on_hover_text(tooltip).clicked()
}
