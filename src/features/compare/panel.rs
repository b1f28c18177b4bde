//! The Compare pane: references with their figures, then joints and angles of the selected one; a row chooses the curve beside it.

use backlit_document::edit::Edit;
use backlit_runs::comparison::{clock_words, world_words};
use backlit_tracking::metrics::comparison::{AngleAgreement, ErrorStatistics, PCK_MM, TrackComparison};
use backlit_tracking::statistics::Statistics;
use backlit_ui::style::theme::{run_style, size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{Icon, cut_off, icon_button, paint_run_sample, paint_text, segmented};
use egui::{
    Align, Align2, Layout as Direction, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke, TextStyle,
    Ui, WidgetInfo, pos2, vec2,
};

use super::curves::{CurveChoice, ErrorKind};
use super::{Compare, Side};
use crate::context::command::{Command, CompareCommand};
use crate::context::command_button;
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::{Context, Requests, pane_title};

/// Width of the tables, and of the pane from which the plot stands beside them.
const TABLES: f32 = 452.0;
const BESIDE: f32 = 800.0;
/// Height of the plot below the tables.
const PLOT: f32 = 220.0;
/// Width of a column of figures.
const FIGURE: f32 = 58.0;
const ROW: f32 = 20.0;
/// Length of the piece of a curve before a reference's name.
const SAMPLE: f32 = 16.0;

/// A column of errors: title, what it means, and its figure.
type ErrorColumn = (&'static str, &'static str, fn(&ErrorStatistics) -> Option<f64>);

fn mean_of(statistics: Option<&Statistics>) -> Option<f64> {
    statistics.map(|statistics| statistics.mean)
}

const ERRORS: [ErrorColumn; 5] = [
    ("mean", "Mean distance of the joints, millimetres", |errors| Some(errors.raw.mean)),
    ("95 %", "95 of 100 joints are nearer, millimetres", |errors| Some(errors.raw.p95)),
    (
        "placed",
        "Mean without where the reference’s tool puts its markers, learnt in other frames",
        |errors| errors.placed,
    ),
    ("root", "Mean without the place of the hips", |errors| mean_of(errors.root_aligned.as_ref())),
    ("shape", "Mean without place, turn and size of each frame (Procrustes)", |errors| {
        mean_of(errors.procrustes.as_ref())
    }),
];

/// The same of angles.
type AngleColumn = (&'static str, &'static str, fn(&AngleAgreement) -> String);

const ANGLES: [AngleColumn; 4] = [
    ("RMS", "Root of the mean square difference, degrees", |angle| format::number(angle.rms, 1)),
    ("differ", "Mean of poses − reference, degrees", |angle| format::number(angle.offset, 1)),
    ("without", "RMS without the mean difference, degrees", |angle| {
        format::number(angle.rms_without_offset, 1)
    }),
    ("corr.", "Correlation of both curves", |angle| {
        angle.correlation.map_or_else(|| format::MISSING.to_owned(), |r| format::number(r, 2))
    }),
];

impl Compare {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        pane_title::row(ui, |ui| {
            pane_title::show(ui, Pane::Compare, siblings, requests);
            segmented(ui, &mut self.side, &[(Side::References, "References"), (Side::Runs, "Runs")]);
            if self.side == Side::References {
                command_button::button(ui, context, requests, Command::Compare(CompareCommand::AddReference));
            }
            ui.add_space(HEADER_BUTTONS);
        });
        match self.side {
            Side::Runs => self.runs(ui, context, requests),
            Side::References if self.references.is_empty() => {
                let text = "Nothing to compare with yet. Add a recording of another tool (TRC, C3D, BVH, MOT, CSV, NumPy), \
                            a track.json or a project: its clock, axes and unit are found from the motion.";
                ui.add(egui::Label::new(RichText::new(text).color(theme::palette(ui).text2)).wrap());
            }
            Side::References => self.beside(ui, context, requests),
        }
    }

    /// Tables, and the plot at their right where there is room, else below.
    fn beside(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let area = ui.available_size();
        if area.x >= BESIDE {
            ui.horizontal_top(|ui| {
                let tables = vec2(TABLES, area.y);
                ui.allocate_ui_with_layout(tables, Direction::top_down(Align::Min), |ui| {
                    ScrollArea::vertical()
                        .auto_shrink(false)
                        .show(ui, |ui| self.tables(ui, context, requests));
                });
                ui.vertical(|ui| self.plot(ui, context, requests));
            });
            return;
        }
        let tables = vec2(area.x, (area.y - PLOT).max(100.0));
        ui.allocate_ui_with_layout(tables, Direction::top_down(Align::Min), |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| self.tables(ui, context, requests));
        });
        self.plot(ui, context, requests);
    }

    fn tables(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        ui.spacing_mut().item_spacing.y = 0.0;
        titles(ui, "Reference", &ERRORS.map(|column| (column.0, column.1)));
        for index in 0..self.references.len() {
            let named = &self.references[index];
            let found = self.found.get(index);
            let cells = match found.map(|found| &found.overall) {
                Some(Some(overall)) => error_cells(overall),
                Some(None) => vec!["angles only".to_owned()],
                None => vec!["comparing…".to_owned()],
            };
            let response = row(ui, &named.reference.name, &cells, index == self.selected, Some(index));
            let response = match found.and_then(|found| found.overall.as_ref()) {
                Some(overall) => response.on_hover_text(pck_words(overall)),
                None => response,
            };
            if response.clicked() {
                self.selected = index;
            }
            if let Some(path) = &named.path
                && index == self.selected
                && remove_button(ui, &response, &named.reference.name)
            {
                let others = context.document().references.iter().filter(|other| *other != path);
                requests.edit(Edit::SetReferences(others.cloned().collect()));
            }
        }
        let Some(found) = self.found.get(self.selected).cloned() else { return };
        ui.add_space(space::WIDGET);
        self.overlaps.show(ui, &found, context, requests);
        self.joints(ui, &found);
        self.angles(ui, &found);
    }

    /// The joints of the selected reference.
    fn joints(&mut self, ui: &mut Ui, found: &TrackComparison) {
        let Some(overall) = &found.overall else { return };
        let kind = match self.curve {
            CurveChoice::Error(kind, _) => kind,
            CurveChoice::Angle(_) => ErrorKind::Raw,
        };
        titles(ui, "Joint error, mm", &ERRORS.map(|column| (column.0, column.1)));
        let all = CurveChoice::Error(kind, None);
        if row(ui, "all joints", &error_cells(overall), self.curve == all, None).clicked() {
            self.curve = all;
        }
        for (joint, errors) in &found.by_joint {
            let choice = CurveChoice::Error(kind, Some(joint.clone()));
            if row(ui, joint, &error_cells(errors), self.curve == choice, None).clicked() {
                self.curve = choice;
            }
        }
        ui.add_space(space::WIDGET);
    }

    /// The angles of the selected reference.
    fn angles(&mut self, ui: &mut Ui, found: &TrackComparison) {
        if found.angles.is_empty() {
            return;
        }
        titles(ui, "Angle, °", &ANGLES.map(|column| (column.0, column.1)));
        for angle in &found.angles {
            let choice = CurveChoice::Angle(angle.angle);
            let cells = ANGLES.map(|column| (column.2)(angle));
            let response = row(ui, angle.angle.label(), &cells, self.curve == choice, None);
            let turned = "The reference counts the other way round, and was turned.";
            let response = if angle.is_turned { response.on_hover_text(turned) } else { response };
            if response.clicked() {
                self.curve = choice;
            }
        }
    }

    /// What is drawn, the curves, and how clocks and axes were matched.
    fn plot(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let palette = theme::palette(ui);
        ui.horizontal(|ui| {
            let (what, joint) = match &self.curve {
                CurveChoice::Angle(angle) => (angle.label().to_owned(), None),
                CurveChoice::Error(_, joint) => {
                    (joint.clone().unwrap_or_else(|| "all joints".to_owned()), Some(joint))
                }
            };
            ui.label(RichText::new(what).color(palette.text));
            if let Some(joint) = joint.cloned() {
                let CurveChoice::Error(mut kind, _) = self.curve else { return };
                segmented(ui, &mut kind, &ErrorKind::ALL.map(|(kind, name, _)| (kind, name)))
                    .on_hover_text(ErrorKind::ALL.iter().find(|row| row.0 == kind).map_or("", |row| row.2));
                self.curve = CurveChoice::Error(kind, joint);
            } else {
                ui.label(RichText::new("poses: the plain line").small().color(palette.text3));
            }
        });
        let words = self.found_of(self.selected).map(|found| {
            let axes = if found.joints.is_empty() {
                String::new()
            } else {
                format!("; axes: {}", world_words(&found.world))
            };
            format!("Clocks: {}{axes}.", clock_words(found.clock))
        });
        let below = size::ROW + space::ROW;
        let area = ui.available_size() - vec2(space::ROW, below);
        if area.y > 60.0 {
            self.curves(ui, area, context, requests);
        }
        if let Some(words) = words {
            ui.add(egui::Label::new(RichText::new(&words).small().color(palette.text2)).truncate())
                .on_hover_text(words);
        }
    }
}

