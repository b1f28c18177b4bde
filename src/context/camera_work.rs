//! Work about the cameras in use, as cards have it: it begins as soon as the footage is seen by the document's cameras, and what it
//! says stays about those that it began with.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::footage::replacement::Calibration;
use backlit_jobs::{Job, Outbox, Pool, Task, TaskEvent, one_step};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{WorkAnswer, hint, work_buttons};
use egui::{RichText, Ui};

use super::{Context, Requests};

/// Work that tells its progress as `P` and ends with an `R`.
#[derive(Debug)]
pub(crate) struct CameraWork<P, R, const PRIORITY: u8> {
    task: Task<(), WorkMessage<P, R>, PRIORITY>,
    is_wanted: bool,
    progress: Option<P>,
    /// The cameras that it began with; `None` for the take's own.
    calibration: Option<Arc<Calibration>>,
    outcome: Option<Result<Box<R>, String>>,
}

/// What such work tells.
#[derive(Debug)]
pub(crate) enum WorkMessage<P, R> {
    At(P),
    Ended(Result<Box<R>, String>),
}

impl<P, R, const PRIORITY: u8> Default for CameraWork<P, R, PRIORITY> {
    fn default() -> Self {
        Self { task: Task::default(), is_wanted: false, progress: None, calibration: None, outcome: None }
    }
}

impl<P: Send + 'static, R: Send + 'static, const PRIORITY: u8> CameraWork<P, R, PRIORITY> {
    /// It begins as soon as it can.
    pub(crate) const fn want(&mut self) {
        self.is_wanted = true;
    }

    /// The same unless what it said is about the cameras in use.
    pub(crate) fn want_current(&mut self, context: &Context<'_>) {
        self.is_wanted = !self.is_current(context);
    }

    /// Hears what was told; `what` names the work. The footage that it is to [begin](Self::begin) with, if it is time.
    pub(crate) fn update(
        &mut self,
        what: &str,
        context: &Context<'_>,
        requests: &mut Requests,
    ) -> Option<Arc<Footage>> {
        for event in self.task.poll() {
            match event {
                TaskEvent::Output(WorkMessage::At(progress)) => self.progress = Some(progress),
                TaskEvent::Output(WorkMessage::Ended(outcome)) => self.outcome = Some(outcome),
                TaskEvent::Ended => self.progress = None,
                TaskEvent::Failed(failure) => requests.failed(what, &failure),
            }
        }
        let take = context.session.take.as_ref().filter(|_| self.is_wanted)?;
        if take.calibration != context.document().calibration {
            return None;
        }
        *self = Self { task: std::mem::take(&mut self.task), ..Self::default() };
        self.calibration.clone_from(&take.calibration);
        Some(Arc::clone(take))
    }

    pub(crate) fn begin<J: Job<WorkMessage<P, R>> + 'static>(&mut self, pool: &Pool, job: J) {
        self.task.begin(pool, (), |()| job);
    }

    /// The same with work of one step. It is told where it was not cancelled.
    pub(crate) fn begin_step(
        &mut self,
        pool: &Pool,
        step: impl FnOnce(&Outbox<WorkMessage<P, R>>) -> Result<R, String> + Send + 'static,
    ) {
        self.begin(
            pool,
            one_step(move |out: &Outbox<_>| {
                let outcome = step(out);
                if !out.cancel().is_cancelled() {
                    out.send(WorkMessage::Ended(outcome.map(Box::new)));
                }
            }),
        );
    }

    /// It cannot begin.
    pub(crate) fn refuse(&mut self, why: &str) {
        self.outcome = Some(Err(why.to_owned()));
    }

    pub(crate) const fn progress(&self) -> Option<&P> {
        self.progress.as_ref()
    }

    /// How it ended; `None` where it has not, or was stopped.
    pub(crate) const fn outcome(&self) -> Option<&Result<Box<R>, String>> {
        self.outcome.as_ref()
    }

    pub(crate) fn result(&self) -> Option<&R> {
        self.outcome.as_ref()?.as_ref().ok().map(|result| &**result)
    }

    /// Whether it said something about the cameras in use.
    pub(crate) fn is_current(&self, context: &Context<'_>) -> bool {
        self.outcome.is_some() && self.calibration == context.document().calibration
    }

    pub(crate) const fn is_busy(&self) -> bool {
        self.is_wanted || self.task.is_busy()
    }

    pub(crate) fn stop(&mut self) {
        self.is_wanted = false;
        self.task.stop();
    }

    /// Why there is no result, unless nothing was asked: what stands in its place on the card.
    pub(crate) fn no_result(&self, ui: &mut Ui, stopped: &str) {
        match &self.outcome {
            None => hint(ui, stopped),
            Some(Err(why)) => {
                let why = format!("{}.", format::capitalised(why));
                ui.label(RichText::new(why).color(theme::palette(ui).warn));
            }
            Some(Ok(_)) => {}
        }
    }

    /// The card's buttons: *Stop* while it works, else `verb` (*Check*, and *Check again*) and *Close* beside others. Whether the card
    /// is closed.
    pub(crate) fn buttons(
        &mut self,
        ui: &mut Ui,
        (verb, is_primary): (&str, bool),
        others: impl FnOnce(&mut Ui),
    ) -> bool {
        let text = if self.outcome.is_some() { format!("{verb} again") } else { verb.to_owned() };
        let answer = work_buttons(ui, self.is_busy(), (&text, is_primary), others);
        match answer {
            Some(WorkAnswer::Stop) => self.stop(),
            Some(WorkAnswer::Again) => self.want(),
            Some(WorkAnswer::Close) | None => {}
        }
        answer == Some(WorkAnswer::Close)
    }
}
