//! Cameras as unknowns beside poses and sizes: turn and place of each, and by choice focal length, principal point, offset and
//! drift of the clock.
//!
//! Silhouettes cannot tell where the whole rig stands and turns, how large it is, and what all clocks show together. These
//! seven freedoms of the world, and the common offset and drift, stay as the calibration has them: with the gauge directions G
//! and the calibration's own deviations W⁻½ every step δ becomes Pδ,
//!
//! ```text
//! P = I − G (GᵀWG)⁻¹ GᵀW
//! ```
//!
//! so that the changes c keep `GᵀWc = 0`: no common motion of all cameras explains any of them (inner constraints: B. Triggs and
//! others, "Bundle Adjustment: A Modern Synthesis", 2000, section 9). The cost does not feel what P takes away.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, DVector};

use super::frames::BodyFrame;
use crate::body::{Parameters, Pose};
use crate::camera::{Camera, CameraChange, CameraError};
use crate::fit::FitView;
use crate::geometry::rotation::{exp, log};
use crate::optimize::NormalEquations;
use crate::residual::camera_columns::CameraColumns;

/// Longest turn of a camera in a step, radians, and longest move, metres.
const LARGEST_STEP: [f64; 2] = [0.03, 0.06];

/// What of each camera is unknown beside its turn and its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CameraChoice {
    /// The focal length.
    pub focal_length: bool,
    /// The principal point.
    pub principal_point: bool,
    /// By how much its clock is late.
    pub offset: bool,
    /// By how much its clock goes slow.
    pub drift: bool,
}

/// How far a calibration is usually off, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraDeviations {
    /// Of the turn about each axis, radians.
    pub turn: f64,
    /// Of the place along each axis, metres.
    pub shift_m: f64,
    /// Of the focal length, as a share of it.
    pub focal_length: f64,
    /// Of the principal point, as a share of the picture's height.
    pub principal_point: f64,
    /// Of the clock's offset, seconds.
    pub offset_s: f64,
    /// Of the clock's drift, seconds a second.
    pub drift: f64,
}

impl Default for CameraDeviations {
    fn default() -> Self {
        Self {
            turn: 0.03,
            shift_m: 0.05,
            focal_length: 0.04,
            principal_point: 0.02,
            offset_s: 0.05,
            drift: 1e-3,
        }
    }
}

/// A camera beside what its calibration says.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CameraState {
    /// Place, focal length and principal point.
    pub change: CameraChange,
    /// By how many seconds its clock is late, at the mean time of the frames.
    pub late_s: f64,
    /// By how many seconds a second that grows.
    pub drift: f64,
}

/// The cameras of a fit, and what is known of the motion.
#[derive(Debug)]
pub(super) struct CameraSet {
    given: Vec<Arc<Camera>>,
    layout: Layout,
    /// Rates of every frame's pose, per second, by the frame's number.
    rates: BTreeMap<usize, Vec<f64>>,
    mean_time_s: f64,
    frame_rate: f64,
    /// By how many frames each camera's evidence was taken earlier.
    earlier: Vec<isize>,
    /// W, by column.
    weights: DVector<f64>,
    /// P.
    projection: DMatrix<f64>,
}

/// The columns of one camera, from its first.
#[derive(Debug, Clone, Copy)]
struct Layout {
    focal_length: Option<usize>,
    principal_point: Option<usize>,
    offset: Option<usize>,
    drift: Option<usize>,
    count: usize,
}

impl Layout {
    fn new(choice: CameraChoice) -> Self {
        let mut count = 6;
        let mut next = |is_free: bool, width: usize| {
            let first = is_free.then_some(count);
            count += if is_free { width } else { 0 };
            first
        };
        let [focal_length, principal_point] = [next(choice.focal_length, 1), next(choice.principal_point, 2)];
        let [offset, drift] = [next(choice.offset, 1), next(choice.drift, 1)];
        Self { focal_length, principal_point, offset, drift, count }
    }

    /// One camera's numbers by their columns; what has no column is 0.
    fn state(&self, columns: &[f64]) -> CameraState {
        let part = |at: Option<usize>| at.map_or(0.0, |at| columns[at]);
        let principal = self.principal_point;
        let change = CameraChange {
            turn: DVec3::from_slice(&columns[..3]),
            shift: DVec3::from_slice(&columns[3..6]),
            zoom: part(self.focal_length),
            principal_px: DVec2::new(part(principal), part(principal.map(|at| at + 1))),
        };
        CameraState { change, late_s: part(self.offset), drift: part(self.drift) }
    }
}

