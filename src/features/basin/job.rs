//! The basin of a frame, one fit a step.

use backlit_jobs::{Job, Outbox, Turn};
use backlit_lab::experiment::ExperimentError;
use backlit_lab::experiment::basin_map::{self, BasinMap};
use backlit_lab::experiment::frame_basin::{self, Frame, FrameBasin};
use backlit_tracking::cancel::CancelToken;

use backlit_lab::experiment::basin_map::Cell;
use backlit_lab::experiment::frame_basin::Trial;

/// A fit that was made, or why none can be.
#[derive(Debug)]
pub(super) enum Fitted {
    Trial(Trial),
    Cell(Cell),
    Refused(ExperimentError),
}

/// What is to be tried.
#[derive(Debug)]
pub(super) enum BasinWork {
    /// Success over angle.
    Angles(Box<frame_basin::Options>),
    /// The map.
    Map(Box<basin_map::Options>),
}

#[derive(Debug)]
enum Prepared {
    Angles(Box<FrameBasin>),
    Map(Box<BasinMap>),
}

/// An experiment about a frame. Its first step finds where fits are to end.
#[derive(Debug)]
pub(super) struct BasinJob {
    begin: Option<(Frame, BasinWork)>,
    prepared: Option<Prepared>,
    next: usize,
}

impl BasinJob {
    /// All fits about this frame.
    pub(super) fn new(frame: Frame, work: BasinWork) -> Self {
        Self { begin: Some((frame, work)), prepared: None, next: 0 }
    }

    /// Makes the next fit; whether there is one more.
    fn go_on(&mut self, out: &Outbox<Fitted>) -> Result<bool, ExperimentError> {
        if let Some((frame, work)) = self.begin.take() {
            self.prepared = Some(prepare(frame, work, out.cancel())?);
        }
        let index = self.next;
        self.next += 1;
        let total = match &self.prepared {
            Some(Prepared::Angles(basin)) => {
                out.send(Fitted::Trial(basin.run(index, out.cancel())?));
                basin.len()
            }
            Some(Prepared::Map(map)) => {
                out.send(Fitted::Cell(map.run(index, out.cancel())?));
                map.len()
            }
            None => 0,
        };
        Ok(self.next < total)
    }
}

fn prepare(frame: Frame, work: BasinWork, cancel: &CancelToken) -> Result<Prepared, ExperimentError> {
    Ok(match work {
        BasinWork::Angles(options) => Prepared::Angles(Box::new(FrameBasin::new(frame, *options, cancel)?)),
        BasinWork::Map(options) => Prepared::Map(Box::new(BasinMap::new(frame, *options, cancel)?)),
    })
}

impl Job<Fitted> for BasinJob {
    fn step(&mut self, out: &Outbox<Fitted>) -> Turn {
        if out.cancel().is_cancelled() {
            return Turn::Done;
        }
        match self.go_on(out) {
            Ok(true) => Turn::Again,
            Ok(false) | Err(ExperimentError::Cancelled) => Turn::Done,
            Err(error) => {
                out.send(Fitted::Refused(error));
                Turn::Done
            }
        }
    }
}
