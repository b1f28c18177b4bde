//! Which pixels a triangle covers: those whose centre lies inside it, and of centres on an edge those on
//! its top or left edges. So triangles that share an edge cover each pixel along it exactly once.
//!
//! Positions are in 1/256 pixel, the centre of pixel i is at 256 i + 128, and everything is exact integer
//! arithmetic.

use std::ops::Range;

/// One pixel in snapped units.
pub(crate) const UNIT: i64 = 256;

const CENTRE: i64 = UNIT / 2;

/// A position in 1/256 pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Snapped {
    pub(crate) x: i64,
    pub(crate) y: i64,
}

/// The pixels that may be drawn on: `left..right` by `top..bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Clip {
    pub(crate) left: i64,
    pub(crate) top: i64,
    pub(crate) right: i64,
    pub(crate) bottom: i64,
}

impl Snapped {
    /// Positions are held this close to the origin, in pixels, so that no product overflows.
    const LIMIT: f64 = 262_144.0;

    /// Rounds a position in pixels; `None` if it is not finite.
    pub(crate) fn new(x: f32, y: f32) -> Option<Self> {
        let snap = |v: f32| (f64::from(v).clamp(-Self::LIMIT, Self::LIMIT) * UNIT as f64).round() as i64;
        (x.is_finite() && y.is_finite()).then(|| Self { x: snap(x), y: snap(y) })
    }
}

/// The pixels whose centre is in `from..to`, both snapped.
pub(crate) fn pixels_between(from: i64, to: i64) -> Range<i64> {
    ceil_div(from - CENTRE, UNIT)..ceil_div(to - CENTRE, UNIT)
}

/// Twice the signed area: positive for clockwise on a screen whose y points down.
pub(crate) fn doubled_area([a, b, c]: [Snapped; 3]) -> i64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Calls `span(row, pixels)` for every row of `clip` in which the triangle covers pixels, from the top.
///
/// The corners may be in either order. A triangle without area covers nothing.
pub(crate) fn for_each_span(corners: [Snapped; 3], clip: Clip, mut span: impl FnMut(i64, Range<i64>)) {
    let [a, mut b, mut c] = corners;
    match doubled_area(corners) {
        0 => return,
        area if area < 0 => std::mem::swap(&mut b, &mut c),
        _ => {}
    }
    let top = a.y.min(b.y).min(c.y);
    let bottom = a.y.max(b.y).max(c.y);
    let first = ceil_div(top - CENTRE, UNIT).max(clip.top);
    let last = (bottom - CENTRE).div_euclid(UNIT).min(clip.bottom - 1);
    if first > last {
        return;
    }
    for row in first..=last {
        let centre = row * UNIT + CENTRE;
        let (mut left, mut right) = (clip.left, clip.right);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            // Inside is where E = (to.x − from.x)(y − from.y) − (to.y − from.y)(x − from.x) is positive, or zero on a top
            // or left edge. It is `start` at the centre of the row's pixel 0, and `slope` · `UNIT` more with each pixel.
            let (along, slope) = (to.x - from.x, from.y - to.y);
            let start = along * (centre - from.y) + slope * (CENTRE - from.x);
            match slope.signum() {
                1 => left = left.max(ceil_div(-start, slope * UNIT)),
                -1 => right = right.min(ceil_div(start, -slope * UNIT)),
                _ if start < i64::from(along < 0) => right = left,
                _ => {}
            }
        }
        if left < right {
            span(row, left..right);
        }
    }
}

