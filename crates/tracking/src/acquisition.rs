//! A person of unknown size, in an unknown pose, without keypoints: a first body in one pass.
//!
//! After I. Mikić, M. Trivedi, E. Hunter and P. Cosman (IJCV 53, 2003), with pixels in the place of voxels, and the report's 6.5:
//!
//! 1. **Size.** The hull of all silhouettes says how tall the person is, roughly: the average body is scaled to it.
//! 2. **Pose.** Templates are put into the silhouettes one after the other ([`templates`](crate::templates)), or the search looks for it
//!    ([`search`](crate::search)); a fit goes on from there.
//! 3. **Growing.** Every limb is a template that shrinks until it holds no background and grows until background enters in some
//!    camera. A limb's radius ends there; the end of an arm, a leg or the skull is felt for by a ball that goes along it; where the
//!    chain is bent, the joint in its middle goes to where both parts hold most of the subject. Left and right, and all frames,
//!    count together, by their medians.
//! 4. **Turning on the way.** After each round of growing a fit turns all limbs of the grown body, and growing begins again.
//!
//! There is no prior of proportions and no least squares: it is quick and rough, a body to begin
//! [`fit_body`](crate::body_fit::fit_body) or a track with. Lengths that end nowhere (spine, hips, clavicles) keep the body's
//! proportions.

mod sizes;

use std::sync::Arc;

use sizes::Factors;
use thiserror::Error;

use crate::body::{Model, ModelError, Pose};
use crate::cancel::CancelToken;
use crate::fit::{Fit, FitError, FitOptions, FitView};
use crate::numbers::{AT_LEAST_ONE, OptionError, Range, check_options};
use crate::search::{WithoutStartError, WithoutStartOptions, hull_scale, without_start};
use crate::templates::{Silhouettes, TemplateBody, TemplateError, TemplateOptions, place};

