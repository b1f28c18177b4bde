//! Keypoints to compare with: measured by somebody else, or the truth of a synthetic take.

use std::collections::BTreeMap;
use std::path::Path;

use backlit_tracking::body::Model;
use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::metrics::{MarkerPlacement, ReferenceJoints};
use glam::{DVec2, DVec3};

use crate::trc::{self, Axes, limb_of_marker};
use crate::{FileError, FileProblem, Result, TextFormat, text};

/// The word for the root where a limb's name stands for its second joint.
pub const ROOT: &str = "root";
/// Coordinates above this (metres) are a mistake of units.
const MAX_COORDINATE: f64 = 1e6;

/// A joint of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// Where all chains grow from.
    Root,
    /// The second joint of the limb with this index.
    End(usize),
}

impl Joint {
    /// The joint of a name: "root", or a limb's, whose second joint is meant.
    #[must_use]
    pub fn named(model: &Model, name: &str) -> Option<Self> {
        if name == ROOT { Some(Self::Root) } else { model.limb_index(name).map(Self::End) }
    }

    /// The limb whose second joint it is; `None` for the root.
    #[must_use]
    pub fn limb(self) -> Option<usize> {
        match self {
            Self::Root => None,
            Self::End(limb) => Some(limb),
        }
    }
}

/// Positions of joints by frame; some joints may be unseen in some frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reference {
    markers: Vec<(String, Joint)>,
    frames: BTreeMap<usize, Vec<(usize, DVec3)>>,
    placement: Option<MarkerPlacement>,
}

/// How a table of keypoints is to be understood.
#[derive(Debug)]
pub(super) struct ReferenceOptions<'a> {
    pub(super) model: &'a Model,
    /// Which joint each marker shows; `None`: the marker's name is the joint's.
    pub(super) markers: Option<&'a [(String, Joint)]>,
    /// The table's number of the take's frame 0.
    pub(super) first_frame: u64,
    /// The take's frames; others are not kept.
    pub(super) frame_count: usize,
    /// Metres in one unit of the table.
    pub(super) metres_per_unit: f64,
    /// Which of the table's axes are the world's.
    pub(super) axes: Axes,
}

impl Reference {
    /// The markers and the joints that they show.
    #[must_use]
    pub fn markers(&self) -> &[(String, Joint)] {
        &self.markers
    }

    /// Where the tool that it is of puts its markers, if that is known.
    #[must_use]
    pub fn placement(&self) -> Option<&MarkerPlacement> {
        self.placement.as_ref()
    }

    /// The same reference, of a tool that puts its markers there.
    #[must_use]
    pub fn with_placement(self, placement: MarkerPlacement) -> Self {
        Self { placement: Some(placement), ..self }
    }

