//! Closed triangle meshes: what a solid is bounded by.

use std::collections::HashMap;

use glam::DVec3;
use thiserror::Error;

/// Most vertices and most triangles of a mesh.
pub const MAX_ELEMENTS: usize = 1 << 22;

/// Why triangles do not bound a solid.
#[derive(Debug, Clone, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum MeshError {
    #[error("has no triangles; expected the triangles of a closed surface")]
    Empty,
    #[error("has {found} {what}; expected at most {MAX_ELEMENTS}")]
    TooLarge { what: &'static str, found: usize },
    #[error("vertex {vertex} is ({}, {}, {}); expected finite numbers of at most 1e9", place.x, place.y, place.z)]
    Vertex { vertex: usize, place: DVec3 },
    #[error("triangle {triangle} names vertex {found}; there are {count}, counted from 0")]
    Index { triangle: usize, found: u32, count: usize },
    #[error(
        "is not closed: {edges} edges have no triangle on their other side, the first from ({:.4}, {:.4}, {:.4}) to \
         ({:.4}, {:.4}, {:.4}); expected a surface without holes", from.x, from.y, from.z, to.x, to.y, to.z
    )]
    Open { edges: usize, from: DVec3, to: DVec3 },
    #[error(
        "has no inside: around the edge from ({:.4}, {:.4}, {:.4}) to ({:.4}, {:.4}, {:.4}) triangles do not all turn \
         the same way; expected a surface with two sides", from.x, from.y, from.z, to.x, to.y, to.z
    )]
    Sides { from: DVec3, to: DVec3 },
    #[error("encloses no volume; expected the surface of a solid")]
    Flat,
}

/// A closed surface of triangles, anticlockwise seen from outside. It may have several parts, and holes as a torus has.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedMesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// One use of an edge: its ends in order of their numbers, the triangle, and whether it runs from the lower to the higher.
type EdgeUse = ([u32; 2], u32, bool);

impl ClosedMesh {
    /// From vertices (any unit) and triangles that name them. Vertices at one place become one, triangles without area between
    /// them are left out, and triangles that turn against their neighbours are turned. A surface inside out is turned.
    ///
    /// # Errors
    /// No triangles or too many, numbers that are not finite, an index beyond the vertices, a surface with a border, with one side
    /// only, or without volume.
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        for (what, found) in [("vertices", vertices.len()), ("triangles", triangles.len())] {
            if found > MAX_ELEMENTS {
                return Err(MeshError::TooLarge { what, found });
            }
        }
        let is_bad = |place: &DVec3| !place.is_finite() || place.abs().max_element() > 1e9;
        if let Some(vertex) = vertices.iter().position(is_bad) {
            return Err(MeshError::Vertex { vertex, place: vertices[vertex] });
        }
        let mut mesh = Self::welded(vertices, triangles)?;
        if mesh.triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        mesh.turn_alike()?;
        let [low, high] = mesh.bounds();
        let volume = mesh.volume();
        if volume.abs() <= 1e-12 * (high - low).length().powi(3) {
            return Err(MeshError::Flat);
        }
        if volume < 0.0 {
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        Ok(mesh)
    }

    /// Places of the vertices.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Vertices of the triangles, anticlockwise seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Places of a triangle's corners.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }

