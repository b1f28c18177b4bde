//! How a number stands in a message.

use std::fmt;

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
