//! Joints in space from the keypoints of several cameras, and the body that they make.

use backlit_tracking::body::builtin::{self, KEYPOINT_LIMBS};
use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::body_fit::scale;
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::JointKeypoint;
use backlit_tracking::geometry::NearestToLines;
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::start;
use glam::{DVec2, DVec3};

use super::{Keypoint, Person};

/// Keypoints with a lower score are not believed to be anywhere.
pub const LOWEST_SCORE: f64 = 0.3;
/// A joint whose rays miss one another by more is not believed, metres.
const FARTHEST_RAY: f64 = 0.12;
/// Fewest joints that a pose is made of.
const FEWEST_JOINTS: usize = 8;
/// A body whose joints are farther from the keypoints, metres in the mean, is not believed.
const FARTHEST_JOINTS: f64 = 0.15;

/// Keypoints of COCO's body.
const COCO_KEYPOINTS: usize = 17;

/// Which keypoint shows which limb's second joint, in the order of `KEYPOINT_LIMBS`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeypointOrder([usize; 12]);

impl KeypointOrder {
    /// Left and right shoulder, left and right hip.
    pub(super) fn trunk(self) -> [usize; 4] {
        [0, 1, 6, 7].map(|limb| self.0[limb])
    }
}

/// That of COCO, which `HALPE_26`, `BODY_25B` and whole-body models begin with, and that of `OpenPose`'s `BODY_25`.
const ORDERS: [KeypointOrder; 2] = [
    KeypointOrder([5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]),
    KeypointOrder([5, 2, 6, 3, 7, 4, 12, 9, 13, 10, 14, 11]),
];

/// A body that keypoints make.
#[derive(Debug, Clone)]
pub struct KeypointBody {
    /// The average body, scaled to the joints.
    pub model: Model,
    /// Its pose.
    pub pose: Pose,
    /// The order of keypoints that makes the best body.
    pub order: KeypointOrder,
}

/// The body that the keypoints of one person in one moment make, as cameras see them. `None` where they are of fewer than two
/// cameras, or make no body.
#[must_use]
pub fn body_of(people: &[(&Camera, Person)]) -> Option<KeypointBody> {
    let bodies = ORDERS.into_iter().filter_map(|order| body_of_order(people, order));
    let best = bodies.min_by(|a, b| a.0.total_cmp(&b.0));
    best.filter(|(error, _)| *error < FARTHEST_JOINTS).map(|(_, body)| body)
}

/// The joints of a body that keypoints of this order show, world metres: those of its limbs that are seen by two cameras or more
/// whose rays meet.
#[must_use]
pub fn joints_of(model: &Model, people: &[(&Camera, Person)], order: KeypointOrder) -> ReferenceJoints {
    let mut joints = ReferenceJoints::new();
    for (name, index) in KEYPOINT_LIMBS.iter().zip(order.0) {
        let seen = people.iter().filter_map(|(camera, person)| {
            let keypoint = (*person.get(index)?)?;
            (keypoint.score >= LOWEST_SCORE).then_some((*camera, keypoint.place))
        });
        if let (Some(point), Some(limb)) = (meeting_point(seen), model.limb_index(name)) {
            joints.push((Some(limb), point));
        }
    }
    joints
}

/// The keypoints of one person as [cues](backlit_tracking::cues) take them: at which limb's second joint each is, in pixels of
/// the `working` camera, the ideal and perhaps reduced one that the fit uses. `camera` is the one whose pixels the person's
/// are. Keypoints of limbs that the model lacks, and where the lens has no inverse, are left out.
#[must_use]
pub fn cues_of(
    model: &Model,
    person: &Person,
    order: KeypointOrder,
    camera: &Camera,
    working: &Camera,
) -> Vec<JointKeypoint> {
    let cue = |(name, seen): (&&str, Option<(DVec2, f64)>)| {
        let (pixel, score) = seen?;
        Some(JointKeypoint { limb: model.limb_index(name)?, pixel, score: score.min(1.0) })
    };
    KEYPOINT_LIMBS.iter().zip(joint_pixels(person, order, camera, working)).filter_map(cue).collect()
}

