//! Motions named by what was learnt from others.

use std::collections::BTreeMap;

use super::{Evaluation, Tally, tracked};
use crate::augment::TrackerNoise;
use crate::learn::{LearnError, LearnOptions, NamedMotion, Prepared, distinct, prepare_all};
use crate::recognizer::Recognizer;

/// What is left out of what is learnt from, part after part, to be named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftOut {
    /// Each subject: how often strangers are named rightly.
    Subjects,
    /// Each subject, except for classes that would keep fewer than [`LEAST_KEPT`] motions: of these only the recording that is named is
    /// left out. So no class is unknown only because one person recorded most of it.
    SubjectsKeepingClasses,
    /// Each class, and who is named: how often an unknown kind of motion of a stranger is said to be unknown.
    Classes,
}

/// Motions that a class is to keep.
pub const LEAST_KEPT: usize = 4;

/// Motions that are named together by what is learnt from others: their numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fold {
    /// Those that are named.
    pub named: Vec<usize>,
    /// Those that are learnt from.
    pub learnt: Vec<usize>,
}

/// What is left out for motions that are named together: a class, a recording, a subject.
type Part<'a> = [Option<&'a str>; 3];

/// The recording that a motion was cut from: its name without what comes after the last point and without one small letter at the end.
fn recording(name: &str) -> &str {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let before = stem.strip_suffix(|c: char| c.is_ascii_lowercase());
    before.filter(|before| before.ends_with(|c: char| c.is_ascii_digit())).unwrap_or(stem)
}

impl LeftOut {
    /// What is named by what: each motion is named once.
    #[must_use]
    pub fn folds(self, motions: &[NamedMotion]) -> Vec<Fold> {
        let mut parts: BTreeMap<Part<'_>, Vec<usize>> = BTreeMap::new();
        for (number, motion) in motions.iter().enumerate() {
            parts.entry(self.part(motion, motions)).or_default().push(number);
        }
        let fold = |(part, named): (Part<'_>, Vec<usize>)| Fold {
            learnt: (0..motions.len()).filter(|&number| keeps(part, &motions[number])).collect(),
            named,
        };
        parts.into_iter().map(fold).collect()
    }

    /// The part that a motion is named with.
    fn part<'a>(self, named: &'a NamedMotion, all: &[NamedMotion]) -> Part<'a> {
        let kept = || {
            let stays = |other: &&NamedMotion| other.class == named.class && other.subject != named.subject;
            all.iter().filter(stays).count()
        };
        let (class, subject) = (Some(&*named.class), Some(&*named.subject));
        match self {
            Self::SubjectsKeepingClasses if kept() < LEAST_KEPT => [None, Some(recording(&named.name)), None],
            Self::Subjects | Self::SubjectsKeepingClasses => [None, None, subject],
            Self::Classes => [class, None, subject],
        }
    }
}

/// Whether a motion may be learnt from where a part is named.
fn keeps(part: Part<'_>, motion: &NamedMotion) -> bool {
    let own = [&*motion.class, recording(&motion.name), &*motion.subject];
    own.into_iter().zip(part).all(|(own, left_out)| left_out != Some(own))
}

/// Names each part's motions by what was learnt from all others'. With `noise`, in metres of an adult, the motions that are named are
/// as a tracker would have found them.
///
/// # Errors
/// Two classes at least must be left without any one part; joints that do not lie as a person's.
pub fn leave_out(
    left_out: LeftOut,
    motions: &[NamedMotion],
    options: &LearnOptions,
    noise: Option<TrackerNoise>,
    mut progress: impl FnMut(usize, usize),
) -> Result<Evaluation, LearnError> {
    let prepared = prepare_all(motions, options)?;
    let folds = left_out.folds(motions);
    let mut tally = Tally::new(distinct(motions.iter().map(|motion| &motion.class)));
    for (done, fold) in folds.iter().enumerate() {
        let others: Vec<&Prepared<'_>> = fold.learnt.iter().map(|&number| &prepared[number]).collect();
        let recognizer = Recognizer::learn_prepared(&others, options)?;
        let own = fold.named.iter().map(|&number| tracked(&motions[number], noise, number as u64));
        tally.add(&recognizer, &own.collect::<Vec<_>>())?;
        progress(done + 1, folds.len());
    }
    Ok(tally.finish())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests;

    #[test]
    fn a_recording_is_a_name_without_its_clip() {
        let names = ["14_02a.bvh", "14_02.bvh", "walk.bvh", "take 3b", "x/y.1.bvh"];
        assert_eq!(names.map(recording), ["14_02", "14_02", "walk", "take 3", "x/y.1"]);
    }

    #[test]
    fn a_class_that_others_have_recorded_is_left_out_whole_and_others_by_recording() {
        let named = |name: &str, class: &str, subject: &str| tests::named(name, class, subject, 1.0, 1.0);
        let mut all: Vec<NamedMotion> = (0..4).map(|i| named(&format!("b{i}"), "walk", "b")).collect();
        all.extend([named("a1a", "walk", "a"), named("a2a", "box", "a"), named("a2b", "box", "a")]);
        let part = |left_out: LeftOut, index: usize| left_out.part(&all[index], &all);
        let kept = LeftOut::SubjectsKeepingClasses;
        assert_eq!(part(kept, 4), [None, None, Some("a")]);
        assert_eq!(part(kept, 5), [None, Some("a2"), None]);
        assert_eq!(part(kept, 5), part(kept, 6));
        assert_eq!(part(LeftOut::Subjects, 5), [None, None, Some("a")]);
        let kept_by = |part: Part<'_>| all.iter().filter(|motion| keeps(part, motion)).count();
        assert_eq!([part(kept, 4), part(kept, 5), part(LeftOut::Classes, 5)].map(kept_by), [4, 5, 4]);
        let folds = [kept, LeftOut::Subjects].map(|left_out| left_out.folds(&all));
        let fold =
            |named: &[usize], learnt: &[usize]| Fold { named: named.to_vec(), learnt: learnt.to_vec() };
        let others = fold(&[0, 1, 2, 3], &[4, 5, 6]);
        assert_eq!(folds[1], [fold(&[4, 5, 6], &[0, 1, 2, 3]), others]);
    }
}
