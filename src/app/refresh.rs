//! What the screen lacks is made: the frame, its prediction, footage for other cameras, a look at the whole take.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_formats::footage::MadeWith;
use backlit_formats::footage::replacement::{Calibration, PlateFiles};
use backlit_jobs::{Task, once};
use backlit_tracking::people::FollowedPerson;
use backlit_tracking::segment::SegmentOptions;

use super::Inspector;
use super::survey_job::SurveyJob;
use crate::context::priority;
use crate::session::prediction::{PosedInputs, Predicted};
use crate::session::{Extent, FrameData};

/// A frame that was read waits for its prediction for at most so many seconds.
const LONGEST_HELD: f64 = 0.1;

/// What the footage is made again for.
type Replacements = (Option<Arc<Calibration>>, Arc<PlateFiles>, Option<Arc<FollowedPerson>>);

/// The tasks whose results the session holds.
#[derive(Debug, Default)]
pub(crate) struct Refresh {
    pub(crate) frame: Task<(usize, MadeWith), Arc<FrameData>, { priority::FRAME }>,
    pub(crate) prediction: Task<PosedInputs, Arc<Predicted>, { priority::PREDICTION }>,
    pub(crate) survey: Task<Arc<Vec<SegmentOptions>>, Vec<Option<Extent>>, { priority::SURVEY }>,
    replaced: Task<Replacements, Arc<Footage>, { priority::CALIBRATION }>,
}

impl Inspector {
    /// Takes in what was made for the screen.
    pub(crate) fn take_in_refreshed(&mut self) {
        let frame = self.state.selection.frame;
        let (refresh, session, notices) =
            (&mut self.refresh, &mut self.state.session, &mut self.state.notices);
        for frame in notices.outputs("Reading the frame", &mut refresh.frame) {
            session.keep_frame(frame);
        }
        for predicted in notices.outputs("Drawing the silhouettes of the pose", &mut refresh.prediction) {
            session.predict_seconds = Some(predicted.seconds);
            // Pictures and body change together.
            if let Some(drawn) = predicted.scene.frame.as_ref().filter(|drawn| drawn.frame == frame) {
                session.show(drawn.clone());
            }
            session.predicted = Some(predicted);
            session.generation += 1;
        }
        for extents in notices.outputs("Looking through the whole take", &mut refresh.survey) {
            session.subject = extents;
        }
        let doing = "Reading the footage with the new cameras, plates or person";
        for footage in notices.outputs(doing, &mut refresh.replaced) {
            self.replaced(footage);
        }
    }

    /// Asks for the frame and for the prediction on the screen, where they are missing or old.
    pub(crate) fn refresh(&mut self) {
        self.follow_replacements();
        let Some(take) = self.state.session.take.clone() else { return };
        let frame = self.state.selection.frame;
        let shown = self.state.session.frames.get(frame).cloned();
        let is_missing = shown.is_none();
        if is_missing {
            self.read_frame(&take, frame);
        } else {
            if !self.waits_for_prediction(frame) {
                shown.into_iter().for_each(|shown| self.state.session.show(shown));
            }
            if !self.refresh.frame.is_busy() && self.refresh.frame.failure().is_none() {
                let (context, features, _) = self.split();
                if let Some(ahead) = features.timeline.frame_to_read_ahead(&context) {
                    self.read_frame(&take, ahead);
                }
            }
            if self.state.session.subject.is_empty() {
                let measurement = self.document().measurement.clone();
                let pool = &self.state.pool;
                self.refresh
                    .survey
                    .ask(pool, measurement, |measurement| SurveyJob::new(take, measurement.clone()));
            }
        }
        self.refresh_prediction();
    }

    fn read_frame(&mut self, take: &Arc<Footage>, frame: usize) {
        let measurement = self.document().measurement.clone();
        let inputs = (frame, take.made_with(&measurement, frame));
        let take = take.clone();
        let read = |_: &_| once(move |_| Arc::new(take.load_frame(&measurement, frame)));
        self.refresh.frame.need(&self.state.pool, inputs, read);
    }

    /// The footage follows the document's calibration, plates, person and silhouettes, also where they are undone. Frames that were made
    /// with others, or with other settings of the measurement, are made again.
    fn follow_replacements(&mut self) {
        let Some(take) = self.state.session.take.clone() else { return };
        let document = self.document();
        let (masks, brush) = (document.masks.clone(), document.brush.clone());
        let changes = document.changes.clone();
        let wanted = (document.calibration.clone(), document.plates.clone(), document.person.clone());
        if (&take.calibration, &take.plates, take.take().person())
            != (&wanted.0, &wanted.1, wanted.2.as_ref())
        {
            // The tables that take a lens out of a picture take their time.
            self.refresh.replaced.need(&self.state.pool, wanted, |replacements| {
                let (take, (calibration, plates, person)) = (take.clone(), replacements.clone());
                once(move |_| Arc::new(take.with_replacements(calibration, plates, person)))
            });
        } else if (&take.masks, &take.brush, &take.changes) != (&masks, &brush, &changes) {
            let mut steered = take.with_changes(changes);
            (steered.masks, steered.brush) = (masks, brush);
            self.state.session.take = Some(Arc::new(steered));
        }
        let measurement = self.document().measurement.clone();
        if let Some(take) = &self.state.session.take {
            self.state
                .session
                .frames
                .retain(|data| data.made_with == take.made_with(&measurement, data.frame));
        }
    }

