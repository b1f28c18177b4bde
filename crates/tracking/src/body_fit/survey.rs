//! Silhouettes of a few frames, looked at before a take is tracked: can they be a person's at all?
//!
//! With a black plate nearly all pixels are unknown, with a wrong one the subject fills the picture, and an inverted mask shows
//! all but the person. A fit of such evidence ends somewhere and overlaps well; so it is looked at by itself, beforehand.

use thiserror::Error;

use crate::cancel::CancelToken;
use crate::fit::{Evidence, FitView};
use crate::people::people_in_frame;
use crate::silhouette::{Label, Mask};

/// A mask of which more is unknown says nothing: with a black plate nearly all of it is.
const MOST_UNKNOWN: f64 = 0.8;
/// A subject that covers more of what is known fills the picture.
const MOST_SUBJECT: f64 = 0.6;
/// A subject with a larger share of its border beside unknown pixels has hardly an outline.
const MOST_HIDDEN: f64 = 0.8;

/// Why a silhouette cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum Unusable {
    #[error("nobody is seen")]
    Nobody,
    #[error("{:.0} % of the pixels are unknown; at most {:.0} % may be", 100.0 * share, 100.0 * MOST_UNKNOWN)]
    Unknown { share: f64 },
    #[error("the subject covers {:.0} % of the picture; at most {:.0} % can be a person", 100.0 * share, 100.0 * MOST_SUBJECT)]
    Fills { share: f64 },
    #[error("{:.0} % of the subject's border lies beside unknown pixels; at most {:.0} % may", 100.0 * share, 100.0 * MOST_HIDDEN)]
    Hidden { share: f64 },
}

/// A camera that was left out of a frame.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("camera \"{camera}\", frame {frame}: {because}")]
pub struct LeftOut {
    /// The frame.
    pub frame: usize,
    /// The camera's name.
    pub camera: String,
    /// Why.
    pub because: Unusable,
}

/// Looks at what a camera contributes by itself; grey levels are taken as they are.
///
/// # Errors
/// What speaks against it.
pub fn check_view(view: &FitView) -> Result<(), Unusable> {
    let Evidence::Mask(mask) = &view.evidence else { return Ok(()) };
    let [subject, background, unknown] =
        [Label::Subject, Label::Background, Label::Unknown].map(|label| mask.count(label) as f64);
    let unknown_share = unknown / (subject + background + unknown).max(1.0);
    if unknown_share > MOST_UNKNOWN {
        return Err(Unusable::Unknown { share: unknown_share });
    }
    if subject == 0.0 {
        return Err(Unusable::Nobody);
    }
    let share = subject / (subject + background);
    if share > MOST_SUBJECT {
        return Err(Unusable::Fills { share });
    }
    let (seen, hidden) = borders(mask);
    let share = hidden as f64 / (seen + hidden).max(1) as f64;
    if share > MOST_HIDDEN { Err(Unusable::Hidden { share }) } else { Ok(()) }
}

/// A frame's views that count and can be a person's; others that count are noted.
pub(super) fn usable_views(
    frame: usize,
    mut views: Vec<FitView>,
    left_out: &mut Vec<LeftOut>,
) -> Vec<FitView> {
    let mut keep = |view: &FitView| match check_view(view) {
        Ok(()) => view.has_data(),
        Err(because) => {
            left_out.push(LeftOut { frame, camera: view.camera.name().to_owned(), because });
            false
        }
    };
    views.retain(|view| view.weight > 0.0 && keep(view));
    views
}

/// The best reason of all: a picture in which nobody is may be between others, one that cannot be right is worse.
pub(super) fn worst<'a>(mut left_out: impl Iterator<Item = &'a LeftOut> + Clone) -> Option<&'a LeftOut> {
    left_out.clone().find(|one| one.because != Unusable::Nobody).or_else(|| left_out.next())
}

/// Neighbours across and down of which one is subject and the other background, or unknown.
fn borders(mask: &Mask) -> (usize, usize) {
    let (width, labels) = (mask.width(), mask.labels());
    let (mut seen, mut hidden) = (0, 0);
    let mut meet = |a: Label, b: Label| match (a, b) {
        (Label::Subject, Label::Background) | (Label::Background, Label::Subject) => seen += 1,
        (Label::Subject, Label::Unknown) | (Label::Unknown, Label::Subject) => hidden += 1,
        _ => {}
    };
    for row in labels.chunks_exact(width.max(1)) {
        row.windows(2).for_each(|pair| meet(pair[0], pair[1]));
    }
    for (above, below) in labels.iter().zip(labels.iter().skip(width)) {
        meet(*above, *below);
    }
    (seen, hidden)
}

/// Frames that are looked at: the first, the last, and some between.
pub const LOOKED_AT: usize = 5;

