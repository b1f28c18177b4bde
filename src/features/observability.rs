//! What the user looks at of what the cameras see: a direction, how the body sways along it, ellipses. Nothing here is
//! saved or undone, and swaying never changes the document.

pub(crate) mod camera_subsets;
pub(crate) mod observed;
pub(crate) mod panel;
pub(crate) mod update;
pub(crate) mod words;

use std::f64::consts::TAU;
use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Pose};
use backlit_tracking::observability::{Cause, Direction, JointUncertainty, Observability};
use backlit_tracking::posing::LimitedAngle;

use crate::document::Document;
use crate::drawing::Swaying;
use crate::drawing::ellipse_factor::automatic_factor;
use crate::features::observability::observed::Observed;

/// Farthest that a joint sways at first, millimetres, and the ends of its slider.
const AMPLITUDE_MM: f64 = 60.0;
/// How far the joint that moves most may sway to either side, millimetres.
pub const AMPLITUDES_MM: [f64; 2] = [5.0, 300.0];
/// Sways a second at first, and the ends of their slider.
const SPEED: f64 = 0.4;
/// How fast the body may sway.
pub const SPEEDS: [f64; 2] = [0.1, 2.0];
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

/// A body that sways.
#[derive(Debug, Clone, Default)]
struct Sway {
    /// Radians of a whole sway of 2π; the body is where it was at zero.
    phase: f64,
    is_paused: bool,
    /// When the phase was moved last, seconds.
    at: Option<f64>,
    /// What it sways along: it ends when this is of the past.
    of: Option<Arc<Observed>>,
}

/// What the user asks of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ObserveRequest {
    /// Preferences at a direction, by its index.
    Pick(usize),
    /// Preferences at a direction and sway along it.
    SwayAlong(usize),
    /// Sway on, or hold still where it is.
    Play(bool),
    /// The body goes back to where it is.
    StopSway,
    /// Farthest that a joint sways, millimetres.
    Amplitude(f64),
    /// Sways a second.
    Speed(f64),
    /// Whether ellipses are in the views.
    Ellipses(bool),
    /// How much larger than life they are drawn; `None` chooses by itself.
    EllipseFactor(Option<u32>),
}

/// What the panels of one frame look at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Glance {
    /// A section shows figures: they are wanted.
    pub at_figures: bool,
    /// The set of cameras under the pointer, by its place in the list.
    pub subset: Option<usize>,
    /// The angle of the selected limb under the pointer, or held by it.
    pub angle: Option<LimitedAngle>,
}

/// What is looked at.
#[derive(Debug, Clone)]
pub struct Observing {
    found: Option<Arc<Observed>>,
    is_stale: bool,
    glance: Glance,
    picked: Option<usize>,
    sway: Option<Sway>,
    amplitude_mm: f64,
    speed: f64,
    ellipses: bool,
    /// Chosen by the user.
    ellipse_factor: Option<u32>,
}

impl Default for Observing {
    fn default() -> Self {
        Self {
            found: None,
            is_stale: true,
            glance: Glance::default(),
            picked: None,
            sway: None,
            amplitude_mm: AMPLITUDE_MM,
            speed: SPEED,
            ellipses: false,
            ellipse_factor: None,
        }
    }
}

impl Observing {
    /// The figures, perhaps of an older pose.
    #[must_use]
    pub fn found(&self) -> Option<&Observed> {
        self.found.as_deref()
    }

    /// Whether the figures are of an older pose, frame or set of cameras than the one on the screen.
    #[must_use]
    pub fn is_stale(&self) -> bool {
        self.is_stale
    }

    /// Whether figures are wanted: a section shows them, or the views do.
    #[must_use]
    pub fn is_wanted(&self) -> bool {
        self.glance.at_figures || self.ellipses || self.sway.is_some()
    }

    /// Index of the direction that is looked at: the one picked, or else the weakest that is seen at all.
    #[must_use]
    pub fn picked(&self) -> Option<usize> {
        let shown = &self.found()?.shown;
        let count = shown.directions.len();
        let weakest = (count - shown.null_count()).saturating_sub(1);
        (count > 0).then(|| self.picked.filter(|picked| *picked < count).unwrap_or(weakest))
    }

    /// The direction that is looked at.
    #[must_use]
    pub fn direction(&self) -> Option<(&Observability, &Direction)> {
        let shown = &self.found()?.shown;
        Some((shown, shown.directions.get(self.picked()?)?))
    }

    /// Farthest that a joint sways, millimetres.
    #[must_use]
    pub fn amplitude_mm(&self) -> f64 {
        self.amplitude_mm
    }

    /// Sways a second.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Whether the body sways or is held on its way.
    #[must_use]
    pub fn is_swaying(&self) -> bool {
        self.sway.is_some()
    }

