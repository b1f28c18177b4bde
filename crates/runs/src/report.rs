//! A track as a page to send: what the page holds is gathered here, for the command line and the window alike.

mod chosen;
mod compared;
mod figures;
mod making;
mod pictures;
mod steps;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::bookmark::Bookmark as Marked;
use backlit_document::{CameraUse, Document};
use backlit_formats::Footage;
use backlit_formats::export::track_read::WrittenTrack;
use backlit_formats::footage::CameraFrame;
use backlit_report::{
    Bookmark, CommandLine, DoubtedLimb, FitSteps, Frame, Page, PageCamera, PageLimb, Picture,
};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::{Camera, RigError, up_of};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::track::{FrameEstimate, Lost, Track};
use backlit_words::joint::JointId;
use glam::DVec3;
use thiserror::Error;

use crate::track_summary::TrackMaking;

pub use compared::ReportComparison;
pub use making::fit_of_settings;

/// Frames with a picture of each camera, unless something else is asked for.
pub const PICTURES: usize = 24;

/// A track with everything that a page tells of it.
#[derive(Debug, Clone)]
pub struct ReportSource {
    /// What the recording is called.
    pub name: String,
    /// Frames per second.
    pub frame_rate: f64,
    /// The body.
    pub model: Arc<Model>,
    /// The cameras' names, in the order of the estimates' overlaps.
    pub cameras: Vec<String>,
    /// The estimates.
    pub track: Track,
    /// Overlap of all cameras together, by frame, where it is not known by camera.
    pub ious: BTreeMap<usize, f64>,
    /// How a frame is fitted again for its steps.
    pub fit: FitOptions,
    /// The footage; `None` where the take is not at hand.
    pub footage: Option<Arc<Footage>>,
    /// How silhouettes are made, by the take's cameras; `None`: as the take says.
    pub measurement: Option<Arc<Vec<SegmentOptions>>>,
    /// By camera, how much its pixels weigh in a fit; 1 as a rule, 0 leaves it out.
    pub weights: Vec<f64>,
    /// How the track was made, where that is known.
    pub making: TrackMaking,
    /// Places that somebody marked.
    pub bookmarks: Vec<Bookmark>,
    /// References that it is compared with; see [`Self::compare`].
    pub comparisons: Vec<ReportComparison>,
}

/// What a page is to hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReportOptions {
    /// How many frames have a picture of each camera; those with bookmarks and with steps come on top.
    pub pictures: usize,
    /// The frames that are fitted again for their steps; `None`: the first that can be, and the most doubtful one.
    pub steps_of: Option<Vec<usize>>,
    /// The command that makes the page, if one does.
    pub command: Option<String>,
}

impl Default for ReportOptions {
    fn default() -> Self {
        Self { pictures: PICTURES, steps_of: None, command: None }
    }
}

/// Why there is no page.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ReportError {
    #[error("the track has no frame")]
    Empty,
    #[error("the take is not the track's: {0}")]
    Cameras(#[from] RigError),
    #[error("--steps-of: frame {frame} is not in the track, which has frames {first} to {last}")]
    NoFrame { frame: usize, first: usize, last: usize },
    #[error("stopped")]
    Stopped,
}

/// The poses of a track, by frame.
fn frames_poses(track: &Track) -> BTreeMap<usize, Pose> {
    track.frames.iter().map(|(frame, one)| (*frame, one.pose.clone())).collect()
}

impl ReportSource {
    /// A track as it was written. Its footage, if there is any, must be of the track's take.
    pub fn of_written(written: WrittenTrack, footage: Option<Arc<Footage>>, making: TrackMaking) -> Self {
        Self {
            measurement: None,
            weights: vec![1.0; written.cameras.len()],
            name: written.name,
            frame_rate: written.frame_rate,
            model: Arc::new(written.model),
            cameras: written.cameras,
            track: written.track,
            ious: BTreeMap::new(),
            fit: fit_of_settings(&making.settings),
            footage,
            making,
            bookmarks: Vec::new(),
            comparisons: Vec::new(),
        }
    }

