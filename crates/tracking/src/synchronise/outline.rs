//! What is kept of a silhouette: its convex hull as rays, which of its corners may not be the subject's, its area, and its cells.
//!
//! A half-plane that touches a silhouette touches its convex hull, so a few dozen rays a frame are enough, however large
//! the pictures are.

use glam::{DVec2, DVec3};

use super::cells::MaskCells;
use crate::camera::Camera;
use crate::silhouette::{Label, Mask};
use crate::statistics::upper_median;

/// Subject pixels, itself included, that a pixel must have in the 3 × 3 around it to count: specks and spurs do not.
const NEIGHBOURS: usize = 4;
/// A corner this close to the picture's border may not be the subject's own, pixels.
const REACH: f64 = 2.0;

/// A corner of a silhouette's convex hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    /// Unit, in world axes.
    pub(crate) ray: DVec3,
    /// The subject may go on here: the picture ends. Beside unknown pixels it may too, and such corners count all the same:
    /// on real footage with shadows and dark clothes leaving them out loses more (10 of 15 offsets told, 15 of 15 with them).
    pub(crate) is_open: bool,
}

/// One camera's silhouette at one time.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sighting {
    pub(crate) seconds: f64,
    /// In order round the hull; empty where nothing is seen.
    pub(crate) hull: Vec<Corner>,
    /// Subject pixels.
    pub(crate) area: f64,
    /// Unit rays to joints in world axes, in an order that all cameras share; empty without keypoints.
    pub(crate) keypoints: Vec<Option<DVec3>>,
    /// The silhouette itself, coarsely, in the recording's [pictures](Recording::pictures).
    pub(crate) cells: Option<MaskCells>,
}

/// What one camera saw over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    pub(crate) camera: Camera,
    pub(crate) sightings: Vec<Sighting>,
    /// The camera of the silhouettes and that of the pictures as they were taken, where other numbers are believed of both.
    pub(crate) pictures: Option<Box<[Camera; 2]>>,
    /// The first mask that was not of the camera's size.
    pub(crate) wrong_size: Option<usize>,
}

impl Recording {
    /// Nothing seen yet. The camera is that of the masks: without distortion if they were rectified.
    #[must_use]
    pub fn new(camera: Camera) -> Self {
        Self { camera, sightings: Vec::new(), pictures: None, wrong_size: None }
    }

    /// Adds a silhouette at a time by the camera's own clock, seconds, later than the one before. A mask without subject
    /// counts as an unknown moment.
    pub fn push(&mut self, seconds: f64, mask: &Mask) {
        if [mask.width(), mask.height()] != [self.camera.width(), self.camera.height()] {
            self.wrong_size.get_or_insert(self.sightings.len());
        }
        let corners = hull(edge_points(mask));
        let corner = |pixel: DVec2| {
            let is_open = is_open(mask, pixel);
            self.camera.ray_in_world(pixel).map(|ray| Corner { ray, is_open })
        };
        let hull = corners.into_iter().filter_map(corner).collect();
        let area = mask.count(Label::Subject) as f64;
        let cells = Some(MaskCells::of(mask));
        self.sightings.push(Sighting { seconds, hull, area, keypoints: Vec::new(), cells });
    }

    /// Gives a frame that was [pushed](Self::push) its keypoints: the same joints in the same order for all cameras and frames, in
    /// pixels of this camera. `None` for those that it does not show.
    pub fn set_keypoints(&mut self, frame: usize, pixels: &[Option<DVec2>]) {
        let ray = |pixel: &Option<DVec2>| pixel.and_then(|pixel| self.camera.ray_in_world(pixel));
        if let Some(sighting) = self.sightings.get_mut(frame) {
            sighting.keypoints = pixels.iter().map(ray).collect();
        }
    }

