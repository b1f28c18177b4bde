//! Errors and angles over frames: a curve a reference, in an angle the poses' own too. A click goes to the frame.

use backlit_plot::marks::{even_marks, step_marks};
use backlit_tracking::metrics::JointAngle;
use backlit_tracking::metrics::comparison::{ComparedFrame, TrackComparison};
use backlit_ui::style::theme::run_style;
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::{grid_marks, run_line, still_plot};
use egui::{Role, Sense, Ui, Vec2, WidgetInfo};
use egui_plot::{Line, PlotPoints, PlotUi, VLine};

use super::Compare;
use crate::context::{Context, Requests, SessionRequest};

/// Width of a curve.
const WIDTH: f32 = 1.5;

/// Which error is drawn.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum ErrorKind {
    #[default]
    Raw,
    RootAligned,
    Procrustes,
}

impl ErrorKind {
    pub(super) const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Raw, "Raw", "Distance of each joint, as it is"),
        (
            Self::RootAligned,
            "Root-aligned",
            "Without the place of the hips: the pose without where it stands",
        ),
        (Self::Procrustes, "Procrustes", "Without place, turn and size of each frame: the shape alone"),
    ];

    fn of(self, frame: &ComparedFrame) -> &[Option<f64>] {
        match self {
            Self::Raw => &frame.raw,
            Self::RootAligned => &frame.root_aligned,
            Self::Procrustes => &frame.procrustes,
        }
    }
}

/// What is drawn over the frames.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum CurveChoice {
    /// The mean error of all joints, or a joint's.
    Error(ErrorKind, Option<String>),
    /// An angle.
    Angle(JointAngle),
}

impl Default for CurveChoice {
    fn default() -> Self {
        Self::Error(ErrorKind::Raw, None)
    }
}

/// Points of a curve, and gaps between its pieces.
type Pieces = Vec<Vec<[f64; 2]>>;

/// Splits values by frame where one is missing.
fn pieces(values: impl Iterator<Item = (usize, Option<f64>)>) -> Pieces {
    let mut all: Pieces = vec![Vec::new()];
    for (frame, value) in values {
        match (value, all.last_mut()) {
            (Some(value), Some(last)) => last.push([frame as f64, value]),
            _ => all.push(Vec::new()),
        }
    }
    all.retain(|piece| !piece.is_empty());
    all
}

impl CurveChoice {
    /// The curve of a comparison; of an angle the reference's.
    fn of(&self, found: &TrackComparison) -> Pieces {
        match self {
            Self::Error(kind, joint) => {
                let column = joint.as_ref().map(|joint| found.joints.iter().position(|name| name == joint));
                pieces(found.frames.iter().map(|frame| {
                    let errors = kind.of(frame);
                    let value = match column {
                        None => backlit_tracking::statistics::mean(errors.iter().flatten().copied()),
                        Some(column) => column.and_then(|column| errors[column]),
                    };
                    (frame.frame, value)
                }))
            }
            Self::Angle(angle) => Self::angle(found, *angle, 1),
        }
    }

    /// An angle's curve: 0 of the poses, 1 of the reference.
    fn angle(found: &TrackComparison, angle: JointAngle, side: usize) -> Pieces {
        let agreement = found.angles.iter().find(|agreement| agreement.angle == angle);
        let curves = agreement.into_iter().flat_map(|agreement| &agreement.curves);
        pieces(found.numbers.iter().copied().zip(curves.map(|pair| pair[side])))
    }
}

