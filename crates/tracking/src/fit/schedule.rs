//! Annealing by the size of what is seen: stages as data, made for a picture's scale.
//!
//! A schedule in pixels is right for one picture size. What matters is how many pixels a limb is thick: the
//! ramp begins some limbs' widths wide, narrows by halves, and ends at the report's softened form; pixels
//! finer than a limb by far are skipped while the ramp is wide.

use super::evidence::{Evidence, FitView};
use super::options::{DataView, FitOptions, Stage};
use crate::body::{Model, Pose};
use crate::render::Ramp;

/// Limbs nearer than this (metres) to a camera plane say nothing of the scale.
const NEAREST_M: f64 = 0.05;
/// Outer widths of the annealed stages, in radii of the thinnest limb.
const OUTER_RADII: [f64; 4] = [10.0, 5.0, 2.5, 1.25];
/// Inner width of all stages, in radii of the thinnest limb: data and prediction mean the same only inside
/// every limb.
const INNER_RADII: f64 = 1.0;
/// No ramp is narrower than this, pixels: a step between two pixels has no slope.
const NARROWEST_PX: f64 = 0.8;
/// Widest first stage, as a fraction of the person's size in the picture.
const WIDEST_OF_PERSON: f64 = 0.5;
/// Pixels skipped at most.
const COARSEST: f64 = 8.0;
/// Iterations of an annealed stage and of the last one.
const ITERATIONS: [usize; 2] = [15, 20];
/// Relative decrease that ends an annealed stage and the last one.
const TOLERANCES: [f64; 2] = [1e-3, 1e-4];
/// Proximal weight and pull of twists for a tiny person from any start, with one camera and with more: where a start may
/// be far off, weak; one camera holds no depth by itself.
const WIDE: [[f64; 2]; 2] = [[10.0, 5.0], [3.0, 0.5]];
/// The same for a frame near the one before: weaker, an arm two pixels thick lets go; stronger, it does not follow.
const NEAR: [f64; 2] = [10.0, 5.0];

/// Radius of the thinnest limb that the robust preset's stages are meant for, pixels: that of the balancing footage, on which they
/// were set. Other sizes are those of the basin (`backlit experiment basin`).
pub(crate) const MEANT_FOR_PX: f64 = 4.6;
/// Finer pictures are taken as this many times as fine.
const FINEST: f64 = 16.0;
/// A person smaller than this, pixels, is tiny.
const TINY_PX: f64 = 64.0;

/// How large a body appears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApparentSize {
    /// Longer side of the box around the subject, pixels, in the camera that sees it largest.
    pub person_px: f64,
    /// Radius of the thinnest limb, pixels, in the camera that sees it smallest.
    pub thinnest_px: f64,
    /// Cameras that see something.
    pub cameras: usize,
}

impl ApparentSize {
    /// How large the views' subjects are, and a body at the start's distance.
    pub fn of(model: &Model, views: &[FitView], start: &Pose) -> Self {
        let radius = model.limbs().iter().map(|limb| limb.radius).fold(f64::INFINITY, f64::min);
        let thinnest = views.iter().map(|view| {
            let depth = view.camera.depth(start.root).max(NEAREST_M);
            radius * view.camera.intrinsics().mean_focal_px() / depth
        });
        let person = views.iter().map(|view| match &view.evidence {
            Evidence::Mask(mask) => {
                mask.bounds().map_or(0.0, |b| (b.x_max - b.x_min).max(b.y_max - b.y_min) as f64)
            }
            Evidence::Measurement(data) => data.height() as f64,
        });
        Self {
            person_px: person.fold(0.0, f64::max),
            thinnest_px: thinnest.fold(f64::INFINITY, f64::min),
            cameras: views.iter().filter(|view| view.has_data()).count(),
        }
    }

    /// Whether the person is but a few dozen pixels tall.
    fn is_tiny(&self) -> bool {
        self.person_px < TINY_PX
    }

