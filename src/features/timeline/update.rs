//! What the timeline's commands do, why they cannot be used, and which frame is read ahead.

use backlit_document::edit::Edit;

use super::Timeline;
use super::ranking::{by_fit, next_in_rank, poor};
use crate::context::command::{Command, TimelineCommand, WindowCommand};
use crate::context::feature::Feature;
use crate::context::unavailable::{Why, because, no_take, not_tracked};
use crate::context::{Context, Requests, SessionRequest};
use crate::session::playback::PlaybackChange;

/// How long a frame takes to be read, before one was: seconds.
const FIRST_GUESS: f64 = 0.05;
/// Share of the newest time of reading in the one that is expected.
const NEW_SHARE: f64 = 0.3;

impl Feature for Timeline {
    fn update(&mut self, context: &Context<'_>, _: &mut Requests) {
        if let Some((frame, since)) = self.ahead
            && context.session.frames.get(frame).is_some()
        {
            let taken = context.now - since;
            let known = self.reading.unwrap_or(taken);
            self.reading = Some(known + NEW_SHARE * (taken - known));
            self.ahead = None;
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        if command == Command::Window(WindowCommand::ToggleTimeline) {
            self.shows_lanes ^= true;
            return true;
        }
        let Command::Timeline(command) = command else { return false };
        let (here, document) = (context.selection.frame, context.document());
        let last = context.session.frame_count().saturating_sub(1);
        let mut go_to = |frame: usize| requests.request(SessionRequest::Frame(frame.min(last)));
        match command {
            TimelineCommand::PreviousFrame => go_to(here.saturating_sub(1)),
            TimelineCommand::NextFrame => go_to(here + 1),
            TimelineCommand::TenFramesBack => go_to(here.saturating_sub(10)),
            TimelineCommand::TenFramesOn => go_to(here + 10),
            TimelineCommand::FirstFrame => go_to(0),
            TimelineCommand::LastFrame => go_to(last),
            TimelineCommand::NextKey | TimelineCommand::PreviousKey => {
                let keys: Vec<usize> = document.keys.keys().copied().collect();
                let key = neighbour(&keys, here, command == TimelineCommand::NextKey);
                key.into_iter().for_each(go_to);
            }
            TimelineCommand::WorstFrame => {
                requests.others.extend(
                    next_in_rank(&by_fit(context), here).map(|frame| SessionRequest::Visit(frame).into()),
                );
            }
            TimelineCommand::NextPoor | TimelineCommand::PreviousPoor => {
                let poor = neighbour(&poor(context), here, command == TimelineCommand::NextPoor);
                requests.others.extend(poor.map(|frame| SessionRequest::Visit(frame).into()));
            }
            TimelineCommand::SetKeyPose => {
                let is_key = document.keys.contains_key(&here);
                requests.edit(if is_key {
                    Edit::ClearKey { frame: here }
                } else {
                    Edit::SetKey { frame: here }
                });
            }
            TimelineCommand::ClearRange => {
                if let Some(range) = context.playback.range {
                    requests.edit(Edit::ClearRange { first: range.first, last: range.last });
                }
            }
            TimelineCommand::Play => requests.request(SessionRequest::Playback(PlaybackChange::PlayOrPause)),
            TimelineCommand::ToggleLoop => {
                requests.request(SessionRequest::Playback(PlaybackChange::ToggleLoop));
            }
            TimelineCommand::Slower | TimelineCommand::Faster => {
                let speed = context.playback.next_speed(command == TimelineCommand::Faster);
                requests.request(SessionRequest::Playback(PlaybackChange::Speed(speed)));
            }
            TimelineCommand::WholeTake => self.span = None,
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Timeline(command) = command else { return None };
        let (session, document, frame) = (context.session, context.document(), context.selection.frame);
        match command {
            TimelineCommand::SetKeyPose => no_take(context),
            TimelineCommand::PreviousKey | TimelineCommand::NextKey => {
                let is_only = document.keys.len() == 1 && document.keys.contains_key(&frame);
                because(document.keys.is_empty(), "There is no key pose yet: K sets one")
                    .or(because(is_only, "This frame has the only key pose"))
            }
            TimelineCommand::WorstFrame | TimelineCommand::NextPoor | TimelineCommand::PreviousPoor => {
                not_tracked(context).or(because(document.estimates.len() < 2, "Only one frame is fitted"))
            }
            TimelineCommand::ClearRange => match context.playback.range {
                None => Some("Mark frames first: drag along the timeline with Shift"),
                Some(range) => {
                    let found = document.estimates.range(range.first..=range.last).next();
                    because(found.is_none(), "No frame of the marked ones is fitted")
                }
            },
            TimelineCommand::Play
            | TimelineCommand::ToggleLoop
            | TimelineCommand::Slower
            | TimelineCommand::Faster => {
                no_take(context).or(because(session.frame_count() < 2, "The take has one frame"))
            }
            TimelineCommand::WholeTake => {
                no_take(context).or(because(self.span.is_none(), "All frames are on the screen"))
            }
            TimelineCommand::PreviousFrame | TimelineCommand::TenFramesBack | TimelineCommand::FirstFrame => {
                no_take(context).or(because(frame == 0, "This is the first frame"))
            }
            TimelineCommand::NextFrame | TimelineCommand::TenFramesOn | TimelineCommand::LastFrame => {
                let is_last = frame + 1 >= session.frame_count();
                no_take(context).or(because(is_last, "This is the last frame"))
            }
        }
    }
}

impl Timeline {
    /// The frame that a film will need next, if it is not there.
    pub(crate) fn frame_to_read_ahead(&mut self, context: &Context<'_>) -> Option<usize> {
        let take = context.session.take.as_ref()?;
        let seconds = self.reading.unwrap_or(FIRST_GUESS);
        let frame =
            context.playback.due_in(seconds, take.frame_count(), take.take().frame_rate(), context.now)?;
        if context.session.frames.get(frame).is_some() {
            return None;
        }
        self.ahead = Some((frame, context.now));
        Some(frame)
    }
}

/// The next of some frames on a side, or the one at the other end.
fn neighbour(frames: &[usize], here: usize, later: bool) -> Option<usize> {
    let all = || frames.iter().copied();
    if later {
        all().filter(|frame| *frame > here).min().or_else(|| all().min())
    } else {
        all().filter(|frame| *frame < here).max().or_else(|| all().max())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_go_round() {
        let frames = [30, 2, 11];
        assert_eq!(neighbour(&frames, 11, true), Some(30));
        assert_eq!(neighbour(&frames, 30, true), Some(2));
        assert_eq!(neighbour(&frames, 2, false), Some(30));
        assert_eq!(neighbour(&[], 2, false), None);
    }
}
