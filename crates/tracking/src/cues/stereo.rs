//! Patches that two neighbouring cameras see alike give points of the surface in space.
//!
//! A patch of the surface as the pose shows it, tangent to the limb, is moved along the ray of one camera: so its place in
//! the other camera moves along the epipolar line, with the foreshortening that it has there. The depth at which both see the
//! same by zero-mean normalised cross-correlation,
//!
//! ```text
//! ZNCC = Σ (a − ā)(b − b̄) / √(Σ (a − ā)² Σ (b − b̄)²)
//! ```
//!
//! is where the surface is, if the peak is high, inside the range and alone. The point pulls at the limb's surface.

use glam::DVec3;

use super::options::CueStrength;
use super::picture::GreyPicture;
use super::source::{BodySight, CueFrame, CueSource, SurfacePoint, metres_per_px};
use crate::camera::Camera;
use crate::residual::cue::{Cue, CuePull, CueTarget};

/// Samples of a patch across and down.
const SIDE: usize = 7;
const SAMPLES: usize = SIDE * SIDE;
/// Pixels between them.
const SPACING_PX: f64 = 1.1;
/// How far along the ray the surface is looked for, metres either way.
const RANGE_M: f64 = 0.1;
/// Pixels of the other camera between two depths.
const STEP_PX: f64 = 0.6;
/// Most depths to either side.
const MOST_DEPTHS: i32 = 40;
/// A peak below this correlation is none.
const LEAST_CORRELATION: f64 = 0.85;
/// Between two depths that are both below this there is no peak: a patch is several steps wide.
const NEAR_PEAK: f64 = 0.55;
/// Another peak may not come nearer to the best one.
const LEAD: f64 = 0.06;
/// A patch with less deviation than this, grey levels, says nothing.
const LEAST_DEVIATION: f64 = 3.0;
/// Places along a limb, and aside of its middle.
const PLACES: [f64; 3] = [0.25, 0.55, 0.85];
const ASIDE: [f64; 2] = [-0.35, 0.35];
/// Neighbouring cameras see a point at an angle of between these cosines (5° and 60°): from nearer depth is not told, from
/// farther they see other sides.
const COSINES: [f64; 2] = [0.5, 0.996];

/// One camera of a pair.
struct StereoView<'a> {
    sight: BodySight<'a>,
    picture: &'a GreyPicture,
}

/// Points in space that neighbouring cameras see alike. Nothing is remembered.
#[derive(Debug)]
pub(super) struct StereoSource;

impl CueSource for StereoSource {
    fn cue(&self) -> Cue {
        Cue::Stereo
    }

    fn pulls(&self, frame: &CueFrame<'_>, camera: usize, strength: CueStrength) -> Vec<CuePull> {
        if frame.limbs.is_empty() {
            return Vec::new();
        }
        let view =
            |camera: usize| Some(StereoView { picture: frame.picture(camera)?, sight: frame.sight(camera) });
        let Some(one) = view(camera) else { return Vec::new() };
        let others = (0..frame.cameras.len()).filter(|other| *other != camera).filter_map(view);
        others.flat_map(|other| pulls(&one, &other, &frame.limbs, strength)).collect()
    }
}

/// Pulls at limbs of the points that two cameras see alike, from the first one's rays.
fn pulls(
    one: &StereoView<'_>,
    other: &StereoView<'_>,
    limbs: &[usize],
    strength: CueStrength,
) -> Vec<CuePull> {
    let pull = |(limb, point): (usize, SurfacePoint)| {
        let point = is_seen_by(other, limb, &point).then(|| point_in_space(one, other, &point))??;
        Some(strength.pull(Cue::Stereo, limb, CueTarget::Surface { point }, 1.0))
    };
    one.sight.visible_points(limbs, PLACES, ASIDE).filter_map(pull).collect()
}

/// Whether the other camera sees a point from not too steep, and not hidden.
fn is_seen_by(other: &StereoView<'_>, limb: usize, point: &SurfacePoint) -> bool {
    let camera = other.sight.camera;
    let Some(pixel) = camera.project(point.world) else { return false };
    let way = (camera.centre() - point.world).normalize();
    let seen = SurfacePoint { pixel, depth: camera.depth(point.world), ..*point };
    way.dot(point.facing) > 0.4 && other.sight.is_visible(limb, &seen)
}

