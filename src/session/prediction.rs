//! What a pose predicts in every camera, and how that compares with the data.

use std::sync::Arc;
use std::time::Instant;

use backlit_document::CameraUse;
use backlit_document::run::RunStep;
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::{Fit, FitOptions, FitView};
use backlit_tracking::optimize::Iteration;
use backlit_tracking::render::{
    BodyMotion, DrawOptions, Drawing, Footprint, Prediction, Ramp, View, draw, draw_over, prediction,
};
use backlit_tracking::silhouette::{Label, Mask, Overlap};
use backlit_ui::drawing::{Derivative, PictureInput, ViewedPicture, body_outline, limb_colours};
use egui::{Color32, ColorImage};
use glam::DVec2;

use rayon::prelude::*;

use crate::session::FrameData;

mod mismatch;

use mismatch::CameraMismatch;
pub(crate) use mismatch::{ComparedData, Measured};

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
    pub(crate) data: Option<Arc<ComparedData>>,
    /// Body with hard edges against silhouette, whatever the ramp.
    pub(crate) overlap: Option<Overlap>,
    /// How strongly each pixel pulls, if that was asked for.
    pub(crate) gradient: Option<Derivative>,
    /// A column of the Jacobian, if that was asked for.
    pub(crate) jacobian: Option<Derivative>,
    /// The body's outline, in pixel coordinates.
    pub(crate) outlines: Vec<Vec<DVec2>>,
}

/// A picture that a view shows.
#[derive(Debug, Clone)]
pub struct ComposedPicture {
    pub(crate) shows: ViewedPicture,
    pub(crate) image: Arc<ColorImage>,
    /// Outside of these pixels it is as if there were no body.
    footprint: Footprint,
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
    /// Predicts and compares. The data of an earlier prediction of the same scene are used again.
    pub(crate) fn new(scene: &FitInputs, pose: &Pose, earlier: Option<&Self>) -> Self {
        Self::draw(scene, pose, earlier, Vec::new())
    }

    /// The same with the pictures that views show, by camera, so that the window need not make them. The memory of `spare`,
    /// at which nobody looks any more, is used again: of the same scene, only pixels that a body touches are made.
    pub(crate) fn with_pictures(
        posed: &PosedInputs,
        views: &[Vec<ViewedPicture>],
        earlier: Option<&Self>,
        spare: Option<Self>,
    ) -> Self {
        let is_alike =
            |scene: &FitInputs| scene.is(&posed.inputs) && scene.derivatives == posed.inputs.derivatives;
        let spare = spare.filter(|spare| is_alike(&spare.scene));
        let start = Instant::now();
        let (cameras, mut pictures) =
            spare.map_or_else(Default::default, |spare| (spare.cameras, spare.pictures));
        let drawings = cameras.into_iter().map(CameraPrediction::into_drawing).collect();
        let predicted = Self::draw(&posed.inputs, &posed.pose, earlier, drawings);
        let colours = limb_colours(&predicted.scene.model);
        pictures.resize_with(views.len(), Vec::new);
        let compose = |((camera, views), spares): ((usize, &Vec<ViewedPicture>), Vec<ComposedPicture>)| {
            let Some(input) = predicted.picture(camera, &colours) else { return Vec::new() };
            let footprint = &predicted.cameras[camera].prediction.footprint;
            let mut spares = spares;
            let compose = |shows: &ViewedPicture| {
                let spare = spares.iter().position(|spare| spare.shows == *shows);
                let spare = spare.map(|place| spares.swap_remove(place));
                ComposedPicture::over(spare, *shows, &input, footprint)
            };
            views.iter().map(compose).collect()
        };
        let pictures = views.par_iter().enumerate().zip(pictures).map(compose).collect();
        Self { pictures, seconds: start.elapsed().as_secs_f64(), ..predicted }
    }

