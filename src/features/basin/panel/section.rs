//! The Basin section of the right panel: what is tried, and the buttons that begin it.

use backlit_document::fit_words as words;
use backlit_runs::basin::{Angle, ComparedFit, ComparedMethod, MOST_COMPARED};
use backlit_tracking::body::Model;
use backlit_tracking::render::RendererKind;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{run_style, size, space};
use backlit_ui::widgets::{Icon, hint, icon_button, named_row, number_field, section, segmented};
use backlit_ui::widgets::{choice, text_button};
use egui::{ComboBox, RichText, TextEdit, Ui, vec2};

use super::run_or_cancel;
use crate::context::command::{BasinView, Command, WindowCommand};
use crate::context::command_button::named_button;
use crate::context::pane::Pane;
use crate::context::{Context, Requests};
use crate::features::basin::settings::MOST_STARTS;
use crate::features::basin::{Basin, BasinResults, BasinSettings, MapDirection, Reference};

/// Width of the names in this section.
const NAME: f32 = 64.0;
/// Width of a fit's colour, and of the box of angles.
const SWATCH: f32 = 10.0;
const ANGLE: f32 = 94.0;
const FIELD: f32 = 62.0;

impl Basin {
    pub(crate) fn section(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        section(ui, "Basin", &summary(&self.results), false, |ui| {
            let mut settings = self.preferences.settings.clone();
            ui.spacing_mut().item_spacing.y = 6.0;
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 6.0;
                run_or_cancel(ui, self, context, requests, BasinView::Angles);
                if self.results.running.is_none() {
                    run_or_cancel(ui, self, context, requests, BasinView::Map);
                }
                let tile = Command::Window(WindowCommand::TogglePane(Pane::Basin));
                let text = if context.shows(Pane::Basin) { "Close tile" } else { "Open tile" };
                named_button(ui, context, requests, tile, text);
            });
            starts(ui, context, &mut settings);
            compared(ui, context, &mut settings);
            map(ui, context, &mut settings);
            if settings != self.preferences.settings {
                self.set(settings);
            }
        });
    }
}

fn summary(basin: &BasinResults) -> String {
    if let Some(running) = basin.running {
        return super::progress_text(running);
    }
    let Some(result) = &basin.angles else {
        return if basin.map.is_some() { "map".to_owned() } else { "not run".to_owned() };
    };
    let first = result.report.choices.first();
    let half = first.and_then(|choice| {
        choice.levels.iter().rfind(|level| level.rate.success.is_some_and(|success| success >= 0.5))
    });
    half.map_or_else(
        || "under half succeed".to_owned(),
        |level| format!("half or more succeed up to {}°", level.level.degrees),
    )
}

fn row(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    named_row(ui, name, NAME, contents);
}

fn starts(ui: &mut Ui, context: &Context<'_>, settings: &mut BasinSettings) {
    let has_truth = context.session.take.as_ref().is_some_and(|take| take.take().reference().is_some());
    row(ui, "About", |ui| {
        let choices = [(Reference::Pose, "This pose"), (Reference::Truth, "Truth")];
        ui.add_enabled_ui(has_truth || settings.reference == Reference::Truth, |ui| {
            segmented(ui, &mut settings.reference, &choices).on_hover_text(
                "The pose that starts are drawn around. This pose: a fit succeeds where it ends like the fit from \
                 this pose. Truth: where it ends at the true pose of the take",
            );
        })
        .response
        .on_disabled_hover_text("The take has no true pose of this frame: starts are drawn around the pose on the \
                                 screen");
    });
    let model = &context.document().model;
    let held = &model.limbs()[context.selection.limb(model)].name;
    row(ui, "Turn", |ui| {
        segmented(ui, &mut settings.only_held, &[(false, "All joints"), (true, "Held joint")])
            .on_hover_text(format!("Which joints of a start are turned: every one, or the {held} alone"));
    });
    let problem = settings.levels().err();
    list(ui, "By", "Angles", &mut settings.angles, "°", "How far joints are turned, about random axes");
    list(
        ui,
        "Root",
        "Moves of the root",
        &mut settings.root_cm,
        "cm",
        "How far the root is moved: one number for each angle, the last one for all that follow",
    );
    if let Some(problem) = problem {
        let text = RichText::new(format!("{problem}.")).small().color(theme::palette(ui).warn);
        ui.add(egui::Label::new(text).wrap());
    }
    row(ui, "Starts", |ui| {
        let mut starts = settings.starts as f64;
        number_field(ui, "Starts of each angle", &mut starts, 0, "", 1.0, FIELD)
            .on_hover_text("How many starts of each angle; more make the bars shorter");
        settings.starts = (starts.round() as usize).clamp(1, MOST_STARTS);
        hint(ui, "seed");
        let mut seed = settings.seed as f64;
        number_field(ui, "Seed", &mut seed, 0, "", 1.0, FIELD)
            .on_hover_text("The same seed draws the same starts");
        settings.seed = seed.clamp(0.0, 1e9).round() as u64;
    });
    row(ui, "Within", |ui| {
        number_field(ui, "Limit of success", &mut settings.success_mm, 0, " mm", 1.0, FIELD)
            .on_hover_text("A fit succeeds when its root and leaf joints end less than this off on average");
        settings.success_mm = settings.success_mm.clamp(1.0, 1000.0);
    });
}

