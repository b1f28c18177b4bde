//! Polylines with as few points as they need: the window pays for each of them in every frame.

use glam::DVec2;

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

    use glam::dvec2;
    use proptest::prelude::*;

    use super::*;

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
