//! A body of spheres from several frames: one frame is read a step, then limbs are carved from all.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_jobs::{Job, Outbox, Step};
use backlit_take::footage::Footage;
use backlit_tracking::body::Pose;
use backlit_tracking::body_spheres::{
    PosedViews, SphereBody, SphereBodyError, SphereBodyOptions, sphere_body,
};
use backlit_tracking::fit::{Evidence, FitOptions};
use backlit_tracking::render::RendererKind;
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::Label;

use super::Found;
use crate::context::command::{Command, HistoryCommand};
use crate::context::command_button::next_gesture;
use crate::context::view_settings::ViewSettings;
use crate::context::{Context, Request, Requests};
use crate::session::load_frame;
use crate::session::prediction::FitInputs;

/// A sphere stands for so many pixels of the subject in a view, or more.
const PIXELS_A_SPHERE: usize = 25;
/// The fewest spheres of a body.
const FEWEST: usize = 120;

/// Frames with poses, of which a body of spheres is made.
#[derive(Debug)]
pub(super) struct SpheresJob {
    pub(super) footage: Arc<Footage>,
    pub(super) measurement: Arc<Vec<SegmentOptions>>,
    pub(super) fit: FitInputs,
    /// Frames that are still to be read, each with its pose.
    pub(super) waiting: VecDeque<(usize, Pose)>,
    pub(super) read: Vec<PosedViews>,
}

impl Job<Found> for SpheresJob {
    fn step(&mut self, out: &Outbox<Found>) -> Step {
        if out.cancel().is_cancelled() {
            return Step::Done;
        }
        if let Some((frame, pose)) = self.waiting.pop_front() {
            self.fit.frame = Some(Arc::new(load_frame(&self.footage, &self.measurement, frame)));
            self.read.push(PosedViews { frame, views: self.fit.views(), pose });
            return Step::Again;
        }
        let frames = std::mem::take(&mut self.read);
        let (options, fit) = (options_for(&frames), FitOptions::default());
        let told = |what: &str| out.send(Found::At(format!("Making a body of spheres: {what}")));
        match sphere_body(&self.fit.model, frames, &options, &fit, out.cancel(), told) {
            Ok(body) => out.send(Found::Spheres(Box::new(body))),
            Err(SphereBodyError::Cancelled) => {}
            Err(error) => out.send(Found::Refused(format!("No body of spheres can be made: {error}."))),
        }
        Step::Done
    }
}

/// No more spheres than the pictures can show.
fn options_for(frames: &[PosedViews]) -> SphereBodyOptions {
    let masks = frames.iter().flat_map(|frame| &frame.views).filter_map(|view| match &view.evidence {
        Evidence::Mask(mask) => Some(mask),
        Evidence::Measurement(_) => None,
    });
    let areas = masks.map(|mask| mask.labels().iter().filter(|label| **label == Label::Subject).count());
    let (sum, count) = areas.fold((0, 0), |(sum, count), area| (sum + area, count + 1));
    let usual = SphereBodyOptions::default();
    let shown = sum / count.max(1) / PIXELS_A_SPHERE;
    SphereBodyOptions { spheres: shown.clamp(FEWEST, usual.spheres), ..usual }
}

/// The body of spheres becomes the document's, drawn by its spheres: one act.
pub(super) fn take_in(body: &SphereBody, context: &Context<'_>, requests: &mut Requests) {
    let (document, gesture) = (context.document(), Some(next_gesture(context.egui)));
    let model = Arc::new(body.model.clone().renamed(document.model.name()));
    let renderer = RendererKind::SphereTree { spheres: None };
    let options = Box::new(FitOptions { renderer, ..(*document.fit).clone() });
    requests.edits.push((Edit::SetBody(model), gesture));
    requests.edits.push((Edit::SetFit { options, what: "Make body of spheres".to_owned() }, gesture));
    let views = ViewSettings { spheres: true, sphere_level: None, ..context.views };
    requests.request(Request::Views(views));
    let count = body.spheres.last().copied().unwrap_or(0);
    let mut said = format!("The body is {count} spheres in {} levels now", body.spheres.len());
    if let Some([capsules, _, spheres]) = body.iou {
        said.push_str(&format!(
            ": IoU {spheres:.3} in the frames that it was made from, with capsules {capsules:.3}"
        ));
    }
    requests
        .inform(format!("{said}. Run or track again with it."), Some(Command::History(HistoryCommand::Undo)));
}
