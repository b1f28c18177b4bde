//! A run of the fit with all its steps, rejected ones too.

use backlit_tracking::body::Pose;

/// One step of a run. The first is the start.
#[derive(Debug, Clone, PartialEq)]
pub struct RunStep {
    /// The pose after the step; of a rejected step, the pose before it.
    pub pose: Pose,
    /// Mismatch by one measure for all steps and runs, squared grey levels: the plot's height.
    pub mismatch: f64,
    /// The cost that the solver lowered, in its own stage.
    pub cost: f64,
    /// The cost that a rejected step would have had.
    pub trial_cost: f64,
    /// How far the linear model said that the cost would fall.
    pub foretold: f64,
    /// How far it fell.
    pub fell: f64,
    /// The damping.
    pub damping: f64,
    /// Time of the solver's step, in seconds.
    pub seconds: f64,
    /// Stage of the annealing.
    pub stage: usize,
    /// Whether the pose moved.
    pub accepted: bool,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RunEnding {
    /// The solver's own words.
    Solver(String),
    /// The user stopped it; it may go on.
    Stopped,
}

/// A run of the fit on one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// What distinguishes it: the preset or the method.
    pub name: String,
    /// Renderer, ramp and what else differs.
    pub detail: String,
    /// The frame.
    pub frame: usize,
    /// Index of its colour and dash.
    pub colour: usize,
    /// The start, then every step.
    pub steps: Vec<RunStep>,
    /// Words for the stages of the annealing.
    pub stages: Vec<String>,
    /// How it ended, once it has.
    pub ending: Option<RunEnding>,
    /// Whether its curve is drawn.
    pub is_shown: bool,
}

impl Run {
    /// Number of accepted steps among the first `step` ones: the place in the plot.
    #[must_use]
    pub fn accepted_until(&self, step: usize) -> usize {
        self.steps.iter().take(step + 1).skip(1).filter(|step| step.accepted).count()
    }

    /// The mismatch after a step, as a fraction of the start's.
    #[must_use]
    pub fn fraction(&self, step: usize) -> Option<f64> {
        let start = self.steps.first()?.mismatch;
        let here = self.steps.get(step)?.mismatch;
        (start > 0.0).then(|| here / start)
    }

    /// How it ended, in a sentence without its full stop.
    #[must_use]
    pub fn ending_text(&self) -> String {
        match &self.ending {
            None => format!("{} steps so far", self.steps.len().saturating_sub(1)),
            Some(RunEnding::Solver(words)) => format!("Stopped: {words}"),
            Some(RunEnding::Stopped) => "Stopped by you".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn step(mismatch: f64, accepted: bool) -> RunStep {
        RunStep {
            pose: Pose { root: DVec3::ZERO, rotations: Vec::new() },
            mismatch,
            cost: mismatch,
            trial_cost: mismatch,
            foretold: 0.0,
            fell: 0.0,
            damping: 0.0,
            seconds: 0.0,
            stage: 0,
            accepted,
        }
    }

    #[test]
    fn rejected_steps_take_no_place_in_the_plot() {
        let run = Run {
            name: String::new(),
            detail: String::new(),
            frame: 0,
            colour: 0,
            steps: vec![step(8.0, true), step(4.0, true), step(4.0, false), step(2.0, true)],
            stages: Vec::new(),
            ending: None,
            is_shown: true,
        };
        let places: Vec<usize> = (0..4).map(|step| run.accepted_until(step)).collect();
        assert_eq!(places, [0, 1, 1, 2]);
        assert_eq!((run.fraction(3), run.fraction(4)), (Some(0.25), None));
    }
}