impl Compare {
    /// The plot, in an area.
    pub(super) fn curves(&self, ui: &mut Ui, area: Vec2, context: &Context<'_>, requests: &mut Requests) {
        let palette = theme::palette(ui);
        let is_angle = matches!(self.curve, CurveChoice::Angle(_));
        let curves: Vec<(usize, Pieces)> =
            self.found.iter().enumerate().map(|(index, found)| (index, self.curve.of(found))).collect();
        let own = match self.curve {
            CurveChoice::Angle(angle) => {
                self.found_of(self.selected).map(|found| CurveChoice::angle(found, angle, 0))
            }
            CurveChoice::Error(..) => None,
        };
        let all = || curves.iter().flat_map(|(_, pieces)| pieces).chain(own.iter().flatten()).flatten();
        let ends = |axis: usize| {
            all().map(|point| point[axis]).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            })
        };
        let ([first, last], [low, high]) = (ends(0), ends(1));
        let (low, high) = if is_angle { (low, high) } else { (0.0, high) };
        if !(first.is_finite() && high.is_finite()) {
            return;
        }
        let room = 0.06 * (high - low).max(1e-9);
        let unit = if is_angle { "°" } else { " mm" };
        let shown = context.selection.frame as f64;
        let response = still_plot("comparison plot", area, palette)
            .sense(Sense::click_and_drag())
            .y_axis_min_width(56.0)
            .x_grid_spacer(grid_marks(step_marks))
            .y_grid_spacer(grid_marks(even_marks))
            .y_axis_formatter(move |mark, _| format!("{}{unit}", format::short(mark.value)))
            .x_axis_formatter(|mark, _| format::number(mark.value, 0))
            .show(ui, |plot| {
                plot.set_plot_bounds_x(first..=last.max(first + 1.0));
                plot.set_plot_bounds_y(low - room..=high + room);
                plot.vline(VLine::new("", shown).color(palette.text3).width(1.0));
                for piece in own.iter().flatten() {
                    plot.line(
                        Line::new("", PlotPoints::from(piece.clone())).color(palette.text).width(WIDTH),
                    );
                }
                for (index, pieces) in &curves {
                    draw(plot, *index, pieces, *index == self.selected);
                }
            });
        let plot = response.response;
        plot.widget_info(|| {
            WidgetInfo::labeled(Role::Image, true, "Errors over frames; a click goes to the frame")
        });
        if let Some(at) = plot.interact_pointer_pos().filter(|_| plot.clicked() || plot.dragged()) {
            let frame = response.transform.value_from_position(at).x.round().clamp(first, last) as usize;
            if frame != context.selection.frame {
                requests.request(SessionRequest::Frame(frame));
            }
        }
        if let Some(at) = plot.hover_pos() {
            let frame = response.transform.value_from_position(at).x.round() as usize;
            let lines = self.values_at(frame, &curves, own.as_ref(), unit);
            plot.on_hover_ui_at_pointer(|ui| lines.iter().for_each(|line| drop(ui.label(line))));
        }
    }

    /// What the curves are at a frame, in words.
    fn values_at(
        &self,
        frame: usize,
        curves: &[(usize, Pieces)],
        own: Option<&Pieces>,
        unit: &str,
    ) -> Vec<String> {
        let at = |pieces: &Pieces| {
            let point = pieces.iter().flatten().find(|point| point[0] == frame as f64);
            point.map_or_else(
                || format::MISSING.to_owned(),
                |point| format!("{}{unit}", format::number(point[1], 1)),
            )
        };
        let mut lines = vec![format!("Frame {}", format::count(frame as i64))];
        lines.extend(own.map(|own| format!("poses: {}", at(own))));
        for (index, pieces) in curves {
            if let Some(named) = self.references.get(*index) {
                lines.push(format!("{}: {}", named.reference.name, at(pieces)));
            }
        }
        lines
    }
}

fn draw(plot: &mut PlotUi<'_>, index: usize, pieces: &Pieces, is_selected: bool) {
    let width = if is_selected { run_style(index).width } else { WIDTH };
    for piece in pieces {
        run_line(plot, piece.clone(), index, width);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_have_gaps_where_nothing_was_compared() {
        let values = [(0, Some(1.0)), (1, Some(2.0)), (2, None), (3, None), (4, Some(3.0))];
        assert_eq!(pieces(values.into_iter()), [vec![[0.0, 1.0], [1.0, 2.0]], vec![[4.0, 3.0]]]);
    }
}
