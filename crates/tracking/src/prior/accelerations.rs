//! How much joints' velocities change: q of a constant-velocity filter, joint by joint.
//!
//! Of a velocity that white accelerations change by √q in a second, the second difference over a time Δ has the variance
//!
//! E (x(t + Δ) − 2 x(t) + x(t − Δ))² = ⅔ q Δ³
//!
//! in each column (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001, section
//! 6.2.2, summed over two steps). A limb's turn ω from moment to moment is the least that leads from direction to direction, seen
//! from the trunk; a forearm's, a calf's and a foot's are those beyond their parent's. Twists show nowhere and are
//! taken to change as other turns do.

use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::direction::{BodyDirection, BodyPoints, TrunkFrame};
use super::train::Clip;
use crate::geometry::rotation::log;

/// Δ, seconds: over less, errors of capture are as large.
const SECONDS: f64 = 1.0 / 15.0;
/// A thigh and a calf together, metres, by which motion of any unit is measured.
const LEG_M: f64 = 0.84;
/// Nothing that moves changes its velocity less than this.
const LEAST: f64 = 0.05;

/// Joints that are told apart, the root with them.
const JOINTS: usize = 8;

/// √q: of the root m/s^1.5, of rotations rad/s^1.5; both sides are alike.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the fields are joints")]
pub struct Accelerations {
    pub root: f64,
    pub pelvis: f64,
    pub chest: f64,
    pub upper_arm: f64,
    pub forearm: f64,
    pub thigh: f64,
    pub calf: f64,
    pub foot: f64,
}

impl Accelerations {
    /// Of the rotation of a limb of this name; what stands on the chest and was not learnt moves as the chest does.
    #[must_use]
    pub fn of_limb(&self, name: &str) -> f64 {
        match name.trim_start_matches("right ").trim_start_matches("left ") {
            "spine" | "torso" => self.pelvis,
            "upper arm" => self.upper_arm,
            "forearm" => self.forearm,
            "thigh" => self.thigh,
            "calf" => self.calf,
            "foot" => self.foot,
            _ => self.chest,
        }
    }

    /// The first that is no number above 0, by its name in files.
    pub(super) fn wrong(&self) -> Option<(&'static str, f64)> {
        let Self { root, pelvis, chest, upper_arm, forearm, thigh, calf, foot } = *self;
        let named = [
            ("root", root),
            ("pelvis", pelvis),
            ("chest", chest),
            ("upper-arm", upper_arm),
            ("forearm", forearm),
            ("thigh", thigh),
            ("calf", calf),
            ("foot", foot),
        ];
        named.into_iter().find(|(_, value)| !(*value > 0.0 && (value * value).is_normal()))
    }

    /// Learns them; `None` where no clip is long enough. Of movements, of which some are ten times as lively as others, the typical one
    /// counts: the geometric mean of the clips.
    pub(super) fn learn(clips: &[Clip]) -> Option<Self> {
        let learnt: Vec<[f64; JOINTS]> = clips.iter().filter_map(of_clip).collect();
        let typical = |joint: usize| {
            let logarithms: f64 = learnt.iter().map(|of_clip| of_clip[joint].ln()).sum();
            (logarithms / learnt.len() as f64).exp()
        };
        let [root, pelvis, chest, upper_arm, forearm, thigh, calf, foot] = std::array::from_fn(typical);
        let all = Self { root, pelvis, chest, upper_arm, forearm, thigh, calf, foot };
        (!learnt.is_empty()).then_some(all)
    }
}

/// √q of all joints in one clip; `None` if it is too short.
fn of_clip(clip: &Clip) -> Option<[f64; JOINTS]> {
    let mut squares = [Mean::default(); JOINTS];
    let gap = (SECONDS / clip.frame_seconds).round().max(1.0) as usize;
    let seconds = gap as f64 * clip.frame_seconds;
    let moments: Vec<Option<Moment>> = clip.frames.iter().map(Moment::of).collect();
    for three in moments.windows(2 * gap + 1) {
        if let (Some(first), Some(middle), Some(last)) = (&three[0], &three[gap], &three[2 * gap]) {
            add(&mut squares, [first, middle, last], 1.5 / seconds.powi(3));
        }
    }
    (squares[0].count > 0.0).then(|| squares.map(Mean::root))
}

/// Of squares.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Mean {
    fn add(&mut self, squares: f64, count: f64) {
        self.sum += squares;
        self.count += count;
    }

    fn root(self) -> f64 {
        (self.sum / self.count.max(1.0)).sqrt().max(LEAST)
    }
}

/// A person at one moment.
struct Moment {
    /// Metres.
    root: DVec3,
    pelvis: DQuat,
    /// As the pelvis sees it.
    chest: DQuat,
    /// Of upper arm and forearm by the chest, of thigh, calf and foot by the pelvis, right and left.
    directions: [[DVec3; 5]; 2],
}

