//! A body that sways along the direction that is looked at.

use std::f64::consts::TAU;
use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Pose};
use backlit_tracking::observability::{Cause, Direction};
use backlit_ui::drawing::Swaying;

use super::{Observability, Observed};
use crate::context::Context;

/// Farthest that a joint sways at first, millimetres, and the ends of its slider.
pub(super) const AMPLITUDE_MM: f64 = 60.0;
/// How far the joint that moves most may sway to either side, millimetres.
pub(super) const AMPLITUDES_MM: [f64; 2] = [5.0, 300.0];
/// Sways a second at first, and the ends of their slider.
pub(super) const SPEED: f64 = 0.4;
/// How fast the body may sway.
pub(super) const SPEEDS: [f64; 2] = [0.1, 2.0];
/// A joint that turns and moves nothing turns this far for every 60 mm of the slider, radians.
const TURN_AT_60_MM: f64 = 0.6;
/// Farthest turn whatever the slider says, radians.
const FARTHEST_TURN: f64 = 1.5;
/// Places along the whole way at which joints are shown.
const WAY_POINTS: i32 = 9;
/// A limb turns about its own length if this share of a direction's motion is that.
const TWISTS: f64 = 0.1;
/// Longest time between two frames that counts, seconds: after a pause nothing jumps.
const LONGEST_FRAME: f64 = 0.1;

#[derive(Debug, Clone, Default)]
pub(super) struct Sway {
    /// Radians of a whole sway of 2π; the body is where it was at zero.
    pub(super) phase: f64,
    is_paused: bool,
    /// When the phase was moved last, seconds.
    at: Option<f64>,
    /// What it sways along: it ends when this is of the past.
    of: Option<Arc<Observed>>,
}

impl Observability {
    /// Whether the body sways or is held on its way.
    pub fn is_swaying(&self) -> bool {
        self.sway.is_some()
    }

    /// Whether it is on its way.
    pub fn is_playing(&self) -> bool {
        self.sway.as_ref().is_some_and(|sway| !sway.is_paused)
    }

    /// Looks at a direction and sways along it.
    pub(super) fn sway_along(&mut self, index: usize) {
        self.picked = Some(index);
        self.sway = Some(Sway::default());
    }

    /// Sways on, or holds still where it is.
    pub(super) fn toggle_sway(&mut self) {
        match &mut self.sway {
            Some(sway) => sway.is_paused ^= true,
            None => self.sway = Some(Sway::default()),
        }
    }

    /// The body goes back to where it is.
    pub(crate) fn stop_sway(&mut self) {
        self.sway = None;
    }

    /// How much of the direction the slider stands for: no joint moves or turns farther.
    pub(super) fn largest_amount(&self, direction: &Direction) -> f64 {
        let amplitude_mm = self.choices.amplitude_mm;
        let turn = (TURN_AT_60_MM * amplitude_mm / AMPLITUDE_MM).min(FARTHEST_TURN);
        let turn = if direction.moves_no_joint() { turn } else { FARTHEST_TURN };
        direction.amount_within(1e-3 * amplitude_mm, turn)
    }

    /// The pose at a share of the way, −1 to 1, of a body that sways.
    fn pose_at(&self, share: f64) -> Option<Pose> {
        let of = self.sway.as_ref()?.of.as_ref()?;
        let direction = of.shown.directions.get(self.picked()?)?;
        Some(direction.swayed(&of.pose, share * self.largest_amount(direction)))
    }

    /// Where the body is on its way.
    pub fn swayed_pose(&self) -> Option<Pose> {
        self.pose_at(self.sway.as_ref()?.phase.sin())
    }

    /// The body on its way, if it sways.
    pub fn swaying(&self) -> Option<Swaying> {
        let now = self.swayed_pose()?;
        let (shown, direction) = self.direction()?;
        let model = &shown.model;
        let half = (WAY_POINTS - 1) / 2;
        let shares = (-half..=half).map(|at| f64::from(at) / f64::from(half));
        let twists = direction.shares.iter().filter(|part| part.cause == Cause::Twist && part.share > TWISTS);
        Some(Swaying {
            now: Kinematics::new(model, &now),
            way: shares.filter_map(|share| Some(Kinematics::new(model, &self.pose_at(share)?))).collect(),
            twisted: twists.map(|part| model.limbs()[part.limb].rotation).collect(),
        })
    }

    /// Moves the body on, and stops it when the pose on the screen is no longer the one that it sways about.
    pub(super) fn advance(&mut self, context: &Context<'_>) {
        let Some(sway) = &mut self.sway else { return };
        if sway.of.is_none() {
            sway.of = self.found.clone().filter(|_| self.is_current);
        }
        let Some(of) = &sway.of else { return };
        let is_current = self.found.as_ref().is_some_and(|found| Arc::ptr_eq(found, of));
        let is_same_body = Arc::ptr_eq(&of.inputs.model, &context.document().model);
        if !is_current || of.pose != *context.shown_pose() || !is_same_body {
            self.sway = None;
            return;
        }
        let passed = sway.at.map_or(0.0, |at| (context.now - at).clamp(0.0, LONGEST_FRAME));
        sway.at = Some(context.now);
        if !sway.is_paused {
            sway.phase = (sway.phase + passed * self.choices.speed * TAU) % TAU;
        }
    }
}
