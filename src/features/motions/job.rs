//! Names of a track's frames. A track with gaps is named run by run: nobody knows what happened in between.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::Estimate;
use backlit_formats::motion::{JointTrack, Motion};
use backlit_recognition::joints::SHORTEST_S;
use backlit_recognition::{FrameName, Method, MotionError, Recognition, Recognizer};
use backlit_runs::motions::{joint_motion, read_recognizer};
use backlit_tracking::body::Model;
use backlit_tracking::cancel::CancelToken;
use glam::DVec3;

use super::words;
use crate::context::marks::NamedStretch;

/// A longer gap begins a new run, seconds; a shorter one is bridged.
const BRIDGED_S: f64 = 0.25;

/// All that names depend on.
#[derive(Debug, Clone)]
pub(super) struct Inputs {
    pub(super) body: Arc<Model>,
    pub(super) estimates: Arc<BTreeMap<usize, Arc<Estimate>>>,
    pub(super) frame_rate: f64,
    pub(super) up: DVec3,
    pub(super) model: Option<PathBuf>,
    pub(super) method: Method,
}

/// The document's parts are shared: as long as one has not changed, it is the same.
impl PartialEq for Inputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.body, &other.body)
            && Arc::ptr_eq(&self.estimates, &other.estimates)
            && self.frame_rate.to_bits() == other.frame_rate.to_bits()
            && self.up == other.up
            && self.model == other.model
            && self.method == other.method
    }
}

#[derive(Debug)]
pub(super) struct RecognisedMotions {
    pub(super) recognizer: Recognizer,
    pub(super) method: Method,
    /// Classes in plain words, by number.
    pub(super) names: Vec<String>,
    /// Runs of frames without a gap, in their order.
    pub(super) runs: Vec<Recognition>,
}

/// Why there are no names.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Missing {
    /// Nothing is tracked.
    Track,
    /// Too few frames without a gap.
    Short { seconds: f64, least: f64 },
    /// The body lacks a joint.
    Joint(String),
    /// The file that was learnt elsewhere is none; why.
    Model(String),
    /// Something else; why, without a full stop.
    Other(String),
}

impl RecognisedMotions {
    /// A class in plain words.
    pub(super) fn name(&self, class: Option<usize>) -> &str {
        class.and_then(|class| self.names.get(class)).map_or(words::UNKNOWN, |name| name)
    }

    /// The class in plain words that a frame is most likely of, known or not.
    pub(super) fn likeliest(&self, named: &FrameName) -> &str {
        let shares = &named.shares;
        self.name((0..shares.len()).max_by(|&a, &b| shares[a].total_cmp(&shares[b])))
    }

    /// What a frame is.
    pub(super) fn frame(&self, frame: usize) -> Option<&FrameName> {
        let run = self.runs.iter().find(|run| {
            run.frames
                .first()
                .zip(run.frames.last())
                .is_some_and(|(a, b)| (a.frame..=b.frame).contains(&frame))
        })?;
        run.frames.get(frame - run.frames[0].frame)
    }

    /// All frames of one name that follow each other.
    pub(super) fn stretches(&self) -> Vec<NamedStretch> {
        let named = |stretch: &backlit_recognition::Stretch| NamedStretch {
            name: self.name(stretch.class).to_owned(),
            class: stretch.class,
            frames: stretch.frames.clone(),
            confidence: stretch.confidence,
        };
        self.runs.iter().flat_map(|run| &run.stretches).map(named).collect()
    }
}

impl Inputs {
    /// Names all frames that a pose was found for, where somebody was in the picture.
    pub(super) fn recognise(&self, cancel: &CancelToken) -> Result<Arc<RecognisedMotions>, Missing> {
        let recognizer =
            read_recognizer(self.model.as_deref()).map_err(|error| Missing::Model(format!("{error:#}")))?;
        let seen = self.estimates.iter().filter(|(_, estimate)| estimate.cost.is_some());
        let poses = seen.map(|(&frame, estimate)| (frame, estimate.pose.clone())).collect();
        let motion = Motion::of_poses("", (*self.body).clone(), self.frame_rate, poses);
        let track = JointTrack::of_motion(&motion);
        // A method that was kept from another model.
        let is_there = recognizer.methods().any(|method| method == self.method);
        let method = if is_there { self.method } else { Method::Combined };
        let bridged = (BRIDGED_S * self.frame_rate).max(1.0) as usize;
        let (mut runs, mut problem) = (Vec::new(), Missing::Track);
        for run in track.frames.chunk_by(|(a, _), (b, _)| b - a <= bridged) {
            if cancel.is_cancelled() {
                break;
            }
            let found = joint_motion(&track, run, self.up)
                .and_then(|motion| recognizer.recognise_by(&motion, method));
            match found {
                Ok(found) => runs.push(found),
                Err(error) => problem = problem.or(error),
            }
        }
        if runs.is_empty() {
            return Err(problem);
        }
        let names = recognizer.classes.iter().map(|class| words::class(class)).collect();
        Ok(Arc::new(RecognisedMotions { recognizer, method, names, runs }))
    }
}

impl Missing {
    /// What is to be said of two runs without names: of the longest one that is too short.
    fn or(self, error: MotionError) -> Self {
        match (self, error) {
            (Self::Short { seconds: a, least }, MotionError::TooShort { seconds, .. }) => {
                Self::Short { seconds: a.max(seconds), least }
            }
            (_, MotionError::TooShort { seconds, .. }) => Self::Short { seconds, least: SHORTEST_S },
            (_, MotionError::MissingJoint { names, .. }) => Self::Joint(format!("“{}”", names[1])),
            (_, other) => Self::Other(other.to_string()),
        }
    }
}
