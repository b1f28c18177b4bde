//! Optic flow: where points of the last picture are in this one.
//!
//! A patch T about the point is looked for at d in the next picture I: with g the gradient of T, H = Σ g gᵀ and
//! d ← d + H⁻¹ Σ g (T − I(d)), from the coarsest picture of a pyramid to the finest (B. Lucas and T. Kanade, 1981;
//! J.-Y. Bouguet, "Pyramidal implementation of the Lucas Kanade feature tracker", 2000). What is found is followed back; if
//! that does not lead to where it began, nothing was found.
//!
//! Points of a limb's surface as the last frame's pose shows it are followed so, and pull at the same points of the limb.

use glam::{DMat2, DVec2};

use super::options::CueStrength;
use super::picture::GreyPicture;
use super::source::{BodySight, CameraPictures, CueFrame, CueSource, SurfacePoint, drawn, metres_per_px};
use super::watch::CueMemory;
use crate::body::{Kinematics, Model, Pose};
use crate::residual::cue::{Cue, CuePull, CueTarget};

/// Pixels from a patch's middle to its side.
const RADIUS: i32 = 4;
const SIDE: usize = 2 * RADIUS as usize + 1;
/// Pictures of the pyramid.
const LEVELS: usize = 3;
/// Most steps at each of them.
const STEPS: usize = 8;
/// A step shorter than this is the last, pixels.
const SHORTEST: f64 = 0.02;
/// A patch whose smaller eigenvalue of H is below this, grey levels² per pixel, says nothing across its texture.
const LEAST_TEXTURE: f64 = 6.0;
/// Where points of a limb are taken: along it, and aside of its middle as a share of its radius.
const PLACES: [f64; 3] = [0.2, 0.5, 0.8];
const ASIDE: [f64; 2] = [-0.4, 0.4];
/// How far from its beginning a point may come back, pixels.
const FARTHEST_BACK: f64 = 0.7;

/// Where a point of one picture is in the next, followed from a guess; `None` where the patch has no texture, leaves the
/// picture, or does not lead back to the point. Pixels.
#[must_use]
pub fn follow_point(from: &GreyPicture, to: &GreyPicture, point: DVec2, guess: DVec2) -> Option<DVec2> {
    let found = follow(from, to, point, guess)?;
    // Back it begins where it is to end: the finest picture is enough.
    let back = found + follow_at(to, from, found, point - found)?;
    (back.distance(point) < FARTHEST_BACK).then_some(found)
}

fn follow(from: &GreyPicture, to: &GreyPicture, point: DVec2, guess: DVec2) -> Option<DVec2> {
    let mut levels = vec![(from, to)];
    while levels.len() < LEVELS
        && let (Some(from), Some(to)) =
            (levels[levels.len() - 1].0.coarser(), levels[levels.len() - 1].1.coarser())
    {
        levels.push((from, to));
    }
    let mut motion = guess - point;
    for (level, (from, to)) in levels.iter().enumerate().rev() {
        let scale = (1_u32 << level) as f64;
        let found = follow_at(from, to, point / scale, motion / scale);
        match found {
            Some(found) => motion = found * scale,
            // Where a coarse picture says nothing a finer one still may.
            None if level > 0 => {}
            None => return None,
        }
    }
    Some(point + motion)
}

/// The motion at one level of the pyramid, begun at `motion`.
fn follow_at(from: &GreyPicture, to: &GreyPicture, point: DVec2, mut motion: DVec2) -> Option<DVec2> {
    // The gradients' pixel, and the one beside it.
    let border = f64::from(RADIUS) + 2.0;
    if !from.holds(point, border) {
        return None;
    }
    let patch = Patch::new(from, point);
    let inverse = patch.inverse()?;
    for _ in 0..STEPS {
        let at = point + motion;
        if !to.holds(at, border) {
            return None;
        }
        let step = inverse * patch.force(to, at);
        motion += step;
        if step.length() < SHORTEST {
            break;
        }
    }
    to.holds(point + motion, border).then_some(motion)
}

struct Patch {
    levels: [f32; SIDE * SIDE],
    gradients: [[f32; 2]; SIDE * SIDE],
    products: DMat2,
}

