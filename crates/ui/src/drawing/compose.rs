//! The pictures of the view modes, but for the tinted one: footage, the measurement D, the prediction Λ, D − Λ in two
//! hues, the report's overlay, owner limbs, and derivatives.

use backlit_tracking::body::Model;
use backlit_tracking::render::Footprint;
use backlit_tracking::render::prediction::NO_OWNER;
use backlit_tracking::silhouette::Label;
use egui::{Color32, ColorImage};

use super::tinted::{self, mix};
use super::{PictureInput, ViewMode};
use crate::style::format;
use crate::style::theme::data_colours::{
    NO_GRADIENT, PICTURE_GROUND, REPORT_GROUND, SHADOW, UNKNOWN, byte, limb_colour, mark, report_grey,
};
use crate::style::theme::{gradient_colour, residual_colour};

/// What a view shows of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ViewedPicture {
    /// What its pixels mean.
    pub mode: ViewMode,
    /// It is laid over the footage, which is shown at a size of its own: premultiplied colours.
    pub is_over_footage: bool,
}

/// The picture of a view mode. What `input` lacks for it is said by [`PictureInput::shown`].
pub fn compose(mode: ViewMode, input: &PictureInput<'_>) -> ColorImage {
    ViewedPicture { mode, is_over_footage: false }.compose(input)
}

/// Whether a mode shows footage as it is or tinted, so that it can lie over a larger picture of the same.
pub fn shows_footage(mode: ViewMode, input: &PictureInput<'_>) -> bool {
    input.frame.is_some() && matches!(input.fitting().shown(mode), ViewMode::Footage | ViewMode::Tinted)
}

impl ViewedPicture {
    /// The whole picture.
    pub fn compose(self, input: &PictureInput<'_>) -> ColorImage {
        let mut picture = ColorImage::filled(input.size, Color32::TRANSPARENT);
        self.compose_part(input, &Footprint::whole(input.size), &mut picture);
        picture
    }

    /// Composes some pixels of a picture of the input's size.
    pub fn compose_part(self, input: &PictureInput<'_>, part: &Footprint, picture: &mut ColorImage) {
        let input = &input.fitting();
        match input.shown(self.mode) {
            ViewMode::Tinted if self.is_over_footage => tinted::compose_over_footage(input, part, picture),
            _ if self.is_over_footage => input.paint(part, picture, |_, _, _| Color32::TRANSPARENT),
            ViewMode::Footage => {
                input.paint(part, picture, |x, y, _| input.footage(x, y).unwrap_or(PICTURE_GROUND));
            }
            ViewMode::Data => {
                paint_data(input, part, picture, PICTURE_GROUND, |level, _| Color32::from_gray(byte(level)));
            }
            ViewMode::Prediction => {
                for (_, row) in input.rows(part) {
                    paint_levels(&mut picture.pixels[row.clone()], &[], input.lambdas(row), |_, lambda| {
                        Color32::from_gray(byte(lambda))
                    });
                }
            }
            ViewMode::ReportOverlay => {
                let ground = Color32::from_gray(REPORT_GROUND);
                paint_data(input, part, picture, ground, |level, lambda| {
                    Color32::from_gray(report_grey(level, lambda))
                });
            }
            ViewMode::Tinted => tinted::compose(input, part, picture),
            ViewMode::Residual => {
                paint_data(input, part, picture, PICTURE_GROUND, |level, lambda| {
                    residual_colour(level - lambda)
                });
            }
            ViewMode::OwnerLimb => input.paint(part, picture, |_, _, index| {
                let owner = input.prediction.map_or(NO_OWNER, |p| p.owner[index]);
                let colour = input.limb_colours.get(usize::from(owner));
                colour.map_or(PICTURE_GROUND, |colour| {
                    mix(PICTURE_GROUND, *colour, 1.0 - input.lambda(index).clamp(0.0, 255.0) / 255.0)
                })
            }),
            ViewMode::Gradient => {
                derivative(input, part, picture, (input.gradient, gradient_colour));
            }
            ViewMode::JacobianColumn => {
                derivative(input, part, picture, (input.jacobian, |share| residual_colour(share * 255.0)));
            }
        }
    }
}

/// Paints the data: `shown` of D and Λ where it says something, else hatched over `ground`. What every frame of a drag does for every
/// view is to be quick: slices side by side, and hatches only on rows that need them.
fn paint_data(
    input: &PictureInput<'_>,
    part: &Footprint,
    picture: &mut ColorImage,
    ground: Color32,
    shown: impl Fn(f32, f32) -> Color32,
) {
    let mut of_mask = Vec::new();
    for (y, row) in input.rows(part) {
        let pixels = &mut picture.pixels[row.clone()];
        let levels = input.levels(row.clone(), &mut of_mask);
        paint_levels(pixels, levels, input.lambdas(row.clone()), &shown);
        if input.is_hatched_in(row.clone()) {
            let first = row.start - y * input.size[0];
            for ((x, index), pixel) in (first..).zip(row).zip(pixels) {
                *pixel = hatch(input, [x, y, index], ground).unwrap_or(*pixel);
            }
        }
    }
}

