//! The models that come with the program, embedded from `assets/`.

use super::{Model, ModelSpec};

/// Names of the built-in models, as `--model` takes them.
pub const NAMES: [&str; 3] = ["single_limb", "upper_body", "full_body"];

/// Their files, in the same order.
const TEXTS: [&str; 3] = [
    include_str!("../../../../assets/single_limb.toml"),
    include_str!("../../../../assets/upper_body.toml"),
    include_str!("../../../../assets/full_body.toml"),
];

/// The text of a built-in model file, by its name.
pub fn text(name: &str) -> Option<&'static str> {
    NAMES.iter().position(|known| *known == name).map(|index| TEXTS[index])
}

/// One limb, as in the report's Fig. 5.1.
pub fn single_limb() -> Model {
    parse(TEXTS[0])
}

/// The report's upper body: five chains, twelve limbs, eight rotations.
pub fn upper_body() -> Model {
    parse(TEXTS[1])
}

/// Limbs of the full body whose second joints tools of keypoints see (COCO's shoulders, elbows, wrists, hips, knees and ankles).
pub const KEYPOINT_LIMBS: [&str; 12] = [
    "left clavicle",
    "right clavicle",
    "left upper arm",
    "right upper arm",
    "left forearm",
    "right forearm",
    "left hip",
    "right hip",
    "left lower thigh",
    "right lower thigh",
    "left lower calf",
    "right lower calf",
];

/// A whole adult: thirty limbs on fifteen rotations.
pub fn full_body() -> Model {
    parse(TEXTS[2])
}

/// The built-in body that calls itself so ([`Model::name`]).
pub fn of_name(name: &str) -> Option<Model> {
    TEXTS.map(parse).into_iter().find(|model| model.name() == name)
}

fn parse(text: &str) -> Model {
    #[expect(clippy::expect_used, reason = "embedded files are checked by a test")]
    let spec: ModelSpec = toml::from_str(text).expect("a built-in model is TOML");
    #[expect(clippy::expect_used, reason = "embedded files are checked by a test")]
    Model::new(&spec).expect("a built-in model is valid")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_models_are_valid() {
        let sizes: Vec<(usize, usize)> = [single_limb(), upper_body(), full_body()]
            .iter()
            .map(|model| (model.limbs().len(), model.rotation_count()))
            .collect();
        assert_eq!(sizes, [(1, 1), (12, 8), (30, 15)]);
    }

    #[test]
    fn the_full_body_is_symmetric() {
        let body = full_body();
        for (index, limb) in body.limbs().iter().enumerate() {
            let other = &body.limbs()[body.mirrored_limb(index)];
            assert_eq!((limb.length, limb.radius), (other.length, other.radius), "{}", limb.name);
            assert_eq!(other.direction.y, limb.direction.y, "{}", limb.name);
            let expected = if limb.name == other.name { limb.direction.x } else { -limb.direction.x };
            assert_eq!(other.direction.x, expected, "{}", limb.name);
        }
    }
}
