//! The flesh and the clothes: which solids each part of the [`Figure`] is made of.
//!
//! Numbers are metres in the rest frame of the part's rotation about its joint: an adult of 1.75 m.

use glam::DVec3;

use super::figure::{Build, FAR, Figure, HAIR, HEAD, Layers};
use super::motion::ANKLE_HEIGHT;
use super::solid::{ellipsoid, frustum, noise, round_cone, rounded_box, smooth_max, smooth_min};

impl Figure {
    pub(super) fn head_layers(&self, point: DVec3) -> Layers {
        let p = self.head.local(point) / HEAD;
        let side = to_one_side(p);
        let skull = ellipsoid(p, [0.0, 0.008, 0.112], [0.074, 0.094, 0.09]);
        let jaw = ellipsoid(p, [0.0, 0.044, 0.04], [0.052, 0.056, 0.062]);
        let chin = ellipsoid(p, [0.0, 0.074, -0.004], [0.024, 0.022, 0.02]);
        let mut face = smooth_min(smooth_min(skull, jaw, 0.035), chin, 0.025);
        let nose = round_cone(p, [0.0, 0.098, 0.093], [0.0, 0.114, 0.06], 0.007, 0.012);
        face = smooth_min(face, nose, 0.012);
        let eye_socket = ellipsoid(side, [0.031, 0.104, 0.09], [0.016, 0.012, 0.01]);
        face = smooth_max(face, -eye_socket, 0.012);
        let ear = ellipsoid(side, [0.078, 0.0, 0.078], [0.009, 0.022, 0.03]);
        face = smooth_min(face, ear, 0.01);
        // Full hair that leaves the face and the ears free, thicker at the back.
        let cap = ellipsoid(p, [0.0, -0.006, 0.12], [0.074 + HAIR, 0.093 + HAIR, 0.086 + HAIR]);
        let cap = displaced(cap, || 0.006 * noise(p * 42.0));
        let brow_line = p.y - 0.062 - 0.55 * (p.z - 0.15).max(-0.03) + 0.35 * (p.x + 0.02).abs();
        let nape = 0.02 - p.z + 0.5 * (p.y + 0.02).max(0.0);
        let hair = smooth_max(smooth_max(cap, brow_line, 0.02), nape, 0.02);
        Layers([face * HEAD, FAR, FAR, FAR, hair * HEAD])
    }

    pub(super) fn trunk_layers(&self, point: DVec3) -> Layers {
        let Build { cloth, folds, .. } = self.build;
        let (pelvis, chest) = (self.pelvis.local(point), self.chest.local(point));
        let [neck, right, left] = self.collar;
        let head = self.chest.local(self.head.origin);
        let throat = round_cone(chest, neck + DVec3::new(0.0, -0.006, -0.03), head, 0.06, 0.054);
        // Chest a little forward of the axis, back a little hollow, belly below.
        let ribs = ellipsoid(chest, [0.0, 0.006, 0.1], [0.166, 0.116, 0.2]);
        let breast = ellipsoid(to_one_side(chest), [0.075, 0.055, 0.12], [0.085, 0.07, 0.085]);
        let belly = ellipsoid(pelvis, [0.0, 0.008, 0.14], [0.146, 0.112, 0.17]);
        let mut shirt = smooth_min(smooth_min(ribs, breast, 0.05), belly, 0.09);
        for (index, shoulder) in [right, left].into_iter().enumerate() {
            let inward = neck + (shoulder - neck) * 0.3 + DVec3::new(0.0, -0.01, -0.03);
            let yoke = round_cone(chest, inward, shoulder + DVec3::new(0.0, -0.004, -0.004), 0.058, 0.046);
            let along = self.clavicles[index].local(point);
            let sign = if index == 0 { 1.0 } else { -1.0 };
            let shoulder_blade = ellipsoid(along, [0.075 * sign, -0.062, -0.095], [0.07, 0.05, 0.1]);
            shirt = smooth_min(smooth_min(shirt, yoke, 0.06), shoulder_blade, 0.05);
        }
        // The hem hangs from the waist and stands off a little.
        let loose = 0.010 * cloth;
        let behind = pelvis + DVec3::new(0.0, 0.012, 0.0);
        let hem = frustum(behind, [0.2, 0.142 + loose], [-0.052, 0.19 + loose], 0.8, 0.012);
        shirt = smooth_min(shirt, hem, 0.06);
        shirt = displaced(shirt, || {
            let drape = noise(DVec3::new(pelvis.x * 17.0, pelvis.y * 17.0, pelvis.z * 5.0 + pelvis.x * 9.0))
                + 0.5 * noise(chest * DVec3::new(26.0, 26.0, 15.0));
            folds * drape * (1.0 - 3.0 * chest.z.clamp(0.0, 0.3))
        });
        let neckline = ellipsoid(chest, neck + DVec3::new(0.0, 0.03, 0.035), [0.077, 0.088, 0.06]);
        shirt = smooth_max(shirt, -neckline, 0.008);
        let seat = ellipsoid(pelvis, [0.0, -0.004, -0.015], [0.172, 0.118, 0.12]);
        let buttock = ellipsoid(to_one_side(pelvis), [0.078, -0.056, -0.055], [0.086, 0.08, 0.095]);
        Layers([throat, shirt, smooth_min(seat, buttock, 0.05), FAR, FAR])
    }

