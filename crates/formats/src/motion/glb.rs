//! glTF 2.0, binary: the skeleton as nodes, the limbs as one skinned mesh, the motion as an animation.
//!
//! The bind pose is the rest pose with the root at the origin, so an inverse bind matrix only moves: x ↦ x − place.

use glam::DVec3;
use serde_json::{Value, json};

use super::capsule;
use super::glb_buffer::{Buffer, Target};
use super::scene::Scene;
use super::skeleton::Skeleton;
use crate::FileProblem;

pub(super) fn to_bytes(scene: &Scene<'_>) -> Result<Vec<u8>, FileProblem> {
    let skeleton = Skeleton::new(scene);
    let mut buffer = Buffer::default();
    let mesh = mesh(scene, &skeleton, &mut buffer);
    let matrices = skeleton.nodes.iter().map(|node| {
        let [x, y, z] = floats(-node.place);
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
    });
    let inverse_bind = buffer.floats("MAT4", matrices, Target::Other, false);
    let animation = animation(scene, &skeleton, &mut buffer);
    let joints: Vec<usize> = (0..skeleton.nodes.len()).collect();
    let mut nodes = nodes(&skeleton);
    let body = nodes.len();
    nodes.push(json!({"name": "body", "mesh": 0, "skin": 0}));
    let material =
        json!({"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 0.9});
    buffer.into_file(json!({
        "asset": {"version": "2.0", "generator": concat!("Backlit ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"name": scene.name, "nodes": [0, body]}],
        "nodes": nodes,
        "meshes": [mesh],
        "materials": [{"name": "body", "pbrMetallicRoughness": material}],
        "skins": [{"joints": joints, "skeleton": 0, "inverseBindMatrices": inverse_bind}],
        "animations": [animation],
    }))
}

fn floats(vector: DVec3) -> [f32; 3] {
    vector.as_vec3().to_array()
}

/// The skeleton's nodes at rest, then the tips of those without children.
fn nodes(skeleton: &Skeleton) -> Vec<Value> {
    let mut nodes = Vec::new();
    let mut tips = Vec::new();
    let count = skeleton.nodes.len();
    for (index, node) in skeleton.nodes.iter().enumerate() {
        let mut children: Vec<usize> = skeleton.children(index).collect();
        if children.is_empty() {
            children.push(count + tips.len());
            let tip = floats(skeleton.tip(index)).map(f64::from);
            tips.push(json!({"name": format!("{}_end", node.name), "translation": tip}));
        }
        let translation = floats(node.offset).map(f64::from);
        nodes.push(json!({"name": node.name, "translation": translation, "children": children}));
    }
    nodes.extend(tips);
    nodes
}

/// A capsule a limb, each wholly of one joint.
fn mesh(scene: &Scene<'_>, skeleton: &Skeleton, buffer: &mut Buffer) -> Value {
    let (mut corners, mut normals, mut joints, mut indices) = (vec![], vec![], vec![], vec![]);
    for (limb, line) in scene.model.limbs().iter().zip(&skeleton.limbs) {
        let place = skeleton.nodes[line.node].place;
        let radius = limb.radius * scene.unit.per_metre();
        let surface = capsule::surface(place + line.start, place + line.end, radius);
        let first = corners.len() as u32;
        indices.extend(surface.triangles.into_iter().flatten().map(|index| first + index));
        joints.extend(surface.corners.iter().map(|_| [line.node as u16, 0, 0, 0]));
        corners.extend(surface.corners.into_iter().map(floats));
        normals.extend(surface.normals.into_iter().map(floats));
    }
    let weights = corners.iter().map(|_| [1.0, 0.0, 0.0, 0.0]);
    let weights = buffer.floats("VEC4", weights, Target::Vertices, false);
    let attributes = json!({
        "POSITION": buffer.floats("VEC3", corners, Target::Vertices, true),
        "NORMAL": buffer.floats("VEC3", normals, Target::Vertices, false),
        "JOINTS_0": buffer.shorts(joints),
        "WEIGHTS_0": weights,
    });
    let indices = buffer.indices(indices);
    json!({"name": "body", "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]})
}

/// The root's place and every node's turn; times begin at 0 with the first frame.
fn animation(scene: &Scene<'_>, skeleton: &Skeleton, buffer: &mut Buffer) -> Value {
    let first = scene.first_and_last().0;
    let times = scene.frames.iter().map(|(frame, _)| [scene.seconds(frame - first) as f32]);
    let times = buffer.floats("SCALAR", times, Target::Other, true);
    let mut turns = vec![Vec::with_capacity(scene.frames.len()); skeleton.nodes.len()];
    for (_, pose) in &scene.frames {
        for (of_node, turn) in turns.iter_mut().zip(skeleton.turns(scene, pose)) {
            let mut q = turn.as_quat().to_array();
            // The same turn with the sign that is nearer to the frame before.
            if let Some(before) = of_node.last()
                && q.iter().zip(before).map(|(a, b): (&f32, &f32)| a * b).sum::<f32>() < 0.0
            {
                q = q.map(|value| -value);
            }
            of_node.push(q);
        }
    }
    let roots = scene.frames.iter().map(|(_, pose)| floats(scene.point(pose.root)));
    let mut outputs = vec![(0, "translation", buffer.floats("VEC3", roots, Target::Other, false))];
    for (node, turns) in turns.into_iter().enumerate() {
        outputs.push((node, "rotation", buffer.floats("VEC4", turns, Target::Other, false)));
    }
    let samplers = outputs
        .iter()
        .map(|(_, _, output)| json!({"input": times, "output": output, "interpolation": "LINEAR"}));
    let channels = outputs.iter().enumerate().map(
        |(sampler, (node, path, _))| json!({"sampler": sampler, "target": {"node": node, "path": path}}),
    );
    json!({
        "name": scene.name,
        "samplers": samplers.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
    })
}