/// Numbers of at most `most` of `count` frames, spread from the first to the last.
pub fn spread_numbers(count: usize, most: usize) -> impl Iterator<Item = usize> {
    let wanted = most.min(count);
    (0..wanted).map(move |k| k * (count - 1) / (wanted - 1).max(1))
}

/// At most this many of some frames, spread from the first to the last.
pub fn spread(frames: &[usize], most: usize) -> Vec<usize> {
    spread_numbers(frames.len(), most).map(|number| frames[number]).collect()
}

/// What one camera shows in the frames that were looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSurvey {
    /// Its name.
    pub camera: String,
    /// In how many of the frames its silhouette can be a person's.
    pub good: usize,
    /// The first of the others, those in which it is worse than that nobody is seen before those.
    pub bad: Option<LeftOut>,
}

/// What the silhouettes of a few frames say about a take.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The frames.
    pub frames: Vec<usize>,
    /// By camera, in the order in which they were first seen.
    pub cameras: Vec<CameraSurvey>,
    /// How many people are in view in half of the frames or more, as far as cameras tell people apart.
    pub people: usize,
}

/// Why a take cannot be tracked.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("the silhouettes cannot be right: {worst}; in {looked_at} frames no camera shows a person")]
pub struct NobodyToTrack {
    /// The camera and frame that say most, and what is wrong there.
    pub worst: LeftOut,
    /// How many frames were looked at.
    pub looked_at: usize,
}

/// Surveys the silhouettes of some frames, usually [`spread`] over the frames of a track. Cameras of no weight do not
/// count.
///
/// # Errors
/// What `views` returns.
pub fn survey<E>(
    frames: &[usize],
    mut views: impl FnMut(usize) -> Result<Vec<FitView>, E>,
) -> Result<Survey, E> {
    let mut cameras: Vec<CameraSurvey> = Vec::new();
    let mut people = Vec::new();
    for &frame in frames {
        let views = views(frame)?;
        let usable = views.iter().filter(|view| check_view(view).is_ok());
        people.push(people_in_frame(usable, &CancelToken::new()).people.len());
        for view in views.iter().filter(|view| view.weight > 0.0) {
            let name = view.camera.name();
            let index = cameras.iter().position(|one| one.camera == name).unwrap_or_else(|| {
                cameras.push(CameraSurvey { camera: name.to_owned(), good: 0, bad: None });
                cameras.len() - 1
            });
            let CameraSurvey { camera, good, bad } = &mut cameras[index];
            let Err(because) = check_view(view) else {
                *good += 1;
                continue;
            };
            let is_worse = |known: &LeftOut| known.because == Unusable::Nobody && because != Unusable::Nobody;
            if bad.as_ref().is_none_or(is_worse) {
                *bad = Some(LeftOut { frame, camera: camera.clone(), because });
            }
        }
    }
    people.sort_unstable();
    let people = people.get(people.len() / 2).copied().unwrap_or(0);
    Ok(Survey { frames: frames.to_vec(), cameras, people })
}

impl Survey {
    /// Whether there is anything to track: one camera that shows a person in one frame is enough.
    ///
    /// # Errors
    /// The worst that was found. Nothing is wrong where no frame was looked at.
    pub fn check(&self) -> Result<(), NobodyToTrack> {
        if self.cameras.iter().any(|camera| camera.good > 0) {
            return Ok(());
        }
        match worst(self.cameras.iter().filter_map(|camera| camera.bad.as_ref())) {
            Some(worst) => Err(NobodyToTrack { worst: worst.clone(), looked_at: self.frames.len() }),
            None => Ok(()),
        }
    }

    /// What must be said of cameras although others may be tracked, a sentence each: of those that never can be used, and
    /// of those with a silhouette that cannot be right. That nobody is seen in some frames is nothing to be said.
    pub fn doubts(&self) -> impl Iterator<Item = String> {
        let looked_at = self.frames.len();
        self.cameras.iter().filter_map(move |camera| {
            let worst = camera.bad.as_ref()?;
            let bad = looked_at.saturating_sub(camera.good);
            (camera.good == 0 || worst.because != Unusable::Nobody).then(|| match looked_at {
                1 => worst.to_string(),
                all => format!("{worst} (so, or nobody seen, in {bad} of {all} frames)"),
            })
        })
    }