impl Patch {
    fn new(picture: &GreyPicture, middle: DVec2) -> Self {
        // One more pixel on each side for the gradients.
        const WIDE: usize = SIDE + 2;
        let mut wide = [0.0_f32; WIDE * WIDE];
        picture.square(middle - f64::from(RADIUS + 1), WIDE, &mut wide);
        let mut patch =
            Self { levels: [0.0; SIDE * SIDE], gradients: [[0.0; 2]; SIDE * SIDE], products: DMat2::ZERO };
        for index in 0..SIDE * SIDE {
            let at = (index / SIDE + 1) * WIDE + index % SIDE + 1;
            let [gx, gy] = [0.5 * (wide[at + 1] - wide[at - 1]), 0.5 * (wide[at + WIDE] - wide[at - WIDE])];
            patch.levels[index] = wide[at];
            patch.gradients[index] = [gx, gy];
            let g = DVec2::new(f64::from(gx), f64::from(gy));
            patch.products += DMat2::from_cols(g * g.x, g * g.y);
        }
        patch
    }

    /// H⁻¹; `None` where the patch has no texture in some direction.
    fn inverse(&self) -> Option<DMat2> {
        let [a, b, d] = [self.products.x_axis.x, self.products.x_axis.y, self.products.y_axis.y];
        let smaller = 0.5 * (a + d) - (0.25 * (a - d) * (a - d) + b * b).sqrt();
        (smaller > LEAST_TEXTURE * (SIDE * SIDE) as f64).then(|| self.products.inverse())
    }

    /// Σ g (T − I).
    fn force(&self, picture: &GreyPicture, middle: DVec2) -> DVec2 {
        let mut there = [0.0; SIDE * SIDE];
        picture.square(middle - f64::from(RADIUS), SIDE, &mut there);
        let (mut x, mut y) = (0.0, 0.0);
        for ((level, gradient), there) in self.levels.iter().zip(&self.gradients).zip(there) {
            let off = level - there;
            x += gradient[0] * off;
            y += gradient[1] * off;
        }
        let (x, y) = (f64::from(x), f64::from(y));
        DVec2::new(x, y)
    }
}

/// Points of the last frame's picture, carried into this one's.
#[derive(Debug, Default)]
pub(super) struct FlowSource {
    /// The frame before, if its pose was good and it had pictures.
    before: Option<FrameBefore>,
}

#[derive(Debug)]
struct FrameBefore {
    pose: Pose,
    kinematics: Kinematics,
    pictures: CameraPictures,
}

impl CueSource for FlowSource {
    fn cue(&self) -> Cue {
        Cue::Flow
    }

    fn pulls(&self, frame: &CueFrame<'_>, index: usize, strength: CueStrength) -> Vec<CuePull> {
        let camera = frame.cameras[index];
        let Some(FrameBefore { kinematics, pictures, .. }) = &self.before else { return Vec::new() };
        let (Some(last), Some(now)) = (pictures.get(camera.name()), frame.picture(index)) else {
            return Vec::new();
        };
        let view = drawn(frame.model, kinematics, camera, frame.renderer);
        let before = BodySight { model: frame.model, kinematics, camera, view: &view };
        let pull = |(limb, point): (usize, SurfacePoint)| {
            let turn = frame.kinematics.world_rotations()[frame.model.limbs()[limb].rotation];
            let guess = camera.project(frame.kinematics.starts()[limb] + turn * point.arm)?;
            let pixel = follow_point(last, now, point.pixel, guess)?;
            let target = CueTarget::Pixel { camera: index, arm: point.arm, pixel };
            Some(strength.pull(Cue::Flow, limb, target, metres_per_px(camera, point.depth)?))
        };
        before.visible_points(&frame.limbs, PLACES, ASIDE).filter_map(pull).collect()
    }

    fn learn(&mut self, frame: &CueFrame<'_>) {
        let (pose, kinematics, pictures) = (frame.pose.clone(), frame.kinematics.clone(), frame.pictures());
        self.before = (!pictures.is_empty()).then_some(FrameBefore { pose, kinematics, pictures });
    }

    fn forget_last_frame(&mut self) {
        self.before = None;
    }

    fn store(&self, memory: &mut CueMemory) {
        memory.before = self.before.as_ref().map(|before| before.pose.clone());
    }

