//! Boxes about the figure's parts: where a point is far from a part, its solids are not asked.

use glam::DVec3;

use super::figure::{Chain, Figure, Frame, HAIR, HEAD, Part};
use super::solid::rounded_box;

/// What fillets and folds may add to the solids that a box is made for, metres, folds once for each unit of their height.
const FILLET: f64 = 0.025;
const FOLDS: f64 = 3.0;

/// A box in a part's frame that holds some of its solids.
#[derive(Debug, Clone, Copy)]
struct Hull {
    part: Part,
    frame: Frame,
    middle: DVec3,
    half: DVec3,
}

impl Hull {
    fn new(part: Part, frame: Frame, low: DVec3, high: DVec3) -> Self {
        Self { part, frame, middle: (low + high) / 2.0, half: (high - low) / 2.0 }
    }

    fn distance(&self, point: DVec3) -> f64 {
        rounded_box(self.frame.local(point), self.middle.to_array(), self.half.to_array(), 0.0)
    }
}

/// Boxes that hold all parts of a figure, and a ball that holds the boxes.
#[derive(Debug, Clone, Default)]
pub(super) struct Hulls {
    boxes: Vec<Hull>,
    pub(super) centre: DVec3,
    pub(super) radius: f64,
}

impl Hulls {
    pub(super) fn of(figure: &Figure) -> Self {
        let mut boxes = vec![head(figure), lower_trunk(figure), upper_trunk(figure)];
        for side in [0, 1] {
            boxes.extend(arm(figure, side));
            boxes.extend(leg(figure, side));
        }
        let middles: Vec<DVec3> = boxes.iter().map(|hull| hull.frame.world(hull.middle)).collect();
        let centre = middles.iter().sum::<DVec3>() / middles.len() as f64;
        let reach =
            boxes.iter().zip(&middles).map(|(hull, middle)| middle.distance(centre) + hull.half.length());
        let radius = reach.fold(0.0, f64::max);
        Self { boxes, centre, radius }
    }

    /// No solid of a part is nearer to a point than this, by [`Part`]'s index.
    pub(super) fn bounds(&self, point: DVec3) -> [f64; Part::ALL.len()] {
        let mut bounds = [f64::INFINITY; Part::ALL.len()];
        for hull in &self.boxes {
            let bound = &mut bounds[hull.part.index()];
            *bound = bound.min(hull.distance(point));
        }
        bounds
    }
}

fn head(figure: &Figure) -> Hull {
    let (low, high) = (DVec3::new(-0.1, -0.12, -0.03), DVec3::new(0.1, 0.13, 0.21 + HAIR));
    let around = DVec3::splat(FILLET);
    Hull::new(Part::Head, figure.head, HEAD * low - around, HEAD * high + around)
}

/// Seat, belly and the hem that hangs from the waist.
fn lower_trunk(figure: &Figure) -> Hull {
    let loose = 0.01 * figure.build.cloth + FOLDS * figure.build.folds + FILLET;
    let high = DVec3::new(0.2, 0.16, 0.32) + loose;
    Hull::new(Part::Trunk, figure.pelvis, DVec3::new(-0.2, -0.16, -0.16) - loose, high)
}

/// Ribs and breast, and what comes from the shoulders, the shoulder blades and the neck, which move.
fn upper_trunk(figure: &Figure) -> Hull {
    let [neck, right, left] = figure.collar;
    let (mut low, mut high) = (DVec3::new(-0.17, -0.12, -0.11), DVec3::new(0.17, 0.135, 0.31));
    let blades = [0, 1].map(|side| {
        let sign = if side == 0 { 1.0 } else { -1.0 };
        figure.chest.local(figure.clavicles[side].world(DVec3::new(0.075 * sign, -0.062, -0.095)))
    });
    let [right_blade, left_blade] = blades;
    let throat = figure.chest.local(figure.head.origin);
    let balls =
        [(neck, 0.1), (throat, 0.06), (right, 0.06), (left, 0.06), (right_blade, 0.1), (left_blade, 0.1)];
    for (centre, radius) in balls {
        (low, high) = (low.min(centre - radius), high.max(centre + radius));
    }
    let around = DVec3::splat(FILLET + FOLDS * figure.build.folds);
    Hull::new(Part::Trunk, figure.chest, low - around, high + around)
}

/// A limb's upper or lower half: `wide` about its axis, from `above` its upper joint to `below` its lower one.
fn half_limb(part: Part, frame: Frame, length: f64, wide: f64, [above, below]: [f64; 2]) -> Hull {
    Hull::new(part, frame, DVec3::new(-wide, -wide, -length - below), DVec3::new(wide, wide, above))
}

/// Upper arm with sleeve; forearm with hand.
fn arm(figure: &Figure, side: usize) -> [Hull; 2] {
    let Chain { upper, lower, upper_length, lower_length, .. } = figure.arms[side];
    let part = Part::Arm(side);
    let sleeve = 0.07 + 0.015 * figure.build.cloth + FOLDS * figure.build.folds + FILLET;
    [
        half_limb(part, upper, upper_length, sleeve, [0.06 + FILLET, 0.06]),
        half_limb(part, lower, lower_length, 0.07 + FILLET, [0.06, 0.19 + FILLET]),
    ]
}

/// Thigh; calf; foot. The last is mirrored on the left, and as wide on both sides.
fn leg(figure: &Figure, side: usize) -> [Hull; 3] {
    let Chain { upper, lower, end, upper_length, lower_length, .. } = figure.legs[side];
    let part = Part::Leg(side);
    let cloth = 0.006 * figure.build.cloth + FOLDS * figure.build.folds + FILLET;
    let (low, high) = (DVec3::new(-0.06, -0.09, -0.11), DVec3::new(0.06, 0.22, 0.06));
    [
        half_limb(part, upper, upper_length, 0.1 + cloth, [0.08 + cloth, 0.06 + cloth]),
        half_limb(part, lower, lower_length, 0.09 + cloth, [0.06 + cloth, 0.05]),
        Hull::new(part, end, low - FILLET, high + FILLET),
    ]
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::synthetic::figure::REACH;
    use crate::synthetic::{Build, motion};

    /// No solid, whatever is worn, comes out of its boxes.
    #[test]
    fn boxes_hold_their_parts() {
        let model = builtin::full_body();
        let mut random = Pcg64Mcg::seed_from_u64(4);
        let wide = Build { cloth: 4.0, folds: 0.009, pattern: 0.0 };
        let mut inside = [0; Part::ALL.len()];
        for frame in 0..20 {
            let build = if frame % 2 == 0 { Build::default() } else { wide };
            let figure = Figure::new(&model, &motion::pose(&model, 3.0 * f64::from(frame)), build).unwrap();
            let (centre, radius) = figure.bounding_ball();
            for _ in 0..20_000 {
                let mut side = || radius * random.random_range(-1.0..1.0);
                let point = centre + DVec3::new(side(), side(), side());
                let bounds = figure.hulls.bounds(point);
                for (part, bound) in Part::ALL.into_iter().zip(bounds) {
                    let (own, _) = figure.part(part, point).nearest();
                    inside[part.index()] += usize::from(own < 0.0);
                    assert!(own > 0.0 || bound < 0.0, "frame {frame}, {part:?}: {own} {bound}");
                    // Where a part is left out, it is farther off than fillets reach.
                    let is_left_out = (REACH..0.5).contains(&bound);
                    assert!(!is_left_out || own > 0.05, "frame {frame}, {part:?}: {own} {bound}");
                }
            }
        }
        assert!(inside.iter().all(|&count| count > 100), "{inside:?}");
    }
}
