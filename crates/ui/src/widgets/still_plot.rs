//! A plot that the pointer neither moves nor zooms.

use backlit_plot::marks::{AxisSpan, Mark};
use egui::Vec2;
use egui_plot::{GridInput, GridMark, Plot};

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

/// The marks of an axis, as a plot takes them.
pub fn grid_marks(marks: fn(AxisSpan) -> Vec<Mark>) -> impl Fn(GridInput) -> Vec<GridMark> {
    move |input| {
        let span = AxisSpan { bounds: input.bounds, division: input.base_step_size };
        let of_plot = |mark: Mark| GridMark { value: mark.value, step_size: mark.step };
        marks(span).into_iter().map(of_plot).collect()
    }
}