fn point_in_space(one: &StereoView<'_>, other: &StereoView<'_>, point: &SurfacePoint) -> Option<DVec3> {
    let eye = one.sight.camera.centre();
    let ray = (point.world - eye).normalize();
    let towards = (point.world - other.sight.camera.centre()).normalize();
    let cosine = ray.dot(towards);
    if !(COSINES[0]..COSINES[1]).contains(&cosine) {
        return None;
    }
    let metres = metres_per_px(one.sight.camera, point.depth)?;
    let across = point.along.cross(point.facing).normalize();
    let [u, v] = [across, point.along].map(|side| side * (SPACING_PX * metres));
    let here = patch(one.sight.camera, one.picture, point.world, [u, v])?;
    let sine = (1.0 - cosine * cosine).sqrt();
    let step = STEP_PX * metres_per_px(other.sight.camera, other.sight.camera.depth(point.world))? / sine;
    let depths = ((RANGE_M / step).ceil() as i32).clamp(2, MOST_DEPTHS);
    let correlation = |k: i32| {
        let there =
            patch(other.sight.camera, other.picture, point.world + ray * (f64::from(k) * step), [u, v]);
        there.map_or(-1.0, |there| zncc(&here, &there))
    };
    let all = near_peaks((2 * depths + 1) as usize, |at| correlation(at as i32 - depths));
    let offset = peak(&all)? - f64::from(depths);
    Some(point.world + ray * (offset * step))
}

/// Every second correlation, and those beside one that may be near a peak; −1 for those that are not asked for.
fn near_peaks(count: usize, correlation: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut all = vec![-1.0; count];
    for at in (0..count).step_by(2) {
        all[at] = correlation(at);
    }
    for at in (1..count).step_by(2) {
        let beside = all[at - 1].max(all.get(at + 1).copied().unwrap_or(-1.0));
        if beside > NEAR_PEAK {
            all[at] = correlation(at);
        }
    }
    all
}

/// The place of the best peak, between entries; `None` if it is low, at an end, or not alone.
fn peak(all: &[f64]) -> Option<f64> {
    let (best, &height) = all.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    if height < LEAST_CORRELATION || best == 0 || best + 1 == all.len() {
        return None;
    }
    let is_peak = |at: usize| {
        at > 0
            && at + 1 < all.len()
            && all[at] >= all[at - 1]
            && all[at] >= all[at + 1]
            && at.abs_diff(best) > 2
    };
    if (0..all.len()).any(|at| is_peak(at) && all[at] > height - LEAD) {
        return None;
    }
    let [before, after] = [all[best - 1], all[best + 1]];
    let bend = before - 2.0 * height + after;
    let shift = if bend < -1e-9 { 0.5 * (before - after) / bend } else { 0.0 };
    Some(best as f64 + shift.clamp(-0.5, 0.5))
}

/// A patch as a camera sees it, less its mean and of unit length; `None` outside the picture and without texture.
fn patch(
    camera: &Camera,
    picture: &GreyPicture,
    middle: DVec3,
    [u, v]: [DVec3; 2],
) -> Option<[f64; SAMPLES]> {
    let mut levels = [0.0; SAMPLES];
    let half = (SIDE / 2) as f64;
    // The patch is small: its sides are straight lines of even steps.
    let pixel = camera.project(middle)?;
    let [du, dv] = [u, v].map(|side| Some(camera.project(middle + side * half)? - pixel));
    let (du, dv) = (du? / half, dv? / half);
    let reach = half * (du.abs() + dv.abs()).max_element() + 1.0;
    if !picture.holds(pixel, reach) {
        return None;
    }
    for (index, level) in levels.iter_mut().enumerate() {
        let [x, y] = [(index % SIDE) as f64 - half, (index / SIDE) as f64 - half];
        *level = f64::from(picture.at(pixel + du * x + dv * y));
    }
    let mean = levels.iter().sum::<f64>() / SAMPLES as f64;
    levels.iter_mut().for_each(|level| *level -= mean);
    let length = levels.iter().map(|level| level * level).sum::<f64>().sqrt();
    if length < LEAST_DEVIATION * (SAMPLES as f64).sqrt() {
        return None;
    }
    levels.iter_mut().for_each(|level| *level /= length);
    Some(levels)
}

