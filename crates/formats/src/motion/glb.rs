use std::f64::consts::{PI, TAU};

use glam::DVec3;
use serde_json::{Value, json};

use super::bones::BoneTree;
use super::frames::{MotionFrames, too_large};
use crate::FileProblem;

/// Types of an accessor's numbers.
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
/// Uses of a buffer view; animations and matrices have none.
const VERTICES: Option<u32> = Some(34962);
const INDICES: Option<u32> = Some(34963);
/// Corners around a limb's capsule, and rings from a pole to where the cylinder begins.
const AROUND: usize = 16;
const RINGS: usize = 4;

pub(super) fn to_bytes(scene: &MotionFrames<'_>) -> Result<Vec<u8>, FileProblem> {
    let bones = BoneTree::new(scene);
    let mut buffer = Buffer::default();
    let mesh = mesh(scene, &bones, &mut buffer);
    let matrices = bones.bones.iter().map(|node| {
        let [x, y, z] = floats(-node.place);
        [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
    });
    let inverse_bind = buffer.floats("MAT4", matrices, None, false);
    let animation = animation(scene, &bones, &mut buffer);
    let joints: Vec<usize> = (0..bones.bones.len()).collect();
    let mut nodes = nodes(&bones);
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

/// The bones's nodes at rest, then the tips of those without children.
fn nodes(bones: &BoneTree) -> Vec<Value> {
    let mut nodes = Vec::new();
    let mut tips = Vec::new();
    let count = bones.bones.len();
    for (index, node) in bones.bones.iter().enumerate() {
        let mut children: Vec<usize> = bones.children(index).collect();
        if children.is_empty() {
            children.push(count + tips.len());
            let tip = floats(bones.tip(index)).map(f64::from);
            tips.push(json!({"name": format!("{}_end", node.name), "translation": tip}));
        }
        let translation = floats(node.offset).map(f64::from);
        nodes.push(json!({"name": node.name, "translation": translation, "children": children}));
    }
    nodes.extend(tips);
    nodes
}

/// A capsule a limb, each wholly of one joint.
fn mesh(scene: &MotionFrames<'_>, bones: &BoneTree, buffer: &mut Buffer) -> Value {
    let (mut corners, mut normals, mut joints, mut indices) = (vec![], vec![], vec![], vec![]);
    for (limb, line) in scene.model.limbs().iter().zip(&bones.limbs) {
        let place = bones.bones[line.node].place;
        let radius = limb.radius * scene.unit.per_metre();
        let surface = capsule(place + line.start, place + line.end, radius);
        let first = corners.len() as u32;
        indices.extend(surface.triangles.into_iter().flatten().map(|index| [(first + index).to_le_bytes()]));
        joints.extend(surface.corners.iter().map(|_| [line.node as u16, 0, 0, 0].map(u16::to_le_bytes)));
        corners.extend(surface.corners.into_iter().map(floats));
        normals.extend(surface.normals.into_iter().map(floats));
    }
    let weights = corners.iter().map(|_| [1.0, 0.0, 0.0, 0.0]);
    let weights = buffer.floats("VEC4", weights, VERTICES, false);
    let attributes = json!({
        "POSITION": buffer.floats("VEC3", corners, VERTICES, true),
        "NORMAL": buffer.floats("VEC3", normals, VERTICES, false),
        "JOINTS_0": buffer.rows(UNSIGNED_SHORT, "VEC4", joints, VERTICES),
        "WEIGHTS_0": weights,
    });
    let indices = buffer.rows(UNSIGNED_INT, "SCALAR", indices, INDICES);
    json!({"name": "body", "primitives": [{"attributes": attributes, "indices": indices, "material": 0}]})
}

/// The root's place and every node's turn; times begin at 0 with the first frame.
fn animation(scene: &MotionFrames<'_>, bones: &BoneTree, buffer: &mut Buffer) -> Value {
    let first = scene.first_and_last().0;
    let times = scene.frames.iter().map(|(frame, _)| [scene.seconds(frame - first) as f32]);
    let times = buffer.floats("SCALAR", times, None, true);
    let mut turns = vec![Vec::with_capacity(scene.frames.len()); bones.bones.len()];
    for (_, pose) in &scene.frames {
        for (of_node, turn) in turns.iter_mut().zip(bones.turns(scene, pose)) {
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
    let mut outputs = vec![(0, "translation", buffer.floats("VEC3", roots, None, false))];
    for (node, turns) in turns.into_iter().enumerate() {
        outputs.push((node, "rotation", buffer.floats("VEC4", turns, None, false)));
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

/// The binary chunk: bytes, views of them and accessors. Every view begins at a multiple of 4.
#[derive(Debug, Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds rows of floats and gives the accessor's index. Least and largest are of the numbers as they are stored.
    fn floats<const N: usize>(
        &mut self,
        kind: &str,
        rows: impl IntoIterator<Item = [f32; N]>,
        target: Option<u32>,
        bounds: bool,
    ) -> usize {
        let (mut min, mut max) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
        let rows = rows.into_iter().inspect(|row| {
            for ((value, min), max) in row.iter().zip(&mut min).zip(&mut max) {
                (*min, *max) = (min.min(*value), max.max(*value));
            }
        });
        let index = self.rows(FLOAT, kind, rows.map(|row| row.map(f32::to_le_bytes)), target);
        if bounds {
            // As doubles, or the decimals would not be the stored number's.
            self.accessors[index]["min"] = json!(min.map(f64::from).to_vec());
            self.accessors[index]["max"] = json!(max.map(f64::from).to_vec());
        }
        index
    }

    /// Adds rows of numbers, each as its bytes, and gives the accessor's index.
    fn rows<const N: usize, const SIZE: usize>(
        &mut self,
        component: u32,
        kind: &str,
        rows: impl IntoIterator<Item = [[u8; SIZE]; N]>,
        target: Option<u32>,
    ) -> usize {
        let (start, mut count) = (self.bytes.len(), 0);
        for row in rows {
            self.bytes.extend(row.as_flattened());
            count += 1;
        }
        let mut view = json!({"buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": kind
        }));
        self.accessors.len() - 1
    }

    /// The whole file: the document with buffers, views and accessors put in, and the bytes.
    pub(super) fn into_file(self, mut document: Value) -> Result<Vec<u8>, FileProblem> {
        document["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        document["bufferViews"] = Value::Array(self.views);
        document["accessors"] = Value::Array(self.accessors);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = self.bytes;
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        let length = 12 + 8 + text.len() + 8 + bytes.len();
        let length = u32::try_from(length).map_err(|_error| too_large(length))?;
        // No part is longer than the whole.
        let mut out = b"glTF\x02\x00\x00\x00".to_vec();
        out.extend(length.to_le_bytes());
        out.extend((text.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(text);
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(bytes);
        Ok(out)
    }
}

/// A limb's surface: a cylinder with half a sphere on each end. Corners, their outward normals, and triangles, seen from
/// outside against the clock.
#[derive(Debug, Default)]
struct Capsule {
    corners: Vec<DVec3>,
    normals: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// The capsule from `start` to `end`.
fn capsule(start: DVec3, end: DVec3, radius: f64) -> Capsule {
    let along = (end - start).try_normalize().unwrap_or(DVec3::Z);
    let (u, v) = along.any_orthonormal_pair();
    // A right-handed frame u, v, along, whichever hand the pair was of.
    let v = if u.cross(v).dot(along) < 0.0 { -v } else { v };
    let mut out = Capsule::default();
    // Rings from the pole at the start to the pole at the end; each half sphere has its own equator.
    for ring in 0..2 * (RINGS + 1) {
        let (centre, step) = if ring <= RINGS { (start, ring) } else { (end, ring - 1) };
        let latitude = PI * (step as f64 / (2 * RINGS) as f64 - 0.5);
        for corner in 0..AROUND {
            let longitude = TAU * corner as f64 / AROUND as f64;
            let outwards = u * longitude.cos() + v * longitude.sin();
            let normal = (outwards * latitude.cos() + along * latitude.sin()).normalize();
            out.corners.push(centre + normal * radius);
            out.normals.push(normal);
        }
    }
    let index = |ring: usize, corner: usize| (ring * AROUND + corner % AROUND) as u32;
    for ring in 0..2 * RINGS + 1 {
        for corner in 0..AROUND {
            let [a, b] = [index(ring, corner), index(ring, corner + 1)];
            let [c, d] = [index(ring + 1, corner), index(ring + 1, corner + 1)];
            // At a pole one of the two has no area.
            if ring != 0 {
                out.triangles.push([a, b, d]);
            }
            if ring != 2 * RINGS {
                out.triangles.push([a, d, c]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_capsule_is_closed_and_looks_outwards() {
        let (start, end, radius) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.4, 0.1, 0.9), 0.05);
        let Capsule { corners, normals, triangles } = capsule(start, end, radius);
        let along = (end - start).normalize();
        for (corner, normal) in corners.iter().zip(&normals) {
            let at = (*corner - start).dot(along).clamp(0.0, start.distance(end));
            assert!((corner.distance(start + along * at) - radius).abs() < 1e-12);
            assert!((normal.length() - 1.0).abs() < 1e-12);
        }
        let mut volume = 0.0;
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|index| corners[index as usize]);
            assert!((b - a).cross(c - a).dot(normals[triangle[0] as usize]) > 0.0);
            volume += a.dot(b.cross(c)) / 6.0;
        }
        let whole = PI * radius.powi(2) * (start.distance(end) + 4.0 / 3.0 * radius);
        assert!((0.9..1.0).contains(&(volume / whole)), "{}", volume / whole);
    }
}
