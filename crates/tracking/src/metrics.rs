//! Joint errors against a reference, raw and without what its markers are defined otherwise.

mod angles;
pub mod comparison;
mod placement;
mod reference_noise;
mod trajectories;

use std::collections::BTreeMap;

use glam::DVec3;

use crate::body::{Kinematics, Model, Pose};
use crate::statistics::Statistics;

pub use angles::JointAngle;
pub use placement::{FEWEST_FRAMES, MarkerOffset, MarkerPlacement};
pub use trajectories::{Between, Moments, Trajectories};

/// Where a reference says that joints are, in one frame: limb index of the joint's limb (its second joint),
/// or `None` for the root, and the world position in metres.
pub type ReferenceJoints = Vec<(Option<usize>, DVec3)>;

/// Errors of all joints in all frames, put together. Frames are added in the order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointErrors {
    /// From the fitted joint to the reference in the axes of the joint's limb, metres.
    by_joint: BTreeMap<String, Vec<DVec3>>,
    rods: reference_noise::Rods,
}

impl JointErrors {
    /// Adds one frame's distances.
    pub fn add(&mut self, model: &Model, pose: &Pose, reference: &ReferenceJoints) {
        let kinematics = Kinematics::new(model, pose);
        for &(limb, place) in reference {
            let name = limb.map_or("root", |limb| &model.limbs()[limb].name).to_owned();
            let (axes, joint) = placement::axes_of(model, &kinematics, limb);
            self.by_joint.entry(name).or_default().push(axes.transpose() * (place - joint));
        }
        self.rods.add(model, reference);
    }

    /// Distances of all joints and frames, millimetres; `None` if no joint was compared.
    pub fn overall(&self) -> Option<Statistics> {
        Statistics::of(&self.by_joint.values().flat_map(|places| raw(places)).collect::<Vec<f64>>())
    }

    /// The same by the joint's name.
    pub fn by_joint(&self) -> BTreeMap<&str, Statistics> {
        let joints = self.by_joint.iter();
        joints.filter_map(|(name, places)| Some((name.as_str(), Statistics::of(&raw(places))?))).collect()
    }

    /// The same for a reference whose markers are brought back to the joints: by a placement that was learnt elsewhere, or without
    /// one by offsets that are learnt, for every frame, in other frames of the same track. Joints seen in fewer than
    /// [`FEWEST_FRAMES`] are left out of the second.
    pub fn placed(&self, placement: Option<&MarkerPlacement>) -> BTreeMap<&str, Vec<f64>> {
        let judge = |name: &str, places: &[DVec3]| match placement {
            None => placement::held_out(places),
            Some(placement) => {
                let offset = placement.offsets.get(name).map_or(DVec3::ZERO, |learnt| learnt.offset);
                Some(places.iter().map(|place| place.distance(offset)).collect())
            }
        };
        let joints = self.by_joint.iter().filter_map(|(name, places)| {
            let mm = judge(name, places)?.into_iter().map(|distance| 1000.0 * distance);
            Some((name.as_str(), mm.collect()))
        });
        joints.collect()
    }

    /// How far the reference itself scatters in the mean, millimetres, from distances in it that cannot vary; `None` where it has
    /// none.
    pub fn reference_noise_mm(&self) -> Option<f64> {
        self.rods.noise_mm()
    }

    /// Where the reference's tool puts its markers, learnt from all frames; joints seen in a few only are left out.
    pub fn placement(&self, tool: &str) -> MarkerPlacement {
        let learn =
            |(name, places): (&String, &Vec<DVec3>)| Some((name.clone(), MarkerOffset::learn(places)?));
        MarkerPlacement { tool: tool.to_owned(), offsets: self.by_joint.iter().filter_map(learn).collect() }
    }
}

/// Lengths, millimetres.
fn raw(places: &[DVec3]) -> Vec<f64> {
    places.iter().map(|place| 1000.0 * place.length()).collect()
}

/// Mean distance between the limbs' ends of two poses, millimetres. Twists that no joint shows do not count.
pub fn mean_joint_error_mm(model: &Model, pose: &Pose, truth: &Pose) -> f64 {
    let (found, truth) = (Kinematics::new(model, pose), Kinematics::new(model, truth));
    let sum: f64 = found.ends().iter().zip(truth.ends()).map(|(a, b)| a.distance(*b)).sum();
    1000.0 * sum / found.ends().len().max(1) as f64
}

/// How much a track trembles: mean length of the joints' second differences from frame to frame, millimetres.
///
/// `poses` are consecutive frames in their order; `None` for fewer than three.
pub fn jitter_mm<'a>(model: &Model, poses: impl IntoIterator<Item = &'a Pose>) -> Option<f64> {
    let joints: Vec<Vec<DVec3>> =
        poses.into_iter().map(|pose| Kinematics::new(model, pose).ends().to_vec()).collect();
    let lengths = joints.windows(3).flat_map(|three| {
        let [before, here, after] = [&three[0], &three[1], &three[2]];
        let second = |joint: usize| 1000.0 * (after[joint] - 2.0 * here[joint] + before[joint]).length();
        (0..here.len()).map(second).collect::<Vec<f64>>()
    });
    Statistics::of(&lengths.collect::<Vec<f64>>()).map(|statistics| statistics.mean)
}

