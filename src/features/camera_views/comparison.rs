//! Two view modes in one picture: a wipe with its handle, or a blink.

use std::sync::Arc;

use backlit_ui::drawing::{JointId, ModeComparison, ViewMode};
use backlit_ui::style::theme;
use backlit_ui::style::theme::data_colours::{CASING, JOINT};
use backlit_ui::style::theme::{Theme, size};
use backlit_ui::widgets::cased;
use egui::{
    CursorIcon, Galley, Id, Painter, Pos2, Rect, Sense, Stroke, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo,
    pos2, vec2,
};

use super::pointer::rotation_owner;
use super::{TileEvent, TileInput, TileView};

const WIPE_RADIUS: f32 = 11.0;

/// How far down the picture the wipe's handle is.
const WIPE_HEIGHT: f32 = 0.6;
const WIPE_WIDTH: f32 = 1.5;

/// From the picture's corner to the name of what is seen there.
const CHIP_AWAY: f32 = 8.0;

/// Around a name.
const CHIP_MARGIN: Vec2 = vec2(6.0, 3.0);

/// Opacity of a name's ground.
const CHIP_GROUND: f32 = 0.82;

/// What is seen in this frame of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ShownModes {
    /// One mode.
    One(ViewMode),
    /// Two modes, and where between them the handle is.
    Wiped(ViewMode, ViewMode, f32),
    /// Two modes one after the other, and whether the second is seen now.
    Blinking([ViewMode; 2], bool),
}

impl ShownModes {
    /// The mode that is seen: in a wipe, that of the left part.
    pub(crate) const fn mode(self) -> ViewMode {
        match self {
            Self::One(mode) | Self::Wiped(mode, ..) => mode,
            Self::Blinking(modes, is_other) => modes[is_other as usize],
        }
    }

    /// The mode that is seen at a point of the picture.
    pub(crate) fn mode_at(self, picture: Rect, at: Pos2) -> ViewMode {
        match self {
            Self::Wiped(_, other, share) if at.x >= picture.left() + picture.width() * share => other,
            _ => self.mode(),
        }
    }

    /// All modes that are compared, or the only one.
    pub(crate) fn modes(self) -> Vec<ViewMode> {
        match self {
            Self::One(mode) => vec![mode],
            Self::Wiped(mode, other, _) | Self::Blinking([mode, other], _) if mode == other => vec![mode],
            Self::Wiped(mode, other, _) | Self::Blinking([mode, other], _) => vec![mode, other],
        }
    }

    /// Whether a mode that is compared is not seen at this moment.
    pub(crate) fn is_hidden_now(self, mode: ViewMode) -> bool {
        matches!(self, Self::Blinking(..)) && mode != self.mode()
    }
}

/// Lets the pointer move the wipe's handle, or waits for the next blink.
pub(crate) fn seen(
    ui: &Ui,
    id: Id,
    rect: Rect,
    input: &TileInput<'_>,
    events: &mut Vec<TileEvent>,
) -> ShownModes {
    let shown = |mode| input.picture.shown(mode);
    let tile = &input.tile;
    match tile.comparison {
        None => ShownModes::One(shown(tile.mode)),
        Some(ModeComparison::Wipe) => {
            ShownModes::Wiped(shown(tile.mode), shown(tile.other), drag_handle(ui, id, rect, input, events))
        }
        Some(ModeComparison::Blink) => {
            let seconds = input.settings.blink_seconds();
            let (is_other, wait) = blink(ui.input(|input| input.time), seconds);
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(wait));
            ShownModes::Blinking([tile.mode, tile.other].map(shown), is_other)
        }
    }
}

/// Whether the second mode is seen at this time, and how long it stays so. All views blink together.
fn blink(time: f64, seconds: f64) -> (bool, f64) {
    let changes = (time / seconds).floor();
    (changes.rem_euclid(2.0) >= 1.0, ((changes + 1.0) * seconds - time).max(0.001))
}

fn drag_handle(ui: &Ui, id: Id, rect: Rect, input: &TileInput<'_>, events: &mut Vec<TileEvent>) -> f32 {
    let at = input.tile.wipe_at;
    let at = if at.is_finite() { at.clamp(0.0, 1.0) } else { 0.5 };
    let handle = Rect::from_center_size(wipe_handle(rect, at), vec2(size::BUTTON, size::BUTTON));
    let response = ui.interact(handle, id.with("wipe"), Sense::drag());
    let label = format!("Wipe to {}", input.tile.other.label().to_lowercase());
    response.widget_info(|| WidgetInfo::slider(true, f64::from(at), label.as_str()));
    let at = match response.interact_pointer_pos().filter(|_| response.dragged()) {
        Some(pointer) => {
            let moved = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
            events.push(TileEvent::SetView(TileView { wipe_at: moved, ..input.tile }));
            moved
        }
        None => at,
    };
    response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    at
}

