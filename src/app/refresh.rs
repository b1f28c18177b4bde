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
use crate::session::prediction::{FitInputs, PosedInputs, Predicted};
use crate::session::{Extent, FrameData};

/// A frame that was read waits for its prediction for at most so many seconds: its pictures would else be made on the window's thread.
const LONGEST_HELD: f64 = 1.0;

/// What the footage is made again for.
type Replacements = (Option<Arc<Calibration>>, Arc<PlateFiles>, Option<Arc<FollowedPerson>>);

/// The tasks whose results the session holds.
#[derive(Debug, Default)]
pub(crate) struct Refresh {
    pub(crate) frame: Task<(usize, MadeWith), Arc<FrameData>, { priority::FRAME }>,
    pub(crate) prediction: Task<PosedInputs, Arc<Predicted>, { priority::PREDICTION }>,
    /// The prediction before the one on the screen, while a drag goes on: the next is drawn in its memory.
    spare: Option<Arc<Predicted>>,
    pub(crate) survey: Task<Arc<Vec<SegmentOptions>>, Vec<Option<Extent>>, { priority::SURVEY }>,
    replaced: Task<Replacements, Arc<Footage>, { priority::CALIBRATION }>,
}

impl Inspector {
    /// Takes in what was made for the screen.
    pub(crate) fn take_in_refreshed(&mut self) {
        let (frame, is_playing) = (self.state.selection.frame, self.state.playback.is_playing());
        let (refresh, session, notices) =
            (&mut self.refresh, &mut self.state.session, &mut self.state.notices);
        for frame in notices.outputs("Reading the frame", &mut refresh.frame) {
            session.keep_frame(frame);
        }
        for predicted in notices.outputs("Drawing the silhouettes of the pose", &mut refresh.prediction) {
            session.predict_seconds = Some(predicted.seconds);
            // Pictures and body change together.
            let is_shown = |drawn: &&Arc<FrameData>| drawn.frame == frame || is_playing;
            if let Some(drawn) = predicted.scene.frame.as_ref().filter(is_shown) {
                session.show(drawn.clone());
            }
            refresh.spare = session.predicted.replace(predicted);
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
        self.follow_views();
        self.refresh_prediction();
    }

    /// Keeps what the views show where predictions are made.
    fn follow_views(&mut self) {
        let views = self.features.camera_views.pictures(&self.context());
        if *self.state.session.viewed != views {
            self.state.session.viewed = Arc::new(views);
        }
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
        if !self.state.egui.input(|input| input.pointer.any_down()) {
            self.refresh.spare = None;
        }
        if self.state.session.is_stale && !self.lets_draw(&inputs) {
            let posed = PosedInputs { inputs, pose };
            let views = self.state.session.viewed.clone();
            let spare = &mut self.refresh.spare;
            let predict = |posed: &PosedInputs| {
                let (posed, spare) = (posed.clone(), spare.take());
                once(move |_| {
                    let spare = spare.and_then(Arc::into_inner);
                    Arc::new(Predicted::with_pictures(&posed, &views, shown.as_deref(), spare))
                })
            };
            self.refresh.prediction.need(&self.state.pool, posed, predict);
        }
    }

    /// Whether a pose of the same scene, or of a frame that is played, is being drawn. It is let be: a hand that never rests, or a
    /// film that is faster than predictions, would else show nothing.
    fn lets_draw(&self, inputs: &FitInputs) -> bool {
        let drawn = self.refresh.prediction.inputs().filter(|_| self.refresh.prediction.is_busy());
        let is_alike = |drawn: &FitInputs| drawn.is(inputs) && drawn.derivatives == inputs.derivatives;
        drawn.is_some_and(|drawn| self.state.playback.is_playing() || is_alike(&drawn.inputs))
    }
}

#[cfg(test)]
mod tests {
    use crate::app::testing::{Breaks, TestWindow, open, open_take};
    use crate::context::preferences::Layout;
    use backlit_document::edit::Edit;
    use backlit_take::demonstration::Demonstration;
    use backlit_ui::drawing::{ViewMode, ViewedPicture};

    use crate::session::prediction::{PosedInputs, Predicted};