    /// The poses of a document as they are, those set by hand included, with its footage.
    pub fn of_document(document: &Document, footage: Arc<Footage>) -> Self {
        let take = footage.take();
        let mut track = Track::default();
        let mut ious = BTreeMap::new();
        // Poses beyond the last frame are kept and not shown.
        for (frame, pose) in document.own_poses().into_iter().filter(|(at, _)| *at < take.frame_count()) {
            let mut one = FrameEstimate::of_pose(frame, pose);
            if let Some(found) = document.estimates.get(&frame).filter(|found| found.pose == one.pose) {
                (one.cost, one.rms, one.iterations) = (found.cost, found.rms, found.steps);
                one.lost_because = found.lost.then_some(Lost::Numbers);
                ious.extend(found.iou.map(|iou| (frame, iou)));
            }
            if let Some(told) = document.trust_of(frame, &one.pose) {
                one.trust = told.doubts().to_vec();
            }
            track.frames.insert(frame, one);
        }
        let path = || PathBuf::from(take.path());
        let joint = |joint: JointId| match joint {
            JointId::Root => 0,
            JointId::End(limb) => limb + 1,
        };
        let bookmark = |mark: &Marked| Bookmark {
            frame: mark.frame,
            camera: mark.camera,
            joint: mark.joint.map(joint),
            text: mark.text.clone(),
        };
        let weight = |camera: &CameraUse| if camera.used { camera.weight } else { 0.0 };
        Self {
            name: take.name().to_owned(),
            frame_rate: take.frame_rate(),
            model: document.model.clone(),
            cameras: footage.cameras.iter().map(|camera| camera.name().to_owned()).collect(),
            track,
            ious,
            fit: (*document.fit).clone(),
            measurement: Some(document.measurement.clone()),
            weights: document.cameras.iter().map(weight).collect(),
            making: TrackMaking { take: path(), ..making::of_document(document) },
            bookmarks: document.bookmarks.iter().map(bookmark).collect(),
            comparisons: Vec::new(),
            footage: Some(footage),
        }
    }

    /// Gathers the page. What of the footage cannot be read is left out, and the page says so.
    ///
    /// # Errors
    /// The track has no frame, the take lacks one of its cameras, steps are asked for of a frame that the track does not have, or
    /// the token was cancelled.
    pub fn page(&self, options: &ReportOptions, cancel: &CancelToken) -> Result<Page, ReportError> {
        let ends = self.track.frames.first_key_value().zip(self.track.frames.last_key_value());
        let Some(((&first, _), (&last, _))) = ends else { return Err(ReportError::Empty) };
        let asked = options.steps_of.iter().flatten();
        if let Some(&frame) = asked.into_iter().find(|&frame| !self.track.frames.contains_key(frame)) {
            return Err(ReportError::NoFrame { frame, first, last });
        }
        let seen = self.footage.as_ref().map(|footage| self.seen(footage)).transpose()?;
        let frames = || self.track.frames.values().map(|frame| self.frame(frame)).collect();
        let figures = || (frames(), figures::curves(self, seen.is_some()), figures::tables(self));
        // Videos are decoded by a thread a camera: a thread without one makes the figures.
        let (drawn, (frames, curves, tables)) =
            rayon::join(|| self.drawn(seen.as_ref(), options, cancel), figures);
        let PageDrawings { pictures, fits, notes } = drawn?;
        let cameras: Vec<&Camera> = seen.iter().flat_map(PageFootage::cameras).collect();
        Ok(Page {
            title: self.name.clone(),
            frame_rate: self.frame_rate,
            up: up_of(cameras.iter().copied()).unwrap_or(DVec3::Z),
            limbs: PageLimb::all(&self.model),
            cameras: cameras.iter().map(|camera| PageCamera::of(camera)).collect(),
            frames,
            pictures,
            fits,
            curves,
            tables,
            bookmarks: self.bookmarks.clone(),
            settings: making::settings(self),
            commands: self.commands(options),
            notes,
        })
    }