    /// What was seen in a frame: index of the marker in [`markers`](Self::markers), joint, position in world metres.
    pub fn frame(&self, frame: usize) -> impl Iterator<Item = (usize, Joint, DVec3)> + '_ {
        let seen = self.frames.get(&frame).map(Vec::as_slice).unwrap_or_default();
        seen.iter().map(|&(marker, position)| (marker, self.markers[marker].1, position))
    }

    /// The same for comparing with a pose, or for finding one.
    #[must_use]
    pub fn joints(&self, frame: usize) -> ReferenceJoints {
        self.frame(frame).map(|(_, joint, position)| (joint.limb(), position)).collect()
    }

    /// The number of a table's first row; 0 for a table without rows, and for CSV, whose rows may be in any order.
    pub(super) fn first_frame(path: &Path, bytes: &[u8]) -> Result<u64> {
        if !trc::is_one(bytes) {
            return Ok(0);
        }
        Ok(trc::parse(path, bytes)?.rows.first().map_or(0, |row| row.frame))
    }

    /// How many of the points lie in the pictures of cameras, counted in each.
    pub(super) fn count_seen(&self, rig: &Rig) -> usize {
        let points = self.frames.values().flatten().map(|&(_, point)| point);
        let is_seen = |camera: &Camera, point: DVec3| {
            camera.project(point).is_some_and(|pixel| {
                pixel.cmpge(DVec2::ZERO).all()
                    && pixel.x < camera.width() as f64
                    && pixel.y < camera.height() as f64
            })
        };
        points.map(|point| rig.cameras().iter().filter(|camera| is_seen(camera, point)).count()).sum()
    }

    /// Parses a TRC, whose unit is its own, or a table `frame,marker,x,y,z` (`joint` may stand for `marker`); further columns are not read.
    pub(super) fn parse(path: &Path, bytes: &[u8], options: &ReferenceOptions<'_>) -> Result<Self> {
        if trc::is_one(bytes) {
            return Self::of_trc(path, bytes, options);
        }
        let text = text::decode(path, bytes)?;
        let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let syntax = |error: &csv::Error| {
            let line = error.position().and_then(|position| usize::try_from(position.line()).ok());
            FileProblem::syntax(TextFormat::Csv, error.to_string()).at(path, line)
        };
        let header = table.headers().map_err(|error| syntax(&error))?.clone();
        let columns = Columns::new(path, &header)?;
        let markers = options.markers.unwrap_or_default().to_vec();
        let mut reference = Self { markers, ..Self::default() };
        let mut seen = vec![false; reference.markers.len()];
        for record in table.records() {
            let record = record.map_err(|error| syntax(&error))?;
            let line = record.position().and_then(|position| usize::try_from(position.line()).ok());
            let row = TableRow { path, line, record: &record, columns: &columns };
            let name = record.get(columns.marker).unwrap_or_default();
            let Some(marker) = reference.marker(&row, name, options)? else { continue };
            if let Some(seen) = seen.get_mut(marker) {
                *seen = true;
            }
            reference.insert(&row, marker, options)?;
        }
        match seen.iter().position(|seen| !seen) {
            Some(unseen) => Err(reference.never_seen(path, unseen)),
            None => Ok(reference),
        }
    }

    fn never_seen(&self, path: &Path, marker: usize) -> FileError {
        let found = format!("never \"{}\"", self.markers[marker].0);
        FileProblem::field("marker", found, "every marker that the take maps to a joint").at(path, None)
    }

    /// Without a map of markers, those count that other tools give a joint of the model.
    fn of_trc(path: &Path, bytes: &[u8], options: &ReferenceOptions<'_>) -> Result<Self> {
        let table = trc::parse(path, bytes)?;
        let markers = options.markers.map_or_else(
            || {
                let joint = |marker: &String| {
                    Some((marker.clone(), Joint::named(options.model, &limb_of_marker(marker)?)?))
                };
                table.markers.iter().filter_map(joint).collect()
            },
            <[_]>::to_vec,
        );
        let mut reference = Self { markers, ..Self::default() };
        let column = |marker: &str| table.markers.iter().position(|name| name == marker);
        let columns: Vec<Option<usize>> =
            reference.markers.iter().map(|(marker, _)| column(marker)).collect();
        if let Some(unseen) = columns.iter().position(Option::is_none) {
            return Err(reference.never_seen(path, unseen));
        }
        for row in &table.rows {
            let frame =
                row.frame.checked_sub(options.first_frame).and_then(|frame| usize::try_from(frame).ok());
            let Some(frame) = frame.filter(|&frame| frame < options.frame_count) else { continue };
            let seen = columns.iter().enumerate().filter_map(|(marker, column)| {
                row.points.get((*column)?).copied().flatten().map(|point| (marker, options.axes.world(point)))
            });
            reference.frames.insert(frame, seen.collect());
        }
        Ok(reference)
    }

    /// Index of a row's marker; `None` for one that shows no joint.
    fn marker(
        &mut self,
        row: &TableRow<'_>,
        name: &str,
        options: &ReferenceOptions<'_>,
    ) -> Result<Option<usize>> {
        let known = self.markers.iter().position(|(marker, _)| marker == name);
        if known.is_some() || options.markers.is_some() {
            return Ok(known);
        }
        let joint = Joint::named(options.model, name).ok_or_else(|| {
            row.problem(FileProblem::UnknownLimb { field: "marker".to_owned(), limb: name.to_owned() })
        })?;
        self.markers.push((name.to_owned(), joint));
        Ok(Some(self.markers.len() - 1))
    }

    fn insert(&mut self, row: &TableRow<'_>, marker: usize, options: &ReferenceOptions<'_>) -> Result<()> {
        let number: u64 = row.parse("frame", row.columns.frame, "a whole number, 0 or above")?;
        let mut position = DVec3::ZERO;
        for (axis, field) in ["x", "y", "z"].into_iter().enumerate() {
            let expected = "a finite number";
            let value: f64 = row.parse(field, row.columns.position[axis], expected)?;
            position[axis] = value * options.metres_per_unit;
            if !position[axis].is_finite() || position[axis].abs() > MAX_COORDINATE {
                return Err(row.field(field, row.columns.position[axis], expected));
            }
        }
        let frame = number.checked_sub(options.first_frame).and_then(|frame| usize::try_from(frame).ok());
        let Some(frame) = frame.filter(|&frame| frame < options.frame_count) else { return Ok(()) };
        let seen = self.frames.entry(frame).or_default();
        if seen.iter().any(|&(other, _)| other == marker) {
            let field = format!("frame {number}, marker {}", self.markers[marker].0);
            return Err(row.problem(FileProblem::Duplicate { field }));
        }
        seen.push((marker, options.axes.world(position)));
        Ok(())
    }
}

