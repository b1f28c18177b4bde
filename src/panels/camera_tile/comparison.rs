//! Two view modes in one picture: a wipe with its handle, or a blink.

use egui::{CursorIcon, Id, Painter, Pos2, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::{CameraTileInput, Comparison, TileEvent};
use crate::picture::ViewMode;
use crate::theme::data_colours::{CASING, JOINT};
use crate::theme::size;

/// Radius of the wipe's handle.
const WIPE_RADIUS: f32 = 11.0;

/// How far down the picture the wipe's handle is.
const WIPE_HEIGHT: f32 = 0.6;

/// Width of the wipe's line.
const WIPE_WIDTH: f32 = 1.5;

/// What is seen in this frame of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Seen {
    /// One mode.
    One(ViewMode),
    /// Two modes, and where between them the handle is.
    Wiped(ViewMode, ViewMode, f32),
}

impl Seen {
    /// The mode whose legend is shown: in a wipe, that of the left part.
    pub(super) const fn mode(self) -> ViewMode {
        match self {
            Self::One(mode) | Self::Wiped(mode, ..) => mode,
        }
    }
}

/// Lets the pointer move the wipe's handle, or waits for the next blink.
pub(super) fn seen(
    ui: &Ui,
    id: Id,
    rect: Rect,
    input: &CameraTileInput<'_>,
    events: &mut Vec<TileEvent>,
) -> Seen {
    let shown = |mode| input.picture.shown(mode);
    let look = &input.look;
    match look.comparison {
        None => Seen::One(shown(look.mode)),
        Some(Comparison::Wipe) => {
            Seen::Wiped(shown(look.mode), shown(look.other), drag_handle(ui, id, rect, input, events))
        }
        Some(Comparison::Blink) => {
            let seconds = input.settings.blink_seconds();
            let (is_other, wait) = blink(ui.input(|input| input.time), seconds);
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(wait));
            Seen::One(shown(if is_other { look.other } else { look.mode }))
        }
    }
}

/// Whether the second mode is seen at this time, and how long it stays so. All views blink together.
fn blink(time: f64, seconds: f64) -> (bool, f64) {
    let changes = (time / seconds).floor();
    (changes.rem_euclid(2.0) >= 1.0, ((changes + 1.0) * seconds - time).max(0.001))
}

fn drag_handle(ui: &Ui, id: Id, rect: Rect, input: &CameraTileInput<'_>, events: &mut Vec<TileEvent>) -> f32 {
    let at = input.look.wipe_at;
    let at = if at.is_finite() { at.clamp(0.0, 1.0) } else { 0.5 };
    let handle = Rect::from_center_size(wipe_handle(rect, at), vec2(size::BUTTON, size::BUTTON));
    let response = ui.interact(handle, id.with("wipe"), Sense::drag());
    let label = format!("Wipe to {}", input.look.other.label().to_lowercase());
    response.widget_info(|| WidgetInfo::slider(true, f64::from(at), label.as_str()));
    let at = match response.interact_pointer_pos().filter(|_| response.dragged()) {
        Some(pointer) => {
            let moved = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
            events.push(TileEvent::SetWipe(moved));
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
pub(super) fn paint_wipe(painter: &Painter, rect: Rect, at: f32) {
    let handle = wipe_handle(rect, at);
    painter.vline(handle.x, rect.y_range(), Stroke::new(WIPE_WIDTH + 2.0 * size::CASING, CASING));
    painter.vline(handle.x, rect.y_range(), Stroke::new(WIPE_WIDTH, JOINT));
    painter.circle(handle, WIPE_RADIUS, CASING, Stroke::new(WIPE_WIDTH, JOINT));
    for side in [-1.0, 1.0] {
        let tip = handle + vec2(side * 6.0, 0.0);
        let back = vec2(-side * 3.0, 3.5);
        let arrow = vec![tip + back, tip, tip + vec2(back.x, -back.y)];
        painter.line(arrow, Stroke::new(size::ICON_STROKE, JOINT));
    }
}

/// What a mode is named where two are compared, for the header: "tinted overlay on footage | footage".
pub(super) fn mode_text(input: &CameraTileInput<'_>, is_short: bool) -> String {
    let look = &input.look;
    let axis = input.settings.axis;
    let mode = |mode: ViewMode| match (mode, is_short) {
        (ViewMode::JacobianColumn, true) => format!("J, {}", axis.short_label()),
        (ViewMode::JacobianColumn, false) => format!("{}, {}", mode.label(), axis.label().to_lowercase()),
        (_, true) => mode.short_label().to_owned(),
        (_, false) => mode.label().to_owned(),
    };
    match look.comparison {
        Some(Comparison::Wipe) => format!("{} | {}", mode(look.mode), mode(look.other).to_lowercase()),
        Some(Comparison::Blink) => format!("{} / {}", mode(look.mode), mode(look.other).to_lowercase()),
        None => mode(look.mode),
    }
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
