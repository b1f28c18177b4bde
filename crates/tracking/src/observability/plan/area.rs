//! A floor, a part of it that is looked at, and cameras around that.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

use super::MIDDLE_M;
use crate::body::{Kinematics, Model, Pose};
use crate::camera::{Camera, CameraError, CameraFromWorld};

/// A person is so tall, metres.
const TALL_M: f64 = 1.75;
/// What cameras see is looked for this far about them, and this finely, metres.
const ABOUT_M: f64 = 1.0;
const STEP_M: f64 = 0.25;
/// No farther than that from the middle of the cameras, metres.
const REACH_M: f64 = 15.0;
/// Sides of an area that is found, metres.
const SIDES_M: [f64; 2] = [1.0, 6.0];

/// A floor in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// Away from it, a unit vector, world axes.
    pub up: DVec3,
    /// Its height along that, metres.
    pub height_m: f64,
}

impl Floor {
    /// The floor that a body stands on: through its lowest point.
    #[must_use]
    pub fn under(model: &Model, pose: &Pose, up: DVec3) -> Self {
        let kinematics = Kinematics::new(model, pose);
        let joints = kinematics.starts().iter().zip(kinematics.ends()).zip(model.limbs());
        let lowest = joints.map(|((from, to), limb)| from.dot(up).min(to.dot(up)) - limb.radius);
        Self { up, height_m: lowest.fold(f64::INFINITY, f64::min) }
    }

    /// Unit vectors along the floor, world axes: the world's x (or y where that is up) as far as it is along the floor, and
    /// a quarter turn to its left.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 2] {
        let along = if self.up.x.abs() < 0.7 { DVec3::X } else { DVec3::Y };
        let ahead = (along - self.up * self.up.dot(along)).normalize();
        [ahead, self.up.cross(ahead)]
    }

    /// The world point over a place, metres above the floor.
    #[must_use]
    pub fn point(&self, place: [f64; 2], above_m: f64) -> DVec3 {
        let [ahead, left] = self.axes();
        ahead * place[0] + left * place[1] + self.up * (self.height_m + above_m)
    }

    /// The place under a world point.
    #[must_use]
    pub fn place(&self, point: DVec3) -> [f64; 2] {
        self.axes().map(|axis| axis.dot(point))
    }
}

/// A rectangle of a floor along its axes, in cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorArea {
    /// Its middle, metres.
    pub middle: [f64; 2],
    /// Its sides, metres.
    pub size_m: [f64; 2],
    /// Cells along each side.
    pub cells: [usize; 2],
}

impl FloorArea {
    /// An area with about `cells` cells along its longer side, nearly square ones.
    #[must_use]
    pub fn new(middle: [f64; 2], size_m: [f64; 2], cells: usize) -> Self {
        let side = size_m[0].max(size_m[1]) / cells.max(1) as f64;
        let along = size_m.map(|size| ((size / side).round() as usize).max(1));
        Self { middle, size_m, cells: along }
    }

    /// What at least two of the cameras see of a person who stands there, from head to toe (one, if there is but one): a rectangle about
    /// the middle of that, as large as it spreads. `None` where there is no such place.
    #[must_use]
    pub fn seen_by(cameras: &[Arc<Camera>], floor: &Floor, cells: usize) -> Option<Self> {
        let places: Vec<[f64; 2]> = cameras.iter().map(|camera| floor.place(camera.centre())).collect();
        let ends = |axis: usize| {
            let along = places.iter().map(|place| place[axis]);
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
            let middle = 0.5 * (low + high);
            // One camera has nothing behind it; what it sees is before it.
            let reach = if cameras.len() < 2 { REACH_M } else { ABOUT_M };
            [(low - reach).max(middle - REACH_M), (high + reach).min(middle + REACH_M)]
        };
        if cameras.is_empty() {
            return None;
        }
        let (across, along) = (ends(0), ends(1));
        let steps = |[low, high]: [f64; 2]| {
            (0..=((high - low) / STEP_M) as usize).map(move |step| low + STEP_M * step as f64)
        };
        let least = cameras.len().min(2);
        let is_seen = |place: [f64; 2]| {
            let whole = |camera: &&Arc<Camera>| {
                [0.0, TALL_M].into_iter().all(|above| is_in_picture(camera, floor.point(place, above)))
            };
            cameras.iter().filter(whole).take(least).count() == least
        };
        let seen: Vec<[f64; 2]> = steps(along)
            .flat_map(|y| steps(across).map(move |x| [x, y]))
            .filter(|place| is_seen(*place))
            .collect();
        let count = seen.len() as f64;
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| seen.iter().map(of).sum::<f64>() / count;
        let middle = [mean(&|at| at[0]), mean(&|at| at[1])];
        // An even spread over a side s has the variance s²/12.
        let size = |axis: usize| {
            (12.0 * mean(&|at| (at[axis] - middle[axis]).powi(2))).sqrt().clamp(SIDES_M[0], SIDES_M[1])
        };
        (!seen.is_empty()).then(|| Self::new(middle, [size(0), size(1)], cells))
    }

    /// The middles of its cells: the first axis runs fastest.
    #[must_use]
    pub fn places(&self) -> Vec<[f64; 2]> {
        let at = |axis: usize, cell: usize| {
            let share = (cell as f64 + 0.5) / self.cells[axis] as f64 - 0.5;
            self.middle[axis] + share * self.size_m[axis]
        };
        (0..self.cells[1])
            .flat_map(|row| (0..self.cells[0]).map(move |column| [at(0, column), at(1, row)]))
            .collect()
    }
}

fn is_in_picture(camera: &Camera, point: DVec3) -> bool {
    let (width, height) = (camera.width() as f64, camera.height() as f64);
    let inside = |px: glam::DVec2| px.x >= -0.5 && px.y >= -0.5 && px.x < width - 0.5 && px.y < height - 0.5;
    camera.project(point).is_some_and(inside)
}

/// Cameras like one of another place: on a ring about a place of a floor, evenly from its first axis on, each looking at the middle of a
/// person there. They are named `NAME 1` and so on.
///
/// # Errors
/// Numbers that make no camera.
pub fn camera_ring(
    like: &Camera,
    floor: &Floor,
    middle: [f64; 2],
    [radius_m, height_m]: [f64; 2],
    count: usize,
    name: &str,
) -> Result<Vec<Arc<Camera>>, CameraError> {
    let target = floor.point(middle, MIDDLE_M);
    let one = |index: usize| {
        let (sine, cosine) = (TAU * index as f64 / count as f64).sin_cos();
        let centre = floor.point([middle[0] + radius_m * cosine, middle[1] + radius_m * sine], height_m);
        let place = CameraFromWorld::looking_at(centre, target, floor.up);
        let size = [like.width(), like.height()].map(|side| side as u64);
        let name = format!("{name} {}", index + 1);
        Ok(Arc::new(Camera::new(&name, size, *like.intrinsics(), crate::camera::Distortion::None, place)?))
    };
    (0..count).map(one).collect()
}
