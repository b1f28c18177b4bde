//! TRC, tables of markers of `OpenSim`, `Pose2Sim`, `OpenCap` and Caliscope, as their tools write them and as spreadsheets
//! save them again: separated by tabs or commas, with empty fields where a marker was not seen.

use std::path::Path;

use glam::DVec3;

use super::{FileProblem, Result, text};

/// Coordinates beyond this, metres, are a mistake of units.
const MAX_COORDINATE: f64 = 1e6;
/// Most markers of one table.
const MAX_MARKERS: usize = 10_000;

/// Positions of markers by frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MarkerTable {
    /// The markers' names, in the order of the columns.
    pub markers: Vec<String>,
    /// Frames a second, where the file says it.
    pub rate: Option<f64>,
    /// The rows in order.
    pub rows: Vec<MarkerRow>,
}

/// One frame of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkerRow {
    /// The frame's number as the file has it: tools begin at 0, at 1, or where the recording began.
    pub frame: u64,
    /// Seconds, as the file has them.
    pub time: f64,
    /// By marker, metres in the file's own axes; `None` where it was not seen.
    pub points: Vec<Option<DVec3>>,
}

/// Joints as tools name their markers, and the limb of the built-in full body whose second joint each is. Heads, necks, heels
/// and toes are left out: what tools call so is no joint of the body.
const JOINTS: [(&str, &str); 6] = [
    ("shoulder", "clavicle"),
    ("elbow", "upper arm"),
    ("wrist", "forearm"),
    ("hip", "hip"),
    ("knee", "lower thigh"),
    ("ankle", "lower calf"),
];

/// The limb of the built-in full body whose second joint a marker shows: of `RShoulder` and `right_shoulder` the "right
/// clavicle". `None` for markers that show no joint.
#[must_use]
pub fn limb_of_marker(marker: &str) -> Option<String> {
    let plain: String = marker.to_lowercase().chars().filter(char::is_ascii_alphabetic).collect();
    JOINTS.iter().find_map(|(joint, limb)| {
        match plain.strip_suffix(joint).or_else(|| plain.strip_prefix(joint))? {
            "r" | "right" => Some(format!("right {limb}")),
            "l" | "left" => Some(format!("left {limb}")),
            _ => None,
        }
    })
}

/// Which of a table's axes are the world's x, y and z, each perhaps turned round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes([DVec3; 3]);

impl Axes {
    /// Of a table for `OpenSim`, whose Y is up, of a world whose Z is up: the world's x, y, z are the table's z, x, y.
    pub const Y_UP: Self = Self([DVec3::Z, DVec3::X, DVec3::Y]);

    /// Parses three letters, each with a minus or none: "zxy" says that the world's x is the table's z, and so on.
    /// `None` unless every axis is named once and the order does not mirror.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (mut rows, mut sign) = (Vec::new(), 1.0);
        for letter in text.chars() {
            let axis = match letter {
                '-' => {
                    sign = -sign;
                    continue;
                }
                'x' => DVec3::X,
                'y' => DVec3::Y,
                'z' => DVec3::Z,
                _ => return None,
            };
            rows.push(sign * axis);
            sign = 1.0;
        }
        let rows: [DVec3; 3] = rows.try_into().ok()?;
        let is_rotation = rows[0].cross(rows[1]).dot(rows[2]) == 1.0;
        (is_rotation && sign > 0.0).then_some(Self(rows))
    }

    /// A table's point in the world.
    #[must_use]
    pub fn world(self, point: DVec3) -> DVec3 {
        DVec3::from_array(self.0.map(|row| row.dot(point)))
    }
}

impl Default for Axes {
    fn default() -> Self {
        Self([DVec3::X, DVec3::Y, DVec3::Z])
    }
}

/// Whether a file is a TRC, by its first word.
pub(super) fn is_one(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).starts_with(b"PathFileType")
}

