//! A plot that the pointer neither moves nor zooms.

use egui::Vec2;
use egui_plot::Plot;

use crate::style::theme::Palette;

/// A plot of a size in points: what it shows is what there is, and a click or the pointer over it means a point of it.
pub fn still_plot<'a>(name: &str, size: Vec2, palette: &Palette) -> Plot<'a> {
    Plot::new(name)
        .width(size.x)
        .height(size.y)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
        .label_formatter(|_| None)
        .grid_color(palette.grid)
}
