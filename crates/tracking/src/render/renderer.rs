//! The renderers: which solid stands for a limb.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::body::Limb;

/// Most spheres of one limb.
pub const MAX_SPHERES: usize = 1024;

/// The solid that stands for a limb (chapter 4 of the report), in the report's order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum RendererKind {
    /// A cylinder with flat ends.
    Cylinder,
    /// A cylinder with hemispherical ends.
    #[default]
    Capsule,
    /// Spheres along the axis: the limb's own, or this many equal ones (`None`: 1 + ⌈2s/r⌉).
    SphereTree {
        /// Equal spheres a limb.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        spheres: Option<usize>,
    },
}

impl RendererKind {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Capsule, Self::Cylinder, Self::SphereTree { spheres: None }];

    /// All of them, in the order of the report.
    pub fn in_report_order() -> [Self; Self::ALL.len()] {
        let mut all = Self::ALL;
        all.sort();
        all
    }

    /// All of these in a sentence: "a, b or c" with the word "or".
    pub fn listed(all: &[Self], word: &str, text: fn(Self) -> &'static str) -> String {
        let [before @ .., last] = all else { return String::new() };
        let before: Vec<&str> = before.iter().map(|&kind| text(kind)).collect();
        format!("{} {word} {}", before.join(", "), text(*last))
    }

    /// How many equal spheres stand for a limb; `None` where it has a sphere tree of its own and no count is
    /// asked for.
    pub fn equal_spheres(limb: &Limb, count: Option<usize>) -> Option<usize> {
        if count.is_none() && !limb.spheres.is_empty() {
            return None;
        }
        let natural = 1 + (2.0 * limb.length / limb.radius).ceil().min(MAX_SPHERES as f64) as usize;
        Some(count.unwrap_or(natural).clamp(1, MAX_SPHERES))
    }

    /// Its word in files and on the command line.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Its name for people.
    pub const fn label(self) -> &'static str {
        self.words()[1]
    }

    /// What a limb of it has, in two words.
    pub fn shape(self) -> &'static str {
        self.words()[2]
    }

    /// How it pulls along the limb, as a sentence.
    pub fn pull(self) -> &'static str {
        self.words()[3]
    }

    /// Name, label, shape and pull: all that a new solid must say of itself in words.
    const fn words(self) -> [&'static str; 4] {
        match self {
            Self::Cylinder => [
                "cylinder",
                "Cylinder",
                "flat ends",
                "Flat ends: seen from the side, they hardly pull along the limb.",
            ],
            Self::Capsule => [
                "capsule",
                "Capsule",
                "round ends",
                "Round ends fade over a band, so every end says which way to go.",
            ],
            Self::SphereTree { .. } => {
                ["sphere-tree", "Sphere tree", "spheres", "Spheres pull along the limb everywhere, a little."]
            }
        }
    }

    /// The same with the number of spheres chosen by itself: one of [`ALL`](Self::ALL).
    pub fn plain(self) -> Self {
        match self {
            Self::SphereTree { .. } => Self::SphereTree { spheres: None },
            other => other,
        }
    }
}

impl fmt::Display for RendererKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Text that is not a renderer, or not a ramp.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
#[error("\"{0}\" is not {1}")]
pub struct ParseError(pub(super) String, pub(super) Cow<'static, str>);

impl FromStr for RendererKind {
    type Err = ParseError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = Self::ALL.into_iter().find(|kind| kind.name() == text);
        let expected =
            || format!("a renderer; expected {}", Self::listed(&Self::ALL, "or", Self::name)).into();
        known.ok_or_else(|| ParseError(text.to_owned(), expected()))
    }
}
