//! Cameras that were started apart: two of them side by side, one shifted by eye or all as the silhouettes say. `card` is the
//! card with both pictures and the shifts.

mod card;
#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::synchronise::{self, OffsetShift, TakeClocks, TakeClocksError, shift_offsets};
use backlit_formats::video::Video;
use backlit_jobs::{Outbox, Task, TaskEvent, once, one_step};
use backlit_tracking::camera::Camera;
use backlit_tracking::synchronise::SynchroniseOptions;
use egui::{ColorImage, Ui};
use glam::DVec2;

use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::write_advice::write_advice;
use crate::context::{Context, DesktopRequest, FeatureCard, Requests, ShellRequest, priority};

#[derive(Debug, Default)]
pub(crate) struct Offsets {
    /// The cameras of the left and of the right picture.
    shown: [usize; 2],
    frame: usize,
    /// How many of its own frames each camera is shifted by, beside what the take says.
    shifts: Vec<i64>,
    sides: [PictureSide; 2],
    /// A place in a picture, and which: the other picture shows the line on which it can be.
    pointed_at: Option<(usize, DVec2)>,
    find: Task<(), SearchMessage, { priority::TRACK }>,
    /// How far the search is: frames done, and in all.
    progress: Option<[usize; 2]>,
    found: Option<Result<Box<TakeClocks>, String>>,
    write: Task<(), Result<(), String>, { priority::EXPORT }>,
    /// The take that is written to.
    path: PathBuf,
}

#[derive(Debug, Default)]
struct PictureSide {
    task: Task<OffsetPicture, PictureRead, { priority::FRAME }>,
    /// The picture that was read last, and of what.
    picture: Option<(OffsetPicture, Arc<ColorImage>)>,
    problem: Option<String>,
}

/// Height of the pictures on the card, pixels, at least.
const HEIGHT: usize = 360;

/// A picture: what a camera shows `shift` of its own frames later.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct OffsetPicture {
    camera: usize,
    frame: usize,
    shift: i64,
}

/// The picture, and by how much it is reduced; nothing where the camera has none then; or why it cannot be read.
type PictureRead = Result<Option<Arc<ColorImage>>, String>;

fn read(footage: &Footage, wanted: OffsetPicture) -> PictureRead {
    let height = Offsets::full_cameras(footage).get(wanted.camera).map_or(HEIGHT, |camera| camera.height());
    let divisor = (height / HEIGHT).max(1);
    let picture = footage.take().shifted_frame(wanted.camera, wanted.frame, wanted.shift, divisor);
    let picture = picture.map_err(|error| error.to_string())?;
    Ok(picture.map(|picture| {
        let size = [picture.width() as usize, picture.height() as usize];
        Arc::new(ColorImage::from_rgb(size, picture.as_raw()))
    }))
}

#[derive(Debug)]
enum SearchMessage {
    /// Frames done, and in all.
    At([usize; 2]),
    Ended(Result<Box<TakeClocks>, String>),
}

fn find(footage: &Footage, out: &Outbox<SearchMessage>) {
    let (options, tell) =
        (SynchroniseOptions::default(), |done, all| out.send(SearchMessage::At([done, all])));
    match synchronise::find(footage, synchronise::USUAL_FRAMES, &options, out.cancel(), tell) {
        Err(TakeClocksError::Cancelled) => {}
        ended => out.send(SearchMessage::Ended(ended.map(Box::new).map_err(|error| error.to_string()))),
    }
}

