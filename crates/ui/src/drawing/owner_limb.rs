//! The limb that wins each pixel: one hue a chain, darker with each joint outwards, faded by the ramp.

use backlit_tracking::body::Model;
use backlit_tracking::render::prediction::NO_OWNER;
use egui::{Color32, ColorImage};

use super::PictureInput;
use super::tinted::mix;
use crate::style::format;
use crate::style::theme::data_colours::{PICTURE_GROUND, limb_colour};

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
    let places = chain_places(model);
    model.limbs().iter().map(|limb| limb_colour(places[limb.rotation].0, places[limb.rotation].1)).collect()
}

/// What people call the chains of a model, each with the colour of its first limb: "Right arm".
pub fn limb_chains(model: &Model) -> Vec<(String, Color32)> {
    const NAMES: [(&str, &str); 6] = [
        ("clavicle", "arm"),
        ("shoulder", "arm"),
        ("upper arm", "arm"),
        ("hip", "leg"),
        ("thigh", "leg"),
        ("neck", "head"),
    ];
    let places = chain_places(model);
    let firsts = model.rotations_parents_first().iter().filter(|rotation| places[**rotation].1 == 0);
    let name = |rotation: &usize| {
        let limb = model.limbs()[model.rotation_owners()[*rotation]].name.as_str();
        let part = NAMES.iter().find_map(|(part, chain)| Some((limb.strip_suffix(part)?, *chain)));
        let name = part.map_or_else(|| limb.to_owned(), |(side, chain)| format!("{side}{chain}"));
        format::capitalised(&name)
    };
    firsts.map(|rotation| (name(rotation), limb_colour(places[*rotation].0, 0))).collect()
}

/// Chain and place in it of each rotation.
fn chain_places(model: &Model) -> Vec<(usize, usize)> {
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
    places
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin::full_body;

    use super::*;

    #[test]
    fn chains_are_called_what_people_call_them() {
        let names: Vec<String> = limb_chains(&full_body()).into_iter().map(|(name, _)| name).collect();
        for name in ["Spine", "Chest", "Head", "Right arm", "Left arm", "Right leg", "Left leg"] {
            assert!(names.contains(&name.to_owned()), "{name} of {names:?}");
        }
        assert_eq!(names.len(), 7);
    }

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
