//! The timeline: transport, and the frames with lanes of RMS, overlap and steps.

mod extra_lanes;
mod lanes;
mod marks;
mod ranking;
mod read_out;
mod span;
mod transport;
mod update;

use backlit_ui::style::theme::{self, size};
use egui::{Frame, Margin, Panel, PointerButton, Pos2, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2};

use crate::context::command::{Command, TimelineCommand, TrackingCommand};
use crate::context::command_button::menu_row;
use crate::context::preferences::Layout;
use crate::context::{Context, Requests, SessionRequest};
use crate::session::playback::{FrameRange, PlaybackChange};
use lanes::Lane;
use marks::RULER;
use span::{Span, TimeScale};

/// Width of the names and numbers left of the lanes.
const NAMES: f32 = 122.0;
/// Room of the axes' ends right of the lanes.
const AXES: f32 = 46.0;
/// Below this height of the window there is one lane.
const ONE_LANE_BELOW: f32 = 800.0;
/// How much a point of the wheel zooms.
const ZOOM_PER_POINT: f32 = 0.004;

/// What the menu over the lanes offers.
const MENU: [Command; 7] = [
    Command::Timeline(TimelineCommand::SetKeyPose),
    Command::Tracking(TrackingCommand::Forward),
    Command::Tracking(TrackingCommand::Back),
    Command::Tracking(TrackingCommand::Between),
    Command::Timeline(TimelineCommand::ClearRange),
    Command::Tracking(TrackingCommand::Clear),
    Command::Timeline(TimelineCommand::WholeTake),
];

#[derive(Debug, Default)]
pub(crate) struct Timeline {
    /// Whether there are lanes, kept from start to start.
    pub(crate) shows_lanes: bool,
    /// The frames on the screen; all where `None`.
    span: Option<Span>,
    /// The frame that was shown last: a zoomed timeline follows it when it goes elsewhere.
    last_frame: Option<usize>,
    /// Where a drag with Shift has begun.
    marks_from: Option<usize>,
    /// How long a frame takes to be read, seconds.
    reading: Option<f64>,
    /// The frame that is read ahead, and since when.
    ahead: Option<(usize, f64)>,
}

