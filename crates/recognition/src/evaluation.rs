//! How often names are right: of whole clips, of seconds, and of the frames of clips that were joined to takes.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DQuat, DVec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use serde::Serialize;

use crate::augment::{TrackerNoise, noisy, unit};
use crate::features::{RATE, body_size};
use crate::joints::{Joint, JointMotion, Joints, MotionError};
use crate::learn::{LearnError, LearnOptions, NamedMotion, Prepared, prepare};
use crate::observed::Observed;
use crate::recognizer::{Method, Recognizer};

/// Parts that were right, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Score {
    /// Of whole clips.
    pub clips: f64,
    /// Of windows of a second, each seen by itself.
    pub windows: f64,
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
    /// Windows of a second.
    pub windows: Vec<Vec<usize>>,
}

/// What a recognizer is worth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// By method.
    pub methods: BTreeMap<&'static str, Score>,
    /// Of the method that names takes, hidden Markov models and support vectors together.
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

    fn part(self) -> f64 {
        self.right as f64 / self.all.max(1) as f64
    }
}

/// Counts while clips go by.
#[derive(Debug, Default)]
struct Tally {
    counts: BTreeMap<Method, [Count; 3]>,
    clips: Vec<Vec<usize>>,
    windows: Vec<Vec<usize>>,
    results: Vec<ClipResult>,
}

/// Seconds of a take that clips are joined to, about.
const JOINED_S: f64 = 40.0;

/// The number of the largest value.
fn largest(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0)
}

impl Tally {
    fn new(class_count: usize) -> Self {
        let zeros = vec![vec![0; class_count]; class_count];
        Self { clips: zeros.clone(), windows: zeros, ..Self::default() }
    }

    /// Names clips, and the takes that they are joined to.
    fn add(
        &mut self,
        recognizer: &Recognizer,
        classes: &[String],
        motions: &[NamedMotion],
    ) -> Result<(), LearnError> {
        let seen: Result<Vec<Observed>, LearnError> = motions.iter().map(observe).collect();
        let seen = seen?;
        let clips: Vec<(&str, &str, &Observed)> =
            motions.iter().zip(&seen).map(|(motion, seen)| (&*motion.name, &*motion.class, seen)).collect();
        self.name(recognizer, classes, &clips);
        self.cut(recognizer, &join_all(&motions.iter().collect::<Vec<_>>())?);
        Ok(())
    }

    /// Names clips and their windows; `classes` are those of the rows and columns.
    fn name(&mut self, recognizer: &Recognizer, classes: &[String], clips: &[(&str, &str, &Observed)]) {
        let number = |name: &str| classes.iter().position(|class| class == name);
        let columns: Vec<Option<usize>> = recognizer.classes.iter().map(|class| number(class)).collect();
        for &(name, class, seen) in clips {
            let truth = number(class);
            for method in recognizer.methods() {
                let shares = recognizer.clip_shares(seen, method);
                let found = largest(&shares);
                let is_combined = method == Method::Combined;
                let counts = self.counts.entry(method).or_default();
                counts[0].add(recognizer.classes[found] == class);
                for start in seen.window_starts() {
                    let window = largest(&recognizer.window_logs(seen, start, method));
                    counts[1].add(recognizer.classes[window] == class);
                    if let (true, Some(row), Some(column)) = (is_combined, truth, columns[window]) {
                        self.windows[row][column] += 1;
                    }
                }
                if let (true, Some(row), Some(column)) = (is_combined, truth, columns[found]) {
                    self.clips[row][column] += 1;
                    self.results.push(ClipResult {
                        name: name.to_owned(),
                        class: class.to_owned(),
                        found: recognizer.classes[found].clone(),
                        confidence: shares[found],
                        unknown: recognizer.is_unknown(seen),
                    });
                }
            }
        }
    }

    /// Names the frames of takes, whose truth is a class a frame.
    fn cut(&mut self, recognizer: &Recognizer, takes: &[(Observed, Vec<String>)]) {
        for (seen, truth) in takes {
            for method in recognizer.methods() {
                let walk = recognizer.network().segment(&recognizer.evidence(seen, method));
                let counts = self.counts.entry(method).or_default();
                for (frame, class) in truth.iter().enumerate() {
                    counts[2].add(recognizer.classes[walk[seen.step_of(frame)]] == *class);
                }
            }
        }
    }

    fn finish(self, classes: Vec<String>) -> Evaluation {
        let methods = self.counts.iter().map(|(method, [clips, windows, joined])| {
            (method.name(), Score { clips: clips.part(), windows: windows.part(), joined: joined.part() })
        });
        let unknown = self.results.iter().filter(|result| result.unknown).count();
        Evaluation {
            methods: methods.collect(),
            unknown: unknown as f64 / self.results.len().max(1) as f64,
            confusion: Confusion { classes, clips: self.clips, windows: self.windows },
            clips: self.results,
        }
    }
}

