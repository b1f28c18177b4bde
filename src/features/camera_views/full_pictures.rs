//! The footage at its full size, under what is worked on at a part of it: read once a frame stays on the screen.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::{Job, Outbox, Task, TaskEvent, Turn};
use egui::ColorImage;

use crate::context::Context;
use crate::context::priority;

/// The pictures of the frame on the screen.
#[derive(Debug, Default)]
pub(super) struct FullPictures {
    task: Task<FrameKey, (usize, Arc<ColorImage>), { priority::FRAME }>,
    of: Option<FrameKey>,
    /// By camera; `None` where it is not read yet, or cannot be.
    pictures: Vec<Option<Arc<ColorImage>>>,
}

/// A frame of some footage, which is another one once cameras are replaced.
#[derive(Debug, Clone)]
struct FrameKey {
    take: Arc<Footage>,
    frame: usize,
}

impl PartialEq for FrameKey {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.take, &other.take) && self.frame == other.frame
    }
}

impl Clone for FullPictures {
    /// The pictures, not the work.
    fn clone(&self) -> Self {
        Self { of: self.of.clone(), pictures: self.pictures.clone(), ..Self::default() }
    }
}

impl FullPictures {
    /// Asks for the pictures of the frame on the screen, unless it is passed by, and takes in what was read.
    pub(super) fn update(&mut self, context: &Context<'_>) {
        let take = context.session.take.as_ref().filter(|take| take.take().reduction() > 1);
        let Some(take) = take else { return };
        let wanted = FrameKey { take: take.clone(), frame: context.selection.frame };
        if self.of.as_ref() != Some(&wanted) {
            self.pictures = vec![None; take.cameras.len()];
            self.of = Some(wanted.clone());
        }
        let passes_by = context.playback.is_playing() || context.busy.tracking;
        let has_frame = context.session.frames.get(wanted.frame).is_some();
        if !passes_by && has_frame && self.pictures.iter().all(Option::is_none) {
            self.task.ask(context.pool, wanted, |wanted| ReadJob { wanted: wanted.clone(), camera: 0 });
        }
        let is_of_this = self.task.inputs() == self.of.as_ref();
        for event in self.task.poll() {
            if let TaskEvent::Output((camera, picture)) = event
                && is_of_this
                && let Some(place) = self.pictures.get_mut(camera)
            {
                *place = Some(picture);
            }
        }
    }

    /// A camera's picture of this frame, if it was read.
    pub(super) fn of(&self, camera: usize, frame: usize) -> Option<&Arc<ColorImage>> {
        self.of.as_ref().filter(|of| of.frame == frame)?;
        self.pictures.get(camera)?.as_ref()
    }
}

/// One camera a step.
#[derive(Debug)]
struct ReadJob {
    wanted: FrameKey,
    camera: usize,
}

impl Job<(usize, Arc<ColorImage>)> for ReadJob {
    fn step(&mut self, out: &Outbox<(usize, Arc<ColorImage>)>) -> Turn {
        let FrameKey { take, frame } = &self.wanted;
        if self.camera >= take.cameras.len() || out.cancel().is_cancelled() {
            return Turn::Done;
        }
        if let Ok(picture) = take.full_picture(self.camera, *frame) {
            let size = [picture.width() as usize, picture.height() as usize];
            out.send((self.camera, Arc::new(ColorImage::from_rgb(size, picture.as_raw()))));
        }
        self.camera += 1;
        Turn::Again
    }
}