/// Parses a table. Of its numbers of frames and markers none is believed: the rows and columns that are there count.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<MarkerTable> {
    let content = text::decode(path, bytes)?;
    let mut lines = content.lines().enumerate().map(|(index, line)| (index + 1, line));
    let expected =
        "PathFileType, then names and values of the header, then Frame#, Time and the markers' names";
    let bad = |line: usize, field: &str, found: String, expected: &str| {
        FileProblem::field(field, found, expected).at(path, line)
    };
    let mut next = || lines.next().map(|(number, line)| (number, fields(line)));
    let (Some(_), Some((_, keys)), Some((at, values)), Some((names_at, names))) =
        (next(), next(), next(), next())
    else {
        return Err(bad(content.lines().count(), "header", "cut off".to_owned(), expected));
    };
    if !is_one(bytes) || names.first().is_none_or(|name| !name.starts_with("Frame")) {
        let found = names.first().map_or_else(String::new, |name| format!("{name:?}"));
        return Err(bad(names_at, "Frame#", found, expected));
    }
    let value = |key: &str| {
        let column = keys.iter().position(|name| name.eq_ignore_ascii_case(key))?;
        values.get(column).copied().filter(|value| !value.is_empty())
    };
    let metres = match value("Units") {
        None | Some("m" | "M" | "meters") => 1.0,
        Some("mm" | "MM") => 1e-3,
        Some("cm" | "CM") => 1e-2,
        Some(other) => return Err(bad(at, "Units", format!("{other:?}"), "m, cm or mm")),
    };
    let rate = value("DataRate").and_then(|rate| rate.parse::<f64>().ok());
    // A name stands over the first of its three columns.
    let markers: Vec<(usize, String)> = (2..names.len())
        .step_by(3)
        .take_while(|&column| !names[column].is_empty())
        .map(|column| (column, names[column].to_owned()))
        .collect();
    if markers.is_empty() || markers.len() > MAX_MARKERS {
        let expected = format!("1 to {MAX_MARKERS} names, one above every three columns");
        return Err(bad(names_at, "markers", format!("{} names", markers.len()), &expected));
    }
    let mut table = MarkerTable {
        markers: markers.iter().map(|(_, name)| name.clone()).collect(),
        rate: rate.filter(|rate| *rate > 0.0 && rate.is_finite()),
        rows: Vec::new(),
    };
    for (number, line) in lines {
        let row = fields(line);
        let is_head = row.first().is_none_or(|first| first.is_empty() || first.starts_with(['X', 'x']));
        if is_head {
            continue;
        }
        let parse = |column: usize, field: &str| {
            let found = row.get(column).copied().unwrap_or_default();
            let value = found.parse::<f64>().ok();
            value.ok_or_else(|| bad(number, field, format!("{found:?}"), "a number"))
        };
        let frame = parse(0, "Frame#")?;
        if !(frame >= 0.0 && frame.fract() == 0.0 && frame < 1e15) {
            return Err(bad(number, "Frame#", frame.to_string(), "a whole number, 0 or above"));
        }
        let mut points = Vec::with_capacity(markers.len());
        for (column, name) in &markers {
            let three = row.get(*column..).unwrap_or_default();
            let is_gap = three.iter().take(3).all(|field| field.is_empty());
            if is_gap {
                points.push(None);
                continue;
            }
            let point = DVec3::new(parse(*column, name)?, parse(column + 1, name)?, parse(column + 2, name)?)
                * metres;
            // Tools write NaN for a marker that was not seen.
            if point.is_finite() && point.abs().max_element() > MAX_COORDINATE {
                return Err(bad(number, name, point.to_string(), "metres: the unit must be wrong"));
            }
            points.push(point.is_finite().then_some(point));
        }
        table.rows.push(MarkerRow { frame: frame as u64, time: parse(1, "Time")?, points });
    }
    Ok(table)
}

/// The fields of a line, by tabs where there are any, else by commas.
fn fields(line: &str) -> Vec<&str> {
    let separator = if line.contains('\t') { '\t' } else { ',' };
    line.split(separator).map(str::trim).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    const TABLE: &str = "PathFileType\t4\t(X/Y/Z)\ta.trc\n\
        DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
        60\t60\t9\t2\tmm\t60\t0\t9\nFrame#\tTime\tRHip\t\t\tNeck\t\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n\
        1\t0.0\t1000\t2000\t-500\t\t\t\n2\t0.016\t1\t2\t3\tnan\tnan\tnan\n";

    fn parsed(text: &str) -> Result<MarkerTable, String> {
        parse(Path::new("a.trc"), text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn tabs_and_commas_give_the_same_rows() {
        let table = parsed(TABLE).unwrap();
        assert_eq!((table.markers.join(" ").as_str(), table.rate), ("RHip Neck", Some(60.0)));
        assert_eq!(table.rows[0].points, [Some(DVec3::new(1.0, 2.0, -0.5)), None]);
        assert_eq!((table.rows[1].frame, table.rows[1].time, table.rows[1].points[1]), (2, 0.016, None));
        assert_eq!(parsed(&TABLE.replace('\t', ",")).unwrap(), table);
    }

    #[test]
    fn what_is_wrong_is_named() {
        assert_refused(
            TABLE,
            parsed,
            r#"
            2000 ⇒ two ⇒ a.trc, line 7: `RHip` is "two"; expected a number
            mm ⇒ feet ⇒ line 3: `Units` is "feet"; expected m, cm or mm
            \n2 ⇒ \n-2 ⇒ line 8: `Frame#` is -2
            1000 ⇒ 1e300 ⇒ metres: the unit must be wrong
            RHip ⇒ ⇒ line 4: `markers` is 0 names
            PathFileType\n ⇒ a.trc, line 1: `header` is cut off
            "#,
        );
        assert!(parsed(&TABLE[..200]).unwrap_err().contains("a.trc, line "));
    }

    #[test]
    fn axes_are_turned_and_never_mirrored() {
        let point = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(Axes::parse("zxy"), Some(Axes::Y_UP));
        assert_eq!(Axes::Y_UP.world(point), DVec3::new(3.0, 1.0, 2.0));
        assert_eq!(Axes::parse("x-zy").unwrap().world(point), DVec3::new(1.0, -3.0, 2.0));
        for text in ["", "xy", "xxz", "yxz", "xyzz", "xyz-", "abc", "-xyz"] {
            assert_eq!(Axes::parse(text), None, "{text}");
        }
    }

    #[test]
    fn markers_of_several_tools_are_the_same_joints() {
        for marker in ["RShoulder", "right_shoulder", "shoulder.R"] {
            assert_eq!(limb_of_marker(marker).as_deref(), Some("right clavicle"), "{marker}");
        }
        assert_eq!(limb_of_marker("LAnkle").as_deref(), Some("left lower calf"));
        for marker in ["midHip", "Neck", "RHeel", "r_shoulder_study"] {
            assert_eq!(limb_of_marker(marker), None, "{marker}");
        }
    }
}
