//! The view modes of a camera's picture, how two of them are compared, and the coefficient whose Jacobian column is
//! shown.

use backlit_tracking::body::Parameters;
use egui::Color32;
use serde::{Deserialize, Serialize};

use crate::style::theme::data_colours::{
    AGREEMENT, MISSING, NO_GRADIENT, REPORT_BOTH, REPORT_DATA, REPORT_MODEL, SHADOW, SPURIOUS, UNKNOWN,
};

/// What a camera's tile shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ViewMode {
    /// The frame as it is.
    Footage,
    /// The measurement D.
    Data,
    /// The prediction Λ.
    Prediction,
    /// Data black, model white, both grey.
    ReportOverlay,
    /// Agreement, missing and spurious as tints over dimmed footage.
    #[default]
    Tinted,
    /// D − Λ in two hues.
    Residual,
    /// The limb that owns each pixel.
    OwnerLimb,
    /// How strongly each pixel pulls at its limb.
    Gradient,
    /// How each pixel changes with one coefficient of the pose.
    JacobianColumn,
}

/// What is beside the picture, or under it, to read its colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Legend {
    /// The picture explains itself.
    None,
    /// Swatches with a word each.
    Entries(&'static [LegendEntry]),
    /// The chains of the body in their colours: see [`limb_chains`](super::limb_chains).
    Chains,
    /// The residual's map, from −255 to 255.
    ResidualMap,
    /// The gradient's map, from zero to the scale of [`PictureInput::gradient`](super::PictureInput::gradient).
    GradientMap,
    /// The residual's map over ± the scale of [`PictureInput::jacobian`](super::PictureInput::jacobian).
    JacobianMap,
}

/// A swatch and its word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegendEntry {
    /// What the swatch stands for.
    pub text: &'static str,
    /// How it looks in the picture.
    pub swatch: Swatch,
}

/// How something looks in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Swatch {
    /// One colour.
    Fill(Color32),
    /// The don't-know hatch.
    Hatch(Color32),
    /// The hatch of shadows.
    Shadow(Color32),
    /// The hatch of no gradient.
    NoGradient(Color32),
    /// The line of an ellipse.
    Ring(Color32),
    /// Words only.
    None,
}

const fn fill(text: &'static str, colour: Color32) -> LegendEntry {
    LegendEntry { text, swatch: Swatch::Fill(colour) }
}

const UNKNOWN_ENTRY: LegendEntry = LegendEntry { text: "Don’t know", swatch: Swatch::Hatch(UNKNOWN) };
const SHADOW_ENTRY: LegendEntry = LegendEntry { text: "Shadow", swatch: Swatch::Shadow(SHADOW) };
/// Pixels in the subject's shadow, and those of which the data says nothing.
pub const UNKNOWN_LEGEND: &[LegendEntry] = &[SHADOW_ENTRY, UNKNOWN_ENTRY];
const DATA_LEGEND: &[LegendEntry] =
    &[fill("Subject 0", Color32::BLACK), fill("Background 255", Color32::WHITE), SHADOW_ENTRY, UNKNOWN_ENTRY];
const PREDICTION_LEGEND: &[LegendEntry] =
    &[fill("Body 0", Color32::BLACK), fill("Background 255", Color32::WHITE)];
const REPORT_LEGEND: &[LegendEntry] = &[
    fill("Data only", Color32::from_gray(REPORT_DATA)),
    fill("Model only", Color32::from_gray(REPORT_MODEL)),
    fill("Both", Color32::from_gray(REPORT_BOTH)),
    SHADOW_ENTRY,
    UNKNOWN_ENTRY,
];
const TINTED_LEGEND: &[LegendEntry] = &[
    fill("Agreement", AGREEMENT),
    fill("Missing", MISSING),
    fill("Spurious", SPURIOUS),
    SHADOW_ENTRY,
    UNKNOWN_ENTRY,
];
/// Pixels of the ramp that pull at nothing.
pub const NO_PULL_LEGEND: &[LegendEntry] =
    &[LegendEntry { text: "No pull", swatch: Swatch::NoGradient(NO_GRADIENT) }];
/// Pixels of the ramp that the coefficient does not change.
pub const NO_CHANGE_LEGEND: &[LegendEntry] =
    &[LegendEntry { text: "No change", swatch: Swatch::NoGradient(NO_GRADIENT) }];

