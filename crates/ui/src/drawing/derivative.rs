//! Derivatives of the prediction as pictures: how strongly each pixel pulls at its limb, and how it changes with one
//! coefficient of the pose. Pixels of the ramp whose derivative is zero are hatched, so that zero is not mistaken
//! for background.

use egui::{Color32, ColorImage};

use super::{PictureInput, hatch};
use crate::style::theme::data_colours::PICTURE_GROUND;
use crate::style::theme::{gradient_colour, residual_colour};

/// The share of pixels with a derivative that the scale leaves within the map.
const PERCENTILE: f64 = 0.99;

/// A derivative counts as zero below this share of the scale.
const ZERO_SHARE: f32 = 1e-6;

/// A number for each pixel, row by row, and the end of its colour map.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivative {
    /// Zero where the pixel has no derivative.
    pub values: Vec<f32>,
    /// The 99th percentile of the magnitudes that are not zero; 1 if there is none.
    pub scale: f32,
}

impl Derivative {
    /// Finds the scale of these values. What is not finite becomes zero.
    pub fn new(mut values: Vec<f32>) -> Self {
        values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
        let mut magnitudes: Vec<f32> =
            values.iter().map(|value| value.abs()).filter(|value| *value > 0.0).collect();
        let index = (magnitudes.len().saturating_sub(1) as f64 * PERCENTILE).round() as usize;
        let scale = match magnitudes.len() {
            0 => 1.0,
            _ => *magnitudes.select_nth_unstable_by(index, f32::total_cmp).1,
        };
        Self { values, scale }
    }
}

pub(super) fn compose_gradient(input: &PictureInput<'_>) -> ColorImage {
    compose(input, input.gradient, gradient_colour)
}

pub(super) fn compose_jacobian(input: &PictureInput<'_>) -> ColorImage {
    compose(input, input.jacobian, |share| residual_colour(share * 255.0))
}

fn compose(
    input: &PictureInput<'_>,
    derivative: Option<&Derivative>,
    colour: impl Fn(f32) -> Color32,
) -> ColorImage {
    let Some(derivative) = derivative else { return ColorImage::filled(input.size, PICTURE_GROUND) };
    input.map(|x, y, index| {
        let share = derivative.values[index] / derivative.scale;
        let lambda = input.lambda(index);
        match (share.abs() > ZERO_SHARE, lambda > 0.0 && lambda < 255.0) {
            (true, _) => colour(share),
            (false, true) => hatch::no_gradient(x, y, PICTURE_GROUND),
            (false, false) => PICTURE_GROUND,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::input::tests::prediction;
    use crate::drawing::{ViewMode, compose as compose_mode};
    use crate::style::theme::data_colours::NO_GRADIENT;

    #[test]
    fn the_scale_is_the_99th_percentile_of_what_is_not_zero() {
        let mut values: Vec<f32> = (1..=100).map(|value| -(value as f32)).collect();
        values.extend([0.0; 900]);
        assert!((Derivative::new(values).scale - 99.0).abs() < 1e-6);
        assert_eq!(Derivative::new(vec![f32::NAN, 0.0]), Derivative { values: vec![0.0; 2], scale: 1.0 });
    }

    #[test]
    fn pixels_of_the_ramp_that_do_not_pull_are_hatched() {
        let prediction = prediction(&[100.0, 100.0, 0.0], &[0; 3]);
        let derivative = Derivative { values: vec![0.0, -2.0, 0.0], scale: 2.0 };
        let input = PictureInput {
            prediction: Some(&prediction),
            gradient: Some(&derivative),
            jacobian: Some(&derivative),
            ..PictureInput::empty([3, 1])
        };
        let picture = compose_mode(ViewMode::JacobianColumn, &input).pixels;
        assert_eq!(picture, [NO_GRADIENT, residual_colour(-255.0), PICTURE_GROUND]);
        let picture = compose_mode(ViewMode::Gradient, &input).pixels;
        assert_eq!(picture[0], NO_GRADIENT);
    }
}