fn ceil_div(numerator: i64, divisor: i64) -> i64 {
    -(-numerator).div_euclid(divisor)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLIP: Clip = Clip { left: 0, top: 0, right: 12, bottom: 8 };

    fn snapped(points: [(f32, f32); 3]) -> [Snapped; 3] {
        points.map(|(x, y)| Snapped::new(x, y).unwrap())
    }

    fn count(triangles: &[[Snapped; 3]]) -> Vec<String> {
        let mut hits = vec![vec![0_u8; 12]; 8];
        for triangle in triangles {
            for_each_span(*triangle, CLIP, |row, pixels| {
                for x in pixels {
                    hits[row as usize][x as usize] += 1;
                }
            });
        }
        let glyph = |n: &u8| if *n == 0 { '.' } else { char::from(b'0' + n) };
        hits.iter().map(|row| row.iter().map(glyph).collect()).collect()
    }

    #[test]
    fn a_triangle_covers_the_centres_inside_it() {
        let rows = count(&[snapped([(1.0, 1.0), (11.0, 1.0), (1.0, 6.0)])]);
        assert_eq!(
            rows,
            [
                "............",
                ".111111111..",
                ".1111111....",
                ".11111......",
                ".111........",
                ".1..........",
                "............",
                "............",
            ]
        );
    }

    #[test]
    fn ties_belong_to_top_and_left_edges() {
        let square = [(2.5, 2.5), (6.5, 2.5), (6.5, 5.5), (2.5, 5.5)];
        let [a, b, c, d] = square.map(|(x, y)| Snapped::new(x, y).unwrap());
        let expected = [
            "............",
            "............",
            "..1111......",
            "..1111......",
            "..1111......",
            "............",
            "............",
            "............",
        ];
        assert_eq!(count(&[[a, b, c], [a, c, d]]), expected);
        assert_eq!(count(&[[a, c, b], [a, d, c]]), expected);
        assert_eq!(count(&[[a, b, d], [d, b, c]]), expected);
    }

    /// A fan about a point, all its edges shared: the union must be the square, each pixel once.
    #[test]
    fn neighbours_share_no_pixel_and_leave_none() {
        for step in 0..200 {
            let hub = Snapped { x: 300 + step * 13 % 2200, y: 280 + step * 29 % 1400 };
            let ring = [(0, 0), (1500, 0), (3072, 0), (3072, 2048), (911, 2048), (0, 2048), (0, 77)]
                .map(|(x, y)| Snapped { x, y });
            let fan: Vec<_> = (0..ring.len()).map(|i| [hub, ring[i], ring[(i + 1) % ring.len()]]).collect();
            for row in count(&fan) {
                assert_eq!(row, "1".repeat(12), "hub {hub:?}");
            }
        }
    }

    #[test]
    fn walking_rows_equals_testing_every_pixel() {
        let mut seed = 7_u64;
        let mut random = |span: i64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as i64 % span - span / 6
        };
        for _ in 0..500 {
            let corners = [(); 3].map(|()| Snapped { x: random(4600), y: random(3100) });
            let area = doubled_area(corners);
            let mut walked = [[false; 12]; 8];
            for_each_span(corners, CLIP, |row, pixels| {
                pixels.for_each(|x| walked[row as usize][x as usize] = true);
            });
            let [a, b, c] = if area < 0 { [corners[0], corners[2], corners[1]] } else { corners };
            for (row, cells) in walked.iter().enumerate() {
                for (column, cell) in cells.iter().enumerate() {
                    let p = Snapped { x: column as i64 * UNIT + 128, y: row as i64 * UNIT + 128 };
                    let inside = [(a, b), (b, c), (c, a)].iter().all(|(from, to)| {
                        let e = doubled_area([*from, *to, p]);
                        let top_left = to.y < from.y || (to.y == from.y && to.x > from.x);
                        e > 0 || (e == 0 && top_left)
                    });
                    assert_eq!(*cell, area != 0 && inside, "{corners:?} at {column}, {row}");
                }
            }
        }
    }

    #[test]
    fn far_and_flat_triangles_are_harmless() {
        assert!(Snapped::new(f32::NAN, 0.0).is_none());
        assert_eq!(count(&[snapped([(-1e30, -1e30), (1e30, -1e30), (0.0, 1e30)])])[3], "1".repeat(12));
        assert_eq!(count(&[snapped([(1.0, 1.0), (5.0, 5.0), (9.0, 9.0)])]).concat().matches('1').count(), 0);
    }
}