    /// Frames so far.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.sightings.len()
    }

    /// Frames with a silhouette.
    pub(super) fn seen(&self) -> usize {
        self.sightings.iter().filter(|sighting| !sighting.hull.is_empty()).count()
    }

    /// The middle length of time between two frames, seconds.
    pub(crate) fn period(&self) -> f64 {
        let mut steps: Vec<f64> =
            self.sightings.windows(2).map(|pair| pair[1].seconds - pair[0].seconds).collect();
        upper_median(&mut steps).unwrap_or(0.0)
    }

    /// First and last time.
    #[must_use]
    pub fn span(&self) -> [f64; 2] {
        let time = |sighting: Option<&Sighting>| sighting.map_or(0.0, |sighting| sighting.seconds);
        [time(self.sightings.first()), time(self.sightings.last())]
    }
}

/// Corners of the first and last pixel of every row.
fn edge_points(mask: &Mask) -> Vec<DVec2> {
    let mut points = Vec::new();
    for (y, row) in mask.labels().chunks_exact(mask.width()).enumerate() {
        let is_firm = |&x: &usize| row[x] == Label::Subject && neighbours(mask, x, y) >= NEIGHBOURS;
        let Some(first) = (0..row.len()).find(is_firm) else { continue };
        let last = (first..row.len()).rev().find(is_firm).unwrap_or(first);
        for (x, side) in [(first, -0.5), (last, 0.5)] {
            for up in [-0.5, 0.5] {
                points.push(DVec2::new(x as f64 + side, y as f64 + up));
            }
        }
    }
    points
}

/// Subject pixels in the 3 × 3 about a pixel.
fn neighbours(mask: &Mask, x: usize, y: usize) -> usize {
    let (rows, columns) = (y.saturating_sub(1)..y + 2, x.saturating_sub(1)..x + 2);
    let labels = rows.flat_map(|y| columns.clone().map(move |x| mask.get(x, y)));
    labels.filter(|label| *label == Some(Label::Subject)).count()
}

/// Whether the picture ends so near to a corner that the subject may go on beyond it.
fn is_open(mask: &Mask, pixel: DVec2) -> bool {
    let last = DVec2::new(mask.width() as f64 - 1.0, mask.height() as f64 - 1.0);
    pixel.min_element() < REACH - 0.5 || (last - pixel).min_element() < REACH - 0.5
}

/// The convex hull (A. Andrew, "Another efficient algorithm for convex hulls in two dimensions", 1979).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain.as_slice()
                && (*b - *a).perp_dot(point - *a) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.append(&mut half(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures;

    #[test]
    fn a_hull_keeps_corners_and_leaves_out_specks() {
        let mask = Mask::from_ascii(
            "
            ........
            ...##..#
            ...##...
            ..####..
            ...##...
            ........
        ",
        )
        .unwrap();
        let hull = hull(edge_points(&mask));
        let has = |x: f64, y: f64| hull.contains(&DVec2::new(x, y));
        assert!(has(2.5, 0.5) && has(4.5, 0.5) && has(4.5, 4.5) && has(1.5, 2.5), "{hull:?}");
        assert!(hull.iter().all(|corner| corner.x < 6.0), "the speck: {hull:?}");
        let area: f64 = (0..hull.len()).map(|i| hull[i].perp_dot(hull[(i + 1) % hull.len()])).sum();
        assert!(area > 0.0, "in one order round");
    }

    #[test]
    fn corners_at_the_border_are_open() {
        let mut mask = Mask::filled(40, 30, Label::Background).unwrap();
        for y in 10..30 {
            mask.labels_mut()[y * 40 + 12..y * 40 + 18].fill(Label::Subject);
        }
        let at = DVec3::new(0.0, -3.0, 1.0);
        let camera = fixtures::camera([40, 30], [40.0, 40.0, 19.5, 14.5], at, DVec3::Z, DVec3::Z);
        let mut recording = Recording::new(camera.clone());
        recording.push(0.0, &mask);
        let hull = &recording.sightings[0].hull;
        assert_eq!(hull.len(), 4);
        for corner in hull {
            let pixel = camera.project(camera.centre() + corner.ray).unwrap();
            assert_eq!(corner.is_open, pixel.y > 20.0, "{pixel}");
        }
    }
}
