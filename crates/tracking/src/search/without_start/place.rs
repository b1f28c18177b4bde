//! Where the subject is, by its silhouettes: its hull, or what one camera lets guess.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::super::chains::Chains;
use super::WithoutStartError;
use crate::body::{Kinematics, Model, Pose, Sides};
use crate::camera::{Camera, Intrinsics, up_of};
use crate::cancel::CancelToken;
use crate::fit::{ApparentSize, Evidence, FitView, MEANT_FOR_PX};
use crate::silhouette::{Label, Mask};
use crate::statistics::upper_median;
use crate::visual_hull::{HullView, VisualHull};

/// Cubes along the hull's longest side.
const CELLS: usize = 40;
/// A slice of the hull reaches so far below and above its height, in heights of the hull.
const SLICE: f64 = 0.08;
/// Pixels across the longer side of one camera's picture that are looked at.
const ACROSS: usize = 200;
/// A body before one camera is at least as near and as far as this, metres.
const NEAREST_M: f64 = 0.3;
const FARTHEST_M: f64 = 100.0;

/// Where the subject is. Metres, world axes.
#[derive(Debug, Clone)]
pub(crate) struct SubjectPlace {
    /// Up, a unit vector.
    pub(crate) up: DVec3,
    /// Along the ground, towards the cameras' middle; a unit vector.
    pub(crate) to_cameras: DVec3,
    /// How much the cameras stand on that side: 0 all around, 1 all in one place.
    pub(crate) one_sided: f64,
    /// Lowest and highest point, along `up`.
    pub(crate) bottom: f64,
    pub(crate) top: f64,
    /// Points of the subject's surface; before one camera, of a plane.
    pub(crate) points: Vec<DVec3>,
    /// Whether one camera alone has said where the subject is.
    pub(crate) is_flat: bool,
}

impl SubjectPlace {
    /// By the hull of all silhouettes; by the body's height before one camera.
    pub(crate) fn of(
        seen: &[FitView],
        up: Option<DVec3>,
        body_height: f64,
        cancel: &CancelToken,
    ) -> Result<Self, WithoutStartError> {
        let of_cameras =
            || up_of(seen.iter().map(|view| view.camera.as_ref())).ok_or(WithoutStartError::NoUp);
        let up = up.map_or_else(of_cameras, |up| Ok(up.normalize()))?;
        if let [view] = seen {
            return Ok(Self::before_one(view, up, body_height, seen));
        }
        let hull_view =
            |view: &FitView| Some(HullView { camera: Arc::clone(&view.camera), silhouette: mask_of(view)? });
        let views: Vec<HullView<Arc<Camera>, Arc<Mask>>> = seen.iter().filter_map(hull_view).collect();
        let Some(hull) = VisualHull::carve(&views, CELLS, cancel) else {
            let cameras = seen.iter().map(|view| view.camera.name().to_owned()).collect();
            let is_cancelled = cancel.is_cancelled();
            return Err(if is_cancelled {
                WithoutStartError::Cancelled
            } else {
                WithoutStartError::Apart { cameras }
            });
        };
        let points = hull.shell.iter().map(|voxel| voxel.centre).collect();
        Ok(Self::about(points, 0.5 * hull.voxel, up, seen))
    }

    /// The silhouette on a plane before the camera, as far away as a body of that height appears.
    fn before_one(view: &FitView, up: DVec3, body_height: f64, seen: &[FitView]) -> Self {
        let camera = &view.camera;
        let stride = (camera.width().max(camera.height()) / ACROSS).max(1);
        let rays: Vec<DVec3> = mask_of(view).map_or_else(Vec::new, |mask| {
            let subject = |(_, label): &(usize, &Label)| **label == Label::Subject;
            let place = |(index, _): (usize, &Label)| (index % mask.width(), index / mask.width());
            let all = mask.labels().iter().enumerate().filter(subject).map(place);
            let some = all.filter(|(x, y)| x % stride == 0 && y % stride == 0);
            some.filter_map(|(x, y)| camera.ray_in_camera(DVec2::new(x as f64, y as f64))).collect()
        });
        // Across the plane one metre before the camera.
        let back = camera.camera_from_world().rotation.transpose();
        let offsets: Vec<DVec3> = rays.iter().map(|ray| back * (*ray / ray.z)).collect();
        let heights = || offsets.iter().map(|offset| offset.dot(up));
        let height = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
        let depth = (body_height / height).clamp(NEAREST_M, FARTHEST_M);
        let depth = if depth.is_finite() { depth } else { FARTHEST_M };
        let points = offsets.iter().map(|offset| camera.centre() + *offset * depth).collect();
        Self::about(points, 0.0, up, seen)
    }

