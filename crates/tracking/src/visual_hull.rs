//! The visual hull: what is left of space when every silhouette has cut away what it does not cover.
//!
//! Voxels are carved on a grid of equal cubes (A. Laurentini, "The visual hull concept for silhouette-based image
//! understanding", IEEE PAMI 16(2), 1994). The hull holds the body, and whatever no camera can tell from it. Lengths
//! are metres, in world axes.

mod support;

use std::borrow::Borrow;

use glam::{DVec2, DVec3};

use crate::camera::Camera;
use crate::cancel::CancelToken;
use crate::geometry::NearestToLines;
use crate::silhouette::{Label, Mask, SignedDistance};

pub use support::{UnsupportedPart, unsupported_parts};

/// Cubes along each side of the first, coarse grid.
const COARSE: usize = 24;
/// The first grid reaches so much farther than the silhouettes do.
const MARGIN: f64 = 1.25;
/// Half the diagonal of a cube of side one.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_6;

/// One camera's silhouette.
#[derive(Debug, Clone)]
pub struct HullView<C, M> {
    /// The camera, of the same picture as the silhouette: without distortion if that was rectified.
    pub camera: C,
    /// What it sees of the subject. Of what lies behind unknown pixels it cannot say whether that is the subject's.
    pub silhouette: M,
}

/// How finely is carved as a rule: cubes along the longest side of the hull's box.
pub const CELLS: usize = 64;

/// A cube at the hull's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShellVoxel {
    /// Its middle.
    pub centre: DVec3,
    /// Unit vector away from the cubes of the hull beside it.
    pub normal: DVec3,
}

/// The hull of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct VisualHull {
    /// Corners of the box that holds it: each face is within a side of a cube of the hull's own.
    pub bounds: [DVec3; 2],
    /// Side of a cube.
    pub voxel: f64,
    /// The cubes at its surface, in the order of x, y, z.
    pub shell: Vec<ShellVoxel>,
}

impl VisualHull {
    /// Carves the hull, so many cubes along the longest side of its box. A place beyond the border of a picture does not belong to it either, unless the silhouette, or
    /// what is unknown, reaches that picture's border: then that camera says nothing about it. A place must be in two
    /// pictures or more, within the silhouette in two of them, and in none of them on background; unknown pixels neither
    /// carve nor bear witness. With two silhouettes in all one witness is enough where the other cannot say. `None` with
    /// fewer than two silhouettes, with silhouettes that do not meet, or when cancelled.
    #[must_use]
    pub fn carve<C: Borrow<Camera>, M: Borrow<Mask>>(
        views: &[HullView<C, M>],
        cells: usize,
        cancel: &CancelToken,
    ) -> Option<Self> {
        let seen: Vec<CarvingView<'_>> = views
            .iter()
            .filter_map(|view| CarvingView::new(view.camera.borrow(), view.silhouette.borrow()))
            .collect();
        if seen.len() < 2 {
            return None;
        }
        let (middle, half) = region(seen.iter().map(|view| &view.extent))?;
        let coarse = Grid {
            corner: middle - DVec3::splat(half),
            side: 2.0 * half / COARSE as f64,
            counts: [COARSE; 3],
        };
        // Coarsely, whatever may hold a part of it stays.
        let [low, high] = coarse.bounds(&coarse.carve(&seen, HALF_DIAGONAL, cancel)?)?;
        let extent = high - low;
        let side = extent.max_element() / cells.max(1) as f64;
        let counts = extent.to_array().map(|length| (length / side).ceil().max(1.0) as usize);
        let fine = Grid { corner: low, side, counts };
        let held = fine.carve(&seen, 0.0, cancel)?;
        Some(Self { bounds: fine.bounds(&held)?, voxel: side, shell: fine.shell(&held) })
    }

    /// Lengths of the box along x, y and z.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.bounds[1] - self.bounds[0]
    }
}

/// Where a silhouette is in its picture.
struct Extent<'a> {
    camera: &'a Camera,
    /// Nothing of it is cut off by the picture's border, not even what is unknown.
    is_whole: bool,
    /// The ray of the middle of what it shows, and half the diagonal of that in focal lengths.
    ray: DVec3,
    spread: f64,
}

