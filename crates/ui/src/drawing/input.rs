//! What there is to look at in one camera.

use std::ops::Range;

use backlit_tracking::render::prediction::NO_OWNER;
use backlit_tracking::render::{Footprint, Prediction, View};
use backlit_tracking::silhouette::{Label, Mask, Measurement};
use egui::{Color32, ColorImage};
use image::RgbImage;

use super::{Derivative, ViewMode};

/// Grey level between subject and background.
pub(super) const HALF: f32 = 127.5;

/// One camera's footage, data and prediction, each where there is one. All have the same size; a part of
/// another size is left out of pictures.
#[derive(Clone, Copy, Debug)]
pub struct PictureInput<'a> {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The frame.
    pub frame: Option<&'a RgbImage>,
    /// The silhouette.
    pub mask: Option<&'a Mask>,
    /// The measurement made from it. Without one, the mask stands for it as it is.
    pub data: Option<&'a Measurement>,
    /// What the model predicts.
    pub prediction: Option<&'a Prediction>,
    /// What the prediction was drawn from.
    pub view: Option<&'a View>,
    /// How strongly each pixel pulls at its limb, grey levels a metre.
    pub gradient: Option<&'a Derivative>,
    /// A column of the Jacobian: grey levels a metre or radian.
    pub jacobian: Option<&'a Derivative>,
    /// A colour for each limb: see [`limb_colours`](super::limb_colours).
    pub limb_colours: &'a [Color32],
}

/// The numbers of one pixel. What is not known, or not a finite number, is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// D.
    pub data: Option<f32>,
    /// Λ.
    pub prediction: Option<f32>,
    /// D − Λ.
    pub residual: Option<f32>,
    /// The limb that wins the pixel.
    pub owner: Option<usize>,
    /// Distance of the ray from that limb's axis, in its radii.
    pub distance_over_radius: Option<f32>,
    /// Distance along the ray to that limb, metres.
    pub depth_m: Option<f32>,
    /// The data says nothing here, and the pixel weighs nothing.
    pub is_unknown: bool,
    /// The subject's shadow falls here.
    pub is_shadow: bool,
}

impl<'a> PictureInput<'a> {
    /// A camera with nothing known but the size of its pictures.
    pub const fn empty(size: [usize; 2]) -> Self {
        Self {
            size,
            frame: None,
            mask: None,
            data: None,
            prediction: None,
            view: None,
            gradient: None,
            jacobian: None,
            limb_colours: &[],
        }
    }

    /// The mode that can be shown: `mode`, or footage where what `mode` needs is not there yet.
    pub fn shown(&self, mode: ViewMode) -> ViewMode {
        let has_data = self.mask.is_some() || self.data.is_some();
        let has_prediction = self.prediction.is_some();
        let can_show = match mode {
            ViewMode::Footage => true,
            ViewMode::Data => has_data,
            ViewMode::Prediction | ViewMode::OwnerLimb => has_prediction,
            ViewMode::Gradient => has_prediction && self.gradient.is_some(),
            ViewMode::JacobianColumn => has_prediction && self.jacobian.is_some(),
            ViewMode::ReportOverlay | ViewMode::Tinted | ViewMode::Residual => has_data && has_prediction,
        };
        if can_show { mode } else { ViewMode::Footage }
    }

    /// Whether the data says nothing of some pixel that is no shadow.
    pub fn has_unknown(&self) -> bool {
        let input = self.fitting();
        let pixels =
            if input.mask.is_some() || input.data.is_some() { self.size[0] * self.size[1] } else { 0 };
        (0..pixels).any(|index| input.label(index) == Label::Unknown && !input.is_shadow(index))
    }

    /// Whether some pixel is shadow.
    pub fn has_shadow(&self) -> bool {
        self.fitting().mask.is_some_and(Mask::has_shadow)
    }

    /// The numbers at a pixel; `None` outside the picture.
    pub fn sample(&self, x: usize, y: usize) -> Option<Sample> {
        let [width, height] = self.size;
        if x >= width || y >= height {
            return None;
        }
        let input = self.fitting();
        let index = y * width + x;
        let finite = |value: f32| Some(value).filter(|value| value.is_finite());
        let data = input.level(index);
        let prediction = input.prediction.and_then(|p| finite(p.lambda[index]));
        let owner = input.prediction.map(|p| p.owner[index]).filter(|owner| *owner != NO_OWNER);
        let sight = input.view.filter(|_| owner.is_some()).and_then(|view| view.seen_limb(x, y));
        let is_unknown =
            (input.mask.is_some() || input.data.is_some()) && input.label(index) == Label::Unknown;
        Some(Sample {
            data,
            prediction,
            residual: data.zip(prediction).filter(|_| !is_unknown).map(|(data, lambda)| data - lambda),
            owner: owner.map(usize::from),
            distance_over_radius: sight.and_then(|sight| finite(sight.distance_over_radius as f32)),
            depth_m: sight.and_then(|sight| finite(sight.depth as f32)),
            is_unknown,
            is_shadow: input.is_shadow(index),
        })
    }

