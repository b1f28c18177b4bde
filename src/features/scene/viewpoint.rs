//! Which way is up and where the floor is, which takes do not say; and where the scene is seen from.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use glam::DVec3;

use super::raster::SceneCamera;

/// Full vertical angle of view of the orbit view, radians.
const ANGLE_OF_VIEW: f64 = 0.62;
/// Radians that a drag turns, for each point.
const TURN: f64 = 0.008;
/// The eye keeps this far from straight above and below, radians.
const FROM_POLE: f64 = 0.02;
/// Distances of the eye from what it looks at.
const DISTANCES: [f64; 2] = [0.2, 200.0];
/// The first view looks down by this angle, radians.
const FIRST_ELEVATION: f64 = 0.36;
/// The first view holds all cameras within so much of the picture's half width and height.
const FIRST_FIT: f64 = 0.86;
/// The first view looks at the middle of all cameras by so much, and at the body by the rest.
const FIRST_LEAN: f64 = 0.45;
/// Least share of the picture’s height that a body has in it.
const LEAST_BODY: f64 = 0.18;
/// Where it would have less, the eye goes to this share of the distance at which it has that much.
const SPECK_FROM: f64 = 0.3;
/// Steps of the search for its distance.
const FIRST_STEPS: usize = 32;

/// Where the scene is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Viewpoint {
    /// From anywhere.
    Orbit(Orbit),
    /// From the place of a camera, counted from zero.
    Camera(usize),
}

/// An eye on a ball about what it looks at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// What it looks at.
    pub target: DVec3,
    /// Azimuth of the eye about the target, radians.
    pub azimuth: f64,
    /// Its elevation above the horizon, radians.
    pub elevation: f64,
    /// Its distance.
    pub distance: f64,
}

impl Orbit {
    /// From where all `eyes` and the target are seen about the middle, in a picture of so much width for its height: out of the
    /// widest gap between them, from above.
    /// Where cameras are so far away that a body of this size would be a speck, the body alone.
    pub(crate) fn around(
        upright: &Upright,
        (target, size): (DVec3, f64),
        eyes: &[DVec3],
        aspect: f64,
    ) -> Self {
        let mut azimuths: Vec<f64> = eyes.iter().map(|eye| upright.angles(*eye - target)[0]).collect();
        azimuths.sort_by(f64::total_cmp);
        let turn = std::f64::consts::TAU;
        let next = |index: usize| azimuths.get(index + 1).copied().unwrap_or_else(|| azimuths[0] + turn);
        let gaps = (0..azimuths.len()).map(|index| (azimuths[index], next(index) - azimuths[index]));
        let widest = gaps.reduce(|best, gap| if gap.1 > best.1 + 1e-9 { gap } else { best });
        // A single camera is looked at from its side, so that it hides nothing.
        let share = if eyes.len() == 1 { 0.125 } else { 0.5 };
        let azimuth = widest.map_or(0.0, |(from, gap)| from + share * gap);
        let seen: Vec<DVec3> = eyes.iter().copied().chain(target.is_finite().then_some(target)).collect();
        let middle = eyes.iter().sum::<DVec3>() / eyes.len().max(1) as f64;
        let body = target;
        let target = if eyes.is_empty() { target } else { target.lerp(middle, FIRST_LEAN) };
        let from = |distance| Self { target, azimuth, elevation: FIRST_ELEVATION, distance }.held();
        let [mut near, mut far] = [1.5, DISTANCES[1]];
        for _ in 0..FIRST_STEPS {
            let middle = 0.5 * (near + far);
            if from(middle).holds(upright, &seen, aspect) { far = middle } else { near = middle }
        }
        let farthest = size / (2.0 * LEAST_BODY * (0.5 * ANGLE_OF_VIEW).tan());
        if size > 0.0 && far > farthest {
            return Self { target: body, distance: SPECK_FROM * farthest, ..from(far) }.held();
        }
        from(far)
    }

    /// Whether all points are well inside the picture.
    fn holds(&self, upright: &Upright, points: &[DVec3], aspect: f64) -> bool {
        let camera = self.camera(upright);
        let view_from_world = camera.view_from_world();
        let half = FIRST_FIT * (0.5 * camera.fov_y).tan();
        points.iter().map(|point| view_from_world * (*point - camera.position)).all(|point| {
            point.z > 0.0 && point.y.abs() < half * point.z && point.x.abs() < half * aspect * point.z
        })
    }

