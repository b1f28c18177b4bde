//! The ruler, and what is marked on it: tracked and marked frames, key poses, lost and worst frames, the frame on
//! the screen.

use egui::{Align2, Pos2, Rect, Shape, Stroke, StrokeKind, Ui, pos2, vec2};

use super::span::{Scale, Span};
use crate::document::Document;
use crate::format;
use crate::playback::FrameRange;
use crate::showing::Showing;
use crate::theme::{self, tick};

/// Height of the ruler.
pub(super) const RULER: f32 = 18.0;
/// Thickness of the bar of fitted frames.
const BAR: f32 = 3.0;
/// Half a key pose's diamond.
const KEY: f32 = 4.5;
/// Least distance of two numbers on the ruler.
const NUMBERS: f32 = 60.0;

/// Numbers and grid.
pub(super) fn ruler(ui: &Ui, plot: Rect, scale: &Scale, count: usize) {
    let palette = theme::palette(ui);
    let step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000]
        .into_iter()
        .find(|step| scale.step() * *step as f32 >= NUMBERS)
        .unwrap_or(50_000);
    let font = tick().resolve(ui.style());
    let frames = scale.span.frames(count);
    let first = frames.start().next_multiple_of(step);
    for frame in (first..=*frames.end()).step_by(step) {
        let at = scale.x(frame as f64);
        if !plot.x_range().expand(0.5).contains(at) {
            continue;
        }
        ui.painter().vline(at, plot.top() + RULER - 4.0..=plot.bottom(), Stroke::new(1.0, palette.grid));
        let place = pos2(at, plot.top() + RULER - 5.0);
        let text = format::count(frame as i64);
        ui.painter().text(place, Align2::CENTER_BOTTOM, text, font.clone(), palette.text2);
    }
    if scale.span != Span::whole(count) {
        overview(ui, plot, scale, count);
    }
}

/// Which part of the take is on the screen.
fn overview(ui: &Ui, plot: Rect, scale: &Scale, count: usize) {
    let palette = theme::palette(ui);
    let whole = Scale::new(Span::whole(count), plot);
    let y = plot.top() + 1.0;
    ui.painter().hline(plot.x_range(), y, Stroke::new(1.0, palette.line));
    let shown = whole.x(scale.span.first)..=whole.x(scale.span.last).max(whole.x(scale.span.first) + 4.0);
    ui.painter().hline(shown, y, Stroke::new(2.0, palette.text3));
}

/// The frames that are marked, behind everything else.
pub(super) fn marked(ui: &Ui, plot: Rect, scale: &Scale, range: FrameRange) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(plot);
    let half = 0.5 * scale.step().min(8.0);
    let across = scale.x(range.first as f64) - half..=scale.x(range.last as f64) + half;
    let band = Rect::from_x_y_ranges(across, plot.top() + 2.0..=plot.top() + RULER - 3.0);
    painter.rect_filled(band, 0.0, palette.select);
    for x in [band.left(), band.right()] {
        painter.vline(x, band.top()..=plot.bottom(), Stroke::new(1.0, palette.accent_text));
    }
}

/// Fitted frames as a bar, key poses as diamonds.
pub(super) fn on_ruler(ui: &Ui, document: &Document, plot: Rect, scale: &Scale, count: usize) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(plot.expand2(vec2(KEY + 1.0, 0.0)));
    let y = plot.top() + RULER - 3.0;
    painter.hline(plot.x_range(), y, Stroke::new(1.0, palette.line));
    let half = 0.5 * scale.step().min(6.0);
    for (from, to) in pieces(document.estimates.range(scale.span.frames(count)).map(|(frame, _)| *frame)) {
        let across =
            scale.x(from as f64) - half..=(scale.x(to as f64) + half).max(scale.x(from as f64) + 1.0);
        painter.hline(across, y, Stroke::new(BAR, palette.text3));
    }
    let mut before = f32::NEG_INFINITY;
    for frame in document.keys.range(scale.span.frames(count)).map(|(frame, _)| *frame) {
        let at = scale.x(frame as f64);
        if at - before < 1.0 {
            continue;
        }
        before = at;
        let corners = [vec2(0.0, -KEY), vec2(KEY, 0.0), vec2(0.0, KEY), vec2(-KEY, 0.0)];
        let corners = corners.map(|corner| pos2(at, y) + corner).to_vec();
        painter.add(Shape::convex_polygon(corners, palette.text, Stroke::new(1.0, palette.panel)));
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

/// Lost frames, and the worst of the others.
pub(super) fn troubles(ui: &Ui, document: &Document, lane: Rect, scale: &Scale, count: usize) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(lane.expand2(vec2(5.0, 0.0)));
    let triangle = |at: Pos2| vec![at + vec2(-4.0, -4.0), at + vec2(4.0, -4.0), at + vec2(0.0, 3.0)];
    let mut before = f32::NEG_INFINITY;
    let found = document.estimates.range(scale.span.frames(count));
    for (frame, _) in found.clone().filter(|(_, estimate)| estimate.lost) {
        let at = scale.x(*frame as f64);
        if at - before < 3.0 {
            continue;
        }
        before = at;
        let shape =
            Shape::convex_polygon(triangle(pos2(at, lane.bottom() - 5.0)), palette.warn, Stroke::NONE);
        painter.add(shape);
    }
    if let Some(frame) = worst(document) {
        let at = pos2(scale.x(frame as f64), lane.top() + 6.0);
        painter.add(Shape::closed_line(triangle(at), Stroke::new(1.2, palette.warn)));
    }
}

/// The frame with the least overlap of those that are not lost; `None` where there is nothing to compare.
pub(super) fn worst(document: &Document) -> Option<usize> {
    let found = document.estimates.iter().filter(|(_, estimate)| !estimate.lost);
    let known: Vec<(f64, usize)> = found.filter_map(|(frame, found)| Some((found.iou?, *frame))).collect();
    if known.len() < 2 {
        return None;
    }
    known.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, frame)| frame)
}

/// The frame on the screen.
pub(super) fn playhead(ui: &Ui, showing: &Showing<'_>, plot: Rect, scale: &Scale) {
    let palette = theme::palette(ui);
    let at = scale.x(showing.selection.frame as f64);
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
