//! The laboratory in every frame of the window: it begins again when what it compares changes, steps its fits, and asks
//! for what its pictures lack.

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::{Pool, TaskEvent};
use backlit_plot::AsPicture;
use backlit_tracking::body::Pose;
use image::{DynamicImage, ImageFormat};

use super::check::{FitCheck, check_all};
use super::comparison::PushKey;
use super::job::{DrawingMessage, LaboratoryMessage, Lacking, StepJob, draw};
use super::{Basis, Comparison, Contestant, Laboratory, LaboratoryChoices};
use crate::context::command::{Command, LaboratoryCommand};
use crate::context::feature::Feature;
use crate::context::preferences::Layout;
use crate::context::{Context, FeatureRequest, Requests};

impl Feature for Laboratory {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        self.take_in_steps(context, requests);
        self.take_in_looks_and_checks(requests);
        for ((), path) in self.dialogs.answers() {
            self.save_plot(&path, context, requests);
        }
        if context.preferences.layout == Layout::Demonstrate {
            self.go_on(context);
        } else {
            // What nobody sees need not be checked.
            self.checks.forget();
        }
    }

    fn run(&mut self, command: Command, _: &Context<'_>, _: &mut Requests) -> bool {
        let Command::Laboratory(command) = command else { return false };
        match command {
            LaboratoryCommand::Restart => self.comparison = None,
        }
        true
    }

    fn answer(&mut self, request: &FeatureRequest, _: &Context<'_>, _: &mut Requests) {
        if let FeatureRequest::RunLaboratory { over, camera } = *request {
            self.choices.lineup = over.into();
            self.choices.camera = camera.unwrap_or(self.choices.camera);
            self.wants_run = true;
        }
    }

    fn sentence(&self, context: &Context<'_>) -> Option<String> {
        if context.preferences.layout != Layout::Demonstrate {
            return None;
        }
        let all = self.choices.lineup.words().all;
        let Some(comparison) = self.begun() else { return Some("Preparing the laboratory…".to_owned()) };
        let step = comparison.cursor;
        if self.is_running() {
            return Some(format!("Step {step} in {all}. They are running; Esc stops them."));
        }
        let last = comparison.last();
        if comparison.is_over() && step == last {
            return Some(format!(
                "Step {step} in {all}: they have ended. The arrow keys go through their steps."
            ));
        }
        if step < last {
            return Some(format!("Step {step} of {last} in {all}. The arrow keys go through them."));
        }
        Some(format!(
            "Step {step} in {all}. Space steps them together, Enter runs them; the arrow keys step."
        ))
    }

    fn reset(&mut self, _: &Footage) {
        let choices = LaboratoryChoices { is_log: self.choices.is_log, ..Default::default() };
        *self = Self { choices, comparisons: self.comparisons, ..Self::default() };
    }

    fn freeze_times(&mut self) {
        self.step_seconds = None;
    }

    fn at_rest(&self) -> Self {
        Self {
            choices: self.choices,
            comparison: self.comparison.clone(),
            step_seconds: self.step_seconds,
            comparisons: self.comparisons,
            ..Self::default()
        }
    }
}

impl Laboratory {
    fn take_in_steps(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for event in self.steps.poll() {
            match (event, &mut self.comparison) {
                (
                    TaskEvent::Output(LaboratoryMessage::Step(index, mut step, predicted)),
                    Some(comparison),
                ) => {
                    step.joint_error_mm = context.joint_error_mm(&step.iteration.point);
                    comparison.add_step(index, *step, predicted);
                    self.measure_steps();
                }
                (TaskEvent::Output(LaboratoryMessage::Extents(extents)), Some(comparison)) => {
                    comparison.add_extents(&extents);
                }
                (TaskEvent::Output(LaboratoryMessage::Ended(index, ending)), Some(comparison)) => {
                    comparison.end(index, ending);
                }
                (TaskEvent::Output(LaboratoryMessage::Waiting(fits)), _) => self.fits = fits,
                (TaskEvent::Output(_), None) => {}
                (TaskEvent::Ended, _) => {
                    let steps = std::mem::take(&mut self.pending_steps);
                    if steps > 0 {
                        self.run_fits(Some(steps), context.pool);
                    }
                }
                (TaskEvent::Failed(failure), comparison) => {
                    requests.failed("The laboratory", &failure);
                    if let Some(comparison) = comparison {
                        comparison.break_down("the work on the fits broke down; Restart begins again");
                    }
                    (self.pending_steps, self.wants_run) = (0, false);
                }
            }
        }
    }

