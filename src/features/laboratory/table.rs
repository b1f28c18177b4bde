//! The curves as text and as a figure.

use std::fmt::Write as _;

use backlit_plot::{Axis, Figure, Line};

use super::Comparison;

/// The least height on the logarithmic axis, percent of the start.
pub(crate) const LEAST_PERCENT: f64 = 0.01;

/// One line a step: for every fit its cost and its percent of the start. A field is empty once its fit has ended.
pub(crate) fn csv(comparison: &Comparison) -> String {
    let mut text = "step".to_owned();
    for fit in &comparison.contestants {
        let name = fit.entrant.name.to_lowercase().replace(' ', "_");
        let _ = write!(text, ",{name}_cost,{name}_percent");
    }
    text.push('\n');
    for step in 0..=comparison.last() {
        text += &step.to_string();
        for fit in &comparison.contestants {
            match (fit.steps.get(step), fit.percent(step)) {
                (Some(at), Some(percent)) => {
                    let _ = write!(text, ",{:?},{percent:?}", at.mismatch);
                }
                (Some(at), None) => {
                    let _ = write!(text, ",{:?},", at.mismatch);
                }
                (None, _) => text += ",,",
            }
        }
        text.push('\n');
    }
    text
}

/// The plot as a picture of its own.
pub(crate) fn figure(comparison: &Comparison, title: &str, subtitle: &str, is_log: bool) -> Figure {
    let lines = comparison.contestants.iter().enumerate();
    let label = "cost, % of the start";
    Figure {
        title: title.to_owned(),
        subtitle: subtitle.to_owned(),
        x: Axis::linear("step"),
        y: if is_log { Axis::log(label).within(LEAST_PERCENT, 150.0) } else { Axis::linear(label) },
        lines: lines.map(|(style, fit)| Line::of_values(fit.entrant.name, style, &fit.percents())).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::laboratory::comparison::tests::comparison;

    #[test]
    fn the_table_has_a_line_for_every_step() {
        let found = csv(&comparison([&[8.0, 4.0, 2.0], &[10.0, 1.0], &[0.0]]));
        let lines: Vec<&str> = found.lines().collect();
        assert_eq!(
            lines[0],
            "step,cylinder_cost,cylinder_percent,capsule_cost,capsule_percent,sphere_tree_cost,sphere_tree_percent"
        );
        assert_eq!(lines[1], "0,8.0,100.0,10.0,100.0,0.0,");
        assert_eq!(lines[3], "2,2.0,25.0,,,,");
        assert_eq!(lines.len(), 4);
    }
}
