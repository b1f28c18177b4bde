//! What panels read, and what they ask for.

pub(crate) mod activity;
pub(crate) mod arrangement;
pub(crate) mod camera_work;
pub mod clock;
pub mod command;
pub(crate) mod command_button;
pub(crate) mod feature;
pub(crate) mod file_dialog;
pub(crate) mod marks;
pub(crate) mod notices;
pub mod pane;
pub(crate) mod pane_title;
pub mod preferences;
pub(crate) mod priority;
pub(crate) mod request;
pub(crate) mod unavailable;
pub mod view_settings;
pub(crate) mod write_advice;

pub use request::Requests;
pub(crate) use request::{
    Decision, DesktopRequest, FeatureCard, FeatureRequest, PaneEvent, Request, SessionRequest, ShellRequest,
    Write,
};
pub(crate) use unavailable::{Unavailable, unavailable};

use std::path::Path;
use std::sync::Arc;

use backlit_document::Document;
use backlit_document::frame_trust::are_same;
use backlit_document::history::History;
use backlit_document::run::Run;
use backlit_document::runs::{Runs, StepRef};
use backlit_formats::Footage;
use backlit_formats::take::BodySizes;

use crate::context::activity::Activity;
use crate::context::clock::Clock;
use crate::context::marks::{
    DragMarks, FloorPicture, MotionMarks, ObservabilityMarks, ReferenceMark, SilhouetteMarks,
};
use crate::context::notices::Notices;
use crate::context::pane::Pane;
use crate::context::preferences::Preferences;
use crate::context::view_settings::ViewSettings;
use crate::session::Session;
use crate::session::playback::Playback;
use crate::session::prediction::{Derivatives, FitInputs};
use crate::session::selection::Selection;
use backlit_jobs::Pool;
use backlit_take::source::TakeSource;
use backlit_tracking::body::Pose;
use backlit_tracking::metrics::JointErrors;
use backlit_tracking::people::PersonTrack;
use backlit_ui::drawing::Ghosts;

/// All that a panel may look at while a frame is drawn.
#[derive(Debug, Clone)]
pub struct Context<'a> {
    /// The document with its past.
    pub(crate) history: &'a History,
    pub(crate) session: &'a Session,
    pub(crate) selection: &'a Selection,
    pub(crate) preferences: &'a Preferences,
    pub(crate) notices: &'a Notices,
    pub(crate) busy: Activity,
    /// Which derivatives the views show.
    pub(crate) derivatives: Derivatives,
    pub(crate) project: Option<&'a Path>,
    /// Whether a project was not opened since its take was not there.
    pub(crate) lacks_take: bool,
    /// The pane that fills the centre.
    pub(crate) alone: Option<Pane>,
    pub(crate) playback: &'a Playback,
    /// What all camera views share.
    pub(crate) views: ViewSettings,
    /// What goes on in the camera views.
    pub(crate) drag: DragMarks,
    /// What views and scene draw of what the cameras see.
    pub(crate) observability: &'a ObservabilityMarks,
    /// What the tracked motion is called.
    pub(crate) motions: &'a MotionMarks,
    /// What steers silhouettes.
    pub(crate) silhouettes: &'a SilhouetteMarks,
    /// Bodies that views and scene draw in the place of the posed one.
    pub(crate) ghosts: Option<&'a Ghosts>,
    /// The references that the poses are compared with, in the frame on the screen.
    pub(crate) references: &'a [ReferenceMark],
    /// The people to choose from, while one is to be chosen.
    pub(crate) people: &'a [PersonTrack],
    /// What lies on the floor of the scene.
    pub(crate) floor_picture: Option<&'a Arc<FloorPicture>>,
    pub(crate) clock: &'a Clock,
    /// The sentence of the status bar about what the hand is doing.
    pub(crate) doing: Option<&'a str>,
    /// Whether something lies over the window: the palette, a dialog.
    pub(crate) is_covered: bool,
    /// Whether work is offered that an earlier start of the program left unsaved.
    pub(crate) offers_unsaved_work: bool,
    pub(crate) unavailable: &'a Unavailable,
    pub(crate) can_restore_layout: bool,
    /// Time that the last frame of the window took, in seconds.
    pub(crate) frame_seconds: f64,
    /// Seconds since the window was opened.
    pub(crate) now: f64,
    pub(crate) pool: &'a Pool,
    pub(crate) egui: &'a egui::Context,
}

/// What features let views, scene and timeline draw.
#[derive(Debug, Default)]
pub(crate) struct Published {
    pub(crate) observability: ObservabilityMarks,
    pub(crate) motions: MotionMarks,
    pub(crate) silhouettes: SilhouetteMarks,
    pub(crate) references: Arc<Vec<ReferenceMark>>,
    pub(crate) ghosts: Option<Arc<Ghosts>>,
    pub(crate) people: Arc<Vec<PersonTrack>>,
    pub(crate) floor_picture: Option<Arc<FloorPicture>>,
}

