//! A look at a few silhouettes before a take is tracked: whether they can be a person's at all.

use std::convert::Infallible;
use std::sync::Arc;

use backlit_document::tracking_choices::CueChoice;
use backlit_tracking::body_fit::survey;
use backlit_tracking::cancel::CancelToken;

use super::job::TrackInputs;
use crate::session::load_frame;

/// Frames that are looked at: the tracker waits for them.
const LOOKED_AT: usize = 3;
/// Of so few frames each is seen at once as it is fitted.
const FEW: usize = 8;

/// Why keypoints cannot pull, in a sentence, where they alone are asked for.
pub(super) fn no_keypoints(inputs: &TrackInputs) -> Option<String> {
    if inputs.choices.cues != CueChoice::Keypoints {
        return None;
    }
    match inputs.footage.take().keypoint_order() {
        Ok(Some(_)) => None,
        Ok(None) => Some(
            "Not tracked: the take has no keypoints of a body. Choose other cues in the Solver section, or name them as \
             keypoints of the take’s cameras."
                .to_owned(),
        ),
        Err(error) => Some(format!("Not tracked: {error}.")),
    }
}

/// Why the frames that are to be tracked cannot be, in a sentence. Nothing where they can, or where they are few.
pub(super) fn nobody_to_track(inputs: &TrackInputs, cancel: &CancelToken) -> Option<String> {
    let frames: Vec<usize> = inputs.legs.iter().flat_map(|leg| leg.frames.iter().copied()).collect();
    if frames.len() <= FEW {
        return None;
    }
    let mut fit = inputs.fit.clone();
    let views = |frame: usize| {
        if !cancel.is_cancelled() {
            fit.frame = Some(Arc::new(load_frame(&inputs.footage, &inputs.measurement, frame)));
        }
        Ok::<_, Infallible>(fit.views())
    };
    let Ok(found) = survey::survey(&survey::spread(&frames, LOOKED_AT), views);
    found.check().err().map(|error| format!("Not tracked: {error}."))
}
