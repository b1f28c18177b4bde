//! Backgrounds that change while a take is filmed, found by looking at sampled frames of all its cameras.

use std::sync::Arc;

use backlit_tracking::cancel::CancelToken;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::segment::changes::{
    BackgroundChange, LightField, StandingThing, StillPixels, light_change,
};
use backlit_tracking::silhouette::{Label, Mask};
use image::RgbImage;
use rayon::prelude::*;

use super::{Footage, FootageError};

/// The most frames of a take that are looked at, and the least distance of two: a look costs about as much as reading for a track does.
const MOST_SAMPLES: usize = 36;
const LEAST_STEP: usize = 4;
/// With fewer cameras nobody can say which of them is wrong.
pub const FEWEST_CAMERAS: usize = 3;

/// A take whose changes are looked for.
#[derive(Debug)]
pub struct ChangeSurvey<'a, P> {
    /// The take; changes that it has are looked for again.
    pub footage: &'a Footage,
    /// The cameras that are looked at, and check one another.
    pub cameras: &'a [usize],
    /// The frames, in their order.
    pub frames: &'a [usize],
    /// How silhouettes are made, a camera.
    pub measurement: &'a [SegmentOptions],
    /// The picture of a camera and a frame, on the ideal grid.
    pub picture: P,
}

/// What was seen of one camera.
struct CameraSurvey {
    camera: usize,
    still: StillPixels,
    light: Vec<(usize, LightField)>,
}

impl Footage {
    /// The survey of these cameras in these frames, by the footage's own pictures and the take's measurement.
    pub fn change_survey<'a>(
        &'a self,
        cameras: &'a [usize],
        frames: &'a [usize],
    ) -> ChangeSurvey<'a, impl Fn(usize, usize) -> Result<RgbImage, FootageError> + Sync + 'a> {
        let measurement = self.take().measurement();
        let picture = |camera, frame| self.picture(camera, frame);
        ChangeSurvey { footage: self, cameras, frames, measurement, picture }
    }
}

