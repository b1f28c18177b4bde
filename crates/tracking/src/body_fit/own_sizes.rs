//! A person's own sizes in one go, and whether they are to be taken.
//!
//! From a track with a body of about the right size, well-spread frames are chosen and some of them held out. Sizes are
//! fitted to the others ([`fit_body`]). Then the body found, as the silhouettes show it, and the body to begin with, scaled
//! as a whole, are posed again in the frames held out, and what does not overlap better there, or is no person's size, is
//! not taken: a fact of the report, not an error. Errors are what forbids to look at all.

use std::sync::Arc;

use thiserror::Error;

use super::fit::{BodyFitError, BodyProgress, FirstSizes, fit_body};
use super::frames::{BodyFrame, Choice, PosedFrame, choose};
use super::options::{BodyFitOptions, CLOTHED};
use super::report::BodyFit;
use super::survey::{LeftOut, usable_views, worst};
use crate::body::{Model, SizeChoice, SizeKind};
use crate::cancel::CancelToken;
use crate::fit::{Fit, FitOptions, FitView};
use crate::metrics::ReferenceJoints;
use crate::silhouette::Overlap;

/// Fewer frames than this cannot both be fitted to and judged by.
pub const FEWEST_FRAMES: usize = 3;

/// Every choice of it.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnSizesOptions {
    /// The fit of sizes; by default of people in clothes of whom no joint is known.
    pub fit: BodyFitOptions,
    /// How the frames held out are posed again.
    pub pose: FitOptions,
    /// Frames that sizes are fitted to.
    pub fitted: usize,
    /// Frames that judge them.
    pub held_out: usize,
    /// By how much IoU is to rise in them.
    pub least_gain: f64,
    /// Stoutness, or a widening, this many standard deviations from none is not believed.
    pub most_deviations: f64,
    /// A single size this many standard deviations from what is expected is not believed: there are many of them, and
    /// the frames held out judge better.
    pub most_size_deviations: f64,
}

impl Default for OwnSizesOptions {
    fn default() -> Self {
        Self {
            fit: BodyFitOptions::default().with_proportions(CLOTHED),
            pose: FitOptions::default(),
            fitted: 8,
            held_out: 4,
            least_gain: 0.001,
            most_deviations: 3.0,
            most_size_deviations: 5.0,
        }
    }
}

/// Why sizes that were found are not taken.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// Frames held out are not overlapped better: IoU of the scaled body and of the body found.
    NotBetter {
        /// IoU of the scaled body and of the body found.
        iou: [f64; 2],
    },
    /// The body is stouter (above 0) or slimmer than people are.
    Stoutness {
        /// Standard deviations from the average.
        deviations: f64,
    },
    /// Silhouettes would be too wide, or too narrow, by more than they ever are.
    Widening {
        /// Standard deviations of [`BodyFitOptions::widening`] from none.
        deviations: f64,
    },
    /// A size is not a person's of this size and stoutness.
    Size {
        /// The limb, without its side where both sides share the size.
        name: String,
        /// Length or radius.
        kind: SizeKind,
        /// Standard deviations from what is expected.
        deviations: f64,
    },
}

/// What the frames held out say.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Their numbers.
    pub frames: Vec<usize>,
    /// IoU of the scaled body and of the body found, all frames and cameras together; `None` without masks.
    pub iou: [Option<f64>; 2],
    /// Root of the mean squared residual per pixel of both, grey levels, mean of the frames.
    pub rms: [f64; 2],
}

/// What was found, and whether it is to be taken.
#[derive(Debug, Clone)]
pub struct OwnSizes {
    /// The body to begin with.
    pub start: Arc<Model>,
    /// The body with its own sizes.
    pub fit: BodyFit,
    /// The body to begin with, scaled as a whole to the same frames: what the sizes are judged beside.
    pub scaled: BodyFit,
    /// What the frames held out say.
    pub judged: Judged,
    /// What speaks against the sizes; empty: they are to be taken.
    pub doubts: Vec<Doubt>,
    /// Which of the candidates were looked at, and why others were not.
    pub choice: Choice,
    /// Silhouettes that could not be used.
    pub left_out: Vec<LeftOut>,
}

