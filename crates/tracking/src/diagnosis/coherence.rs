//! Whether the visual hull of the other cameras explains a silhouette: coherence of silhouettes (C. Hernández, F. Schmitt and
//! R. Cipolla, "Silhouette coherence for camera calibration under circular motion", IEEE PAMI 29(2), 2007).
//!
//! The ray through an edge of camera c's silhouette touches the subject, so that some place on it lies in every other silhouette.
//! With `sd_d` the signed distance from silhouette d's border, negative inside, the edge's *gap* is
//!
//! ```text
//! g = max(0, min over z of max over d ≠ c of sd_d(π_d(o + z r)))
//! ```
//!
//! pixels: by how much the others' silhouettes would have to grow. Unknown pixels may be the subject's, and so may what lies beyond
//! a border that the silhouette reaches. Places are looked for about the middle of what all cameras see.
//!
//! sd grows by no more than a cell where a picture moves by one, which tells how far a search may leap along the ray
//! (J. Hart, "Sphere tracing", The Visual Computer 12(10), 1996).

use std::sync::OnceLock;

use glam::{DVec2, DVec3};

use super::outlines::Clock;
use crate::camera::Camera;
use crate::geometry::NearestToLines;
use crate::silhouette::{Label, SignedDistance};
use crate::synchronise::Recording;
use crate::synchronise::cells::MaskCells;
use crate::synchronise::outline::Sighting;

/// Edges of a silhouette that are asked.
const EDGES: usize = 24;
/// Frames of a camera whose edges are asked.
const FRAMES: usize = 12;
/// Gaps are no larger, cells.
const LARGEST: f64 = 12.0;
/// Parts of a cell in which distances are kept.
const PARTS: f32 = 8.0;
/// The subject reaches from its middle by so many of the largest half extents.
const REACH: f64 = 1.25;
/// A moment this near to a frame, as a share of the time between two, is the frame's.
const NEAR_FRAME: f64 = 0.02;
/// Rays that point less far ahead than this say nothing, cosines.
const LEAST_AHEAD: f64 = 0.05;

/// One camera's silhouettes in coarse cells.
#[derive(Debug)]
pub(super) struct SilhouetteRecord {
    /// The camera of the pictures as they were taken, and that of the silhouettes, which may be without the lens.
    lens: Camera,
    ideal: Camera,
    frames: Vec<RecordedFrame>,
}

#[derive(Debug)]
struct RecordedFrame {
    seconds: f64,
    cells: MaskCells,
    shape: OnceLock<SilhouetteShape>,
}

/// What is asked of a silhouette. Places are in pixels of the pictures as they were taken.
#[derive(Debug)]
struct SilhouetteShape {
    /// Signed distance of each cell with all that is unknown subject, in parts of a cell.
    distances: Vec<i8>,
    edges: Vec<DVec2>,
    /// Corners of the box about the subject.
    corners: Vec<DVec2>,
    /// The subject does not reach the picture's border.
    is_whole: bool,
}

/// Gaps of edges, pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrameGaps {
    pub(super) camera: usize,
    /// When, by the camera's clock.
    pub(super) seconds: f64,
    pub(super) px: Vec<f64>,
}

impl SilhouetteRecord {
    /// `lens` is the camera of the pictures as they were taken.
    pub(super) fn of(recording: &Recording, lens: &Camera) -> Self {
        let [ideal, lens] = match recording.pictures.as_deref() {
            Some(cameras) => cameras.clone(),
            None => [recording.camera.clone(), lens.clone()],
        };
        let frame = |sighting: &Sighting| {
            let cells = sighting.cells.clone()?;
            Some(RecordedFrame { seconds: sighting.seconds, cells, shape: OnceLock::new() })
        };
        Self { lens, ideal, frames: recording.sightings.iter().filter_map(frame).collect() }
    }

    /// Pixels along a cell's side.
    pub(super) fn side(&self) -> f64 {
        self.frames.first().map_or(1.0, |frame| frame.cells.side as f64)
    }

