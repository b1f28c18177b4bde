//! What is plotted of a run, the points of its curve, and the ends of the plot's axes. These are round numbers around what
//! is shown, so they move seldom while a run goes on, and never back.

use backlit_document::run::{Run, RunStep};
use backlit_ui::style::format;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Quantity {
    /// What is left of the start's cost, percent, as in the report's Fig. 5.1.
    #[default]
    Percent,
    /// The cost, squared grey levels.
    Cost,
    /// Root of the mean squared residual, grey levels.
    Rms,
    /// IoU of body and silhouettes.
    Iou,
    /// Mean distance of the joints from the take's reference, millimetres.
    JointError,
    /// Length of the step, metres and radians together.
    StepNorm,
    /// Damping of the step, as the fit's options count it.
    Damping,
    /// By how much the step lowered the cost, and by how much the linear model said it would, in percent of the
    /// cost before.
    Decrease,
}

pub(crate) struct QuantityWords {
    /// On its choice.
    pub(crate) name: &'static str,
    /// With its unit, above a plot that is a file.
    pub(crate) label: &'static str,
    /// What it is, in a sentence without its full stop.
    pub(crate) explanation: &'static str,
}

impl Quantity {
    /// All of them, in the order in which they are offered.
    pub(crate) const ALL: [Self; 8] = [
        Self::Percent,
        Self::Cost,
        Self::Rms,
        Self::Iou,
        Self::JointError,
        Self::StepNorm,
        Self::Damping,
        Self::Decrease,
    ];

    pub(crate) const fn words(self) -> QuantityWords {
        let (name, label, explanation) = match self {
            Self::Percent => (
                "Cost, % of start",
                "Cost in % of the start",
                "What is left of the start’s cost. Where the ramp changes, the curve goes on at the height it had; a branch \
                 begins where its run was",
            ),
            Self::Cost => (
                "Cost",
                "Cost in squared grey levels",
                "What the fit lowers: squared mismatch of body and silhouettes by the ramp of each step’s stage, and its priors",
            ),
            Self::Rms => (
                "RMS",
                "RMS in grey levels",
                "Root mean square of D − Λ over the pixels that count, in grey levels. All runs of a frame are measured \
                 by the last ramp of the first of them",
            ),
            Self::Iou => (
                "IoU",
                "IoU of body and silhouettes",
                "Area that body and silhouettes share, over the area that either covers, all cameras together",
            ),
            Self::JointError => (
                "Joint error",
                "Mean distance from the reference in mm",
                "Mean distance of the joints from the take’s reference, in millimetres",
            ),
            Self::StepNorm => {
                ("Step norm", "Step in m and rad", "How long each step was, metres and radians together")
            }
            Self::Damping => (
                "Damping",
                "Damping in parts of the diagonal",
                "How much each step was shortened: small is Gauss-Newton, large goes straight down",
            ),
            Self::Decrease => (
                "Decrease",
                "Decrease in % of the cost before, expected ones as rings,",
                "By how much a step lowered its cost (dots), and by how much it was expected to (rings)",
            ),
        };
        QuantityWords { name, label, explanation }
    }

    /// Whether its axis shows the range of the values alone, without zero.
    pub(crate) const fn is_without_zero(self) -> bool {
        matches!(self, Self::Iou)
    }

    /// Whether a rejected step has a value of its own; else its mark stands as high as the step before it.
    pub(crate) const fn is_of_trials(self) -> bool {
        matches!(self, Self::StepNorm | Self::Damping | Self::Decrease)
    }

    /// Whether it is measured by the ramp of each step's stage, so that it means another thing in the next one.
    pub(crate) const fn is_of_stages(self) -> bool {
        matches!(self, Self::Cost)
    }

    /// Its value at a step of a run; `None` where it has none. `left` is what is left of the start's cost after every step.
    fn value(self, run: &Run, left: &[f64], step: usize) -> Option<f64> {
        let record = run.steps.get(step)?;
        let value = match self {
            Self::Percent => 100.0 * left.get(step)?,
            Self::Cost => record.iteration.cost,
            Self::Rms => record.rms,
            Self::Iou => record.iou?,
            Self::JointError => record.joint_error_mm?,
            Self::StepNorm | Self::Damping | Self::Decrease if step == 0 => return None,
            Self::StepNorm => record.iteration.step_norm,
            Self::Damping => record.iteration.damping,
            Self::Decrease => 100.0 * record.actual_share()?,
        };
        value.is_finite().then_some(value)
    }

    /// A value as it is written at the axis and beside curves.
    pub(crate) fn text_of(self, value: f64) -> String {
        match self {
            Self::Percent | Self::Decrease => format!("{} %", format::number(value, decimals(value))),
            Self::Rms => format::number(value, if value.abs() < 10.0 { 2 } else { 1 }),
            Self::Iou => format::ratio(value),
            Self::JointError => format!("{} mm", format::number(value, if value < 100.0 { 1 } else { 0 })),
            Self::Cost => format::cost(value),
            Self::StepNorm | Self::Damping => format::short(value),
        }
    }
}

