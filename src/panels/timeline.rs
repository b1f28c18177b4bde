//! The timeline: transport, and the frames with lanes of cost, overlap and steps.

use egui::{
    Align, Align2, Frame, Layout as Direction, Margin, Panel, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui,
    WidgetInfo, pos2, vec2,
};

use super::command::{icon, named_button};
use crate::action::Action;
use crate::document::Document;
use crate::format;
use crate::look::Layout;
use crate::showing::{Intents, Request, Showing};
use crate::theme::{self, size, tick};
use crate::widgets::{Icon, number_field};

/// Width of the names and numbers left of the lanes.
const NAMES: f32 = 92.0;
/// Room of the ruler.
const RULER: f32 = 18.0;
/// Below this height of the window there is one lane.
const ONE_LANE_BELOW: f32 = 800.0;

/// The timeline.
pub(crate) fn ui(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, window_height: f32) {
    let lanes: &[Lane] = if !showing.look.lanes {
        &[]
    } else if window_height < ONE_LANE_BELOW || showing.look.layout == Layout::Debug {
        &[Lane::Overlap]
    } else {
        &[Lane::Cost, Lane::Overlap, Lane::Steps]
    };
    let height = match lanes.len() {
        0 => size::TIMELINE_SHUT,
        1 => size::TIMELINE_ONE_LANE + 6.0,
        _ => size::TIMELINE,
    };
    let frame = Frame::NONE.fill(theme::palette(ui).panel).inner_margin(Margin::symmetric(8, 4));
    Panel::bottom("timeline").exact_size(height).resizable(false).frame(frame).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        transport(ui, showing, intents);
        if !lanes.is_empty() {
            track(ui, showing, intents, lanes);
        }
    });
}

#[derive(Clone, Copy, PartialEq)]
enum Lane {
    Cost,
    Overlap,
    Steps,
}

impl Lane {
    const fn name(self) -> &'static str {
        match self {
            Self::Cost => "Cost",
            Self::Overlap => "IoU",
            Self::Steps => "Steps",
        }
    }

    fn value(self, document: &Document, frame: usize) -> Option<f64> {
        let estimate = document.estimates.get(&frame)?;
        match self {
            Self::Cost => Some(estimate.cost),
            Self::Overlap => estimate.iou,
            Self::Steps => Some(estimate.steps as f64),
        }
    }

    fn text(self, value: Option<f64>) -> String {
        let Some(value) = value else { return format::MISSING.to_owned() };
        match self {
            Self::Cost => format::cost(value),
            Self::Overlap => format::ratio(value),
            Self::Steps => format::number(value, 0),
        }
    }
}

fn transport(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents) {
    ui.allocate_ui_with_layout(
        vec2(ui.available_width(), 28.0),
        Direction::left_to_right(Align::Center),
        |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            icon(ui, showing, intents, Action::PreviousFrame, Icon::First);
            let play = if showing.is_playing { Icon::Pause } else { Icon::Play };
            icon(ui, showing, intents, Action::Play, play);
            icon(ui, showing, intents, Action::NextFrame, Icon::Last);
            frame_field(ui, showing, intents);
            ui.add_space(8.0);
            for (action, text) in [
                (Action::TrackBack, "Track back"),
                (Action::SetKeyPose, "Key pose"),
                (Action::PreviousWorst, "Previous worst"),
                (Action::NextWorst, "Next worst"),
            ] {
                named_button(ui, showing, intents, action, text);
            }
            ui.with_layout(Direction::right_to_left(Align::Center), |ui| {
                let text = RichText::new(summary(showing)).small().color(theme::palette(ui).text3);
                ui.add(egui::Label::new(text).truncate());
            });
        },
    );
}