/// Paints pixels by D and Λ: an empty slice stands for the background. Λ that is no number counts as background.
fn paint_levels(
    pixels: &mut [Color32],
    levels: &[f32],
    lambdas: &[f32],
    shown: impl Fn(f32, f32) -> Color32,
) {
    let finite = |lambda: f32| if lambda.is_finite() { lambda } else { 255.0 };
    match (levels.is_empty(), lambdas.is_empty()) {
        (false, false) => {
            for ((pixel, &level), &lambda) in pixels.iter_mut().zip(levels).zip(lambdas) {
                *pixel = shown(level, finite(lambda));
            }
        }
        (false, true) => {
            pixels.iter_mut().zip(levels).for_each(|(pixel, &level)| *pixel = shown(level, 255.0));
        }
        (true, _) => {
            pixels.iter_mut().zip(lambdas).for_each(|(pixel, &lambda)| *pixel = shown(255.0, finite(lambda)));
        }
    }
}

/// What is painted over a pixel where the data says nothing, or shadow falls; `None` where the data is shown.
fn hatch(input: &PictureInput<'_>, [x, y, index]: [usize; 3], ground: Color32) -> Option<Color32> {
    match (input.label(index), input.is_shadow(index)) {
        (_, true) if is_shadow_line(y) => Some(SHADOW),
        (Label::Unknown, false) if is_unknown_line(x, y) => Some(UNKNOWN),
        (Label::Unknown, _) => Some(ground),
        (Label::Subject | Label::Background, _) => None,
    }
}

/// Whether the hatch of shadows has a line in this row: one of every three.
pub(super) fn is_shadow_line(y: usize) -> bool {
    let [width, period] = mark::SHADOW_HATCH.map(|px| px as usize);
    y % period < width
}

/// Whether the don't-know hatch has a line at this pixel: one diagonal of every five, falling to the right.
pub(super) fn is_unknown_line(x: usize, y: usize) -> bool {
    let [width, period] = mark::UNKNOWN_HATCH.map(|px| px as usize);
    // x − y, kept above zero: y of any picture is far below the offset, a multiple of the period.
    (x + (usize::MAX >> 8) / period * period - y) % period < width
}

/// A colour for each limb of a model. Limbs that turn together share one; a chain is a run of rotations
/// without a branch.
pub fn limb_colours(model: &Model) -> Vec<Color32> {
    let places = chain_places(model);
    model.limbs().iter().map(|limb| limb_colour(places[limb.rotation].0, places[limb.rotation].1)).collect()
}

/// What people call the chains of a model, each with the colour of its first limb: "Right arm".
pub fn limb_chains(model: &Model) -> Vec<(String, Color32)> {
    const NAMES: [(&str, &str); 6] = [
        ("clavicle", "arm"),
        ("shoulder", "arm"),
        ("upper arm", "arm"),
        ("hip", "leg"),
        ("thigh", "leg"),
        ("neck", "head"),
    ];
    let places = chain_places(model);
    let firsts = model.rotations_parents_first().iter().filter(|rotation| places[**rotation].1 == 0);
    let name = |rotation: &usize| {
        let limb = model.limbs()[model.rotation_owners()[*rotation]].name.as_str();
        let part = NAMES.iter().find_map(|(part, chain)| Some((limb.strip_suffix(part)?, *chain)));
        let name = part.map_or_else(|| limb.to_owned(), |(side, chain)| format!("{side}{chain}"));
        format::capitalised(&name)
    };
    firsts.map(|rotation| (name(rotation), limb_colour(places[*rotation].0, 0))).collect()
}

/// Chain and place in it of each rotation.
fn chain_places(model: &Model) -> Vec<(usize, usize)> {
    let parents = model.rotation_parents();
    let mut places = vec![(0, 0); model.rotation_count()];
    let mut chains = 0;
    for &rotation in model.rotations_parents_first() {
        let siblings = parents.iter().filter(|parent| **parent == parents[rotation]).count();
        places[rotation] = match parents[rotation] {
            Some(parent) if siblings == 1 => (places[parent].0, places[parent].1 + 1),
            _ => {
                chains += 1;
                (chains - 1, 0)
            }
        };
    }
    places
}

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

