//! Ends of the plot's axes. They are round numbers around what is shown, so they move seldom while a run goes on,
//! and never back.

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

/// Ends of the axis of heights, as values: of all values that are finite, and on a logarithmic axis above zero.
pub(crate) fn heights(values: impl Iterator<Item = f64>, is_log: bool) -> [f64; 2] {
    let values = values.filter(|value| value.is_finite() && (!is_log || *value > 0.0));
    let [low, high] = values
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
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
    let [low, high] = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
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
mod tests {
    use super::*;

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
