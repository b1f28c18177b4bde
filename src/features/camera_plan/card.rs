//! The card: the floor with the cameras there are and with one more, which sets of them know most, and where one more brings most.

use backlit_runs::camera_plan::PlanResult;
use backlit_tracking::observability::plan::PlannedSet;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::heat_map::error_legend;
use backlit_ui::widgets::{
    checkbox, hint, paint_text, search_card, work_head, work_progress, work_results, work_row,
};
use egui::{Align2, Color32, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::{CameraPlan, map};
use crate::context::{Context, Requests};

/// Width of the card and of its two maps.
const WIDTH: f32 = 700.0;
const MAP: f32 = 320.0;
const LEAST_MAP: f32 = 200.0;
/// Height of the legend.
const LEGEND: f32 = 34.0;
/// Where the numbers of a set end, from the right edge.
const COLUMNS: [f32; 2] = [110.0, 8.0];
/// Places for one more camera that are listed, and sets of one size.
const LISTED: usize = 5;
const SETS_LISTED: usize = 3;

impl CameraPlan {
    /// Shows the card, and says whether it stays.
    pub(super) fn show(&mut self, ui: &Ui, context: &Context<'_>, _: &mut Requests) -> bool {
        if context.session.take.is_none() {
            return false;
        }
        let modal = search_card(ui.ctx(), "camera plan").show(ui.ctx(), |ui| {
            let text = "How far off joints would be that silhouettes alone find, in the mean, for a person who stands, walks and \
                        reaches at each place of the floor. No footage is looked at.";
            work_head(ui, WIDTH, "Where to put cameras", text);
            if self.work.is_busy() {
                self.progress(ui);
            } else {
                self.outcome(ui, context);
            }
            self.buttons(ui, context)
        });
        let is_left = modal.inner || modal.should_close();
        if is_left {
            self.work.stop();
        }
        !is_left
    }

    fn progress(&self, ui: &mut Ui) {
        match self.work.progress().copied() {
            None => work_progress(ui, "Cameras", [0, 1]),
            Some([done, all]) => work_progress(ui, format!("{done} of {all} places"), [done, all]),
        }
    }

    fn outcome(&mut self, ui: &mut Ui, context: &Context<'_>) {
        let Some(found) = self.work.result() else {
            return self.work.no_result(ui, "The plan was stopped.");
        };
        if !self.work.is_current(context) {
            hint(ui, "What stands below is about the cameras before. Plan again with those in use.");
        }
        let mut looked_at = self.looked_at;
        work_results(ui, |ui| {
            maps(ui, found, looked_at);
            ui.spacing_mut().item_spacing.y = 0.0;
            if let Some(clicked) = additions(ui, found, looked_at) {
                looked_at = clicked;
            }
            ui.add_space(space::WIDGET);
            sets(ui, found);
        });
        self.looked_at = looked_at;
    }

    /// Whether the card is closed.
    fn buttons(&mut self, ui: &mut Ui, context: &Context<'_>) -> bool {
        let is_old = !self.work.is_current(context);
        let (has_floor, is_off_floor) = (self.floor.is_some(), &mut self.is_off_floor);
        self.work.buttons(ui, ("Plan", is_old), |ui| {
            let mut is_on_floor = !*is_off_floor;
            if has_floor && checkbox(ui, &mut is_on_floor, "On the floor of the scene").changed() {
                *is_off_floor = !is_on_floor;
            }
        })
    }
}

/// The floor as it is known now, and with one more camera.
fn maps(ui: &mut Ui, found: &PlanResult, looked_at: usize) {
    let side = (0.5 * (ui.available_width() - space::WIDGET)).clamp(LEAST_MAP, MAP);
    let Some(whole) = found.whole() else { return };
    let shown = [Some(whole), found.additions.get(looked_at)];
    ui.horizontal_top(|ui| {
        for (index, set) in shown.into_iter().flatten().enumerate() {
            ui.vertical(|ui| {
                let name = match index {
                    0 => format::counted(found.subject.cameras.len(), "camera"),
                    _ => "With one more".to_owned(),
                };
                hint(ui, format!("{name}: {} mm in the mean", format::number(1e3 * set.mean_m(), 1)));
                map::ui(ui, found, set, side);
            });
        }
    });
    ui.add_space(space::ROW);
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), LEGEND), Sense::hover());
    error_legend(ui, area, map::LIMIT_MM);
}

