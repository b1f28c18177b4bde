//! One fit: percent of its start, its two pictures, its counts and the check of its gradient.

use std::hash::Hash;

use backlit_document::run::RunEnding;
use backlit_ui::drawing::{PictureInput, ViewMode, compose};
use backlit_ui::style::theme::data_colours::{CASING, PICTURE_GROUND, REPORT_GROUND, SELECTED};
use backlit_ui::style::theme::{Theme, run_style, size};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::image_canvas::{cached_texture, paint_picture, picture_bounds};
use backlit_ui::widgets::{
    ViewTransform, first_that_fits, fitting_label, paint_run_sample, paint_text, within,
};
use egui::{
    Align, Align2, Color32, Layout as Direction, Rect, RichText, Role, Sense, Stroke, TextStyle, Ui,
    WidgetInfo, pos2, vec2,
};
use glam::DVec2;

use super::{Bench, named};
use crate::features::laboratory::comparison::percent_text;
use crate::features::laboratory::{Checked, Contestant, LaboratoryChoices, Worst};
use crate::session::Extent;

/// Heights of head and foot.
const HEAD: f32 = 36.0;
const HEAD_COMPACT: f32 = 30.0;
const ROW: f32 = 20.0;
const FOOT_PADDING: f32 = 5.0;
/// Length of the piece of the curve in the head.
const SAMPLE: f32 = 24.0;
/// Narrower columns have no note behind the name.
const NOTE_FROM: f32 = 300.0;
/// Pixels between the two pictures.
const BETWEEN: f32 = 2.0;

pub(crate) fn ui(ui: &mut Ui, bench: &Bench<'_>, index: usize, choices: &mut LaboratoryChoices) {
    let (rect, fit) = (ui.max_rect(), &bench.comparison.contestants[index]);
    let head_height = if bench.room.is_compact { HEAD_COMPACT } else { HEAD };
    let rows = if bench.room.is_compact { 2.0 } else { 3.0 };
    let foot_height = rows * ROW + 2.0 * FOOT_PADDING;
    let (head, rest) = rect.split_top_bottom_at_y(rect.top() + head_height);
    let (pictures, foot) = rest.split_top_bottom_at_y(rect.bottom() - foot_height);
    let pictures = pictures.shrink2(vec2(1.0, 0.0));
    within(ui, head.shrink2(vec2(14.0, 0.0)), Direction::left_to_right(Align::Center), |ui| {
        header(ui, bench, index, fit, rect.width());
    });
    let marked = (bench.laboratory.choices.marked == Some(index)).then(|| checked(bench, fit)).flatten();
    let worst = worst_of(marked).filter(|worst| worst.camera == bench.key.0);
    let (upper, lower) = if is_stacked(bench, pictures) {
        let middle = pictures.center().y.round();
        let (upper, lower) = pictures.split_top_bottom_at_y(middle);
        (upper, lower.with_min_y(middle + BETWEEN))
    } else {
        let middle = pictures.center().x.round();
        let (left, right) = pictures.split_left_right_at_x(middle);
        (left, right.with_min_x(middle + BETWEEN))
    };
    overlay(ui, upper, bench, index, worst);
    push_picture(ui, lower, bench, index);
    let inner = foot.shrink2(vec2(14.0, FOOT_PADDING));
    within(ui, inner, Direction::top_down(Align::Min), |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        pushes(ui, bench, fit);
        gradient(ui, bench, index, choices);
        if !bench.room.is_compact {
            ending(ui, fit, worst_of(marked));
        }
    });
}

