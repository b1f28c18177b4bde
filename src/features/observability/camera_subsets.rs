//! The Camera subsets section: what each set of cameras would see of this pose, the best first.

use backlit_document::edit::Edit;
use backlit_tracking::observability::SubsetFigures;
use backlit_ui::drawing::joint_name;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{hint, paint_camera_badge, paint_text, section};
use egui::{Align2, Rect, Response, RichText, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::panel::paint_selected;
use super::{Observability, Observed};
use crate::context::preferences::Layout;
use crate::context::{Context, Requests};

const BADGE_GAP: f32 = 3.0;
/// Width of the column of figures at the right.
const FIGURE: f32 = 66.0;
/// Widest bar, and its height.
const BAR: f32 = 34.0;
const BAR_HEIGHT: f32 = 5.0;
/// A bar is full at this standard deviation, metres, and empty at the other.
const BARS_M: [f64; 2] = [1.0, 0.0005];

impl Observability {
    pub(super) fn subsets_section(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
        let open = context.preferences.layout == Layout::Debug;
        let used: Vec<usize> = context.document().used_cameras().collect();
        let summary = format!("{} of {} cameras", used.len(), context.session.camera_count());
        section(ui, "Camera subsets", &summary, open, |ui| {
            self.drawn.figures = true;
            let palette = theme::palette(ui);
            let Some(found) = self.found.clone().filter(|found| !found.subsets.is_empty()) else {
                hint(ui, "No camera has a silhouette yet");
                return;
            };
            ui.spacing_mut().item_spacing.y = 0.0;
            head(ui);
            for (place, figures) in found.subsets.iter().enumerate() {
                let response = row(ui, &found, self.is_stale(), figures, figures.cameras == used);
                if response.hovered() || response.has_focus() {
                    self.drawn.subset = Some(place);
                }
                if response.clicked() && figures.cameras != used {
                    requests.edit(Edit::UseOnly { cameras: figures.cameras.clone() });
                }
            }
            ui.add_space(space::ROW);
            let text = RichText::new(about(&found)).small().color(palette.text3);
            ui.add(egui::Label::new(text).wrap()).on_hover_text(
                "Each camera is summed by itself, with the noise of the cameras in use, so that sets differ \
                 only in what they see",
            );
        });
    }
}

/// Which sets there are, and what the best of few cameras is worth.
fn about(found: &Observed) -> String {
    let cameras = found.subsets.iter().map(|set| set.cameras.len()).max().unwrap_or_default();
    let sets = found.subsets.len();
    let which = match (cameras, sets) {
        (1, _) => "One camera has a silhouette.".to_owned(),
        (..=4, _) => format!("All {sets} sets of {cameras} cameras."),
        (..=8, _) => format!("{sets} sets of {cameras} cameras: each, pairs, all but one, all."),
        _ => format!("{sets} sets of {cameras} cameras: each, all but one, all."),
    };
    let best = |count| found.subsets.iter().find(|set| set.cameras.len() == count);
    let compared = best(2).zip(best(1)).filter(|(two, one)| one.median_m.is_finite() && two.median_m > 0.0);
    compared.map_or(which.clone(), |(two, one)| {
        let times = one.median_m / two.median_m;
        let text = format::number(times, usize::from(times < 9.95));
        format!("{which} The best camera alone knows the middle joint {text} times worse than the best pair.")
    })
}

fn head(ui: &mut Ui) {
    let palette = theme::palette(ui);
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), size::ROW), Sense::hover());
    let text = |at, align, text: &str| paint_text(ui, at, align, text, TextStyle::Small, palette.text3);
    text(row.left_center(), Align2::LEFT_CENTER, "Cameras");
    text(pos2(row.right() - FIGURE - BAR - 14.0, row.center().y), Align2::RIGHT_CENTER, "Seen");
    text(row.right_center(), Align2::RIGHT_CENTER, "Worst joint, 1σ");
}

fn row(ui: &mut Ui, found: &Observed, is_stale: bool, figures: &SubsetFigures, is_current: bool) -> Response {
    let palette = theme::palette(ui);
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), size::ROW), Sense::click());
    let names: Vec<String> = figures.cameras.iter().map(|camera| (camera + 1).to_string()).collect();
    let label = format!("Cameras {}", names.join(", "));
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, ui.is_enabled(), is_current, &label));
    if is_current {
        paint_selected(ui, row);
    } else if response.hovered() {
        ui.painter().rect_filled(row.expand2(vec2(space::PANEL_MARGIN, 0.0)), 0.0, palette.hover);
    }
    for (index, &camera) in figures.cameras.iter().enumerate() {
        let left = row.left() + index as f32 * (size::BADGE + BADGE_GAP);
        let at = pos2(left, row.center().y - 0.5 * size::BADGE);
        paint_camera_badge(ui.painter(), Rect::from_min_size(at, vec2(size::BADGE, size::BADGE)), camera);
    }
    numbers(ui, row, is_stale, figures);
    if response.has_focus() {
        ui.painter().rect_stroke(row, size::FIELD_RADIUS, palette.focus_ring(), egui::StrokeKind::Outside);
    }
    response.on_hover_text(tooltip(found, figures, is_current))
}

fn tooltip(found: &Observed, figures: &SubsetFigures, is_current: bool) -> String {
    let worst = joint_name(&found.shown.model, figures.worst.0.into());
    let click = if is_current { "These are in use" } else { "Click to use these and no others" };
    format!(
        "Worst joint: {worst}, {}\nJoint in the middle: {}\nWeakest direction that is seen: {} grey²/rad²\n{click}",
        format::length(figures.worst.1),
        format::length(figures.median_m),
        format::cost(figures.smallest),
    )
}

fn numbers(ui: &Ui, row: Rect, is_stale: bool, figures: &SubsetFigures) {
    let palette = theme::palette(ui);
    let colour = if is_stale { palette.text3 } else { palette.text };
    let text = |at, text: String| {
        paint_text(ui, at, Align2::RIGHT_CENTER, text, TextStyle::Monospace, colour);
    };
    let y = row.center().y;
    let seen = format!("{}/{}", figures.columns - figures.null_count, figures.columns);
    let bar_right = row.right() - FIGURE;
    text(pos2(bar_right - BAR - 14.0, y), seen);
    let deviation = figures.worst.1;
    let value = if deviation.is_finite() { format::length(deviation) } else { "unseen".to_owned() };
    text(row.right_center(), value);
    let [full, empty] = BARS_M.map(f64::log10);
    let share = ((deviation.log10() - empty) / (full - empty)).clamp(0.0, 1.0) as f32;
    let bar = Rect::from_min_size(
        pos2(bar_right - BAR - 4.0, y - 0.5 * BAR_HEIGHT),
        vec2((BAR * share).max(1.0), BAR_HEIGHT),
    );
    ui.painter().rect_filled(bar, 1.0, if is_stale { palette.active } else { palette.line2 });
}
