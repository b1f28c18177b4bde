//! The two menus of a tile's header: what the picture shows, and all the rest.

use backlit_ui::drawing::{Comparison, StateAxis, ViewMode};
use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{Framing, ValueSlider, checkbox};
use egui::{Button, RichText, Ui};

use super::{CameraTileInput, TileEvent, gutter};
use crate::context::view_settings::ViewSettings;

/// Width of the slider of the blink's rate.
const RATE_SLIDER: f32 = 96.0;
/// Least width of the menus.
const WIDTH: f32 = 220.0;

/// The view modes; below them what the mode is compared with, and the Jacobian's axis.
pub(crate) fn modes(ui: &mut Ui, input: &CameraTileInput<'_>, events: &mut Vec<TileEvent>) {
    ui.set_min_width(WIDTH);
    let tile = &input.tile;
    for mode in ViewMode::ALL {
        let entry = Button::new(mode.label()).shortcut_text(mode.key()).selected(mode == tile.mode);
        if ui.add(entry).on_hover_text(mode.tooltip()).clicked() {
            events.push(TileEvent::SetMode(mode));
            ui.close();
        }
    }
    ui.separator();
    for (comparison, text, key, tooltip) in [
        (Comparison::Wipe, "Wipe", "W", "Two modes side by side; drag the handle between them"),
        (Comparison::Blink, "Blink", "B", "Two modes one after the other: what differs seems to move"),
    ] {
        let is_on = tile.comparison == Some(comparison);
        let entry = Button::new(text).shortcut_text(key).selected(is_on);
        if ui.add(entry).on_hover_text(tooltip).clicked() {
            events.push(TileEvent::SetComparison((!is_on).then_some(comparison)));
        }
    }
    let title = format!("Compare with: {}", tile.other.label().to_lowercase());
    ui.menu_button(title, |ui| {
        for mode in ViewMode::ALL.into_iter().filter(|mode| *mode != tile.mode) {
            let is_other = tile.comparison.is_some() && mode == tile.other;
            let entry = Button::new(format!("With {}", mode.label().to_lowercase())).selected(is_other);
            if ui.add(entry).on_hover_text(mode.tooltip()).clicked() {
                events.push(TileEvent::CompareWith(mode));
            }
        }
    });
    blink_rate(ui, input, events);
    ui.separator();
    let settings = input.settings;
    ui.menu_button(format!("Jacobian: {}", settings.axis.label().to_lowercase()), |ui| {
        for axis in StateAxis::ALL {
            let tooltip = if axis.is_of_root() {
                "A move of the whole body along an axis of the world"
            } else {
                "A turn of the selected limb about an axis of its parent’s frame"
            };
            let entry = Button::new(axis.label()).selected(axis == settings.axis);
            if ui.add(entry).on_hover_text(tooltip).clicked() {
                events.push(TileEvent::SetSettings(ViewSettings { axis, ..settings }));
                ui.close();
            }
        }
    });
}

fn blink_rate(ui: &mut Ui, input: &CameraTileInput<'_>, events: &mut Vec<TileEvent>) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        ui.set_height(size::ROW);
        ui.add_space(space::WIDGET);
        ui.label(RichText::new("Rate").color(palette.text2));
        let mut rate = f64::from(input.settings.blink_hz);
        let slider = ValueSlider::new(&mut rate, ViewSettings::BLINK_HZ, "Blink rate").width(RATE_SLIDER);
        if ui.add(slider).on_hover_text("How often a blinking view changes").changed() {
            let settings = ViewSettings { blink_hz: rate as f32, ..input.settings };
            events.push(TileEvent::SetSettings(settings));
        }
        let text = format!("{} / s", backlit_ui::style::format::number(rate, 1));
        ui.label(RichText::new(text).monospace().color(palette.text2));
    });
}

/// Framing, marks, and the camera's use in the fit.
pub(crate) fn more(ui: &mut Ui, input: &CameraTileInput<'_>, has_link: bool, events: &mut Vec<TileEvent>) {
    ui.set_min_width(WIDTH);
    for (text, key, framing, tooltip) in [
        (
            "Fit subject",
            "F",
            Framing::Subject,
            "As large as possible with the subject of all frames in view; the wheel zooms from there",
        ),
        ("Whole picture", "A", Framing::Whole, "All that the camera saw"),
    ] {
        let entry = Button::new(text).shortcut_text(key).selected(input.tile.framing == framing);
        if ui.add(entry).on_hover_text(tooltip).clicked() {
            events.push(TileEvent::SetFraming(framing));
            ui.close();
        }
    }
    let mut is_linked = input.is_linked;
    if !has_link && checkbox(ui, &mut is_linked, "Zoom linked").changed() {
        events.push(TileEvent::SetLinked(is_linked));
    }
    ui.separator();
    let mut settings = input.settings;
    let marks = checkbox(ui, &mut settings.calibration_marks, "Calibration marks").on_hover_text(
        "Principal point, axes of the world, half-metre grid through its origin, edge of what the lens saw   Q",
    );
    let sides = checkbox(ui, &mut settings.side_marks, "Left, right and face").on_hover_text(
        "L and R beside hands and feet; a nose whose tip is filled where the body faces the camera",
    );
    let grid = checkbox(ui, &mut settings.pixel_grid, "Pixel grid")
        .on_hover_text("Lines between pixels where they are shown large");
    let spheres = checkbox(ui, &mut settings.spheres, "Spheres")
        .on_hover_text("With the sphere tree: a circle for each sphere of the body");
    if spheres.changed() || marks.changed() || sides.changed() || grid.changed() {
        events.push(TileEvent::SetSettings(settings));
    }
    ui.separator();
    gutter::show_fit_use(ui, input, events);
    ui.separator();
    let close = ui.add(Button::new("Close tile"));
    if close.on_hover_text("The View menu opens it again").clicked() {
        events.push(TileEvent::Close);
        ui.close();
    }
}