fn zncc(a: &[f64; SAMPLES], b: &[f64; SAMPLES]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::body::{Kinematics, Pose, builtin};
    use crate::fixtures;
    use crate::render::{Ramp, RendererKind, View};

    fn camera(at: DVec3) -> Camera {
        fixtures::camera([160, 120], [260.0, 260.0, 79.5, 59.5], at, DVec3::new(0.2, 0.0, 0.0), DVec3::Y)
    }

    /// What a camera sees of a wall z = `wall` with a pattern that nowhere repeats nearby.
    fn picture(camera: &Camera, wall: f64, pattern: impl Fn(f64, f64) -> f64) -> GreyPicture {
        fixtures::grey_picture([160, 120], |x, y| {
            let ray = camera.ray_in_world(DVec2::new(x as f64, y as f64)).unwrap();
            let at = camera.centre() + ray * ((wall - camera.centre().z) / ray.z);
            pattern(at.x, at.y)
        })
    }

    fn blotches(x: f64, y: f64) -> f64 {
        let wave = |fx: f64, fy: f64, phase: f64| (fx * x + fy * y + phase).sin();
        128.0
            + 25.0 * wave(61.0, 23.0, 0.3)
            + 25.0 * wave(-31.0, 67.0, 1.1)
            + 20.0 * wave(97.0, 88.0, 0.5)
            + 20.0 * wave(-143.0, 51.0, 2.2)
            + 20.0 * wave(37.0, -119.0, 1.7)
            + 15.0 * wave(201.0, 67.0, 2.9)
    }

    /// The limb's front is at z = 0.06; the wall is some centimetres nearer or farther, and there the points are.
    fn points(wall: f64, pattern: impl Fn(f64, f64) -> f64 + Copy) -> Vec<DVec3> {
        let model = builtin::single_limb();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        let cameras = [camera(DVec3::new(-0.5, 0.1, 1.6)), camera(DVec3::new(0.4, 0.0, 1.7))];
        let pictures = cameras.each_ref().map(|camera| picture(camera, wall, pattern));
        let views = cameras
            .each_ref()
            .map(|camera| View::new(&model, &kinematics, camera, RendererKind::Capsule, Ramp::Half));
        let stereo = |index: usize| StereoView {
            sight: BodySight {
                model: &model,
                kinematics: &kinematics,
                camera: &cameras[index],
                view: &views[index],
            },
            picture: &pictures[index],
        };
        let strength = CueStrength { weight: 1.0, scale_m: 0.02 };
        let mut all = pulls(&stereo(0), &stereo(1), &[0], strength);
        all.extend(pulls(&stereo(1), &stereo(0), &[0], strength));
        let point = |pull: &CuePull| match pull.target {
            CueTarget::Surface { point } => point,
            _ => panic!("{pull:?}"),
        };
        all.iter().map(point).collect()
    }

    #[test]
    fn points_lie_where_the_surface_is() {
        for wall in [0.02, 0.05, 0.09] {
            let points = points(wall, blotches);
            let worst = points.iter().map(|point| (point.z - wall).abs()).fold(0.0, f64::max);
            assert!(points.len() >= 6 && worst < 0.005, "wall at {wall}: {} points, {worst}", points.len());
        }
    }

    #[test]
    fn what_is_flat_or_too_far_gives_no_point_and_what_repeats_hardly_any() {
        assert_eq!(points(0.05, |_, _| 90.0), []);
        assert_eq!(points(-0.25, blotches), [], "out of range");
        // Stripes two centimetres apart look alike at many depths; a place that is seen from the side may still be taken for one.
        let stripes = |x: f64, y: f64| 128.0 + 60.0 * (314.0 * x).sin() + 0.1 * y;
        let (repeated, plain) = (points(0.05, stripes).len(), points(0.05, blotches).len());
        assert!(5 * repeated < plain, "{repeated} points of stripes, {plain} of blotches");
    }
}
