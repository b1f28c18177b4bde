//! Which fitted frames are worst: lost ones, then those whose limbs are most likely to be wrong, then those that overlap least.

use backlit_document::Estimate;
use backlit_document::frame_trust::FrameTrust;

use crate::context::Context;

/// How bad a frame is: first by the one, then by the next. More is worse.
fn badness(context: &Context<'_>, frame: usize, found: &Estimate) -> [f64; 3] {
    let trust = context.document().trust_of(frame, &found.pose);
    let lost = if found.lost { 1.0 } else { 0.0 };
    [lost, trust.map_or(0.0, FrameTrust::expected_wrong), -found.iou.unwrap_or(1.0)]
}

/// All fitted frames, the worst first.
pub(super) fn by_fit(context: &Context<'_>) -> Vec<usize> {
    let found = context.document().estimates.iter();
    let mut ranked: Vec<([f64; 3], usize)> =
        found.map(|(frame, found)| (badness(context, *frame, found), *frame)).collect();
    ranked.sort_by(|(a, _), (b, _)| b.partial_cmp(a).unwrap_or(std::cmp::Ordering::Equal));
    ranked.into_iter().map(|(_, frame)| frame).collect()
}

/// The worst frame of those that are not lost; `None` where there is nothing to compare.
pub(super) fn worst(context: &Context<'_>) -> Option<usize> {
    let found = context.document().estimates.iter();
    let known = found.filter(|(_, found)| !found.lost && found.iou.is_some());
    let known: Vec<([f64; 3], usize)> =
        known.map(|(frame, found)| (badness(context, *frame, found), *frame)).collect();
    if known.len() < 2 {
        return None;
    }
    let worse =
        |worst: ([f64; 3], usize), other: ([f64; 3], usize)| if other.0 > worst.0 { other } else { worst };
    known.into_iter().reduce(worse).map(|(_, frame)| frame)
}

/// The tenth of them that fits worst.
pub(super) fn poor(context: &Context<'_>) -> Vec<usize> {
    let mut frames = by_fit(context);
    frames.truncate(frames.len().div_ceil(10));
    frames
}

/// The first of some frames, or from one of the poor ones the next in rank; after the poor ones the first again.
pub(super) fn next_in_rank(frames: &[usize], here: usize) -> Option<usize> {
    let poor = &frames[..frames.len().div_ceil(10)];
    let rank = poor.iter().position(|frame| *frame == here);
    rank.and_then(|rank| poor.get(rank + 1)).or(poor.first()).copied()
}

#[cfg(test)]
mod tests {
    use backlit_document::edit::Edit;
    use backlit_document::tracking_choices::{CueChoice, TrackingChoices};
    use backlit_take::demonstration::Demonstration;

    use super::*;
    use crate::app::testing::open_take;
    use crate::context::command::{Command, TimelineCommand, TrackingCommand};
    use crate::context::preferences::Layout;

    /// Where the tracker tells how far limbs are believed, the worst frame is the one that is believed least, though another one
    /// overlaps less.
    #[test]
    fn the_worst_frame_is_the_one_that_is_believed_least() {
        let mut app = open_take(Demonstration::Cues, Layout::Pose);
        let alone = TrackingChoices { cues: CueChoice::None, ..app.document().tracking };
        app.state.edit(Edit::SetTracking(alone), None);
        app.does(Command::Tracking(TrackingCommand::Clear));
        app.run(Command::Timeline(TimelineCommand::FirstFrame));
        app.does(Command::Tracking(TrackingCommand::Forward));
        app.run(Command::Timeline(TimelineCommand::FirstFrame));
        app.does(Command::Timeline(TimelineCommand::WorstFrame));
        let here = app.state.selection.frame;
        let wrong = |frame: usize| {
            let found = &app.document().estimates[&frame];
            app.document().trust_of(frame, &found.pose).unwrap().expected_wrong()
        };
        let frames = || app.document().estimates.keys().copied();
        assert!(wrong(here) > 0.0 && frames().all(|frame| wrong(frame) <= wrong(here)), "{here}");
        let iou = |frame: &usize| app.document().estimates[frame].iou.unwrap();
        let least = frames().min_by(|a, b| iou(a).total_cmp(&iou(b))).unwrap();
        assert_ne!(here, least);
        assert_eq!(worst(&app.context()), Some(here));
    }

    #[test]
    fn the_worst_frame_comes_first_and_then_the_next_worst() {
        let mut frames: Vec<usize> = vec![7, 2];
        frames.extend(10..20);
        assert_eq!(next_in_rank(&frames, 3), Some(7));
        assert_eq!(next_in_rank(&frames, 7), Some(2));
        assert_eq!(next_in_rank(&frames, 2), Some(7), "and round");
        assert_eq!(next_in_rank(&[], 3), None);
    }
}
