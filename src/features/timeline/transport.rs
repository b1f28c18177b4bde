//! The row above the lanes: going, playing, tracking, key poses, worst frames.

use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{Icon, checkbox, choice, fitting_label, number_field};
use egui::{Align, Layout as Direction, RichText, Sense, TextStyle, Ui, vec2};

use crate::context::command::{Command, TimelineCommand, TrackingCommand};
use crate::context::command_button::{icon, named_button, sized_button};
use crate::context::{Context, Requests, SessionRequest};
use crate::session::playback::{PlaybackChange, SPEEDS};

/// Height of the row.
pub(crate) const HEIGHT: f32 = 28.0;
/// Below this width the time is left out and words are shorter.
const FOLD: f32 = 900.0;
/// Below this one the menu alone leads from poor frame to poor frame.
const TIGHT: f32 = 740.0;
/// Width of the frame's number.
const FRAME: f32 = 84.0;
/// Width of the time.
const TIME: f32 = 64.0;
/// Width of the speed.
const SPEED: f32 = 58.0;
/// Width of the button that sets and clears a key pose.
const KEY: f32 = 72.0;

pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let row = vec2(ui.available_width(), HEIGHT);
    ui.allocate_ui_with_layout(row, Direction::left_to_right(Align::Center), |ui| {
        let (folded, tight) = (row.x < FOLD, row.x < TIGHT);
        ui.spacing_mut().item_spacing.x = space::ROW;
        going(ui, context, requests, folded);
        playing(ui, context, requests);
        ui.add_space(space::WIDGET);
        named_button(ui, context, requests, Command::Tracking(TrackingCommand::Back), "Track back");
        let between = if folded { "Between" } else { "Between keys" };
        named_button(ui, context, requests, Command::Tracking(TrackingCommand::Between), between);
        ui.add_space(space::WIDGET);
        icon(ui, context, requests, Command::Timeline(TimelineCommand::PreviousKey), Icon::PreviousKey);
        // The text says which it does, in a place that does not change.
        let is_key = context.document().keys.contains_key(&context.selection.frame);
        let text = if is_key { "Clear key" } else { "Set key" };
        sized_button(ui, context, requests, Command::Timeline(TimelineCommand::SetKeyPose), text, KEY);
        icon(ui, context, requests, Command::Timeline(TimelineCommand::NextKey), Icon::NextKey);
        ui.add_space(space::WIDGET);
        if !tight {
            icon(ui, context, requests, Command::Timeline(TimelineCommand::PreviousPoor), Icon::Previous);
        }
        named_button(ui, context, requests, Command::Timeline(TimelineCommand::WorstFrame), "Worst");
        if !tight {
            icon(ui, context, requests, Command::Timeline(TimelineCommand::NextPoor), Icon::Next);
        }
        ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
            let [full, short] = summaries(context);
            let colour = theme::palette(ui).text3;
            fitting_label(ui, &[&full, &short], TextStyle::Small, colour);
        });
    });
}

fn going(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, folded: bool) {
    icon(ui, context, requests, Command::Timeline(TimelineCommand::PreviousFrame), Icon::First);
    let play = if context.playback.is_playing() { Icon::Pause } else { Icon::Play };
    icon(ui, context, requests, Command::Timeline(TimelineCommand::Play), play);
    icon(ui, context, requests, Command::Timeline(TimelineCommand::NextFrame), Icon::Last);
    let last = context.session.frame_count().saturating_sub(1);
    let mut frame = context.selection.frame as f64;
    let unit = format!(" / {last}");
    let field = number_field(ui, "Frame", &mut frame, 0, &unit, 0.1, FRAME);
    if field.on_hover_text("The frame on the screen, counted from 0").changed() {
        requests.request(SessionRequest::Frame(frame.round().max(0.0) as usize));
    }
    if !folded {
        let text = RichText::new(format!("{} s", seconds(context, context.selection.frame))).monospace();
        let (rect, _) = ui.allocate_exact_size(vec2(TIME, size::ROW), Sense::hover());
        ui.put(rect, egui::Label::new(text.color(theme::palette(ui).text2)));
    }
}

/// When a frame was taken, in seconds since the first.
pub(crate) fn seconds(context: &Context<'_>, frame: usize) -> String {
    let rate = context.session.take.as_ref().map_or(1.0, |take| take.take().frame_rate());
    format::number(frame as f64 / rate.max(f64::MIN_POSITIVE), 3)
}

fn playing(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests) {
    let playback = context.playback;
    let texts = SPEEDS.map(speed_text);
    let tooltip = |speed: f64| {
        if speed < 1.0 { "Slower than it was filmed" } else { "Frames that come too late are left out" }
    };
    let choices: Vec<(f64, &str, String)> = SPEEDS
        .iter()
        .zip(&texts)
        .map(|(speed, text)| (*speed, text.as_str(), tooltip(*speed).to_owned()))
        .collect();
    if let Some(speed) = choice(ui, "Speed", SPEED, &speed_text(playback.speed), &choices) {
        requests.request(SessionRequest::Playback(PlaybackChange::Speed(speed)));
    }
    let mut loops = playback.loops;
    let command = Command::Timeline(TimelineCommand::ToggleLoop);
    if checkbox(ui, &mut loops, "Loop").on_hover_text(command.tooltip()).changed() {
        requests.run(command);
    }
}

fn speed_text(speed: f64) -> String {
    let decimals = if speed.fract() == 0.0 {
        0
    } else if (10.0 * speed).fract() == 0.0 {
        1
    } else {
        2
    };
    format!("{}×", format::number(speed, decimals))
}

/// What is known of the take, in a line and in two words.
fn summaries(context: &Context<'_>) -> [String; 2] {
    let document = context.document();
    let found = &document.estimates;
    let (Some((first, _)), Some((last, _))) = (found.first_key_value(), found.last_key_value()) else {
        return ["No frame is fitted yet".to_owned(), String::new()];
    };
    let overlaps: Vec<f64> = found.values().filter_map(|estimate| estimate.iou).collect();
    let mean = (!overlaps.is_empty()).then(|| overlaps.iter().sum::<f64>() / overlaps.len() as f64);
    let lost = match found.values().filter(|estimate| estimate.lost).count() {
        0 => String::new(),
        lost => format!(", {lost} lost"),
    };
    let short = mean.map_or_else(String::new, |mean| format!("IoU {}{lost}", format::ratio(mean)));
    let mean = mean.map_or_else(String::new, |mean| format!(", mean IoU {}", format::ratio(mean)));
    let keys = match document.keys.len() {
        0 => String::new(),
        keys => format!(", {}", format::counted(keys, "key pose")),
    };
    let frames = match found.len() {
        1 => format!("Frame {first} fitted"),
        count => format!("{count} frames fitted, {first} to {last}"),
    };
    [format!("{frames}{mean}{lost}{keys}"), short]
}
