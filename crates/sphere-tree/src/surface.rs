//! Signed distances to a closed mesh: closest points by a tree of boxes; inside or outside by the angle-weighted normal there.
//!
//! Baerentzen and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal": the sign of (p − q)·n at the
//! closest point q is exact where n is the face's normal, the sum of an edge's two, or a corner's weighted by angles.

use std::collections::HashMap;

use glam::DVec3;

use crate::mesh::ClosedMesh;

/// Triangles of a leaf.
const LEAF: usize = 4;

/// A place on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Closest point of the surface.
    pub point: DVec3,
    /// The triangle that it lies on.
    pub triangle: usize,
    /// Distance to it, negative inside.
    pub signed: f64,
}

/// A mesh made ready for [`nearest`](Self::nearest).
#[derive(Debug)]
pub struct MeshSurface<'a> {
    mesh: &'a ClosedMesh,
    boxes: Vec<BoxNode>,
    /// Triangles, leaf by leaf.
    order: Vec<u32>,
    corners: Vec<[DVec3; 3]>,
    face_normals: Vec<DVec3>,
    edge_normals: Vec<[DVec3; 3]>,
    vertex_normals: Vec<DVec3>,
}

#[derive(Debug, Clone, Copy)]
struct BoxNode {
    low: DVec3,
    high: DVec3,
    /// Of a leaf the first place in `order`, else the second child; the first child follows its parent.
    first: u32,
    /// Triangles of a leaf; 0 else.
    count: u32,
}

impl BoxNode {
    fn distance_squared(&self, point: DVec3) -> f64 {
        point.distance_squared(point.clamp(self.low, self.high))
    }
}

impl<'a> MeshSurface<'a> {
    /// Boxes and normals of a mesh.
    #[must_use]
    pub fn new(mesh: &'a ClosedMesh) -> Self {
        let count = mesh.triangles().len();
        let mut order: Vec<u32> = (0..count as u32).collect();
        let mut boxes = Vec::with_capacity(count);
        split(mesh, &mut order, 0, &mut boxes);
        let corners = order.iter().map(|&triangle| mesh.corners(triangle as usize)).collect();
        let mut surface = Self {
            mesh,
            boxes,
            order,
            corners,
            face_normals: Vec::new(),
            edge_normals: Vec::new(),
            vertex_normals: vec![DVec3::ZERO; mesh.vertices().len()],
        };
        surface.add_normals();
        surface
    }

    fn add_normals(&mut self) {
        let triangles = self.mesh.triangles();
        let normals = (0..triangles.len()).map(|triangle| {
            let [a, b, c] = self.mesh.corners(triangle);
            (b - a).cross(c - a).normalize_or_zero()
        });
        self.face_normals = normals.collect();
        let key = |a: u32, b: u32| [a.min(b), a.max(b)];
        let mut edges: HashMap<[u32; 2], DVec3> = HashMap::with_capacity(3 * triangles.len() / 2);
        for (index, &triangle) in triangles.iter().enumerate() {
            let normal = self.face_normals[index];
            let places = self.mesh.corners(index);
            for i in 0..3 {
                let (next, last) = ((i + 1) % 3, (i + 2) % 3);
                *edges.entry(key(triangle[i], triangle[next])).or_default() += normal;
                let (out, back) = (places[next] - places[i], places[last] - places[i]);
                let angle = out.cross(back).length().atan2(out.dot(back));
                self.vertex_normals[triangle[i] as usize] += angle * normal;
            }
        }
        self.edge_normals = triangles
            .iter()
            .map(|&[a, b, c]| [key(a, b), key(b, c), key(c, a)].map(|edge| edges[&edge]))
            .collect();
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &ClosedMesh {
        self.mesh
    }

    /// The normal of a vertex, of length 1; zero where the surface has none.
    #[must_use]
    pub fn vertex_normal(&self, vertex: usize) -> DVec3 {
        self.vertex_normals[vertex].normalize_or_zero()
    }

    /// The closest point of the surface, and the distance, negative inside.
    #[must_use]
    pub fn nearest(&self, point: DVec3) -> Nearest {
        self.nearest_within(point, f64::INFINITY)
    }

    /// The same where the surface is known to be no further than `most`, which saves time.
    pub(crate) fn nearest_within(&self, point: DVec3, most: f64) -> Nearest {
        // A little more, so that the place that is known is found again.
        let mut best = most * most * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        let mut found = (0, DVec3::ZERO, Feature::Face);
        let mut stack = [(0_u32, 0.0); 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (index, distance) = stack[depth];
            if distance >= best {
                continue;
            }
            let node = self.boxes[index as usize];
            if node.count > 0 {
                let range = node.first as usize..(node.first + node.count) as usize;
                for (place, corners) in range.clone().zip(&self.corners[range]) {
                    let (closest, feature) = closest_point(*corners, point);
                    let distance = closest.distance_squared(point);
                    if distance < best {
                        best = distance;
                        found = (place, closest, feature);
                    }
                }
            } else {
                let near = (index + 1, self.boxes[index as usize + 1].distance_squared(point));
                let far = (node.first, self.boxes[node.first as usize].distance_squared(point));
                let [near, far] = if near.1 <= far.1 { [near, far] } else { [far, near] };
                stack[depth] = far;
                stack[depth + 1] = near;
                depth += 2;
            }
        }
        let (place, closest, feature) = found;
        let triangle = self.order[place] as usize;
        let normal = match feature {
            Feature::Face => self.face_normals[triangle],
            Feature::Edge(edge) => self.edge_normals[triangle][edge],
            Feature::Vertex(corner) => self.vertex_normals[self.mesh.triangles()[triangle][corner] as usize],
        };
        let sign = if (point - closest).dot(normal) < 0.0 { -1.0 } else { 1.0 };
        Nearest { point: closest, triangle, signed: sign * best.sqrt() }
    }

    /// Distance to the surface, negative inside.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        self.nearest(point).signed
    }
}

