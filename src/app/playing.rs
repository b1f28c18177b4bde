//! Playing frames.

use std::time::Duration;

use super::Inspector;
use crate::context::Request;
use crate::session::playback::{Cue, PlaybackChange};

/// While frames are played, the window looks at its clock at least this often: seconds.
const LONGEST_WAIT: f64 = 1.0;

impl Inspector {
    /// Whether frames are being played.
    pub fn is_playing(&self) -> bool {
        self.state.playback.is_playing()
    }

    /// Stops playing: the frame on the screen is about to be worked on.
    pub(crate) fn pause(&mut self) {
        self.state.playback.stop();
    }

    /// Plays otherwise.
    pub(crate) fn change_playback(&mut self, change: PlaybackChange) {
        match change {
            PlaybackChange::PlayOrPause if !self.is_playing() => {
                let (here, count) = (self.state.selection.frame, self.state.session.frame_count());
                let from = self.state.playback.start(here, count, self.state.now);
                self.request(Request::Frame(from));
            }
            PlaybackChange::PlayOrPause | PlaybackChange::Pause => self.pause(),
            PlaybackChange::Speed(speed) => self.state.playback.set_speed(speed, self.state.now),
            PlaybackChange::ToggleLoop => self.state.playback.loops ^= true,
            PlaybackChange::Mark(range) => {
                self.state.playback.range = range;
                // Who marks frames wants to see them again and again.
                self.state.playback.loops |= range.is_some();
            }
        }
    }

    /// Goes on to the next frame when it is time, as long as frames are played.
    pub(crate) fn play(&mut self, ctx: &egui::Context) {
        let Some(take) = &self.state.session.take else { return self.pause() };
        let (rate, count) = (take.frame_rate, take.frame_count());
        let (frames, now) = (&self.state.session.frames, self.state.now);
        let is_there = |frame: usize| frames.get(frame).is_some();
        match self.state.playback.cue(self.state.selection.frame, count, rate, now, is_there) {
            Cue::Show(frame) | Cue::End(frame) => self.go_to_frame(frame),
            Cue::Wait => {}
        }
        if let Some(seconds) = self.state.playback.next_in(rate, now) {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds.min(LONGEST_WAIT)));
        }
    }
}
