//! What each camera says of a pose by itself: JᵀJ, which limbs it sees, and how its pixels err.

use std::sync::Arc;

use glam::DVec3;
use nalgebra::{DMatrix, DVector, Matrix6, SMatrix, SVector};
use rayon::prelude::*;

use crate::body::{Kinematics, Model, MovingColumn, Parameters, Pose};
use crate::camera::Camera;
use crate::fit::{FitError, FitOptions, FitView, Stage};
use crate::geometry::rotation::skew;
use crate::optimize::NormalEquations;
use crate::render::wrench::WrenchBlock;
use crate::render::{BACKGROUND, Ramp, RendererKind, RowWinners, View};
use crate::residual::Loss;
use crate::residual::silhouette::{StateMap, WorldBlocks};

/// Side of the cells within which pixels err together, pixels: longer than the steps of a silhouette's edge, shorter than
/// most limbs.
const CELL_PX: usize = 16;

/// Points along a limb's axis that are looked for in the picture.
const AXIS_POINTS: usize = 9;

/// How a camera sees a limb.
#[derive(Debug, Clone, PartialEq)]
pub struct LimbSight {
    /// Whether any point of its axis lies in the picture.
    pub in_picture: bool,
    /// Pixels at which it is the darkest limb.
    pub won: usize,
    /// Those of them on a ramp: only they have a gradient.
    pub on_ramp: usize,
    /// Σ JᵀJ by the velocities of its two joints, world axes, of unit weight: grey²/m². Twist is not in it.
    pub by_ends: Matrix6<f64>,
}

/// One camera's part, its own weight left out.
#[derive(Debug, Clone)]
pub struct CameraInformation {
    /// The camera.
    pub camera: Arc<Camera>,
    /// Its weight in a fit.
    pub weight: f64,
    /// JᵀJ, Jᵀρ and Σ ρ² of the pixels on a ramp, in tangent columns.
    pub equations: NormalEquations,
    /// Σ w of the pixels on a ramp, and how many they are.
    pub ramp_weight: f64,
    /// Number of those pixels.
    pub ramp_pixels: usize,
    /// Σ g gᵀ, g = Jᵀρ of a cell, over the cells of the picture.
    pub scatter: DMatrix<f64>,
    /// By limb.
    pub limbs: Vec<LimbSight>,
}

/// All cameras' parts at one pose of one frame.
#[derive(Debug, Clone)]
pub struct FrameInformation {
    /// The body.
    pub model: Arc<Model>,
    /// Joints of the pose.
    pub kinematics: Kinematics,
    /// The pose, its quaternions of unit length.
    pub pose: Pose,
    /// By camera; `None` for one without a silhouette.
    pub cameras: Vec<Option<CameraInformation>>,
    /// L, metres: what a radian is worth for the root's position.
    pub lever_m: f64,
}

/// Eigenvalues of the scaled JᵀJ, largest first, with their vectors as columns, and how many are not null.
pub(super) struct Spectrum {
    pub(super) values: Vec<f64>,
    pub(super) vectors: DMatrix<f64>,
    pub(super) rank: usize,
    pub(super) null_below: f64,
}

impl FrameInformation {
    /// Looks at a pose through every camera that has data. `views` is by camera, whether it is used in the fit or not;
    /// a weight of zero counts as one, so that cameras that are left out can be compared too.
    /// Options are taken as they are: made to a scale before, where that is wanted.
    ///
    /// # Errors
    /// A pose that is not the model's, data that are not the camera's, options out of range.
    pub fn new(
        model: &Arc<Model>,
        views: &[Option<FitView>],
        options: &FitOptions,
        pose: &Pose,
    ) -> Result<Self, FitError> {
        pose.check(model)?;
        options.check()?;
        views.iter().flatten().try_for_each(FitView::check)?;
        let pose = pose.normalized();
        let kinematics = Kinematics::new(model, &pose);
        let cameras = views
            .par_iter()
            .map(|view| {
                let view = view.as_ref()?;
                let weight = if view.weight > 0.0 { view.weight } else { 1.0 };
                let view = FitView { weight, ..view.clone() };
                view.has_data().then(|| camera_information(model, &kinematics, &view, options))
            })
            .collect();
        let lever_m = mean_lever(model);
        Ok(Self { model: Arc::clone(model), kinematics, pose, cameras, lever_m })
    }

