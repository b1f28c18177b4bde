//! Bodies that more than one subject is tried on.

use backlit_tracking::body::{LimbSphere, Model};
use glam::DVec3;

/// Two spheres a limb, of other radii than the limb's and off its axis.
pub(crate) fn with_own_spheres(model: &Model) -> Model {
    let mut spec = model.to_spec();
    for limb in &mut spec.limbs {
        let sphere = |at, scale, x| LimbSphere {
            at,
            radius: scale * limb.radius,
            offset: DVec3::new(x, 0.02, -0.01) * limb.radius * 5.0,
            parent: None,
        };
        limb.spheres = vec![sphere(0.2, 1.1, 0.05), sphere(0.8, 0.8, -0.04)];
    }
    Model::new(&spec).unwrap()
}