    /// Whether it is on its way.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.sway.as_ref().is_some_and(|sway| !sway.is_paused)
    }

    /// Whether ellipses are in the views.
    #[must_use]
    pub fn shows_ellipses(&self) -> bool {
        self.ellipses
    }

    /// How much of the direction the slider stands for: no joint moves or turns farther.
    #[must_use]
    pub fn largest_amount(&self, direction: &Direction) -> f64 {
        let turn = (TURN_AT_60_MM * self.amplitude_mm / AMPLITUDE_MM).min(FARTHEST_TURN);
        let turn = if direction.moves_no_joint() { turn } else { FARTHEST_TURN };
        direction.amount_within(1e-3 * self.amplitude_mm, turn)
    }

    /// The pose at a share of the way, −1 to 1, of a body that sways.
    #[must_use]
    pub fn pose_at(&self, share: f64) -> Option<Pose> {
        let sway = self.sway.as_ref()?;
        let of = sway.of.as_ref()?;
        let direction = of.shown.directions.get(self.picked()?)?;
        Some(direction.swayed(&of.pose, share * self.largest_amount(direction)))
    }

    /// Where the body is on its way.
    #[must_use]
    pub fn swayed_pose(&self) -> Option<Pose> {
        self.pose_at(self.sway.as_ref()?.phase.sin())
    }

    /// The body on its way, if it sways.
    #[must_use]
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

    /// The angle of the selected limb that a panel looks at.
    #[must_use]
    pub fn angle(&self) -> Option<LimitedAngle> {
        self.glance.angle
    }

    /// The joints whose ellipses are shown, and the cameras that they are of, where these are not the ones in use.
    #[must_use]
    pub fn ellipses(&self) -> Option<(&[JointUncertainty], Option<&[usize]>)> {
        let found = self.found()?;
        if let Some(subset) = self.glance.subset.and_then(|place| found.subsets.get(place)) {
            return Some((&subset.joints, Some(&subset.cameras)));
        }
        self.ellipses.then_some((&found.shown.joints, None))
    }

    /// How much larger than life ellipses are drawn; the same for every set of cameras, so that they can be compared.
    #[must_use]
    pub fn ellipse_factor(&self) -> u32 {
        self.ellipse_factor.unwrap_or_else(|| self.automatic_factor())
    }

    /// The factor that the user has chosen.
    #[must_use]
    pub fn chosen_factor(&self) -> Option<u32> {
        self.ellipse_factor
    }

    /// The factor that suits what the cameras in use know.
    #[must_use]
    pub fn automatic_factor(&self) -> u32 {
        let joints = self.found.iter().flat_map(|found| &found.shown.joints);
        automatic_factor(joints.map(JointUncertainty::worst_deviation_m))
    }

    /// Does what was asked.
    pub fn apply(&mut self, request: ObserveRequest) {
        match request {
            ObserveRequest::Pick(index) => {
                self.picked = Some(index);
                if let Some(sway) = &mut self.sway {
                    sway.phase = 0.0;
                }
            }
            ObserveRequest::SwayAlong(index) => {
                self.picked = Some(index);
                self.sway = Some(Sway::default());
            }
            ObserveRequest::Play(true) => self.sway.get_or_insert_default().is_paused = false,
            ObserveRequest::Play(false) => {
                if let Some(sway) = &mut self.sway {
                    sway.is_paused = true;
                }
            }
            ObserveRequest::StopSway => self.sway = None,
            ObserveRequest::Amplitude(mm) => {
                self.amplitude_mm = mm.clamp(AMPLITUDES_MM[0], AMPLITUDES_MM[1]);
            }
            ObserveRequest::Speed(speed) => self.speed = speed.clamp(SPEEDS[0], SPEEDS[1]),
            ObserveRequest::Ellipses(on) => self.ellipses = on,
            ObserveRequest::EllipseFactor(factor) => self.ellipse_factor = factor,
        }
    }

    /// Looks at the direction that is seen less (or better, with `by` below zero) than the one looked at.
    pub fn pick_next(&mut self, by: isize) {
        let Some((picked, count)) = self.picked().zip(self.found().map(|found| found.shown.directions.len()))
        else {
            return;
        };
        self.apply(ObserveRequest::Pick(picked.saturating_add_signed(by).min(count - 1)));
    }

    /// What the panels of this frame look at; whether that has changed.
    pub(crate) fn glance(&mut self, glance: Glance) -> bool {
        std::mem::replace(&mut self.glance, glance) != glance
    }

    /// New figures.
    pub(crate) fn hear(&mut self, found: Arc<Observed>) {
        self.found = Some(found);
    }

    /// Forgets the figures: another take is open.
    pub(crate) fn forget(&mut self) {
        *self = Self {
            amplitude_mm: self.amplitude_mm,
            speed: self.speed,
            ellipses: self.ellipses,
            ellipse_factor: self.ellipse_factor,
            ..Self::default()
        };
    }

    /// Moves the body on, and stops it when the pose on the screen is no longer the one that it sways about.
    pub(crate) fn advance(&mut self, now: f64, pose: &Pose, document: &Document, is_stale: bool) {
        self.is_stale = is_stale;
        let Some(sway) = &mut self.sway else { return };
        if sway.of.is_none() {
            sway.of = self.found.clone().filter(|_| !is_stale);
        }
        let Some(of) = &sway.of else { return };
        let is_current = self.found.as_ref().is_some_and(|found| Arc::ptr_eq(found, of));
        if !is_current || of.pose != *pose || !Arc::ptr_eq(&of.scene.model, &document.model) {
            self.sway = None;
            return;
        }
        let passed = sway.at.map_or(0.0, |at| (now - at).clamp(0.0, LONGEST_FRAME));
        sway.at = Some(now);
        if !sway.is_paused {
            sway.phase = (sway.phase + passed * self.speed * TAU) % TAU;
        }
    }
}
