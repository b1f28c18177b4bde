//! Which panels there are, and where.

use egui::{CentralPanel, Frame, Ui, pos2};

use super::App;
use super::state::Overlay;
use crate::context::preferences::Layout;
use crate::context::{Busy, Intents, Request, Showing};
use crate::features::demonstration::explanation;
use crate::features::laboratory::panel as laboratory;
use crate::features::timeline;
use crate::shell::tiles::TilesLook;
use crate::shell::{about, dock, empty, messages, notice_cards, right_panel, shortcuts, status_bar, toolbar};
use crate::style::theme::size;
use crate::worker::Lane;

impl App {
    /// What the panels may look at.
    pub(crate) fn showing(&self) -> Showing<'_> {
        Showing {
            history: &self.history,
            session: &self.session,
            selection: &self.selection,
            look: &self.look,
            notices: &self.notices,
            busy: Busy {
                opening: self.worker.is_busy(Lane::Open),
                loading: self.worker.is_busy(Lane::Load),
                load_broke: !self.may_ask(Lane::Load),
                fitting: self.worker.is_busy(Lane::Fit),
                tracking: self.worker.is_busy(Lane::Track),
                exporting: self.export_progress(),
            },
            basin: &self.basin,
            project: self.project.as_deref(),
            has_exported: self.exported_to.is_some(),
            has_discarded: self.has_discarded(),
            lacks_take: self.lost_take.is_some(),
            time: &self.time,
            observing: &self.observing,
            doing: self.doing.as_deref(),
            explanation: self.explanation,
            can_restore_layout: self.docking.before.is_some(),
            laboratory: &self.laboratory,
            frame_seconds: self.frame_seconds,
        }
    }

    /// Shows all panels.
    pub(crate) fn show(&mut self, ui: &mut Ui, intents: &mut Intents) {
        if ui.input(|input| !input.events.is_empty()) && self.held.is_none() && !intents.actions.is_empty() {
            self.doing = None;
        }
        if let Some(next) = self.notices.tick(self.now) {
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64((next - self.now).max(0.0)));
        }
        let window = ui.max_rect();
        let mut centre_size = None;
        let showing = self.showing();
        if self.picture_alone.is_some() {
            return dock::ui(ui, &showing, &self.tiles_look(), intents);
        }
        toolbar::ui(ui, &showing, intents);
        status_bar::ui(ui, &showing, intents);
        let mut notices_from = pos2(window.right(), window.bottom() - size::STATUS_BAR);
        if showing.session.take.is_some() {
            let demonstrates = self.look.layout == Layout::Demonstrate;
            if self.look.panel && !demonstrates {
                right_panel::ui(ui, &showing, intents);
            }
            let centre = ui.available_rect_before_wrap();
            let frame = Frame::NONE;
            CentralPanel::default().frame(frame).show(ui, |ui| {
                notices_from = pos2(centre.right(), centre.bottom());
                if demonstrates {
                    return laboratory::ui(ui, &showing, intents);
                }
                explanation::ui(ui, &showing, intents);
                if self.docking.alone.is_none() {
                    timeline::ui(ui, &showing, intents, window.height());
                    notices_from.y = ui.available_rect_before_wrap().bottom();
                }
                centre_size = Some(ui.available_rect_before_wrap().size());
                dock::ui(ui, &showing, &self.tiles_look(), intents);
            });
        } else {
            empty::ui(ui, &showing, intents, &self.offer());
        }
        for id in notice_cards::ui(ui, &showing, intents, notices_from) {
            intents.request(Request::HoldNotice(id));
        }
        if let Some(size) = centre_size.filter(|_| self.docking.alone.is_none()) {
            self.docking.size = size;
        }
        self.show_overlay(ui, intents);
        self.show_tour(ui, notices_from.y);
        self.show_drop(ui);
    }

    pub(crate) fn tiles_look(&self) -> TilesLook<'_> {
        TilesLook { views: self.camera_views(), alone: self.docking.alone, pair: self.docking.pair }
    }

    fn show_overlay(&mut self, ui: &Ui, intents: &mut Intents) {
        let Some(mut overlay) = self.overlay.take() else { return };
        let stays = match &mut overlay {
            Overlay::Palette(palette) => palette.ui(ui, &self.showing(), intents),
            Overlay::Shortcuts(search) => shortcuts::ui(ui, search),
            Overlay::Messages => messages::messages(ui, &self.notices, self.now, intents),
            Overlay::About => about::about(ui, intents),
            Overlay::Export(dialog) => dialog.ui(ui, &self.showing(), intents),
        };
        if stays {
            self.overlay = Some(overlay);
        } else if let Some(field) = ui.memory(egui::Memory::focused) {
            // The next key is the window's, also if no frame comes before it.
            ui.memory_mut(|memory| memory.surrender_focus(field));
        }
    }
}
