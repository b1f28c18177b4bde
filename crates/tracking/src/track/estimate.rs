//! What was found in a frame, and in all of them.

use std::collections::BTreeMap;

use super::beam::Mode;
use super::lost::Lost;
use super::motion::FrameBelief;
use crate::belief::{LimbTrust, Signs, Verdict};
use crate::body::{Kinematics, Model, Pose};
use crate::cues::LimbHold;
use crate::fit::{Evidence, FitView};
use crate::optimize::Termination;
use crate::render::{Ramp, RendererKind, View, prediction};
use crate::search::Hypothesis;
use crate::silhouette::{Label, Overlap};

/// What the tracker found in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameEstimate {
    /// Number of the frame.
    pub frame: usize,
    /// Its pose.
    pub pose: Pose,
    /// Cost at the end, squared grey levels, by the last stage's measure; `None` where nobody was in the picture.
    pub cost: Option<f64>,
    /// Root of the mean squared residual per pixel, grey levels; `None` likewise.
    pub rms: Option<f64>,
    /// Overlap of model and silhouette, camera by camera; `None` where there was no mask or nobody in it.
    pub overlap: Vec<Option<Overlap>>,
    /// Cameras that had nothing to say and were left out, by name.
    pub empty_cameras: Vec<String>,
    /// Iterations, rejected ones included.
    pub iterations: usize,
    /// Why the subject, or a limb of it, counts as lost; `None` if it does not.
    pub lost_because: Option<Lost>,
    /// Why the fit ended; `None` if there was nothing to fit.
    pub termination: Option<Termination>,
    /// What the Kalman filter believed, where it ran.
    pub belief: Option<FrameBelief>,
    /// What a search found before the fit, best first; empty where there was none.
    pub hypotheses: Vec<Hypothesis>,
    /// What held which part of the body, by rotation; empty where nobody watched cues
    /// ([`Tracker::with_cues`](super::Tracker::with_cues)) and in a frame in which nobody was found.
    pub holds: Vec<LimbHold>,
    /// How far each limb may be believed; empty where nobody judged them ([`Tracker::with_trust`](super::Tracker::with_trust)).
    pub trust: Vec<LimbTrust>,
    /// By limb, what that was told from; empty likewise, and of frames that were read from a file.
    pub signs: Vec<Signs>,
    /// Rivals that were carried beside the pose, likeliest first.
    pub modes: Vec<Mode>,
    /// Whether the pose was found elsewhere than where the motion led: by a search, or since a rival took the lead.
    pub is_elsewhere: bool,
}

impl FrameEstimate {
    /// A pose alone, without cost or overlap.
    #[must_use]
    pub fn of_pose(frame: usize, pose: Pose) -> Self {
        Self {
            frame,
            pose,
            cost: None,
            rms: None,
            overlap: Vec::new(),
            empty_cameras: Vec::new(),
            iterations: 0,
            lost_because: None,
            termination: None,
            belief: None,
            hypotheses: Vec::new(),
            holds: Vec::new(),
            trust: Vec::new(),
            signs: Vec::new(),
            modes: Vec::new(),
            is_elsewhere: false,
        }
    }

    /// Overlap of all cameras together; `None` without masks.
    #[must_use]
    pub fn iou(&self) -> Option<f64> {
        iou(&self.overlap)
    }

    /// The limbs that nothing held, each with those that turn with it: their poses are what motion and priors make of them.
    pub fn unsure_limbs(&self) -> impl Iterator<Item = usize> + '_ {
        self.holds.iter().filter(|hold| hold.is_unsure()).map(|hold| hold.limb)
    }

    /// The limbs of a verdict that have a rotation of their own.
    pub fn judged<'a>(&'a self, model: &'a Model, verdict: Verdict) -> impl Iterator<Item = &'a LimbTrust> {
        let has_own = |limb: &&LimbTrust| model.limbs()[limb.limb].has_own_rotation;
        self.trust.iter().filter(has_own).filter(move |limb| limb.verdict == verdict)
    }

    /// Measures the overlap again with what the frame's cameras saw, as after smoothing has moved the pose.
    pub fn measure_overlap(&mut self, model: &Model, renderer: RendererKind, views: &[FitView]) {
        self.overlap = overlaps(model, &self.pose, renderer, views);
    }

    /// Without what only the filter, smoothing and tuning need: what was predicted, and what the frame says by itself. That is two
    /// thirds of what a filter keeps of a frame.
    #[must_use]
    pub fn settled(mut self) -> Self {
        if let Some(belief) = &mut self.belief {
            (belief.predicted, belief.measurement) = (None, None);
        }
        self
    }

    /// Whether the subject, or a limb of it, was lost.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost_because.is_some()
    }
}

/// Overlap of a pose with the mask of every camera that sees somebody, in the order of the views.
#[must_use]
pub fn overlaps(
    model: &Model,
    pose: &Pose,
    renderer: RendererKind,
    views: &[FitView],
) -> Vec<Option<Overlap>> {
    let kinematics = Kinematics::new(model, pose);
    let of_view = |view: &FitView| match &view.evidence {
        Evidence::Mask(mask) if mask.labels().contains(&Label::Subject) => {
            let drawn = View::new(model, &kinematics, &view.camera, renderer, Ramp::Half);
            prediction::overlap(&drawn, mask).ok()
        }
        _ => None,
    };
    views.iter().map(of_view).collect()
}

/// Overlap of all cameras together.
pub(super) fn iou(overlap: &[Option<Overlap>]) -> Option<f64> {
    overlap.iter().flatten().copied().reduce(Overlap::merge).and_then(|overlap| overlap.iou())
}

/// Estimates by frame, in the order of the frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Track {
    /// By frame number.
    pub frames: BTreeMap<usize, FrameEstimate>,
}
