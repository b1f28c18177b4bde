//! The timeline: transport, and the frames with lanes of cost, overlap and steps.
//!
//! | file | holds |
//! |---|---|
//! | `transport` | the row of buttons |
//! | `span` | which frames are on the screen, and where |
//! | `lanes` | the curves |
//! | `marks` | ruler, lost and worst frames, the frame on the screen |
//! | `key_poses` | the diamonds |
//! | `read_out` | the frame under the pointer |

mod key_poses;
mod lanes;
mod marks;
pub(crate) mod playing;
mod read_out;
mod span;
mod transport;

use egui::{
    Frame, Id, Margin, Panel, PointerButton, Pos2, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2,
};

use crate::context::command::{Command, TimelineCommand, TrackingCommand};
use crate::context::command_button::menu_row;
use crate::context::preferences::Layout;
use crate::context::{Context, Request, Requests};
use crate::session::playback::FrameRange;
use crate::style::theme;
use crate::style::theme::size;
use lanes::Lane;
use marks::RULER;
use span::Scale;
pub use span::Span;

/// Width of the names and numbers left of the lanes.
const NAMES: f32 = 122.0;
/// Room of the axes' ends right of the lanes.
const AXES: f32 = 46.0;
/// Below this height of the window there is one lane.
const ONE_LANE_BELOW: f32 = 800.0;
/// How much a point of the wheel zooms.
const ZOOM_PER_POINT: f32 = 0.004;

/// What was done in the timeline, besides going to a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimelineEvent {
    /// Show these frames; all where `None`.
    Show(Option<Span>),
    /// Mark these frames, or none.
    Mark(Option<FrameRange>),
    /// Stop playing.
    Pause,
    /// Play at this multiple of the take's speed.
    Speed(f64),
}

/// The timeline.
pub(crate) fn ui(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, window_height: f32) {
    let lanes: &[Lane] = if !context.preferences.lanes {
        &[]
    } else if window_height < ONE_LANE_BELOW || context.preferences.layout == Layout::Debug {
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
        transport::ui(ui, context, requests);
        if !lanes.is_empty() {
            frames(ui, context, requests, lanes);
        }
    });
}

/// Everything below the transport.
fn frames(ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, lanes: &[Lane]) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let count = context.session.frame_count();
    let shown = context.selection.frame as f64;
    response.widget_info(|| WidgetInfo::slider(true, shown, "Timeline"));
    let names = rect.with_max_x(rect.left() + NAMES);
    let plot = Rect::from_x_y_ranges(names.right()..=rect.right() - AXES, rect.y_range());
    if count == 0 || plot.width() < 1.0 {
        return;
    }
    let span = shown_span(ui, context, requests, count);
    let (frames, last) = (span.frames(count), count - 1);
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(last as f64);
        node.set_description(format!("Frames {} to {} of 0 to {last}", frames.start(), frames.end()));
    });
    let scale = Scale::new(span, plot);
    let area = Area { plot, scale, count };
    area.act(ui, context, requests, &response);
    if let Some(range) = area.marking(ui, &response).or(context.time.playback.range) {
        marks::marked(ui, plot, &scale, range);
    }
    marks::ruler(ui, plot, &scale, count);
    let lane_height = (rect.height() - RULER) / lanes.len() as f32;
    let document = context.document();
    for (index, lane) in lanes.iter().enumerate() {
        let top = rect.top() + RULER + lane_height * index as f32;
        let lane_area = Rect::from_x_y_ranges(plot.x_range(), top + 1.0..=top + lane_height - 1.0);
        lanes::draw(ui, document, *lane, lane_area, &scale, count);
        lanes::labels(ui, document, *lane, context.selection.frame, names, lane_area);
        if *lane == Lane::Overlap {
            marks::troubles(ui, document, lane_area, &scale, count);
        }
        let name = Rect::from_x_y_ranges(names.x_range(), lane_area.y_range());
        let name = ui.interact(name, response.id.with(index), Sense::hover());
        let said = || lane.said(document, context.selection.frame);
        name.widget_info(|| WidgetInfo::labeled(Role::Label, true, said()));
        name.on_hover_text(lane.explanation(document));
    }
    if document.estimates.is_empty() && context.session.tracking.is_none() {
        let below = plot.with_min_y(plot.top() + RULER);
        marks::first_steps(ui, below, document.keys.is_empty());
    }
    marks::on_ruler(ui, context, plot, &scale, count);
    marks::playhead(ui, context, plot, &scale);
    let key = key_poses::ui(ui, context, requests, plot, &scale, count);
    let under = response.hover_pos().filter(|pointer| plot.expand(4.0).contains(*pointer));
    if let Some(frame) = key.or_else(|| Some(scale.frame_at(under?.x, count))) {
        read_out::ui(ui, context, frame, pos2(scale.x(frame as f64), plot.top()));
    }
    if response.secondary_clicked()
        && let Some(pointer) = response.interact_pointer_pos()
    {
        // What the menu offers is about the frame on the screen.
        requests.request(Request::Frame(area.frame_at(pointer)));
    }
    response.context_menu(|ui| {
        for command in [
            Command::Timeline(TimelineCommand::SetKeyPose),
            Command::Tracking(TrackingCommand::Forward),
            Command::Tracking(TrackingCommand::Back),
            Command::Tracking(TrackingCommand::Between),
            Command::Timeline(TimelineCommand::ClearRange),
            Command::Tracking(TrackingCommand::Clear),
            Command::Timeline(TimelineCommand::WholeTake),
        ] {
            menu_row(ui, context, requests, command, command.text());
        }
    });
}

