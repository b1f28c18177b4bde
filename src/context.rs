//! What panels read, and what they ask for.

pub mod activity;
pub mod arrangement;
pub mod clock;
pub mod command;
pub(crate) mod command_button;
pub(crate) mod drag_marks;
pub(crate) mod file_dialog;
pub mod notices;
pub mod observability;
pub mod pane;
pub(crate) mod pane_title;
pub(crate) mod picture_alone;
pub mod preferences;
pub(crate) mod preset_box;
pub(crate) mod unavailable;
pub mod view_settings;
pub mod write_advice;

pub use unavailable::{Unavailable, unavailable};

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::context::activity::Activity;
use crate::context::arrangement::Arrangement;
use crate::context::clock::Clock;
use crate::context::command::Command;
use crate::context::drag_marks::DragMarks;
use crate::context::notices::Notices;
use crate::context::observability::ObservabilityMarks;
use crate::context::pane::Pane;
use crate::context::preferences::{Layout, Preferences};
use crate::context::view_settings::ViewSettings;
use crate::document::Document;
use crate::document::edit::Edit;
use crate::document::history::{Gesture, History};
use crate::drawing::{DragEvent, JointId, ViewMode};
use crate::features::convergence::CurvesRequest;
use crate::jobs::{Failure, Pool};
use crate::session::playback::{Playback, PlaybackChange};
use crate::session::prediction::{Derivatives, FitInputs};
use crate::session::selection::{Selection, StepRef};
use crate::session::{FrameData, Session};
use crate::take::source::TakeSource;
use backlit_tracking::body::Pose;

/// All that a panel may look at while a frame is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// The document with its past.
    pub history: &'a History,
    /// Derived data.
    pub session: &'a Session,
    /// What is selected.
    pub selection: &'a Selection,
    /// The arrangement.
    pub preferences: &'a Preferences,
    /// What was said.
    pub notices: &'a Notices,
    /// Work in progress.
    pub busy: Activity,
    /// The project file, if there is one.
    pub project: Option<&'a Path>,
    /// Whether a project was not opened since its take was not there.
    pub lacks_take: bool,
    /// The pane that fills the centre.
    pub alone: Option<Pane>,
    /// How frames are played.
    pub playback: &'a Playback,
    /// What all camera views share.
    pub views: ViewSettings,
    /// What goes on in the camera views.
    pub(crate) drag: DragMarks<'a>,
    /// What views and scene draw of what the cameras see.
    pub observability: &'a ObservabilityMarks,
    /// What time it is.
    pub clock: &'a Clock,
    /// The sentence of the status bar about what the hand is doing.
    pub doing: Option<&'a str>,
    /// Whether something lies over the window: the palette, a dialog.
    pub is_covered: bool,
    /// Whether work is offered that an earlier start of the program left unsaved.
    pub offers_unsaved_work: bool,
    /// What cannot be used in this frame.
    pub unavailable: &'a Unavailable,
    /// Whether a change of the layout can be taken back.
    pub can_restore_layout: bool,
    /// Time that the last frame of the window took, in seconds.
    pub frame_seconds: f64,
    /// Seconds since the window was opened.
    pub now: f64,
    /// The threads, for the features' tasks.
    pub pool: &'a Pool,
    /// The window's own context.
    pub egui: &'a egui::Context,
}

impl<'a> Context<'a> {
    /// The document.
    #[must_use]
    pub fn document(&self) -> &'a Document {
        self.history.document()
    }

    /// The pose on the screen.
    #[must_use]
    pub fn shown_pose(&self) -> &'a Pose {
        self.session.shown_pose(self.document(), self.selection)
    }

    /// Whether a pane is on the screen.
    #[must_use]
    pub fn shows(&self, pane: Pane) -> bool {
        let is_open = || self.preferences.is_open(pane, self.session.camera_count());
        self.alone.map_or_else(is_open, |alone| alone == pane)
    }

    /// The name of the take, for files that are made of it.
    #[must_use]
    pub fn take_name(&self) -> &'a str {
        self.session.take.as_ref().map_or("project", |take| take.name.as_str())
    }

    /// All that a prediction of the frame on the screen depends on, but the pose; without derivatives.
    #[must_use]
    pub fn fit_inputs(&self) -> Option<FitInputs> {
        let document = self.document();
        Some(FitInputs {
            model: document.model.clone(),
            cameras: self.session.take.as_ref()?.cameras.clone(),
            uses: document.cameras.clone(),
            fit: document.fit.clone(),
            frame: self.session.frames.get(self.selection.frame).cloned(),
            derivatives: Derivatives::default(),
        })
    }
}

