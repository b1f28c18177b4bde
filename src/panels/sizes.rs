//! The Size section: length and radius of the selected limb.

use egui::Ui;

use super::command::gesture;
use crate::edit::Edit;
use crate::format;
use crate::showing::{Intents, Showing};
use crate::widgets::{SliderRow, checkbox, section};

/// The Size section.
pub(super) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, open: bool) {
    let model = &showing.document().model;
    let limb = showing.selection.limb(model);
    let (length, radius) = (model.limbs()[limb].length, model.limbs()[limb].radius);
    let summary = format!("{} long, radius {}", format::metres(length), format::metres(radius));
    section(ui, "Size", &summary, open, |ui| {
        let id = ui.scope_id().with("both sides");
        let mut both = ui.data(|data| data.get_temp(id)).unwrap_or(true);
        let mut sizes = [length, radius];
        let rows = [
            ("Length", 0.02..=0.8, "Length of the limb, joint to joint"),
            ("Radius", 0.01..=0.25, "Radius of the limb"),
        ];
        let mut change = None;
        for (index, (name, range, tooltip)) in rows.into_iter().enumerate() {
            let row = SliderRow {
                name,
                unit: " m",
                decimals: 3,
                origin: *range.start(),
                range,
                limits: None,
                is_held: false,
                tooltip,
            };
            let response = row.show(ui, &mut sizes[index]);
            let drag = gesture(ui, ("size", index), &response);
            if response.changed() {
                change = Some(drag);
            }
        }
        if checkbox(ui, &mut both, "Both sides").changed() {
            ui.data_mut(|data| data.insert_temp(id, both));
        }
        if let Some(drag) = change {
            let [length, radius] = sizes;
            intents.edits.push((Edit::SetSize { limb, length, radius, both_sides: both }, drag));
        }
    });
}