    /// The stages: distance ramps from wide to narrow, then the softened form on the mask as it is.
    pub fn stages(&self) -> Vec<Stage> {
        let radius = if self.thinnest_px.is_finite() { self.thinnest_px.max(NARROWEST_PX) } else { 1.0 };
        let stride = |per_pixel: f64| (radius * per_pixel).clamp(1.0, COARSEST).floor() as usize;
        let widest = (WIDEST_OF_PERSON * self.person_px).max(radius);
        let stage = |ramp, data, per_pixel, index: usize| Stage {
            ramp,
            data,
            stride: stride(per_pixel),
            iterations: ITERATIONS[index],
            tolerance: Some(TOLERANCES[index]),
            priors: 1.0,
        };
        let annealed = OUTER_RADII.map(|radii| {
            let inner_px = (INNER_RADII * radius).max(NARROWEST_PX);
            let outer_px = (radii * radius).min(widest).max(NARROWEST_PX);
            stage(Ramp::Distance { inner_px, outer_px }, DataView::Distance, 1.0, 0)
        });
        let last = stage(Ramp::Half, DataView::Hard, 0.5, 1);
        annealed.into_iter().chain([last]).collect()
    }
}

impl FitOptions {
    /// The choices as they are meant for these views and a start near their subjects: themselves, unless they are
    /// made to follow the scale ([`to_scale`](Self::to_scale)).
    ///
    /// Where the thinnest limb is twice as thick as the stages are meant for, one twice as wide and as coarse goes
    /// before them; so for every doubling. A person of a few dozen pixels gets the annealing by limbs' widths
    /// ([`ApparentSize::stages`]) and weak priors.
    pub fn at_scale(self, model: &Model, views: &[FitView], start: &Pose) -> Self {
        if !self.to_scale {
            return self;
        }
        let scale = ApparentSize::of(model, views, start);
        let mut options = if scale.is_tiny() { self.scaled_to(&scale) } else { self.widened_to(&scale) };
        options.to_scale = false;
        options
    }

    /// The same for a frame whose start is the pose of the one before, or what the motion predicts: without the widest
    /// stages, and with priors that hold a tiny person's limbs.
    pub(crate) fn near_at_scale(self, model: &Model, views: &[FitView], start: &Pose) -> Self {
        let is_tiny = self.to_scale && ApparentSize::of(model, views, start).is_tiny();
        let mut options = self.at_scale(model, views, start);
        let skipped = options.skip_when_tracking.min(options.stages.len().saturating_sub(1));
        options.stages.drain(..skipped);
        if is_tiny {
            [options.proximal_weight, options.rest_weight] = NEAR;
        }
        options
    }

    /// What pixels tell of a limb's place grows with the third power of its pixels: its outline has more of them, and each is a
    /// smaller share of a metre, which counts twice; over a ramp that is wider it is less. Priors and cues grow with it, so
    /// that they mean the same in finer pictures.
    fn widened_to(mut self, scale: &ApparentSize) -> Self {
        let finer = scale.thinnest_px / MEANT_FOR_PX;
        let finer = if finer.is_finite() { finer.clamp(1.0, FINEST) } else { 1.0 };
        self.stages.iter_mut().for_each(|stage| stage.priors *= finer.powi(3));
        for _ in 0..finer.log2().round() as usize {
            let Some(&first) = self.stages.first() else { break };
            let Ramp::Distance { inner_px, outer_px } = first.ramp else { break };
            let ramp = Ramp::Distance { inner_px, outer_px: 2.0 * outer_px };
            let stride = (2 * first.stride).min(COARSEST as usize).max(first.stride);
            self.stages.insert(0, Stage { ramp, stride, priors: 0.5 * first.priors, ..first });
            self.skip_when_tracking += 1;
        }
        self
    }