    fn shape<'a>(&self, frame: &'a RecordedFrame) -> &'a SilhouetteShape {
        frame.shape.get_or_init(|| self.shape_of(&frame.cells))
    }

    fn shape_of(&self, cells: &MaskCells) -> SilhouetteShape {
        let mask = cells.mask();
        let [columns, rows] = cells.size;
        let taken = |cell: DVec2| {
            let pixel = (cell + 0.5) * cells.side as f64 - 0.5;
            self.lens.project(self.ideal.centre() + self.ideal.ray_in_world(pixel)?)
        };
        let signed = SignedDistance::from_mask(&mask);
        let kept = |at: usize| (signed.range(at)[0] * PARTS).round().clamp(-127.0, 127.0) as i8;
        let mut edges = Vec::new();
        let mut is_whole = true;
        for (at, _) in mask.labels().iter().enumerate().filter(|(_, label)| **label == Label::Subject) {
            let (x, y) = (at % columns, at / columns);
            is_whole &= x > 0 && y > 0 && x + 1 < columns && y + 1 < rows;
            for (dx, dy) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
                let beside = x.checked_add_signed(dx).zip(y.checked_add_signed(dy));
                if beside.and_then(|(x, y)| mask.get(x, y)) == Some(Label::Background) {
                    edges.push(DVec2::new(x as f64 + 0.5 * dx as f64, y as f64 + 0.5 * dy as f64));
                }
            }
        }
        let some = EDGES.min(edges.len());
        let spread = (0..some).map(|at| edges[(2 * at + 1) * edges.len() / (2 * some)]);
        let corners = mask.bounds().into_iter().flat_map(|bounds| {
            let [left, right] = [bounds.x_min as f64 - 0.5, bounds.x_max as f64 + 0.5];
            let [top, low] = [bounds.y_min as f64 - 0.5, bounds.y_max as f64 + 0.5];
            [(left, top), (right, top), (left, low), (right, low)].map(DVec2::from)
        });
        SilhouetteShape {
            distances: (0..mask.labels().len()).map(kept).collect(),
            edges: spread.filter_map(taken).collect(),
            corners: corners.filter_map(taken).collect(),
            is_whole,
        }
    }

    /// The frames before and after a time, and how far it is from one to the other; the same one twice at a frame. `None` beyond
    /// the recording.
    fn at(&self, seconds: f64) -> Option<([&SilhouetteShape; 2], f64)> {
        let after = self.frames.partition_point(|frame| frame.seconds < seconds);
        let at = |index: usize| self.frames.get(index);
        let (before, after) = (after.checked_sub(1).and_then(at), at(after));
        let period = match self.frames.as_slice() {
            [first, second, ..] => second.seconds - first.seconds,
            _ => 0.0,
        };
        let is_near = |frame: &&RecordedFrame| (frame.seconds - seconds).abs() <= NEAR_FRAME * period;
        if let Some(frame) = before.filter(is_near).or(after.filter(is_near)) {
            return Some(([self.shape(frame); 2], 0.0));
        }
        let (before, after) = before.zip(after)?;
        let share = (seconds - before.seconds) / (after.seconds - before.seconds);
        Some(([self.shape(before), self.shape(after)], share))
    }
}

/// A camera as it is believed to be, and its silhouette at one moment.
struct View<'a> {
    silhouettes: &'a SilhouetteRecord,
    camera: &'a Camera,
    /// The camera that projects into the silhouettes' pictures; `None` where the believed lens is not that of the pictures.
    direct: Option<Camera>,
    shapes: [&'a SilhouetteShape; 2],
    share: f64,
    /// The box in which distances are known, on the plane at depth 1; `None` where it has no end.
    bounds: Option<[DVec2; 2]>,
}

impl<'a> View<'a> {
    fn new(silhouettes: &'a SilhouetteRecord, camera: &'a Camera, seconds: f64) -> Option<Self> {
        let (shapes, share) = silhouettes.at(seconds)?;
        let corners = || shapes.iter().flat_map(|shape| &shape.corners);
        let plane = |corner: &DVec2| {
            let ray = camera.ray_in_camera(*corner).filter(|ray| ray.z > LEAST_AHEAD)?;
            Some(ray.truncate() / ray.z)
        };
        let planes: Vec<DVec2> =
            corners().map(plane).collect::<Option<_>>().filter(|all: &Vec<_>| !all.is_empty())?;
        let low = planes.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = planes.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let margin = (LARGEST + 1.0) * silhouettes.side() / camera.intrinsics().mean_focal_px();
        let is_whole = shapes.iter().all(|shape| shape.is_whole);
        let has_same_lens = camera.distortion() == silhouettes.lens.distortion()
            && camera.intrinsics() == silhouettes.lens.intrinsics();
        let has_none = camera.distortion().is_none() && silhouettes.lens.distortion().is_none();
        let direct = (has_same_lens || has_none).then(|| camera.without_distortion());
        let bounds = is_whole.then_some([low - margin, high + margin]);
        Some(Self { silhouettes, camera, direct, shapes, share, bounds })
    }