    /// Only the parts that have the picture's size.
    pub fn fitting(&self) -> Self {
        let [width, height] = self.size;
        let pixels = width * height;
        Self {
            frame: self.frame.filter(|frame| [frame.width() as usize, frame.height() as usize] == self.size),
            mask: self.mask.filter(|mask| [mask.width(), mask.height()] == self.size),
            data: self.data.filter(|data| [data.width(), data.height()] == self.size),
            prediction: self.prediction.filter(|p| {
                [p.width, p.height] == self.size && p.owner.len() == pixels && p.lambda.len() == pixels
            }),
            view: self.view.filter(|view| view.size == self.size),
            ..*self
        }
    }

    /// The rows of a part of the picture, each with the range of its pixels.
    pub(super) fn rows(&self, part: &Footprint) -> impl Iterator<Item = (usize, Range<usize>)> {
        let width = self.size[0];
        part.rows().map(move |y| {
            let columns = part.columns(y);
            (y, y * width + columns.start..y * width + columns.end)
        })
    }

    /// D of some pixels of a fitting input, which `of_mask` holds where there is but a mask; empty where there is neither.
    pub(super) fn levels<'b>(&'b self, row: Range<usize>, of_mask: &'b mut Vec<f32>) -> &'b [f32] {
        match (self.data, self.mask) {
            (Some(data), _) => &data.values()[row],
            (None, Some(mask)) => {
                of_mask.clear();
                of_mask.extend(mask.labels()[row].iter().map(|label| level_of(*label)));
                of_mask
            }
            (None, None) => &[],
        }
    }

    /// Λ of some pixels of a fitting input as it is drawn; empty without a prediction.
    pub(super) fn lambdas(&self, row: Range<usize>) -> &[f32] {
        self.prediction.map_or(&[], |prediction| &prediction.lambda[row])
    }

    /// Whether one of these pixels of a fitting input is shadow or has the label [`Label::Unknown`].
    pub(super) fn is_hatched_in(&self, row: Range<usize>) -> bool {
        // These two loops never end early: so they run in lanes.
        let weights = self.data.map_or(&[][..], |data| &data.weights()[row.clone()]);
        let labels = self.mask.map_or(&[][..], |mask| &mask.labels()[row.clone()]);
        weights.iter().fold(false, |any, weight| any | (*weight <= 0.0))
            || labels.iter().fold(false, |any, label| any | (*label == Label::Unknown))
            || (row.start..row.end).any(|index| self.is_shadow(index))
    }

    /// Paints some pixels of a picture of this size; `colour` is given x, y and the index of the pixel.
    pub(super) fn paint(
        &self,
        part: &Footprint,
        picture: &mut ColorImage,
        mut colour: impl FnMut(usize, usize, usize) -> Color32,
    ) {
        for y in part.rows() {
            let (start, columns) = (y * self.size[0], part.columns(y));
            let pixels = &mut picture.pixels[start + columns.start..start + columns.end];
            for (x, pixel) in columns.zip(pixels) {
                *pixel = colour(x, y, start + x);
            }
        }
    }

    /// The footage at a pixel of a [`fitting`](Self::fitting) input.
    pub fn footage(&self, x: usize, y: usize) -> Option<Color32> {
        let [r, g, b] = self.frame?.get_pixel(x as u32, y as u32).0;
        Some(Color32::from_rgb(r, g, b))
    }

    /// The grey level D of a pixel of a fitting input.
    pub fn level(&self, index: usize) -> Option<f32> {
        match (self.data, self.mask) {
            (Some(data), _) => Some(data.values()[index]),
            (None, Some(mask)) => Some(level_of(mask.labels()[index])),
            (None, None) => None,
        }
    }

    /// What a fitting input says about a pixel. The measurement can make a pixel unknown that the mask knows.
    pub fn label(&self, index: usize) -> Label {
        let weightless = self.data.is_some_and(|data| data.weights()[index] <= 0.0);
        match (weightless, self.mask, self.data) {
            (true, _, _) | (false, None, None) => Label::Unknown,
            (false, Some(mask), _) => mask.labels()[index],
            (false, None, Some(data)) if data.values()[index] < HALF => Label::Subject,
            (false, None, Some(_)) => Label::Background,
        }
    }

    /// Whether a pixel of a fitting input is shadow.
    #[inline]
    pub(super) fn is_shadow(&self, index: usize) -> bool {
        self.mask.is_some_and(|mask| mask.is_shadow(index))
    }

