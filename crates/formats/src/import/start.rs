//! A pose to begin with, and the person's height, from two-dimensional keypoints of several cameras.

use backlit_tracking::body::{Kinematics, Model, Pose, builtin};
use backlit_tracking::body_fit::scale;
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::start;
use glam::{DMat3, DVec2, DVec3};

use super::{Found, FoundCamera, ImportError};
use crate::keypoints::{self, Person};

/// Keypoints with a lower score are not believed to be anywhere.
const LOWEST_SCORE: f64 = 0.3;
/// A joint whose rays miss one another by more is not believed, metres.
const FARTHEST_RAY: f64 = 0.12;
/// A pose is made of so many joints or more.
const FEWEST_JOINTS: usize = 8;
/// A body whose joints are farther from the keypoints, metres in the mean, is not believed.
const FARTHEST_JOINTS: f64 = 0.15;

/// The limbs of the full body whose second joints keypoints show.
const LIMBS: [&str; 12] = [
    "left clavicle",
    "right clavicle",
    "left upper arm",
    "right upper arm",
    "left forearm",
    "right forearm",
    "left hip",
    "right hip",
    "left lower thigh",
    "right lower thigh",
    "left lower calf",
    "right lower calf",
];
/// Where they stand in the order of COCO, which `HALPE_26`, `BODY_25B` and whole-body models begin with, and in that of
/// `OpenPose`'s `BODY_25` and `COCO` of 18.
const ORDERS: [[usize; 12]; 2] =
    [[5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16], [5, 2, 6, 3, 7, 4, 12, 9, 13, 10, 14, 11]];

/// The body, scaled to the person's joints, and its pose in the first frame. `None` where keypoints are of fewer than two
/// cameras, or make no body.
pub(super) fn of_keypoints(found: &Found) -> Result<Option<(Model, Pose)>, ImportError> {
    let mut people = Vec::new();
    for camera in &found.cameras {
        let Some(folder) = &camera.keypoints else { continue };
        let files = keypoints::files_of(folder)?;
        let Some((first, _)) = files.first() else { continue };
        let Some((_, path)) = files.iter().find(|(number, _)| *number == first + found.first as u64) else {
            continue;
        };
        let tallest =
            |person: &Person| keypoints::largest_extent(std::slice::from_ref(person)).unwrap_or(0.0);
        let person = keypoints::read(path)?.into_iter().max_by(|a, b| tallest(a).total_cmp(&tallest(b)));
        people.extend(person.map(|person| (camera, person)));
    }
    let bodies = ORDERS.iter().filter_map(|order| body_of(&people, order));
    let best = bodies.min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(best.filter(|(error, ..)| *error < FARTHEST_JOINTS).map(|(_, model, pose)| (model, pose)))
}

/// The body that keypoints of this order make, and how far its joints are from them in the mean, metres.
fn body_of(people: &[(&FoundCamera, Person)], order: &[usize; 12]) -> Option<(f64, Model, Pose)> {
    let average = builtin::full_body();
    let mut joints = ReferenceJoints::new();
    for (name, &index) in LIMBS.iter().zip(order) {
        let seen = people.iter().filter_map(|(camera, person)| {
            let keypoint = (*person.get(index)?)?;
            (keypoint.score >= LOWEST_SCORE).then_some((*camera, keypoint.place))
        });
        if let (Some(point), Some(limb)) = (meeting_point(seen), average.limb_index(name)) {
            joints.push((Some(limb), point));
        }
    }
    if joints.len() < FEWEST_JOINTS {
        return None;
    }
    let size = scale::from_joints(&average, std::slice::from_ref(&joints)).unwrap_or(0.0);
    let model = average.scaled(size.exp()).ok()?;
    let pose = start::from_joints(&model, &joints)?;
    let ends = Kinematics::new(&model, &pose);
    let off =
        joints.iter().map(|(limb, point)| limb.map_or(pose.root, |limb| ends.ends()[limb]).distance(*point));
    Some((off.sum::<f64>() / joints.len() as f64, model, pose))
}

/// The point that is nearest to the rays of pixels; `None` for fewer than two, or where they miss one another.
fn meeting_point<'a>(pixels: impl Iterator<Item = (&'a FoundCamera, DVec2)>) -> Option<DVec3> {
    let rays: Vec<(DVec3, DVec3)> = pixels
        .filter_map(|(found, pixel)| Some((found.camera.centre(), found.camera.ray_in_world(pixel)?)))
        .collect();
    if rays.len() < 2 {
        return None;
    }
    let (mut sum, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for &(centre, ray) in &rays {
        let across = DMat3::IDENTITY - DMat3::from_cols(ray * ray.x, ray * ray.y, ray * ray.z);
        sum += across;
        right += across * centre;
    }
    let point = sum.inverse() * right;
    let off = |(centre, ray): &(DVec3, DVec3)| (point - *centre).cross(*ray).length();
    let mean = rays.iter().map(off).sum::<f64>() / rays.len() as f64;
    (point.is_finite() && mean < FARTHEST_RAY).then_some(point)
}