    fn take_in_looks_and_checks(&mut self, requests: &mut Requests) {
        let looks = requests.outputs("Drawing the laboratory’s pictures", &mut self.looks);
        let checks = requests.outputs("The check of the laboratory’s gradients", &mut self.checks);
        let Some(comparison) = &mut self.comparison else { return };
        let fits = &mut comparison.contestants;
        for look in looks {
            match look {
                DrawingMessage::Step(index, predicted) => {
                    fits.iter_mut().skip(index).take(1).for_each(|fit| fit.shown = Some(predicted.clone()));
                }
                DrawingMessage::Pushes(key, pushed) => {
                    let fits = fits.iter_mut().zip(pushed);
                    fits.for_each(|(fit, pushed)| fit.pushed = Some((key, Arc::new(pushed))));
                }
            }
        }
        for (index, checked) in checks {
            fits.iter_mut().skip(index).take(1).for_each(|fit| fit.checked = Some(checked.clone()));
        }
    }

    /// What is compared as things are now; `None` as long as the frame is not there.
    fn basis(&self, context: &Context<'_>) -> Option<Basis> {
        let scene = context.fit_inputs()?;
        scene.frame.as_ref()?;
        let document = context.document();
        let truth = || context.session.demonstration()?.truth(context.selection.frame);
        let start = self.choices.start.pose(&document.model, context.shown_pose(), &document.start, truth);
        Some(Basis {
            start: start.normalized(),
            entrants: self.choices.lineup.entrants(&document.fit, &document.model),
            scene,
        })
    }

    fn go_on(&mut self, context: &Context<'_>) {
        let Some(basis) = self.basis(context) else { return };
        if !self.comparison.as_ref().is_some_and(|old| old.basis.is(&basis)) {
            self.begin(basis, context.pool);
        }
        let last = context.session.camera_count().saturating_sub(1);
        self.choices.camera = self.choices.camera.min(last);
        if self.begun().is_none() {
            return;
        }
        if self.wants_run && !self.is_running() {
            self.wants_run = false;
            self.step(None, context.pool);
        }
        // Fits and pictures go before checks: while they come, the pose to check changes with every step.
        match self.lacking(context) {
            // What is being drawn is shown too while one goes through the steps.
            Some(_) if self.looks.is_busy() => {}
            Some(lacking) => {
                if let Some(comparison) = &self.comparison {
                    self.looks.need(context.pool, lacking, |lacking| draw(comparison, lacking));
                }
            }
            None if self.is_running() => {}
            None => self.ask_for_checks(context.pool),
        }
    }

    fn begin(&mut self, basis: Basis, pool: &Pool) {
        self.looks.forget();
        self.checks.forget();
        (self.pending_steps, self.choices.marked) = (0, None);
        self.comparisons += 1;
        self.fits.clear();
        let starts = basis.entrants.iter().map(|entrant| (basis.scene_of(entrant), basis.start.clone()));
        self.steps.begin(pool, (), |()| StepJob::begin(starts.collect()));
        self.comparison = Some(Comparison::new(basis, self.comparisons));
    }

    fn run_fits(&mut self, steps: Option<usize>, pool: &Pool) {
        let fits = std::mem::take(&mut self.fits);
        self.steps.begin(pool, (), |()| StepJob::go_on(fits, steps));
    }

    /// A step of all fits, or all of their steps. Steps that are there already are only looked at.
    pub(super) fn step(&mut self, steps: Option<usize>, pool: &Pool) {
        let is_running = self.is_running();
        let Some(comparison) = &mut self.comparison else { return };
        if steps.is_some() && comparison.cursor < comparison.last() {
            comparison.go_to(comparison.cursor + 1);
            return;
        }
        comparison.go_to(comparison.last());
        comparison.follows = true;
        if is_running {
            self.pending_steps += steps.unwrap_or(0);
        } else if !comparison.is_over() {
            self.run_fits(steps, pool);
        }
    }