impl Timeline {
    /// The timeline, at the bottom of what is left of the window.
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        requests: &mut Requests,
        window_height: f32,
    ) {
        let lanes: &[Lane] = if !self.shows_lanes {
            &[]
        } else if window_height < ONE_LANE_BELOW || context.preferences.layout == Layout::Debug {
            &[Lane::Overlap]
        } else {
            &[Lane::Rms, Lane::Overlap, Lane::Steps]
        };
        let (named, doubts) = (extra_lanes::motions_height(context), extra_lanes::doubts_height(context));
        let height = match lanes.len() {
            0 => size::TIMELINE_SHUT,
            1 => size::TIMELINE_ONE_LANE + 6.0 + named + doubts,
            _ => size::TIMELINE + named + doubts,
        };
        let frame = Frame::NONE.fill(theme::palette(ui).panel).inner_margin(Margin::symmetric(8, 4));
        Panel::bottom("timeline").exact_size(height).resizable(false).frame(frame).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            transport::ui(ui, context, requests);
            if !lanes.is_empty() {
                self.frames(ui, context, requests, lanes);
            }
        });
    }

    fn frames(&mut self, ui: &mut Ui, context: &Context<'_>, requests: &mut Requests, lanes: &[Lane]) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let count = context.session.frame_count();
        let shown = context.selection.frame as f64;
        response.widget_info(|| WidgetInfo::slider(true, shown, "Timeline"));
        let names = rect.with_max_x(rect.left() + NAMES);
        let plot = Rect::from_x_y_ranges(names.right()..=rect.right() - AXES, rect.y_range());
        if count == 0 || plot.width() < 1.0 {
            return;
        }
        let span = self.follow(context.selection.frame, count);
        let scale = TimeScale { span, plot, count };
        let (frames, last) = (scale.frames(), count - 1);
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_min_numeric_value(0.0);
            node.set_max_numeric_value(last as f64);
            node.set_description(format!("Frames {} to {} of 0 to {last}", frames.start(), frames.end()));
        });
        let before = self.span;
        self.act(&scale, ui, context, requests, &response);
        if self.span != before {
            ui.ctx().request_repaint();
        }
        if let Some(range) = self.marking(&scale, &response).or(context.playback.range) {
            marks::marked(ui, &scale, range);
        }
        marks::ruler(ui, &scale);
        let (named, doubts) = (extra_lanes::motions_height(context), extra_lanes::doubts_height(context));
        let lane_height = (rect.height() - RULER - named - doubts) / lanes.len() as f32;
        let document = context.document();
        for (index, lane) in lanes.iter().enumerate() {
            let top = rect.top() + RULER + lane_height * index as f32;
            let lane_area = Rect::from_x_y_ranges(plot.x_range(), top + 1.0..=top + lane_height - 1.0);
            lanes::draw(ui, document, *lane, lane_area, &scale);
            lanes::labels(ui, document, *lane, context.selection.frame, names, lane_area);
            if *lane == Lane::Overlap {
                marks::troubles(ui, context, lane_area, &scale);
            }
            let name = Rect::from_x_y_ranges(names.x_range(), lane_area.y_range());
            let name = ui.interact(name, response.id.with(index), Sense::hover());
            let said = || lane.said(document, context.selection.frame);
            name.widget_info(|| WidgetInfo::labeled(Role::Label, true, said()));
            name.on_hover_text(lane.explanation(document));
        }
        let low = |above: f32, height: f32| {
            let top = rect.bottom() - above - height;
            Rect::from_x_y_ranges(plot.x_range(), top + 2.0..=top + height - 1.0)
        };
        if doubts > 0.0 {
            extra_lanes::doubts(ui, context, names, low(named, doubts), &scale);
        }
        if named > 0.0 {
            extra_lanes::motions(ui, context, names, low(0.0, named), &scale);
        }
        if document.estimates.is_empty() && context.busy.track.is_none() {
            let below = plot.with_min_y(plot.top() + RULER);
            marks::first_steps(ui, below, document.keys.is_empty());
        }
        marks::on_ruler(ui, context, &scale);
        marks::playhead(ui, context, &scale);
        marks::silhouettes(ui, context, requests, &scale);
        marks::bookmarks(ui, context, requests, &scale);
        let key = marks::key_poses(ui, context, requests, &scale);
        let under = response.hover_pos().filter(|pointer| plot.expand(4.0).contains(*pointer));
        if let Some(frame) = key.or_else(|| Some(scale.frame_at(under?.x))) {
            read_out::ui(ui, context, frame, pos2(scale.x(frame as f64), plot.top()));
        }
        if response.secondary_clicked()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            // What the menu offers is about the frame on the screen.
            requests.request(SessionRequest::Frame(scale.frame_at(pointer.x)));
        }
        response.context_menu(|ui| {
            MENU.iter().for_each(|&command| menu_row(ui, context, requests, command, command.text()));
        });
    }

    /// The frames on the screen. A zoomed timeline follows the frame when that goes elsewhere.
    fn follow(&mut self, frame: usize, count: usize) -> Span {
        let before = self.last_frame.replace(frame);
        let Some(span) = &mut self.span else { return Span::whole(count) };
        if before != Some(frame) {
            *span = span.containing(frame, count);
        }
        *span
    }

    fn marking(&self, scale: &TimeScale, response: &Response) -> Option<FrameRange> {
        Some(FrameRange::between(self.marks_from?, scale.frame_at(response.interact_pointer_pos()?.x)))
    }

    fn act(
        &mut self,
        scale: &TimeScale,
        ui: &Ui,
        context: &Context<'_>,
        requests: &mut Requests,
        response: &Response,
    ) {
        let (shift, middle) = ui.input(|input| (input.modifiers.shift, input.pointer.middle_down()));
        if response.double_clicked() {
            self.span = None;
        } else if shift && response.clicked() {
            requests.request(SessionRequest::Playback(PlaybackChange::Mark(None)));
        } else if response.drag_started_by(PointerButton::Primary) && shift {
            let from = ui.input(|input| input.pointer.press_origin());
            self.marks_from = from.map(|from| scale.frame_at(from.x));
        } else if self.marks_from.is_some() {
            if response.drag_stopped() {
                if let Some(range) = self.marking(scale, response) {
                    requests.request(SessionRequest::Playback(PlaybackChange::Mark(Some(range))));
                }
                self.marks_from = None;
            }
        } else if response.dragged_by(PointerButton::Middle) {
            let by = -response.drag_delta().x / scale.step();
            self.span = self.span.map(|_| scale.span.moved(f64::from(by), scale.count));
        } else if let Some(pointer) = response.interact_pointer_pos().filter(|_| !shift && !middle)
            && !response.secondary_clicked()
            && ui.input(|input| !input.pointer.secondary_down())
        {
            if response.drag_started() && context.playback.is_playing() {
                requests.request(SessionRequest::Playback(PlaybackChange::Pause));
            }
            self.scrub(scale, context, requests, pointer);
        }
        if let Some(pointer) = response.hover_pos() {
            self.wheel(scale, ui, pointer);
        }
    }

    /// Goes to the frame under the pointer; a zoomed timeline goes on past its ends.
    fn scrub(&mut self, scale: &TimeScale, context: &Context<'_>, requests: &mut Requests, pointer: Pos2) {
        let beyond = (pointer.x - scale.plot.right()).max(0.0) + (pointer.x - scale.plot.left()).min(0.0);
        if beyond != 0.0 && self.span.is_some() {
            self.span = Some(scale.span.moved(f64::from(0.2 * beyond / scale.step()), scale.count));
        }
        let frame = scale.frame_at(pointer.x);
        if frame != context.selection.frame {
            requests.request(SessionRequest::Frame(frame));
        }
    }

    /// The wheel zooms about the frame under the pointer; sideways, or with Shift, it moves.
    fn wheel(&mut self, scale: &TimeScale, ui: &Ui, pointer: Pos2) {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
        let about = scale.at(pointer.x.clamp(scale.plot.left(), scale.plot.right()));
        let factor = f64::from((scroll.y * ZOOM_PER_POINT).exp() * pinch);
        if factor != 1.0 {
            self.span = scale.span.zoomed(factor, about, scale.count);
        }
        if scroll.x != 0.0
            && let Some(zoomed) = &mut self.span
        {
            *zoomed = zoomed.moved(f64::from(-scroll.x / scale.step()), scale.count);
        }
    }
}
