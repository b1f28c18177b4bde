//! What panels read, and what they ask for.

pub(crate) mod activity;
pub(crate) mod arrangement;
pub mod clock;
pub mod command;
pub(crate) mod command_button;
pub(crate) mod drag_marks;
pub(crate) mod file_dialog;
pub(crate) mod motions;
pub(crate) mod notices;
pub(crate) mod observability;
pub mod pane;
pub(crate) mod pane_title;
pub(crate) mod picture_alone;
pub mod preferences;
pub(crate) mod preset_box;
pub(crate) mod unavailable;
pub mod view_settings;
pub(crate) mod write_advice;

pub(crate) use unavailable::{Unavailable, unavailable};

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_document::Document;
use backlit_document::edit::Edit;
use backlit_document::history::{Gesture, History};
use backlit_document::run::Run;
use backlit_document::runs::{RunChange, Runs, StepRef};
use backlit_formats::take::BodySizes;
use backlit_take::footage::Footage;
use backlit_take::source::TakeSource;

use crate::context::activity::Activity;
use crate::context::arrangement::Arrangement;
use crate::context::clock::Clock;
use crate::context::command::{Command, Variants};
use crate::context::drag_marks::DragMarks;
use crate::context::motions::MotionMarks;
use crate::context::notices::Notices;
use crate::context::observability::ObservabilityMarks;
use crate::context::pane::Pane;
use crate::context::preferences::{Layout, Preferences};
use crate::context::view_settings::ViewSettings;
use crate::session::playback::{Playback, PlaybackChange};
use crate::session::prediction::{Derivatives, FitInputs, Predicted};
use crate::session::selection::Selection;
use crate::session::{BelievedJoints, FrameData, HeldLimbs, Session};
use backlit_jobs::{Failure, Pool};
use backlit_tracking::body::Pose;
use backlit_tracking::metrics::JointErrors;
use backlit_ui::drawing::{DragEvent, Ghosts, JointId, ViewMode};

/// All that a panel may look at while a frame is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    /// The document with its past.
    pub(crate) history: &'a History,
    /// Derived data.
    pub(crate) session: &'a Session,
    /// What is selected.
    pub(crate) selection: &'a Selection,
    /// The arrangement.
    pub(crate) preferences: &'a Preferences,
    /// What was said.
    pub(crate) notices: &'a Notices,
    /// Work in progress.
    pub(crate) busy: Activity,
    /// Which derivatives the views show.
    pub(crate) derivatives: Derivatives,
    /// The project file, if there is one.
    pub(crate) project: Option<&'a Path>,
    /// Whether a project was not opened since its take was not there.
    pub(crate) lacks_take: bool,
    /// The pane that fills the centre.
    pub(crate) alone: Option<Pane>,
    /// How frames are played.
    pub(crate) playback: &'a Playback,
    /// What all camera views share.
    pub(crate) views: ViewSettings,
    /// What goes on in the camera views.
    pub(crate) drag: DragMarks<'a>,
    /// What views and scene draw of what the cameras see.
    pub(crate) observability: &'a ObservabilityMarks,
    /// What the tracked motion is called.
    pub(crate) motions: &'a MotionMarks,
    /// Bodies that views and scene draw in the place of the posed one.
    pub(crate) ghosts: Option<&'a Ghosts>,
    /// What time it is.
    pub(crate) clock: &'a Clock,
    /// The sentence of the status bar about what the hand is doing.
    pub(crate) doing: Option<&'a str>,
    /// Whether something lies over the window: the palette, a dialog.
    pub(crate) is_covered: bool,
    /// Whether work is offered that an earlier start of the program left unsaved.
    pub(crate) offers_unsaved_work: bool,
    /// What cannot be used in this frame.
    pub(crate) unavailable: &'a Unavailable,
    /// Whether a change of the layout can be taken back.
    pub(crate) can_restore_layout: bool,
    /// Time that the last frame of the window took, in seconds.
    pub(crate) frame_seconds: f64,
    /// Seconds since the window was opened.
    pub(crate) now: f64,
    /// The threads, for the features' tasks.
    pub(crate) pool: &'a Pool,
    /// The window's own context.
    pub(crate) egui: &'a egui::Context,
}

