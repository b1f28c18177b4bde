//! A tile's header: badge, name, view mode, link, expand, more; and its two menus, what the picture shows and all the rest.

use backlit_tracking::camera::Camera;
use backlit_ui::drawing::{ModeComparison, StateAxis, ViewMode};
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{
    CHEVRON, Framing, Icon, ValueSlider, camera_badge, checkbox, icon_button, menu_words, within,
};
use egui::{
    Align, Button, CornerRadius, Layout, Popup, Rect, RichText, Role, Sense, TextStyle, TextWrapMode, Ui,
    WidgetInfo, WidgetText, pos2, vec2,
};

use super::comparison::mode_text;
use super::tile::TileLayout;
use super::{TileEvent, TileInput, TileView, gutter};
use crate::context::command::{Command, ViewCommand};
use crate::context::pane_title;
use crate::context::view_settings::ViewSettings;

/// In a narrower header the link button folds into the menu.
const LINK_FROM: f32 = 300.0;

/// A wider header has the camera's name in the take too.
const NAME_FROM: f32 = 420.0;

/// A narrower header has no word beside the badge.
const TITLE_FROM: f32 = 236.0;

/// Width of the button back to all views, with the space behind it.
const BACK: f32 = 84.0;

/// Height of the overlap's bar at the foot of a header, where no gutter has it.
const OVERLAP_BAR: f32 = 3.0;

/// Dashes around the badge of a camera without calibration.
const DASH: f32 = 2.5;

pub(crate) fn show(ui: &mut Ui, layout: &TileLayout, input: &TileInput<'_>, events: &mut Vec<TileEvent>) {
    let rect = layout.header;
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).raised);
    let back = ui.interact(rect, ui.scope_id().with("header"), Sense::click_and_drag());
    back.widget_info(|| WidgetInfo::labeled(Role::TitleBar, true, format!("{} header", input.name())));
    if back.double_clicked() {
        events.push(TileEvent::ToggleExpanded);
    } else if back.clicked() {
        events.push(TileEvent::Activate);
    } else if back.drag_started() {
        events.push(TileEvent::DragTile);
    }
    if layout.gutter.is_none() {
        back.on_hover_ui(|ui| gutter::show_overlap(ui, input));
        if let Some(overlap) = &input.overlap {
            let bar = rect.with_min_y(rect.bottom() - OVERLAP_BAR);
            gutter::paint_bar(ui.painter(), bar, overlap);
        }
    }

    let has_link = rect.width() >= LINK_FROM;
    let badges_width: f32 =
        input.siblings.iter().map(|sibling| pane_title::width_behind(ui, *sibling) + space::ROW).sum();
    let back_width = if input.is_expanded { BACK } else { 0.0 };
    let buttons_width =
        if has_link { 3.0 } else { 2.0 } * size::BUTTON + space::ROW + badges_width + back_width;
    let (left, right) = rect.split_left_right_at_x((rect.right() - buttons_width).max(rect.left()));
    let left = Rect::from_min_max(pos2(left.left() + space::WIDGET, left.top()), left.max);
    within(ui, left, Layout::left_to_right(Align::Center), |ui| {
        if camera_badge(ui, input.index).on_hover_text(expand_tooltip(input)).clicked() {
            events.push(TileEvent::ToggleExpanded);
        }
        if !input.is_calibrated {
            paint_dashes(
                ui,
                Rect::from_center_size(pos2(left.left() + 8.0, left.center().y), vec2(18.0, 18.0)),
            );
        }
        let palette = theme::palette(ui);
        let name = RichText::new(input.name());
        let name = if input.is_used { name } else { name.color(palette.text3) };
        // The badge has the number; where there is little room the mode needs it more than the word.
        let name = (rect.width() >= TITLE_FROM).then(|| ui.add(egui::Label::new(name).selectable(false)));
        if let Some(camera) = input.camera {
            if let Some(name) = name {
                name.on_hover_text(about(camera));
            }
            if rect.width() >= NAME_FROM {
                let name = RichText::new(camera.name()).small().color(palette.text3);
                ui.add(egui::Label::new(name).selectable(false));
            }
        }
        if !input.is_used && input.is_calibrated {
            let off = RichText::new("not in fit").small().color(palette.text3);
            ui.add(egui::Label::new(off).selectable(false)).on_hover_text(
                "This camera’s silhouette does not count: tick it in the gutter or under More.",
            );
        }
        mode_menu(ui, input, events);
    });
    show_buttons(ui, right, input, has_link, events);
}

