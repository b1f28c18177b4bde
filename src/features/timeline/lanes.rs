//! The lanes: RMS, overlap and steps by frame. Where several frames share a point of the screen, their range is
//! drawn, so a take of thousands of frames is as quick as a short one.

use backlit_document::{Document, Estimate};
use backlit_ui::style::theme::tick;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::paint_text;
use egui::{Align2, Color32, Mesh, Pos2, Rect, Shape, Stroke, TextStyle, Ui, pos2, vec2};

use super::span::TimeScale;
use backlit_tracking::track::LOST_BELOW_IOU;

/// Width of a curve.
const CURVE: f32 = 1.5;
/// Frames farther apart than this on the screen have dots.
const DOTS_FROM: f32 = 20.0;
/// The RMS's axis ends at most at this multiple of the median: one bad frame must not flatten all others.
const MOST_MEDIANS: f64 = 4.0;
/// From this height on both ends of an axis stand at their places; below, beside each other.
const BOTH_ENDS_FROM: f32 = 30.0;

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Lane {
    Rms,
    Overlap,
    Steps,
}

impl Lane {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Rms => "RMS, grey",
            Self::Overlap => "IoU",
            Self::Steps => "Steps",
        }
    }

    /// What is drawn, what is good, and where the lane ends.
    pub(crate) fn explanation(self, document: &Document) -> String {
        let what = match self {
            Self::Rms => {
                "RMS: what the fit of each frame has left over, as the root mean square of the pixels that it saw, \
                 in grey levels. It is one measure for tracked and for fitted frames. Less is better; one frame \
                 that stands out has gone wrong."
            }
            Self::Overlap => {
                "IoU: the area that body and silhouettes share, over the area that either covers, all cameras \
                 together; unknown pixels are left out. 1 is perfect; below 0.4 a frame counts as lost. A filled triangle \
                 marks a lost frame, an outlined one the worst of the others."
            }
            Self::Steps => {
                "Steps: how many steps the fit of each frame took, rejected ones included. Many mean that the \
                 frame was hard."
            }
        };
        format!("{what}\nThe lane goes from {}.", self.ends(document))
    }

    fn ends(self, document: &Document) -> String {
        let [low, high] = self.axis(document).map(|value| self.axis_text(value));
        format!("{low} to {high}")
    }

    /// The lane in words: its value at a frame, and its ends.
    pub(crate) fn said(self, document: &Document, frame: usize) -> String {
        let estimate = document.estimates.get(&frame);
        let unknown = match estimate {
            Some(estimate) if estimate.cost.is_none() => "nobody in the picture",
            _ => "not known",
        };
        let value = estimate.and_then(|estimate| self.value(estimate));
        let value = value.map_or_else(|| unknown.to_owned(), |value| self.text(Some(value)));
        format!("{}: {value}, lane from {}", self.name(), self.ends(document))
    }

    pub(crate) fn value(self, estimate: &Estimate) -> Option<f64> {
        let value = match self {
            Self::Rms => estimate.rms,
            Self::Overlap => estimate.iou,
            Self::Steps => Some(estimate.steps as f64),
        };
        value.filter(|value| value.is_finite())
    }

    pub(crate) fn text(self, value: Option<f64>) -> String {
        let Some(value) = value else { return format::MISSING.to_owned() };
        match self {
            Self::Rms => format::number(value, 1),
            Self::Overlap => format::ratio(value),
            Self::Steps => format::number(value, 0),
        }
    }

    /// Both ends of the lane's axis: round numbers, which stay while frames are tracked.
    pub(crate) fn axis(self, document: &Document) -> [f64; 2] {
        let mut values: Vec<f64> =
            document.estimates.values().filter_map(|estimate| self.value(estimate)).collect();
        let largest = values.iter().copied().fold(0.0, f64::max);
        if self == Self::Overlap {
            if values.is_empty() {
                return [LOST_BELOW_IOU, 1.0];
            }
            // A twentieth of the frames may lie below the lane: a few bad ones must not flatten all others.
            let few = values.len() / 20;
            let (_, low, _) = values.select_nth_unstable_by(few, f64::total_cmp);
            let (low, high) = ((*low * 10.0).floor() / 10.0, (largest * 10.0).ceil() / 10.0);
            return [low.min(high - 0.1).max(0.0), high.max(0.1)];
        }
        if values.is_empty() {
            return [0.0, 1.0];
        }
        let middle = values.len() / 2;
        let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
        [0.0, round_up(largest.min(MOST_MEDIANS * *median))]
    }

    fn axis_text(self, value: f64) -> String {
        match self {
            Self::Overlap if value.fract() != 0.0 => format::number(value, 1),
            _ => format::number(value, 0),
        }
    }
}

