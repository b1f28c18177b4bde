//! What one camera contributes to a frame: its silhouette, or grey levels given as they are.

use std::sync::Arc;

use thiserror::Error;

use super::options::{DataView, FitOptions, OptionsError, Stage};
use crate::body::{Model, Pose, PoseError};
use crate::camera::{Camera, Rectification};
use crate::render::Ramp;
use crate::residual::cue::CueError;
use crate::residual::silhouette::SampledData;
use crate::silhouette::distance_ramp::DistanceRamp;
use crate::silhouette::measurement;
use crate::silhouette::{Label, Mask, Measurement, SignedDistance};

/// The data of one camera in one frame.
#[derive(Debug, Clone)]
pub enum Evidence {
    /// A segmented silhouette: each stage looks at it in its own way.
    Mask(Arc<Mask>),
    /// Grey levels D that every stage takes as they are.
    Measurement(Arc<Measurement>),
}

/// One camera's part in a fit.
#[derive(Debug, Clone)]
pub struct FitView {
    /// An ideal pinhole, or with a lens: [`Fit`](super::Fit) takes it out first.
    pub camera: Arc<Camera>,
    /// Its data.
    pub evidence: Evidence,
    /// Weight of its pixels; 1 as a rule, 0 leaves the camera out.
    pub weight: f64,
}

/// Why a fit cannot begin.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum FitError {
    #[error(transparent)]
    Pose(#[from] PoseError),
    #[error(transparent)]
    Options(#[from] OptionsError),
    #[error(
        "camera \"{camera}\": the silhouette is {found_width} × {found_height} pixels, the camera's pictures are {width} × {height}"
    )]
    Size { camera: String, found_width: usize, found_height: usize, width: usize, height: usize },
    #[error("camera \"{camera}\": `weight` is {weight}; expected a finite number, 0 or more")]
    Weight { camera: String, weight: f64 },
    #[error("camera \"{camera}\" has lens distortion; expected rectified pictures and an ideal camera")]
    Distorted { camera: String },
    #[error("`free` has {found} entries; the model has {expected} rotations")]
    FreeRotations { found: usize, expected: usize },
    #[error(transparent)]
    Cue(#[from] CueError),
    #[error("no camera has a silhouette to fit: {reasons}")]
    NoData { reasons: String },
}

impl FitView {
    /// A camera's silhouette, with a weight of 1.
    pub fn of_mask(camera: impl Into<Arc<Camera>>, mask: impl Into<Arc<Mask>>) -> Self {
        Self { camera: camera.into(), evidence: Evidence::Mask(mask.into()), weight: 1.0 }
    }

    /// The same through an ideal pinhole: what the lens bends is resampled, pixels that it never saw count as unknown. A
    /// camera without a lens, or data of another size, stays as it is.
    ///
    /// Many frames of one camera are quicker with one [`Rectification`] for all.
    pub fn rectified(self) -> Self {
        if self.camera.distortion().is_none() {
            return self;
        }
        let rectification = Rectification::new(&self.camera);
        let evidence = match &self.evidence {
            Evidence::Mask(mask) => rectification
                .nearest(mask.labels(), Label::Unknown)
                .and_then(|labels| Mask::new(mask.width(), mask.height(), labels).ok())
                .map(|mask| Evidence::Mask(Arc::new(mask))),
            Evidence::Measurement(data) => rectification
                .nearest(data.values(), 0.0)
                .zip(rectification.nearest(data.weights(), 0.0))
                .and_then(|(values, weights)| {
                    Measurement::new(data.width(), data.height(), values, weights).ok()
                })
                .map(|data| Evidence::Measurement(Arc::new(data))),
        };
        match evidence {
            Some(evidence) => Self { camera: Arc::new(self.camera.without_distortion()), evidence, ..self },
            None => self,
        }
    }

    /// Checks that data and camera belong together.
    ///
    /// # Errors
    /// Sizes that differ, a weight that is not one, a lens that was not taken out.
    pub fn check(&self) -> Result<(), FitError> {
        let name = || self.camera.name().to_owned();
        let (found_width, found_height) = match &self.evidence {
            Evidence::Mask(mask) => (mask.width(), mask.height()),
            Evidence::Measurement(data) => (data.width(), data.height()),
        };
        let (width, height) = (self.camera.width(), self.camera.height());
        if (found_width, found_height) != (width, height) {
            return Err(FitError::Size { camera: name(), found_width, found_height, width, height });
        }
        if !(self.weight.is_finite() && self.weight >= 0.0) {
            return Err(FitError::Weight { camera: name(), weight: self.weight });
        }
        if !self.camera.distortion().is_none() {
            return Err(FitError::Distorted { camera: name() });
        }
        Ok(())
    }

