//! MOT, the coordinates of `OpenSim`: three angles a node, in degrees, and the root's place.
//!
//! A node turns by `Rz(a) Rx(b) Ry(c)` against its parent, with the body at rest looking along x, y up, z to its right.

use std::fmt::Write;

use super::scene::Scene;
use super::skeleton::Skeleton;
use super::{EulerOrder, euler, names};

pub(super) fn to_bytes(scene: &Scene<'_>) -> Vec<u8> {
    let skeleton = Skeleton::new(scene);
    let coordinates: Vec<[(String, f64); 3]> = skeleton
        .nodes
        .iter()
        .map(|node| match node.owner {
            Some(owner) => names::coordinates(scene.model, scene.names, &scene.model.limbs()[owner].name),
            None => ["z", "x", "y"].map(|axis| (format!("{}_{axis}", node.name), 1.0)),
        })
        .collect();
    let root = coordinates[0][0].0.strip_suffix("_tilt").unwrap_or(&skeleton.nodes[0].name);
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
    let mut before = vec![None; skeleton.nodes.len()];
    for (frame, pose) in &scene.frames {
        // Writing to a string cannot fail.
        let _ = write!(out, "{:.9}", scene.seconds(*frame));
        for (node, turn) in skeleton.turns(scene, pose).into_iter().enumerate() {
            let angles = euler::angles(EulerOrder::Zxy, turn, before[node]);
            before[node] = Some(angles);
            for (angle, (_, sense)) in angles.into_iter().zip(&coordinates[node]) {
                let _ = write!(out, "\t{:.8}", sense * angle.to_degrees());
            }
            if node == 0 {
                let place = scene.point(pose.root);
                let _ = write!(out, "\t{:.8}\t{:.8}\t{:.8}", place.x, place.y, place.z);
            }
        }
        out.push('\n');
    }
    out.into_bytes()
}
