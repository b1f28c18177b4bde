//! A tile's header: badge, name, view mode, link, expand, more.

use backlit_tracking::camera::Camera;
use egui::{
    Align, CornerRadius, Layout, Popup, Rect, Role, Sense, TextStyle, TextWrapMode, Ui, UiBuilder,
    WidgetInfo, WidgetText, pos2, vec2,
};

use super::comparison::mode_text;
use super::{CameraTileInput, TileEvent, TileLayout, gutter, tile_menu};
use crate::format;
use crate::panels::pane_title;
use crate::theme::{self, size, space};
use crate::widgets::{Icon, camera_badge, icon_button};

/// In a narrower header the link button folds into the menu.
const LINK_FROM: f32 = 300.0;

/// A wider header has the camera's name in the take too.
const NAME_FROM: f32 = 420.0;

/// Space for the chevron behind the mode's name.
const CHEVRON: f32 = 18.0;

/// Dashes around the badge of a camera without calibration.
const DASH: f32 = 2.5;

pub(super) fn show(
    ui: &mut Ui,
    layout: &TileLayout,
    input: &CameraTileInput<'_>,
    events: &mut Vec<TileEvent>,
) {
    let rect = layout.header;
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).raised);
    let back = ui.interact(rect, ui.scope_id().with("header"), Sense::click_and_drag());
    back.widget_info(|| WidgetInfo::labeled(Role::TitleBar, true, format!("{} header", input.name)));
    if back.double_clicked() {
        events.push(TileEvent::ToggleExpanded);
    } else if back.clicked() {
        events.push(TileEvent::Activate);
    } else if back.drag_started() {
        events.push(TileEvent::DragTile);
    }
    if layout.gutter.is_none() {
        back.on_hover_ui(|ui| gutter::show_overlap(ui, input));
    }

    let has_link = rect.width() >= LINK_FROM;
    let badges_width: f32 =
        input.siblings.iter().map(|sibling| pane_title::width_behind(ui, *sibling) + space::ROW).sum();
    let buttons_width = if has_link { 3.0 } else { 2.0 } * size::BUTTON + space::ROW + badges_width;
    let (left, right) = rect.split_left_right_at_x((rect.right() - buttons_width).max(rect.left()));
    let left = Rect::from_min_max(pos2(left.left() + space::WIDGET, left.top()), left.max);
    let builder = UiBuilder::new().max_rect(left).layout(Layout::left_to_right(Align::Center));
    ui.scope_builder(builder, |ui| {
        if camera_badge(ui, input.index).clicked() {
            events.push(TileEvent::ToggleExpanded);
        }
        if !input.is_calibrated {
            paint_dashes(
                ui,
                Rect::from_center_size(pos2(left.left() + 8.0, left.center().y), vec2(18.0, 18.0)),
            );
        }
        let palette = theme::palette(ui);
        let name = egui::RichText::new(input.name);
        let name = if input.is_used { name } else { name.color(palette.text3) };
        let name = ui.add(egui::Label::new(name).selectable(false));
        if let Some(camera) = input.camera {
            name.on_hover_text(about(camera));
            if rect.width() >= NAME_FROM {
                let name = egui::RichText::new(camera.name()).small().color(palette.text3);
                ui.add(egui::Label::new(name).selectable(false));
            }
        }
        if !input.is_used && input.is_calibrated {
            let off = egui::RichText::new("not in fit").small().color(palette.text3);
            ui.add(egui::Label::new(off).selectable(false)).on_hover_text(
                "This camera's silhouette does not count: tick it in the gutter or under More.",
            );
        }
        mode_menu(ui, input, events);
    });
    let builder = UiBuilder::new().max_rect(right).layout(Layout::left_to_right(Align::Center));
    ui.scope_builder(builder, |ui| {
        ui.spacing_mut().item_spacing.x = space::ROW;
        for &sibling in input.siblings {
            if pane_title::behind(ui, sibling).clicked() {
                events.push(TileEvent::Switch(sibling));
            }
        }
        ui.spacing_mut().item_spacing.x = 0.0;
        if has_link {
            link_button(ui, input, events);
        }
        buttons(ui, input, has_link, events);
    });
}