    /// The lowest and the highest coordinates.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        self.vertices.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], vertex| {
            [low.min(*vertex), high.max(*vertex)]
        })
    }

    /// The enclosed volume, cubic units.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let origin = self.vertices[0];
        let tetrahedron = |triangle: usize| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - origin);
            a.dot(b.cross(c)) / 6.0
        };
        (0..self.triangles.len()).map(tetrahedron).sum()
    }

    /// The area of all triangles, square units.
    #[must_use]
    pub fn area(&self) -> f64 {
        let area = |triangle: usize| {
            let [a, b, c] = self.corners(triangle);
            0.5 * (b - a).cross(c - a).length()
        };
        (0..self.triangles.len()).map(area).sum()
    }

    /// The connected part with the largest area, the first of equals.
    #[must_use]
    pub fn largest_part(self) -> Self {
        let larger = |best: Self, part: Self| if part.area() > best.area() { part } else { best };
        self.parts().into_iter().reduce(larger).unwrap_or(self)
    }

    /// The connected parts, each turned outwards, in the order of their first triangles. A part of a closed surface is closed.
    #[must_use]
    pub fn parts(&self) -> Vec<Self> {
        // The lowest vertex that each vertex hangs together with, by chains of lower ones.
        let mut lower: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let lowest = |lower: &mut [u32], mut vertex: u32| {
            while lower[vertex as usize] != vertex {
                lower[vertex as usize] = lower[lower[vertex as usize] as usize];
                vertex = lower[vertex as usize];
            }
            vertex
        };
        for &[a, b, c] in &self.triangles {
            let roots = [a, b, c].map(|vertex| lowest(&mut lower, vertex));
            let least = roots[0].min(roots[1]).min(roots[2]);
            roots.iter().for_each(|&root| lower[root as usize] = least);
        }
        let mut places: HashMap<u32, usize> = HashMap::new();
        let mut parts: Vec<Vec<[u32; 3]>> = Vec::new();
        for triangle in &self.triangles {
            let place = *places.entry(lowest(&mut lower, triangle[0])).or_insert_with(|| {
                parts.push(Vec::new());
                parts.len() - 1
            });
            parts[place].push(*triangle);
        }
        parts.iter().filter_map(|triangles| Self::new(&self.vertices, triangles).ok()).collect()
    }

    /// The same with every vertex at another place; the map must not turn the surface inside out.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn map(&self, place: impl Fn(DVec3) -> DVec3) -> Result<Self, MeshError> {
        let vertices: Vec<DVec3> = self.vertices.iter().map(|vertex| place(*vertex)).collect();
        Self::new(&vertices, &self.triangles)
    }

    fn welded(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let mut known: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
        let mut places = Vec::new();
        let mut kept = Vec::with_capacity(triangles.len());
        for (index, triangle) in triangles.iter().enumerate() {
            let mut corners = [0; 3];
            for (corner, &vertex) in corners.iter_mut().zip(triangle) {
                let Some(place) = vertices.get(vertex as usize) else {
                    return Err(MeshError::Index { triangle: index, found: vertex, count: vertices.len() });
                };
                // Zero has two signs and one place.
                let key = (*place + DVec3::ZERO).to_array().map(f64::to_bits);
                *corner = *known.entry(key).or_insert_with(|| {
                    places.push(*place);
                    places.len() as u32 - 1
                });
            }
            let [a, b, c] = corners;
            if a != b && b != c && c != a {
                kept.push(corners);
            }
        }
        Ok(Self { vertices: places, triangles: kept })
    }

    fn edge_uses(&self) -> Vec<EdgeUse> {
        let mut uses = Vec::with_capacity(3 * self.triangles.len());
        for (index, &[a, b, c]) in self.triangles.iter().enumerate() {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                uses.push(([from.min(to), from.max(to)], index as u32, from < to));
            }
        }
        uses.sort_unstable();
        uses
    }

    fn ends(&self, [from, to]: [u32; 2]) -> [DVec3; 2] {
        [self.vertices[from as usize], self.vertices[to as usize]]
    }

    /// Turns triangles until all turn as their neighbours do.
    fn turn_alike(&mut self) -> Result<(), MeshError> {
        let uses = self.edge_uses();
        let edges = || uses.chunk_by(|a, b| a.0 == b.0);
        let mut open = edges().filter(|edge| edge.len() % 2 == 1);
        if let Some(first) = open.next() {
            let [from, to] = self.ends(first[0].0);
            return Err(MeshError::Open { edges: 1 + open.count(), from, to });
        }
        let is_balanced = |edge: &[EdgeUse]| 2 * edge.iter().filter(|use_| use_.2).count() == edge.len();
        if edges().all(is_balanced) {
            return Ok(());
        }
        let mut neighbours: Vec<Vec<(u32, bool)>> = vec![Vec::new(); self.triangles.len()];
        for edge in edges() {
            if let [(_, a, a_up), (_, b, b_up)] = *edge {
                neighbours[a as usize].push((b, a_up == b_up));
                neighbours[b as usize].push((a, a_up == b_up));
            }
        }
        self.turn_parts(&neighbours);
        let uses = self.edge_uses();
        match uses.chunk_by(|a, b| a.0 == b.0).find(|edge| !is_balanced(edge)) {
            None => Ok(()),
            Some(edge) => {
                let [from, to] = self.ends(edge[0].0);
                Err(MeshError::Sides { from, to })
            }
        }
    }

    /// Each connected part turned alike, with its volume positive.
    fn turn_parts(&mut self, neighbours: &[Vec<(u32, bool)>]) {
        let mut is_seen = vec![false; self.triangles.len()];
        for first in 0..self.triangles.len() {
            if is_seen[first] {
                continue;
            }
            is_seen[first] = true;
            let mut part = vec![(first as u32, false)];
            let mut next = 0;
            while let Some(&(triangle, is_turned)) = part.get(next) {
                next += 1;
                for &(other, differs) in &neighbours[triangle as usize] {
                    if !std::mem::replace(&mut is_seen[other as usize], true) {
                        part.push((other, is_turned != differs));
                    }
                }
            }
            let origin = self.corners(first)[0];
            let mut volume = 0.0;
            for &(triangle, is_turned) in &part {
                if is_turned {
                    self.triangles[triangle as usize].swap(1, 2);
                }
                let [a, b, c] = self.corners(triangle as usize).map(|corner| corner - origin);
                volume += a.dot(b.cross(c));
            }
            if volume < 0.0 {
                part.iter().for_each(|&(triangle, _)| self.triangles[triangle as usize].swap(1, 2));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        (vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    }

    #[test]
    fn triangles_are_turned_and_welded() {
        let (vertices, triangles) = tetrahedron();
        let mesh = ClosedMesh::new(&vertices, &triangles).unwrap();
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15);
        // Inside out, one turned, each with vertices of its own: the same solid.
        for turned in [vec![0, 1, 2, 3], vec![2], vec![0, 3]] {
            let mut other = triangles.clone();
            turned.iter().for_each(|&index: &usize| other[index].swap(0, 1));
            let soup: Vec<DVec3> = other.iter().flatten().map(|&vertex| vertices[vertex as usize]).collect();
            let own: Vec<[u32; 3]> = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = ClosedMesh::new(&soup, &own).unwrap();
            assert_eq!(mesh.vertices().len(), 4);
            assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15, "{turned:?}");
        }
    }

    #[test]
    fn the_largest_part_is_what_hangs_together() {
        let (mut vertices, mut triangles) = tetrahedron();
        vertices.extend(vertices.clone().iter().map(|place| 0.5 * *place + DVec3::splat(3.0)));
        triangles.extend(triangles.clone().iter().map(|triangle| triangle.map(|vertex| vertex + 4)));
        for order in [[0, 1], [1, 0]] {
            let ordered = order.map(|part| &triangles[4 * part..4 * part + 4]).concat();
            let part = ClosedMesh::new(&vertices, &ordered).unwrap().largest_part();
            assert_eq!((part.vertices().len(), part.triangles().len()), (4, 4));
            assert!((part.volume() - 1.0 / 6.0).abs() < 1e-15);
            assert!((part.area() - (1.5 + 0.75_f64.sqrt())).abs() < 1e-12);
        }
    }

    #[test]
    fn what_bounds_no_solid_is_told_in_words() {
        let (vertices, triangles) = tetrahedron();
        let message = |vertices: &[DVec3], triangles: &[[u32; 3]]| {
            ClosedMesh::new(vertices, triangles).unwrap_err().to_string()
        };
        assert!(message(&vertices, &[]).contains("has no triangles"));
        let open = message(&vertices, &triangles[1..]);
        assert!(
            open.contains("is not closed: 3 edges") && open.contains("(1.0000, 0.0000, 0.0000)"),
            "{open}"
        );
        let index = message(&vertices, &[[0, 1, 4]]);
        assert!(index.contains("triangle 0 names vertex 4; there are 4"), "{index}");
        let mut bad = vertices.clone();
        bad[2].y = f64::NAN;
        assert!(message(&bad, &triangles).contains("vertex 2 is (0, NaN, 0)"));
        let flat: Vec<DVec3> = vertices.iter().map(|v| DVec3::new(v.x, v.y, 0.0)).collect();
        assert!(message(&flat, &triangles).contains("no volume"), "{}", message(&flat, &triangles));
        // A surface with one side: a Möbius band of five triangles, its border closed by a cone.
        let band: Vec<[u32; 3]> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
        let rim = |i: u32| [i, (i + 2) % 5, 5];
        let all: Vec<[u32; 3]> = band.into_iter().chain((0..5).map(rim)).collect();
        let places: Vec<DVec3> =
            (0..6).map(|i| DVec3::new(f64::from(i * i), f64::from(i), f64::from(i * i * i % 7))).collect();
        assert!(message(&places, &all).contains("has no inside"), "{}", message(&places, &all));
    }
}