/// Where `working` sees the second joints of `KEYPOINT_LIMBS`, pixels, and the keypoints' scores.
pub(crate) fn joint_pixels(
    person: &Person,
    order: KeypointOrder,
    camera: &Camera,
    working: &Camera,
) -> [Option<(DVec2, f64)>; 12] {
    order.0.map(|index| {
        let keypoint = (*person.get(index)?)?;
        let ray = camera.ray_in_camera(keypoint.place)?;
        Some((working.intrinsics().pixel_from_plane(ray.truncate() / ray.z), keypoint.score))
    })
}

/// The person in COCO's order whose keypoints these are: the other way round than [`cues_of`], for a camera that is both.
#[must_use]
pub fn person_of(model: &Model, cues: &[JointKeypoint]) -> Person {
    let mut person = vec![None; COCO_KEYPOINTS];
    for (name, index) in KEYPOINT_LIMBS.iter().zip(ORDERS[0].0) {
        let cue = cues.iter().find(|cue| model.limb_index(name) == Some(cue.limb));
        person[index] = cue.map(|cue| Keypoint { place: cue.pixel, score: cue.score });
    }
    person
}

/// The body, and how far its joints are from the keypoints in the mean, metres.
fn body_of_order(people: &[(&Camera, Person)], order: KeypointOrder) -> Option<(f64, KeypointBody)> {
    let average = builtin::full_body();
    let joints = joints_of(&average, people, order);
    if joints.len() < FEWEST_JOINTS {
        return None;
    }
    let size = scale::from_joints(&average, std::slice::from_ref(&joints)).unwrap_or(0.0);
    let model = average.scaled(size.exp()).ok()?;
    let pose = start::from_joints(&model, &joints)?;
    let ends = Kinematics::new(&model, &pose);
    let off =
        joints.iter().map(|(limb, point)| limb.map_or(pose.root, |limb| ends.ends()[limb]).distance(*point));
    Some((off.sum::<f64>() / joints.len() as f64, KeypointBody { model, pose, order }))
}

/// The point that is nearest to the rays of pixels; `None` for fewer than two, or where they miss one another.
pub(crate) fn meeting_point<'a>(pixels: impl Iterator<Item = (&'a Camera, DVec2)>) -> Option<DVec3> {
    let rays: Vec<(DVec3, DVec3)> =
        pixels.filter_map(|(camera, pixel)| Some((camera.centre(), camera.ray_in_world(pixel)?))).collect();
    if rays.len() < 2 {
        return None;
    }
    let mut nearest = NearestToLines::default();
    rays.iter().for_each(|&(centre, ray)| nearest.add(centre, ray, 1.0));
    let point = nearest.solve()?;
    let off = |(centre, ray): &(DVec3, DVec3)| (point - *centre).cross(*ray).length();
    let mean = rays.iter().map(off).sum::<f64>() / rays.len() as f64;
    (mean < FARTHEST_RAY).then_some(point)
}

#[cfg(test)]
mod tests {
    use super::super::{Keypoint, coarse_mask};
    use super::*;
    use backlit_tracking::silhouette::Label;

    /// A person upright in a picture of 200 × 300, in the order of COCO: x and y of each keypoint.
    fn person() -> Person {
        let places = [
            100, 30, 104, 26, 96, 26, 110, 28, 90, 28, 130, 70, 70, 70, 145, 120, 55, 120, 150, 160, 50, 160,
            118, 160, 82, 160, 120, 215, 80, 215, 122, 270, 78, 270,
        ];
        let keypoint = |&[x, y]: &[i32; 2]| Keypoint { place: DVec2::new(x.into(), y.into()), score: 0.9 };
        places.as_chunks().0.iter().map(|place| Some(keypoint(place))).collect()
    }