impl OwnSizes {
    /// Whether the sizes found are to be taken.
    pub fn is_taken(&self) -> bool {
        self.doubts.is_empty()
    }

    /// The person: with sizes of its own, or the body to begin with where those are doubted. To be followed on silhouettes
    /// that are [`narrowed`](super::widening::narrowed) by [`widening_px`](Self::widening_px).
    pub fn model(&self) -> &Model {
        if self.is_taken() { &self.fit.model } else { &self.start }
    }

    /// The body to follow on silhouettes as they are: the person, and stouter by what silhouettes are too wide.
    pub fn as_seen(&self) -> Model {
        if self.is_taken() { self.fit.as_seen() } else { (*self.start).clone() }
    }

    /// By how many pixels silhouettes are too wide all round; 0 where that, or the sizes, are doubted.
    pub fn widening_px(&self) -> f64 {
        self.fit.widening.filter(|found| found.is_believed && self.is_taken()).map_or(0.0, |found| found.px)
    }
}

/// Why there are no sizes.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum OwnSizesError {
    #[error(
        "{found} frames can be used, expected {FEWEST_FRAMES} or more: of {all} with a pose {} are lost, {} turned round, {} \
         seen poorly", choice.lost, choice.turned, choice.poor
    )]
    FewFrames { found: usize, all: usize, choice: Choice },
    #[error(
        "camera \"{}\" in frame {}: {}; {others} more pictures of the chosen frames cannot be used",
        worst.camera, worst.frame, worst.because
    )]
    Unusable { worst: LeftOut, others: usize },
    #[error(transparent)]
    Fit(#[from] BodyFitError),
}

/// How far it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OwnSizesProgress {
    /// How many of the chosen frames are read, and how many there are.
    Reading(usize, usize),
    /// Sizes are fitted.
    Fitting(BodyProgress),
    /// The body to begin with is scaled as a whole.
    Scaling(BodyProgress),
    /// How many of the frames held out are judged, and how many there are.
    Judging(usize, usize),
}

/// Finds a person's sizes from a track with a body of about the right size, and judges them.
///
/// `track` has poses of `model` in the order of their frames; `views(frame)` gives what the cameras see, `joints(frame)` the
/// joints that are known.
///
/// # Errors
/// What `views` returns; too few frames, silhouettes that cannot be a person's, or as [`fit_body`].
pub fn own_sizes<E: From<OwnSizesError>>(
    model: &Arc<Model>,
    track: &[PosedFrame],
    options: &OwnSizesOptions,
    cancel: &CancelToken,
    mut views: impl FnMut(usize) -> Result<Vec<FitView>, E>,
    joints: impl Fn(usize) -> ReferenceJoints,
    mut progress: impl FnMut(OwnSizesProgress),
) -> Result<OwnSizes, E> {
    let choice = choose(model, track, options.fitted, options.held_out);
    let chosen = choice.fitted.len() + choice.held_out.len();
    let mut read = 0;
    let mut left_out = Vec::new();
    let mut read_frames = |chosen_ones: &[usize]| -> Result<Vec<BodyFrame>, E> {
        let mut frames = Vec::new();
        for &one in chosen_ones {
            let PosedFrame { frame, ref pose, .. } = track[one];
            let views = usable_views(frame, views(frame)?, &mut left_out);
            read += 1;
            progress(OwnSizesProgress::Reading(read, chosen));
            if cancel.is_cancelled() {
                return Err(OwnSizesError::from(BodyFitError::Cancelled).into());
            }
            if !views.is_empty() {
                frames.push(BodyFrame { frame, views, start: pose.clone(), joints: joints(frame) });
            }
        }
        Ok(frames)
    };
    let (fitted, held_out) = (read_frames(&choice.fitted)?, read_frames(&choice.held_out)?);
    let found = fitted.len() + held_out.len();
    if fitted.is_empty() || held_out.is_empty() || found < FEWEST_FRAMES {
        let error = match worst(left_out.iter()) {
            Some(worst) => OwnSizesError::Unusable { worst: worst.clone(), others: left_out.len() - 1 },
            None => OwnSizesError::FewFrames { found, all: track.len(), choice },
        };
        return Err(error.into());
    }
    let fit = |frames: Vec<BodyFrame>, options: &BodyFitOptions, progress: &mut dyn FnMut(BodyProgress)| {
        fit_body(Arc::clone(model), frames, FirstSizes::Scaled(0.0), options, cancel, progress)
            .map_err(OwnSizesError::from)
    };
    let own = fit(fitted.clone(), &options.fit, &mut |at| progress(OwnSizesProgress::Fitting(at)))?;
    let choice_of_sizes = SizeChoice { lengths: false, radii: false, ..options.fit.choice };
    let whole = BodyFitOptions { choice: choice_of_sizes, widening: 0.0, ..options.fit.clone() };
    let scaled = fit(fitted, &whole, &mut |at| progress(OwnSizesProgress::Scaling(at)))?;
    let bodies = [scaled.model.clone(), own.as_seen()].map(Arc::new);
    let judged = judge(&bodies, &held_out, options, cancel, |done| {
        progress(OwnSizesProgress::Judging(done, held_out.len()));
    })?;
    let doubts = doubts(&own, &judged, options);
    Ok(OwnSizes { start: Arc::clone(model), fit: own, scaled, judged, doubts, choice, left_out })
}