    /// That several people are in view, in words; `None` where it is one, as far as cameras tell people apart.
    #[must_use]
    pub fn several_people(&self) -> Option<String> {
        let people = self.people;
        (people > 1)
            .then(|| format!("{people} people are in view, and one body is fitted to the silhouettes of all"))
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use glam::DVec3;

    use super::*;
    use crate::camera::Distortion;
    use crate::fixtures;

    fn view(name: &str, of: impl Fn(usize, usize) -> Label) -> FitView {
        let (intrinsics, from) = ([50.0, 50.0, 19.5, 29.5], DVec3::new(0.0, -4.0, 1.0));
        let lens = Distortion::None;
        let camera = fixtures::named_camera(name, lens, [40, 60], intrinsics, from, DVec3::Z, DVec3::Z);
        FitView::of_mask(camera, fixtures::painted([40, 60], of))
    }

    fn person(x: usize, y: usize) -> Label {
        if (15..25).contains(&x) && (5..55).contains(&y) { Label::Subject } else { Label::Background }
    }

    fn nobody(_: usize, _: usize) -> Label {
        Label::Background
    }

    /// As a mask that is read the wrong way round.
    fn inverted(x: usize, y: usize) -> Label {
        if person(x, y) == Label::Subject { Label::Background } else { Label::Subject }
    }

    /// What a camera of this name sees, pixel by pixel.
    type Named<'a> = (&'a str, fn(usize, usize) -> Label);

    fn of(cameras: &[Named<'_>]) -> Survey {
        let views = |_| Ok::<_, Infallible>(cameras.iter().map(|(name, of)| view(name, of)).collect());
        survey(&[3, 9], views).unwrap()
    }

    #[test]
    fn frames_are_spread_from_the_first_to_the_last() {
        let frames: Vec<usize> = (10..110).step_by(10).collect();
        assert_eq!(spread(&frames, 5), [10, 30, 50, 70, 100]);
        assert_eq!(spread(&frames[..2], 5), [10, 20]);
        assert_eq!(spread(&frames, 1), [10]);
        assert_eq!(spread(&[], 5), [0; 0]);
    }

    #[test]
    fn a_take_without_anybody_is_refused_by_the_worst_that_is_seen() {
        let refused =
            of(&[("a", nobody), ("b", |_, _| Label::Unknown), ("c", inverted)]).check().unwrap_err();
        let because = Unusable::Unknown { share: 1.0 };
        assert_eq!(refused.worst, LeftOut { frame: 3, camera: "b".to_owned(), because });
        let said = refused.to_string();
        assert!(said.contains("camera \"b\", frame 3: 100 % of the pixels are unknown"), "{said}");
        let refused = of(&[("a", nobody)]).check().unwrap_err();
        assert_eq!(refused.worst.because, Unusable::Nobody);
        assert!(matches!(of(&[("c", inverted)]).check().unwrap_err().worst.because, Unusable::Fills { .. }));
        assert_eq!(of(&[]).check(), Ok(()));
    }

    #[test]
    fn what_is_wrong_with_one_camera_is_said_and_the_others_are_tracked() {
        let found = of(&[("a", person), ("b", inverted), ("c", nobody)]);
        assert_eq!(found.check(), Ok(()));
        let said: Vec<String> = found.doubts().collect();
        let covers = "camera \"b\", frame 3: the subject covers 79 % of the picture";
        assert!(said[0].starts_with(covers), "{said:?}");
        assert!(said[1].starts_with("camera \"c\", frame 3: nobody is seen") && said.len() == 2, "{said:?}");
        // A person who comes later is as it should be, and a camera of no weight does not count.
        let late = |frame| {
            let mut views = vec![view("a", if frame == 3 { nobody } else { person }), view("b", inverted)];
            views[1].weight = 0.0;
            Ok::<_, Infallible>(views)
        };
        let found = survey(&[3, 9], late).unwrap();
        assert_eq!((found.check(), found.doubts().count(), found.cameras.len()), (Ok(()), 0, 1));
    }

    #[test]
    fn silhouettes_that_cannot_be_a_person_say_why() {
        let check = |of: &dyn Fn(usize, usize) -> Label| check_view(&view("a", of));
        assert_eq!(check(&person), Ok(()));
        assert_eq!(check(&|_, _| Label::Background), Err(Unusable::Nobody));
        let black = |x, y| if y < 55 { Label::Unknown } else { person(x, y) };
        assert!(matches!(check(&black), Err(Unusable::Unknown { share }) if share > 0.9));
        let fills = |x, _| if x < 30 { Label::Subject } else { Label::Background };
        assert_eq!(check(&fills), Err(Unusable::Fills { share: 0.75 }));
        // Dark clothes before a dark wall: the subject's outline is nowhere.
        let hidden = |x: usize, y: usize| match person(x, y) {
            Label::Background if (10..30).contains(&x) && y > 2 => Label::Unknown,
            label => label,
        };
        assert!(matches!(check(&hidden), Err(Unusable::Hidden { share }) if share > 0.9));
        let half = |x: usize, y: usize| {
            if x == 25 && person(24, y) == Label::Subject { Label::Unknown } else { person(x, y) }
        };
        assert_eq!(check(&half), Ok(()));
    }
}
