//! What the 3-D scene shows. Kept from start to start, but for where it is seen from.

use serde::{Deserialize, Serialize};

use super::Viewpoint;

/// What is shown of the visual hull.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShownHull {
    /// Nothing; it is not carved.
    Hidden,
    /// The box that holds it.
    #[default]
    Bounds,
    /// The box, and the cubes at its surface.
    Shell,
}

impl ShownHull {
    /// All of them with their names.
    pub(crate) const ALL: [(Self, &'static str); 3] =
        [(Self::Hidden, "No visual hull"), (Self::Bounds, "Hull bounds"), (Self::Shell, "Hull voxels")];
}

/// What the scene shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ScenePreferences {
    /// Where it is seen from; `None` from where all cameras are seen.
    #[serde(skip)]
    pub viewpoint: Option<Viewpoint>,
    /// Cameras with their frusta.
    pub cameras: bool,
    /// The pictures on the frusta.
    pub pictures: bool,
    /// Floor and axes.
    pub floor: bool,
    /// The visual hull.
    pub hull: ShownHull,
}

impl Default for ScenePreferences {
    fn default() -> Self {
        Self { viewpoint: None, cameras: true, pictures: true, floor: true, hull: ShownHull::Bounds }
    }
}
