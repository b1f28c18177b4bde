//! The inspector as it is without a desktop: all that is shown and worked on, and nothing that is read, written or asked
//! outside. The window is one; another, which nobody sees, is painted for exports.

use std::time::Instant;

use backlit_document::Document;
use backlit_document::history::History;
use backlit_document::run::Run;
use backlit_jobs::Pool;
use backlit_tracking::body::builtin;
use backlit_ui::style::theme;
use egui::Ui;

use super::refresh::Refresh;
use super::settings::Settings;
use super::state::{Opening, State};
use crate::context::Unavailable;
use crate::context::clock::Clock;
use crate::context::command::FileCommand;
use crate::context::motions::MotionMarks;
use crate::context::notices::Notices;
use crate::context::observability::ObservabilityMarks;
use crate::context::pane::Pane;
use crate::context::preferences::Preferences;
use crate::context::{Request, Write};
use crate::features::Features;
use crate::features::basin::Basin;
use crate::features::laboratory::Laboratory;
use crate::features::observability::Observability;
use crate::features::scene::Scene;
use crate::session::Session;
use crate::session::playback::Playback;
use crate::session::selection::Selection;
use crate::shell::Shell;

/// What the inspector leaves to who has a desktop.
#[derive(Debug)]
pub(crate) enum Errand {
    Command(FileCommand),
    Request(Request),
    Open(Opening),
    Write(Write),
}

/// The inspector.
#[derive(Debug)]
pub struct Inspector {
    pub(crate) state: State,
    pub(crate) features: Features,
    pub(crate) shell: Shell,
    pub(crate) refresh: Refresh,
    /// How the window was arranged before its layout was reset.
    pub(crate) layout_before: Option<Box<Settings>>,
    pub(crate) errands: Vec<Errand>,
}

impl Inspector {
    /// An inspector without a take, whose tasks are done by `pool`.
    pub(crate) fn new(egui: egui::Context, pool: Pool, clock: Clock) -> Self {
        let state = State {
            history: History::new(Document::new(builtin::full_body())),
            selection: Selection::default(),
            session: Session::default(),
            playback: Playback::default(),
            preferences: Preferences::default(),
            notices: Notices::default(),
            observability: ObservabilityMarks::default(),
            motions: MotionMarks::default(),
            ghosts: None,
            unavailable: Unavailable::default(),
            status: None,
            project: None,
            is_opening: false,
            lost_take: None,
            clock,
            now: 0.0,
            frame_seconds: 0.0,
            pool,
            egui,
        };
        Self {
            state,
            features: Features::default(),
            shell: Shell::default(),
            refresh: Refresh::default(),
            layout_before: None,
            errands: Vec::new(),
        }
    }

    /// The window's time and context, for what is done before the frame too.
    pub(crate) fn begin_frame(&mut self, ui: &Ui) {
        self.state.now = ui.input(|input| input.time);
        // Whoever made the inspector may show it in another window's context.
        self.state.egui.clone_from(ui.ctx());
        self.state.pool.turn();
    }

    pub(crate) fn frame(&mut self, ui: &mut Ui) {
        let began = Instant::now();
        self.begin_frame(ui);
        self.apply_theme(ui);
        self.take_in_refreshed();
        self.update_features();
        let mut requests = self.read_keys(ui.ctx());
        self.show(ui, &mut requests);
        self.apply(requests, ui.ctx());
        self.play(ui.ctx());
        self.keep_work();
        self.refresh();
        self.state.frame_seconds = began.elapsed().as_secs_f64();
    }

    /// Has something opened.
    pub(crate) fn open(&mut self, opening: Opening) {
        self.state.is_opening = true;
        self.errands.push(Errand::Open(opening));
    }

    /// Has a file written.
    pub(crate) fn write(&mut self, write: Write) {
        self.errands.push(Errand::Write(write));
    }

    /// The document as it is.
    pub fn document(&self) -> &Document {
        self.state.history.document()
    }

    /// What is selected.
    pub fn selection(&self) -> &Selection {
        &self.state.selection
    }

    /// The runs of the fit, the newest last.
    pub fn runs(&self) -> &[Run] {
        self.state.history.runs().all()
    }

    /// The derived data.
    pub fn session(&self) -> &Session {
        &self.state.session
    }

    /// Whether a pane is open.
    pub fn is_open(&self, pane: Pane) -> bool {
        self.state.preferences.is_open(pane, self.state.session.camera_count())
    }

    /// Whether there is work that is in no file.
    pub fn is_unsaved(&self) -> bool {
        self.state.history.is_dirty()
    }

    /// The laboratory.
    pub fn laboratory(&self) -> &Laboratory {
        &self.features.laboratory
    }

    /// What was said.
    pub fn notices(&self) -> &Notices {
        &self.state.notices
    }

    /// What was tried of the basin.
    pub fn basin(&self) -> &Basin {
        &self.features.basin
    }

    /// What the cameras see of the pose.
    pub fn observability(&self) -> &Observability {
        &self.features.observability
    }

    /// The 3-D scene.
    pub fn shown_scene(&self) -> &Scene {
        &self.features.scene
    }

    /// Closes the cards of notices; they stay among the messages.
    pub fn close_notices(&mut self) {
        self.state.notices.close_all();
    }

    /// Whether nothing is being read, fitted or drawn again: what is on the screen is whole.
    pub fn is_idle(&self) -> bool {
        // A body that sways never comes to rest, and neither does its picture.
        let is_at_rest = match self.features.observability.is_playing() {
            true => self.features.scene.is_all_that_works(&self.state.pool),
            false => self.state.pool.is_idle(),
        };
        is_at_rest
            && self.errands.is_empty()
            && (!self.state.session.is_stale || self.refresh.has_failed_to_predict())
            && self.features.laboratory.is_settled(&self.context())
    }

    /// Goes to a frame.
    pub fn go_to_frame(&mut self, frame: usize) {
        if self.state.selection.frame != frame {
            self.state.selection.go_to_frame(frame, self.state.session.frame_count());
        }
    }

    /// Hands the theme to egui when it has changed.
    pub(crate) fn apply_theme(&mut self, ui: &mut Ui) {
        if self.shell.shown_theme != Some(self.state.preferences.theme) {
            theme::apply(ui.ctx(), self.state.preferences.theme);
            // This frame has begun in the old one.
            let style = ui.ctx().style_of(theme::egui_theme(self.state.preferences.theme));
            ui.set_style(style);
            self.shell.shown_theme = Some(self.state.preferences.theme);
        }
    }
}