    /// The same with the annealing and the priors that suit a scale.
    fn scaled_to(mut self, scale: &ApparentSize) -> Self {
        self.stages = scale.stages();
        self.skip_when_tracking = self.skip_when_tracking.min(self.stages.len() - 1);
        [self.proximal_weight, self.rest_weight] = WIDE[usize::from(scale.cameras > 1)];
        self
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::body::builtin;
    use crate::fixtures;
    use crate::silhouette::Measurement;

    fn outer_px(stage: &Stage) -> f64 {
        match stage.ramp {
            Ramp::Distance { outer_px, .. } => outer_px,
            _ => 0.0,
        }
    }

    #[test]
    fn the_presets_stages_grow_with_the_limbs() {
        let outer = |options: &FitOptions| options.stages.iter().map(outer_px).collect::<Vec<f64>>();
        let preset = FitOptions::default();
        let scale = |thinnest_px| ApparentSize { person_px: 300.0, thinnest_px, cameras: 2 };
        for thinnest_px in [0.0, 3.3, MEANT_FOR_PX, f64::INFINITY, f64::NAN] {
            assert_eq!(preset.clone().widened_to(&scale(thinnest_px)), preset, "{thinnest_px}");
        }
        let wider = preset.clone().widened_to(&scale(4.0 * MEANT_FOR_PX));
        assert_eq!(outer(&wider), [96.0, 48.0, 24.0, 12.0, 6.0, 3.0, 1.5]);
        let priors: Vec<f64> = wider.stages.iter().map(|stage| stage.priors).collect();
        assert_eq!(priors, [16.0, 32.0, 64.0, 64.0, 64.0, 64.0, 64.0]);
        assert_eq!((wider.skip_when_tracking, wider.stages[0].stride), (3, 8));
        assert_eq!(wider.check(), Ok(()));
    }

    #[test]
    fn a_tiny_person_is_held_from_frame_to_frame() {
        let (model, preset) = (builtin::upper_body(), FitOptions::default());
        let pose = Pose::rest(&model);
        for (size, is_tiny) in [([48, 36], true), ([192, 144], false)] {
            let [width, height] = size;
            let focal = width as f64;
            let intrinsics = [focal, focal, focal / 2.0, height as f64 / 2.0];
            let camera = Arc::new(fixtures::camera(size, intrinsics, [0.0, 0.0, 4.0], DVec3::ZERO, DVec3::Y));
            let whole = |value: f32| vec![value; (width * height) as usize];
            let data = Measurement::new(width as usize, height as usize, whole(0.0), whole(1.0)).unwrap();
            let evidence = Evidence::Measurement(Arc::new(data));
            let views = vec![FitView { camera, evidence, weight: 1.0 }; 2];
            let wide = preset.clone().at_scale(&model, &views, &pose);
            let near = preset.clone().near_at_scale(&model, &views, &pose);
            assert_eq!(near.stages, wide.stages[wide.skip_when_tracking..], "{size:?}");
            assert_eq!(near.proximal_weight > wide.proximal_weight, is_tiny, "{size:?}");
            assert_eq!(near.check(), Ok(()));
            let fixed = preset.clone().with_iterations(25);
            let near = fixed.clone().near_at_scale(&model, &views, &pose);
            assert_eq!(near.proximal_weight, fixed.proximal_weight);
        }
    }

    #[test]
    fn stages_narrow_and_follow_the_scale() {
        for (person_px, thinnest_px) in [(28.0, 1.15), (110.0, 4.6), (300.0, 7.0), (0.0, f64::INFINITY)] {
            let scale = ApparentSize { person_px, thinnest_px, cameras: 2 };
            let options = FitOptions::default().scaled_to(&scale);
            assert_eq!(options.check(), Ok(()), "{scale:?}");
            assert!(options.stages.windows(2).all(|two| outer_px(&two[0]) >= outer_px(&two[1])), "{scale:?}");
            assert_eq!(options.final_ramp(), Ramp::Half);
        }
        let scale = |thinnest_px| ApparentSize { person_px: 1e3, thinnest_px, cameras: 2 };
        assert_eq!(scale(1.15).stages()[0].stride, 1);
        assert_eq!(scale(4.6).stages()[0].stride, 4);
        assert_eq!(scale(4.6).stages()[4].stride, 2);
    }
}
