//! A joint that was put somewhere in one view and is dragged in another: it stays on the first view's sight ray.

use backlit_tracking::camera::Camera;
use backlit_tracking::geometry::across;
use glam::{DVec2, DVec3};

/// Cameras that look from nearer to the same direction tell nothing of where a ray is met, as a squared sine.
const PARALLEL: f64 = 1e-4;

/// The point of the first camera's ray through `at` that is nearest to the ray of the pixel in `camera`, and to those of the
/// `others` through `at`. `None` where the rays do not tell.
pub(super) fn on_ray(
    first: &Camera,
    others: &[&Camera],
    at: DVec3,
    camera: &Camera,
    px: DVec2,
) -> Option<DVec3> {
    let (from, along) = (first.centre(), (at - first.centre()).try_normalize()?);
    let mut rays = vec![(camera.centre(), camera.ray_in_world(px)?)];
    rays.extend(others.iter().map(|other| (other.centre(), (at - other.centre()).normalize_or_zero())));
    // Least squares over t of the distances of `from + t along` to the rays.
    let (mut sum, mut squares) = (0.0, 0.0);
    for (centre, ray) in rays {
        let sideways = across(ray) * along;
        sum += sideways.dot(centre - from);
        squares += sideways.length_squared();
    }
    let distance = sum / squares;
    (squares > PARALLEL && distance > 0.0).then(|| from + along * distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::testing::camera;

    /// On the first camera's ray, as near to the pixel's ray as it goes; cameras in one place tell nothing.
    #[test]
    fn a_joint_stays_on_the_first_ray() {
        let at = |x: f64, y: f64| {
            camera([272, 480], [420.0, 134.0, 238.0], DVec3::new(x, y, 1.0), DVec3::ZERO, DVec3::Z)
        };
        let (first, second, third) = (at(3.0, -1.0), at(-0.5, 3.0), at(-3.0, -0.5));
        let before = DVec3::new(0.2, 0.1, 0.3);
        let goal = first.centre() + 1.2 * (before - first.centre());
        let px = second.project(goal).unwrap();
        let found = on_ray(&first, &[], before, &second, px).unwrap();
        assert!(found.distance(goal) < 1e-9, "{found}");
        // Beside the ray's picture it is on the ray all the same.
        let beside = on_ray(&first, &[], before, &second, px + DVec2::new(3.0, 25.0)).unwrap();
        assert!(first.project(beside).unwrap().distance(first.project(before).unwrap()) < 1e-6);
        // A place in a third view pulls back towards where it was.
        let pulled = on_ray(&first, &[&third], before, &second, px).unwrap();
        let (all, part) = (goal.distance(before), pulled.distance(before));
        assert!((0.01 * all..0.99 * all).contains(&part), "{part} of {all}");
        assert_eq!(on_ray(&first, &[], before, &first, first.project(before).unwrap()), None);
    }
}
