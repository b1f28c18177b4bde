//! What the fit found, in words.

use backlit_tracking::search::Origin;

/// Where a pose comes from, for the middle of a line.
pub(crate) fn origin(origin: &Origin) -> String {
    match origin {
        Origin::Start => "the start".to_owned(),
        Origin::Trunk => "trunk turned or moved".to_owned(),
        Origin::TurnedRound => "turned round".to_owned(),
        Origin::Hull => "from the visual hull".to_owned(),
        Origin::Chain { limb } => format!("{limb} searched"),
        Origin::Pair { limbs: [one, other] } => format!("{one} and {other} searched"),
    }
}
