//! How the tiles of the centre are arranged.

use super::camera_tile::CameraViews;
use crate::pane::Pane;

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
