//! The title in a pane's header with the panes that stand behind it: one row for both, whatever they are.

use backlit_ui::style::format::uncapitalised;
use backlit_ui::style::theme::{self, size, space};
use backlit_ui::widgets::{camera_badge, within};
use egui::{
    Align, Button, Label, Layout, Rect, Response, RichText, Role, TextStyle, TextWrapMode, Ui, UiBuilder,
    WidgetInfo, WidgetText, vec2,
};

use crate::context::pane::Pane;
use crate::context::{PaneEvent, Requests, ShellRequest};

/// The title of a pane that is no camera, and the panes behind it.
pub(crate) fn show(ui: &mut Ui, pane: Pane, siblings: &[Pane], requests: &mut Requests) {
    ui.add(Label::new(pane.title()).selectable(false));
    for sibling in siblings {
        if behind(ui, *sibling).clicked() {
            requests.request(ShellRequest::Pane(*sibling, PaneEvent::Open));
        }
    }
}

/// A row of a header.
pub(crate) fn row(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), size::TILE_HEADER);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_height(size::TILE_HEADER);
        add(ui);
    });
}

/// What stands in the middle of a pane that has nothing to show: a text of this width, or of the pane's if that is less,
/// and a row below.
pub(crate) fn in_the_middle(ui: &mut Ui, width: f32, text: &str, below: impl FnOnce(&mut Ui)) {
    let area = ui.available_rect_before_wrap();
    let width = width.min(area.width() - 2.0 * space::WIDGET);
    let text = WidgetText::from(RichText::new(text).color(theme::palette(ui).text3));
    let text = text.into_galley(ui, Some(TextWrapMode::Wrap), width, TextStyle::Body);
    let size = vec2(width, text.size().y + space::WIDGET + ui.spacing().interact_size.y);
    within(ui, Rect::from_center_size(area.center(), size), Layout::top_down(Align::Center), |ui| {
        ui.label(text);
        ui.add_space(space::WIDGET);
        below(ui);
    });
}

/// The ground of a pane that is no picture, in all of the space that is left.
pub(crate) fn ground(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).panel);
    let inner = UiBuilder::new().max_rect(rect.shrink2(vec2(space::WIDGET, 0.0)));
    ui.scope_builder(inner, contents);
}

/// A pane that stands behind the one on the screen, as a button.
pub(crate) fn behind(ui: &mut Ui, pane: Pane) -> Response {
    let title = pane.title();
    let response = match pane {
        Pane::Camera(index) => camera_badge(ui, index),
        _ => {
            let text = RichText::new(&title).color(theme::palette(ui).text3);
            let button = ui.add(Button::new(text).frame(false));
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Show {title}")));
            button
        }
    };
    response.on_hover_text(format!("Show {} here", uncapitalised(&title)))
}

/// How wide that button is.
pub(crate) fn width_behind(ui: &Ui, pane: Pane) -> f32 {
    match pane {
        Pane::Camera(_) => size::BADGE,
        _ => {
            let text = WidgetText::from(pane.title());
            let galley = text.into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, TextStyle::Button);
            galley.size().x + 2.0 * ui.spacing().button_padding.x
        }
    }
}