/// Poses both bodies again in the frames held out.
fn judge(
    bodies: &[Arc<Model>; 2],
    frames: &[BodyFrame],
    options: &OwnSizesOptions,
    cancel: &CancelToken,
    mut progress: impl FnMut(usize),
) -> Result<Judged, OwnSizesError> {
    let mut overlaps: [Option<Overlap>; 2] = [None, None];
    let mut rms = [0.0; 2];
    for (done, frame) in frames.iter().enumerate() {
        for ((body, overlap), rms) in bodies.iter().zip(&mut overlaps).zip(&mut rms) {
            let at_frame = |error| BodyFitError::Frame { frame: frame.frame, error };
            let (views, start) = (frame.views.clone(), frame.start.normalized());
            let fit = Fit::new(Arc::clone(body), views, start, options.pose.clone()).map_err(at_frame);
            let mut fit = fit?;
            fit.run(cancel, |_| {});
            if cancel.is_cancelled() {
                return Err(BodyFitError::Cancelled.into());
            }
            *rms += fit.rms() / frames.len() as f64;
            *overlap =
                (*overlap).into_iter().chain(frame.overlap(body, fit.pose(), 0.0)).reduce(Overlap::merge);
        }
        progress(done + 1);
    }
    let iou = overlaps.map(|overlap| overlap.and_then(|overlap| overlap.iou()));
    Ok(Judged { frames: frames.iter().map(|frame| frame.frame).collect(), iou, rms })
}

fn doubts(own: &BodyFit, judged: &Judged, options: &OwnSizesOptions) -> Vec<Doubt> {
    let mut doubts = Vec::new();
    if let [Some(scaled), Some(found)] = judged.iou
        && found < scaled + options.least_gain
    {
        doubts.push(Doubt::NotBetter { iou: [scaled, found] });
    }
    let stoutness = own.girth.ln() / own.girth_spread;
    if stoutness.abs() > options.most_deviations {
        doubts.push(Doubt::Stoutness { deviations: stoutness });
    }
    if let Some(widening) = own.widening {
        let deviations = widening.px * widening.metres_per_px / options.fit.widening;
        if deviations.abs() > options.most_deviations {
            doubts.push(Doubt::Widening { deviations });
        }
    }
    for size in &own.sizes {
        let deviations = size.z_score();
        if deviations.abs() > options.most_size_deviations {
            let name = size.name.clone();
            doubts.push(Doubt::Size { name, kind: size.kind, deviations });
        }
    }
    doubts
}
