//! The 3-D scene: what it shows and where it is seen from. Lengths are metres, in world axes.
//!
//! | file | holds |
//! |---|---|
//! | `preferences` | what is shown |
//! | `upright` | which way is up, and where the floor is |
//! | `viewpoint` | the orbit view, and a camera's own place |
//! | `contents` | body, cameras, floor, hull and sight ray as things to draw |
//! | `ghosts` | bodies in the place of the posed one |
//! | `order` | all that a picture of the scene shows |
//! | `drawing` | the picture made of that, and the cameras' pictures small |
//! | `hulls` | visual hulls of the frames that were looked at last |
//! | `update` | commands; pictures and hulls are taken in, hulls asked for |
//! | `panel` | the pane |

mod contents;
mod drawing;
mod ghosts;
mod hulls;
mod order;
pub(crate) mod panel;
mod preferences;
pub(crate) mod raster;
#[cfg(test)]
mod tests;
mod update;
mod upright;
mod viewpoint;

use std::sync::Arc;

use backlit_jobs::{Pool, Task};
use backlit_tracking::visual_hull::VisualHull;

pub(crate) use contents::{ContentsInput, Frustum, contents};
pub use drawing::{SceneDrawing, Thumbnails};
pub(crate) use hulls::HullCache;
use hulls::HullInputs;

use crate::context::priority;
pub(crate) use order::SceneOrder;
pub use preferences::{ScenePreferences, ShownHull};
pub use upright::Upright;
pub use viewpoint::{Orbit, Viewpoint};

/// The feature.
#[derive(Debug)]
pub struct Scene {
    /// What is shown.
    pub(crate) preferences: ScenePreferences,
    /// Visual hulls of frames.
    pub hulls: HullCache,
    /// The picture. While a newer one is drawn, the old stays.
    pub drawing: Option<Arc<SceneDrawing>>,
    /// Makes the picture of the order with this key.
    draw: Task<u64, Arc<SceneDrawing>>,
    carve: Task<HullInputs, Option<Arc<VisualHull>>>,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            preferences: ScenePreferences::default(),
            hulls: HullCache::default(),
            drawing: None,
            draw: Task::new(priority::SCENE),
            carve: Task::new(priority::HULL),
        }
    }
}

impl Scene {
    /// Whether nothing but the picture of the scene is being worked on.
    pub(crate) fn is_all_that_works(&self, pool: &Pool) -> bool {
        pool.is_idle_but(&self.draw)
    }
}
