//! What experiments on a sequence share: a take or the simulated upper body, the methods, D and Λ as pictures.

use std::path::PathBuf;

use anyhow::{Result, ensure};
use backlit_formats::Take;
use backlit_lab::experiment::sequence::Sequence;
use backlit_lab::experiment::{Simulation, scene};
use backlit_plot::Sheet;
use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::fit::{DataView, FitOptions, FitView, Preset, Stage};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::{Ramp, RendererKind, predict};
use backlit_tracking::track::Motion;
use clap::Args;
use image::{GrayImage, Luma};
use serde::Serialize;

use crate::numbers::within;
use crate::take_options::{self, PartArguments, StartArguments};

/// Cameras, as in the report.
const CAMERAS: usize = 2;
/// Most iterations of a frame, as in the report.
pub(crate) const ITERATIONS: usize = 25;
/// Pull of [`lm_half`] towards the pose that a frame began with: weak, for what the cameras do not see.
const WEAK_PRIOR: f64 = 1.0;
/// The level of pixels that weigh nothing, in a picture of the measurement.
const NOT_KNOWN: u8 = 208;

/// Which sequence.
#[derive(Debug, Default, Args, Serialize)]
pub(crate) struct SequenceArguments {
    /// A take instead of the simulated upper body: its folder or its take.toml
    #[arg(long, value_name = "TAKE")]
    #[serde(skip)]
    take: Option<PathBuf>,
    /// Another body than the take's, as from fit-body: a file, or a built-in one by name
    #[arg(long, value_name = "MODEL", requires = "take")]
    #[serde(skip)]
    model: Option<String>,
    /// Names of the take's cameras, with commas [default: the first two]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "take")]
    #[serde(skip)]
    cameras: Option<Vec<String>>,
    /// Radius of the box over which the report's fit smooths its masks, pixels; 0: not at all [0 to 100]
    #[arg(long, value_name = "PX", default_value_t = 1, value_parser = within(0..=100_usize))]
    #[serde(skip)]
    smoothing: usize,
    #[arg(skip)]
    #[serde(flatten)]
    pub(crate) conditions: Conditions,
}

/// What was run on, for the file with the numbers.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Conditions {
    sequence: String,
    cameras: Vec<String>,
    size_px: [usize; 2],
    frames: usize,
}

impl Conditions {
    fn of(sequence: &Sequence) -> Self {
        let views = sequence.moments.first().map(|moment| moment.views.as_slice()).unwrap_or_default();
        let size = |view: &FitView| [view.camera.width(), view.camera.height()];
        Self {
            sequence: sequence.name.clone(),
            cameras: views.iter().map(|view| view.camera.name().to_owned()).collect(),
            size_px: views.first().map_or([0, 0], size),
            frames: sequence.moments.len(),
        }
    }

    /// In words.
    pub(crate) fn text(&self) -> String {
        let ([width, height], cameras) = (self.size_px, self.cameras.join(" and "));
        format!("{}, {cameras}, {width} × {height} pixels", self.sequence)
    }

    /// A sheet of D and Λ: titled columns with the pictures of all cameras, two rows a camera.
    pub(crate) fn sheet(&self, title: String, columns: Vec<(String, Vec<ViewPictures>)>) -> Sheet {
        let (columns, pictures): (Vec<String>, Vec<Vec<ViewPictures>>) = columns.into_iter().unzip();
        let hides = pictures.iter().flatten().any(|view| view.hides);
        let row = |name: String, camera: usize, of: fn(&ViewPictures) -> &GrayImage| {
            (
                name,
                pictures.iter().filter_map(|views| views.get(camera)).map(|view| of(view).clone()).collect(),
            )
        };
        let rows = self.cameras.iter().enumerate().flat_map(|(camera, name)| {
            [
                row(format!("{name} D"), camera, |view| &view.data),
                row(format!("{name} Λ"), camera, |view| &view.prediction),
            ]
        });
        let legend = if hides { "; light grey in D: not known" } else { "" };
        Sheet { title, subtitle: self.text() + legend, rows: rows.collect(), columns }
    }
}

impl SequenceArguments {
    /// The first frames, in pictures of this size; the conditions are then known.
    ///
    /// # Errors
    /// A take that cannot be read or does not have what is asked for.
    pub(crate) fn open(&mut self, size_px: [u64; 2], frames: usize) -> Result<Sequence> {
        let sequence = match &self.take {
            None => Sequence::simulated(size_px, CAMERAS, frames)?,
            Some(path) => {
                let footage = take_options::open_with_model(path, self.model.as_deref())?;
                let take: &Take = footage.take();
                ensure!(
                    frames <= take.frame_count(),
                    "--frames {frames}: the take has {}",
                    take.frame_count()
                );
                let names = PartArguments { frames: None, every: 1, cameras: self.cameras.clone() };
                let mut cameras = names.cameras(take)?;
                if self.cameras.is_none() {
                    cameras.truncate(CAMERAS);
                }
                let start = StartArguments::none().pose(&footage, &cameras, 0, &FitOptions::default())?;
                Sequence::of_take(&footage, &cameras, frames, start, size_px)?
            }
        };
        self.conditions = Conditions::of(&sequence);
        Ok(sequence)
    }

