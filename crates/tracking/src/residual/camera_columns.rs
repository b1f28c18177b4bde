//! A camera's own columns beside those of poses and sizes.
//!
//! A camera that turns by ω about its centre C, or moves by s, sees the body turn by −ω about C, or move by −s. A camera whose
//! clock is late by τ sees the body where it is τ later: every column of the pose times its rate. Focal length and principal
//! point have components of their own.

use glam::{DMat3, DVec3};

use super::body_size::{PINHOLE, SizeColumn, SizeMap, SizeVector, rigid, unit};
use crate::camera::Camera;
use crate::geometry::rotation::exp;

/// Where a camera's columns stand, and what they need. What is not free has no column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CameraColumns<'a> {
    /// The camera as it is now.
    pub(crate) camera: &'a Camera,
    /// First of six: turn in the camera's axes, move of the centre in the world's.
    pub(crate) place: usize,
    /// Of the focal length's logarithm.
    pub(crate) zoom: Option<usize>,
    /// First of the principal point's two.
    pub(crate) principal: Option<usize>,
    /// Of the clock: columns, with what a unit of them is in seconds.
    pub(crate) clock: [Option<(usize, f64)>; 2],
    /// Rates of the pose's columns, per second.
    pub(crate) rates: &'a [f64],
    /// By how many seconds the camera's clock is late: `kinematics` are those of the pose so much later.
    pub(crate) late_s: f64,
}

impl CameraColumns<'_> {
    /// The camera's columns for a limb. The pose's, in `path`, become those of the pose that is `late_s` earlier.
    pub(super) fn columns(&self, limb: usize, map: &SizeMap<'_>, path: &mut [SizeColumn]) -> Vec<SizeColumn> {
        let place = self.camera.camera_from_world();
        let arm = map.kinematics.starts()[limb] - self.camera.centre();
        let mut columns = Vec::with_capacity(11);
        for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
            let turn = place.rotation.transpose() * unit;
            columns.push(SizeColumn { index: self.place + axis, motion: rigid(turn.cross(arm), turn) });
            columns.push(SizeColumn { index: self.place + 3 + axis, motion: rigid(-unit, DVec3::ZERO) });
        }
        columns.extend(self.zoom.map(|index| SizeColumn { index, motion: unit(PINHOLE) }));
        for (part, first) in self.principal.into_iter().flat_map(|first| [(1, first), (2, first + 1)]) {
            columns.push(SizeColumn { index: first, motion: unit(PINHOLE + part) });
        }
        let rate = path
            .iter()
            .map(|column| column.motion * self.rates[column.index - map.first_pose])
            .sum::<SizeVector>();
        for (index, seconds) in self.clock.into_iter().flatten() {
            columns.push(SizeColumn { index, motion: rate * seconds });
        }
        // exp(τω) exp(δ) = exp(exp(τω) δ) exp(τω): a rotation's three columns turn with what came later.
        if self.late_s != 0.0 {
            let root = path.iter().take_while(|column| column.index < map.first_pose + 3).count();
            for block in path[root..].chunks_exact_mut(3) {
                let at = block[0].index - map.first_pose;
                let turn = DMat3::from_quat(exp(self.late_s * DVec3::from_slice(&self.rates[at..at + 3])));
                let moved = [0, 1, 2].map(|column| {
                    let by = turn.col(column);
                    block[0].motion * by.x + block[1].motion * by.y + block[2].motion * by.z
                });
                for (column, motion) in block.iter_mut().zip(moved) {
                    column.motion = motion;
                }
            }
        }
        columns
    }
}
