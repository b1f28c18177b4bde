//! The body's outline: the line on which the prediction Λ is half subject, by marching squares.
//!
//! Between four pixel centres the line crosses each edge whose ends lie on both sides of the level, where linear
//! interpolation says. A saddle is cut by the mean of its corners. Beyond the picture everything is background.

use glam::DVec2;

use super::input::HALF;
use super::polyline::simplified_closed;

/// Points of the line that lie nearer than this to what is left of it are dropped, pixels.
const TOLERANCE_PX: f64 = 0.05;

/// Marks an edge that the line does not cross.
const NONE: usize = usize::MAX;

/// Closed polylines in pixel coordinates around the pixels with Λ < 127.5, the body on the right as seen on the
/// screen. The last point joins the first and does not repeat it. `lambda` that is not `width` × `height` long
/// has no outline.
pub fn body_outline(lambda: &[f32], width: usize, height: usize) -> Vec<Vec<DVec2>> {
    if width == 0 || lambda.len() != width * height {
        return Vec::new();
    }
    let lines = Grid::around_subject(lambda, width).map_or_else(Vec::new, |grid| grid.trace());
    lines.iter().map(|line| simplified_closed(line, TOLERANCE_PX)).collect()
}

/// The box of the subject with a border of one pixel, numbered row by row.
struct Grid<'a> {
    lambda: &'a [f32],
    picture_width: usize,
    /// The pixel at the grid's corner; one left of the subject, so −1 at the least.
    corner: [isize; 2],
    width: usize,
    height: usize,
}

impl<'a> Grid<'a> {
    fn around_subject(lambda: &'a [f32], picture_width: usize) -> Option<Self> {
        let mut bounds: Option<[usize; 4]> = None;
        for (y, row) in lambda.chunks_exact(picture_width).enumerate() {
            let Some(first) = row.iter().position(|level| *level < HALF) else { continue };
            let last = row.iter().rposition(|level| *level < HALF).unwrap_or(first);
            let [left, top, right, _] = bounds.unwrap_or([first, y, last, y]);
            bounds = Some([left.min(first), top, right.max(last), y]);
        }
        let [left, top, right, bottom] = bounds?;
        Some(Self {
            lambda,
            picture_width,
            corner: [left as isize - 1, top as isize - 1],
            width: right - left + 3,
            height: bottom - top + 3,
        })
    }

    fn level(&self, column: usize, row: usize) -> f32 {
        let x = usize::try_from(column as isize + self.corner[0]).ok().filter(|x| *x < self.picture_width);
        let y = usize::try_from(row as isize + self.corner[1]).ok();
        let level = x.zip(y).and_then(|(x, y)| self.lambda.get(y * self.picture_width + x)).copied();
        level.filter(|level| level.is_finite()).unwrap_or(255.0)
    }

    /// The edge from a grid point to the right (`down` false) or downwards.
    fn edge(&self, column: usize, row: usize, down: bool) -> usize {
        2 * (row * self.width + column) + usize::from(down)
    }

    /// Where the line crosses an edge, in pixel coordinates.
    fn crossing(&self, edge: usize) -> DVec2 {
        let (point, down) = (edge / 2, edge % 2);
        let (column, row) = (point % self.width, point / self.width);
        let from = self.level(column, row);
        let to = self.level(column + 1 - down, row + down);
        let share = (HALF - from) / (to - from);
        let x = (column as isize + self.corner[0]) as f32;
        let y = (row as isize + self.corner[1]) as f32;
        let [x, y] = if down == 1 { [x, y + share] } else { [x + share, y] };
        DVec2::new(f64::from(x), f64::from(y))
    }

    /// For each edge, the edge that the line crosses next.
    fn successors(&self) -> Vec<usize> {
        let mut next = vec![NONE; 2 * self.width * self.height];
        for row in 0..self.height - 1 {
            for column in 0..self.width - 1 {
                let corners = [
                    self.level(column, row),
                    self.level(column + 1, row),
                    self.level(column + 1, row + 1),
                    self.level(column, row + 1),
                ];
                let edges = [
                    self.edge(column, row, false),
                    self.edge(column + 1, row, true),
                    self.edge(column, row + 1, false),
                    self.edge(column, row, true),
                ];
                self.link_cell(corners, edges, &mut next);
            }
        }
        next
    }

