//! Why commands about frames cannot be used now.

use super::Context;
use crate::app::keys_around;
use crate::context::action::Action;

/// As [`unavailable`](super::unavailable), of commands that track, play, or go to a frame.
pub(crate) fn unavailable(action: Action, context: &Context<'_>) -> Option<&'static str> {
    use Action as A;
    let (session, selection, document) = (context.session, context.selection, context.document());
    let because = |is_so: bool, why: &'static str| is_so.then_some(why);
    let no_take = because(session.take.is_none(), "Open a take first");
    let one_frame = no_take.or(because(session.frame_count() < 2, "The take has one frame"));
    let not_tracked = because(document.estimates.is_empty(), "No frame is tracked yet");
    let no_track = || {
        no_take
            .or(because(document.used_cameras().next().is_none(), "No camera is used in the fit"))
            .or(because(context.busy.tracking, "The tracker is at work"))
    };
    match action {
        A::TrackForward => {
            let is_last = selection.frame + 1 >= session.frame_count();
            no_track().or(because(is_last, "This is the last frame: Enter fits it"))
        }
        A::TrackBack => {
            no_track().or(because(selection.frame == 0, "This is the first frame: Enter fits it"))
        }
        A::TrackBetween => no_track().or(match keys_around(document, selection.frame) {
            None => Some("Set a key pose before this frame and one after it, with K"),
            Some((first, last)) => {
                because(last - first < 2, "There is no frame between the key poses around this frame")
            }
        }),
        A::PreviousKey | A::NextKey => {
            let is_only = document.keys.len() == 1 && document.keys.contains_key(&selection.frame);
            because(document.keys.is_empty(), "There is no key pose yet: K sets one")
                .or(because(is_only, "This frame has the only key pose"))
        }
        A::ClearTrack => not_tracked,
        A::NextWorst | A::PreviousWorst => {
            not_tracked.or(because(document.estimates.len() < 2, "Only one frame is fitted"))
        }
        A::ClearRange => match context.time.playback.range {
            None => Some("Mark frames first: drag along the timeline with Shift"),
            Some(range) => {
                let found = document.estimates.range(range.first..=range.last).next();
                because(found.is_none(), "No frame of the marked ones is fitted")
            }
        },
        A::Play | A::ToggleLoop | A::PlaySlower | A::PlayFaster => one_frame,
        A::WholeTake => no_take.or(because(context.time.span.is_none(), "All frames are on the screen")),
        A::PreviousFrame | A::TenFramesBack | A::FirstFrame => {
            no_take.or(because(selection.frame == 0, "This is the first frame"))
        }
        A::NextFrame | A::TenFramesOn | A::LastFrame => {
            no_take.or(because(selection.frame + 1 >= session.frame_count(), "This is the last frame"))
        }
        _ => None,
    }
}
