//! The Renderer section: which solid stands for a limb.

use backlit_document::edit::Edit;
use backlit_document::fit_words as words;
use backlit_tracking::body::Model;
use backlit_tracking::render::RendererKind;
use backlit_ui::style::format;
use backlit_ui::widgets::{SliderRow, checkbox, choice, hint, section};
use egui::Ui;

use crate::context::command::{Command, FitCommand};
use crate::context::{Context, FeatureRequest, Requests, command_button};

/// The command that switches to a renderer. The count of spheres is chosen by itself.
fn command_of(kind: RendererKind) -> Command {
    Command::Fit(FitCommand::Renderer(kind.plain()))
}

pub(crate) fn kind_box(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, width: f32) {
    let chosen = command_of(context.document().fit.renderer).text();
    let choices =
        RendererKind::ALL.map(command_of).map(|command| (command, command.text(), command.tooltip()));
    if let Some(command) = choice(ui, "Renderer", width, chosen, &choices) {
        requests.run(command);
    }
}

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, open: bool) {
    let fit = &*context.document().fit;
    let name = command_of(fit.renderer).text().to_lowercase();
    let ramps = words::ramps(fit);
    section(ui, "Renderer", &format!("{name}, {ramps}"), open, |ui| {
        kind_box(ui, context, requests, ui.available_width());
        let levels = context.document().model.spheres_by_level();
        if let RendererKind::SphereTree { spheres: None } = fit.renderer
            && !levels.is_empty()
        {
            sphere_levels(ui, context, &levels, requests);
        } else if let RendererKind::SphereTree { spheres } = fit.renderer {
            let mut count = spheres.unwrap_or(0) as f64;
            let tooltip = "Spheres per limb; 0 chooses the number by the limb’s length";
            let row = SliderRow::new("Spheres", "", 0, 0.0..=30.0, tooltip);
            let response = row.show(ui, &mut count);
            let drag = command_button::gesture(ui, "spheres", &response);
            if response.changed() {
                let count = count.round().max(0.0) as usize;
                let mut options = fit.clone();
                options.renderer = RendererKind::SphereTree { spheres: (count > 0).then_some(count) };
                let what = "Change sphere count".to_owned();
                requests.edits.push((Edit::SetFit { options: Box::new(options), what }, drag));
            }
        }
        let text = fit.renderer.pull();
        command_button::button(ui, context, requests, Command::Fit(FitCommand::MakeSpheres));
        hint(ui, text);
    });
}

/// The levels of a body of spheres: one is drawn in the views and the scene.
fn sphere_levels(ui: &mut Ui, context: &Context<'_>, levels: &[usize], requests: &mut Requests) {
    let model = &context.document().model;
    let mut settings = context.views;
    let finest = levels.len() - 1;
    let drawn = settings.drawn_level().min(finest);
    for (level, count) in levels.iter().enumerate() {
        let error = if level == finest {
            "finest".to_owned()
        } else {
            format!("{} off, mean", format::length(mean_error_m(model, level)))
        };
        let text = format!("Level {}: {count} spheres, {error}", level + 1);
        let row = ui.selectable_label(level == drawn, text).on_hover_text(
            "Draw this level in the views and the scene. The fit takes the coarsest one that is fine enough for a picture",
        );
        if row.clicked() {
            settings.sphere_level = (level < finest).then_some(level);
        }
    }
    checkbox(ui, &mut settings.spheres, "Outline spheres in views")
        .on_hover_text("A circle for each sphere, in the colour of its limb");
    if settings != context.views {
        requests.request(FeatureRequest::Views(settings));
    }
}

/// How much farther a level's spheres stand off the limbs than the finest level's, metres: the mean over the limbs.
fn mean_error_m(model: &Model, level: usize) -> f64 {
    let errors: Vec<f64> =
        model.limbs().iter().filter_map(|limb| Some(limb.coarser.get(level)?.error)).collect();
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}
