//! The Solver section: every choice of the fit by itself.

use backlit_document::edit::Edit;
use backlit_document::fit_words::preset_like;
use backlit_document::{fit_words as words, likely_poses};
use backlit_tracking::body::Parameters;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::optimize::Method;
use backlit_tracking::render::Ramp;
use backlit_ui::style::theme;
use backlit_ui::widgets::{hint, named_row, number_field, section, segmented};
use egui::{RichText, Ui};

use super::stages;
use crate::context::command_button::preset_box;
use crate::context::{Context, Requests};

/// Width of the names in this section.
const NAME: f32 = 78.0;
/// Width of a field.
const FIELD: f32 = 72.0;

/// The Solver section, with what else it holds at its end.
pub(crate) fn ui(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    (open, edits_stages): (bool, &mut bool),
    more: impl FnOnce(&mut Ui, &mut Requests),
) {
    let fit = &*context.document().fit;
    let summary = preset_like(fit).map_or_else(|| "custom".to_owned(), |p| p.label().to_owned());
    section(ui, "Solver", &summary, open, |ui| {
        let mut options = fit.clone();
        ui.spacing_mut().item_spacing.y = 6.0;
        row(ui, "Preset", |ui| preset_box(ui, context, requests, ui.available_width()));
        row(ui, "Update", |ui| {
            let choices = [(Parameters::Tangent, "Tangent"), (Parameters::Raw, "Raw")];
            segmented(ui, &mut options.parameters, &choices).on_hover_text(
                "Tangent: three numbers a joint, steps that stay rotations. Raw: four quaternion coefficients, made a \
                 rotation again after each step, as in the report",
            );
        });
        row(ui, "Damping", |ui| {
            let choices = [(Method::LevenbergMarquardt, "LM"), (Method::GaussNewton, "Fixed")];
            segmented(ui, &mut options.method, &choices).on_hover_text(
                "LM adapts the damping and takes back steps that raise the cost; fixed is the report’s Gauss-Newton",
            );
            number_field(ui, "Damping", &mut options.damping, 3, "", 0.001, FIELD - 8.0).on_hover_text(
                "Holds steps back at first. 0: full Gauss-Newton steps, which may leap too far; 1 and more: short steps \
                 straight downhill, safe and slow",
            );
        });
        row(ui, "Stages", |ui| {
            let text = widths(&options);
            ui.label(RichText::new(text).monospace().color(theme::palette(ui).text))
                .on_hover_text("Outer width of the ramp, stage by stage");
            let text = if *edits_stages { "Done" } else { "Edit" };
            let edit = ui.add(egui::Button::new(text).small());
            edit.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{text} stages"))
            });
            *edits_stages ^=
                edit.on_hover_text("Widths, pixels, steps and tolerance of each stage").clicked();
        });
        if *edits_stages {
            stages::ui(ui, &mut options);
            // What somebody has written down is what is run.
            options.to_scale &= options.stages == fit.stages;
        }
        row(ui, "Pull back", |ui| {
            number_field(ui, "Proximal prior", &mut options.proximal_weight, 0, "", 1.0, FIELD)
                .on_hover_text("Proximal prior: pull towards the pose that the fit began with. 0: silhouettes alone decide; large values \
                     hold the body at its start");
            hint(ui, "to the start");
        });
        row(ui, "Untwist", |ui| {
            number_field(ui, "Twist prior", &mut options.rest_weight, 0, "", 1.0, FIELD)
                .on_hover_text("Twist prior: pull of every limb’s twist towards none, since silhouettes do not show it. 0: twists drift; \
                     large values turn limbs stiff");
            hint(ui, "to no twist");
        });
        row(ui, "Likely", |ui| {
            let mut weight = likely_poses::weight(&options).unwrap_or(0.0);
            let field = number_field(ui, "Likely poses", &mut weight, 0, "", 1.0, FIELD).on_hover_text(
                "Likely poses: pull towards poses that recorded people took, where silhouettes do not \
                 decide. 0: none; 3 \
                 helps with two cameras; large values hold the body in common poses. Arrows in the views show where it pulls",
            );
            if field.changed() {
                likely_poses::set_weight(&mut options, weight.max(0.0));
            }
            hint(ui, "poses of people");
        });
        row(ui, "Limits", |ui| {
            number_field(ui, "Joint limits", &mut options.limit_weight, 0, "", 5.0, FIELD)
                .on_hover_text("How hard joints are held within their limits. 0: knees may bend backwards; large values stop them exactly");
            hint(ui, "of the joints");
        });
        more(ui, requests);
        sanitise(&mut options);
        if options != *fit {
            let what = "Change solver".to_owned();
            requests.edit(Edit::SetFit { options: Box::new(options), what });
        }
    });
}

fn row(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    named_row(ui, name, NAME, contents);
}

fn sanitise(options: &mut FitOptions) {
    for value in [
        &mut options.damping,
        &mut options.proximal_weight,
        &mut options.rest_weight,
        &mut options.limit_weight,
    ] {
        *value = value.max(0.0);
    }
}

/// The ramps of the stages, as short as they can be said.
fn widths(options: &FitOptions) -> String {
    let words: Vec<String> = options.stages.iter().map(|stage| words::short_ramp(stage.ramp)).collect();
    let in_pixels = options.stages.iter().any(|stage| matches!(stage.ramp, Ramp::Distance { .. }));
    words.join("  ") + if in_pixels { " px" } else { "" }
}
