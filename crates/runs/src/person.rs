//! A person found from nothing but silhouettes: a pose to begin with, and the body's own sizes.

use std::sync::Arc;

use backlit_formats::{FootageError, Take, TakeError};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::body_fit::{
    OwnSizesProgress, Person, PersonError, PersonOptions, PersonProgress, find_person,
};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;

use crate::track::FrameReader;

/// What is looked for.
#[derive(Debug)]
pub struct PersonSearch {
    /// The body to begin with.
    pub model: Arc<Model>,
    /// The fit of a frame.
    pub fit: FitOptions,
    /// The pose of the first frame, where it is known.
    pub start: Option<Pose>,
    /// The first is searched for a start where none is known; sizes are fitted to some of them.
    pub frames: Vec<usize>,
    /// Whether the body's own sizes are looked for.
    pub sizes: bool,
}

/// Why nobody was found.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what each variant is")]
pub enum PersonSearchError {
    #[error(transparent)]
    Keypoints(TakeError),
    #[error(transparent)]
    Footage(#[from] FootageError),
    #[error(transparent)]
    Person(#[from] PersonError),
}

impl PersonSearch {
    /// Looks for the person; `tell` hears in words how far the search is.
    pub fn run<R: FrameReader>(
        self,
        take: &Take,
        reader: &R,
        cancel: &CancelToken,
        mut tell: impl FnMut(String),
    ) -> Result<Person, PersonSearchError> {
        let Self { model, fit, start, frames, sizes } = self;
        let mut options = PersonOptions::new(fit, sizes, take.frame_rate());
        if sizes {
            let followed = options.followed(&frames);
            options.joints = take.keypoint_joints(&followed).map_err(PersonSearchError::Keypoints)?;
        }
        let views = |frame: usize| -> Result<_, PersonSearchError> { Ok(reader.views(&reader.read(frame)?)) };
        find_person(&model, start, &frames, &options, cancel, views, |at| tell(progress_text(at)))
    }
}

fn progress_text(at: PersonProgress) -> String {
    let doing = match at {
        PersonProgress::Searching => return "Looking for the person".to_owned(),
        PersonProgress::Following(done, all) => format!("{done} of {all} frames tracked"),
        PersonProgress::Sizes(OwnSizesProgress::Reading(done, all)) => {
            format!("{done} of {all} frames read")
        }
        PersonProgress::Sizes(OwnSizesProgress::Fitting(at) | OwnSizesProgress::Scaling(at)) => {
            format!("stage {} of {}, step {}", at.stage + 1, at.stages, at.iterations)
        }
        PersonProgress::Sizes(OwnSizesProgress::Judging(done, all)) => {
            format!("{done} of {all} frames judged")
        }
    };
    format!("Finding the person’s sizes: {doing}")
}
