//! One of several people: the parts of the visual hull that are people, who is where from frame to frame, and which pixels are
//! another's.
//!
//! Cubes of the [hull](crate::visual_hull) that touch are a part; parts as large as a person are people. From one frame to the next every
//! cube goes to the person who was nearest, so that people who touch stay apart. Two cameras leave crossings of sight
//! rays that look like people: three or more are needed. Lengths are metres, in world axes.

mod bodies;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use self::bodies::DrawnBody;
pub use self::bodies::KnownBody;
use crate::camera::Camera;
use crate::cancel::CancelToken;
use crate::fit::{Evidence, FitView};
use crate::numbers::{OptionError, Range, check_options};
use crate::silhouette::{Label, Mask};
use crate::visual_hull::{HullView, VisualHull};

/// No cube has a longer side, metres.
const LARGEST_CUBE_M: f64 = 10.0;
/// Fewer cameras than that cannot tell people from crossings of sight rays.
pub const FEWEST_CAMERAS: usize = 3;
/// Cubes along the longest side of the hull's box.
const CELLS: usize = 48;
/// A part is a person if its longest side is within these lengths, metres, and it has this share of the cubes of the largest.
const SIDES_M: [f64; 2] = [0.7, 3.0];
const LEAST_SHARE: f64 = 0.25;
/// A person explains this share of the places of its silhouettes that nobody else does.
const LEAST_NEW: f64 = 0.2;
/// A smaller part belongs to the person whose box is nearer than that, metres: a hand that a gap cut off.
const LOOSE_M: f64 = 0.3;
/// A person is not farther than that, metres, from where it was in the frame before.
const STEP_M: f64 = 0.6;
/// A person is there where it has this share of the cubes that people have on average.
const LEAST_THERE: f64 = 0.3;
/// Who is in fewer frames than this share of them is nobody.
const LEAST_FRAMES: f64 = 0.1;
/// So many frames from one in which somebody was seen the place is taken for the same.
const REACH: usize = 10;
/// A cube covers so many of its sides about its middle in a picture: half, the corners, and what moves with clothes.
const MARGIN: f64 = 1.2;

/// Where a person is: a box along the axes of the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 6]", into = "[f64; 6]")]
pub struct PersonBox {
    /// Its lowest corner.
    pub low: DVec3,
    /// Its highest corner.
    pub high: DVec3,
}

impl From<[f64; 6]> for PersonBox {
    fn from([a, b, c, d, e, f]: [f64; 6]) -> Self {
        Self { low: DVec3::new(a, b, c), high: DVec3::new(d, e, f) }
    }
}

impl From<PersonBox> for [f64; 6] {
    fn from(PersonBox { low, high }: PersonBox) -> Self {
        [low.x, low.y, low.z, high.x, high.y, high.z]
    }
}

impl PersonBox {
    /// The box about some points; `None` about none.
    fn about<'a>(points: impl Iterator<Item = &'a DVec3>) -> Option<Self> {
        let grow = |Self { low, high }: Self, at: &DVec3| Self { low: low.min(*at), high: high.max(*at) };
        let none = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        Some(points.fold(none, grow)).filter(|found| found.low.is_finite())
    }

    /// Its middle.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// Its eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|corner| {
            let side = |axis: usize| if corner >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] };
            DVec3::new(side(0), side(1), side(2))
        })
    }

    fn moved(&self, by: DVec3) -> Self {
        Self { low: self.low + by, high: self.high + by }
    }

    fn distance(&self, point: DVec3) -> f64 {
        point.distance(point.clamp(self.low, self.high))
    }
}

/// Where a person is in a frame: the surface of its part of the hull.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "WrittenPlace")]
pub struct PersonPlace {
    /// What it is within.
    pub bounds: PersonBox,
    /// Side of a cube, metres.
    side_m: f64,
    /// The cubes' middles, centimetres.
    cubes_cm: Vec<[i16; 3]>,
}

impl PersonPlace {
    /// `None` of no cubes.
    fn new(cubes: &[DVec3], side_m: f64) -> Option<Self> {
        let cubes_cm =
            cubes.iter().map(|at| at.to_array().map(|along| (100.0 * along).round() as i16)).collect();
        Some(Self { bounds: PersonBox::about(cubes.iter())?, side_m, cubes_cm })
    }

