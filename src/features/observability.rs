//! What the cameras see of the pose, and what they do not: directions, how the body sways along one, ellipses of joints, sets
//! of cameras. Nothing here is saved or undone, and swaying never changes the document.

mod camera_subsets;
mod panel;
mod sway;
#[cfg(test)]
mod tests;
mod update;

use std::sync::Arc;

use backlit_jobs::Task;
use backlit_tracking::fit::FitError;
use backlit_tracking::observability::{Direction, JointUncertainty, Observability as Figures};
use backlit_tracking::posing::LimitedAngle;
use backlit_ui::drawing::automatic_factor;

use sway::Sway;
pub(crate) use update::Observed;

use crate::context::priority;
use crate::session::prediction::PosedInputs;

/// What was chosen. It outlives the take.
#[derive(Debug, Clone)]
struct Choices {
    /// Farthest that a joint sways, millimetres.
    amplitude_mm: f64,
    /// Sways a second.
    speed: f64,
    /// Whether ellipses are in the views.
    ellipses: bool,
    /// How much larger than life they are drawn; `None` chooses by itself.
    factor: Option<u32>,
}

impl Default for Choices {
    fn default() -> Self {
        Self { amplitude_mm: sway::AMPLITUDE_MM, speed: sway::SPEED, ellipses: false, factor: None }
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct PanelMarks {
    /// A section shows figures: they are wanted.
    figures: bool,
    /// The set of cameras under the pointer, by its place in the list.
    subset: Option<usize>,
    /// The angle of the selected limb under the pointer, or held by it.
    angle: Option<LimitedAngle>,
}

/// The feature.
#[derive(Debug, Default)]
pub struct Observability {
    found: Option<Arc<Observed>>,
    /// What a Kalman filter believed of the joints of the pose on the screen, if the pose is a filter's.
    believed: Option<Arc<Vec<JointUncertainty>>>,
    /// Whether the figures are of the pose, frame and set of cameras on the screen.
    is_current: bool,
    /// What panels have shown in the last frame, and what they show in this one.
    shown: PanelMarks,
    drawn: PanelMarks,
    picked: Option<usize>,
    sway: Option<Sway>,
    choices: Choices,
    task: Task<PosedInputs, Result<Arc<Observed>, FitError>, { priority::OBSERVABILITY }>,
}

impl Observability {
    /// The figures, perhaps of an older pose.
    pub fn found(&self) -> Option<&Observed> {
        self.found.as_deref()
    }

    /// Whether the figures are of an older pose, frame or set of cameras than the one on the screen.
    pub fn is_stale(&self) -> bool {
        !self.is_current
    }

    /// Index of the direction that is looked at: the one picked, or else the weakest that is seen at all.
    pub fn picked(&self) -> Option<usize> {
        let shown = &self.found()?.shown;
        let count = shown.directions.len();
        let weakest = (count - shown.null_count()).saturating_sub(1);
        (count > 0).then(|| self.picked.filter(|picked| *picked < count).unwrap_or(weakest))
    }

    /// The direction that is looked at.
    pub fn direction(&self) -> Option<(&Figures, &Direction)> {
        let shown = &self.found()?.shown;
        Some((shown, shown.directions.get(self.picked()?)?))
    }

    /// The joints whose ellipses are shown, and the cameras that they are of, where these are not the ones in use. Where a
    /// Kalman filter gave the pose, they are what it believes.
    pub fn ellipses(&self) -> Option<(&[JointUncertainty], Option<&[usize]>)> {
        let found = self.found()?;
        if let Some(subset) = self.shown.subset.and_then(|place| found.subsets.get(place)) {
            return Some((&subset.joints, Some(&subset.cameras)));
        }
        let joints = self.believed.as_deref().unwrap_or(&found.shown.joints);
        self.choices.ellipses.then_some((joints, None))
    }

    /// How much larger than life ellipses are drawn; the same for every set of cameras, so that they can be compared.
    pub fn ellipse_factor(&self) -> u32 {
        self.choices.factor.unwrap_or_else(|| self.automatic_factor())
    }

    /// The factor that suits what the cameras in use know.
    fn automatic_factor(&self) -> u32 {
        let joints = self.found.iter().flat_map(|found| &found.shown.joints);
        automatic_factor(joints.map(JointUncertainty::worst_deviation_m))
    }

    /// Looks at a direction, by its index.
    fn pick(&mut self, index: usize) {
        self.picked = Some(index);
        if let Some(sway) = &mut self.sway {
            sway.phase = 0.0;
        }
    }

    /// Looks at the direction that is seen less (or better, with `by` below zero) than the one looked at.
    fn pick_next(&mut self, by: isize) {
        if let Some((picked, found)) = self.picked().zip(self.found()) {
            self.pick(picked.saturating_add_signed(by).min(found.shown.directions.len() - 1));
        }
    }

    /// A panel shows this angle of the selected limb with its limits.
    pub(crate) fn look_at_angle(&mut self, angle: Option<LimitedAngle>) {
        self.drawn.angle = angle;
    }
}