impl<P: Fn(usize, usize) -> Result<RgbImage, FootageError> + Sync> ChangeSurvey<'_, P> {
    /// The changes, in the order of cameras and frames; none with fewer than three cameras. Cameras whose silhouettes are given, and
    /// those that [need no support](SegmentOptions::needs_support), are left as they are. `tell` hears how many frames were looked at,
    /// of how many. `None` where it is cancelled. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// A picture or a background cannot be read.
    pub fn changes(
        &self,
        cancel: &CancelToken,
        mut tell: impl FnMut([usize; 2]),
    ) -> Result<Option<Vec<BackgroundChange>>, FootageError> {
        if self.cameras.len() < FEWEST_CAMERAS || self.frames.is_empty() || self.footage.drawn.is_some() {
            return Ok(Some(Vec::new()));
        }
        let mut footage = Footage { changes: Arc::default(), ..self.footage.clone() };
        let Some(seen) = self.survey_cameras(&footage, cancel, &mut tell)? else { return Ok(None) };
        let mut changes = Vec::new();
        for CameraSurvey { camera, light, .. } in &seen {
            let background = footage.prepared.background(*camera)?;
            let field = |frame| -> Result<_, FootageError> {
                Ok(LightField::fit(&(self.picture)(*camera, frame)?, background, |_| true))
            };
            changes.extend(light_change(*camera, light, field)?);
        }
        // Before other light what stands still cannot be told.
        let seen = if changes.is_empty() {
            seen
        } else {
            footage.changes = Arc::new(changes.clone());
            let Some(again) = self.survey_cameras(&footage, cancel, &mut tell)? else { return Ok(None) };
            again
        };
        for CameraSurvey { camera, still, .. } in seen {
            let found = still.things(footage.prepared.background(camera)?);
            for thing in found {
                changes.push(self.change(camera, thing)?);
            }
        }
        changes.sort_by_key(|change| (change.camera, change.from));
        Ok(Some(changes))
    }

    /// How far samples are from one another, in frames that are used.
    fn step(&self) -> usize {
        self.frames.len().div_ceil(MOST_SAMPLES).max(LEAST_STEP)
    }

    fn samples(&self) -> Vec<usize> {
        self.frames.iter().copied().step_by(self.step()).collect()
    }

    /// Looks at all samples; `None` where it is cancelled.
    fn survey_cameras(
        &self,
        footage: &Footage,
        cancel: &CancelToken,
        tell: &mut impl FnMut([usize; 2]),
    ) -> Result<Option<Vec<CameraSurvey>>, FootageError> {
        let measurement = self.measurement;
        let samples = self.samples();
        let mut seen: Vec<CameraSurvey> = Vec::new();
        for &camera in self.cameras {
            if measurement[camera].needs_support && footage.given_mask(camera, samples[0])?.is_none() {
                let ideal = &footage.cameras[camera];
                let still = StillPixels::new([ideal.width(), ideal.height()]);
                seen.push(CameraSurvey { camera, still, light: Vec::new() });
            }
        }
        if seen.is_empty() {
            return Ok(Some(seen));
        }
        for (number, &frame) in samples.iter().enumerate() {
            if cancel.is_cancelled() {
                return Ok(None);
            }
            let read = |&camera: &usize| -> Result<(Option<RgbImage>, Mask), FootageError> {
                if let Some(mask) = footage.given_mask(camera, frame)? {
                    return Ok((None, mask));
                }
                // A thing may be smaller than the body, and far from it.
                let options = SegmentOptions { min_group_fraction: 0.0, ..measurement[camera].clone() };
                let picture = (self.picture)(camera, frame)?;
                let mask = footage.mask(camera, frame, &picture, &options)?;
                Ok((Some(picture), mask))
            };
            let read: Vec<Result<_, FootageError>> = self.cameras.par_iter().map(read).collect();
            let read: Vec<(Option<RgbImage>, Mask)> = read.into_iter().collect::<Result<_, _>>()?;
            let mut supported: Vec<Mask> = read.iter().map(|(_, mask)| mask.clone()).collect();
            footage.check_masks(self.cameras, frame, &mut supported, |_| true);
            let add = |one: &mut CameraSurvey| -> Result<(), FootageError> {
                let Some(place) = self.cameras.iter().position(|camera| *camera == one.camera) else {
                    return Ok(());
                };
                let ((Some(picture), single), supported) = (&read[place], &supported[place]) else {
                    return Ok(());
                };
                one.still.add(picture, single, supported);
                let is_background = |pixel: usize| supported.labels()[pixel] != Label::Subject;
                let background = footage.prepared.background(one.camera)?;
                let field = LightField::fit(picture, background, is_background);
                one.light.extend(field.map(|field| (frame, field)));
                Ok(())
            };
            seen.par_iter_mut().map(add).collect::<Result<(), _>>()?;
            tell([number + 1, samples.len()]);
        }
        Ok(Some(seen))
    }

    /// When a thing came, and when it went.
    fn change(&self, camera: usize, thing: StandingThing) -> Result<BackgroundChange, FootageError> {
        let step = self.step();
        let shown = |frame: usize| Ok::<_, FootageError>(thing.shown_in(&(self.picture)(camera, frame)?));
        // Between a frame that shows it and one that does not; both by their places among the frames.
        let edge = |mut there: usize, mut gone: usize| {
            let least = 0.5 * shown(self.frames[there])?;
            while there.abs_diff(gone) > 1 {
                let middle = there.midpoint(gone);
                let at = if shown(self.frames[middle])? >= least { &mut there } else { &mut gone };
                *at = middle;
            }
            Ok::<_, FootageError>(self.frames[there])
        };
        let from = match thing.first {
            0 => self.frames[0],
            first => edge(step * first, step * (first - 1))?,
        };
        let until = thing.last.map(|last| edge(step * last, step * (last + 1))).transpose()?;
        Ok(BackgroundChange {
            camera,
            from,
            until,
            kind: thing.kind,
            pixels: thing.pixels,
            light: Vec::new(),
        })
    }
}