    fn about(points: Vec<DVec3>, margin: f64, up: DVec3, views: &[FitView]) -> Self {
        let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let away = |view: &FitView| {
            let to = view.camera.centre() - middle;
            (to - up * to.dot(up)).normalize_or_zero()
        };
        let mean = views.iter().map(away).sum::<DVec3>() / views.len().max(1) as f64;
        let heights = || points.iter().map(|point| point.dot(up));
        Self {
            up,
            to_cameras: mean.try_normalize().unwrap_or_else(|| up.any_orthonormal_vector()),
            one_sided: mean.length(),
            bottom: heights().fold(f64::INFINITY, f64::min) - margin,
            top: heights().fold(f64::NEG_INFINITY, f64::max) + margin,
            points,
            is_flat: views.len() == 1,
        }
    }

    pub(crate) fn height(&self) -> f64 {
        self.top - self.bottom
    }

    /// The middle at half height.
    pub(crate) fn middle(&self) -> DVec3 {
        self.middle_at(0.5 * (self.top + self.bottom))
    }

    /// The middle of what is at a height: medians along two directions of the ground, so that an arm held out hardly counts.
    pub(crate) fn middle_at(&self, height: f64) -> DVec3 {
        let reach = SLICE * self.height();
        let mut slice: Vec<DVec3> =
            self.points.iter().filter(|point| (point.dot(self.up) - height).abs() < reach).copied().collect();
        if slice.is_empty() {
            slice.clone_from(&self.points);
        }
        let [a, b] = [self.to_cameras, self.up.cross(self.to_cameras)].map(|axis| {
            let mut along: Vec<f64> = slice.iter().map(|point| point.dot(axis)).collect();
            axis * upper_median(&mut along).unwrap_or(0.0)
        });
        a + b + self.up * height
    }
}

/// The silhouette; grey levels below half are the subject.
pub(crate) fn mask_of(view: &FitView) -> Option<Arc<Mask>> {
    match &view.evidence {
        Evidence::Mask(mask) => Some(Arc::clone(mask)),
        Evidence::Measurement(grey) => {
            let label = |(&value, &weight): (&f32, &f32)| match (weight > 0.0, value < 127.5) {
                (false, _) => Label::Unknown,
                (true, true) => Label::Subject,
                (true, false) => Label::Background,
            };
            let labels = grey.values().iter().zip(grey.weights()).map(label).collect();
            Mask::new(grey.width(), grey.height(), labels).ok().map(Arc::new)
        }
    }
}

/// Limbs at rest that reach less than this out of the body's plane tell no front, metres.
const LEAST_FRONT: f64 = 1e-3;

/// Directions and extents of a body at rest. Unit vectors at right angles; metres from the root.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stance {
    /// Along the trunk.
    up: DVec3,
    /// Where the body looks; any direction at right angles to `up` where that cannot be told.
    ahead: DVec3,
    /// Whether front and back can be told.
    pub(crate) has_front: bool,
    /// How far the body reaches below and above the root, radii included.
    pub(crate) below: f64,
    pub(crate) above: f64,
}

impl Stance {
    pub(crate) fn new(model: &Model, parts: &Chains) -> Self {
        let kinematics = Kinematics::new(model, &Pose::rest(model));
        let (starts, ends) = (kinematics.starts(), kinematics.ends());
        let trunk = parts.trunk.iter().flat_map(|&rotation| &parts.groups[rotation]);
        let along: DVec3 = trunk.map(|&limb| ends[limb] - starts[limb]).sum();
        let (up, ahead, has_front) = match Sides::of(model, &kinematics) {
            Some(sides) => (sides.up, sides.ahead, true),
            None => {
                let up = along.normalize_or(DVec3::Y);
                let (ahead, has_front) = front(up, ends);
                (up, ahead, has_front)
            }
        };
        let [low, high] = reach(model, &kinematics, up);
        Self { up, ahead, has_front, below: -low, above: high }
    }

    /// How tall the body stands, metres.
    pub(crate) fn height(&self) -> f64 {
        self.below + self.above
    }

    /// The body at rest, standing along `up` and facing `ahead` (unit vectors at right angles, world axes).
    pub(crate) fn pose(&self, model: &Model, root: DVec3, up: DVec3, ahead: DVec3) -> Pose {
        let basis = |up: DVec3, ahead: DVec3| DMat3::from_cols(up.cross(ahead), up, ahead);
        let turn = DQuat::from_mat3(&(basis(up, ahead) * basis(self.up, self.ahead).transpose()));
        let mut pose = Pose::rest(model);
        pose.root = root;
        turn_whole(model, &mut pose, turn);
        pose
    }

