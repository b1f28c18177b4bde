//! The curves of one comparison, and the step that is looked at: one step for all of them.

use std::fmt::Write as _;
use std::sync::Arc;

use backlit_document::run::{RunEnding, RunStep};
use backlit_plot::{Axis, Figure, Line};
use backlit_tracking::body::Pose;
use backlit_ui::style::format;

use super::{Checked, Entrant, PushAxis, Pushed};
use crate::session::prediction::{FitInputs, Predicted};
use crate::session::{Extent, union};

/// What a comparison is made of. If it changes the comparison begins again.
#[derive(Debug, Clone)]
pub struct Basis {
    /// The frame's data; its fit is not looked at.
    pub(crate) scene: FitInputs,
    pub(crate) start: Pose,
    pub(crate) entrants: Vec<Entrant>,
}

impl Basis {
    /// Whether both make the same comparison.
    pub(crate) fn is(&self, other: &Self) -> bool {
        let same_scene = FitInputs { fit: other.scene.fit.clone(), ..self.scene.clone() }.is(&other.scene);
        same_scene && self.start == other.start && self.entrants == other.entrants
    }

    /// The scene as one of the fits sees it.
    pub(crate) fn scene_of(&self, entrant: &Entrant) -> FitInputs {
        FitInputs { fit: Arc::new(entrant.fit.clone()), ..self.scene.clone() }
    }
}

/// The least height on the logarithmic axis, percent of the start.
pub(crate) const LEAST_PERCENT: f64 = 0.01;
/// A fit has arrived below this share of its start, percent.
pub(crate) const ARRIVED_PERCENT: f64 = 5.0;

/// A share of the start with as many figures as can be read at a glance.
pub(crate) fn percent_text(percent: f64) -> String {
    let decimals = match percent.abs() {
        value if value >= 0.95 => 1,
        value if value >= 0.095 => 2,
        _ => 3,
    };
    format::number(percent, decimals)
}

/// What a picture of pushing pixels is of: camera, axis and limb.
pub(crate) type PushKey = (usize, PushAxis, usize);

/// One of the fits.
#[derive(Debug, Clone)]
pub struct Contestant {
    /// Its name and choices.
    pub entrant: Entrant,
    /// The scene with its choices.
    pub scene: FitInputs,
    /// The start, then every iteration, rejected ones too.
    pub steps: Vec<RunStep>,
    /// How it ended, once it has.
    pub(crate) ending: Option<RunEnding>,
    /// What the step that is looked at predicts; while a newer one is made, the old stays.
    pub(crate) shown: Option<Arc<Predicted>>,
    /// What its newest step predicts.
    pub(crate) newest: Option<Arc<Predicted>>,
    /// What pushes at the start, and in which camera along which axis of which limb.
    pub pushed: Option<(PushKey, Arc<Pushed>)>,
    /// The newest check of the gradient; while a newer one is made, the old stays.
    pub checked: Option<Checked>,
}

impl Contestant {
    /// The last step that there is.
    pub fn last(&self) -> usize {
        self.steps.len().saturating_sub(1)
    }

    /// The mismatch after a step in percent of the start's. After its end a fit stays where it is.
    pub fn percent(&self, step: usize) -> Option<f64> {
        let start = self.steps.first()?.mismatch;
        let here = self.steps.get(step.min(self.last()))?.mismatch;
        (start > 0.0).then(|| 100.0 * here / start)
    }

    /// The mismatch of every step in percent of the start's.
    pub fn percents(&self) -> Vec<f64> {
        (0..self.steps.len()).filter_map(|step| self.percent(step)).collect()
    }

    /// The pose after a step.
    pub fn pose(&self, step: usize) -> Option<&Pose> {
        self.steps.get(step.min(self.last())).map(|step| &step.iteration.point)
    }

    /// The first step from which on it stays below a share of its start, percent.
    pub(crate) fn arrived(&self, percent: f64) -> Option<usize> {
        let percents = self.percents();
        let stays = percents.iter().rev().take_while(|value| **value < percent).count();
        (stays > 0).then(|| percents.len() - stays)
    }
}

/// Several fits from one start.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// What it is made of.
    pub(crate) basis: Basis,
    /// The fits.
    pub contestants: Vec<Contestant>,
    /// The step that is looked at.
    pub cursor: usize,
    /// Whether the newest step is looked at as it comes.
    pub(crate) follows: bool,
    /// By camera: where data and starts are, so that the pictures show that and do not jump.
    pub(crate) extents: Vec<Option<Extent>>,
    /// Which comparison since the program began: pictures of an older one are not shown for this.
    pub id: u64,
}

