//! Bundle adjustment: cameras and points in space, moved together until the points are seen where they are marked.
//!
//! B. Triggs and others, "Bundle Adjustment: A Modern Synthesis" (2000): Levenberg-Marquardt on
//! the cameras alone, the points eliminated (Schur complement), a robust loss (Cauchy) on the distances in pixels. A calibration
//! that is given is not thrown away: every camera is held to what it was by deviations that calibrations have. What the
//! sightings cannot tell, where the whole rig stands, turns and how large it is, stays as it was: the points found are laid
//! over the points given by the similarity that fits them best (S. Umeyama, IEEE PAMI 13(4), 1991).

use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3};

use super::{Camera, CameraChange, CameraFromWorld};
use crate::geometry::umeyama;
use crate::optimize::{DescentOptions, StructuredLeastSquares, descend};
use crate::statistics::upper_median;

/// Numbers of one camera: turn, place of the centre, logarithm of the focal length, principal point.
const COLUMNS: usize = 9;
/// Steps of central differences, by column.
const DIFFERENCES: [f64; COLUMNS] = [1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-2, 1e-2];
/// The same of a point, metres.
const POINT_DIFFERENCE: f64 = 1e-5;
/// Standard deviation of a sighting, as a share of the picture's height.
const SIGHTING: f64 = 0.005;
/// Of a camera's turn about each axis, radians.
const TURN_RAD: f64 = 0.02;
/// Of a camera's place along each axis, metres.
const PLACE_M: f64 = 0.03;
/// Of the focal length, as a share of it.
const FOCAL: f64 = 0.005;
/// Of the principal point, as a share of the picture's height.
const PRINCIPAL: f64 = 0.005;
/// Most rounds.
const ROUNDS: usize = 60;
/// A round that lowers the cost by a smaller share is the last one.
const TOLERANCE: f64 = 1e-6;
/// Damping beyond which no step helps.
const MOST_DAMPING: f64 = 1e12;

type CameraRow = SMatrix<f64, 2, COLUMNS>;
type PointRow = SMatrix<f64, 2, 3>;

/// Where a camera sees a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// Index of the camera.
    pub camera: usize,
    /// Index of the point.
    pub point: usize,
    /// Pixels.
    pub pixel: DVec2,
}

/// Cameras that see the points where they are marked, as far as that can be.
#[derive(Debug, Clone, PartialEq)]
pub struct Adjusted {
    /// The cameras, in their order.
    pub cameras: Vec<Camera>,
    /// The points, world metres.
    pub points: Vec<DVec3>,
    /// Median distance of the sightings from where the points are seen, pixels: before, with the points given, and after.
    pub median_px: [f64; 2],
}

/// Adjusts cameras and points to the sightings. `None` where fewer than two cameras see a point, an index is beyond its
/// list, or the sightings say nothing about the cameras.
pub fn adjust(cameras: &[Camera], points: &[DVec3], sightings: &[Sighting]) -> Option<Adjusted> {
    let is_known = |sighting: &Sighting| sighting.camera < cameras.len() && sighting.point < points.len();
    let mut seeing: Vec<usize> = sightings.iter().map(|sighting| sighting.camera).collect();
    seeing.sort_unstable();
    seeing.dedup();
    if seeing.len() < 2 || !sightings.iter().all(is_known) {
        return None;
    }
    let mut bundle = Bundle { given: cameras, sightings, equations: None };
    let none = vec![[0.0; COLUMNS]; cameras.len()];
    let before = bundle.median_px(cameras, points);
    let start = Adjustment { changes: none, cameras: cameras.to_vec(), points: points.to_vec() };
    let descent = DescentOptions {
        damping: 1e-3,
        lower: |damping| (damping / 5.0).max(1e-9),
        raise: |damping| 4.0 * damping,
        most_damping: MOST_DAMPING,
        max_trials: usize::MAX,
        max_steps: ROUNDS,
        tolerance: TOLERANCE,
    };
    let found = descend(&mut bundle, start, &descent);
    let (cameras, points) = aligned(&found.cameras, &found.points, points)?;
    let median_px = [before?, bundle.median_px(&cameras, &points)?];
    Some(Adjusted { cameras, points, median_px })
}

#[derive(Debug, Clone)]
struct Adjustment {
    changes: Vec<[f64; COLUMNS]>,
    cameras: Vec<Camera>,
    points: Vec<DVec3>,
}

struct Bundle<'a> {
    given: &'a [Camera],
    sightings: &'a [Sighting],
    equations: Option<Equations>,
}

