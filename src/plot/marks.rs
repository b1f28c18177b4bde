//! Where an axis has its marks: round numbers, on even and on logarithmic axes.

use egui_plot::{GridInput, GridMark};

/// With fewer marks at 1, 2 and 5 a logarithmic axis has even ones.
const LEAST_MARKS: usize = 3;

/// Marks at 1, 2 and 5 of each decade, or even ones where those are too few; the axis is of logarithms.
#[must_use]
pub fn decade_marks(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let decades = (low.floor() as i32)..=(high.ceil() as i32);
    let mark = |value: f64| GridMark { value: value.log10(), step_size: 1.0 };
    let marks = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| mark(digit * 10f64.powi(decade))));
    let marks: Vec<GridMark> = marks.filter(|mark| (low..=high).contains(&mark.value)).collect();
    if marks.len() >= LEAST_MARKS {
        return marks;
    }
    let even = even_marks(GridInput { bounds: (10f64.powf(low), 10f64.powf(high)), ..input });
    even.into_iter().filter(|even| even.value > 0.0).map(|even| mark(even.value)).collect()
}

/// Marks at even steps of 1, 2 or 5 times a power of ten.
#[must_use]
pub fn even_marks(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let rough = ((high - low) / 5.0).max(f64::MIN_POSITIVE);
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * decade).into_iter().find(|s| *s >= rough);
    let step = step.unwrap_or(rough);
    let marks = (low / step).ceil() as i64..=(high / step).floor() as i64;
    marks.map(|k| GridMark { value: k as f64 * step, step_size: step }).collect()
}

/// A mark's number with as many digits as its axis needs.
#[must_use]
pub fn number(value: f64, step: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.0e}");
    }
    let decimals = (-step.abs().max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}
