//! What a pose predicts in every camera, and how that compares with the data.

use std::sync::Arc;
use std::time::Instant;

use backlit_document::CameraUse;
use backlit_document::run::RunStep;
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::optimize::Iteration;
use backlit_tracking::render::{BodyMotion, DrawOptions, Prediction, Ramp, View, draw, prediction};
use backlit_tracking::silhouette::{Measurement, Overlap};
use backlit_ui::drawing::{
    Derivative, PictureInput, ViewMode, body_outline, compose, compose_over_footage, limb_colours,
};
use egui::{Color32, ColorImage};
use glam::DVec2;

use rayon::prelude::*;

use crate::session::FrameData;

/// All that a prediction depends on, but the pose.
#[derive(Debug, Clone)]
pub struct FitInputs {
    /// The body.
    pub model: Arc<Model>,
    /// The cameras without distortion.
    pub cameras: Arc<Vec<Arc<Camera>>>,
    /// Which of them count, and how much.
    pub(crate) uses: Arc<Vec<CameraUse>>,
    /// How poses are fitted: the last stage's ramp is what is shown.
    pub fit: Arc<FitOptions>,
    /// The frame's pictures, once they are there.
    pub(crate) frame: Option<Arc<FrameData>>,
    /// Which derivatives are looked at.
    pub derivatives: Derivatives,
}

/// Which derivatives of the prediction are looked at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Derivatives {
    /// How strongly each pixel pulls.
    pub(crate) gradient: bool,
    /// A column of the tangent Jacobian.
    pub column: Option<usize>,
}

impl FitInputs {
    /// Whether both are of the very same parts, whatever derivatives are looked at.
    pub(crate) fn is(&self, other: &Self) -> bool {
        self.frame.as_ref().map(Arc::as_ptr) == other.frame.as_ref().map(Arc::as_ptr)
            && Arc::ptr_eq(&self.model, &other.model)
            && Arc::ptr_eq(&self.uses, &other.uses)
            && Arc::ptr_eq(&self.fit, &other.fit)
            && Arc::ptr_eq(&self.cameras, &other.cameras)
    }

    /// What the cameras that count contribute to a fit.
    pub(crate) fn views(&self) -> Vec<FitView> {
        self.numbered_views().map(|(_, view)| view).collect()
    }

    /// The same, each with its camera's index.
    pub(crate) fn numbered_views(&self) -> impl Iterator<Item = (usize, FitView)> + '_ {
        let looks = self.fit.stages.last().map(|stage| stage.data).unwrap_or_default();
        let pictures = self.frame.iter().flat_map(|frame| &frame.cameras);
        let parts = self.cameras.iter().zip(self.uses.iter()).zip(pictures).enumerate();
        parts.filter_map(move |(index, ((camera, used), data))| {
            let evidence = data.evidence(looks).filter(|_| used.used && used.weight > 0.0)?;
            Some((index, FitView { camera: camera.clone(), evidence, weight: used.weight }))
        })
    }
}

/// Fit inputs and a pose: what a prediction is made of. Equal where all parts are the very same and the poses are equal.
#[derive(Debug, Clone)]
pub(crate) struct PosedInputs {
    pub(crate) inputs: FitInputs,
    pub(crate) pose: Pose,
}

impl PartialEq for PosedInputs {
    fn eq(&self, other: &Self) -> bool {
        self.pose == other.pose
            && self.inputs.is(&other.inputs)
            && self.inputs.derivatives == other.inputs.derivatives
    }
}

#[derive(Debug, Clone)]
pub(crate) struct CameraPrediction {
    /// Λ, with the owner of each pixel.
    pub(crate) prediction: Prediction,
    /// What it was drawn from: says what a single pixel sees.
    pub(crate) view: View,
    /// D as the last stage looks at it.
    pub(crate) data: Option<Arc<Measurement>>,
    /// Body with hard edges against silhouette, whatever the ramp.
    pub(crate) overlap: Option<Overlap>,
    /// How strongly each pixel pulls, if that was asked for.
    pub(crate) gradient: Option<Derivative>,
    /// A column of the Jacobian, if that was asked for.
    pub(crate) jacobian: Option<Derivative>,
    /// The body's outline, in pixel coordinates.
    pub(crate) outlines: Vec<Vec<DVec2>>,
}

/// What a view shows of a frame and a prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ViewedPicture {
    pub(crate) mode: ViewMode,
    /// It lies over the footage at its full size.
    pub(crate) is_over_footage: bool,
}

/// The picture of that.
#[derive(Debug, Clone)]
pub struct ComposedPicture {
    pub(crate) shows: ViewedPicture,
    pub(crate) image: Arc<ColorImage>,
}

/// What a pose predicts in every camera.
#[derive(Debug, Clone)]
pub struct Predicted {
    /// What else it depends on.
    pub scene: FitInputs,
    /// The pose.
    pub pose: Pose,
    pub(crate) cameras: Vec<CameraPrediction>,
    /// Σ w (D − Λ)² over the cameras that count: one measure for all stages and runs.
    pub(crate) mismatch: f64,
    /// Root of its mean, grey levels.
    pub(crate) rms: Option<f64>,
    /// Each limb's part of the mismatch.
    pub(crate) mismatch_by_limb: Vec<f64>,
    /// By camera, the pictures that its view shows, as far as they were made beside the prediction.
    pub(crate) pictures: Vec<Vec<ComposedPicture>>,
    /// How long it took, in seconds.
    pub(crate) seconds: f64,
}

