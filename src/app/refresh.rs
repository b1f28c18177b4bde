//! What the screen lacks is asked of the worker.

use std::sync::Arc;

use super::App;
use crate::app::calibrate_job::CalibrateJob;
use crate::app::load_job::LoadJob;
use crate::app::survey_job::SurveyJob;
use crate::session::prediction::PredictJob;
use crate::take::footage::Footage;
use crate::worker::Lane;

impl App {
    /// Asks for the frame and for the prediction on the screen, where they are missing or old.
    pub(crate) fn request_jobs(&mut self) {
        self.state.session.is_stepping = self.worker.is_busy(Lane::Fit);
        self.follow_replacements();
        let Some(take) = self.state.session.take.clone() else { return };
        let frame = self.state.selection.frame;
        let measurement = self.document().measurement.clone();
        let is_missing = self.state.session.frames.get(frame).is_none();
        if let Some(shown) = self.state.session.frames.get(frame) {
            self.state.session.last_frame = Some(shown.clone());
        }
        let may_load = self.may_ask(Lane::Load);
        if is_missing
            && may_load
            && !(self.worker.is_busy(Lane::Load) && self.state.session.loading == Some(frame))
        {
            self.state.session.loading = Some(frame);
            self.worker.request(Lane::Load, LoadJob::new(take.clone(), measurement.clone(), frame));
        }
        if !is_missing
            && may_load
            && !self.worker.is_busy(Lane::Load)
            && let Some(ahead) = self.with(
                |features| &mut features.timeline,
                |timeline, context, _| timeline.frame_to_read_ahead(context),
            )
        {
            self.state.session.loading = Some(ahead);
            self.worker.request(Lane::Load, LoadJob::new(take.clone(), measurement.clone(), ahead));
        }
        let may_survey = !is_missing && self.may_ask(Lane::Survey) && !self.worker.is_busy(Lane::Survey);
        if self.state.session.subject.is_empty() && may_survey {
            self.worker.request(Lane::Survey, SurveyJob::new(take, measurement));
        }
        self.request_prediction();
        self.request_hull();
    }

    /// The footage follows the document's calibration and silhouettes, also where they are undone. Frames that were made
    /// with others, or with other settings of the measurement, are made anew.
    fn follow_replacements(&mut self) {
        let Some(take) = self.state.session.take.clone() else { return };
        let (calibration, masks) = (self.document().calibration.clone(), self.document().masks.clone());
        if take.calibration != calibration {
            if !self.worker.is_busy(Lane::Calibrate) && self.may_ask(Lane::Calibrate) {
                self.worker.request(Lane::Calibrate, CalibrateJob { footage: take.clone(), calibration });
            }
        } else if take.masks != masks {
            self.state.session.take = Some(Arc::new(take.with_masks(masks)));
        }
        let measurement = self.document().measurement.clone();
        if let Some(take) = &self.state.session.take {
            self.state
                .session
                .frames
                .retain(|data| data.made_with == take.made_with(&measurement, data.frame));
        }
    }

    /// The cameras are others now.
    pub(crate) fn recalibrated(&mut self, footage: Arc<Footage>) {
        let is_wanted = footage.calibration == self.document().calibration;
        let is_open = self.state.session.take.as_ref().is_some_and(|take| take.source == footage.source);
        if is_wanted && is_open {
            self.interrupt_fit();
            self.state.session.take = Some(footage);
            self.state.session.subject.clear();
            self.state.session.generation += 1;
        }
    }

    fn request_prediction(&mut self) {
        let Some(scene) = self.scene() else { return };
        let pose = self.shown_pose().clone();
        let shown = self.state.session.predicted.clone();
        self.state.session.is_stale = !shown.as_ref().is_some_and(|shown| shown.is_of(&scene, &pose));
        if !self.state.session.is_stale || !self.may_ask(Lane::Predict) {
            return;
        }
        let wanted = self.state.session.wanted.as_ref();
        let is_coming = self.worker.is_busy(Lane::Predict)
            && wanted.is_some_and(|(other, other_pose)| {
                *other_pose == pose && other.is(&scene) && other.derivatives == scene.derivatives
            });
        if !is_coming {
            self.state.session.wanted = Some((scene.clone(), pose.clone()));
            self.worker.request(Lane::Predict, PredictJob { scene, pose, earlier: shown });
        }
    }
}