fn header(ui: &mut Ui, bench: &Bench<'_>, index: usize, fit: &Contestant, width: f32) {
    let palette = theme::palette(ui);
    let (sample, _) = ui.allocate_exact_size(vec2(SAMPLE, size::ROW), Sense::hover());
    let stroke = Stroke::new(size::CURVE_DEMONSTRATE + 0.5, run_style(index).colour);
    let ends = [sample.left_center(), sample.right_center()];
    paint_run_sample(ui.painter(), ends, index, stroke, 0.618);
    ui.label(RichText::new(fit.entrant.name).text_style(theme::column_heading()).color(palette.text));
    if width >= NOTE_FROM {
        ui.label(RichText::new(&fit.entrant.note).color(palette.text3));
    }
    ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
        let percent = fit.percent(bench.comparison.cursor);
        let text = percent.map_or_else(|| format::MISSING.to_owned(), |p| format!("{} %", percent_text(p)));
        let label = ui.label(RichText::new(text.clone()).text_style(theme::headline()).color(palette.text));
        named(&label, Role::Label, &format!("{} at {text}", fit.entrant.name));
        label.on_hover_text("Cost at this step, in percent of the cost at the start, by its own ramp");
    });
}

/// A name on the left, the longest of these that there is room for, and a value on the right that stays in its place.
fn line(ui: &mut Ui, names: &[&str], value: RichText) -> egui::Response {
    let palette = theme::palette(ui);
    let size = vec2(ui.available_width(), ROW);
    ui.allocate_ui_with_layout(size, Direction::right_to_left(Align::Center), |ui| {
        ui.label(value.monospace());
        ui.with_layout(Direction::left_to_right(Align::Center), |ui| {
            fitting_label(ui, names, TextStyle::Body, palette.text2);
        });
    })
    .response
}

fn pushes(ui: &mut Ui, bench: &Bench<'_>, fit: &Contestant) {
    let palette = theme::palette(ui);
    let (text, is_fresh) = fit.pushed.as_ref().map_or_else(
        || (format::MISSING.to_owned(), false),
        |(key, pushed)| (pushed.text(), *key == bench.key),
    );
    let colour = if is_fresh { palette.text } else { palette.text3 };
    let name = bench.axis.pixels();
    let response = line(ui, &[name, "Pushing pixels", "Pushing"], RichText::new(&text).color(colour));
    named(&response, Role::Label, &format!("{}, {name}: {text}", fit.entrant.name));
    response.on_hover_text(
        "Pixels of the ramp whose grey changes as the limb moves that way, by at least 1 % of the strongest \
         change in all these fits. The second number counts all pixels of the ramp: those neither black nor \
         white",
    );
}

/// The check that belongs to what is shown.
fn checked<'a>(bench: &Bench<'_>, fit: &'a Contestant) -> Option<&'a Checked> {
    let pose = fit.pose(bench.comparison.cursor)?;
    fit.checked.as_ref().filter(|checked| checked.pose == *pose)
}

fn worst_of(checked: Option<&Checked>) -> Option<&Worst> {
    checked?.progress.worst.as_ref()
}

