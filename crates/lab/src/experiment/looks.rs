//! D and Λ of a pose as pictures, as the report lays them out for its real data.

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::fit::{FitOptions, FitView, Stage};
use backlit_tracking::render::{RendererKind, predict};
use image::GrayImage;

/// The level of pixels that weigh nothing, in a picture of the measurement.
pub const NOT_KNOWN: u8 = 208;

/// What one camera is shown of a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct Look {
    /// The measurement, as the fit looks at it; [`NOT_KNOWN`] where it does not.
    pub data: GrayImage,
    /// Whether there are such pixels.
    pub hides: bool,
    /// The prediction.
    pub prediction: GrayImage,
}

impl Look {
    /// A pose in every camera, as a stage of a fit looks at it.
    #[must_use]
    pub fn of_views(
        model: &Model,
        pose: &Pose,
        views: &[FitView],
        stage: &Stage,
        renderer: RendererKind,
    ) -> Vec<Self> {
        let kinematics = Kinematics::new(model, pose);
        let look = |view: &FitView| {
            let distance = view.distance(&[*stage]);
            let drawn = predict(model, &kinematics, &view.camera, renderer, stage.ramp);
            let pixel = |x: u32, y: u32| drawn.lambda[y as usize * drawn.width + x as usize].round() as u8;
            let prediction = GrayImage::from_fn(drawn.width as u32, drawn.height as u32, |x, y| {
                image::Luma([pixel(x, y)])
            });
            let measured = view.data(stage, distance.as_ref());
            let mut data = measured.to_gray();
            let mut hides = false;
            for (pixel, _) in data.pixels_mut().zip(measured.weights()).filter(|(_, weight)| **weight == 0.0)
            {
                *pixel = image::Luma([NOT_KNOWN]);
                hides = true;
            }
            Self { data, hides, prediction }
        };
        views.iter().map(look).collect()
    }

    /// A pose in every camera, as the last stage of a fit looks at it.
    #[must_use]
    pub fn at_the_end(model: &Model, pose: &Pose, views: &[FitView], fit: &FitOptions) -> Vec<Self> {
        let fit = fit.clone().at_scale(model, views, pose);
        let Some(stage) = fit.stages.last() else { return Vec::new() };
        Self::of_views(model, pose, views, stage, fit.renderer)
    }
}
