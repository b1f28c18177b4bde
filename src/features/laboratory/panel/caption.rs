//! The caption: what was measured of each fit, and what the colours of the pictures mean.

use backlit_ui::style::theme::data_colours::{
    NO_GRADIENT, PICTURE_GROUND, REPORT_BOTH, REPORT_DATA, REPORT_MODEL,
};
use backlit_ui::style::theme::residual_colour;
use backlit_ui::style::{format, theme};
use egui::{Color32, Grid, Label, Rect, RichText, ScrollArea, Sense, Separator, StrokeKind, Ui, vec2};

use super::Bench;
use crate::features::laboratory::comparison::{ARRIVED_PERCENT, PushKey, percent_text};
use crate::features::laboratory::{Comparison, Contestant, LaboratoryChoices, Lineup, PushAxis, StartChoice};

const SWATCH: egui::Vec2 = vec2(40.0, 11.0);
/// Height of a row where there is little room, and of one of the legend with what is between two.
const COMPACT_LINE: f32 = 17.0;
const COMPACT_ROW: f32 = 21.0;

/// What each column of figures is, and what it says when it is pointed at.
const COLUMNS: [(&str, &str); 4] = [
    ("Cost, %", "Cost of the newest step in percent of the start’s, by the fit’s own ramp"),
    ("Below 5 %", "The step from which on the cost stays below 5 % of the start’s"),
    ("Joints, mm", "Mean joint error of the newest step, where the truth is known"),
    ("Pushing", "Pixels at the start that push, of all pixels in the ramp"),
];

/// What the figures are of.
fn title(comparison: &Comparison) -> &'static str {
    match comparison.last() {
        _ if comparison.problem().is_some() => "Nothing to fit",
        0 => "Before the first step",
        _ if comparison.is_over() => "At their ends",
        _ => "So far",
    }
}

/// A fit's figures in the order of [`COLUMNS`].
fn figures(fit: &Contestant, key: PushKey) -> [String; 4] {
    let newest = fit.steps.last();
    let pushed = fit.pushed.as_ref().filter(|(of, _)| *of == key);
    let arrived = fit.arrived(ARRIVED_PERCENT).filter(|_| fit.last() > 0);
    let known = [
        fit.percent(fit.last()).map(percent_text),
        arrived.map(|step| format!("step {step}")),
        newest.and_then(|step| step.joint_error_mm).map(|error| format::number(error, 1)),
        pushed.map(|(_, pushed)| pushed.text()),
    ];
    known.map(|text| text.unwrap_or_else(|| format::MISSING.to_owned()))
}

/// The caption and the legend; what has no room is scrolled to.
pub(crate) fn ui(ui: &mut Ui, bench: &Bench<'_>, choices: &mut LaboratoryChoices) {
    let palette = theme::palette(ui);
    let is_compact = bench.room.is_compact;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = if is_compact { 4.0 } else { 8.0 };
        let style = if is_compact { theme::column_heading() } else { theme::title() };
        ui.label(RichText::new(title(bench.comparison)).text_style(style).color(palette.text));
        if let Some(problem) = bench.comparison.problem() {
            let text = RichText::new(format!("{}.", format::capitalised(problem)));
            ui.add(Label::new(text.color(palette.text)).wrap());
        } else {
            table(ui, bench);
        }
        ui.add(Separator::default().spacing(if is_compact { 5.0 } else { 6.0 }));
        if is_compact {
            ui.spacing_mut().interact_size.y = COMPACT_LINE;
            ui.spacing_mut().item_spacing.y = 2.0;
        }
        legend(ui, bench);
        next(ui, bench, choices);
    });
}

fn table(ui: &mut Ui, bench: &Bench<'_>) {
    let palette = theme::palette(ui);
    let spacing = vec2(14.0, if bench.room.is_compact { 1.0 } else { 4.0 });
    Grid::new("figures").num_columns(1 + COLUMNS.len()).min_row_height(COMPACT_LINE).spacing(spacing).show(
        ui,
        |ui| {
            ui.spacing_mut().interact_size.y = COMPACT_LINE;
            ui.label("");
            for (name, tooltip) in COLUMNS {
                ui.label(RichText::new(name).small().color(palette.text3)).on_hover_text(tooltip);
            }
            ui.end_row();
            for fit in &bench.comparison.contestants {
                ui.label(RichText::new(fit.entrant.name).color(palette.text2));
                for figure in figures(fit, bench.key) {
                    ui.label(RichText::new(figure).monospace().color(palette.text));
                }
                ui.end_row();
            }
        },
    );
}

