//! The bodies of a plan: who stands, walks and reaches, turned all ways about.

use glam::{DMat3, DQuat};

use super::Floor;
use crate::body::{Kinematics, Model, Pose, Sides};

/// How often each is turned about, evenly; one begins a third of that after the other.
const TURNS: usize = 4;
/// A body without legs has its root so high, metres.
const SEATED_M: f64 = 1.0;

/// How far limbs are turned from rest, degrees: part of a limb's name, of the right and of the left side each forwards, outwards.
type Turns = [(&'static str, [[f64; 2]; 2])];

const STANDS: &Turns = &[("upper arm", [[5.0, 15.0], [5.0, 15.0]]), ("forearm", [[15.0, 0.0], [15.0, 0.0]])];
const WALKS: &Turns = &[
    ("upper arm", [[-25.0, 10.0], [30.0, 10.0]]),
    ("forearm", [[25.0, 0.0], [40.0, 0.0]]),
    ("thigh", [[28.0, 0.0], [-18.0, 0.0]]),
    ("calf", [[-8.0, 0.0], [-30.0, 0.0]]),
];
const REACHES: &Turns = &[
    ("upper arm", [[75.0, 20.0], [10.0, 85.0]]),
    ("forearm", [[25.0, 0.0], [10.0, 30.0]]),
    ("thigh", [[15.0, 8.0], [5.0, 8.0]]),
    ("calf", [[-15.0, 0.0], [-10.0, 0.0]]),
];

/// The bodies at the floor's origin: who stands, who walks with one leg ahead, who reaches with one arm forwards and one
/// aside, each turned four ways, all by other angles. Limbs are known by the built-in bodies' names; others stay at rest.
#[must_use]
pub fn people(model: &Model, floor: &Floor) -> Vec<Pose> {
    let kinds = [STANDS, WALKS, REACHES];
    let all = TURNS * kinds.len();
    let one = |(kind, limbs): (usize, &&Turns)| {
        (0..TURNS)
            .map(|turn| {
                let angle = std::f64::consts::TAU * (turn * kinds.len() + kind) as f64 / all as f64;
                on_floor(model, floor, upright(model, floor, limbs, angle))
            })
            .collect::<Vec<_>>()
    };
    kinds.iter().enumerate().flat_map(one).collect()
}

/// The body upright in the world, turned about by an angle, its limbs turned from rest.
fn upright(model: &Model, floor: &Floor, limbs: &Turns, angle: f64) -> Pose {
    let mut pose = Pose::rest(model);
    let sides = Sides::of(model, &Kinematics::new(model, &pose));
    let Some(Sides { left, up, ahead }) = sides else { return pose };
    for (part, turns) in limbs {
        for (side, [forwards, outwards]) in ["right", "left"].into_iter().zip(turns) {
            let Some(limb) = model.limb_index(&format!("{side} {part}")) else { continue };
            let out = if side == "right" { -1.0 } else { 1.0 } * outwards.to_radians();
            let turn = DQuat::from_axis_angle(-left, forwards.to_radians());
            let rotation = model.limbs()[limb].rotation;
            pose.rotations[rotation] = DQuat::from_axis_angle(ahead, out) * turn * pose.rotations[rotation];
        }
    }
    let [across, along] = floor.axes();
    let faces = across * angle.cos() + along * angle.sin();
    // Columns: where the body's own directions go.
    let world_from_sides = DMat3::from_cols(floor.up.cross(faces), floor.up, faces);
    let turn = DQuat::from_mat3(&(world_from_sides * DMat3::from_cols(left, up, ahead).transpose()));
    for (rotation, parent) in model.rotation_parents().iter().enumerate() {
        if parent.is_none() {
            pose.rotations[rotation] = turn * pose.rotations[rotation];
        }
    }
    pose
}

/// The body moved over the floor's origin, its lowest point on the floor.
fn on_floor(model: &Model, floor: &Floor, mut pose: Pose) -> Pose {
    pose.root = floor.point([0.0; 2], SEATED_M);
    let has_legs = model.limbs().iter().any(|limb| limb.name.contains("calf") || limb.name.contains("foot"));
    if has_legs {
        let lowest = Floor::under(model, &pose, floor.up).height_m;
        pose.root += floor.up * (floor.height_m - lowest);
    }
    pose
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::body::builtin;

    #[test]
    fn bodies_stand_upright_on_the_floor_and_look_all_ways() {
        for (model, up) in [(builtin::full_body(), DVec3::Z), (builtin::full_body(), DVec3::NEG_Y)] {
            let floor = Floor { up, height_m: -0.2 };
            let found = people(&model, &floor);
            assert_eq!(found.len(), 12);
            let mut faced = DVec3::ZERO;
            for pose in &found {
                pose.check(&model).unwrap();
                let kinematics = Kinematics::new(&model, pose);
                let sides = Sides::of(&model, &kinematics).unwrap();
                assert!(sides.up.dot(up) > 0.99, "{sides:?}");
                assert!((Floor::under(&model, pose, up).height_m - floor.height_m).abs() < 1e-9);
                faced += sides.ahead;
            }
            assert!(faced.length() < 1e-6, "as often one way as the other: {faced}");
            // Who reaches has the right hand ahead of the chest and the left hand aside.
            let kinematics = Kinematics::new(&model, &found[8]);
            let sides = Sides::of(&model, &kinematics).unwrap();
            let from = |limb: &str, end: &str| {
                let at = |limb: &str| kinematics.ends()[model.limb_index(limb).unwrap()];
                at(end) - at(limb)
            };
            assert!(from("right clavicle", "right forearm").dot(sides.ahead) > 0.4);
            assert!(from("left clavicle", "left forearm").dot(sides.left) > 0.4);
            let walks = Kinematics::new(&model, &found[4]);
            let calf = |side: &str| walks.ends()[model.limb_index(&format!("{side} calf")).unwrap()];
            let ahead = Sides::of(&model, &walks).unwrap().ahead;
            assert!((calf("right") - calf("left")).dot(ahead) > 0.4, "one leg is ahead of the other");
        }
    }

    #[test]
    fn a_body_without_legs_is_above_the_floor_and_one_limb_is_as_it_is() {
        let floor = Floor { up: DVec3::Y, height_m: 0.0 };
        let upper = builtin::upper_body();
        assert!(people(&upper, &floor).iter().all(|pose| (pose.root.y - SEATED_M).abs() < 1e-12));
        let limb = builtin::single_limb();
        assert!(people(&limb, &floor).iter().all(|pose| pose.rotations == Pose::rest(&limb).rotations));
    }
}