impl StructuredLeastSquares for Bundle<'_> {
    type Point = Adjustment;

    fn linearise(&mut self, point: &Adjustment) {
        self.equations = Some(self.equations(point));
    }

    fn trial(&mut self, point: &Adjustment, damping: f64) -> Option<Adjustment> {
        let step = self.equations.as_ref()?.step(damping)?;
        self.moved(point, &step)
    }

    /// Twice the negative logarithm of the likelihood. A point behind its camera counts as a hundred deviations.
    fn cost(&mut self, state: &Adjustment) -> f64 {
        let of_sightings = self.sightings.iter().map(|sighting| {
            let miss = self.miss(sighting, &state.cameras[sighting.camera], state.points[sighting.point]);
            miss.map_or(1e4, DVec2::length_squared).ln_1p()
        });
        let of_cameras = state.changes.iter().enumerate().map(|(camera, changes)| {
            let deviations = self.deviations(camera);
            changes
                .iter()
                .zip(deviations)
                .map(|(change, deviation)| (change / deviation).powi(2))
                .sum::<f64>()
        });
        of_sightings.sum::<f64>() + of_cameras.sum::<f64>()
    }
}

impl Bundle<'_> {
    /// A camera that is changed by these numbers.
    fn changed(&self, camera: usize, by: &[f64; COLUMNS]) -> Option<Camera> {
        let change = CameraChange {
            turn: DVec3::new(by[0], by[1], by[2]),
            shift: DVec3::new(by[3], by[4], by[5]),
            zoom: by[6],
            principal_px: DVec2::new(by[7], by[8]),
        };
        self.given[camera].changed(&change).ok()
    }

    /// What a camera's numbers deviate by.
    fn deviations(&self, camera: usize) -> [f64; COLUMNS] {
        let principal = PRINCIPAL * self.given[camera].height() as f64;
        [TURN_RAD, TURN_RAD, TURN_RAD, PLACE_M, PLACE_M, PLACE_M, FOCAL, principal, principal]
    }

    /// How far a sighting is off, in deviations.
    fn miss(&self, sighting: &Sighting, camera: &Camera, point: DVec3) -> Option<DVec2> {
        let deviation_px = SIGHTING * self.given[sighting.camera].height() as f64;
        Some((camera.project(point)? - sighting.pixel) / deviation_px)
    }

    /// The normal equations, each sighting weighed by the loss.
    fn equations(&self, state: &Adjustment) -> Equations {
        let count = COLUMNS * state.cameras.len();
        let mut equations = Equations {
            cameras: DMatrix::zeros(count, count),
            of_cameras: DVector::zeros(count),
            points: vec![(Matrix3::zeros(), Vector3::zeros()); state.points.len()],
            both: vec![Vec::new(); state.points.len()],
        };
        for (camera, changes) in state.changes.iter().enumerate() {
            for (column, (change, deviation)) in changes.iter().zip(self.deviations(camera)).enumerate() {
                let (at, weight) = (COLUMNS * camera + column, deviation.powi(-2));
                equations.cameras[(at, at)] += weight;
                equations.of_cameras[at] -= weight * change;
            }
        }
        let beside: Vec<[Option<[Camera; 2]>; COLUMNS]> = (0..state.cameras.len())
            .map(|camera| self.nudged_cameras(camera, &state.changes[camera]))
            .collect();
        for sighting in self.sightings {
            let camera = &state.cameras[sighting.camera];
            let point = state.points[sighting.point];
            let Some(miss) = self.miss(sighting, camera, point) else { continue };
            let weight = 1.0 / (1.0 + miss.length_squared());
            let sides = |sides: [Option<DVec2>; 2], step: f64| match sides {
                [Some(after), Some(before)] => (after - before) / (2.0 * step),
                _ => DVec2::ZERO,
            };
            let of_camera = CameraRow::from_fn(|row, column| {
                let Some(pair) = &beside[sighting.camera][column] else { return 0.0 };
                let misses = [0, 1].map(|side| self.miss(sighting, &pair[side], point));
                sides(misses, DIFFERENCES[column])[row]
            });
            let of_point = PointRow::from_fn(|row, column| {
                let step = POINT_DIFFERENCE * DVec3::AXES[column];
                let misses = [point + step, point - step].map(|point| self.miss(sighting, camera, point));
                sides(misses, POINT_DIFFERENCE)[row]
            });
            equations.add(sighting, &of_camera, &of_point, weight, -miss);
        }
        equations
    }

    /// A camera with each of its numbers a little larger and a little smaller.
    fn nudged_cameras(&self, camera: usize, changes: &[f64; COLUMNS]) -> [Option<[Camera; 2]>; COLUMNS] {
        std::array::from_fn(|column| {
            let side = |by: f64| {
                let mut changes = *changes;
                changes[column] += by * DIFFERENCES[column];
                self.changed(camera, &changes)
            };
            Some([side(1.0)?, side(-1.0)?])
        })
    }

    fn moved(&self, state: &Adjustment, (by_cameras, by_points): &BundleStep) -> Option<Adjustment> {
        let mut changes = state.changes.clone();
        for (change, by) in changes.iter_mut().flatten().zip(by_cameras.iter()) {
            *change += by;
        }
        let cameras =
            (0..changes.len()).map(|camera| self.changed(camera, &changes[camera])).collect::<Option<_>>()?;
        let points = state.points.iter().zip(by_points).map(|(point, by)| *point + *by).collect();
        Some(Adjustment { changes, cameras, points })
    }

    fn median_px(&self, cameras: &[Camera], points: &[DVec3]) -> Option<f64> {
        let mut misses: Vec<f64> = self
            .sightings
            .iter()
            .filter_map(|sighting| {
                let seen = cameras[sighting.camera].project(points[sighting.point])?;
                Some(seen.distance(sighting.pixel))
            })
            .collect();
        upper_median(&mut misses)
    }
}

