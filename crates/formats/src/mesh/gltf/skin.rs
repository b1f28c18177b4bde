//! The first skinned mesh of a glTF document: its surface in the pose in which the file has it, the joint that moves each vertex
//! most, and the skeleton.

use backlit_tracking::body_spheres::{Skin, SkinJoint};
use glam::{DAffine3, DMat4, DVec3};
use serde::Deserialize;

use super::{GltfReader, MAX_DEPTH, MeshProblem, Primitive, Soup, entry, float, room};

/// Most joints of a skeleton.
const MAX_JOINTS: usize = 4096;

/// A skin as the document has it.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SkinJson {
    joints: Vec<usize>,
    inverse_bind_matrices: Option<usize>,
}

/// The skeleton of a skin.
struct SkinSkeleton {
    joints: Vec<SkinJoint>,
    /// By joint: from the mesh in its bind pose to the world.
    world_from_mesh: Vec<DAffine3>,
}

impl GltfReader<'_> {
    /// The mesh, its skeleton and which joint moves what.
    pub(super) fn skin(&mut self) -> Result<Skin, MeshProblem> {
        let document = self.document;
        let skinned = document.nodes.iter().find_map(|node| node.mesh.zip(node.skin));
        let Some((mesh, skin)) = skinned else { return Err(MeshProblem::Lacks { what: "skinned mesh" }) };
        let skeleton = self.skeleton(entry(&document.skins, skin, "a skin")?)?;
        let mut found = Skin { joints: skeleton.joints.clone(), ..Skin::default() };
        for primitive in &entry(&document.meshes, mesh, "a mesh")?.primitives {
            if primitive.mode.unwrap_or(4) != 4 {
                return Err(MeshProblem::unsupported("a primitive of a skinned mesh", "no triangles"));
            }
            self.skinned(primitive, &skeleton, &mut found)?;
        }
        Ok(found)
    }

    fn skeleton(&self, skin: &SkinJson) -> Result<SkinSkeleton, MeshProblem> {
        let document = self.document;
        if skin.joints.len() > MAX_JOINTS {
            let found = format!("{} joints; expected at most {MAX_JOINTS}", skin.joints.len());
            return Err(MeshProblem::unsupported("a skeleton", found));
        }
        let mut parents: Vec<Option<usize>> = vec![None; document.nodes.len()];
        for (index, node) in document.nodes.iter().enumerate() {
            for &child in &node.children {
                entry(&document.nodes, child, "a node")?;
                parents[child] = Some(index);
            }
        }
        let mut places: Vec<Option<usize>> = vec![None; document.nodes.len()];
        for (joint, &node) in skin.joints.iter().enumerate() {
            entry(&document.nodes, node, "a node")?;
            places[node] = Some(joint);
        }
        let binds = self.inverse_binds(skin)?;
        let mut skeleton = SkinSkeleton { joints: Vec::new(), world_from_mesh: Vec::new() };
        for (&node, bind) in skin.joints.iter().zip(&binds) {
            let joint = &document.nodes[node];
            let (mut world_from_joint, mut parent, mut above) =
                (joint.parent_from_node(), None, parents[node]);
            for _ in 0..=MAX_DEPTH {
                let Some(at) = above else { break };
                world_from_joint = document.nodes[at].parent_from_node() * world_from_joint;
                parent = parent.or(places[at]);
                above = parents[at];
            }
            if above.is_some() {
                return Err(MeshProblem::unsupported("a tree of nodes", format!("deeper than {MAX_DEPTH}")));
            }
            let name = joint.name.clone().unwrap_or_default();
            skeleton.joints.push(SkinJoint { name, parent, place: world_from_joint.translation });
            skeleton.world_from_mesh.push(world_from_joint * *bind);
        }
        Ok(skeleton)
    }

    fn inverse_binds(&self, skin: &SkinJson) -> Result<Vec<DAffine3>, MeshProblem> {
        let mut binds = vec![DAffine3::IDENTITY; skin.joints.len()];
        let Some(matrices) = skin.inverse_bind_matrices else { return Ok(binds) };
        let accessor = entry(&self.document.accessors, matrices, "an accessor")?;
        if accessor.kind != "MAT4" || accessor.component_type != 5126 || accessor.count < binds.len() {
            let found = format!("{} of {} for {} joints", accessor.count, accessor.kind, binds.len());
            return Err(MeshProblem::unsupported("inverse bind matrices", found));
        }
        let mut rows = binds.iter_mut();
        self.rows(accessor, 64, |row| {
            let Some(bind) = rows.next() else { return };
            *bind = DAffine3::from_mat4(DMat4::from_cols_array(&std::array::from_fn(|i| float(row, i))));
        })?;
        Ok(binds)
    }

    fn skinned(
        &mut self,
        primitive: &Primitive,
        skeleton: &SkinSkeleton,
        skin: &mut Skin,
    ) -> Result<(), MeshProblem> {
        self.soup = Soup::default();
        self.primitive(primitive, DAffine3::IDENTITY)?;
        let Soup { vertices, triangles } = std::mem::take(&mut self.soup);
        let joints = self.fours(primitive.attributes.joints, "JOINTS_0", &[5121, 5123])?;
        let weights = self.fours(primitive.attributes.weights, "WEIGHTS_0", &[5126, 5121, 5123])?;
        for (what, found) in [("JOINTS_0", joints.len()), ("WEIGHTS_0", weights.len())] {
            if found != vertices.len() {
                let found = format!("{found} for {} vertices", vertices.len());
                return Err(MeshProblem::word(what, found, "one a vertex"));
            }
        }
        room("vertices", skin.vertices.len(), vertices.len())?;
        room("triangles", skin.triangles.len(), triangles.len())?;
        let first = skin.vertices.len() as u32;
        for ((place, joints), weights) in vertices.into_iter().zip(joints).zip(weights) {
            let (place, joint) = skeleton.moved(place, joints, weights)?;
            skin.vertices.push(place);
            skin.joint_of.push(joint);
        }
        skin.triangles.extend(triangles.iter().map(|corners| corners.map(|corner| corner + first)));
        Ok(())
    }

    /// Rows of four numbers of an attribute.
    fn fours(
        &self,
        attribute: Option<usize>,
        what: &'static str,
        kinds: &[u32],
    ) -> Result<Vec<[f64; 4]>, MeshProblem> {
        let Some(index) = attribute else { return Err(MeshProblem::Lacks { what }) };
        let accessor = entry(&self.document.accessors, index, "an accessor")?;
        if accessor.kind != "VEC4" || !kinds.contains(&accessor.component_type) {
            let found = format!("{what}: {} of {}", accessor.kind, accessor.component_type);
            return Err(MeshProblem::unsupported("an attribute of another kind", found));
        }
        room("vertices", 0, accessor.count)?;
        let size = match accessor.component_type {
            5121 => 1,
            5123 => 2,
            _ => 4,
        };
        let mut rows = Vec::new();
        self.rows(accessor, 4 * size, |row| {
            rows.push(std::array::from_fn(|i| match size {
                1 => f64::from(row[i]),
                2 => f64::from(u16::from_le_bytes([row[2 * i], row[2 * i + 1]])),
                _ => float(row, i),
            }));
        })?;
        Ok(rows)
    }
}

impl SkinSkeleton {
    /// Where a vertex is, and the joint that moves it most.
    fn moved(
        &self,
        place: DVec3,
        joints: [f64; 4],
        weights: [f64; 4],
    ) -> Result<(DVec3, usize), MeshProblem> {
        let (mut at, mut total, mut most) = (DVec3::ZERO, 0.0, (0.0, 0));
        for (joint, weight) in joints.into_iter().zip(weights).filter(|(_, weight)| *weight > 0.0) {
            let joint = joint as usize;
            let Some(world_from_mesh) = self.world_from_mesh.get(joint) else {
                let (what, expected) = ("a joint of JOINTS_0", "one of the skin's joints");
                return Err(MeshProblem::word(what, joint.to_string(), expected));
            };
            at += weight * world_from_mesh.transform_point3(place);
            total += weight;
            if weight > most.0 {
                most = (weight, joint);
            }
        }
        match self.world_from_mesh.first() {
            _ if total > 0.0 => Ok((at / total, most.1)),
            // What no joint moves stays with the first.
            Some(first) => Ok((first.transform_point3(place), 0)),
            None => Err(MeshProblem::Lacks { what: "joint" }),
        }
    }
}
