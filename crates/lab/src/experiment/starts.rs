//! Starts of known distance from a known truth, before cameras that see hard masks.

use std::collections::BTreeMap;
use std::sync::Arc;

use backlit_formats::starts_file::Start;
use backlit_tracking::body::{Model, Pose, builtin};
use backlit_tracking::camera::Camera;
use backlit_tracking::fit::FitView;
use backlit_tracking::geometry::rotation::exp;
use backlit_tracking::search::start::{LEVELS, Level, perturb};
use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use super::ExperimentError;
use crate::synthetic::capsules;
use crate::synthetic::studio::pinhole;

/// Metres from the cameras to the body, and what they look at above its root.
const DISTANCE: f64 = 2.7;
const TARGET: DVec3 = DVec3::new(0.0, 0.35, 0.0);
/// Focal length, in picture widths.
const FOCAL: f64 = 1.55;
/// How far the true root lies from the origin at most, metres.
const ROOT: DVec3 = DVec3::new(0.15, 0.08, 0.15);
/// How far the true rotations are turned from rest at most, radians, by the limb's name.
const TURNS: [(&str, f64); 8] = [
    ("torso", 0.33),
    ("right shoulder", 0.28),
    ("right upper arm", 1.54),
    ("right forearm", 1.1),
    ("left shoulder", 0.28),
    ("left upper arm", 1.54),
    ("left forearm", 1.1),
    ("head", 0.44),
];

/// What starts to draw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Draw {
    /// Starts of each level.
    pub starts: usize,
    /// How far they are off.
    pub levels: Vec<Level>,
    /// Numbers of cameras.
    pub cameras: Vec<usize>,
    /// Pixels across and down.
    pub size_px: [u64; 2],
    /// Seed of poses, cameras and starts.
    pub seed: u64,
}

impl Default for Draw {
    fn default() -> Self {
        Self { starts: 40, levels: LEVELS.to_vec(), cameras: vec![1, 2, 4], size_px: [48, 36], seed: 1 }
    }
}

impl Draw {
    /// Draws them: every start has a pose and cameras of its own.
    ///
    /// # Errors
    /// Numbers that make no scene.
    pub fn draw(&self) -> Result<Vec<Start>, ExperimentError> {
        if self.starts == 0 {
            return Err(ExperimentError::Option { option: "starts", value: 0.0, expected: "1 or more" });
        }
        let model = Arc::new(builtin::upper_body());
        let mut starts = Vec::new();
        for level in &self.levels {
            for index in 0..self.starts {
                starts.push(self.one(&model, *level, index as u64)?);
            }
        }
        Ok(starts)
    }

    fn one(&self, model: &Arc<Model>, level: Level, index: u64) -> Result<Start, ExperimentError> {
        let seed = self.seed.wrapping_mul(1_000_003).wrapping_add(index * 101);
        let mut random = Pcg64Mcg::seed_from_u64(seed.wrapping_add(u64::from(level.degrees) * 7919));
        let truth = random_pose(model, &mut random);
        let middle = random.random_range(-0.6..0.6);
        let mut views = BTreeMap::new();
        for &count in &self.cameras {
            let cameras = self.arc(count, middle, &mut random)?;
            let view = |camera: Arc<Camera>| -> Result<FitView, ExperimentError> {
                let mask = capsules::hard_mask(model, &truth, &camera)?;
                Ok(FitView::of_mask(camera, mask))
            };
            views.insert(count, cameras.into_iter().map(view).collect::<Result<Vec<_>, _>>()?);
        }
        let angle = f64::from(level.degrees).to_radians();
        let start = perturb(model, &truth, angle, level.metres, random.random_range(0..u64::MAX));
        Ok(Start { model: Arc::clone(model), degrees: level.degrees, truth, start, views })
    }

    /// Cameras on an arc about the body: two about a quarter turn apart, more on half as much again.
    fn arc(
        &self,
        count: usize,
        middle: f64,
        random: &mut Pcg64Mcg,
    ) -> Result<Vec<Arc<Camera>>, ExperimentError> {
        if !(1..=16).contains(&count) {
            let value = count as f64;
            return Err(ExperimentError::Option { option: "cameras", value, expected: "1 to 16" });
        }
        let opening = random.random_range(1.2..1.9) * if count > 2 { 1.5 } else { 1.0 };
        let focal = FOCAL * self.size_px[0] as f64;
        let gaps = count.saturating_sub(1).max(1) as f64;
        let mut cameras = Vec::with_capacity(count);
        for index in 0..count {
            let along = if count == 1 { 0.0 } else { index as f64 / gaps - 0.5 };
            let (sine, cosine) = (middle + opening * along).sin_cos();
            let centre = DVec3::new(DISTANCE * sine, random.random_range(0.3..1.1), DISTANCE * cosine);
            let name = format!("cam{:02}", index + 1);
            cameras.push(pinhole(&name, self.size_px, focal, [centre, TARGET], DVec3::Y)?);
        }
        Ok(cameras)
    }
}

fn random_pose(model: &Model, random: &mut Pcg64Mcg) -> Pose {
    let mut pose = Pose::rest(model);
    let mut unit = || random.random_range(-1.0..1.0);
    pose.root = ROOT * DVec3::new(unit(), unit(), unit());
    for (name, most) in TURNS {
        if let Some(limb) = model.limb_index(name) {
            let axis = loop {
                let axis = DVec3::new(unit(), unit(), unit());
                if (0.01..1.0).contains(&axis.length_squared()) {
                    break axis.normalize();
                }
            };
            let share = 0.6 + 0.4 * unit();
            pose.rotations[model.limbs()[limb].rotation] = exp(axis * (most * share));
        }
    }
    pose
}

#[cfg(test)]
mod tests {
    use backlit_tracking::fit::Evidence;
    use backlit_tracking::silhouette::Label;

    use super::*;

    #[test]
    fn starts_are_as_far_off_as_they_say_and_the_cameras_see_the_truth() {
        let draw = Draw { starts: 2, ..Draw::default() };
        let starts = draw.draw().unwrap();
        assert_eq!(starts.len(), 10);
        for start in &starts {
            let step = start.start.local(&start.truth);
            let turn = DVec3::from_slice(&step[3..6]).length().to_degrees();
            assert!((turn - f64::from(start.degrees)).abs() < 1e-6, "{turn}");
            for (count, views) in &start.views {
                assert_eq!(views.len(), *count);
                for view in views {
                    let Evidence::Mask(mask) = &view.evidence else { panic!("no mask") };
                    assert!(mask.count(Label::Subject) > 100);
                }
            }
        }
        let again = draw.draw().unwrap();
        assert!(starts.iter().zip(&again).all(|(a, b)| a.start == b.start && a.truth == b.truth));
        let none = Draw { cameras: vec![0], ..draw };
        assert!(none.draw().unwrap_err().to_string().contains("cameras"));
    }
}
