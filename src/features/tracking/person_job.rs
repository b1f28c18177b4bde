//! A person found from nothing but silhouettes: a start, and the body's own sizes.

use std::sync::Arc;

use backlit_jobs::{Job, Outbox, Step};
use backlit_take::footage::Footage;
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::{
    OwnSizesProgress, Person, PersonError, PersonOptions, PersonProgress, find_person,
};
use backlit_tracking::fit::FitView;
use backlit_tracking::segment::SegmentOptions;
use backlit_ui::style::format;

use super::Found;
use crate::session::load_frame;
use crate::session::prediction::FitInputs;

/// A person to be found.
#[derive(Debug)]
pub(super) struct PersonJob {
    pub(super) footage: Arc<Footage>,
    pub(super) measurement: Arc<Vec<SegmentOptions>>,
    pub(super) fit: FitInputs,
    /// The pose of the first frame, where it is known.
    pub(super) start: Option<Pose>,
    /// The first is searched for a start where none is known; sizes are fitted to some of them.
    pub(super) frames: Vec<usize>,
    /// Whether the body's sizes are looked for.
    pub(super) sizes: bool,
}

impl Job<Found> for PersonJob {
    fn step(&mut self, out: &Outbox<Found>) -> Step {
        let mut options = PersonOptions::new((*self.fit.fit).clone(), self.sizes, self.footage.frame_rate);
        if self.sizes {
            match self.footage.keypoint_joints(&options.followed(&self.frames)) {
                Ok(joints) => options.joints = joints,
                Err(error) => {
                    out.send(Found::Refused(format!("The keypoints cannot be read: {error}.")));
                    return Step::Done;
                }
            }
        }
        let mut fit = self.fit.clone();
        let mut views = |frame: usize| -> Result<Vec<FitView>, PersonError> {
            fit.frame = Some(Arc::new(load_frame(&self.footage, &self.measurement, frame)));
            Ok(fit.views())
        };
        let tell = |at| out.send(Found::At(progress_text(at)));
        let found = find_person(
            &self.fit.model,
            self.start.take(),
            &self.frames,
            &options,
            out.cancel(),
            &mut views,
            tell,
        );
        match found {
            _ if out.cancel().is_cancelled() => {}
            Ok(person) => {
                let said = said_of(&person);
                out.send(Found::Person { frame: self.frames[0], person: Box::new(person), said });
            }
            Err(error) => out.send(Found::Refused(format!("Nobody was found: {error}."))),
        }
        Step::Done
    }
}

fn progress_text(at: PersonProgress) -> String {
    match at {
        PersonProgress::Searching => "Looking for the person".to_owned(),
        PersonProgress::Following(done, all) => {
            format!("Finding the person’s sizes: {done} of {all} frames tracked")
        }
        PersonProgress::Sizes(OwnSizesProgress::Reading(..)) => {
            "Finding the person’s sizes: reading frames".to_owned()
        }
        PersonProgress::Sizes(OwnSizesProgress::Fitting(at) | OwnSizesProgress::Scaling(at)) => {
            format!("Finding the person’s sizes: stage {} of {}", at.stage + 1, at.stages)
        }
        PersonProgress::Sizes(OwnSizesProgress::Judging(..)) => {
            "Finding the person’s sizes: judging them".to_owned()
        }
    }
}

/// "Found the person. Body 3 % taller, own sizes: IoU 0.893 in frames held out, only scaled 0.871."
fn said_of(person: &Person) -> String {
    let mut said = if person.search.is_some() { "Found the person." } else { "" }.to_owned();
    for doubt in person.search.iter().flat_map(|found| &found.doubts) {
        let text = doubt.to_string();
        let mut letters = text.chars();
        let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
        said += &format!(" {first}{}.", letters.as_str());
    }
    match &person.sizes {
        Some(Ok(own)) if own.is_taken() => {
            if let [Some(scaled), Some(found)] = own.judged.iou {
                said += &format!(" Own sizes: IoU {found:.3} in frames held out, only scaled {scaled:.3}.");
            }
        }
        Some(Ok(own)) => {
            let factor = format::percent(own.scaled.size - 1.0);
            said += &format!(
                " The person’s own sizes were not trusted; the body is only scaled, by \
                              {factor}."
            );
        }
        Some(Err(error)) => said += &format!(" The person’s own sizes cannot be found: {error}."),
        None => {}
    }
    said.trim_start().to_owned()
}
