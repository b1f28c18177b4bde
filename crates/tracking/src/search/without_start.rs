//! A pose where no start is known: the search begins in the visual hull.
//!
//! 1. **Place.** The hull of all silhouettes says where the person is ([`VisualHull`](crate::visual_hull::VisualHull));
//!    the cameras, which people hold level, or the caller say which way is up. With one camera the body's own height says
//!    how far away it is.
//! 2. **Headings.** About the vertical through the person the body stands up in eight directions. On the best trunks of
//!    each, by the sketch, arms, legs and head are put together, and the whole is refined a little by two coarse stages.
//! 3. **Halving.** The best few that differ are refined to the end, each chain seeded again; then the best of them more
//!    closely, each also turned round: facing the other way, right and left swapped.
//! 4. **Judgement.** By the last stage's cost without any pull to a start. Where the other way costs as good as the same,
//!    the body is taken to face the cameras if these stand on one side of it, and that is said ([`Doubt`]).
//!
//! All of it is the same for any number of threads.

mod place;
mod rounds;

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use glam::{DQuat, DVec3};
use thiserror::Error;

pub(crate) use self::place::{Stance, SubjectPlace, mask_of, reduced, turn_whole};
use self::rounds::{Judged, Rounds};
use super::SearchOptions;
use super::chains::Chains;
use super::hypotheses::Hypothesis;
use super::sketch::Sketch;
use crate::body::{Model, ModelError, Parameters, Pose};
use crate::cancel::CancelToken;
use crate::fit::{FitError, FitOptions, FitView, PreparedFit};

/// A body is made as much larger or smaller as this at most.
const LARGEST_SCALE: f64 = 2.0;

/// How to look for a pose without a start.
#[derive(Debug, Clone, PartialEq)]
pub struct WithoutStartOptions {
    /// Up in world axes, of any length; `None` asks the cameras ([`up_of`](crate::camera::up_of)).
    pub up: Option<DVec3>,
    /// Whether the body is scaled as a whole to stand as tall as the hull is: rough, and better than an average body for
    /// a child.
    pub scale_body: bool,
    /// Where the body is taken to look where the silhouettes do not tell front from back; `None`: to the cameras.
    pub faces: Option<DVec3>,
    /// By what candidates are refined and judged.
    pub fit: FitOptions,
    /// Headings about the vertical, at least one.
    pub headings: usize,
    /// Trunks of each heading that the limbs are put on, at least one.
    pub trunks: usize,
    /// Candidates of all headings that are refined to the end, and of these that are looked at most closely; each at least one.
    pub kept: [usize; 2],
    /// How hard the candidates of all headings are looked at.
    pub coarse: SearchOptions,
    /// How hard the last few are.
    pub fine: SearchOptions,
}

impl Default for WithoutStartOptions {
    fn default() -> Self {
        let fine = SearchOptions { pairs: 0, ..SearchOptions::default() };
        Self {
            up: None,
            scale_body: false,
            faces: None,
            fit: FitOptions::default(),
            headings: 8,
            trunks: 2,
            kept: [8, 3],
            coarse: SearchOptions { beam: 16, proposals: 2, sweeps: 1, ..fine.clone() },
            fine,
        }
    }
}

/// What a search without a start found and what it tried.
#[derive(Debug, Clone, PartialEq)]
pub struct WithoutStartResult {
    /// The body that the poses are of: the given one, or as it was scaled.
    pub model: Arc<Model>,
    /// All that were refined to the end and differ, best first; never empty. Costs are the last stage's, without any pull to
    /// a start. The best may cost a little more than another that faces away from the cameras.
    pub hypotheses: Vec<Hypothesis>,
    /// What came of each round, best first: the trunks of all headings with their limbs; the best of these, their chains seeded
    /// again; the best of those and the same turned round, looked at more closely. Costs can be compared within a round.
    pub rounds: Vec<Vec<Hypothesis>>,
    /// Where the body of each hypothesis looks: a unit vector, world axes; `None` for a body without front and back.
    pub facings: Vec<Option<DVec3>>,
    /// Up, a unit vector, world axes.
    pub up: DVec3,
    /// What that body was scaled by; 1 unless [`scale_body`](WithoutStartOptions::scale_body) asks for more.
    pub scale: f64,
    /// How tall the subject's hull is and how tall the given body stands. `None` with one camera.
    pub heights: Option<Heights>,
    /// What the silhouettes leave open.
    pub doubts: Vec<Doubt>,
    /// Evaluations of Λ with its derivatives. Looks at single limbs in the sketch are not counted.
    pub evaluations: usize,
}

