//! The inspector as it is without a desktop: all that is shown and worked on, and nothing that is read, written or asked
//! outside. The window is one; another, which nobody sees, is painted for exports.

use std::time::{Duration, Instant};

use backlit_document::Document;
use backlit_document::run::Run;
use backlit_jobs::Pool;
use backlit_tracking::body::Pose;
use backlit_ui::style::theme;
use egui::Ui;

use super::refresh::Refresh;
use super::settings::Settings;
use super::state::State;
use crate::context::activity::Activity;
use crate::context::clock::Clock;
use crate::context::command::Command;
use crate::context::pane::Pane;
use crate::context::{Context, DesktopRequest, Requests};
use crate::features::Features;
use crate::features::scene::panel::input as scene_keys;
use crate::shell::Shell;

/// While frames are played, the window looks at its clock at least this often: seconds.
const LONGEST_WAIT: f64 = 1.0;

/// The inspector.
#[derive(Debug)]
pub struct Inspector {
    /// What features and shell read.
    pub state: State,
    /// The features, each with its own state.
    pub features: Features,
    pub(crate) shell: Shell,
    pub(crate) refresh: Refresh,
    /// How the window was arranged before its layout was reset.
    pub(crate) layout_before: Option<Box<Settings>>,
    /// What is left to the desktop.
    pub(crate) errands: Vec<DesktopRequest>,
}

/// What features and shell may look at. It borrows the state alone, so that they can change themselves meanwhile.
fn context<'a>(
    state: &'a State,
    features: &Features,
    shell: &Shell,
    refresh: &Refresh,
    can_restore_layout: bool,
) -> Context<'a> {
    Context {
        history: &state.history,
        session: &state.session,
        selection: &state.selection,
        preferences: &state.preferences,
        notices: &state.notices,
        busy: Activity {
            opening: state.is_opening,
            share: state.opened_share.or_else(|| features.tracking.share()),
            loading: refresh.frame.is_busy(),
            load_broke: refresh.frame.failure().is_some(),
            fitting: features.fit.is_running(),
            fitted_run: features.fit.fitted_run(),
            tracking: features.tracking.is_busy(),
            track: features.tracking.progress(),
            basin: features.basin.is_running(),
            exporting: features.export.progress(),
        },
        derivatives: features.camera_views.derivatives(
            state.preferences.layout,
            &state.history.document().model,
            &state.selection,
        ),
        project: state.project.as_deref(),
        lacks_take: state.lost_take.is_some(),
        alone: shell.docking.alone,
        clock: &state.clock,
        playback: &state.playback,
        views: features.camera_views.preferences.settings,
        drag: features.pose.marks(state.now),
        observability: &state.published.observability,
        motions: &state.published.motions,
        silhouettes: &state.published.silhouettes,
        ghosts: state.published.ghosts.as_deref(),
        references: &state.published.references,
        people: &state.published.people,
        floor_picture: state.published.floor_picture.as_ref(),
        doing: state.status.as_deref(),
        is_covered: shell.overlay.is_some(),
        offers_unsaved_work: features.recovery.is_offered(),
        unavailable: &state.unavailable,
        can_restore_layout,
        frame_seconds: state.frame_seconds,
        now: state.now,
        pool: &state.pool,
        egui: &state.egui,
    }
}

impl Inspector {
    /// An inspector without a take, whose tasks are done by `pool`.
    pub(crate) fn new(egui: egui::Context, pool: Pool, clock: Clock) -> Self {
        Self {
            state: State::new(egui, pool, clock),
            features: Features::default(),
            shell: Shell::default(),
            refresh: Refresh::default(),
            layout_before: None,
            errands: Vec::new(),
        }
    }

    /// The document as it is.
    pub fn document(&self) -> &Document {
        self.state.history.document()
    }

    /// The runs of the fit, the newest last.
    pub fn runs(&self) -> &[Run] {
        self.state.history.runs().all()
    }

    /// Whether a pane is open.
    pub fn is_open(&self, pane: Pane) -> bool {
        self.state.preferences.is_open(pane, self.state.session.camera_count())
    }

    /// The pose on the screen.
    pub fn shown_pose(&self) -> &Pose {
        self.context().shown_pose()
    }

