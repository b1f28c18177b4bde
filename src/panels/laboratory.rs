//! The laboratory: several ways to fit, from one start, side by side. It has the whole centre of its layout.

use egui::{CentralPanel, Frame, Margin, RichText, Ui};

use crate::format;
use crate::showing::{Intents, Showing};
use crate::theme::{self, space};

/// The panel.
pub(crate) fn ui(ui: &mut Ui, showing: &Showing<'_>, _intents: &mut Intents) {
    let palette = theme::palette(ui);
    let margin = Margin::symmetric(space::PAGE_MARGIN as i8, space::WIDGET as i8);
    let frame = Frame::NONE.fill(palette.panel).inner_margin(margin);
    CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.label(RichText::new("Renderer laboratory").text_style(theme::title()).color(palette.text));
        let Some(take) = &showing.session.take else { return };
        let frame = format::count(showing.selection.frame as i64);
        let text = format!("{}, frame {frame}: one start, one solver, several renderers.", take.name);
        ui.label(RichText::new(text).color(palette.text2));
    });
}