    /// Whether the camera says anything: it has weight and a subject.
    pub fn has_data(&self) -> bool {
        self.weight > 0.0
            && match &self.evidence {
                Evidence::Mask(mask) => mask.labels().contains(&Label::Subject),
                Evidence::Measurement(data) => data
                    .values()
                    .iter()
                    .zip(data.weights())
                    .any(|(&value, &weight)| weight > 0.0 && value < 255.0),
            }
    }

    /// The mask's distance field, exact as far as any of the stages looks; `None` for grey levels.
    pub fn distance(&self, stages: &[Stage]) -> Option<SignedDistance> {
        self.distance_within(stages, 0.0)
    }

    /// The same, exact at least as far as `least_px`.
    pub(super) fn distance_within(&self, stages: &[Stage], least_px: f64) -> Option<SignedDistance> {
        let reach = stages.iter().map(|stage| match stage.ramp {
            Ramp::Distance { inner_px, outer_px } => inner_px.max(outer_px) + 1.0,
            _ => 0.0,
        });
        let reach = reach.fold(least_px, f64::max);
        match &self.evidence {
            Evidence::Mask(_) if reach == 0.0 => None,
            Evidence::Mask(mask) => Some(SignedDistance::from_mask_within(mask, reach as f32)),
            Evidence::Measurement(_) => None,
        }
    }

    /// D as a stage looks at it; `distance` is what [`distance`](Self::distance) gave.
    pub fn data(&self, stage: &Stage, distance: Option<&SignedDistance>) -> Arc<Measurement> {
        let mask = match &self.evidence {
            Evidence::Measurement(data) => return Arc::clone(data),
            Evidence::Mask(mask) => mask,
        };
        let data = match (stage.data, stage.ramp, distance) {
            // Sizes agree and the options' check has seen the widths: what is left is the black-and-white view.
            (DataView::Distance, Ramp::Distance { inner_px, outer_px }, Some(distance)) => {
                Measurement::from_distance(distance, mask, inner_px as f32, outer_px as f32)
                    .unwrap_or_else(|_| Measurement::from_mask_hard(mask))
            }
            (DataView::Averaged { radius_px }, ..) => Measurement::from_mask_averaged(mask, radius_px),
            _ => Measurement::from_mask_hard(mask),
        };
        Arc::new(data)
    }

    /// The stage's samples of [`data`](Self::data): what lies between them is not worked out where that can be
    /// spared.
    pub(super) fn sampled_data(&self, stage: &Stage, distance: Option<&SignedDistance>) -> SampledData {
        let whole = || SampledData::new(&self.data(stage, distance), stage.stride);
        let Evidence::Mask(mask) = &self.evidence else { return whole() };
        let (size, labels) = ([mask.width(), mask.height()], mask.labels());
        match (stage.data, stage.ramp, distance) {
            (DataView::Distance, Ramp::Distance { inner_px, outer_px }, Some(distance)) => {
                let Ok(ramp) = DistanceRamp::new(inner_px as f32, outer_px as f32) else { return whole() };
                SampledData::of_rows(size, stage.stride, |pixels, values, weights| {
                    ramp.fill(distance, pixels.clone(), &labels[pixels], values, weights);
                })
            }
            (DataView::Averaged { .. }, ..) => whole(),
            _ => SampledData::of_rows(size, stage.stride, |pixels, values, weights| {
                for ((value, weight), label) in values.iter_mut().zip(weights).zip(&labels[pixels]) {
                    (*value, *weight) = (measurement::hard_level(label), measurement::weight(label));
                }
            }),
        }
    }
}

/// Views that have data, their distance fields, and a start of unit quaternions.
#[derive(Debug, Clone)]
pub(crate) struct PreparedFit {
    pub(crate) views: Vec<FitView>,
    pub(crate) distances: Arc<Vec<Option<SignedDistance>>>,
    pub(crate) start: Pose,
    /// Cameras that had nothing to say, by name.
    pub(crate) empty_cameras: Vec<String>,
}

