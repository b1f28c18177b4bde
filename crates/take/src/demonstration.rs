//! Demonstrations: the report's experiments, prepared so that the window shows them. They are takes made in memory,
//! with fits that the laboratory shows side by side, and a sentence or two that say what to look at.

mod occluded;
mod real;
mod take;

use backlit_formats::footage::DrawnPictures;
use backlit_lab::experiment::Simulation;
use backlit_lab::synthetic::{exercise, upper_body};
use backlit_tracking::fit::{DataView, FitOptions, Preset};
use backlit_tracking::render::Ramp;
use clap::ValueEnum;
use serde::{Deserialize, Serialize};

pub(crate) use take::joints_of;
pub use take::{SINGLE_LIMB_OFFSET_MM, single_limb_start};

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
    /// Limbs that silhouettes do not hold, and keypoints that do.
    #[serde(rename = "cues")]
    #[value(name = "cues")]
    Cues,
    /// A body of spheres, carved from silhouettes.
    #[serde(rename = "spheres")]
    #[value(name = "spheres")]
    Spheres,
    /// Different motions that are called by their names.
    #[serde(rename = "motions")]
    #[value(name = "motions")]
    Motions,
    /// Ways to begin from a start that is far off.
    #[serde(rename = "begin")]
    #[value(name = "begin")]
    Begin,
}

struct DemonstrationData {
    which: Demonstration,
    name: &'static str,
    preset: Preset,
    used_cameras: usize,
    explanation: &'static str,
}

/// In the order of [`Demonstration`].
const DEMONSTRATIONS: [DemonstrationData; 11] = [
    DemonstrationData {
        which: Demonstration::SingleLimb,
        name: "Fig. 5.1: one limb",
        preset: Preset::Report,
        used_cameras: 1,
        explanation: "One limb, seen from the side, begins 10 cm off along its axis. At the cylinder’s flat ends hardly \
             a pixel pulls along the axis, so it stays. The capsule and the sphere tree have a whole band of \
             such pixels, so they reach the true place.",
    },
    DemonstrationData {
        which: Demonstration::OneCamera,
        name: "Fig. 5.2: one camera",
        preset: Preset::Report,
        used_cameras: 1,
        explanation: "Only camera 1 counts. The cost falls with every renderer, and in camera 1 the fit looks good. \
             These pictures are of camera 2, which does not count: the limbs are off in depth, which one \
             camera cannot see. Let it count, and they reach the truth.",
    },
    DemonstrationData {
        which: Demonstration::TwoCameras,
        name: "Fig. 5.3: two cameras",
        preset: Preset::Report,
        used_cameras: 2,
        explanation: "The same start as with one camera, but both cameras count: the joints reach the truth. They do \
             not from every start: backlit experiment fig5.3 tries a hundred. The report’s cost falls \
             steadily; the robust preset begins wide and ends sharp.",
    },
    DemonstrationData {
        which: Demonstration::Sequence,
        name: "Fig. 5.5, simulated: a sequence",
        preset: Preset::Robust,
        used_cameras: 2,
        explanation: "50 simulated frames of silhouettes in two cameras, as large as the report’s real ones. Here is \
             the first frame, fitted as in 2004 and by the robust preset. Track all frames with either; N goes \
             to the worst ones.",
    },
    DemonstrationData {
        which: Demonstration::TinySequence,
        name: "Fig. 5.6, simulated: tiny pictures",
        preset: Preset::Robust,
        used_cameras: 2,
        explanation: "The same 50 simulated frames in pictures of 48 × 36 pixels. An arm is only two pixels wide here, \
             and the fit has nothing else to go by. Here is the first frame; track all of them.",
    },
    DemonstrationData {
        which: Demonstration::RealFootage,
        name: "Figs. 5.4 and 5.5: real footage",
        preset: Preset::Report,
        used_cameras: 2,
        explanation: "A person on a beam, two cameras, 144 × 192 pixels, 50 frames: as in section 5.2 of the report. \
             Here is the first frame, as in Fig. 5.4; the arrow keys go through the steps. Track all frames \
             for Fig. 5.5, where each frame begins at the pose of the one before, and then track with Robust.",
    },
    DemonstrationData {
        which: Demonstration::Bias,
        name: "Bias of a ramp",
        preset: Preset::Report,
        used_cameras: 1,
        explanation: "Only camera 1 counts, and every fit began at the true pose: without bias it would stay there. The \
             thesis ramp is half grey outside the limb’s surface, so its cost is lower where the body is \
                 farther away. These pictures of camera 2 show how far it went. Ramps that are half grey on the surface stay \
             nearer.",
    },
    DemonstrationData {
        which: Demonstration::Cues,
        name: "Section 6.3: cues under occlusion",
        preset: Preset::Robust,
        used_cameras: 2,
        explanation: "Squats before two phones, 37° apart, with the arms towards them. In front of the trunk an arm has \
             no outline of its own, so silhouettes alone lose it while the overlap stays high. Keypoints of \
             another tool, or the pictures themselves, hold it. Limbs that a cue holds are outlined in teal, \
             limbs that nothing holds in dashed red. Point at a limb to read what held it.",
    },
    DemonstrationData {
        which: Demonstration::Spheres,
        name: "Section 6.5: a body of spheres",
        preset: Preset::Robust,
        used_cameras: 4,
        explanation: "A clothed person before four cameras, in twelve known poses. Capsules cannot follow a shirt or \
             shoes. Here each limb is carved from all silhouettes and filled with nested spheres, which are \
             moved until they fit. Each is drawn as a circle in the colour of its limb. The Renderer section \
             on the right has the levels of the trees; the coarse ones are for small pictures.",
    },
    DemonstrationData {
        which: Demonstration::Motions,
        name: "Section 6.6: motions recognised",
        preset: Preset::Robust,
        used_cameras: exercise::MOST_CAMERAS,
        explanation: "Somebody walks in, squats, signals with the arms and boxes before three cameras. The silhouettes are \
             tracked as this opens, and the timeline’s lowest lane says what the motion is called. The Motions tile \
             shows why: the motion is a curve among the regions of known motions; click it to go to a moment. Hidden \
             Markov models alone see a jump between squats and signals: choose the method there.",
    },
    DemonstrationData {
        which: Demonstration::Begin,
        name: "Section 6.4: three ways to begin",
        preset: Preset::Robust,
        used_cameras: 2,
        explanation: "The start is 30° off in every joint and 15 cm off its place. The fit of 2004 and the softened ramp go \
             downhill into a wrong minimum. A particle filter and the program’s own search find the pose; templates, which \
             need no start, put an arm wrong and never take it back. Choose a way at the right and play its steps.",
    },
];

