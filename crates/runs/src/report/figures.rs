//! Curves and tables of a page.

use backlit_report::{Cell, Curve, Table};
use backlit_tracking::metrics::JointErrors;
use backlit_tracking::track::{FrameEstimate, Lost};
use backlit_words::format;

use super::{ReportSource, compared};
use crate::track_summary::{Distances, Doubts, ErrorSummary, IouSummary};

/// A reference that scatters by less than this, millimetres, is the truth of a simulation.
const LEAST_NOISE_MM: f64 = 0.05;

/// Overlap, residual, cost and joint error over frames. Curves by camera name the page's cameras, if it has any.
pub(super) fn curves(source: &ReportSource, has_cameras: bool) -> Vec<Curve> {
    let of = |label: &str, group: &str, unit: &str, value: &dyn Fn(&FrameEstimate) -> Option<f64>| Curve {
        label: label.to_owned(),
        unit: unit.to_owned(),
        group: group.to_owned(),
        camera: None,
        values: source.track.frames.values().map(|one| (one.frame, value(one))).collect(),
    };
    let mut curves = vec![of("all cameras", "Overlap (IoU)", "", &|one| source.iou(one))];
    for (camera, name) in source.cameras.iter().enumerate() {
        let iou = |one: &FrameEstimate| one.overlap.get(camera).copied().flatten()?.iou();
        let curve = of(name, "Overlap (IoU)", "", &iou);
        curves.push(Curve { camera: has_cameras.then_some(camera), ..curve });
    }
    let errors = |one: &FrameEstimate| {
        let errors = errors(source, std::iter::once(one))?;
        Some(errors.overall()?.mean)
    };
    curves.push(of("mean of all joints", "Joint error", "mm", &errors));
    curves.extend(compared::curves(source));
    curves.push(of("root mean square", "Residual", "grey levels", &|one| one.rms));
    curves.push(of("cost", "Cost", "squared grey levels", &|one| one.cost));
    curves.retain(|curve| curve.values.iter().any(|(_, value)| value.is_some_and(f64::is_finite)));
    curves
}

/// Errors of these frames against the take's reference; `None` without one.
fn errors<'a>(source: &ReportSource, frames: impl Iterator<Item = &'a FrameEstimate>) -> Option<JointErrors> {
    let reference = source.footage.as_ref()?.take().reference()?;
    let mut errors = JointErrors::default();
    frames.for_each(|one| errors.add(&source.model, &one.pose, &reference.joints(one.frame)));
    Some(errors)
}

/// Doubtful limbs, errors by joint, overlaps and sizes; those that there is anything to tell of.
pub(super) fn tables(source: &ReportSource) -> Vec<Table> {
    let tables = [doubts(source), joint_errors(source), overlaps(source), sizes(source)];
    let tables = tables.into_iter().flatten().chain(compared::tables(source));
    tables.filter(|table| !table.rows.is_empty()).collect()
}

fn doubts(source: &ReportSource) -> Option<Table> {
    let by_limb = Doubts::by_limb(&source.model, &source.track);
    let mut worst: Vec<_> = by_limb.into_iter().collect();
    worst.sort_by_key(|(_, counts)| std::cmp::Reverse((counts.wrong, counts.doubtful)));
    let row = |(limb, counts): (String, Doubts)| {
        let Doubts { doubtful, wrong, first } = counts;
        let first = Cell { text: first.to_string(), frame: Some(first) };
        vec![limb.into(), doubtful.to_string().into(), wrong.to_string().into(), first]
    };
    let note = "Frames in which a limb may be wrong, and in which there is a chance of one in four or more that its end is over 250 mm off.";
    Some(table("Doubtful limbs", note, &["limb", "doubtful", "wrong", "first"], worst.into_iter().map(row)))
}