/// `JᵀWJ` and `−JᵀWr`: of the cameras, of each point, and of both together for each camera that sees the point.
struct Equations {
    cameras: DMatrix<f64>,
    of_cameras: DVector<f64>,
    points: Vec<(Matrix3<f64>, Vector3<f64>)>,
    both: Vec<Vec<(usize, SMatrix<f64, COLUMNS, 3>)>>,
}

/// By how much cameras and points move.
type BundleStep = (DVector<f64>, Vec<DVec3>);

impl Equations {
    fn add(&mut self, sighting: &Sighting, camera: &CameraRow, point: &PointRow, weight: f64, right: DVec2) {
        let right = SVector::<f64, 2>::new(right.x, right.y) * weight;
        let at = COLUMNS * sighting.camera;
        let mut block = self.cameras.fixed_view_mut::<COLUMNS, COLUMNS>(at, at);
        block += camera.transpose() * camera * weight;
        let mut part = self.of_cameras.fixed_rows_mut::<COLUMNS>(at);
        part += camera.transpose() * right;
        let (matrix, side) = &mut self.points[sighting.point];
        *matrix += point.transpose() * point * weight;
        *side += point.transpose() * right;
        self.both[sighting.point].push((at, camera.transpose() * point * weight));
    }

    /// The step with this damping of each diagonal. `None` where the equations have no solution.
    fn step(&self, damping: f64) -> Option<BundleStep> {
        let (mut matrix, mut right) = (self.cameras.clone(), self.of_cameras.clone());
        for at in 0..right.len() {
            matrix[(at, at)] *= 1.0 + damping;
        }
        let damped = |(matrix, _): &(Matrix3<f64>, Vector3<f64>)| {
            let mut matrix = *matrix;
            (0..3).for_each(|at| matrix[(at, at)] = matrix[(at, at)] * (1.0 + damping) + 1e-9);
            matrix.try_inverse()
        };
        let inverses: Vec<Matrix3<f64>> = self.points.iter().map(damped).collect::<Option<_>>()?;
        for (point, inverse) in inverses.iter().enumerate() {
            for (at, block) in &self.both[point] {
                let through = block * inverse;
                let mut part = right.fixed_rows_mut::<COLUMNS>(*at);
                part -= through * self.points[point].1;
                for (other, beside) in &self.both[point] {
                    let mut part = matrix.fixed_view_mut::<COLUMNS, COLUMNS>(*at, *other);
                    part -= through * beside.transpose();
                }
            }
        }
        let cameras = matrix.cholesky()?.solve(&right);
        let points = inverses.iter().enumerate().map(|(point, inverse)| {
            let mut side = self.points[point].1;
            for (at, block) in &self.both[point] {
                side -= block.transpose() * cameras.fixed_rows::<COLUMNS>(*at);
            }
            let step = inverse * side;
            DVec3::new(step.x, step.y, step.z)
        });
        let points = points.collect();
        Some((cameras, points))
    }
}

