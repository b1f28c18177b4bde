//! Singular values of JᵀJ, relative to the largest, on a logarithmic scale: one bar a direction, null ones hatched below the
//! line of what is nothing but rounding.

use backlit_document::observability_words as words;
use backlit_tracking::observability::Observability as Figures;
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use egui::text::{LayoutJob, TextFormat};
use egui::{
    Align, Align2, Color32, EventFilter, FontId, Key, Painter, Rect, Response, Role, Sense, Shape, Stroke,
    TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use crate::features::observability::Observability;

const HEIGHT: f32 = 124.0;
/// Room of the numbers at its left.
const AXIS: f32 = 38.0;
/// Space within the well.
const INSET: f32 = 6.0;
/// Below the line of rounding.
const FLOOR: f32 = 12.0;
const WIDEST: f32 = 9.0;
/// Decades between two ticks.
const TICK_DECADES: i32 = 3;
/// Size of the ticks, and of a raised letter.
const TICK: f32 = 11.0;
const RAISED: f32 = 9.0;
/// Between lines of the hatch.
const HATCH: f32 = 5.0;

/// Where things are in the chart.
struct Places {
    /// The well.
    area: Rect,
    bars: Rect,
    /// Where a relative value of one is, and that of the threshold.
    top: f32,
    line: f32,
    decades: f32,
    pitch: f32,
}

impl Places {
    fn new(area: Rect, shown: &Figures) -> Self {
        let bars = Rect::from_min_max(
            pos2(area.left() + AXIS, area.top() + INSET),
            pos2(area.right() - INSET, area.bottom() - 2.0),
        );
        let line = bars.bottom() - FLOOR;
        let decades = -(shown.null_below.max(1e-300).log10() as f32);
        let pitch = bars.width() / shown.directions.len().max(1) as f32;
        Self { area, bars, top: bars.top() + 4.0, line, decades, pitch }
    }

    /// Height of a relative value.
    fn y(&self, relative: f64) -> f32 {
        let down = -(relative.max(1e-300).log10() as f32) / self.decades;
        self.top + down.clamp(0.0, 1.0) * (self.line - self.top)
    }

    fn column(&self, index: usize) -> Rect {
        let left = self.bars.left() + index as f32 * self.pitch;
        Rect::from_x_y_ranges(left..=left + self.pitch, self.area.y_range())
    }

    fn bar(&self, index: usize, relative: f64, is_null: bool) -> Rect {
        let column = self.column(index);
        let width = (column.width() - 1.0).clamp(1.0, WIDEST);
        let (top, bottom) =
            if is_null { (self.line + 2.0, self.bars.bottom() - 1.0) } else { (self.y(relative), self.line) };
        Rect::from_center_size(column.center(), vec2(width, 0.0))
            .with_min_y(top.min(bottom - 1.0))
            .with_max_y(bottom)
    }

    fn index_at(&self, x: f32, count: usize) -> usize {
        (((x - self.bars.left()) / self.pitch).max(0.0) as usize).min(count.saturating_sub(1))
    }
}

/// The chart with its caption. A click on a bar, or the arrow keys, look at a direction; the body sways along it.
pub(super) fn ui(ui: &mut Ui, observability: &mut Observability, shown: &Figures) {
    let (area, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click());
    let places = Places::new(area, shown);
    let count = shown.directions.len();
    let picked = observability.picked().unwrap_or_default();
    let label = format!("Singular values, direction {} of {count}", picked + 1);
    response.widget_info(|| WidgetInfo::labeled(Role::ListBox, ui.is_enabled(), &label));
    let hovered = response.hover_pos().map(|at| places.index_at(at.x, count));
    if response.clicked()
        && let Some(at) = response.interact_pointer_pos()
    {
        response.request_focus();
        observability.sway_along(places.index_at(at.x, count));
    }
    keys(ui, &response, observability, count);
    paint(ui, &places, observability, shown, hovered);
    if response.has_focus() {
        let ring = theme::palette(ui).focus_ring();
        ui.painter().rect_stroke(area.expand(1.0), size::FIELD_RADIUS, ring, egui::StrokeKind::Outside);
    }
    if let Some(direction) = hovered.and_then(|hovered| shown.directions.get(hovered)) {
        let value = if direction.is_null { "null".to_owned() } else { format::cost(direction.relative) };
        let index = hovered.unwrap_or_default() + 1;
        let text = format!(
            "Direction {index} of {count}: {}\n{value}. Click to sway along it.",
            words::title(shown, direction)
        );
        response.on_hover_text_at_pointer(text);
    }
    caption(ui, shown);
}

/// With the focus: arrows go from bar to bar, Enter and Space play and hold.
fn keys(ui: &Ui, response: &Response, observability: &mut Observability, count: usize) {
    if !response.has_focus() {
        return;
    }
    let arrows = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let presses = |key| ui.input(|input| input.num_presses(key)) as isize;
    let picked = observability.picked().unwrap_or_default();
    let by = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
    let to = picked.saturating_add_signed(by).min(count.saturating_sub(1));
    if to != picked {
        observability.pick(to);
    }
    if presses(Key::Space) + presses(Key::Enter) > 0 {
        observability.toggle_sway();
    }
}

fn paint(ui: &Ui, places: &Places, observability: &Observability, shown: &Figures, hovered: Option<usize>) {
    let palette = theme::palette(ui);
    let painter = ui.painter();
    painter.rect_filled(places.area, size::FIELD_RADIUS, palette.plot);
    ticks(painter, places, palette.grid, palette.text2);
    let plain = if observability.is_stale() { palette.active } else { palette.line2 };
    let nulls = shown.null_count();
    let count = shown.directions.len();
    if nulls > 0 {
        let first = places.column(count - nulls);
        let floor = Rect::from_min_max(pos2(first.left(), places.line + 1.0), places.bars.max);
        hatch(&painter.with_clip_rect(floor.intersect(painter.clip_rect())), floor, palette.line2);
    }
    for (index, direction) in shown.directions.iter().enumerate() {
        let bar = places.bar(index, direction.relative, direction.is_null);
        let is_picked = observability.picked() == Some(index);
        if hovered == Some(index) && !is_picked {
            painter.rect_filled(places.column(index).shrink2(vec2(0.0, 2.0)), 0.0, palette.grid);
        }
        let colour = match (is_picked, hovered == Some(index)) {
            (true, _) => palette.accent,
            (false, true) => palette.text2,
            (false, false) => plain,
        };
        if is_picked || !direction.is_null || hovered == Some(index) {
            painter.rect_filled(bar, 1.0, colour);
            if is_picked && palette.accent_edge != Stroke::NONE {
                painter.rect_stroke(bar, 1.0, palette.accent_edge, egui::StrokeKind::Inside);
            }
        }
    }
    let dashes = [pos2(places.bars.left(), places.line + 0.5), pos2(places.bars.right(), places.line + 0.5)];
    painter.extend(Shape::dashed_line(&dashes, Stroke::new(1.0, palette.text3), 4.0, 3.0));
    if nulls > 0 {
        let font = TextStyle::Small.resolve(ui.style());
        let right = pos2(places.bars.right(), places.line - 3.0);
        let text = format!("{nulls} unseen");
        let galley = painter.layout_no_wrap(text, font, palette.text3);
        // It stands over the null ones where they have room for it, else at the top.
        let room = nulls as f32 * places.pitch;
        let at = if galley.size().x <= room { right.y - galley.size().y } else { places.area.top() + 4.0 };
        painter.galley(pos2(right.x - galley.size().x, at), galley, palette.text3);
    }
}

fn ticks(painter: &Painter, places: &Places, grid: Color32, text: Color32) {
    let last = places.decades.floor() as i32;
    for decade in (0..=last).step_by(TICK_DECADES as usize) {
        let y = places.y(10f64.powi(-decade)).round() + 0.5;
        painter.hline(places.bars.x_range(), y, Stroke::new(1.0, grid));
        let label = if decade == 0 { "1".to_owned() } else { format!("1e−{decade}") };
        let at = pos2(places.bars.left() - 5.0, y);
        painter.text(at, Align2::RIGHT_CENTER, label, FontId::monospace(TICK), text);
    }
}

fn hatch(painter: &Painter, area: Rect, colour: Color32) {
    let mut x = area.left() - area.height();
    while x < area.right() {
        let ends = [pos2(x, area.bottom()), pos2(x + area.height(), area.top())];
        painter.line_segment(ends, Stroke::new(1.0, colour));
        x += HATCH;
    }
}

/// What the bars are. The raised T is in neither font: it is set small and high.
fn caption(ui: &mut Ui, shown: &Figures) {
    let palette = theme::palette(ui);
    let font = TextStyle::Small.resolve(ui.style());
    let plain = TextFormat { font_id: font.clone(), color: palette.text3, ..TextFormat::default() };
    let raised =
        TextFormat { font_id: FontId::new(RAISED, font.family), valign: Align::TOP, ..plain.clone() };
    let mut job = LayoutJob::default();
    job.append("Singular values of J", 0.0, plain.clone());
    job.append("T", 0.0, raised);
    job.append("J, relative to the largest", 0.0, plain);
    job.wrap.max_width = ui.available_width();
    let tooltip = format!(
        "Of the silhouettes alone: priors and limits are left out. The root’s metres are measured in {} m, as far as \
         a radian moves the joints on average. Below the dashed line, {} of the largest, there is only rounding.",
        format::number(shown.lever_m, 2),
        format::cost(shown.null_below),
    );
    ui.label(job).on_hover_text(tooltip);
    ui.add_space(space::ROW);
}
