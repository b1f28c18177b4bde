//! Which frames of a page have pictures, and which are fitted again for their steps.

use std::collections::{BTreeMap, BTreeSet};

use backlit_tracking::body_fit::survey::spread;

use super::{ReportOptions, ReportSource};

/// This share of the pictures goes to the most doubtful frames.
const DOUBTFUL_SHARE: usize = 4;
/// Doubtful frames are so far apart, seconds: each stands for its surroundings.
const DOUBTS_APART_S: f64 = 0.5;
/// A frame beside a doubtful one stands for it if it is this share as doubtful, and decoded sooner.
const NEARLY_AS_DOUBTFUL: f64 = 0.75;
/// Pictures that may be decoded on the way to doubtful frames for each picture of a page, which is wanted soon.
const DECODED_PER_PICTURE: usize = 8;

/// The chosen frames.
pub(super) struct PageFrames {
    /// Those with pictures.
    pub(super) pictured: BTreeSet<usize>,
    /// Those with steps, which have pictures too.
    pub(super) stepped: Vec<usize>,
}

/// Frames of the track that lie in the take, which has `count`. `sooner` is the last frame, up to one, that the take decodes by
/// itself: it is shown in the place of those that are spread evenly.
pub(super) fn frames(
    source: &ReportSource,
    options: &ReportOptions,
    count: usize,
    sooner: impl Fn(usize) -> usize,
) -> PageFrames {
    let all: Vec<usize> = source.track.frames.keys().copied().filter(|&frame| frame < count).collect();
    let doubts: BTreeMap<usize, f64> = all.iter().map(|&frame| (frame, doubt(source, frame))).collect();
    let mut worst: Vec<(usize, f64)> = doubts.iter().map(|(frame, doubt)| (*frame, *doubt)).collect();
    // The first of equals comes first.
    worst.sort_by(|a, b| b.1.total_cmp(&a.1));
    let stepped: Vec<usize> = match &options.steps_of {
        Some(asked) => asked.iter().copied().filter(|frame| all.contains(frame)).collect(),
        None => {
            let ends = all.first().into_iter().chain(worst.first().map(|(frame, _)| frame));
            ends.copied().collect::<BTreeSet<usize>>().into_iter().collect()
        }
    };
    let mut pictured: BTreeSet<usize> = BTreeSet::new();
    if options.pictures > 0 && !all.is_empty() {
        let marked = source.bookmarks.iter().map(|mark| mark.frame).filter(|frame| all.contains(frame));
        pictured.extend(marked.chain(stepped.iter().copied()));
        if options.pictures < all.len() {
            pictured.extend(doubtful(source, options.pictures, (&doubts, &worst), &sooner));
        }
        let even = spread(&all, options.pictures.saturating_sub(pictured.len()));
        let before = std::iter::once(None).chain(even.iter().map(Some));
        pictured.extend(even.iter().zip(before).map(|(&even, before)| {
            let sooner = sooner(even);
            let is_between =
                before.is_none_or(|before| sooner > *before) && all.binary_search(&sooner).is_ok();
            if is_between { sooner } else { even }
        }));
    }
    PageFrames { pictured, stepped }
}

/// The frames of a page of `pictures` that stand for its most doubtful ones, from the doubts of all frames, by frame and worst first.
/// Those that take too long to decode are left out.
fn doubtful(
    source: &ReportSource,
    pictures: usize,
    (doubts, worst): (&BTreeMap<usize, f64>, &[(usize, f64)]),
    sooner: impl Fn(usize) -> usize,
) -> Vec<usize> {
    let apart = (DOUBTS_APART_S * source.frame_rate).round() as usize;
    let mut decodes = DECODED_PER_PICTURE * pictures;
    let (mut peaks, mut shown): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
    for &(peak, most) in worst {
        if shown.len() == pictures / DOUBTFUL_SHARE || most <= 0.0 {
            break;
        }
        if peaks.iter().any(|other| other.abs_diff(peak) <= apart) {
            continue;
        }
        peaks.push(peak);
        let near = doubts.range(peak.saturating_sub(apart)..=peak + apart);
        let stands_for =
            near.filter(|&(frame, doubt)| sooner(*frame) == *frame && *doubt >= NEARLY_AS_DOUBTFUL * most);
        let nearest = stands_for.min_by_key(|(frame, _)| frame.abs_diff(peak));
        let frame = nearest.map_or(peak, |(frame, _)| *frame);
        let cost = (frame + 1).saturating_sub(sooner(frame)) * source.cameras.len();
        if let Some(left) = decodes.checked_sub(cost) {
            decodes = left;
            shown.push(frame);
        }
    }
    shown
}

