//! A slider of a number, and a row of it with its name and a number field.

use std::ops::RangeInclusive;

use egui::{
    Context, CornerRadius, DragValue, EventFilter, Id, Key, Rect, Response, RichText, Sense, Stroke,
    TextStyle, Ui, Widget, WidgetInfo, pos2, vec2,
};

use super::buttons::focus_ring;
use super::cards::paint_text;
use crate::style::theme::{size, space};
use crate::style::{format, theme};

const HANDLE_RADIUS: f32 = 6.0;

const LIMIT_HEIGHT: f32 = 16.0;

/// The share of the range by which an arrow key moves the handle.
const KEY_STEP: f64 = 0.01;

/// A horizontal slider without a number field of its own.
///
/// Dragging and clicking set the value; with the keyboard focus the left and right arrows move it by one
/// hundredth of the range. The value is always kept within the range and, if there are any, the limits.
#[must_use = "a slider is shown with `ui.add`"]
#[derive(Debug)]
pub struct ValueSlider<'a> {
    /// What it sets.
    pub value: &'a mut f64,
    /// Its ends.
    pub range: RangeInclusive<f64>,
    /// Its name for screen readers and tests.
    pub label: &'a str,
    /// The trail runs from this value to the handle: at first the start of the range.
    pub origin: f64,
    /// Limits that are marked and between which the value is held, and how near to them the mark warns.
    pub limits: Option<(f64, f64, f64)>,
    /// The trail is in the accent: for what the user holds.
    pub is_held: bool,
    /// Points.
    pub width: f32,
}

impl<'a> ValueSlider<'a> {
    /// A slider over `range`, without limits.
    pub fn new(value: &'a mut f64, range: RangeInclusive<f64>, label: &'a str) -> Self {
        let origin = *range.start();
        Self { value, range, label, origin, limits: None, is_held: false, width: 124.0 }
    }

    fn set(&mut self, value: f64) {
        if value.is_finite() {
            let (low, high, _) = self.limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY, 0.0));
            *self.value = value.max(low).min(high).max(*self.range.start()).min(*self.range.end());
        }
    }

    fn interact(&mut self, ui: &Ui, rail: Rect, response: &mut Response) {
        let before = *self.value;
        let span = self.range.end() - self.range.start();
        if let Some(pointer) = response.interact_pointer_pos() {
            let share = f64::from((pointer.x - rail.left()) / rail.width());
            self.set(self.range.start() + share.clamp(0.0, 1.0) * span);
        }
        if response.has_focus() {
            hold_arrows(ui, response);
            let presses = |key| ui.input(|input| input.num_presses(key)) as f64;
            let steps = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
            if steps != 0.0 {
                self.set(*self.value + steps * KEY_STEP * span);
            }
        }
        if *self.value != before {
            response.mark_changed();
        }
    }

    fn position(&self, rail: Rect, value: f64) -> f32 {
        let span = (self.range.end() - self.range.start()).max(f64::MIN_POSITIVE);
        let share = ((value - self.range.start()) / span).clamp(0.0, 1.0);
        rail.left() + rail.width() * share as f32
    }

    fn paint(&self, ui: &Ui, rail: Rect, response: &Response) {
        let palette = theme::palette(ui);
        let painter = ui.painter();
        let radius = CornerRadius::same(2);
        painter.rect_filled(rail, radius, palette.active);
        let handle = self.position(rail, *self.value);
        let origin = self.position(rail, self.origin);
        let mut trail = rail;
        trail.min.x = handle.min(origin);
        trail.max.x = handle.max(origin);
        let enabled = ui.is_enabled();
        let trail_colour = if self.is_held && enabled { palette.accent } else { palette.line2 };
        painter.rect_filled(trail, radius, trail_colour);
        if let Some((low, high, warn_within)) = self.limits {
            for limit in [low, high] {
                let is_near = (*self.value - limit).abs() <= warn_within;
                let colour = if is_near { palette.warn } else { palette.text3 };
                let x = self.position(rail, limit);
                let middle = rail.center().y;
                let ends = [pos2(x, middle - 0.5 * LIMIT_HEIGHT), pos2(x, middle + 0.5 * LIMIT_HEIGHT)];
                painter.line_segment(ends, Stroke::new(size::LIMIT_MARK, colour));
            }
        }
        let is_touched = response.hovered() || response.dragged();
        let fill = match (enabled, is_touched) {
            (false, _) => palette.line2,
            (true, false) => palette.text2,
            (true, true) => palette.text,
        };
        // A gap in the colour of the panel sets the handle off from its trail.
        let edge = Stroke::new(1.0, palette.panel);
        painter.circle(pos2(handle, rail.center().y), HANDLE_RADIUS, fill, edge);
        focus_ring(ui, response);
    }
}

