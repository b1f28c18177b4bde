//! What a page tells of references that a track is compared with, and of the track's own angles.

use backlit_formats::motion::Motion;
use backlit_report::{Cell, Curve, Table};
use backlit_tracking::metrics::comparison::{ComparisonOptions, ErrorStatistics, PCK_MM, TrackComparison};
use backlit_tracking::metrics::{JointAngle, Trajectories};

use super::figures::{number, table};
use super::{ReportSource, frames_poses};
use crate::comparison::{ComparedReference, clock_words, compare_motion, world_words};

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

fn joints(name: &str, found: &TrackComparison) -> Table {
    let row = |joint: &str, errors: &ErrorStatistics| -> Vec<Cell> {
        let mean = |of: &Option<backlit_tracking::statistics::Statistics>| of.as_ref().map(|of| of.mean);
        let numbers = [
            Some(errors.raw.mean),
            Some(errors.raw.median),
            Some(errors.raw.p95),
            errors.placed,
            mean(&errors.root_aligned),
            mean(&errors.procrustes),
        ];
        let numbers = numbers.map(|mm| Cell::from(number(mm, 1)));
        let shares = errors.pck.map(|share| Cell::from(number(Some(100.0 * share), 0)));
        std::iter::once(Cell::from(joint)).chain(numbers).chain(shares).collect()
    };
    let mut rows: Vec<Vec<Cell>> = found.by_joint.iter().map(|(joint, errors)| row(joint, errors)).collect();
    rows.extend(found.overall.as_ref().map(|errors| row("all joints", errors)));
    let pck = PCK_MM.map(|mm| format!("{mm:.0} mm, %"));
    let columns = [
        "joint",
        "mean",
        "median",
        "95 %",
        "placed",
        "root-aligned",
        "Procrustes",
        &pck[0],
        &pck[1],
        &pck[2],
    ];
    let note = format!(
        "Millimetres. Clocks: {}. Axes: {}. Placed: without where the tool puts its markers. Root-aligned: without the place of \
         the hips. Procrustes: without place, turn and size of each frame. The last columns: joints within a distance.",
        clock_words(found.clock),
        world_words(&found.world)
    );
    table(&format!("Beside {name}"), &note, &columns, rows)
}

fn angles(name: &str, found: &TrackComparison) -> Table {
    let row = |angle: &backlit_tracking::metrics::comparison::AngleAgreement| -> Vec<Cell> {
        let turned = if angle.is_turned { " (reference turned round)" } else { "" };
        let numbers = [Some(angle.rms), Some(angle.offset), Some(angle.rms_without_offset)];
        let numbers = numbers.map(|degrees| Cell::from(number(degrees, 1)));
        let name = Cell::from(format!("{}{turned}", angle.angle.label()));
        std::iter::once(name).chain(numbers).chain([Cell::from(number(angle.correlation, 3))]).collect()
    };
    let columns = ["angle", "RMS", "mean difference", "RMS without it", "correlation"];
    table(&format!("Angles beside {name}"), "Degrees.", &columns, found.angles.iter().map(row))
}