    /// Looks at a pose as cameras would see it whose silhouettes are what the model predicts: nothing errs, every pixel counts, each
    /// camera has a weight of one. No footage is needed. Lenses are taken for ideal.
    #[must_use]
    pub fn of_prediction(
        model: &Arc<Model>,
        cameras: &[Arc<Camera>],
        (renderer, ramp): (RendererKind, Ramp),
        pose: &Pose,
    ) -> Self {
        let pose = pose.normalized();
        let kinematics = Kinematics::new(model, &pose);
        let look = |camera: &Arc<Camera>| {
            let drawn = View::new(model, &kinematics, camera, renderer, ramp);
            Some(drawn_information(model, &kinematics, camera, &drawn, |_, _| [0.0, 1.0]))
        };
        let cameras = cameras.par_iter().map(look).collect();
        Self { model: Arc::clone(model), lever_m: mean_lever(model), cameras, kinematics, pose }
    }

    /// H = Σ w JᵀJ of a set of cameras, tangent columns. Cameras without data add nothing.
    #[must_use]
    pub fn equations(&self, cameras: &[usize]) -> NormalEquations {
        let mut sum = NormalEquations::zeros(Parameters::Tangent.columns(self.model.rotation_count()));
        for part in self.parts(cameras) {
            sum.jtj += &part.equations.jtj * part.weight;
            sum.jtr += &part.equations.jtr * part.weight;
            sum.cost += part.equations.cost * part.weight;
        }
        sum
    }

    pub(super) fn parts<'a>(&'a self, cameras: &'a [usize]) -> impl Iterator<Item = &'a CameraInformation> {
        cameras.iter().filter_map(|&camera| self.cameras.get(camera)?.as_ref())
    }

    /// The scaled JᵀJ's eigenvalues and what of them is null.
    pub(super) fn spectrum(&self, cameras: &[usize]) -> Spectrum {
        let mut scaled = self.equations(cameras).jtj;
        for axis in 0..3 {
            scaled.row_mut(axis).scale_mut(self.lever_m);
            scaled.column_mut(axis).scale_mut(self.lever_m);
        }
        let columns = scaled.nrows();
        let pixels: usize = self.parts(cameras).map(|part| part.ramp_pixels).sum();
        let eigen = scaled.symmetric_eigen();
        let mut order: Vec<usize> = (0..columns).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let values: Vec<f64> = order.iter().map(|&index| eigen.eigenvalues[index].max(0.0)).collect();
        let null_below = f64::EPSILON * (columns + pixels) as f64;
        let rank = values.iter().take_while(|value| **value > null_below * values[0]).count();
        Spectrum { vectors: eigen.eigenvectors.select_columns(&order), values, rank, null_below }
    }
}

/// Root mean square distance of the joints from the joints that turn them, in the rest pose, metres.
fn mean_lever(model: &Model) -> f64 {
    let kinematics = Kinematics::new(model, &Pose::rest(model));
    let (mut sum, mut count) = (0.0, 0);
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        let pivot = kinematics.starts()[owner];
        for (limb, end) in model.limbs().iter().zip(kinematics.ends()) {
            if model.rotation_follows(limb.rotation, rotation) {
                sum += end.distance_squared(pivot);
                count += 1;
            }
        }
    }
    let lever = (sum / f64::from(count.max(1))).sqrt();
    if lever > 0.0 { lever } else { 1.0 }
}

fn camera_information(
    model: &Model,
    kinematics: &Kinematics,
    view: &FitView,
    options: &FitOptions,
) -> CameraInformation {
    let stages = &options.stages;
    let stage = Stage { stride: 1, ..stages[stages.len() - 1] };
    // A fit of one stage believes every pixel.
    let loss = if stages.len() > 1 { options.pixel_loss } else { Loss::Squares };
    let data = view.data(&stage, view.distance(std::slice::from_ref(&stage)).as_ref());
    let drawn = View::new(model, kinematics, &view.camera, options.renderer, stage.ramp);
    let seen = |at: usize, level: f64| {
        let residual = f64::from(data.values()[at]) - BACKGROUND * level;
        [residual, f64::from(data.weights()[at]) * loss.weight(residual * residual)]
    };
    CameraInformation {
        weight: view.weight,
        ..drawn_information(model, kinematics, &view.camera, &drawn, seen)
    }
}

