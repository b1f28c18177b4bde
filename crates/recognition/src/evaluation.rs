//! How often names are right: of whole clips, of windows, and of the frames of clips that were joined to takes.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use crate::augment::{TrackerNoise, noisy, unit};
use crate::features::{RATE, body_size};
use crate::joints::{Joint, JointMotion, Joints, MotionError};
use crate::learn::{LearnError, NamedMotion, distinct};
use crate::observed::{Observed, WINDOW};
use crate::recognizer::{Method, Recognizer, largest};

mod left_out;

pub use left_out::{Fold, LEAST_KEPT, LeftOut, leave_out};

/// Parts that were right, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Score {
    /// Of whole clips.
    pub clips: f64,
    /// Of windows of two seconds, each seen by itself.
    pub windows: f64,
    /// Of the same windows, each named given the whole clip that it is a part of.
    pub in_context: f64,
    /// Of the frames of clips that were joined to long takes.
    pub joined: f64,
}

/// How often each class was called what: rows are what it was, columns what it was called.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confusion {
    /// The classes' names, of rows and columns.
    pub classes: Vec<String>,
    /// Clips.
    pub clips: Vec<Vec<usize>>,
    /// Windows of two seconds.
    pub windows: Vec<Vec<usize>>,
}

/// What a recognizer is worth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// By method.
    pub methods: BTreeMap<&'static str, Score>,
    /// How far clips, windows and windows in context of the method that names takes would spread with other people of the same kind: deviations
    /// where people are drawn again, again and again (bootstrap).
    pub spread: [f64; 3],
    /// Of the method that names takes, [`Method::Combined`].
    pub confusion: Confusion,
    /// The part of the clips that was said to be unknown, whose classes are known.
    pub unknown: f64,
    /// Clips and what each was called, in their order.
    pub clips: Vec<ClipResult>,
}

/// One clip.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClipResult {
    /// The clip's name.
    pub name: String,
    /// What it is.
    pub class: String,
    /// What it was called, and how likely that was.
    pub found: String,
    /// The probability of that.
    pub confidence: f64,
    /// Whether it was said to be unknown.
    pub unknown: bool,
    /// How strange it is; beyond 1 it is unknown.
    pub strangeness: f64,
}

/// Right and all.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    right: usize,
    all: usize,
}

impl Count {
    fn add(&mut self, is_right: bool) {
        self.right += usize::from(is_right);
        self.all += 1;
    }

    fn join(&mut self, other: Self) {
        self.right += other.right;
        self.all += other.all;
    }

    fn part(self) -> f64 {
        self.right as f64 / self.all.max(1) as f64
    }
}

/// Counts while clips go by.
#[derive(Debug)]
struct Tally {
    /// Clips, windows, frames of joined clips, windows in context.
    counts: BTreeMap<Method, [Count; 4]>,
    /// The same of the method that names takes, by person.
    people: BTreeMap<String, [Count; 4]>,
    confusion: Confusion,
    results: Vec<ClipResult>,
}

/// Seconds of a take that clips are joined to, about.
pub const JOINED_S: f64 = 40.0;
/// How often people are drawn again.
const DRAWS: usize = 1000;

impl Tally {
    fn new(classes: Vec<String>) -> Self {
        let zeros = vec![vec![0; classes.len()]; classes.len()];
        let confusion = Confusion { classes, clips: zeros.clone(), windows: zeros };
        Self { counts: BTreeMap::new(), people: BTreeMap::new(), confusion, results: Vec::new() }
    }

    /// Names clips, and the takes that they are joined to.
    fn add(&mut self, recognizer: &Recognizer, motions: &[NamedMotion]) -> Result<(), LearnError> {
        let seen = motions.iter().map(observe).collect::<Result<Vec<Observed>, LearnError>>()?;
        for (motion, seen) in motions.iter().zip(&seen) {
            self.name(recognizer, motion, seen);
        }
        for (take, truth) in joined(&motions.iter().collect::<Vec<_>>())? {
            self.cut(recognizer, &observe(&take)?, &truth);
        }
        Ok(())
    }

