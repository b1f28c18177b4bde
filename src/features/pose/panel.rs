//! The Pose section: the tree of limbs, with each one's share of the mismatch and its pin.

use backlit_document::edit::Edit;
use backlit_tracking::body::Model;
use backlit_ui::drawing::JointId;
use backlit_ui::style::format;
use backlit_ui::style::theme;
use backlit_ui::style::theme::{size, space};
use backlit_ui::widgets::{checkbox, paint_text, section};
use egui::{Align2, Rect, Response, Role, Sense, StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::context::command::{Command, PoseCommand};
use crate::context::{Context, FeatureRequest, Requests, SessionRequest};
use crate::session::selection::Selection;

const INDENT: f32 = 11.0;
/// Width of the bar of a share.
const BAR: f32 = 60.0;
const PIN: f32 = 28.0;
/// Width of the mark at the edge of the selected row.
const SELECTION_MARK: f32 = 3.0;

pub(super) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, open: bool) {
    let model = &context.document().model;
    let held = format::capitalised(&model.limbs()[context.selection.limb(model)].name);
    section(ui, "Pose", if open { "Share of mismatch    Pin" } else { &held }, open, |ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let shares = shares(context);
        for (rotation, depth) in rotation_tree(model) {
            let limb = model.rotation_owners()[rotation];
            row(ui, context, requests, limb, depth, shares.get(rotation).copied());
        }
        ui.add_space(space::ROW);
        let mut settings = context.views;
        let hold = checkbox(ui, &mut settings.hold_trunk, "Hold the trunk");
        if hold.on_hover_text(Command::Pose(PoseCommand::HoldTrunk).tooltip()).changed() {
            requests.request(FeatureRequest::Views(settings));
        }
    });
}

/// The rotations with their depths, each followed by those that turn with it.
pub(super) fn rotation_tree(model: &Model) -> Vec<(usize, usize)> {
    let children = |parent: Option<usize>| {
        let parents = model.rotation_parents().iter().enumerate();
        parents.filter(move |(_, other)| **other == parent).map(|(rotation, _)| rotation).rev()
    };
    let mut open: Vec<(usize, usize)> = children(None).map(|rotation| (rotation, 0)).collect();
    let mut rows = Vec::with_capacity(model.rotation_count());
    while let Some((rotation, depth)) = open.pop() {
        rows.push((rotation, depth));
        open.extend(children(Some(rotation)).map(|child| (child, depth + 1)));
    }
    rows
}

/// Each rotation's share of the squared residual, relative to the largest.
fn shares(context: &Context<'_>) -> Vec<f32> {
    let model = &context.document().model;
    let Some(predicted) = &context.session.predicted else { return Vec::new() };
    let mut sums = vec![0.0; model.rotation_count()];
    for (limb, mismatch) in model.limbs().iter().zip(&predicted.mismatch_by_limb) {
        sums[limb.rotation] += mismatch;
    }
    let most = sums.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    sums.into_iter().map(|sum| (sum / most) as f32).collect()
}

fn row(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    limb: usize,
    depth: usize,
    share: Option<f32>,
) {
    let model = &context.document().model;
    let joint = Selection::joint_of(model, limb);
    let is_held = context.selection.limb(model) == limb;
    let is_root = joint == JointId::Root;
    let name = format::capitalised(&model.limbs()[limb].name) + if is_root { " (root)" } else { "" };
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width() - PIN, size::ROW), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::ListItem, true, is_held, &name));
    if response.clicked() {
        requests.request(SessionRequest::Joint(joint));
    }
    let palette = theme::palette(ui);
    let whole = Rect::from_x_y_ranges(ui.max_rect().expand(space::PANEL_MARGIN).x_range(), rect.y_range());
    if is_held {
        ui.painter().rect_filled(whole, 0.0, palette.select);
        let mark = Rect::from_min_size(whole.min, vec2(SELECTION_MARK, whole.height()));
        ui.painter().rect_filled(mark, 0.0, palette.accent);
    } else if response.hovered() {
        ui.painter().rect_filled(whole, 0.0, palette.raised);
    }
    let colour = if is_held { palette.accent_text } else { palette.text };
    let at = pos2(rect.left() + 8.0 + INDENT * depth as f32, rect.center().y);
    paint_text(ui, at, Align2::LEFT_CENTER, &name, TextStyle::Body, colour);
    bar(ui, rect, share, is_held);
    let share_text = share.filter(|share| share.is_finite()).map_or_else(String::new, |share| {
        let percent = format::percent(f64::from(share));
        format!(" Its pixels are {percent} as wrong as those of the worst limb, by the sum of (D − Λ)².")
    });
    let response = response
        .on_hover_text(format!("Select the {}; Tab goes to the next.{share_text}", model.limbs()[limb].name));
    if let JointId::End(end) = joint {
        pin(ui, context, requests, end, rect, is_held || response.hovered());
    }
}

fn bar(ui: &Ui, rect: Rect, share: Option<f32>, is_held: bool) {
    let palette = theme::palette(ui);
    let well = Rect::from_center_size(pos2(rect.right() - BAR / 2.0 - 4.0, rect.center().y), vec2(BAR, 5.0));
    ui.painter().rect_filled(well, 1.0, palette.field);
    let Some(share) = share.filter(|share| share.is_finite()) else { return };
    let mut fill = well;
    fill.set_width((well.width() * share.clamp(0.0, 1.0)).max(2.0));
    ui.painter().rect_filled(fill, 1.0, if is_held { palette.accent } else { palette.text3 });
}

fn pin(ui: &Ui, context: &Context<'_>, requests: &mut Requests, limb: usize, row: Rect, is_near: bool) {
    let is_pinned = context.document().pins.contains(&limb);
    let rect = Rect::from_min_size(row.right_top(), vec2(PIN, row.height()));
    let id = ui.scope_id().with(("pin", limb));
    let response: Response = ui.interact(rect, id, Sense::click());
    let name = &context.document().model.limbs()[limb].name;
    response
        .widget_info(|| WidgetInfo::selected(Role::CheckBox, true, is_pinned, format!("Pin end of {name}")));
    if response.clicked() {
        requests.edit(Edit::Pin { limb, pinned: !is_pinned });
    }
    let palette = theme::palette(ui);
    let square = Rect::from_center_size(rect.center() + vec2(5.0, 0.0), vec2(7.0, 7.0));
    if is_pinned {
        ui.painter().rect_filled(square, 1.0, palette.text);
    } else if is_near || response.hovered() || response.has_focus() {
        ui.painter().rect_stroke(square, 1.0, egui::Stroke::new(1.0, palette.text3), StrokeKind::Inside);
    }
    response.on_hover_text("A pinned joint stays where it is while others are dragged   I");
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn limbs_stand_below_the_one_they_turn_with() {
        let model = builtin::full_body();
        let rows = rotation_tree(&model);
        assert_eq!(rows.len(), model.rotation_count());
        let name = |row: usize| model.limbs()[model.rotation_owners()[rows[row].0]].name.as_str();
        let arm = (0..rows.len()).find(|row| name(*row) == "right upper arm").unwrap();
        assert_eq!((name(arm - 1), name(arm + 1)), ("right clavicle", "right forearm"));
        assert_eq!(rows[arm + 1].1, rows[arm].1 + 1);
    }
}