impl ViewMode {
    /// All modes, in the order of the menu.
    pub const ALL: [Self; 9] = [
        Self::Footage,
        Self::Data,
        Self::Prediction,
        Self::ReportOverlay,
        Self::Tinted,
        Self::Residual,
        Self::OwnerLimb,
        Self::Gradient,
        Self::JacobianColumn,
    ];

    /// The name in menus and headers.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Footage => "Footage",
            Self::Data => "Data",
            Self::Prediction => "Prediction",
            Self::ReportOverlay => "Report overlay",
            Self::Tinted => "Tinted overlay on footage",
            Self::Residual => "Residual",
            Self::OwnerLimb => "Owner limb",
            Self::Gradient => "Gradient",
            Self::JacobianColumn => "Jacobian column",
        }
    }

    /// The name where there is little room.
    pub const fn short_label(self) -> &'static str {
        match self {
            Self::ReportOverlay => "Report",
            Self::Tinted => "Tinted",
            Self::OwnerLimb => "Owner",
            Self::JacobianColumn => "Jacobian",
            _ => self.label(),
        }
    }

    /// The letter of its shortcut.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Footage => "O",
            Self::Data => "D",
            Self::Prediction => "M",
            Self::ReportOverlay => "V",
            Self::Tinted => "T",
            Self::Residual => "R",
            Self::OwnerLimb => "L",
            Self::Gradient => "G",
            Self::JacobianColumn => "J",
        }
    }

    /// What it shows, in a sentence.
    pub const fn tooltip(self) -> &'static str {
        match self {
            Self::Footage => "The frame as it was filmed.",
            Self::Data => "The measurement D: black is subject, white is background, hatched is don’t know.",
            Self::Prediction => "The prediction Λ of the model: black is subject, white is background.",
            Self::ReportOverlay => {
                "Data black, model white, as in the report: the picture goes quiet where both agree."
            }
            Self::Tinted => "Orange is subject the body misses, blue is body without subject.",
            Self::Residual => {
                "D − Λ on a fixed scale: orange is missing, blue is spurious, dark is agreement."
            }
            Self::OwnerLimb => "The limb that wins each pixel: one hue a chain, darker outwards.",
            Self::Gradient => {
                "How strongly each pixel pulls at its limb; hatched pixels of the ramp do not pull."
            }
            Self::JacobianColumn => {
                "How each pixel changes as the selected joint turns; hatched pixels of the ramp do not change."
            }
        }
    }

    /// How to read it, for somebody who sees it for the first time.
    pub const fn explanation(self) -> &'static str {
        match self {
            Self::Footage => {
                "The frame as it was filmed. The white line is the outline of the body in its pose."
            }
            Self::Data => {
                "What was measured: the silhouette of the subject, in grey levels. 0, black, is subject; 255, white, is \
                 background; grey is the edge between them. Of hatched pixels nobody knows: they weigh nothing."
            }
            Self::Prediction => {
                "What the model predicts for this pose, in grey levels. 0, black, is body; 255, white, is background; \
                 grey is the ramp at its edge, which tells the fit where to go."
            }
            Self::ReportOverlay => {
                "Data and model in one picture, as the report of 2004 printed it: black is subject that the body does \
                 not cover, white is body without subject. Where both agree it is a quiet grey."
            }
            Self::Tinted => {
                "Grey: subject and body agree. Orange, missing: subject that the body does not cover. Blue, spurious: \
                 body where there is no subject. Counts are pixels. Of hatched pixels nobody knows: they do not count."
            }
            Self::Residual => {
                "Data minus prediction, D − Λ, from −255 to 255 grey levels. Orange, missing: subject that the body \
                 does not cover. Blue, spurious: body without subject. Dark: no error. The fit makes the sum of the \
                 squares small. Hatched pixels weigh nothing."
            }
            Self::OwnerLimb => {
                "The limb that decides each pixel: a hue for each chain of limbs, darker from joint to joint outwards. \
                 The card at the pointer names the limb."
            }
            Self::Gradient => {
                "How strongly each pixel pulls at its limb: by how many grey levels it changes when the limb moves a \
                 metre towards it. Only the ramp at the body’s edge pulls; what is hatched is on it and does not."
            }
            Self::JacobianColumn => {
                "How each pixel changes with one number of the pose: grey levels for a turn of one radian of the \
                 selected limb, or for a move of one metre of the body. Orange becomes darker, more body; blue becomes \
                 lighter. J again: the next axis."
            }
        }
    }

    /// How to read its colours.
    pub const fn legend(self) -> Legend {
        match self {
            Self::Footage => Legend::None,
            Self::Data => Legend::Entries(DATA_LEGEND),
            Self::Prediction => Legend::Entries(PREDICTION_LEGEND),
            Self::ReportOverlay => Legend::Entries(REPORT_LEGEND),
            Self::Tinted => Legend::Entries(TINTED_LEGEND),
            Self::Residual => Legend::ResidualMap,
            Self::OwnerLimb => Legend::Chains,
            Self::Gradient => Legend::GradientMap,
            Self::JacobianColumn => Legend::JacobianMap,
        }
    }

    /// Whether the body's outline is drawn on it: not where the colours are the model's own.
    pub const fn has_outline(self) -> bool {
        matches!(self, Self::Footage | Self::Data | Self::Tinted | Self::Residual)
    }
}

