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

/// What starts are made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StartParts<'a> {
    /// The body.
    pub(crate) model: &'a Model,
    /// The pose on the screen.
    pub(crate) shown: &'a Pose,
    /// The pose that the take begins with.
    pub(crate) take: &'a Pose,
    /// The demonstration that is open, and the frame.
    pub(crate) demonstration: Option<(Demonstration, usize)>,
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

    /// Its words in the box.
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

    pub(crate) fn pose(self, parts: &StartParts<'_>) -> Pose {
        match self {
            Self::Shown => parts.shown.clone(),
            Self::Take => parts.take.clone(),
            Self::Slid { mm } => single_limb_start(f64::from(mm) / 1000.0),
            Self::Turned { degrees } => {
                let truth = parts.demonstration.and_then(|(which, frame)| which.truth(frame));
                let from = truth.as_ref().unwrap_or(parts.shown);
                perturb(parts.model, from, f64::from(degrees).to_radians(), ROOT_OFF_M, SEED)
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
            let parts = StartParts {
                model: &model,
                shown: &rest,
                take: &rest,
                demonstration: demonstration.map(|which| (which, 3)),
            };
            let offered = StartChoice::offered(demonstration);
            assert!(offered.contains(&StartChoice::of(demonstration)));
            for choice in offered {
                choice.pose(&parts).check(&model).unwrap();
            }
        }
    }

    #[test]
    fn a_turned_start_is_that_far_from_the_truth() {
        let model = builtin::upper_body();
        let rest = Pose::rest(&model);
        let which = Demonstration::TwoCameras;
        let parts = StartParts { model: &model, shown: &rest, take: &rest, demonstration: Some((which, 0)) };
        let off = StartChoice::Turned { degrees: 10 }.pose(&parts).local(&which.truth(0).unwrap());
        let angle = glam::DVec3::from_slice(&off[3..6]).length();
        assert!((angle.to_degrees() - 10.0).abs() < 1e-9);
    }
}