impl WithoutStartResult {
    /// The best pose.
    #[must_use]
    pub fn pose(&self) -> &Pose {
        &self.hypotheses[0].pose
    }
}

/// Heights along the vertical, metres. The hull of few cameras is some per cent taller than who is in it, and nobody has
/// to stand upright: of the person's size they are a hint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heights {
    /// Of the visual hull.
    pub subject_m: f64,
    /// Of the body that was given, at rest.
    pub body_m: f64,
}

impl Heights {
    /// How many times as tall as the body the hull is.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.subject_m / self.body_m
    }

    fn scale(self) -> f64 {
        self.ratio().clamp(LARGEST_SCALE.recip(), LARGEST_SCALE)
    }
}

/// What silhouettes leave open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Doubt {
    /// One camera alone sees the subject: how far away it is follows from the body's height.
    OneCamera,
    /// Turned round the body explains the silhouettes as well; it was taken to face the cameras, or the way that the
    /// caller expects.
    FacingAssumed,
    /// The same, and the cameras stand all around.
    FacingOpen,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OneCamera => {
                "one camera alone sees the person: how far away it is follows from the body's height alone"
            }
            Self::FacingAssumed => {
                "the silhouettes do not tell front from back; the body is taken to face the cameras, or as it did before"
            }
            Self::FacingOpen => "the silhouettes do not tell front from back; the body may be turned round",
        })
    }
}

/// Why no pose was found.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum WithoutStartError {
    #[error(transparent)]
    Fit(#[from] FitError),
    #[error("`{field}` is {value}; expected a direction")]
    Direction { field: &'static str, value: DVec3 },
    #[error("the cameras do not agree on which way is up; expected `up` to be given")]
    NoUp,
    #[error("`{field}` is 0; expected at least 1")]
    Count { field: &'static str },
    #[error(
        "the silhouettes of {} do not meet in space; expected one person at one moment, seen by cameras of one calibration",
        cameras.join(", ")
    )]
    Apart { cameras: Vec<String> },
    #[error("the body cannot be scaled by {scale:.2}: {error}")]
    Scale { scale: f64, error: ModelError },
    #[error("the search for a start was stopped")]
    Cancelled,
}

/// Looks for a pose where no start is known. Views without a subject are left out; one that has one is enough.
///
/// # Errors
/// Nobody is seen ([`FitError::NoData`]), silhouettes that do not meet, no vertical, choices or data out of range,
/// or `cancel`.
pub fn without_start(
    model: &Arc<Model>,
    views: &[FitView],
    choices: &WithoutStartOptions,
    cancel: &CancelToken,
) -> Result<WithoutStartResult, WithoutStartError> {
    choices.check()?;
    let (seen, _, place, heights) = located(model, views, choices.up, &choices.fit, cancel)?;
    let (scale, scaled) = match heights.filter(|_| choices.scale_body) {
        Some(heights) => {
            let scale = heights.scale();
            (scale, model.scaled(scale).map_err(|error| WithoutStartError::Scale { scale, error })?.into())
        }
        None => (1.0, Arc::clone(model)),
    };
    let stance = Stance::new(&scaled, &Chains::new(&scaled));
    let standing = stance.pose(&scaled, place.middle(), place.up, place.to_cameras);
    let smaller = reduced(&scaled, &seen, &standing);
    let options = choices.fit.clone().at_scale(&scaled, &smaller, &standing);
    let prepared = PreparedFit::new(&scaled, smaller, &standing, &options, Sketch::reach_px)?;
    let rounds = Rounds {
        model: &scaled,
        prepared: &prepared,
        options: &options,
        choices,
        place: &place,
        stance,
        cancel,
        evaluations: AtomicUsize::new(0),
    };
    let Judged { hypotheses, facings, doubt, rounds: all } = rounds.run()?;
    let one_camera = (seen.len() == 1).then_some(Doubt::OneCamera);
    Ok(WithoutStartResult {
        scale,
        heights,
        hypotheses,
        facings,
        rounds: all,
        up: place.up,
        doubts: one_camera.into_iter().chain(doubt).collect(),
        evaluations: rounds.evaluations.into_inner(),
        model: scaled,
    })
}