fn error_cells(errors: &ErrorStatistics) -> Vec<String> {
    let cell =
        |value: Option<f64>| value.map_or_else(|| format::MISSING.to_owned(), |mm| format::number(mm, 1));
    ERRORS.iter().map(|column| cell((column.2)(errors))).collect()
}

/// How many joints are within the thresholds, in words.
fn pck_words(errors: &ErrorStatistics) -> String {
    let shares = PCK_MM.iter().zip(errors.pck);
    let shares: Vec<String> = shares
        .map(|(mm, share)| format!("{} % within {mm:.0} mm", format::number(100.0 * share, 0)))
        .collect();
    format!("Joints (PCK): {}.", shares.join(", "))
}

fn remove_button(ui: &mut Ui, row: &Response, name: &str) -> bool {
    let at = Rect::from_min_size(
        pos2(row.rect.left() + TABLES - 5.0 * FIGURE - 34.0, row.rect.top()),
        vec2(ROW, ROW),
    );
    let at = if at.right() < row.rect.right() { at } else { row.rect };
    let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(at));
    icon_button(&mut ui, Icon::Close, &format!("Remove {name}"), "Compare with it no more").clicked()
}

/// Titles over columns of figures.
pub(super) fn titles(ui: &mut Ui, first: &str, columns: &[(&str, &str)]) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), size::ROW), Sense::hover());
    let palette = theme::palette(ui);
    paint_text(
        ui,
        rect.left_center() + vec2(space::ROW, 0.0),
        Align2::LEFT_CENTER,
        first,
        TextStyle::Small,
        palette.text2,
    );
    for (index, (title, meaning)) in columns.iter().enumerate() {
        let cell = cell(rect, columns.len() - 1 - index);
        paint_text(ui, cell.right_center(), Align2::RIGHT_CENTER, *title, TextStyle::Small, palette.text3);
        let response = ui.interact(cell, ui.scope_id().with((first, *title)), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, *title));
        response.on_hover_text(*meaning);
    }
}

