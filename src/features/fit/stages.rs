//! The stages of the annealing, a row each: how wide the ramp is, how many pixels count, and when a stage ends.

use backlit_document::fit_words::short_ramp;
use backlit_tracking::fit::{FitOptions, Stage};
use backlit_tracking::render::Ramp;
use backlit_ui::style::theme::{self, space};
use backlit_ui::widgets::{hint, number_field, paint_text};
use egui::{Align2, Button, RichText, TextStyle, Ui, vec2};

/// Width of a stage's number, and of a field.
const NUMBER: f32 = 14.0;
const FIELD: f32 = 50.0;
/// Widest ramp, widest stride, most steps and largest tolerance that can be typed.
const WIDEST_PX: f64 = 500.0;
const WIDEST_STRIDE: f64 = 16.0;
const MOST_STEPS: f64 = 1000.0;
const LARGEST_TOLERANCE: f64 = 50.0;
/// Most stages of a fit.
const MOST_STAGES: usize = 12;

/// Whether stages follow the person's size, in words.
const TO_SCALE: &str =
    "A fit suits these to the person’s size in the picture. Once edited, they are run as they stand.";
const AS_THEY_ARE: &str = "Run as they stand, whatever the person’s size. The preset brings the others back.";

/// The columns, with what each does and what happens at both ends.
const COLUMNS: [(&str, &str); 4] = [
    (
        "ramp px",
        "How far outside the body a pixel still pulls. Wide: starts from far off succeed, but details blur. \
         Narrow: exact, but only from near. Thesis and half ramps are as wide as their limb",
    ),
    (
        "every px",
        "Which pixels count. 1 is all of them, exact and slow; 4 is one in sixteen, quick and coarse",
    ),
    (
        "steps",
        "Most steps of the stage. 0 leaves the stage out; more than it needs costs nothing, since it ends by itself",
    ),
    (
        "ends below",
        "The stage ends when a step lowers the cost by less than this. 0 runs all steps; large values end it early and \
         leave it inexact",
    ),
];

/// The table, and a row for a stage more.
pub(super) fn ui(ui: &mut Ui, options: &mut FitOptions) {
    ui.spacing_mut().item_spacing = vec2(space::ROW, 3.0);
    ui.horizontal(|ui| {
        cell(ui, NUMBER, "", "");
        for (name, explanation) in COLUMNS {
            cell(ui, FIELD, name, explanation);
        }
    });
    let mut gone = None;
    let count = options.stages.len();
    for (index, stage) in options.stages.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            cell(ui, NUMBER, &(index + 1).to_string(), "");
            fields(ui, index, stage);
            let remove = ui.add_enabled(count > 1, Button::new("−").small());
            let name = format!("Remove stage {}", index + 1);
            remove.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, count > 1, &name));
            if remove.on_hover_text(&name).on_disabled_hover_text("A fit needs at least one stage").clicked()
            {
                gone = Some(index);
            }
        });
    }
    if let Some(index) = gone {
        options.stages.remove(index);
    }
    hint(ui, if options.to_scale { TO_SCALE } else { AS_THEY_ARE });
    let may_add = options.stages.len() < MOST_STAGES;
    let add = ui.add_enabled(may_add, Button::new("Add stage").small());
    let add = add.on_hover_text("One more like the last, half as wide");
    if add.clicked()
        && let Some(last) = options.stages.last()
    {
        options.stages.push(Stage { ramp: narrower(last.ramp), ..*last });
    }
}

fn fields(ui: &mut Ui, index: usize, stage: &mut Stage) {
    let name = |column: usize| format!("Stage {}, {}", index + 1, COLUMNS[column].0);
    match &mut stage.ramp {
        Ramp::Width { px } | Ramp::Distance { outer_px: px, .. } => {
            let decimals = usize::from(px.fract() != 0.0);
            number_field(ui, &name(0), px, decimals, "", 0.1, FIELD).on_hover_text(COLUMNS[0].1);
            *px = px.clamp(0.1, WIDEST_PX);
        }
        ramp => cell(ui, FIELD, &short_ramp(*ramp), COLUMNS[0].1),
    }
    let mut stride = stage.stride as f64;
    number_field(ui, &name(1), &mut stride, 0, "", 0.05, FIELD).on_hover_text(COLUMNS[1].1);
    stage.stride = stride.round().clamp(1.0, WIDEST_STRIDE) as usize;
    let mut steps = stage.iterations as f64;
    number_field(ui, &name(2), &mut steps, 0, "", 0.1, FIELD).on_hover_text(COLUMNS[2].1);
    stage.iterations = steps.round().clamp(0.0, MOST_STEPS) as usize;
    let before = 100.0 * stage.tolerance.unwrap_or(0.0);
    let mut percent = before;
    number_field(ui, &name(3), &mut percent, 2, " %", 0.01, FIELD).on_hover_text(COLUMNS[3].1);
    if percent != before {
        let share = 0.01 * percent.clamp(0.0, LARGEST_TOLERANCE);
        stage.tolerance = (share > 0.0).then_some(share);
    }
}

fn cell(ui: &mut Ui, width: f32, text: &str, explanation: &str) {
    let palette = theme::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(width, theme::size::ROW), egui::Sense::hover());
    paint_text(ui, rect.left_center(), Align2::LEFT_CENTER, text, TextStyle::Small, palette.text2);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, text));
    if !explanation.is_empty() {
        response.on_hover_ui(|ui| {
            ui.label(RichText::new(explanation));
        });
    }
}

/// A ramp half as wide; those that follow their limb stay.
fn narrower(ramp: Ramp) -> Ramp {
    match ramp {
        Ramp::Width { px } => Ramp::Width { px: 0.5 * px },
        Ramp::Distance { inner_px, outer_px } => Ramp::Distance { inner_px, outer_px: 0.5 * outer_px },
        Ramp::Thesis | Ramp::Half => ramp,
    }
}
