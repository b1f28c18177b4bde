//! Tables of points: a row a frame and joint (`frame,seconds,joint,x,y,z`; also Caliscope's), or a row a frame
//! with three columns a joint (`RKnee_x,RKnee_y,RKnee_z`; Anipose, `FreeMoCap` and others).

use std::collections::BTreeMap;
use std::path::Path;

use ::csv::{ReaderBuilder, StringRecord, Trim};
use glam::DVec3;

use super::{Recording, limited, point, told_rate};
use crate::{FileProblem, Result, TextFormat, text};

const FRAME: [&str; 6] = ["frame", "sync_index", "fnum", "frame_number", "frame_index", "index"];
const TIME: [&str; 4] = ["seconds", "time", "timestamp", "t"];
const NAME: [&str; 5] = ["joint", "marker", "keypoint", "name", "point_id"];
const EXPECTED: &str = "frame or time, joint, x, y, z; or NAME_x, NAME_y, NAME_z for every joint";

/// Where columns stand.
struct Columns {
    frame: Option<usize>,
    time: Option<usize>,
    /// Of a row a joint.
    name: Option<usize>,
    /// Names and their three columns; one without a name of a row a joint.
    points: Vec<(String, [usize; 3])>,
}

impl Columns {
    fn of(header: &StringRecord) -> Option<Self> {
        let names: Vec<String> = header.iter().map(|name| name.to_lowercase()).collect();
        let find =
            |known: &[&str]| known.iter().find_map(|known| names.iter().position(|name| name == known));
        let (frame, time, name) = (find(&FRAME), find(&TIME), find(&NAME));
        let three = |stem: &str, x: usize| {
            let at = |axis: char| names.iter().position(|name| *name == format!("{stem}{axis}"));
            Some([x, at('y')?, at('z')?])
        };
        let points: Vec<(String, [usize; 3])> = match name {
            Some(_) => {
                let of = |x: &str| find(&[x, &format!("{x}_coord")]);
                vec![(String::new(), [of("x")?, of("y")?, of("z")?])]
            }
            None => names
                .iter()
                .enumerate()
                .filter_map(|(x, name)| {
                    let stem = name.strip_suffix('x').filter(|stem| stem.len() > 1)?;
                    let plain = header.get(x)?.get(..stem.len())?.trim_end_matches(['_', '.', ' ', '-', ':']);
                    Some((plain.to_owned(), three(stem, x)?))
                })
                .collect(),
        };
        let is_timed = frame.is_some() || time.is_some() || name.is_none();
        (is_timed && !points.is_empty()).then_some(Self { frame, time, name, points })
    }
}

/// Points of a frame by the column of their name.
type Row = (f64, Vec<Option<DVec3>>);

pub(super) fn parse(path: &Path, bytes: &[u8], frame_rate: Option<f64>) -> Result<Recording> {
    let text = text::decode(path, bytes)?;
    let mut table = ReaderBuilder::new().trim(Trim::All).from_reader(text.as_bytes());
    let line_of =
        |position: Option<&::csv::Position>| position.and_then(|at| usize::try_from(at.line()).ok());
    let syntax = |error: ::csv::Error| {
        FileProblem::syntax(TextFormat::Csv, error.to_string()).at(path, line_of(error.position()))
    };
    let header = table.headers().map_err(&syntax)?.clone();
    let columns = Columns::of(&header).ok_or_else(|| {
        let found = header.iter().take(12).collect::<Vec<_>>().join(", ");
        FileProblem::field("columns", found, EXPECTED).at(path, 1)
    })?;
    let rate = if columns.time.is_some() {
        None
    } else {
        let expected = "a column of seconds, or frames per second told beside the file (--frame-rate)";
        Some(told_rate(frame_rate, expected).map_err(|problem| problem.at(path, 1))?)
    };
    let mut names: Vec<String> = match columns.name {
        Some(_) => Vec::new(),
        None => columns.points.iter().map(|(name, _)| name.clone()).collect(),
    };
    let mut known: BTreeMap<String, usize> = BTreeMap::new();
    let mut rows: Vec<Row> = Vec::new();
    for (index, record) in table.records().enumerate() {
        let record = record.map_err(&syntax)?;
        let line = line_of(record.position());
        let number = |column: usize, field: &str| -> Result<f64> {
            let found = record.get(column).unwrap_or_default();
            let number = found.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| FileProblem::field(field, format!("{found:?}"), "a number").at(path, line))
        };
        let time = match (columns.time, columns.frame, rate) {
            (Some(time), _, _) => number(time, "time")?,
            (None, Some(frame), Some(rate)) => number(frame, "frame")? / rate,
            (None, _, rate) => index as f64 / rate.unwrap_or(1.0),
        };
        if rows.last().is_none_or(|(last, _)| *last != time) {
            rows.push((time, Vec::new()));
        }
        let Some((_, points)) = rows.last_mut() else { continue };
        for (index, (_, axes)) in columns.points.iter().enumerate() {
            let column = match columns.name.map(|name| record.get(name).unwrap_or_default()) {
                None => index,
                Some(name) => *known.entry(name.to_owned()).or_insert_with(|| {
                    names.push(name.to_owned());
                    names.len() - 1
                }),
            };
            points.resize(points.len().max(column + 1), None);
            let coordinate =
                |axis: usize| record.get(axes[axis]).and_then(|field| field.parse().ok()).unwrap_or(f64::NAN);
            points[column] = point([coordinate(0), coordinate(1), coordinate(2)]);
        }
        limited(rows.len().checked_mul(names.len())).map_err(|problem| problem.at(path, line))?;
    }
    let (times, mut points): (Vec<f64>, Vec<Vec<Option<DVec3>>>) = rows.into_iter().unzip();
    points.iter_mut().for_each(|points| points.resize(names.len(), None));
    Ok(Recording { names, times, points, angles: BTreeMap::new() })
}
