//! Chooses the settings of the segmentation by how well cameras and body agree.
//!
//! In each of some frames the body is fitted again to what the cameras see by other settings, from the pose that is known. The
//! agreement of a frame is that of body and silhouettes over all cameras,
//!
//! ```text
//! a = (|S ∩ B| + ½ |U ∩ B|) / (|S ∪ B| + |X|)
//! ```
//!
//! with S the subject, B the body, U unknown pixels, which hold half, and X what one camera alone calls subject. One setting after the
//! other is changed where that raises the mean of a by more than chance: by two deviations of the mean of the frames' differences.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::FootageError;
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitError};
use backlit_tracking::image::RgbImage;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::Overlap;
use backlit_tracking::track::overlaps;
use rayon::prelude::*;
use thiserror::Error;

use super::PosedBody;
use super::settings::{candidates, with_changes};

/// The most frames that are looked at.
const MOST_FRAMES: usize = 12;
/// How many times each setting is looked at.
const ROUNDS: usize = 2;
/// A smaller gain is not worth a change.
const LEAST_GAIN: f64 = 0.001;
/// The deviations of its mean from which on a gain counts.
const DEVIATIONS: f64 = 2.0;

/// Why settings cannot be chosen.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum TuneError {
    #[error("no frame has a known pose; expected the body tracked or posed in at least one")]
    NoPose,
    #[error("no camera has silhouettes that are made of its pictures")]
    NoPictures,
    #[error("it was stopped")]
    Cancelled,
    #[error(transparent)]
    Footage(#[from] FootageError),
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// How well cameras and body agree, over frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// a of each frame.
    frames: Vec<f64>,
}

impl Agreement {
    /// The mean of the frames, from 0 to 1.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.frames.iter().sum::<f64>() / self.frames.len().max(1) as f64
    }

    /// Whether it is better than another of the same frames by more than chance.
    fn is_above(&self, other: &Self) -> bool {
        let gains: Vec<f64> = self.frames.iter().zip(&other.frames).map(|(a, b)| a - b).collect();
        let count = gains.len() as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        mean > LEAST_GAIN.max(DEVIATIONS * (variance / count).sqrt())
    }
}

/// What was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct TunedSettings {
    /// The first camera's settings. Others have their own, [changed](super::with_changes) likewise.
    pub options: SegmentOptions,
    /// How well all agree by the settings before.
    pub before: Agreement,
    /// How well they do by these.
    pub after: Agreement,
    /// How many settings were tried.
    pub tried: usize,
}

/// The pictures of a frame, and the pose that is known.
struct Sample {
    frame: usize,
    pictures: Vec<RgbImage>,
    pose: Pose,
}

/// Chooses settings, beginning with the first camera's. `tell` hears how many settings were tried, and of how many at most.
///
/// # Errors
/// No pose is known, pictures cannot be read, or it is cancelled.
pub fn tune(
    footage: &Footage,
    measurement: &Arc<Vec<SegmentOptions>>,
    body: &PosedBody,
    cancel: &CancelToken,
    mut tell: impl FnMut([usize; 2]),
) -> Result<TunedSettings, TuneError> {
    let mut trial = SettingsTrial::new(footage, measurement, body)?;
    let mut options = measurement.first().cloned().unwrap_or_default();
    let (before, poses) = trial.agreement(&options)?;
    trial.take_poses(poses);
    let (mut after, mut tried) = (before.clone(), 1);
    let all = 2 + ROUNDS * candidates(&options).iter().map(Vec::len).sum::<usize>();
    // Settings that are all wrong are not mended one by one: the usual ones are tried first.
    let SegmentOptions { z_threshold, shadow, hysteresis_z, chroma, opening_px, closing_px, .. } =
        SegmentOptions::default();
    let usual = SegmentOptions {
        z_threshold,
        shadow,
        hysteresis_z,
        chroma,
        opening_px,
        closing_px,
        ..options.clone()
    };
    let (found, poses) = trial.agreement(&usual)?;
    if found.is_above(&after) {
        (options, after) = (usual, found);
        trial.take_poses(poses);
    }
    for _ in 0..ROUNDS {
        let start = options.clone();
        for knob in 0..candidates(&options).len() {
            for candidate in candidates(&options).swap_remove(knob) {
                if cancel.is_cancelled() {
                    return Err(TuneError::Cancelled);
                }
                tell([tried, all]);
                // A test that this background does not allow is none to choose.
                if let Ok((found, poses)) = trial.agreement(&candidate) {
                    tried += 1;
                    if found.is_above(&after) {
                        (options, after) = (candidate, found);
                        trial.take_poses(poses);
                    }
                }
            }
        }
        if options == start {
            break;
        }
    }
    Ok(TunedSettings { options, before, after, tried })
}