/// The cell of a row that is the n-th from the right.
pub(super) fn cell(row: Rect, from_right: usize) -> Rect {
    let right = row.right() - space::WIDGET - from_right as f32 * FIGURE;
    Rect::from_min_max(pos2(right - FIGURE, row.top()), pos2(right, row.bottom()))
}

/// A row of a name and figures; before the name of a reference or a run a piece of its curve.
pub(super) fn row(
    ui: &mut Ui,
    name: &str,
    cells: &[String],
    is_selected: bool,
    sample: Option<usize>,
) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let said = format!("{name}: {}", cells.join(", "));
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, is_selected, &said));
    let palette = theme::palette(ui);
    let ground =
        if is_selected { Some(palette.select) } else { response.hovered().then_some(palette.raised) };
    if let Some(ground) = ground {
        ui.painter().rect_filled(rect, f32::from(size::FIELD_RADIUS), ground);
    }
    let mut left = rect.left() + space::ROW;
    if let Some(index) = sample {
        let style = run_style(index);
        let ends = [pos2(left, rect.center().y), pos2(left + SAMPLE, rect.center().y)];
        paint_run_sample(ui.painter(), ends, index, Stroke::new(style.width, style.colour), 1.0);
        left += SAMPLE + space::ROW;
    }
    let first = cell(rect, cells.len().saturating_sub(1)).left();
    let galley = cut_off(ui, name, TextStyle::Body, palette.text, (first - left).max(24.0));
    let at = pos2(left, rect.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, palette.text);
    for (index, text) in cells.iter().enumerate() {
        let at = cell(rect, cells.len() - 1 - index).right_center();
        paint_text(ui, at, Align2::RIGHT_CENTER, text, TextStyle::Monospace, palette.text);
    }
    response
}