/// What a camera of weight one tells. `seen` says of a pixel, by its index and predicted level from 0 to 1, the residual and how
/// much it counts.
fn drawn_information(
    model: &Model,
    kinematics: &Kinematics,
    camera: &Arc<Camera>,
    drawn: &View,
    seen: impl Fn(usize, f64) -> [f64; 2],
) -> CameraInformation {
    let (width, height) = (camera.width(), camera.height());
    let columns = Parameters::Tangent.columns(model.rotation_count());
    let count = model.limbs().len();
    let moving = |limb| {
        let mut columns = Vec::new();
        kinematics.moving_columns_into(limb, Parameters::Tangent, &mut columns);
        columns
    };
    let moving: Vec<Vec<MovingColumn>> = (0..count).map(moving).collect();
    let camera_from_world = camera.camera_from_world().rotation;
    let world_from_camera = camera_from_world.transpose();
    let mut blocks = vec![WrenchBlock::default(); count];
    let mut limbs =
        vec![LimbSight { in_picture: false, won: 0, on_ramp: 0, by_ends: Matrix6::zeros() }; count];
    let (mut cost, mut ramp_weight) = (0.0, 0.0);
    // g of the cells of the current row of cells.
    let mut cells = vec![DVector::zeros(columns); width.div_ceil(CELL_PX)];
    let mut scatter = DMatrix::zeros(columns, columns);
    let mut row = RowWinners::default();
    for y in 0..height {
        row.find(drawn, y, 1, 0);
        for x in row.touched() {
            let Some(winner) = row.winner(x) else { continue };
            let primitive = &drawn.primitives[winner];
            limbs[primitive.limb].won += 1;
            let sample = primitive.sample(drawn.ray(x, y));
            let [residual, weight] = seen(y * width + x, row.level(x).clamp(0.0, 1.0));
            let Some(wrench) = sample.wrench.filter(|_| weight > 0.0) else { continue };
            blocks[primitive.limb].add(wrench, weight, residual);
            limbs[primitive.limb].on_ramp += 1;
            cost += weight * residual * residual;
            ramp_weight += weight;
            if residual == 0.0 {
                continue;
            }
            let pull = SVector::from(wrench.rotated(world_from_camera).to_array()) * (weight * residual);
            for column in &moving[primitive.limb] {
                cells[x / CELL_PX][column.index] += SVector::from(column.motion).dot(&pull);
            }
        }
        if y % CELL_PX == CELL_PX - 1 || y + 1 == height {
            for cell in cells.iter_mut().filter(|cell| cell.iter().any(|value| *value != 0.0)) {
                scatter.ger(1.0, cell, cell, 1.0);
                cell.fill(0.0);
            }
        }
    }
    let mut world = WorldBlocks::new(count);
    world.add(camera, &blocks, 1.0);
    let mut equations = NormalEquations::zeros(columns);
    world.add_to(kinematics, Parameters::Tangent, &mut StateMap::default(), &mut equations);
    equations.cost = cost;
    for (limb, sight) in limbs.iter_mut().enumerate() {
        let (start, end) = (kinematics.starts()[limb], kinematics.ends()[limb]);
        let (products, _) = blocks[limb].in_world(camera_from_world);
        sight.in_picture = is_in_picture(camera, start, end);
        sight.by_ends = by_ends(&products, end - start);
    }
    let ramp_pixels = limbs.iter().map(|sight| sight.on_ramp).sum();
    let camera = Arc::clone(camera);
    CameraInformation { camera, weight: 1.0, equations, ramp_weight, ramp_pixels, scatter, limbs }
}

fn is_in_picture(camera: &Camera, start: DVec3, end: DVec3) -> bool {
    let (width, height) = (camera.width() as f64, camera.height() as f64);
    (0..AXIS_POINTS).any(|index| {
        let at = start.lerp(end, index as f64 / (AXIS_POINTS - 1) as f64);
        camera
            .project(at)
            .is_some_and(|px| px.x >= -0.5 && px.y >= -0.5 && px.x < width - 0.5 && px.y < height - 0.5)
    })
}

/// A limb's wrench sums by the velocities (v₀, v₁) of its joints: v = v₀, ω = a × (v₁ − v₀) / a·a.
fn by_ends(products: &SMatrix<f64, 7, 7>, axis: DVec3) -> Matrix6<f64> {
    let turn = skew(axis) * (1.0 / axis.length_squared());
    let mut map = SMatrix::<f64, 7, 6>::zeros();
    for i in 0..3 {
        map[(i, i)] = 1.0;
        for j in 0..3 {
            map[(3 + i, j)] = -turn.col(j)[i];
            map[(3 + i, 3 + j)] = turn.col(j)[i];
        }
    }
    map.transpose() * products * map
}
