//! The ruler, and what is marked on it and in the lane of the overlap: tracked and marked frames, key poses, lost and worst
//! frames, the frame on the screen.

use std::collections::BTreeMap;

use backlit_runs::changes::change_text;
use backlit_ui::style::theme::tick;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::paint_text;
use egui::{
    Align2, Id, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo, pos2,
    vec2,
};

use super::ranking::worst;
use super::span::{Span, TimeScale};
use crate::context::{Context, Requests, SessionRequest, ShellRequest};
use crate::session::playback::FrameRange;

pub(crate) const RULER: f32 = 18.0;
/// Thickness of the bar of fitted frames.
const BAR: f32 = 3.0;
/// Half a mark's height and width, for the pointer.
const MARK: f32 = 5.0;
/// From this width on there is room for a second sentence.
const WIDE: f32 = 900.0;
/// Least distance of two numbers on the ruler.
const NUMBERS: f32 = 60.0;

/// Half a diamond.
const HALF: f32 = 5.0;
/// Half a diamond under the pointer.
const HALF_HOVERED: f32 = 6.5;
/// Height of a bookmark's flag.
const FLAG: f32 = 11.0;
/// Half the square that takes the pointer.
const TARGET: f32 = 8.0;

pub(crate) fn ruler(ui: &Ui, scale: &TimeScale) {
    let (palette, plot) = (theme::palette(ui), scale.plot);
    let step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000]
        .into_iter()
        .find(|step| scale.step() * *step as f32 >= NUMBERS)
        .unwrap_or(50_000);
    let frames = scale.frames();
    let first = frames.start().next_multiple_of(step);
    for frame in (first..=*frames.end()).step_by(step) {
        let at = scale.x(frame as f64);
        if !plot.x_range().expand(0.5).contains(at) {
            continue;
        }
        ui.painter().vline(at, plot.top() + RULER - 4.0..=plot.bottom(), Stroke::new(1.0, palette.grid));
        let place = pos2(at, plot.top() + RULER - 5.0);
        let text = format::count(frame as i64);
        paint_text(ui, place, Align2::CENTER_BOTTOM, text, tick(), palette.text2);
    }
    if scale.span != Span::whole(scale.count) {
        overview(ui, scale);
    }
}

/// Which part of the take is on the screen.
fn overview(ui: &Ui, scale: &TimeScale) {
    let palette = theme::palette(ui);
    let whole = TimeScale { span: Span::whole(scale.count), ..*scale };
    let y = scale.plot.top() + 1.0;
    ui.painter().hline(scale.plot.x_range(), y, Stroke::new(1.0, palette.line));
    let shown = whole.x(scale.span.first)..=whole.x(scale.span.last).max(whole.x(scale.span.first) + 4.0);
    ui.painter().hline(shown, y, Stroke::new(2.0, palette.text3));
}

/// What may be done where no frame is fitted yet, over the empty lanes.
pub(crate) fn first_steps(ui: &Ui, lanes: Rect, has_no_key: bool) {
    let palette = theme::palette(ui);
    let track =
        "Ctrl+Enter tracks from this frame on: RMS, overlap and steps of every frame stand here then.";
    let key = "K keeps this frame\u{2019}s pose as a key pose, a diamond above.";
    let text = if has_no_key && lanes.width() > WIDE { format!("{track} {key}") } else { track.to_owned() };
    paint_text(ui, lanes.center(), Align2::CENTER_CENTER, text, TextStyle::Small, palette.text3);
}

pub(crate) fn marked(ui: &Ui, scale: &TimeScale, range: FrameRange) {
    let (palette, plot) = (theme::palette(ui), scale.plot);
    let painter = ui.painter().with_clip_rect(plot);
    let half = 0.5 * scale.step().min(8.0);
    let across = scale.x(range.first as f64) - half..=scale.x(range.last as f64) + half;
    let band = Rect::from_x_y_ranges(across, plot.top() + 2.0..=plot.top() + RULER - 3.0);
    painter.rect_filled(band, 0.0, palette.select);
    for x in [band.left(), band.right()] {
        painter.vline(x, band.top()..=plot.bottom(), Stroke::new(1.0, palette.accent_text));
    }
}

fn line(plot: Rect) -> f32 {
    plot.top() + RULER - 3.0
}

