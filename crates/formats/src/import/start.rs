//! A pose to begin with, and the person's height, from two-dimensional keypoints of several cameras.

use super::{Found, ImportError};
use crate::keypoints::joints::{KeypointBody, body_of};
use crate::keypoints::{self, tallest};

/// The body, scaled to the person's joints, and its pose in the first frame. `None` where keypoints are of fewer than two
/// cameras, or make no body.
pub(super) fn of_keypoints(found: &Found) -> Result<Option<KeypointBody>, ImportError> {
    let mut people = Vec::new();
    for camera in &found.cameras {
        let Some(folder) = &camera.keypoints else { continue };
        let files = keypoints::files_of(folder)?;
        let Some((first, _)) = files.first() else { continue };
        let Some((_, path)) = files.iter().find(|(number, _)| *number == first + found.first as u64) else {
            continue;
        };
        people.extend(tallest(&keypoints::read(path)?).map(|person| (&camera.camera, person.clone())));
    }
    Ok(body_of(&people))
}