fn gradient(ui: &mut Ui, bench: &Bench<'_>, index: usize, choices: &mut LaboratoryChoices) {
    let palette = theme::palette(ui);
    let fit = &bench.comparison.contestants[index];
    let fresh = checked(bench, fit);
    // How much is done, in whole percent.
    let done = fresh.map_or(0, |checked| 100 * checked.progress.done / checked.progress.total.max(1));
    let progress = fresh.or(fit.checked.as_ref()).map(|checked| &checked.progress);
    let is_whole = fresh.is_some_and(|checked| checked.progress.is_whole());
    let cameras = bench.comparison.basis.scene.cameras.len();
    let name = match fresh {
        None if bench.laboratory.check_broke_down() => "Gradient check, broke down".to_owned(),
        Some(_) if !is_whole && bench.laboratory.check_broke_down() => {
            format!("Gradient check, broke down at {done} %")
        }
        Some(_) if !is_whole => format!("Gradient check, {done} % done"),
        None if bench.laboratory.is_running() => "Gradient check, after the run".to_owned(),
        None => "Gradient check, computing".to_owned(),
        Some(checked) => match &checked.progress.worst {
            Some(worst) if cameras > 1 => format!("Gradient check, worst in camera {}", worst.camera + 1),
            _ => "Gradient check, worst pixel".to_owned(),
        },
    };
    let value =
        progress.map_or_else(|| format::MISSING.to_owned(), |progress| format::cost(progress.largest_error));
    let fails = progress.is_some_and(|progress| !progress.passes());
    let colour = match (fails, is_whole) {
        (true, _) => palette.error,
        (false, true) => palette.ok,
        (false, false) => palette.text3,
    };
    let text = if fails { format!("fails  {value}") } else { value.clone() };
    let (_, state) = name.split_once(", ").unwrap_or_default();
    let short = format!("Gradient, {}", state.trim_start_matches("worst in "));
    let row = line(ui, &[&name, &short, "Gradient"], RichText::new(text).color(colour));
    let response = ui.interact(row.rect, ui.scope_id().with("gradient check"), Sense::click());
    let is_marked = bench.laboratory.choices.marked == Some(index);
    let label = format!("Gradient check of {}: {value}", fit.entrant.name);
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_marked, label.clone()));
    if response.hovered() || is_marked || response.has_focus() {
        let y = row.rect.bottom() - 2.5;
        ui.painter().hline(row.rect.x_range(), y, Stroke::new(1.0, palette.line2));
    }
    if response.hovered() {
        ui.set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    let tooltip = fresh.map_or_else(
        || "The analytic Jacobian against central differences, at this step in all cameras".to_owned(),
        |checked| explained(bench, checked, is_marked),
    );
    if response.on_hover_text(tooltip).clicked() {
        // A mark in another camera is gone to first.
        let is_seen = worst_of(fresh).is_none_or(|worst| worst.camera == bench.key.0);
        choices.marked = (!is_marked || !is_seen).then_some(index);
        let worst = choices.marked.and_then(|_| worst_of(fit.checked.as_ref()));
        choices.camera = worst.map_or(choices.camera, |worst| worst.camera);
    }
}

fn pixel_words(worst: &Worst) -> String {
    let [x, y] = worst.pixel;
    format!(
        "Camera {}, pixel ({x}, {y}), column {}: analytic {}, differences {}",
        worst.camera + 1,
        worst.column,
        figures(worst.analytic),
        figures(worst.numeric)
    )
}

/// Seven figures: enough to see where two numbers part.
fn figures(value: f64) -> String {
    let decimals = 6 - (value.abs().max(1e-9).log10().floor() as i32).clamp(-3, 6);
    format::number(value, decimals.max(0) as usize)
}

fn explained(bench: &Bench<'_>, checked: &Checked, is_marked: bool) -> String {
    let progress = &checked.progress;
    let count = |n: usize| format::count(n as i64);
    let worst = progress.worst.as_ref().map_or_else(String::new, |worst| pixel_words(worst) + ".\n");
    let is_seen = progress.worst.as_ref().is_none_or(|worst| worst.camera == bench.key.0);
    let click = match (is_marked, is_seen) {
        (true, true) => "Click to take the mark away",
        (false, true) => "Click to mark the pixel",
        (_, false) => "Click to see the pixel, in its camera",
    };
    let cameras = bench.comparison.basis.scene.cameras.len();
    let of = if cameras == 1 { String::new() } else { format!(" in {cameras} cameras") };
    format!(
        "{worst}{} derivatives{of} compared with central differences, {} differ, {} skipped at kinks; the number is the \
         largest difference over the largest derivative of its column.\n{click}",
        count(progress.compared),
        count(progress.mismatches),
        count(progress.skipped)
    )
}

