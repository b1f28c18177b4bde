//! How sure a share of successes is: Wilson's interval.
//!
//! With k of n, p = k/n and z standard deviations its ends are
//! (p + z²/2n ± z √(p(1−p)/n + z²/4n²)) / (1 + z²/n)
//! (E. B. Wilson, "Probable inference, the law of succession, and statistical inference", 1927). Unlike the normal
//! interval it stays within 0 and 1 and has a width where none or all succeeded.

/// Standard deviations of an interval that holds the true share 95 times of 100.
pub const Z_95: f64 = 1.96;

/// Ends of the interval for `found` of `tried`, from 0 to 1; all of that where nothing was tried.
#[must_use]
pub fn wilson(found: usize, tried: usize, z: f64) -> [f64; 2] {
    if tried == 0 {
        return [0.0, 1.0];
    }
    let n = tried as f64;
    let share = found.min(tried) as f64 / n;
    let middle = share + z * z / (2.0 * n);
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    let whole = 1.0 + z * z / n;
    [((middle - half) / whole).clamp(0.0, share), ((middle + half) / whole).clamp(share, 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_those_of_the_tables() {
        let near = |[low, high]: [f64; 2], expected: [f64; 2]| {
            assert!((low - expected[0]).abs() < 5e-4 && (high - expected[1]).abs() < 5e-4, "{low} {high}");
        };
        near(wilson(5, 10, Z_95), [0.2366, 0.7634]);
        near(wilson(0, 10, Z_95), [0.0, 0.2775]);
        near(wilson(10, 10, Z_95), [0.7225, 1.0]);
        near(wilson(90, 100, Z_95), [0.8256, 0.9448]);
        assert_eq!(wilson(0, 0, Z_95), [0.0, 1.0]);
    }
}
