//! A calibration that is off, mended by the keypoints of a person who moves through the room.

use backlit_tracking::camera::{AdjustOptions, Adjusted, Camera, Sighting, adjust};
use glam::DVec2;

use super::plates::{Keypoints, spread};
use super::{Found, ImportError};
use crate::keypoints::joints::{LOWEST_SCORE, meeting_point};
use crate::keypoints::{Person, tallest};

/// Frames whose keypoints are used.
const MOST_FRAMES: usize = 100;
/// Fewer points than this say too little of a rig.
const FEWEST_POINTS: usize = 100;
/// An adjusted calibration is taken where keypoints are off by less than this share of what they were.
const WORTHWHILE: f64 = 0.8;

/// The cameras found, adjusted so that they see the keypoints of one person at the same places in space. `None` where
/// keypoints say too little, or the calibration agrees with them about as well as it is.
pub(super) fn adjusted(found: &Found) -> Result<Option<Adjusted>, ImportError> {
    let cameras: Vec<Camera> = found.cameras.iter().map(|camera| camera.camera.clone()).collect();
    let keypoints: Vec<Keypoints> = found.cameras.iter().map(Keypoints::of).collect::<Result<_, _>>()?;
    let (mut points, mut sightings) = (Vec::new(), Vec::new());
    for frame in spread(found, MOST_FRAMES) {
        let mut people: Vec<(usize, Person)> = Vec::new();
        for (camera, keypoints) in keypoints.iter().enumerate() {
            people.extend(tallest(&keypoints.people(frame)?).map(|person| (camera, person.clone())));
        }
        let count = people.iter().map(|(_, person)| person.len()).max().unwrap_or(0);
        for keypoint in 0..count {
            let seen: Vec<(usize, DVec2)> = people
                .iter()
                .filter_map(|(camera, person)| {
                    let keypoint = (*person.get(keypoint)?)?;
                    (keypoint.score >= LOWEST_SCORE).then_some((*camera, keypoint.place))
                })
                .collect();
            let Some(point) = meeting_point(seen.iter().map(|&(camera, pixel)| (&cameras[camera], pixel)))
            else {
                continue;
            };
            let index = points.len();
            sightings.extend(seen.into_iter().map(|(camera, pixel)| Sighting {
                camera,
                point: index,
                pixel,
            }));
            points.push(point);
        }
    }
    if points.len() < FEWEST_POINTS {
        return Ok(None);
    }
    let adjusted = adjust(&cameras, &points, &sightings, &AdjustOptions::default());
    Ok(adjusted.filter(|adjusted| adjusted.median_px[1] < WORTHWHILE * adjusted.median_px[0]))
}
