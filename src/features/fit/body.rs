//! Fitting the body's own sizes, and what is said of them.

use backlit_tracking::body::{Pose, SizeKind};
use backlit_tracking::body_fit::{BodyFit, frames};

use crate::app::App;
use crate::context::action::Action;
use crate::document::edit::Edit;
use crate::features::fit::body_job::BodyJob;
use crate::worker::Lane;

/// Frames that a body is fitted to: more of one movement say little more.
const MOST_FRAMES: usize = 8;

impl App {
    /// Fits lengths and radii to the frames that have poses of their own, at most eight of them.
    pub(crate) fn fit_body(&mut self) {
        self.interrupt_fit();
        let (Some(take), Some(scene)) = (self.state.session.take.clone(), self.scene()) else { return };
        let document = self.document();
        let is_lost = |frame: usize| document.estimates.get(&frame).is_some_and(|found| found.lost);
        let posed: Vec<usize> =
            (0..take.frame_count()).filter(|&frame| document.has_pose(frame) && !is_lost(frame)).collect();
        let shown = self.state.selection.frame;
        let chosen = if posed.is_empty() { vec![shown] } else { frames::spread(&posed, MOST_FRAMES) };
        let start = |frame: usize| -> (usize, Pose) { (frame, document.pose_at(frame).clone()) };
        let starts: Vec<(usize, Pose)> = chosen.into_iter().map(start).collect();
        let job = BodyJob::new(take, document.measurement.clone(), scene, starts);
        self.state.selection.step = None;
        self.state.session.fitting_body = true;
        self.worker.request(Lane::Track, job);
    }

    /// The fitted body becomes the document's.
    pub(crate) fn body_fitted(&mut self, fit: &BodyFit) {
        let model = fit.model.clone().renamed(self.document().model.name());
        let before = self.document().model.clone();
        self.edit(Edit::SetBody(std::sync::Arc::new(model)), None);
        if self.document().model != before {
            self.state.notices.info(self.state.now, said_of(fit), Some(Action::Undo));
        }
    }
}

/// "Fitted the body to 8 frames: IoU 0.890, scaled as a whole 0.877. Hardly seen: length of neck, radius of hip. …"
fn said_of(fit: &BodyFit) -> String {
    let count = fit.frames.len();
    let mut said = format!("Fitted the body to {count} {}", if count == 1 { "frame" } else { "frames" });
    if let [Some(before), Some(after)] = fit.iou {
        said.push_str(&format!(": IoU {after:.3}, scaled as a whole {before:.3}"));
    }
    let held: Vec<String> = fit
        .sizes
        .iter()
        .filter(|size| size.is_held_by_prior())
        .map(|size| {
            let kind = if size.kind == SizeKind::Length { "length" } else { "radius" };
            format!("{kind} of {}", size.name)
        })
        .collect();
    let hardly = match held.len() {
        0 => String::new(),
        1..=4 => format!(" Hardly seen: {}.", held.join(", ")),
        many => format!(" {many} of {} sizes are hardly seen.", fit.sizes.len()),
    };
    format!("{said}.{hardly} Run or track again with it.")
}