/// How the fit ended, or the marked pixel's numbers.
fn ending(ui: &mut Ui, fit: &Contestant, marked: Option<&Worst>) {
    let palette = theme::palette(ui);
    let text = match &fit.ending {
        Some(RunEnding::Solver(words)) => format!("Stopped at step {}: {words}", fit.last()),
        Some(RunEnding::Stopped) => format!("Stopped by you at step {}", fit.last()),
        None if fit.last() == 0 => "Not stepped yet".to_owned(),
        None => format!("{} so far", format::counted(fit.last(), "step")),
    };
    let (text, short, colour) = match marked {
        Some(worst) => {
            let [x, y] = worst.pixel;
            (
                pixel_words(worst),
                format!("Camera {}, pixel ({x}, {y})", worst.camera + 1),
                palette.accent_text,
            )
        }
        None => {
            // Without what made it stop.
            let first = text.splitn(3, ": ").take(2).collect::<Vec<_>>().join(": ");
            (text, first, palette.text3)
        }
    };
    let room = vec2(ui.available_width(), ROW);
    ui.allocate_ui_with_layout(room, Direction::left_to_right(Align::Center), |ui| {
        fitting_label(ui, &[&text, &short], TextStyle::Small, colour);
    });
}

/// Space around data and start, as a share of their larger side.
const PADDING: f32 = 0.12;
/// Room of the line above the picture.
const LABEL: f32 = 24.0;
/// The mark of the worst pixel: gap between pixel and ring, and its widths.
const RING_GAP: f32 = 5.0;
const RING: f32 = 1.6;
const RING_CASING: f32 = 3.6;

/// Whether two pictures of the camera are larger one above the other than side by side in `area`.
fn is_stacked(bench: &Bench<'_>, area: Rect) -> bool {
    let Some(crop) = crop(bench) else { return true };
    let scale = |width: f32, height: f32| (width / crop.width()).min((height - LABEL) / crop.height());
    scale(area.width(), 0.5 * area.height()) >= scale(0.5 * area.width(), area.height())
}

/// What the pictures show, in pixel coordinates of the camera.
fn crop(bench: &Bench<'_>) -> Option<Rect> {
    let camera = bench.key.0;
    let size = bench.comparison.basis.scene.cameras.get(camera).map(|c| [c.width(), c.height()])?;
    let extent: Option<Extent> = bench.comparison.extents.get(camera).copied().flatten();
    let rect = extent.map_or_else(
        || picture_bounds(size),
        |[left, top, right, bottom]| Rect::from_min_max(pos2(left, top), pos2(right, bottom)).expand(0.5),
    );
    Some(rect.expand(PADDING * rect.size().max_elem()))
}

fn view_of(bench: &Bench<'_>, rect: Rect) -> Option<ViewTransform> {
    let crop = crop(bench)?;
    let below = rect.with_min_y(rect.top() + LABEL.min(0.3 * rect.height()));
    let scale = (below.width() / crop.width()).min(below.height() / crop.height());
    // The subject keeps clear of the line above; what lies around it may reach under that.
    let centre_px = crop.center() - vec2(0.0, (below.center().y - rect.center().y) / scale);
    Some(ViewTransform { rect, points_per_px: scale, centre_px })
}

/// The report's overlay at this step, with the worst pixel if that is marked.
fn overlay(ui: &Ui, rect: Rect, bench: &Bench<'_>, index: usize, mark: Option<&Worst>) {
    let fit = &bench.comparison.contestants[index];
    let response = ui.interact(rect, ui.scope_id().with("overlay"), Sense::hover());
    named(&response, Role::Image, &format!("{}, data and model", fit.entrant.name));
    let ground = Color32::from_gray(REPORT_GROUND);
    ui.painter().rect_filled(rect, 0.0, ground);
    let camera = bench.key.0;
    let shown = fit.shown.as_ref();
    let parts = shown.and_then(|shown| Some((shown, shown.cameras.get(camera)?)));
    let (Some(view), Some((shown, prediction))) = (view_of(bench, rect), parts) else { return };
    let frame = bench.comparison.basis.scene.frame.as_ref().and_then(|frame| frame.cameras.get(camera));
    let size = [prediction.prediction.width, prediction.prediction.height];
    let input = PictureInput {
        mask: frame.and_then(|frame| frame.mask.as_deref()),
        data: prediction.data.as_ref().map(|data| data.measurement()),
        prediction: Some(&prediction.prediction),
        ..PictureInput::empty(size)
    };
    let pose: Vec<u64> = shown.pose.to_state().iter().map(|x| x.to_bits()).collect();
    let mode = ViewMode::ReportOverlay;
    paint_texture(ui, "overlay texture", &view, (bench.comparison.id, index, camera, pose), mode, &input);
    if let Some(worst) = mark {
        paint_mark(ui, &view, worst);
    }
    let words = ["Data black, model white, both grey", "Data black, model white", "Data and model"];
    label(ui, rect, &words, Color32::from_gray(0x20));
}

