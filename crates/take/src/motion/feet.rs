//! Feet that are kept out of the floor: recordings tell where ankles are, and seldom where toes are.

use backlit_tracking::body::{Kinematics, Model, Pose, split_side};
use glam::{DMat3, DQuat, DVec3};

use super::ANKLE_M;

/// A limb that is a foot.
struct Foot {
    limb: usize,
    /// How high its end is above the floor while it stands flat.
    end_m: f64,
}

/// The feet of a body.
pub(super) struct Feet<'a> {
    model: &'a Model,
    feet: Vec<Foot>,
}

impl<'a> Feet<'a> {
    pub(super) fn of(model: &'a Model) -> Self {
        let rest = Kinematics::new(model, &Pose::rest(model));
        let limbs = model.limbs().iter().enumerate();
        let feet = limbs.filter(|(_, limb)| split_side(&limb.name).1 == "foot" && limb.has_own_rotation);
        let foot = |(limb, _)| Foot {
            limb,
            end_m: (ANKLE_M + rest.ends()[limb].z - rest.starts()[limb].z).max(0.0),
        };
        Self { model, feet: feet.map(foot).collect() }
    }

    /// Turns each foot whose toes are in the floor z = 0 up about its ankle until it stands on it.
    pub(super) fn lift(&self, pose: &mut Pose) {
        let kinematics = Kinematics::new(self.model, pose);
        for Foot { limb, end_m } in &self.feet {
            let [ankle, toes] = [kinematics.starts()[*limb], kinematics.ends()[*limb]];
            let along = toes - ankle;
            let rise = (end_m - ankle.z) / along.length();
            let Some(ahead) = along.with_z(0.0).try_normalize().filter(|_| toes.z < *end_m && rise < 1.0)
            else {
                continue;
            };
            let flat = ahead * (1.0 - rise * rise).sqrt() + DVec3::Z * rise;
            let turn = DMat3::from_quat(DQuat::from_rotation_arc(along.normalize(), flat));
            let rotation = self.model.limbs()[*limb].rotation;
            let frame = kinematics.parent_frames()[rotation];
            let local = DQuat::from_mat3(&(frame.transpose() * turn * frame));
            pose.rotations[rotation] = (local * pose.rotations[rotation]).normalize();
        }
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    /// Calves that lean forwards push the toes into the floor: the feet stand flat on it. Toes in the air stay where they are.
    #[test]
    fn toes_come_out_of_the_floor_and_stay_in_the_air() {
        let model = builtin::full_body();
        let feet = Feet::of(&model);
        assert_eq!(feet.feet.len(), 2);
        let mut pose = Pose::rest(&model);
        for side in ["right", "left"] {
            let calf = model.limb_index(&format!("{side} calf")).unwrap();
            pose.rotations[model.limbs()[calf].rotation] = DQuat::from_rotation_x(-0.6);
        }
        let ankle = |pose: &Pose| Kinematics::new(&model, pose).starts()[feet.feet[0].limb].z;
        pose.root.z += ANKLE_M - ankle(&pose);
        let toes = |pose: &Pose| {
            let kinematics = Kinematics::new(&model, pose);
            feet.feet.iter().map(|foot| kinematics.ends()[foot.limb]).collect::<Vec<DVec3>>()
        };
        let before = toes(&pose);
        assert!(before.iter().all(|end| end.z < 0.0), "{before:?}");
        let mut lifted = pose.clone();
        feet.lift(&mut lifted);
        for (foot, end) in feet.feet.iter().zip(toes(&lifted)) {
            assert!((end.z - foot.end_m).abs() < 1e-9, "{end}");
        }
        lifted.root.z += 0.3;
        let unchanged = lifted.clone();
        feet.lift(&mut lifted);
        assert_eq!(lifted, unchanged);
    }
}
