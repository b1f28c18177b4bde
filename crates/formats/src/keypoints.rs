//! Two-dimensional keypoints of other tools: `OpenPose`'s JSON, a file a frame, which `Pose2Sim` and `MMPose` write too.

use std::path::{Path, PathBuf};

use backlit_tracking::silhouette::{Label, MAX_PIXELS, Mask};
use glam::DVec2;
use serde::Deserialize;

use super::{DiskFiles, FileError, FileProblem, MAX_TEXT_BYTES, TakeFiles, json_text, text};

/// Keypoints with a lower score are not believed to be anywhere.
const LOWEST_SCORE: f64 = 0.1;
/// A person of fewer keypoints than this covers nothing and is not believed.
const FEWEST: usize = 5;
/// How far a body reaches beyond its keypoints, as a share of the person's extent in the picture: a hand beyond its wrist.
const REACH: f64 = 0.1;
/// To how many of its nearest neighbours a keypoint is joined.
const NEIGHBOURS: usize = 3;

/// One keypoint: its place in pixels, with pixel centres at integers, and how sure the tool is, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keypoint {
    /// Pixels.
    pub place: DVec2,
    /// 0 to 1.
    pub score: f64,
}

/// The keypoints of one person in one picture, in the tool's own order; `None` for one that was not found.
pub type Person = Vec<Option<Keypoint>>;

#[derive(Deserialize)]
struct Frame {
    people: Vec<PersonSpec>,
}

#[derive(Deserialize)]
struct PersonSpec {
    pose_keypoints_2d: Vec<f64>,
}

/// Parses a file of one frame: x, y and score of each keypoint; a zero stands for one that was not found.
///
/// # Errors
/// Not JSON, no `people`, or numbers that do not come in threes. The error names the line or the field.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<Person>, FileError> {
    let frame: Frame = json_text::parse(path, text::decode(path, bytes)?)?;
    let person = |(index, person): (usize, PersonSpec)| {
        let (triples, rest) = person.pose_keypoints_2d.as_chunks::<3>();
        if rest.is_empty() && triples.iter().flatten().all(|number| number.is_finite()) {
            return Ok(triples.iter().map(keypoint).collect());
        }
        let field = format!("people[{index}].pose_keypoints_2d");
        let found = format!("{} numbers", person.pose_keypoints_2d.len());
        let expected = "x, y and score of each keypoint".to_owned();
        Err(FileError::new(path, FileProblem::Field { field, found, expected }))
    };
    frame.people.into_iter().enumerate().map(person).collect()
}

fn keypoint(&[x, y, score]: &[f64; 3]) -> Option<Keypoint> {
    // Some tools leave only one coordinate at zero: no keypoint lies just there.
    let is_missing = x == 0.0 || y == 0.0;
    (!is_missing).then_some(Keypoint { place: DVec2::new(x, y), score })
}

/// Reads a file of the disk.
///
/// # Errors
/// No such file, or as [`parse`].
pub fn read(path: &Path) -> Result<Vec<Person>, FileError> {
    parse(path, &DiskFiles.read(path, MAX_TEXT_BYTES)?)
}

/// The files of a folder by the number of their frame: the last one in their name, as in `cam01.0007.json` and
/// `cam01_000000000007_keypoints.json`. In order; files without a number are left out.
///
/// # Errors
/// The folder cannot be read.
pub fn files_of(folder: &Path) -> Result<Vec<(u64, PathBuf)>, FileError> {
    let failed = |error| FileError::new(folder, FileProblem::Read { error });
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
            && let Some(number) = last_number(&path)
        {
            found.push((number, path));
        }
    }
    found.sort();
    Ok(found)
}

fn last_number(path: &Path) -> Option<u64> {
    let stem = path.file_stem()?.to_str()?;
    let digits = |letter: char| letter.is_ascii_digit();
    stem.rsplit(|letter: char| !digits(letter)).find(|number| !number.is_empty())?.parse().ok()
}

