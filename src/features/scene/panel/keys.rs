//! Keys of the scene, while the pointer is over it or it has the focus: then they are not the commands' that they are
//! elsewhere.

use backlit_ui::style::theme;
use backlit_ui::style::theme::size;
use egui::{Context, Event, EventFilter, Id, Key, Rect, Response, Stroke, StrokeKind, Ui};

use crate::context::pane::Pane;

/// A key turns the scene as a drag over so many points would.
const TURN: f64 = 16.0;
/// A key magnifies by this factor.
const ZOOM: f64 = 1.15;

/// Keys as they are listed, and what they do.
pub(crate) const KEYS: [(&str, &str); 3] = [
    ("Left, Right, Up, Down", "Turn the scene"),
    ("+, -", "Zoom the scene"),
    ("Home, F", "See the whole scene"),
];

/// What the keys of a frame ask for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pressed {
    /// As a drag of so many points.
    pub(crate) turn: [f64; 2],
    /// Magnification.
    pub(crate) zoom: f64,
    /// Back to the whole scene.
    pub(crate) resets: bool,
}

pub(crate) fn canvas_id(scope: Id) -> Id {
    scope.with("scene canvas")
}

/// Takes the scene's keys out of the input, to be [given back](give_back) when the commands have had theirs.
pub(crate) fn hold_back(ctx: &Context) -> Vec<Event> {
    let canvas = ctx.read_response(canvas_id(Pane::Scene.scope()));
    let is_meant = canvas.is_some_and(|canvas| canvas.contains_pointer() || canvas.has_focus());
    if !is_meant || ctx.text_edit_focused() {
        return Vec::new();
    }
    ctx.input_mut(|input| input.events.extract_if(.., |event| pressed_key(event).is_some()).collect())
}

/// Puts the scene's keys back into the input.
pub(crate) fn give_back(ctx: &Context, events: Vec<Event>) {
    ctx.input_mut(|input| input.events.extend(events));
}

/// Uses up the keys that are the scene's.
pub(crate) fn take(ui: &Ui, response: &Response) -> Pressed {
    let mut pressed = Pressed { turn: [0.0; 2], zoom: 1.0, resets: false };
    if response.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    }
    if !(response.contains_pointer() || response.has_focus()) || ui.ctx().text_edit_focused() {
        return pressed;
    }
    let keys: Vec<Key> = ui.input_mut(|input| {
        let taken = input.events.extract_if(.., |event| pressed_key(event).is_some());
        taken.filter_map(|event| pressed_key(&event)).collect()
    });
    for key in keys {
        match key {
            Key::ArrowLeft => pressed.turn[0] -= TURN,
            Key::ArrowRight => pressed.turn[0] += TURN,
            Key::ArrowUp => pressed.turn[1] -= TURN,
            Key::ArrowDown => pressed.turn[1] += TURN,
            Key::Minus => pressed.zoom /= ZOOM,
            Key::Plus | Key::Equals => pressed.zoom *= ZOOM,
            _ => pressed.resets = true,
        }
    }
    pressed
}

/// A ring about the picture, if the keys are its because it has the focus.
pub(crate) fn show_focus(ui: &Ui, picture: Rect) {
    if ui.memory(|memory| memory.has_focus(canvas_id(ui.scope_id()))) {
        let ring = Stroke::new(size::FOCUS_RING, theme::palette(ui).accent);
        ui.painter().rect_stroke(picture, 0.0, ring, StrokeKind::Inside);
    }
}

/// The key, if it is one of the scene's and was pressed.
fn pressed_key(event: &Event) -> Option<Key> {
    let Event::Key { key, pressed: true, modifiers, .. } = event else { return None };
    let is_plus = matches!(key, Key::Plus | Key::Equals);
    let is_plain = modifiers.is_none() || (is_plus && modifiers.shift_only());
    let is_ours = matches!(
        key,
        Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown | Key::Minus | Key::Home | Key::F
    );
    (is_plain && (is_ours || is_plus)).then_some(*key)
}