    /// Names a clip and its windows.
    fn name(&mut self, recognizer: &Recognizer, motion: &NamedMotion, seen: &Observed) {
        let Confusion { classes, clips, windows } = &mut self.confusion;
        let number = |name: &str| classes.iter().position(|class| class == name);
        let column = |found: usize| number(&recognizer.classes[found]);
        let truth = number(&motion.class);
        let is_right = |found: usize| recognizer.classes[found] == motion.class;
        for method in recognizer.methods() {
            let shares = recognizer.clip_shares(seen, method);
            let (_, beliefs) = recognizer.names(seen, method);
            let found = largest(&shares);
            let is_combined = method == Method::Combined;
            let mut own = [Count::default(); 4];
            own[0].add(is_right(found));
            for start in seen.window_starts() {
                let window = largest(&recognizer.window_logs(seen, start, method));
                own[1].add(is_right(window));
                own[3].add(is_right(largest(&beliefs[seen.step_of(start + WINDOW / 2)])));
                if let (true, Some(row), Some(column)) = (is_combined, truth, column(window)) {
                    windows[row][column] += 1;
                }
            }
            let all = self.counts.entry(method).or_default();
            all.iter_mut().zip(own).for_each(|(all, own)| all.join(own));
            if !is_combined {
                continue;
            }
            let person = self.people.entry(motion.subject.clone()).or_default();
            person.iter_mut().zip(own).for_each(|(all, own)| all.join(own));
            if let (Some(row), Some(column)) = (truth, column(found)) {
                clips[row][column] += 1;
            }
            let strangeness = recognizer.clip_strangeness(seen);
            self.results.push(ClipResult {
                name: motion.name.clone(),
                class: motion.class.clone(),
                found: recognizer.classes[found].clone(),
                confidence: shares[found],
                unknown: strangeness > 1.0,
                strangeness,
            });
        }
    }

    /// Names the frames of a take, whose truth is a class a frame.
    fn cut(&mut self, recognizer: &Recognizer, seen: &Observed, truth: &[String]) {
        for method in recognizer.methods() {
            let (names, _) = recognizer.names(seen, method);
            let counts = self.counts.entry(method).or_default();
            for (frame, class) in truth.iter().enumerate() {
                counts[2].add(recognizer.classes[names[seen.step_of(frame)]] == *class);
            }
        }
    }

    /// Deviations of clips, windows and windows in context where people are drawn again.
    fn spread(&self) -> [f64; 3] {
        let people: Vec<&[Count; 4]> = self.people.values().collect();
        let mut random = Pcg64Mcg::seed_from_u64(11);
        let mut drawn: [Vec<f64>; 3] = std::array::from_fn(|_| Vec::with_capacity(DRAWS));
        for _ in 0..DRAWS {
            let mut sum = [Count::default(); 4];
            for _ in 0..people.len() {
                let person = people[(unit(&mut random) * people.len() as f64) as usize];
                sum.iter_mut().zip(person).for_each(|(sum, own)| sum.join(*own));
            }
            for (drawn, at) in drawn.iter_mut().zip([0, 1, 3]) {
                drawn.push(sum[at].part());
            }
        }
        drawn.map(|parts| {
            let mean = parts.iter().sum::<f64>() / parts.len() as f64;
            (parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / parts.len() as f64).sqrt()
        })
    }

    fn finish(self) -> Evaluation {
        let methods = self.counts.iter().map(|(method, counts)| {
            let [clips, windows, joined, in_context] = counts.map(Count::part);
            (method.name(), Score { clips, windows, in_context, joined })
        });
        let unknown = self.results.iter().filter(|result| result.unknown).count();
        Evaluation {
            methods: methods.collect(),
            spread: self.spread(),
            unknown: unknown as f64 / self.results.len().max(1) as f64,
            confusion: self.confusion,
            clips: self.results,
        }
    }
}

/// Names motions that a recognizer may or may not know, as they are or as a tracker would have found them; the noise's deviation is in metres of an adult.
///
/// # Errors
/// Joints that do not lie as a person's.
pub fn evaluate(
    recognizer: &Recognizer,
    motions: &[NamedMotion],
    noise: Option<TrackerNoise>,
) -> Result<Evaluation, LearnError> {
    let motions: Vec<NamedMotion> =
        motions.iter().zip(0..).map(|(motion, number)| tracked(motion, noise, number)).collect();
    let classes = distinct(recognizer.classes.iter().chain(motions.iter().map(|motion| &motion.class)));
    let mut tally = Tally::new(classes);
    tally.add(recognizer, &motions)?;
    Ok(tally.finish())
}