/// The widget that takes the arrow keys while it has the focus, and no others.
#[derive(Clone, Copy, PartialEq, Eq)]
struct HoldsArrows(Id);

/// Keeps the left and right arrow keys for a slider that has the focus. Space and Enter, which a slider has no use for, stay
/// the window's, see [`focus_holds_arrows_only`].
pub fn hold_arrows(ui: &Ui, slider: &Response) {
    let arrows = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(slider.id, arrows));
    ui.data_mut(|data| data.insert_temp(Id::NULL, HoldsArrows(slider.id)));
}

/// Whether what has the focus takes the arrow keys and no others.
pub fn focus_holds_arrows_only(ctx: &Context) -> bool {
    let holder = ctx.data(|data| data.get_temp::<HoldsArrows>(Id::NULL));
    holder.is_some_and(|HoldsArrows(id)| ctx.memory(|memory| memory.has_focus(id)))
}

impl Widget for ValueSlider<'_> {
    fn ui(mut self, ui: &mut Ui) -> Response {
        let sense = Sense::click_and_drag();
        let (rect, mut response) = ui.allocate_exact_size(vec2(self.width, size::ROW), sense);
        let rail_size = vec2(rect.width() - 2.0 * HANDLE_RADIUS, ui.spacing().slider_rail_height);
        let rail = Rect::from_center_size(rect.center(), rail_size);
        self.interact(ui, rail, &mut response);
        let (enabled, value) = (ui.is_enabled(), *self.value);
        response.widget_info(|| WidgetInfo::slider(enabled, value, self.label));
        if ui.is_rect_visible(rect) {
            self.paint(ui, rail, &response);
        }
        response
    }
}

/// Width of the name before the slider.
const NAME: f32 = 68.0;
const FIELD: f32 = 68.0;
/// A field's drag over this many points runs through the range.
const DRAG_POINTS: f64 = 300.0;

/// What a row shows.
#[derive(Debug, Clone)]
pub struct SliderRow<'a> {
    /// The name, also for screen readers.
    pub name: &'a str,
    /// The unit behind the number: `°`, ` m`.
    pub unit: &'a str,
    /// Digits after the point.
    pub decimals: usize,
    /// Ends of the slider.
    pub range: RangeInclusive<f64>,
    /// Limits that are marked and at which it stops, and how near to them the mark warns.
    pub limits: Option<(f64, f64, f64)>,
    /// Where the filled part begins.
    pub origin: f64,
    /// Whether it is of what the user holds.
    pub is_held: bool,
    /// What it changes, in a sentence.
    pub tooltip: &'a str,
}

impl<'a> SliderRow<'a> {
    /// A row without limits, filled from the slider's lower end.
    pub fn new(
        name: &'a str,
        unit: &'a str,
        decimals: usize,
        range: RangeInclusive<f64>,
        tooltip: &'a str,
    ) -> Self {
        let origin = *range.start();
        Self { name, unit, decimals, range, limits: None, origin, is_held: false, tooltip }
    }

