//! What a take holds: a class a frame, stretches, places on the plane.

use crate::features::{RATE, median};
use crate::joints::{JointMotion, MotionError};
use crate::observed::{Observed, SHORT, STEP};
use crate::recognizer::{Method, Recognizer};

/// What a frame is.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameName {
    /// The frame's number in the motion that was given.
    pub frame: usize,
    /// Number of the class; `None` where the motion is nothing known.
    pub class: Option<usize>,
    /// Probability of that class, or of the likeliest where the motion is unknown, 0 to 1.
    pub confidence: f64,
    /// Probability of each class, given the whole motion.
    pub shares: Vec<f64>,
    /// Place on the plane of the first two principal components.
    pub place: [f64; 2],
    /// Place on the plane of the first two axes that tell short windows of the classes apart.
    pub apart: [f64; 2],
}

/// Frames of one class that follow each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Number of the class; `None` where the motion is nothing known.
    pub class: Option<usize>,
    /// Its first and last frame.
    pub frames: std::ops::RangeInclusive<usize>,
    /// When it begins and ends, seconds after frame 0.
    pub seconds: [f64; 2],
    /// Mean of its frames' confidence.
    pub confidence: f64,
}

/// What a take holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Recognition {
    /// The classes' names, by number.
    pub classes: Vec<String>,
    /// A name a frame, in their order without gaps.
    pub frames: Vec<FrameName>,
    /// The take, cut where its motion changes.
    pub stretches: Vec<Stretch>,
}

/// A moment is unknown where the windows about it are, so far before and after it, seconds: a strange window alone makes nothing unknown.
const ABOUT_S: f64 = 1.5;
/// What is less likely than that has no name: all other motions together are likelier.
const LEAST_SURE: f64 = 0.5;

impl Recognizer {
    /// Names each frame of a motion and cuts it into stretches, by [`Method::Combined`].
    ///
    /// # Errors
    /// The joints do not lie as a person's.
    pub fn recognise(&self, motion: &JointMotion) -> Result<Recognition, MotionError> {
        self.recognise_by(motion, Method::Combined)
    }

    /// The same by one of [`Self::methods`].
    ///
    /// # Errors
    /// The joints do not lie as a person's.
    pub fn recognise_by(&self, motion: &JointMotion, method: Method) -> Result<Recognition, MotionError> {
        let seen = Observed::new(motion)?;
        let (names, beliefs) = self.names(&seen, method);
        let unknown = self.unknown_steps(&seen);
        let places: Vec<[f64; 2]> =
            seen.frames().iter().map(|row| first_two(&self.plane.project(row))).collect();
        let apart: Vec<[f64; 2]> = seen.short.iter().map(|row| first_two(&self.short.project(row))).collect();
        let frames = (0..motion.frames.len()).map(|index| {
            let at = (index as f64 * RATE / motion.frame_rate) as usize;
            let at = at.min(seen.length - 1);
            let step = seen.step_of(at);
            let class = names[step];
            FrameName {
                frame: motion.first_frame + index,
                class: (!unknown[step] && beliefs[step][class] >= LEAST_SURE).then_some(class),
                confidence: beliefs[step][class],
                shares: beliefs[step].clone(),
                place: places[at],
                apart: between(&apart, (at as f64 - SHORT as f64 / 2.0) / STEP as f64),
            }
        });
        let frames: Vec<FrameName> = frames.collect();
        Ok(Recognition {
            stretches: stretches(&frames, motion.frame_rate),
            classes: self.classes.clone(),
            frames,
        })
    }

    /// Of each short window, whether what happens about it is nothing known.
    fn unknown_steps(&self, seen: &Observed) -> Vec<bool> {
        let strangeness = |step: usize| self.strangeness(seen, seen.window_about(step));
        let all: Vec<f64> = (0..seen.short.len()).map(strangeness).collect();
        medians_about(&all, (ABOUT_S * RATE / STEP as f64) as usize)
            .into_iter()
            .map(|median| median > 1.0)
            .collect()
    }

    /// How strange a motion is as a whole, the middle one of its windows; beyond 1 it is nothing known.
    #[must_use]
    pub fn clip_strangeness(&self, seen: &Observed) -> f64 {
        median(seen.window_starts().into_iter().map(|start| self.strangeness(seen, start)).collect())
    }
}

