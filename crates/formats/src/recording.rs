//! Recordings of motion by any tool, to compare with: places of joints or angles over time, from TRC, C3D, BVH, MOT, CSV, `NumPy`
//! arrays, and tracks of ours. The name's end says which.

mod c3d;
mod csv;
mod mot;
mod npz;

use std::collections::BTreeMap;
use std::path::Path;

use backlit_tracking::body::Model;
use backlit_tracking::metrics::{JointAngle, Trajectories};
use glam::DVec3;

use crate::motion::{self, JointTrack};
use crate::{DiskFiles, FileError, FileProblem, Result, TakeFiles, joint_names, trc};

/// Largest file that is read, bytes.
const MAX_BYTES: u64 = 1 << 30;
/// Most places, or angles, of one recording: 800 MB.
const MAX_PLACES: usize = 1 << 25;
/// Frames a second that a recording may have.
const RATES: std::ops::RangeInclusive<f64> = 0.01..=100_000.0;
/// The names' ends that are read, as they are told.
pub const ENDINGS: &str = "trc, c3d, bvh, mot, sto, csv, npz, npy or json";

/// What a file has of a motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Names of joints or markers as the file has them.
    pub names: Vec<String>,
    /// Seconds of the frames, ascending.
    pub times: Vec<f64>,
    /// By frame and name, in the file's axes, metres where the file tells its unit; `None` where it was not seen.
    pub points: Vec<Vec<Option<DVec3>>>,
    /// Angles of a file that has these, by its own names: radians.
    pub angles: BTreeMap<String, Vec<f64>>,
}

/// What is told beside a file.
#[derive(Debug, Clone, Default)]
pub struct RecordingOptions {
    /// Frames a second of a file that does not say it.
    pub frame_rate: Option<f64>,
    /// The file's name of a joint where it is none that is known: marker, then the anatomical name (`left knee`).
    pub joints: Vec<(String, String)>,
    /// The body of a track whose body is none of the built-in ones.
    pub model: Option<Model>,
}

/// The anatomical name of a joint that all tools mean alike, of `left_knee` or `Left knee`; `None` for others.
#[must_use]
pub fn anatomical_name(text: &str) -> Option<String> {
    let name = text.trim().replace(['_', '-'], " ").to_lowercase();
    let (side, joint) = name.split_once(' ')?;
    (matches!(side, "left" | "right") && joint_names::COMMON.contains(&joint)).then_some(name)
}

/// Reads a recording.
///
/// # Errors
/// Another ending than [`ENDINGS`], no such file, or one that is not as its format says. The error names the file, and the line or field.
pub fn read(path: &Path, options: &RecordingOptions) -> Result<Recording> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !ENDINGS.split([',', ' ']).any(|known| known == ending && known != "or") {
        let found = if ending.is_empty() { "none".to_owned() } else { ending };
        return Err(FileProblem::field("the name's end", found, ENDINGS).at(path, None));
    }
    if ending == "json" {
        return Ok(motion::read_joints(path, options.model.as_ref())?.into());
    }
    parse(path, &DiskFiles.read(path, MAX_BYTES)?, options)
}

/// Parses a recording that is no track; `path` tells the format, and is for the error's message.
pub fn parse(path: &Path, bytes: &[u8], options: &RecordingOptions) -> Result<Recording> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let at = |problem: FileProblem| problem.at(path, None);
    let recording = match ending.as_str() {
        "trc" => of_trc(trc::parse(path, bytes)?),
        "c3d" => c3d::parse(bytes).map_err(at)?,
        "bvh" => motion::parse_bvh(path, bytes)?.into(),
        "mot" | "sto" => mot::parse(path, bytes)?,
        "csv" => csv::parse(path, bytes, options.frame_rate)?,
        _ => npz::parse(bytes, options.frame_rate).map_err(at)?,
    };
    recording.checked(path)
}

