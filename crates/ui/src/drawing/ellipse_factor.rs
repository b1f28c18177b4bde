//! How much larger than life ellipses of uncertainty are drawn, so that they can be read.
//!
//! The factor depends on the deviations in the world alone: ellipses grow with the picture when that is zoomed.

/// Ellipses are of so many standard deviations.
pub const DEVIATIONS: f64 = 2.0;
/// The factors that can be chosen.
pub const FACTORS: [u32; 8] = [1, 2, 5, 10, 20, 50, 100, 200];
/// The middle one of the ellipses has half axes of at most this, in metres of the scene: more than a joint's handle.
const MIDDLE_M: f64 = 0.12;
/// The largest one, of at most this: less than a limb.
const LARGEST_M: f64 = 0.5;

/// The largest round factor by which ellipses stay within reason, from the joints' deviations in their worst directions
/// (metres). Joints without bound do not count; 1 if there are no others.
pub fn automatic_factor(deviations_m: impl Iterator<Item = f64>) -> u32 {
    let mut deviations: Vec<f64> = deviations_m.filter(|deviation| deviation.is_finite()).collect();
    deviations.sort_by(f64::total_cmp);
    let Some(largest) = deviations.last() else { return 1 };
    let middle = deviations[deviations.len() / 2];
    let fits = |factor: &u32| {
        let scale = DEVIATIONS * f64::from(*factor);
        scale * middle <= MIDDLE_M && scale * largest <= LARGEST_M
    };
    FACTORS.into_iter().rfind(fits).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_round_and_leave_the_largest_ellipse_on_the_body() {
        let factor = |millimetres: &[f64]| automatic_factor(millimetres.iter().map(|mm| 1e-3 * mm));
        assert_eq!(factor(&[1.0, 2.0, 3.0]), 20);
        assert_eq!(factor(&[1.0, 2.0, 60.0]), 2, "the largest has its limit");
        assert_eq!(factor(&[1.0, 2.0, f64::INFINITY]), 20, "what has no bound does not count");
        assert_eq!(factor(&[0.0001; 3]), 200);
        assert_eq!(factor(&[90.0, 400.0]), 1);
        assert_eq!(factor(&[f64::INFINITY]), 1);
    }
}