/// How little a frame is believed: how many limbs may be expected to be wrong, and what its overlap lacks.
fn doubt(source: &ReportSource, frame: usize) -> f64 {
    let Some(estimate) = source.track.frames.get(&frame) else { return 0.0 };
    let limbs = source.model.limbs();
    let told =
        estimate.trust.iter().filter(|limb| limb.reason.is_some() && limbs[limb.limb].has_own_rotation);
    let lost = if estimate.is_lost() { 100.0 } else { 0.0 };
    lost + told.map(|limb| limb.wrong).sum::<f64>() + source.iou(estimate).map_or(0.0, |iou| 1.0 - iou)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use backlit_report::Bookmark;
    use backlit_tracking::belief::{LimbTrust, Reason};
    use backlit_tracking::body::{Pose, builtin};
    use backlit_tracking::track::{FrameEstimate, Track};

    use super::*;

    #[test]
    fn pictures_are_spread_and_doubts_and_bookmarks_have_theirs() {
        let model = Arc::new(builtin::single_limb());
        let mut track = Track::default();
        for frame in 0..1000 {
            let mut one = FrameEstimate::of_pose(frame, Pose::rest(&model));
            let wrong = match frame {
                500..504 => frame as f64 / 1000.0,
                620 => 0.4,
                700 => 0.3,
                _ => 0.0,
            };
            if wrong > 0.0 {
                one.trust = vec![LimbTrust::new(0, wrong, [0.1, 0.4], Reason::Unheld)];
            }
            track.frames.insert(frame, one);
        }
        let mut source = crate::report::tests::source(model, track);
        source.cameras = ["left", "right"].map(str::to_owned).into();
        let mark = Bookmark { frame: 77, camera: None, joint: None, text: String::new() };
        source.bookmarks = vec![mark.clone(), Bookmark { frame: 5000, ..mark }];
        let options = ReportOptions::default();
        let chosen = frames(&source, &options, 900, |frame| frame);
        // Each doubtful stretch has one picture, at its peak; the rest is spread from end to end.
        let doubtful = |frame: &&usize| (500..504).contains(*frame) || [620, 700].contains(*frame);
        assert_eq!(chosen.pictured.iter().filter(doubtful).collect::<Vec<_>>(), [&503, &620, &700]);
        assert!([0, 77, 899].iter().all(|frame| chosen.pictured.contains(frame)));
        assert!((22..=24).contains(&chosen.pictured.len()), "{:?}", chosen.pictured);
        assert!(chosen.pictured.iter().all(|&frame| frame < 900));
        assert_eq!(chosen.stepped, [0, 503]);
        // A key beside a peak stands for it; the first of all is shown as it is, for it has steps.
        let sooner = frames(&source, &options, 900, |frame| frame / 50 * 50);
        let (at_keys, others): (Vec<usize>, Vec<usize>) =
            sooner.pictured.iter().partition(|frame| **frame % 50 == 0);
        assert_eq!(others, [77, 503, 620], "{at_keys:?}");
        assert!([500, 700, 850].iter().all(|frame| at_keys.contains(frame)) && at_keys.len() > 14);
        // What takes too long to decode has no picture but with its steps.
        let seldom = frames(&source, &options, 900, |frame| frame / 400 * 400);
        assert!(seldom.pictured.contains(&503) && !seldom.pictured.contains(&620));
        let of =
            |pictures| frames(&source, &ReportOptions { pictures, ..options.clone() }, 900, |frame| frame);
        assert!(of(0).pictured.is_empty());
        assert_eq!(of(5000).pictured.len(), 900);
    }
}
