//! The Size section: length and radius of the selected limb, and the scale of the whole body.

use backlit_document::edit::Edit;
use backlit_tracking::body::Model;
use backlit_ui::style::format;
use backlit_ui::style::theme::space;
use backlit_ui::widgets::{SliderRow, checkbox, section};
use egui::Ui;

use super::dragged::{LENGTHS_M, RADII_M};
use crate::context::command_button::gesture;
use crate::context::{Context, FeatureRequest, Requests, SessionRequest};

/// Ends of the slider of the whole body, in percent of the take's own body.
const SCALES: std::ops::RangeInclusive<f64> = 60.0..=150.0;

pub(super) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, open: bool) {
    let model = &context.document().model;
    let limb = context.selection.sized_limb(model);
    let (length, radius) = (model.limbs()[limb].length, model.limbs()[limb].radius);
    let summary = format!("{} long, radius {}", format::metres(length), format::metres(radius));
    section(ui, "Size", &summary, open, |ui| {
        parts(ui, context, requests, limb);
        let mut settings = context.views;
        let mut sizes = [length, radius];
        let rows = [
            ("Length", LENGTHS_M, "Length of the limb, joint to joint"),
            ("Radius", RADII_M, "Radius of the limb"),
        ];
        let mut change = None;
        for (index, (name, range, tooltip)) in rows.into_iter().enumerate() {
            let response = SliderRow::new(name, " m", 3, range, tooltip).show(ui, &mut sizes[index]);
            let drag = gesture(ui, ("size", index), &response);
            if response.changed() {
                change = Some(drag);
            }
        }
        if let Some(drag) = change {
            let [length, radius] = sizes;
            let both_sides = settings.both_sides;
            requests.edits.push((Edit::SetSize { limb, length, radius, both_sides }, drag));
        }
        scale(ui, context, requests);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = space::GROUP;
            let both = checkbox(ui, &mut settings.both_sides, "Both sides")
                .on_hover_text("Change the limb on the other side of the body too");
            let handles = checkbox(ui, &mut settings.size_handles, "Handles in views").on_hover_text(
                "Drag the diamonds in a view: length at the limb’s end, radius at its outline   E",
            );
            if both.changed() || handles.changed() {
                requests.request(FeatureRequest::Views(settings));
            }
        });
    });
}

/// The limbs that turn with the selected joint, if there are several: whose size is it?
fn parts(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, limb: usize) {
    let model = &context.document().model;
    let rotation = model.limbs()[limb].rotation;
    let parts: Vec<usize> =
        (0..model.limbs().len()).filter(|part| model.limbs()[*part].rotation == rotation).collect();
    if parts.len() < 2 {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(space::ROW, space::ROW);
        for part in parts {
            let name = format::capitalised(&model.limbs()[part].name);
            let label = ui.selectable_label(part == limb, name);
            if label.on_hover_text("These limbs turn together; each has its own size").clicked() {
                requests.request(SessionRequest::Part(part));
            }
        }
    });
    ui.add_space(space::ROW);
}

/// The whole body, compared with that of the take.
fn scale(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let Some(take) = &context.session.take else { return };
    let before = 100.0 * total_length(&context.document().model) / total_length(take.take().model());
    let mut percent = before;
    let tooltip = "All lengths and radii together; 100 % is as long as the take’s own body";
    let row = SliderRow { origin: 100.0, ..SliderRow::new("Body", " %", 1, SCALES, tooltip) };
    let response = row.show(ui, &mut percent);
    let drag = gesture(ui, "scale", &response);
    if response.changed() && percent.is_finite() && percent > 0.0 {
        requests.edits.push((Edit::ScaleBody { factor: percent / before }, drag));
    }
}

fn total_length(model: &Model) -> f64 {
    model.limbs().iter().map(|limb| limb.length).sum()
}
