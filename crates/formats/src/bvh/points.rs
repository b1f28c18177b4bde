//! The joints of a person among those of a skeleton, by name.

use std::path::Path;

use backlit_tracking::prior::{BodyPoints, Clip};
use glam::DVec3;

use super::BvhMotion;
use crate::{FileError, FileProblem, Result, joint_names};

/// Where a person's joints stand in a skeleton's list.
struct JointIndices {
    waist: usize,
    neck: usize,
    hips: [usize; 2],
    knees: [usize; 2],
    ankles: [usize; 2],
    toes: [usize; 2],
    shoulders: [usize; 2],
    elbows: [usize; 2],
    wrists: [usize; 2],
}

impl BvhMotion {
    /// The motion of a person's joints. `path` is for the error's message.
    pub fn body_points(&self, path: &Path) -> Result<Clip> {
        let places = JointIndices::of(self).map_err(|problem| FileError::new(path, problem))?;
        let at = |frame: usize| {
            let joints = self.joints_at(frame);
            let one = |index: usize| joints[index].0;
            let pair = |[right, left]: [usize; 2]| -> [DVec3; 2] { [one(right), one(left)] };
            BodyPoints {
                hips: pair(places.hips),
                waist: one(places.waist),
                neck: one(places.neck),
                shoulders: pair(places.shoulders),
                elbows: pair(places.elbows),
                wrists: pair(places.wrists),
                knees: pair(places.knees),
                ankles: pair(places.ankles),
                toes: pair(places.toes),
            }
        };
        let frames = (0..self.frame_count()).map(at).collect();
        Ok(Clip { frame_seconds: self.frame_seconds, frames })
    }
}

impl JointIndices {
    fn of(motion: &BvhMotion) -> Result<Self, FileProblem> {
        let names: Vec<String> =
            motion.joints().iter().map(|joint| joint_names::plain(&joint.name)).collect();
        let find = |joint: &str, side: &str| {
            // A root is the middle of the hips, whatever it is called.
            let may = |index: usize| !side.is_empty() || motion.joints()[index].parent.is_some();
            joint_names::column(&names, joint, side, may).ok_or_else(|| {
                let space = if side.is_empty() { "" } else { " " };
                let words = joint_names::words(joint).join(", ");
                let expected = format!("a joint for the {side}{space}{joint}: {words}");
                FileProblem::field("HIERARCHY", "without it", expected)
            })
        };
        let pair = |joint: &str| Ok([find(joint, "right")?, find(joint, "left")?]);
        Ok(Self {
            waist: find("waist", "")?,
            neck: find("neck", "")?,
            hips: pair("hip")?,
            knees: pair("knee")?,
            ankles: pair("ankle")?,
            toes: pair("toes")?,
            shoulders: pair("shoulder")?,
            elbows: pair("elbow")?,
            wrists: pair("wrist")?,
        })
    }
}