fn joint_errors(source: &ReportSource) -> Option<Table> {
    let placement = source.footage.as_ref()?.take().reference()?.placement();
    let summary = ErrorSummary::of(&errors(source, source.track.frames.values())?, placement)?;
    let row = |name: &str, all: &Distances, placed: Option<f64>| -> Vec<Cell> {
        let numbers = [Some(all.mean), Some(all.median), Some(all.p95), Some(all.max), placed];
        let cells = numbers.map(|mm| Cell::from(number(mm, 1)));
        std::iter::once(Cell::from(name)).chain(cells).collect()
    };
    let mut rows: Vec<_> =
        summary.by_joint.iter().map(|(name, joint)| row(name, &joint.raw, joint.placed)).collect();
    rows.push(row("all joints", &summary.overall, summary.placed.map(|placed| placed.mean)));
    let by = summary.placement.as_deref().unwrap_or("learnt in other frames");
    let noise = summary.reference_noise.filter(|mm| *mm >= LEAST_NOISE_MM).map_or(String::new(), |mm| {
        format!(" The reference itself scatters by {} mm.", format::number(mm, 1))
    });
    let note = format!(
        "Millimetres from the reference. Placed: the mean without where the markers sit beside the joints ({by}).{noise}"
    );
    Some(table("Joint errors", &note, &["joint", "mean", "median", "95 %", "max", "placed"], rows))
}

fn overlaps(source: &ReportSource) -> Option<Table> {
    let summary = IouSummary::of(&source.cameras, &source.track);
    let left_out = |name: &String| {
        let frames = source.track.frames.values();
        frames.filter(|frame| frame.empty_cameras.contains(name)).count().to_string()
    };
    let by_camera = |name: &String| summary.by_camera.get(name).copied().flatten();
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    if source.cameras.iter().any(|name| by_camera(name).is_some()) {
        rows.extend(source.cameras.iter().map(|name| {
            vec![name.as_str().into(), number(by_camera(name), 3).into(), left_out(name).into()]
        }));
    }
    let all: Vec<f64> = source.track.frames.values().filter_map(|frame| source.iou(frame)).collect();
    if !all.is_empty() {
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        rows.push(vec!["all cameras".into(), number(Some(mean), 3).into(), "".into()]);
    }
    let percent = summary.left_out.filter(|share| *share > 0.0).map_or(String::new(), |share| {
        format!(
            " It leaves out {} of the body's pixels, where the silhouettes are unknown.",
            format::percent(share)
        )
    });
    let note = format!("Intersection over union of body and silhouette, the mean of all frames.{percent}");
    Some(table("Overlap", &note, &["camera", "IoU", "frames with nobody"], rows))
}

fn sizes(source: &ReportSource) -> Option<Table> {
    let mm = |metres: f64| Cell::from(number(Some(1000.0 * metres), 0));
    let limbs = source.model.limbs().iter();
    let rows = limbs.map(|limb| vec![limb.name.as_str().into(), mm(limb.length), mm(limb.radius)]);
    let sizes = table("Sizes of the body", "Millimetres.", &["limb", "length", "radius"], rows);
    Some(Table { is_folded: true, ..sizes })
}

pub(super) fn table(
    title: &str,
    note: &str,
    columns: &[&str],
    rows: impl IntoIterator<Item = Vec<Cell>>,
) -> Table {
    Table {
        title: title.to_owned(),
        note: note.to_owned(),
        is_folded: false,
        columns: columns.iter().map(|column| (*column).to_owned()).collect(),
        rows: rows.into_iter().collect(),
    }
}

/// A number, or a dash for one that is not known.
pub(super) fn number(value: Option<f64>, decimals: usize) -> String {
    let known = value.filter(|value| value.is_finite());
    known.map_or_else(|| "–".to_owned(), |value| format::number(value, decimals))
}

/// Why a frame counts as lost, in words.
pub(super) fn lost_text(why: Lost) -> &'static str {
    match why {
        Lost::Nobody => "no camera sees anybody",
        Lost::NoStart => "no start could be found",
        Lost::Numbers => "the tracker does not trust it",
        Lost::OutOfScene => "the fit left the scene",
        Lost::Overlap { .. } => "body and silhouettes hardly overlap",
        Lost::Cost { .. } => "the residual is far above the usual one",
    }
}
