//! The joints of a body, and what people call them.
//!
//! A joint is the second joint of a limb; the root is its own.

use backlit_tracking::body::{Model, joint_at_end};
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
    let limb = match joint {
        JointId::Root => return "root".to_owned(),
        JointId::End(limb) => model.limbs().get(limb).map_or("", |limb| limb.name.as_str()),
    };
    joint_at_end(limb).unwrap_or_else(|| format!("end of {limb}"))
}