impl Predicted {
    /// Predicts and compares. `data` is reused from an earlier prediction of the same scene.
    pub(crate) fn new(scene: &FitInputs, pose: &Pose, earlier: Option<&Self>) -> Self {
        let start = Instant::now();
        let kinematics = Kinematics::new(&scene.model, pose);
        let reusable = earlier.filter(|earlier| earlier.scene.is(scene));
        let look = |index: usize| {
            let data = match reusable {
                Some(earlier) => earlier.cameras[index].data.clone(),
                None => scene.data(index),
            };
            let camera = CameraPrediction::new(scene, &kinematics, index, data);
            let used = scene.uses.get(index).filter(|used| used.used);
            let mismatch = used.zip(camera.data.as_deref()).map(|(used, data)| {
                Mismatch::between(&camera.prediction, data, used.weight, scene.model.limbs().len())
            });
            (camera, mismatch)
        };
        // Cameras side by side, sums in their order.
        let looks: Vec<(CameraPrediction, Option<Mismatch>)> =
            (0..scene.cameras.len()).into_par_iter().map(look).collect();
        let measured = Measured::of(looks.iter().filter_map(|(_, mismatch)| mismatch.as_ref()));
        let mut mismatch_by_limb = vec![0.0; scene.model.limbs().len()];
        for mismatch in looks.iter().filter_map(|(_, mismatch)| mismatch.as_ref()) {
            let limbs = mismatch_by_limb.iter_mut().zip(&mismatch.by_limb);
            limbs.for_each(|(total, part)| *total += part);
        }
        Self {
            scene: scene.clone(),
            pose: pose.clone(),
            cameras: looks.into_iter().map(|(camera, _)| camera).collect(),
            mismatch: measured.mismatch,
            rms: measured.rms,
            mismatch_by_limb,
            pictures: Vec::new(),
            seconds: start.elapsed().as_secs_f64(),
        }
    }

    /// Makes the pictures that views show, by camera, so that the window need not.
    pub(crate) fn with_pictures(self, views: &[Vec<ViewedPicture>]) -> Self {
        let colours = limb_colours(&self.scene.model);
        let compose = |(camera, views): (usize, &Vec<ViewedPicture>)| -> Vec<ComposedPicture> {
            let Some(input) = self.picture(camera, &colours) else { return Vec::new() };
            let compose =
                |shows: &ViewedPicture| ComposedPicture { shows: *shows, image: shows.compose(&input) };
            views.iter().map(compose).collect()
        };
        let pictures = views.par_iter().enumerate().map(compose).collect();
        Self { pictures, ..self }
    }

    /// What there is to see in a camera, with its frame; `None` without one.
    pub(crate) fn picture<'a>(
        &'a self,
        camera: usize,
        limb_colours: &'a [Color32],
    ) -> Option<PictureInput<'a>> {
        let pictures = self.scene.frame.as_ref()?.cameras.get(camera)?;
        let (predicted, of) = (self.cameras.get(camera)?, self.scene.cameras.get(camera)?);
        Some(PictureInput {
            size: [of.width(), of.height()],
            frame: pictures.image.as_deref(),
            mask: pictures.mask.as_deref(),
            data: predicted.data.as_deref(),
            prediction: Some(&predicted.prediction),
            view: Some(&predicted.view),
            gradient: predicted.gradient.as_ref(),
            jacobian: predicted.jacobian.as_ref(),
            limb_colours,
        })
    }

    /// Intersection over union of the cameras that count and see somebody, all together: as the tracker has it.
    pub(crate) fn iou(&self) -> Option<f64> {
        let used = self.cameras.iter().zip(self.scene.uses.iter()).filter(|(_, used)| used.used);
        let overlaps = used.filter_map(|(camera, _)| camera.overlap);
        let of_somebody = overlaps.filter(|overlap| overlap.agreement + overlap.missing > 0);
        of_somebody.reduce(Overlap::merge)?.iou()
    }

    /// The start of a fit, which predicts this.
    pub(crate) fn start_of(&self, fit: &Fit) -> RunStep {
        let start =
            Iteration { damping: self.scene.fit.damping, ..Iteration::start(self.pose.clone(), fit.cost()) };
        self.step_of(start, 0.0)
    }

    /// A step of a fit that ends at what predicts this.
    pub(crate) fn step_of(&self, iteration: Iteration<Pose>, seconds: f64) -> RunStep {
        RunStep {
            // A project does not keep these two, and a run is equal when it comes back from one.
            iteration: Iteration { rms: 0.0, gradient_max: 0.0, ..iteration },
            mismatch: self.mismatch,
            rms: self.rms.unwrap_or_default(),
            iou: self.iou(),
            joint_error_mm: None,
            seconds,
        }
    }

    /// Whether it is of this pose and these parts.
    pub(crate) fn is_of(&self, scene: &FitInputs, pose: &Pose) -> bool {
        self.pose == *pose && self.scene.is(scene) && self.scene.derivatives == scene.derivatives
    }
}