    /// Along the trunk of a posed body, and where it looks: both by the rotation that turns all of it.
    pub(crate) fn up_of(&self, model: &Model, pose: &Pose) -> DVec3 {
        whole_turn(model, pose) * self.up
    }

    /// The same of where it looks.
    pub(crate) fn ahead_of(&self, model: &Model, pose: &Pose) -> DVec3 {
        whole_turn(model, pose) * self.ahead
    }
}

/// Lowest and highest place of a body along a direction, metres.
fn reach(model: &Model, kinematics: &Kinematics, up: DVec3) -> [f64; 2] {
    let joints = kinematics.starts().iter().zip(kinematics.ends()).zip(model.limbs());
    joints.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ((start, end), limb)| {
        let (start, end) = (start.dot(up), end.dot(up));
        [low.min(start.min(end) - limb.radius), high.max(start.max(end) + limb.radius)]
    })
}

/// The first rotation that no other turns.
fn whole_turn(model: &Model, pose: &Pose) -> DQuat {
    let first = model.rotation_parents().iter().position(Option::is_none);
    first.map_or(DQuat::IDENTITY, |rotation| pose.rotations[rotation])
}

/// Turns the whole body about its root.
pub(crate) fn turn_whole(model: &Model, pose: &mut Pose, turn: DQuat) {
    for (rotation, parent) in model.rotation_parents().iter().enumerate() {
        if parent.is_none() {
            pose.rotations[rotation] = (turn * pose.rotations[rotation]).normalize();
        }
    }
}

/// The front of a body without named sides: across its broadest direction, to where limbs at rest reach.
fn front(up: DVec3, ends: &[DVec3]) -> (DVec3, bool) {
    let (a, b) = up.any_orthonormal_pair();
    let moment = |u: DVec3, v: DVec3| ends.iter().map(|end| end.dot(u) * end.dot(v)).sum::<f64>();
    let angle = 0.5 * (2.0 * moment(a, b)).atan2(moment(a, a) - moment(b, b));
    let across = a * angle.cos() + b * angle.sin();
    let ahead = across.cross(up);
    let reach: f64 = ends.iter().map(|end| end.dot(ahead)).sum::<f64>() / ends.len().max(1) as f64;
    let has_front = reach.abs() > LEAST_FRONT;
    (if has_front && reach < 0.0 { -ahead } else { ahead }, has_front)
}

/// The views with every block of pixels made one, where the thinnest limb is twice as thick as it need be and more. Grey
/// levels stay as they are.
pub(crate) fn reduced(model: &Model, views: &[FitView], pose: &Pose) -> Vec<FitView> {
    let factor = (ApparentSize::of(model, views, pose).thinnest_px / MEANT_FOR_PX).floor();
    if !(factor.is_finite() && factor >= 2.0) {
        return views.to_vec();
    }
    views.iter().map(|view| smaller(view, factor as usize).unwrap_or_else(|| view.clone())).collect()
}

fn smaller(view: &FitView, factor: usize) -> Option<FitView> {
    let Evidence::Mask(mask) = &view.evidence else { return None };
    let (width, height) = (mask.width() / factor, mask.height() / factor);
    let block = |x: usize, y: usize| {
        let rows = (0..factor).map(|row| (y * factor + row) * mask.width() + x * factor);
        let (mut subject, mut unknown) = (0, 0);
        for label in rows.flat_map(|from| &mask.labels()[from..from + factor]) {
            subject += usize::from(*label == Label::Subject);
            unknown += usize::from(*label == Label::Unknown);
        }
        let known = factor * factor - unknown;
        match (2 * unknown > factor * factor, 2 * subject >= known) {
            (true, _) => Label::Unknown,
            (false, true) => Label::Subject,
            (false, false) => Label::Background,
        }
    };
    let labels =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| block(x, y)).collect();
    let mask = Mask::new(width, height, labels).ok()?;
    let (camera, by) = (&view.camera, factor as f64);
    let pinhole = camera.intrinsics();
    // Centres of pixels are at integers: the first block's is at half of what it holds beside its first pixel.
    let centre = |at: f64| (at - 0.5 * (by - 1.0)) / by;
    let pinhole = Intrinsics {
        fx: pinhole.fx / by,
        fy: pinhole.fy / by,
        cx: centre(pinhole.cx),
        cy: centre(pinhole.cy),
    };
    let size = [width as u64, height as u64];
    let place = *camera.camera_from_world();
    let camera = Camera::new(camera.name(), size, pinhole, *camera.distortion(), place).ok()?;
    let view = FitView { camera: Arc::new(camera), evidence: Evidence::Mask(Arc::new(mask)), ..*view };
    view.has_data().then_some(view)
}