    /// What features and shell may look at.
    pub(crate) fn context(&self) -> Context<'_> {
        let can_restore_layout = self.layout_before.is_some();
        context(&self.state, &self.features, &self.shell, &self.refresh, can_restore_layout)
    }

    /// The same, and features and shell to be changed meanwhile.
    pub(crate) fn split(&mut self) -> (Context<'_>, &mut Features, &mut Shell) {
        let Self { state, features, shell, refresh, layout_before, .. } = self;
        let context = context(state, features, shell, refresh, layout_before.is_some());
        (context, features, shell)
    }

    /// Lets features work, with what they read and what they ask for, and does what they have asked for.
    pub fn ask<T>(&mut self, work: impl FnOnce(&mut Features, &Context<'_>, &mut Requests) -> T) -> T {
        let mut requests = Requests::default();
        let (context, features, _) = self.split();
        let answer = work(features, &context, &mut requests);
        self.apply(requests);
        answer
    }

    /// The window's time and context, for what is done before the frame too.
    pub(crate) fn begin_frame(&mut self, ui: &Ui) {
        self.state.now = ui.input(|input| input.time);
        self.state.notices.now = self.state.now;
        // Whoever made the inspector may show it in another window's context.
        self.state.egui.clone_from(ui.ctx());
        self.state.pool.turn();
    }

    pub(crate) fn frame(&mut self, ui: &mut Ui) {
        let began = Instant::now();
        self.begin_frame(ui);
        if self.shell.shown_theme.replace(self.state.preferences.theme) != Some(self.state.preferences.theme)
        {
            theme::apply(ui.ctx(), self.state.preferences.theme);
            // This frame has begun in the old one.
            let style = ui.ctx().style_of(theme::egui_theme(self.state.preferences.theme));
            ui.set_style(style);
        }
        self.take_in_refreshed();
        self.update_features();
        let mut requests = self.read_keys(ui.ctx());
        self.show(ui, &mut requests);
        self.apply(requests);
        self.play(ui.ctx());
        self.ask(|features, context, requests| {
            features.recovery.keep_copy(context, requests);
            features.recovery.guard_close(context, requests);
        });
        self.refresh();
        self.state.frame_seconds = began.elapsed().as_secs_f64();
    }

    /// Every feature takes in what its tasks have done, and asks for what it lacks.
    pub(crate) fn update_features(&mut self) {
        self.state.keep_to_memory();
        for index in 0..self.features.all().count() {
            let mut requests = Requests::default();
            let (context, features, _) = self.split();
            if let Some(feature) = features.all_mut().nth(index) {
                feature.update(&context, &mut requests);
            }
            // The panels see it in this frame of the window: no other is needed.
            self.apply_before_show(requests);
            if let Some(feature) = self.features.all().nth(index) {
                feature.publish(&mut self.state.published);
            }
        }
    }

    /// The commands whose keys were pressed. While something lies over the window, or the hand holds
    /// something, keys are theirs.
    fn read_keys(&mut self, ctx: &egui::Context) -> Requests {
        let mut requests = Requests::default();
        let (context, features, shell) = self.split();
        let is_moving = shell.docking.is_moving_tile(ctx, context.preferences, context.session);
        let is_held = context.drag.is_dragging() || is_moving || egui::Popup::is_any_open(ctx);
        if shell.overlay.is_none() && !is_held {
            let of_scene = scene_keys::hold_back(ctx);
            requests.commands = Command::pressed(ctx);
            scene_keys::give_back(ctx, of_scene);
            features.pose.read_clipboard(&context, &mut requests);
        }
        requests
    }

    fn show(&mut self, ui: &mut Ui, requests: &mut Requests) {
        let state = &mut self.state;
        if let Some(next) = state.notices.tick() {
            ui.ctx().request_repaint_after(Duration::from_secs_f64((next - state.now).max(0.0)));
        }
        let context = self.context();
        let why = |command| Some((command, self.features.unavailable(command, &context)?));
        self.state.unavailable = Command::all().filter_map(why).collect();
        let (context, features, shell) = self.split();
        shell.ui(ui, &context, features, requests);
    }

    /// Goes on to the next frame when it is time, as long as frames are played.
    fn play(&mut self, ctx: &egui::Context) {
        let state = &mut self.state;
        let Some(take) = &state.session.take else { return state.playback.stop() };
        let (rate, count) = (take.take().frame_rate(), take.frame_count());
        let (frames, now) = (&state.session.frames, state.now);
        let is_there = |frame: usize| frames.get(frame).is_some();
        if let Some(frame) = state.playback.due(state.selection.frame, count, rate, now, is_there) {
            state.go_to_frame(frame);
        }
        if let Some(seconds) = self.state.playback.next_in(rate, now) {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds.min(LONGEST_WAIT)));
        }
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
            && (!self.state.session.is_stale || self.refresh.prediction.failure().is_some())
            && self.features.laboratory.is_settled(&self.context())
    }

    /// Forgets how long things took, so that a picture of the next frame is the same every time.
    pub fn freeze_times(&mut self) {
        self.state.frame_seconds = f64::NAN;
        self.state.session.predict_seconds = None;
        self.features.all_mut().for_each(|feature| feature.freeze_times());
    }
}