/// All classes of a recognizer and of motions, in their order.
fn all_classes<'a>(known: &[String], others: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut all: Vec<String> = known.iter().cloned().chain(others.map(str::to_owned)).collect();
    all.sort();
    all.dedup();
    all
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
    let classes = all_classes(&recognizer.classes, motions.iter().map(|motion| &*motion.class));
    let mut tally = Tally::new(classes.len());
    tally.add(recognizer, &classes, &motions)?;
    Ok(tally.finish(classes))
}

fn observe(named: &NamedMotion) -> Result<Observed, LearnError> {
    let fail = |error| LearnError::Motion { name: named.name.clone(), error };
    Observed::new(&named.motion).map_err(fail)
}

/// What is left out of what is learnt from, part after part, to be named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftOut {
    /// Each subject: how often strangers are named rightly.
    Subjects,
    /// Each class: how often an unknown kind of motion is said to be unknown.
    Classes,
}

impl LeftOut {
    fn of(self, subject: &str, class: &str) -> String {
        match self {
            Self::Subjects => subject.to_owned(),
            Self::Classes => class.to_owned(),
        }
    }
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
    let prepared: Result<Vec<Prepared>, LearnError> =
        motions.iter().zip(0..).map(|(named, number)| prepare(named, options, number)).collect();
    let prepared = prepared?;
    let classes = all_classes(&[], motions.iter().map(|motion| &*motion.class));
    let part_of = |motion: &NamedMotion| left_out.of(&motion.subject, &motion.class);
    let parts: BTreeSet<String> = motions.iter().map(part_of).collect();
    let mut tally = Tally::new(classes.len());
    for (done, part) in parts.iter().enumerate() {
        let is_other = |motion: &&Prepared| left_out.of(&motion.subject, &motion.class) != *part;
        let others: Vec<&Prepared> = prepared.iter().filter(is_other).collect();
        let recognizer = Recognizer::learn_prepared(&others, options)?;
        let own: Vec<NamedMotion> = motions
            .iter()
            .zip(0..)
            .filter(|(motion, _)| part_of(motion) == *part)
            .map(|(motion, number)| tracked(motion, noise, number))
            .collect();
        tally.add(&recognizer, &classes, &own)?;
        progress(done + 1, parts.len());
    }
    Ok(tally.finish(classes))
}

/// The motion as a tracker would have found it.
#[must_use]
pub fn tracked(named: &NamedMotion, noise: Option<TrackerNoise>, seed: u64) -> NamedMotion {
    let Some(noise) = noise else { return named.clone() };
    let noise = TrackerNoise { deviation: noise.deviation * body_size(&named.motion), ..noise };
    NamedMotion { motion: noisy(&named.motion, noise, 77 + seed), ..named.clone() }
}

/// Motions in an order that is drawn, joined to takes of about [`JOINED_S`] seconds.
fn join_all(motions: &[&NamedMotion]) -> Result<Vec<(Observed, Vec<String>)>, LearnError> {
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
            let (motion, truth) =
                join(&group).map_err(|error| LearnError::Motion { name: group[0].name.clone(), error })?;
            let named = NamedMotion { motion, ..group[0].clone() };
            takes.push((observe(&named)?, truth));
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
        let first = motion.frames()[0];
        let turn = match frames.last() {
            Some(last) => DQuat::from_rotation_y(heading(last) - heading(&first)),
            None => DQuat::IDENTITY,
        };
        let shift = frames.last().map_or(DVec3::ZERO, |last| {
            (middle(last) - turn * middle(&first) / size) * DVec3::new(1.0, 0.0, 1.0)
        });
        frames.extend(motion.frames().iter().map(|joints| joints.map(|p| turn * p / size + shift)));
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
    use crate::tests::walker;

    #[test]
    fn joined_motions_go_on_where_they_ended() {
        let named = |speed: f64, class: &str| NamedMotion {
            name: class.to_owned(),
            class: class.to_owned(),
            subject: "a".to_owned(),
            motion: walker(1.0, speed),
        };
        let (fast, slow) = (named(2.0, "fast"), named(0.5, "slow"));
        let (motion, truth) = join(&[&fast, &slow, &fast]).unwrap();
        assert_eq!((motion.frames().len(), truth.len()), (90, 90));
        assert_eq!([&truth[29], &truth[30], &truth[60]], ["fast", "slow", "fast"]);
        for pair in motion.frames().windows(2) {
            let step = (middle(&pair[1]) - middle(&pair[0])) * DVec3::new(1.0, 0.0, 1.0);
            assert!(step.length() < 0.1, "{step}");
        }
    }
}