impl Recording {
    /// The joints that tools mean alike, by their anatomical names, and the angles that have a clinician's name.
    ///
    /// # Errors
    /// None of either; the message lists names that there are.
    pub fn trajectories(&self, path: &Path, options: &RecordingOptions) -> Result<Trajectories> {
        let mut columns = joint_names::common_joints(&self.names);
        for (marker, joint) in &options.joints {
            let column = self.names.iter().position(|name| name == marker);
            let column = column.ok_or_else(|| self.without(path, marker))?;
            columns.insert(joint.clone(), column);
        }
        let of = |angle: JointAngle| {
            let curve = angle.opensim().iter().find_map(|name| self.angles.get(*name))?;
            Some((angle, curve.iter().map(|value| Some(*value)).collect()))
        };
        let angles: BTreeMap<JointAngle, Vec<Option<f64>>> =
            JointAngle::ALL.into_iter().filter_map(of).collect();
        if columns.is_empty() && angles.is_empty() {
            return Err(self
                .without(path, "a joint (left_shoulder, RElbow, LeftUpLeg …) or an angle (knee_angle_r …)"));
        }
        let order: Vec<usize> = columns.values().copied().collect();
        let pick = |points: &Vec<Option<DVec3>>| order.iter().map(|column| points[*column]).collect();
        Ok(Trajectories {
            joints: columns.into_keys().collect(),
            times: self.times.clone(),
            points: self.points.iter().map(pick).collect(),
            angles,
        })
    }

    /// The error of a name that is not there.
    fn without(&self, path: &Path, wanted: &str) -> FileError {
        let names: Vec<&str> = self.names.iter().chain(self.angles.keys()).map(String::as_str).collect();
        let more = if names.len() > 12 { format!(" and {} more", names.len() - 12) } else { String::new() };
        let found = format!("{}{more}", names[..names.len().min(12)].join(", "));
        FileProblem::field("names", found, wanted).at(path, None)
    }

    /// Refuses what no comparison can use.
    fn checked(self, path: &Path) -> Result<Self> {
        let bad = |field: &str, found: String, expected: &str| {
            Err(FileProblem::field(field, found, expected).at(path, None))
        };
        if self.times.len() < 2 {
            return bad("frames", self.times.len().to_string(), "at least 2");
        }
        if let Some(pair) = self.times.windows(2).find(|pair| !(pair[0] < pair[1] && pair[1].is_finite())) {
            return bad(
                "time",
                format!("{} after {}", pair[1], pair[0]),
                "seconds that grow from frame to frame",
            );
        }
        Ok(self)
    }
}

impl From<JointTrack> for Recording {
    fn from(track: JointTrack) -> Self {
        Self {
            times: track.frames.iter().map(|(frame, _)| *frame as f64 / track.frame_rate).collect(),
            points: track
                .frames
                .into_iter()
                .map(|(_, points)| points.into_iter().map(Some).collect())
                .collect(),
            names: track.joints,
            angles: BTreeMap::new(),
        }
    }
}

fn of_trc(table: trc::MarkerTable) -> Recording {
    Recording {
        names: table.markers,
        times: table.rows.iter().map(|row| row.time).collect(),
        points: table.rows.into_iter().map(|row| row.points).collect(),
        angles: BTreeMap::new(),
    }
}

/// A point of a file: none where a coordinate is missing, not a number, or of no world.
fn point(coordinates: [f64; 3]) -> Option<DVec3> {
    let point = DVec3::from_array(coordinates);
    (point.is_finite() && point.abs().max_element() < 1e9).then_some(point)
}

/// The frame rate that is told, or the error that it is not.
fn told_rate(told: Option<f64>, expected: &str) -> std::result::Result<f64, FileProblem> {
    let rate = told.ok_or_else(|| FileProblem::field("frame rate", "none", expected))?;
    if RATES.contains(&rate) {
        Ok(rate)
    } else {
        Err(FileProblem::field("frame rate", rate.to_string(), "frames per second, above 0"))
    }
}

/// The error of a file that tells more than fits.
fn limited(places: Option<usize>) -> std::result::Result<usize, FileProblem> {
    places.filter(|places| *places <= MAX_PLACES).ok_or_else(|| {
        let found = places.map_or_else(|| "more than can be counted".to_owned(), |places| places.to_string());
        FileProblem::field("places", found, format!("at most {MAX_PLACES}"))
    })
}

#[cfg(test)]
mod tests;
