//! Which panels there are, and where.

use std::mem::swap;

use backlit_ui::style::theme::size;
use egui::{CentralPanel, Frame, Ui, pos2};

use super::Inspector;
use crate::context::activity::Activity;
use crate::context::preferences::Layout;
use crate::context::{Context, Request, Requests, Unavailable};
use crate::features::Features;
use crate::shell::Overlay;
use crate::shell::{about, dock, empty, messages, notice_cards, right_panel, shortcuts, status_bar, toolbar};

impl Inspector {
    /// What the panels may look at.
    pub(crate) fn context(&self) -> Context<'_> {
        Context {
            history: &self.state.history,
            session: &self.state.session,
            selection: &self.state.selection,
            preferences: &self.state.preferences,
            notices: &self.state.notices,
            busy: Activity {
                opening: self.state.is_opening,
                loading: self.refresh.is_reading(),
                load_broke: self.refresh.has_failed_to_read(),
                fitting: self.features.fit.is_running(),
                fitted_run: self.features.fit.fitted_run(),
                tracking: self.features.tracking.is_busy(),
                track: self.features.tracking.progress(),
                basin: self.features.basin.is_running(),
                exporting: self.features.export.progress(),
            },
            derivatives: self.features.camera_views.derivatives(
                self.state.preferences.layout,
                &self.document().model,
                &self.state.selection,
            ),
            project: self.state.project.as_deref(),
            lacks_take: self.state.lost_take.is_some(),
            alone: self.shell.docking.alone,
            clock: &self.state.clock,
            playback: &self.state.playback,
            views: self.features.camera_views.preferences.settings,
            drag: self.features.pose.marks(self.state.now),
            observability: &self.state.observability,
            motions: &self.state.motions,
            ghosts: self.state.ghosts.as_deref(),
            doing: self.state.status.as_deref(),
            is_covered: self.shell.overlay.is_some(),
            offers_unsaved_work: self.features.recovery.is_offered(),
            unavailable: &self.state.unavailable,
            can_restore_layout: self.layout_before.is_some(),
            frame_seconds: self.state.frame_seconds,
            now: self.state.now,
            pool: &self.state.pool,
            egui: &self.state.egui,
        }
    }

    /// Shows all panels.
    pub(crate) fn show(&mut self, ui: &mut Ui, requests: &mut Requests) {
        if let Some(next) = self.state.notices.tick(self.state.now) {
            ui.ctx()
                .request_repaint_after(std::time::Duration::from_secs_f64((next - self.state.now).max(0.0)));
        }
        self.state.unavailable = Unavailable::find(|command| self.unavailable(command));
        let window = ui.max_rect();
        let mut centre_size = None;
        let Context { busy, derivatives, views, .. } = self.context();
        let mut features = self.lend();
        let context = Context { busy, derivatives, views, ..self.context() };
        if features.camera_views.is_picture_alone() {
            dock::ui(ui, &context, &mut features, &self.shell.docking, requests);
            return self.take_back(features);
        }
        toolbar::ui(ui, &context, &mut features, requests);
        status_bar::ui(ui, &context, &features, requests);
        let mut notices_from = pos2(window.right(), window.bottom() - size::STATUS_BAR);
        if context.session.take.is_some() {
            let demonstrates = self.state.preferences.layout == Layout::Demonstrate;
            if self.state.preferences.panel && !demonstrates {
                right_panel::ui(ui, &context, &mut features, requests);
            }
            let centre = ui.available_rect_before_wrap();
            let frame = Frame::NONE;
            CentralPanel::default().frame(frame).show(ui, |ui| {
                notices_from = pos2(centre.right(), centre.bottom());
                features.demonstrations.ui(ui, &context, requests);
                if demonstrates {
                    return features.laboratory.ui(ui, &context, requests);
                }
                if self.shell.docking.alone.is_none() {
                    features.timeline.ui(ui, &context, requests, window.height());
                    notices_from.y = ui.available_rect_before_wrap().bottom();
                }
                centre_size = Some(ui.available_rect_before_wrap().size());
                dock::ui(ui, &context, &mut features, &self.shell.docking, requests);
            });
        } else {
            empty::ui(ui, &context, &self.features.recovery, requests);
        }
        for id in notice_cards::ui(ui, &context, requests, notices_from) {
            requests.request(Request::HoldNotice(id));
        }
        features.tour.ui(ui, &context, notices_from.y, requests);
        self.take_back(features);
        if let Some(size) = centre_size.filter(|_| self.shell.docking.alone.is_none()) {
            self.shell.docking.size = size;
        }
        self.show_overlay(ui, requests);
        self.show_drop(ui);
    }

    /// The features to be shown with their own state in hand, while the rest of the app is read.
    fn lend(&mut self) -> Features {
        let mut features = Features::default();
        self.exchange(&mut features);
        features
    }

    fn take_back(&mut self, mut features: Features) {
        self.exchange(&mut features);
    }

    /// Gives all features for others, but those that the context reads while the rest is shown.
    fn exchange(&mut self, others: &mut Features) {
        swap(&mut self.features, others);
        swap(&mut self.features.export, &mut others.export);
        swap(&mut self.features.pose, &mut others.pose);
        swap(&mut self.features.recovery, &mut others.recovery);
    }

    fn show_overlay(&mut self, ui: &Ui, requests: &mut Requests) {
        let Some(mut overlay) = self.shell.overlay.take() else { return };
        let stays = match &mut overlay {
            Overlay::Palette(palette) => palette.ui(ui, &self.context(), requests),
            Overlay::Shortcuts(search) => shortcuts::ui(ui, search),
            Overlay::Messages => messages::messages(ui, &self.state.notices, self.state.now, requests),
            Overlay::About => about::about(ui, requests),
            Overlay::UnsavedWork => self.features.recovery.card(ui, &self.context(), requests),
            Overlay::NewTake => self.with(
                |all| &mut all.new_take,
                |new_take, context, requests| new_take.card(ui, context, requests),
            ),
            Overlay::Offsets => self.with(
                |all| &mut all.offsets,
                |offsets, context, requests| offsets.card(ui, context, requests),
            ),
            Overlay::Export => {
                let mut export = std::mem::take(&mut self.features.export);
                let stays = export.card(ui, &self.context(), requests);
                self.features.export = export;
                stays
            }
        };
        if stays {
            self.shell.overlay = Some(overlay);
        } else if let Some(field) = ui.memory(egui::Memory::focused) {
            // The next key is the window's, also if no frame comes before it.
            ui.memory_mut(|memory| memory.surrender_focus(field));
        }
    }
}
