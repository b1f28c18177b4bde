//! How all camera views look and what is dragged in them: kept from start to start.

use std::ops::RangeInclusive;

use backlit_ui::drawing::StateAxis;
use serde::{Deserialize, Serialize};

/// The settings that all camera views share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "ticks that do not depend on each other")]
pub struct ViewSettings {
    /// How often a blinking view changes, per second.
    pub blink_hz: f32,
    /// Whether principal point, world axes, floor and lens edge are drawn.
    pub calibration_marks: bool,
    /// Whether hands and feet say left or right, and a nose where the body faces.
    pub side_marks: bool,
    /// Whether poses that rival a tracked one are drawn.
    pub rivals: bool,
    /// Whether lines lie between pixels that are shown large.
    pub pixel_grid: bool,
    /// The coefficient of the pose whose Jacobian column is shown.
    pub axis: StateAxis,
    /// Whether the selected limb has handles for its length and radius.
    pub size_handles: bool,
    /// Whether a dragged joint moves its own arm, leg or neck alone.
    pub hold_trunk: bool,
    /// Whether the spheres of a body of spheres are outlined.
    pub spheres: bool,
    /// The level of their trees that is drawn, counted from the coarsest; the finest where `None`.
    pub sphere_level: Option<usize>,
    /// Whether a size is changed on both sides of the body.
    pub both_sides: bool,
}

impl ViewSettings {
    /// Slowest and fastest blink, changes per second.
    pub(crate) const BLINK_HZ: RangeInclusive<f64> = 0.5..=8.0;

    pub(crate) fn drawn_level(&self) -> usize {
        self.sphere_level.unwrap_or(usize::MAX)
    }

    /// Seconds that a blinking view stays as it is.
    pub(crate) fn blink_seconds(&self) -> f64 {
        let hz = f64::from(self.blink_hz);
        let hz = if hz.is_finite() { hz } else { 2.0 };
        1.0 / hz.clamp(*Self::BLINK_HZ.start(), *Self::BLINK_HZ.end())
    }
}

impl Default for ViewSettings {
    fn default() -> Self {
        Self {
            blink_hz: 2.0,
            calibration_marks: false,
            side_marks: true,
            rivals: true,
            pixel_grid: true,
            axis: StateAxis::default(),
            size_handles: false,
            hold_trunk: true,
            spheres: false,
            sphere_level: None,
            both_sides: true,
        }
    }
}