    pub(super) fn arm_layers(&self, which: usize, point: DVec3) -> Layers {
        let Build { cloth, folds, .. } = self.build;
        let chain = &self.arms[which];
        let mirrored = DVec3::new(chain.mirror, 1.0, 1.0);
        // From here x points outward on both sides.
        let (u, l) = (chain.upper.local(point) * mirrored, chain.lower.local(point) * mirrored);
        let (elbow, wrist) =
            (DVec3::new(0.0, 0.0, -chain.upper_length), DVec3::new(0.0, 0.0, -chain.lower_length));
        let upper = round_cone(u, DVec3::ZERO, elbow, 0.05, 0.037);
        let biceps = ellipsoid(u, [-0.004, 0.012, -0.15], [0.043, 0.047, 0.1]);
        let lower = round_cone(l, DVec3::ZERO, wrist, 0.037, 0.026);
        let forearm = ellipsoid(l, [0.011, 0.002, -0.075], [0.042, 0.039, 0.1]);
        let skin = smooth_min(smooth_min(upper, biceps, 0.04), smooth_min(lower, forearm, 0.04), 0.035);
        let hand = hand(l - wrist);
        let shirt = if u.z > -0.32 {
            let top = round_cone(u, [-0.004, 0.0, -0.012], [0.0, 0.0, -0.1], 0.058, 0.056);
            let sleeve = frustum(
                u - DVec3::new(0.0, -0.005, 0.0),
                [-0.02, 0.054],
                [-0.2, 0.056 + 0.012 * cloth],
                1.05,
                0.006,
            );
            displaced(smooth_min(top, sleeve, 0.03), || {
                folds * noise(DVec3::new(u.x * 30.0, u.y * 30.0, u.z * 22.0 + u.x * 20.0))
            })
        } else {
            FAR
        };
        Layers([smooth_min(skin, hand, 0.022), shirt, FAR, FAR, FAR])
    }