    /// The cameras, the plates or the person are others now.
    fn replaced(&mut self, footage: Arc<Footage>) {
        let document = self.document();
        let is_wanted = footage.calibration == document.calibration
            && footage.plates == document.plates
            && footage.take().person() == document.person.as_ref();
        let is_open = self.state.session.take.as_ref().is_some_and(|take| take.shares_take_with(&footage));
        if is_wanted && is_open {
            self.interrupt_fit();
            self.state.session.take = Some(footage);
            self.state.session.subject.clear();
            self.refresh.survey.forget();
            self.state.session.generation += 1;
        }
    }

    /// Whether a frame that was read is still to be shown together with its prediction: not for long, so that frames that come
    /// faster than predictions are seen.
    fn waits_for_prediction(&mut self, frame: usize) -> bool {
        let (session, now) = (&mut self.state.session, self.state.now);
        let is_other = session.last_frame.as_ref().is_some_and(|last| last.frame != frame);
        let is_drawn = session.predicted.as_ref().is_some_and(|predicted| {
            predicted
                .scene
                .frame
                .as_ref()
                .zip(session.last_frame.as_ref())
                .is_some_and(|(a, b)| Arc::ptr_eq(a, b))
        });
        if !is_other || !is_drawn || self.refresh.prediction.failure().is_some() {
            session.waits_since = None;
            return false;
        }
        let since = *session.waits_since.get_or_insert(now);
        now - since < LONGEST_HELD
    }

    fn refresh_prediction(&mut self) {
        let Some(inputs) = self.context().fit_inputs() else { return };
        let is_reading = self.state.session.frames.get(self.state.selection.frame).is_none();
        if is_reading && self.context().pictured().0 != self.state.selection.frame {
            // The body does not go ahead of the pictures that it is drawn over.
            self.state.session.is_stale = true;
            return;
        }
        let pose = self.shown_pose().clone();
        let shown = self.state.session.predicted.clone();
        self.state.session.is_stale = !shown.as_ref().is_some_and(|shown| shown.is_of(&inputs, &pose));
        if self.state.session.is_stale {
            let posed = PosedInputs { inputs, pose };
            let views = self.features.camera_views.pictures(&self.context());
            let predict = |posed: &PosedInputs| {
                let posed = posed.clone();
                once(move |_| {
                    let predicted = Predicted::new(&posed.inputs, &posed.pose, shown.as_deref());
                    Arc::new(predicted.with_pictures(&views))
                })
            };
            self.refresh.prediction.need(&self.state.pool, posed, predict);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::app::testing::{Breaks, open, open_take};
    use crate::context::preferences::Layout;
    use backlit_document::edit::Edit;
    use backlit_take::demonstration::Demonstration;

    #[test]
    fn what_begins_by_itself_is_tried_again_after_a_change_and_not_before() {
        let mut app = open(Layout::Pose);
        let mut pose = app.shown_pose().clone();
        pose.root.x += 0.01;
        app.state.edit(Edit::SetPose { frame: 0, pose: pose.clone(), what: "Move".to_owned() }, None);
        let posed = super::PosedInputs { inputs: app.context().fit_inputs().unwrap(), pose: pose.clone() };
        app.break_down(|all, pool| all.refresh.prediction.begin(pool, posed, |_| Breaks));
        assert!(app.refresh.prediction.failure().is_some() && app.state.session.is_stale);
        assert_eq!(app.errors().len(), 1, "it is said once");
        pose.root.x += 0.01;
        app.state.edit(Edit::SetPose { frame: 0, pose, what: "Move".to_owned() }, None);
        app.settle();
        assert!(!app.state.session.is_stale, "it is drawn now");
    }

    #[test]
    fn the_body_stays_in_its_pictures_until_those_of_the_next_frame_are_there() {
        let mut app = open_take(Demonstration::Spheres, Layout::Pose);
        let poses = [0, 1].map(|frame| app.document().pose_at(frame).clone());
        assert_ne!(poses[0], poses[1]);
        app.state.session.frames.clear();
        app.state.go_to_frame(1);
        app.refresh();
        assert_eq!(app.context().pictured(), (0, &poses[0]));
        assert_eq!(app.state.session.predicted.as_ref().unwrap().pose, poses[0]);
        app.settle();
        assert_eq!(app.context().pictured(), (1, &poses[1]));
        assert_eq!(app.state.session.predicted.as_ref().unwrap().pose, poses[1]);
    }

    #[test]
    fn a_frame_that_cannot_be_read_is_said_once_and_nothing_waits_for_it() {
        let mut app = open(Layout::Pose);
        app.break_down(|all, pool| all.refresh.frame.begin(pool, (0, Default::default()), |_| Breaks));
        assert_eq!(app.errors(), ["Reading the frame broke down: thirteen. Your work is unharmed."]);
    }
}
