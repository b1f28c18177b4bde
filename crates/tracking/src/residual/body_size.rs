//! D − Λ of every pixel with derivatives by the pose *and* by the body's sizes and the camera, in f64, one pixel at a time.
//!
//! A limb of length s and radius r, whose points are q = p0 + t a (a = s R v), moves with the sizes θ = log(s/s₀):
//!
//! - its own length: q moves by t a, so ∂λ/∂θ = k·(q − p0), the wrench's stretch;
//! - the length of a limb m on the way to it: all of it moves by that bone, aₘ, so ∂λ/∂θₘ = k·aₘ;
//! - its own radius: ∂λ/∂θ = r ∂λ/∂r, through the ramp alone;
//! - silhouettes that are w pixels too wide all round: in the picture its radius is r + w c, c metres a pixel where it is.
//!
//! A known joint (a keypoint) has the same columns: its limb's second joint moves by v + ω × a + θ a.
//!
//! So a pixel's row is h = [force, moment, stretch, r ∂λ/∂r, ∂λ/∂ log f, ∂λ/∂c] times the limb's 11 × n map, and sums of
//! h hᵀ and h ρ per limb give JᵀJ and Jᵀρ exactly, as for the pose alone. This path runs once a person; the fast
//! kernels know nothing of sizes.

use std::sync::Arc;

use glam::DVec3;
use nalgebra::SVector;

use super::RowSums;
use super::camera_columns::CameraColumns;
use crate::body::{Kinematics, Model, MovingColumn, Parameters, SizeKind, Sizes};
use crate::camera::Camera;
use crate::optimize::NormalEquations;
use crate::render::wrench::Wrench;
use crate::render::{BACKGROUND, Primitive, Ramp, RowWinners, View};
use crate::silhouette::Measurement;

/// Force, moment, stretch, radius, focal length, principal point.
pub(crate) const COMPONENTS: usize = 11;

/// A pixel's row on its limb, or a column of the limb's map: force and moment (or v and ω) in world axes, stretch, radius,
/// focal length, principal point.
pub(crate) type SizeVector = SVector<f64, COMPONENTS>;

/// The sums of one limb, world axes.
pub(crate) type SizeBlock = RowSums<COMPONENTS>;

/// One camera's data in one frame, every `stride`-th pixel.
#[derive(Debug, Clone)]
pub(crate) struct SizeData {
    measurement: Arc<Measurement>,
    stride: usize,
    empty_cost: f64,
    /// Σ w over the sampled pixels.
    pub(crate) total_weight: f64,
}

impl SizeData {
    /// Takes every `stride`-th pixel, from the middle of the first block.
    pub(crate) fn new(measurement: Arc<Measurement>, stride: usize) -> Self {
        let stride = stride.max(1);
        let (mut empty_cost, mut total_weight) = (0.0, 0.0);
        for y in (stride / 2..measurement.height()).step_by(stride) {
            for x in (stride / 2..measurement.width()).step_by(stride) {
                let slot = y * measurement.width() + x;
                let weight = f64::from(measurement.weights()[slot]);
                empty_cost += weight * (f64::from(measurement.values()[slot]) - BACKGROUND).powi(2);
                total_weight += weight;
            }
        }
        Self { measurement, stride, empty_cost, total_weight }
    }