    fn cubes(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.cubes_cm.iter().map(|at| DVec3::from_array(at.map(|along| f64::from(along) / 100.0)))
    }
}

/// The same as a file has it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenPlace {
    bounds: PersonBox,
    side_m: f64,
    cubes_cm: Vec<[i16; 3]>,
}

impl TryFrom<WrittenPlace> for PersonPlace {
    type Error = OptionError;

    fn try_from(WrittenPlace { bounds, side_m, cubes_cm }: WrittenPlace) -> Result<Self, OptionError> {
        let side = Range(|side| side > 0.0 && side <= LARGEST_CUBE_M, "above 0 and at most 10 metres");
        let upwards =
            Range(|length| length.is_finite() && length >= 0.0, "a highest corner above the lowest");
        let lengths = (bounds.high - bounds.low).to_array().map(|length| ("bounds", length, upwards));
        check_options([("side_m", side_m, side)].into_iter().chain(lengths))?;
        Ok(Self { bounds, side_m, cubes_cm })
    }
}

/// Where a person is in the frames of a take.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PersonTrack {
    /// By frame; frames in which nothing of the person was seen are left out.
    pub places: BTreeMap<usize, PersonPlace>,
}

impl PersonTrack {
    /// Where the person is in a frame, or was seen in the nearest one. `None` far from all of these.
    #[must_use]
    pub fn at(&self, frame: usize) -> Option<&PersonPlace> {
        let (before, after) = (self.places.range(..=frame).next_back(), self.places.range(frame..).next());
        let near = before.into_iter().chain(after).filter(|(other, _)| other.abs_diff(frame) <= REACH);
        near.min_by_key(|(other, _)| other.abs_diff(frame)).map(|(_, place)| place)
    }
}

/// The people of one frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PeopleInFrame {
    /// Each as the cubes of its part of the hull, the largest first.
    pub people: Vec<Vec<DVec3>>,
    /// Side of a cube, metres.
    pub side_m: f64,
}

/// The people that silhouettes of one frame show. Nobody with fewer than [`FEWEST_CAMERAS`] silhouettes that count, or when
/// cancelled.
pub fn people_in_frame<'a>(
    views: impl IntoIterator<Item = &'a FitView>,
    cancel: &CancelToken,
) -> PeopleInFrame {
    let counted = views.into_iter().filter(|view| view.weight > 0.0);
    let views: Vec<HullView<&Camera, &Mask>> = counted
        .filter_map(|view| match &view.evidence {
            Evidence::Mask(silhouette) => Some(HullView { camera: &*view.camera, silhouette: &**silhouette }),
            Evidence::Measurement(_) => None,
        })
        .collect();
    if views.len() < FEWEST_CAMERAS {
        return PeopleInFrame::default();
    }
    let Some(hull) = VisualHull::carve(&views, CELLS, cancel) else { return PeopleInFrame::default() };
    let mut parts = parts(&hull);
    parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
    let least = LEAST_SHARE * parts.first().map_or(0.0, |part| part.len() as f64);
    let is_person = |part: &Vec<DVec3>| {
        let side = PersonBox::about(part.iter()).map_or(0.0, |found| (found.high - found.low).max_element());
        part.len() as f64 >= least && (SIDES_M[0]..=SIDES_M[1]).contains(&side)
    };
    let (people, loose): (Vec<_>, Vec<_>) = parts.into_iter().partition(is_person);
    let mut people = explaining(people, &views, hull.voxel);
    let boxes: Vec<PersonBox> = people.iter().filter_map(|part| PersonBox::about(part.iter())).collect();
    for part in loose {
        let distance =
            |found: &PersonBox| part.iter().map(|&at| found.distance(at)).fold(f64::INFINITY, f64::min);
        let nearest = boxes.iter().map(distance).zip(0..).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, person)) = nearest.filter(|(distance, _)| *distance < LOOSE_M) {
            people[person].extend(part);
        }
    }
    PeopleInFrame { people, side_m: hull.voxel }
}