fn observe(named: &NamedMotion) -> Result<Observed, LearnError> {
    Observed::new(&named.motion).map_err(LearnError::of(named))
}

/// The motion as a tracker would have found it.
#[must_use]
pub fn tracked(named: &NamedMotion, noise: Option<TrackerNoise>, seed: u64) -> NamedMotion {
    let Some(noise) = noise else { return named.clone() };
    let noise = TrackerNoise { deviation: noise.deviation * body_size(&named.motion), ..noise };
    NamedMotion { motion: noisy(&named.motion, noise, 77 + seed), ..named.clone() }
}

/// Motions in an order that is drawn, joined to takes of about [`JOINED_S`] seconds at [`RATE`], each with the class of
/// every frame. A take has the name, and otherwise the class and the subject, of its first motion.
///
/// # Errors
/// Nothing is left of a motion at that rate.
pub fn joined(motions: &[&NamedMotion]) -> Result<Vec<(NamedMotion, Vec<String>)>, LearnError> {
    let mut order: Vec<usize> = (0..motions.len()).collect();
    let mut random = Pcg64Mcg::seed_from_u64(3);
    for index in (1..order.len()).rev() {
        order.swap(index, (unit(&mut random) * (index + 1) as f64) as usize);
    }
    let mut takes = Vec::new();
    let mut group: Vec<&NamedMotion> = Vec::new();
    let mut length = 0.0;
    for (place, &index) in order.iter().enumerate() {
        group.push(motions[index]);
        length += motions[index].motion.seconds();
        if length >= JOINED_S || place + 1 == order.len() {
            let (motion, truth) = join(&group).map_err(LearnError::of(group[0]))?;
            takes.push((NamedMotion { motion, ..group[0].clone() }, truth));
            group.clear();
            length = 0.0;
        }
    }
    Ok(takes)
}

/// Motions one after the other, each turned and moved to where the one before it ended, of one size; and the class of each frame.
pub(crate) fn join(motions: &[&NamedMotion]) -> Result<(JointMotion, Vec<String>), MotionError> {
    let mut frames: Vec<Joints> = Vec::new();
    let mut truth = Vec::new();
    for named in motions {
        let motion = named.motion.resampled(RATE);
        let size = body_size(&motion);
        let first = motion.frames[0];
        let turn = match frames.last() {
            Some(last) => DQuat::from_rotation_y(heading(last) - heading(&first)),
            None => DQuat::IDENTITY,
        };
        let shift = frames.last().map_or(DVec3::ZERO, |last| {
            (middle(last) - turn * middle(&first) / size) * DVec3::new(1.0, 0.0, 1.0)
        });
        frames.extend(motion.frames.iter().map(|joints| joints.map(|p| turn * p / size + shift)));
        truth.resize(frames.len(), named.class.clone());
    }
    Ok((JointMotion::new(RATE, 0, frames)?, truth))
}

fn middle(joints: &Joints) -> DVec3 {
    joints[Joint::LeftHip as usize].midpoint(joints[Joint::RightHip as usize])
}

/// Angle of the hips about the vertical.
fn heading(joints: &Joints) -> f64 {
    let across = joints[Joint::LeftHip as usize] - joints[Joint::RightHip as usize];
    (-across.z).atan2(across.x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::named;

    #[test]
    fn joined_motions_go_on_where_they_ended() {
        let (fast, slow) = (named("", "fast", "a", 1.0, 2.0), named("", "slow", "a", 1.0, 0.5));
        let (motion, truth) = join(&[&fast, &slow, &fast]).unwrap();
        assert_eq!((motion.frames.len(), truth.len()), (90, 90));
        assert_eq!([&truth[29], &truth[30], &truth[60]], ["fast", "slow", "fast"]);
        for pair in motion.frames.windows(2) {
            let step = (middle(&pair[1]) - middle(&pair[0])) * DVec3::new(1.0, 0.0, 1.0);
            assert!(step.length() < 0.1, "{step}");
        }
    }
}
