//! The steps of the silhouette on the screen, as small pictures side by side (the report's Fig. 4.9); one can be shown large.

use backlit_tracking::segment::Segmentation;
use backlit_ui::drawing::{decision, excess_picture, mask_picture, stage_words, subject_change};
use backlit_ui::style::theme::space;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::image_canvas::{cached_texture, paint_whole};
use backlit_ui::widgets::paint_text;
use egui::{
    Align2, ColorImage, Rect, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo, pos2, vec2,
};

/// A small picture is about so wide.
const WIDTH: f32 = 80.0;
/// Height of a line under a picture.
const LINE: f32 = 15.0;

/// Shows the steps; `enlarged` is the one that is shown large, by its place. `key` changes with what is shown.
pub(super) fn show(ui: &mut Ui, steps: &Segmentation, key: u64, enlarged: &mut Option<usize>) {
    let Some(mask) = steps.mask() else { return };
    let size = [mask.width(), mask.height()];
    let gap = space::ROW;
    let room = ui.available_width();
    let columns = ((room + gap) / (WIDTH + gap)).floor().max(1.0);
    let width = (room - gap * (columns - 1.0)) / columns;
    let height = |width: f32| width * size[1] as f32 / size[0].max(1) as f32;
    if let Some(place) = enlarged.filter(|place| *place <= steps.stages.len()) {
        let (rect, response) = ui.allocate_exact_size(vec2(room, height(room)), Sense::CLICK);
        paint(ui, rect, place, steps, key, size);
        let name = format!("{} step, large", cell_words(steps, place).0);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name.as_str()));
        tell(&response, rect, steps, size);
        if response.clicked() {
            *enlarged = None;
        }
        ui.add_space(gap);
    }
    let cell = vec2(width, height(width) + 2.0 * LINE);
    let count = steps.stages.len() + 1;
    for row in 0..count.div_ceil(columns as usize) {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = gap;
            for place in (row * columns as usize..count).take(columns as usize) {
                small(ui, cell, place, steps, key, enlarged);
            }
        });
        ui.add_space(gap);
    }
}

/// A step's name, what it does, and how many pixels it has changed.
fn cell_words(steps: &Segmentation, place: usize) -> (&'static str, &'static str, String) {
    let Some(at) = place.checked_sub(1) else {
        let what = "By how much each pixel differs from the background: middle grey is the threshold";
        return ("Difference", what, String::new());
    };
    let (name, what) = stage_words(steps.stages[at].stage);
    let counted = |px: usize| format::count(px as i64);
    let change = match at.checked_sub(1) {
        None => {
            let subject = backlit_tracking::silhouette::Label::Subject;
            format!("{} px", counted(steps.stages[at].mask.count(subject)))
        }
        Some(before) => {
            let [more, less] = subject_change(&steps.stages[before].mask, &steps.stages[at].mask);
            match (more, less) {
                (0, 0) => "unchanged".to_owned(),
                (_, 0) => format!("+{} px", counted(more)),
                (0, _) => format!("−{} px", counted(less)),
                _ => format!("+{} −{} px", counted(more), counted(less)),
            }
        }
    };
    (name, what, change)
}

fn small(
    ui: &mut Ui,
    cell: Vec2,
    place: usize,
    steps: &Segmentation,
    key: u64,
    enlarged: &mut Option<usize>,
) {
    let palette = theme::palette(ui);
    let Some(mask) = steps.mask() else { return };
    let size = [mask.width(), mask.height()];
    let (rect, response) = ui.allocate_exact_size(cell, Sense::CLICK);
    let picture = Rect::from_min_size(rect.min, cell - vec2(0.0, 2.0 * LINE));
    paint(ui, picture, place, steps, key, size);
    let (name, what, change) = cell_words(steps, place);
    let edge =
        if *enlarged == Some(place) || response.hovered() { palette.accent_text } else { palette.line };
    ui.painter().rect_stroke(picture, 0.0, Stroke::new(1.0, edge), StrokeKind::Inside);
    let line = |index: f32| pos2(rect.left(), picture.bottom() + (index + 0.5) * LINE);
    paint_text(ui, line(0.0), Align2::LEFT_CENTER, name, TextStyle::Small, palette.text);
    paint_text(ui, line(1.0), Align2::LEFT_CENTER, &change, TextStyle::Small, palette.text3);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{name} step {change}")));
    if response.clicked() {
        *enlarged = (*enlarged != Some(place)).then_some(place);
    }
    response.on_hover_text(format!("{what}. Click: show it large"));
}

/// Says what decided the pixel under the pointer.
fn tell(response: &egui::Response, rect: Rect, steps: &Segmentation, size: [usize; 2]) {
    let Some(at) = response.hover_pos() else { return };
    let share = (at - rect.min) / rect.size();
    let pixel = [0, 1].map(|axis| ((share[axis] * size[axis] as f32) as usize).min(size[axis] - 1));
    if let Some(decided) = decision(steps, pixel[1] * size[0] + pixel[0]) {
        let text = format!("Pixel {}, {}: {decided}", pixel[0], pixel[1]);
        response.clone().on_hover_text_at_pointer(text);
    }
}

fn paint(ui: &Ui, rect: Rect, place: usize, steps: &Segmentation, key: u64, size: [usize; 2]) {
    let id = ui.scope_id().with(("step", place));
    let is_crisp = rect.width() > 2.0 * size[0] as f32;
    let texture = cached_texture(ui.ctx(), id, (key, place), is_crisp, || -> ColorImage {
        match place.checked_sub(1) {
            None => excess_picture(steps, size),
            Some(at) => mask_picture(&steps.stages[at].mask),
        }
    });
    paint_whole(ui.painter(), &texture, rect);
}
