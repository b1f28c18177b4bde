//! A person, a body's own sizes, a body of spheres: made from several frames, then taken into the document.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_jobs::{Job, Outbox, Turn};
use backlit_runs::person::{PersonSearch, PersonSearchError};
use backlit_runs::track::{FrameReader, survey};
use backlit_tracking::body::{Model, Pose, SizeKind};
use backlit_tracking::body_fit::survey::LOOKED_AT;
use backlit_tracking::body_fit::{
    BodyFit, BodyFitError, BodyFitOptions, BodyFrame, CLOTHED, FirstSizes, Person, fit_body, frames as choice,
};
use backlit_tracking::body_spheres::{
    PosedViews, SphereBody, SphereBodyError, SphereBodyOptions, SphereBodyProgress, sphere_body,
};
use backlit_tracking::fit::{Evidence, FitOptions};
use backlit_tracking::render::RendererKind;
use backlit_tracking::silhouette::Label;
use backlit_ui::style::format;

use super::job::WindowReader;
use super::{Applied, applied, people, progress, refused};
use crate::context::activity::WorkShare;
use crate::context::command::{Command, HistoryCommand};
use crate::context::command_button::next_gesture;
use crate::context::view_settings::ViewSettings;
use crate::context::{Context, FeatureRequest, Requests};

/// Frames that a body is fitted to: more of one movement say little more.
pub(super) const SIZE_FRAMES: usize = 8;
/// Frames that limbs are carved from: each view takes away what the others could not see.
pub(super) const SPHERE_FRAMES: usize = 12;
/// A sphere stands for at least this many pixels of the subject in a view.
const PIXELS_A_SPHERE: usize = 25;
/// The fewest spheres of a body.
const FEWEST: usize = 120;
/// What helps where nobody was found, in sentences.
const REMEDY: &str = "Look at the silhouettes first: a picture of the room without the person, masks of another tool, or \
                                 keypoints beside the footage make them better. Or set a pose near the person by hand.";
/// What a notice offers.
const UNDO: Option<Command> = Some(Command::History(HistoryCommand::Undo));

/// Frames with poses, of which a body is made: one frame is read a step, then all are used at once.
#[derive(Debug)]
pub(super) struct BodyJob {
    pub(super) reader: WindowReader,
    /// Frames that are still to be read, each with its pose.
    pub(super) waiting: VecDeque<(usize, Pose)>,
    pub(super) read: Vec<PosedViews>,
    /// Makes a body of this one, and says what came of it.
    pub(super) make: fn(&Arc<Model>, Vec<PosedViews>, &Outbox<Applied>),
}

impl Job<Applied> for BodyJob {
    fn step(&mut self, out: &Outbox<Applied>) -> Turn {
        if out.cancel().is_cancelled() {
            return Turn::Done;
        }
        if let Some((frame, pose)) = self.waiting.pop_front() {
            match self.reader.read(frame) {
                Ok(read) => self.read.push(PosedViews { frame, views: read.views(), pose }),
                Err(error) => {
                    out.send(refused(format!("The body cannot be made: {error}.")));
                    return Turn::Done;
                }
            }
            return Turn::Again;
        }
        (self.make)(&self.reader.fit.model, std::mem::take(&mut self.read), out);
        Turn::Done
    }
}

/// The frames that a body is made of, with their poses: at most `most` of those that have poses of their own, or else the one
/// on the screen.
pub(super) fn frames(context: &Context<'_>, most: usize) -> VecDeque<(usize, Pose)> {
    let document = context.document();
    let is_lost = |frame: usize| document.estimates.get(&frame).is_some_and(|found| found.lost);
    let all = 0..context.session.frame_count();
    let posed: Vec<usize> = all.filter(|&frame| document.has_pose(frame) && !is_lost(frame)).collect();
    let shown = context.selection.frame;
    let chosen = if posed.is_empty() { vec![shown] } else { choice::spread(&posed, most) };
    chosen.into_iter().map(|frame| (frame, document.pose_at(frame).clone())).collect()
}

pub(super) fn sizes(model: &Arc<Model>, frames: Vec<PosedViews>, out: &Outbox<Applied>) {
    let start =
        |PosedViews { frame, views, pose }| BodyFrame { frame, views, start: pose, joints: Vec::new() };
    let frames = frames.into_iter().map(start).collect();
    let options = BodyFitOptions::default().with_proportions(CLOTHED);
    match fit_body(Arc::clone(model), frames, FirstSizes::Silhouettes, &options, out.cancel(), |_| {}) {
        Ok(fit) => out.send(applied(move |_, context, requests| take_in_sizes(&fit, context, requests))),
        Err(BodyFitError::Cancelled) => {}
        Err(error) => out.send(refused(format!("The body cannot be fitted: {error}."))),
    }
}

fn take_in_sizes(fit: &BodyFit, context: &Context<'_>, requests: &mut Requests) {
    let before = &context.document().model;
    let model = Arc::new(fit.model.clone().renamed(before.name()));
    let is_other = model != *before;
    requests.edit(Edit::SetBody(model));
    if is_other {
        requests.inform(sizes_text(fit), UNDO);
    }
}