fn frame_field(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents) {
    let last = showing.session.frame_count().saturating_sub(1);
    let mut frame = showing.selection.frame as f64;
    let unit = format!(" / {last}");
    if number_field(ui, "Frame", &mut frame, 0, &unit, 0.1, 76.0).changed() {
        intents.request(Request::Frame(frame.round().max(0.0) as usize));
    }
    let rate = showing.session.take.as_ref().map_or(1.0, |take| take.frame_rate);
    let seconds = showing.selection.frame as f64 / rate.max(f64::MIN_POSITIVE);
    let text = RichText::new(format!("{} s", format::number(seconds, 3))).monospace();
    let (rect, _) = ui.allocate_exact_size(vec2(64.0, size::ROW), Sense::hover());
    ui.put(rect, egui::Label::new(text.color(theme::palette(ui).text2)));
}

fn summary(showing: &Showing<'_>) -> String {
    let document = showing.document();
    let found = &document.estimates;
    let (Some((first, _)), Some((last, _))) = (found.first_key_value(), found.last_key_value()) else {
        return "No frame is fitted yet".to_owned();
    };
    let overlaps: Vec<f64> = found.values().filter_map(|estimate| estimate.iou).collect();
    let mean = (!overlaps.is_empty()).then(|| overlaps.iter().sum::<f64>() / overlaps.len() as f64);
    let mean = mean.map_or_else(String::new, |mean| format!(", mean IoU {}", format::ratio(mean)));
    let lost = found.values().filter(|estimate| estimate.lost).count();
    let lost = if lost > 0 { format!(", {lost} lost") } else { String::new() };
    let keys = document.keys.len();
    let keys = match keys {
        0 => String::new(),
        1 => ", 1 key pose".to_owned(),
        _ => format!(", {keys} key poses"),
    };
    let count = found.len();
    if count == 1 {
        format!("Frame {first} fitted{mean}{lost}{keys}")
    } else {
        format!("{count} frames fitted, {first} to {last}{mean}{lost}{keys}")
    }
}

fn track(ui: &mut Ui, showing: &Showing<'_>, intents: &mut Intents, lanes: &[Lane]) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let frames = showing.session.frame_count();
    response.widget_info(|| WidgetInfo::slider(true, showing.selection.frame as f64, "Timeline"));
    let mut plot = rect;
    plot.set_left(rect.left() + NAMES);
    plot.set_right(rect.right() - 12.0);
    let last = frames.saturating_sub(1).max(1) as f32;
    let x = |frame: usize| plot.left() + plot.width() * frame as f32 / last;
    if frames > 0
        && let Some(pointer) = response.interact_pointer_pos()
    {
        let share = ((pointer.x - plot.left()) / plot.width()).clamp(0.0, 1.0);
        let frame = (share * last).round() as usize;
        if frame != showing.selection.frame {
            intents.request(Request::Frame(frame.min(frames - 1)));
        }
    }
    ruler(ui, plot, frames, &x);
    let lane_height = (rect.height() - RULER) / lanes.len() as f32;
    for (index, lane) in lanes.iter().enumerate() {
        let top = rect.top() + RULER + lane_height * index as f32;
        let area =
            Rect::from_min_max(pos2(plot.left(), top + 1.0), pos2(plot.right(), top + lane_height - 1.0));
        lane_names(ui, showing, *lane, rect.left(), area);
        draw_lane(ui, showing.document(), *lane, area, frames, &x);
    }
    marks(ui, showing, plot, &x);
}

fn ruler(ui: &Ui, plot: Rect, frames: usize, x: &impl Fn(usize) -> f32) {
    if frames == 0 {
        return;
    }
    let palette = theme::palette(ui);
    let step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 5000]
        .into_iter()
        .find(|step| plot.width() * *step as f32 / frames as f32 >= 60.0)
        .unwrap_or(10_000);
    let font = tick().resolve(ui.style());
    for frame in (0..frames).step_by(step) {
        let at = x(frame);
        ui.painter().vline(at, plot.top() + RULER - 4.0..=plot.bottom(), Stroke::new(1.0, palette.grid));
        ui.painter().text(
            pos2(at, plot.top() + RULER - 5.0),
            Align2::CENTER_BOTTOM,
            format::count(frame as i64),
            font.clone(),
            palette.text2,
        );
    }
    let y = plot.top() + RULER - 3.0;
    ui.painter().hline(plot.x_range(), y, Stroke::new(1.5, palette.line));
}

