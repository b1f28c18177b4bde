//! Fitting the body's own sizes, and what is said of them.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_tracking::body::{Pose, SizeKind};
use backlit_tracking::body_fit::{BodyFit, frames as choice};

use crate::context::command::{Command, HistoryCommand};
use crate::context::{Context, Requests};

/// Frames that a body is fitted to: more of one movement say little more.
pub(super) const SIZE_FRAMES: usize = 8;
/// Frames that limbs are carved from: each view takes away what the others could not see.
pub(super) const SPHERE_FRAMES: usize = 12;

/// The frames that a body is made of, with their poses: at most so many of those that have poses of their own, or else the one
/// on the screen.
pub(super) fn frames(context: &Context<'_>, most: usize) -> VecDeque<(usize, Pose)> {
    let document = context.document();
    let is_lost = |frame: usize| document.estimates.get(&frame).is_some_and(|found| found.lost);
    let all = 0..context.session.frame_count();
    let posed: Vec<usize> = all.filter(|&frame| document.has_pose(frame) && !is_lost(frame)).collect();
    let shown = context.selection.frame;
    let chosen = if posed.is_empty() { vec![shown] } else { choice::spread(&posed, most) };
    chosen.into_iter().map(|frame| (frame, document.pose_at(frame).clone())).collect()
}

/// The fitted body becomes the document's.
pub(super) fn take_in(fit: &BodyFit, context: &Context<'_>, requests: &mut Requests) {
    let before = &context.document().model;
    let model = Arc::new(fit.model.clone().renamed(before.name()));
    let is_other = model != *before;
    requests.edit(Edit::SetBody(model));
    if is_other {
        requests.inform(said_of(fit), Some(Command::History(HistoryCommand::Undo)));
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
