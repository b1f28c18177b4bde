//! What the worker said.

use std::sync::Arc;

use backlit_tracking::fit::Preset;

use super::Inspector;
use crate::app::open_job::OpenedProject;
use crate::app::refresh::Refresh;
use crate::context::command::{Command, FileCommand};
use crate::document::edit::Edit;
use crate::document::history::History;
use crate::document::run::{RunEnding, RunStep};
use crate::document::tracking_choices::TrackingChoices;
use crate::document::{CameraUse, Document, Estimate, Origin};
use crate::features::demonstrations::Demonstrations;
use crate::features::fit::job::FitJob;
use crate::features::fit::refitted::Refitted;
use crate::session::prediction::Predicted;
use crate::session::selection::Selection;
use crate::take::footage::Footage;
use crate::take::source::TakeSource;
use crate::worker::{Event, Lane, Report};

impl Inspector {
    /// Takes in all that has happened since the last frame.
    pub(crate) fn hear_worker(&mut self) {
        for report in self.worker.poll() {
            match report {
                Report::Event(event) => self.hear(event),
                Report::Panicked(lane, why) => self.broke(lane, &why),
                Report::Ended(lane) => self.ended(lane),
            }
        }
    }

    fn hear(&mut self, event: Event) {
        match event {
            Event::FrameLoaded(frame) => self.state.session.keep_frame(frame),
            Event::FitStep(step, predicted) => self.fit_step(*step, predicted),
            Event::FitEnded(ending) => self.finish_run(ending),
            Event::Failed(text) => self.state.notices.error(text),
        }
    }

    fn fit_step(&mut self, step: RunStep, predicted: Arc<Predicted>) {
        self.state.session.step_seconds = Some(step.seconds);
        if self.state.selection.step.is_none() {
            self.state.session.predicted = Some(predicted.clone());
            self.state.session.generation += 1;
        }
        self.state.session.live_prediction = Some(predicted);
        if let Some(run) = self.state.session.live.and_then(|live| self.state.session.runs.get_mut(live)) {
            run.steps.push(step);
            if run.steps.len() == 1 {
                // Its start is known now, and whether it is another than those of the runs before.
                self.name_runs();
            }
        }
    }

    /// The steps asked for are done, or the fit has ended: its pose becomes the frame's.
    pub(crate) fn finish_run(&mut self, ending: Option<RunEnding>) {
        let Some(run) = self.state.session.live.and_then(|live| self.state.session.runs.get_mut(live)) else {
            return;
        };
        let stays_live = ending.is_none();
        run.ending = ending;
        if run.steps.is_empty() {
            // It could not begin.
            self.state.session.live = None;
            self.state.session.runs.retain(|run| !run.steps.is_empty());
            self.name_runs();
            return;
        }
        let frame = run.frame;
        let steps = run.steps.len() - 1;
        let Some(last) = run.steps.last().cloned() else { return };
        let before = run.steps.first().map_or(last.mismatch, |first| first.mismatch);
        let ending = run.ending_text();
        if let Some(what) = self.state.session.refitting.take_if(|_| !stays_live) {
            let refitted = Refitted { what, before, after: last.mismatch, steps, ending };
            self.state.session.refits.insert(frame, refitted);
        }
        let predicted =
            self.state.session.live_prediction.as_ref().filter(|predicted| predicted.pose == last.pose);
        let estimate = Estimate {
            pose: last.pose,
            origin: Origin::Fit,
            cost: last.mismatch,
            rms: predicted.and_then(|predicted| predicted.rms).unwrap_or_default(),
            iou: predicted.and_then(|predicted| predicted.iou()),
            steps,
            lost: false,
        };
        if steps > 0 {
            let gesture = self.features.fit.run_gesture;
            self.edit(Edit::AddEstimate { frame, estimate: Arc::new(estimate) }, gesture);
        }
        if !stays_live {
            self.features.fit.pending_steps = 0;
        }
    }

    fn ended(&mut self, lane: Lane) {
        match lane {
            Lane::Fit if self.features.fit.pending_steps > 0 => {
                let steps = std::mem::take(&mut self.features.fit.pending_steps);
                self.features.fit.run_gesture = Some(self.new_gesture());
                self.worker.request(Lane::Fit, FitJob::go_on(self.features.fit.live.clone(), Some(steps)));
            }
            _ => {}
        }
    }

    pub(crate) fn take_opened(&mut self, footage: &Arc<Footage>, project: Option<OpenedProject>) {
        self.worker.drop_lane(Lane::Fit);
        self.refresh = Refresh::default();
        self.forget_broken();
        self.features.laboratory.reset(footage);
        self.state.session.reset(Some(footage.clone()));
        self.features.observability.reset();
        self.features.scene.reset();
        self.features.basin.reset();
        self.features.tracking.reset();
        if let Some(TakeSource::Path(path)) = &footage.source {
            self.state.preferences.remember(path.clone());
        }
        let left = self.features.recovery.begin(project.as_ref().map(|project| project.path.as_path()));
        self.state.lost_take = None;
        if let Some(note) = project.as_ref().and_then(|project| project.note.clone()) {
            self.state.notices.info(self.state.now, note, None);
        }
        let (history, path) = match project {
            // What was left unsaved is in no file as it is.
            Some(project) if left.is_some() => {
                (History::unsaved(*project.document), left.as_ref().and_then(|left| left.project.clone()))
            }
            Some(project) if project.is_changed => (History::unsaved(*project.document), Some(project.path)),
            Some(project) => (History::new(*project.document), Some(project.path)),
            None => (History::new(document_of(footage)), None),
        };
        if let Some(project) = &path {
            self.state.preferences.remember(project.clone());
        }
        let is_new = path.is_none() && !history.is_dirty();
        let document = history.document();
        self.state.selection = Selection::default();
        self.state.selection.frame =
            left.map_or(0, |left| left.frame).min(footage.frame_count().saturating_sub(1));
        let first = document.model.rotation_owners()[0];
        self.state.selection.joint = Selection::joint_of(&document.model, first);
        self.state.history = history;
        self.state.project = path;
        self.shell.docking.alone = None;
        self.shell.docking.pair = [0, 1.min(footage.cameras.len() - 1)];
        self.features.pose.reset();
        self.features.fit.pending_steps = 0;
        self.features.demonstrations = Demonstrations::default();
        self.features.camera_views.reset(footage.cameras.len());
        if let Some(TakeSource::Demonstration(which)) = &footage.source
            && is_new
        {
            self.with(
                |features| &mut features.demonstrations,
                |demonstrations, context, requests| demonstrations.begin(*which, context, requests),
            );
        }
    }
}

/// A new document about a take.
fn document_of(footage: &Footage) -> Document {
    let mut document = Document::new((**footage.model()).clone());
    document.take = footage.source.clone();
    document.start = Arc::new(footage.start());
    document.measurement = Arc::new(footage.measurement().to_vec());
    let camera = |camera: &Arc<backlit_tracking::camera::Camera>| CameraUse {
        name: camera.name().to_owned(),
        used: true,
        weight: 1.0,
    };
    let mut cameras: Vec<CameraUse> = footage.cameras.iter().map(camera).collect();
    if let Some(TakeSource::Demonstration(which)) = &footage.source {
        document.fit = Arc::new(which.fit());
        // As in the report: downhill, and nowhere else.
        document.tracking = TrackingChoices::of_preset(Some(Preset::Report));
        cameras.iter_mut().skip(which.used_cameras()).for_each(|camera| camera.used = false);
    }
    document.cameras = Arc::new(cameras);
    document
}
