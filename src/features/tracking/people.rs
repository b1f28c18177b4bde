//! One of several people: who is in view is found, boxes are shown in the views, and a click says whom to follow.

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_jobs::{Outbox, one_step};
use backlit_runs::people;
use backlit_tracking::people::{FEWEST_CAMERAS, FollowedPerson, PersonTrack};
use backlit_ui::style::format;

use super::job::WindowReader;
use super::{Applied, Tracking, TrackingWork, applied, progress, refused};
use crate::context::Context;
use crate::context::Requests;
use crate::context::activity::WorkShare;
use crate::context::command::{Command, HistoryCommand, TrackingCommand};
use crate::context::unavailable::{Why, because, no_silhouette, no_take};

const UNDO: Option<Command> = Some(Command::History(HistoryCommand::Undo));
const LOOKING: &str = "Looking for people";

/// Says that several people are in view, and offers to choose one.
pub(super) fn tell_of_several(several: &str, requests: &mut Requests) {
    requests.inform(format!("{several}."), Some(Command::Tracking(TrackingCommand::ChoosePerson)));
}

impl Tracking {
    /// Looks for everybody in view, to choose from.
    pub(super) fn find_people(&mut self, mut reader: WindowReader, context: &Context<'_>) {
        self.people = Arc::default();
        let frames: Vec<usize> = (0..context.session.frame_count()).collect();
        let job = one_step(move |out: &Outbox<Applied>| {
            let (calibration, plates) = (reader.footage.calibration.clone(), reader.footage.plates.clone());
            let everybody = reader.footage.with_replacements(calibration, plates, None);
            reader.footage = Arc::new(everybody);
            let tell = |done, total| {
                let share = Some(WorkShare { done, total });
                out.send(progress(format!("{LOOKING}: {done} of {total} frames"), share));
            };
            let found = people::find(&Arc::new(reader), &frames, out.cancel(), tell);
            match found {
                _ if out.cancel().is_cancelled() => {}
                Ok(found) => {
                    out.send(applied(|tracking, _, requests| tracking.offer_people(found, requests)));
                }
                Err(error) => out.send(refused(format!("People cannot be looked for: {error}."))),
            }
        });
        self.begin(TrackingWork::Make(LOOKING.to_owned(), None), context, job);
    }

    /// Shows who was found, if there is anybody to choose from.
    fn offer_people(&mut self, found: Vec<PersonTrack>, requests: &mut Requests) {
        let (text, next) = match found.len() {
            0 => ("Nobody as large as a person stands in all silhouettes.".to_owned(), None),
            1 => ("One person is in view: nobody has to be chosen.".to_owned(), None),
            people => {
                let leave = Command::Tracking(TrackingCommand::FollowEverybody);
                (
                    format!("{people} people are in view. Click the one to follow in a camera’s view."),
                    Some(leave),
                )
            }
        };
        requests.inform(text, next);
        self.people = Arc::new(if found.len() > 1 { found } else { Vec::new() });
    }

    /// Follows the person who was clicked, counted from 0.
    pub(super) fn follow_person(&mut self, number: usize, requests: &mut Requests) {
        let Some(person) = FollowedPerson::of(&self.people, number) else { return };
        let others = format::counted(self.people.len() - 1, "other");
        self.people = Arc::default();
        requests.edit(Edit::FollowPerson(Some(Arc::new(person))));
        requests.inform(
            format!(
                "Person {} is followed. Pixels of the {others} are unknown now. Find the start or track next.",
                number + 1
            ),
            UNDO,
        );
    }

    /// Everybody in view is the subject again.
    pub(super) fn follow_everybody(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.people = Arc::default();
        if context.document().person.is_some() {
            requests.edit(Edit::FollowPerson(None));
            requests.inform("Everybody in view is the subject again.", UNDO);
        }
    }

    pub(super) fn cannot_find_people(&self, context: &Context<'_>) -> Why {
        no_take(context)
            .or(because(
                context.document().used_cameras().count() < FEWEST_CAMERAS,
                "Two cameras cannot tell people apart: three or more are needed",
            ))
            .or(because(self.is_busy(), "The tracker is running"))
            .or(no_silhouette(context))
    }

    pub(super) fn cannot_follow_everybody(&self, context: &Context<'_>) -> Why {
        let follows_one = context.document().person.is_some() || !self.people.is_empty();
        because(!follows_one, "Everybody in view is the subject already")
    }
}