impl CameraSet {
    /// The cameras that may change, among those of the frames; `rates` are needed where clocks are free.
    pub(super) fn new(
        given: Vec<Arc<Camera>>,
        choice: CameraChoice,
        deviations: &CameraDeviations,
        frames: &[BodyFrame],
        rates: BTreeMap<usize, Vec<f64>>,
        frame_rate: f64,
    ) -> Self {
        let mean_time_s = frames.iter().map(|frame| frame.frame as f64 / frame_rate).sum::<f64>()
            / frames.len().max(1) as f64;
        let layout = Layout::new(choice);
        let mut weights = DVector::zeros(layout.count * given.len());
        for (camera, given) in given.iter().enumerate() {
            let mut set = |at: Option<usize>, width: usize, deviation: f64| {
                let first = at.map_or(0..0, |at| at..at + width);
                first.for_each(|at| weights[camera * layout.count + at] = deviation.powi(-2));
            };
            set(Some(0), 3, deviations.turn);
            set(Some(3), 3, deviations.shift_m);
            set(layout.focal_length, 1, deviations.focal_length);
            set(layout.principal_point, 2, deviations.principal_point * given.height() as f64);
            set(layout.offset, 1, deviations.offset_s);
            set(layout.drift, 1, deviations.drift);
        }
        let projection = projection(&gauge(&given, layout), &weights);
        let earlier = vec![0; given.len()];
        Self { given, layout, rates, mean_time_s, frame_rate, earlier, weights, projection }
    }

    /// The same where each camera's evidence is from earlier frames.
    pub(super) fn with_earlier(self, earlier: Vec<isize>) -> Self {
        Self { earlier, ..self }
    }

    pub(super) fn columns(&self) -> usize {
        self.weights.len()
    }

    /// Which of the cameras this is.
    pub(super) fn index(&self, camera: &Camera) -> Option<usize> {
        self.given.iter().position(|given| given.name() == camera.name())
    }

    /// A camera as it is now.
    pub(super) fn camera(&self, camera: usize, state: &CameraState) -> Result<Camera, CameraError> {
        self.given[camera].changed(&state.change)
    }

    fn seconds(&self, frame: usize) -> f64 {
        frame as f64 / self.frame_rate - self.mean_time_s
    }

    /// By how much a camera's evidence is late in a frame, seconds.
    fn late_s(&self, camera: usize, state: &CameraState, frame: usize) -> f64 {
        state.late_s + state.drift * self.seconds(frame) - self.earlier[camera] as f64 / self.frame_rate
    }

    /// The pose that a camera sees in a frame, if it is another than the frame's: what that is some seconds later.
    pub(super) fn later(
        &self,
        camera: usize,
        state: &CameraState,
        frame: usize,
        pose: &Pose,
    ) -> Option<Pose> {
        let late_s = self.late_s(camera, state, frame);
        let rates = self.rates.get(&frame).filter(|_| late_s != 0.0)?;
        let step: Vec<f64> = rates.iter().map(|rate| rate * late_s).collect();
        Some(pose.retract(Parameters::Tangent, &step))
    }

    /// A frame as each of its cameras sees it now: the camera alone, and the pose when its clock says.
    pub(super) fn seen(
        &self,
        frame: &BodyFrame,
        pose: &Pose,
        states: &[CameraState],
    ) -> Vec<(BodyFrame, Pose)> {
        let one = |view: &FitView| {
            let index = self.index(&view.camera)?;
            let camera = Arc::new(self.camera(index, &states[index]).ok()?);
            let views = vec![FitView { camera, ..view.clone() }];
            let later = self.later(index, &states[index], frame.frame, pose);
            Some((BodyFrame { views, ..frame.clone() }, later.unwrap_or_else(|| pose.clone())))
        };
        frame.views.iter().filter_map(one).collect()
    }

