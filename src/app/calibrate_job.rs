//! Making footage again for other cameras: the lens is taken out of every picture by tables that take their time.

use std::sync::Arc;

use backlit_jobs::{Job, Outbox, Step};
use backlit_take::footage::Footage;
use backlit_take::replacement::Calibration;

/// Footage that is to be seen by other cameras.
#[derive(Debug)]
pub(crate) struct CalibrateJob {
    pub(crate) footage: Arc<Footage>,
    /// The cameras; the take's own without any.
    pub(crate) calibration: Option<Arc<Calibration>>,
}

impl Job<Arc<Footage>> for CalibrateJob {
    fn step(&mut self, out: &Outbox<Arc<Footage>>) -> Step {
        out.send(Arc::new(self.footage.with_calibration(self.calibration.take())));
        Step::Done
    }
}
