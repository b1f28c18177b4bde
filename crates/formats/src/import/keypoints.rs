//! What keypoints say: how a calibration that is off must be mended, a pose to begin with, and the person's height.

use backlit_tracking::camera::{Adjusted, Camera, Sighting, adjust};
use glam::DVec2;

use super::plates::{Keypoints, spread};
use super::{ImportError, ImportSurvey};
use crate::keypoints::joints::{KeypointBody, LOWEST_SCORE, body_of, meeting_point};
use crate::keypoints::{Person, tallest};

/// Frames whose keypoints are used.
const MOST_FRAMES: usize = 100;
/// Fewer points than this say too little of a rig.
const FEWEST_POINTS: usize = 100;
/// An adjusted calibration is taken where keypoints are off by less than this share of what they were.
const WORTHWHILE: f64 = 0.8;

/// The cameras found, adjusted so that they see the keypoints of one person at the same places in space. `None` where
/// keypoints say too little, or the calibration agrees with them about as well as it is.
pub(super) fn adjusted_rig(found: &ImportSurvey) -> Result<Option<Adjusted>, ImportError> {
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
    let adjusted = adjust(&cameras, &points, &sightings);
    Ok(adjusted.filter(|adjusted| adjusted.median_px[1] < WORTHWHILE * adjusted.median_px[0]))
}

/// The body, scaled to the person's joints, and its pose in the first frame. `None` where keypoints are of fewer than two
/// cameras, or make no body.
pub(super) fn start(found: &ImportSurvey) -> Result<Option<KeypointBody>, ImportError> {
    let mut people = Vec::new();
    for camera in &found.cameras {
        let seen = Keypoints::of(camera)?.people(found.first)?;
        people.extend(tallest(&seen).map(|person| (&camera.camera, person.clone())));
    }
    Ok(body_of(&people))
}