fn lane_names(ui: &Ui, showing: &Showing<'_>, lane: Lane, left: f32, area: Rect) {
    let palette = theme::palette(ui);
    let small = egui::TextStyle::Small.resolve(ui.style());
    let mono = egui::TextStyle::Monospace.resolve(ui.style());
    let y = area.center().y;
    ui.painter().text(pos2(left + 4.0, y), Align2::LEFT_CENTER, lane.name(), small, palette.text2);
    let value = lane.text(lane.value(showing.document(), showing.selection.frame));
    ui.painter().text(pos2(left + NAMES - 10.0, y), Align2::RIGHT_CENTER, value, mono, palette.text);
}

fn draw_lane(ui: &Ui, document: &Document, lane: Lane, area: Rect, frames: usize, x: &impl Fn(usize) -> f32) {
    let palette = theme::palette(ui);
    ui.painter().rect_filled(area, 0.0, palette.plot);
    let values: Vec<(usize, f64)> =
        (0..frames).filter_map(|frame| Some((frame, lane.value(document, frame)?))).collect();
    let most = match lane {
        Lane::Overlap => 1.0,
        _ => values.iter().map(|(_, value)| *value).fold(f64::MIN_POSITIVE, f64::max),
    };
    let y = |value: f64| area.bottom() - 1.0 - (area.height() - 3.0) * (value / most).clamp(0.0, 1.0) as f32;
    if lane == Lane::Steps {
        for (frame, value) in values {
            let bar = Rect::from_min_max(pos2(x(frame) - 1.5, y(value)), pos2(x(frame) + 1.5, area.bottom()));
            ui.painter().rect_filled(bar, 0.0, palette.text3);
        }
        return;
    }
    // Gaps between fitted frames stay gaps.
    let mut points: Vec<Pos2> = Vec::new();
    let mut last: Option<usize> = None;
    for (frame, value) in values {
        if last.is_some_and(|last| last + 1 != frame) {
            curve(ui, &points);
            points.clear();
        }
        points.push(pos2(x(frame), y(value)));
        last = Some(frame);
    }
    curve(ui, &points);
}

fn curve(ui: &Ui, points: &[Pos2]) {
    let palette = theme::palette(ui);
    match points {
        [] => {}
        [point] => {
            ui.painter().circle_filled(*point, 2.0, palette.text2);
        }
        _ => {
            ui.painter().add(Shape::line(points.to_vec(), Stroke::new(1.5, palette.text2)));
        }
    }
}

fn marks(ui: &Ui, showing: &Showing<'_>, plot: Rect, x: &impl Fn(usize) -> f32) {
    let palette = theme::palette(ui);
    let y = plot.top() + RULER - 3.0;
    let document = showing.document();
    for (frame, _) in document.estimates.iter().filter(|(_, estimate)| estimate.lost) {
        let at = pos2(x(*frame), plot.bottom() - 6.0);
        let corners = vec![at + vec2(-4.0, -4.0), at + vec2(4.0, -4.0), at + vec2(0.0, 3.0)];
        ui.painter().add(Shape::convex_polygon(corners, palette.warn, Stroke::NONE));
    }
    for frame in document.keys.keys() {
        let at = pos2(x(*frame), y);
        let corners =
            [vec2(0.0, -4.5), vec2(4.5, 0.0), vec2(0.0, 4.5), vec2(-4.5, 0.0)].map(|d| at + d).to_vec();
        ui.painter().add(Shape::convex_polygon(corners, palette.text, Stroke::new(1.0, palette.panel)));
    }
    if showing.session.frame_count() > 0 {
        let at = x(showing.selection.frame);
        ui.painter().vline(at, plot.top() + 8.0..=plot.bottom(), Stroke::new(1.5, palette.accent_text));
        let head = Rect::from_center_size(pos2(at, plot.top() + 6.0), vec2(11.0, 11.0));
        ui.painter().rect(head, 2.0, palette.accent, palette.accent_edge, egui::StrokeKind::Inside);
    }
}