/// Of each number the middle one of it and this many before and after it.
fn medians_about(values: &[f64], reach: usize) -> Vec<f64> {
    let about = |index: usize| &values[index.saturating_sub(reach)..(index + reach + 1).min(values.len())];
    (0..values.len()).map(|index| median(about(index).to_vec())).collect()
}

/// The first two coordinates; a model of two classes has one axis only.
fn first_two(place: &[f64]) -> [f64; 2] {
    [0, 1].map(|axis| place.get(axis).copied().unwrap_or(0.0))
}

/// A place between two that follow each other; the ends hold beyond.
fn between(places: &[[f64; 2]], at: f64) -> [f64; 2] {
    let at = at.clamp(0.0, (places.len() - 1) as f64);
    let (before, share) = (at as usize, at.fract());
    let after = (before + 1).min(places.len() - 1);
    [0, 1].map(|axis| places[before][axis] + share * (places[after][axis] - places[before][axis]))
}

fn stretches(frames: &[FrameName], frame_rate: f64) -> Vec<Stretch> {
    frames
        .chunk_by(|a, b| a.class == b.class)
        .filter_map(|chunk| {
            let (first, last) = (chunk.first()?, chunk.last()?);
            Some(Stretch {
                class: first.class,
                frames: first.frame..=last.frame,
                seconds: [first.frame as f64 / frame_rate, (last.frame + 1) as f64 / frame_rate],
                confidence: chunk.iter().map(|frame| frame.confidence).sum::<f64>() / chunk.len() as f64,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_cut_where_the_class_changes() {
        let classes = [Some(1), Some(1), None, Some(0), Some(0)];
        let frames: Vec<FrameName> = (7..)
            .zip(classes)
            .map(|(frame, class)| FrameName {
                frame,
                class,
                confidence: 0.5,
                shares: vec![0.5; 2],
                place: [0.0; 2],
                apart: [0.0; 2],
            })
            .collect();
        let found = stretches(&frames, 10.0);
        let spans: Vec<_> = found.iter().map(|s| (s.class, s.frames.clone(), s.seconds)).collect();
        assert_eq!(
            spans,
            [(Some(1), 7..=8, [0.7, 0.9]), (None, 9..=9, [0.9, 1.0]), (Some(0), 10..=11, [1.0, 1.2])]
        );
    }

    #[test]
    fn every_method_names_frames_whose_places_follow_each_other() {
        let (motions, learnt) = (crate::tests::standing_and_walking(), crate::tests::learnt());
        for method in Method::ALL {
            for named in &motions {
                let found = learnt.recognise_by(&named.motion, method).unwrap();
                let most = |frame: &FrameName| {
                    let top = (0..2).max_by(|&a, &b| frame.shares[a].total_cmp(&frame.shares[b]));
                    &found.classes[top.unwrap()]
                };
                assert_eq!(most(&found.frames[22]), &named.class, "{}, {}", method.name(), named.name);
                for pair in found.frames.windows(2) {
                    assert!((pair[0].shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
                    assert!((pair[0].apart[0] - pair[1].apart[0]).abs() < 2.0, "{}", named.name);
                    assert_eq!(pair[0].apart[1], 0.0, "two classes have one axis");
                }
            }
        }
        let whole = learnt.recognise(&motions[2].motion).unwrap();
        assert_eq!(whole, learnt.recognise_by(&motions[2].motion, Method::Combined).unwrap());
    }

    #[test]
    fn what_is_strange_for_a_moment_is_not_unknown() {
        let values = [0.5, 3.0, 0.5, 0.5, 2.0, 2.0, 2.0, 2.0];
        assert_eq!(medians_about(&values, 1), [1.75, 0.5, 0.5, 0.5, 2.0, 2.0, 2.0, 2.0]);
        assert_eq!(medians_about(&values, 100), [2.0; 8]);
    }

    #[test]
    fn places_lie_on_the_way_between_two() {
        let places = [[0.0, 1.0], [2.0, 5.0], [4.0, 5.0]];
        assert_eq!(
            [-3.0, 0.25, 1.0, 9.0].map(|at| between(&places, at)),
            [[0.0, 1.0], [0.5, 2.0], [2.0, 5.0], [4.0, 5.0]]
        );
    }
}
