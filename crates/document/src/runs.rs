//! The runs of the fit, the newest last. They stand beside the document: they are saved with it, and undo does not take
//! their steps back.

use backlit_tracking::body::Pose;
use backlit_tracking::fit::{FitOptions, Stage};

use super::run::{Run, RunEnding, RunStep};
use super::run_names::name_runs;

/// What is said when runs that were removed are there again.
pub const BROUGHT_BACK: &str = "Brought back the runs.";

/// A step of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StepRef {
    /// The run's number.
    pub run: usize,
    /// 0 is the start; n is the state after the n-th iteration.
    pub step: usize,
}

/// All runs that were not removed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Runs {
    /// By number.
    all: Vec<Run>,
    /// The number of the run that was begun last.
    begun: usize,
}

/// What happens to runs, which are named by their numbers.
#[derive(Debug, Clone, PartialEq)]
pub enum RunChange {
    /// A run begins, with the [next number](Runs::next_number).
    Begin(Box<Run>),
    /// It has made a step, or has its start.
    Step(usize, Box<RunStep>),
    /// It has ended, or may go on. One that has not even a start could not begin, and is forgotten.
    End(usize, Option<RunEnding>),
    /// Its curve is shown or hidden.
    Show(usize, bool),
    /// Its curve alone is shown.
    ShowOnly(usize),
    /// It is called so; by an empty name, again by what differs.
    Rename(usize, String),
    /// It is removed.
    Remove(usize),
    /// All are removed.
    Clear,
    /// What was removed last comes back, whatever was done since.
    Restore,
}

/// Whether two poses are the same but for rounding: a fit begins with rotations of unit length.
pub(super) fn is_same(one: &Pose, other: &Pose) -> bool {
    let turns = one.rotations.iter().zip(&other.rotations);
    one.root.distance(other.root) < 1e-9
        && one.rotations.len() == other.rotations.len()
        && turns.into_iter().all(|(one, other)| one.dot(*other).abs() > 1.0 - 1e-12)
}

impl Runs {
    /// Those of a project.
    pub(super) fn of(mut all: Vec<Run>) -> Self {
        name_runs(&mut all);
        Self { begun: all.last().map_or(0, |run| run.number), all }
    }

    /// All of them, by number.
    pub fn all(&self) -> &[Run] {
        &self.all
    }

    /// The number of the run that is begun next.
    pub fn next_number(&self) -> usize {
        self.begun + 1
    }

    /// The run of a number, unless it was removed.
    pub fn get(&self, number: usize) -> Option<&Run> {
        self.all.iter().find(|run| run.number == number)
    }

    /// A step of a run.
    pub fn step(&self, at: StepRef) -> Option<&RunStep> {
        self.get(at.run)?.steps.get(at.step)
    }

    /// The run of a frame that was begun last.
    pub fn newest_of(&self, frame: usize) -> Option<&Run> {
        self.all.iter().rfind(|run| run.frame == frame)
    }

    /// What a run with these choices would be measured by to be comparable with the other runs of its frame, where that is
    /// not its own last stage.
    pub fn measure_beside(&self, frame: usize, fit: &FitOptions) -> Option<Stage> {
        let others = self.newest_of(frame)?.measure()?;
        let is_own = |own: &Stage| own.ramp == others.ramp && own.data == others.data;
        (!fit.stages.last().is_some_and(is_own)).then_some(others)
    }

    /// The first step of a run on a frame that ended at this pose, if it is not that run's start.
    pub fn step_with_pose(&self, frame: usize, pose: &Pose) -> Option<StepRef> {
        let found = |run: &Run| {
            let step = run.steps.iter().position(|step| is_same(&step.iteration.point, pose))?;
            (step > 0).then_some(StepRef { run: run.number, step })
        };
        self.all.iter().filter(|run| run.frame == frame).find_map(found)
    }

    /// The last step of the newest run on a frame that stands at this pose, its start included.
    pub fn last_step_with_pose(&self, frame: usize, pose: &Pose) -> Option<StepRef> {
        self.all.iter().rev().filter(|run| run.frame == frame).find_map(|run| {
            let step = run.steps.iter().rposition(|step| is_same(&step.iteration.point, pose))?;
            Some(StepRef { run: run.number, step })
        })
    }

    /// The first colour that no run has.
    pub fn free_colour(&self) -> usize {
        (0..).find(|colour| self.all.iter().all(|run| run.colour != *colour)).unwrap_or_default()
    }

    /// Makes a change. Whatever it does to other runs, names say again what differs. Says which runs were removed.
    pub(super) fn apply(&mut self, change: RunChange) -> Vec<Run> {
        let mut removed = Vec::new();
        match change {
            RunChange::Begin(run) => {
                self.begun = run.number;
                self.all.push(*run);
            }
            RunChange::Step(number, step) => {
                let Some(run) = self.get_mut(number) else { return removed };
                run.steps.push(*step);
                if run.steps.len() > 1 {
                    // Only its start tells it from other runs.
                    return removed;
                }
            }
            RunChange::End(number, ending) => {
                let Some(run) = self.get_mut(number) else { return removed };
                run.ending = ending;
                if run.steps.is_empty() {
                    self.all.retain(|run| run.number != number);
                }
            }
            RunChange::Show(number, is_shown) => {
                let Some(run) = self.get_mut(number) else { return removed };
                run.is_shown = is_shown;
            }
            RunChange::ShowOnly(number) => {
                self.all.iter_mut().for_each(|run| run.is_shown = run.number == number);
            }
            RunChange::Rename(number, name) => {
                let Some(run) = self.get_mut(number) else { return removed };
                let name = name.trim();
                (run.is_named, run.name) = (!name.is_empty(), name.to_owned());
            }
            RunChange::Remove(number) => {
                removed = self.all.extract_if(.., |run| run.number == number).collect();
            }
            RunChange::Clear => removed = std::mem::take(&mut self.all),
            RunChange::Restore => {}
        }
        name_runs(&mut self.all);
        removed
    }

    /// Brings runs back to their places. What was interrupted cannot go on.
    pub(super) fn bring_back(&mut self, removed: Vec<Run>) {
        self.all.extend(removed.into_iter().map(|run| {
            let ending = run.ending.clone().or(Some(RunEnding::Stopped));
            Run { ending, ..run }
        }));
        self.all.sort_by_key(|run| run.number);
        name_runs(&mut self.all);
    }

    fn get_mut(&mut self, number: usize) -> Option<&mut Run> {
        self.all.iter_mut().find(|run| run.number == number)
    }
}
