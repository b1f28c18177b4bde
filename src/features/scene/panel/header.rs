//! Title and menu of the scene's tile.

use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{Icon, checkbox};
use egui::{Align, Button, Layout, Popup, Rect, Role, Sense, Ui, UiBuilder, WidgetInfo, pos2, vec2};

use crate::context::command::{Command, SceneCommand};
use crate::context::pane::{HEADER_BUTTONS, Pane};
use crate::context::pane_title;
use crate::context::{Context, Requests};
use crate::features::scene::{ScenePreferences, ShownHull, Viewpoint};

/// Space for the chevron behind the menu's name.
const CHEVRON: f32 = 18.0;

pub(super) fn show(
    ui: &mut Ui,
    rect: Rect,
    preferences: &mut ScenePreferences,
    context: &Context<'_>,
    siblings: &[Pane],
    requests: &mut Requests,
) {
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).raised);
    let right = (rect.right() - HEADER_BUTTONS).max(rect.left());
    let left = Rect::from_min_max(pos2(rect.left() + space::WIDGET, rect.top()), pos2(right, rect.bottom()));
    let builder = UiBuilder::new().max_rect(left).layout(Layout::left_to_right(Align::Center));
    ui.scope_builder(builder, |ui| {
        pane_title::show(ui, Pane::Scene, siblings, requests);
        menu(ui, preferences, context, requests);
    });
}

fn menu(ui: &mut Ui, preferences: &mut ScenePreferences, context: &Context<'_>, requests: &mut Requests) {
    let palette = theme::palette(ui);
    let text = title(preferences);
    let font = egui::TextStyle::Button.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(text.clone(), font, egui::Color32::PLACEHOLDER);
    job.wrap = egui::text::TextWrapping::truncate_at_width((ui.available_width() - CHEVRON).max(0.0));
    let galley = ui.painter().layout_job(job);
    let (rect, response) = ui.allocate_exact_size(vec2(galley.size().x + CHEVRON, size::ROW), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Scene view: {text}")));
    let is_open = Popup::is_id_open(ui.ctx(), Popup::default_response_id(&response));
    let colour = if response.hovered() || is_open { palette.text } else { palette.text2 };
    ui.painter().galley(pos2(rect.left(), rect.center().y - galley.size().y * 0.5), galley, colour);
    let chevron = Rect::from_min_max(pos2(rect.right() - size::ICON, rect.top()), rect.max);
    Icon::ChevronDown.paint_scaled(ui.painter(), chevron, colour, 0.85);
    let response = response.on_hover_text("Views, and what is shown");
    Popup::menu(&response).close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        ui.set_min_width(190.0);
        views(ui, preferences, context, requests);
        ui.separator();
        shown(ui, preferences);
    });
}

/// From where it is seen, or what is shown.
fn title(preferences: &ScenePreferences) -> String {
    match preferences.viewpoint {
        Some(Viewpoint::Camera(index)) => format!("From camera {}", index + 1),
        _ if preferences.cameras => "Body and cameras".to_owned(),
        _ => "Body".to_owned(),
    }
}

fn views(ui: &mut Ui, preferences: &mut ScenePreferences, context: &Context<'_>, requests: &mut Requests) {
    let presets = [
        ("Whole scene", Command::Scene(SceneCommand::Reset)),
        ("Front", Command::Scene(SceneCommand::Front)),
        ("Side", Command::Scene(SceneCommand::Side)),
        ("Above", Command::Scene(SceneCommand::Top)),
    ];
    for (text, command) in presets {
        if ui.add(Button::new(text)).on_hover_text(command.tooltip()).clicked() {
            requests.run(command);
            ui.close();
        }
    }
    for camera in 0..context.session.camera_count() {
        let viewpoint = Some(Viewpoint::Camera(camera));
        let is_chosen = preferences.viewpoint == viewpoint;
        if ui.add(Button::new(format!("From camera {}", camera + 1)).selected(is_chosen)).clicked() {
            preferences.viewpoint = viewpoint;
            ui.close();
        }
    }
}

fn shown(ui: &mut Ui, preferences: &mut ScenePreferences) {
    checkbox(ui, &mut preferences.cameras, "Cameras");
    let pictures = &mut preferences.pictures;
    ui.add_enabled_ui(preferences.cameras, |ui| checkbox(ui, pictures, "Their pictures"));
    checkbox(ui, &mut preferences.floor, "Floor and axes");
    ui.separator();
    for (hull, text) in ShownHull::ALL {
        let tooltip = "The visual hull: the space that all silhouettes allow";
        if ui.add(Button::new(text).selected(preferences.hull == hull)).on_hover_text(tooltip).clicked() {
            preferences.hull = hull;
        }
    }
}