/// Cameras that stand behind this one, the way back, link, expand, more.
fn show_buttons(
    ui: &mut Ui,
    right: Rect,
    input: &TileInput<'_>,
    has_link: bool,
    events: &mut Vec<TileEvent>,
) {
    within(ui, right, Layout::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = space::ROW;
        for &sibling in input.siblings {
            if pane_title::behind(ui, sibling).clicked() {
                events.push(TileEvent::Switch(sibling));
            }
        }
        ui.spacing_mut().item_spacing.x = 0.0;
        if input.is_expanded {
            let back = Button::new("All views").min_size(vec2(BACK - space::WIDGET, size::ROW));
            let back = ui.add(back).on_hover_text("Back to all views, with their timeline   Esc");
            if back.clicked() {
                events.push(TileEvent::ToggleExpanded);
            }
            ui.add_space(space::WIDGET);
        }
        let name = input.name();
        if has_link {
            let (icon, verb, tooltip) = if input.is_linked {
                (
                    Icon::Link,
                    "Unlink",
                    "All views zoom and pan together, about the same point of the body   Z",
                )
            } else {
                (Icon::Unlink, "Link", "This view zooms and pans by itself; link it with the others   Z")
            };
            if icon_button(ui, icon, &format!("{verb} zoom of {name}"), tooltip).clicked() {
                events.push(TileEvent::SetLinked(!input.is_linked));
            }
        }
        if icon_button(ui, Icon::Expand, &format!("Expand {name}"), &expand_tooltip(input)).clicked() {
            events.push(TileEvent::ToggleExpanded);
        }
        let tooltip = "Framing, marks, and how much this camera counts in the fit";
        let more = icon_button(ui, Icon::More, &format!("More for {name}"), tooltip);
        Popup::menu(&more)
            .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
            .show(|ui| more_menu_entries(ui, input, has_link, events));
    });
}

fn mode_menu(ui: &mut Ui, input: &TileInput<'_>, events: &mut Vec<TileEvent>) {
    let text = mode_text(input, false);
    let room = (ui.available_width() - CHEVRON).max(0.0);
    let lay_out =
        |text: &str, mode| WidgetText::from(text).into_galley(ui, Some(mode), room, TextStyle::Button);
    let mut galley = lay_out(&text, TextWrapMode::Extend);
    if galley.size().x > room {
        galley = lay_out(&mode_text(input, true), TextWrapMode::Truncate);
    }
    let response = menu_words(ui, galley, &format!("{}, view mode: {text}", input.name()));
    if response.has_focus() {
        let radius = CornerRadius::same(size::BUTTON_RADIUS);
        let ring = theme::palette(ui).focus_ring();
        ui.painter().rect_stroke(response.rect, radius, ring, egui::StrokeKind::Outside);
    }
    let mode = input.tile.mode;
    let tooltip = format!("{}: {}   {}", mode.label(), mode.tooltip(), mode.key());
    let response = response.on_hover_text(tooltip);
    Popup::menu(&response)
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| mode_menu_entries(ui, input, events));
}