    fn draw(scene: &FitInputs, pose: &Pose, earlier: Option<&Self>, mut drawings: Vec<Drawing>) -> Self {
        let start = Instant::now();
        let kinematics = Kinematics::new(&scene.model, pose);
        let reusable = earlier.filter(|earlier| earlier.scene.is(scene));
        let look = |(index, drawing): (usize, Drawing)| {
            let data = match reusable {
                Some(earlier) => earlier.cameras[index].data.clone(),
                None => scene.data(index).map(Arc::new),
            };
            let camera = CameraPrediction::new(scene, &kinematics, index, (data, drawing));
            let used = scene.uses.get(index).filter(|used| used.used);
            let mismatch = used.zip(camera.data.as_deref()).map(|(used, data)| {
                data.mismatch(&camera.prediction, used.weight, scene.model.limbs().len())
            });
            (camera, mismatch)
        };
        drawings.resize_with(scene.cameras.len(), Drawing::default);
        // Cameras side by side, sums in their order.
        let looks: Vec<(CameraPrediction, Option<CameraMismatch>)> =
            drawings.into_par_iter().enumerate().map(look).collect();
        let measured = Measured::of(looks.iter().filter_map(|(_, mismatch)| mismatch.as_ref()));
        let mut mismatch_by_limb = vec![0.0; scene.model.limbs().len()];
        for mismatch in looks.iter().filter_map(|(_, mismatch)| mismatch.as_ref()) {
            let limbs = mismatch_by_limb.iter_mut().zip(mismatch.by_limb());
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
            data: predicted.data.as_ref().map(|data| data.measurement()),
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

impl ComposedPicture {
    /// Composes a picture of a body with this footprint, in the memory of an earlier one of the same frame and data.
    fn over(
        earlier: Option<Self>,
        shows: ViewedPicture,
        input: &PictureInput<'_>,
        footprint: &Footprint,
    ) -> Self {
        let earlier = earlier.and_then(|earlier| Some((Arc::into_inner(earlier.image)?, earlier.footprint)));
        let image = match earlier {
            Some((mut image, stale)) => {
                shows.compose_part(input, &stale.union(footprint), &mut image);
                image
            }
            None => shows.compose(input),
        };
        Self { shows, image: Arc::new(image), footprint: footprint.clone() }
    }
}

impl CameraPrediction {
    fn new(
        scene: &FitInputs,
        kinematics: &Kinematics,
        index: usize,
        (data, memory): (Option<Arc<ComparedData>>, Drawing),
    ) -> Self {
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
        let drawing = draw_over(memory, &view, DrawOptions { gradient, motion: motion.as_ref() });
        let mask = scene.frame.as_ref().and_then(|frame| frame.cameras.get(index)?.mask.clone());
        let overlap = |mask: Arc<Mask>| {
            let subject = data.as_ref().and_then(|data| data.subject_pixels);
            let subject = subject.unwrap_or_else(|| mask.count(Label::Subject));
            let drawn = &drawing.prediction;
            if let Some(overlap) = prediction::overlap_of_drawing(&view, drawn, &mask, subject).ok()? {
                return Some(overlap);
            }
            let hard = View::new(&scene.model, kinematics, camera, scene.fit.renderer, Ramp::Half);
            prediction::overlap(&hard, &mask).ok()
        };
        let overlap = mask.and_then(overlap);
        let prediction = drawing.prediction;
        Self {
            overlap,
            outlines: body_outline(&prediction),
            gradient: gradient.then(|| Derivative::new(drawing.gradient)),
            jacobian: motion.map(|_| Derivative::new(drawing.change)),
            prediction,
            view,
            data,
        }
    }

    /// Its memory, for another drawing.
    fn into_drawing(self) -> Drawing {
        let values = |derivative: Option<Derivative>| derivative.map_or_else(Vec::new, |one| one.values);
        Drawing {
            prediction: self.prediction,
            gradient: values(self.gradient),
            change: values(self.jacobian),
        }
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
            Some(data.mismatch(&prediction, used.weight, self.model.limbs().len()))
        };
        let cameras: Vec<Option<CameraMismatch>> =
            (0..self.cameras.len()).into_par_iter().map(look).collect();
        Measured::of(cameras.iter().flatten())
    }

    /// D of a camera, as the last stage looks at it.
    pub(crate) fn data(&self, camera: usize) -> Option<ComparedData> {
        let frame = self.frame.as_ref()?.cameras.get(camera)?;
        let stage = self.fit.stages.last()?;
        let view = FitView {
            camera: self.cameras[camera].clone(),
            evidence: frame.evidence(stage.data)?,
            weight: 1.0,
        };
        Some(ComparedData::new(view.data(stage, frame.distance().as_deref()), frame.mask.as_deref()))
    }
}