/// How a second view mode is seen in the same picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeComparison {
    /// Side by side: the tile's own mode is left of a handle, the other one right of it.
    Wipe,
    /// One after the other.
    Blink,
}

/// A coefficient of the tangent state: a turn of the selected limb, or a move of the root.
///
/// A turn ω is made as q ← exp(ω) q, so its axes are those of the frame in which the limb's rotation stands: its
/// parent's. The root moves along the axes of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StateAxis {
    /// A turn about the x axis.
    #[default]
    TurnX,
    /// A turn about the y axis.
    TurnY,
    /// A turn about the z axis.
    TurnZ,
    /// A move of the root along the x axis.
    RootX,
    /// A move of the root along the y axis.
    RootY,
    /// A move of the root along the z axis.
    RootZ,
}

impl StateAxis {
    /// All axes, in the order of the menu.
    pub const ALL: [Self; 6] = [Self::TurnX, Self::TurnY, Self::TurnZ, Self::RootX, Self::RootY, Self::RootZ];

    /// The name in menus.
    pub const fn label(self) -> &'static str {
        const LABELS: [&str; 6] =
            ["Turn about x", "Turn about y", "Turn about z", "Root along x", "Root along y", "Root along z"];
        LABELS[self as usize]
    }

    /// The name where there is little room.
    pub const fn short_label(self) -> &'static str {
        ["turn x", "turn y", "turn z", "root x", "root y", "root z"][self as usize]
    }

    /// What the column is divided by: radian or metre.
    pub const fn unit(self) -> &'static str {
        if self.is_of_root() { "m" } else { "rad" }
    }

    /// Whether it moves the root, whatever is selected.
    pub const fn is_of_root(self) -> bool {
        matches!(self, Self::RootX | Self::RootY | Self::RootZ)
    }

    /// The column of the tangent state, for the limb with this rotation.
    pub fn column(self, rotation: usize) -> usize {
        let axis = self as usize % 3;
        if self.is_of_root() { axis } else { Parameters::Tangent.first_column(rotation) + axis }
    }

    /// The next of the three axes of the same kind.
    pub const fn next(self) -> Self {
        let index = self as usize;
        Self::ALL[index / 3 * 3 + (index + 1) % 3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_keys_are_unique_and_written_in_kebab_case() {
        for (index, mode) in ViewMode::ALL.iter().enumerate() {
            for other in &ViewMode::ALL[..index] {
                assert_ne!(mode.label(), other.label());
                assert_ne!(mode.key(), other.key());
            }
            let text = serde_json::to_string(mode).unwrap();
            assert_eq!(serde_json::from_str::<ViewMode>(&text).unwrap(), *mode);
        }
        assert_eq!(serde_json::to_string(&ViewMode::ReportOverlay).unwrap(), "\"report-overlay\"");
    }

    #[test]
    fn columns_are_those_of_the_tangent_state() {
        let columns: Vec<usize> = StateAxis::ALL.iter().map(|axis| axis.column(2)).collect();
        assert_eq!(columns, [9, 10, 11, 0, 1, 2]);
        for axis in StateAxis::ALL {
            assert_eq!(axis.next().next().next(), axis);
            assert_eq!(axis.next().unit(), axis.unit());
        }
    }
}
