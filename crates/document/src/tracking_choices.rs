//! How frames are followed: how motion is carried on, and when other poses are looked for.

use backlit_tracking::cues::Cue;
use backlit_tracking::fit::Preset;
use backlit_tracking::track::{KalmanOptions, Motion, WhenToSearch};
use serde::{Deserialize, Serialize};

/// How motion is carried from frame to frame.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Following {
    /// A frame's fit starts from the last pose.
    Still,
    /// It starts where the motion between the last two frames leads.
    #[default]
    Velocity,
    /// Pose and velocity by the iterated extended Kalman filter.
    Kalman,
    /// The same, but a frame's fit begins at the prediction and carries it from its first iteration.
    Steered,
    /// As [`Kalman`](Self::Kalman), and at the end every frame is smoothed by later ones.
    Smoothed {
        /// How many later frames count; all of them where `None`.
        lag: Option<usize>,
    },
}

impl Following {
    /// All of them by their words, with what each does; smoothed is by all later frames.
    pub const NAMED: [(&'static str, &'static str, Self); 5] = [
        ("still", "Start from the last pose", Self::Still),
        ("velocity", "Start where the motion between the last two frames leads", Self::Velocity),
        (
            "kalman",
            "Pose and velocity by the iterated extended Kalman filter, weighed against each frame's own fit",
            Self::Kalman,
        ),
        (
            "steered",
            "The same, but every fit begins at the prediction and carries it from the first iteration",
            Self::Steered,
        ),
        (
            "smoothed",
            "As kalman, and earlier frames smoothed by later ones at the end",
            Self::Smoothed { lag: None },
        ),
    ];

    /// Its word.
    #[must_use]
    pub fn name(self) -> &'static str {
        let kind = |other: &Self| std::mem::discriminant(other) == std::mem::discriminant(&self);
        Self::NAMED.iter().find(|(.., other)| kind(other)).map_or("", |(name, ..)| name)
    }

    /// What the tracker is told.
    pub fn motion(self) -> Motion {
        match self {
            Self::Still => Motion::Still,
            Self::Velocity => Motion::Velocity,
            Self::Steered => Motion::Kalman(KalmanOptions { steers: true, ..KalmanOptions::default() }),
            Self::Kalman | Self::Smoothed { .. } => Motion::Kalman(KalmanOptions::default()),
        }
    }
}

/// What the tracker does at a key pose on its way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AtKeys {
    /// The pose stays as it was set, and the track goes on from it.
    #[default]
    Keep,
    /// The fit of its frame begins there.
    Refine,
    /// The track ends before it.
    Stop,
}

/// The body that is tracked where a take has an average one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrackedBody {
    /// The person's own sizes are found first.
    #[default]
    Own,
    /// The body stays as it is.
    AsItIs,
}

/// What else pulls at limbs that the silhouettes do not hold.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CueChoice {
    /// Nothing: silhouettes alone.
    #[default]
    None,
    /// The take's keypoints of another tool.
    Keypoints,
    /// Optic flow and stereo points of the pictures.
    Pictures,
    /// All of these.
    All,
}

impl CueChoice {
    /// The cues that it stands for. Edges do more harm than good (docs/chapter6.md) and are in none.
    pub const fn cues(self) -> &'static [Cue] {
        match self {
            Self::None => &[],
            Self::Keypoints => &[Cue::Keypoints],
            Self::Pictures => &[Cue::Flow, Cue::Stereo],
            Self::All => &[Cue::Keypoints, Cue::Flow, Cue::Stereo],
        }
    }

    /// Whether the cameras' pictures are looked at.
    pub fn wants_pictures(self) -> bool {
        matches!(self, Self::Pictures | Self::All)
    }
}

/// The prior learnt from motion that pulls at tracked poses, where the fit has none of its own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrackPrior {
    /// Silhouettes alone.
    #[default]
    None,
    /// The prior that comes with the program.
    People,
}

/// All choices of a run of the tracker, besides those of a frame's fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackingChoices {
    /// How motion is carried on.
    pub motion: Following,
    /// When other poses than the one downhill are looked for.
    pub search: WhenToSearch,
    /// What becomes of key poses on the way.
    #[serde(default)]
    pub at_keys: AtKeys,
    /// Whether the person's own sizes are found first.
    #[serde(default)]
    pub body: TrackedBody,
    /// What else pulls at limbs that the silhouettes do not hold.
    #[serde(default)]
    pub cues: CueChoice,
    /// Whether likely poses pull.
    #[serde(default)]
    pub prior: TrackPrior,
}

impl TrackingChoices {
    /// What goes with a preset: the report begins every frame at the last pose and never looks for others; everything
    /// else carries the motion on, looks where a fit is poor, and has the prior of likely poses.
    pub fn of_preset(preset: Option<Preset>) -> Self {
        let (motion, search, prior) = match preset {
            Some(Preset::Report) => (Following::Still, WhenToSearch::Never, TrackPrior::None),
            _ => (Following::default(), WhenToSearch::WhenPoor, TrackPrior::People),
        };
        let (at_keys, body, cues) = Default::default();
        Self { motion, search, at_keys, body, cues, prior }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_follow_as_the_core_says() {
        for preset in Preset::ALL.map(Some).into_iter().chain([None]) {
            assert_eq!(TrackingChoices::of_preset(preset).motion.motion(), Motion::of_preset(preset));
        }
    }

    #[test]
    fn choices_are_read_back() {
        for motion in [
            Following::Still,
            Following::Kalman,
            Following::Steered,
            Following::Smoothed { lag: None },
            Following::Smoothed { lag: Some(7) },
        ] {
            let (search, at_keys, body) = (WhenToSearch::Always, AtKeys::Stop, TrackedBody::AsItIs);
            let (cues, prior) = (CueChoice::Pictures, TrackPrior::People);
            let choices = TrackingChoices { motion, search, at_keys, body, cues, prior };
            let text = serde_json::to_string(&choices).unwrap();
            assert_eq!(serde_json::from_str::<TrackingChoices>(&text).unwrap(), choices, "{text}");
        }
        assert!(serde_json::from_str::<TrackingChoices>(r#"{"motion": "still", "search": "now"}"#).is_err());
    }
}
