//! Ways to begin, tried one after the other on one frame.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Instant;

use backlit_tracking::body::{Model, Pose};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitView;
use backlit_tracking::initialisation::{
    Attempt, InitialisationInputs, InitialisationMethod, InitialisationOptions, InitialisationResult,
};
use backlit_tracking::metrics::{JointErrors, ReferenceJoints};

/// One frame and the methods that are still to be tried on it.
#[derive(Debug, Clone)]
pub struct InitialisationRun {
    /// The body.
    pub model: Arc<Model>,
    /// What the cameras see.
    pub views: Vec<FitView>,
    /// Where the methods begin; `None` where nothing is known.
    pub start: Option<Pose>,
    /// The joints that are taken as true, as far as they are known.
    pub reference: Option<ReferenceJoints>,
    /// The methods' choices.
    pub options: InitialisationOptions,
    /// What is still to be tried, in order.
    pub methods: VecDeque<InitialisationMethod>,
}

/// What a run tells.
#[derive(Debug)]
pub enum InitialisationMessage<'a> {
    /// A method begins.
    Begun(InitialisationMethod),
    /// It has tried something.
    Attempt(Attempt<'a>),
    /// It has come by a pose.
    Ended(InitialisationMethod, InitialisationOutcome),
    /// It has come by none; why.
    Failed(InitialisationMethod, String),
}

/// What a method led to.
#[derive(Debug)]
pub struct InitialisationOutcome {
    /// Its hypotheses.
    pub result: InitialisationResult,
    /// The best pose.
    pub pose: Pose,
    /// Wall time.
    pub seconds: f64,
    /// Mean distance of the joints from the reference, millimetres.
    pub error_mm: Option<f64>,
}

impl InitialisationRun {
    /// Tries the next method; whether others are left. Nothing is told of one that was cancelled.
    pub fn step(
        &mut self,
        cancel: &CancelToken,
        on_message: &mut dyn FnMut(InitialisationMessage<'_>),
    ) -> bool {
        let Some(method) = self.methods.pop_front().filter(|_| !cancel.is_cancelled()) else { return false };
        on_message(InitialisationMessage::Begun(method));
        let began = Instant::now();
        let (model, views, start) = (&self.model, &self.views, self.start.as_ref());
        let inputs = InitialisationInputs { model, views, start, cancel };
        let on_attempt = &mut |attempt: Attempt<'_>| on_message(InitialisationMessage::Attempt(attempt));
        let result = self.options.run(method, &inputs, on_attempt);
        if cancel.is_cancelled() {
            return false;
        }
        let outcome = result.map_err(|error| error.to_string()).and_then(|result| {
            let pose = result.pose().cloned().ok_or("the silhouettes do not meet in space")?;
            let (seconds, error_mm) = (began.elapsed().as_secs_f64(), self.error_mm(&result.model, &pose));
            Ok(InitialisationOutcome { result, pose, seconds, error_mm })
        });
        on_message(match outcome {
            Ok(outcome) => InitialisationMessage::Ended(method, outcome),
            Err(why) => InitialisationMessage::Failed(method, why),
        });
        !self.methods.is_empty()
    }

    fn error_mm(&self, model: &Model, pose: &Pose) -> Option<f64> {
        let mut errors = JointErrors::default();
        errors.add(model, pose, self.reference.as_ref()?);
        errors.overall().map(|all| all.mean)
    }
}