/// Fitted frames as a bar, and those that the tracker still has before it.
pub(crate) fn on_ruler(ui: &Ui, context: &Context<'_>, scale: &TimeScale) {
    let (palette, document, plot) = (theme::palette(ui), context.document(), scale.plot);
    let painter = ui.painter().with_clip_rect(plot.expand2(vec2(3.0, 0.0)));
    let y = line(plot);
    painter.hline(plot.x_range(), y, Stroke::new(1.0, palette.line));
    let half = 0.5 * scale.step().min(6.0);
    for (from, to) in pieces(document.estimates.range(scale.frames()).map(|(frame, _)| *frame)) {
        let across =
            scale.x(from as f64) - half..=(scale.x(to as f64) + half).max(scale.x(from as f64) + 1.0);
        painter.hline(across, y, Stroke::new(BAR, palette.text3));
    }
    if let Some(FrameRange { first, last }) =
        context.busy.track.and_then(|tracking| tracking.frames_to_come())
    {
        let across = scale.x(first as f64) - half..=scale.x(last as f64) + half;
        painter.hline(across, y, Stroke::new(BAR, palette.accent_text));
    }
}

/// First and last frame of every piece without a gap.
fn pieces(frames: impl Iterator<Item = usize>) -> Vec<(usize, usize)> {
    let mut pieces: Vec<(usize, usize)> = Vec::new();
    for frame in frames {
        match pieces.last_mut() {
            Some((_, last)) if *last + 1 == frame => *last = frame,
            _ => pieces.push((frame, frame)),
        }
    }
    pieces
}

pub(crate) fn troubles(ui: &Ui, context: &Context<'_>, lane: Rect, scale: &TimeScale) {
    let (palette, document) = (theme::palette(ui), context.document());
    let painter = ui.painter().with_clip_rect(lane.expand2(vec2(5.0, 0.0)));
    let triangle = |at: Pos2| vec![at + vec2(-4.0, -4.0), at + vec2(4.0, -4.0), at + vec2(0.0, 3.0)];
    let mut before = f32::NEG_INFINITY;
    let found = document.estimates.range(scale.frames());
    for (frame, _) in found.clone().filter(|(_, estimate)| estimate.lost) {
        let at = pos2(scale.x(*frame as f64), lane.bottom() - 5.0);
        if at.x - before < 3.0 {
            continue;
        }
        before = at.x;
        painter.add(Shape::convex_polygon(triangle(at), palette.warn, Stroke::NONE));
        named(ui, lane, at, format!("Lost frame {frame}"));
    }
    if let Some(frame) = worst(context) {
        let at = pos2(scale.x(frame as f64), lane.top() + 6.0);
        painter.add(Shape::closed_line(triangle(at), Stroke::new(1.2, palette.warn)));
        named(ui, lane, at, format!("Worst frame {frame}"));
    }
}

/// The name of a mark that is on the screen, for those who cannot see it.
fn named(ui: &Ui, lane: Rect, at: Pos2, name: String) {
    if lane.x_range().expand(0.5).contains(at.x) {
        let rect = Rect::from_center_size(at, Vec2::splat(2.0 * MARK));
        let mark = ui.interact(rect, Id::unique(("timeline's mark", &name)), Sense::hover());
        mark.widget_info(|| WidgetInfo::labeled(Role::GraphicsSymbol, true, &name));
    }
}

/// The diamonds. Says which one is under the pointer.
pub(crate) fn key_poses(
    ui: &Ui,
    context: &Context<'_>,
    requests: &mut Requests,
    scale: &TimeScale,
) -> Option<usize> {
    let (palette, plot) = (theme::palette(ui), scale.plot);
    let y = line(plot);
    let mut hovered = None;
    let mut before = f32::NEG_INFINITY;
    for (&frame, _) in context.document().keys.range(scale.frames()) {
        let at = pos2(scale.x(frame as f64), y);
        if at.x - before < 1.0 || !plot.x_range().expand(0.5).contains(at.x) {
            continue;
        }
        before = at.x;
        let target = Rect::from_center_size(at, Vec2::splat(2.0 * TARGET));
        let response = ui.interact(target, Id::unique(("key pose", frame)), Sense::click());
        let name = || WidgetInfo::labeled(Role::Button, true, format!("Key pose of frame {frame}"));
        response.widget_info(name);
        if response.clicked() {
            requests.request(SessionRequest::Frame(frame));
        }
        let is_hovered = response.hovered();
        if is_hovered {
            hovered = Some(frame);
        }
        let half = if is_hovered || response.has_focus() { HALF_HOVERED } else { HALF };
        let corners = [vec2(0.0, -half), vec2(half, 0.0), vec2(0.0, half), vec2(-half, 0.0)];
        let corners = corners.map(|corner| at + corner).to_vec();
        // A gap in the colour of the panel keeps it apart from its neighbours and from the bar.
        let edge = if response.has_focus() { palette.accent_text } else { palette.panel };
        ui.painter().add(Shape::convex_polygon(corners, palette.text, Stroke::new(1.5, edge)));
    }
    hovered
}

/// What is told of the silhouettes of a frame.
#[derive(Default)]
struct SilhouetteWedge {
    changes: bool,
    texts: Vec<String>,
    /// The camera that it is about.
    camera: Option<usize>,
}