/// The parts without crossings of sight rays: whoever explains most of the silhouettes first, then whoever explains most of what is
/// left. A part that explains little more than those before it is nobody.
fn explaining(parts: Vec<Vec<DVec3>>, views: &[HullView<&Camera, &Mask>], voxel: f64) -> Vec<Vec<DVec3>> {
    // A place in a silhouette is as large as the cubes that the camera sees from nearest.
    let side = |camera: &Camera| {
        let nearest = parts.iter().flatten().map(|&at| camera.depth(at)).fold(f64::INFINITY, f64::min);
        voxel * camera.intrinsics().mean_focal_px() / nearest.max(voxel)
    };
    let sides: Vec<f64> = views.iter().map(|view| side(view.camera)).collect();
    let places = |part: &Vec<DVec3>| -> BTreeSet<(usize, [i64; 2])> {
        let of_view = |(view, HullView { camera, .. }): (usize, &HullView<&Camera, &Mask>)| {
            let place = |&at: &DVec3| {
                Some((view, (camera.project(at)? / sides[view]).to_array().map(|x| x.floor() as i64)))
            };
            part.iter().filter_map(place).collect::<Vec<_>>()
        };
        views.iter().enumerate().flat_map(of_view).collect()
    };
    let explained_by: Vec<_> = parts.iter().map(places).collect();
    let mut left: Vec<_> = explained_by.into_iter().zip(parts).collect();
    let (mut people, mut explained) = (Vec::new(), BTreeSet::new());
    while !left.is_empty() {
        let fresh: Vec<usize> =
            left.iter().map(|(places, _)| places.difference(&explained).count()).collect();
        let most = (0..left.len()).rev().max_by_key(|&index| fresh[index]).unwrap_or(0);
        let (places, part) = left.remove(most);
        if (fresh[most] as f64) < LEAST_NEW * places.len() as f64 {
            break;
        }
        explained.extend(places);
        people.push(part);
    }
    people
}

/// The hull's surface, cut where its cubes do not touch.
fn parts(hull: &VisualHull) -> Vec<Vec<DVec3>> {
    let cell = |at: DVec3| ((at - hull.bounds[0]) / hull.voxel).to_array().map(|along| along.floor() as i32);
    let places: BTreeMap<[i32; 3], DVec3> =
        hull.shell.iter().map(|voxel| (cell(voxel.centre), voxel.centre)).collect();
    let mut left: BTreeSet<[i32; 3]> = places.keys().copied().collect();
    let mut parts = Vec::new();
    while let Some(first) = left.pop_first() {
        let (mut part, mut waiting) = (Vec::new(), vec![first]);
        while let Some(at) = waiting.pop() {
            part.push(places[&at]);
            for step in 0..27 {
                let beside = [at[0] + step % 3 - 1, at[1] + step / 3 % 3 - 1, at[2] + step / 9 - 1];
                if left.remove(&beside) {
                    waiting.push(beside);
                }
            }
        }
        parts.push(part);
    }
    parts
}

/// Who is who in all frames: a track a person, those who are seen longest first.
#[must_use]
pub fn link(frames: &BTreeMap<usize, PeopleInFrame>) -> Vec<PersonTrack> {
    // From the first of the frames that show the most people, forwards and backwards.
    let most = frames.values().map(|seen| seen.people.len()).max().unwrap_or(0);
    let Some((&anchor, seen)) = frames.iter().find(|(_, seen)| seen.people.len() == most && most > 0) else {
        return Vec::new();
    };
    let begun = seen.people.iter().filter_map(|part| PersonPlace::new(part, seen.side_m));
    let mut tracks: Vec<PersonTrack> =
        begun.map(|place| PersonTrack { places: BTreeMap::from([(anchor, place)]) }).collect();
    let mut backwards = tracks.clone();
    follow(&mut tracks, frames.range(anchor + 1..));
    follow(&mut backwards, frames.range(..anchor).rev());
    let earlier = backwards.split_off(most);
    for (track, before) in tracks.iter_mut().zip(backwards) {
        track.places.extend(before.places);
    }
    tracks.extend(earlier);
    let shown = frames.values().filter(|seen| !seen.people.is_empty()).count() as f64;
    tracks.retain(|track| track.places.len() as f64 >= LEAST_FRAMES * shown);
    tracks.sort_by_key(|track| std::cmp::Reverse(track.places.len()));
    tracks
}