    /// Cost Σ w (D − Λ)², and the sums of every limb. `blocks` has one entry per limb and comes cleared.
    pub(crate) fn accumulate(
        &self,
        view: &View,
        camera: &Camera,
        ramp: Ramp,
        row: &mut RowWinners,
        blocks: &mut [SizeBlock],
        is_camera_free: bool,
    ) -> f64 {
        let (stride, offset) = (self.stride, self.stride / 2);
        let mut cost = self.empty_cost;
        for y in (offset..self.measurement.height()).step_by(stride) {
            row.find(view, y, stride, offset);
            for x in row.touched().step_by(stride) {
                let Some(winner) = row.winner(x) else { continue };
                let slot = y * self.measurement.width() + x;
                let weight = f64::from(self.measurement.weights()[slot]);
                if weight == 0.0 {
                    continue;
                }
                let data = f64::from(self.measurement.values()[slot]);
                let residual = data - BACKGROUND * row.level(x).clamp(0.0, 1.0);
                cost += weight * (residual * residual - (data - BACKGROUND).powi(2));
                if row.level(x) > 0.0
                    && let Some(mut h) = size_vector(view, &view.primitives[winner], camera, ramp, [x, y])
                {
                    if is_camera_free {
                        add_pinhole(&mut h, view, &view.primitives[winner], [x, y]);
                    }
                    blocks[view.primitives[winner].limb].add(&h, weight, residual);
                }
            }
        }
        cost.max(0.0)
    }
}

/// A pixel's row on the limb that wins it; `None` where λ is clipped.
pub(crate) fn size_vector(
    view: &View,
    primitive: &Primitive,
    camera: &Camera,
    ramp: Ramp,
    [x, y]: [usize; 2],
) -> Option<SizeVector> {
    let sample = primitive.sample(view.ray(x, y));
    let world_from_camera = camera.camera_from_world().rotation.transpose();
    let Wrench { force, moment, stretch } = sample.wrench?.rotated(world_from_camera);
    let rate = primitive.radius_rate(ramp, view.pinhole.mean_focal_px(), sample.squared);
    let by_radius = primitive.radius * rate;
    let mut h = SizeVector::zeros();
    h.as_mut_slice()[..8]
        .copy_from_slice(&[force.x, force.y, force.z, moment.x, moment.y, moment.z, stretch, by_radius]);
    Some(h)
}

/// The components of focal length and principal point.
fn add_pinhole(h: &mut SizeVector, view: &View, primitive: &Primitive, [x, y]: [usize; 2]) {
    let by_pinhole = primitive.by_pinhole(view.ray(x, y), &view.pinhole);
    h.as_mut_slice()[PINHOLE..].copy_from_slice(&by_pinhole);
}

/// The first component of focal length and principal point.
pub(crate) const PINHOLE: usize = 8;

/// A row that is one component.
pub(crate) fn unit(component: usize) -> SizeVector {
    SizeVector::from_fn(|i, _| f64::from(u8::from(i == component)))
}

/// A row of a rigid motion: of a limb's first joint, and its turn.
pub(crate) fn rigid(velocity: DVec3, turn: DVec3) -> SizeVector {
    let mut motion = SizeVector::zeros();
    motion.as_mut_slice()[..3].copy_from_slice(&velocity.to_array());
    motion.as_mut_slice()[3..6].copy_from_slice(&turn.to_array());
    motion
}

/// A column of a limb's 8 × n map that is not zero, with its index in the state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SizeColumn {
    /// The state's column.
    pub index: usize,
    /// What a unit of it does to the limb.
    pub motion: SizeVector,
}

/// How the columns of a joint state move the limbs of one frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SizeMap<'a> {
    pub(crate) sizes: &'a Sizes,
    /// The body with these sizes.
    pub(crate) model: &'a Model,
    pub(crate) kinematics: &'a Kinematics,
    /// First column of the frame's pose.
    pub(crate) first_pose: usize,
    /// First column of the sizes.
    pub(crate) first_size: usize,
    /// The column of the silhouettes' widening, where it is unknown.
    pub(crate) widening: Option<usize>,
    /// The camera's own columns, where it is unknown.
    pub(crate) camera: Option<CameraColumns<'a>>,
}

/// How a limb's radius in a picture, r + w c, grows as a logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RadiusGrowth {
    /// With the logarithm of the limb's own radius r.
    pub by_radius: f64,
    /// With the widening w, per pixel.
    pub by_px: f64,
}

impl RadiusGrowth {
    /// Silhouettes are taken as they are.
    pub(crate) const PLAIN: Self = Self { by_radius: 1.0, by_px: 0.0 };
}