/// Cameras and points moved, turned and scaled together so that the points lie over those given. All are seen as before.
fn aligned(cameras: &[Camera], points: &[DVec3], given: &[DVec3]) -> Option<(Vec<Camera>, Vec<DVec3>)> {
    let similarity = umeyama(points, given)?;
    let camera = |camera: &Camera| {
        let rotation = camera.camera_from_world().rotation * similarity.rotation.transpose();
        let translation = -(rotation * similarity.apply(camera.centre()));
        let place = CameraFromWorld { rotation, translation };
        camera.with_numbers(*camera.intrinsics(), *camera.distortion(), place).ok()
    };
    let cameras = cameras.iter().map(camera).collect::<Option<_>>()?;
    Some((cameras, points.iter().map(|&point| similarity.apply(point)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Distortion, Intrinsics};

    /// Four cameras round a room, and points as a person leaves them.
    fn scene() -> (Vec<Camera>, Vec<DVec3>, Vec<Sighting>) {
        let lens = Distortion::OpenCv { k1: -0.05, k2: 0.1, p1: 5e-4, p2: 5e-4, k3: 0.0 };
        let cameras: Vec<Camera> = (0..4)
            .map(|k| {
                let angle = 0.4 + 1.5 * f64::from(k);
                let centre = DVec3::new(3.5 * angle.cos(), 3.5 * angle.sin(), 1.2 + 0.3 * f64::from(k));
                let place = CameraFromWorld::looking_at(centre, DVec3::new(0.0, 0.0, 1.0), DVec3::Z);
                let intrinsics = Intrinsics { fx: 1600.0, fy: 1600.0, cx: 540.0, cy: 960.0 };
                Camera::new(&format!("c{k}"), [1080, 1920], intrinsics, lens, place).unwrap()
            })
            .collect();
        let wave = |k: usize, by: f64| (by * (k as f64 + 1.0)).sin();
        let points: Vec<DVec3> = (0..150)
            .map(|k| DVec3::new(0.5 * wave(k, 1.3), 0.5 * wave(k, 2.9), 1.0 + 0.7 * wave(k, 4.7)))
            .collect();
        let seen = points.iter().enumerate().flat_map(|(point, &at)| {
            let cameras = cameras.iter().enumerate();
            cameras
                .filter_map(move |(camera, seen)| Some(Sighting { camera, point, pixel: seen.project(at)? }))
        });
        let sightings = seen.collect();
        (cameras, points, sightings)
    }

    /// A calibration that is off by what calibrations are off by.
    fn disturbed(cameras: &[Camera]) -> Vec<Camera> {
        let bundle = Bundle { given: cameras, sightings: &[], equations: None };
        let off = |k: usize| {
            std::array::from_fn(|column| {
                [0.004, 0.01, 0.002, 6.0][[0, 0, 0, 1, 1, 1, 2, 3, 3][column]]
                    * (7.0 * (k + 1) as f64 + column as f64).sin()
            })
        };
        (0..cameras.len()).map(|k| bundle.changed(k, &off(k)).unwrap()).collect()
    }

    #[test]
    fn a_disturbed_calibration_is_found_again_from_points_that_move_through_it() {
        let (cameras, points, mut sightings) = scene();
        // One in twenty is somewhere else altogether.
        for sighting in sightings.iter_mut().step_by(20) {
            sighting.pixel += DVec2::new(170.0, -230.0);
        }
        let given = disturbed(&cameras);
        let adjusted = adjust(&given, &points, &sightings).unwrap();
        let [before, after] = adjusted.median_px;
        assert!(before > 6.0 && after < 0.3, "{before} px before, {after} px after");
        // The points given are the true ones: the rig lies where it was.
        for (camera, (found, truth)) in adjusted.cameras.iter().zip(&cameras).enumerate() {
            let off = found.centre().distance(truth.centre());
            assert!(off < 0.01, "camera {camera} is {off} m off");
        }
        let off = adjusted.points.iter().zip(&points).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(off < 0.01, "{off}");
    }

    #[test]
    fn an_exact_calibration_stays_as_it_is() {
        let (cameras, points, sightings) = scene();
        let adjusted = adjust(&cameras, &points, &sightings).unwrap();
        for (found, truth) in adjusted.cameras.iter().zip(&cameras) {
            assert!(found.centre().distance(truth.centre()) < 1e-6);
        }
    }

    #[test]
    fn one_camera_or_a_point_that_is_not_there_is_no_bundle() {
        let (cameras, points, sightings) = scene();
        let alone: Vec<Sighting> =
            sightings.iter().copied().filter(|sighting| sighting.camera == 0).collect();
        assert_eq!(adjust(&cameras, &points, &alone), None);
        assert_eq!(adjust(&cameras, &points[..9], &sightings), None);
        assert_eq!(adjust(&[], &[], &[]), None);
    }
}
