//! The document with its history, and all that is around it.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use backlit_formats::Take;
use backlit_tracking::body::{Pose, builtin};

use super::background::Background;
use super::broken::Broken;
use super::clipboard::Clipboard;
use super::demonstrating::Prepared;
use super::docking::Docking;
use super::dropping::Hovering;
use super::exporting::Exporting;
use super::hand::{Held, Nudging};
use super::playing::TimeAxis;
use super::settings::Settings;
use super::touring::Tour;
use super::tracking::Tracked;
use super::unsaved::Unsaved;
use crate::basin::{BasinState, FileKind};
use crate::clock::Clock;
use crate::document::{Document, TakeSource};
use crate::history::{Gesture, History};
use crate::laboratory::Laboratory;
use crate::look::{Layout, Look};
use crate::notices::Notices;
use crate::observing::Observing;
use crate::panels::camera_tile::{PictureAlone, TileLook};
use crate::panels::export_dialog::ExportDialog;
use crate::panels::palette::Palette;
use crate::selection::Selection;
use crate::session::Session;
use crate::worker::{Event, Lane, LiveFit, LiveLaboratory, Scene, Worker};

/// What the window begins with.
#[derive(Debug, Default)]
pub struct AppOptions {
    /// The arrangement of the last time.
    pub look: Look,
    /// Folder for the copy of unsaved work and the settings; without one nothing is kept for the next start.
    pub data_folder: Option<PathBuf>,
    /// What is opened at once.
    pub opening: Option<Opening>,
    /// File that the state is written to after each frame in which it changed, for tests from outside.
    pub state_file: Option<PathBuf>,
    /// Whether the tour is offered, if it never was.
    pub offers_tour: bool,
    /// What time it is.
    pub clock: Clock,
}

/// Something to open.
#[derive(Debug)]
pub enum Opening {
    /// A take.
    Take(TakeSource),
    /// A take that has been read.
    Ready(Box<Take>),
    /// A project file.
    Project(PathBuf),
    /// A project file whose take has moved.
    Moved {
        /// The project file.
        project: PathBuf,
        /// Where its take is now.
        take: PathBuf,
    },
}

/// What lies over the window.
#[derive(Debug)]
pub(super) enum Overlay {
    Palette(Palette),
    Shortcuts(String),
    Messages,
    About,
    Export(Box<ExportDialog>),
}

/// What a file dialog was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DialogKind {
    Take,
    FindTake,
    Project,
    SaveAs,
    Export,
    Curves,
    Plot,
    LaboratoryPlot,
    Basin(FileKind),
}

/// What a file dialog was asked for, and the file that was chosen.
pub(super) type DialogAnswer = (DialogKind, PathBuf);

/// The inspector.
#[derive(Debug)]
pub struct App {
    pub(super) history: History,
    pub(super) selection: Selection,
    pub(super) session: Session,
    pub(super) look: Look,
    pub(super) notices: Notices,
    pub(super) worker: Worker<Event>,
    pub(super) background: Background,
    pub(super) broken: Broken,
    pub(super) live: LiveFit,
    /// Steps that were asked for while one was being made.
    pub(super) pending_steps: usize,
    /// The gesture of the run of fit or tracker that is going on.
    pub(super) run_gesture: Option<Gesture>,
    /// Whether the screen follows the tracker.
    pub(super) follows_tracker: bool,
    pub(super) tracked: Tracked,
    pub(super) observing: Observing,
    /// What figures were asked for last, whatever came of it.
    pub(super) asked_to_observe: Option<(Scene, Pose)>,
    pub(super) held: Option<Held>,
    pub(super) nudging: Option<Nudging>,
    pub(super) basin: BasinState,
    /// The demonstration that is being prepared.
    pub(super) prepared: Option<Prepared>,
    pub(super) explanation: Option<&'static str>,
    pub(super) state_file: Option<PathBuf>,
    pub(super) tour: Option<Tour>,
    pub(super) hovering: Option<Hovering>,
    pub(super) exporting: Option<Exporting>,
    /// Folder of the last export.
    pub(super) exported_to: Option<PathBuf>,
    /// One camera's picture and nothing else: this is the twin that an export paints.
    pub(super) picture_alone: Option<PictureAlone>,
    pub(super) laboratory: Laboratory,
    pub(super) live_laboratory: LiveLaboratory,
    /// By layout, then by camera.
    pub(super) tiles: [Vec<TileLook>; 2],
    /// Tiles of the centre.
    pub(super) docking: Docking,
    pub(super) clipboard: Clipboard,
    pub(super) project: Option<PathBuf>,
    pub(super) overlay: Option<Overlay>,
    pub(super) doing: Option<String>,
    pub(super) time: TimeAxis,
    pub(super) unsaved: Unsaved,
    pub(super) settings: Settings,
    pub(super) clock: Clock,
    /// The project that was not opened since its take was not there.
    pub(super) lost_take: Option<PathBuf>,
    /// What is opened when the unsaved work is left.
    pub(super) postponed: Option<Opening>,
    pub(super) dialog_sender: Sender<DialogAnswer>,
    pub(super) dialog_answers: Receiver<DialogAnswer>,
    pub(super) next_gesture: u64,
    pub(super) now: f64,
    pub(super) frame_seconds: f64,
    pub(super) shown_theme: Option<crate::theme::Theme>,
    pub(super) context: egui::Context,
}

