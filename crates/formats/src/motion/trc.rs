//! TRC, the markers of `OpenSim`: tabs, two lines of names, one row a frame. In a gap the
//! numbers are `nan`, as `OpenSim` writes it: a row that ends in empty fields it does not read.

use std::fmt::Write;

use super::names;
use super::scene::Scene;
use crate::FileProblem;

pub(super) fn to_bytes(scene: &Scene<'_>) -> Result<Vec<u8>, FileProblem> {
    let markers = names::joints(scene.model, scene.names, true);
    let frames = scene.without_gaps()?;
    let (rate, first) = (scene.frame_rate, scene.first_and_last().0);
    let mut out = format!(
        "PathFileType\t4\t(X/Y/Z)\t{}.trc\n\
         DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
         {rate}\t{rate}\t{count}\t{}\t{}\t{rate}\t{first}\t{count}\nFrame#\tTime",
        names::word(scene.name),
        markers.len(),
        scene.unit.symbol(),
        count = frames.len(),
    );
    for marker in &markers {
        out.extend(["\t", marker, "\t\t"]);
    }
    out.push_str("\n\t");
    for number in 1..=markers.len() {
        // Writing to a string cannot fail.
        let _ = write!(out, "\tX{number}\tY{number}\tZ{number}");
    }
    out.push_str("\n\n");
    let mut joints = scene.joints();
    for (frame, pose) in frames {
        let _ = write!(out, "{frame}\t{:.9}", scene.seconds(frame));
        match pose {
            Some(pose) => {
                for point in joints.of(pose) {
                    let _ = write!(out, "\t{:.6}\t{:.6}\t{:.6}", point.x, point.y, point.z);
                }
            }
            None => out.extend(std::iter::repeat_n("\tnan", 3 * markers.len())),
        }
        out.push('\n');
    }
    Ok(out.into_bytes())
}