/// 1, 2 or 5 times a power of ten, not below the value.
fn round_up(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 1.0;
    }
    let power = 10_f64.powf(value.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|digit| digit * power).find(|top| *top >= value).unwrap_or(value)
}

/// The range of values that share a column of the screen.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Column {
    x: f32,
    frame: usize,
    low: f64,
    high: f64,
}

/// One column for all frames that fall on the same point. `None` between two columns is a gap: frames without a
/// value.
fn columns(lane: Lane, document: &Document, scale: &TimeScale) -> Vec<Option<Column>> {
    let mut columns: Vec<Option<Column>> = Vec::new();
    for (&frame, estimate) in document.estimates.range(scale.frames()) {
        let Some(value) = lane.value(estimate) else { continue };
        let x = scale.x(frame as f64);
        match columns.last_mut() {
            Some(Some(column)) if frame == column.frame + 1 && x.floor() == column.x.floor() => {
                (column.low, column.high) = (column.low.min(value), column.high.max(value));
                column.frame = frame;
                continue;
            }
            Some(Some(column)) if frame != column.frame + 1 => columns.push(None),
            _ => {}
        }
        columns.push(Some(Column { x, frame, low: value, high: value }));
    }
    columns
}

pub(crate) fn draw(ui: &Ui, document: &Document, lane: Lane, area: Rect, scale: &TimeScale) {
    let palette = theme::palette(ui);
    let painter = ui.painter().with_clip_rect(area.expand2(vec2(4.0, 0.0)));
    painter.rect_filled(area, 0.0, palette.plot);
    // A curve near the upper end of its lane is not taken for the one above.
    painter.hline(area.x_range(), area.top() - 1.0, palette.hairline());
    let axis = lane.axis(document);
    let height = area.height() - 3.0;
    let y = |value: f64| {
        let share = ((value - axis[0]) / (axis[1] - axis[0])).clamp(0.0, 1.0);
        area.bottom() - 1.0 - height * share as f32
    };
    let columns = columns(lane, document, scale);
    if lane == Lane::Steps {
        let width = (0.5 * scale.step()).clamp(1.0, 4.0);
        let mut bars = Mesh::default();
        for column in columns.iter().flatten() {
            let top = y(column.high).min(area.bottom() - 1.0);
            let bar = Rect::from_min_max(
                pos2(column.x - 0.5 * width, top),
                pos2(column.x + 0.5 * width, area.bottom()),
            );
            bars.add_colored_rect(bar, palette.text3);
        }
        painter.add(bars);
        return;
    }
    // Of a body of other sizes: paler.
    let is_stale = document.estimates.values().all(|estimate| estimate.is_stale);
    let colour = if is_stale { palette.text3 } else { palette.text2 };
    for piece in columns.split(Option::is_none) {
        let piece: Vec<Column> = piece.iter().flatten().copied().collect();
        if scale.step() < 1.0 {
            painter.add(ranges(&piece, y, colour));
        } else {
            curve(&painter, &piece, y, colour, scale.step());
        }
    }
}

/// Frames that share points: a band from the lowest to the highest, which touches its neighbours.
fn ranges(piece: &[Column], y: impl Fn(f64) -> f32, colour: Color32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut before: Option<(f32, f32)> = None;
    for column in piece {
        let (mut top, mut bottom) = (y(column.high), y(column.low));
        if let Some((last_top, last_bottom)) = before {
            (top, bottom) = (top.min(last_bottom), bottom.max(last_top));
        }
        before = Some((y(column.high), y(column.low)));
        let (middle, half) = (0.5 * (top + bottom), (0.5 * (bottom - top)).max(0.5 * CURVE));
        let left = column.x.floor();
        let band = Rect::from_min_max(pos2(left, middle - half), pos2(left + 1.0, middle + half));
        mesh.add_colored_rect(band, colour);
    }
    mesh
}