    /// What of the page is made of the footage.
    fn drawn(
        &self,
        seen: Option<&PageFootage<'_>>,
        options: &ReportOptions,
        cancel: &CancelToken,
    ) -> Result<PageDrawings, ReportError> {
        let mut notes = Vec::new();
        let Some(seen) = seen else {
            let why = "The take was not at hand when this page was made: it has no pictures, no silhouettes and no cameras.";
            return Ok(PageDrawings { notes: vec![why.to_owned()], ..PageDrawings::default() });
        };
        let chosen = chosen::frames(self, options, seen.frames(), |frame| seen.sooner(frame));
        let pictures = seen.pictures(&chosen.pictured, &mut notes, cancel)?;
        let fits = steps::fits(self, seen, &chosen.stepped, &mut notes, cancel)?;
        Ok(PageDrawings { pictures, fits, notes })
    }

    fn frame(&self, estimate: &FrameEstimate) -> Frame {
        let limbs = self.model.limbs();
        let told = estimate.trust.iter().filter(|limb| limbs[limb.limb].has_own_rotation);
        Frame {
            lost: estimate.lost_because.map(|why| figures::lost_text(why).to_owned()),
            iou: self.iou(estimate),
            doubts: told.filter_map(DoubtedLimb::of).collect(),
            ..Frame::of_pose(&self.model, estimate.frame, &estimate.pose)
        }
    }

    /// Overlap of all cameras together.
    fn iou(&self, estimate: &FrameEstimate) -> Option<f64> {
        estimate.iou().or_else(|| self.ious.get(&estimate.frame).copied())
    }

    fn commands(&self, options: &ReportOptions) -> Vec<CommandLine> {
        let made = Some(self.making.command.clone()).filter(|line| !line.is_empty());
        let lines = [("The track", made), ("This page", options.command.clone())];
        let command = |(title, line): (&str, Option<String>)| {
            let title = title.to_owned();
            line.map(|line| CommandLine { title, line })
        };
        lines.into_iter().filter_map(command).collect()
    }

    /// The footage with the track's cameras in it.
    fn seen<'a>(&self, footage: &'a Footage) -> Result<PageFootage<'a>, RigError> {
        let rig = footage.take().rig();
        let cameras: Result<Vec<usize>, RigError> = self.cameras.iter().map(|name| rig.index(name)).collect();
        let own = || Arc::new(footage.take().measurement().to_vec());
        let measurement = self.measurement.clone().unwrap_or_else(own);
        Ok(PageFootage { footage, cameras: cameras?, measurement, weights: self.weights.clone() })
    }
}

/// What of a page is made of the footage.
#[derive(Default)]
struct PageDrawings {
    pictures: Vec<Picture>,
    fits: Vec<FitSteps>,
    notes: Vec<String>,
}

/// What the track's cameras see.
struct PageFootage<'a> {
    footage: &'a Footage,
    /// The track's cameras, by their places in the take.
    cameras: Vec<usize>,
    /// How silhouettes are made, by the take's cameras.
    measurement: Arc<Vec<SegmentOptions>>,
    /// By the track's cameras, how much pixels weigh in a fit.
    weights: Vec<f64>,
}

impl PageFootage<'_> {
    fn frames(&self) -> usize {
        self.footage.frame_count()
    }

    fn cameras(&self) -> impl Iterator<Item = &Camera> {
        self.cameras.iter().map(|&camera| &*self.footage.cameras[camera])
    }

    /// The last frame, up to this one, whose picture the first camera has quickly.
    fn sooner(&self, frame: usize) -> usize {
        let first = self.cameras.first().and_then(|&camera| self.footage.take().footage().get(camera));
        first.map_or(frame, |footage| footage.quick_frame_before(frame))
    }

    /// The pictures and silhouettes of a frame.
    fn load(&self, frame: usize) -> Vec<CameraFrame> {
        self.footage.load_cameras(&self.cameras, &self.measurement, frame)
    }
}

#[cfg(test)]
mod tests;