impl<'a> Extent<'a> {
    fn new(camera: &'a Camera, silhouette: &Mask) -> Option<Self> {
        let found = silhouette.bounds()?;
        let fits = (silhouette.width(), silhouette.height()) == (camera.width(), camera.height());
        let corner = |x: usize, y: usize| DVec2::new(x as f64, y as f64);
        let (low, high) = (corner(found.x_min, found.y_min), corner(found.x_max, found.y_max));
        let ray = camera.ray_in_world(0.5 * (low + high)).filter(|_| fits)?;
        let spread = 0.5 * (high - low + DVec2::ONE).length() / camera.intrinsics().mean_focal_px();
        let width = silhouette.width();
        let is_background = |label: &Label| *label == Label::Background;
        let mut rows = silhouette.labels().chunks_exact(width);
        let ends_are = |row: &[Label]| is_background(&row[0]) && is_background(&row[width - 1]);
        let is_whole = rows.clone().all(ends_are)
            && rows.next().is_some_and(|row| row.iter().all(is_background))
            && rows.next_back().is_none_or(|row| row.iter().all(is_background));
        Some(Self { camera, is_whole, ray, spread })
    }
}

/// A silhouette that shows something.
struct CarvingView<'a> {
    distance: SignedDistance,
    extent: Extent<'a>,
}

impl<'a> CarvingView<'a> {
    fn new(camera: &'a Camera, silhouette: &Mask) -> Option<Self> {
        let extent = Extent::new(camera, silhouette)?;
        Some(Self { distance: SignedDistance::from_mask(silhouette), extent })
    }

    /// What this camera says about a ball.
    fn vote(&self, point: DVec3, radius: f64) -> CameraVote {
        let Extent { camera, is_whole, .. } = self.extent;
        let unseen = if is_whole { CameraVote::Empty } else { CameraVote::Nothing };
        let Some(pixel) = camera.project(point) else { return unseen };
        let reach = radius * camera.intrinsics().mean_focal_px() / camera.depth(point);
        let (width, height) = (self.distance.width(), self.distance.height());
        let last = DVec2::new(width as f64 - 1.0, height as f64 - 1.0);
        let inside = pixel.clamp(DVec2::ZERO, last);
        if pixel.distance(inside) > reach.max(0.5) {
            return unseen;
        }
        let pixel = inside.round();
        let away = self.distance.range(pixel.y as usize * width + pixel.x as usize).map(f64::from);
        match away.map(|away| away <= reach) {
            [_, true] => CameraVote::Subject,
            [true, false] => CameraVote::Unknown,
            [false, false] => CameraVote::Empty,
        }
    }
}

/// What a camera says about a ball.
#[derive(Clone, Copy, PartialEq)]
enum CameraVote {
    /// It may hold some of the subject.
    Subject,
    /// It may, if what is unknown there is the subject.
    Unknown,
    /// It holds nothing of it.
    Empty,
    /// It is not in the picture, and the subject may reach beyond that.
    Nothing,
}

/// A cube that holds the subject: its middle, nearest to all middle rays, and half its side.
fn region<'e>(seen: impl Iterator<Item = &'e Extent<'e>> + Clone) -> Option<(DVec3, f64)> {
    let mut nearest = NearestToLines::default();
    seen.clone().for_each(|extent| nearest.add(extent.camera.centre(), extent.ray, 1.0));
    let middle = nearest.solve().filter(|_| nearest.determinant().abs() >= 1e-6)?;
    let half = seen.map(|extent| extent.spread * extent.camera.depth(middle)).fold(0.0, f64::max);
    (half > 0.0).then_some((middle, MARGIN * half))
}

/// Equal cubes in a box.
struct Grid {
    corner: DVec3,
    side: f64,
    counts: [usize; 3],
}

