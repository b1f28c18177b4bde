//! A person of spheres: every limb a sphere tree of its own shape, off the axis, with radii of its own (4.1.4, 6.5 of the report).
//!
//! From frames whose poses are known: each limb is [carved](self) from the visual hulls of all frames, carried back to its own rest
//! frame; what is left is a closed surface, and [`SphereTree`] fills it with nested spheres. Then
//! centres and radii are moved by the silhouettes themselves, and poses by the spheres, in turns.

mod carve;
mod options;
mod refine;
mod skin;
mod trees;

use std::sync::Arc;

use backlit_sphere_tree::{MeshError, OptionsError, SphereTree};
use glam::DVec3;
use rayon::prelude::*;
use thiserror::Error;

use crate::body::{
    FORMAT, Kinematics, LimbSpec, LimbSphere, Model, ModelError, ModelSpec, Pose, SphereLevel,
};
use crate::cancel::CancelToken;
use crate::fit::{Evidence, Fit, FitError, FitOptions, FitView};
use crate::numbers::OptionError;
use crate::render::{Ramp, RendererKind, View, prediction};
use crate::silhouette::Overlap;

pub use options::SphereBodyOptions;
pub use skin::{Skin, SkinError, SkinJoint, SkinOptions, body_of_skin};

/// One frame: its silhouettes and the pose that the body has in it.
#[derive(Debug, Clone)]
pub struct PosedViews {
    /// Its number.
    pub frame: usize,
    /// Its cameras.
    pub views: Vec<FitView>,
    /// A pose of the body.
    pub pose: Pose,
}

/// Why no body of spheres could be made.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum SphereBodyError {
    #[error("there is no frame to look at; expected one or more with their poses")]
    NoFrames,
    #[error("frame {frame}: {error}")]
    Frame { frame: usize, error: FitError },
    #[error(transparent)]
    Options(#[from] OptionError),
    #[error("limb \"{limb}\": what silhouettes leave of it {error}")]
    Limb { limb: String, error: MeshError },
    #[error(transparent)]
    Tree(#[from] OptionsError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error("it was cancelled")]
    Cancelled,
}

/// A body of spheres, and what it is worth in the frames that it was made from.
#[derive(Debug, Clone)]
pub struct SphereBody {
    /// The body; lengths, radii and limits are those of the body that it was made of.
    pub model: Model,
    /// The poses of the frames.
    pub poses: Vec<Pose>,
    /// Spheres of all limbs, level by level, the coarsest first.
    pub spheres: Vec<usize>,
    /// IoU of all frames and cameras: of capsules, of the spheres as they were carved, and at the end; `None` without masks.
    pub iou: Option<[f64; 3]>,
    /// Root of the mean squared residual a pixel, grey levels, before and after the last round.
    pub rms: [f64; 2],
}

/// How far [`sphere_body`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SphereBodyProgress {
    /// What is done now.
    pub doing: &'static str,
    /// Parts of the work that are done.
    pub done: usize,
    /// All parts.
    pub total: usize,
}

/// Makes the body of spheres of a person from frames. `fit` is how poses are fitted between rounds.
///
/// # Errors
/// No frames, options out of range, poses of another model, a limb that carving left empty, or `cancel`.
pub fn sphere_body(
    model: &Model,
    mut frames: Vec<PosedViews>,
    options: &SphereBodyOptions,
    fit: &FitOptions,
    cancel: &CancelToken,
    mut progress: impl FnMut(SphereBodyProgress),
) -> Result<SphereBody, SphereBodyError> {
    options.check()?;
    check(model, &frames)?;
    // Carving, the rounds with poses between them, and each coarser level.
    let total = 2 * options.rounds.max(1) + options.levels.saturating_sub(1);
    let mut done = 0;
    let mut tell = |doing| {
        progress(SphereBodyProgress { doing, done, total });
        done += 1;
    };
    let capsules = overlap(model, &frames, RendererKind::Capsule);
    tell("carving limbs");
    let trees = trees::carved(model, &frames, options)?;
    let carved = overlap(&trees, &frames, OWN);
    let begin = trees.at_level(FINEST)?;
    let (mut body, mut rms) = (begin.clone(), [0.0; 2]);
    for round in 0..options.rounds {
        if cancel.is_cancelled() {
            return Err(SphereBodyError::Cancelled);
        }
        tell("moving spheres");
        (body, rms) = refine::refine(&body, &begin, &frames, options);
        if round + 1 < options.rounds {
            tell("moving poses");
            pose_again(&body, &mut frames, fit, cancel)?;
        }
    }
    let body = with_coarser(&trees, &body, &frames, options, || tell("moving coarser spheres"))?;
    let end = overlap(&body, &frames, OWN);
    Ok(SphereBody {
        spheres: body.spheres_by_level(),
        model: body,
        poses: frames.into_iter().map(|frame| frame.pose).collect(),
        iou: capsules.zip(carved).zip(end).map(|((a, b), c)| [a, b, c]),
        rms,
    })
}

