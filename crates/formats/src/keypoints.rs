//! Two-dimensional keypoints of other tools: `OpenPose`'s JSON, a file a frame, which `Pose2Sim` and `MMPose` write too.

pub mod joints;

use std::path::{Path, PathBuf};

use backlit_tracking::silhouette::{Label, MAX_PIXELS, Mask};
use glam::DVec2;
use serde::Deserialize;

use self::joints::KeypointOrder;
use super::take::{FramePattern, split_number};
use super::{DiskFiles, FileError, FileProblem, MAX_TEXT_BYTES, Result, TakeFiles, json_text, text};

/// Keypoints with a lower score are not believed to be anywhere.
const LOWEST_SCORE: f64 = 0.1;
/// A person of fewer keypoints than this covers nothing and is not believed.
const FEWEST: usize = 5;
/// More than any tool finds on a person, face and hands included.
const MOST_KEYPOINTS: usize = 512;
/// As many as bodies have, without fingers and faces.
const BODY_KEYPOINTS: usize = 40;
/// Of more keypoints, those that are closer to one another than this share of the person's extent count once.
const CLOSE: f64 = 0.02;
/// A person of whom a smaller share of the keypoints is believed may be elsewhere too.
const WHOLE: f64 = 0.7;
/// How far a body reaches beyond the lines between its keypoints, as a share of the person's extent in the picture.
const REACH: f64 = 0.065;
/// And beyond a keypoint that is joined to one other at most: a hand beyond its wrist.
const REACH_OF_END: f64 = 0.12;
/// How far a body reaches at least beyond the lines of its tree: a forearm's radius.
const SURE_REACH: f64 = 0.02;
/// Keypoints that are nearer to one another are joined, as a share of the person's extent: a hip is further from the shoulder
/// across, which is 0.35 of a person's height, and the extent of who
/// bends is smaller than that.
const NEAR: f64 = 0.5;

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
struct OpenPoseFrame {
    people: Vec<PersonSpec>,
}

#[derive(Deserialize)]
struct PersonSpec {
    /// Left out of a person who is not in the picture.
    #[serde(default)]
    pose_keypoints_2d: Vec<f64>,
}

/// One frame's people as [`parse`] reads them.
#[must_use]
pub fn to_text(people: &[Person]) -> String {
    let numbers = |keypoint: &Option<Keypoint>| {
        keypoint.map_or([0.0; 3], |keypoint| [keypoint.place.x, keypoint.place.y, keypoint.score])
    };
    let person = |person: &Person| {
        let numbers: Vec<f64> = person.iter().flat_map(numbers).collect();
        serde_json::json!({ "pose_keypoints_2d": numbers })
    };
    serde_json::json!({ "people": people.iter().map(person).collect::<Vec<_>>() }).to_string()
}

/// Parses a file of one frame: x, y and score of each keypoint; a zero stands for one that was not found.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<Person>> {
    let frame: OpenPoseFrame = json_text::parse(path, text::decode(path, bytes)?)?;
    let person = |(index, person): (usize, PersonSpec)| {
        let (triples, rest) = person.pose_keypoints_2d.as_chunks::<3>();
        let is_whole = rest.is_empty() && triples.len() <= MOST_KEYPOINTS;
        if is_whole && triples.iter().flatten().all(|number| number.is_finite()) {
            return Ok(triples.iter().map(keypoint).collect());
        }
        let field = format!("people[{index}].pose_keypoints_2d");
        let found = format!("{} numbers", person.pose_keypoints_2d.len());
        let expected = format!("x, y and score of each keypoint, of {MOST_KEYPOINTS} at most");
        Err(FileProblem::field(field, found, expected).at(path, None))
    };
    frame.people.into_iter().enumerate().map(person).collect()
}

fn keypoint(&[x, y, score]: &[f64; 3]) -> Option<Keypoint> {
    // Some tools leave only one coordinate at zero: no keypoint lies just there.
    let is_missing = x == 0.0 || y == 0.0;
    (!is_missing).then_some(Keypoint { place: DVec2::new(x, y), score })
}

/// Reads a file of the disk.
pub fn read(path: &Path) -> Result<Vec<Person>> {
    parse(path, &DiskFiles.read(path, MAX_TEXT_BYTES)?)
}

/// The files of a folder by the number of their frame: the last one in their name, as in `cam01.0007.json` and
/// `cam01_000000000007_keypoints.json`. In order; files without a number are left out.
pub fn files_of(folder: &Path) -> Result<Vec<(u64, PathBuf)>> {
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

/// The names of a folder's files with `%03d`, or as many digits as they have, in the place of the number, and the first
/// number. `None` for a folder without such files, or where names differ otherwise.
pub fn pattern_of(folder: &Path) -> Result<Option<(String, u64)>> {
    let files = files_of(folder)?;
    let Some((first, path)) = files.first() else { return Ok(None) };
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Ok(None) };
    let Some((before, digits, after)) = split_number(name) else { return Ok(None) };
    let number = if digits.len() > 1 { format!("%0{}d", digits.len()) } else { "%d".to_owned() };
    let pattern = format!("{}{number}{}", before.replace('%', "%%"), after.replace('%', "%%"));
    let fits = FramePattern::new(&pattern)
        .is_ok_and(|pattern| files.iter().all(|(number, path)| pattern.path(folder, *number) == *path));
    Ok(fits.then_some((pattern, *first)))
}