/// Goes on with tracks through frames in their order, the nearest first. Who comes in begins a track.
fn follow<'a>(tracks: &mut Vec<PersonTrack>, frames: impl Iterator<Item = (&'a usize, &'a PeopleInFrame)>) {
    let begun = tracks.iter().filter_map(|track| track.places.values().next());
    // Where everybody was, and how far they went since the frame before that.
    let mut last: Vec<(PersonBox, DVec3)> = begun.map(|place| (place.bounds, DVec3::ZERO)).collect();
    for (&frame, PeopleInFrame { people, side_m }) in frames {
        let average = people.iter().map(Vec::len).sum::<usize>() as f64 / people.len().max(1) as f64;
        let mut cubes: Vec<Vec<DVec3>> = vec![Vec::new(); tracks.len()];
        let expected: Vec<PersonBox> = last.iter().map(|(found, step)| found.moved(*step)).collect();
        // Everybody is in the nearest part; who share one are told apart cube by cube.
        let far = |part: &Vec<DVec3>, found: &PersonBox| {
            part.iter().map(|at| at.distance(found.centre())).sum::<f64>() / part.len() as f64
        };
        let nearest = |found: &PersonBox| {
            (0..people.len()).min_by(|&a, &b| far(&people[a], found).total_cmp(&far(&people[b], found)))
        };
        let parts: Vec<Option<usize>> = expected.iter().map(nearest).collect();
        for (number, part) in people.iter().enumerate() {
            let within = |found: &PersonBox| part.iter().any(|&at| found.distance(at) < STEP_M);
            let owners: Vec<usize> = (0..expected.len())
                .filter(|&person| parts[person] == Some(number) && within(&expected[person]))
                .collect();
            for &at in part {
                let away = |person: &usize| expected[*person].centre().distance(at);
                let owner = owners.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
                owner.into_iter().for_each(|&person| cubes[person].push(at));
            }
            if owners.is_empty() && !expected.iter().any(within) {
                cubes.push(part.clone());
                tracks.push(PersonTrack::default());
                last.extend(PersonBox::about(part.iter()).map(|found| (found, DVec3::ZERO)));
            }
        }
        for ((track, (last, step)), cubes) in tracks.iter_mut().zip(&mut last).zip(cubes) {
            let is_there = cubes.len() as f64 >= LEAST_THERE * average;
            if let Some(place) = PersonPlace::new(&cubes, *side_m).filter(|_| is_there) {
                *step = 0.5 * (*step + place.bounds.centre() - last.centre());
                *last = place.bounds;
                track.places.insert(frame, place);
            }
        }
    }
}

/// The person who is followed, and the others of the take.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FollowedPerson {
    /// Who is followed.
    pub own: PersonTrack,
    /// Everybody else.
    pub others: Vec<PersonTrack>,
    /// Their bodies, where a track has found them. They are not written.
    #[serde(skip)]
    pub bodies: FoundBodies,
}

/// Bodies of who is followed and of the others, as far as they are known.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FoundBodies {
    /// Of who is followed.
    pub own: Option<KnownBody>,
    /// In the order of the others; may be empty.
    pub others: Vec<Option<KnownBody>>,
}

impl FollowedPerson {
    /// One of the people of a take, by number from 0; `None` of no such number.
    #[must_use]
    pub fn of(people: &[PersonTrack], number: usize) -> Option<Self> {
        let mut others = people.to_vec();
        let bodies = FoundBodies::default();
        (number < others.len()).then(|| Self { own: others.remove(number), others, bodies })
    }

    /// Makes subject that is, or may be, another's unknown in a camera without distortion: pixels that a known body of another
    /// explains, or that it explains better than one's own; of others whose body is not known, pixels before or behind whose
    /// surface a cube of theirs is.
    pub fn hide_others(&self, camera: &Camera, frame: usize, mask: &mut Mask) {
        let drawn = |body: &KnownBody| DrawnBody::new(body, camera, frame);
        let own = self.bodies.own.as_ref().and_then(drawn);
        let body = |other: usize| own.as_ref().and(self.bodies.others.get(other)?.as_ref()).and_then(drawn);
        let others: Vec<Option<DrawnBody>> = (0..self.others.len()).map(body).collect();
        for (other, _) in self.others.iter().zip(&others).filter(|(_, body)| body.is_none()) {
            hide_cubes(other.at(frame), camera, mask);
        }
        let known: Vec<DrawnBody> = others.into_iter().flatten().collect();
        if let Some(own) = own.filter(|_| !known.is_empty()) {
            bodies::hide(&own, &known, mask);
        }
    }
}

