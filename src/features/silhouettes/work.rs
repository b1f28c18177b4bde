//! What takes its time: the worst silhouettes of the take, and settings that suit it better.

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_jobs::{Outbox, TaskEvent, one_step};
use backlit_runs::silhouettes::{
    PosedBody, SilhouetteQuality, TuneError, TunedSettings, changes, tune, worst,
};
use backlit_tracking::segment::SegmentOptions;
use backlit_ui::style::format;

use super::{LISTED, SilhouetteSteering};
use crate::context::command::{Command, HistoryCommand, SilhouetteCommand, WindowCommand};
use crate::context::pane::Pane;
use crate::context::{Context, Requests};

/// The most frames of a take that are looked at.
const MOST_FRAMES: usize = 400;
/// What is being done, as the status bar says it.
const FINDING: &str = "Looking for the worst silhouettes";
const TUNING: &str = "Trying settings of the silhouettes";

#[derive(Debug)]
pub(super) enum WorkMessage {
    At(&'static str, [usize; 2]),
    Worst(Vec<SilhouetteQuality>),
    Tuned { before: Box<SegmentOptions>, found: Result<Box<TunedSettings>, TuneError> },
}

impl SilhouetteSteering {
    pub(super) fn take_in_work(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for event in self.work.poll() {
            match event {
                TaskEvent::Output(WorkMessage::At(doing, done)) => self.progress = Some((doing, done)),
                TaskEvent::Output(WorkMessage::Worst(mut found)) => {
                    found.truncate(LISTED);
                    if !context.shows(Pane::Silhouettes) {
                        let text = match found.len() {
                            0 => "Nothing speaks against any silhouette.",
                            _ => {
                                "The worst silhouettes are marked on the timeline, and listed in the pane Silhouettes."
                            }
                        };
                        let pane = Command::Window(WindowCommand::TogglePane(Pane::Silhouettes));
                        requests.inform(text, Some(pane).filter(|_| !found.is_empty()));
                    }
                    self.worst = Some(found);
                }
                TaskEvent::Output(WorkMessage::Tuned { before, found }) => {
                    self.use_tuned(&before, found, requests);
                }
                TaskEvent::Ended => self.progress = None,
                TaskEvent::Failed(failure) => requests.failed("Looking through the silhouettes", &failure),
            }
        }
    }

    /// Whether this command is what is going on.
    pub(super) fn is_working_on(&self, command: SilhouetteCommand) -> bool {
        self.progress.is_some_and(|(doing, _)| match command {
            SilhouetteCommand::FindWorst => doing == FINDING,
            SilhouetteCommand::Tune => doing == TUNING,
            _ => false,
        })
    }

    pub(super) fn find_worst(&mut self, context: &Context<'_>) {
        let Some(take) = context.session.take.clone() else { return };
        let (measurement, body) = (context.document().measurement.clone(), posed_body(context));
        let count = take.frame_count();
        let frames: Vec<usize> = (0..count).step_by(count.div_ceil(MOST_FRAMES).max(1)).collect();
        self.progress = Some((FINDING, [0, frames.len()]));
        self.work.begin(context.pool, (), |()| {
            one_step(move |out: &Outbox<WorkMessage>| {
                let tell = |done| out.send(WorkMessage::At(FINDING, [done, frames.len()]));
                let found = worst(&take, &measurement, &frames, Some(&body), out.cancel(), tell);
                if !out.cancel().is_cancelled() {
                    out.send(WorkMessage::Worst(found));
                }
            })
        });
    }

    pub(super) fn tune(&mut self, context: &Context<'_>) {
        let Some(take) = context.session.take.clone() else { return };
        let (measurement, body) = (context.document().measurement.clone(), posed_body(context));
        self.progress = Some((TUNING, [0, 1]));
        self.work.begin(context.pool, (), |()| {
            one_step(move |out: &Outbox<WorkMessage>| {
                let tell = |done| out.send(WorkMessage::At(TUNING, done));
                let found = tune(&take, &measurement, &body, out.cancel(), tell).map(Box::new);
                if !out.cancel().is_cancelled() {
                    let before = Box::new(measurement.first().cloned().unwrap_or_default());
                    out.send(WorkMessage::Tuned { before, found });
                }
            })
        });
    }

    /// Puts the settings that were found in the place of those before, and says what they change.
    fn use_tuned(
        &mut self,
        before: &SegmentOptions,
        found: Result<Box<TunedSettings>, TuneError>,
        requests: &mut Requests,
    ) {
        let found = match found {
            Ok(found) => found,
            Err(error) => return requests.complain(format!("Settings cannot be chosen: {error}.")),
        };
        let agreement = |mean: f64| format!("{} %", format::number(100.0 * mean, 1));
        let (was, is) = (agreement(found.before.mean()), agreement(found.after.mean()));
        let changes = changes(before, &found.options);
        let said = if changes.is_empty() {
            let tried = format::counted(found.tried - 1, "other setting");
            format!("Cameras and body agree to {was}; none of {tried} is better by more than chance.")
        } else {
            requests.edit(Edit::SetMeasurement(Box::new(found.options)));
            format!("Cameras and body agree to {is}, {was} before: {}.", changes.join(", "))
        };
        let undo = (!changes.is_empty()).then_some(Command::History(HistoryCommand::Undo));
        requests.inform(said.clone(), undo);
        self.tuned = Some(said);
    }

    pub(super) fn stop(&mut self) {
        self.work.stop();
        self.progress = None;
    }
}

/// The document's body with all its poses.
fn posed_body(context: &Context<'_>) -> PosedBody {
    let document = context.document();
    PosedBody {
        model: Arc::clone(&document.model),
        fit: Arc::clone(&document.fit),
        poses: document.own_poses(),
    }
}