/// The level that no tree has more of.
const FINEST: usize = usize::MAX;

/// Each limb's own spheres.
const OWN: RendererKind = RendererKind::SphereTree { spheres: None };

fn check(model: &Model, frames: &[PosedViews]) -> Result<(), SphereBodyError> {
    if frames.is_empty() {
        return Err(SphereBodyError::NoFrames);
    }
    for PosedViews { frame, views, pose } in frames {
        let failed = |error| SphereBodyError::Frame { frame: *frame, error };
        pose.check(model).map_err(|error| failed(error.into()))?;
        views.iter().try_for_each(FitView::check).map_err(failed)?;
    }
    Ok(())
}

/// Poses by the spheres, from where they are.
fn pose_again(
    body: &Model,
    frames: &mut [PosedViews],
    options: &FitOptions,
    cancel: &CancelToken,
) -> Result<(), SphereBodyError> {
    let near = options.skip_when_tracking.min(options.stages.len().saturating_sub(1));
    let options = FitOptions { renderer: OWN, stages: options.stages[near..].to_vec(), ..options.clone() };
    let model = Arc::new(body.clone());
    frames.par_iter_mut().try_for_each(|frame| {
        let failed = |error| SphereBodyError::Frame { frame: frame.frame, error };
        let fit = Fit::new(Arc::clone(&model), frame.views.clone(), frame.pose.clone(), options.clone());
        let summary = fit.map_err(failed)?.run(cancel, |_| {});
        if cancel.is_cancelled() {
            return Err(SphereBodyError::Cancelled);
        }
        if !summary.is_broken() {
            frame.pose = summary.pose;
        }
        Ok(())
    })
}

/// The trees with the finest spheres of `finest`, and the coarser levels moved by the same silhouettes, each for itself.
fn with_coarser(
    trees: &Model,
    finest: &Model,
    frames: &[PosedViews],
    options: &SphereBodyOptions,
    mut tell: impl FnMut(),
) -> Result<Model, SphereBodyError> {
    let count = trees.limbs().iter().map(|limb| limb.coarser.len()).max().unwrap_or(0);
    let mut levels: Vec<Vec<SphereLevel>> = Vec::with_capacity(trees.limbs().len());
    for limb in trees.limbs() {
        let finest = SphereLevel { error: 0.0, spheres: limb.spheres.clone(), reaches: Vec::new() };
        levels.push(limb.coarser.iter().cloned().chain([finest]).collect());
    }
    for level in 0..=count {
        let moved = if level == count {
            finest.clone()
        } else {
            tell();
            let alone = trees.at_level(level)?;
            refine::refine(&alone, &alone, frames, options).0
        };
        for (levels, limb) in levels.iter_mut().zip(moved.limbs()) {
            let Some(level) = levels.get_mut(level) else { continue };
            for (old, new) in level.spheres.iter_mut().zip(&limb.spheres) {
                *old = LimbSphere { parent: old.parent, ..*new };
            }
        }
    }
    Ok(trees.with_trees(levels)?)
}

/// IoU of all frames and cameras together; `None` without masks.
fn overlap(model: &Model, frames: &[PosedViews], renderer: RendererKind) -> Option<f64> {
    let of_frame = |frame: &PosedViews| {
        let kinematics = Kinematics::new(model, &frame.pose);
        let of_view = |view: &FitView| {
            let Evidence::Mask(mask) = &view.evidence else { return None };
            let drawn = View::new(model, &kinematics, &view.camera, renderer, Ramp::Half);
            prediction::overlap(&drawn, mask).ok()
        };
        frame.views.iter().filter_map(of_view).reduce(Overlap::merge)
    };
    frames.iter().filter_map(of_frame).reduce(Overlap::merge)?.iou()
}

/// A tree of a mesh as a body of one limb: at rest, with its root at the origin, the spheres are where the mesh is.
///
/// # Errors
/// Spheres that no body can have: lengths are metres, at most 100.
pub fn body_of_tree(tree: &SphereTree, name: &str) -> Result<Model, ModelError> {
    let finest = tree.levels.last().map_or(&[][..], |level| &level.spheres);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for sphere in finest {
        low = low.min(sphere.centre - sphere.radius);
        high = high.max(sphere.centre + sphere.radius);
    }
    let size = high - low;
    let limb = LimbSpec {
        name: "mesh".to_owned(),
        direction: DVec3::Z,
        length: size.max_element(),
        radius: 0.5 * size.min_element(),
        ..LimbSpec::default()
    };
    let spec = ModelSpec { format: FORMAT.to_owned(), name: name.to_owned(), limbs: vec![limb] };
    let body = Model::new(&spec)?;
    let levels = trees::levels_of(tree, &body.limbs()[0]);
    body.with_trees(vec![levels])
}

#[cfg(test)]
mod tests;