impl ViewedPicture {
    pub(crate) fn compose(self, input: &PictureInput<'_>) -> Arc<ColorImage> {
        Arc::new(match self.is_over_footage {
            true => compose_over_footage(self.mode, input),
            false => compose(self.mode, input),
        })
    }
}

impl CameraPrediction {
    fn new(scene: &FitInputs, kinematics: &Kinematics, index: usize, data: Option<Arc<Measurement>>) -> Self {
        let camera = &scene.cameras[index];
        let view = View::new(&scene.model, kinematics, camera, scene.fit.renderer, scene.fit.final_ramp());
        let columns = Parameters::Tangent.columns(scene.model.rotation_count());
        let column = scene.derivatives.column.filter(|column| *column < columns);
        let motion = column.map(|column| {
            let mut direction = vec![0.0; columns];
            direction[column] = 1.0;
            BodyMotion::along(kinematics, camera, Parameters::Tangent, &direction)
        });
        let gradient = scene.derivatives.gradient;
        let drawing = draw(&view, DrawOptions { gradient, motion: motion.as_ref() });
        let prediction = drawing.prediction;
        let mask = scene.frame.as_ref().and_then(|frame| frame.cameras.get(index)?.mask.clone());
        let covered = || {
            let hard = View::new(&scene.model, kinematics, camera, scene.fit.renderer, Ramp::Half);
            prediction::covered(&hard)
        };
        Self {
            overlap: mask.and_then(|mask| Overlap::of_covered(&mask, &covered()).ok()),
            outlines: body_outline(&prediction.lambda, prediction.width, prediction.height),
            gradient: gradient.then(|| Derivative::new(drawing.gradient)),
            jacobian: motion.map(|_| Derivative::new(drawing.change)),
            prediction,
            view,
            data,
        }
    }
}

/// How far a pose is from the data: one measure for fits, tracks, searches and what is on the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Measured {
    /// Σ w (D − Λ)² over the cameras that count, squared grey levels.
    pub(crate) mismatch: f64,
    /// Root of its mean, grey levels.
    pub(crate) rms: Option<f64>,
}

impl Measured {
    /// Sums of cameras, in their order.
    fn of<'a>(cameras: impl Iterator<Item = &'a Mismatch>) -> Self {
        let (mut mismatch, mut weight) = (0.0, 0.0);
        for camera in cameras {
            mismatch += camera.sum;
            weight += camera.weight;
        }
        Self { mismatch, rms: (weight > 0.0).then(|| (mismatch / weight).sqrt()) }
    }
}

/// Σ w (D − Λ)² of a camera.
struct Mismatch {
    sum: f64,
    weight: f64,
    by_limb: Vec<f64>,
}

impl Mismatch {
    fn between(prediction: &Prediction, data: &Measurement, camera_weight: f64, limbs: usize) -> Self {
        let mut result = Self { sum: 0.0, weight: 0.0, by_limb: vec![0.0; limbs] };
        let pixels = prediction.lambda.iter().zip(&prediction.owner).zip(data.values()).zip(data.weights());
        for (((lambda, owner), value), pixel_weight) in pixels {
            let pixel_weight = f64::from(*pixel_weight) * camera_weight;
            let residual = f64::from(*value) - f64::from(*lambda);
            let cost = pixel_weight * residual * residual;
            result.weight += pixel_weight;
            result.sum += cost;
            if let Some(limb) = result.by_limb.get_mut(usize::from(*owner)) {
                *limb += cost;
            }
        }
        result
    }
}

impl FitInputs {
    /// How far a pose is from the data, as [`Predicted`] has it, without all else that a picture needs.
    pub(crate) fn measure(&self, pose: &Pose) -> Measured {
        let kinematics = Kinematics::new(&self.model, pose);
        let look = |index: usize| {
            let used = self.uses.get(index).filter(|used| used.used)?;
            let (camera, data) = (&self.cameras[index], self.data(index)?);
            let view = View::new(&self.model, &kinematics, camera, self.fit.renderer, self.fit.final_ramp());
            let prediction = draw(&view, DrawOptions { gradient: false, motion: None }).prediction;
            Some(Mismatch::between(&prediction, &data, used.weight, self.model.limbs().len()))
        };
        let cameras: Vec<Option<Mismatch>> = (0..self.cameras.len()).into_par_iter().map(look).collect();
        Measured::of(cameras.iter().flatten())
    }

    /// D of a camera, as the last stage looks at it.
    pub(crate) fn data(&self, camera: usize) -> Option<Arc<Measurement>> {
        let frame = self.frame.as_ref()?.cameras.get(camera)?;
        let stage = self.fit.stages.last()?;
        let view = FitView {
            camera: self.cameras[camera].clone(),
            evidence: frame.evidence(stage.data)?,
            weight: 1.0,
        };
        Some(view.data(stage, frame.distance().as_deref()))
    }
}