    fn restore(&mut self, model: &Model, memory: &CueMemory) {
        self.before = memory.before.clone().map(|pose| FrameBefore {
            kinematics: Kinematics::new(model, &pose),
            pictures: CameraPictures::new(),
            pose,
        });
    }

    fn see_before(&mut self, pictures: &CameraPictures) {
        if let Some(before) = &mut self.before {
            before.pictures.clone_from(pictures);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::grey_picture;

    /// Smooth blotches of some pixels, the same for the same place of the world.
    fn texture(x: f64, y: f64) -> f64 {
        let wave = |fx: f64, fy: f64, phase: f64| (fx * x + fy * y + phase).sin();
        128.0
            + 30.0 * wave(0.083, 0.037, 0.9)
            + 26.0 * wave(-0.041, 0.097, 2.3)
            + 18.0 * wave(0.55, 0.21, 0.3)
            + 16.0 * wave(-0.28, 0.62, 1.1)
            + 12.0 * wave(0.19, -0.11, 2.0)
            + 9.0 * wave(0.9, 0.7, 0.5)
    }

    fn picture(of: impl Fn(DVec2) -> f64) -> GreyPicture {
        grey_picture([160, 120], |x, y| of(DVec2::new(x as f64, y as f64)).round())
    }

    fn points() -> impl Iterator<Item = DVec2> {
        (0..40).map(|i| DVec2::new(30.0 + f64::from(i % 8) * 12.7, 30.0 + f64::from(i / 8) * 13.3))
    }

    /// Turned, scaled, sheared and moved by several pixels, without a guess: the motion is known exactly.
    #[test]
    fn points_of_a_warped_picture_are_found() {
        let from = picture(|p| texture(p.x, p.y));
        for (turn, scale, shift) in [
            (0.0, 1.0, DVec2::new(0.4, -0.3)),
            (0.0, 1.0, DVec2::new(6.0, -4.5)),
            (0.06, 1.03, DVec2::new(-3.0, 5.0)),
            (-0.08, 0.96, DVec2::new(2.0, 2.0)),
        ] {
            let warp = DMat2::from_angle(turn) * scale;
            let middle = DVec2::new(80.0, 60.0);
            let moved = |p: DVec2| warp * (p - middle) + middle + shift;
            let back = |p: DVec2| warp.inverse() * (p - middle - shift) + middle;
            let to = picture(|p| texture(back(p).x, back(p).y));
            let (mut found, mut worst) = (0, 0.0_f64);
            for point in points().filter(|p| to.holds(moved(*p), 8.0)) {
                if let Some(at) = follow_point(&from, &to, point, point) {
                    found += 1;
                    worst = worst.max(at.distance(moved(point)));
                }
            }
            assert!(found >= 30 && worst < 0.25, "{turn} {scale} {shift}: {found} found, {worst:.3} px off");
        }
    }

    /// A large motion is found with a guess and, without one, not wrongly.
    #[test]
    fn a_guess_leads_far_and_what_is_not_there_is_not_found() {
        let from = picture(|p| texture(p.x, p.y));
        let shift = DVec2::new(24.0, 11.0);
        let to = picture(|p| texture(p.x - shift.x, p.y - shift.y));
        let near = DVec2::new(50.0, 50.0);
        let at = follow_point(&from, &to, near, near + shift + DVec2::new(2.0, -1.5)).unwrap();
        assert!(at.distance(near + shift) < 0.1, "{at}");
        // Another texture altogether: what comes back by chance is rare.
        let other = picture(|p| texture(0.7 * p.y + 300.0, 1.3 * p.x - 90.0));
        let chance = points().filter(|p| follow_point(&from, &other, *p, *p).is_some()).count();
        assert!(chance <= 8, "{chance} of 40");
        // No texture, one in a single direction, and outside.
        let flat = picture(|_| 90.0);
        assert_eq!(follow_point(&flat, &flat, near, near), None);
        let stripes = picture(|p| 128.0 + 60.0 * (0.6 * p.x).sin());
        assert_eq!(follow_point(&stripes, &stripes, near, near), None);
        assert_eq!(follow_point(&from, &to, DVec2::new(2.0, 50.0), near), None);
        assert_eq!(follow_point(&from, &to, DVec2::NAN, near), None);
        assert_eq!(follow_point(&from, &to, near, DVec2::INFINITY), None);
    }
}
