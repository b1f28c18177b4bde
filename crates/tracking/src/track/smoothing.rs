//! A track smoothed by what later frames say of earlier ones.

use nalgebra::DVector;

use super::estimate::{FrameEstimate, Track};
use crate::body::{Parameters, Pose};
use crate::filter::{Belief, smoother};

/// The track smoothed by what later frames say of earlier ones (Rauch, Tung, Striebel): by all of them, or, with a
/// `lag`, by so many frames after each, as a live track could show that many frames late.
///
/// Frames are taken in the order in which they were tracked; a frame without a belief, or with which nothing
/// was foretold, begins anew. Costs and overlaps stay those of the filtered poses; overlaps can be measured anew
/// ([`FrameEstimate::measure_overlap`]).
#[must_use]
pub fn smoothed(track: &Track, lag: Option<usize>) -> Track {
    let mut order: Vec<&FrameEstimate> = track.frames.values().collect();
    let runs_back = |estimate: &&FrameEstimate| {
        let predicted = estimate.belief.as_ref().and_then(|belief| belief.predicted.as_ref());
        predicted.is_some_and(|predicted| predicted.seconds < 0.0)
    };
    if order.iter().any(runs_back) {
        order.reverse();
    }
    let mut smoothed = track.clone();
    let mut keep = |estimate: &FrameEstimate, pose: Pose, belief: Belief| {
        if let Some(target) = smoothed.frames.get_mut(&estimate.frame)
            && let Some(target_belief) = &mut target.belief
        {
            target.pose = pose;
            target_belief.belief = belief;
        }
    };
    match lag {
        None => {
            let mut later = None;
            for index in (0..order.len()).rev() {
                later = smoothed_by(order[index], order.get(index + 1).copied(), later);
                if let Some((pose, belief)) = later.clone() {
                    keep(order[index], pose, belief);
                }
            }
        }
        Some(lag) => {
            for index in 0..order.len() {
                let last = (index + lag).min(order.len() - 1);
                let mut later = None;
                for at in (index..=last).rev() {
                    let next = (at < last).then(|| order[at + 1]);
                    later = smoothed_by(order[at], next, later);
                }
                if let Some((pose, belief)) = later {
                    keep(order[index], pose, belief);
                }
            }
        }
    }
    smoothed
}

/// A frame's pose and belief given the next frame's; its own where nothing is known of a next one.
fn smoothed_by(
    here: &FrameEstimate,
    next: Option<&FrameEstimate>,
    later: Option<(Pose, Belief)>,
) -> Option<(Pose, Belief)> {
    let filtered = &here.belief.as_ref()?.belief;
    let predicted = next.and_then(|next| next.belief.as_ref()?.predicted.as_ref());
    let by_later = predicted.zip(later).and_then(|(predicted, (pose, belief))| {
        let difference = DVector::from_vec(pose.local(&predicted.mean));
        smoother::smooth(filtered, &predicted.belief, &belief, &difference, predicted.seconds)
    });
    Some(match by_later {
        Some(found) => (here.pose.retract(Parameters::Tangent, found.step.as_slice()), found.belief),
        None => (here.pose.clone(), filtered.clone()),
    })
}