fn wipe_handle(rect: Rect, at: f32) -> Pos2 {
    pos2(rect.left() + rect.width() * at, rect.top() + rect.height() * WIPE_HEIGHT)
}

/// The wipe's line with its handle.
pub(crate) fn paint_wipe(painter: &Painter, rect: Rect, at: f32) {
    let handle = wipe_handle(rect, at);
    for stroke in cased(WIPE_WIDTH, JOINT) {
        painter.vline(handle.x, rect.y_range(), stroke);
    }
    painter.circle(handle, WIPE_RADIUS, CASING, Stroke::new(WIPE_WIDTH, JOINT));
    for side in [-1.0, 1.0] {
        let tip = handle + vec2(side * 6.0, 0.0);
        let back = vec2(-side * 3.0, 3.5);
        let arrow = vec![tip + back, tip, tip + vec2(back.x, -back.y)];
        painter.line(arrow, Stroke::new(size::ICON_STROKE, JOINT));
    }
}

/// Names what is compared: in a wipe each side at its corner, in a blink both, the one that is seen now bright.
pub(crate) fn paint_names(ui: &Ui, painter: &Painter, rect: Rect, seen: ShownModes) {
    let palette = theme::colours(Theme::Dark);
    let font = TextStyle::Small.resolve(ui.style());
    let name = |mode: ViewMode, colour| painter.layout_no_wrap(mode.label().to_owned(), font.clone(), colour);
    let chip = |at: Rect, galley: Arc<Galley>| {
        painter.rect_filled(at, f32::from(size::FIELD_RADIUS), CASING.gamma_multiply(CHIP_GROUND));
        painter.galley(at.min + CHIP_MARGIN, galley, palette.text);
    };
    let corner = rect.shrink(CHIP_AWAY);
    match seen {
        ShownModes::One(_) => {}
        ShownModes::Wiped(mode, other, at) => {
            let line = rect.left() + rect.width() * at;
            let [left, right] = [mode, other].map(|mode| name(mode, palette.text));
            let left_at = Rect::from_min_size(corner.min, left.size() + 2.0 * CHIP_MARGIN);
            let size = right.size() + 2.0 * CHIP_MARGIN;
            let right_at = Rect::from_min_size(pos2(corner.right() - size.x, corner.top()), size);
            // A name stands on its own side or not at all.
            if left_at.right() + CHIP_AWAY <= line {
                chip(left_at, left);
            }
            if right_at.left() - CHIP_AWAY >= line {
                chip(right_at, right);
            }
        }
        ShownModes::Blinking(modes, is_other) => {
            let mut at = corner.min;
            for (mode, is_seen) in modes.into_iter().zip([!is_other, is_other]) {
                let galley = name(mode, if is_seen { palette.text } else { palette.text3 });
                let place = Rect::from_min_size(at, galley.size() + 2.0 * CHIP_MARGIN);
                at.x = place.right() + CHIP_AWAY * 0.5;
                chip(place, galley);
                if is_seen {
                    let edge = Stroke::new(1.0, palette.text2);
                    painter.rect_stroke(place, f32::from(size::FIELD_RADIUS), edge, StrokeKind::Inside);
                }
            }
        }
    }
}

/// What a mode is named where two are compared, for the header: "tinted overlay on footage | footage".
pub(crate) fn mode_text(input: &TileInput<'_>, is_short: bool) -> String {
    let tile = &input.tile;
    let axis = input.settings.axis;
    let mode = |mode: ViewMode| match (mode, is_short) {
        (ViewMode::JacobianColumn, true) => format!("J, {}", axis.short_label()),
        (ViewMode::JacobianColumn, false) => format!("{}, {}", mode.label(), axis_text(input)),
        (_, true) => mode.short_label().to_owned(),
        (_, false) => mode.label().to_owned(),
    };
    match tile.comparison {
        Some(ModeComparison::Wipe) => format!("{} | {}", mode(tile.mode), mode(tile.other).to_lowercase()),
        Some(ModeComparison::Blink) => format!("{} / {}", mode(tile.mode), mode(tile.other).to_lowercase()),
        None => mode(tile.mode),
    }
}

/// What the Jacobian's column is of: "right forearm about x", "root along z".
fn axis_text(input: &TileInput<'_>) -> String {
    let axis = input.settings.axis;
    let letter = axis.label().chars().last().unwrap_or('x');
    if axis.is_of_root() {
        return format!("root along {letter}");
    }
    let owner = match input.selected {
        Some(JointId::End(limb)) => rotation_owner(input.body, limb),
        Some(JointId::Root) | None => input.body.rotation_owners().first().copied().unwrap_or_default(),
    };
    format!("{} about {letter}", input.limb_name(owner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blink_changes_at_its_rate() {
        assert!(!blink(0.2, 0.5).0);
        assert!(blink(0.6, 0.5).0);
        assert!(!blink(1.1, 0.5).0);
        assert!((blink(1.1, 0.5).1 - 0.4).abs() < 1e-9);
    }
}
