//! Cameras refined by the silhouettes of the person: what is free, what was found, and cameras in the place of the take's. `card`
//! is the card that tells it.

mod card;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_formats::footage::replacement::Calibration;
use backlit_jobs::Outbox;
use backlit_runs::camera_refinement::refine;
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::{
    CameraChoice, CameraRefinementOptions, CameraRefinementProgress, FEWEST_CAMERAS, RefinedCameras,
};
use backlit_tracking::camera::Rig;
use egui::Ui;

use crate::context::camera_work::{CameraWork, WorkMessage};
use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, FeatureCard, Requests, ShellRequest, priority};

/// What stands in a project where the name of a calibration's file would be.
const REFINED: &str = "cameras refined by silhouettes";

#[derive(Debug, Default)]
pub(crate) struct CameraRefinement {
    work: CameraWork<CameraRefinementProgress, RefinedRig, { priority::TRACK }>,
    choice: CameraChoice,
}

/// What a refinement has found.
#[derive(Debug)]
struct RefinedRig {
    choice: CameraChoice,
    found: RefinedCameras,
    /// Which of the take's cameras were refined.
    cameras: Vec<usize>,
    /// All cameras of the take.
    calibration: Arc<Calibration>,
}

/// What is refined: these cameras, by a person who begins the first of these frames in this pose.
struct RefinementSubject {
    footage: Footage,
    cameras: Vec<usize>,
    start: Pose,
    frames: Vec<usize>,
    options: CameraRefinementOptions,
}

impl RefinementSubject {
    /// The cameras that count, from the first frame that has a pose on.
    fn of(footage: &Footage, choice: CameraChoice, context: &Context<'_>) -> Self {
        let document = context.document();
        let count = footage.take().frame_count();
        let is_lost = |frame: usize| document.estimates.get(&frame).is_some_and(|found| found.lost);
        let first = (0..count).find(|&frame| document.has_pose(frame) && !is_lost(frame));
        let first = first.unwrap_or(context.selection.frame);
        let mut options = CameraRefinementOptions::new((*document.fit).clone(), footage.take().frame_rate());
        options.choice = choice;
        Self {
            footage: footage.clone(),
            cameras: document.used_cameras().collect(),
            start: document.pose_at(first).clone(),
            frames: (first..count).collect(),
            options,
        }
    }

    fn refine(
        self,
        out: &Outbox<WorkMessage<CameraRefinementProgress, RefinedRig>>,
    ) -> Result<RefinedRig, String> {
        let Self { footage, cameras, start, frames, options } = self;
        let tell = |at| out.send(WorkMessage::At(at));
        let refined = refine(&footage, &cameras, (start, &frames), &options, out.cancel(), tell);
        let in_place = |(found, rig): (RefinedCameras, Rig)| {
            let calibration = Arc::new(Calibration { path: REFINED.into(), rig });
            RefinedRig { choice: options.choice, found, cameras, calibration }
        };
        refined.map(in_place).map_err(|error| error.to_string())
    }
}

impl Feature for CameraRefinement {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        if let Some(take) = self.work.update("The refinement of the cameras", context, requests) {
            let subject = RefinementSubject::of(&take, self.choice, context);
            self.work.begin_step(context.pool, |out| subject.refine(out));
        }
    }

    fn run(&mut self, command: Command, _: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::CameraRefinement;
        if is_own {
            requests.request(ShellRequest::OpenCard(FeatureCard::CameraRefinement));
        }
        is_own
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        if command != Command::CameraRefinement {
            return None;
        }
        let few = "Cameras are refined where they can disagree: two or more must be used";
        no_take(context).or(because(context.document().used_cameras().count() < FEWEST_CAMERAS, few))
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        self.show(ui, context, requests)
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self::default();
    }
}

impl CameraRefinement {
    /// The cameras that were found, and whether they are in use.
    fn in_use(&self, context: &Context<'_>) -> Option<(&Arc<Calibration>, bool)> {
        let found = self.work.result()?;
        Some((&found.calibration, context.document().calibration.as_ref() == Some(&found.calibration)))
    }

    /// Puts the cameras that were found in the place of those in use.
    fn use_refined(&self, context: &Context<'_>, requests: &mut Requests) {
        if let Some((calibration, false)) = self.in_use(context) {
            requests.edit(Edit::SetCalibration(Some(Arc::clone(calibration))));
        }
    }
}
