//! Where an axis has its marks: round numbers, on even and on logarithmic axes.

/// The part of an axis that is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisSpan {
    /// Its ends.
    pub bounds: (f64, f64),
    /// Length of eight points of the screen, in the axis' own unit.
    pub division: f64,
}

/// A mark of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Where it stands.
    pub value: f64,
    /// How far it is from the next.
    pub step: f64,
}

/// With fewer marks at 1, 2 and 5 a logarithmic axis has even ones.
const LEAST_MARKS: usize = 3;

/// Points of a division.
pub(crate) const DIVISION: f64 = 8.0;
/// A decade has marks at 1, 2 and 5 if it is at least this long, points.
const ROOMY_DECADE: f64 = 50.0;
/// Else only whole decades have marks, at least this far apart, points.
const LEAST_APART: f64 = 30.0;
/// Least distance of the marks of an axis of steps, in divisions: closer ones would have no numbers.
const MARK_SPACING: f64 = 10.0;

/// Marks at 1, 2 and 5 of each decade, or at whole decades where there is less room, or even ones where those are
/// too few; the axis is of logarithms.
pub fn decade_marks(span: AxisSpan) -> Vec<Mark> {
    let (low, high) = span.bounds;
    let decade = DIVISION / span.division;
    if decade < ROOMY_DECADE {
        let step = (LEAST_APART / decade).ceil().max(1.0);
        let marks = (low / step).ceil() as i64..=(high / step).floor() as i64;
        let marks: Vec<Mark> = marks.map(|k| Mark { value: k as f64 * step, step }).collect();
        if marks.len() >= LEAST_MARKS {
            return marks;
        }
    }
    let decades = (low.floor() as i32)..=(high.ceil() as i32);
    let mark = |value: f64| Mark { value: value.log10(), step: 1.0 };
    let marks = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| mark(digit * 10f64.powi(decade))));
    let marks: Vec<Mark> = marks.filter(|mark| (low..=high).contains(&mark.value)).collect();
    if marks.len() >= LEAST_MARKS {
        return marks;
    }
    let even = even_marks(AxisSpan { bounds: (10f64.powf(low), 10f64.powf(high)), ..span });
    even.into_iter().filter(|even| even.value > 0.0).map(|even| mark(even.value)).collect()
}

/// Marks at even steps of 1, 2 or 5 times a power of ten.
pub fn even_marks(span: AxisSpan) -> Vec<Mark> {
    let (low, high) = span.bounds;
    let rough = ((high - low) / 5.0).max(f64::MIN_POSITIVE);
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * decade).into_iter().find(|s| *s >= rough);
    let step = step.unwrap_or(rough);
    let marks = (low / step).ceil() as i64..=(high / step).floor() as i64;
    marks.map(|k| Mark { value: k as f64 * step, step }).collect()
}

/// Marks at whole steps.
pub fn step_marks(span: AxisSpan) -> Vec<Mark> {
    let (low, high) = span.bounds;
    let apart = MARK_SPACING * span.division;
    let step = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0].into_iter().find(|s| *s >= apart).unwrap_or(200.0);
    let first = (low.max(0.0) / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|k| Mark { value: k as f64 * step, step }).collect()
}

/// A mark's number with as many digits as its axis needs.
pub fn number(value: f64, step: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        return format!("{value:.0e}");
    }
    let decimals = (-step.abs().max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_they_need() {
        assert_eq!(number(0.25, 0.05), "0.25");
        assert_eq!(number(20.0, 5.0), "20");
        assert_eq!(number(1e-5, 1e-5), "1e-5");
    }

    fn values(low: f64, high: f64, points: f64) -> Vec<f64> {
        let division = DIVISION * (high - low) / points;
        let marks = decade_marks(AxisSpan { bounds: (low, high), division });
        marks.iter().map(|mark| 10f64.powf(mark.value)).collect()
    }

    fn assert_near(found: &[f64], expected: &[f64]) {
        let same = found.len() == expected.len()
            && found.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-9);
        assert!(same, "{found:?}");
    }

    #[test]
    fn logarithmic_marks_keep_apart() {
        assert_near(&values(-0.1, 1.1, 200.0), &[1.0, 2.0, 5.0, 10.0]);
        assert_near(&values(-2.1, 2.1, 200.0), &[0.01, 0.1, 1.0, 10.0, 100.0]);
        assert_near(&values(-4.1, 2.1, 100.0), &[0.0001, 0.01, 1.0, 100.0]);
        // Too few round ones: even ones.
        assert_near(&values(1.9, 2.01, 200.0), &[80.0, 85.0, 90.0, 95.0, 100.0]);
    }
}
