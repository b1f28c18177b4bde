//! The column on the right: one order in all layouts, only what is open differs.

use backlit_ui::style::theme::{self, size, space};
use egui::{Frame, Margin, Panel, ScrollArea, Ui};

use crate::context::preferences::Layout;
use crate::context::{Context, Requests};
use crate::features::Features;
use crate::features::fit::{measurement, renderer};
use crate::features::pose::Posing;
use crate::features::tracking::choices as tracking_choices;

/// Below this width of the window the panel takes its smallest width.
const NARROW: f32 = 1200.0;

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, features: &mut Features, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let frame = Frame::NONE.fill(palette.panel).inner_margin(Margin::ZERO);
    let layout = context.preferences.layout;
    let narrow = ui.max_rect().width() < NARROW;
    let width = if narrow { *size::RIGHT_PANEL_RANGE.start() } else { layout.panel_width() };
    Panel::right(("right panel", layout, narrow, context.preferences.generation))
        .default_size(width)
        .size_range(size::RIGHT_PANEL_RANGE)
        .resizable(true)
        .frame(frame)
        .show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                let margin = Margin::symmetric(space::PANEL_MARGIN as i8, 0);
                Frame::NONE.inner_margin(margin).show(ui, |ui| {
                    ui.push_id((layout, context.preferences.generation), |ui| {
                        sections(ui, context, features, requests, layout);
                    });
                });
            });
        });
}

fn sections(
    ui: &mut Ui,
    context: &Context<'_>,
    features: &mut Features,
    requests: &mut Requests,
    layout: Layout,
) {
    let posing = layout == Layout::Pose;
    ui.spacing_mut().item_spacing.y = 0.0;
    features.observability.look_at_angle(Posing::limbs(ui, context, requests, posing));
    features.fit.refit_section(ui, context, requests, posing, |ui, requests| {
        features.tracking.other_poses(ui, context, requests);
        features.tracking.offer(ui, context, requests);
    });
    Posing::sizes(ui, context, requests);
    measurement::ui(ui, context, requests, false);
    renderer::ui(ui, context, requests, !posing);
    features.fit.solver_section(ui, context, requests, !posing, |ui, requests| {
        tracking_choices::ui(ui, context, requests);
    });
    features.all_mut().for_each(|feature| feature.sections(ui, context, requests));
}
