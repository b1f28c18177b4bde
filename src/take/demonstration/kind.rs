//! Which demonstrations there are, their names and explanations.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// A demonstration, named in files and on the command line as its experiment is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ValueEnum)]
pub enum Demonstration {
    /// One limb seen from the side, three renderers.
    #[serde(rename = "fig5.1")]
    #[value(name = "fig5.1")]
    SingleLimb,
    /// The upper body before one camera.
    #[serde(rename = "fig5.2")]
    #[value(name = "fig5.2")]
    OneCamera,
    /// The same before two cameras.
    #[serde(rename = "fig5.3")]
    #[value(name = "fig5.3")]
    TwoCameras,
    /// A simulated sequence.
    #[serde(rename = "fig5.5")]
    #[value(name = "fig5.5")]
    Sequence,
    /// The same in tiny pictures.
    #[serde(rename = "fig5.6")]
    #[value(name = "fig5.6")]
    TinySequence,
    /// The real footage in the report's small pictures.
    #[serde(rename = "footage")]
    #[value(name = "footage")]
    RealFootage,
    /// Fits that begin at the truth, by ramp.
    #[serde(rename = "bias")]
    #[value(name = "bias")]
    Bias,
}

impl Demonstration {
    /// All of them, in the order of the menu.
    #[cfg(test)]
    pub(crate) const ALL: [Self; 7] = [
        Self::SingleLimb,
        Self::OneCamera,
        Self::TwoCameras,
        Self::Sequence,
        Self::TinySequence,
        Self::RealFootage,
        Self::Bias,
    ];

    /// What its take is called.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::SingleLimb => "Fig. 5.1: one limb",
            Self::OneCamera => "Fig. 5.2: one camera",
            Self::TwoCameras => "Fig. 5.3: two cameras",
            Self::Sequence => "Fig. 5.5, simulated: a sequence",
            Self::TinySequence => "Fig. 5.6, simulated: tiny pictures",
            Self::RealFootage => "Figs. 5.4 and 5.5: real footage",
            Self::Bias => "Bias of a ramp",
        }
    }

    /// Whether it can be shown here: the real footage does not come with the program.
    pub(crate) fn is_available(self) -> bool {
        self != Self::RealFootage || super::real::is_there()
    }

    /// What is shown, and what to look at and to try.
    pub(crate) const fn explanation(self) -> &'static str {
        match self {
            Self::SingleLimb => {
                "One limb, seen from the side, begins 10 cm off along its axis. The Demonstrate layout (F3) fits it \
                 with all three renderers at once. Here, press G: of the cylinder, hardly a pixel at its ends pulls \
                 along the axis; press C, and the capsule has a whole band of them."
            }
            Self::OneCamera => {
                "Only camera 1 counts. Its view fits and the cost falls, yet camera 2, which does not count, shows \
                 limbs that are off where one camera cannot see: in depth. To go on with both, tick \"Used in the \
                 fit\" in the menu at the right of camera 2's header and press Enter."
            }
            Self::TwoCameras => {
                "The same start as with one camera, and both count: the joints come home. The report's fit falls \
                 steadily; Levenberg-Marquardt on tangent steps is at the truth after a dozen. Not from every \
                 start: backlit experiment fig5.3 tries a hundred. Press Comma and Period to go through the steps."
            }
            Self::Sequence => {
                "50 simulated frames of silhouettes in two cameras, of the size of the report's real ones. Track \
                 forward follows them with the robust preset. Then choose Report 2004 as the preset, go to the first frame and track again: N leads to the \
                 worst frames."
            }
            Self::TinySequence => {
                "The same 50 simulated frames in pictures of 48 × 36 pixels. Track forward follows them; an arm is two \
                 pixels wide here, and that is all there is to go by."
            }
            Self::RealFootage => {
                "A person on a beam, two cameras, 144 × 192 pixels, 50 frames: what the report's section 5.2 had. Run \
                 the fit (Enter) and go through its steps with Comma and Period for Fig. 5.4; Track forward for Fig. \
                 5.5, where each frame begins at the last one's pose. Then choose Robust as the preset, go to the \
                 first frame and track again."
            }
            Self::Bias => {
                "Only camera 1 counts, and every run began at the true pose: without bias it would stay there. The \
                 thesis ramp is half grey outside the limb's surface, so its cost is less where the body is \
                 further away; camera 2 shows how far it went. Ramps that are half grey on the surface stay \
                 nearer: click a run to see where it ended."
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_command_line_say_the_same_word() {
        for demonstration in Demonstration::ALL {
            let in_files = serde_json::to_value(demonstration).unwrap();
            let on_the_line = demonstration.to_possible_value().unwrap();
            assert_eq!(in_files, on_the_line.get_name());
        }
    }
}
