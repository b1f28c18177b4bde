//! What held which limb in a frame.

use super::coverage::Coverage;
use crate::body::{Kinematics, Model};
use crate::residual::cue::{Cue, CueSet};

/// A pull counts if its loss believes it at the fitted pose by this much, 0 to 1.
const BELIEVED: f64 = 0.5;
/// So many flowed points, pieces of edge or points in space hold a part.
const FEWEST: usize = 4;

/// What held a part of the body in one frame: the limb that owns a rotation, and those that turn with it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LimbHold {
    /// The limb that owns the rotation.
    pub limb: usize,
    /// How many cameras see a boundary of its own.
    pub cameras: usize,
    /// Whether those are enough, or it lies between parts that silhouettes hold.
    pub by_silhouettes: bool,
    /// The cues that held it besides, in their order.
    pub cues: Vec<Cue>,
}

impl LimbHold {
    /// Whether nothing held it: its pose is what motion and priors make of it.
    #[must_use]
    pub fn is_unsure(&self) -> bool {
        !self.by_silhouettes && self.cues.is_empty()
    }

    /// Says of every part what held it at a fitted pose, in the order of the rotations. A cue holds a part where enough of
    /// its pulls agree with the pose: a keypoint in as many cameras as a silhouette needs, four points of the others.
    #[must_use]
    pub fn of_pose(model: &Model, kinematics: &Kinematics, coverage: &Coverage, set: &CueSet) -> Vec<Self> {
        let mut counts = vec![[0; Cue::ALL.len()]; model.rotation_count()];
        for pull in &set.pulls {
            let believed = set.distance(pull, model, kinematics).is_some_and(|(_, share)| share >= BELIEVED);
            if let Some(cue) = Cue::ALL.iter().position(|cue| *cue == pull.cue)
                && believed
            {
                counts[model.limbs()[pull.limb].rotation][cue] += 1;
            }
        }
        let keypoints_needed = coverage.enough();
        let holds = |(cue, count): (Cue, usize)| {
            let needed = if cue == Cue::Keypoints { keypoints_needed } else { FEWEST };
            (count >= needed).then_some(cue)
        };
        let of_part = |(&limb, counts): (&usize, [usize; Cue::ALL.len()])| Self {
            limb,
            cameras: coverage.cameras_that_see(limb),
            by_silhouettes: !coverage.is_covered(limb),
            cues: Cue::ALL.into_iter().zip(counts).filter_map(holds).collect(),
        };
        model.rotation_owners().iter().zip(counts).map(of_part).collect()
    }
}
