//! Tables of text: TRC and MOT of `OpenSim`, and CSV.

use std::fmt::Write;

use super::bones::{BoneTree, angles};
use super::frames::MotionFrames;
use super::{EulerOrder, names};
use crate::FileProblem;

/// TRC, markers: tabs, two lines of names, one row a frame. In a gap the numbers are `nan`, as `OpenSim` writes them:
/// it does not read a row that ends in empty fields.
pub(super) fn trc(scene: &MotionFrames<'_>) -> Result<Vec<u8>, FileProblem> {
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

/// MOT, coordinates: three angles a bone, in degrees, and the root's place.
///
/// A bone turns by `Rz(a) Rx(b) Ry(c)` against its parent, with the body at rest looking along x, y up, z to its right.
pub(super) fn mot(scene: &MotionFrames<'_>) -> Result<Vec<u8>, FileProblem> {
    let bones = BoneTree::new(scene);
    let coordinates: Vec<[(String, f64); 3]> = bones
        .bones
        .iter()
        .map(|node| match node.owner {
            Some(owner) => names::coordinates(scene.model, scene.names, &scene.model.limbs()[owner].name),
            None => ["z", "x", "y"].map(|axis| (format!("{}_{axis}", node.name), 1.0)),
        })
        .collect();
    let root = coordinates[0][0].0.strip_suffix("_tilt").unwrap_or(&bones.bones[0].name);
    let mut header = vec!["time".to_owned()];
    header.extend(coordinates[0].iter().map(|(name, _)| name.clone()));
    header.extend(["tx", "ty", "tz"].map(|axis| format!("{root}_{axis}")));
    header.extend(coordinates[1..].iter().flatten().map(|(name, _)| name.clone()));
    let header = names::different(header.into_iter());
    let mut out = format!(
        "{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees=yes\n\n\
         Units are S.I. units (second, meters, Newtons, ...), but lengths here are in {}\n\
         Angles are in degrees.\n\nendheader\n{}\n",
        names::word(scene.name),
        scene.frames.len(),
        header.len(),
        scene.unit.symbol(),
        header.join("\t"),
    );
    let mut before = vec![None; bones.bones.len()];
    for (frame, pose) in &scene.frames {
        let _ = write!(out, "{:.9}", scene.seconds(*frame));
        for (node, turn) in bones.turns(scene, pose).into_iter().enumerate() {
            let turned = angles(EulerOrder::Zxy, turn, before[node]);
            before[node] = Some(turned);
            for (angle, (_, sense)) in turned.into_iter().zip(&coordinates[node]) {
                let _ = write!(out, "\t{:.8}", sense * angle.to_degrees());
            }
            if node == 0 {
                let place = scene.point(pose.root);
                let _ = write!(out, "\t{:.8}\t{:.8}\t{:.8}", place.x, place.y, place.z);
            }
        }
        out.push('\n');
    }
    Ok(out.into_bytes())
}

/// CSV: `frame,seconds,joint,x,y,z`, and where limbs were judged `wrong,error`. Numbers read back to the bit.
pub(super) fn csv(scene: &MotionFrames<'_>) -> Result<Vec<u8>, FileProblem> {
    let names: Vec<String> =
        names::joints(scene.model, scene.names, false).iter().map(|name| quoted(name)).collect();
    let is_judged = scene.is_judged();
    let mut out = format!("frame,seconds,joint,x,y,z{}\n", if is_judged { ",wrong,error" } else { "" });
    let mut joints = scene.joints();
    for (frame, pose) in &scene.frames {
        let seconds = scene.seconds(*frame);
        for ((name, point), trust) in names.iter().zip(joints.of(pose)).zip(scene.joint_trust(*frame)) {
            let _ = write!(out, "{frame},{seconds},{name},{},{},{}", point.x, point.y, point.z);
            if is_judged && trust.wrong.is_nan() {
                out.push_str(",,");
            } else if is_judged {
                let _ = write!(out, ",{},{}", trust.wrong, trust.error_95_m * scene.unit.per_metre());
            }
            out.push('\n');
        }
    }
    Ok(out.into_bytes())
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}
