//! Biovision hierarchy.
//!
//! A node's place is its parent's place, plus its offset turned as the parent is; the root's is its three position
//! channels. Angles are degrees; the channels' order is the order of the matrices.

use std::fmt::Write;

use super::bones::{BoneTree, angles};
use super::frames::MotionFrames;
use crate::FileProblem;

pub(super) fn to_bytes(scene: &MotionFrames<'_>) -> Result<Vec<u8>, FileProblem> {
    let bones = BoneTree::new(scene);
    let poses = scene.bridged()?;
    let mut out = String::from("HIERARCHY\n");
    let mut order = Vec::new();
    hierarchy(&mut out, scene, &bones, &mut order);
    out.push_str(&format!("MOTION\nFrames: {}\nFrame Time: {:.9}\n", poses.len(), 1.0 / scene.frame_rate));
    let mut before = vec![None; bones.bones.len()];
    for pose in &poses {
        let root = scene.point(pose.root);
        // Writing to a string cannot fail.
        let _ = write!(out, "{:.6} {:.6} {:.6}", root.x, root.y, root.z);
        let turns = bones.turns(scene, pose);
        for &node in &order {
            let turned = angles(scene.euler, turns[node], before[node]);
            before[node] = Some(turned);
            for angle in turned {
                let _ = write!(out, " {:.6}", angle.to_degrees());
            }
        }
        out.push('\n');
    }
    Ok(out.into_bytes())
}

/// Writes the tree, deepest first, and notes the order of its nodes.
fn hierarchy(out: &mut String, scene: &MotionFrames<'_>, bones: &BoneTree, order: &mut Vec<usize>) {
    let [a, b, c] = scene.euler.letters();
    // What is still to be written: a node, or the bracket that ends one.
    let mut open = vec![(0, 0, false)];
    while let Some((node, depth, is_end)) = open.pop() {
        let tabs = "\t".repeat(depth);
        if is_end {
            let _ = writeln!(out, "{tabs}}}");
            continue;
        }
        order.push(node);
        let this = &bones.bones[node];
        let (kind, positions) = match this.parent {
            Some(_) => ("JOINT", "3"),
            None => ("ROOT", "6 Xposition Yposition Zposition"),
        };
        let o = this.offset;
        let _ = write!(
            out,
            "{tabs}{kind} {}\n{tabs}{{\n{tabs}\tOFFSET {:.6} {:.6} {:.6}\n\
             {tabs}\tCHANNELS {positions} {a}rotation {b}rotation {c}rotation\n",
            this.name, o.x, o.y, o.z
        );
        open.push((node, depth, true));
        let mut children: Vec<usize> = bones.children(node).collect();
        if children.is_empty() {
            let tip = bones.tip(node);
            let _ = write!(
                out,
                "{tabs}\tEnd Site\n{tabs}\t{{\n{tabs}\t\tOFFSET {:.6} {:.6} {:.6}\n{tabs}\t}}\n",
                tip.x, tip.y, tip.z
            );
        }
        children.reverse();
        open.extend(children.into_iter().map(|child| (child, depth + 1, false)));
    }
}
