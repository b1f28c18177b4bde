//! The 3-D scene on the CPU: bodies, cameras and the floor, seen by an orbit view.
//!
//! Limbs are intersected with each pixel's ray, so they are round at every scale; pictures are shown in
//! true perspective; a depth buffer decides what is in front. Every pixel is the mean of 2 × 2 samples.
//! Lengths are metres, and nothing closer to the eye than [`NEAR`] is drawn. What is not finite is skipped.

mod frame;
mod shapes;

use egui::Color32;
use glam::{DMat3, DVec2, DVec3};
use image::RgbaImage;

pub(crate) use frame::SceneFrame;
pub(crate) use shapes::Limb;

/// What is closer to the eye than this is not drawn.
pub(crate) const NEAR: f64 = 0.01;

/// Where the scene is seen from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneCamera {
    /// The eye.
    pub position: DVec3,
    /// The point in the middle of the picture.
    pub(crate) target: DVec3,
    /// What points up in the picture, more or less.
    pub(crate) up: DVec3,
    /// Full vertical angle of view, in radians.
    pub(crate) fov_y: f64,
}

impl SceneCamera {
    /// Rotation from the world to the view's axes: x right, y down, z forward. A view along its `up`, or
    /// of its own position, still gets some rotation.
    pub(crate) fn view_from_world(&self) -> DMat3 {
        let forward = (self.target - self.position).normalize_or(DVec3::Z);
        let right = forward.cross(self.up).normalize_or(forward.any_orthonormal_vector());
        DMat3::from_cols(right, forward.cross(right), forward).transpose()
    }

    /// Where a point appears in a picture of `size` pixels, and its depth along the view; `None` if that is
    /// less than [`NEAR`]. Pixel centres are at integers.
    pub(crate) fn project(&self, point_in_world: DVec3, size: [u32; 2]) -> Option<(DVec2, f64)> {
        let view = Pinhole::new(self, size, 1);
        let point = view.in_view(point_in_world);
        (point.z >= NEAR).then(|| (view.on_screen(point), point.z))
    }
}

/// A line of constant width on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SceneLine {
    pub(crate) ends: [DVec3; 2],
    /// Its width in pixels.
    pub(crate) width_px: f64,
    pub(crate) colour: Color32,
}

/// A square that faces the viewer, such as a cube of a hull seen from afar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dot {
    pub(crate) at: DVec3,
    /// Its side, as long as if it were in the scene.
    pub(crate) side: f64,
    pub(crate) colour: Color32,
}

/// A flat picture, such as a camera's image on its frustum.
///
/// One texel is picked for each sample: give it at about the size it is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlatPicture<'a> {
    /// Where its upper left corner is.
    pub(crate) corner: DVec3,
    /// From there to its upper right corner.
    pub(crate) across: DVec3,
    /// From there to its lower left corner.
    pub(crate) down: DVec3,
    pub(crate) image: &'a RgbaImage,
    pub(crate) opacity: f32,
}

/// A square grid on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Floor {
    pub(crate) centre: DVec3,
    /// Two directions in the plane, each as long as a cell.
    pub(crate) cell: [DVec3; 2],
    /// Cells from the middle to each side.
    pub(crate) half_cells: u16,
    pub(crate) colour: Color32,
}

impl Floor {
    /// The lines of the grid, one pixel wide.
    pub(crate) fn lines(&self) -> impl Iterator<Item = SceneLine> {
        let half = i32::from(self.half_cells);
        let [first, second] = self.cell;
        (-half..=half).flat_map(move |index| {
            let [index, half] = [f64::from(index), f64::from(half)];
            [(first, second), (second, first)].map(|(along, step)| {
                let middle = self.centre + step * index;
                SceneLine {
                    ends: [middle - along * half, middle + along * half],
                    width_px: 1.0,
                    colour: self.colour,
                }
            })
        })
    }
}

/// All that is drawn in a scene: limbs first, then the floor, then pictures from the farthest to the
/// nearest, then dots and lines in their order.
#[derive(Clone, Debug, Default)]
pub struct SceneShapes<'a> {
    /// Limbs.
    pub limbs: Vec<Limb>,
    /// The floor, if any.
    pub(crate) floor: Option<Floor>,
    /// Pictures. Where they are more than half opaque they hide lines behind them.
    pub(crate) pictures: Vec<FlatPicture<'a>>,
    /// Dots. They hide nothing.
    pub(crate) dots: Vec<Dot>,
    pub(crate) lines: Vec<SceneLine>,
}

/// The pinhole through which samples look: rays are (x, y, 1) in the view's axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pinhole {
    view_from_world: DMat3,
    position: DVec3,
    focal: f64,
    centre: DVec2,
}

impl Pinhole {
    fn new(camera: &SceneCamera, size: [u32; 2], samples: u32) -> Self {
        let size = size.map(|pixels| f64::from(pixels * samples));
        Self {
            view_from_world: camera.view_from_world(),
            position: camera.position,
            focal: 0.5 * size[1] / (0.5 * camera.fov_y).tan(),
            centre: DVec2::new(0.5 * (size[0] - 1.0), 0.5 * (size[1] - 1.0)),
        }
    }

    fn in_view(&self, point_in_world: DVec3) -> DVec3 {
        self.view_from_world * (point_in_world - self.position)
    }

    fn on_screen(&self, point: DVec3) -> DVec2 {
        point.truncate() * (self.focal / point.z) + self.centre
    }

    fn ray(&self, sample: DVec2) -> DVec3 {
        ((sample - self.centre) / self.focal).extend(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_target_is_in_the_middle_and_up_is_up() {
        let camera = SceneCamera {
            position: DVec3::new(3.0, 1.0, -2.0),
            target: DVec3::new(0.2, 0.9, 0.1),
            up: DVec3::Y,
            fov_y: 0.8,
        };
        let (middle, depth) = camera.project(camera.target, [101, 51]).unwrap();
        assert!((middle - DVec2::new(50.0, 25.0)).length() < 1e-9);
        assert!((depth - camera.position.distance(camera.target)).abs() < 1e-12);
        let (above, _) = camera.project(camera.target + DVec3::Y * 0.1, [101, 51]).unwrap();
        assert!(above.y < middle.y && (above.x - middle.x).abs() < 1e-9);
        assert!(camera.project(camera.position - (camera.target - camera.position), [101, 51]).is_none());
    }

    #[test]
    fn a_degenerate_view_still_has_a_rotation() {
        for (target, up) in [(DVec3::Y, DVec3::Y), (DVec3::ZERO, DVec3::Y), (DVec3::Z, DVec3::ZERO)] {
            let camera = SceneCamera { position: DVec3::ZERO, target, up, fov_y: 1.0 };
            assert!((camera.view_from_world().determinant() - 1.0).abs() < 1e-12);
        }
    }
}