    /// The columns of a camera in a frame; the first camera's first is `first`.
    pub(super) fn columns_of<'a>(
        &'a self,
        first: usize,
        frame: usize,
        index: usize,
        camera: &'a Camera,
        state: &CameraState,
    ) -> CameraColumns<'a> {
        let place = first + index * self.layout.count;
        let at = |column: Option<usize>| column.map(|column| place + column);
        let rates = self.rates.get(&frame).map_or(&[][..], |rates| rates);
        let clock = [(self.layout.offset, 1.0), (self.layout.drift, self.seconds(frame))];
        CameraColumns {
            camera,
            place,
            zoom: at(self.layout.focal_length),
            principal: at(self.layout.principal_point),
            clock: clock
                .map(|(column, seconds)| at(column.filter(|_| !rates.is_empty())).map(|at| (at, seconds))),
            rates,
            late_s: self.late_s(index, state, frame),
        }
    }

    /// Makes equations by free columns those of columns that keep the gauge, and adds how far calibrations are usually off.
    /// `unit` is in squared grey levels a variance of 1.
    pub(super) fn constrain(
        &self,
        equations: &mut NormalEquations,
        states: &[CameraState],
        first: usize,
        unit: f64,
    ) {
        let (count, all) = (self.columns(), equations.columns());
        let columns = equations.jtj.columns(first, count) * &self.projection;
        equations.jtj.columns_mut(first, count).copy_from(&columns);
        let rows = self.projection.transpose() * equations.jtj.rows(first, count);
        equations.jtj.view_mut((first, 0), (count, all)).copy_from(&rows);
        let right = self.projection.transpose() * equations.jtr.rows(first, count);
        equations.jtr.rows_mut(first, count).copy_from(&right);
        let changes = self.numbers(states);
        for (at, (change, weight)) in changes.iter().zip(self.weights.iter()).enumerate() {
            equations.add_row(&[(first + at, 1.0)], -change, unit * weight);
        }
    }

    /// A step of the cameras' columns, in the gauge.
    fn in_gauge(&self, step: &[f64]) -> DVector<f64> {
        &self.projection * DVector::from_column_slice(step)
    }

    pub(super) fn retract(&self, states: &[CameraState], step: &[f64]) -> Vec<CameraState> {
        let step = self.in_gauge(step);
        let one = |(state, step): (&CameraState, &[f64])| {
            let (own, by) = (state.change, self.layout.state(step));
            let change = CameraChange {
                turn: log(exp(by.change.turn) * exp(own.turn)),
                shift: own.shift + by.change.shift,
                zoom: own.zoom + by.change.zoom,
                principal_px: own.principal_px + by.change.principal_px,
            };
            CameraState { change, late_s: state.late_s + by.late_s, drift: state.drift + by.drift }
        };
        states.iter().zip(step.as_slice().chunks_exact(self.layout.count)).map(one).collect()
    }

    /// By how much a step is to be shortened: a camera that is known roughly does not fly away.
    pub(super) fn shortened(&self, step: &[f64]) -> f64 {
        let step = self.in_gauge(step);
        let blocks = step.as_slice().chunks_exact(self.layout.count);
        let by_block = blocks.flat_map(|block| {
            let length = |at: usize| DVec3::from_slice(&block[at..at + 3]).length().max(1e-12);
            [LARGEST_STEP[0] / length(0), LARGEST_STEP[1] / length(3)]
        });
        by_block.fold(1.0, f64::min)
    }

    /// The changes by column.
    fn numbers(&self, states: &[CameraState]) -> Vec<f64> {
        let one = |CameraState { change, late_s, drift }: &CameraState| {
            let mut numbers = [change.turn.to_array(), change.shift.to_array()].concat();
            numbers.extend(self.layout.focal_length.map(|_| change.zoom));
            numbers
                .extend(self.layout.principal_point.into_iter().flat_map(|_| change.principal_px.to_array()));
            numbers.extend(self.layout.offset.map(|_| *late_s));
            numbers.extend(self.layout.drift.map(|_| *drift));
            numbers
        };
        states.iter().flat_map(one).collect()
    }

    /// Standard deviations of the changes, from the covariance of the free columns.
    pub(super) fn deviations(&self, covariance: &DMatrix<f64>) -> Vec<CameraState> {
        let in_gauge = &self.projection * covariance * self.projection.transpose();
        let deviations = in_gauge.diagonal().map(|variance| variance.max(0.0).sqrt());
        let cameras = deviations.as_slice().chunks_exact(self.layout.count);
        cameras.map(|deviations| self.layout.state(deviations)).collect()
    }
}

/// G: how the cameras' columns change where the world moves, turns and grows, and where all clocks change alike.
fn gauge(cameras: &[Arc<Camera>], layout: Layout) -> DMatrix<f64> {
    let middle = cameras.iter().map(|camera| camera.centre()).sum::<DVec3>() / cameras.len().max(1) as f64;
    let clocks = [layout.offset, layout.drift].into_iter().flatten();
    let mut gauge = DMatrix::zeros(layout.count * cameras.len(), 7 + clocks.clone().count());
    for (camera, given) in cameras.iter().enumerate() {
        let arm = given.centre() - middle;
        let first = layout.count * camera;
        let mut set = |at: usize, column: usize, to: DVec3| {
            (0..3).for_each(|axis| gauge[(first + at + axis, column)] = to[axis]);
        };
        for (axis, unit) in DVec3::AXES.into_iter().enumerate() {
            set(3, axis, unit);
            // R exp(−ω) = exp(−Rω) R.
            set(0, 3 + axis, -(given.camera_from_world().rotation * unit));
            set(3, 3 + axis, unit.cross(arm));
        }
        set(3, 6, arm);
        clocks.clone().enumerate().for_each(|(clock, at)| gauge[(first + at, 7 + clock)] = 1.0);
    }
    gauge
}

/// The projection P along the gauge directions.
fn projection(gauge: &DMatrix<f64>, weights: &DVector<f64>) -> DMatrix<f64> {
    let weighed =
        DMatrix::from_fn(gauge.nrows(), gauge.ncols(), |row, column| weights[row] * gauge[(row, column)]);
    let normal = gauge.transpose() * &weighed;
    let inverse =
        normal.pseudo_inverse(1e-9).unwrap_or_else(|_| DMatrix::zeros(gauge.ncols(), gauge.ncols()));
    DMatrix::identity(gauge.nrows(), gauge.nrows()) - gauge * inverse * weighed.transpose()
}

#[cfg(test)]
mod tests;