    /// The view of an eye that looks at a target.
    pub(crate) fn looking(upright: &Upright, eye: DVec3, target: DVec3) -> Self {
        let [azimuth, elevation] = upright.angles(eye - target);
        Self { target, azimuth, elevation, distance: eye.distance(target) }.held()
    }

    /// The same distance from another side.
    pub(crate) fn seen_from_side(self, upright: &Upright, direction: DVec3) -> Self {
        let [azimuth, elevation] = upright.angles(direction);
        Self { azimuth, elevation, ..self }.held()
    }

    /// Turned by a drag of some points.
    pub(crate) fn turned(self, [right, down]: [f64; 2]) -> Self {
        let (azimuth, elevation) = (self.azimuth - TURN * right, self.elevation + TURN * down);
        Self { azimuth, elevation, ..self }.held()
    }

    /// Moved parallel to the picture, so that what is at the target follows a drag of some points in a view that is
    /// `height` points high.
    pub(crate) fn panned(self, upright: &Upright, [right, down]: [f64; 2], height: f64) -> Self {
        let rows = self.camera(upright).view_from_world().transpose();
        let length = 2.0 * self.distance * (0.5 * ANGLE_OF_VIEW).tan() / height.max(1.0);
        Self { target: self.target - (rows.x_axis * right + rows.y_axis * down) * length, ..self }.held()
    }

    /// Closer by a factor.
    pub(crate) fn zoomed(self, factor: f64) -> Self {
        Self { distance: self.distance / factor, ..self }.held()
    }

    /// The eye.
    pub fn camera(&self, upright: &Upright) -> SceneCamera {
        let direction = upright.direction(self.azimuth, self.elevation);
        SceneCamera {
            position: self.target + direction * self.distance,
            target: self.target,
            up: upright.up,
            fov_y: ANGLE_OF_VIEW,
        }
    }

    /// Within what can be shown.
    fn held(self) -> Self {
        let pole = std::f64::consts::FRAC_PI_2 - FROM_POLE;
        let finite = |value: f64, other: f64| if value.is_finite() { value } else { other };
        Self {
            target: if self.target.is_finite() { self.target } else { DVec3::ZERO },
            azimuth: finite(self.azimuth, 0.0),
            elevation: finite(self.elevation, 0.0).clamp(-pole, pole),
            distance: finite(self.distance, 5.0).clamp(DISTANCES[0], DISTANCES[1]),
        }
    }
}

impl Viewpoint {
    /// The eye, for a picture of so much width for its height.
    pub(crate) fn camera(self, upright: &Upright, cameras: &[Arc<Camera>], aspect: f64) -> SceneCamera {
        match self {
            Self::Orbit(orbit) => orbit.camera(upright),
            Self::Camera(index) => match cameras.get(index) {
                Some(camera) => own_place(camera, aspect),
                None => Orbit::around(upright, (DVec3::ZERO, 0.0), &[], aspect).camera(upright),
            },
        }
    }
}

/// A camera's own place and axis, with an angle that holds its whole picture.
fn own_place(camera: &Camera, aspect: f64) -> SceneCamera {
    let world_from_camera = camera.camera_from_world().rotation.transpose();
    let [width, height] = [camera.width() as f64, camera.height() as f64];
    let focal = camera.intrinsics();
    let half = (0.5 * height / focal.fy).max(0.5 * width / focal.fx / aspect.max(1e-3));
    SceneCamera {
        position: camera.centre(),
        target: camera.centre() + world_from_camera.z_axis,
        up: -world_from_camera.y_axis,
        fov_y: 2.0 * half.atan(),
    }
}

/// A world axis is up when the cameras' own up is this near to it (cosine of 35°).
const NEAR_AXIS: f64 = 0.82;
/// The floor is the plane through the origin when the body's lowest point is this near to it.
const NEAR_ORIGIN: f64 = 0.25;

/// Directions of a person who stands in the world. They are unit vectors at right angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Upright {
    /// Away from the floor.
    pub(crate) up: DVec3,
    /// Along the floor: what azimuths count from.
    pub(crate) ahead: DVec3,
}