/// The frames on the screen. A zoomed timeline follows the frame when that goes elsewhere.
fn shown_span(ui: &Ui, context: &Context<'_>, requests: &mut Requests, count: usize) -> Span {
    let frame = context.selection.frame;
    let id = Id::unique("timeline's frame");
    let before: Option<usize> = ui.data_mut(|data| {
        let before = data.get_temp(id);
        data.insert_temp(id, frame);
        before
    });
    let Some(span) = context.time.span else { return Span::whole(count) };
    if before == Some(frame) {
        return span;
    }
    let follows = span.containing(frame, count);
    if follows != span {
        requests.request(Request::Timeline(TimelineEvent::Show(Some(follows))));
    }
    follows
}

/// The part of the timeline that the frames fill.
struct Area {
    plot: Rect,
    scale: Scale,
    count: usize,
}

impl Area {
    fn frame_at(&self, pointer: Pos2) -> usize {
        self.scale.frame_at(pointer.x, self.count)
    }

    /// Where a drag with Shift has begun.
    fn mark_id(response: &Response) -> Id {
        response.id.with("mark from")
    }

    /// The frames that are being marked.
    fn marking(&self, ui: &Ui, response: &Response) -> Option<FrameRange> {
        let from: usize = ui.data(|data| data.get_temp(Self::mark_id(response)))?;
        Some(FrameRange::between(from, self.frame_at(response.interact_pointer_pos()?)))
    }

    /// Clicks, drags and the wheel.
    fn act(&self, ui: &Ui, context: &Context<'_>, requests: &mut Requests, response: &Response) {
        let ask = |requests: &mut Requests, event| requests.request(Request::Timeline(event));
        let (shift, middle) = ui.input(|input| (input.modifiers.shift, input.pointer.middle_down()));
        let id = Self::mark_id(response);
        let is_marking = ui.data(|data| data.get_temp::<usize>(id)).is_some();
        if response.double_clicked() {
            ask(requests, TimelineEvent::Show(None));
        } else if shift && response.clicked() {
            ask(requests, TimelineEvent::Mark(None));
        } else if response.drag_started_by(PointerButton::Primary) && shift {
            let from = ui.input(|input| input.pointer.press_origin());
            if let Some(from) = from {
                ui.data_mut(|data| data.insert_temp(id, self.frame_at(from)));
            }
        } else if is_marking {
            if response.drag_stopped() {
                if let Some(range) = self.marking(ui, response) {
                    ask(requests, TimelineEvent::Mark(Some(range)));
                }
                ui.data_mut(|data| data.remove_temp::<usize>(id));
            }
        } else if response.dragged_by(PointerButton::Middle) {
            let by = -response.drag_delta().x / self.scale.step();
            let moved = self.scale.span.moved(f64::from(by), self.count);
            ask(requests, TimelineEvent::Show(Some(moved).filter(|_| context.time.span.is_some())));
        } else if let Some(pointer) = response.interact_pointer_pos().filter(|_| !shift && !middle)
            && !response.secondary_clicked()
            && ui.input(|input| !input.pointer.secondary_down())
        {
            if response.drag_started() && context.time.playback.is_playing() {
                ask(requests, TimelineEvent::Pause);
            }
            self.scrub(context, requests, pointer);
        }
        if let Some(pointer) = response.hover_pos() {
            self.wheel(ui, context, requests, pointer);
        }
    }

    /// Goes to the frame under the pointer; a zoomed timeline goes on past its ends.
    fn scrub(&self, context: &Context<'_>, requests: &mut Requests, pointer: Pos2) {
        let beyond = (pointer.x - self.plot.right()).max(0.0) + (pointer.x - self.plot.left()).min(0.0);
        if beyond != 0.0 && context.time.span.is_some() {
            let moved = self.scale.span.moved(f64::from(0.2 * beyond / self.scale.step()), self.count);
            requests.request(Request::Timeline(TimelineEvent::Show(Some(moved))));
        }
        let frame = self.frame_at(pointer);
        if frame != context.selection.frame {
            requests.request(Request::Frame(frame));
        }
    }

    /// The wheel zooms about the frame under the pointer; sideways, or with Shift, it moves.
    fn wheel(&self, ui: &Ui, context: &Context<'_>, requests: &mut Requests, pointer: Pos2) {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
        let about = self.scale.at(pointer.x.clamp(self.plot.left(), self.plot.right()));
        let factor = f64::from((scroll.y * ZOOM_PER_POINT).exp() * pinch);
        let mut span = context.time.span;
        if factor != 1.0 {
            span = self.scale.span.zoomed(factor, about, self.count);
        }
        if scroll.x != 0.0
            && let Some(zoomed) = &mut span
        {
            *zoomed = zoomed.moved(f64::from(-scroll.x / self.scale.step()), self.count);
        }
        if span != context.time.span {
            requests.request(Request::Timeline(TimelineEvent::Show(span)));
        }
    }
}
