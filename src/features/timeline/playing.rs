//! Playing frames, and what the timeline is asked for.

use std::time::Duration;

use crate::app::App;
use crate::context::Request;
use crate::context::command::TimelineCommand;
use crate::document::edit::Edit;
use crate::features::timeline::{Span, TimelineEvent};
use crate::session::playback::{Cue, Playback};

/// How long a frame takes to be read, before one was: seconds.
const FIRST_GUESS: f64 = 0.05;
/// While frames are played, the window looks at its clock at least this often: seconds.
const LONGEST_WAIT: f64 = 1.0;
/// Share of the newest time of reading in the one that is expected.
const NEW_SHARE: f64 = 0.3;

/// The time axis: what is played and what of it is on the screen. Neither saved nor undone.
#[derive(Debug, Default)]
pub(crate) struct TimeAxis {
    pub(crate) playback: Playback,
    /// The frames on the screen; all where `None`.
    pub(crate) span: Option<Span>,
    /// How long a frame takes to be read, seconds.
    reading: Option<f64>,
    /// The frame that is read ahead, and since when.
    ahead: Option<(usize, f64)>,
}

impl App {
    /// Whether frames are being played.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.features.timeline.playback.is_playing()
    }

    /// Does a command about frames, key poses or the time axis.
    pub(crate) fn timeline_command(&mut self, command: TimelineCommand) {
        let here = self.state.selection.frame;
        let last = self.state.session.frame_count().saturating_sub(1);
        let go_to = |app: &mut Self, frame: usize| app.request(Request::Frame(frame.min(last)));
        match command {
            TimelineCommand::PreviousFrame => go_to(self, here.saturating_sub(1)),
            TimelineCommand::NextFrame => go_to(self, here + 1),
            TimelineCommand::TenFramesBack => go_to(self, here.saturating_sub(10)),
            TimelineCommand::TenFramesOn => go_to(self, here + 10),
            TimelineCommand::FirstFrame => go_to(self, 0),
            TimelineCommand::LastFrame => go_to(self, last),
            TimelineCommand::NextWorst => self.go_to_worst(true),
            TimelineCommand::PreviousWorst => self.go_to_worst(false),
            TimelineCommand::NextKey => self.go_to_key(true),
            TimelineCommand::PreviousKey => self.go_to_key(false),
            TimelineCommand::SetKeyPose => {
                let is_key = self.document().keys.contains_key(&here);
                let edit = if is_key { Edit::ClearKey { frame: here } } else { Edit::SetKey { frame: here } };
                self.edit(edit, None);
            }
            TimelineCommand::ClearRange => self.clear_range(),
            TimelineCommand::Play => self.play_or_pause(),
            TimelineCommand::ToggleLoop => self.features.timeline.playback.loops ^= true,
            TimelineCommand::Slower | TimelineCommand::Faster => {
                let speed = self.features.timeline.playback.next_speed(command == TimelineCommand::Faster);
                self.features.timeline.playback.set_speed(speed, self.state.now);
            }
            TimelineCommand::WholeTake => self.features.timeline.span = None,
        }
    }

    /// Stops playing: the frame on the screen is about to be worked on.
    pub(crate) fn pause(&mut self) {
        self.features.timeline.playback.stop();
    }

    /// Plays, or stops playing.
    pub(crate) fn play_or_pause(&mut self) {
        let (here, count) = (self.state.selection.frame, self.state.session.frame_count());
        if self.features.timeline.playback.is_playing() {
            self.pause();
        } else {
            self.features.tracking.follows_tracker = false;
            self.interrupt_fit();
            let from = self.features.timeline.playback.start(here, count, self.state.now);
            self.go_to_frame(from);
        }
    }

    /// Goes on to the next frame when it is time, as long as frames are played.
    pub(crate) fn play(&mut self, ctx: &egui::Context) {
        let Some(take) = self.state.session.take.clone() else {
            self.features.timeline.playback.stop();
            return;
        };
        let (rate, count) = (take.frame_rate, take.frame_count());
        if let Some((frame, since)) = self.features.timeline.ahead
            && self.state.session.frames.get(frame).is_some()
        {
            let known = self.features.timeline.reading.unwrap_or(self.state.now - since);
            self.features.timeline.reading = Some(known + NEW_SHARE * (self.state.now - since - known));
            self.features.timeline.ahead = None;
        }
        let frames = &self.state.session.frames;
        let is_there = |frame: usize| frames.get(frame).is_some();
        match self.features.timeline.playback.cue(
            self.state.selection.frame,
            count,
            rate,
            self.state.now,
            is_there,
        ) {
            Cue::Show(frame) | Cue::End(frame) => self.go_to_frame(frame),
            Cue::Wait => {}
        }
        if let Some(seconds) = self.features.timeline.playback.next_in(rate, self.state.now) {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds.min(LONGEST_WAIT)));
        }
    }

    /// The frame that a film will need next, if it is not there.
    pub(crate) fn frame_to_read_ahead(&mut self) -> Option<usize> {
        let take = self.state.session.take.as_ref()?;
        let seconds = self.features.timeline.reading.unwrap_or(FIRST_GUESS);
        let (count, rate) = (take.frame_count(), take.frame_rate);
        let frame = self.features.timeline.playback.due_in(seconds, count, rate, self.state.now)?;
        if self.state.session.frames.get(frame).is_some() {
            return None;
        }
        self.features.timeline.ahead = Some((frame, self.state.now));
        Some(frame)
    }

    /// What was done in the timeline.
    pub(crate) fn timeline_event(&mut self, event: TimelineEvent) {
        match event {
            TimelineEvent::Show(span) => self.features.timeline.span = span,
            TimelineEvent::Mark(range) => {
                self.features.timeline.playback.range = range;
                // Who marks frames wants to see them again and again.
                self.features.timeline.playback.loops |= range.is_some();
            }
            TimelineEvent::Pause => self.pause(),
            TimelineEvent::Speed(speed) => self.features.timeline.playback.set_speed(speed, self.state.now),
        }
    }

    /// Forgets what was found for the frames that are marked.
    fn clear_range(&mut self) {
        if let Some(range) = self.features.timeline.playback.range {
            self.edit(Edit::ClearRange { first: range.first, last: range.last }, None);
        }
    }
}
