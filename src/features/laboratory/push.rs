//! A direction in which the body can move, and how hard every pixel pushes along it: J v.
//!
//! v is a unit motion of the state in tangent columns; a pixel's number is ∂λ/∂v in grey levels a metre or radian.
//! All fits that are compared are measured by one scale, so that counts and colours of their pictures mean the same:
//! the median of their 99th percentiles, since the edge of a flat end that is seen nearly from the side has a few
//! derivatives far above all others. A pixel of the ramp (0 < λ < 255) *pushes* from [`LEAST_SHARE`] of it on.

use backlit_tracking::body::{Kinematics, Model, Parameters, Pose};
use backlit_tracking::render::{Prediction, View, jacobian_along};
use backlit_ui::drawing::Derivative;
use backlit_ui::style::format;
use glam::DVec3;

use super::comparison::PushKey;
use crate::session::prediction::FitInputs;

/// A pixel pushes from this share of the scale on.
pub(crate) const LEAST_SHARE: f64 = 0.01;
/// Less than this is rounding, whatever the largest is: grey levels a metre or radian, of some 255 a limb's radius.
const LEAST_PUSH: f64 = 1e-6;

/// How the body moves in the picture of what pushes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PushAxis {
    /// The whole body along the chosen limb's own axis.
    Slide,
    /// The chosen limb about the x, y or z of its parent's frame: 0, 1, 2.
    Turn(usize),
    /// The chosen limb about its own axis.
    Twist,
    /// The whole body along the world's x, y or z.
    Move(usize),
}

impl PushAxis {
    /// All of them, with their names.
    pub(crate) const ALL: [(Self, &'static str); 8] = [
        (Self::Slide, "slides along its axis"),
        (Self::Turn(0), "turns about x"),
        (Self::Turn(1), "turns about y"),
        (Self::Turn(2), "turns about z"),
        (Self::Twist, "twists"),
        (Self::Move(0), "body moves along x"),
        (Self::Move(1), "body moves along y"),
        (Self::Move(2), "body moves along z"),
    ];

    /// What a body is looked at by at first: a single limb's sliding is the lesson of Fig. 5.1.
    pub(crate) fn of(model: &Model) -> Self {
        if model.rotation_count() == 1 { Self::Slide } else { Self::Turn(0) }
    }

    pub(crate) fn text(self) -> &'static str {
        Self::ALL.iter().find(|(axis, _)| *axis == self).map_or("", |(_, text)| text)
    }

    /// What pixels do along it, behind "what" and "pixels that".
    pub(crate) fn verb(self, limb: &str) -> String {
        let axis = |index: usize| ["x", "y", "z"][index.min(2)];
        match self {
            Self::Slide => format!("pushes the {limb} along its axis"),
            Self::Turn(index) => format!("turns the {limb} about {}", axis(index)),
            Self::Twist => format!("twists the {limb}"),
            Self::Move(index) => format!("pushes the body along {}", axis(index)),
        }
    }

    /// Which pixels are counted, below the picture.
    pub(crate) const fn pixels(self) -> &'static str {
        match self {
            Self::Slide => "Pixels that push along the axis",
            Self::Turn(_) => "Pixels that turn it",
            Self::Twist => "Pixels that twist it",
            Self::Move(_) => "Pixels that push the body",
        }
    }

    /// The motion v in tangent columns.
    pub(crate) fn direction(self, model: &Model, kinematics: &Kinematics, limb: usize) -> Vec<f64> {
        let mut v = vec![0.0; Parameters::Tangent.columns(model.rotation_count())];
        let limb = limb.min(model.limbs().len().saturating_sub(1));
        let along = (kinematics.ends()[limb] - kinematics.starts()[limb]).normalize_or_zero();
        let rotation = model.limbs()[limb].rotation;
        let first = Parameters::Tangent.first_column(rotation);
        let (at, motion) = match self {
            Self::Slide => (0, along),
            Self::Move(index) => (0, DVec3::AXES[index.min(2)]),
            Self::Turn(index) => (first, DVec3::AXES[index.min(2)]),
            Self::Twist => (first, kinematics.parent_frames()[rotation].transpose() * along),
        };
        v[at..at + 3].copy_from_slice(&motion.to_array());
        v
    }
}

/// What every pixel of one camera says about a motion, for one fit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Push {
    /// ∂λ/∂v, row by row; zero where the pixel has no gradient.
    pub(crate) values: Vec<f64>,
    pub(crate) prediction: Prediction,
}

impl Push {
    /// Looks at a pose in one camera.
    pub(crate) fn new(scene: &FitInputs, pose: &Pose, (camera, axis, limb): PushKey) -> Option<Self> {
        let FitInputs { model, fit, cameras, .. } = scene;
        let camera = cameras.get(camera)?;
        let kinematics = Kinematics::new(model, pose);
        let view = View::new(model, &kinematics, camera, fit.renderer, fit.final_ramp());
        let direction = axis.direction(model, &kinematics, limb);
        let values = jacobian_along(&view, &kinematics, camera, Parameters::Tangent, &direction);
        Some(Self { values, prediction: Prediction::of(&view) })
    }