impl Comparison {
    /// A comparison without any step yet, not even the start.
    pub(crate) fn new(basis: Basis, id: u64) -> Self {
        let contestant = |entrant: &Entrant| Contestant {
            scene: basis.scene_of(entrant),
            entrant: entrant.clone(),
            steps: Vec::new(),
            ending: None,
            shown: None,
            newest: None,
            pushed: None,
            checked: None,
        };
        let contestants = basis.entrants.iter().map(contestant).collect();
        let extents = vec![None; basis.scene.cameras.len()];
        Self { basis, contestants, cursor: 0, follows: true, extents, id }
    }

    /// The last step that any fit has.
    pub fn last(&self) -> usize {
        self.contestants.iter().map(Contestant::last).max().unwrap_or(0)
    }

    /// Whether every fit has its start or has failed to begin.
    pub(crate) fn has_begun(&self) -> bool {
        self.contestants.iter().all(|fit| !fit.steps.is_empty() || fit.ending.is_some())
    }

    /// Whether every fit has ended by itself.
    pub fn is_over(&self) -> bool {
        self.contestants.iter().all(|fit| fit.ending.is_some())
    }

    /// Why no fit could begin, if none could.
    pub(crate) fn problem(&self) -> Option<&str> {
        let all_empty = self.contestants.iter().all(|fit| fit.steps.is_empty());
        let first = self.contestants.first()?.ending.as_ref()?;
        match first {
            RunEnding::Solver(words) if all_empty => Some(words),
            _ => None,
        }
    }

    pub(crate) fn go_to(&mut self, step: usize) {
        self.cursor = step.min(self.last());
        self.follows = self.cursor == self.last();
    }

    /// Takes in where data and start are in every camera.
    pub(crate) fn add_extents(&mut self, found: &[Option<Extent>]) {
        for (known, found) in self.extents.iter_mut().zip(found) {
            *known = match (*known, *found) {
                (Some(a), Some(b)) => Some(union(a, b)),
                (a, b) => a.or(b),
            };
        }
    }

    pub(crate) fn add_step(&mut self, index: usize, step: RunStep, predicted: Arc<Predicted>) {
        let Some(fit) = self.contestants.get_mut(index) else { return };
        fit.steps.push(step);
        fit.newest = Some(predicted);
        self.follow();
    }

    pub(crate) fn end(&mut self, index: usize, ending: RunEnding) {
        if let Some(fit) = self.contestants.get_mut(index) {
            fit.ending = Some(ending);
        }
        self.follow();
    }

    /// The work on the fits has broken down: those that were going on have ended.
    pub(crate) fn break_down(&mut self, words: &str) {
        for fit in self.contestants.iter_mut().filter(|fit| fit.ending.is_none()) {
            fit.ending = Some(RunEnding::Solver(words.to_owned()));
        }
        self.follow();
    }

    /// The step that all fits have reached which go on is looked at.
    fn follow(&mut self) {
        if self.follows {
            let going = self.contestants.iter().filter(|fit| fit.ending.is_none()).map(Contestant::last);
            self.cursor = self.cursor.max(going.min().unwrap_or_else(|| self.last()));
        }
        // Pictures that are there need not be asked for.
        for fit in &mut self.contestants {
            if fit.newest.as_ref().is_some_and(|newest| fit.pose(self.cursor) == Some(&newest.pose)) {
                fit.shown.clone_from(&fit.newest);
            }
        }
    }

    /// Fits whose picture is not that of the step that is looked at.
    pub fn stale(&self) -> impl Iterator<Item = (usize, &Contestant, &Pose)> {
        self.contestants.iter().enumerate().filter_map(|(index, fit)| {
            let pose = fit.pose(self.cursor)?;
            let is_fresh = fit.shown.as_ref().is_some_and(|shown| shown.pose == *pose);
            (!is_fresh).then_some((index, fit, pose))
        })
    }

    /// One line a step: for every fit its cost and its percent of the start. A field is empty once its fit has ended.
    pub(crate) fn csv(&self) -> String {
        let mut text = "step".to_owned();
        for fit in &self.contestants {
            let name = fit.entrant.name.to_lowercase().replace(' ', "_");
            let _ = write!(text, ",{name}_cost,{name}_percent");
        }
        text.push('\n');
        for step in 0..=self.last() {
            text += &step.to_string();
            for fit in &self.contestants {
                let at = fit.steps.get(step);
                let cost = at.map_or_else(String::new, |at| format!("{:?}", at.mismatch));
                let percent = at.and_then(|_| fit.percent(step));
                let percent = percent.map_or_else(String::new, |percent| format!("{percent:?}"));
                let _ = write!(text, ",{cost},{percent}");
            }
            text.push('\n');
        }
        text
    }

