//! The body's outline: the line on which the prediction Λ is half subject, by marching squares; and polylines with as
//! few points as they need, since the window pays for each of them in every frame.
//!
//! Between four pixel centres the line crosses each edge whose ends lie on both sides of the level, where linear
//! interpolation says. A saddle is cut by the mean of its corners. Beyond the picture everything is background.

use std::ops::Range;

use backlit_tracking::render::Prediction;
use glam::DVec2;

use super::input::HALF;

/// Points of the line that lie nearer than this to what is left of it are dropped, pixels.
const TOLERANCE_PX: f64 = 0.05;

/// Marks an edge that the line does not cross.
const NONE: usize = usize::MAX;

/// Closed polylines in pixel coordinates around the pixels with Λ < 127.5, the body on the right as seen on the
/// screen. The last point joins the first and does not repeat it.
pub fn body_outline(prediction: &Prediction) -> Vec<Vec<DVec2>> {
    let lines = Grid::around_subject(prediction).map_or_else(Vec::new, |grid| grid.trace());
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
    fn around_subject(prediction: &'a Prediction) -> Option<Self> {
        let (lambda, picture_width) = (&prediction.lambda, prediction.width);
        let mut bounds: Option<[usize; 4]> = None;
        for y in prediction.footprint.rows() {
            let Range { start: from, end: to } = prediction.footprint.columns(y);
            let row = &lambda[y * picture_width + from..y * picture_width + to];
            let Some(Range { start: first, end: past }) = subject_of(row) else { continue };
            let [first, last] = [from + first, from + past - 1];
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

    /// Whether each point of a row of the grid is subject.
    fn is_subject(&self, row: usize, points: &mut Vec<bool>) {
        points.clear();
        points.resize(self.width, false);
        let Ok(y) = usize::try_from(row as isize + self.corner[1]) else { return };
        let Some(levels) = self.lambda.get(y * self.picture_width..(y + 1) * self.picture_width) else {
            return;
        };
        // The first column of the grid is one left of the subject, the last one right of it.
        let first = (self.corner[0] + 1) as usize;
        for (point, level) in points[1..].iter_mut().zip(&levels[first..]) {
            *point = *level < HALF;
        }
    }

    /// For each edge that the line crosses, in their order, the edge that it crosses next.
    fn successors(&self) -> Vec<(usize, usize)> {
        let mut next = Vec::new();
        let (mut above, mut below, mut crossed) = (Vec::new(), Vec::new(), Vec::new());
        self.is_subject(0, &mut above);
        for row in 0..self.height - 1 {
            self.is_subject(row + 1, &mut below);
            crossed_cells(&above, &below, &mut crossed);
            for &column in &crossed {
                let is_subject = [above[column], above[column + 1], below[column + 1], below[column]];
                let edges = [
                    self.edge(column, row, false),
                    self.edge(column + 1, row, true),
                    self.edge(column, row + 1, false),
                    self.edge(column, row, true),
                ];
                let centre = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| self.level(column + x, row + y));
                link_cell(is_subject, centre.iter().sum::<f32>() / 4.0 < HALF, edges, &mut next);
            }
            std::mem::swap(&mut above, &mut below);
        }
        next.sort_unstable();
        next
    }

    fn trace(&self) -> Vec<Vec<DVec2>> {
        let mut next = self.successors();
        let mut outlines = Vec::new();
        for start in 0..next.len() {
            let mut outline = Vec::new();
            let mut place = Some(start);
            while let Some((edge, after)) =
                place.and_then(|place| next.get_mut(place)).filter(|(_, after)| *after != NONE)
            {
                outline.push(self.crossing(*edge));
                let after = std::mem::replace(after, NONE);
                place = next.binary_search_by_key(&after, |(edge, _)| *edge).ok();
            }
            if !outline.is_empty() {
                outlines.push(outline);
            }
        }
        outlines
    }
}

/// From the first subject pixel of a row to past the last; many pixels are looked at at once.
fn subject_of(row: &[f32]) -> Option<Range<usize>> {
    const AT_ONCE: usize = 64;
    let is_subject = |level: &f32| *level < HALF;
    let has_subject = |levels: &[f32]| levels.iter().fold(false, |any, level| any | is_subject(level));
    let before =
        row.chunks(AT_ONCE).take_while(|levels| !has_subject(levels)).map(<[f32]>::len).sum::<usize>();
    let behind =
        row.rchunks(AT_ONCE).take_while(|levels| !has_subject(levels)).map(<[f32]>::len).sum::<usize>();
    let first = before + row[before..].iter().position(is_subject)?;
    let last = row[..row.len() - behind].iter().rposition(is_subject)?;
    Some(first..last + 1)
}

/// The cells between two rows of points whose corners are not all alike, many looked at at once.
fn crossed_cells(above: &[bool], below: &[bool], columns: &mut Vec<usize>) {
    const AT_ONCE: usize = 32;
    columns.clear();
    for from in (0..above.len() - 1).step_by(AT_ONCE) {
        let past = (from + AT_ONCE).min(above.len() - 1);
        let [a, b] = [&above[from..past], &above[from + 1..past + 1]];
        let [c, d] = [&below[from..past], &below[from + 1..past + 1]];
        let corners = a.iter().zip(b).zip(c.iter().zip(d));
        let mut crossed = corners.map(|((a, b), (c, d))| (a ^ b) | (a ^ c) | (c ^ d));
        if crossed.clone().fold(false, |any, is_crossed| any | is_crossed) {
            columns.extend((from..past).filter(|_| crossed.next() == Some(true)));
        }
    }
}

/// Corners and edges run clockwise from the upper left corner and the upper edge. With the subject on the right, the line
/// enters a cell where, clockwise, subject turns into background, and leaves where it turns back.
fn link_cell(
    is_subject: [bool; 4],
    centre_is_subject: bool,
    edges: [usize; 4],
    next: &mut Vec<(usize, usize)>,
) {
    let is_saddle = is_subject[0] == is_subject[2] && is_subject[1] == is_subject[3];
    for exit in 0..4 {
        if is_subject[exit] || !is_subject[(exit + 1) % 4] {
            continue;
        }
        // The line goes round the subject's corners behind the exit. In a saddle whose centre is subject, the two corners
        // are one region and the line goes round the background's corner instead.
        let entry = if is_saddle && centre_is_subject {
            (exit + 3) % 4
        } else {
            let mut behind = (1..4).map(|step| (exit + step) % 4);
            behind.find(|&e| is_subject[e] && !is_subject[(e + 1) % 4]).unwrap_or(exit)
        };
        next.push((edges[entry], edges[exit]));
    }
}

/// The polyline without points that lie within `tolerance` of what is left, in the order of before (Douglas and Peucker,
/// 1973). The ends stay.
pub(crate) fn simplified(points: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut stays = vec![false; points.len()];
    stays[0] = true;
    stays[last] = true;
    let mut parts = vec![(0, last)];
    while let Some((from, to)) = parts.pop() {
        if let Some(farthest) = farthest_between(points, from, to, tolerance) {
            stays[farthest] = true;
            parts.extend([(from, farthest), (farthest, to)]);
        }
    }
    points.iter().zip(stays).filter_map(|(point, stays)| stays.then_some(*point)).collect()
}

/// The same of a closed polyline, whose last point joins the first and does not repeat it.
pub(crate) fn simplified_closed(points: &[DVec2], tolerance: f64) -> Vec<DVec2> {
    let Some(first) = points.first() else { return Vec::new() };
    let closed: Vec<DVec2> = points.iter().chain([first]).copied().collect();
    let mut simple = simplified(&closed, tolerance);
    simple.pop();
    simple
}

/// The point between two others that is farthest from the straight line from one to the other, if that is farther than the
/// tolerance.
fn farthest_between(points: &[DVec2], from: usize, to: usize, tolerance: f64) -> Option<usize> {
    let (start, along) = (points[from], points[to] - points[from]);
    let length_squared = along.length_squared();
    let distance_squared = |point: DVec2| {
        let away = point - start;
        let share =
            if length_squared > 0.0 { (away.dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
        (away - share * along).length_squared()
    };
    let inner = (from + 1..to).map(|index| (index, distance_squared(points[index])));
    let (farthest, squared) = inner.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (squared > tolerance * tolerance).then_some(farthest)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use backlit_tracking::render::Footprint;
    use glam::dvec2;
    use proptest::prelude::*;

    use super::*;

    fn prediction(lambda: &[f32], width: usize) -> Prediction {
        let height = lambda.len() / width.max(1);
        let footprint = Footprint::whole([width, height]);
        Prediction { width, height, lambda: lambda.to_vec(), owner: Vec::new(), footprint }
    }

    /// Positive when clockwise on the screen.
    fn area(outline: &[DVec2]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>() / 2.0
    }

    #[test]
    fn the_first_and_last_subject_pixel_of_a_row_are_those_of_a_plain_search() {
        let is_subject = |level: &f32| *level < HALF;
        for seed in 0..300_usize {
            let length = seed % 200;
            let level = |x: usize| if (x * x + 31 * seed) % 97 < seed % 4 { 10.0 } else { 255.0 };
            let row: Vec<f32> = (0..length).map(level).collect();
            let ends = row.iter().position(is_subject).zip(row.iter().rposition(is_subject));
            assert_eq!(subject_of(&row), ends.map(|(first, last)| first..last + 1), "{seed}");
        }
    }

    #[test]
    fn a_disc_is_outlined_where_the_ramp_is_half_way() {
        let lambda: Vec<f32> = (0..40 * 40)
            .map(|i| {
                let (x, y) = ((i % 40) as f32 - 19.3, (i / 40) as f32 - 20.6);
                ((x.hypot(y) - 10.0) / 4.0 + 0.5).clamp(0.0, 1.0) * 255.0
            })
            .collect();
        let outlines = body_outline(&prediction(&lambda, 40));
        assert_eq!(outlines.len(), 1);
        for point in &outlines[0] {
            assert!((point.distance(DVec2::new(19.3, 20.6)) - 10.0).abs() < 0.03, "{point}");
        }
        assert!((area(&outlines[0]) - std::f64::consts::PI * 100.0).abs() < 2.0);
        assert!(outlines[0].len() < 60, "{} points", outlines[0].len());
    }

    #[test]
    fn a_body_at_the_border_stays_closed() {
        let outlines = body_outline(&prediction(&[0.0; 4], 2));
        assert_eq!(outlines.len(), 1);
        assert!(area(&outlines[0]) > 1.0);
    }

    #[test]
    fn a_hole_runs_the_other_way() {
        let mut lambda = [0.0; 25];
        lambda[12] = 255.0;
        let outlines = body_outline(&prediction(&lambda, 5));
        let mut areas: Vec<f64> = outlines.iter().map(|outline| area(outline)).collect();
        areas.sort_by(f64::total_cmp);
        assert!(areas.len() == 2 && areas[0] < 0.0 && areas[1] > 20.0, "{areas:?}");
    }

    #[test]
    fn nothing_and_nonsense_have_no_outline() {
        assert!(body_outline(&prediction(&[255.0, f32::NAN], 2)).is_empty());
        assert!(body_outline(&Prediction::default()).is_empty());
    }

    proptest! {
        /// Every pixel centre is inside the outlines (by winding) exactly when it is subject.
        #[test]
        fn outlines_separate_subject_from_background(levels in proptest::collection::vec(0.0..255.0_f32, 42)) {
            // Before points are left out: a pixel may lie nearer to the line than those do.
            let drawn = prediction(&levels, 7);
            let outlines = Grid::around_subject(&drawn).map_or_else(Vec::new, |grid| grid.trace());
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

    /// Distance from a point to the nearest segment of a polyline.
    fn distance(point: DVec2, line: &[DVec2]) -> f64 {
        let segment = |pair: &[DVec2]| {
            let along = pair[1] - pair[0];
            let share = ((point - pair[0]).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
            (pair[0] + share * along - point).length()
        };
        line.windows(2).map(segment).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn straight_runs_are_two_points_and_corners_stay() {
        let bent: Vec<DVec2> = (0..=10)
            .map(|x| dvec2(f64::from(x), 0.0))
            .chain((1..=10).map(|y| dvec2(10.0, f64::from(y))))
            .collect();
        assert_eq!(simplified(&bent, 0.01), [dvec2(0.0, 0.0), dvec2(10.0, 0.0), dvec2(10.0, 10.0)]);
        assert!(simplified(&[], 0.1).is_empty() && simplified_closed(&[], 0.1).is_empty());
        assert_eq!(simplified(&[dvec2(1.0, 2.0)], 0.1), [dvec2(1.0, 2.0)]);
    }

    #[test]
    fn a_circle_stays_closed_and_round() {
        let circle: Vec<DVec2> =
            (0..400).map(|step| 20.0 * DVec2::from_angle(TAU * f64::from(step) / 400.0)).collect();
        let simple = simplified_closed(&circle, 0.05);
        assert!((20..=100).contains(&simple.len()), "{}", simple.len());
        let again: Vec<DVec2> = simple.iter().chain(&simple[..1]).copied().collect();
        assert!(circle.iter().all(|point| distance(*point, &again) <= 0.05));
    }

    proptest! {
        #[test]
        fn nothing_is_farther_away_than_said(
            coordinates in proptest::collection::vec((-9.0..9.0_f64, -9.0..9.0_f64), 2..60),
            tolerance in 0.01..2.0_f64,
        ) {
            let points: Vec<DVec2> = coordinates.iter().map(|(x, y)| dvec2(*x, *y)).collect();
            let simple = simplified(&points, tolerance);
            prop_assert!(simple.len() <= points.len());
            prop_assert_eq!((simple[0], simple[simple.len() - 1]), (points[0], points[points.len() - 1]));
            for point in &points {
                prop_assert!(distance(*point, &simple) <= tolerance + 1e-9);
            }
        }
    }
}