    /// The 99th percentile of the magnitudes above rounding; `None` if there is none.
    fn scale(&self) -> Option<f64> {
        let is_rounding = |value: f64| value.abs() < LEAST_PUSH;
        let values: Vec<f32> = self.values.iter().filter(|v| !is_rounding(**v)).map(|v| *v as f32).collect();
        (!values.is_empty()).then(|| f64::from(Derivative::new(values).scale))
    }
}

/// A [`Push`] measured by what all fits together reach.
#[derive(Debug, Clone, PartialEq)]
pub struct Pushed {
    /// The picture: zero where the pixel does not push.
    pub(crate) picture: Derivative,
    pub(crate) prediction: Prediction,
    /// Pixels that push.
    pub pushing: usize,
    /// Pixels in the ramp.
    pub in_ramp: usize,
}

fn is_in_ramp(level: &f32) -> bool {
    *level > 0.0 && *level < 255.0
}

impl Pushed {
    /// Pixels that push, of those in the ramp.
    pub(crate) fn text(&self) -> String {
        let count = |n: usize| format::count(n as i64);
        format!("{} of {}", count(self.pushing), count(self.in_ramp))
    }

    /// Counts and colours pushes by one measure.
    pub(crate) fn all(pushes: Vec<Push>) -> Vec<Self> {
        let mut scales: Vec<f64> = pushes.iter().filter_map(Push::scale).collect();
        scales.sort_by(f64::total_cmp);
        let scale = scales.get(scales.len().saturating_sub(1) / 2).copied().unwrap_or(1.0);
        // Rounding is no push.
        let least = (scale * LEAST_SHARE).max(LEAST_PUSH);
        let kept = |(value, level): (&f64, &f32)| {
            if is_in_ramp(level) && value.abs() >= least { *value as f32 } else { 0.0 }
        };
        let measured = |Push { values, prediction }: Push| {
            let values: Vec<f32> = values.iter().zip(&prediction.lambda).map(kept).collect();
            Self {
                pushing: values.iter().filter(|value| value.abs() > 0.0).count(),
                in_ramp: prediction.lambda.iter().filter(|level| is_in_ramp(level)).count(),
                picture: Derivative { values, scale: scale as f32 },
                prediction,
            }
        };
        pushes.into_iter().map(measured).collect()
    }
}

#[cfg(test)]
mod tests {
    use backlit_lab::synthetic::single_limb;
    use backlit_tracking::body::builtin;
    use backlit_tracking::fit::{FitOptions, Preset};
    use backlit_tracking::render::RendererKind;

    use super::*;
    use crate::features::laboratory::comparison::tests::scene;

    fn counts(axis: PushAxis, distance_m: f64) -> Vec<(usize, usize)> {
        let camera = single_limb::camera(distance_m, [192, 144]).unwrap();
        let look = |renderer| {
            let fit = FitOptions { renderer, ..FitOptions::preset(Preset::Report) };
            let scene = scene(builtin::single_limb(), fit, vec![camera.clone()]);
            Push::new(&scene, &single_limb::start(0.1), (0, axis, 0)).unwrap()
        };
        Pushed::all(RendererKind::in_report_order().map(look).into())
            .iter()
            .map(|push| (push.pushing, push.in_ramp))
            .collect()
    }

    #[test]
    fn from_the_side_flat_ends_do_not_push_along_the_limb() {
        let found = counts(PushAxis::Slide, 10.0);
        assert!(found[0].0 < 40, "{found:?}");
        assert!(found[1].0 > 1000 && found[2].0 > 2 * found[1].0, "{found:?}");
        assert!(found.iter().all(|(pushing, in_ramp)| pushing <= in_ramp), "{found:?}");
        let near = counts(PushAxis::Slide, 0.8);
        assert!(near[0].0 > found[0].0, "near by the camera sees the ends: {near:?}");
    }

    #[test]
    fn nothing_tells_a_twist() {
        for (pushing, in_ramp) in counts(PushAxis::Twist, 10.0) {
            assert!(pushing == 0 && in_ramp > 100, "{pushing} of {in_ramp}");
        }
    }

    #[test]
    fn motions_are_what_their_names_say() {
        let model = builtin::upper_body();
        let pose = backlit_take::demonstration::Demonstration::TwoCameras.truth(7).unwrap();
        let before = Kinematics::new(&model, &pose);
        let limb = model.limb_index("right forearm").unwrap();
        for (axis, name) in PushAxis::ALL {
            let step: Vec<f64> = axis.direction(&model, &before, limb).iter().map(|v| v * 1e-6).collect();
            let after = Kinematics::new(&model, &pose.retract(Parameters::Tangent, &step));
            let moved = (after.ends()[limb] - before.ends()[limb]) / 1e-6;
            let along = (before.ends()[limb] - before.starts()[limb]).normalize();
            match axis {
                PushAxis::Slide => assert!(moved.distance(along) < 1e-5, "{name}: {moved}"),
                PushAxis::Move(index) => assert!(moved.distance(DVec3::AXES[index]) < 1e-5, "{name}"),
                PushAxis::Twist => assert!(moved.length() < 1e-5, "{name}: {moved}"),
                PushAxis::Turn(_) => assert!(moved.length() > 1e-3, "{name}: {moved}"),
            }
        }
    }
}
