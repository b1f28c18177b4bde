//! A first guess of the body's size.

use glam::{DMat3, DVec2, DVec3};

use super::frames::BodyFrame;
use crate::body::{Kinematics, Model, Pose};
use crate::camera::Camera;
use crate::fit::{Evidence, FitView};
use crate::metrics::ReferenceJoints;
use crate::render::{Ramp, RendererKind, RowWinners, View};
use crate::silhouette::Label;
use crate::statistics::upper_median;

/// Rounds of matching places and areas.
const ROUNDS: usize = 6;
/// Largest change of the size's logarithm in a round.
const LARGEST_CHANGE: f64 = 0.3;
/// Smallest and largest size, as logarithms of the start's.
const RANGE: f64 = 1.2;
/// Every n pixels across and down: areas and places need no more.
const STRIDE: usize = 4;

/// The logarithm of the size of a body whose joints are known, over the model's: the median over all pairs of known
/// joints that are a rigid link's two ends. `None` without such a pair.
pub fn from_joints(model: &Model, joints: &[ReferenceJoints]) -> Option<f64> {
    let mut ratios = Vec::new();
    for frame in joints {
        let place = |limb: usize| frame.iter().find(|(of, _)| *of == Some(limb)).map(|(_, place)| *place);
        for (limb, end) in frame.iter().filter_map(|&(limb, end)| Some((limb?, end))) {
            let rotation = model.limbs()[limb].rotation;
            let (mut bone, mut next) = (DVec3::ZERO, Some(limb));
            while let Some(part) = next.map(|part| &model.limbs()[part]).filter(|p| p.rotation == rotation) {
                bone += part.direction * part.length;
                next = part.parent;
            }
            if let Some(start) = next.and_then(place) {
                ratios.push((end.distance(start) / bone.length()).ln());
            }
        }
    }
    ratios.retain(|ratio| ratio.is_finite());
    upper_median(&mut ratios).map(|ratio| ratio.clamp(-RANGE, RANGE))
}

/// The logarithm of the body's size, by the silhouettes' areas, and the poses moved to the silhouettes' places.
///
/// `model` is scaled by exp(`size`) at the start. Poses keep their rotations. Frames without masks keep their place.
pub(super) fn from_silhouettes(model: &Model, frames: &[BodyFrame], mut size: f64) -> (f64, Vec<Pose>) {
    let mut poses: Vec<Pose> = frames.iter().map(|frame| frame.start.clone()).collect();
    for _ in 0..ROUNDS {
        let Ok(body) = model.scaled(size.exp()) else { break };
        let mut changes = Vec::new();
        for (frame, pose) in frames.iter().zip(&mut poses) {
            let kinematics = Kinematics::new(&body, pose);
            let (mut normal, mut pull) = (DMat3::ZERO, DVec3::ZERO);
            for view in &frame.views {
                let Some(seen) = blob_of_mask(view) else { continue };
                let drawn = blob_of_model(&body, &kinematics, &view.camera);
                let centre = drawn.map(|drawn| drawn.centre).or_else(|| view.camera.project(pose.root));
                if let Some((by_move, centre)) = by_move(&view.camera, pose.root).zip(centre) {
                    let off = seen.centre - centre;
                    for (row, off) in by_move.into_iter().zip([off.x, off.y]) {
                        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
                        pull += row * off;
                    }
                }
                if let Some(drawn) = drawn {
                    changes.push(0.5 * (seen.area / drawn.area).ln());
                }
            }
            // A little ridge: one camera does not say how far away the body is.
            let trace = normal.x_axis.x + normal.y_axis.y + normal.z_axis.z;
            if trace > 0.0 {
                pose.root += (normal + DMat3::from_diagonal(DVec3::splat(1e-3 * trace))).inverse() * pull;
            }
        }
        if !changes.is_empty() {
            let change = changes.iter().sum::<f64>() / changes.len() as f64;
            size = (size + change.clamp(-LARGEST_CHANGE, LARGEST_CHANGE)).clamp(-RANGE, RANGE);
        }
    }
    (size, poses)
}

/// A silhouette's middle and its area, pixels.
#[derive(Debug, Clone, Copy)]
struct Blob {
    centre: DVec2,
    area: f64,
}

impl Blob {
    fn of(pixels: impl Iterator<Item = (usize, usize)>) -> Option<Self> {
        let (sum, count) = pixels.fold((DVec2::ZERO, 0.0), |(sum, count), (x, y)| {
            (sum + DVec2::new(x as f64, y as f64), count + 1.0)
        });
        (count > 0.0).then(|| Self { centre: sum / count, area: count * (STRIDE * STRIDE) as f64 })
    }
}

/// Of a camera that counts and has a mask.
fn blob_of_mask(view: &FitView) -> Option<Blob> {
    let Evidence::Mask(mask) = &view.evidence else { return None };
    let columns = || (STRIDE / 2..mask.width()).step_by(STRIDE);
    let sampled = (STRIDE / 2..mask.height()).step_by(STRIDE).flat_map(|y| columns().map(move |x| (x, y)));
    let is_subject = |&(x, y): &(usize, usize)| mask.get(x, y) == Some(Label::Subject);
    Blob::of(sampled.filter(is_subject)).filter(|_| view.weight > 0.0)
}

fn blob_of_model(body: &Model, kinematics: &Kinematics, camera: &Camera) -> Option<Blob> {
    let view = View::new(body, kinematics, camera, RendererKind::Capsule, Ramp::Half);
    let mut row = RowWinners::default();
    let mut inside = Vec::new();
    for y in (STRIDE / 2..view.size[1]).step_by(STRIDE) {
        row.find(&view, y, STRIDE, STRIDE / 2);
        let touched = row.touched().step_by(STRIDE);
        inside.extend(touched.filter(|&x| row.level(x) < 0.5).map(|x| (x, y)));
    }
    Blob::of(inside.into_iter())
}

/// How a point's picture moves with it: rows of the derivative by its place in the world, pixels per metre.
fn by_move(camera: &Camera, point: DVec3) -> Option<[DVec3; 2]> {
    let place = camera.camera_from_world();
    let p = place.transform(point);
    if p.z <= 1e-3 {
        return None;
    }
    let (fx, fy) = (camera.intrinsics().fx, camera.intrinsics().fy);
    let world_from_camera = place.rotation.transpose();
    Some([
        world_from_camera * DVec3::new(fx / p.z, 0.0, -fx * p.x / (p.z * p.z)),
        world_from_camera * DVec3::new(0.0, fy / p.z, -fy * p.y / (p.z * p.z)),
    ])
}
