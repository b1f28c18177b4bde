//! What the user paints into silhouettes: subject, background, or nobody can tell. It is kept apart from what was measured and
//! painted over it last.

use backlit_tracking::silhouette::{Mask, Stroke};

use super::Footage;

/// A stroke in the silhouettes of one camera, on the ideal grid, in one frame or several.
#[derive(Debug, Clone, PartialEq)]
pub struct BrushStroke {
    /// The camera, in the order of the take.
    pub camera: usize,
    /// First and last frame.
    pub frames: [usize; 2],
    /// The line.
    pub stroke: Stroke,
}

impl BrushStroke {
    /// Whether it is painted in a frame of a camera.
    pub fn is_of(&self, camera: usize, frame: usize) -> bool {
        self.camera == camera && (self.frames[0]..=self.frames[1]).contains(&frame)
    }
}

impl Footage {
    /// Paints the strokes of a frame into a silhouette, in the order in which they were made.
    pub(super) fn paint(&self, camera: usize, frame: usize, mask: &mut Mask) {
        self.brush.iter().filter(|one| one.is_of(camera, frame)).for_each(|one| one.stroke.paint(mask));
    }
}
