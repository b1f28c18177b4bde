//! Commands as buttons and menu rows: what cannot be used is grey, and its tooltip says why.

use backlit_document::fit_words::preset_like;
use backlit_document::history::Gesture;
use backlit_tracking::fit::Preset;
use backlit_ui::style::theme::size;
use backlit_ui::widgets::{Icon, choice, icon_button, primary_button};
use egui::{AsIdSalt, Button, Id, Response, Ui, vec2};

use crate::context::command::{Command, FitCommand};
use crate::context::{Context, Requests, unavailable};

/// Adds a widget for a command, grey where it cannot be used, and asks for the command on a click.
fn widget(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    command: Command,
    add: impl FnOnce(&mut Ui, &str) -> Response,
) -> Response {
    let why_not = unavailable(command, context);
    let tooltip = why_not.map_or_else(|| command.tooltip(), |why| format!("{}\n{why}.", command.tooltip()));
    let response = ui.add_enabled_ui(why_not.is_none(), |ui| add(ui, &tooltip)).inner;
    if response.clicked() {
        requests.run(command);
    }
    response
}

/// A square button.
pub(crate) fn icon(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    command: Command,
    icon: Icon,
) {
    widget(ui, context, requests, command, |ui, tooltip| icon_button(ui, icon, command.text(), tooltip));
}

/// A button with the command's text.
pub(crate) fn button(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, command: Command) {
    named_button(ui, context, requests, command, command.text());
}

/// A button with a shorter text.
pub(crate) fn named_button(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    command: Command,
    text: &str,
) {
    sized_button(ui, context, requests, command, text, 0.0);
}

/// A button with a text of its own that is at least so wide.
pub(crate) fn sized_button(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    command: Command,
    text: &str,
    width: f32,
) {
    widget(ui, context, requests, command, |ui, tooltip| {
        let button = ui.add(Button::new(text).min_size(vec2(width, size::BUTTON)));
        button.on_hover_text(tooltip).on_disabled_hover_text(tooltip)
    });
}

/// The one button in the accent.
pub(crate) fn primary(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, command: Command) {
    widget(ui, context, requests, command, |ui, tooltip| {
        primary_button(ui, command.text()).on_hover_text(tooltip).on_disabled_hover_text(tooltip)
    });
}

/// A row of a menu, with its keys.
pub(crate) fn menu_row(
    ui: &mut Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    command: Command,
    text: &str,
) {
    let response = widget(ui, context, requests, command, |ui, tooltip| {
        let button = Button::new(text).shortcut_text(command.keys_text().unwrap_or_default());
        ui.add(button).on_hover_text(tooltip).on_disabled_hover_text(tooltip)
    });
    if response.clicked() {
        ui.close();
    }
}

/// The gesture of a widget that the pointer holds, from the press on: every press has one of its own. `None` when it
/// changes otherwise.
pub(crate) fn gesture(ui: &Ui, key: impl AsIdSalt, response: &Response) -> Option<Gesture> {
    let id = ui.scope_id().with(key);
    let is_down = response.is_pointer_button_down_on();
    if is_down && ui.input(|input| input.pointer.any_pressed()) {
        let gesture = next_gesture(ui.ctx());
        ui.data_mut(|data| data.insert_temp(id, gesture));
    }
    let is_held = is_down || response.dragged();
    let gesture: Option<Gesture> = (is_held || response.drag_stopped() || response.clicked())
        .then(|| ui.data(|data| data.get_temp(id)))
        .flatten();
    if let Some(gesture) = gesture.filter(|_| is_held) {
        let pass = ui.ctx().cumulative_pass_nr();
        ui.data_mut(|data| data.insert_temp(Id::unique(DRAGGED), (gesture, pass)));
    }
    gesture
}

/// Name of the gesture of the widget that was dragged last.
const DRAGGED: &str = "dragged gesture";

/// The gesture of a widget that was dragged until this frame of the window: Esc has ended it.
pub(crate) fn dragged_until_now(ctx: &egui::Context) -> Option<Gesture> {
    let (gesture, pass): (Gesture, u64) = ctx.data(|data| data.get_temp(Id::unique(DRAGGED)))?;
    (ctx.cumulative_pass_nr() <= pass + 2).then_some(gesture)
}

/// A gesture that was not used before.
pub(crate) fn next_gesture(ctx: &egui::Context) -> Gesture {
    let id = Id::unique("newest gesture");
    ctx.data_mut(|data| {
        let newest: &mut u64 = data.get_temp_mut_or_default(id);
        *newest += 1;
        Gesture(*newest)
    })
}

/// A box of the presets.
pub(crate) fn preset_box(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, width: f32) {
    let chosen = preset_like(&context.document().fit).map_or("Custom", Preset::label);
    let choices = [Preset::Robust, Preset::Report].map(|preset| {
        let command = Command::Fit(FitCommand::Preset(preset));
        (command, command.text(), command.tooltip())
    });
    if let Some(command) = choice(ui, "Preset", width, chosen, &choices) {
        requests.run(command);
    }
}