/// The views that show somebody, how the body stands, where the subject is, and how tall both are.
fn located(
    model: &Model,
    views: &[FitView],
    up: Option<DVec3>,
    options: &FitOptions,
    cancel: &CancelToken,
) -> Result<(Vec<FitView>, Stance, SubjectPlace, Option<Heights>), WithoutStartError> {
    let seen = with_subject(model, views, options)?;
    let stance = Stance::new(model, &Chains::new(model));
    let place = SubjectPlace::of(&seen, up, stance.height(), cancel)?;
    let heights = Heights { subject_m: place.height(), body_m: stance.height() };
    let heights = (seen.len() > 1).then_some(heights);
    Ok((seen, stance, place, heights))
}

/// By how much a body is to be larger to stand as tall as the hull of the silhouettes is, no more than twice; 1 with one camera. A
/// hint: the hull of few cameras is some per cent taller than who is in it, and nobody has to stand upright.
///
/// # Errors
/// As [`without_start`].
pub fn hull_scale(
    model: &Model,
    views: &[FitView],
    up: Option<DVec3>,
    cancel: &CancelToken,
) -> Result<f64, WithoutStartError> {
    let (_, _, _, heights) = located(model, views, up, &FitOptions::default(), cancel)?;
    Ok(heights.map_or(1.0, |heights| heights.scale()))
}

/// The views that show somebody, at least one.
fn with_subject(
    model: &Model,
    views: &[FitView],
    options: &FitOptions,
) -> Result<Vec<FitView>, WithoutStartError> {
    let views: Vec<FitView> = views.iter().cloned().map(FitView::rectified).collect();
    for view in &views {
        view.check()?;
    }
    let seen: Vec<FitView> = views.iter().filter(|view| view.has_data()).cloned().collect();
    if seen.is_empty() {
        // Says who sees nothing.
        PreparedFit::new(model, views, &Pose::rest(model), options, |_, _, _| 0.0)?;
    }
    Ok(seen)
}

/// The body at rest where the subject is, upright and facing this many ways, at least one: where a search, a fit or a
/// filter may begin that has nothing else to go by.
///
/// # Errors
/// As [`without_start`].
pub fn standing(
    model: &Model,
    views: &[FitView],
    up: Option<DVec3>,
    headings: usize,
    cancel: &CancelToken,
) -> Result<Vec<Pose>, WithoutStartError> {
    let (_, stance, place, _) = located(model, views, up, &FitOptions::default(), cancel)?;
    // Between a body on the hull's floor and one under its top.
    let height = 0.5 * (place.bottom + stance.below + place.top - stance.above);
    let middle = place.middle_at(height);
    let headings = headings.max(1);
    let pose = |heading: usize| {
        let angle = TAU * heading as f64 / headings as f64;
        let ahead = DQuat::from_axis_angle(place.up, angle) * place.to_cameras;
        stance.pose(model, middle, place.up, ahead)
    };
    Ok((0..headings).map(pose).collect())
}

impl WithoutStartOptions {
    /// The usual choices for a fit: by its own options where they are made for a start from afar, else by the robust
    /// preset with its solid.
    #[must_use]
    pub fn for_fit(fit: &FitOptions) -> Self {
        let is_meant_for_it = fit.stages.len() > 1 && fit.parameters == Parameters::Tangent;
        let robust = || FitOptions { renderer: fit.renderer, ..FitOptions::default() };
        Self { fit: if is_meant_for_it { fit.clone() } else { robust() }, ..Self::default() }
    }

    /// First thing wrong with the choices.
    ///
    /// # Errors
    /// A count of zero, numbers out of range, no direction.
    fn check(&self) -> Result<(), WithoutStartError> {
        for (field, count) in
            [("headings", self.headings), ("trunks", self.trunks), ("kept", self.kept[0].min(self.kept[1]))]
        {
            if count == 0 {
                return Err(WithoutStartError::Count { field });
            }
        }
        for effort in [&self.coarse, &self.fine] {
            effort.check().map_err(FitError::from)?;
        }
        for (field, given) in [("up", self.up), ("faces", self.faces)] {
            if let Some(value) = given.filter(|given| !(given.is_finite() && given.length() > 1e-9)) {
                return Err(WithoutStartError::Direction { field, value });
            }
        }
        Ok(())
    }
}