/// Boxes of the triangles `order`, which begin at place `first` of all; half of them on each side of the longest extent.
fn split(mesh: &ClosedMesh, order: &mut [u32], first: u32, boxes: &mut Vec<BoxNode>) {
    let mut node =
        BoxNode { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, first, count: order.len() as u32 };
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let middle = |triangle: u32| mesh.corners(triangle as usize).into_iter().sum::<DVec3>();
    for &triangle in order.iter() {
        for corner in mesh.corners(triangle as usize) {
            node.low = node.low.min(corner);
            node.high = node.high.max(corner);
        }
        low = low.min(middle(triangle));
        high = high.max(middle(triangle));
    }
    let index = boxes.len();
    boxes.push(node);
    if order.len() <= LEAF {
        return;
    }
    let axis = (high - low).max_position();
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |&a, &b| {
        middle(a)[axis].total_cmp(&middle(b)[axis]).then_with(|| a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(half);
    split(mesh, left, first, boxes);
    boxes[index].first = boxes.len() as u32;
    boxes[index].count = 0;
    split(mesh, right, first + half as u32, boxes);
}

/// What of a triangle is closest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Feature {
    Face,
    /// From this corner to the next.
    Edge(usize),
    Vertex(usize),
}

/// The closest point of a triangle (Ericson 2005, "Real-Time Collision Detection", 5.1.5).
fn closest_point([a, b, c]: [DVec3; 3], p: DVec3) -> (DVec3, Feature) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, Feature::Vertex(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, Feature::Vertex(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, Feature::Vertex(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Feature::Edge(1));
    }
    let sum = va + vb + vc;
    (a + ab * (vb / sum) + ac * (vc / sum), Feature::Face)
}

/// Distance of a point from a triangle.
pub(crate) fn distance_to_triangle(corners: [DVec3; 3], point: DVec3) -> f64 {
    closest_point(corners, point).0.distance(point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isosurface::isosurface;

    #[test]
    fn distances_are_those_of_brute_force_and_signs_those_of_the_solid() {
        let torus = |p: DVec3| p.z.hypot(p.x.hypot(p.y) - 0.7) - 0.25;
        let mesh = isosurface([DVec3::splat(-1.1), DVec3::splat(1.1)], 0.11, torus).unwrap();
        let surface = MeshSurface::new(&mesh);
        let (mut inside, mut seed) = (0, 1_u64);
        for _ in 0..500 {
            let mut next = || {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (seed >> 11) as f64 / (1_u64 << 53) as f64 * 2.4 - 1.2
            };
            let point = DVec3::new(next(), next(), next());
            let found = surface.nearest(point);
            let least = (0..mesh.triangles().len())
                .map(|triangle| distance_to_triangle(mesh.corners(triangle), point))
                .fold(f64::INFINITY, f64::min);
            assert!((found.signed.abs() - least).abs() < 1e-12);
            assert!((found.point.distance(point) - least).abs() < 1e-12);
            if torus(point).abs() > 0.02 {
                assert_eq!(found.signed < 0.0, torus(point) < 0.0, "{point}");
            }
            inside += usize::from(found.signed < 0.0);
        }
        assert!(inside > 20, "{inside}");
    }
}
