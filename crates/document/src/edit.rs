//! Every change that a user can make to a document.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::footage::BrushStroke;
use backlit_formats::footage::replacement::Calibration;
use backlit_tracking::body::{Model, ModelError, Pose, PoseError};
use backlit_tracking::fit::{FitOptions, OptionsError};
use backlit_tracking::people::FollowedPerson;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::segment::changes::BackgroundChange;
use backlit_tracking::silhouette::{Region, StrokeError};
use thiserror::Error;

use crate::bookmark::Bookmark;
use crate::frame_trust::FrameTrust;
use crate::tracking_choices::TrackingChoices;
use crate::{CameraUse, Document, Estimate, Origin};

/// A change of the document. [`Document::apply`] makes it, [`Edit::text`] names it for the undo menu.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the names say what each field is")]
pub enum Edit {
    /// The pose of a frame, by hand: it becomes a key pose and replaces what was found there.
    SetPose {
        frame: usize,
        pose: Pose,
        /// What the user did, for the undo menu: "Move right forearm".
        what: String,
    },
    /// Makes the pose of a frame a key pose.
    SetKey { frame: usize },
    /// Forgets the key pose of a frame.
    ClearKey { frame: usize },
    /// What a fit or the tracker found for a frame.
    AddEstimate { frame: usize, estimate: Arc<Estimate> },
    /// What the tracker found, frame by frame, and told beside it; it replaces what was found there before.
    AddTrack(Vec<Tracked>),
    /// Forgets everything that was found; key poses stay.
    ClearEstimates,
    /// Forgets what was found from one frame to another, both included; key poses stay.
    ClearRange { first: usize, last: usize },
    /// Length and radius of a limb, in metres, and of its mirror image if wanted.
    SetSize {
        limb: usize,
        length: f64,
        radius: f64,
        /// Also the limb on the other side of the body.
        both_sides: bool,
    },
    /// Another body with the same limbs: its lengths and radii were fitted.
    SetBody(Arc<Model>),
    /// Makes the whole body larger or smaller.
    ScaleBody {
        /// All lengths and radii are multiplied by it.
        factor: f64,
    },
    /// Whether a camera counts in the fit.
    UseCamera {
        camera: usize,
        /// Whether it counts.
        used: bool,
    },
    /// Which cameras count in the fit: these and no others.
    UseOnly { cameras: Vec<usize> },
    /// The weight of a camera's pixels.
    WeighCamera {
        camera: usize,
        /// From 0 on; 1 as a rule.
        weight: f64,
    },
    /// How poses are fitted.
    SetFit {
        options: Box<FitOptions>,
        /// What the user did, for the undo menu: "Switch to cylinder".
        what: String,
    },
    /// How frames are followed.
    SetTracking(TrackingChoices),
    /// How silhouettes are made; each camera keeps its own region of interest.
    SetMeasurement(Box<SegmentOptions>),
    /// Cameras in the place of the take's, or the take's own again.
    SetCalibration(Option<Arc<Calibration>>),
    /// Plates in the place of the take's, by camera; without any they are the take's own again.
    SetPlates(BTreeMap<usize, PathBuf>),
    /// Silhouettes of a frame, by camera, in the place of those that are measured.
    SetMasks { frame: usize, masks: BTreeMap<usize, PathBuf> },
    /// Strokes over silhouettes, after those that are there.
    Paint(Vec<BrushStroke>),
    /// Takes away what is painted in some frames of a camera, first and last included.
    EraseBrush { camera: usize, frames: [usize; 2] },
    /// Where a camera's subject may be; `None` for everywhere.
    SetRegion { camera: usize, region: Option<Region> },
    /// One of several people: pixels of others are unknown. `None` for everybody in view.
    FollowPerson(Option<Arc<FollowedPerson>>),
    /// Marks a place.
    AddBookmark(Bookmark),
    /// Another bookmark in the place of one.
    ChangeBookmark { index: usize, bookmark: Bookmark },
    /// Takes a bookmark away.
    RemoveBookmark { index: usize },
    /// Backgrounds that change while the take is filmed.
    SetChanges(Arc<Vec<BackgroundChange>>),
    /// Files that poses are compared with.
    SetReferences(Vec<PathBuf>),
    /// Whether the second joint of a limb is held while another joint is dragged.
    Pin {
        limb: usize,
        /// Whether it is held.
        pinned: bool,
    },
}

