//! The ways as rows, with what each led to.

use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{Icon, cut_off, icon_button, paint_text, within};
use egui::{
    Align, Align2, Layout as Direction, Rect, RichText, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use crate::context::command::{BeginningCommand, Command};
use crate::context::{Context, Requests, unavailable};
use crate::features::beginnings::update::Outcome;
use crate::features::beginnings::{AttemptIndex, Beginnings, COMPARED, Method, MethodWords};

/// Height of a row of the table.
const ROW: f32 = 26.0;
const NAME: f32 = 96.0;

/// A column: its title, what it says, how wide it is, and what stands in it.
type Column = (&'static str, &'static str, f32, fn(&Outcome) -> String);

/// The columns from the left. In a narrow pane those go first that say least: see [`columns`].
const COLUMNS: [Column; 5] = [
    ("Cost", "Σ (D − Λ)² of the pose at the end, as the window measures every pose", 54.0, |outcome| {
        format::cost(outcome.cost)
    }),
    ("IoU", "What silhouettes and body have in common, as a share of what either covers", 46.0, |outcome| {
        outcome.iou.map_or_else(missing, format::ratio)
    }),
    (
        "Λ",
        "How many times a body was predicted in all cameras. Looks at single limbs and templates are not counted",
        52.0,
        |outcome| outcome.evaluations.map_or_else(missing, |count| format::count(count as i64)),
    ),
    ("Time", "Wall time on this machine", 70.0, |outcome| format::duration(outcome.seconds)),
    ("Error", "Mean distance of the joints from the truth, or from the take’s reference", 58.0, |outcome| {
        outcome.error_mm.map_or_else(missing, |mm| format::length(mm / 1e3))
    }),
];
/// The order in which columns go.
const LEAST: [&str; 3] = ["Cost", "Λ", "Time"];

fn missing() -> String {
    format::MISSING.to_owned()
}

/// The columns for which there is room beside the names.
fn columns(width: f32) -> Vec<Column> {
    let mut columns = COLUMNS.to_vec();
    for least in LEAST {
        let all: f32 = columns.iter().map(|column| column.2).sum();
        if size::BUTTON + NAME + all + space::ROW > width {
            columns.retain(|column| column.0 != least);
        }
    }
    columns
}

pub(super) fn ui(ui: &mut Ui, beginnings: &mut Beginnings, context: &Context<'_>, requests: &mut Requests) {
    let columns = columns(ui.available_width());
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        titles(ui, &columns);
        for method in COMPARED {
            row(ui, beginnings, method, &columns, (context, requests));
        }
        ui.add_space(space::ROW);
        let text = "A body from nothing: neither pose nor size is known";
        ui.label(RichText::new(text).small().color(theme::palette(ui).text2));
        row(ui, beginnings, Method::Body, &columns, (context, requests));
    });
}

/// The place of each column in a row.
fn cells(row: Rect, columns: &[Column]) -> Vec<Rect> {
    let mut right = row.right() - space::ROW;
    let cells = columns.iter().rev().map(|column| {
        let cell = Rect::from_min_max(pos2(right - column.2, row.top()), pos2(right, row.bottom()));
        right -= column.2;
        cell
    });
    let mut cells: Vec<Rect> = cells.collect();
    cells.reverse();
    cells
}

fn titles(ui: &mut Ui, columns: &[Column]) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), size::ROW), Sense::hover());
    for (column, cell) in columns.iter().zip(cells(rect, columns)) {
        let colour = theme::palette(ui).text3;
        paint_text(ui, cell.right_center(), Align2::RIGHT_CENTER, column.0, TextStyle::Small, colour);
        let title = ui.interact(cell, ui.scope_id().with(column.0), Sense::hover());
        title.widget_info(|| WidgetInfo::labeled(Role::Label, true, column.0));
        title.on_hover_text(column.1);
    }
}

fn row(
    ui: &mut Ui,
    beginnings: &mut Beginnings,
    method: Method,
    columns: &[Column],
    (context, requests): (&Context<'_>, &mut Requests),
) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let is_looked_at = beginnings.at.is_some_and(|at| at.method == method);
    response.widget_info(|| {
        WidgetInfo::selected(Role::ListItem, true, is_looked_at, MethodWords::of(method).name)
    });
    let palette = theme::palette(ui);
    if is_looked_at {
        ui.painter().rect_filled(rect, f32::from(size::FIELD_RADIUS), palette.select);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, f32::from(size::FIELD_RADIUS), palette.raised);
    }
    let left = Rect::from_min_size(rect.min, vec2(size::BUTTON, rect.height()));
    within(ui, left, Direction::left_to_right(Align::Center), |ui| {
        if run_button(ui, context, method) {
            beginnings.begin(&[method], context, requests);
            context.egui.request_repaint();
        }
    });
    let ended = beginnings.ended.get(&method);
    let name_at = pos2(left.right() + space::ROW, rect.center().y);
    let name_colour = if is_looked_at { palette.accent_text } else { palette.text };
    let name = MethodWords::of(method).name;
    paint_text(ui, name_at, Align2::LEFT_CENTER, name, TextStyle::Body, name_colour);
    let cells = cells(rect, columns);
    let mut hover = format!("{}.", MethodWords::of(method).explanation);
    match ended {
        Some(Ok(outcome)) => {
            for (column, cell) in columns.iter().zip(&cells) {
                let text = (column.3)(outcome);
                let at = cell.right_center();
                paint_text(ui, at, Align2::RIGHT_CENTER, text, TextStyle::Monospace, palette.text);
            }
            hover += " Click to look at its steps.";
        }
        Some(Err(why)) => {
            let text = format!("Leads nowhere: {why}");
            let place = cells.first().map_or(rect, |first| Rect::from_min_max(first.min, rect.max));
            let galley = cut_off(ui, &text, TextStyle::Body, palette.warn, place.width());
            let at = pos2(place.left(), place.center().y - galley.size().y / 2.0);
            ui.painter().galley(at, galley, palette.warn);
            hover = format!("{text}.");
        }
        None => {
            let is_now = beginnings.is_running() && beginnings.running == Some(method);
            let text = if is_now { "running…" } else { "not run yet" };
            let at = rect.right_center() - vec2(space::ROW, 0.0);
            paint_text(ui, at, Align2::RIGHT_CENTER, text, TextStyle::Body, palette.text3);
        }
    }
    if response.clicked() && matches!(ended, Some(Ok(_))) {
        beginnings.choose(AttemptIndex { method, step: 0 }, context);
    }
    response.on_hover_text(hover);
}

/// Whether a method is to be run.
fn run_button(ui: &mut Ui, context: &Context<'_>, method: Method) -> bool {
    let command = match method {
        Method::Body => BeginningCommand::AcquireBody,
        _ => BeginningCommand::RunAll,
    };
    let why_not = unavailable(Command::Beginning(command), context);
    let label = format!("Run {}", MethodWords::of(method).lower_case);
    let tooltip = why_not.map_or_else(|| label.clone(), |why| format!("{label}\n{why}."));
    ui.add_enabled_ui(why_not.is_none(), |ui| icon_button(ui, Icon::Run, &label, &tooltip).clicked()).inner
}