impl App {
    /// The window's state. `context` is woken when the worker has news.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(context: egui::Context, options: AppOptions) -> anyhow::Result<Self> {
        let worker = Worker::start({
            let context = context.clone();
            move || context.request_repaint()
        })?;
        let (dialog_sender, dialog_answers) = channel();
        let mut app = Self {
            history: History::new(Document::new(builtin::full_body())),
            selection: Selection::default(),
            session: Session::default(),
            settings: Settings::new(options.data_folder.clone(), &options.look),
            look: options.look,
            notices: Notices::default(),
            worker,
            background: Background::start(&context)?,
            broken: Broken::default(),
            live: LiveFit::default(),
            pending_steps: 0,
            run_gesture: None,
            follows_tracker: false,
            tracked: Tracked::default(),
            observing: Observing::default(),
            asked_to_observe: None,
            held: None,
            nudging: None,
            basin: BasinState::default(),
            prepared: None,
            explanation: None,
            state_file: options.state_file,
            tour: None,
            hovering: None,
            exporting: None,
            exported_to: None,
            picture_alone: None,
            laboratory: Laboratory::default(),
            live_laboratory: LiveLaboratory::default(),
            tiles: [Vec::new(), Vec::new()],
            docking: Docking::default(),
            clipboard: Clipboard::default(),
            project: None,
            overlay: None,
            doing: None,
            time: TimeAxis::default(),
            unsaved: Unsaved::new(options.data_folder),
            clock: options.clock,
            lost_take: None,
            postponed: None,
            dialog_sender,
            dialog_answers,
            next_gesture: 1,
            now: 0.0,
            frame_seconds: 0.0,
            shown_theme: None,
            context,
        };
        if options.offers_tour {
            app.offer_tour();
        }
        app.look_for_unsaved_work();
        match options.opening {
            Some(opening) if app.unsaved.offered.is_empty() => app.open(opening),
            // First the unsaved work: once something else is open, its own copy would take that one's place.
            opening => app.postponed = opening,
        }
        Ok(app)
    }

    /// The document as it is.
    #[must_use]
    pub fn document(&self) -> &Document {
        self.history.document()
    }

    /// What is selected.
    #[must_use]
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// The derived data.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// How the window is arranged.
    #[must_use]
    pub fn look(&self) -> &Look {
        &self.look
    }

    /// Whether there is work that is in no file.
    #[must_use]
    pub fn is_unsaved(&self) -> bool {
        self.history.is_dirty()
    }

    /// The laboratory.
    #[must_use]
    pub fn laboratory(&self) -> &Laboratory {
        &self.laboratory
    }

    /// What was said.
    #[must_use]
    pub fn notices(&self) -> &Notices {
        &self.notices
    }

    /// What was tried of the basin.
    #[must_use]
    pub fn basin(&self) -> &BasinState {
        &self.basin
    }

    /// Closes the cards of notices; they stay among the messages.
    pub fn close_notices(&mut self) {
        self.notices.close_all();
    }

    /// Whether nothing is being read, fitted or drawn anew: what is on the screen is whole.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        let is_waiting = self.laboratory.is_waiting && self.look.layout == Layout::Demonstrate;
        // A body that sways never comes to rest, and neither does its picture.
        let is_drawn = !self.worker.is_busy(Lane::Scene) || self.observing.is_playing();
        self.worker.is_idle_but(Lane::Scene)
            && is_drawn
            && self.background.is_idle()
            && !(self.session.is_stale && self.may_ask(Lane::Predict))
            && self.prepared.is_none()
            && self.exporting.is_none()
            && !is_waiting
    }

    /// Goes to a frame.
    pub fn go_to_frame(&mut self, frame: usize) {
        if self.selection.frame != frame {
            self.selection.go_to_frame(frame, self.session.frame_count());
        }
    }

    /// A gesture that was not used before.
    pub(super) fn new_gesture(&mut self) -> Gesture {
        // Far from those of the panels, which count from one.
        self.next_gesture += 1;
        Gesture(u64::MAX - self.next_gesture)
    }

    /// How the tiles of the layout look.
    pub(super) fn tiles_mut(&mut self) -> &mut Vec<TileLook> {
        &mut self.tiles[usize::from(self.look.layout == Layout::Debug)]
    }

    /// Hands the theme to egui when it has changed.
    pub(super) fn apply_theme(&mut self, ui: &mut egui::Ui) {
        if self.shown_theme != Some(self.look.theme) {
            crate::theme::apply(ui.ctx(), self.look.theme);
            // This frame has begun in the old one.
            let style = ui.ctx().style_of(self.look.theme.to_egui());
            ui.set_style(style);
            self.shown_theme = Some(self.look.theme);
        }
    }
}
