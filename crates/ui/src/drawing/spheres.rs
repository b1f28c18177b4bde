//! Spheres that stand for a body, in space and as a camera sees them.

use backlit_tracking::body::{Kinematics, Model, PlacedSphere};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::RendererKind;
use glam::DVec2;

/// Spheres nearer than this to the camera plane are not drawn (metres).
const NEAREST_M: f64 = 0.05;

/// A sphere as one camera sees it, taken as a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProjectedSphere {
    /// Index of its limb.
    pub limb: usize,
    /// Its centre.
    pub centre_px: DVec2,
    /// Its radius.
    pub radius_px: f64,
}

/// The spheres that a renderer stands a body on: those of a level of the limbs' trees, counted from the coarsest, and equal ones
/// along the axis of limbs without a tree. None of other renderers.
pub fn body_spheres(
    model: &Model,
    kinematics: &Kinematics,
    renderer: RendererKind,
    level: usize,
) -> Vec<PlacedSphere> {
    let RendererKind::SphereTree { spheres } = renderer else { return Vec::new() };
    let trees = model.placed_spheres(kinematics, level);
    let mut placed = Vec::new();
    for (index, limb) in model.limbs().iter().enumerate() {
        match RendererKind::equal_spheres(limb, spheres) {
            None => placed.extend(trees.iter().filter(|sphere| sphere.limb == index)),
            Some(count) => {
                let (from, to) = (kinematics.starts()[index], kinematics.ends()[index]);
                let share = |number: usize| if count == 1 { 0.5 } else { number as f64 / (count - 1) as f64 };
                let equal = |number| PlacedSphere {
                    limb: index,
                    centre: from.lerp(to, share(number)),
                    radius: limb.radius,
                };
                placed.extend((0..count).map(equal));
            }
        }
    }
    placed
}

/// Spheres as a camera sees them, the farthest first; without those behind it.
pub fn project_spheres(spheres: &[PlacedSphere], camera: &Camera) -> Vec<ProjectedSphere> {
    let focal = camera.intrinsics().mean_focal_px();
    let project = |sphere: &PlacedSphere| {
        let depth = camera.depth(sphere.centre);
        let centre_px = (depth > NEAREST_M).then(|| camera.project(sphere.centre))??;
        Some((
            depth,
            ProjectedSphere { limb: sphere.limb, centre_px, radius_px: focal * sphere.radius / depth },
        ))
    };
    let mut seen: Vec<_> = spheres.iter().filter_map(project).collect();
    seen.sort_by(|a, b| b.0.total_cmp(&a.0));
    seen.into_iter().map(|(_, sphere)| sphere).collect()
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{LimbSphere, Pose, SphereLevel, builtin};
    use glam::DVec3;

    use super::*;

    const OWN: RendererKind = RendererKind::SphereTree { spheres: None };

    #[test]
    fn limbs_with_trees_have_their_levels_and_others_equal_spheres() {
        let model = builtin::single_limb();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        assert!(body_spheres(&model, &kinematics, RendererKind::Capsule, 0).is_empty());
        let three = body_spheres(&model, &kinematics, RendererKind::SphereTree { spheres: Some(3) }, 0);
        assert_eq!(three.len(), 3);
        assert!(three[1].centre.abs_diff_eq(kinematics.starts()[0].midpoint(kinematics.ends()[0]), 1e-12));

        let sphere = |at: f64, parent| LimbSphere { at, radius: 0.1, offset: DVec3::X * 0.02, parent };
        let level = |spheres: Vec<LimbSphere>| SphereLevel { error: 0.01, spheres, reaches: Vec::new() };
        let levels =
            vec![level(vec![sphere(0.5, None)]), level(vec![sphere(0.2, Some(0)), sphere(0.8, Some(0))])];
        let tree = model.with_trees(vec![levels]).unwrap();
        let counts = [0, 1, 9].map(|level| body_spheres(&tree, &kinematics, OWN, level).len());
        assert_eq!(counts, [1, 2, 2], "there is nothing finer than the finest");
    }
}