fn list(ui: &mut Ui, name: &str, label: &str, text: &mut String, unit_text: &str, tooltip: &str) {
    row(ui, name, |ui| {
        let width = ui.available_width() - 28.0;
        let field = TextEdit::singleline(text).desired_width(width - 8.0).font(egui::TextStyle::Monospace);
        ui.name_inputs(label, |ui| ui.add(field)).on_hover_text(tooltip);
        hint(ui, unit_text);
    });
}

/// The fits that are compared: the current choices, and up to three more.
fn compared(ui: &mut Ui, context: &Context<'_>, settings: &mut BasinSettings) {
    let palette = theme::palette(ui);
    row(ui, "Fits", |ui| {
        swatch(ui, 0);
        let fit = &context.document().fit;
        let renderer = fit.renderer.label().to_lowercase();
        let text = format!("{}, {renderer}", words::fit_name(fit));
        ui.add(egui::Label::new(RichText::new(text).color(palette.text)).truncate())
            .on_hover_text("The current choices of renderer and solver");
    });
    let mut removed = None;
    for (index, other) in settings.compared.iter_mut().enumerate() {
        // Two rows: side by side their names are wider than the panel.
        row(ui, "", |ui| {
            swatch(ui, index + 1);
            let width = ui.available_width() - size::BUTTON - 2.0 * space::ROW;
            let methods = ComparedMethod::ALL
                .map(|method| (method, method.text(), format!("Compare with {}", method.text())));
            let name = format!("Compared fit {}", index + 1);
            if let Some(method) = choice(ui, &name, width, other.method.text(), &methods) {
                other.method = method;
            }
            let label = format!("Remove compared fit {}", index + 1);
            if icon_button(ui, Icon::Close, &label, "Remove this fit from the comparison").clicked() {
                removed = Some(index);
            }
        });
        row(ui, "", |ui| {
            ui.add_space(SWATCH + ui.spacing().item_spacing.x);
            let width = ui.available_width() - size::BUTTON - 2.0 * space::ROW;
            let renderers = RendererKind::ALL.map(|kind| (kind, kind.label(), String::new()));
            let name = format!("Renderer of compared fit {}", index + 1);
            if let Some(kind) = choice(ui, &name, width, other.renderer.label(), &renderers) {
                other.renderer = kind;
            }
        });
    }
    if let Some(index) = removed {
        settings.compared.remove(index);
    }
    if settings.compared.len() < MOST_COMPARED {
        row(ui, "", |ui| {
            let button = text_button(ui, "Compare with…");
            if button.on_hover_text("Try the same starts with another preset or renderer too").clicked() {
                settings.compared.push(ComparedFit::next(&context.document().fit, &settings.compared));
            }
        });
    }
}

fn swatch(ui: &mut Ui, index: usize) {
    let (rect, _) = ui.allocate_exact_size(vec2(SWATCH, size::ROW), egui::Sense::hover());
    let colour = run_style(index).colour;
    ui.painter().circle_filled(rect.center(), 4.0, colour);
}

fn map(ui: &mut Ui, context: &Context<'_>, settings: &mut BasinSettings) {
    let model = &context.document().model;
    for (direction, name) in settings.directions.iter_mut().zip(["Across", "Up"]) {
        row(ui, name, |ui| {
            let width = ui.available_width() - ANGLE - 2.0 * space::ROW;
            joint(ui, name, width, direction, model);
            let angles = Angle::ALL.map(|angle| (angle, angle.name(), String::new()));
            let label = format!("Angle {}", name.to_lowercase());
            if let Some(angle) = choice(ui, &label, ANGLE, direction.angle.name(), &angles) {
                direction.angle = angle;
            }
        });
    }
    row(ui, "Map", |ui| {
        number_field(ui, "Farthest of the map", &mut settings.map_degrees, 0, "°", 1.0, FIELD - 8.0)
            .on_hover_text("How far the map turns the two angles to either side");
        settings.map_degrees = settings.map_degrees.clamp(1.0, 180.0);
        hint(ui, "to either side");
    });
    row(ui, "Cells", |ui| {
        let cells = [(7, "7"), (11, "11"), (15, "15"), (21, "21")];
        segmented(ui, &mut settings.cells, &cells).on_hover_text("Cells across and up; each is a fit");
    });
}

/// The box of a direction's joint.
fn joint(ui: &mut Ui, name: &str, width: f32, direction: &mut MapDirection, model: &Model) {
    let name_of = |rotation: usize| {
        model.rotation_owners().get(rotation).map(|limb| model.limbs()[*limb].name.as_str())
    };
    // A joint that was chosen for another body is the held one here.
    let known = direction.joint.as_deref().filter(|name| model.limb_index(name).is_some());
    let chosen = known.unwrap_or("held joint").to_owned();
    // A box cuts its words at the end of its row, not at its own: the row ends where it does.
    let row = egui::Layout::left_to_right(egui::Align::Center);
    ui.allocate_ui_with_layout(vec2(width, size::BUTTON), row, |ui| {
        ui.name_inputs(format!("Joint {}", name.to_lowercase()), |ui| {
            let joints = ComboBox::from_id_salt(("map joint", name)).width(width).truncate();
            joints.selected_text(chosen).show_ui(ui, |ui| {
                ui.selectable_value(&mut direction.joint, None, "held joint");
                for text in (0..model.rotation_count()).filter_map(name_of) {
                    ui.selectable_value(&mut direction.joint, Some(text.to_owned()), text);
                }
            });
        });
    });
}
