//! The frame before, and where its motion leads.

use crate::body::{Parameters, Pose};

/// The frame before.
#[derive(Debug, Clone, PartialEq)]
pub struct LastFrame {
    /// Its number.
    pub frame: usize,
    /// As it was fitted, before any filter.
    pub pose: Pose,
    /// Whether the subject was lost there.
    pub lost: bool,
    /// Tangent units per second, where the motion goes on from the frame before that.
    pub velocity: Option<Vec<f64>>,
}

impl LastFrame {
    /// Where the motion leads in this many seconds, negative backwards.
    pub(super) fn leads_to(&self, seconds: f64) -> Pose {
        match &self.velocity {
            Some(velocity) => {
                let step: Vec<f64> = velocity.iter().map(|value| value * seconds).collect();
                self.pose.retract(Parameters::Tangent, &step)
            }
            None => self.pose.clone(),
        }
    }

    /// The velocity that leads to a pose in this many seconds.
    pub(super) fn velocity_to(&self, pose: &Pose, seconds: f64) -> Vec<f64> {
        pose.local(&self.pose).into_iter().map(|value| value / seconds).collect()
    }
}