impl Feature for Offsets {
    fn update(&mut self, _: &Context<'_>, requests: &mut Requests) {
        for side in &mut self.sides {
            side.update(requests);
        }
        for event in self.find.poll() {
            match event {
                TaskEvent::Output(SearchMessage::At(progress)) => self.progress = Some(progress),
                TaskEvent::Output(SearchMessage::Ended(found)) => {
                    let shifts = found.iter().flat_map(|found| &found.shifts);
                    for (shift, found) in self.shifts.iter_mut().zip(shifts) {
                        *shift = found.as_ref().map_or(*shift, |found| found.frames);
                    }
                    self.found = Some(found);
                }
                TaskEvent::Ended => self.progress = None,
                TaskEvent::Failed(failure) => requests.failed("The search for the offsets", &failure),
            }
        }
        for written in requests.outputs("Writing the offsets", &mut self.write) {
            match written {
                Ok(()) => {
                    requests.request(ShellRequest::CloseCard);
                    requests
                        .inform("The offsets are in the take; its frames were read again.".to_owned(), None);
                    requests.request(DesktopRequest::OpenPath(std::mem::take(&mut self.path)));
                }
                Err(why) => requests.complain(why),
            }
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let is_own = command == Command::Offsets;
        if is_own {
            self.open(context, requests);
        }
        is_own
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        if command != Command::Offsets {
            return None;
        }
        let is_built_in = context.session.take_path().is_none();
        let is_one = context.session.take.as_ref().is_some_and(|take| Self::full_cameras(take).len() < 2);
        let built_in = "This take has no take.toml that could be changed: open one of your own";
        no_take(context)
            .or(because(is_built_in, built_in))
            .or(because(is_one, "The take has one camera only"))
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, _: &mut Requests) -> bool {
        self.show(ui, context)
    }
}

impl Offsets {
    /// The cameras with their lenses, for pictures as large as on the disk.
    fn full_cameras(take: &Footage) -> &[Camera] {
        take.original().full_rig().cameras()
    }

    /// Lays the card over the window.
    pub(crate) fn open(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let Some(take) = &context.session.take else { return };
        let Some(path) = context.session.take_path() else { return };
        let count = Self::full_cameras(take).len();
        let left = context.selection.camera.min(count.saturating_sub(1));
        *self = Self {
            shown: [left, if left == 0 { 1 } else { 0 }],
            frame: context.selection.frame,
            shifts: vec![0; count],
            path: path.clone(),
            ..Self::default()
        };
        requests.request(ShellRequest::OpenCard(FeatureCard::Offsets));
    }

    fn read_pictures(&mut self, context: &Context<'_>) {
        let Some(take) = &context.session.take else { return };
        for (side, &camera) in self.sides.iter_mut().zip(&self.shown) {
            let shift = self.shifts.get(camera).copied().unwrap_or(0);
            let wanted = OffsetPicture { camera, frame: self.frame, shift };
            if side.picture.as_ref().is_none_or(|(of, _)| *of != wanted) {
                let take = take.clone();
                side.task.ask(context.pool, wanted, |&wanted| once(move |_| read(&take, wanted)));
            }
        }
    }

    fn find(&mut self, context: &Context<'_>) {
        let Some(take) = context.session.take.clone() else { return };
        (self.progress, self.found) = (None, None);
        self.find.begin(context.pool, (), |()| one_step(move |out: &Outbox<_>| find(&take, out)));
    }

    fn write(&mut self, context: &Context<'_>) {
        let Some(take) = &context.session.take else { return };
        let shifts = shifts_of(take, &self.shifts);
        let path = self.path.clone();
        self.write.begin(context.pool, (), |()| {
            once(move |_| {
                shift_offsets(&path, &shifts)
                    .map(|_| ())
                    .map_err(|error| format!("Not written: {error}. {}", write_advice(&error)))
            })
        });
    }
}

impl PictureSide {
    fn update(&mut self, requests: &mut Requests) {
        for read in requests.outputs("Reading a picture", &mut self.task) {
            self.problem = match read {
                Ok(Some(picture)) => {
                    self.picture = self.task.inputs().map(|of| (*of, picture));
                    None
                }
                Ok(None) => Some("This camera has no picture of that moment.".to_owned()),
                Err(why) => Some(format!("{why}.")),
            };
        }
    }
}

fn shifts_of(take: &Footage, shifts: &[i64]) -> Vec<OffsetShift> {
    let shift = |(camera, &frames): (usize, &i64)| {
        let video = take.take().footage().get(camera).and_then(|footage| footage.video());
        let rate = video.and_then(Video::frame_rate).unwrap_or(take.take().frame_rate());
        let camera = Offsets::full_cameras(take).get(camera)?.name().to_owned();
        (frames != 0).then(|| OffsetShift { camera, frames, seconds: frames as f64 / rate })
    };
    shifts.iter().enumerate().filter_map(shift).collect()
}