    /// The ray of the middle of what it sees, and the tangent of half the angle that this fills.
    fn extent(&self) -> Option<(DVec3, f64)> {
        let rays: Vec<DVec3> =
            self.shapes[0].corners.iter().filter_map(|corner| self.camera.ray_in_world(*corner)).collect();
        let middle = rays.iter().copied().sum::<DVec3>().try_normalize()?;
        let cosine = rays.iter().map(|ray| ray.dot(middle)).fold(1.0, f64::min);
        Some((middle, cosine.clamp(LEAST_AHEAD, 1.0).acos().tan()))
    }

    /// Signed distance of a place, cells; `None` where the picture does not tell.
    fn distance(&self, place: DVec3) -> Option<f64> {
        let pixel = match &self.direct {
            Some(camera) => camera.project(place)?,
            None => {
                let ideal = &self.silhouettes.ideal;
                let ray = self.silhouettes.lens.ray_in_world(self.camera.project(place)?)?;
                ideal.project(ideal.centre() + ray)?
            }
        };
        let [columns, rows] = self.silhouettes.frames.first()?.cells.size;
        let cell = (pixel + 0.5) / self.silhouettes.side() - 0.5;
        let inside = cell.clamp(DVec2::ZERO, DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0));
        let beyond = cell.distance(inside);
        let (x, y) = (inside.x as usize, inside.y as usize);
        let (right, down) = ((x + 1).min(columns - 1), (y + 1).min(rows - 1));
        let part = inside - DVec2::new(x as f64, y as f64);
        let of = |shape: &SilhouetteShape| {
            if beyond > 0.5 && !shape.is_whole {
                return None;
            }
            let at = |x: usize, y: usize| f64::from(shape.distances[y * columns + x]) / f64::from(PARTS);
            let row = |y: usize| at(x, y) * (1.0 - part.x) + at(right, y) * part.x;
            Some(row(y) * (1.0 - part.y) + row(down) * part.y + beyond)
        };
        let [first, second] = self.shapes;
        if self.share > 0.0 {
            Some(of(first)? * (1.0 - self.share) + of(second)? * self.share)
        } else {
            of(first)
        }
    }
}

/// The gaps of all cameras at some frames each, with cameras and clocks as they are believed to be.
pub(super) fn gaps(all: &[SilhouetteRecord], cameras: &[Camera], clocks: &[Clock]) -> Vec<FrameGaps> {
    let mut found = Vec::new();
    for (index, (own, camera)) in all.iter().zip(cameras).enumerate() {
        let every = own.frames.len().div_ceil(FRAMES).max(1);
        for frame in own.frames.iter().skip(every / 2).step_by(every) {
            let common = clocks[index].common(frame.seconds);
            let at = |other: usize| View::new(&all[other], &cameras[other], clocks[other].own(common));
            let others: Vec<View<'_>> =
                (0..all.len()).filter(|other| *other != index).filter_map(at).collect();
            let edges = &own.shape(frame).edges;
            let region = View::new(own, camera, frame.seconds).and_then(|view| region(&view, &others));
            let gap = |edge: &DVec2| match (region, camera.ray_in_world(*edge)) {
                (Some(region), Some(ray)) => gap(camera.centre(), ray, &others, region),
                _ => LARGEST,
            };
            // Without others there is nothing to explain it.
            let edges = if others.is_empty() { &[][..] } else { edges };
            let px = edges.iter().map(|edge| gap(edge) * own.side()).collect();
            found.push(FrameGaps { camera: index, seconds: frame.seconds, px });
        }
    }
    found
}

