//! How a number stands in a message, and options that are out of range.

use std::fmt;

use thiserror::Error;

/// From here on an exponent says more than zeros.
const LARGE: f64 = 1e12;
/// Up to here likewise.
const SMALL: f64 = 1e-6;

/// A number in a message: as people write it, and short however large or small it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Brief<T>(pub(crate) T);

impl<T: Copy + Into<f64> + fmt::Display + fmt::LowerExp> fmt::Display for Brief<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value: f64 = self.0.into();
        let is_plain = value == 0.0 || (SMALL..LARGE).contains(&value.abs()) || !value.is_finite();
        if is_plain { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}

/// An option that is out of range.
#[derive(Debug, Error, Clone, Copy, PartialEq)]
#[error("`{field}` is {}; expected {expected}", Brief(*.value))]
pub struct OptionError {
    /// Its name.
    pub field: &'static str,
    /// What it is.
    pub value: f64,
    /// What it may be.
    pub expected: &'static str,
}

/// What an option may be, as a test and in words.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range(pub(crate) fn(f64) -> bool, pub(crate) &'static str);

/// A count of at least one.
pub(crate) const AT_LEAST_ONE: Range = Range(|value| value >= 1.0, "1 or more");
/// A finite number, 0 included.
pub(crate) const NOT_NEGATIVE: Range = Range(|value| value.is_finite() && value >= 0.0, "0 or more");
/// A finite number above 0.
pub(crate) const POSITIVE: Range = Range(|value| value.is_finite() && value > 0.0, "more than 0");

/// Checks options in order.
///
/// # Errors
/// The first that is out of its range.
pub(crate) fn check_options(
    options: impl IntoIterator<Item = (&'static str, f64, Range)>,
) -> Result<(), OptionError> {
    let wrong = options.into_iter().find(|(_, value, Range(is_valid, _))| !is_valid(*value));
    wrong.map_or(Ok(()), |(field, value, Range(_, expected))| Err(OptionError { field, value, expected }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, expected) in [
            (0.0, "0"),
            (-4.0, "-4"),
            (0.25, "0.25"),
            (999_999_999_999.0, "999999999999"),
            (1e308, "1e308"),
            (-2.5e-200, "-2.5e-200"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Brief(number).to_string(), expected);
        }
        assert_eq!(Brief(4.149_f32).to_string(), "4.149");
    }
}