    #[test]
    fn what_begins_by_itself_is_tried_again_after_a_change_and_not_before() {
        let mut app = open(Layout::Pose);
        let mut pose = app.shown_pose().clone();
        pose.root.x += 0.01;
        app.state.edit(Edit::SetPose { frame: 0, pose: pose.clone(), what: "Move".to_owned() }, None);
        let posed = PosedInputs { inputs: app.context().fit_inputs().unwrap(), pose: pose.clone() };
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

    /// In every mode of the views, from pose to pose, with derivatives and without.
    #[test]
    fn predictions_in_used_memory_are_as_in_new() {
        let app = open_take(Demonstration::Spheres, Layout::Pose);
        let mut inputs = app.context().fit_inputs().unwrap();
        let mut spare = None;
        for (index, shift) in [0.0, 0.15, -0.2, -0.2, 0.4, 9.0, 0.1].into_iter().enumerate() {
            inputs.derivatives.gradient = index > 2;
            inputs.derivatives.column = (index > 3).then_some(index);
            let mut pose = app.shown_pose().clone();
            pose.root.x += shift;
            let posed = PosedInputs { inputs: inputs.clone(), pose };
            let modes = ViewMode::ALL
                .map(|mode| [true, false].map(|is_over| ViewedPicture { mode, is_over_footage: is_over }));
            let views = vec![modes.concat(); inputs.cameras.len()];
            let new = Predicted::with_pictures(&posed, &views, None, None);
            let used = Predicted::with_pictures(&posed, &views, None, spare.take());
            assert_eq!((used.mismatch, used.rms, used.iou()), (new.mismatch, new.rms, new.iou()));
            assert_eq!(used.mismatch_by_limb, new.mismatch_by_limb);
            for (used, new) in used.cameras.iter().zip(&new.cameras) {
                assert_eq!((&used.prediction, &used.outlines), (&new.prediction, &new.outlines));
                assert_eq!((&used.gradient, &used.jacobian), (&new.gradient, &new.jacobian));
            }
            for (used, new) in used.pictures.iter().flatten().zip(new.pictures.iter().flatten()) {
                assert!(used.image == new.image, "{:?}, pose {index}", new.shows);
            }
            assert_eq!(used.pictures.concat().len(), views.concat().len());
            assert_eq!(used.mismatch, inputs.measure(&posed.pose).mismatch);
            spare = Some(used);
        }
    }

    #[test]
    fn the_mismatch_is_the_weighted_sum_over_all_pixels() {
        let app = open(Layout::Pose);
        let predicted = app.state.session.predicted.clone().unwrap();
        let (mut sum, mut weight) = (0.0, 0.0);
        for (camera, used) in predicted.cameras.iter().zip(predicted.scene.uses.iter()) {
            let data = camera.data.as_ref().unwrap().measurement();
            let pixels = data.values().iter().zip(data.weights()).zip(&camera.prediction.lambda);
            for ((value, pixel_weight), lambda) in pixels {
                let pixel_weight = used.weight * f64::from(*pixel_weight);
                sum += pixel_weight * (f64::from(*value) - f64::from(*lambda)).powi(2);
                weight += pixel_weight;
            }
        }
        assert!(sum > 0.0 && (predicted.mismatch / sum - 1.0).abs() < 1e-12, "{} {sum}", predicted.mismatch);
        assert!((predicted.rms.unwrap() / (sum / weight).sqrt() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_hand_that_never_rests_sees_what_its_pose_predicts() {
        let mut app = open(Layout::Pose);
        let move_on = |app: &mut TestWindow| {
            let mut pose = app.shown_pose().clone();
            pose.root.x += 0.01;
            app.state.edit(Edit::SetPose { frame: 0, pose: pose.clone(), what: "Move".to_owned() }, None);
            app.refresh();
            pose
        };
        let first = move_on(&mut app);
        move_on(&mut app);
        app.state.pool.turn();
        app.take_in_refreshed();
        assert_eq!(app.state.session.predicted.as_ref().unwrap().pose, first);
    }

    #[test]
    fn a_frame_that_cannot_be_read_is_said_once_and_nothing_waits_for_it() {
        let mut app = open(Layout::Pose);
        app.break_down(|all, pool| all.refresh.frame.begin(pool, (0, Default::default()), |_| Breaks));
        assert_eq!(app.errors(), ["Reading the frame broke down: thirteen. Your work is unharmed."]);
    }
}