    /// Whether nothing that its layout shows is still to be made.
    pub(crate) fn is_settled(&self, context: &Context<'_>) -> bool {
        if context.preferences.layout != Layout::Demonstrate || context.session.take.is_none() {
            return true;
        }
        let Some(basis) = self.basis(context) else { return context.busy.load_broke };
        if !self.begun().is_some_and(|comparison| comparison.basis.is(&basis)) || self.wants_run {
            return false;
        }
        self.lacking(context).is_none() && (self.is_running() || self.to_check().is_none())
    }

    /// Which pushes are shown.
    pub(super) fn push_key(&self, context: &Context<'_>) -> PushKey {
        let model = &context.document().model;
        (self.choices.camera, self.choices.axis_for(model), context.selection.limb(model))
    }

    /// The pictures that the screen lacks and that can be made.
    fn lacking(&self, context: &Context<'_>) -> Option<Lacking> {
        let comparison = self.comparison.as_ref()?;
        let key = self.push_key(context);
        let has_push =
            |fit: &Contestant| fit.pushed.as_ref().is_some_and(|(of, _)| *of == key) || fit.steps.is_empty();
        let push = (!comparison.contestants.iter().all(has_push)).then_some(key);
        let steps: Vec<_> = comparison.stale().map(|(index, _, pose)| (index, pose.clone())).collect();
        let lacking = (push.is_some() || !steps.is_empty()).then_some(Lacking { steps, push });
        lacking.filter(|lacking| self.looks.failure().is_none() || self.looks.inputs() != Some(lacking))
    }

    /// The gradients that are still to be checked at the step that is looked at.
    fn to_check(&self) -> Option<Vec<(usize, Pose)>> {
        let comparison = self.comparison.as_ref()?;
        let wanted = unchecked(comparison);
        let has_failed = self.checks.failure().is_some() && is_asked(self.checks.inputs(), &wanted);
        let is_wanted = !wanted.is_empty() && !comparison.basis.scene.cameras.is_empty() && !has_failed;
        is_wanted.then_some(wanted)
    }

    /// Asks for the check of the gradients in all cameras, the one that is shown first.
    fn ask_for_checks(&mut self, pool: &Pool) {
        let Some((wanted, comparison)) = self.to_check().zip(self.comparison.as_ref()) else { return };
        if self.checks.is_busy() && is_asked(self.checks.inputs(), &wanted) {
            return;
        }
        let mut order: Vec<usize> = (0..comparison.basis.scene.cameras.len()).collect();
        order.sort_by_key(|camera| *camera != self.choices.camera);
        self.checks.begin(pool, wanted, |wanted| {
            let check = |(index, pose): &(usize, Pose)| {
                let scene = comparison.contestants[*index].scene.clone();
                FitCheck::new(*index, scene, pose.clone(), order.clone())
            };
            check_all(wanted.iter().map(check).collect())
        });
    }

    /// Writes the plot as a PNG.
    pub fn save_plot(&self, path: &Path, context: &Context<'_>, requests: &mut Requests) {
        let Some(comparison) = &self.comparison else { return };
        let take = context.session.take.as_ref().map_or("", |take| take.take().name());
        let words = self.choices.lineup.words();
        let subtitle = format!("{take}. {}", words.sentence);
        let figure = comparison.figure(words.title, &subtitle, self.choices.is_log);
        let theme = context.preferences.theme;
        let path = if path.extension().is_none() { path.with_extension("png") } else { path.to_owned() };
        requests.write(&path, move || {
            let mut bytes = Cursor::new(Vec::new());
            DynamicImage::ImageRgba8(figure.picture(theme)).write_to(&mut bytes, ImageFormat::Png)?;
            Ok(bytes.into_inner())
        });
    }
}

fn is_asked(asked: Option<&Vec<(usize, Pose)>>, wanted: &[(usize, Pose)]) -> bool {
    asked.is_some_and(|asked| wanted.iter().all(|one| asked.contains(one)))
}

/// Fits whose gradient was not wholly checked at the step that is looked at, with their poses.
pub(super) fn unchecked(comparison: &Comparison) -> Vec<(usize, Pose)> {
    let pose = |(index, fit): (usize, &Contestant)| {
        let pose = fit.pose(comparison.cursor)?;
        let known = fit.checked.as_ref().filter(|old| old.pose == *pose);
        (!known.is_some_and(|known| known.progress.is_whole())).then(|| (index, pose.clone()))
    };
    comparison.contestants.iter().enumerate().filter_map(pose).collect()
}