/// Where one more camera brings most; the one that was clicked, by its rank.
fn additions(ui: &mut Ui, found: &PlanResult, looked_at: usize) -> Option<usize> {
    let palette = theme::palette(ui);
    let whole = found.whole()?;
    head(ui, "One more camera", ["mean, mm", "brings"]);
    let mut clicked = None;
    for (rank, set) in found.additions.iter().take(LISTED).enumerate() {
        let camera = found.added(set)?;
        let [x, y] = found.subject.floor.place(camera.centre());
        let height = camera.centre().dot(found.subject.floor.up) - found.subject.floor.height_m;
        let [x, y, height] = [x, y, height].map(|along| format::number(along, 1));
        let text = format!("At ({x}, {y}) m, {height} m high");
        let numbers = [set.mean_m(), whole.mean_m() - set.mean_m()].map(|m| format::number(1e3 * m, 1));
        let colour = if rank == looked_at { palette.text } else { palette.text2 };
        if row(ui, &text, &numbers, (rank == looked_at, colour)) {
            clicked = Some(rank);
        }
    }
    clicked
}

/// The best sets of each size, the largest first, and what can be left out best.
fn sets(ui: &mut Ui, found: &PlanResult) {
    let palette = theme::palette(ui);
    head(ui, "Sets of these cameras", ["mean, mm", "known, %"]);
    for count in (1..=found.subject.cameras.len()).rev() {
        let of_size = found.sets.iter().filter(|set| set.cameras.len() == count);
        for set in of_size.take(SETS_LISTED) {
            let numbers = [1e3 * set.mean_m(), 100.0 * set.known()];
            let numbers = [format::number(numbers[0], 1), format::number(numbers[1], 0)];
            let style = (TextStyle::Body, palette.text2);
            work_row(ui, (&set.cameras, &found.names(set)), (&numbers, &COLUMNS), style);
        }
    }
    if let Some((spare, without)) = found.spare() {
        ui.add_space(space::ROW);
        hint(ui, spare_text(found, spare, without));
    }
}

fn spare_text(found: &PlanResult, spare: usize, without: &PlannedSet) -> String {
    format!(
        "{} is missed least: {} mm without it.",
        found.subject.cameras[spare].name(),
        format::number(1e3 * without.mean_m(), 1)
    )
}

fn head(ui: &mut Ui, title: &str, columns: [&str; 2]) {
    let style = (TextStyle::Small, theme::palette(ui).text3);
    work_row(ui, (&[], title), (&columns.map(str::to_owned), &COLUMNS), style);
}

/// Words, and numbers in columns; whether it was clicked.
fn row(ui: &mut Ui, text: &str, numbers: &[String; 2], (is_chosen, colour): (bool, Color32)) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), size::ROW), Sense::click());
    let said = format!("{text}: {}", numbers.join(", "));
    let enabled = ui.is_enabled();
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, enabled, is_chosen, said.as_str()));
    let palette = theme::palette(ui);
    let ground = rect.expand2(vec2(0.5 * space::ROW, 0.0));
    if is_chosen {
        ui.painter().rect_filled(ground, size::FIELD_RADIUS, palette.active);
    } else if response.hovered() {
        ui.painter().rect_filled(ground, size::FIELD_RADIUS, palette.hover);
    }
    paint_text(ui, rect.left_center(), Align2::LEFT_CENTER, text, TextStyle::Body, colour);
    for (number, right) in numbers.iter().zip(COLUMNS) {
        let at = pos2(rect.right() - right, rect.center().y);
        paint_text(ui, at, Align2::RIGHT_CENTER, number, TextStyle::Body, colour);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(ground, size::FIELD_RADIUS, palette.focus_ring(), egui::StrokeKind::Outside);
    }
    response.clicked()
}
