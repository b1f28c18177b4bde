//! Sets of cameras compared, from sums that are there already: nothing is rendered again.

use super::directions::Noise;
use super::information::FrameInformation;
use super::uncertainty::{JointUncertainty, joint_uncertainties};
use crate::statistics::upper_median;

/// Up to this many cameras every set of them is compared.
const ALL_SETS_UP_TO: usize = 4;
/// Up to this many cameras pairs are compared; beyond, single cameras, all but one, and all.
const PAIRS_UP_TO: usize = 8;

/// What a set of cameras sees, in a few numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct SubsetFigures {
    /// The set, by index, in order.
    pub cameras: Vec<usize>,
    /// Directions that none of them sees.
    pub null_count: usize,
    /// Directions in all.
    pub columns: usize,
    /// The joint that is known worst, by the limb whose second joint it is (`None` is the root), and its standard
    /// deviation in its worst direction, metres; infinite where nothing bounds it.
    pub worst: (Option<usize>, f64),
    /// The same of the joint in the middle: half are known better.
    pub median_m: f64,
    /// Smallest singular value that is not null, squared grey levels per rad²; zero if all are.
    pub smallest: f64,
    /// Root first, then [`articulated_joints`](super::uncertainty::articulated_joints).
    pub joints: Vec<JointUncertainty>,
}

/// The sets of `cameras` that are compared, small ones first: all of them up to four cameras, else single cameras, pairs
/// (up to eight cameras), all but one, and all.
#[must_use]
pub fn camera_subsets(cameras: &[usize]) -> Vec<Vec<usize>> {
    let count = cameras.len();
    let of_bits = |bits: u32| -> Vec<usize> {
        (0..count).filter(|at| bits >> at & 1 == 1).map(|at| cameras[at]).collect()
    };
    let mut sets: Vec<Vec<usize>> = if count <= ALL_SETS_UP_TO {
        (1..1_u32 << count).map(of_bits).collect()
    } else {
        let mut sets: Vec<Vec<usize>> = cameras.iter().map(|&camera| vec![camera]).collect();
        if count <= PAIRS_UP_TO {
            let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
            sets.extend(pairs.map(|pair| pair.map(|at| cameras[at]).to_vec()));
        }
        let without = |left: &usize| cameras.iter().copied().filter(|camera| camera != left).collect();
        sets.extend(cameras.iter().map(without));
        sets.push(cameras.to_vec());
        sets
    };
    sets.sort_by(|a, b| a.len().cmp(&b.len()).then_with(|| a.cmp(b)));
    sets
}

impl FrameInformation {
    /// Figures of a set of cameras, with the same noise for every set so that only what they see differs.
    #[must_use]
    pub fn subset(&self, cameras: &[usize], noise: Noise) -> SubsetFigures {
        let spectrum = self.spectrum(cameras);
        let joints = joint_uncertainties(self, &spectrum, noise.deviation());
        let mut deviations: Vec<f64> = joints.iter().map(|joint| joint.worst_deviation_m()).collect();
        let worst = joints.iter().zip(&deviations).map(|(joint, deviation)| (joint.limb, *deviation));
        let worst = worst.reduce(|worst, next| if next.1 > worst.1 { next } else { worst });
        SubsetFigures {
            cameras: cameras.to_vec(),
            null_count: spectrum.values.len() - spectrum.rank,
            columns: spectrum.values.len(),
            worst: worst.unwrap_or((None, f64::INFINITY)),
            median_m: upper_median(&mut deviations).unwrap_or(f64::INFINITY),
            smallest: spectrum.rank.checked_sub(1).map_or(0.0, |last| spectrum.values[last]),
            joints,
        }
    }

    /// Figures of all sets that [`camera_subsets`] names of the cameras with data, best first: fewest null directions,
    /// then the smallest deviation of the worst joint, of the middle one, then fewest cameras.
    #[must_use]
    pub fn compare_subsets(&self, noise: Noise) -> Vec<SubsetFigures> {
        let all = 0..self.cameras.len();
        let cameras: Vec<usize> = all.filter(|&camera| self.cameras[camera].is_some()).collect();
        let mut figures: Vec<SubsetFigures> =
            camera_subsets(&cameras).iter().map(|set| self.subset(set, noise)).collect();
        figures.sort_by(|a, b| {
            (a.null_count.cmp(&b.null_count))
                .then(a.worst.1.total_cmp(&b.worst.1))
                .then(a.median_m.total_cmp(&b.median_m))
                .then(a.cameras.len().cmp(&b.cameras.len()))
                .then_with(|| a.cameras.cmp(&b.cameras))
        });
        figures
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sets_are_all_of_few_and_the_telling_ones_of_many() {
        assert_eq!(camera_subsets(&[2, 5]), [vec![2], vec![5], vec![2, 5]]);
        assert_eq!(camera_subsets(&[0, 1, 2, 3]).len(), 15);
        assert_eq!(camera_subsets(&(0..8).collect::<Vec<_>>()).len(), 8 + 28 + 8 + 1);
        assert_eq!(camera_subsets(&(0..9).collect::<Vec<_>>()).len(), 9 + 9 + 1);
        assert!(camera_subsets(&[]).is_empty());
    }
}