/// Decimals of a percentage to three figures, up to four.
fn decimals(percent: f64) -> usize {
    let percent = percent.abs();
    if percent >= 99.95 || percent == 0.0 {
        0
    } else if percent >= 0.995 {
        1
    } else {
        (1.0 - percent.log10().floor()).clamp(2.0, 4.0) as usize
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CurvePoint {
    pub(crate) step: usize,
    /// Steps up to here, rejected ones too.
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) accepted: bool,
    pub(crate) stage: usize,
}

/// The points of a run's curve among all runs, in the order of its steps.
pub(crate) fn points(run: &Run, all: &[Run], quantity: Quantity) -> Vec<CurvePoint> {
    let left = if quantity == Quantity::Percent { run.fractions_among(all) } else { Vec::new() };
    points_of(run, all, quantity, |step| quantity.value(run, &left, step))
}

/// What the linear model said of every step, in percent of the cost before it.
pub(crate) fn predicted(run: &Run, all: &[Run]) -> Vec<CurvePoint> {
    let share = |step: usize| run.steps[step].predicted_share().filter(|_| step > 0);
    points_of(run, all, Quantity::Decrease, |step| share(step).map(|share| 100.0 * share))
}

fn points_of(
    run: &Run,
    all: &[Run],
    quantity: Quantity,
    value: impl Fn(usize) -> Option<f64>,
) -> Vec<CurvePoint> {
    let (begins_at, mut last) = (run.origin(all).steps, None);
    let point = |(step, record): (usize, &RunStep)| {
        let accepted = step == 0 || record.iteration.accepted;
        if accepted {
            last = value(step);
        }
        let y = if accepted || quantity.is_of_trials() { value(step) } else { last };
        Some(CurvePoint {
            step,
            x: (begins_at + step) as f64,
            y: y?,
            accepted,
            stage: record.iteration.stage,
        })
    };
    run.steps.iter().enumerate().filter_map(point).collect()
}

/// Ends of the axis of steps, so that a few more steps change nothing.
const STEPS: [f64; 13] = [10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 80.0, 100.0, 150.0, 200.0, 300.0, 400.0, 600.0];
/// Ends within a decade of a logarithmic and of an even axis.
const LOG_DIGITS: [f64; 3] = [1.0, 3.0, 10.0];
const EVEN_DIGITS: [f64; 9] = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
/// A logarithmic axis reaches so far below the largest value at most.
const LOG_RANGE: f64 = 1e-6;

/// The end of the axis of steps.
pub(crate) fn last_step(steps: f64) -> f64 {
    STEPS.into_iter().find(|end| *end >= steps).unwrap_or_else(|| (steps / 200.0).ceil() * 200.0)
}

/// The least and the largest of the values that are finite; the first is above the second where there is none.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// Ends of the axis of heights, as values: of all values that are finite, and on a logarithmic axis above zero.
pub(crate) fn heights(values: impl Iterator<Item = f64>, is_log: bool) -> [f64; 2] {
    let [low, high] = ends(values.filter(|value| !is_log || *value > 0.0));
    if low > high {
        return [if is_log { 0.1 } else { 0.0 }, 1.0];
    }
    if is_log {
        let low = low.max(high * LOG_RANGE);
        let (low, high) = (below(low, &LOG_DIGITS), above(high, &LOG_DIGITS));
        [if high / low < 9.0 { 0.1 * high } else { low }, high]
    } else {
        let end = |value: f64| if value > 0.0 { above(value, &EVEN_DIGITS) } else { 0.0 };
        let (low, high) = (-end(-low), end(high));
        if low < high { [low, high] } else { [low, low + 1.0] }
    }
}

/// Ends of an even axis of shares from 0 to 1 that shows no more than it must: whole twentieths around the values, a
/// tenth apart at least.
pub(crate) fn shares(values: impl Iterator<Item = f64>) -> [f64; 2] {
    const STEPS: f64 = 20.0;
    let [low, high] = ends(values);
    if low > high {
        return [0.0, 1.0];
    }
    let (low, high) = ((low * STEPS).floor().clamp(0.0, STEPS), (high * STEPS).ceil().clamp(0.0, STEPS));
    let low = if high - low < 2.0 { (high - 2.0).max(0.0) } else { low };
    [low / STEPS, high.max(low + 2.0) / STEPS]
}

/// The largest of the digits times a power of ten that is not above a value above zero.
fn below(value: f64, digits: &[f64]) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let fits = |digit: &&f64| **digit * decade <= value * (1.0 + 1e-9);
    digits.iter().rev().find(fits).map_or(0.1 * decade, |digit| digit * decade)
}