impl PreparedFit {
    /// Checks all inputs. Distances are exact at least as far as the stages look, and as far as `reach_px`
    /// says for these views and this start.
    ///
    /// # Errors
    /// If the pose is not the model's, data are not of the camera's size, an option is out of range, or no camera has a
    /// silhouette.
    pub(crate) fn new(
        model: &Model,
        views: Vec<FitView>,
        start: &Pose,
        options: &FitOptions,
        reach_px: impl Fn(&Model, &[FitView], &Pose) -> f64,
    ) -> Result<Self, FitError> {
        start.check(model)?;
        options.check()?;
        let views: Vec<FitView> = views.into_iter().map(FitView::rectified).collect();
        for view in &views {
            view.check()?;
        }
        let (views, empty): (Vec<FitView>, Vec<FitView>) = views.into_iter().partition(FitView::has_data);
        let empty_cameras: Vec<String> = empty.iter().map(|view| view.camera.name().to_owned()).collect();
        if views.is_empty() {
            let reasons = if empty_cameras.is_empty() {
                "no camera was given".to_owned()
            } else {
                format!("{} see no subject or have no weight", empty_cameras.join(", "))
            };
            return Err(FitError::NoData { reasons });
        }
        let start = start.normalized();
        let least = reach_px(model, &views, &start);
        let distances: Vec<_> =
            views.iter().map(|view| view.distance_within(&options.stages, least)).collect();
        Ok(Self { views, distances: Arc::new(distances), start, empty_cameras })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::body::{Kinematics, builtin};
    use crate::camera::Distortion;
    use crate::fixtures;
    use crate::render::{RendererKind, View};
    use crate::residual::silhouette::KernelMemory;

    /// Through a lens a fit sees what it sees of a silhouette that was rectified before.
    #[test]
    fn lenses_are_taken_out() {
        let model = Arc::new(builtin::upper_body());
        let lens = Distortion::OpenCv { k1: -0.2, k2: 0.05, p1: 0.0, p2: 0.0, k3: 0.0 };
        let from = DVec3::new(0.1, 0.2, 3.0);
        let intrinsics = [90.0, 90.0, 39.5, 29.5];
        let bent = fixtures::lens_camera(lens, [80, 60], intrinsics, from, DVec3::Y * 0.3, DVec3::Y);
        let start = Pose::rest(&model);
        let view = fixtures::fit_view(&model, &start, bent);
        let fit = |view: FitView| {
            crate::fit::Fit::new(model.clone(), vec![view], start.clone(), FitOptions::default()).unwrap()
        };
        let plain = view.clone().rectified();
        assert!(plain.camera.distortion().is_none() && plain.check().is_ok());
        assert_eq!(fit(view).cost().to_bits(), fit(plain).cost().to_bits());
    }

    /// The shortcut and the whole measurement are the same data to the bit.
    #[test]
    fn samples_are_those_of_the_whole_measurement() {
        let mask = fixtures::painted([83, 61], |x, y| match (x, y) {
            (x, y) if (x * y) % 17 == 3 => Label::Unknown,
            (x, y) if (30..55).contains(&x) && (20..50).contains(&y) => Label::Subject,
            _ => Label::Background,
        });
        let intrinsics = [90.0, 85.0, 31.0, 40.0];
        let camera = fixtures::camera([83, 61], intrinsics, [0.1, 0.2, 3.0], DVec3::ZERO, DVec3::NEG_Y);
        let model = builtin::upper_body();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        let view = FitView::of_mask(camera, mask);
        let ramps = [
            (Ramp::Distance { inner_px: 1.0, outer_px: 6.0 }, DataView::Distance),
            (Ramp::Half, DataView::Hard),
            (Ramp::Half, DataView::Averaged { radius_px: 1 }),
        ];
        for ((ramp, data), stride) in ramps.into_iter().flat_map(|ramp| (1..9).map(move |s| (ramp, s))) {
            let stage = Stage { ramp, data, stride, iterations: 1, tolerance: None, priors: 1.0 };
            let distance = view.distance(&[stage]);
            let whole = SampledData::new(&view.data(&stage, distance.as_ref()), stride);
            let samples = view.sampled_data(&stage, distance.as_ref());
            let seen = View::new(&model, &kinematics, &view.camera, RendererKind::Capsule, ramp);
            let [a, b] = [&whole, &samples].map(|data| {
                (data.total_weight.to_bits(), data.cost(&seen, &mut KernelMemory::default()).to_bits())
            });
            assert_eq!(a, b, "{ramp} {data:?}, stride {stride}");
        }
    }
}
