//! MOT and STO, tables of coordinates of `OpenSim`: `name=value` lines up to `endheader`, then a row of names, then numbers;
//! separated by blanks or commas.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Recording, limited};
use crate::{FileProblem, Result, text};

/// Columns that have metres, by how their names end.
const LENGTHS: [&str; 4] = ["_tx", "_ty", "_tz", "_beta"];

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Recording> {
    let text = text::decode(path, bytes)?;
    let bad = |line: usize, field: &str, found: &str, expected: &str| {
        FileProblem::field(field, format!("{found:?}"), expected).at(path, line)
    };
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line));
    let mut in_degrees = false;
    loop {
        let Some((_, line)) = lines.next() else {
            return Err(bad(text.lines().count(), "header", "no end", "a line endheader before the table"));
        };
        let line = line.trim().trim_end_matches(',').trim_end();
        if line.eq_ignore_ascii_case("endheader") {
            break;
        }
        if let Some((name, value)) = line.split_once('=')
            && name.trim().eq_ignore_ascii_case("inDegrees")
        {
            in_degrees = value.trim().eq_ignore_ascii_case("yes");
        }
    }
    let mut rows =
        lines.map(|(number, line)| (number, fields(line))).filter(|(_, fields)| !fields.is_empty());
    let (names_at, names) = rows.next().unwrap_or_default();
    if names.first().is_none_or(|name| !name.eq_ignore_ascii_case("time")) || names.len() < 2 {
        return Err(bad(names_at, "names", &names.join(" "), "time and the names of coordinates"));
    }
    let mut times = Vec::new();
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len() - 1];
    for (number, fields) in rows {
        if fields.len() != names.len() {
            let expected = format!("{} numbers, one a name", names.len());
            return Err(FileProblem::field("row", fields.len().to_string(), expected).at(path, number));
        }
        let value = |field: &str| {
            field
                .parse()
                .ok()
                .filter(|value: &f64| value.is_finite())
                .ok_or_else(|| bad(number, "row", field, "a number"))
        };
        times.push(value(fields[0])?);
        for (column, field) in columns.iter_mut().zip(&fields[1..]) {
            column.push(value(field)?);
        }
        limited(Some(times.len() * names.len())).map_err(|problem| problem.at(path, number))?;
    }
    let factor = if in_degrees { 1_f64.to_radians() } else { 1.0 };
    let angles =
        names[1..].iter().zip(columns).filter(|(name, _)| !LENGTHS.iter().any(|end| name.ends_with(end)));
    let angles: BTreeMap<String, Vec<f64>> = angles
        .map(|(name, column)| ((*name).to_owned(), column.into_iter().map(|value| factor * value).collect()))
        .collect();
    let points = vec![Vec::new(); times.len()];
    Ok(Recording { names: Vec::new(), times, points, angles })
}

fn fields(line: &str) -> Vec<&str> {
    line.split(|letter: char| letter == ',' || letter.is_whitespace())
        .filter(|field| !field.is_empty())
        .collect()
}