/// "Fitted the body to 8 frames: IoU 0.890, scaled as a whole 0.877. Hardly seen: length of neck, radius of hip. …"
fn sizes_text(fit: &BodyFit) -> String {
    let mut said = format!("Fitted the body to {}", format::counted(fit.frames.len(), "frame"));
    if let [Some(before), Some(after)] = fit.iou {
        said.push_str(&format!(": IoU {after:.3}, scaled as a whole {before:.3}"));
    }
    let held: Vec<String> = fit
        .sizes
        .iter()
        .filter(|size| size.is_held_by_prior())
        .map(|size| {
            let kind = if size.kind == SizeKind::Length { "length" } else { "radius" };
            format!("{kind} of {}", size.name)
        })
        .collect();
    let hardly = match held.len() {
        0 => String::new(),
        1..=4 => format!(" Hardly seen: {}.", held.join(", ")),
        many => format!(" {many} of {} sizes are hardly seen.", fit.sizes.len()),
    };
    format!("{said}.{hardly} Run or track again with it.")
}

/// Limbs carved from all silhouettes, and spheres in them.
pub(super) fn spheres(model: &Arc<Model>, frames: Vec<PosedViews>, out: &Outbox<Applied>) {
    let (options, fit) = (sphere_options(&frames), FitOptions::default());
    let tell = |SphereBodyProgress { doing, done, total }| {
        let text = format!("Making a body of spheres: {doing}, {} of {total}", done + 1);
        out.send(progress(text, Some(WorkShare { done, total })));
    };
    match sphere_body(model, frames, &options, &fit, out.cancel(), tell) {
        Ok(body) => out.send(applied(move |_, context, requests| take_in_spheres(&body, context, requests))),
        Err(SphereBodyError::Cancelled) => {}
        Err(error) => out.send(refused(format!("No body of spheres can be made: {error}."))),
    }
}

/// No more spheres than the pictures can show.
fn sphere_options(frames: &[PosedViews]) -> SphereBodyOptions {
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
fn take_in_spheres(body: &SphereBody, context: &Context<'_>, requests: &mut Requests) {
    let (document, gesture) = (context.document(), Some(next_gesture(context.egui)));
    let model = Arc::new(body.model.clone().renamed(document.model.name()));
    let renderer = RendererKind::SphereTree { spheres: None };
    let options = Box::new(FitOptions { renderer, ..(*document.fit).clone() });
    requests.edits.push((Edit::SetBody(model), gesture));
    requests.edits.push((Edit::SetFit { options, what: "Make body of spheres".to_owned() }, gesture));
    let views = ViewSettings { spheres: true, sphere_level: None, ..context.views };
    requests.request(FeatureRequest::Views(views));
    let count = body.spheres.last().copied().unwrap_or(0);
    let mut said = format!("The body is {count} spheres in {} levels now", body.spheres.len());
    if let Some([capsules, _, spheres]) = body.iou {
        said.push_str(&format!(
            ": IoU {spheres:.3} in the frames that it was made from, with capsules {capsules:.3}"
        ));
    }
    requests.inform(format!("{said}. Run or track again with it."), UNDO);
}

/// Finds a person from nothing but silhouettes: a start, and the body's own sizes.
pub(super) fn find_person(search: PersonSearch, reader: &WindowReader, out: &Outbox<Applied>) {
    let frame = search.frames[0];
    let silhouettes = survey(reader, &search.frames, LOOKED_AT, out.cancel());
    let doubts: Vec<String> =
        silhouettes.doubts().map(|doubt| format!("{}.", format::capitalised(&doubt.to_string()))).collect();
    if !doubts.is_empty() {
        out.send(applied(move |_, _, requests| requests.inform(doubts.join(" "), None)));
    }
    if let Some(several) = silhouettes.several_people() {
        out.send(applied(move |tracking, _, requests| {
            // Where all frames are tracked next, the tracker says it.
            if !tracking.tracks_then {
                people::tell_of_several(&several, requests);
            }
        }));
    }
    match search.run(reader.footage.take(), reader, out.cancel(), |text| out.send(progress(text, None))) {
        _ if out.cancel().is_cancelled() => {}
        Ok(person) => out.send(applied(move |tracking, context, requests| {
            take_in_person(frame, &person, context, requests);
            tracking.tracks_next = std::mem::take(&mut tracking.tracks_then);
        })),
        Err(PersonSearchError::Keypoints(error)) => {
            out.send(refused(format!("The keypoints cannot be read: {error}.")));
        }
        Err(error) => out.send(refused(format!("Nobody was found: {error}. {REMEDY}"))),
    }
}

/// The person who was found becomes the document's.
fn take_in_person(frame: usize, person: &Person, context: &Context<'_>, requests: &mut Requests) {
    let before = &context.document().model;
    if *person.model != **before {
        requests.edit(Edit::SetBody(Arc::new((*person.model).clone().renamed(before.name()))));
    }
    requests.edit(Edit::SetPose { frame, pose: person.start.clone(), what: "Find person".to_owned() });
    requests.inform(person_text(person), UNDO);
}

/// "Found the person. Own sizes: IoU 0.893 in frames held out, only scaled 0.871."
fn person_text(person: &Person) -> String {
    let mut said = if person.search.is_some() { "Found the person." } else { "" }.to_owned();
    for doubt in person.search.iter().flat_map(|found| &found.doubts) {
        said += &format!(" {}.", format::capitalised(&doubt.to_string()));
    }
    match &person.sizes {
        Some(Ok(own)) if own.is_taken() => {
            if let [Some(scaled), Some(found)] = own.judged.iou {
                said += &format!(" Own sizes: IoU {found:.3} in frames held out, only scaled {scaled:.3}.");
            }
        }
        Some(Ok(own)) => {
            let factor = format::percent(own.scaled.size - 1.0);
            said +=
                &format!(" The person’s own sizes were not trusted; the body is only scaled, by {factor}.");
        }
        Some(Err(error)) => said += &format!(" The person’s own sizes cannot be found: {error}."),
        None => {}
    }
    said.trim_start().to_owned()
}