fn mode_menu(ui: &mut Ui, input: &CameraTileInput<'_>, events: &mut Vec<TileEvent>) {
    let palette = theme::palette(ui);
    let text = mode_text(input, false);
    let room = (ui.available_width() - CHEVRON).max(0.0);
    let lay_out =
        |text: &str, mode| WidgetText::from(text).into_galley(ui, Some(mode), room, TextStyle::Button);
    let mut galley = lay_out(&text, TextWrapMode::Extend);
    if galley.size().x > room {
        galley = lay_out(&mode_text(input, true), TextWrapMode::Truncate);
    }
    let (rect, response) = ui.allocate_exact_size(vec2(galley.size().x + CHEVRON, size::ROW), Sense::click());
    let label = format!("{}, view mode: {text}", input.name);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    let is_open = Popup::is_id_open(ui.ctx(), Popup::default_response_id(&response));
    let colour = if response.hovered() || is_open { palette.text } else { palette.text2 };
    let at = pos2(rect.left(), rect.center().y - galley.size().y * 0.5);
    ui.painter().galley(at, galley, colour);
    let chevron = Rect::from_min_max(pos2(rect.right() - size::ICON, rect.top()), rect.max);
    Icon::ChevronDown.paint_scaled(ui.painter(), chevron, colour, 0.85);
    if response.has_focus() {
        let radius = CornerRadius::same(size::BUTTON_RADIUS);
        ui.painter().rect_stroke(rect, radius, palette.focus_ring(), egui::StrokeKind::Outside);
    }
    let response = response.on_hover_text(input.look.mode.tooltip());
    Popup::menu(&response)
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| tile_menu::modes(ui, input, events));
}

fn link_button(ui: &mut Ui, input: &CameraTileInput<'_>, events: &mut Vec<TileEvent>) {
    let (icon, tooltip) = if input.is_linked {
        (Icon::Link, "Zooms and pans with the other linked views")
    } else {
        (Icon::Unlink, "Zooms and pans by itself")
    };
    let verb = if input.is_linked { "Unlink" } else { "Link" };
    if icon_button(ui, icon, &format!("{verb} zoom of {}", input.name), tooltip).clicked() {
        events.push(TileEvent::SetLinked(!input.is_linked));
    }
}

fn buttons(ui: &mut Ui, input: &CameraTileInput<'_>, has_link: bool, events: &mut Vec<TileEvent>) {
    let tooltip = if input.is_expanded { "Back to all views" } else { "Fill the window with this view" };
    if icon_button(ui, Icon::Expand, &format!("Expand {}", input.name), tooltip).clicked() {
        events.push(TileEvent::ToggleExpanded);
    }
    let more = icon_button(ui, Icon::More, &format!("More for {}", input.name), "More");
    Popup::menu(&more)
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| tile_menu::more(ui, input, has_link, events));
}

/// What the calibration says of a camera, in a sentence.
fn about(camera: &Camera) -> String {
    let focal = format::number(camera.intrinsics().mean_focal_px(), 0);
    let (width, height) = (camera.width(), camera.height());
    let [x, y, z] = camera.centre().to_array().map(|metres| format::number(metres, 2));
    format!(
        "In the take: {}. {width} × {height} pixels, focal length {focal} pixels, at {x}, {y}, {z} m.",
        camera.name()
    )
}

/// The sign of a camera without calibration.
fn paint_dashes(ui: &Ui, rect: Rect) {
    let stroke = theme::palette(ui).edge();
    let corners =
        [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom(), rect.left_top()];
    ui.painter().extend(egui::Shape::dashed_line(&corners, stroke, DASH, DASH));
}
