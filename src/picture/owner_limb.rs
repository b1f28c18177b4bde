//! The limb that wins each pixel: one hue a chain, darker with each joint outwards, faded by the ramp.

use backlit_tracking::body::Model;
use backlit_tracking::render::prediction::NO_OWNER;
use egui::{Color32, ColorImage};

use super::PictureInput;
use super::tinted::mix;
use crate::theme::data_colours::{PICTURE_GROUND, limb_colour};

pub(super) fn compose(input: &PictureInput<'_>) -> ColorImage {
    input.map(|_, _, index| {
        let owner = input.prediction.map_or(NO_OWNER, |p| p.owner[index]);
        match input.limb_colours.get(usize::from(owner)) {
            Some(colour) => mix(PICTURE_GROUND, *colour, 1.0 - input.lambda(index).clamp(0.0, 255.0) / 255.0),
            None => PICTURE_GROUND,
        }
    })
}

/// A colour for each limb of a model. Limbs that turn together share one; a chain is a run of rotations
/// without a branch.
pub fn limb_colours(model: &Model) -> Vec<Color32> {
    let parents = model.rotation_parents();
    let mut places = vec![(0, 0); model.rotation_count()];
    let mut chains = 0;
    for &rotation in model.rotations_parents_first() {
        let siblings = parents.iter().filter(|parent| **parent == parents[rotation]).count();
        places[rotation] = match parents[rotation] {
            Some(parent) if siblings == 1 => (places[parent].0, places[parent].1 + 1),
            _ => {
                chains += 1;
                (chains - 1, 0)
            }
        };
    }
    model.limbs().iter().map(|limb| limb_colour(places[limb.rotation].0, places[limb.rotation].1)).collect()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin::full_body;

    use super::*;

    #[test]
    fn a_chain_keeps_its_hue_and_darkens() {
        let model = full_body();
        let colours = limb_colours(&model);
        let colour = |name: &str| colours[model.limb_index(name).unwrap()];
        assert_eq!(colour("right hand"), colour("right forearm"));
        assert_ne!(colour("right forearm"), colour("left forearm"));
        let brightness = |name: &str| colour(name).r().max(colour(name).g()).max(colour(name).b());
        assert!(brightness("right clavicle") > brightness("right upper arm"));
        assert!(brightness("right upper arm") > brightness("right forearm"));
    }
}
