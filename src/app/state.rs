//! The document with its history, and all that is around it.

use std::path::PathBuf;

use backlit_document::Document;
use backlit_document::edit::Edit;
use backlit_document::history::{Gesture, History};
use backlit_jobs::Pool;
use backlit_tracking::body::builtin;

use crate::app::Place;
use crate::context::activity::WorkShare;
use crate::context::arrangement::Kept;
use crate::context::clock::Clock;
use crate::context::notices::Notices;
use crate::context::preferences::{Layout, Preferences};
use crate::context::{Published, Unavailable};
use crate::session::Session;
use crate::session::playback::Playback;
use crate::session::selection::Selection;

/// What the context lends to features and shell.
#[derive(Debug)]
pub struct State {
    /// The document with its past and its runs of the fit.
    pub history: History,
    /// What is selected.
    pub selection: Selection,
    /// The derived data.
    pub session: Session,
    /// How frames are played: neither saved nor undone.
    pub playback: Playback,
    /// What was said.
    pub notices: Notices,
    pub(crate) preferences: Preferences,
    /// The layout and its tiles of before the demonstration that is open.
    pub(crate) own_tiles: Option<(Layout, Kept)>,
    /// What features let others draw.
    pub(crate) published: Published,
    /// What cannot be used in the frame that is shown.
    pub(crate) unavailable: Unavailable,
    /// The sentence of the status bar about what was just done.
    pub(crate) status: Option<String>,
    /// The project file, if there is one.
    pub(crate) project: Option<PathBuf>,
    /// Whether a take is being opened, or is about to be.
    pub(crate) is_opening: bool,
    /// How many of its pictures are drawn, where it has to be drawn first.
    pub(crate) opened_share: Option<WorkShare>,
    /// Where to go in the take that is being opened.
    pub(crate) place: Option<Place>,
    /// The project that was not opened since its take was not there.
    pub(crate) lost_take: Option<PathBuf>,
    pub(crate) clock: Clock,
    /// Seconds since the window was opened.
    pub(crate) now: f64,
    /// Time that the last frame of the window took, in seconds.
    pub(crate) frame_seconds: f64,
    pub(crate) pool: Pool,
    pub(crate) egui: egui::Context,
}

impl State {
    /// No take is open.
    pub(crate) fn new(egui: egui::Context, pool: Pool, clock: Clock) -> Self {
        Self {
            history: History::new(Document::new(builtin::full_body())),
            selection: Selection::default(),
            session: Session::default(),
            playback: Playback::default(),
            notices: Notices::default(),
            preferences: Preferences::default(),
            own_tiles: None,
            published: Published::default(),
            unavailable: Unavailable::default(),
            status: None,
            project: None,
            is_opening: false,
            opened_share: None,
            place: None,
            lost_take: None,
            clock,
            now: 0.0,
            frame_seconds: 0.0,
            pool,
            egui,
        }
    }

    /// Makes a change, and what follows from it for the selection.
    pub(crate) fn edit(&mut self, edit: Edit, gesture: Option<Gesture>) {
        let sets_pose = matches!(edit, Edit::SetPose { .. });
        let remeasures = matches!(edit, Edit::SetMeasurement(_));
        match self.history.apply(edit, gesture) {
            Ok(()) => {
                if sets_pose {
                    self.playback.stop();
                    // The pose on the screen is now the document's again.
                    self.selection.step = None;
                }
                if remeasures {
                    self.session.frames.clear();
                }
            }
            Err(error) => self.notices.error(format!("That cannot be done: {error}.")),
        }
    }

    /// Goes to a frame.
    pub fn go_to_frame(&mut self, frame: usize) {
        if self.selection.frame != frame {
            self.selection.go_to_frame(frame, self.session.frame_count());
        }
    }

    /// Half of the memory for frames is for what is on the screen or was, half for decoded videos.
    pub(crate) fn keep_to_memory(&mut self) {
        let half = self.preferences.frames_mb / 2;
        self.session.frames.set_limit_mb(half);
        if let Some(cache) = self.session.take.as_ref().map(|take| take.take().frame_cache())
            && cache.limit_mb() != half
        {
            cache.set_limit_mb(half);
        }
    }
}