/// A derivative by its colour map. Pixels of the ramp without one have two diagonals of every six, rising to the right.
fn derivative(
    input: &PictureInput<'_>,
    part: &Footprint,
    picture: &mut ColorImage,
    (derivative, colour): (Option<&Derivative>, impl Fn(f32) -> Color32),
) {
    let [width, period] = mark::NO_GRADIENT_HATCH.map(|px| px as usize);
    input.paint(part, picture, |x, y, index| {
        let share = derivative.map_or(0.0, |derivative| derivative.values[index] / derivative.scale);
        let lambda = input.lambda(index);
        match (share.abs() > ZERO_SHARE, lambda > 0.0 && lambda < 255.0) {
            (true, _) => colour(share),
            (false, true) if (x + y) % period < width => NO_GRADIENT,
            (false, _) => PICTURE_GROUND,
        }
    });
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin::full_body;
    use backlit_tracking::silhouette::{Mask, Measurement};

    use crate::drawing::input::tests::prediction;

    use super::*;

    #[test]
    fn grey_levels_are_shown_as_they_are_and_shadow_and_unknown_are_hatched() {
        let shadows = Mask::from_ascii("-~.").unwrap();
        let input = PictureInput { mask: Some(&shadows), ..PictureInput::empty([3, 1]) };
        let picture = compose(ViewMode::Data, &input);
        assert_eq!(picture.pixels, [SHADOW, SHADOW, Color32::WHITE]);
        assert!(input.has_shadow() && !input.has_unknown());
        // Between the lines lies what the shadow weighs.
        let shadows = Mask::from_ascii("-~.\n-~.").unwrap();
        let input = PictureInput { mask: Some(&shadows), ..PictureInput::empty([3, 2]) };
        let picture = compose(ViewMode::Data, &input);
        assert_eq!(picture.pixels[3..], [Color32::WHITE, PICTURE_GROUND, Color32::WHITE]);
        let mask = Mask::from_ascii("?#.").unwrap();
        let input = PictureInput { mask: Some(&mask), ..PictureInput::empty([3, 1]) };
        let picture = compose(ViewMode::Data, &input);
        assert_eq!(picture.pixels, [UNKNOWN, Color32::BLACK, Color32::WHITE]);
        let data = Measurement::new(3, 1, vec![99.6, 40.0, 12.0], vec![1.0, 1.0, 0.0]).unwrap();
        let picture = compose(ViewMode::Data, &PictureInput { data: Some(&data), mask: None, ..input });
        assert_eq!(picture.pixels, [Color32::from_gray(100), Color32::from_gray(40), PICTURE_GROUND]);
    }

    #[test]
    fn weightless_pixels_are_hatched_and_numbers_that_are_none_are_background() {
        let mask = Mask::from_ascii("##..").unwrap();
        let data = Measurement::new(4, 1, vec![40.0; 4], vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let prediction = prediction(&[0.0, 0.0, f32::NAN, 40.0], &[0; 4]);
        let input = PictureInput {
            mask: Some(&mask),
            data: Some(&data),
            prediction: Some(&prediction),
            ..PictureInput::empty([4, 1])
        };
        let picture = compose(ViewMode::Residual, &input).pixels;
        assert_eq!(picture, [UNKNOWN, PICTURE_GROUND, residual_colour(40.0 - 255.0), residual_colour(0.0)]);
        let grey = Color32::from_gray;
        assert_eq!(compose(ViewMode::Prediction, &input).pixels, [0, 0, 255, 40].map(grey));
        let overlay = compose(ViewMode::ReportOverlay, &input).pixels;
        assert_eq!(
            overlay[1..],
            [grey(REPORT_GROUND), grey(report_grey(40.0, 255.0)), grey(report_grey(40.0, 40.0))]
        );
    }

    #[test]
    fn lines_fall_to_the_right_every_five_pixels() {
        let row =
            |y: usize| -> String { (0..8).map(|x| if is_unknown_line(x, y) { '\\' } else { '.' }).collect() };
        assert_eq!([row(0), row(1), row(2)], ["\\....\\..", ".\\....\\.", "..\\....\\"]);
    }

    #[test]
    fn chains_are_called_what_people_call_them() {
        let names: Vec<String> = limb_chains(&full_body()).into_iter().map(|(name, _)| name).collect();
        for name in ["Spine", "Chest", "Head", "Right arm", "Left arm", "Right leg", "Left leg"] {
            assert!(names.contains(&name.to_owned()), "{name} of {names:?}");
        }
        assert_eq!(names.len(), 7);
    }

    #[test]
    fn a_chain_keeps_its_hue_and_darkens() {
        let model = full_body();
        let colours = limb_colours(&model);
        let colour = |name: &str| colours[model.limb_index(name).unwrap()];
        assert_eq!(colour("right hand"), colour("right forearm"));
        assert_ne!(colour("right forearm"), colour("left forearm"));
        let brightness = |name: &str| colour(name).r().max(colour(name).g()).max(colour(name).b());
        assert!(brightness("right clavicle") > brightness("right upper arm"));
        assert!(brightness("right upper arm") > brightness("right forearm"));
    }

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
        let picture = compose(ViewMode::JacobianColumn, &input).pixels;
        assert_eq!(picture, [NO_GRADIENT, residual_colour(-255.0), PICTURE_GROUND]);
        let picture = compose(ViewMode::Gradient, &input).pixels;
        assert_eq!(picture[0], NO_GRADIENT);
    }
}