fn curve(painter: &egui::Painter, piece: &[Column], y: impl Fn(f64) -> f32, colour: Color32, step: f32) {
    let points: Vec<Pos2> = piece.iter().map(|column| pos2(column.x, y(column.high))).collect();
    if points.len() == 1 || step >= DOTS_FROM {
        for point in &points {
            painter.circle_filled(*point, 2.0, colour);
        }
    }
    painter.add(Shape::line(points, Stroke::new(CURVE, colour)));
}

/// The lane's name with its unit, the value of the frame on the screen, and the ends of the axis.
pub(crate) fn labels(ui: &Ui, document: &Document, lane: Lane, frame: usize, left: Rect, area: Rect) {
    let palette = theme::palette(ui);
    let y = area.center().y;
    let estimate = document.estimates.get(&frame);
    let value = estimate.and_then(|estimate| lane.value(estimate));
    let is_stale = estimate.is_some_and(|estimate| estimate.is_stale);
    let at = pos2(left.left() + 4.0, y);
    paint_text(ui, at, Align2::LEFT_CENTER, lane.name(), TextStyle::Small, palette.text2);
    let (at, colour) = (pos2(left.right() - 10.0, y), if is_stale { palette.text3 } else { palette.text });
    paint_text(ui, at, Align2::RIGHT_CENTER, lane.text(value), TextStyle::Monospace, colour);
    let [low, high] = lane.axis(document);
    let x = area.right() + 4.0;
    let text = |text: String, y: f32, align: Align2| {
        paint_text(ui, pos2(x, y), align, text, tick(), palette.text3);
    };
    let [low, high] = [low, high].map(|value| lane.axis_text(value));
    if area.height() >= BOTH_ENDS_FROM {
        text(high, area.top() - 1.0, Align2::LEFT_TOP);
        text(low, area.bottom() + 1.0, Align2::LEFT_BOTTOM);
    } else {
        text(format!("{low}–{high}"), y, Align2::LEFT_CENTER);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Instant;

    use backlit_tracking::body::{Pose, builtin};

    use super::*;
    use crate::features::timeline::span::Span;
    use backlit_document::Origin;
    use backlit_document::edit::Edit;

    fn document(frames: impl Iterator<Item = (usize, f64)>) -> Document {
        let model = builtin::single_limb();
        let pose = Pose::rest(&model);
        let estimate = |rms| Estimate {
            pose: pose.clone(),
            origin: Origin::Track,
            cost: Some(1.0),
            rms: Some(rms),
            iou: Some(0.8),
            steps: 3,
            lost: false,
            is_stale: false,
        };
        let found = frames.map(|(frame, rms)| (frame, Arc::new(estimate(rms)), None)).collect();
        let mut document = Document::new(model);
        document.apply(Edit::AddTrack(found)).unwrap();
        document
    }

    #[test]
    fn axes_end_with_round_numbers_and_one_bad_frame_does_not_flatten_the_rest() {
        assert_eq!([0.7, 1.0, 1.2, 3.6e8, 7e8].map(round_up), [1.0, 1.0, 2.0, 5e8, 1e9]);
        assert_eq!(round_up(0.0), 1.0);
        let document = document((0..50).map(|frame| (frame, if frame == 9 { 1e9 } else { 3.0 })));
        assert_eq!(Lane::Rms.axis(&document), [0.0, 20.0]);
    }

    #[test]
    fn frames_that_share_a_point_are_one_range_and_gaps_stay_gaps() {
        let count = 20_000;
        let is_known = |frame: &usize| !(4000..4400).contains(frame);
        let document = document((0..count).filter(is_known).map(|frame| (frame, (frame % 7) as f64)));
        let plot = Rect::from_min_size(pos2(0.0, 0.0), vec2(1000.0, 30.0));
        let scale = TimeScale { span: Span::whole(count), plot, count };
        let began = Instant::now();
        let columns = columns(Lane::Rms, &document, &scale);
        assert!(began.elapsed().as_millis() < 200, "{:?}", began.elapsed());
        assert!(columns.len() < 1005, "{}", columns.len());
        assert_eq!(columns.iter().filter(|column| column.is_none()).count(), 1);
        let middle = columns[500].unwrap();
        assert_eq!((middle.low, middle.high), (0.0, 6.0), "no extreme is lost");
    }
}
