//! What a take lacks before it can be tracked, found from its silhouettes: a pose to begin with, the person's own sizes.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use anyhow::Context;
use backlit_formats::Footage;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::body_fit::{
    Doubt, OwnSizes, OwnSizesProgress, PersonOptions, PersonProgress, find_person, survey,
};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::search::{Found, WithoutStart, without_start};
use indicatif::ProgressBar;
use serde::{Deserialize, Serialize};

use super::interrupt::Interrupted;
use super::output;

/// What was found before tracking began.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Begun {
    /// The start was found by a search, not given.
    searched: bool,
    /// What the silhouettes leave open about it.
    doubts: Vec<String>,
    /// The body's own sizes, where they were looked for.
    sizes: Option<SizesFound>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct SizesFound {
    /// Whether the body has them: else it is only scaled as a whole.
    taken: bool,
    /// Why not.
    doubts: Vec<String>,
    /// Factors of the average body.
    size: f64,
    girth: f64,
    /// In frames that sizes were not fitted to: of the body scaled as a whole, and of the body found.
    held_out_iou: [Option<f64>; 2],
    /// By how many pixels silhouettes are too wide all round.
    widening_px: f64,
}

/// Where to begin in a frame without a start.
///
/// # Errors
/// Nobody is seen, or the silhouettes do not meet.
pub(crate) fn search_start(
    footage: &Footage,
    cameras: &[usize],
    frame: usize,
    fit: &FitOptions,
) -> anyhow::Result<Found> {
    let views = footage.fit_views(cameras, frame)?;
    let choices = WithoutStart { fit: fit.clone(), ..WithoutStart::default() };
    let found = without_start(footage.take().model(), &views, &choices, &CancelToken::new());
    found.with_context(|| no_start(frame))
}

fn no_start(frame: usize) -> String {
    format!("the take has no `start`, and none can be found in frame {frame}; give a pose with --start POSE")
}

/// Looks at the silhouettes of some of these frames, and says on standard error which cameras' cannot be right. Frames that
/// cannot be read are told when it is their turn.
///
/// # Errors
/// No camera shows a person in any of them.
pub(crate) fn check_silhouettes(
    footage: &Footage,
    cameras: &[usize],
    frames: &[usize],
) -> anyhow::Result<()> {
    let looked_at = survey::spread(frames, survey::LOOKED_AT);
    let views = |frame| Ok::<_, Infallible>(footage.fit_views(cameras, frame).unwrap_or_default());
    let Ok(found) = survey::survey(&looked_at, views);
    found.check()?;
    found.doubts().for_each(|doubt| output::complain(&doubt.to_string()));
    Ok(())
}

/// Finds what is lacking and says so on standard error: a start, and where that is asked for the person's own sizes. The body
/// is returned where it is another than the take's.
///
/// # Errors
/// A picture cannot be read, or nobody is seen.
pub(crate) fn begin(
    footage: &Footage,
    cameras: &[usize],
    frames: &[usize],
    fit: &FitOptions,
    start: Option<Pose>,
    sizes: bool,
    cancel: &CancelToken,
) -> anyhow::Result<(Pose, Option<Model>, Begun)> {
    let take = footage.take();
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(200));
    let mut options = PersonOptions::new(fit.clone(), sizes, take.frame_rate());
    if sizes {
        options.joints = take.keypoint_joints(&options.followed(frames))?;
    }
    let is_given = start.is_some();
    let person = find_person(
        take.model(),
        start,
        frames,
        &options,
        cancel,
        |frame| -> Result<_, anyhow::Error> { Ok(footage.fit_views(cameras, frame)?) },
        |at| spinner.set_message(progress_text(at)),
    );
    spinner.finish_and_clear();
    anyhow::ensure!(!cancel.is_cancelled(), Interrupted);
    let person = if is_given { person? } else { person.with_context(|| no_start(frames[0]))? };
    let mut begun = Begun::default();
    if let Some(found) = &person.search {
        begun.searched = true;
        begun.doubts = found.doubts.iter().map(ToString::to_string).collect();
        output::complain(&format!("frame {}: a start was found from the silhouettes", frames[0]));
        begun.doubts.iter().for_each(|doubt| output::complain(doubt));
    }
    match &person.sizes {
        Some(Ok(own)) => {
            let sizes = SizesFound::new(own);
            output::complain(&sizes.text());
            begun.sizes = Some(sizes);
        }
        Some(Err(error)) => {
            output::complain(&format!(
                "the body is only scaled as a whole: the person's own sizes cannot be found: {error}"
            ));
        }
        None => {}
    }
    let is_own = Arc::ptr_eq(&person.model, take.model());
    Ok((person.start, (!is_own).then(|| (*person.model).clone()), begun))
}