/// A ball about what all cameras see: its middle, nearest to all middle rays, and its radius.
fn region(own: &View<'_>, others: &[View<'_>]) -> Option<(DVec3, f64)> {
    let extents: Vec<(DVec3, DVec3, f64)> = std::iter::once(own)
        .chain(others)
        .filter_map(|view| view.extent().map(|(ray, half)| (view.camera.centre(), ray, half)))
        .collect();
    let mut nearest = NearestToLines::default();
    extents.iter().for_each(|(centre, ray, _)| nearest.add(*centre, *ray, 1.0));
    let middle = nearest.solve().filter(|_| extents.len() > 1 && nearest.determinant().abs() >= 1e-6)?;
    let radius = extents.iter().map(|(centre, _, half)| half * centre.distance(middle)).fold(0.0, f64::max);
    (radius > 0.0).then_some((middle, REACH * radius))
}

/// The gap of one ray, cells.
fn gap(centre: DVec3, ray: DVec3, views: &[View<'_>], (middle, radius): (DVec3, f64)) -> f64 {
    let about = (middle - centre).dot(ray);
    let half = radius.powi(2) - (middle - centre - about * ray).length_squared();
    let half = half.max(0.0).sqrt();
    let (mut near, mut far) = ((about - half).max(1e-3 * radius), about + half);
    for view in views {
        let place = view.camera.camera_from_world();
        let (from, along) = (place.transform(centre), place.rotation * ray);
        // Keeps the z with a + z b ≥ 0.
        let mut keep = |a: f64, b: f64| {
            if b > 0.0 {
                near = near.max(-a / b);
            } else if b < 0.0 {
                far = far.min(-a / b);
            } else if a < 0.0 {
                far = f64::NEG_INFINITY;
            }
        };
        if let Some([low, high]) = view.bounds {
            keep(from.z - 1e-3 * radius, along.z);
            keep(from.x - low.x * from.z, along.x - low.x * along.z);
            keep(high.x * from.z - from.x, high.x * along.z - along.x);
            keep(from.y - low.y * from.z, along.y - low.y * along.z);
            keep(high.y * from.z - from.y, high.y * along.z - along.y);
        }
    }
    if near >= far {
        return LARGEST;
    }
    // Cells that a picture moves by in a metre along the ray, at most about.
    let rate = |view: &View<'_>| {
        let depth = |z: f64| view.camera.depth(centre + z * ray);
        let nearest = depth(near).min(depth(far)).max(0.1 * radius);
        1.5 * view.camera.intrinsics().mean_focal_px() / view.silhouettes.side() / nearest
    };
    let rate = views.iter().map(rate).fold(0.0, f64::max);
    let least = (0.7 / rate).max((far - near) / 400.0);
    let (mut best, mut z) = (LARGEST, near);
    while z <= far {
        let mut told = views.iter().filter_map(|view| view.distance(centre + z * ray)).peekable();
        let worst = if told.peek().is_some() { told.fold(f64::NEG_INFINITY, f64::max) } else { LARGEST };
        if worst <= 0.0 {
            return 0.0;
        }
        best = best.min(worst);
        z += ((worst - best) / rate).max(least);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::calibration::placed;
    use crate::fixtures;
    use crate::geometry::rotation::exp;
    use crate::silhouette::Mask;
    use glam::DMat3;

    const CAMERAS: usize = 6;
    const PICTURE: [u64; 2] = [240, 200];

    /// A ball of half a metre that moves, before cameras around it.
    fn filmed() -> Vec<Recording> {
        let camera = |number: usize| {
            let angle = 0.4 + std::f64::consts::FRAC_PI_6 * number as f64;
            let at = DVec3::new(4.0 * angle.cos(), 4.0 * angle.sin(), 1.6);
            fixtures::camera(PICTURE, [300.0, 300.0, 119.5, 99.5], at, DVec3::new(0.0, 0.0, 0.9), DVec3::Z)
        };
        let ball = |frame: usize| DVec3::new(0.05 * frame as f64 - 0.2, 0.1, 0.9);
        let recording = |number: usize| {
            let mut recording = Recording::new(camera(number));
            for frame in 0..8 {
                let own = camera(number);
                let mask = fixtures::covered(PICTURE.map(|side| side as usize), |x, y| {
                    let ray = own.ray_in_world(DVec2::new(x as f64, y as f64)).unwrap();
                    (ball(frame) - own.centre()).cross(ray).length() < 0.25
                });
                recording.push(0.1 * frame as f64, &mask);
            }
            recording
        };
        (0..CAMERAS).map(recording).collect()
    }

    fn asked(recordings: &[Recording], cameras: &[Camera], clocks: &[Clock]) -> Vec<FrameGaps> {
        let all = recordings.iter().map(|recording| SilhouetteRecord::of(recording, &recording.camera));
        gaps(&all.collect::<Vec<_>>(), cameras, clocks)
    }

    fn largest(gaps: &[FrameGaps], camera: usize) -> f64 {
        let own = gaps.iter().filter(|frame| frame.camera == camera);
        own.flat_map(|frame| frame.px.iter().copied()).fold(0.0, f64::max)
    }

    #[test]
    fn right_cameras_explain_one_another_and_a_turned_one_shows_by_how_much() {
        let recordings = filmed();
        let mut cameras: Vec<Camera> = recordings.iter().map(|recording| recording.camera.clone()).collect();
        let right = asked(&recordings, &cameras, &[Clock::RIGHT; CAMERAS]);
        assert_eq!(right.len(), CAMERAS * 8);
        assert!(right.iter().all(|frame| frame.px.len() == EDGES));
        (0..CAMERAS).for_each(|camera| assert!(largest(&right, camera) < 1.0, "{}", largest(&right, camera)));
        let place = *cameras[1].camera_from_world();
        let rotation = DMat3::from_quat(exp(DVec3::Y * 0.03)) * place.rotation;
        cameras[1] = placed(&cameras[1], rotation, -(rotation * place.centre())).unwrap();
        let turned = asked(&recordings, &cameras, &[Clock::RIGHT; CAMERAS]);
        // The ray passes at 0.25 + 0.12 m. Six cameras, of which one is left out, leave a corner at r / cos 30°, so that silhouettes
        // would have to grow by 0.07 m, 5 pixels.
        let gap = largest(&turned, 1);
        assert!((3.5..=6.5).contains(&gap), "{gap}");
        assert!(
            (0..CAMERAS).filter(|camera| *camera != 1).all(|camera| largest(&turned, camera) < gap + 1.0)
        );
    }

    #[test]
    fn a_clock_is_read_between_frames() {
        let recordings = filmed();
        let cameras: Vec<Camera> = recordings.iter().map(|recording| recording.camera.clone()).collect();
        let late = Clock { offset_s: 0.25, rate: 1.0 };
        let mut clocks = [Clock::RIGHT; CAMERAS];
        clocks[1] = late;
        let wrong = asked(&recordings, &cameras, &clocks);
        assert!(largest(&wrong, 1) > 3.0, "{}", largest(&wrong, 1));
        let all_late = asked(&recordings, &cameras, &[late; CAMERAS]);
        assert!(largest(&all_late, 1) < 1.0);
    }

    #[test]
    fn unknown_pixels_may_be_the_subject() {
        let mut recordings = filmed();
        let mut cameras: Vec<Camera> = recordings.iter().map(|recording| recording.camera.clone()).collect();
        let unknown = Mask::filled(240, 200, Label::Unknown).unwrap();
        for camera in (0..CAMERAS).filter(|camera| *camera != 1) {
            let mut blind = Recording::new(cameras[camera].clone());
            (0..8).for_each(|frame| blind.push(0.1 * frame as f64, &unknown));
            // The subject is as it was, and all else is unknown.
            for (blind, own) in blind.sightings.iter_mut().zip(&recordings[camera].sightings) {
                let (mut mask, own) =
                    (blind.cells.as_ref().unwrap().mask(), own.cells.as_ref().unwrap().mask());
                for (label, own) in mask.labels_mut().iter_mut().zip(own.labels()) {
                    *label = if *own == Label::Subject { *own } else { *label };
                }
                blind.cells = Some(MaskCells::of(&mask));
            }
            recordings[camera] = blind;
        }
        let place = *cameras[1].camera_from_world();
        let rotation = DMat3::from_quat(exp(DVec3::Y * 0.03)) * place.rotation;
        cameras[1] = placed(&cameras[1], rotation, -(rotation * place.centre())).unwrap();
        assert_eq!(largest(&asked(&recordings, &cameras, &[Clock::RIGHT; CAMERAS]), 1), 0.0);
    }
}
