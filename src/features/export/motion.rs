//! The motion for other programs: poses as the document has them, those set by hand included. The file's ending says its
//! format; axes and unit are those that the format expects.

use std::path::Path;
use std::sync::Arc;

use anyhow::anyhow;
use backlit_formats::motion::{self, Motion, MotionFormat, MotionOptions};
use backlit_tracking::camera::up_of;

use super::Export;
use crate::context::file_dialog::Wanted;
use crate::context::{Context, Requests};

/// The endings that are offered, the first as a name is made up.
const ENDINGS: [&str; 7] = ["bvh", "trc", "mot", "c3d", "glb", "npz", "csv"];

/// What a file dialog was opened for.
#[derive(Debug)]
pub(super) enum Asked {
    /// Where pictures go.
    Pictures,
    /// Where this motion goes.
    Motion(Arc<Motion>, MotionOptions),
}

/// The poses of a document: of each frame that has one of its own, fitted or set by hand.
fn motion_of(context: &Context<'_>) -> Motion {
    let document = context.document();
    let frames = document.estimates.keys().chain(document.keys.keys());
    let take = context.session.take.as_ref();
    Motion {
        name: take.map_or_else(|| "backlit".to_owned(), |take| take.name.clone()),
        model: (*document.model).clone(),
        frame_rate: take.map_or(30.0, |take| take.frame_rate),
        poses: frames.map(|&frame| (frame, document.pose_at(frame).clone())).collect(),
    }
}

impl Export {
    /// Asks where the motion goes.
    pub(super) fn ask_for_motion(&self, context: &Context<'_>, requests: &mut Requests) {
        let motion = motion_of(context);
        let cameras = context.session.take.as_ref().map(|take| take.cameras.clone()).unwrap_or_default();
        let up = up_of(cameras.iter().map(|camera| &**camera));
        let options =
            MotionOptions { up: up.unwrap_or(MotionOptions::default().up), ..MotionOptions::default() };
        let wanted = Wanted::NewFile(format!("{}.bvh", motion.name), &ENDINGS);
        let asked = Asked::Motion(Arc::new(motion), options);
        if let Err(why) = self.dialogs.ask(context.egui, asked, "Export motion", wanted) {
            requests.complain(why.to_string());
        }
    }

    /// Has the motion written in the format of the file's ending.
    pub(super) fn write_motion(
        path: &Path,
        motion: Arc<Motion>,
        options: MotionOptions,
        requests: &mut Requests,
    ) {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        let Some(format) = MotionFormat::of_extension(ending) else {
            requests.complain(format!(
                "Not exported: the name ends in \"{ending}\"; expected .bvh, .trc, .mot, .c3d, .glb, .npz or .csv."
            ));
            return;
        };
        requests.write(path, move || {
            motion::to_bytes(format, &motion, &options).map_err(|problem| anyhow!("{problem}"))
        });
    }
}
