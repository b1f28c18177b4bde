//! The fit of one frame, one iteration a step.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use backlit_tracking::body::Pose;
use backlit_tracking::fit::{Fit, FitError, FitOptions};

use crate::document::run::RunEnding;
use crate::session::prediction::{FitInputs, Predicted};
use crate::worker::{Event, Job, Outbox, Step};

/// What a fit begins with.
#[derive(Debug, Clone)]
pub struct FitStart {
    /// The frame's data and the choices of the fit.
    pub scene: FitInputs,
    /// Where it begins.
    pub pose: Pose,
    /// The scene's choices, at the scale of what is seen.
    pub options: FitOptions,
    /// Rotations that may move; all of them if there is none.
    pub free: Option<Vec<bool>>,
}

/// A fit that waits for its next step. The job puts it back when it has done its steps, so that damping and
/// stage go on where they were.
pub type LiveFit = Arc<Mutex<Option<Running>>>;

/// A fit between two steps.
#[derive(Debug)]
pub struct Running {
    fit: Fit,
    scene: FitInputs,
    last: Arc<Predicted>,
}

/// Steps of a fit.
#[derive(Debug)]
pub struct FitJob {
    /// Begins a new fit; otherwise the live one goes on.
    start: Option<FitStart>,
    live: LiveFit,
    /// Steps to do; `None` runs to the end.
    left: Option<usize>,
    running: Option<Running>,
}

impl FitJob {
    /// Begins a fit and does so many steps, or all of them.
    #[must_use]
    pub fn begin(start: FitStart, live: LiveFit, steps: Option<usize>) -> Self {
        Self { start: Some(start), live, left: steps, running: None }
    }

    /// Goes on with the live fit.
    #[must_use]
    pub fn go_on(live: LiveFit, steps: Option<usize>) -> Self {
        Self { start: None, live, left: steps, running: None }
    }

    fn prepare(&mut self, out: &Outbox<Event>) -> Result<(), FitError> {
        if let Some(start) = self.start.take() {
            let model = start.scene.model.clone();
            let views = start.scene.views();
            let fit = Fit::with_free_rotations(model, views, start.pose, start.options, start.free)?;
            let last = Arc::new(Predicted::new(&start.scene, fit.pose(), None));
            let first = last.start_of(&fit);
            out.send(Event::FitStep(Box::new(first), last.clone()));
            self.running = Some(Running { fit, scene: start.scene, last });
        } else {
            self.running = self.live.lock().unwrap_or_else(PoisonError::into_inner).take();
        }
        Ok(())
    }

    fn end(&mut self, out: &Outbox<Event>, ending: Option<RunEnding>) -> Step {
        let mut live = self.live.lock().unwrap_or_else(PoisonError::into_inner);
        *live = self.running.take().filter(|running| running.fit.termination().is_none());
        out.send(Event::FitEnded(ending));
        Step::Done
    }
}

impl Job<Event> for FitJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if self.running.is_none()
            && let Err(error) = self.prepare(out)
        {
            out.send(Event::Failed(format!("The fit cannot begin: {error}")));
            return self.end(out, Some(RunEnding::Solver(error.to_string())));
        }
        if out.cancel().is_cancelled() {
            return self.end(out, Some(RunEnding::Stopped));
        }
        if self.left == Some(0) {
            return self.end(out, None);
        }
        let Some(running) = &mut self.running else { return self.end(out, Some(RunEnding::Stopped)) };
        let began = Instant::now();
        let Some(record) = running.fit.step() else {
            let is_annealed = running.scene.fit.stages.len() > 1;
            let ending = running.fit.termination().map(|why| RunEnding::of(why, is_annealed));
            return self.end(out, Some(ending.unwrap_or(RunEnding::Stopped)));
        };
        let seconds = began.elapsed().as_secs_f64();
        if record.accepted {
            running.last = Arc::new(Predicted::new(&running.scene, &record.pose, Some(&running.last)));
        }
        let step = running.last.step_of(&record, seconds);
        out.send(Event::FitStep(Box::new(step), running.last.clone()));
        self.left = self.left.map(|left| left.saturating_sub(1));
        Step::Again
    }
}
