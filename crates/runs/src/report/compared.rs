//! What a page tells of references that a track is compared with, and of the track's own angles.

use backlit_formats::motion::Motion;
use backlit_report::{Cell, Curve, Table};
use backlit_tracking::metrics::comparison::{ComparisonOptions, TrackComparison};
use backlit_tracking::metrics::{JointAngle, Trajectories};

use super::figures::{number, table};
use super::{ReportSource, frames_poses};
use crate::comparison::{
    ANGLE_TITLES, ComparedReference, Figure, angle_figures, clock_words, compare_motion, error_figures,
    error_titles, world_words,
};

/// A reference, and what comparing with it has shown.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportComparison {
    name: String,
    found: TrackComparison,
}

impl ReportSource {
    /// Compares the track with a reference, for the page. A reference without anything in common has no curves and no rows.
    pub fn compare(&mut self, reference: &ComparedReference, options: &ComparisonOptions) {
        let motion =
            Motion::of_poses(&self.name, (*self.model).clone(), self.frame_rate, frames_poses(&self.track));
        let found = compare_motion(&motion, reference, options);
        self.comparisons.push(ReportComparison { name: reference.name.clone(), found });
    }
}

/// Errors beside each reference, and angles of the track and of the references.
pub(super) fn curves(source: &ReportSource) -> Vec<Curve> {
    let curve = |label: String, unit: &str, group: &str, values: Vec<(usize, Option<f64>)>| Curve {
        label,
        unit: unit.to_owned(),
        group: group.to_owned(),
        camera: None,
        values,
    };
    let mut curves = Vec::new();
    for ReportComparison { name, found } in &source.comparisons {
        let errors = found.frames.iter().map(|frame| (frame.frame, frame.mean_raw())).collect();
        curves.push(curve(name.clone(), "mm", "Joint error beside references", errors));
    }
    let ours = Trajectories::of_poses(&source.model, source.frame_rate, &frames_poses(&source.track));
    for angle in JointAngle::ALL {
        // Both sides of a body in one plot, each with its references.
        let group = angle.label().split_once(' ').map_or("", |(_, joint)| joint);
        let group = format!("Angle: {group}");
        let degrees = ours.angle_curve(angle).into_iter().map(|angle| angle.map(f64::to_degrees));
        let own = source.track.frames.keys().copied().zip(degrees).collect();
        curves.push(curve(angle.label().to_owned(), "°", &group, own));
        for ReportComparison { name, found } in &source.comparisons {
            if let Some(agreement) = found.angles.iter().find(|agreement| agreement.angle == angle) {
                let theirs = found.numbers.iter().copied().zip(agreement.curves.iter().map(|pair| pair[1]));
                curves.push(curve(format!("{}, {name}", angle.label()), "°", &group, theirs.collect()));
            }
        }
    }
    curves
}

/// A table of joints and one of angles for each reference.
pub(super) fn tables(source: &ReportSource) -> impl Iterator<Item = Table> {
    source
        .comparisons
        .iter()
        .flat_map(|ReportComparison { name, found }| [joints(name, found), angles(name, found)])
}

fn row<const N: usize>(name: String, figures: [Figure; N]) -> Vec<Cell> {
    let cells = figures.map(|(value, digits)| Cell::from(number(value, digits)));
    std::iter::once(Cell::from(name)).chain(cells).collect()
}

fn joints(name: &str, found: &TrackComparison) -> Table {
    let rows = found.by_joint.iter().map(|(joint, errors)| row(joint.clone(), error_figures(errors)));
    let overall = found.overall.iter().map(|errors| row("all joints".to_owned(), error_figures(errors)));
    let note = format!(
        "Millimetres. Clocks: {}. Axes: {}. Placed: without where the tool puts its markers. Root-aligned: without the place of \
         the hips. Procrustes: without place, turn and size of each frame. The last columns: joints within a distance.",
        clock_words(found.clock),
        world_words(&found.world)
    );
    let titles = error_titles();
    let columns: Vec<&str> = std::iter::once("joint").chain(titles.iter().map(String::as_str)).collect();
    table(&format!("Beside {name}"), &note, &columns, rows.chain(overall))
}

fn angles(name: &str, found: &TrackComparison) -> Table {
    let rows = found.angles.iter().map(|angle| {
        let turned = if angle.is_turned { " (reference turned round)" } else { "" };
        row(format!("{}{turned}", angle.angle.label()), angle_figures(angle))
    });
    let columns: Vec<&str> = std::iter::once("angle").chain(ANGLE_TITLES).collect();
    table(&format!("Angles beside {name}"), "Degrees.", &columns, rows)
}