fn last_number(path: &Path) -> Option<u64> {
    split_number(path.file_name()?.to_str()?)?.1.parse().ok()
}

/// Where the people of a picture may be, generously: strokes between keypoints that are near to one another, 6.5 % of the
/// person's extent wide on either side and 12 % about hands and other ends, whatever the order of the keypoints. `size` is that of the picture, width first, which is
/// [reduced](crate::images::reduced) by `divisor`. `None` where nobody is found, the tallest person not whole, or the picture
/// has too many pixels: then the mask is unknown.
#[must_use]
pub fn generous_mask(people: &[Person], size: [usize; 2], divisor: usize) -> Option<Mask> {
    let is_believed = |keypoint: &&Keypoint| keypoint.score >= LOWEST_SCORE;
    let share = |person: &Person| {
        person.iter().flatten().filter(is_believed).count() as f64 / person.len().max(1) as f64
    };
    if tallest(people).is_none_or(|person| share(person) < WHOLE) {
        return None;
    }
    let people = places_of(people, divisor, FEWEST);
    let mut mask = mask_for(&people, size, divisor)?;
    let size = [mask.width(), mask.height()];
    for places in &people {
        let (extent, edges, tree) = (extent(places), near(places), tree(places));
        let mut paint = |from, to, reach: f64| stroke(mask.labels_mut(), size, from, to, reach * extent);
        edges.iter().chain(&tree).for_each(|&(from, to)| paint(from, to, REACH));
        for &place in places {
            if tree.iter().filter(|(from, to)| *from == place || *to == place).count() < 2 {
                paint(place, place, REACH_OF_END);
            }
        }
    }
    Some(mask)
}

/// Where a person surely is: narrow strokes along the shortest tree of each person's keypoints. Otherwise as
/// [`generous_mask`].
#[must_use]
pub fn sure_mask(people: &[Person], size: [usize; 2], divisor: usize) -> Option<Mask> {
    let people = places_of(people, divisor, FEWEST);
    let mut mask = mask_for(&people, size, divisor)?;
    let size = [mask.width(), mask.height()];
    for places in &people {
        let radius = SURE_REACH * extent(places);
        tree(places).into_iter().for_each(|(from, to)| stroke(mask.labels_mut(), size, from, to, radius));
    }
    Some(mask)
}

/// A silhouette as far as keypoints tell: the tallest person covers the narrow strokes of [`sure_mask`] and the trunk between
/// shoulders and hips, nobody covers what lies outside of the [`generous_mask`], and the rest is unknown. `None` where nobody
/// is found. Without an `order` the shoulders and hips are unknown.
#[must_use]
pub fn coarse_mask(
    people: &[Person],
    order: Option<KeypointOrder>,
    size: [usize; 2],
    divisor: usize,
) -> Option<Mask> {
    let mut mask = generous_mask(people, size, divisor)?;
    let tallest = tallest(people)?;
    let sure = sure_mask(std::slice::from_ref(tallest), size, divisor)?;
    let trunk = order.and_then(|order| trunk_of(tallest, order, divisor));
    let width = mask.width();
    for (index, (label, sure)) in mask.labels_mut().iter_mut().zip(sure.labels()).enumerate() {
        let place = DVec2::new((index % width) as f64, (index / width) as f64);
        let is_trunk = || trunk.is_some_and(|corners| is_within(place, corners));
        match label {
            Label::Subject if *sure == Label::Subject || is_trunk() => {}
            Label::Subject => *label = Label::Unknown,
            Label::Background | Label::Unknown => {}
        }
    }
    Some(mask)
}

/// The corners of a person's trunk, shoulders and hips, in a picture that is reduced.
fn trunk_of(person: &Person, order: KeypointOrder, divisor: usize) -> Option<[DVec2; 4]> {
    let corners = order.trunk().map(|corner| person.get(corner).copied().flatten());
    let places = places_of(&[corners.to_vec()], divisor, corners.len());
    places.first().and_then(|places| <[DVec2; 4]>::try_from(places.as_slice()).ok())
}

/// Whether a place is within four corners, in whatever order: within a triangle of three of them.
fn is_within(place: DVec2, corners: [DVec2; 4]) -> bool {
    (0..4).any(|left_out| {
        let side = |k: usize| {
            let [a, b] = [k, k + 1].map(|k| corners[(left_out + 1 + k % 3) % 4]);
            (b - a).perp_dot(place - a)
        };
        let sides = [0, 1, 2].map(side);
        sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
    })
}