impl<'a> Context<'a> {
    pub(crate) fn document(&self) -> &'a Document {
        self.history.document()
    }

    /// The runs of the fit.
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

    /// The pose on the screen: that of the step that is looked at, or of the run that is going on, or the document's.
    pub(crate) fn shown_pose(&self) -> &'a Pose {
        let going_on = || {
            let run = self.runs().get(self.busy.fitted_run?)?;
            run.steps.last().filter(|_| run.frame == self.selection.frame)
        };
        let step = self.selection.step.and_then(|step| self.runs().step(step)).or_else(going_on);
        step.map_or_else(|| self.document().pose_at(self.selection.frame), |step| &step.iteration.point)
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
        self.session.take.as_ref().map_or("project", |take| take.name.as_str())
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
        self.session
            .take
            .as_ref()
            .is_some_and(|take| take.take().sizes() == BodySizes::Fit && *take.model() == document.model)
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

/// Something a panel asks for that is neither an edit nor a command of its own.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Request {
    /// Go to a frame: a fit that is going on ends, and the tracker is followed no more.
    Frame(usize),
    /// Go to a frame while a fit goes on; the tracker is followed no more.
    Visit(usize),
    /// Go on to the frame that the tracker has reached.
    Follow(usize),
    /// Hold a joint.
    Joint(JointId),
    /// Make a camera's tile the active one.
    Camera(usize),
    /// Look at a step of a run.
    Step(StepRef),
    /// Leave the step that is looked at: the pose is the document's again.
    LeaveStep,
    /// Something happens to the runs of the fit.
    Runs(RunChange),
    /// Stop a fit that is going on: what it has done stays.
    InterruptFit,
    /// Show another camera in the tile of one.
    SwitchCamera {
        /// The camera whose tile it is.
        from: usize,
        /// The camera that is shown there.
        to: usize,
    },
    /// Something is dragged in a camera's view.
    Drag(usize, DragEvent),
    /// Undo all of a gesture that goes on, as if it had not begun.
    CancelGesture(Gesture),
    /// Look at the size of this limb, of those that turn with the held joint.
    Part(usize),
    /// What all camera views share.
    Views(ViewSettings),
    /// Show a mode alone in all views of a layout.
    ShowMode(Layout, ViewMode),
    /// How the window is arranged.
    Layout(Layout),
    /// Show all tiles again, if one fills the window.
    ShowAllTiles,
    /// Run fits in the laboratory as soon as they have begun.
    RunLaboratory {
        /// What they differ in.
        over: Variants,
        /// The camera whose pictures are shown from now on.
        camera: Option<usize>,
    },
    /// What the user did with a tile.
    Pane(Pane, PaneEvent),
    /// The user has arranged the tiles.
    Arrange(Box<Arrangement>),
    /// Open a take.
    Open(TakeSource),
    /// Close all notices.
    CloseNotices,
    /// Close a notice.
    CloseNotice(u64),
    /// Close the notices that begin so: that is over.
    CloseNoticesAbout(&'static str),
    /// A notice is under the pointer: it stays.
    HoldNotice(u64),
    /// Change how frames are played.
    Playback(PlaybackChange),
    /// What to do with work that an earlier start of the program left unsaved.
    Recover(Decision),
    /// Show it over the window.
    RecoveryCard,
    /// Open whatever a path is.
    OpenPath(PathBuf),
    /// Take a path off the list of recent takes.
    ForgetRecent(PathBuf),
    /// Copy a text, and say what it was.
    Copy(&'static str, String),
    /// Open a page or a folder in another program.
    OpenOutside(String),
    /// A command was chosen in the palette.
    Used(Command),
    /// Lay the card of a new take over the window.
    NewTakeCard,
    /// So many megabytes may be taken by frames that were read.
    FramesMb(usize),
    /// The card on which cameras are shifted.
    OffsetsCard,
    /// Close what lies over the window.
    CloseCard,
    /// Lay the card of the export over the window.
    ExportCard,
    /// Begin the export that was put together on its card.
    Export,
    /// Say in the status bar what was just done, or nothing any more.
    Status(Option<String>),
    /// Say something on a card, with a command that goes on from there.
    Inform(String, Option<Command>),
    /// Say what went wrong, with a command that helps.
    Complain(String, Option<Command>),
}

/// A file to be written, and what makes its bytes on the thread that writes.
pub(crate) struct Write {
    /// The file.
    pub(crate) path: PathBuf,
    /// Makes the bytes.
    pub(crate) make: Box<dyn FnOnce() -> anyhow::Result<Vec<u8>> + Send>,
}

impl std::fmt::Debug for Write {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Write").field("path", &self.path).finish_non_exhaustive()
    }
}

