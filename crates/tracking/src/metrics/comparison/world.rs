//! How the axes and the unit of a reference lie in the track's world.

use glam::{DMat3, DVec3};

use crate::geometry::umeyama;
use crate::statistics::upper_median;

/// Units that files have, metres each: m, mm, cm, dm, inches, feet.
const UNITS: [f64; 6] = [1.0, 0.001, 0.01, 0.1, 0.0254, 0.3048];
/// A scale within this factor of a unit is the unit: bodies differ by less, units by more.
const SAME_UNIT: f64 = 1.25;
/// Axes turned by less than this, radians, from axes in another order are these axes: 10°.
const SAME_AXES: f64 = 0.175;
/// A body moved by less than this, metres, has not been moved: it is an error of the track, and counts.
const SAME_PLACE_M: f64 = 0.3;
/// Rounds in which the nearer half of the pairs is chosen again.
const ROUNDS: usize = 5;

/// How a reference's world was laid over the track's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorldMatch {
    /// It has the track's axes and unit, perhaps by another order of the axes or in another unit: nothing was fitted.
    Same,
    /// Turned and moved, as found from the joints of all frames together: errors do not count where the body stands.
    Fitted,
}

/// p ↦ scale · rotation · p + translation: from a reference's axes and unit to the track's world, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldMap {
    /// How it was found.
    pub kind: WorldMatch,
    /// Metres in one unit of the reference.
    pub scale: f64,
    /// World from the reference's axes.
    pub rotation: DMat3,
    /// Metres.
    pub translation: DVec3,
}

impl WorldMap {
    /// Nothing is changed.
    pub const SAME: Self =
        Self { kind: WorldMatch::Same, scale: 1.0, rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// A point of the reference in the track's world.
    #[must_use]
    pub fn apply(&self, point: DVec3) -> DVec3 {
        self.scale * (self.rotation * point) + self.translation
    }

    /// Finds it from pairs of a joint in the track and in the reference. Where axes in another order and a unit explain it, nothing is
    /// fitted. Too few joints change nothing.
    pub(super) fn find(pairs: &[[DVec3; 2]]) -> Self {
        let Some(free) = fit(pairs, None) else { return Self::SAME };
        let unit = UNITS.into_iter().find(|unit| (free.scale / unit).max(unit / free.scale) < SAME_UNIT);
        let fitted = unit.and_then(|unit| fit(pairs, Some(unit))).unwrap_or(free);
        let Some(scale) = unit else { return fitted };
        let rotation = nearest_axes(fitted.rotation);
        let same = Self { kind: WorldMatch::Same, scale, rotation, translation: DVec3::ZERO };
        let angle = glam::DQuat::from_mat3(&(rotation.transpose() * fitted.rotation)).to_axis_angle().1;
        let angle = angle.min(std::f64::consts::TAU - angle);
        let mut moved: Vec<f64> =
            pairs.iter().map(|[ours, theirs]| same.apply(*theirs).distance(*ours)).collect();
        let is_near = upper_median(&mut moved).is_some_and(|moved| moved < SAME_PLACE_M);
        if angle < SAME_AXES && is_near { same } else { fitted }
    }
}

/// The similarity of the nearer half of the pairs (least trimmed squares, P. Rousseeuw, JASA 79, 1984), so that mistaken joints do not
/// pull; of a given scale, if there is one.
fn fit(pairs: &[[DVec3; 2]], scale: Option<f64>) -> Option<WorldMap> {
    let (mut ours, mut theirs): (Vec<DVec3>, Vec<DVec3>) = pairs.iter().map(|[a, b]| (*a, *b)).unzip();
    let mut map: Option<WorldMap> = None;
    for _ in 0..ROUNDS {
        if let Some(map) = map {
            let mut judged: Vec<(f64, [DVec3; 2])> =
                pairs.iter().map(|pair| (map.apply(pair[1]).distance(pair[0]), *pair)).collect();
            judged.sort_by(|a, b| a.0.total_cmp(&b.0));
            judged.truncate(pairs.len().div_ceil(2).max(3));
            (ours, theirs) = judged.iter().map(|(_, [a, b])| (*a, *b)).unzip();
        }
        let found = umeyama(&theirs, &ours)?;
        let scale = scale.unwrap_or(found.scale);
        let translation = found.to - scale * (found.rotation * found.from);
        map = Some(WorldMap { kind: WorldMatch::Fitted, scale, rotation: found.rotation, translation });
    }
    map
}

/// The rotation by quarter turns that is nearest to another.
fn nearest_axes(rotation: DMat3) -> DMat3 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    let pairs = axes.clone().flat_map(|x| axes.clone().map(move |y| (x, y)));
    let all = pairs.filter(|(x, y)| x.dot(*y) == 0.0).map(|(x, y)| DMat3::from_cols(x, y, x.cross(y)));
    let likeness = |axes: &DMat3| {
        let product = axes.transpose() * rotation;
        product.x_axis.x + product.y_axis.y + product.z_axis.z
    };
    all.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or(DMat3::IDENTITY)
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    fn cloud() -> Vec<DVec3> {
        (0..60)
            .map(|k| k as f64)
            .map(|k| DVec3::new(k.sin(), (1.7 * k).cos(), 0.5 * (0.3 * k).sin() + 0.9))
            .collect()
    }

    fn found(theirs: impl Fn(DVec3) -> DVec3) -> WorldMap {
        let pairs: Vec<[DVec3; 2]> = cloud().into_iter().map(|point| [point, theirs(point)]).collect();
        WorldMap::find(&pairs)
    }

    #[test]
    fn other_axes_and_units_are_the_same_world() {
        let error = DVec3::new(0.02, -0.03, 0.01);
        let map = found(|p| 1000.0 * DVec3::new(p.y, p.z, p.x) + error);
        assert_eq!((map.kind, map.scale), (WorldMatch::Same, 0.001));
        let point = cloud()[7];
        assert!(map.apply(1000.0 * DVec3::new(point.y, point.z, point.x)).distance(point) < 1e-9);
        // What a track is off by is not taken off it.
        let off = found(|p| p + DVec3::new(0.1, 0.0, 0.0));
        assert_eq!((off.kind, off.translation), (WorldMatch::Same, DVec3::ZERO));
    }

    #[test]
    fn another_world_is_fitted_and_mistaken_joints_do_not_pull() {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.5, 0.2, -1.0);
        let to_theirs = |p: DVec3| turn * p / 0.056 + DVec3::new(30.0, 2.0, 1.0);
        let mut pairs: Vec<[DVec3; 2]> = cloud().into_iter().map(|p| [p, to_theirs(p)]).collect();
        for pair in pairs.iter_mut().step_by(7) {
            pair[1] += DVec3::new(9.0, 4.0, -5.0);
        }
        let map = WorldMap::find(&pairs);
        assert_eq!(map.kind, WorldMatch::Fitted);
        assert!((map.scale / 0.056 - 1.0).abs() < 1e-6, "{}", map.scale);
        assert!(map.apply(to_theirs(DVec3::ONE)).distance(DVec3::ONE) < 1e-6);
        assert_eq!(WorldMap::find(&[[DVec3::ONE, DVec3::X]; 2]), WorldMap::SAME);
    }
}
