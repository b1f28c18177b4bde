//! Stepping, running and refitting.

pub(crate) mod job;
pub(crate) mod measurement;
pub(crate) mod refit;
pub(crate) mod refitted;
pub(crate) mod renderer;
pub(crate) mod solver;

use backlit_tracking::body::Model;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::render::RendererKind;

use crate::app::Inspector;
use crate::context::command::Part;
use crate::document::edit::Edit;
use crate::document::fit_words as words;
use crate::document::history::Gesture;
use crate::document::run::{Run, RunChoices};
use crate::document::tracking_choices::TrackingChoices;
use crate::features::fit::job::LiveFit;
use crate::features::fit::job::{FitJob, FitStart};
use crate::session::prediction::FitInputs;
use crate::session::selection::StepRef;
use crate::worker::Lane;

/// The fit of the frame on the screen.
#[derive(Debug, Default)]
pub(crate) struct Fit {
    pub(crate) live: LiveFit,
    /// Steps that were asked for while one was being made.
    pub(crate) pending_steps: usize,
    /// The gesture of the run that is going on.
    pub(crate) run_gesture: Option<Gesture>,
}

impl Inspector {
    /// All that a prediction of this frame depends on, but the pose.
    pub(crate) fn scene(&self) -> Option<FitInputs> {
        let document = self.document();
        let take = self.state.session.take.as_ref()?;
        Some(FitInputs {
            model: document.model.clone(),
            cameras: take.cameras.clone(),
            uses: document.cameras.clone(),
            fit: document.fit.clone(),
            frame: self.state.session.frames.get(self.state.selection.frame).cloned(),
            derivatives: self.features.camera_views.derivatives(&self.context()),
        })
    }

    /// One step, or all of them: of the run that is live, if the pose on the screen is its last one and
    /// nothing that it depends on has changed; else of a new run.
    pub(crate) fn step(&mut self, steps: Option<usize>) {
        self.pause();
        if self.worker.is_busy(Lane::Fit) {
            self.features.fit.pending_steps += steps.unwrap_or(0);
            return;
        }
        let goes_on = self.state.session.live.filter(|live| self.can_go_on(*live));
        self.features.fit.run_gesture = Some(self.new_gesture());
        if let Some(live) = goes_on {
            self.state.selection.step = None;
            if let Some(run) = self.state.session.runs.get_mut(live) {
                run.ending = None;
            }
            self.worker.request(Lane::Fit, FitJob::go_on(self.features.fit.live.clone(), steps));
        } else {
            self.begin(None, None, steps);
        }
    }

    fn can_go_on(&self, live: usize) -> bool {
        let Some(run) = self.state.session.runs.get(live) else { return false };
        let Some(last) = run.steps.last() else { return false };
        let shown = self.state.session.shown_pose(self.document(), &self.state.selection);
        let same_scene =
            self.state.session.live_scene.as_ref().zip(self.scene()).is_some_and(|(a, b)| a.is(&b));
        run.frame == self.state.selection.frame && *shown == last.pose && same_scene
    }

    /// Fits a part of the body from the pose on the screen, to the end.
    pub(crate) fn refit(&mut self, part: Part) {
        let model = self.document().model.clone();
        let limb = self.state.selection.limb(&model);
        let name = match part {
            Part::Limb => Some(model.limbs()[limb].name.clone()),
            Part::Chain => Some(format!("chain of {}", model.limbs()[limb].name)),
            Part::Body => None,
        };
        self.features.fit.run_gesture = Some(self.new_gesture());
        let what = format!("Refit {}", name.as_deref().unwrap_or("body"));
        let free = free_rotations(&model, limb, part).zip(name);
        self.begin(None, free.map(|(free, name)| (name, free)), None);
        self.state.session.refitting = Some(what);
    }

    /// Begins a run: with a name of its own or one that is made of its choices; of all the body or of a part, with
    /// that part's name and the rotations that may move.
    pub(crate) fn begin(
        &mut self,
        name: Option<String>,
        part: Option<(String, Vec<bool>)>,
        steps: Option<usize>,
    ) {
        self.pause();
        self.state.session.refitting = None;
        let Some(scene) = self.scene() else { return };
        let pose = self.state.session.shown_pose(self.document(), &self.state.selection).clone();
        let (part, free) = part.unzip();
        let fit = scene.fit.clone();
        // Stages to the scale of what is seen: these are the ones that the fit's steps will name.
        let options = (*fit).clone().at_scale(&scene.model, &scene.views(), &pose);
        self.state.session.runs_begun += 1;
        let branched_from = self.state.session.step_with_pose(self.state.selection.frame, &pose);
        let run = Run {
            number: self.state.session.runs_begun,
            is_named: name.is_some(),
            name: name.unwrap_or_default(),
            detail: words::fit_detail(&fit),
            frame: self.state.selection.frame,
            colour: self.state.session.free_colour(),
            stages: options.stages.iter().map(|stage| words::short_ramp(stage.ramp)).collect(),
            choices: RunChoices { fit, cameras: scene.uses.clone(), part, branched_from },
            is_shown: true,
            ..Run::default()
        };
        self.state.session.live = Some(self.state.session.runs.len());
        self.state.session.runs.push(run);
        self.name_runs();
        self.state.session.live_scene = Some(scene.clone());
        self.state.selection.step = None;
        let start = FitStart { scene, pose, options, free };
        self.worker.request(Lane::Fit, FitJob::begin(start, self.features.fit.live.clone(), steps));
    }

