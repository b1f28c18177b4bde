//! What a take lacks before it can be tracked, found from its silhouettes: a pose to begin with, the person's own sizes, and who of
//! several people it is.

use std::sync::Arc;

use anyhow::{Context, anyhow, ensure};
use backlit_formats::Footage;
use backlit_runs::people;
use backlit_runs::person::{PersonSearch, PersonSearchError};
use backlit_runs::track::{TakeReader, survey};
use backlit_tracking::body::Pose;
use backlit_tracking::body_fit::survey::LOOKED_AT;
use backlit_tracking::body_fit::{Doubt, OwnSizes, Person};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::people::{FEWEST_CAMERAS, FollowedPerson, PersonTrack};
use backlit_tracking::search::{WithoutStartOptions, without_start};
use clap::Args;
use serde::{Deserialize, Serialize};

use crate::interrupt::Interrupted;
use crate::numbers::within;
use crate::{output, progress};

/// Who is followed of several people.
#[derive(Debug, Clone, Args)]
pub(crate) struct PersonArguments {
    /// Follow one of several people, by number: 1 is who is in view longest. Pixels of others are unknown. Needs three
    /// cameras or more [1 to 100]
    #[arg(long, value_name = "K", value_parser = within(1..=100_usize))]
    person: Option<usize>,
}

impl PersonArguments {
    /// The footage of the person who is named, if one is, by what these cameras show in these frames. Who is followed is said on
    /// standard error.
    pub(crate) fn follow(
        &self,
        footage: Arc<Footage>,
        cameras: &[usize],
        frames: &[usize],
        cancel: &CancelToken,
    ) -> anyhow::Result<Arc<Footage>> {
        let Some(number) = self.person else { return Ok(footage) };
        let found = in_view("--person", &footage, (cameras, frames), cancel)?;
        let Some(person) = FollowedPerson::of(&found, number - 1) else {
            return Err(nobody(&format!("--person {number}"), &found));
        };
        output::complain(&format!(
            "followed of {} in view: {}",
            found.len(),
            place_text(number, &person.own)
        ));
        Ok(Arc::new(footage.with_person(Some(Arc::new(person)))))
    }
}

/// Who is in view of these cameras in these frames, those who are seen longest first; `option` asked for it.
pub(crate) fn in_view(
    option: &str,
    footage: &Arc<Footage>,
    (cameras, frames): (&[usize], &[usize]),
    cancel: &CancelToken,
) -> anyhow::Result<Vec<PersonTrack>> {
    ensure!(
        cameras.len() >= FEWEST_CAMERAS,
        "{option}: {} cameras cannot tell people apart; expected {FEWEST_CAMERAS} or more",
        cameras.len()
    );
    let reader = Arc::new(TakeReader::of_silhouettes(footage.clone(), cameras.to_vec()));
    let spinner = progress::spinner();
    let found = people::find(&reader, frames, cancel, |done, all| {
        spinner.set_message(format!("looking for people in {all} frames: {done}"));
    })?;
    spinner.finish_and_clear();
    ensure!(!cancel.is_cancelled(), Interrupted);
    Ok(found)
}

/// Why somebody who was asked for by an option is not in view.
pub(crate) fn nobody(option: &str, found: &[PersonTrack]) -> anyhow::Error {
    let all: Vec<String> = found.iter().zip(1..).map(|(track, number)| place_text(number, track)).collect();
    match all.len() {
        0 => anyhow!("{option}: nobody as large as a person is in view of these cameras"),
        _ => anyhow!("{option}: there is no such person; in view are: {}", all.join("; ")),
    }
}

/// "person 2, frames 0 to 69, first at (0.31, -0.20, 0.90) m".
pub(crate) fn place_text(number: usize, track: &PersonTrack) -> String {
    let ends = track.places.first_key_value().zip(track.places.last_key_value());
    let Some(((first, at), (last, _))) = ends else { return format!("person {number}") };
    let [x, y, z] = at.bounds.centre().to_array();
    format!("person {number}, frames {first} to {last}, first at ({x:.2}, {y:.2}, {z:.2}) m")
}

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
pub(crate) fn search_start(
    footage: &Footage,
    cameras: &[usize],
    frame: usize,
    fit: &FitOptions,
) -> anyhow::Result<Pose> {
    let views = footage.fit_views(cameras, frame)?;
    let choices = WithoutStartOptions { fit: fit.clone(), ..WithoutStartOptions::default() };
    let found = without_start(footage.take().model(), &views, &choices, &CancelToken::new());
    Ok(found.with_context(|| no_start(frame))?.pose().clone())
}

