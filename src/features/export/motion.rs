//! The motion for other programs: poses as the document has them, those set by hand included.

use backlit_formats::motion::{Motion, MotionOptions};
use backlit_tracking::camera::up_of;

use super::choices::MotionChoices;
use crate::context::Context;

/// The poses of a document: of each frame that has one of its own, fitted or set by hand.
pub(super) fn motion_of(context: &Context<'_>) -> Motion {
    let document = context.document();
    let take = context.session.take.as_ref();
    Motion {
        name: take.map_or_else(|| "backlit".to_owned(), |take| take.name.clone()),
        model: (*document.model).clone(),
        frame_rate: take.map_or(30.0, |take| take.frame_rate),
        poses: document.own_poses(),
    }
}

/// How these frames of it are written. Which way is up is told by the cameras.
pub(super) fn options(
    choices: MotionChoices,
    [first, last]: [usize; 2],
    context: &Context<'_>,
) -> MotionOptions {
    let cameras = context.session.take.as_ref().map(|take| take.cameras.clone()).unwrap_or_default();
    let up = up_of(cameras.iter().map(|camera| &**camera)).unwrap_or(MotionOptions::default().up);
    let MotionChoices { axes, unit, names, euler, .. } = choices;
    MotionOptions { axes, up, unit, range: Some(first..=last), names, euler }
}
