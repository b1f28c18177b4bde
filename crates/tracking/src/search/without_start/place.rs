//! Where the subject is, by its silhouettes: its hull, or what one camera lets guess.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::WithoutStartError;
use crate::camera::{Camera, up_of};
use crate::cancel::CancelToken;
use crate::fit::{Evidence, FitView};
use crate::silhouette::{Label, Mask};
use crate::statistics::upper_median;
use crate::visual_hull::{HullOptions, HullView, VisualHull};

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
pub(crate) struct Place {
    /// Up, a unit vector.
    pub(crate) up: DVec3,
    /// Along the ground, towards the cameras' middle; a unit vector.
    pub(crate) to_cameras: DVec3,
    /// How much the cameras stand on that side: 0 all around, 1 all in one place.
    pub(crate) one_sided: f64,
    /// Lowest and highest point, along `up`.
    pub(crate) bottom: f64,
    pub(crate) top: f64,
    /// Points of the subject's surface.
    points: Vec<DVec3>,
    is_flat: bool,
}

impl Place {
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
        let Some(hull) = VisualHull::carve(&views, &HullOptions { cells: CELLS }, cancel) else {
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

    /// Points of the subject's surface; before one camera, of a plane.
    pub(crate) fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Whether one camera alone has said where the subject is.
    pub(crate) fn is_flat(&self) -> bool {
        self.is_flat
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