impl<'a> Context<'a> {
    pub(crate) fn document(&self) -> &'a Document {
        self.history.document()
    }

    pub(crate) fn runs(&self) -> &'a Runs {
        self.history.runs()
    }

    /// The run whose step is on the screen, or else the newest one of the frame.
    pub(crate) fn run(&self) -> Option<&'a Run> {
        let shown = self.shown_step().and_then(|step| self.runs().get(step.run));
        shown.or_else(|| self.runs().newest_of(self.selection.frame))
    }

    /// The step on the screen: the one that is looked at, or the last one of the run that is going on, or the one whose pose is
    /// the frame's. A body that was moved since stands at none.
    pub(crate) fn shown_step(&self) -> Option<StepRef> {
        let frame = self.selection.frame;
        let going_on = || {
            let run = self.runs().get(self.busy.fitted_run?).filter(|run| run.frame == frame)?;
            Some(StepRef { run: run.number, step: run.last_step() })
        };
        let of_pose = || self.runs().last_step_with_pose(frame, self.document().pose_at(frame));
        self.selection.step.or_else(going_on).or_else(of_pose)
    }

    /// Whether there is work that is in no file and that somebody may want back: a demonstration is made again by a click.
    pub(crate) fn is_unsaved(&self) -> bool {
        let is_wanted = match self.document().take {
            Some(TakeSource::Demonstration(_)) => self.project.is_some(),
            Some(_) => true,
            None => false,
        };
        self.history.is_dirty() && is_wanted
    }

    /// The pose on the screen: that of the step that is looked at, or of the run that is going on, or the document's.
    pub(crate) fn shown_pose(&self) -> &'a Pose {
        let going_on = || {
            let run = self.runs().get(self.busy.fitted_run?)?;
            run.steps.last().filter(|_| run.frame == self.selection.frame)
        };
        let step = self.selection.step.and_then(|step| self.runs().step(step)).or_else(going_on);
        step.map_or_else(|| self.document().pose_at(self.selection.frame), |step| &step.iteration.point)
    }

    /// The frame whose pictures are on the screen, and the pose that is drawn over them: those of before, while the pictures of the
    /// frame that was gone to are read.
    pub(crate) fn pictured(&self) -> (usize, &'a Pose) {
        let (frame, session) = (self.selection.frame, self.session);
        let before = || {
            let predicted = session.predicted.as_deref()?;
            let (drawn, shown) = (predicted.scene.frame.as_ref()?, session.last_frame.as_ref()?);
            let is_whole =
                Arc::ptr_eq(drawn, shown) && Arc::ptr_eq(&predicted.scene.model, &self.document().model);
            (is_whole && shown.frame != frame).then_some((shown.frame, &predicted.pose))
        };
        before().filter(|_| !self.busy.load_broke).unwrap_or_else(|| (frame, self.shown_pose()))
    }

    /// The poses that rival the one on the screen with their weights, likeliest first, where they are to be seen.
    pub(crate) fn rivals(&self) -> Vec<(&'a Pose, f64)> {
        let (shown, frame) = (self.shown_pose(), self.selection.frame);
        if !self.views.rivals || self.drag.is_dragging() {
            return Vec::new();
        }
        let modes = self.document().modes(frame, shown).into_iter();
        modes.filter(|(pose, _)| !are_same(pose, shown)).collect()
    }

    /// Mean distance of a pose's joints from the take's reference at the frame on the screen, millimetres.
    pub(crate) fn joint_error_mm(&self, pose: &Pose) -> Option<f64> {
        let reference = self.session.take.as_ref()?.take().reference()?;
        let mut errors = JointErrors::default();
        errors.add(&self.document().model, pose, &reference.joints(self.selection.frame));
        errors.overall().map(|all| all.mean)
    }

    /// Whether a pane is on the screen.
    pub(crate) fn shows(&self, pane: Pane) -> bool {
        let is_open = || self.preferences.is_open(pane, self.session.camera_count());
        self.alone.map_or_else(is_open, |alone| alone == pane)
    }

    /// The name of the take, for files that are made of it.
    pub(crate) fn take_name(&self) -> &'a str {
        self.session.take.as_ref().map_or("project", |take| take.take().name())
    }

    /// Whether nothing says where the person stands: neither the take, nor the user, nor the tracker.
    pub(crate) fn lacks_start(&self) -> bool {
        let document = self.document();
        let is_known = |take: &Footage| take.take().start().is_some() || take.take().reference().is_some();
        self.session.take.as_ref().is_some_and(|take| !is_known(take))
            && document.keys.is_empty()
            && document.estimates.is_empty()
    }

    /// Whether the take has an average body, and nobody has found the person's own sizes yet.
    pub(crate) fn lacks_sizes(&self) -> bool {
        let document = self.document();
        self.session.take.as_ref().is_some_and(|take| {
            take.take().sizes() == BodySizes::Fit && *take.take().model() == document.model
        })
    }

    /// All that a prediction of the frame on the screen depends on, but the pose.
    pub(crate) fn fit_inputs(&self) -> Option<FitInputs> {
        let document = self.document();
        Some(FitInputs {
            model: document.model.clone(),
            cameras: self.session.take.as_ref()?.cameras.clone(),
            uses: document.cameras.clone(),
            fit: document.fit.clone(),
            frame: self.session.frames.get(self.selection.frame).cloned(),
            derivatives: self.derivatives,
        })
    }
}
