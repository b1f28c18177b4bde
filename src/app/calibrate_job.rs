//! Making footage again for other cameras or with other plates: the lens is taken out of every picture by tables that take their time.

use std::sync::Arc;

use backlit_jobs::{Job, Outbox, Step};
use backlit_take::footage::Footage;
use backlit_take::replacement::{Calibration, PlateFiles};

/// Footage that is to be seen by other cameras, or with other plates.
#[derive(Debug)]
pub(crate) struct CalibrateJob {
    pub(crate) footage: Arc<Footage>,
    /// The cameras; the take's own without any.
    pub(crate) calibration: Option<Arc<Calibration>>,
    /// Plates; the take's own without any.
    pub(crate) plates: Arc<PlateFiles>,
}

impl Job<Arc<Footage>> for CalibrateJob {
    fn step(&mut self, out: &Outbox<Arc<Footage>>) -> Step {
        out.send(Arc::new(self.footage.with_replacements(self.calibration.take(), self.plates.clone())));
        Step::Done
    }
}
