//! What silhouettes say against a pose, limb by limb.
//!
//! Masks are wider than people, and limbs are no capsules, so that pixels near an outline say nothing against anybody. What
//! counts is clear:
//!
//! - *spurious*: the inner part of a limb, [`INSIDE_M`] within its surface or nearer to its axis, where the mask has background;
//! - *missing*: the subject where no limb is within [`OUTSIDE_M`]. It is counted at the limb that is nearest.
//!
//! Counts are areas in square metres at the body's distance, so that they mean the same in every picture.

use glam::DVec3;

use crate::body::{Kinematics, Model};
use crate::camera::Camera;
use crate::fit::{Evidence, FitView};
use crate::render::{BACKGROUND, DrawOptions, Ramp, RendererKind, View, draw, prediction::NO_OWNER};
use crate::silhouette::Label;

/// A limb's pixels count where they are this far within its surface, metres.
const INSIDE_M: f64 = 0.02;
/// The subject's pixels count as missing where no limb is nearer than this, metres.
const OUTSIDE_M: f64 = 0.06;
/// How far a limb is looked for from a missing pixel, metres.
const REACH_M: f64 = 0.4;
/// A body nearer to a camera than this is not looked at, metres.
const NEAREST_M: f64 = 0.1;

/// What speaks against one limb. Areas of all cameras together, square metres.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LimbConflict {
    /// Its inner part, where it is the nearest to the camera's ray.
    pub inner: f64,
    /// As much of that as has background in the mask.
    pub spurious: f64,
    /// Subject that no limb covers and to which this one is nearest.
    pub missing: f64,
    /// The largest share of its inner part that has background in any one camera's mask.
    pub worst_share: f64,
}

/// What silhouettes say against a pose.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Conflicts {
    /// By limb.
    pub limbs: Vec<LimbConflict>,
    /// The subject in all masks, square metres.
    pub subject: f64,
    /// As much of it as is far from every limb.
    pub far: f64,
    /// Cameras with a mask in which somebody is.
    pub cameras: usize,
    /// Pixels to a metre of the body, the sum over these cameras.
    pub px_per_metre: f64,
}

impl Conflicts {
    /// Compares a pose with all masks.
    pub fn new(model: &Model, kinematics: &Kinematics, renderer: RendererKind, views: &[FitView]) -> Self {
        let limbs = vec![LimbConflict::default(); model.limbs().len()];
        let mut conflicts = Self { limbs, ..Self::default() };
        for view in views.iter().filter(|view| view.has_data()) {
            conflicts.add(model, kinematics, renderer, view);
        }
        conflicts
    }

    fn add(&mut self, model: &Model, kinematics: &Kinematics, renderer: RendererKind, view: &FitView) {
        let Evidence::Mask(mask) = &view.evidence else { return };
        let camera: &Camera = &view.camera;
        let px_per_m = px_per_metre(camera, kinematics.starts()[0]);
        let area = 1.0 / (px_per_m * px_per_m);
        let [inner_px, outer_px] = [INSIDE_M, REACH_M].map(|metres| metres * px_per_m);
        let ramp = Ramp::Distance { inner_px, outer_px };
        let drawn = View::new(model, kinematics, camera, renderer, ramp);
        let picture = draw(&drawn, DrawOptions::default()).prediction;
        let missing_above = BACKGROUND * (INSIDE_M + OUTSIDE_M) / (INSIDE_M + REACH_M);
        let mut own = vec![[0_u32; 3]; self.limbs.len()];
        let (mut subject, mut far) = (0_u32, 0_u32);
        for ((&label, &level), &owner) in mask.labels().iter().zip(&picture.lambda).zip(&picture.owner) {
            let is_subject = label == Label::Subject;
            subject += u32::from(is_subject);
            if owner == NO_OWNER {
                far += u32::from(is_subject);
                continue;
            }
            let [inner, spurious, missing] = &mut own[usize::from(owner)];
            let is_inner = level <= 0.0;
            *inner += u32::from(is_inner);
            *spurious += u32::from(is_inner && label == Label::Background);
            *missing += u32::from(is_subject && f64::from(level) > missing_above);
        }
        for (limb, [inner, spurious, missing]) in self.limbs.iter_mut().zip(own) {
            limb.inner += area * f64::from(inner);
            limb.spurious += area * f64::from(spurious);
            limb.missing += area * f64::from(missing);
            limb.worst_share = limb.worst_share.max(f64::from(spurious) / f64::from(inner.max(1)));
        }
        self.subject += area * f64::from(subject);
        self.far += area * f64::from(far);
        self.cameras += 1;
        self.px_per_metre += px_per_m;
    }

    /// Pixels to a metre of the body in the mean of the cameras.
    pub fn mean_px_per_metre(&self) -> f64 {
        self.px_per_metre / self.cameras.max(1) as f64
    }

    /// The subject that no limb covers, square metres.
    pub fn missing(&self) -> f64 {
        self.limbs.iter().map(|limb| limb.missing).sum::<f64>() + self.far
    }

    /// The same as a share of the subject.
    pub fn missing_share(&self) -> f64 {
        if self.subject > 0.0 { self.missing() / self.subject } else { 0.0 }
    }
}

/// How many pixels a metre across is at a point, world metres.
pub(crate) fn px_per_metre(camera: &Camera, at: DVec3) -> f64 {
    camera.intrinsics().mean_focal_px() / camera.depth(at).max(NEAREST_M)
}
