//! Beside a portrait picture: how model and data overlap, the camera's use in the fit, and what a drag does.

use backlit_tracking::body::split_side;
use backlit_tracking::silhouette::Overlap;
use backlit_ui::drawing::{SightRay, joint_name};
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{AGREEMENT, GHOST, MISSING, SELECTED, SPURIOUS, mark};
use backlit_ui::style::theme::{headline, size, space};
use backlit_ui::widgets::{Grip, ValueSlider, checkbox, paint_text, within};
use egui::{
    Align, Align2, Color32, CornerRadius, Layout, Painter, Rect, RichText, Role, Sense, Shape, Stroke,
    StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::pointer::{Action, Pointer};
use super::tile::TileState;
use super::{TileEvent, TileInput, overlays};
use crate::context::command_button::gesture;

const ROW: f32 = 20.0;
const SWATCH: f32 = 9.0;
const BAR: f32 = 5.0;
const BAR_GAP: f32 = 2.0;
const WEIGHT_SLIDER: f32 = 72.0;
const MAX_WEIGHT: f64 = 2.0;

/// Where the words beside the keys begin.
const KEY_COLUMN: f32 = 84.0;

pub(super) fn show(ui: &mut Ui, rect: Rect, input: &TileInput<'_>, state: &mut TileState) {
    let inner = rect.shrink2(vec2(space::GUTTER_MARGIN, space::GROUP));
    within(ui, inner, Layout::top_down(Align::Min), |ui| {
        ui.set_clip_rect(rect.intersect(ui.clip_rect()));
        ui.spacing_mut().item_spacing.y = 0.0;
        if !input.is_calibrated {
            ui.label(RichText::new("Not calibrated: pictures only").color(theme::palette(ui).text3));
            return;
        }
        show_overlap(ui, input);
        if input.picture.mask.is_none() && input.picture.data.is_none() {
            ui.add_space(space::ROW);
            let text = RichText::new(NO_SILHOUETTE).small().color(theme::palette(ui).text2);
            ui.add(egui::Label::new(text).wrap());
        }
        separator(ui);
        show_fit_use(ui, input, &mut state.events);
        show_drag(ui, input, &state.pointer);
    });
}

/// What a user can do where a camera has no silhouette.
const NO_SILHOUETTE: &str =
    "Drop a mask of this frame on the window, or name a background picture in take.toml.";

/// What the number is.
pub(super) const IOU: &str = "IoU: what silhouette and body have in common, as a share of what either covers. 1 is a perfect fit. \
                              The body has hard edges here, whatever the ramp of the fit. Unknown pixels, hatched, are left out.";

/// Overlap in words and numbers, for the gutter and for the header's tooltip.
pub(crate) fn show_overlap(ui: &mut Ui, input: &TileInput<'_>) {
    let palette = theme::palette(ui);
    let Some(overlap) = input.overlap else {
        let no_mask = input.picture.mask.is_none() && input.picture.data.is_none();
        let text = match input.marks.ghosts {
            Some(_) => "A step of a way to begin is shown; the pose is hidden.",
            None if no_mask => "No silhouette yet",
            None => "No overlap yet",
        };
        ui.add(egui::Label::new(RichText::new(text).color(palette.text3)).wrap());
        return;
    };
    let colour = if input.is_overlap_stale { palette.text3 } else { palette.text };
    let iou = overlap.iou().map_or(format::MISSING.to_owned(), format::ratio);
    let font = headline();
    let row = number_row(ui, None, "IoU", &iou, font, colour);
    row.on_hover_text(IOU);
    ui.add_space(space::ROW);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), BAR), Sense::hover());
    paint_bar(ui.painter(), rect, &overlap);
    ui.add_space(space::ROW);
    let parts = [
        (AGREEMENT, "Agreement", overlap.agreement, "Pixels of the silhouette that the body covers"),
        (MISSING, "Missing", overlap.missing, "Pixels of the silhouette that the body does not cover"),
        (SPURIOUS, "Spurious", overlap.spurious, "Pixels of the body where there is no silhouette"),
    ];
    for (swatch, label, count, tooltip) in parts {
        let count = format::count(i64::try_from(count).unwrap_or(i64::MAX));
        number_row(ui, Some(swatch), label, &count, TextStyle::Monospace, colour).on_hover_text(tooltip);
    }
    if let Some((label, swatch)) = overlays::doubts_legend(input) {
        let count = input.doubts.len().to_string();
        number_row(ui, Some(swatch), label, &count, TextStyle::Monospace, palette.text)
            .on_hover_text(overlays::doubts_tooltip(input));
    }
    if !input.marks.rivals.is_empty() {
        let count = input.marks.rivals.len().to_string();
        number_row(ui, Some(GHOST), overlays::RIVAL_LEGEND, &count, TextStyle::Monospace, palette.text)
            .on_hover_text(
                "Poses that the tracker carried beside this one, with how likely each is. A click on the number in the picture takes \
                 the pose",
            );
    }
}

