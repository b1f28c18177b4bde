//! Silhouettes of a few frames, looked at before a take is tracked: can they be a person's at all?
//!
//! With a black plate nearly all pixels are unknown, with a wrong one the subject fills the picture, and an inverted mask shows
//! all but the person. A fit of such evidence ends somewhere and overlaps well; so it is looked at by itself, beforehand.

use super::usable::{LeftOut, Unusable, check_view, worst};
use crate::fit::FitView;

/// Frames that are looked at: the first, the last, and some between.
pub const LOOKED_AT: usize = 5;

/// At most this many of some frames, spread from the first to the last.
pub fn spread(frames: &[usize], most: usize) -> Vec<usize> {
    let wanted = most.min(frames.len());
    (0..wanted).map(|k| frames[k * (frames.len() - 1) / (wanted - 1).max(1)]).collect()
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

impl CameraSurvey {
    /// Whether it never can be used.
    pub fn is_useless(&self) -> bool {
        self.good == 0
    }
}

/// What the silhouettes of a few frames say about a take.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The frames.
    pub frames: Vec<usize>,
    /// By camera, in the order in which they were first seen.
    pub cameras: Vec<CameraSurvey>,
}

/// Why a take cannot be tracked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
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
    for &frame in frames {
        for view in views(frame)?.iter().filter(|view| view.weight > 0.0) {
            let name = view.camera.name();
            let index = cameras.iter().position(|one| one.camera == name).unwrap_or_else(|| {
                cameras.push(CameraSurvey { camera: name.to_owned(), good: 0, bad: None });
                cameras.len() - 1
            });
            cameras[index].add(frame, check_view(view));
        }
    }
    Ok(Survey { frames: frames.to_vec(), cameras })
}

impl CameraSurvey {
    fn add(&mut self, frame: usize, found: Result<(), Unusable>) {
        let Err(because) = found else {
            self.good += 1;
            return;
        };
        let is_worse = |known: &LeftOut| known.because == Unusable::Nobody && because != Unusable::Nobody;
        if self.bad.as_ref().is_none_or(is_worse) {
            self.bad = Some(LeftOut { frame, camera: self.camera.clone(), because });
        }
    }
}

impl Survey {
    /// Whether there is anything to track: one camera that shows a person in one frame is enough.
    ///
    /// # Errors
    /// The worst that was found. Nothing is wrong where no frame was looked at.
    pub fn check(&self) -> Result<(), NobodyToTrack> {
        if self.cameras.iter().any(|camera| !camera.is_useless()) {
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
            (camera.is_useless() || worst.because != Unusable::Nobody).then(|| match looked_at {
                1 => worst.to_string(),
                all => format!("{worst} (so, or nobody seen, in {bad} of {all} frames)"),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use glam::DVec3;

    use super::*;
    use crate::camera::Distortion;
    use crate::fixtures;
    use crate::silhouette::{Label, Mask};

    fn view(name: &str, of: impl Fn(usize, usize) -> Label) -> FitView {
        let (intrinsics, from) = ([50.0, 50.0, 19.5, 29.5], DVec3::new(0.0, -4.0, 1.0));
        let lens = Distortion::None;
        let camera = fixtures::named_camera(name, lens, [40, 60], intrinsics, from, DVec3::Z, DVec3::Z);
        let labels = (0..40 * 60).map(|at| of(at % 40, at / 40)).collect();
        FitView::of_mask(camera, Mask::new(40, 60, labels).unwrap())
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
        assert!(
            said[0].starts_with("camera \"b\", frame 3: the subject covers 79 % of the picture"),
            "{said:?}"
        );
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
}