/// What the user decides about work that was left, by its place in the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decision {
    /// Go on with it.
    Restore(usize),
    /// Offer it no more.
    Discard(usize),
    /// Offer none of it any more.
    DiscardAll,
    /// Keep all of it.
    Later,
}

/// What the user did with a tile, whatever stands in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PaneEvent {
    /// Asked for it in the whole window, or back.
    ToggleAlone,
    /// Opened it, or brought it before what it shares tabs with.
    Open,
    /// Closed it; its place is kept.
    Close,
}

/// What the panels ask for in one frame.
#[derive(Debug, Default)]
pub(crate) struct Requests {
    /// Changes of the document, each with its gesture.
    pub(crate) edits: Vec<(Edit, Option<Gesture>)>,
    pub(crate) commands: Vec<Command>,
    /// Everything else.
    pub(crate) others: Vec<Request>,
    /// What the pose on the screen predicts, where who changes the pose knows it already.
    pub(crate) predicted: Option<Arc<Predicted>>,
    /// Files to be written.
    pub(crate) writes: Vec<Write>,
    /// Frames that were read on the way, and that panels may show.
    pub(crate) frames: Vec<Arc<FrameData>>,
    /// What a Kalman filter believed of frames.
    pub(crate) beliefs: Vec<(usize, BelievedJoints)>,
    /// What held the limbs of frames.
    pub(crate) held: Vec<(usize, HeldLimbs)>,
}

impl Requests {
    /// Asks for a change that is undone by itself.
    pub(crate) fn edit(&mut self, edit: Edit) {
        self.edits.push((edit, None));
    }

    /// Asks for a change that is part of a drag.
    pub(crate) fn drag(&mut self, edit: Edit, gesture: Gesture) {
        self.edits.push((edit, Some(gesture)));
    }

    /// Asks for a command.
    pub(crate) fn run(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// Says in the status bar what was just done.
    pub(crate) fn status(&mut self, text: impl Into<String>) {
        self.request(Request::Status(Some(text.into())));
    }

    /// Says something on a card, with a command that goes on from there.
    pub(crate) fn inform(&mut self, text: impl Into<String>, next: Option<Command>) {
        self.request(Request::Inform(text.into(), next));
    }

    /// Says what went wrong.
    pub(crate) fn complain(&mut self, text: impl Into<String>) {
        self.request(Request::Complain(text.into(), None));
    }

    /// Says that a job broke down, and what it was doing, as the beginning of a sentence.
    pub(crate) fn failed(&mut self, doing: &str, failure: &Failure) {
        self.complain(format!("{doing} broke down: {failure}. Your work is unharmed."));
    }

    /// Has a file written; `make` makes its bytes on the thread that writes.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        make: impl FnOnce() -> anyhow::Result<Vec<u8>> + Send + 'static,
    ) {
        self.writes.push(Write { path: path.to_owned(), make: Box::new(make) });
    }

    /// Asks for something else.
    pub(crate) fn request(&mut self, request: Request) {
        self.others.push(request);
    }
}
