//! What stands around the features: toolbar, menus, palette, status bar, the dock of tiles, notices.

pub(crate) mod dock;
pub(crate) mod docking;
pub(crate) mod drop_overlay;
pub(crate) mod empty;
pub(crate) mod help_cards;
pub(crate) mod menus;
pub(crate) mod notice_cards;
pub(crate) mod palette;
pub(crate) mod recent;
pub(crate) mod right_panel;
pub(crate) mod shortcuts;
pub(crate) mod status_bar;
pub(crate) mod toolbar;

use std::path::PathBuf;

use backlit_take::dropped::Dropped;
use backlit_ui::style::theme::{Theme, size};
use egui::{CentralPanel, Frame, Ui, pos2};

use crate::context::preferences::Layout;
use crate::context::{Context, FeatureCard, Requests, ShellRequest};
use crate::features::Features;

/// The state of what stands around the features.
#[derive(Debug, Default)]
pub(crate) struct Shell {
    pub(crate) docking: docking::Docking,
    pub(crate) overlay: Option<Overlay>,
    /// Files over the window, and what they are.
    pub(crate) hovering: Option<(Vec<PathBuf>, Dropped)>,
    pub(crate) shown_theme: Option<Theme>,
}

/// What lies over the window.
#[derive(Debug)]
pub(crate) enum Overlay {
    Palette(palette::Palette),
    Shortcuts(String),
    Messages,
    About,
    Card(FeatureCard),
}

impl Shell {
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        features: &mut Features,
        requests: &mut Requests,
    ) {
        if features.camera_views.is_picture_alone() {
            return dock::ui(ui, context, features, &self.docking, requests);
        }
        let window = ui.max_rect();
        toolbar::ui(ui, context, features, requests);
        status_bar::ui(ui, context, features, requests);
        let mut notices_from = pos2(window.right(), window.bottom() - size::STATUS_BAR);
        let mut centre_size = None;
        if context.session.take.is_some() {
            let demonstrates = context.preferences.layout == Layout::Demonstrate;
            if context.preferences.panel && !demonstrates {
                right_panel::ui(ui, context, features, requests);
            }
            let centre = ui.available_rect_before_wrap();
            CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
                notices_from = pos2(centre.right(), centre.bottom());
                features.demonstrations.ui(ui, context, requests);
                if demonstrates {
                    return features.laboratory.ui(ui, context, requests);
                }
                if self.docking.alone.is_none() {
                    features.timeline.ui(ui, context, requests, window.height());
                    notices_from.y = ui.available_rect_before_wrap().bottom();
                }
                centre_size = Some(ui.available_rect_before_wrap().size());
                dock::ui(ui, context, features, &self.docking, requests);
            });
        } else {
            empty::ui(ui, context, &features.recovery, requests);
        }
        // A card has its buttons where notices would stand.
        let corner = pos2(window.right(), window.bottom() - size::STATUS_BAR);
        let stand_at = if self.overlay.is_some() { corner } else { notices_from };
        for id in notice_cards::ui(ui, context, requests, stand_at) {
            requests.request(ShellRequest::HoldNotice(id));
        }
        features.tour.ui(ui, context, notices_from.y, requests);
        if let Some(size) = centre_size.filter(|_| self.docking.alone.is_none()) {
            self.docking.size = size;
        }
        self.show_overlay(ui, context, features, requests);
        if let Some((_, dropped)) = &self.hovering {
            drop_overlay::ui(ui, context, dropped);
        }
    }

    fn show_overlay(
        &mut self,
        ui: &Ui,
        context: &Context<'_>,
        features: &mut Features,
        requests: &mut Requests,
    ) {
        let Some(overlay) = &mut self.overlay else { return };
        let stays = match overlay {
            Overlay::Palette(palette) => palette.ui(ui, context, requests),
            Overlay::Shortcuts(search) => shortcuts::ui(ui, search),
            Overlay::Messages => help_cards::messages(ui, context.notices, requests),
            Overlay::About => help_cards::about(ui, requests),
            Overlay::Card(card) => features.of_card(*card).card(ui, context, requests),
        };
        if !stays {
            self.overlay = None;
            if let Some(field) = ui.memory(egui::Memory::focused) {
                // The next key is the window's, also if no frame comes before it.
                ui.memory_mut(|memory| memory.surrender_focus(field));
            }
        }
    }
}
