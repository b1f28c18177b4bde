//! Runs that differ: the same start once more with each renderer, preset or ramp, so that their curves can be compared; and
//! the part of the body that a refit moves.

use std::sync::Arc;

use backlit_document::CameraUse;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::fit::{DataView, FitOptions, Preset, Stage};
use backlit_tracking::render::{Ramp, RendererKind};

use crate::context::Context;
use crate::context::command::{BodyPart, Variants};

/// The ramps that are compared, each in one stage on hard silhouettes.
const RAMPS: [Ramp; 3] = [Ramp::Thesis, Ramp::Half, Ramp::Width { px: 4.0 }];

/// A run that is still to come.
#[derive(Debug, Clone)]
pub(super) struct VariantRun {
    pub(super) start: Pose,
    pub(super) options: FitOptions,
    pub(super) cameras: Arc<Vec<CameraUse>>,
}

impl VariantRun {
    /// All runs of a comparison: from the start of the run on the screen, or from the pose on the screen where there is
    /// no run. What has been run like this from there is not run again.
    pub(super) fn all(over: Variants, context: &Context<'_>) -> Vec<Self> {
        let cameras = context.document().cameras.clone();
        let of = |base: &FitOptions| {
            variants(over, base).into_iter().map(|options| (options, cameras.clone())).collect()
        };
        Self::new_ones(of, context)
    }

    /// The same with all cameras in use, and with each of them left out.
    pub(super) fn over_cameras(context: &Context<'_>) -> Vec<Self> {
        let cameras = &context.document().cameras;
        let used: Vec<usize> = context.document().used_cameras().collect();
        let without = used.iter().filter(|_| used.len() > 1).map(|left_out| {
            let mut cameras = (**cameras).clone();
            cameras[*left_out].used = false;
            Arc::new(cameras)
        });
        let sets: Vec<Arc<Vec<CameraUse>>> = std::iter::once(cameras.clone()).chain(without).collect();
        Self::new_ones(|base| sets.into_iter().map(|cameras| (base.clone(), cameras)).collect(), context)
    }

    /// Runs of choices that have not been run from the start.
    fn new_ones(
        choices: impl FnOnce(&FitOptions) -> Vec<(FitOptions, Arc<Vec<CameraUse>>)>,
        context: &Context<'_>,
    ) -> Vec<Self> {
        let shown = context.run().and_then(|run| Some((run, run.steps.first()?)));
        let start =
            shown.map_or_else(|| context.shown_pose().clone(), |(_, first)| first.iteration.point.clone());
        let base = shown.map_or_else(|| context.document().fit.clone(), |(run, _)| run.choices.fit.clone());
        let is_new = |(options, cameras): &(FitOptions, Arc<Vec<CameraUse>>)| {
            let same = |run: &backlit_document::run::Run| {
                run.frame == context.selection.frame
                    && *run.choices.fit == *options
                    && *run.choices.cameras == **cameras
                    && run.choices.part.is_none()
                    && run.steps.first().is_some_and(|first| first.iteration.point == start)
            };
            !context.runs().all().iter().any(same)
        };
        let new = choices(&base).into_iter().filter(is_new);
        new.map(|(options, cameras)| Self { start: start.clone(), options, cameras }).collect()
    }
}

fn variants(over: Variants, base: &FitOptions) -> Vec<FitOptions> {
    match over {
        Variants::Renderers => {
            RendererKind::ALL.map(|renderer| FitOptions { renderer, ..base.clone() }).to_vec()
        }
        Variants::Presets => {
            let of = |preset| FitOptions { renderer: base.renderer, ..FitOptions::preset(preset) };
            Preset::ALL.map(of).to_vec()
        }
        Variants::Ramps => {
            let steps = base.stages.iter().map(|stage| stage.iterations).sum();
            let single = |ramp| {
                base.stages.last().map(|last| Stage {
                    ramp,
                    data: DataView::Hard,
                    iterations: steps,
                    ..*last
                })
            };
            let with = |stages: Vec<Stage>| FitOptions { stages, ..base.clone() };
            let mut all: Vec<FitOptions> =
                RAMPS.iter().filter_map(|ramp| Some(with(vec![single(*ramp)?]))).collect();
            all.push(with(FitOptions::preset(Preset::Robust).stages));
            all
        }
    }
}

/// Rotations that a refit may move; `None` for all of them and the root.
pub(super) fn free_rotations(model: &Model, limb: usize, part: BodyPart) -> Option<Vec<bool>> {
    let rotation = model.limbs()[limb].rotation;
    let mut free = vec![false; model.rotation_count()];
    match part {
        BodyPart::Body => return None,
        BodyPart::Limb => free[rotation] = true,
        BodyPart::Chain => {
            // Up to the trunk: a rotation with more than one child belongs to several chains.
            let children = |parent: usize| {
                model.rotation_parents().iter().filter(|other| **other == Some(parent)).count()
            };
            let mut next = Some(rotation);
            while let Some(at) = next {
                free[at] = true;
                next = model.rotation_parents()[at].filter(|parent| children(*parent) == 1);
            }
            for (index, slot) in free.iter_mut().enumerate() {
                *slot |= model.rotation_follows(index, rotation);
            }
        }
    }
    Some(free)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn variants_differ_in_what_they_are_named_for_alone() {
        let base = FitOptions::preset(Preset::Robust);
        let renderers = variants(Variants::Renderers, &base);
        assert_eq!(renderers.len(), 3);
        for options in &renderers {
            assert_eq!(FitOptions { renderer: base.renderer, ..options.clone() }, base);
        }
        for options in variants(Variants::Ramps, &base) {
            assert_eq!(options.check(), Ok(()));
            assert_eq!(FitOptions { stages: base.stages.clone(), ..options }, base);
        }
        assert_eq!(variants(Variants::Presets, &base).len(), 2);
    }

    #[test]
    fn a_chain_goes_from_the_trunk_to_the_hand() {
        let model = builtin::full_body();
        let arm = model.limb_index("right upper arm").unwrap();
        let free = free_rotations(&model, arm, BodyPart::Chain).unwrap();
        let names: Vec<&str> = model
            .rotation_owners()
            .iter()
            .zip(&free)
            .filter(|(_, free)| **free)
            .map(|(owner, _)| model.limbs()[*owner].name.as_str())
            .collect();
        assert_eq!(names, ["right clavicle", "right upper arm", "right forearm"]);
        assert_eq!(free_rotations(&model, arm, BodyPart::Limb).unwrap().iter().filter(|f| **f).count(), 1);
        assert_eq!(free_rotations(&model, arm, BodyPart::Body), None);
    }
}