/// A frame, what was found in it, and what was told beside, if anything was.
pub type Tracked = (usize, Arc<Estimate>, Option<Arc<FrameTrust>>);

/// Why a change cannot be made. The document is then as before.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum EditError {
    #[error("the pose of frame {frame} does not fit the body: {error}")]
    Pose { frame: usize, error: PoseError },
    #[error("the size of limb {limb} is wrong: {error}")]
    Size { limb: usize, error: ModelError },
    #[error("there is no bookmark {index}; there are {count}")]
    NoBookmark { index: usize, count: usize },
    #[error("the text of a bookmark: expected {expected}")]
    BookmarkText { expected: &'static str },
    #[error("the body cannot be of that size: {error}")]
    Scale { error: ModelError },
    #[error("there is no limb {limb}; the body has {count}")]
    NoLimb { limb: usize, count: usize },
    #[error("the body has other limbs; expected the same ones in other sizes")]
    OtherLimbs,
    #[error("there is no camera {camera}; the take has {count}")]
    NoCamera { camera: usize, count: usize },
    #[error("the calibration has {found} cameras; the take has {count}")]
    Cameras { found: usize, count: usize },
    #[error("the camera's weight is {weight}; expected a number, 0 or above")]
    Weight { weight: f64 },
    #[error("the fit of frame {frame} has a cost that is not a number")]
    Cost { frame: usize },
    #[error("the fit's options make no sense: {0}")]
    Fit(#[from] OptionsError),
    #[error("the region of interest is empty; expected at least one pixel")]
    Region,
    #[error("the stroke cannot be painted: {0}")]
    Stroke(#[from] StrokeError),
    #[error("frame {frame} has no key pose")]
    NoKey { frame: usize },
}

impl Edit {
    /// What was done, as the undo menu says it.
    pub fn text(&self) -> String {
        match self {
            Self::SetPose { what, .. } | Self::SetFit { what, .. } => what.clone(),
            Self::SetKey { .. } => "Set key pose".to_owned(),
            Self::ClearKey { .. } => "Clear key pose".to_owned(),
            Self::AddEstimate { estimate, .. } => match estimate.origin {
                Origin::Fit => "Fit".to_owned(),
                Origin::Track => "Track".to_owned(),
            },
            Self::AddTrack(_) => "Track".to_owned(),
            Self::ClearEstimates => "Clear track".to_owned(),
            Self::ClearRange { first, last } => format!("Clear frames {first} to {last}"),
            Self::SetSize { .. } => "Change limb size".to_owned(),
            Self::SetBody(_) => "Fit body".to_owned(),
            Self::ScaleBody { .. } => "Scale body".to_owned(),
            Self::UseCamera { used: true, .. } => "Use camera".to_owned(),
            Self::UseCamera { used: false, .. } => "Leave camera out".to_owned(),
            Self::UseOnly { .. } => "Choose cameras".to_owned(),
            Self::WeighCamera { .. } => "Change camera weight".to_owned(),
            Self::SetTracking(_) => "Change tracking".to_owned(),
            Self::SetMeasurement(_) => "Change measurement".to_owned(),
            Self::SetCalibration(_) => "Replace calibration".to_owned(),
            Self::SetPlates(_) => "Learn background again".to_owned(),
            Self::FollowPerson(Some(_)) => "Follow one person".to_owned(),
            Self::FollowPerson(None) => "Follow everybody in view".to_owned(),
            Self::SetMasks { .. } => "Replace silhouettes".to_owned(),
            Self::Paint(_) => "Paint silhouette".to_owned(),
            Self::EraseBrush { .. } => "Remove brush strokes".to_owned(),
            Self::SetRegion { region: Some(_), .. } => "Set region of interest".to_owned(),
            Self::SetRegion { region: None, .. } => "Remove region of interest".to_owned(),
            Self::AddBookmark(_) => "Add bookmark".to_owned(),
            Self::ChangeBookmark { .. } => "Change bookmark".to_owned(),
            Self::RemoveBookmark { .. } => "Remove bookmark".to_owned(),
            Self::SetChanges(_) => "Learn changed backgrounds".to_owned(),
            Self::SetReferences(_) => "Change references".to_owned(),
            Self::Pin { pinned: true, .. } => "Pin joint".to_owned(),
            Self::Pin { pinned: false, .. } => "Free joint".to_owned(),
        }
    }
}

impl Document {
    /// Whether there is anything that a change would change.
    pub fn would_change(&self, edit: &Edit) -> bool {
        let mut after = self.clone();
        after.apply(edit.clone()).is_ok() && after != *self
    }

    /// Makes a change. A document that cannot be changed so stays as it was.
    pub fn apply(&mut self, edit: Edit) -> Result<(), EditError> {
        match edit {
            Edit::SetPose { frame, pose, .. } => self.set_pose(frame, &pose)?,
            Edit::SetKey { frame } => {
                let pose = self.pose_at(frame).clone();
                Arc::make_mut(&mut self.keys).insert(frame, pose);
            }
            Edit::ClearKey { frame } => {
                if Arc::make_mut(&mut self.keys).remove(&frame).is_none() {
                    return Err(EditError::NoKey { frame });
                }
            }
            Edit::AddEstimate { frame, estimate } => self.add_estimates(vec![(frame, estimate)])?,
            Edit::AddTrack(found) => {
                self.add_estimates(found.iter().map(|(frame, found, _)| (*frame, found.clone())).collect())?;
                let trust = Arc::make_mut(&mut self.trust);
                for (frame, _, beside) in found {
                    match beside {
                        Some(beside) => trust.insert(frame, beside),
                        None => trust.remove(&frame),
                    };
                }
            }
            Edit::ClearEstimates => self.clear(0..=usize::MAX),
            Edit::ClearRange { first, last } => self.clear(first..=last),
            Edit::SetSize { limb, length, radius, both_sides } => {
                self.set_size(limb, length, radius, both_sides)?;
            }
            Edit::SetBody(model) => self.set_body(model)?,
            Edit::ScaleBody { factor } => {
                let scaled = self.model.scaled(factor).map_err(|error| EditError::Scale { error })?;
                self.model = Arc::new(scaled);
                self.outdate_estimates();
            }
            Edit::UseCamera { camera, used } => self.camera_mut(camera)?.used = used,
            Edit::UseOnly { cameras } => {
                for &camera in &cameras {
                    self.camera_mut(camera)?;
                }
                for (index, camera) in Arc::make_mut(&mut self.cameras).iter_mut().enumerate() {
                    camera.used = cameras.contains(&index);
                }
            }
            Edit::WeighCamera { camera, weight } => {
                if !weight.is_finite() || weight < 0.0 {
                    return Err(EditError::Weight { weight });
                }
                self.camera_mut(camera)?.weight = weight;
            }
            Edit::SetFit { options, .. } => {
                options.check()?;
                self.fit = Arc::new(*options);
            }
            Edit::SetTracking(choices) => self.tracking = choices,
            Edit::SetCalibration(calibration) => self.set_calibration(calibration)?,
            edit @ (Edit::SetMeasurement(_)
            | Edit::SetPlates(_)
            | Edit::FollowPerson(_)
            | Edit::SetMasks { .. }
            | Edit::Paint(_)
            | Edit::EraseBrush { .. }
            | Edit::SetRegion { .. }
            | Edit::SetChanges(_)) => self.steer_silhouettes(edit)?,
            Edit::SetReferences(paths) => self.references = Arc::new(paths),
            edit @ (Edit::AddBookmark(_) | Edit::ChangeBookmark { .. } | Edit::RemoveBookmark { .. }) => {
                self.mark(edit)?;
            }
            Edit::Pin { limb, pinned } => {
                self.check_limb(limb)?;
                let pins = Arc::make_mut(&mut self.pins);
                if pinned {
                    pins.insert(limb)
                } else {
                    pins.remove(&limb)
                };
            }
        }
        Ok(())
    }

    fn set_pose(&mut self, frame: usize, pose: &Pose) -> Result<(), EditError> {
        pose.check(&self.model).map_err(|error| EditError::Pose { frame, error })?;
        Arc::make_mut(&mut self.keys).insert(frame, pose.normalized());
        Arc::make_mut(&mut self.estimates).remove(&frame);
        Ok(())
    }

    fn add_estimates(&mut self, found: Vec<(usize, Arc<Estimate>)>) -> Result<(), EditError> {
        for (frame, estimate) in &found {
            let wrong = |error| EditError::Pose { frame: *frame, error };
            estimate.pose.check(&self.model).map_err(wrong)?;
            if ![estimate.cost, estimate.rms].iter().flatten().all(|value| value.is_finite()) {
                return Err(EditError::Cost { frame: *frame });
            }
        }
        Arc::make_mut(&mut self.estimates).extend(found);
        Ok(())
    }

    fn clear(&mut self, frames: RangeInclusive<usize>) {
        Arc::make_mut(&mut self.estimates).retain(|frame, _| !frames.contains(frame));
        // Rivals of a key pose stay to be chosen from.
        Arc::make_mut(&mut self.trust)
            .retain(|frame, _| !frames.contains(frame) || self.keys.contains_key(frame));
    }

    fn set_size(&mut self, limb: usize, length: f64, radius: f64, both: bool) -> Result<(), EditError> {
        self.check_limb(limb)?;
        let mut spec = self.model.to_spec();
        let other = if both { self.model.mirrored_limb(limb) } else { limb };
        for index in [limb, other] {
            // The specification has the file's order, the model parents first.
            let name = &self.model.limbs()[index].name;
            if let Some(limb) = spec.limbs.iter_mut().find(|limb| limb.name == *name) {
                (limb.length, limb.radius) = (length, radius);
            }
        }
        let model = Model::new(&spec).map_err(|error| EditError::Size { limb, error })?;
        self.model = Arc::new(model);
        self.outdate_estimates();
        Ok(())
    }

    /// Poses, pins and selection count the limbs: they must be the same.
    fn set_body(&mut self, model: Arc<Model>) -> Result<(), EditError> {
        let limbs = |model: &Model| -> Vec<(String, Option<usize>, usize)> {
            let limb = model.limbs().iter();
            limb.map(|limb| (limb.name.clone(), limb.parent, limb.rotation)).collect()
        };
        if limbs(&model) != limbs(&self.model) {
            return Err(EditError::OtherLimbs);
        }
        self.model = model;
        self.outdate_estimates();
        Ok(())
    }

    /// What was found so far was found with another body.
    fn outdate_estimates(&mut self) {
        if self.estimates.values().any(|estimate| !estimate.is_stale) {
            for estimate in Arc::make_mut(&mut self.estimates).values_mut() {
                Arc::make_mut(estimate).is_stale = true;
            }
        }
    }

    fn set_calibration(&mut self, calibration: Option<Arc<Calibration>>) -> Result<(), EditError> {
        let count = self.cameras.len();
        if let Some(found) = calibration.as_ref().map(|new| new.rig.count()).filter(|found| *found != count) {
            return Err(EditError::Cameras { found, count });
        }
        self.calibration = calibration;
        Ok(())
    }

    pub(crate) fn check_limb(&self, limb: usize) -> Result<(), EditError> {
        let count = self.model.limbs().len();
        if limb < count { Ok(()) } else { Err(EditError::NoLimb { limb, count }) }
    }

    fn camera_mut(&mut self, camera: usize) -> Result<&mut CameraUse, EditError> {
        let count = self.cameras.len();
        Arc::make_mut(&mut self.cameras).get_mut(camera).ok_or(EditError::NoCamera { camera, count })
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn a_fitted_body_has_the_same_limbs() {
        let mut document = Document::new(builtin::upper_body());
        let larger = Arc::new(builtin::upper_body().scaled(1.2).unwrap());
        document.apply(Edit::SetBody(larger.clone())).unwrap();
        assert_eq!(document.model, larger);
        let other = Edit::SetBody(Arc::new(builtin::full_body()));
        assert_eq!(document.apply(other), Err(EditError::OtherLimbs));
        assert_eq!(document.model, larger);
    }
}