/// Mean distance of all leaf joints and the root of two poses, millimetres.
pub fn leaf_error_mm(model: &Model, a: &Pose, b: &Pose) -> f64 {
    let is_leaf = |limb: &usize| model.limbs().iter().all(|other| other.parent != Some(*limb));
    let (found, truth) = (Kinematics::new(model, a), Kinematics::new(model, b));
    let mut distances = vec![a.root.distance(b.root)];
    let leaves = (0..model.limbs().len()).filter(is_leaf);
    distances.extend(leaves.map(|limb| found.ends()[limb].distance(truth.ends()[limb])));
    1e3 * distances.iter().sum::<f64>() / distances.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jumps_tremble() {
        let model = crate::body::builtin::upper_body();
        let poses: Vec<Pose> = (0..6).map(|frame| wandering(&model, frame)).collect();
        assert!(jitter_mm(&model, &poses).unwrap() > 10.0);
        assert!(jitter_mm(&model, [&poses[0]; 4]).unwrap() < 1e-12);
        assert_eq!(jitter_mm(&model, &poses[..2]), None);
    }

    /// A pose that changes in every joint, also by turns about the limbs.
    fn wandering(model: &Model, frame: usize) -> Pose {
        let step = |column: usize| 0.1 * ((frame * 3 + column) as f64).sin();
        crate::fixtures::stepped(model, crate::body::Parameters::Tangent, step)
    }

    /// What a tool with offsets of its own sees, each marker off by `noise` metres more: 1 for a deviation of one metre in every axis.
    fn errors_of(model: &Model, frames: usize, noise: f64, offset: DVec3) -> JointErrors {
        use rand::SeedableRng;
        let mut random = rand::rngs::StdRng::seed_from_u64(3);
        let mut errors = JointErrors::default();
        for frame in 0..frames {
            let pose = wandering(model, frame);
            let kinematics = Kinematics::new(model, &pose);
            let joints = std::iter::once(None).chain((0..model.limbs().len()).map(Some));
            let reference = joints.map(|limb| {
                let (axes, joint) = placement::axes_of(model, &kinematics, limb);
                (limb, joint + axes * offset + noise * crate::statistics::normal_vector(&mut random))
            });
            let reference = reference.collect();
            errors.add(model, &pose, &reference);
        }
        errors
    }

    fn mean_of(placed: &BTreeMap<&str, Vec<f64>>) -> f64 {
        crate::statistics::mean(placed.values().flatten().copied()).unwrap()
    }

    /// Markers that always are at the same place of their limb cost nothing once that is known, and are learnt from frames that
    /// are not judged.
    #[test]
    fn offsets_are_taken_off_and_judged_on_other_frames() {
        let model = crate::body::builtin::upper_body();
        let offset = DVec3::new(0.01, -0.02, 0.03);
        let exact = errors_of(&model, 40, 0.0, offset);
        assert!((exact.overall().unwrap().mean - 1000.0 * offset.length()).abs() < 1e-9);
        assert!(mean_of(&exact.placed(None)) < 1e-6);
        let learnt = exact.placement("own");
        assert!(learnt.offsets["head"].offset.distance(offset) < 1e-9 && learnt.offsets["root"].frames == 40);
        assert!(mean_of(&exact.placed(Some(&learnt))) < 1e-6);
        // Of another tool, which knows nothing of these joints, nothing is taken off.
        let unknown = mean_of(&exact.placed(Some(&MarkerPlacement::default())));
        assert!((unknown - 1000.0 * offset.length()).abs() < 1e-9);
        // Where the joints are elsewhere in each half, no frame is judged by itself: the halves differ by 40 mm.
        let mut drifting = errors_of(&model, 4, 0.0, DVec3::ZERO);
        for frame in 4..8 {
            let (pose, up) = (wandering(&model, frame), DVec3::new(0.0, 0.0, 0.04));
            let ends = Kinematics::new(&model, &pose).ends().to_vec();
            drifting.add(
                &model,
                &pose,
                &ends.iter().enumerate().map(|(limb, end)| (Some(limb), *end + up)).collect(),
            );
        }
        let of_head = drifting.placed(None)["head"].clone();
        assert!(of_head.iter().all(|error| *error > 15.0), "{of_head:?}");
        assert!(errors_of(&model, 7, 0.0, offset).placed(None).is_empty());
    }

    /// One marker in eight that was mistaken for another moves an offset by less than a tenth of what the mean would move.
    #[test]
    fn a_mistaken_marker_hardly_moves_an_offset() {
        let near = |frame: usize| DVec3::new(0.001 * (frame as f64).sin(), 0.001 * (frame as f64).cos(), 0.0);
        let places: Vec<DVec3> =
            (0..16).map(|frame| if frame % 8 == 0 { DVec3::X } else { near(frame) }).collect();
        let learnt = MarkerOffset::learn(&places).unwrap();
        assert!(learnt.offset.length() < 0.002 && learnt.frames == 16, "{learnt:?}");
        assert_eq!(MarkerOffset::learn(&places[..3]), None);
    }

    /// The noise of the reference is found whatever the pose is off, and only between joints that one rotation carries.
    #[test]
    fn noise_is_found_from_lengths_that_cannot_vary() {
        for model in [crate::body::builtin::upper_body(), crate::body::builtin::full_body()] {
            let exact = errors_of(&model, 60, 0.0, DVec3::ZERO);
            assert!(exact.reference_noise_mm().unwrap() < 1e-9, "{}", model.name());
            let noisy = errors_of(&model, 400, 0.005, DVec3::ZERO).reference_noise_mm().unwrap();
            let expected = 5.0 * (8.0 / std::f64::consts::PI).sqrt();
            assert!((noisy / expected - 1.0).abs() < 0.05, "{noisy} {expected}");
        }
        assert_eq!(JointErrors::default().reference_noise_mm(), None);
    }
}
