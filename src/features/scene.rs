//! What the 3-D scene shows and where it is seen from. Lengths are metres, in world axes.
//!
//! | file | holds |
//! |---|---|
//! | `upright` | which way is up, and where the floor is |
//! | `viewpoint` | the orbit view, and a camera's own place |
//! | `contents` | body, cameras, floor, hull and sight ray as things to draw |
//! | `order` | all that a picture of the scene shows |
//! | `drawing` | the picture made of that, and the cameras' pictures small |

mod contents;
pub(crate) mod draw_job;
mod drawing;
pub(crate) mod hull_job;
pub(crate) mod hulls;
mod order;
pub(crate) mod panel;
pub mod raster;
pub(crate) mod update;
mod upright;
mod viewpoint;

use serde::{Deserialize, Serialize};

pub use contents::{Contents, ContentsInput, Frustum, contents};
pub use drawing::{SceneDrawing, Thumbnails};
pub use order::SceneOrder;
pub use upright::Upright;
pub use viewpoint::{Orbit, Viewpoint};

/// What is shown of the visual hull.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HullLook {
    /// Nothing; it is not carved.
    Hidden,
    /// The box that holds it.
    #[default]
    Bounds,
    /// The box, and the cubes at its surface.
    Shell,
}

impl HullLook {
    /// All of them with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Hidden, "No visual hull"), (Self::Bounds, "Hull bounds"), (Self::Shell, "Hull voxels")];
}

/// What the scene shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SceneLook {
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
    pub hull: HullLook,
}

impl Default for SceneLook {
    fn default() -> Self {
        Self { viewpoint: None, cameras: true, pictures: true, floor: true, hull: HullLook::Bounds }
    }
}
