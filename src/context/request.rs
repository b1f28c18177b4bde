//! What features and shell ask for, cut by who answers: the session, the shell, the desktop, another feature.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_document::bookmark::Bookmark;
use backlit_document::edit::Edit;
use backlit_document::history::Gesture;
use backlit_document::runs::{RunChange, StepRef};
use backlit_jobs::{Failure, Task};
use backlit_take::source::TakeSource;
use backlit_tracking::body::Pose;
use backlit_ui::drawing::{DragEvent, JointId, ViewMode};

use crate::context::arrangement::Arrangement;
use crate::context::command::{Command, FileCommand, Variants};
use crate::context::notices::broke_down;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::view_settings::ViewSettings;
use crate::session::playback::PlaybackChange;
use crate::session::prediction::Predicted;
use crate::session::{BelievedJoints, FrameData};

/// A request, by who answers it.
#[derive(Debug)]
pub(crate) enum Request {
    Session(SessionRequest),
    Shell(ShellRequest),
    Desktop(DesktopRequest),
    Feature(FeatureRequest),
}

/// What is selected, shown and played.
#[derive(Debug)]
pub(crate) enum SessionRequest {
    /// Go to a frame: a fit that is going on ends, and the tracker is followed no more.
    Frame(usize),
    /// Go to a frame while a fit goes on; the tracker is followed no more.
    Visit(usize),
    /// Go on to the frame that the tracker has reached.
    Follow(usize),
    Joint(JointId),
    /// Look at the size of this limb, of those that turn with the held joint.
    Part(usize),
    Step(StepRef),
    /// Leave the step that is looked at: the pose is the document's again.
    LeaveStep,
    /// Something happens to the runs of the fit.
    Runs(RunChange),
    /// Undo all of a gesture that goes on, as if it had not begun.
    CancelGesture(Gesture),
    Playback(PlaybackChange),
}