/// A wedge below the ruler where a camera's background changes, and a hollow one where a silhouette is among the worst; it says which
/// and what.
pub(crate) fn silhouettes(ui: &Ui, context: &Context<'_>, requests: &mut Requests, scale: &TimeScale) {
    let (palette, plot) = (theme::palette(ui), scale.plot);
    let Some(footage) = &context.session.take else { return };
    let mut told: BTreeMap<usize, SilhouetteWedge> = BTreeMap::new();
    for change in context.document().changes.iter() {
        let wedge = told.entry(change.from).or_default();
        wedge.texts.push(change_text(change, footage.take()));
        (wedge.changes, wedge.camera) = (true, Some(change.camera));
    }
    for worst in &context.silhouettes.worst {
        let name = footage.cameras.get(worst.camera).map_or("a camera", |camera| camera.name());
        let wedge = told.entry(worst.frame).or_default();
        wedge.texts.push(format!("Silhouette of {name}: {}", worst.reason));
        wedge.camera.get_or_insert(worst.camera);
    }
    told.retain(|frame, _| scale.frames().contains(frame));
    for (frame, SilhouetteWedge { changes, texts, camera }) in told {
        let tip = pos2(scale.x(frame as f64), line(plot) + 1.0);
        if !plot.x_range().expand(0.5).contains(tip.x) {
            continue;
        }
        let target = Rect::from_min_size(tip - vec2(TARGET, 0.0), vec2(2.0 * TARGET, 2.0 * MARK));
        let response = ui.interact(target, Id::unique(("silhouettes of a frame", frame)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, texts.join("; ")));
        if response.clicked() {
            requests.others.extend(camera.map(|camera| ShellRequest::Camera(camera).into()));
            requests.request(SessionRequest::Frame(frame));
        }
        let half = if response.hovered() || response.has_focus() { HALF_HOVERED } else { HALF };
        let corners = vec![tip, tip + vec2(half, 1.6 * half), tip + vec2(-half, 1.6 * half)];
        let edge = if response.has_focus() { palette.accent_text } else { palette.panel };
        let shape = if changes {
            Shape::convex_polygon(corners, palette.warn, Stroke::new(1.0, edge))
        } else {
            Shape::closed_line(corners, Stroke::new(1.2, palette.warn))
        };
        ui.painter().add(shape);
        response.on_hover_text(texts.join("\n"));
    }
}

/// A flag below the ruler where somebody marked a place; it says what.
pub(crate) fn bookmarks(ui: &Ui, context: &Context<'_>, requests: &mut Requests, scale: &TimeScale) {
    let (palette, plot, document) = (theme::palette(ui), scale.plot, context.document());
    let shown = document.bookmarks.iter().filter(|mark| scale.frames().contains(&mark.frame));
    for (index, mark) in shown.enumerate() {
        let top = pos2(scale.x(mark.frame as f64), line(plot) + 2.0);
        let text = format!("{}: {}", mark.place(&document.model, &document.cameras), mark.text);
        let target = Rect::from_min_max(top - vec2(3.0, 0.0), top + vec2(2.0 * MARK, FLAG));
        let response = ui.interact(target, Id::unique(("bookmark", index)), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Bookmark. {text}")));
        if response.clicked() {
            requests.go_to(mark);
        }
        let high = if response.hovered() || response.has_focus() { FLAG + 2.0 } else { FLAG };
        let colour = if response.has_focus() { palette.accent_text } else { palette.info };
        ui.painter().line_segment([top, top + vec2(0.0, high)], Stroke::new(1.5, colour));
        let flag = vec![top, top + vec2(7.0, 2.5), top + vec2(0.0, 5.0)];
        ui.painter().add(Shape::convex_polygon(flag, colour, Stroke::NONE));
        response.on_hover_text(text);
    }
}

pub(crate) fn playhead(ui: &Ui, context: &Context<'_>, scale: &TimeScale) {
    let (palette, plot) = (theme::palette(ui), scale.plot);
    let at = scale.x(context.selection.frame as f64);
    if !plot.x_range().expand(6.0).contains(at) {
        return;
    }
    ui.painter().vline(at, plot.top() + 8.0..=plot.bottom(), Stroke::new(1.5, palette.accent_text));
    let head = Rect::from_center_size(pos2(at, plot.top() + 6.0), vec2(11.0, 11.0));
    ui.painter().rect(head, 2.0, palette.accent, palette.accent_edge, StrokeKind::Inside);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_have_no_gaps() {
        assert_eq!(pieces([1, 2, 3, 7, 9, 10].into_iter()), [(1, 3), (7, 7), (9, 10)]);
        assert_eq!(pieces(std::iter::empty()), []);
    }
}
