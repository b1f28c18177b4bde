//! Cameras as far as they are repaired, and what is left between every two of them.

use std::borrow::Cow;

use super::coherence::{FrameGaps, SilhouetteRecord, gaps};
use super::hypothesis::{Hypothesis, Repair};
use super::outlines::{Clock, Outlines};
use super::pair_angles::{ByWitness, PairAngles, Residuals, noise};
use crate::camera::Camera;
use crate::synchronise::Recording;

/// Frames by which cameras are fitted; clocks are by all.
const FITTED_FRAMES: usize = 48;
/// What does not fit at all is apart by this share of the picture's height.
const SPREAD: f64 = 0.05;

/// Cameras as far as they are repaired.
pub(super) struct State {
    pub(super) pairs: Vec<[usize; 2]>,
    pub(super) cameras: Vec<Camera>,
    pub(super) clocks: Vec<Clock>,
    /// Of all frames.
    pub(super) full: Sampled,
    /// Of some, by which cameras are fitted.
    pub(super) thin: Sampled,
    pub(super) silhouettes: Vec<SilhouetteRecord>,
}

/// What cameras see in a set of frames, and what two are apart, by pair.
pub(super) struct Sampled {
    pub(super) outlines: Vec<Outlines>,
    pub(super) recordings: Vec<Recording>,
    pub(super) angles: Vec<PairAngles>,
    pub(super) residuals: Vec<Residuals>,
}

impl Sampled {
    fn new(outlines: Vec<Outlines>, cameras: &[Camera], pairs: &[[usize; 2]]) -> Self {
        let recordings: Vec<Recording> =
            outlines.iter().zip(cameras).map(|(outlines, camera)| outlines.seen_by(camera)).collect();
        let angles: Vec<PairAngles> =
            pairs.iter().map(|&[a, b]| PairAngles::of(&recordings[a], &recordings[b])).collect();
        let residuals = angles.iter().map(|angles| angles.residuals([Clock::RIGHT; 2])).collect();
        Self { outlines, recordings, angles, residuals }
    }

    /// What a repair leaves the pairs apart that it concerns.
    fn with(&self, clocks: &[Clock], pairs: &[[usize; 2]], repair: &Repair) -> Vec<(usize, Residuals)> {
        let concerns = |camera: usize| repair.cameras.iter().any(|(index, _)| *index == camera);
        let is_clock = repair.clock != Clock::RIGHT;
        let mut changed: Vec<Cow<'_, Recording>> = self.recordings.iter().map(Cow::Borrowed).collect();
        if !is_clock {
            for (index, camera) in &repair.cameras {
                changed[*index] = Cow::Owned(self.outlines[*index].seen_by(camera));
            }
        }
        let clock = |camera: usize| {
            if concerns(camera) { clocks[camera].then(repair.clock) } else { clocks[camera] }
        };
        let of_pair = |(at, &[a, b]): (usize, &[usize; 2])| {
            if !concerns(a) && !concerns(b) {
                return None;
            }
            let clocks = [clock(a), clock(b)];
            let mut residuals = if is_clock {
                self.angles[at].residuals(clocks)
            } else {
                PairAngles::of(&changed[a], &changed[b]).residuals(clocks)
            };
            if let Some(split) = repair.after {
                let seconds = self.recordings[a].sightings.iter().map(|sighting| sighting.seconds);
                residuals.keep_before(&self.residuals[at], seconds, split);
            }
            Some((at, residuals))
        };
        pairs.iter().enumerate().filter_map(of_pair).collect()
    }

    fn apply(&mut self, clocks: &[Clock], pairs: &[[usize; 2]], repair: &Repair) {
        for (pair, residuals) in self.with(clocks, pairs, repair) {
            self.residuals[pair] = residuals;
        }
        if repair.after.is_some() {
            return;
        }
        for (index, camera) in &repair.cameras {
            self.recordings[*index] = self.outlines[*index].seen_by(camera);
        }
        for (at, &[a, b]) in pairs.iter().enumerate() {
            if repair.cameras.iter().any(|(index, _)| *index == a || *index == b) {
                self.angles[at] = PairAngles::of(&self.recordings[a], &self.recordings[b]);
            }
        }
    }
}

impl State {
    pub(super) fn new(recordings: &[Recording], cameras: Vec<Camera>) -> Self {
        let both = || recordings.iter().zip(&cameras);
        let outlines: Vec<Outlines> = both().map(|(recording, lens)| Outlines::of(recording, lens)).collect();
        let silhouettes = both().map(|(recording, lens)| SilhouetteRecord::of(recording, lens)).collect();
        let count = cameras.len();
        let pairs: Vec<[usize; 2]> = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b])).collect();
        let frames = outlines.iter().map(Outlines::frame_count).max().unwrap_or(0);
        let every = frames.div_ceil(FITTED_FRAMES).max(1);
        let thin = outlines.iter().map(|outlines| outlines.thinned(every)).collect();
        let full = Sampled::new(outlines, &cameras, &pairs);
        let thin = Sampled::new(thin, &cameras, &pairs);
        Self { clocks: vec![Clock::RIGHT; count], full, thin, pairs, cameras, silhouettes }
    }

    pub(super) fn apply(&mut self, repair: &Repair) {
        for sampled in [&mut self.full, &mut self.thin] {
            sampled.apply(&self.clocks, &self.pairs, repair);
        }
        for (index, camera) in &repair.cameras {
            if repair.after.is_none() {
                self.cameras[*index] = camera.clone();
            }
            self.clocks[*index] = self.clocks[*index].then(repair.clock);
        }
    }

    pub(super) fn spread(&self) -> f64 {
        let tallest = self.cameras.iter().map(Camera::height).max().unwrap_or(1);
        (SPREAD * tallest as f64).max(4.0)
    }

    pub(super) fn noise(&self) -> ByWitness {
        noise(&self.full.residuals, self.spread())
    }

    pub(super) fn with(&self, sampled: &Sampled, repair: &Repair) -> Vec<(usize, Residuals)> {
        sampled.with(&self.clocks, &self.pairs, repair)
    }

    /// The gaps of edges as cameras and clocks are; none with two cameras, whose outlines say as much.
    pub(super) fn gaps(&self) -> Vec<FrameGaps> {
        if self.cameras.len() > 2 { gaps(&self.silhouettes, &self.cameras, &self.clocks) } else { Vec::new() }
    }

    /// The same with a fault repaired; `before` are those without the repair.
    pub(super) fn gaps_with(&self, repair: &Repair, before: &[FrameGaps]) -> Vec<FrameGaps> {
        let (mut cameras, mut clocks) = (self.cameras.clone(), self.clocks.clone());
        for (index, camera) in &repair.cameras {
            cameras[*index] = camera.clone();
            clocks[*index] = clocks[*index].then(repair.clock);
        }
        let mut after = gaps(&self.silhouettes, &cameras, &clocks);
        if let Some(split) = repair.after {
            let both = after.iter_mut().zip(before);
            both.filter(|(_, before)| before.seconds < split)
                .for_each(|(after, before)| *after = before.clone());
        }
        after
    }

    pub(super) fn span(&self, hypothesis: &Hypothesis) -> [f64; 2] {
        self.full.recordings[hypothesis.camera.unwrap_or(0)].span()
    }
}