/// Where the people of a picture may be, generously: strokes between neighbouring keypoints, a tenth of the person's extent
/// wide on either side, whatever the order of the keypoints. `None` where nobody is found, or the picture has too many
/// pixels: then nobody knows.
#[must_use]
pub fn generous_mask(people: &[Person], [width, height]: [usize; 2]) -> Option<Mask> {
    let people: Vec<Vec<DVec2>> = people
        .iter()
        .map(|person| {
            let sure = person.iter().flatten().filter(|keypoint| keypoint.score >= LOWEST_SCORE);
            sure.map(|keypoint| keypoint.place).collect()
        })
        .filter(|places: &Vec<DVec2>| places.len() >= FEWEST)
        .collect();
    if people.is_empty() || width.checked_mul(height).is_none_or(|pixels| pixels > MAX_PIXELS) {
        return None;
    }
    let mut mask = Mask::filled(width, height, Label::Background).ok()?;
    for places in &people {
        let radius = REACH * extent(places);
        for (from, to) in joined(places) {
            stroke(mask.labels_mut(), [width, height], from, to, radius);
        }
    }
    Some(mask)
}

/// The longer side of the box around all people's keypoints of the largest person, pixels; `None` where nobody is found.
#[must_use]
pub fn largest_extent(people: &[Person]) -> Option<f64> {
    let extents = people.iter().filter_map(|person| {
        let sure = person.iter().flatten().filter(|keypoint| keypoint.score >= LOWEST_SCORE);
        let places: Vec<DVec2> = sure.map(|keypoint| keypoint.place).collect();
        (places.len() >= FEWEST).then(|| extent(&places))
    });
    extents.max_by(f64::total_cmp)
}

fn extent(places: &[DVec2]) -> f64 {
    let low = places.iter().fold(DVec2::INFINITY, |low, place| low.min(*place));
    let high = places.iter().fold(DVec2::NEG_INFINITY, |high, place| high.max(*place));
    (high - low).max_element()
}

/// Each place with its nearest neighbours, and with those of the shortest tree that reaches all.
fn joined(places: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let mut edges = Vec::new();
    for (index, &place) in places.iter().enumerate() {
        let mut others: Vec<DVec2> = places.to_vec();
        others.swap_remove(index);
        others.sort_by(|a, b| place.distance_squared(*a).total_cmp(&place.distance_squared(*b)));
        edges.extend(others.into_iter().take(NEIGHBOURS).map(|other| (place, other)));
    }
    // Prim's tree: the nearest place that is not yet reached, again and again.
    let (mut reached, mut left) = (places[..1].to_vec(), places[1..].to_vec());
    while !left.is_empty() {
        let pairs = reached
            .iter()
            .flat_map(|&from| left.iter().enumerate().map(move |(to, place)| (from, to, place)));
        let nearest = pairs.min_by(|a, b| a.0.distance_squared(*a.2).total_cmp(&b.0.distance_squared(*b.2)));
        let Some((from, to, _)) = nearest else { break };
        let place = left.swap_remove(to);
        reached.push(place);
        edges.push((from, place));
    }
    edges
}

/// Paints the pixels that are at most `radius` from the line between two places.
fn stroke(labels: &mut [Label], [width, height]: [usize; 2], from: DVec2, to: DVec2, radius: f64) {
    let low = (from.min(to) - radius).floor().max(DVec2::ZERO);
    let high = (from.max(to) + radius).ceil().min(DVec2::new(width as f64 - 1.0, height as f64 - 1.0));
    let along = to - from;
    let scale = 1.0 / along.length_squared().max(1e-12);
    for y in low.y as usize..=high.y.max(-1.0) as i64 as usize {
        if y >= height {
            break;
        }
        for x in low.x as usize..width.min(high.x.max(-1.0) as i64 as usize + 1) {
            let place = DVec2::new(x as f64, y as f64);
            let share = ((place - from).dot(along) * scale).clamp(0.0, 1.0);
            if place.distance_squared(from + share * along) <= radius * radius {
                labels[y * width + x] = Label::Subject;
            }
        }
    }
}
