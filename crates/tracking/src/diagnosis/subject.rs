//! How tall the subject is, which alone shows the unit of all lengths.

use glam::DVec3;

use super::calibration::placed;
use super::diagnose::Finding;
use super::fault::{FaultKind, Size};
use super::hypothesis::UNITS;
use super::state::State;
use crate::camera::Camera;
use crate::geometry::NearestToLines;
use crate::statistics::upper_median;

/// A subject is so tall, metres, as a rule; and at least and at most.
const TALL: f64 = 1.7;
const TALLEST: [f64; 2] = [0.55, 3.2];
/// A unit of length is told if it makes the subject so tall within this factor.
const TALL_WITHIN: f64 = 1.8;

impl State {
    /// How tall the subject is: the angle of its largest extent at its distance, the median over cameras and frames, metres.
    pub(super) fn subject(&self) -> Option<f64> {
        let extents: Vec<Vec<Option<(f64, DVec3)>>> = self
            .full
            .outlines
            .iter()
            .zip(&self.cameras)
            .map(|(outlines, camera)| outlines.extents(camera).collect())
            .collect();
        let frames = extents.iter().map(Vec::len).min().unwrap_or(0);
        let mut sizes = Vec::new();
        for frame in 0..frames {
            let seen: Vec<(usize, f64, DVec3)> = extents
                .iter()
                .enumerate()
                .filter_map(|(camera, all)| all[frame].map(|(angle, ray)| (camera, angle, ray)))
                .collect();
            let mut nearest = NearestToLines::default();
            seen.iter().for_each(|(camera, _, ray)| nearest.add(self.cameras[*camera].centre(), *ray, 1.0));
            if seen.len() < 2 || nearest.determinant().abs() < 1e-3 {
                continue;
            }
            let Some(middle) = nearest.solve() else { continue };
            let size = |(camera, angle, _): &(usize, f64, DVec3)| {
                2.0 * (0.5 * angle).tan() * middle.distance(self.cameras[*camera].centre())
            };
            sizes.extend(seen.iter().map(size));
        }
        upper_median(&mut sizes).filter(|size| size.is_finite())
    }

    /// That all lengths are in another unit, which only the subject's size shows.
    pub(super) fn unit_of_all(&self, tall: f64) -> Option<Finding> {
        if (TALLEST[0]..=TALLEST[1]).contains(&tall) {
            return None;
        }
        let wrong = |factor: f64| (tall / TALL / factor).ln().abs();
        let factors = UNITS.into_iter().flat_map(|unit| [unit, 1.0 / unit]);
        let factor = factors.min_by(|a, b| wrong(*a).total_cmp(&wrong(*b)))?;
        if wrong(factor) > TALL_WITHIN.ln() {
            return None;
        }
        let in_metres = |camera: &Camera| {
            let place = camera.camera_from_world();
            placed(camera, place.rotation, place.translation / factor)
        };
        Some(Finding {
            camera: None,
            with: None,
            kind: FaultKind::Unit,
            sizes: vec![Size { what: "unit", value: factor, deviation: None, unit: "×" }],
            since_s: None,
            evidence: f64::INFINITY,
            apart_px: None,
            keypoints_apart_px: None,
            unexplained: None,
            rivals: Vec::new(),
            cameras: self.cameras.iter().map(in_metres).collect::<Option<Vec<_>>>()?,
            clock: None,
        })
    }
}