impl Moment {
    fn of(points: &BodyPoints) -> Option<Self> {
        use BodyDirection as D;
        // Left, ahead and up are left-handed.
        let turn =
            |frame: DMat3| DQuat::from_mat3(&DMat3::from_cols(-frame.x_axis, frame.y_axis, frame.z_axis));
        let [pelvis, chest] = [TrunkFrame::Pelvis, TrunkFrame::Chest].map(|frame| points.frame(frame));
        let [pelvis, chest] = [turn(pelvis?), turn(chest?)];
        let of = |directions: [D; 5]| -> Option<[DVec3; 5]> {
            let all: Option<Vec<DVec3>> = directions.into_iter().map(|one| points.direction(one)).collect();
            all?.try_into().ok()
        };
        let leg = points.hips[0].distance(points.knees[0]) + points.knees[0].distance(points.ankles[0]);
        Some(Self {
            root: points.hips[0].midpoint(points.hips[1]) * (LEG_M / leg),
            pelvis,
            chest: pelvis.inverse() * chest,
            directions: [
                of([D::RightUpperArm, D::RightForearm, D::RightThigh, D::RightCalf, D::RightFoot])?,
                of([D::LeftUpperArm, D::LeftForearm, D::LeftThigh, D::LeftCalf, D::LeftFoot])?,
            ],
        })
    }
}

/// Adds the squared second differences of three moments, times 3/(2 Δ³).
fn add(squares: &mut [Mean; JOINTS], [first, middle, last]: [&Moment; 3], scale: f64) {
    let turned = |from: DQuat, to: DQuat| {
        let turn = (to * from.inverse()).normalize();
        log(if turn.w < 0.0 { -turn } else { turn })
    };
    let moved = (last.root - middle.root) - (middle.root - first.root);
    let pelvis = turned(middle.pelvis, last.pelvis) - turned(first.pelvis, middle.pelvis);
    let chest = turned(middle.chest, last.chest) - turned(first.chest, middle.chest);
    for (index, change) in [moved, pelvis, chest].into_iter().enumerate() {
        squares[index].add(scale * change.length_squared(), 3.0);
    }
    for side in 0..2 {
        let turn = |from: &Moment, to: &Moment, limb: usize| {
            log(DQuat::from_rotation_arc(from.directions[side][limb], to.directions[side][limb]))
        };
        for (limb, parent) in [(0, None), (1, Some(0)), (2, None), (3, Some(2)), (4, Some(3))] {
            let own = |from: &Moment, to: &Moment| {
                turn(from, to, limb) - parent.map_or(DVec3::ZERO, |parent| turn(from, to, parent))
            };
            let change = own(middle, last) - own(first, middle);
            // Two of its three columns show.
            let across = change.reject_from_normalized(middle.directions[side][limb]);
            squares[3 + limb].add(scale * across.length_squared(), 2.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;
    use rand_pcg::rand_core::SeedableRng;

    use super::super::direction::tests::standing;
    use super::*;

    /// Someone whose right forearm swings by white accelerations, which fade within a second, and who is otherwise still.
    #[test]
    fn known_accelerations_are_found() {
        let (q, frame_seconds) = (3.0, 1.0 / 30.0);
        let random = &mut Pcg64Mcg::seed_from_u64(2);
        let (mut angle, mut speed) = (1.2, 0.0);
        let mut frames = Vec::new();
        for _ in 0..4000 {
            let mut points = standing();
            points.wrists[0] = points.elbows[0] + 0.26 * DVec3::new(0.0, f64::sin(angle), -f64::cos(angle));
            frames.push(points);
            for _ in 0..8 {
                let short: f64 = frame_seconds / 8.0;
                let normal: f64 = (0..12).map(|_| random.random_range(-0.5..0.5)).sum();
                speed += q * short.sqrt() * normal - speed * short;
                angle += speed * short;
            }
        }
        let still =
            frames.clone().into_iter().map(|points| BodyPoints { wrists: standing().wrists, ..points });
        let still = Clip { frame_seconds, frames: still.collect() };
        let found = Accelerations::learn(&[Clip { frame_seconds, frames }]).unwrap();
        // One of two arms swings, about one of two axes.
        assert!((found.forearm / (q / 2.0) - 1.0).abs() < 0.12, "{found:?}");
        let still = Accelerations::learn(&[still]).unwrap();
        for least in [found.root, found.calf, found.upper_arm, still.forearm] {
            assert!((least - LEAST).abs() < 1e-9, "{found:?} {still:?}");
        }
        assert!(Accelerations::learn(&[]).is_none());
        let names = ["left forearm", "right foot", "torso", "neck", "right clavicle"];
        let of_limb = Accelerations { foot: 2.0, pelvis: 3.0, chest: 4.0, ..found };
        assert_eq!(names.map(|name| of_limb.of_limb(name)), [found.forearm, 2.0, 3.0, 4.0, 4.0]);
    }
}