impl Upright {
    /// Cameras are held upright, on the whole: the world axis nearest to the mean of their up directions.
    pub fn of(cameras: &[Arc<Camera>]) -> Self {
        let mean: DVec3 =
            cameras.iter().map(|camera| -camera.camera_from_world().rotation.transpose().y_axis).sum();
        let mean = mean.normalize_or(DVec3::Z);
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let up = axes.into_iter().find(|axis| axis.dot(mean) > NEAR_AXIS).unwrap_or(mean);
        let along = if up.x.abs() < 0.7 { DVec3::X } else { DVec3::Y };
        Self { up, ahead: (along - up * up.dot(along)).normalize() }
    }

    /// To the left of one who looks ahead.
    pub(crate) fn left(&self) -> DVec3 {
        self.up.cross(self.ahead)
    }

    /// A direction by azimuth and elevation in radians.
    pub(crate) fn direction(&self, azimuth: f64, elevation: f64) -> DVec3 {
        let along = self.ahead * azimuth.cos() + self.left() * azimuth.sin();
        along * elevation.cos() + self.up * elevation.sin()
    }

    /// Azimuth and elevation of a direction, in radians.
    pub(crate) fn angles(&self, direction: DVec3) -> [f64; 2] {
        let azimuth = direction.dot(self.left()).atan2(direction.dot(self.ahead));
        let height = direction.normalize_or(self.ahead).dot(self.up);
        [azimuth, height.clamp(-1.0, 1.0).asin()]
    }

    /// Height of the floor: the body's lowest point in the start pose, or the origin if that is about the same.
    pub(crate) fn floor(&self, model: &Model, start: &Pose) -> f64 {
        let kinematics = Kinematics::new(model, start);
        let joints = kinematics.starts().iter().zip(kinematics.ends()).zip(model.limbs());
        let lowest = joints
            .map(|((from, to), limb)| from.dot(self.up).min(to.dot(self.up)) - limb.radius)
            .fold(f64::INFINITY, f64::min);
        if lowest.is_finite() && lowest.abs() > NEAR_ORIGIN { lowest } else { 0.0 }
    }

    /// Where the body looks, by its left and right limbs; `None` for a body without sides, or one that lies.
    pub(crate) fn facing(&self, model: &Model, kinematics: &Kinematics) -> Option<DVec3> {
        let ends = kinematics.ends();
        let across: DVec3 = model
            .limbs()
            .iter()
            .enumerate()
            .filter(|(_, limb)| limb.name.starts_with("right "))
            .map(|(index, _)| ends[model.mirrored_limb(index)] - ends[index])
            .sum();
        let ahead = across.cross(self.up);
        (ahead.length() > 0.2 * across.length()).then(|| ahead.normalize())
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use glam::DVec2;

    use super::*;
    use crate::app::testing::{camera, side_camera};

    const UPRIGHT: Upright = Upright { up: DVec3::Z, ahead: DVec3::X };

    #[test]
    fn the_first_view_looks_out_of_the_widest_gap_and_holds_all_cameras() {
        let eyes = [0.0_f64, 0.9, 1.8].map(|angle| DVec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 1.2));
        let orbit = Orbit::around(&UPRIGHT, (DVec3::new(0.0, 0.0, 1.0), 1.8), &eyes, 1.0);
        let away = (orbit.azimuth - (0.9 + std::f64::consts::PI)).rem_euclid(std::f64::consts::TAU);
        assert!(away.min(std::f64::consts::TAU - away) < 0.05, "{orbit:?}");
        let camera = orbit.camera(&UPRIGHT);
        for eye in eyes {
            let (at, _) = camera.project(eye, [400, 400]).unwrap();
            assert!(at.cmpgt(DVec2::ZERO).all() && at.cmplt(DVec2::splat(400.0)).all(), "{at}");
        }
        // The body and its only camera are both in the picture.
        let (body, alone) = (DVec3::new(0.0, 0.0, 1.0), [DVec3::new(1.3, 0.0, 1.0)]);
        let camera = Orbit::around(&UPRIGHT, (body, 1.8), &alone, 1.0).camera(&UPRIGHT);
        for point in [body, alone[0]] {
            let (at, _) = camera.project(point, [400, 400]).unwrap();
            assert!(at.cmpgt(DVec2::splat(20.0)).all() && at.cmplt(DVec2::splat(380.0)).all(), "{at}");
        }
        // A limb of half a metre is no speck, however far away its camera is.
        let far = Orbit::around(&UPRIGHT, (body, 0.5), &[DVec3::new(40.0, 0.0, 1.0)], 1.0);
        assert!(far.distance < 3.0 && far.target == body, "{far:?}");
        let nowhere = Orbit::around(&UPRIGHT, (DVec3::splat(f64::NAN), 1.8), &[], 1.0);
        assert!(nowhere.camera(&UPRIGHT).position.is_finite());
    }