impl Grid {
    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.counts[1] + y) * self.counts[2] + z
    }

    fn centre(&self, cell: [usize; 3]) -> DVec3 {
        let [x, y, z] = cell.map(|index| index as f64 + 0.5);
        self.corner + self.side * DVec3::new(x, y, z)
    }

    fn cells(&self) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = self.counts;
        (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])))
    }

    /// Which cubes every camera leaves; `reach` is in sides of a cube.
    fn carve(&self, seen: &[CarvingView<'_>], reach: f64, cancel: &CancelToken) -> Option<Vec<bool>> {
        // Among many cameras one witness alone lets the hull grow along its rays over all that is dark.
        let enough = if seen.len() > 2 { 2 } else { 1 };
        let mut held = vec![false; self.counts.iter().product()];
        for cell in self.cells() {
            if cell[1] == 0 && cell[2] == 0 && cancel.is_cancelled() {
                return None;
            }
            let point = self.centre(cell);
            let (mut pictures, mut witnesses) = (0, 0);
            let is_possible = seen.iter().all(|view| {
                let vote = view.vote(point, reach * self.side);
                pictures += usize::from(vote != CameraVote::Nothing);
                witnesses += usize::from(vote == CameraVote::Subject);
                vote != CameraVote::Empty
            });
            held[self.index(cell)] = is_possible && pictures >= 2 && witnesses >= enough;
        }
        Some(held)
    }

    /// Corners of the box about all cubes that are held.
    fn bounds(&self, held: &[bool]) -> Option<[DVec3; 2]> {
        let half = DVec3::splat(0.5 * self.side);
        let centres = self.cells().filter(|cell| held[self.index(*cell)]).map(|cell| self.centre(cell));
        let (low, high) = centres
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        low.is_finite().then_some([low - half, high + half])
    }

    fn shell(&self, held: &[bool]) -> Vec<ShellVoxel> {
        let is_held = |cell: [usize; 3], axis: usize, by: isize| {
            let moved = cell[axis].checked_add_signed(by).filter(|index| *index < self.counts[axis]);
            moved.is_some_and(|index| {
                let mut other = cell;
                other[axis] = index;
                held[self.index(other)]
            })
        };
        let mut shell = Vec::new();
        for cell in self.cells().filter(|cell| held[self.index(*cell)]) {
            let mut inward = DVec3::ZERO;
            let mut neighbours = 0;
            for (axis, direction) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
                for (by, side) in [(-1, -1.0), (1, 1.0)] {
                    if is_held(cell, axis, by) {
                        neighbours += 1;
                        inward += side * direction;
                    }
                }
            }
            if neighbours < 6 {
                shell.push(ShellVoxel { centre: self.centre(cell), normal: (-inward).normalize_or_zero() });
            }
        }
        shell
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures;

    const LOW: DVec3 = DVec3::new(-0.3, -0.2, 0.1);
    const HIGH: DVec3 = DVec3::new(0.4, 0.3, 1.5);

    fn camera(at: DVec3, up: DVec3) -> Camera {
        fixtures::camera([320, 240], [900.0, 900.0, 159.5, 119.5], at, 0.5 * (LOW + HIGH), up)
    }

    /// The silhouette of a box, by its slabs.
    fn silhouette(camera: &Camera) -> Mask {
        fixtures::covered([320, 240], |x, y| {
            let (eye, ray) = (camera.centre(), camera.ray_in_world(DVec2::new(x as f64, y as f64)).unwrap());
            let (to_low, to_high) = ((LOW - eye) / ray, (HIGH - eye) / ray);
            let (enter, leave) = (to_low.min(to_high).max_element(), to_low.max(to_high).min_element());
            enter <= leave
        })
    }

    fn views(places: &[(DVec3, DVec3)]) -> Vec<HullView<Camera, Mask>> {
        let view = |&(at, up): &(DVec3, DVec3)| {
            let camera = camera(at, up);
            HullView { silhouette: silhouette(&camera), camera }
        };
        places.iter().map(view).collect()
    }

    fn carve(views: &[HullView<Camera, Mask>]) -> Option<VisualHull> {
        VisualHull::carve(views, CELLS, &CancelToken::new())
    }

    #[test]
    fn a_box_seen_from_far_along_its_axes_is_its_own_hull() {
        let far = 8.0;
        let hull = carve(&views(&[
            (DVec3::new(far, 0.05, 0.8), DVec3::Z),
            (DVec3::new(0.05, -far, 0.8), DVec3::Z),
            (DVec3::new(0.05, 0.05, far), DVec3::Y),
        ]))
        .unwrap();
        // A cube, and what perspective leaves beside it.
        let tolerance = hull.voxel + 0.03;
        assert!((hull.bounds[0] - LOW).abs().max_element() < tolerance, "{:?}", hull.bounds);
        assert!((hull.bounds[1] - HIGH).abs().max_element() < tolerance, "{:?}", hull.bounds);
        assert!((hull.size() - (HIGH - LOW)).abs().max_element() < 2.0 * tolerance);
        for voxel in &hull.shell {
            let inside = (voxel.centre - LOW).min(HIGH - voxel.centre).min_element();
            assert!(inside > -tolerance && inside < tolerance, "{voxel:?} is not at the surface");
        }
        let top = hull.shell.iter().filter(|voxel| voxel.normal.z > 0.99).count();
        assert!(top > 100, "{top}");
    }

    #[test]
    fn more_cameras_leave_less() {
        let places: Vec<(DVec3, DVec3)> = [0.3_f64, 1.1, 1.9, 2.7, 3.6]
            .iter()
            .map(|angle| (DVec3::new(7.0 * angle.cos(), 7.0 * angle.sin(), 1.6), DVec3::Z))
            .collect();
        let all = views(&places);
        let mut before = f64::INFINITY;
        for count in 2..=all.len() {
            let hull = carve(&all[..count]).unwrap();
            let volume = hull.size().element_product();
            assert!(volume < before + 0.02, "{count} cameras: {volume} after {before}");
            before = volume;
            let tolerance = hull.voxel;
            assert!((LOW - hull.bounds[0]).min_element() > -tolerance, "{:?}", hull.bounds);
            assert!((hull.bounds[1] - HIGH).min_element() > -tolerance, "{:?}", hull.bounds);
        }
    }

    #[test]
    fn no_hull_without_two_silhouettes_that_meet() {
        let two = views(&[(DVec3::new(5.0, 0.0, 0.8), DVec3::Z), (DVec3::new(0.0, 5.0, 0.8), DVec3::Z)]);
        assert!(carve(&two).is_some());
        assert_eq!(carve(&two[..1]), None);
        let mut blank = two.clone();
        blank[1].silhouette = Mask::filled(320, 240, Label::Background).unwrap();
        assert_eq!(carve(&blank), None);
        let mut other_size = two.clone();
        other_size[1].silhouette = Mask::filled(32, 24, Label::Subject).unwrap();
        assert_eq!(carve(&other_size), None);
        let same = [two[0].clone(), two[0].clone()];
        assert_eq!(carve(&same), None, "one ray twice has no middle");
        let cancelled = CancelToken::new();
        cancelled.cancel();
        assert_eq!(VisualHull::carve(&two, CELLS, &cancelled), None);
    }

    /// Makes everything between two heights unknown.
    fn veil(view: &mut HullView<Camera, Mask>, heights: std::ops::Range<f64>) {
        let rows = [heights.start, heights.end].map(|z| {
            let middle = (0.5 * (LOW + HIGH)).with_z(z);
            view.camera.project(middle).unwrap().y as usize
        });
        let width = view.silhouette.width();
        view.silhouette.labels_mut()[rows[1] * width..rows[0] * width].fill(Label::Unknown);
    }

    #[test]
    fn what_is_unknown_neither_carves_nor_bears_witness() {
        let far = [DVec3::new(8.0, 0.05, 0.8), DVec3::new(0.05, -8.0, 0.8), DVec3::new(-6.0, -6.0, 0.8)];
        let all = views(&far.map(|at| (at, DVec3::Z)));
        for count in [2, 3] {
            let whole = carve(&all[..count]).unwrap();
            // Dark shorts before a dark floor, in one picture, then in all.
            let mut views = all[..count].to_vec();
            veil(&mut views[0], 0.6..0.9);
            let veiled = carve(&views).unwrap();
            let between = |hull: &VisualHull| {
                let heights = hull.shell.iter().map(|voxel| voxel.centre.z);
                heights.filter(|z| (0.65..0.85).contains(z)).count()
            };
            assert!(between(&veiled) >= between(&whole), "{} of {}", between(&veiled), between(&whole));
            for (end, whole) in veiled.bounds.iter().zip(whole.bounds) {
                // The others carve where one cannot: no farther than their silhouettes' own ends, in height.
                assert!((end.z - whole.z).abs() < 2.0 * veiled.voxel, "{:?}", veiled.bounds);
            }
            (1..count).for_each(|view| veil(&mut views[view], 0.6..0.9));
            assert_eq!(between(&carve(&views).unwrap()), 0, "nobody sees anything there");
        }
        let mut blind = all[..2].to_vec();
        blind.iter_mut().for_each(|view| view.silhouette.labels_mut().fill(Label::Unknown));
        assert_eq!(carve(&blind), None);
    }

    #[test]
    fn what_is_unknown_at_the_border_may_go_on_beyond() {
        let far = [DVec3::new(3.0, 0.05, 0.8), DVec3::new(0.05, -8.0, 0.8), DVec3::new(-6.0, -6.0, 0.8)];
        let mut all = views(&far.map(|at| (at, DVec3::Z)));
        let whole = carve(&all).unwrap();
        let labels = all[0].silhouette.labels_mut();
        assert!(labels[..320].contains(&Label::Subject), "it is cut off");
        labels[..10 * 320].fill(Label::Unknown);
        labels[230 * 320..].fill(Label::Unknown);
        let veiled = carve(&all).unwrap();
        assert!((veiled.size().z - whole.size().z).abs() < 2.0 * veiled.voxel, "{:?}", veiled.bounds);
    }
}