/// Whether, and how much, the camera counts in the fit.
pub(crate) fn show_fit_use(ui: &mut Ui, input: &TileInput<'_>, events: &mut Vec<TileEvent>) {
    let mut is_used = input.is_used;
    let used = checkbox(ui, &mut is_used, "Used in the fit")
        .on_hover_text("Whether this camera’s silhouette counts in the fit. If not, the view is only shown");
    if used.changed() {
        events.push(TileEvent::SetUsed(is_used));
    }
    let palette = theme::palette(ui);
    ui.horizontal(|ui| {
        ui.set_height(size::ROW);
        let text = if input.is_used { palette.text2 } else { palette.text3 };
        ui.label(RichText::new("Weight").color(text));
        ui.add_enabled_ui(input.is_used, |ui| {
            let mut weight = input.weight;
            let label = format!("Weight of {}", input.name());
            let slider = ValueSlider::new(&mut weight, 0.0..=MAX_WEIGHT, &label);
            let slider = ui.add(ValueSlider { width: WEIGHT_SLIDER, ..slider });
            let drag = gesture(ui, "weight", &slider);
            if slider.changed() {
                events.push(TileEvent::SetWeight(weight, drag));
            }
            slider.on_hover_text(
                "How much each pixel of this camera counts in the fit, next to those of the others",
            );
        });
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.label(RichText::new(format::number(input.weight, 2)).monospace().color(text));
        });
    });
}

/// What is dragged here, or the ray of what is dragged in another view.
fn show_drag(ui: &mut Ui, input: &TileInput<'_>, pointer: &Pointer) {
    let palette = theme::palette(ui);
    let held = pointer.action().map(|action| match action {
        Action::Joint(joint) => format!("Dragging {}", joint_name(input.body, joint)),
        Action::Depth(joint) => format!("Depth of {}", joint_name(input.body, joint)),
        Action::Twist(limb) => format!("Twisting {}", input.limb_name(limb)),
        Action::Turn(limb) => format!("Turning {}", input.limb_name(limb)),
        Action::Body => "Moving the whole body".to_owned(),
        Action::Length(limb) => format!("Length of {}", input.limb_name(limb)),
        Action::Radius(limb) => format!("Radius of {}", input.limb_name(limb)),
    });
    let hovered = pointer.hovered.or(pointer.grip()).map(|grip| grip_name(input, grip));
    if let Some(title) = held.as_ref().or(hovered.as_ref()) {
        separator(ui);
        let colour = if held.is_some() { palette.accent_text } else { palette.text };
        ui.label(RichText::new(title).color(colour));
        ui.add_space(space::ROW);
        let is_size = matches!(pointer.hovered.or(pointer.grip()), Some(Grip::Length(_) | Grip::Radius(_)));
        let keys: &[(&str, &str)] = match () {
            () if !is_size => &[("Shift", "depth"), ("Ctrl", "twist"), ("Ctrl Shift", "whole body")],
            () if input.settings.both_sides => &[("Drag", "on both sides")],
            () => &[("Drag", "this limb alone")],
        };
        let escape = held.is_some().then_some(("Esc", "put back"));
        for (key, act) in keys.iter().copied().chain(escape) {
            key_row(ui, key, act);
        }
    } else if let Some(ray) = &input.marks.sight_ray {
        separator(ui);
        show_ray(ui, input, ray);
    }
}

