//! Who says why a command cannot be used now: the feature that does it.

use super::Inspector;
use crate::context::command::Command;
use crate::context::unavailable::why;
use crate::features::basin::Basin;
use crate::features::camera_views::CameraViews;
use crate::features::convergence::Convergence;
use crate::features::fit::Fit;
use crate::features::offsets::Offsets;
use crate::features::pose::Posing;
use crate::features::scene::Scene;

impl Inspector {
    /// Why a command cannot be used now, in a sentence without its full stop; `None` if it can.
    pub(crate) fn unavailable(&self, command: Command) -> Option<&'static str> {
        let (context, features) = (&self.context(), &self.features);
        // In its layout some commands of others are the laboratory's.
        if let Some(answer) = features.laboratory.unavailable(command, context) {
            return answer;
        }
        match command {
            Command::Export(command) => features.export.unavailable(command, context),
            Command::Recovery(command) => features.recovery.unavailable(command),
            Command::Tracking(command) => features.tracking.unavailable(command, context),
            Command::Timeline(command) => features.timeline.unavailable(command, context),
            Command::Observability(command) => features.observability.unavailable(command, context),
            Command::Scene(_) => Scene::unavailable(context),
            Command::Offsets => Offsets::unavailable(context),
            Command::Pose(command) => Posing::unavailable(command, context),
            Command::View(command) => CameraViews::unavailable(command, context),
            Command::Fit(command) => Fit::unavailable(command, context),
            Command::Convergence(command) => Convergence::unavailable(command, context),
            Command::Basin(command) => Basin::unavailable(command, context),
            Command::Beginning(command) => features.beginnings.unavailable(command, context),
            other => why(other, context),
        }
    }
}
