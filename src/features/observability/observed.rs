//! What the cameras see of a pose, and what they do not.

use std::sync::Arc;
use std::time::Instant;

use backlit_tracking::body::Pose;
use backlit_tracking::fit::{Evidence, FitError, FitView};
use backlit_tracking::observability::{FrameInformation, Observability, SubsetFigures};

use crate::session::prediction::FitInputs;
use crate::worker::{Event, Job, Outbox, Step};

/// What the cameras see of a pose.
#[derive(Debug)]
pub struct Observed {
    /// What it depends on besides the pose.
    pub scene: FitInputs,
    /// The pose.
    pub pose: Pose,
    /// Of the cameras that count.
    pub shown: Observability,
    /// Sets of the cameras that have a silhouette, the best first.
    pub subsets: Vec<SubsetFigures>,
    /// How long it took, in seconds.
    pub seconds: f64,
}

impl Observed {
    /// Looks through every camera that has a silhouette.
    ///
    /// # Errors
    /// See [`FrameInformation::new`].
    pub fn new(scene: &FitInputs, pose: &Pose) -> Result<Self, FitError> {
        let start = Instant::now();
        let view = |camera: usize| {
            let weight = scene.uses.get(camera).map_or(1.0, |used| used.weight);
            let evidence = Evidence::Measurement(scene.data(camera)?);
            Some(FitView { camera: scene.cameras[camera].clone(), evidence, weight })
        };
        let views: Vec<Option<FitView>> = (0..scene.cameras.len()).map(view).collect();
        let information = FrameInformation::new(&scene.model, &views, &scene.fit, pose)?;
        let counts =
            |camera: &usize| scene.uses.get(*camera).is_some_and(|used| used.used && used.weight > 0.0);
        let used: Vec<usize> = (0..views.len()).filter(counts).collect();
        let shown = information.observe(&used);
        let subsets = information.compare_subsets(shown.noise);
        let seconds = start.elapsed().as_secs_f64();
        Ok(Self { scene: scene.clone(), pose: pose.clone(), shown, subsets, seconds })
    }

    /// Whether it is of this pose and these parts.
    #[must_use]
    pub fn is_of(&self, scene: &FitInputs, pose: &Pose) -> bool {
        self.pose == *pose && self.scene.is(scene)
    }
}

/// The same for the window.
#[derive(Debug)]
pub struct ObserveJob {
    /// What it depends on.
    pub scene: FitInputs,
    /// The pose.
    pub pose: Pose,
}

impl Job<Event> for ObserveJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        match Observed::new(&self.scene, &self.pose) {
            Ok(observed) => out.send(Event::Observed(Arc::new(observed))),
            Err(error) => out.send(Event::Failed(format!("What the cameras see cannot be told: {error}."))),
        }
        Step::Done
    }
}