    /// Through a lens and in a picture of half the size, keypoints project back onto the joints.
    #[test]
    fn cues_are_in_pixels_of_the_working_camera() {
        use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
        let model = builtin::full_body();
        let pose = Pose::rest(&model);
        let joints = Kinematics::new(&model, &pose);
        let place = CameraFromWorld::looking_at(DVec3::new(0.4, 3.5, 1.0), DVec3::ZERO, DVec3::Z);
        let pinhole = Intrinsics { fx: 260.0, fy: 260.0, cx: 119.5, cy: 159.5 };
        let lens = Distortion::OpenCv { k1: -0.2, k2: 0.05, p1: 0.001, p2: 0.0, k3: 0.0 };
        let camera = Camera::new("c", [240, 320], pinhole, lens, place).unwrap();
        let working = camera.without_distortion().reduced(2).unwrap();
        let mut person: Person = vec![None; 17];
        for (name, index) in KEYPOINT_LIMBS.iter().zip(ORDERS[0].0) {
            let place = camera.project(joints.ends()[model.limb_index(name).unwrap()]).unwrap();
            person[index] = Some(Keypoint { place, score: 1.4 });
        }
        person[9] = None;
        let cues = cues_of(&model, &person, ORDERS[0], &camera, &working);
        assert_eq!(cues.len(), 11);
        for cue in cues {
            let expected = working.project(joints.ends()[cue.limb]).unwrap();
            assert!(cue.pixel.distance(expected) < 0.02 && cue.score == 1.0, "{cue:?} {expected}");
        }
        assert_eq!(cues_of(&builtin::single_limb(), &person, ORDERS[0], &camera, &working), []);
    }

    /// The other way round than `cues_of`: what was there is there again, at its place in COCO's order, and nothing else.
    #[test]
    fn cues_become_the_person_whose_they_are() {
        use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
        let model = builtin::full_body();
        let pinhole = Intrinsics { fx: 260.0, fy: 260.0, cx: 99.5, cy: 149.5 };
        let place = CameraFromWorld::looking_at(DVec3::new(0.4, 3.5, 1.0), DVec3::ZERO, DVec3::Z);
        let camera = Camera::new("c", [200, 300], pinhole, Distortion::None, place).unwrap();
        let mut seen = person();
        seen[9] = None;
        let again = person_of(&model, &cues_of(&model, &seen, ORDERS[0], &camera, &camera));
        assert_eq!(again.len(), COCO_KEYPOINTS);
        for (index, (found, expected)) in again.iter().zip(&seen).enumerate() {
            // Nose, eyes and ears are no joints of the body.
            let expected = expected.filter(|_| index >= 5);
            assert_eq!(found.is_some(), expected.is_some(), "keypoint {index}");
            let Some((found, expected)) = found.zip(expected) else { continue };
            assert!(found.place.distance(expected.place) < 1e-9 && found.score == 0.9, "{index}: {found:?}");
        }
        assert_eq!(person_of(&builtin::single_limb(), &[]), vec![None; COCO_KEYPOINTS]);
    }

    #[test]
    fn keypoints_tell_the_trunk_from_what_may_be_and_what_is_not() {
        let person = person();
        let mask = coarse_mask(std::slice::from_ref(&person), Some(ORDERS[0]), [200, 300], 1).unwrap();
        let label = |x, y| mask.get(x, y).unwrap();
        assert_eq!(label(100, 110), Label::Subject, "within the trunk");
        assert_eq!(label(130, 72), Label::Subject, "at the shoulder");
        assert_eq!(label(132, 130), Label::Unknown, "beside the trunk");
        assert_eq!(label(10, 20), Label::Background, "far away");
        // Without an order, or in another one, the trunk is unknown.
        let mask = coarse_mask(std::slice::from_ref(&person), None, [200, 300], 1).unwrap();
        assert_eq!(mask.get(100, 110), Some(Label::Unknown));
        let mask = coarse_mask(std::slice::from_ref(&person), Some(ORDERS[0]), [200, 300], 2).unwrap();
        assert_eq!((mask.width(), mask.get(50, 55)), (100, Some(Label::Subject)));
        // Where the rest of half a person is, is unknown.
        let half = person.iter().enumerate().map(|(k, keypoint)| keypoint.filter(|_| k < 11)).collect();
        assert_eq!(coarse_mask(&[half], Some(ORDERS[0]), [200, 300], 1), None);
    }
}