/// What a click on badge or button does, with its keys.
fn expand_tooltip(input: &TileInput<'_>) -> String {
    let key = Command::View(ViewCommand::CameraAlone(input.index)).keys_text();
    let key = key.map_or_else(String::new, |key| format!("   {key}"));
    if input.is_expanded {
        format!("Back to all views   Esc, or{key}")
    } else {
        format!("{} alone in the window, and back; also by a double click on the header{key}", input.name())
    }
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

const RATE_SLIDER: f32 = 96.0;
const MENU_WIDTH: f32 = 220.0;

/// The view modes; below them what the mode is compared with, and the Jacobian's axis.
fn mode_menu_entries(ui: &mut Ui, input: &TileInput<'_>, events: &mut Vec<TileEvent>) {
    ui.set_min_width(MENU_WIDTH);
    let tile = &input.tile;
    let mut set = |change: &dyn Fn(&mut TileView)| {
        let mut view = *tile;
        change(&mut view);
        events.push(TileEvent::SetView(view));
    };
    for mode in ViewMode::ALL {
        let entry = Button::new(mode.label()).shortcut_text(mode.key()).selected(mode == tile.mode);
        if ui.add(entry).on_hover_text(mode.tooltip()).clicked() {
            set(&|view| view.set_mode(mode));
            ui.close();
        }
    }
    ui.separator();
    for (comparison, text, key, tooltip) in [
        (ModeComparison::Wipe, "Wipe", "W", "Two modes side by side; drag the handle between them"),
        (ModeComparison::Blink, "Blink", "B", "Two modes one after the other: what differs seems to move"),
    ] {
        let entry = Button::new(text).shortcut_text(key).selected(tile.comparison == Some(comparison));
        if ui.add(entry).on_hover_text(tooltip).clicked() {
            set(&|view| view.toggle(comparison));
        }
    }
    let title = format!("Compare with: {}", tile.other.label().to_lowercase());
    ui.menu_button(title, |ui| {
        for mode in ViewMode::ALL.into_iter().filter(|mode| *mode != tile.mode) {
            let is_other = tile.comparison.is_some() && mode == tile.other;
            let entry = Button::new(format!("With {}", mode.label().to_lowercase())).selected(is_other);
            if ui.add(entry).on_hover_text(mode.tooltip()).clicked() {
                set(&|view| view.compare_with(mode));
            }
        }
    });
    blink_rate(ui, input, events);
    ui.separator();
    let settings = input.settings;
    ui.menu_button(format!("Jacobian: {}", settings.axis.label().to_lowercase()), |ui| {
        for axis in StateAxis::ALL {
            let tooltip = if axis.is_of_root() {
                "A move of the whole body along an axis of the world"
            } else {
                "A turn of the selected limb about an axis of its parent’s frame"
            };
            let entry = Button::new(axis.label()).selected(axis == settings.axis);
            if ui.add(entry).on_hover_text(tooltip).clicked() {
                events.push(TileEvent::SetSettings(ViewSettings { axis, ..settings }));
                ui.close();
            }
        }
    });
}

fn blink_rate(ui: &mut Ui, input: &TileInput<'_>, events: &mut Vec<TileEvent>) {
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        ui.set_height(size::ROW);
        ui.add_space(space::WIDGET);
        ui.label(RichText::new("Rate").color(palette.text2));
        let mut rate = f64::from(input.settings.blink_hz);
        let slider = ValueSlider::new(&mut rate, ViewSettings::BLINK_HZ, "Blink rate");
        let slider = ValueSlider { width: RATE_SLIDER, ..slider };
        if ui.add(slider).on_hover_text("How often a blinking view changes").changed() {
            let settings = ViewSettings { blink_hz: rate as f32, ..input.settings };
            events.push(TileEvent::SetSettings(settings));
        }
        let text = format!("{} / s", format::number(rate, 1));
        ui.label(RichText::new(text).monospace().color(palette.text2));
    });
}

/// Framing, marks, and the camera's use in the fit.
fn more_menu_entries(ui: &mut Ui, input: &TileInput<'_>, has_link: bool, events: &mut Vec<TileEvent>) {
    ui.set_min_width(MENU_WIDTH);
    for (text, key, framing, tooltip) in [
        (
            "Fit subject",
            "F",
            Framing::Subject,
            "As large as possible with the subject of all frames in view; the wheel zooms from there",
        ),
        ("Whole picture", "A", Framing::Whole, "All that the camera saw"),
    ] {
        let entry = Button::new(text).shortcut_text(key).selected(input.tile.framing == framing);
        if ui.add(entry).on_hover_text(tooltip).clicked() {
            events.push(TileEvent::SetFraming(framing));
            ui.close();
        }
    }
    let mut is_linked = input.is_linked;
    if !has_link && checkbox(ui, &mut is_linked, "Zoom linked").changed() {
        events.push(TileEvent::SetLinked(is_linked));
    }
    ui.separator();
    let mut settings = input.settings;
    let marks = checkbox(ui, &mut settings.calibration_marks, "Calibration marks").on_hover_text(
        "Principal point, axes of the world, half-metre grid through its origin, edge of what the lens saw   Q",
    );
    let sides = checkbox(ui, &mut settings.side_marks, "Left, right and face").on_hover_text(
        "L and R beside hands and feet; a nose whose tip is filled where the body faces the camera",
    );
    let grid = checkbox(ui, &mut settings.pixel_grid, "Pixel grid")
        .on_hover_text("Lines between pixels where they are shown large");
    let spheres = checkbox(ui, &mut settings.spheres, "Spheres")
        .on_hover_text("With the sphere tree: a circle for each sphere of the body");
    if spheres.changed() || marks.changed() || sides.changed() || grid.changed() {
        events.push(TileEvent::SetSettings(settings));
    }
    ui.separator();
    gutter::show_fit_use(ui, input, events);
    ui.separator();
    let close = ui.add(Button::new("Close tile"));
    if close.on_hover_text("The View menu opens it again").clicked() {
        events.push(TileEvent::Close);
        ui.close();
    }
}
