//! The runs of the fit as a table that sorts by any column; *Run again with…* adds runs from the same start.

use backlit_document::run::Run;
use backlit_document::runs::StepRef;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::paint_text;
use egui::{
    Align2, Color32, Pos2, Rect, RichText, Role, ScrollArea, Sense, Shape, Stroke, TextStyle, Ui, WidgetInfo,
    vec2,
};

use super::Compare;
use super::panel::{cell, row};
use crate::context::command::{Command, FitCommand, Variants};
use crate::context::command_button::menu_row;
use crate::context::{Context, Requests, SessionRequest};

/// A column: title, what it means, its number, and digits behind the point.
type Column = (&'static str, &'static str, fn(&Run, &[Run]) -> Option<f64>, usize);

/// The title of the column of times, seconds.
const TIME: &str = "s";

const COLUMNS: [Column; 7] = [
    ("frame", "The frame that was fitted", |run, _| Some(run.frame as f64), 0),
    ("steps", "Accepted steps", |run, _| Some(run.accepted_until(run.last_step()) as f64), 0),
    (
        "cost, %",
        "What is left of the start’s cost",
        |run, all| Some(100.0 * run.fraction_among(all, run.last_step())?),
        1,
    ),
    ("RMS", "Root mean square of the residuals, grey levels", |run, _| Some(run.steps.last()?.rms), 1),
    ("IoU", "Overlap of model and silhouettes", |run, _| run.steps.last()?.iou, 3),
    (
        "mm",
        "Mean distance of the joints from the take’s reference",
        |run, _| run.steps.last()?.joint_error_mm,
        1,
    ),
    (TIME, "Time of all steps", |run, _| Some(run.steps.iter().map(|step| step.seconds).sum()), 2),
];

/// Half the breadth of the mark of the sorted column.
const MARK: f32 = 3.0;

/// The column by which runs are sorted, and whether the largest come first; none is the order in which they were begun.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Sorting {
    column: Option<usize>,
    is_descending: bool,
}

impl Sorting {
    /// A click on a title: up, down, and then as they were begun.
    fn click(&mut self, column: usize) {
        *self = match (self.column == Some(column), self.is_descending) {
            (true, true) => Self::default(),
            (true, false) => Self { column: Some(column), is_descending: true },
            (false, _) => Self { column: Some(column), is_descending: false },
        };
    }

    /// The runs in order; what has no number in the column comes last.
    fn order<'a>(self, runs: &'a [Run]) -> Vec<&'a Run> {
        let mut order: Vec<&'a Run> = runs.iter().collect();
        if let Some((_, _, value, _)) = self.column.and_then(|column| COLUMNS.get(column)) {
            let sign = if self.is_descending { -1.0 } else { 1.0 };
            let key = |run: &Run| value(run, runs).map_or(f64::INFINITY, |value| sign * value);
            order.sort_by(|a, b| key(a).total_cmp(&key(b)));
        }
        order
    }
}

impl Compare {
    pub(super) fn runs(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let palette = theme::palette(ui);
        ui.horizontal(|ui| {
            ui.menu_button("Run again with…", |ui| {
                let variants =
                    [Variants::Renderers, Variants::Presets, Variants::Ramps].map(FitCommand::RunAgain);
                for command in variants.into_iter().chain([FitCommand::RunAgainWithCameras]) {
                    let command = Command::Fit(command);
                    menu_row(ui, context, requests, command, command.text());
                }
            })
            .response
            .on_hover_text(
                "From the start of the run on the screen, with each renderer, preset, ramp or set of cameras",
            );
            let text = "A click on a title sorts; a click on a run shows its last step.";
            ui.label(RichText::new(text).small().color(palette.text3));
        });
        let runs = context.runs().all();
        if runs.is_empty() {
            ui.label(RichText::new("No run yet: fit the frame first.").color(palette.text2));
            return;
        }
        ui.spacing_mut().item_spacing.y = 0.0;
        self.sorting_titles(ui);
        let shown = context.shown_step().map(|step| step.run);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for run in self.sorting.order(runs) {
                let cells: Vec<String> = COLUMNS
                    .iter()
                    .map(|(title, _, value, digits)| {
                        let is_shown = *title != TIME || !self.hides_times;
                        let value = value(run, runs).filter(|value| value.is_finite() && is_shown);
                        value.map_or_else(
                            || format::MISSING.to_owned(),
                            |value| format::number(value, *digits),
                        )
                    })
                    .collect();
                let response = row(ui, &run.name, &cells, shown == Some(run.number), Some(run.colour));
                if response.on_hover_text(format!("{}\n{}", run.detail, run.ending_text())).clicked() {
                    requests
                        .request(SessionRequest::Step(StepRef { run: run.number, step: run.last_step() }));
                }
            }
        });
    }

    fn sorting_titles(&mut self, ui: &mut Ui) {
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), size::ROW), Sense::hover());
        let palette = theme::palette(ui);
        let at = rect.left_center() + vec2(space::ROW, 0.0);
        paint(ui, at, Align2::LEFT_CENTER, "Run", palette.text2);
        for (index, (title, meaning, ..)) in COLUMNS.iter().enumerate() {
            let cell = cell(rect, COLUMNS.len() - 1 - index);
            let (order, colour) = match (self.sorting.column == Some(index), self.sorting.is_descending) {
                (false, _) => ("", palette.text3),
                (true, true) => (", descending", palette.accent_text),
                (true, false) => (", ascending", palette.accent_text),
            };
            let text = paint(ui, cell.right_center(), Align2::RIGHT_CENTER, title, colour);
            if !order.is_empty() {
                mark(ui, text.left_center() - vec2(MARK + 3.0, 0.0), self.sorting.is_descending, colour);
            }
            let response = ui.interact(cell, ui.scope_id().with(("sort", index)), Sense::click());
            let said = format!("Sort by {title}{order}");
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &said));
            if response.on_hover_text(*meaning).clicked() {
                self.sorting.click(index);
            }
        }
    }
}

fn paint(ui: &Ui, at: Pos2, align: Align2, text: &str, colour: Color32) -> Rect {
    paint_text(ui, at, align, text, TextStyle::Small, colour)
}

/// A triangle whose tip points up, or down.
fn mark(ui: &Ui, at: Pos2, is_down: bool, colour: Color32) {
    let tip = if is_down { MARK } else { -MARK };
    let corners = [vec2(-MARK, -0.6 * tip), vec2(MARK, -0.6 * tip), vec2(0.0, 0.6 * tip)];
    let corners = corners.map(|corner| at + corner).to_vec();
    ui.painter().add(Shape::convex_polygon(corners, colour, Stroke::NONE));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_sort_up_down_and_as_they_were() {
        let runs: Vec<Run> = [5, 2, 9].map(|frame| Run { number: frame, frame, ..Run::default() }).into();
        let frames =
            |sorting: Sorting| -> Vec<usize> { sorting.order(&runs).iter().map(|run| run.frame).collect() };
        let mut sorting = Sorting::default();
        assert_eq!(frames(sorting), [5, 2, 9]);
        sorting.click(0);
        assert_eq!(frames(sorting), [2, 5, 9]);
        sorting.click(0);
        assert_eq!(frames(sorting), [9, 5, 2]);
        sorting.click(0);
        assert_eq!(sorting, Sorting::default());
        // No overlap is known: all stay as they are.
        sorting.click(4);
        assert_eq!(frames(sorting), [5, 2, 9]);
    }
}