    /// Corners and edges run clockwise from the upper left corner and the upper edge. With the subject on the
    /// right, the line enters a cell where, clockwise, subject turns into background, and leaves where it turns
    /// back.
    fn link_cell(&self, corners: [f32; 4], edges: [usize; 4], next: &mut [usize]) {
        let is_subject = corners.map(|level| level < HALF);
        let is_saddle = is_subject[0] == is_subject[2] && is_subject[1] == is_subject[3];
        let centre_is_subject = corners.iter().sum::<f32>() / 4.0 < HALF;
        for exit in 0..4 {
            if is_subject[exit] || !is_subject[(exit + 1) % 4] {
                continue;
            }
            // The line goes round the subject's corners behind the exit. In a saddle whose centre is subject,
            // the two corners are one region and the line goes round the background's corner instead.
            let entry = if is_saddle && centre_is_subject {
                (exit + 3) % 4
            } else {
                let mut behind = (1..4).map(|step| (exit + step) % 4);
                behind.find(|&e| is_subject[e] && !is_subject[(e + 1) % 4]).unwrap_or(exit)
            };
            next[edges[entry]] = edges[exit];
        }
    }

    fn trace(&self) -> Vec<Vec<DVec2>> {
        let mut next = self.successors();
        let mut outlines = Vec::new();
        for start in 0..next.len() {
            let mut outline = Vec::new();
            let mut edge = start;
            while next[edge] != NONE {
                outline.push(self.crossing(edge));
                edge = std::mem::replace(&mut next[edge], NONE);
            }
            if !outline.is_empty() {
                outlines.push(outline);
            }
        }
        outlines
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Positive when clockwise on the screen.
    fn area(outline: &[DVec2]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
    }

    #[test]
    fn a_disc_is_outlined_where_the_ramp_is_half_way() {
        let lambda: Vec<f32> = (0..40 * 40)
            .map(|i| {
                let (x, y) = ((i % 40) as f32 - 19.3, (i / 40) as f32 - 20.6);
                ((x.hypot(y) - 10.0) / 4.0 + 0.5).clamp(0.0, 1.0) * 255.0
            })
            .collect();
        let outlines = body_outline(&lambda, 40, 40);
        assert_eq!(outlines.len(), 1);
        for point in &outlines[0] {
            assert!((point.distance(DVec2::new(19.3, 20.6)) - 10.0).abs() < 0.03, "{point}");
        }
        assert!((area(&outlines[0]) - std::f64::consts::PI * 100.0).abs() < 2.0);
        assert!(outlines[0].len() < 60, "{} points", outlines[0].len());
    }

    #[test]
    fn a_body_at_the_border_stays_closed() {
        let outlines = body_outline(&[0.0; 4], 2, 2);
        assert_eq!(outlines.len(), 1);
        assert!(area(&outlines[0]) > 1.0);
    }

    #[test]
    fn a_hole_runs_the_other_way() {
        let mut lambda = [0.0; 25];
        lambda[12] = 255.0;
        let mut areas: Vec<f64> = body_outline(&lambda, 5, 5).iter().map(|outline| area(outline)).collect();
        areas.sort_by(f64::total_cmp);
        assert!(areas.len() == 2 && areas[0] < 0.0 && areas[1] > 20.0, "{areas:?}");
    }

    #[test]
    fn nothing_and_nonsense_have_no_outline() {
        assert!(body_outline(&[255.0, f32::NAN], 2, 1).is_empty());
        assert!(body_outline(&[0.0; 3], 2, 2).is_empty());
        assert!(body_outline(&[], 0, 0).is_empty());
    }

    proptest! {
        /// Every pixel centre is inside the outlines (by winding) exactly when it is subject.
        #[test]
        fn outlines_separate_subject_from_background(levels in proptest::collection::vec(0.0..255.0_f32, 42)) {
            // Before points are left out: a pixel may lie nearer to the line than those do.
            let outlines = Grid::around_subject(&levels, 7).map_or_else(Vec::new, |grid| grid.trace());
            for (index, level) in levels.iter().enumerate() {
                let (x, y) = ((index % 7) as f64, (index / 7) as f64 + 1e-4);
                let crossings = outlines
                    .iter()
                    .flat_map(|outline| outline.iter().zip(outline.iter().cycle().skip(1)))
                    .filter(|(a, b)| {
                        (a.y > y) != (b.y > y) && x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x)
                    })
                    .count();
                if (level - HALF).abs() > 1.0 {
                    prop_assert_eq!(crossings % 2 == 1, *level < HALF, "pixel {}", index);
                }
            }
        }
    }
}