/// Makes subject unknown before or behind whose surface a cube of a place is.
fn hide_cubes(place: Option<&PersonPlace>, camera: &Camera, mask: &mut Mask) {
    let (width, height) = (mask.width(), mask.height());
    let labels = mask.labels_mut();
    if let Some(place) = place {
        let reach = MARGIN * place.side_m * camera.intrinsics().mean_focal_px();
        for at in place.cubes() {
            let Some(pixel) = camera.project(at) else { continue };
            let reach = reach / camera.depth(at) + 1.0;
            let ends = |at: f64, count: usize| {
                let [low, high] = [at - reach, at + reach + 1.0].map(|end| end.clamp(0.0, count as f64));
                low as usize..high as usize
            };
            let columns = ends(pixel.x, width);
            for row in ends(pixel.y, height) {
                for label in &mut labels[row * width..][columns.clone()] {
                    if *label == Label::Subject {
                        *label = Label::Unknown;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::fixtures;

    const SIZE: DVec3 = DVec3::new(0.5, 0.3, 1.7);
    const PICTURE: [usize; 2] = [320, 240];

    /// A person on the floor, as a box.
    fn standing(x: f64, y: f64) -> PersonBox {
        let foot = DVec3::new(x, y, 0.0);
        PersonBox { low: foot - 0.5 * SIZE.with_z(0.0), high: foot + SIZE * DVec3::new(0.5, 0.5, 1.0) }
    }

    fn cameras(count: usize) -> Vec<Camera> {
        let camera = |number: usize| {
            let angle = 0.4 + 1.3 * number as f64;
            let at = DVec3::new(6.0 * angle.cos(), 6.0 * angle.sin(), 2.4);
            fixtures::camera(
                PICTURE.map(|side| side as u64),
                [300.0, 300.0, 159.5, 119.5],
                at,
                DVec3::new(0.0, 0.0, 0.9),
                DVec3::Z,
            )
        };
        (0..count).map(camera).collect()
    }

    fn silhouette(camera: &Camera, people: &[PersonBox]) -> Mask {
        let is_met = |person: &PersonBox, ray: DVec3| {
            let [to_low, to_high] = [person.low, person.high].map(|corner| (corner - camera.centre()) / ray);
            to_low.min(to_high).max_element() <= to_low.max(to_high).min_element()
        };
        fixtures::covered(PICTURE, |x, y| {
            let ray = camera.ray_in_world(DVec2::new(x as f64, y as f64)).unwrap();
            people.iter().any(|person| is_met(person, ray))
        })
    }

    fn found(cameras: &[Camera], people: &[PersonBox]) -> PeopleInFrame {
        let view = |camera: &Camera| FitView::of_mask(camera.clone(), silhouette(camera, people));
        people_in_frame(&cameras.iter().map(view).collect::<Vec<_>>(), &CancelToken::new())
    }

    /// Two who walk past each other within a hand's breadth, and a third who comes in late.
    fn walk(frame: usize) -> Vec<PersonBox> {
        let t = 0.08 * frame as f64;
        let mut people = vec![standing(t - 1.2, 0.2), standing(1.2 - t, -0.2)];
        if frame >= 20 {
            people.push(standing(-0.3, 1.3));
        }
        people
    }

    #[test]
    fn people_who_pass_each_other_keep_their_names_and_who_comes_in_has_one() {
        let cameras = cameras(4);
        let frames: BTreeMap<usize, PeopleInFrame> =
            (0..30).map(|frame| (frame, found(&cameras, &walk(frame)))).collect();
        assert_eq!([&frames[&0], &frames[&29]].map(|seen| seen.people.len()), [2, 3]);
        let people = link(&frames);
        assert_eq!(people.len(), 3);
        let off = |track: &PersonTrack, frame: usize, person: usize| {
            let found = track.at(frame).unwrap().bounds.centre();
            (found - walk(frame)[person].centre()).truncate().length()
        };
        let first = usize::from(off(&people[0], 0, 0) > 1.0);
        for (track, person) in people.iter().zip([first, 1 - first]) {
            for frame in 0..30 {
                // What four cameras leave of the hull beside people makes their boxes larger.
                let off = off(track, frame, person);
                assert!(off < 0.4, "frame {frame}, person {person}: {off}");
            }
        }
        assert!(people[2].places.keys().all(|frame| *frame >= 20), "{:?}", people[2].places.keys());
    }

    #[test]
    fn pixels_of_others_are_unknown_and_ones_own_are_not() {
        let (cameras, people) = (cameras(4), [standing(-0.9, 0.1), standing(0.9, -0.2)]);
        let tracks = link(&BTreeMap::from([(7, found(&cameras, &people))]));
        let number = tracks.iter().position(|track| track.places[&7].bounds.centre().x < 0.0).unwrap();
        let followed = FollowedPerson::of(&tracks, number).unwrap();
        assert_eq!(FollowedPerson::of(&tracks, 2), None);
        let mut apart = 0;
        for camera in &cameras {
            let [own, other] = people.map(|person| silhouette(camera, &[person]));
            let mut mask = silhouette(camera, &people);
            followed.hide_others(camera, 7, &mut mask);
            let is_subject = |label: &Label| *label == Label::Subject;
            for ((label, own), other) in mask.labels().iter().zip(own.labels()).zip(other.labels()) {
                assert!(!is_subject(label) || is_subject(own), "what is subject is one's own");
                let is_either = is_subject(own) || is_subject(other);
                assert_eq!(*label == Label::Background, !is_either);
            }
            let share = mask.count(Label::Subject) as f64 / own.count(Label::Subject) as f64;
            apart += usize::from(share > 0.95);
        }
        assert!(apart >= 3, "both are apart in most views: {apart}");
    }

    #[test]
    fn a_place_that_no_hull_has_is_not_read() {
        let read = |bounds: &str, side: &str| -> Result<PersonPlace, String> {
            let text = format!(r#"{{"bounds": [{bounds}], "side_m": {side}, "cubes_cm": [[0, 0, 90]]}}"#);
            serde_json::from_str(&text).map_err(|error: serde_json::Error| error.to_string())
        };
        let good = "-1, -1, 0, 1, 1, 2";
        let place = read(good, "0.1").unwrap();
        assert_eq!(
            serde_json::from_str::<PersonPlace>(&serde_json::to_string(&place).unwrap()).unwrap(),
            place
        );
        for side in ["-1", "0", "1e300"] {
            assert!(read(good, side).unwrap_err().contains("side_m"), "{side}");
        }
        assert!(read("-1, -1, 0, 1, -2, 2", "0.1").unwrap_err().contains("bounds"));
        assert!(read("-1e308, -1, 0, 1e308, 1, 2", "0.1").unwrap_err().contains("bounds"));
    }

    #[test]
    fn two_cameras_tell_nobody_apart() {
        let people = [standing(-0.9, 0.1), standing(0.9, -0.2)];
        assert_eq!(found(&cameras(2), &people), PeopleInFrame::default());
        assert!(link(&BTreeMap::from([(0, PeopleInFrame::default())])).is_empty());
    }

    #[test]
    fn a_place_is_that_of_the_nearest_frame_and_of_none_far_away() {
        let place = |x: f64| PersonPlace::new(&standing(x, 0.0).corners(), 0.05).unwrap();
        let track = PersonTrack { places: BTreeMap::from([(10, place(0.0)), (20, place(1.0))]) };
        assert_eq!([14, 16].map(|frame| track.at(frame)), [Some(&place(0.0)), Some(&place(1.0))]);
        assert_eq!(track.at(20 + REACH + 1), None);
        let last = place(1.0);
        let off = last.cubes().map(|at| standing(1.0, 0.0).distance(at));
        assert!(off.fold(0.0, f64::max) < 0.01, "centimetres");
    }
}
