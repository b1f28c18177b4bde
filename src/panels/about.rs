//! About, and the messages of this start.

use egui::{Id, Modal, RichText, ScrollArea, Ui};

use crate::notices::{Notices, Severity};
use crate::theme::{self, title};

/// Shows what the program is and says whether that stays open.
pub(crate) fn about(ui: &Ui) -> bool {
    let mut close = false;
    let modal = Modal::new(Id::unique("about")).show(ui.ctx(), |ui| {
        let palette = theme::palette(ui);
        ui.set_width(440.0);
        ui.label(RichText::new("Backlit").text_style(title()));
        ui.label(
            RichText::new(concat!("Version ", env!("CARGO_PKG_VERSION"))).monospace().color(palette.text2),
        );
        ui.add_space(8.0);
        ui.label("Fits an articulated body to its silhouettes, and shows how.");
        ui.add_space(8.0);
        ui.label(RichText::new("The method follows").color(palette.text2));
        ui.label("P. Kaimakis, “Markerless Motion Capture”, University of Cambridge, 2004.");
        ui.add_space(8.0);
        ui.label(RichText::new("Free software, under the MIT licence or the Apache licence 2.0.").small());
        ui.add_space(8.0);
        close = ui.button("Close").clicked();
    });
    !(close || modal.should_close())
}

/// Shows all messages and says whether they stay open.
pub(crate) fn messages(ui: &Ui, notices: &Notices) -> bool {
    let mut close = false;
    let modal = Modal::new(Id::unique("messages")).show(ui.ctx(), |ui| {
        let palette = theme::palette(ui);
        ui.set_width(560.0);
        ui.heading("Messages");
        ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
            for notice in notices.all().iter().rev() {
                let (word, colour) = match notice.severity {
                    Severity::Info => ("", palette.text),
                    Severity::Error => ("Error: ", palette.error),
                };
                ui.label(RichText::new(format!("{word}{}", notice.text)).color(colour));
            }
            if notices.all().is_empty() {
                ui.label(RichText::new("Nothing was said yet").color(palette.text3));
            }
        });
        close = ui.button("Close").clicked();
    });
    !(close || modal.should_close())
}