/// How the window is arranged, what lies over it, and what it says.
#[derive(Debug)]
pub(crate) enum ShellRequest {
    /// Make a camera's tile the active one.
    Camera(usize),
    /// Show another camera in the tile of one.
    SwitchCamera {
        from: usize,
        to: usize,
    },
    /// How the window is arranged.
    Layout(Layout),
    /// Show all tiles again, if one fills the window.
    ShowAllTiles,
    /// What the user did with a tile.
    Pane(Pane, PaneEvent),
    /// The user has arranged the tiles.
    Arrange(Box<Arrangement>),
    /// Lay a feature's card over the window.
    OpenCard(FeatureCard),
    CloseCard,
    /// Close the notices that nobody has to decide about.
    CloseNotices,
    CloseNotice(u64),
    /// Close the notices that begin so: that is over.
    CloseNoticesAbout(&'static str),
    /// A notice is under the pointer: it stays.
    HoldNotice(u64),
    /// Say in the status bar what was just done, or nothing any more.
    Status(Option<String>),
    /// Say something on a card, with a command that goes on from there.
    Inform(String, Option<Command>),
    /// Say what went wrong, with a command that helps.
    Complain(String, Option<Command>),
    /// Copy a text, and say what it was.
    Copy(&'static str, String),
    /// A command was chosen in the palette.
    Used(Command),
    /// Take a path off the list of recent takes.
    ForgetRecent(PathBuf),
    /// Change how many megabytes are kept of frames that were read.
    FramesMb(usize),
}

/// Files and other programs.
#[derive(Debug)]
pub(crate) enum DesktopRequest {
    File(FileCommand),
    Open(TakeSource),
    /// Open whatever a path is.
    OpenPath(PathBuf),
    /// Open a page or a folder in another program.
    OpenOutside(String),
    /// Begin the export that was put together on its card.
    Export,
    Write(Write),
}

/// What one feature asks of another. Every feature hears it.
#[derive(Debug)]
pub(crate) enum FeatureRequest {
    /// Stop a fit that is going on: what it has done stays.
    InterruptFit,
    /// Something is dragged in a camera's view.
    Drag(usize, DragEvent),
    /// What all camera views share.
    Views(ViewSettings),
    /// Show a mode alone in all views of a layout.
    ShowMode(Layout, ViewMode),
    /// Run fits in the laboratory as soon as they have begun: what they differ in, and the camera whose pictures are shown.
    RunLaboratory { over: Variants, camera: Option<usize> },
    /// Follow this one of the people who were found, counted from 0.
    FollowPerson(usize),
    /// Something was drawn by hand over a camera's silhouette: the line's corners in pixels.
    DrawSilhouette(usize, Vec<[f32; 2]>),
    /// What to do with work that an earlier start of the program left unsaved.
    Recover(Decision),
}

macro_rules! into_request {
    ($($variant:ident($request:ident)),*) => {
        $(impl From<$request> for Request {
            fn from(request: $request) -> Self {
                Self::$variant(request)
            }
        })*
    };
}

into_request!(Session(SessionRequest), Shell(ShellRequest), Desktop(DesktopRequest), Feature(FeatureRequest));

/// A file to be written, and what makes its bytes on the thread that writes.
pub(crate) struct Write {
    pub(crate) path: PathBuf,
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

/// The cards of features that can lie over the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FeatureCard {
    Bookmarks,
    CameraCheck,
    CameraPlan,
    CameraRefinement,
    Export,
    NewTake,
    Offsets,
    UnsavedWork,
}

/// What features and shell ask for in one frame.
#[derive(Debug, Default)]
pub struct Requests {
    /// Changes of the document, each with its gesture.
    pub(crate) edits: Vec<(Edit, Option<Gesture>)>,
    pub(crate) commands: Vec<Command>,
    pub(crate) others: Vec<Request>,
    /// What the pose on the screen predicts, where whoever changes the pose knows it already.
    pub(crate) predicted: Option<Arc<Predicted>>,
    /// Frames that were read on the way, and that panels may show.
    pub(crate) frames: Vec<Arc<FrameData>>,
    /// What a Kalman filter believed of frames.
    pub(crate) beliefs: Vec<(usize, BelievedJoints)>,
}

impl Requests {
    pub(crate) fn is_empty(&self) -> bool {
        self.edits.is_empty() && self.others.is_empty() && self.commands.is_empty()
    }

    /// Asks for a change that is undone by itself.
    pub(crate) fn edit(&mut self, edit: Edit) {
        self.edits.push((edit, None));
    }

    /// Gives a frame a pose that rivals its own, as a key pose.
    pub(crate) fn take_rival(&mut self, frame: usize, pose: &Pose) {
        self.edit(Edit::SetPose { frame, pose: pose.clone(), what: "Take rival pose".to_owned() });
    }

    /// Asks for a change that is part of a drag.
    pub(crate) fn drag(&mut self, edit: Edit, gesture: Gesture) {
        self.edits.push((edit, Some(gesture)));
    }

    pub(crate) fn run(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// Asks for something else.
    pub(crate) fn request(&mut self, request: impl Into<Request>) {
        self.others.push(request.into());
    }

    /// Says in the status bar what was just done.
    pub(crate) fn status(&mut self, text: impl Into<String>) {
        self.request(ShellRequest::Status(Some(text.into())));
    }

    /// Says something on a card, with a command that goes on from there.
    pub(crate) fn inform(&mut self, text: impl Into<String>, next: Option<Command>) {
        self.request(ShellRequest::Inform(text.into(), next));
    }

    /// Says what went wrong.
    pub(crate) fn complain(&mut self, text: impl Into<String>) {
        self.request(ShellRequest::Complain(text.into(), None));
    }

    /// What a task has sent since the last call. That it broke down is said, and what it was `doing`, as the beginning of a
    /// sentence.
    pub(crate) fn outputs<I, O, const P: u8>(&mut self, doing: &str, task: &mut Task<I, O, P>) -> Vec<O> {
        task.outputs(|failure| self.failed(doing, failure))
    }

    /// Says that a job broke down, and what it was doing, as the beginning of a sentence.
    pub(crate) fn failed(&mut self, doing: &str, failure: &Failure) {
        self.complain(broke_down(doing, failure));
    }

    /// Goes to a bookmark's frame, and makes its camera and joint the selected ones.
    pub(crate) fn go_to(&mut self, bookmark: &Bookmark) {
        self.request(SessionRequest::Frame(bookmark.frame));
        if let Some(camera) = bookmark.camera {
            self.request(ShellRequest::Camera(camera));
        }
        if let Some(joint) = bookmark.joint {
            self.request(SessionRequest::Joint(joint));
        }
    }

    /// Has a file written; `make` makes its bytes on the thread that writes.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        make: impl FnOnce() -> anyhow::Result<Vec<u8>> + Send + 'static,
    ) {
        self.request(DesktopRequest::Write(Write { path: path.to_owned(), make: Box::new(make) }));
    }
}