    #[test]
    fn what_is_dragged_follows_the_pointer() {
        let orbit = Orbit { target: DVec3::new(0.3, 0.1, 1.0), azimuth: 0.4, elevation: 0.3, distance: 5.0 };
        let panned = orbit.panned(&UPRIGHT, [30.0, -12.0], 400.0);
        let (at, _) = panned.camera(&UPRIGHT).project(orbit.target, [400, 400]).unwrap();
        assert!(at.distance(DVec2::new(199.5 + 30.0, 199.5 - 12.0)) < 0.01, "{at}");
        assert!(orbit.zoomed(2.0).distance < orbit.distance);
        let over = orbit.turned([0.0, 1e6]);
        assert!(over.elevation < std::f64::consts::FRAC_PI_2 && over.zoomed(1e-9).distance <= 200.0);
        let again = Orbit::looking(&UPRIGHT, orbit.camera(&UPRIGHT).position, orbit.target);
        assert!((again.azimuth - orbit.azimuth).abs() < 1e-9 && (again.distance - 5.0).abs() < 1e-9);
    }

    #[test]
    fn from_a_camera_the_scene_lies_on_its_picture() {
        let camera = side_camera();
        let eye = own_place(&camera, 272.0 / 480.0);
        for point in [DVec3::ZERO, DVec3::new(0.2, 0.3, -0.4), DVec3::new(-0.5, 0.1, 0.6)] {
            let (at, depth) = eye.project(point, [272, 480]).unwrap();
            assert!(at.distance(camera.project(point).unwrap()) < 1e-6);
            assert!((depth - camera.depth(point)).abs() < 1e-9);
        }
    }

    fn around(up: DVec3) -> Vec<Arc<Camera>> {
        let (a, b) = (up.any_orthonormal_vector(), up.cross(up.any_orthonormal_vector()));
        let standing = |angle: f64| {
            let at = (a * angle.cos() + b * angle.sin()) * 4.0 + up * 2.0;
            camera([272, 480], [400.0, 135.5, 239.5], at, up, up)
        };
        [0.0, 1.7, 3.0, 4.4].map(standing).to_vec()
    }

    #[test]
    fn up_is_found_from_the_cameras() {
        for up in [DVec3::Z, DVec3::Y, DVec3::NEG_Y, DVec3::X] {
            let upright = Upright::of(&around(up));
            assert_eq!(upright.up, up);
            assert!(upright.ahead.dot(up).abs() < 1e-12 && (upright.left().length() - 1.0).abs() < 1e-12);
            let [azimuth, elevation] = upright.angles(upright.direction(0.7, -0.4));
            assert!((azimuth - 0.7).abs() < 1e-9 && (elevation + 0.4).abs() < 1e-9);
        }
        assert_eq!(Upright::of(&[]).up, DVec3::Z);
    }

    #[test]
    fn the_body_at_rest_faces_away_from_its_back() {
        let model = builtin::full_body();
        let pose = Pose::rest(&model);
        let kinematics = Kinematics::new(&model, &pose);
        let foot = model.limb_index("right foot").unwrap();
        let toes = kinematics.ends()[foot] - kinematics.starts()[foot];
        let head =
            kinematics.ends().iter().fold(DVec3::ZERO, |top, end| if end.z > top.z { *end } else { top });
        let up = if head.z > 0.5 { DVec3::Z } else { DVec3::Y };
        let upright = Upright { up, ahead: DVec3::X };
        let facing = upright.facing(&model, &kinematics).unwrap();
        assert!(facing.dot(toes) > 0.0, "{facing} {toes}");
        assert!(upright.floor(&model, &pose) < -0.5, "the feet are below the root");
    }
}