/// What pushes at the start; pixels of the ramp that do not are hatched.
fn push_picture(ui: &Ui, rect: Rect, bench: &Bench<'_>, index: usize) {
    let fit = &bench.comparison.contestants[index];
    let response = ui.interact(rect, ui.scope_id().with("push"), Sense::hover());
    let words = format!("At the start: what {}", bench.axis.verb(bench.limb));
    named(&response, Role::Image, &format!("{}, what pushes at the start", fit.entrant.name));
    ui.painter().rect_filled(rect, 0.0, PICTURE_GROUND);
    if let (Some(view), Some((key, pushed))) = (view_of(bench, rect), fit.pushed.as_ref()) {
        // Of another camera it would lie in the wrong place.
        if key.0 == bench.key.0 {
            let size = [pushed.prediction.width, pushed.prediction.height];
            let input = PictureInput {
                prediction: Some(&pushed.prediction),
                jacobian: Some(&pushed.picture),
                ..PictureInput::empty(size)
            };
            let mode = ViewMode::JacobianColumn;
            paint_texture(ui, "push texture", &view, (bench.comparison.id, index, *key), mode, &input);
        }
    }
    let colour = theme::colours(Theme::Dark).text2;
    label(ui, rect, &[&words, "What pushes at the start", "What pushes"], colour);
}

fn paint_texture(
    ui: &Ui,
    salt: &str,
    view: &ViewTransform,
    key: impl Hash,
    mode: ViewMode,
    input: &PictureInput<'_>,
) {
    let is_crisp = view.is_crisp(ui.ctx().pixels_per_point());
    let texture = cached_texture(ui.ctx(), ui.scope_id().with(salt), key, is_crisp, || compose(mode, input));
    paint_picture(&ui.painter_at(view.rect), view, input.size, &texture);
}

/// One line in the upper left corner: the first of these texts that there is room for.
fn label(ui: &Ui, rect: Rect, texts: &[&str], colour: Color32) {
    let at = rect.left_top() + vec2(12.0, 7.0);
    let room = rect.width() - 24.0;
    if let Some(text) = first_that_fits(ui, texts, &TextStyle::Small, room) {
        paint_text(ui, at, Align2::LEFT_TOP, text, TextStyle::Small, colour);
    }
}

/// A ring around the pixel, and its numbers.
fn paint_mark(ui: &Ui, view: &ViewTransform, worst: &Worst) {
    let [x, y] = worst.pixel;
    let at = view.screen_from_px(DVec2::new(x as f64, y as f64));
    let radius = 0.5 * view.points_per_px + RING_GAP;
    let painter = ui.painter_at(view.rect);
    painter.circle_stroke(at, radius, Stroke::new(RING_CASING, CASING));
    painter.circle_stroke(at, radius, Stroke::new(RING, SELECTED));
    let font = TextStyle::Small.resolve(ui.style());
    let text = format!("({x}, {y})");
    let galley = painter.layout_no_wrap(text.clone(), font.clone(), SELECTED);
    let size = galley.size() + vec2(8.0, 4.0);
    let free = view.rect.shrink(2.0);
    let right = at.x + radius + 4.0;
    let left = if right + size.x > free.right() { at.x - radius - 4.0 - size.x } else { right };
    let top = (at.y - 0.5 * size.y).clamp(free.top(), (free.bottom() - size.y).max(free.top()));
    let tag = Rect::from_min_size(pos2(left, top), size);
    painter.rect_filled(tag, 3.0, CASING);
    painter.text(tag.center(), Align2::CENTER_CENTER, text, font, SELECTED);
}
