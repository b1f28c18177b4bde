//! Where all fits of a comparison begin.

use backlit_take::demonstration::{Demonstration, SINGLE_LIMB_OFFSET_MM, single_limb_start};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::search::start::perturb;

/// The root of a turned start is off by so much, metres.
const ROOT_OFF_M: f64 = 0.03;
/// Seed of the turned starts: the same one every time.
const SEED: u64 = 7;
/// Millimetres along the limb that are offered.
const SLIDES_MM: [u32; 5] = [30, 60, 100, 120, 200];
/// Degrees of every joint that are offered.
const TURNS_DEG: [u32; 4] = [3, 5, 10, 20];

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub(crate) enum StartChoice {
    /// The pose on the screen.
    #[default]
    Shown,
    /// The pose that the take begins with.
    Take,
    /// The single limb of Fig. 5.1, this many millimetres along its axis from the truth.
    Slid {
        /// Millimetres.
        mm: u32,
    },
    /// Every joint turned by this many degrees, each about an axis of its own, and the root moved by 3 cm: from the
    /// truth of a demonstration, else from the pose on the screen.
    Turned {
        /// Degrees.
        degrees: u32,
    },
}

impl StartChoice {
    /// What a demonstration begins with here: Fig. 5.1's own offset, else the pose on the screen.
    pub(crate) fn of(demonstration: Option<Demonstration>) -> Self {
        match demonstration {
            Some(Demonstration::SingleLimb) => Self::Slid { mm: SINGLE_LIMB_OFFSET_MM },
            _ => Self::Shown,
        }
    }

    /// The starts that are offered for a take.
    pub(crate) fn offered(demonstration: Option<Demonstration>) -> Vec<Self> {
        let mut all = vec![Self::Shown, Self::Take];
        if demonstration == Some(Demonstration::SingleLimb) {
            all = SLIDES_MM.map(|mm| Self::Slid { mm }).to_vec();
            all.push(Self::Shown);
        } else {
            all.extend(TURNS_DEG.map(|degrees| Self::Turned { degrees }));
        }
        all
    }

    pub(crate) fn text(self) -> String {
        match self {
            Self::Shown => "Start at shown pose".to_owned(),
            Self::Take => "Start of the take".to_owned(),
            Self::Slid { mm } => format!("Start {mm} mm off"),
            Self::Turned { degrees } => format!("Start {degrees}° off"),
        }
    }

    pub(crate) fn tooltip(self) -> String {
        match self {
            Self::Shown => "The pose of this frame, as the other layouts show it".to_owned(),
            Self::Take => "The pose that the take begins with".to_owned(),
            Self::Slid { mm } => format!("The true pose, {mm} mm along the limb"),
            Self::Turned { degrees } => format!(
                "Every joint turned by {degrees}° about an axis of its own, the root moved by 3 cm: from the truth \
                 of a demonstration, else from the shown pose"
            ),
        }
    }

    /// The pose, where these are the one on the screen, the one that the take begins with, and the true one of a
    /// demonstration.
    pub(crate) fn pose(
        self,
        model: &Model,
        shown: &Pose,
        take: &Pose,
        truth: impl FnOnce() -> Option<Pose>,
    ) -> Pose {
        match self {
            Self::Shown => shown.clone(),
            Self::Take => take.clone(),
            Self::Slid { mm } => single_limb_start(f64::from(mm) / 1000.0),
            Self::Turned { degrees } => {
                let from = truth().unwrap_or_else(|| shown.clone());
                perturb(model, &from, f64::from(degrees).to_radians(), ROOT_OFF_M, SEED)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn what_is_offered_can_be_begun_with() {
        let others = [None, Some(Demonstration::SingleLimb), Some(Demonstration::Sequence)];
        for demonstration in others {
            let model = match demonstration {
                Some(Demonstration::SingleLimb) => builtin::single_limb(),
                _ => builtin::upper_body(),
            };
            let rest = Pose::rest(&model);
            let offered = StartChoice::offered(demonstration);
            assert!(offered.contains(&StartChoice::of(demonstration)));
            for choice in offered {
                let truth = || demonstration.and_then(|which| which.truth(3));
                choice.pose(&model, &rest, &rest, truth).check(&model).unwrap();
            }
        }
    }

    #[test]
    fn a_turned_start_is_that_far_from_the_truth() {
        let model = builtin::upper_body();
        let rest = Pose::rest(&model);
        let truth = Demonstration::TwoCameras.truth(0).unwrap();
        let start = StartChoice::Turned { degrees: 10 }.pose(&model, &rest, &rest, || Some(truth.clone()));
        let off = start.local(&truth);
        let angle = glam::DVec3::from_slice(&off[3..6]).length();
        assert!((angle.to_degrees() - 10.0).abs() < 1e-9);
    }
}