    pub(super) fn leg_layers(&self, which: usize, point: DVec3) -> Layers {
        let Build { cloth, folds, .. } = self.build;
        let chain = &self.legs[which];
        let mirrored = DVec3::new(chain.mirror, 1.0, 1.0);
        let (u, l, f) = (
            chain.upper.local(point) * mirrored,
            chain.lower.local(point) * mirrored,
            chain.end.local(point) * mirrored,
        );
        let (knee, ankle) =
            (DVec3::new(0.0, 0.0, -chain.upper_length), DVec3::new(0.0, 0.0, -chain.lower_length));
        let loose = 0.006 * cloth;
        let thigh = round_cone(u, [-0.006, -0.006, -0.02], knee, 0.09 + loose, 0.06 + loose);
        let front = ellipsoid(u, [0.008, 0.02, -0.17], [0.082, 0.08, 0.17]);
        let shin = round_cone(l, DVec3::ZERO, ankle * 0.9, 0.058 + loose, 0.045 + loose);
        let calf = ellipsoid(l, [0.006, -0.027, -0.125], [0.056, 0.058, 0.12]);
        let mut trousers = smooth_min(smooth_min(thigh, front, 0.05), smooth_min(shin, calf, 0.05), 0.04);
        // Cloth bunches at the knee and above the shoe.
        trousers = displaced(trousers, || {
            let at_knee = (1.0 - l.z.abs() / 0.11).max(0.0);
            let at_hem = (1.0 - (l.z - ankle.z * 0.86).abs() / 0.1).max(0.0);
            let rings = (l.z * 150.0 + 2.5 * noise(l * 14.0)).sin();
            let drape = noise(DVec3::new(u.x * 18.0, u.y * 18.0, u.z * 7.0));
            folds * (drape + 0.8 * rings * (at_knee + at_hem))
        });
        trousers = smooth_max(trousers, ankle.z * 0.905 - l.z, 0.01);
        let sock = round_cone(l, ankle * 0.7, ankle, 0.043, 0.037);
        Layers([FAR, FAR, trousers, smooth_min(shoe(f), sock, 0.015), FAR])
    }
}

/// The point or its mirror image, for what is alike on both sides.
fn to_one_side(point: DVec3) -> DVec3 {
    DVec3::new(point.x.abs(), point.y, point.z)
}

/// A solid with folds in its surface; far from it they do not count, and are not asked for.
fn displaced(distance: f64, by: impl FnOnce() -> f64) -> f64 {
    const NEAR: f64 = 0.03;
    if distance.abs() < NEAR { distance + by() * (1.0 - distance.abs() / NEAR) } else { distance }
}

/// Farther from a hand's or a shoe's joint than this, metres, its solids are not asked: they reach by `END_REACH` from there.
const END_FAR: f64 = END_REACH + 0.12;
const END_REACH: f64 = 0.27;

/// A hand about the wrist, x outward (the back of the hand), fingers a little curled. Always of one size.
fn hand(p: DVec3) -> f64 {
    if p.length() > END_FAR {
        return p.length() - END_REACH;
    }
    let palm = rounded_box(p, [0.0, 0.004, -0.052], [0.004, 0.029, 0.036], 0.012);
    let bend = 0.32_f64;
    let q = p - DVec3::new(0.001, 0.004, -0.092);
    let curled = DVec3::new(q.x * bend.cos() - q.z * bend.sin(), q.y, q.x * bend.sin() + q.z * bend.cos());
    let fingers = rounded_box(curled, [0.0, 0.0, -0.032], [0.002, 0.027, 0.034], 0.009);
    let thumb = round_cone(p, [-0.004, 0.03, -0.03], [-0.018, 0.056, -0.083], 0.014, 0.0095);
    smooth_min(smooth_min(palm, fingers, 0.012), thumb, 0.018)
}

/// A shoe about the ankle, flat on z = −[`ANKLE_HEIGHT`](super::motion::ANKLE_HEIGHT). Always of one size.
fn shoe(p: DVec3) -> f64 {
    if p.length() > END_FAR {
        return p.length() - END_REACH;
    }
    let heel = ellipsoid(p, [0.0, -0.024, -0.06], [0.037, 0.054, 0.046]);
    let instep = round_cone(p, [0.0, 0.0, -0.042], [0.004, 0.12, -0.066], 0.043, 0.034);
    let toes = ellipsoid(p, [0.004, 0.145, -0.072], [0.047, 0.068, 0.032]);
    let collar = round_cone(p, [0.0, -0.008, -0.006], [0.0, 0.0, -0.04], 0.041, 0.042);
    let upper = smooth_min(smooth_min(heel, instep, 0.03), smooth_min(toes, collar, 0.02), 0.03);
    let sole = rounded_box(
        p,
        [0.003, 0.06, -0.086],
        [0.026 + 0.006 * (p.y * 12.0).clamp(-1.0, 1.0), 0.122, 0.001],
        0.014,
    );
    smooth_max(smooth_min(upper, sole, 0.008), -ANKLE_HEIGHT - p.z, 0.006)
}