    /// The grey level Λ of a pixel of a fitting input; background where it is not a number.
    pub fn lambda(&self, index: usize) -> f32 {
        let lambda = self.prediction.map_or(255.0, |p| p.lambda[index]);
        if lambda.is_finite() { lambda } else { 255.0 }
    }
}

/// D of a mask that is compared as it is.
const fn level_of(label: Label) -> f32 {
    match label {
        Label::Subject => 0.0,
        Label::Background => 255.0,
        Label::Unknown => HALF,
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use backlit_tracking::body::builtin::upper_body;
    use backlit_tracking::body::{Kinematics, Pose};
    use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
    use backlit_tracking::render::{Ramp, RendererKind};
    use glam::DVec3;

    use super::*;

    /// One row of a prediction.
    pub(crate) fn prediction(lambda: &[f32], owner: &[u16]) -> Prediction {
        let width = lambda.len();
        let footprint = Footprint::whole([width, 1]);
        Prediction { width, height: 1, lambda: lambda.to_vec(), owner: owner.to_vec(), footprint }
    }

    /// A camera by the size of its picture, focal length and principal point in pixels, where it stands and looks, and
    /// what is up.
    pub(crate) fn camera(
        size_px: [u64; 2],
        [focal, cx, cy]: [f64; 3],
        from: DVec3,
        to: DVec3,
        up: DVec3,
    ) -> Camera {
        let intrinsics = Intrinsics { fx: focal, fy: focal, cx, cy };
        let place = CameraFromWorld::looking_at(from, to, up);
        Camera::new("camera", size_px, intrinsics, Distortion::None, place).unwrap()
    }

    #[test]
    fn what_is_not_there_leaves_the_footage() {
        let mask = Mask::from_ascii("#.").unwrap();
        let prediction = prediction(&[0.0, 255.0], &[3, NO_OWNER]);
        let empty = PictureInput::empty([2, 1]);
        let with_mask = PictureInput { mask: Some(&mask), ..empty };
        let derivative = Derivative::new(vec![0.0, 1.0]);
        let (gradient, jacobian) = (Some(&derivative), Some(&derivative));
        let whole = PictureInput { prediction: Some(&prediction), gradient, jacobian, ..with_mask };
        for mode in ViewMode::ALL {
            assert_eq!(empty.shown(mode), ViewMode::Footage);
            assert_eq!(whole.shown(mode), mode);
        }
        assert_eq!(with_mask.shown(ViewMode::Data), ViewMode::Data);
        assert_eq!(with_mask.shown(ViewMode::Tinted), ViewMode::Footage);
    }

    #[test]
    fn samples_hold_what_is_known() {
        let mask = Mask::from_ascii("#?").unwrap();
        let prediction = prediction(&[191.0, f32::NAN], &[3, NO_OWNER]);
        let input =
            PictureInput { mask: Some(&mask), prediction: Some(&prediction), ..PictureInput::empty([2, 1]) };
        let first = input.sample(0, 0).unwrap();
        assert_eq!((first.distance_over_radius, first.depth_m), (None, None));
        assert_eq!((first.data, first.residual, first.owner), (Some(0.0), Some(-191.0), Some(3)));
        let second = input.sample(1, 0).unwrap();
        assert!(second.is_unknown);
        assert_eq!((second.prediction, second.residual, second.owner), (None, None, None));
        assert_eq!(second.distance_over_radius, None);
        assert_eq!(input.sample(2, 0), None);
    }

    #[test]
    fn a_view_says_how_far_the_limb_is() {
        let model = upper_body();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        let camera = camera([9, 9], [9.0, 4.0, 4.0], DVec3::new(0.0, 0.25, 3.0), DVec3::Y * 0.25, DVec3::Y);
        let view = View::new(&model, &kinematics, &camera, RendererKind::Capsule, Ramp::Half);
        let prediction = Prediction::of(&view);
        let input =
            PictureInput { prediction: Some(&prediction), view: Some(&view), ..PictureInput::empty([9, 9]) };
        let middle = input.sample(4, 4).unwrap();
        assert!(middle.depth_m.is_some_and(|depth| (2.8..3.1).contains(&depth)), "{middle:?}");
        assert!(middle.distance_over_radius.is_some_and(|ratio| ratio < 1.0), "{middle:?}");
        assert_eq!(input.sample(0, 0).unwrap().depth_m, None);
        let other = PictureInput { size: [3, 27], ..input };
        assert_eq!(other.sample(1, 1), Some(Sample::default()));
    }

    #[test]
    fn parts_of_another_size_are_left_out() {
        let mask = Mask::from_ascii("###").unwrap();
        let frame = RgbImage::new(1, 1);
        let input = PictureInput { mask: Some(&mask), frame: Some(&frame), ..PictureInput::empty([2, 1]) };
        let fitting = input.fitting();
        assert!(fitting.mask.is_none() && fitting.frame.is_none());
        assert_eq!(input.sample(0, 0), Some(Sample::default()));
    }
}
