//! A closed mesh of where a function is negative, by marching tetrahedra: each cube of a grid is six tetrahedra about its
//! diagonal, and in each the surface is one triangle or two (Doi and Koide 1991). Neighbours share their corners, so the mesh is
//! closed for any function that is positive at the rim of the grid.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::{ClosedMesh, MeshError};

/// Most points of the grid.
const MAX_POINTS: usize = 1 << 26;

/// A value at the rim, in steps: so large that a solid is closed where the bounds are, and not a step beyond.
const RIM: f64 = 100.0;

/// Corners of the six tetrahedra of a cube, as bits x, y, z of an offset; each begins at 0 and ends at the opposite corner 7.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// The surface between where `value` is negative, inside, and where it is not, within `bounds` (low and high corner) on a grid of
/// `step`. Outside the grid nothing is inside: a solid that reaches its rim is closed there.
///
/// # Errors
/// Nothing negative within the bounds, or a grid of more than 2²⁶ points.
pub fn isosurface(
    [low, high]: [DVec3; 2],
    step: f64,
    value: impl Fn(DVec3) -> f64 + Sync,
) -> Result<ClosedMesh, MeshError> {
    let cells = ((high - low) / step).ceil().max(DVec3::ONE);
    let total = (cells + 3.0).element_product();
    if !total.is_finite() || total > MAX_POINTS as f64 {
        return Err(MeshError::TooLarge { what: "grid points", found: total as usize });
    }
    let size = cells.to_array().map(|cells| cells as usize + 3);
    let place = |[x, y, z]: [usize; 3]| low + step * (DVec3::new(x as f64, y as f64, z as f64) - 1.0);
    let index = |[x, y, z]: [usize; 3]| (z * size[1] + y) * size[0] + x;
    let mut values = vec![0.0; size.iter().product()];
    values.par_chunks_mut(size[0] * size[1]).enumerate().for_each(|(z, layer)| {
        for (place_in_layer, slot) in layer.iter_mut().enumerate() {
            let at = [place_in_layer % size[0], place_in_layer / size[0], z];
            let is_rim = at.iter().zip(size).any(|(&i, size)| i == 0 || i + 1 == size);
            let found = value(place(at));
            // A value of nothing would put several corners at one place.
            let least = 1e-3 * step;
            *slot = match (is_rim, found < 0.0) {
                (true, _) => found.max(RIM * step),
                (false, true) => found.min(-least),
                (false, false) => found.max(least),
            };
        }
    });
    let mut corners: HashMap<[u32; 2], u32> = HashMap::new();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for z in 0..size[2] - 1 {
        for y in 0..size[1] - 1 {
            for x in 0..size[0] - 1 {
                let cube: [[usize; 3]; 8] =
                    std::array::from_fn(|bits| [x + (bits & 1), y + (bits >> 1 & 1), z + (bits >> 2 & 1)]);
                let is_inside = cube.map(|at| values[index(at)] < 0.0);
                if is_inside.iter().all(|inside| *inside == is_inside[0]) {
                    continue;
                }
                for tetrahedron in TETRAHEDRA {
                    let mut crossing = |from: usize, to: usize| {
                        let [a, b] = [cube[from], cube[to]].map(index);
                        let key = [a.min(b) as u32, a.max(b) as u32];
                        *corners.entry(key).or_insert_with(|| {
                            let share = values[a] / (values[a] - values[b]);
                            vertices.push(place(cube[from]).lerp(place(cube[to]), share));
                            vertices.len() as u32 - 1
                        })
                    };
                    let (inner, outer): (Vec<usize>, Vec<usize>) =
                        tetrahedron.iter().copied().partition(|&corner| is_inside[corner]);
                    let pieces = cut(&inner, &outer, &mut crossing);
                    for mut piece in pieces.into_iter().flatten() {
                        let [a, b, c] = piece.map(|corner| vertices[corner as usize]);
                        let outwards = place(cube[outer[0]]) - place(cube[inner[0]]);
                        if (b - a).cross(c - a).dot(outwards) < 0.0 {
                            piece.swap(1, 2);
                        }
                        triangles.push(piece);
                    }
                }
            }
        }
    }
    ClosedMesh::new(&vertices, &triangles)
}

/// The triangles that part the inner corners of a tetrahedron from the outer ones.
fn cut(
    inner: &[usize],
    outer: &[usize],
    crossing: &mut impl FnMut(usize, usize) -> u32,
) -> [Option<[u32; 3]>; 2] {
    match (inner, outer) {
        (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => {
            [Some([crossing(a, b), crossing(a, c), crossing(a, d)]), None]
        }
        (&[a, b], &[c, d]) => {
            let [ac, ad, bc, bd] = [crossing(a, c), crossing(a, d), crossing(b, c), crossing(b, d)];
            [Some([ac, ad, bd]), Some([ac, bd, bc])]
        }
        _ => [None, None],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_closed_and_has_its_volume_also_where_the_grid_ends() {
        let ball = |p: DVec3| p.length() - 1.0;
        let mesh = isosurface([DVec3::splat(-1.1), DVec3::splat(1.1)], 0.1, ball).unwrap();
        let volume = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((mesh.volume() / volume - 1.0).abs() < 0.01, "{}", mesh.volume());
        let half = isosurface([DVec3::splat(-1.1), DVec3::new(1.1, 1.1, 0.0)], 0.1, ball).unwrap();
        assert!((half.volume() / volume - 0.5).abs() < 0.05, "{}", half.volume());
        assert_eq!(isosurface([DVec3::ZERO, DVec3::ONE], 0.1, |_| 1.0), Err(MeshError::Empty));
        assert!(isosurface([DVec3::ZERO, DVec3::ONE], 1e-4, |_| 1.0).is_err());
    }
}