impl SizeMap<'_> {
    /// The columns that move a limb: its pose's, and the sizes of all limbs on the way to it. Sizes that are not free are
    /// scaled as a whole: they share the column after those of the free ones.
    pub(crate) fn columns(&self, limb: usize, growth: RadiusGrowth) -> Vec<SizeColumn> {
        let Self { sizes, model, kinematics, .. } = *self;
        let mut path = Vec::new();
        kinematics.moving_columns_into(limb, Parameters::Tangent, &mut path);
        let mut columns: Vec<SizeColumn> = Vec::with_capacity(path.len() + 8);
        for MovingColumn { index, motion: [vx, vy, vz, wx, wy, wz, scaling] } in path {
            let mut motion = rigid(DVec3::new(vx, vy, vz), DVec3::new(wx, wy, wz));
            motion[6] = scaling;
            columns.push(SizeColumn { index: self.first_pose + index, motion });
        }
        let of_camera = self.camera.map(|camera| camera.columns(limb, self, &mut columns));
        let first_size = columns.len();
        let mut add = |column: Option<usize>, motion: SizeVector| {
            let index = self.first_size + column.unwrap_or(sizes.count());
            // Limbs on one path may share a size.
            match columns[first_size..].iter_mut().find(|other| other.index == index) {
                Some(other) => other.motion += motion,
                None => columns.push(SizeColumn { index, motion }),
            }
        };
        add(sizes.column(limb, SizeKind::Length), unit(6));
        add(sizes.column(limb, SizeKind::Radius), unit(7) * growth.by_radius);
        let parents = std::iter::successors(model.limbs()[limb].parent, |&limb| model.limbs()[limb].parent);
        for ancestor in parents {
            let bone = kinematics.ends()[ancestor] - kinematics.starts()[ancestor];
            add(sizes.column(ancestor, SizeKind::Length), rigid(bone, DVec3::ZERO));
        }
        if let Some(index) = self.widening {
            columns.push(SizeColumn { index, motion: unit(7) * growth.by_px });
        }
        columns.extend(of_camera.into_iter().flatten());
        columns
    }

    /// Maps one camera's sums to the joint state with a weight: JᵀJ += KᵀMK, Jᵀρ += Kᵀm. `growth` has one entry per limb.
    pub(crate) fn add(
        &self,
        blocks: &[SizeBlock],
        weight: f64,
        growth: &[RadiusGrowth],
        equations: &mut NormalEquations,
    ) {
        for (limb, block) in blocks.iter().enumerate().filter(|(_, block)| !block.is_empty()) {
            let columns = self.columns(limb, growth[limb]);
            block.add_to(columns.iter().map(|column| (column.index, column.motion)), weight, equations);
        }
    }

    /// Adds w ‖target − p‖² of a joint that should be at a point in the world, with columns for the sizes: a limb's second
    /// joint, or the root.
    pub(crate) fn add_joint(
        &self,
        (limb, target): (Option<usize>, DVec3),
        weight: f64,
        root: DVec3,
        equations: &mut NormalEquations,
    ) {
        let (moved, place): (Vec<(usize, DVec3)>, DVec3) = match limb {
            Some(limb) => {
                let end = self.kinematics.ends()[limb];
                let bone = end - self.kinematics.starts()[limb];
                let moved = |SizeColumn { index, motion }: &SizeColumn| {
                    let [v, turn] = [0, 3].map(|at| DVec3::new(motion[at], motion[at + 1], motion[at + 2]));
                    (*index, v + turn.cross(bone) + motion[6] * bone)
                };
                (self.columns(limb, RadiusGrowth::PLAIN).iter().map(moved).collect(), end)
            }
            None => {
                let axes = DVec3::AXES.into_iter().enumerate();
                (axes.map(|(axis, unit)| (self.first_pose + axis, unit)).collect(), root)
            }
        };
        let residual = target - place;
        equations.cost += weight * residual.length_squared();
        for &(i, a) in &moved {
            equations.jtr[i] += weight * a.dot(residual);
            for &(j, b) in &moved {
                equations.jtj[(i, j)] += weight * a.dot(b);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::body::{SizeChoice, builtin};
    use crate::fixtures;
    use crate::optimize::gradient_check::{DifferenceOptions, check_jacobian};
    use crate::render::{RendererKind, prediction};

    fn camera() -> Camera {
        fixtures::camera([40, 48], [42.0, 42.5, 19.0, 23.5], [1.2, 2.6, 0.7], DVec3::Z * 0.1, DVec3::Z)
    }

    /// Every pixel by every column, pose and sizes, against differences of the drawn prediction.
    #[test]
    fn rows_match_differences() {
        let start = Arc::new(builtin::full_body());
        let sizes = Sizes::new(start.clone(), SizeChoice::default());
        let theta: Vec<f64> = (0..sizes.count()).map(|i| 0.1 * (i as f64 * 1.3).sin()).collect();
        let model = sizes.model(&theta, 0.0).unwrap();
        let columns = Parameters::Tangent.columns(model.rotation_count());
        let pose = fixtures::stepped(&model, Parameters::Tangent, |i| 0.25 * (i as f64 * 2.1).sin());
        let kinematics = Kinematics::new(&model, &pose);
        let camera = camera();
        let ramps = [
            Ramp::Half,
            Ramp::Thesis,
            Ramp::Width { px: 1.0 },
            Ramp::Distance { inner_px: 1.5, outer_px: 6.0 },
            Ramp::Distance { inner_px: 9.0, outer_px: 3.0 },
        ];
        for ramp in ramps {
            let view = View::new(&model, &kinematics, &camera, RendererKind::Capsule, ramp);
            let mut row = RowWinners::default();
            let mut jacobian = DMatrix::zeros(40 * 48, columns + sizes.count());
            let mut filled = 0;
            let map = SizeMap {
                sizes: &sizes,
                model: &model,
                kinematics: &kinematics,
                first_pose: 0,
                first_size: columns,
                widening: None,
                camera: None,
            };
            for y in 0..48 {
                row.find(&view, y, 1, 0);
                for x in row.touched() {
                    let Some(primitive) = row.winner(x).map(|winner| &view.primitives[winner]) else {
                        continue;
                    };
                    let Some(h) = size_vector(&view, primitive, &camera, ramp, [x, y]) else { continue };
                    for column in map.columns(primitive.limb, RadiusGrowth::PLAIN) {
                        jacobian[(y * 40 + x, column.index)] = column.motion.dot(&h);
                        filled += 1;
                    }
                }
            }
            assert!(filled > 500, "{ramp}: {filled}");
            let drawn = |column: usize, offset: f64| -> Vec<f64> {
                let (mut theta, mut pose) = (theta.clone(), pose.clone());
                if column < columns {
                    pose = pose.nudged(Parameters::Tangent, column, offset);
                } else {
                    theta[column - columns] += offset;
                }
                let model = sizes.model(&theta, 0.0).unwrap();
                let kinematics = Kinematics::new(&model, &pose);
                let view = View::new(&model, &kinematics, &camera, RendererKind::Capsule, ramp);
                prediction::levels(&view)
            };
            let name = |pixel: usize, column: usize| {
                let what = match column.checked_sub(columns) {
                    None => format!("pose column {column}"),
                    Some(size) => {
                        let parameter = &sizes.parameters[size];
                        format!("{} {}", parameter.name, parameter.kind)
                    }
                };
                format!("{ramp}, {what}, pixel ({}, {})", pixel % 40, pixel / 40)
            };
            let check = check_jacobian(&jacobian, drawn, name, &DifferenceOptions::default());
            assert!(check.passes() && check.skipped_share() < 0.05, "{check}");
        }
    }
}