    /// The row. The response is of the slider and the field together.
    pub fn show(&self, ui: &mut Ui, value: &mut f64) -> Response {
        let before = *value;
        let row = ui.horizontal(|ui| {
            ui.set_height(size::SLIDER_ROW);
            ui.spacing_mut().item_spacing.x = space::WIDGET;
            row_name(ui, self.name, NAME);
            let slider = ui.add(ValueSlider {
                origin: self.origin,
                is_held: self.is_held,
                width: (ui.available_width() - FIELD - space::WIDGET).max(60.0),
                // Where the pose already lies outside, it may only come back.
                limits: self.limits.map(|(low, high, warn)| (low.min(before), high.max(before), warn)),
                ..ValueSlider::new(value, self.range.clone(), self.name)
            });
            let speed = (self.range.end() - self.range.start()) / DRAG_POINTS;
            let field = number_field(ui, self.name, value, self.decimals, self.unit, speed, FIELD);
            slider.union(field).on_hover_text(self.tooltip)
        });
        let mut response = row.inner;
        if let Some((low, high, _)) = self.limits {
            *value = value.clamp(low.min(before), high.max(before));
        }
        if *value != before {
            response.mark_changed();
        }
        response
    }
}

/// The name at the start of a row, in a column of its own.
pub fn row_name(ui: &mut Ui, name: &str, width: f32) {
    let palette = theme::palette(ui);
    let (rect, _) = ui.allocate_exact_size(vec2(width, size::ROW), Sense::hover());
    paint_text(ui, rect.left_center(), egui::Align2::LEFT_CENTER, name, TextStyle::Body, palette.text2);
}

/// A row of a section: its name, `width` points wide, and what can be chosen.
pub fn named_row(ui: &mut Ui, name: &str, width: f32, contents: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.set_min_height(size::BUTTON);
        ui.spacing_mut().item_spacing.x = space::ROW;
        row_name(ui, name, width);
        contents(ui);
    });
}

/// What a field is about, or its unit, small behind it.
pub fn hint(ui: &mut Ui, text: impl Into<String>) {
    ui.label(RichText::new(text).small().color(theme::palette(ui).text3));
}

/// A field for a number, named for screen readers: drag, or click and type.
pub fn number_field(
    ui: &mut Ui,
    name: &str,
    value: &mut f64,
    decimals: usize,
    unit: &str,
    speed: f64,
    width: f32,
) -> Response {
    let field = DragValue::new(value)
        .speed(speed)
        .custom_formatter(move |value, _| format!("{}{unit}", format::number(value, decimals)))
        .custom_parser(format::parse)
        .update_while_editing(false)
        .min_size(vec2(width, size::ROW));
    ui.name_inputs(format!("{name} value"), |ui| {
        ui.scope(|ui| {
            let palette = theme::palette(ui);
            let widgets = &mut ui.visuals_mut().widgets;
            for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
                state.weak_bg_fill = palette.field;
                state.bg_stroke = palette.hairline();
                state.corner_radius = CornerRadius::same(size::FIELD_RADIUS);
            }
            ui.add_sized(vec2(width, size::ROW), field)
        })
        .inner
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_value_stays_between_its_limits() {
        let mut value = 0.0;
        let mut slider = ValueSlider::new(&mut value, -2.0..=2.0, "Flexion");
        slider.limits = Some((-0.5, 1.5, 0.1));
        slider.set(9.0);
        assert_eq!(*slider.value, 1.5);
        slider.set(-9.0);
        assert_eq!(*slider.value, -0.5);
        slider.set(1.0);
        slider.set(f64::NAN);
        assert_eq!(*slider.value, 1.0);
    }

    #[test]
    fn positions_are_held_on_the_rail() {
        let mut value = 0.0;
        let slider = ValueSlider::new(&mut value, 0.0..=4.0, "Weight");
        let rail = Rect::from_min_max(pos2(10.0, 0.0), pos2(110.0, 3.0));
        assert_eq!(slider.position(rail, 1.0), 35.0);
        assert_eq!(slider.position(rail, 9.0), 110.0);
    }
}