/// What settings are tried on.
struct SettingsTrial<'a> {
    footage: &'a Footage,
    measurement: &'a [SegmentOptions],
    body: &'a PosedBody,
    cameras: Vec<usize>,
    samples: Vec<Sample>,
}

impl<'a> SettingsTrial<'a> {
    fn new(
        footage: &'a Footage,
        measurement: &'a [SegmentOptions],
        body: &'a PosedBody,
    ) -> Result<Self, TuneError> {
        let known: Vec<(usize, &Pose)> = body
            .poses
            .iter()
            .filter(|(frame, _)| **frame < footage.frame_count())
            .map(|(frame, pose)| (*frame, pose))
            .collect();
        let Some(&(first, _)) = known.first() else { return Err(TuneError::NoPose) };
        let mut cameras = Vec::new();
        for camera in 0..footage.cameras.len() {
            if footage.drawn.is_none() && footage.given_mask(camera, first)?.is_none() {
                cameras.push(camera);
            }
        }
        if cameras.is_empty() {
            return Err(TuneError::NoPictures);
        }
        let count = known.len().min(MOST_FRAMES);
        let places = (0..count).map(|place| (2 * place + 1) * known.len() / (2 * count));
        let sample = |(frame, pose): (usize, &Pose)| -> Result<Sample, TuneError> {
            let pictures: Result<Vec<RgbImage>, FootageError> =
                cameras.iter().map(|&camera| footage.picture(camera, frame)).collect();
            Ok(Sample { frame, pictures: pictures?, pose: pose.clone() })
        };
        let samples: Result<Vec<Sample>, TuneError> = places.map(|place| sample(known[place])).collect();
        Ok(Self { footage, measurement, samples: samples?, body, cameras })
    }

    /// Later fits begin with these poses, one a frame.
    fn take_poses(&mut self, poses: Vec<Pose>) {
        self.samples.iter_mut().zip(poses).for_each(|(sample, pose)| sample.pose = pose);
    }

    /// How well all agree by some settings, and the poses that the body then has.
    fn agreement(&self, candidate: &SegmentOptions) -> Result<(Agreement, Vec<Pose>), TuneError> {
        let first = self.measurement.first().unwrap_or(candidate);
        let of_camera = |&camera: &usize| match self.measurement.get(camera) {
            Some(own) => with_changes(own, first, candidate),
            None => candidate.clone(),
        };
        let options: Vec<SegmentOptions> = self.cameras.iter().map(of_camera).collect();
        let one = |sample: &Sample| self.of_frame(sample, &options);
        let found: Result<Vec<(f64, Pose)>, TuneError> = self.samples.par_iter().map(one).collect();
        let (frames, poses) = found?.into_iter().unzip();
        Ok((Agreement { frames }, poses))
    }

    fn of_frame(&self, sample: &Sample, options: &[SegmentOptions]) -> Result<(f64, Pose), TuneError> {
        let tried = self.footage.tried_views(&self.cameras, sample.frame, &sample.pictures, options)?;
        let PosedBody { model, fit, .. } = self.body;
        let refit = Fit::new(model.clone(), tried.views.clone(), sample.pose.clone(), (**fit).clone());
        // By settings that leave no subject nothing agrees.
        if matches!(refit, Err(FitError::NoData { .. })) {
            return Ok((0.0, sample.pose.clone()));
        }
        let mut refit = refit?;
        refit.run(&CancelToken::new(), |_| {});
        let overlap = overlaps(model, refit.pose(), fit.renderer, &tried.views);
        let all = overlap.into_iter().flatten().fold(Overlap::default(), Overlap::merge);
        let alone: usize = tried.unsupported_px.iter().sum();
        let union = all.agreement + all.missing + all.spurious + all.unknown + alone;
        let agreed = all.agreement as f64 + 0.5 * all.unknown as f64;
        let agreement = if union > 0 { agreed / union as f64 } else { 0.0 };
        Ok((agreement, refit.pose().clone()))
    }
}
