//! Which frames of a page have pictures, and which are fitted again for their steps.

use std::collections::BTreeSet;

use super::{ReportOptions, ReportSource};

/// This share of the pictures goes to the most doubtful frames.
const DOUBTFUL_SHARE: usize = 4;

/// The chosen frames.
pub(super) struct Chosen {
    /// Those with pictures.
    pub(super) pictured: BTreeSet<usize>,
    /// Those with steps, which have pictures too.
    pub(super) stepped: Vec<usize>,
}

/// Frames of the track that lie in the take, which has `count`. Of those that are spread evenly the take may have an earlier one
/// sooner.
pub(super) fn frames(
    source: &ReportSource,
    options: &ReportOptions,
    count: usize,
    sooner: impl Fn(usize) -> usize,
) -> Chosen {
    let all: Vec<usize> = source.track.frames.keys().copied().filter(|&frame| frame < count).collect();
    let mut worst = all.clone();
    // The first of equals comes first.
    worst.sort_by(|&a, &b| doubt(source, b).total_cmp(&doubt(source, a)));
    let stepped: Vec<usize> = match &options.steps_of {
        Some(asked) => asked.iter().copied().filter(|frame| all.contains(frame)).collect(),
        None => {
            let ends = all.first().into_iter().chain(worst.first());
            ends.copied().collect::<BTreeSet<usize>>().into_iter().collect()
        }
    };
    let mut pictured: BTreeSet<usize> = BTreeSet::new();
    if options.pictures > 0 {
        let marked = source.bookmarks.iter().map(|mark| mark.frame).filter(|frame| all.contains(frame));
        pictured.extend(marked.chain(stepped.iter().copied()));
        let doubtful = if options.pictures < all.len() { options.pictures / DOUBTFUL_SHARE } else { 0 };
        pictured.extend(&worst[..doubtful.min(worst.len())]);
        let spread = (options.pictures - doubtful).min(all.len());
        let place = |number: usize| number * (all.len() - 1) / (spread - 1).max(1);
        pictured.extend((0..spread).map(|number| {
            let before = number.checked_sub(1).map(|number| all[place(number)]);
            let (even, sooner) = (all[place(number)], sooner(all[place(number)]));
            let is_between =
                before.is_none_or(|before| sooner > before) && all.binary_search(&sooner).is_ok();
            if is_between && number + 1 < spread { sooner } else { even }
        }));
    }
    Chosen { pictured, stepped }
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
            if (501..504).contains(&frame) {
                one.trust = vec![LimbTrust::new(0, frame as f64 / 1000.0, [0.1, 0.4], Reason::Unheld)];
            }
            track.frames.insert(frame, one);
        }
        let mut source = crate::report::tests::source(model, track);
        let mark = Bookmark { frame: 77, camera: None, joint: None, text: String::new() };
        source.bookmarks = vec![mark.clone(), Bookmark { frame: 5000, ..mark }];
        let chosen = frames(&source, &ReportOptions::default(), 900, |frame| frame);
        assert!([0, 77, 501, 502, 503, 899].iter().all(|frame| chosen.pictured.contains(frame)));
        // Six for doubts, eighteen spread, with both ends; of equal doubts the first frames.
        assert!((20..=25).contains(&chosen.pictured.len()), "{:?}", chosen.pictured);
        assert!(chosen.pictured.iter().all(|&frame| frame < 900));
        assert_eq!(chosen.stepped, [0, 503]);
        let sooner = frames(&source, &ReportOptions::default(), 900, |frame| frame / 50 * 50);
        let at_keys = sooner.pictured.iter().filter(|frame| **frame % 50 == 0).count();
        assert_eq!((sooner.pictured.len(), at_keys), (chosen.pictured.len(), 17), "{:?}", sooner.pictured);
        assert!(sooner.pictured.contains(&899) && sooner.pictured.contains(&503));
        let none =
            frames(&source, &ReportOptions { pictures: 0, ..ReportOptions::default() }, 900, |frame| frame);
        assert!(none.pictured.is_empty());
        let all =
            frames(&source, &ReportOptions { pictures: 5000, ..ReportOptions::default() }, 900, |frame| {
                frame
            });
        assert_eq!(all.pictured.len(), 900);
    }
}