    /// All methods, the report's smoothed as asked for.
    pub(crate) fn methods(&self) -> Vec<SequenceMethod> {
        let mut methods = methods();
        for stage in methods.iter_mut().flat_map(|method| &mut method.fit.stages) {
            if let DataView::Averaged { radius_px } = &mut stage.data {
                *radius_px = self.smoothing;
            }
        }
        methods
    }
}

/// How a sequence is followed: a name, what the fit sees, and every choice.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct SequenceMethod {
    pub(crate) name: String,
    /// Grey levels of the truth are of simulations only.
    pub(crate) simulation: Simulation,
    pub(crate) fit: FitOptions,
    pub(crate) motion: Motion,
}

/// Both presets, the report's with [`ITERATIONS`] and also on its own grey levels, and what suits tiny pictures.
fn methods() -> Vec<SequenceMethod> {
    let method = |name: &str, simulation, preset, fit| {
        let motion = Motion::of_preset(Some(preset));
        SequenceMethod { name: name.to_owned(), simulation, fit, motion }
    };
    let report = FitOptions::preset(Preset::Report).with_iterations(ITERATIONS);
    // As it is: its stages suit the scale and end by themselves.
    let robust = FitOptions::preset(Preset::Robust);
    vec![
        method("Report 2004, its own grey levels", Simulation::Prediction, Preset::Report, report.clone()),
        method("Report 2004, masks", Simulation::Mask, Preset::Report, report),
        method("Robust, masks", Simulation::Mask, Preset::Robust, robust),
        method("LM, half ramp, weak prior, masks", Simulation::Mask, Preset::Robust, lm_half()),
    ]
}

/// Tangent Levenberg-Marquardt on hard masks with the half ramp and a weak prior, without annealing.
fn lm_half() -> FitOptions {
    let mut fit = FitOptions {
        parameters: Parameters::Tangent,
        method: Method::LevenbergMarquardt,
        damping: 0.01,
        proximal_weight: WEAK_PRIOR,
        largest_turn: Some(0.3),
        largest_move: Some(0.15),
        ..FitOptions::preset(Preset::Report)
    }
    .with_ramp(Ramp::Half);
    fit.stages[0].data = DataView::Hard;
    fit
}

impl SequenceMethod {
    /// What it sees of a frame; `None` where that takes a truth and there is none.
    pub(crate) fn views(&self, sequence: &Sequence, frame: usize) -> Result<Option<Vec<FitView>>> {
        let moment = &sequence.moments[frame];
        if self.simulation == Simulation::Mask {
            return Ok(Some(moment.views.clone()));
        }
        let Some(truth) = &moment.truth else { return Ok(None) };
        let (ramp, renderer) = (self.fit.final_ramp(), self.fit.renderer);
        let see = |view: &FitView| {
            Ok(scene::view(&sequence.model, truth, &view.camera, self.simulation, renderer, ramp)?)
        };
        moment.views.iter().map(see).collect::<Result<_>>().map(Some)
    }

    /// What a file of its pictures is called: its first word.
    pub(crate) fn short_name(&self) -> String {
        self.name.split([' ', ',']).next().unwrap_or_default().to_lowercase()
    }
}

/// D and Λ of a pose before one camera, as the report lays them out for its real data.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViewPictures {
    /// The measurement, as the fit looks at it; [`NOT_KNOWN`] where it does not.
    pub(crate) data: GrayImage,
    /// Whether there are such pixels.
    hides: bool,
    pub(crate) prediction: GrayImage,
}

impl ViewPictures {
    /// A pose before every camera, as a stage of a fit looks at it.
    pub(crate) fn of_stage(
        model: &Model,
        pose: &Pose,
        views: &[FitView],
        stage: &Stage,
        renderer: RendererKind,
    ) -> Vec<Self> {
        let kinematics = Kinematics::new(model, pose);
        let of_view = |view: &FitView| {
            let distance = view.distance(&[*stage]);
            let drawn = predict(model, &kinematics, &view.camera, renderer, stage.ramp);
            let pixel = |x: u32, y: u32| drawn.lambda[y as usize * drawn.width + x as usize].round() as u8;
            let size = [drawn.width, drawn.height].map(|side| side as u32);
            let prediction = GrayImage::from_fn(size[0], size[1], |x, y| Luma([pixel(x, y)]));
            let measured = view.data(stage, distance.as_ref());
            let mut data = measured.to_gray();
            let mut hides = false;
            for (pixel, weight) in data.pixels_mut().zip(measured.weights()) {
                if *weight == 0.0 {
                    *pixel = Luma([NOT_KNOWN]);
                    hides = true;
                }
            }
            Self { data, hides, prediction }
        };
        views.iter().map(of_view).collect()
    }

    /// A pose before every camera, as the last stage of a fit looks at it.
    pub(crate) fn at_the_end(model: &Model, pose: &Pose, views: &[FitView], fit: &FitOptions) -> Vec<Self> {
        let fit = fit.clone().at_scale(model, views, pose);
        let last = fit.stages.last();
        last.map(|stage| Self::of_stage(model, pose, views, stage, fit.renderer)).unwrap_or_default()
    }
}
