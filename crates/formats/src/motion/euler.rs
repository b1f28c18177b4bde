//! Quaternions as three angles.
//!
//! Angles (a, b, c) and (a + π, π − b, c + π), each plus any whole turns, are the same rotation. Of all of them the one
//! nearest to the frame before is taken, so that curves do not jump.

use std::f64::consts::{PI, TAU};

use glam::DQuat;

use super::EulerOrder;

/// The angles of a rotation, radians, in the order of the axes; near to those of the frame before, if there are any.
pub(super) fn angles(order: EulerOrder, rotation: DQuat, before: Option<[f64; 3]>) -> [f64; 3] {
    let (a, b, c) = rotation.to_euler(order.intrinsic());
    let Some(before) = before else { return [a, b, c] };
    let near = |angles: [f64; 3]| {
        let mut near = angles;
        for (angle, before) in near.iter_mut().zip(before) {
            *angle += TAU * ((before - *angle) / TAU).round();
        }
        let distance: f64 = near.iter().zip(before).map(|(angle, before)| (angle - before).powi(2)).sum();
        (near, distance)
    };
    let (first, second) = (near([a, b, c]), near([a + PI, PI - b, c + PI]));
    if second.1 < first.1 { second.0 } else { first.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_give_the_rotation_back_and_do_not_jump() {
        for order in EulerOrder::ALL {
            let mut before = None;
            for step in 0..400 {
                let t = f64::from(step) * 0.05;
                let rotation = DQuat::from_rotation_z(t) * DQuat::from_rotation_x((0.7 * t).sin());
                let found = angles(order, rotation, before);
                let again = DQuat::from_euler(order.intrinsic(), found[0], found[1], found[2]);
                assert!(rotation.dot(again).abs() > 1.0 - 1e-12, "{order:?} {t}");
                if order == EulerOrder::Zxy
                    && let Some(before) = before
                {
                    let jump = found.iter().zip(before).map(|(a, b): (&f64, f64)| (a - b).abs());
                    assert!(jump.fold(0.0, f64::max) < 0.2, "{order:?} {t}");
                }
                before = Some(found);
            }
        }
    }
}