/// Where the columns are.
struct Columns {
    frame: usize,
    marker: usize,
    position: [usize; 3],
}

impl Columns {
    fn new(path: &Path, header: &csv::StringRecord) -> Result<Self> {
        let find = |names: &[&str]| {
            header.iter().position(|column| names.contains(&column)).ok_or_else(|| {
                let expected = "the columns frame,marker,x,y,z";
                FileProblem::field(names.join("` or `"), "missing from the header", expected).at(path, 1)
            })
        };
        Ok(Self {
            frame: find(&["frame"])?,
            marker: find(&["marker", "joint"])?,
            position: [find(&["x"])?, find(&["y"])?, find(&["z"])?],
        })
    }
}

struct TableRow<'a> {
    path: &'a Path,
    line: Option<usize>,
    columns: &'a Columns,
    record: &'a csv::StringRecord,
}

impl TableRow<'_> {
    fn parse<T: std::str::FromStr>(&self, field: &str, column: usize, expected: &str) -> Result<T> {
        let text = self.record.get(column).unwrap_or_default();
        text.parse().ok().ok_or_else(|| self.field(field, column, expected))
    }

    fn field(&self, field: &str, column: usize, expected: &str) -> FileError {
        let found = format!("{:?}", self.record.get(column).unwrap_or_default());
        self.problem(FileProblem::field(field, found, expected))
    }

    fn problem(&self, problem: FileProblem) -> FileError {
        FileError::new(self.path, problem).at_line(self.line)
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;
    use crate::damaged::assert_refused;

    fn parse(text: &str, markers: Option<&[(String, Joint)]>) -> Result<Reference> {
        let options = ReferenceOptions {
            model: &builtin::upper_body(),
            markers,
            first_frame: 5,
            frame_count: 3,
            metres_per_unit: 0.001,
            axes: Axes::default(),
        };
        Reference::parse(Path::new("k.csv"), text.as_bytes(), &options)
    }

    #[test]
    fn markers_show_joints_and_frames_count_from_the_first() {
        let map = [("RWrist".to_owned(), Joint::End(3)), ("Hip".to_owned(), Joint::Root)];
        let text = "frame,marker,x,y,z,seen\n5,RWrist,1000,2000,-3000,1\n5,Nose,0,0,0,1\n7,Hip,1,2,3,1\n8,Hip,1,2,3,1\n4,Hip,0,0,0,1\n";
        let reference = parse(text, Some(&map)).unwrap();
        let seen: Vec<_> = reference.frame(0).collect();
        assert_eq!(seen, [(0, Joint::End(3), DVec3::new(1.0, 2.0, -3.0))]);
        assert_eq!(reference.joints(0), [(Some(3), DVec3::new(1.0, 2.0, -3.0))]);
        assert_eq!(reference.joints(2), [(None, DVec3::new(0.001, 0.002, 0.003))]);
        assert_eq!(reference.frame(1).count(), 0);
        assert_eq!(reference.frame(2).next().unwrap().1, Joint::Root);
        assert_eq!(reference.frame(3).count(), 0);
    }

    #[test]
    fn without_a_map_names_are_joints() {
        let reference = parse("frame,joint,x,y,z\n5,head,0,0,1\n5,root,0,0,0\n", None).unwrap();
        assert_eq!(
            reference.markers(),
            [("head".to_owned(), Joint::End(7)), ("root".to_owned(), Joint::Root)]
        );
    }

    #[test]
    fn errors_name_line_and_field() {
        assert_refused(
            "frame,marker,x,y,z\n5,head,0,0,1\n5,head,0,0,2\n",
            |text| parse(text, None),
            r#"
            marker, ⇒ ⇒ k.csv, line 1: `marker` or `joint` is missing from the header
            0,2 ⇒ a,1 ⇒ line 3: `y` is "a"; expected a finite
            0,0,1 ⇒ 0,0,NaN ⇒ line 2: `z` is "NaN"; expected a finite
            5,head ⇒ -5,head ⇒ line 2: `frame` is "-5"
            head ⇒ tail ⇒ line 2: `marker` names "tail", and the model has no limb
            0,0,2 ⇒ 0,0,1 ⇒ line 3: `frame 5, marker head` is given twice
            0,0,1 ⇒ 0,0 ⇒ is not valid CSV
            \n ⇒ `frame` is missing
            "#,
        );
        let map = [("RWrist".to_owned(), Joint::End(3))];
        let message = parse("frame,marker,x,y,z\n5,LWrist,0,0,1\n", Some(&map)).unwrap_err().to_string();
        assert!(message.contains("`marker` is never \"RWrist\""), "{message}");
    }
}
