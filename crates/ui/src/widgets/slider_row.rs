//! A row with a name, a slider and a field for one number.

use std::ops::RangeInclusive;

use egui::{CornerRadius, DragValue, Response, RichText, Sense, TextStyle, Ui, vec2};

use super::slider::ValueSlider;
use crate::style::format;
use crate::style::theme;
use crate::style::theme::{size, space};

/// Width of the name before the slider.
const NAME: f32 = 68.0;
/// Width of the field.
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

impl SliderRow<'_> {
    /// The row. The response is of the slider and the field together.
    pub fn show(&self, ui: &mut Ui, value: &mut f64) -> Response {
        let before = *value;
        let row = ui.horizontal(|ui| {
            ui.set_height(size::SLIDER_ROW);
            ui.spacing_mut().item_spacing.x = space::WIDGET;
            row_name(ui, self.name, NAME);
            let width = (ui.available_width() - FIELD - space::WIDGET).max(60.0);
            let mut slider = ValueSlider::new(value, self.range.clone(), self.name)
                .origin(self.origin)
                .held(self.is_held)
                .width(width);
            if let Some((low, high, warn_within)) = self.limits {
                // Where the pose already lies outside, it may only come back.
                slider = slider.limits(low.min(before), high.max(before), warn_within);
            }
            let slider = ui.add(slider);
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
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().text(rect.left_center(), egui::Align2::LEFT_CENTER, name, font, palette.text2);
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
pub fn hint(ui: &mut Ui, text: &str) {
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