fn no_start(frame: usize) -> String {
    format!(
        "the take has no `start`, and none can be found in frame {frame}; give a pose with --start POSE, or better silhouettes by \
         masks, keypoints or a picture of the room alone"
    )
}

/// Looks at the silhouettes of some of these frames, and says on standard error which cameras' cannot be right.
pub(crate) fn check_silhouettes(reader: &TakeReader, frames: &[usize]) -> anyhow::Result<()> {
    let found = survey(reader, frames, LOOKED_AT, &CancelToken::new());
    found.check()?;
    found.doubts().for_each(|doubt| output::complain(&doubt.to_string()));
    // Who is followed is one of them: what is left of the others is unknown.
    let is_followed = reader.footage.take().person().is_some();
    if let Some(several) = found.several_people().filter(|_| !is_followed) {
        output::complain(&format!("{several}: follow one of them with --person K, or all with --people N"));
    }
    Ok(())
}

/// Finds what is lacking and says so on standard error: a start, and where that is asked for the person's own sizes.
pub(crate) fn find(
    reader: &TakeReader,
    search: PersonSearch,
    cancel: &CancelToken,
) -> anyhow::Result<(Person, Begun)> {
    let (is_given, first) = (search.start.is_some(), search.frames[0]);
    let spinner = progress::spinner();
    let person = search.run(reader.footage.take(), reader, cancel, |text| spinner.set_message(text));
    spinner.finish_and_clear();
    ensure!(!cancel.is_cancelled(), Interrupted);
    let person = match person {
        Err(error) if !is_given && !matches!(error, PersonSearchError::Keypoints(_)) => {
            return Err(anyhow::Error::from(error).context(no_start(first)));
        }
        person => person?,
    };
    let mut begun = Begun::default();
    if let Some(found) = &person.search {
        begun.searched = true;
        begun.doubts = found.doubts.iter().map(ToString::to_string).collect();
        output::complain(&format!("frame {first}: a start was found from the silhouettes"));
        begun.doubts.iter().for_each(|doubt| output::complain(doubt));
    }
    match &person.sizes {
        Some(Ok(own)) => {
            let sizes = SizesFound::new(own);
            output::complain(&sizes.text());
            begun.sizes = Some(sizes);
        }
        Some(Err(error)) => output::complain(&format!(
            "the body is only scaled as a whole: the person's own sizes cannot be found: {error}"
        )),
        None => {}
    }
    Ok((person, begun))
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
        let [size, girth] = [self.size, self.girth].map(output::percent_change);
        let [scaled, own] = self.held_out_iou.map(|iou| output::number(iou, 3));
        if !self.taken {
            let doubts = self.doubts.join("; ");
            return format!(
                "the person's own sizes were not used, the body is only scaled ({size}): {doubts}"
            );
        }
        let mut text = format!(
            "the person's own sizes were fitted: size {size}, girth {girth} of the body begun with; IoU in frames held out \
             {own}, with the body only scaled {scaled}"
        );
        if self.widening_px != 0.0 {
            text += &format!("; silhouettes are {:.1} px too wide", self.widening_px);
        }
        text
    }
}

fn doubt_text(doubt: &Doubt) -> String {
    match doubt {
        Doubt::NotBetter { iou: [scaled, own] } => {
            format!("frames held out do not overlap better (IoU {own:.3}, only scaled {scaled:.3})")
        }
        Doubt::Stoutness { deviations } => {
            let word = if *deviations > 0.0 { "stouter" } else { "slimmer" };
            format!("the body would be {word} than people are ({:.1} standard deviations)", deviations.abs())
        }
        Doubt::Widening { deviations } => format!(
            "the silhouettes would be too wide or too narrow by more than they ever are ({deviations:.1} standard deviations)"
        ),
        Doubt::Size { name, kind, deviations } => {
            format!("{name}: its {kind:?} would be {deviations:+.1} standard deviations off what people have")
                .to_lowercase()
        }
    }
}