fn legend(ui: &mut Ui, bench: &Bench<'_>) {
    let moving = match bench.axis {
        PushAxis::Move(_) => bench.axis.text().to_owned(),
        _ => format!("{} {}", bench.limb, bench.axis.text()),
    };
    row(ui, &format!("Darkens / lightens as the {moving}"), |ui, rect| {
        for step in 0..rect.width() as usize {
            let share = step as f32 / rect.width() * 2.0 - 1.0;
            let colour = residual_colour(share * 255.0);
            let bar = Rect::from_min_size(rect.min + vec2(step as f32, 0.0), vec2(1.0, rect.height()));
            ui.painter().rect_filled(bar, 0.0, colour);
        }
    });
    row(ui, "In the ramp, but does not push", |ui, rect| {
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, PICTURE_GROUND);
        let mut x = rect.left() - rect.height();
        while x < rect.right() {
            let line = [egui::pos2(x, rect.bottom()), egui::pos2(x + rect.height(), rect.top())];
            painter.line_segment(line, egui::Stroke::new(1.6, NO_GRADIENT));
            x += 6.0;
        }
    });
    // The pictures say that themselves: with many words above, what follows needs the room.
    let room = ui.clip_rect().bottom() - ui.cursor().top();
    if bench.room.is_compact && room < 2.0 * COMPACT_ROW {
        return;
    }
    row(ui, "Data only / model only / both", |ui, rect| {
        for (index, grey) in [REPORT_DATA, REPORT_MODEL, REPORT_BOTH].into_iter().enumerate() {
            let corner = rect.min + vec2(14.0 * index as f32, 0.0);
            let swatch = Rect::from_min_size(corner, vec2(12.0, rect.height()));
            let stroke = theme::palette(ui).edge();
            ui.painter().rect(swatch, 0.0, Color32::from_gray(grey), stroke, StrokeKind::Inside);
        }
    });
}

fn row(ui: &mut Ui, words: &str, paint: impl FnOnce(&Ui, Rect)) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(SWATCH, Sense::hover());
        paint(ui, rect);
        let text = RichText::new(words).color(theme::palette(ui).text2);
        ui.add(Label::new(text).truncate());
    });
}

/// What to try next, as a link.
fn next(ui: &mut Ui, bench: &Bench<'_>, choices: &mut LaboratoryChoices) {
    let chosen = &bench.laboratory.choices;
    let offered = StartChoice::offered(bench.context.session.demonstration());
    let at = offered.iter().position(|start| *start == chosen.start).unwrap_or(0);
    let start = offered[(at + offered.len() - 1) % offered.len()];
    let lineup = Lineup::ALL[(chosen.lineup as usize + 1) % Lineup::ALL.len()];
    ui.horizontal_wrapped(|ui| {
        let palette = theme::palette(ui);
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(RichText::new("Next:").color(palette.accent_text));
        let link =
            |ui: &mut Ui, text: String| ui.link(RichText::new(text).color(palette.accent_text)).clicked();
        if link(ui, format::uncapitalised(&start.text())) {
            choices.start = start;
        }
        ui.label(RichText::new("or").color(palette.accent_text));
        if link(ui, format!("compare {}", lineup.words().name.to_lowercase())) {
            choices.lineup = lineup;
        }
    });
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use backlit_document::run::RunEnding;
    use backlit_tracking::render::Prediction;
    use backlit_ui::drawing::Derivative;

    use super::*;
    use crate::features::laboratory::Pushed;
    use crate::features::laboratory::comparison::tests::comparison;

    const KEY: PushKey = (0, PushAxis::Slide, 0);

    fn ended(mut found: Comparison, why: &str) -> Comparison {
        for index in 0..3 {
            found.end(index, RunEnding::Solver(why.to_owned()));
        }
        found
    }

    #[test]
    fn the_figures_are_those_of_the_newest_step() {
        let mut found = comparison([&[100.0, 99.0, 98.0], &[10.0, 1.0, 0.1], &[0.0]]);
        assert_eq!(title(&found), "So far");
        let (picture, prediction) = (Derivative { values: Vec::new(), scale: 1.0 }, Prediction::default());
        let pushed = Pushed { picture, prediction, pushing: 26, in_ramp: 1614 };
        found.contestants[0].pushed = Some((KEY, Arc::new(pushed)));
        found.contestants[1].steps[2].joint_error_mm = Some(3.12);
        let all = found.contestants.iter().map(|fit| figures(fit, KEY));
        let missing = format::MISSING;
        let expected = [
            ["98.0", missing, missing, "26 of 1\u{2009}614"],
            ["1.0", "step 2", "3.1", missing],
            [missing, missing, missing, missing],
        ];
        assert_eq!(all.collect::<Vec<_>>(), expected);
        let other = (1, PushAxis::Slide, 0);
        assert_eq!(figures(&found.contestants[0], other)[3], missing, "that is another camera's");
        assert_eq!(title(&ended(found, "25 steps done")), "At their ends");
    }

    #[test]
    fn the_title_says_what_the_figures_are_of() {
        assert_eq!(title(&comparison([&[1.0], &[1.0], &[1.0]])), "Before the first step");
        let none = ended(comparison([&[], &[], &[]]), "no camera has a silhouette to fit");
        assert_eq!(title(&none), "Nothing to fit");
        assert_eq!(none.problem(), Some("no camera has a silhouette to fit"));
    }
}