    /// The plot as a picture of its own.
    pub(crate) fn figure(&self, title: &str, subtitle: &str, is_log: bool) -> Figure {
        let lines = self.contestants.iter().enumerate();
        let label = "cost, % of the start";
        Figure {
            title: title.to_owned(),
            subtitle: subtitle.to_owned(),
            x: Axis::linear("step"),
            y: if is_log { Axis::log(label).within(LEAST_PERCENT, 150.0) } else { Axis::linear(label) },
            lines: lines
                .map(|(style, fit)| Line::of_values(fit.entrant.name, style, &fit.percents()))
                .collect(),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use backlit_tracking::body::{Model, builtin};
    use backlit_tracking::camera::Camera;
    use backlit_tracking::fit::{FitOptions, Preset};
    use backlit_tracking::optimize::Iteration;
    use glam::DVec3;

    use super::*;
    use crate::features::laboratory::Lineup;
    use crate::session::prediction::Derivatives;

    /// A scene without pictures.
    pub(crate) fn scene(model: Model, fit: FitOptions, cameras: Vec<Arc<Camera>>) -> FitInputs {
        FitInputs {
            cameras: Arc::new(cameras),
            uses: Arc::default(),
            fit: Arc::new(fit),
            frame: None,
            derivatives: Derivatives::default(),
            model: Arc::new(model),
        }
    }

    /// A comparison of the renderers with these mismatches, without pictures.
    pub(crate) fn comparison(mismatches: [&[f64]; 3]) -> Comparison {
        let scene = scene(builtin::single_limb(), FitOptions::preset(Preset::Report), Vec::new());
        let model = scene.model.clone();
        let start = Pose::rest(&model);
        let basis = Basis { start, entrants: Lineup::Renderers.entrants(&scene.fit, &model), scene };
        let mut comparison = Comparison::new(basis, 0);
        let longest = mismatches.iter().map(|mismatches| mismatches.len()).max().unwrap_or(0);
        for at in 0..longest {
            for (index, mismatches) in mismatches.iter().enumerate() {
                let Some(&mismatch) = mismatches.get(at) else { continue };
                let before = mismatches[at.saturating_sub(1)];
                let pose = Pose { root: DVec3::splat(at as f64), ..Pose::rest(&model) };
                let scene = comparison.contestants[index].scene.clone();
                let predicted = Arc::new(Predicted::new(&scene, &pose, None));
                comparison.add_step(index, step(pose, mismatch, before - mismatch), predicted);
            }
        }
        comparison
    }

    fn step(point: Pose, mismatch: f64, actual_decrease: f64) -> RunStep {
        let iteration = Iteration { actual_decrease, ..Iteration::start(point, mismatch) };
        RunStep { iteration, mismatch, rms: 0.0, iou: None, joint_error_mm: None, seconds: 0.0 }
    }

    #[test]
    fn the_step_that_all_have_is_followed() {
        let mut found = comparison([&[9.0, 8.0, 7.0], &[9.0, 2.0], &[9.0, 3.0, 1.0]]);
        assert_eq!((found.cursor, found.last()), (1, 2));
        found.end(1, RunEnding::Solver("done".to_owned()));
        assert_eq!(found.cursor, 2, "a fit that has ended is not waited for");
        assert!(
            (found.contestants[1].percent(2).unwrap() - 200.0 / 9.0).abs() < 1e-9,
            "it stays where it is"
        );
        found.go_to(0);
        let stale: Vec<usize> = found.stale().map(|(index, ..)| index).collect();
        assert_eq!(stale, [0, 1, 2]);
        let pose = found.contestants[0].steps[0].iteration.point.clone();
        let predicted = Arc::new(Predicted::new(&found.contestants[0].scene, &pose, None));
        found.add_step(0, step(pose, 6.0, 1.0), predicted);
        assert_eq!(found.cursor, 0, "the step that is looked at stays");
        found.go_to(99);
        assert_eq!((found.cursor, found.follows), (3, true));
    }

    #[test]
    fn arriving_is_staying_below() {
        let found = comparison([&[100.0, 1.0, 50.0, 1.0, 0.5], &[100.0, 90.0], &[0.0, 0.0]]);
        let arrived: Vec<Option<usize>> = found.contestants.iter().map(|fit| fit.arrived(5.0)).collect();
        assert_eq!(arrived, [Some(3), None, None]);
        assert_eq!(found.contestants[2].percent(0), None, "nothing of nothing");
    }

    #[test]
    fn the_table_has_a_line_for_every_step() {
        let found = comparison([&[8.0, 4.0, 2.0], &[10.0, 1.0], &[0.0]]).csv();
        let lines: Vec<&str> = found.lines().collect();
        assert_eq!(
            lines[0],
            "step,cylinder_cost,cylinder_percent,capsule_cost,capsule_percent,sphere_tree_cost,sphere_tree_percent"
        );
        assert_eq!(lines[1], "0,8.0,100.0,10.0,100.0,0.0,");
        assert_eq!(lines[3], "2,2.0,25.0,,,,");
        assert_eq!(lines.len(), 4);
    }
}