/// Why no body was acquired.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum AcquireError {
    #[error(transparent)]
    Templates(#[from] TemplateError),
    #[error(transparent)]
    Search(#[from] WithoutStartError),
    #[error(transparent)]
    Option(#[from] OptionError),
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error("the body cannot have the sizes that were found: {0}")]
    Size(#[from] ModelError),
    #[error("the search for a first body was stopped")]
    Cancelled,
}

/// A body that was acquired.
#[derive(Debug, Clone, PartialEq)]
pub struct Acquired {
    /// The body.
    pub model: Arc<Model>,
    /// Its poses, one a frame.
    pub poses: Vec<Pose>,
    /// What the given body was scaled by before it was grown.
    pub scale: f64,
    /// Sizes that were measured, of all lengths and radii, a limb each, in the last round.
    pub measured: usize,
    /// The rounds of growing, in order.
    pub rounds: Vec<GrowthRound>,
}

/// A round of growing: how the limbs stood, and what became of their sizes.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthRound {
    /// The poses of the body before it was grown, after a fit turned all limbs; one a frame.
    pub poses: Vec<Pose>,
    /// That body.
    pub before: Arc<Model>,
    /// The body as it was grown.
    pub after: Arc<Model>,
    /// Per limb, whether its length and its radius were measured, on this side or the other. Other sizes follow these, or stay.
    pub measured: Vec<[bool; 2]>,
}

impl GrowthRound {
    /// How many times as long and as thick a limb is after the round.
    #[must_use]
    pub fn factors(&self, limb: usize) -> [f64; 2] {
        let (before, after) = (&self.before.limbs()[limb], &self.after.limbs()[limb]);
        [after.length / before.length, after.radius / before.radius]
    }

    /// The body on its way: of the limbs for which `is_grown` says so the grown sizes, of the others those before.
    #[must_use]
    pub fn partly(&self, is_grown: impl Fn(usize) -> bool) -> Arc<Model> {
        let sizes = |limb: usize| {
            let of = if is_grown(limb) { &self.after } else { &self.before };
            [of.limbs()[limb].length, of.limbs()[limb].radius]
        };
        self.before.with_sizes(sizes).map_or_else(|_| Arc::clone(&self.after), Arc::new)
    }
}

/// Acquires a body from one moment in which nothing is known of it.
///
/// # Errors
/// Returns an error if nobody is seen, if silhouettes do not meet, if an option is out of range, or if it is cancelled.
pub fn acquire(
    model: &Arc<Model>,
    views: &[FitView],
    options: &AcquireOptions,
    cancel: &CancelToken,
) -> Result<Acquired, AcquireError> {
    options.check()?;
    let (scaled, scale, pose) = match &options.pose {
        FirstPose::Search(choices) => {
            let found = without_start(model, views, choices, cancel)?;
            (Arc::clone(&found.model), found.scale, found.pose().clone())
        }
        FirstPose::Templates(choices) => {
            let scale = hull_scale(model, views, choices.up, cancel)?;
            let scaled = Arc::new(model.scaled(scale)?);
            let pose = place(&scaled, views, choices, cancel)?.pose;
            (scaled, scale, pose)
        }
    };
    let acquired = acquire_posed(&scaled, &[(views.to_vec(), pose)], options, cancel)?;
    Ok(Acquired { scale, ..acquired })
}

/// The same from poses that are about right, of a body of about the right size, in one moment or several.
///
/// # Errors
/// As [`acquire`].
pub fn acquire_posed(
    model: &Arc<Model>,
    frames: &[(Vec<FitView>, Pose)],
    options: &AcquireOptions,
    cancel: &CancelToken,
) -> Result<Acquired, AcquireError> {
    options.check()?;
    let mut body = Arc::clone(model);
    let mut poses: Vec<Pose> = frames.iter().map(|(_, pose)| pose.clone()).collect();
    let (mut measured, mut rounds) = (0, Vec::with_capacity(options.rounds));
    for _ in 0..options.rounds {
        let mut all: Vec<Factors> = Vec::with_capacity(frames.len());
        for ((views, _), pose) in frames.iter().zip(&mut poses) {
            *pose = turned(&body, views, pose, cancel)?;
            let seen: Vec<FitView> = views.iter().filter(|view| view.has_data()).cloned().collect();
            let frame = TemplateBody::new(&body)
                .ok_or_else(|| TemplateError::NoHead { model: body.name().to_owned() })?;
            all.push(sizes::measured(&frame, &Silhouettes::new(&seen), options, pose));
        }
        let is_measured = |factors: &Factors| factors.iter().flatten().flatten().count();
        measured = all.iter().map(is_measured).max().unwrap_or(0);
        let after = Arc::new(sizes::resized(&body, &all)?);
        let measured = sizes::are_measured(&body, &all);
        rounds.push(GrowthRound { poses: poses.clone(), before: body, after: Arc::clone(&after), measured });
        body = after;
    }
    for ((views, _), pose) in frames.iter().zip(&mut poses) {
        *pose = turned(&body, views, pose, cancel)?;
    }
    Ok(Acquired { model: body, poses, scale: 1.0, measured, rounds })
}

/// All limbs turned by a fit that goes on from a pose.
fn turned(
    model: &Arc<Model>,
    views: &[FitView],
    pose: &Pose,
    cancel: &CancelToken,
) -> Result<Pose, AcquireError> {
    let mut fit = Fit::new(Arc::clone(model), views.to_vec(), pose.clone(), FitOptions::default())?;
    let pose = fit.run(cancel, |_| {}).pose;
    if cancel.is_cancelled() { Err(AcquireError::Cancelled) } else { Ok(pose) }
}

/// By what the first pose is found.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one of them is made a run")]
pub enum FirstPose {
    /// Templates, one after the other.
    Templates(TemplateOptions),
    /// The program's own search from the hull.
    Search(WithoutStartOptions),
}

/// How to acquire a body.
#[derive(Debug, Clone, PartialEq)]
pub struct AcquireOptions {
    /// By what the first pose is found.
    pub pose: FirstPose,
    /// The share of a template's pixels, in the camera that sees most of it, that is background where growing ends.
    pub background: f64,
    /// By how much a template grows or shrinks at a time, as a share.
    pub step: f64,
    /// How much smaller and larger than it began a size may become, as factors.
    pub range: [f64; 2],
    /// Rounds of growing, each after a fit of the pose; at least one.
    pub rounds: usize,
}

impl Default for AcquireOptions {
    fn default() -> Self {
        Self {
            pose: FirstPose::Search(WithoutStartOptions {
                scale_body: true,
                ..WithoutStartOptions::default()
            }),
            background: 0.05,
            step: 0.02,
            range: [0.6, 1.7],
            rounds: 2,
        }
    }
}

impl AcquireOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first option that is out of range.
    pub fn check(&self) -> Result<(), OptionError> {
        const SHARE: Range = Range(|value| value > 0.0 && value < 0.5, "more than 0 and less than 0.5");
        const SMALLEST: Range = Range(|value| value > 0.0 && value < 1.0, "between 0 and 1");
        const LARGEST: Range = Range(|value| value > 1.0 && value.is_finite(), "more than 1");
        check_options([
            ("background", self.background, SHARE),
            ("step", self.step, SHARE),
            ("range[0]", self.range[0], SMALLEST),
            ("range[1]", self.range[1], LARGEST),
            ("rounds", self.rounds as f64, AT_LEAST_ONE),
        ])
    }
}
