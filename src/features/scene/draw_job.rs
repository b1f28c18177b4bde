//! The picture of the 3-D scene.

use std::sync::Arc;

use crate::features::scene::{SceneDrawing, SceneOrder};
use crate::worker::{Event, Job, Outbox, Step};

/// Draws the scene for the window.
#[derive(Debug)]
pub struct DrawSceneJob {
    /// What is to be seen; taken when it is drawn.
    order: Option<SceneOrder>,
    /// The picture on the screen, whose parts may be reused.
    earlier: Option<Arc<SceneDrawing>>,
}

impl DrawSceneJob {
    /// What is to be seen, and the picture on the screen.
    #[must_use]
    pub fn new(order: SceneOrder, earlier: Option<Arc<SceneDrawing>>) -> Self {
        Self { order: Some(order), earlier }
    }
}

impl Job<Event> for DrawSceneJob {
    fn step(&mut self, out: &Outbox<Event>) -> Step {
        if let Some(order) = self.order.take() {
            let drawing = SceneDrawing::new(order, self.earlier.as_deref());
            out.send(Event::SceneDrawn(Arc::new(drawing)));
        }
        Step::Done
    }
}