    /// Ends a fit that is going on, because its pose is about to change: what it has done stays as a run.
    pub(crate) fn interrupt_fit(&mut self) {
        self.features.demonstrations.stop();
        if !self.worker.is_busy(Lane::Fit) {
            return;
        }
        self.worker.drop_lane(Lane::Fit);
        self.features.fit.pending_steps = 0;
        self.finish_run(Some(crate::document::run::RunEnding::Stopped));
        self.state.session.live = None;
    }

    /// Goes to the step before or after the one on the screen.
    pub(crate) fn look_at_neighbour(&mut self, later: bool) {
        let Some(run) = self.state.session.run_of(&self.state.selection) else { return };
        let Some(last) = self.state.session.runs.get(run).and_then(|run| run.steps.len().checked_sub(1))
        else {
            return;
        };
        let at = self.state.selection.step.map_or(last, |step| step.step);
        let step = if later { (at + 1).min(last) } else { at.saturating_sub(1) };
        // The newest step is the document's pose, as long as nobody has changed that.
        let is_newest = step == last
            && self.state.session.runs[run].steps[last].pose
                == *self.document().pose_at(self.state.selection.frame);
        self.state.selection.step = (!is_newest).then_some(StepRef { run, step });
    }

    /// Makes the step on the screen the frame's pose.
    pub(crate) fn branch(&mut self) {
        let Some(at) = self.state.selection.step else { return };
        let Some(step) = self.state.session.step(at) else { return };
        let what = format!("Branch at step {}", at.step);
        let edit = Edit::SetPose { frame: self.state.selection.frame, pose: step.pose.clone(), what };
        self.edit(edit, None);
    }

    /// Changes the choices of the fit.
    pub(crate) fn set_fit(&mut self, options: FitOptions, what: String) {
        self.edit(Edit::SetFit { options: Box::new(options), what }, None);
    }

    /// Switches to a preset, with the tracking that goes with it: one act.
    pub(crate) fn set_preset(&mut self, preset: Preset, options: FitOptions) {
        let gesture = Some(self.new_gesture());
        let what = format!("Switch to {}", preset.label());
        self.edit(Edit::SetFit { options: Box::new(options), what }, gesture);
        let motion = self.document().tracking.motion;
        let choices = TrackingChoices { motion, ..TrackingChoices::of_preset(Some(preset)) };
        self.edit(Edit::SetTracking(choices), gesture);
    }

    /// Switches the renderer.
    pub(crate) fn set_renderer(&mut self, renderer: RendererKind) {
        let options = FitOptions { renderer, ..(*self.document().fit).clone() };
        self.set_fit(options, format!("Switch to {}", words::renderer_name(renderer).to_lowercase()));
    }

    /// Stops the fit; what is done stays.
    pub(crate) fn stop(&mut self) {
        self.features.fit.pending_steps = 0;
        self.features.demonstrations.stop();
        self.worker.cancel(Lane::Fit);
    }
}

/// Rotations that a refit may move; `None` for all of them and the root.
fn free_rotations(model: &Model, limb: usize, part: Part) -> Option<Vec<bool>> {
    let rotation = model.limbs()[limb].rotation;
    let mut free = vec![false; model.rotation_count()];
    match part {
        Part::Body => return None,
        Part::Limb => free[rotation] = true,
        Part::Chain => {
            // Up to the trunk: a rotation with more than one child belongs to several chains.
            let children = |parent: usize| {
                model.rotation_parents().iter().filter(|other| **other == Some(parent)).count()
            };
            let mut next = Some(rotation);
            while let Some(at) = next {
                free[at] = true;
                next = model.rotation_parents()[at].filter(|parent| children(*parent) == 1);
            }
            for (index, slot) in free.iter_mut().enumerate() {
                *slot |= model.rotation_follows(index, rotation);
            }
        }
    }
    Some(free)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn a_chain_goes_from_the_trunk_to_the_hand() {
        let model = builtin::full_body();
        let arm = model.limb_index("right upper arm").unwrap();
        let free = free_rotations(&model, arm, Part::Chain).unwrap();
        let names: Vec<&str> = model
            .rotation_owners()
            .iter()
            .zip(&free)
            .filter(|(_, free)| **free)
            .map(|(owner, _)| model.limbs()[*owner].name.as_str())
            .collect();
        assert_eq!(names, ["right clavicle", "right upper arm", "right forearm"]);
        assert_eq!(free_rotations(&model, arm, Part::Limb).unwrap().iter().filter(|f| **f).count(), 1);
        assert_eq!(free_rotations(&model, arm, Part::Body), None);
    }
}