fn progress_text(progress: PersonProgress) -> String {
    match progress {
        PersonProgress::Searching => "looking for a start".to_owned(),
        PersonProgress::Following(done, all) => format!("the person's sizes: frame {done} of {all}"),
        PersonProgress::Sizes(OwnSizesProgress::Reading(done, all)) => {
            format!("the person's sizes: {done} of {all} frames read")
        }
        PersonProgress::Sizes(OwnSizesProgress::Fitting(at) | OwnSizesProgress::Scaling(at)) => {
            format!("the person's sizes: stage {} of {}, step {}", at.stage + 1, at.stages, at.iterations)
        }
        PersonProgress::Sizes(OwnSizesProgress::Judging(done, all)) => {
            format!("the person's sizes: {done} of {all} frames judged")
        }
    }
}

impl SizesFound {
    fn new(own: &OwnSizes) -> Self {
        let body = if own.is_taken() { &own.fit } else { &own.scaled };
        Self {
            taken: own.is_taken(),
            doubts: own.doubts.iter().map(doubt_text).collect(),
            size: body.size,
            girth: body.girth,
            held_out_iou: own.judged.iou,
            widening_px: own.widening_px(),
        }
    }

    fn text(&self) -> String {
        let percent = |factor: f64| format!("{:+.1} %", 100.0 * (factor - 1.0));
        let iou = |iou: Option<f64>| iou.map_or_else(|| "–".to_owned(), |iou| format!("{iou:.3}"));
        let [scaled, own] = self.held_out_iou.map(iou);
        let (size, girth) = (percent(self.size), percent(self.girth));
        if self.taken {
            let mut text = format!(
                "the person's own sizes were fitted: size {size}, girth {girth} of the body begun with; IoU in frames held \
                 out {own}, with the body only scaled {scaled}"
            );
            if self.widening_px != 0.0 {
                text += &format!("; silhouettes are {:.1} px too wide", self.widening_px);
            }
            return text;
        }
        format!(
            "the person's own sizes were not used, the body is only scaled ({size}): {}",
            self.doubts.join("; ")
        )
    }
}

/// Why sizes are not taken.
pub(crate) fn doubt_text(doubt: &Doubt) -> String {
    match doubt {
        Doubt::NotBetter { iou: [scaled, own] } => {
            format!("frames held out do not overlap better (IoU {own:.3}, only scaled {scaled:.3})")
        }
        Doubt::Stoutness { deviations } if *deviations > 0.0 => {
            format!("the body would be stouter than people are ({deviations:.1} standard deviations)")
        }
        Doubt::Stoutness { deviations } => {
            format!("the body would be slimmer than people are ({:.1} standard deviations)", -deviations)
        }
        Doubt::Widening { deviations } => {
            format!(
                "the silhouettes would be too wide or too narrow by more than they ever are ({deviations:.1} standard deviations)"
            )
        }
        Doubt::Size { name, kind, deviations } => {
            format!("{name}: its {kind:?} would be {deviations:+.1} standard deviations off what people have")
                .to_lowercase()
        }
    }
}
