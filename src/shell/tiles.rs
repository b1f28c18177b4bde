//! How the tiles of the centre are arranged.

use crate::context::pane::Pane;
use crate::features::camera_views::CameraViews;

/// How the tiles are arranged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TilesLook<'a> {
    /// What the cameras' views show.
    pub(crate) views: CameraViews<'a>,
    /// The pane that fills the centre.
    pub(crate) alone: Option<Pane>,
    /// The two cameras that are shown where there is room for two.
    pub(crate) pair: [usize; 2],
}