/// The smallest one that is not below.
fn above(value: f64, digits: &[f64]) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let fits = |digit: &&f64| **digit * decade >= value * (1.0 - 1e-9);
    digits.iter().find(fits).map_or(10.0 * decade, |digit| digit * decade)
}

#[cfg(test)]
pub(crate) mod tests {
    use backlit_tracking::body::Pose;
    use backlit_tracking::optimize::Iteration;
    use glam::DVec3;

    use super::*;

    /// A run of four steps, the second of which was rejected twice.
    pub(crate) fn run() -> Run {
        let iteration = |mismatch: f64, accepted: bool| Iteration {
            trial_cost: mismatch * if accepted { 1.0 } else { 1.5 },
            predicted_decrease: 0.6 * mismatch,
            actual_decrease: if accepted { mismatch } else { 0.0 },
            damping: 0.01,
            step_norm: 0.25,
            accepted,
            ..Iteration::start(Pose { root: DVec3::ZERO, rotations: Vec::new() }, mismatch)
        };
        let step = |mismatch: f64, accepted: bool| RunStep {
            iteration: iteration(mismatch, accepted),
            mismatch,
            rms: mismatch.sqrt(),
            iou: Some(1.0 - mismatch / 1000.0),
            joint_error_mm: None,
            seconds: 0.001,
        };
        let steps = vec![
            step(800.0, true),
            step(400.0, true),
            step(400.0, false),
            step(400.0, false),
            step(200.0, true),
        ];
        Run { number: 1, name: "Robust".to_owned(), steps, is_shown: true, ..Run::default() }
    }

    #[test]
    fn every_step_has_its_place_and_rejected_ones_the_height_before() {
        let run = run();
        let at = |quantity| points(&run, &[], quantity).into_iter().map(|p| (p.x, p.y));
        let percents: Vec<_> = at(Quantity::Percent).collect();
        assert_eq!(percents, [(0.0, 100.0), (1.0, 50.0), (2.0, 50.0), (3.0, 50.0), (4.0, 25.0)]);
        let norms: Vec<f64> = at(Quantity::StepNorm).map(|(x, _)| x).collect();
        assert_eq!(norms, [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn decreases_are_of_the_cost_before() {
        let run = run();
        let found: Vec<f64> = points(&run, &[], Quantity::Decrease).iter().map(|point| point.y).collect();
        assert_eq!(found, [50.0, -50.0, -50.0, 50.0]);
        let predicted: Vec<f64> = predicted(&run, &[]).iter().map(|point| point.y).collect();
        assert_eq!(predicted, [30.0, 60.0, 60.0, 30.0]);
    }

    #[test]
    fn values_have_three_figures() {
        let percent = |value| Quantity::Percent.text_of(value);
        let texts = [100.0, 13.24, 1.5, 0.0213, 0.0].map(percent);
        assert_eq!(texts, ["100 %", "13.2 %", "1.5 %", "0.021 %", "0 %"]);
        assert_eq!(Quantity::Damping.text_of(0.05), "0.05");
        assert_eq!(Quantity::Cost.text_of(1.76e8), "1.8e8");
    }

    #[test]
    fn ends_are_round_and_stay_for_a_while() {
        let percent = |last: f64| heights([100.0, 40.0, last].into_iter(), true);
        assert_eq!(percent(90.0), [10.0, 100.0]);
        assert_eq!(percent(13.2), percent(40.0));
        assert_eq!(percent(9.0), [3.0, 100.0]);
        assert_eq!(heights([0.0, 37.0].into_iter(), false), [0.0, 40.0]);
        assert_eq!(heights([-12.0, 55.0].into_iter(), false), [-15.0, 60.0]);
        assert_eq!(
            [last_step(0.0), last_step(10.0), last_step(11.0), last_step(601.0)],
            [10.0, 10.0, 15.0, 800.0]
        );
    }

    #[test]
    fn shares_fill_their_axis() {
        assert_eq!(shares([0.843, 0.861, 0.868].into_iter()), [0.8, 0.9]);
        assert_eq!(shares([0.31, 0.87].into_iter()), [0.3, 0.9]);
        assert_eq!(shares([1.0].into_iter()), [0.9, 1.0]);
        assert_eq!(shares([0.0].into_iter()), [0.0, 0.1]);
        assert_eq!(shares([f64::NAN].into_iter()), [0.0, 1.0]);
    }

    #[test]
    fn nothing_and_zero_have_axes_too() {
        assert_eq!(heights([].into_iter(), true), [0.1, 1.0]);
        assert_eq!(heights([0.0, f64::NAN].into_iter(), true), [0.1, 1.0]);
        assert_eq!(heights([0.0].into_iter(), false), [0.0, 1.0]);
        let [low, high] = heights([1e-30, 100.0].into_iter(), true);
        assert!(high / low < 1.1e7 && low > 0.0);
    }
}
