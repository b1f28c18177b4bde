//! All that a picture of the scene shows, so that it is drawn again only when something in it has changed.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use backlit_tracking::visual_hull::VisualHull;
use glam::DVec3;

use super::Frustum;
use crate::features::scene::raster::{Scene, SceneCamera};
use crate::session::FrameData;

/// All that a picture of the scene shows.
#[derive(Debug, Clone)]
pub struct SceneOrder {
    /// Width and height in pixels.
    pub(crate) size_px: [u32; 2],
    /// Whether it is of something that moves: drawn quickly, with rough edges.
    pub is_draft: bool,
    /// Where it is seen from.
    pub eye: SceneCamera,
    /// Limbs, floor and lines.
    pub scene: Scene<'static>,
    /// The cameras.
    pub(crate) frusta: Vec<Frustum>,
    /// The frame whose pictures stand on the frusta, if they are to be seen.
    pub(crate) pictures: Option<Arc<FrameData>>,
    /// Longest side of these pictures, in pixels.
    pub(crate) picture_side: u32,
    /// The hull whose cubes are to be seen.
    pub(crate) shell: Option<Arc<VisualHull>>,
    /// Where the held joint is. It is no part of the picture; its mark goes with it.
    pub(crate) held: Option<DVec3>,
}

impl SceneOrder {
    /// Differs when anything differs. Frames and hulls are told apart by their places in memory: a key says something
    /// only as long as its order is kept.
    pub(crate) fn key(&self) -> u64 {
        egui::util::hash(Fingerprint(self))
    }
}

struct Fingerprint<'a>(&'a SceneOrder);

impl Hash for Fingerprint<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let SceneOrder { size_px, is_draft, eye, scene, frusta, pictures, picture_side, shell, held } =
            self.0;
        (size_px, is_draft, picture_side, pictures.as_ref().map(Arc::as_ptr)).hash(state);
        (shell.as_ref().map(Arc::as_ptr), held.map(bits)).hash(state);
        (bits(eye.position), bits(eye.target), bits(eye.up), eye.fov_y.to_bits()).hash(state);
        for limb in &scene.limbs {
            (limb.ends.map(bits), limb.radius.to_bits(), limb.shape, limb.colour).hash(state);
        }
        for line in &scene.lines {
            (line.ends.map(bits), line.width_px.to_bits(), line.colour).hash(state);
        }
        for dot in &scene.dots {
            (bits(dot.at), dot.side.to_bits(), dot.colour).hash(state);
        }
        let floor = scene.floor.map(|floor| (bits(floor.centre), floor.cell.map(bits), floor.colour));
        (scene.limbs.len(), scene.lines.len(), scene.dots.len(), floor).hash(state);
        for frustum in frusta {
            (frustum.camera, bits(frustum.apex), frustum.corners.map(bits)).hash(state);
            frustum.opacity.to_bits().hash(state);
        }
    }
}

fn bits(point: DVec3) -> [u64; 3] {
    point.to_array().map(f64::to_bits)
}
