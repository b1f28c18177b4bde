//! The joints of a body, and what people call them.
//!
//! A joint is the second joint of a limb; the root is its own.

use backlit_tracking::body::Model;
use serde::{Deserialize, Serialize};

/// A joint of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JointId {
    /// Where the chains grow from.
    #[default]
    Root,
    /// The second joint of the limb of this index.
    End(usize),
}

impl From<Option<usize>> for JointId {
    /// The joint at the end of a limb; `None` is the root.
    fn from(limb: Option<usize>) -> Self {
        limb.map_or(Self::Root, Self::End)
    }
}

/// What people call the end of a limb, by the limb's name; other limbs' joints are "end of …".
pub fn joint_name(model: &Model, joint: JointId) -> String {
    const NAMES: [(&str, &str); 13] = [
        ("spine", "waist"),
        ("chest", "neck"),
        ("torso", "neck"),
        ("neck", "head"),
        ("head", "head"),
        ("clavicle", "shoulder"),
        ("shoulder", "shoulder"),
        ("upper arm", "elbow"),
        ("forearm", "wrist"),
        ("hip", "hip"),
        ("thigh", "knee"),
        ("calf", "ankle"),
        ("foot", "toes"),
    ];
    let limb = match joint {
        JointId::Root => return "root".to_owned(),
        JointId::End(limb) => model.limbs().get(limb).map_or("", |limb| limb.name.as_str()),
    };
    let (side, part) = ["right ", "left "]
        .into_iter()
        .find_map(|side| limb.strip_prefix(side).map(|part| (side, part)))
        .unwrap_or(("", limb));
    let part = part.strip_prefix("lower ").unwrap_or(part);
    match NAMES.iter().find(|(name, _)| *name == part) {
        Some((_, joint)) => format!("{side}{joint}"),
        None => format!("end of {limb}"),
    }
}