/// Something a panel asks for that is neither an edit nor a command of its own.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
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
    /// Look at the document's pose again, and no step of a run.
    LeaveStep,
    /// Show or hide a run's curve.
    ShowRun(usize, bool),
    /// A wish of the convergence panel.
    Curves(CurvesRequest),
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
    /// Find the silhouettes of the frame anew.
    Segment,
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
    /// Run the laboratory's fits as soon as they have begun.
    RunLaboratory,
    /// Fit the frame from the pose on the screen to the end, as a run of this name.
    BeginRun {
        /// The name.
        name: String,
        /// The gesture that its result belongs to.
        gesture: Gesture,
    },
    /// Begin a new past of the document: there is nothing to undo and nothing to save.
    ForgetPast,
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
    /// Open what waits until the user has decided about that work.
    OpenPostponed,
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
pub struct Write {
    /// The file.
    pub path: PathBuf,
    /// Makes the bytes.
    pub make: Box<dyn FnOnce() -> anyhow::Result<Vec<u8>> + Send>,
}

impl std::fmt::Debug for Write {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Write").field("path", &self.path).finish_non_exhaustive()
    }
}

/// What the user decides about work that was left, by its place in the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// Go on with it.
    Restore(usize),
    /// Offer it no more.
    Discard(usize),
    /// Offer none of it any more.
    DiscardAll,
    /// Offer all of it again at the next start.
    Later,
}

/// What the user did with a tile, whatever stands in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PaneEvent {
    /// Asked for it in the whole window, or back.
    ToggleAlone,
    /// Opened it, or brought it before what it shares tabs with.
    Open,
    /// Closed it; its place is kept.
    Close,
}

/// What the panels ask for in one frame.
#[derive(Debug, Default)]
pub struct Requests {
    /// Changes of the document, each with its gesture.
    pub edits: Vec<(Edit, Option<Gesture>)>,
    /// Commands.
    pub commands: Vec<Command>,
    /// Everything else.
    pub others: Vec<Request>,
    /// Files to be written.
    pub writes: Vec<Write>,
    /// Frames that were read on the way, and that panels may show.
    pub frames: Vec<Arc<FrameData>>,
}

impl Requests {
    /// Asks for a change that is undone by itself.
    pub fn edit(&mut self, edit: Edit) {
        self.edits.push((edit, None));
    }

    /// Asks for a change that is part of a drag.
    pub fn drag(&mut self, edit: Edit, gesture: Gesture) {
        self.edits.push((edit, Some(gesture)));
    }

    /// Asks for a command.
    pub fn run(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// Says in the status bar what was just done.
    pub fn status(&mut self, text: impl Into<String>) {
        self.request(Request::Status(Some(text.into())));
    }

    /// Says something on a card, with a command that goes on from there.
    pub fn inform(&mut self, text: impl Into<String>, next: Option<Command>) {
        self.request(Request::Inform(text.into(), next));
    }

    /// Says what went wrong.
    pub fn complain(&mut self, text: impl Into<String>) {
        self.request(Request::Complain(text.into(), None));
    }

    /// Says that a job broke down, and what it was doing, as the beginning of a sentence.
    pub fn failed(&mut self, doing: &str, failure: &Failure) {
        self.complain(format!("{doing} broke down: {failure}. Your work is unharmed."));
    }

    /// Has a file written; `make` makes its bytes on the thread that writes.
    pub fn write(&mut self, path: &Path, make: impl FnOnce() -> anyhow::Result<Vec<u8>> + Send + 'static) {
        self.writes.push(Write { path: path.to_owned(), make: Box::new(make) });
    }

    /// Asks for something else.
    pub fn request(&mut self, request: Request) {
        self.others.push(request);
    }
}