/// The sure keypoints of each person with at least `fewest` of them, in a picture that is reduced.
fn places_of(people: &[Person], divisor: usize, fewest: usize) -> Vec<Vec<DVec2>> {
    let scale = 1.0 / divisor.max(1) as f64;
    let places = people.iter().map(|person| {
        let sure = person.iter().flatten().filter(|keypoint| keypoint.score >= LOWEST_SCORE);
        sure.map(|keypoint| (keypoint.place + 0.5) * scale - 0.5).collect::<Vec<DVec2>>()
    });
    places.filter(|places| places.len() >= fewest).map(thinned).collect()
}

/// Without those that are close to another, where there are more than bodies have: faces and hands.
fn thinned(places: Vec<DVec2>) -> Vec<DVec2> {
    if places.len() <= BODY_KEYPOINTS {
        return places;
    }
    let close = CLOSE * extent(&places);
    let mut kept: Vec<DVec2> = Vec::new();
    for place in places {
        if kept.iter().all(|other| other.distance(place) >= close) {
            kept.push(place);
        }
    }
    kept
}

/// An empty mask of the reduced picture; `None` without people, or where it would be too large.
fn mask_for(people: &[Vec<DVec2>], size: [usize; 2], divisor: usize) -> Option<Mask> {
    let [width, height] = size.map(|side| side / divisor.max(1));
    let is_small = width.checked_mul(height).is_some_and(|pixels| pixels <= MAX_PIXELS);
    if people.is_empty() || !is_small { None } else { Mask::filled(width, height, Label::Background).ok() }
}

/// The tallest of some people in a picture, of whom something is believed.
#[must_use]
pub fn tallest(people: &[Person]) -> Option<&Person> {
    let height = |person: &&Person| largest_extent(std::slice::from_ref(*person)).unwrap_or(0.0);
    people.iter().max_by(|a, b| height(a).total_cmp(&height(b)))
}

/// The longer side of the box around a person's keypoints, pixels, of the largest person; `None` where nobody is found.
#[must_use]
pub fn largest_extent(people: &[Person]) -> Option<f64> {
    places_of(people, 1, FEWEST).iter().map(|places| extent(places)).max_by(f64::total_cmp)
}

fn extent(places: &[DVec2]) -> f64 {
    let low = places.iter().fold(DVec2::INFINITY, |low, place| low.min(*place));
    let high = places.iter().fold(DVec2::NEG_INFINITY, |high, place| high.max(*place));
    (high - low).max_element()
}

/// All places that are near to one another, two by two.
fn near(places: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let near = NEAR * extent(places);
    let pairs = places
        .iter()
        .enumerate()
        .flat_map(|(index, &place)| places[..index].iter().map(move |&other| (place, other)));
    pairs.filter(|(place, other)| place.distance(*other) < near).collect()
}

/// The shortest tree that reaches all places (Prim): the nearest one that is not yet reached, again and again.
fn tree(places: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let Some((&first, rest)) = places.split_first() else { return Vec::new() };
    // Each place that is left, with the nearest one that is reached.
    let mut left: Vec<(DVec2, DVec2)> = rest.iter().map(|&place| (first, place)).collect();
    let mut edges = Vec::with_capacity(left.len());
    let length = |(from, to): &(DVec2, DVec2)| from.distance_squared(*to);
    while let Some(nearest) = (0..left.len()).min_by(|&a, &b| length(&left[a]).total_cmp(&length(&left[b]))) {
        let edge = left.swap_remove(nearest);
        for (from, place) in &mut left {
            if edge.1.distance_squared(*place) < from.distance_squared(*place) {
                *from = edge.1;
            }
        }
        edges.push(edge);
    }
    edges
}

/// Paints the pixels that are at most `radius` from the line between two places.
fn stroke(labels: &mut [Label], [width, height]: [usize; 2], from: DVec2, to: DVec2, radius: f64) {
    let low = (from.min(to) - radius).floor().max(DVec2::ZERO);
    let high = (from.max(to) + radius).ceil().min(DVec2::new(width as f64 - 1.0, height as f64 - 1.0));
    let along = to - from;
    let scale = 1.0 / along.length_squared().max(1e-12);
    // A cast to a whole number ends at zero: nothing is painted where the stroke lies outside.
    let [past_x, past_y] = [((high.x + 1.0) as usize).min(width), ((high.y + 1.0) as usize).min(height)];
    for y in low.y as usize..past_y {
        for x in low.x as usize..past_x {
            let place = DVec2::new(x as f64, y as f64);
            let share = ((place - from).dot(along) * scale).clamp(0.0, 1.0);
            if place.distance_squared(from + share * along) <= radius * radius {
                labels[y * width + x] = Label::Subject;
            }
        }
    }
}
