//! A body of spheres from several frames, and how it is taken in.

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_jobs::Outbox;
use backlit_tracking::body::Model;
use backlit_tracking::body_spheres::{
    PosedViews, SphereBody, SphereBodyError, SphereBodyOptions, sphere_body,
};
use backlit_tracking::fit::{Evidence, FitOptions};
use backlit_tracking::render::RendererKind;
use backlit_tracking::silhouette::Label;

use super::Found;
use crate::context::command::{Command, HistoryCommand};
use crate::context::command_button::next_gesture;
use crate::context::view_settings::ViewSettings;
use crate::context::{Context, Request, Requests};

/// A sphere stands for so many pixels of the subject in a view, or more.
const PIXELS_A_SPHERE: usize = 25;
/// The fewest spheres of a body.
const FEWEST: usize = 120;

/// Limbs carved from all silhouettes, and spheres in them.
pub(super) fn spheres(model: &Arc<Model>, frames: Vec<PosedViews>, out: &Outbox<Found>) {
    let (options, fit) = (options_for(&frames), FitOptions::default());
    let told = |what: &str| out.send(Found::At(format!("Making a body of spheres: {what}")));
    match sphere_body(model, frames, &options, &fit, out.cancel(), told) {
        Ok(body) => out.send(Found::Spheres(Box::new(body))),
        Err(SphereBodyError::Cancelled) => {}
        Err(error) => out.send(Found::Refused(format!("No body of spheres can be made: {error}."))),
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