impl Demonstration {
    /// All of them, in the order of the menu.
    pub const ALL: [Self; 11] = {
        let mut all = [Self::SingleLimb; 11];
        let mut index = 0;
        while index < all.len() {
            all[index] = DEMONSTRATIONS[index].which;
            index += 1;
        }
        all
    };

    const fn data(self) -> &'static DemonstrationData {
        &DEMONSTRATIONS[self as usize]
    }

    /// What its take is called.
    pub const fn name(self) -> &'static str {
        self.data().name
    }

    /// What is shown, and what to look at and to try.
    pub const fn explanation(self) -> &'static str {
        self.data().explanation
    }

    /// How many of the take's cameras count, from the first on.
    pub const fn used_cameras(self) -> usize {
        self.data().used_cameras
    }

    /// The choices that the take begins with.
    pub fn fit(self) -> FitOptions {
        if self == Self::Bias {
            return upper_body::least_cost_fit(Ramp::Thesis, DataView::Hard);
        }
        FitOptions::preset(self.data().preset)
    }

    /// Whether it can be shown here: the real footage does not come with the program.
    pub fn is_available(self) -> bool {
        self != Self::RealFootage || real::is_there()
    }

    /// What its pictures are: grey levels D as they are, or masks.
    pub const fn simulation(self) -> Simulation {
        match self {
            Self::SingleLimb | Self::OneCamera | Self::TwoCameras => Simulation::Prediction,
            _ => Simulation::Mask,
        }
    }

    /// What its pictures are; `None` for footage with masks beside it.
    pub fn drawn(self) -> Option<DrawnPictures> {
        let drawn = match self.simulation() {
            Simulation::Prediction => DrawnPictures::GreyLevels,
            Simulation::Mask => DrawnPictures::Masks,
        };
        (self != Self::Cues).then_some(drawn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_command_line_say_the_same_word() {
        for (demonstration, data) in Demonstration::ALL.into_iter().zip(&DEMONSTRATIONS) {
            let in_files = serde_json::to_value(demonstration).unwrap();
            let on_the_line = demonstration.to_possible_value().unwrap();
            assert_eq!(in_files, on_the_line.get_name());
            assert_eq!(demonstration.name(), data.name, "the table is in the order of the type");
        }
    }

    #[test]
    fn the_choices_are_valid() {
        for demonstration in Demonstration::ALL {
            demonstration.fit().check().unwrap();
        }
        assert_eq!(Demonstration::Bias.fit().stages[0].ramp, Ramp::Thesis);
    }
}
