//! Work on other threads: pictures read, and the search for the shifts.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::synchronise::{self, TakeClocks, TakeClocksError};
use backlit_jobs::{Job, Outbox, Turn};
use backlit_tracking::synchronise::SynchroniseOptions;
use egui::ColorImage;

/// Height of the pictures on the card, pixels, at least.
const HEIGHT: usize = 360;

/// A picture: what a camera shows so many of its own frames later.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Wanted {
    pub(super) camera: usize,
    pub(super) frame: usize,
    pub(super) shift: i64,
}

/// The picture, and by how much it is reduced; nothing where the camera has none then; or why it cannot be read.
pub(super) type Picture = Result<Option<Arc<ColorImage>>, String>;

/// By how much pictures of this height are reduced.
pub(super) fn divisor(height: usize) -> usize {
    (height / HEIGHT).max(1)
}

pub(super) fn read(footage: &Footage, wanted: Wanted) -> Picture {
    let height =
        footage.original().full_rig().cameras().get(wanted.camera).map_or(HEIGHT, |camera| camera.height());
    let picture = footage.take().shifted_frame(wanted.camera, wanted.frame, wanted.shift, divisor(height));
    let picture = picture.map_err(|error| error.to_string())?;
    Ok(picture.map(|picture| {
        let size = [picture.width() as usize, picture.height() as usize];
        Arc::new(ColorImage::from_rgb(size, picture.as_raw()))
    }))
}

/// What the search says.
#[derive(Debug)]
pub(super) enum Said {
    /// So many frames are done, of so many.
    At([usize; 2]),
    Found(Box<TakeClocks>),
    /// Why nothing is found.
    Refused(String),
}

/// The search.
#[derive(Debug)]
pub(super) struct FindJob(pub(super) Arc<Footage>);

impl Job<Said> for FindJob {
    fn step(&mut self, out: &Outbox<Said>) -> Turn {
        let (options, tell) = (SynchroniseOptions::default(), |done, all| out.send(Said::At([done, all])));
        let found = synchronise::find(&self.0, synchronise::USUAL_FRAMES, &options, out.cancel(), tell);
        match found {
            Ok(found) => out.send(Said::Found(Box::new(found))),
            Err(TakeClocksError::Cancelled) => {}
            Err(error) => out.send(Said::Refused(error.to_string())),
        }
        Turn::Done
    }
}
