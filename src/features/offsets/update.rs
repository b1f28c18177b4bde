//! Opened, what was read and found taken in, written to the take.

use backlit_formats::Footage;
use backlit_formats::synchronise::{OffsetShift, shift_offsets};
use backlit_formats::take::Take;
use backlit_formats::video::Video;
use backlit_jobs::{News, once};
use egui::Ui;

use super::job::{self, FindJob, Said, Wanted};
use super::{Offsets, Side};
use crate::context::command::Command;
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::write_advice::write_advice;
use crate::context::{Context, DesktopRequest, FeatureCard, Requests, ShellRequest};

impl Feature for Offsets {
    fn update(&mut self, _: &Context<'_>, requests: &mut Requests) {
        for side in &mut self.sides {
            side.update(requests);
        }
        for news in self.find.poll() {
            match news {
                News::Output(Said::At(progress)) => self.progress = Some(progress),
                News::Output(Said::Found(found)) => {
                    for (shift, found) in self.shifts.iter_mut().zip(&found.shifts) {
                        *shift = found.as_ref().map_or(*shift, |found| found.frames);
                    }
                    self.found = Some(Ok(found));
                }
                News::Output(Said::Refused(why)) => self.found = Some(Err(why)),
                News::Ended => self.progress = None,
                News::Failed(failure) => requests.failed("The search for the offsets", &failure),
            }
        }
        for news in self.write.poll() {
            match news {
                News::Output(Ok(())) => {
                    requests.request(ShellRequest::CloseCard);
                    requests
                        .inform("The offsets are in the take; its frames were read again.".to_owned(), None);
                    requests.request(DesktopRequest::OpenPath(std::mem::take(&mut self.path)));
                }
                News::Output(Err(why)) => requests.complain(why),
                News::Ended => {}
                News::Failed(failure) => requests.failed("Writing the offsets", &failure),
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
        let take = context.session.take.as_ref();
        let is_file = context.session.take_path().is_some();
        let is_one = take.is_some_and(|take| take.original().full_rig().cameras().len() < 2);
        no_take(context)
            .or(because(
                !is_file,
                "This take comes with the program and cannot be changed: open one of your own",
            ))
            .or(because(is_one, "The take has one camera only"))
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, _: &mut Requests) -> bool {
        self.show(ui, context)
    }
}

impl Offsets {
    /// Lays the card over the window.
    pub(crate) fn open(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let Some(take) = &context.session.take else { return };
        let Some(path) = context.session.take_path() else { return };
        let count = take.original().full_rig().cameras().len();
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

    /// What a side is to show.
    pub(super) fn wanted(&self, side: usize) -> Wanted {
        let camera = self.shown[side];
        Wanted { camera, frame: self.frame, shift: self.shifts.get(camera).copied().unwrap_or(0) }
    }

    /// Asks for the pictures.
    pub(super) fn read_pictures(&mut self, context: &Context<'_>) {
        let Some(take) = &context.session.take else { return };
        for side in 0..2 {
            let wanted = self.wanted(side);
            if self.sides[side].picture.as_ref().is_some_and(|(of, _)| *of == wanted) {
                continue;
            }
            let take = take.clone();
            self.sides[side]
                .task
                .ask(context.pool, wanted, |&wanted| once(move |_| job::read(&take, wanted)));
        }
    }

    /// Looks for the shifts in the silhouettes.
    pub(super) fn find(&mut self, context: &Context<'_>) {
        let Some(take) = context.session.take.clone() else { return };
        (self.progress, self.found) = (None, None);
        self.find.begin(context.pool, (), |()| FindJob(take));
    }

    pub(super) fn stop(&self) {
        self.find.stop();
    }

    pub(super) const fn is_finding(&self) -> bool {
        self.find.is_busy()
    }

    /// Writes the shifts into the take.
    pub(super) fn write(&mut self, context: &Context<'_>) {
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

impl Side {
    fn update(&mut self, requests: &mut Requests) {
        for news in self.task.poll() {
            match news {
                News::Output(read) => {
                    self.problem = match read {
                        Ok(Some(picture)) => {
                            self.picture = self.task.inputs().map(|of| (*of, picture));
                            None
                        }
                        Ok(None) => Some("This camera has no picture of that moment.".to_owned()),
                        Err(why) => Some(format!("{why}.")),
                    };
                }
                News::Ended => {}
                News::Failed(failure) => requests.failed("Reading a picture", &failure),
            }
        }
    }
}

/// The shifts of the cameras that are shifted.
fn shifts_of(take: &Footage, shifts: &[i64]) -> Vec<OffsetShift> {
    let shift = |(camera, &frames): (usize, &i64)| {
        let rate = frame_rate(take.take(), camera);
        let camera = take.original().full_rig().cameras().get(camera)?.name().to_owned();
        (frames != 0).then(|| OffsetShift { camera, frames, seconds: frames as f64 / rate })
    };
    shifts.iter().enumerate().filter_map(shift).collect()
}

/// A camera's own frames per second.
fn frame_rate(take: &Take, camera: usize) -> f64 {
    let own = take.footage().get(camera).and_then(|footage| footage.video()).and_then(Video::frame_rate);
    own.unwrap_or(take.frame_rate())
}