/// What people call something that can be taken hold of.
pub(crate) fn grip_name(input: &TileInput<'_>, grip: Grip) -> String {
    match grip {
        Grip::Joint(joint) => format::capitalised(&joint_name(input.body, joint)),
        Grip::Limb(limb) => format::capitalised(input.limb_name(limb)),
        Grip::Length(limb) => format!("Length of {}", input.limb_name(limb)),
        Grip::Radius(limb) => format!("Radius of {}", input.limb_name(limb)),
    }
}

fn show_ray(ui: &mut Ui, input: &TileInput<'_>, ray: &SightRay) {
    let palette = theme::palette(ui);
    let text = format!("Sight ray, camera {}", ray.camera + 1);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
    let sample = [rect.left_center(), rect.left_center() + vec2(18.0, 0.0)];
    let colour = if ui.visuals().dark_mode { SELECTED } else { palette.accent_text };
    let [dash, gap] = mark::RAY_DASH;
    ui.painter().extend(Shape::dashed_line(&sample, Stroke::new(mark::RAY_WIDTH, colour), dash, gap));
    let at = pos2(rect.left() + 28.0, rect.center().y);
    paint_text(ui, at, Align2::LEFT_CENTER, text, TextStyle::Body, palette.text2);
    let selected = input.marks.joints.iter().find(|joint| Some(joint.id) == input.selected);
    if let Some(joint) = selected {
        let name = joint_name(input.body, joint.id);
        let label = format!("{} depth here", format::capitalised(split_side(&name).1));
        let depth = format!("{} m", format::number(joint.depth_m, 2));
        number_row(ui, None, &label, &depth, TextStyle::Monospace, palette.text);
    }
}

fn separator(ui: &mut Ui) {
    ui.add_space(space::GROUP);
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), size::HAIRLINE), Sense::hover());
    ui.painter().hline(rect.x_range(), rect.center().y, theme::palette(ui).hairline());
    ui.add_space(space::WIDGET);
}

/// A row with a word at the left and a number at the right.
fn number_row(
    ui: &mut Ui,
    swatch: Option<Color32>,
    label: &str,
    number: &str,
    style: TextStyle,
    colour: Color32,
) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{label} {number}")));
    let palette = theme::palette(ui);
    let mut left = rect.left();
    if let Some(swatch) = swatch {
        let square = Rect::from_center_size(pos2(left + SWATCH * 0.5, rect.center().y), vec2(SWATCH, SWATCH));
        let edge = if ui.visuals().dark_mode { Stroke::NONE } else { palette.edge() };
        ui.painter().rect(square, CornerRadius::same(2), swatch, edge, StrokeKind::Inside);
        left += SWATCH + space::WIDGET;
    }
    paint_text(ui, pos2(left, rect.center().y), Align2::LEFT_CENTER, label, TextStyle::Body, palette.text2);
    paint_text(ui, rect.right_center(), Align2::RIGHT_CENTER, number, style, colour);
    response
}

fn key_row(ui: &mut Ui, key: &str, act: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{key}: {act}")));
    let palette = theme::palette(ui);
    paint_text(ui, rect.left_center(), Align2::LEFT_CENTER, key, TextStyle::Monospace, palette.text);
    let at = pos2(rect.left() + KEY_COLUMN, rect.center().y);
    paint_text(ui, at, Align2::LEFT_CENTER, act, TextStyle::Small, palette.text3);
}

/// The shares of agreement, missing and spurious.
pub(super) fn paint_bar(painter: &Painter, rect: Rect, overlap: &Overlap) {
    let parts = [(overlap.agreement, AGREEMENT), (overlap.missing, MISSING), (overlap.spurious, SPURIOUS)];
    let total: usize = parts.iter().map(|(count, _)| count).sum();
    let shown = parts.iter().filter(|(count, _)| *count > 0).count();
    let width = rect.width() - BAR_GAP * shown.saturating_sub(1) as f32;
    let mut left = rect.left();
    for (count, colour) in parts.into_iter().filter(|(count, _)| *count > 0) {
        let part = width * (count as f64 / total as f64) as f32;
        let part_rect = Rect::from_min_size(pos2(left, rect.top()), vec2(part, rect.height()));
        painter.rect_filled(part_rect, CornerRadius::same(1), colour);
        left += part + BAR_GAP;
    }
}
