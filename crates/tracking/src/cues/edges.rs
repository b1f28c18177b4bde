//! Gradients of the picture along a limb's outline, with the polarity that they had in the frame before.
//!
//! About a point of the outline that the camera sees, the picture is read along the outline's normal, outwards. Which side is
//! the brighter one, and by how much, is remembered of each place of each limb from frame to frame; the step of the same
//! polarity that is nearest to the remembered contrast is where the outline is. Only the distance along the normal is
//! measured: the point pulls to a line. The outline's own motion on the limb as it turns drops out, since the surface there
//! runs along the ray.

use std::collections::BTreeMap;

use glam::DVec2;

use super::options::CueStrength;
use super::picture::GreyPicture;
use super::source::{BodySight, CueFrame, CueSource, SurfacePoint, metres_per_px};
use crate::residual::cue::{Cue, CuePull, CueTarget};

/// Places along a limb.
const PLACES: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
/// How far from the outline a step is looked for, metres.
const REACH_M: f64 = 0.05;
/// Pixels between samples along the normal.
const SAMPLE_PX: f64 = 0.5;
/// Samples between the two sides of a step.
const ACROSS: usize = 4;
/// Most samples to either side.
const MOST_SAMPLES: usize = 60;
/// A step below this contrast is none, grey levels.
const LEAST_CONTRAST: f32 = 8.0;
/// A step is taken for the outline if its contrast is this share of the remembered one, and not this many times as much.
const SAME_CONTRAST: [f32; 2] = [0.5, 2.0];
/// What a new frame's contrast counts beside the remembered one.
const RENEWAL: f32 = 0.3;
/// How far from a fitted outline its step may be, pixels.
const FITTED_PX: f64 = 2.0;

/// A place of an outline: limb, place along it, side.
type OutlinePlace = (usize, usize, bool);

/// Contrasts of outlines in one camera, outside less inside, grey levels.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct EdgeMemory(BTreeMap<OutlinePlace, f32>);

/// The picture along the normal of a place, and the contrasts of all steps.
struct Profile {
    point: SurfacePoint,
    normal: DVec2,
    /// Contrast at k − middle samples from the outline.
    steps: Vec<f32>,
    middle: usize,
}

impl Profile {
    fn offset_px(&self, step: usize) -> f64 {
        (step as f64 - self.middle as f64) * SAMPLE_PX
    }
}

/// As far as [`REACH_M`], where nothing else is said.
fn profile(
    sight: &BodySight<'_>,
    picture: &GreyPicture,
    (limb, place, is_left): OutlinePlace,
    reach_px: Option<f64>,
) -> Option<Profile> {
    let point = sight.point(limb, PLACES[place], if is_left { -1.0 } else { 1.0 })?;
    if !sight.is_visible(limb, &point) {
        return None;
    }
    let outside = sight.camera.project(point.world + point.aside * 0.01)?;
    let normal = (outside - point.pixel).try_normalize()?;
    let reach = reach_px.unwrap_or(REACH_M / metres_per_px(sight.camera, point.depth)?);
    let middle = ((reach / SAMPLE_PX).ceil() as usize).clamp(ACROSS, MOST_SAMPLES);
    let last = (middle + ACROSS) as f64 * SAMPLE_PX;
    if !picture.holds(point.pixel + normal * last, 1.0) || !picture.holds(point.pixel - normal * last, 1.0) {
        return None;
    }
    let half = ACROSS / 2;
    let sample =
        |k: usize| picture.at(point.pixel + normal * ((k as f64 - (middle + half) as f64) * SAMPLE_PX));
    let samples: Vec<f32> = (0..=2 * (middle + half)).map(sample).collect();
    let steps = samples.windows(ACROSS + 1).map(|window| window[ACROSS] - window[0]).collect();
    Some(Profile { point, normal, steps, middle })
}

/// Whether a step is at least as high as those beside it.
fn is_peak(steps: &[f32], at: usize, sign: f32) -> bool {
    let height = |at: usize| steps.get(at).map_or(f32::NEG_INFINITY, |step| sign * step);
    height(at) >= height(at + 1) && (at == 0 || height(at) >= height(at - 1))
}

fn places(limbs: impl Iterator<Item = usize>) -> impl Iterator<Item = OutlinePlace> {
    limbs
        .flat_map(|limb| (0..PLACES.len()).flat_map(move |place| [(limb, place, false), (limb, place, true)]))
}

impl EdgeMemory {
    /// Remembers the contrasts along the outlines of all limbs at a fitted pose.
    pub(super) fn learn(&mut self, sight: &BodySight<'_>, picture: &GreyPicture) {
        for place in places(0..sight.model.limbs().len()) {
            let Some(profile) = profile(sight, picture, place, Some(FITTED_PX)) else { continue };
            let strongest = profile.steps.iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
            let Some(&contrast) = strongest else { continue };
            let known = self.0.entry(place).or_insert(contrast);
            *known += RENEWAL * (contrast - *known);
        }
    }

    /// Pulls of a camera's picture at the outlines of limbs.
    pub(super) fn pulls(
        &self,
        sight: &BodySight<'_>,
        camera: usize,
        picture: &GreyPicture,
        limbs: &[usize],
        strength: CueStrength,
    ) -> Vec<CuePull> {
        let one = |place: OutlinePlace| {
            let known = *self.0.get(&place)?;
            if known.abs() < LEAST_CONTRAST {
                return None;
            }
            let profile = profile(sight, picture, place, None)?;
            let sign = known.signum();
            let is_same_contrast = |at: &usize| {
                let share = profile.steps[*at] / known;
                (SAME_CONTRAST[0]..SAME_CONTRAST[1]).contains(&share) && is_peak(&profile.steps, *at, sign)
            };
            let near = (0..profile.steps.len())
                .filter(is_same_contrast)
                .min_by_key(|at| at.abs_diff(profile.middle))?;
            let metres_per_px = metres_per_px(sight.camera, profile.point.depth)?;
            let (arm, normal) = (profile.point.arm, profile.normal);
            let pixel = profile.point.pixel + normal * profile.offset_px(near);
            let target = CueTarget::Line { camera, arm, pixel, normal };
            Some(strength.pull(Cue::Edges, place.0, target, metres_per_px))
        };
        places(limbs.iter().copied()).filter_map(one).collect()
    }
}

/// Contrasts of outlines, by camera's name.
pub(super) type EdgeSource = BTreeMap<String, EdgeMemory>;

impl CueSource for EdgeSource {
    fn cue(&self) -> Cue {
        Cue::Edges
    }

    fn pulls(&self, frame: &CueFrame<'_>, camera: usize, strength: CueStrength) -> Vec<CuePull> {
        let edges = self.get(frame.cameras[camera].name());
        let Some((edges, picture)) = edges.zip(frame.picture(camera)) else { return Vec::new() };
        edges.pulls(&frame.sight(camera), camera, picture, &frame.limbs, strength)
    }

    fn learn(&mut self, frame: &CueFrame<'_>) {
        let is_on = frame.options.strength(Cue::Edges).weight > 0.0;
        for camera in (0..frame.cameras.len()).filter(|_| is_on) {
            let Some(picture) = frame.picture(camera) else { continue };
            let edges = self.entry(frame.cameras[camera].name().to_owned()).or_default();
            edges.learn(&frame.sight(camera), picture);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::body::{Kinematics, Model, Pose, builtin};
    use crate::camera::Camera;
    use crate::fixtures;
    use crate::render::{Ramp, RendererKind, View};

    fn camera() -> Camera {
        let (from, at) = (DVec3::new(0.2, 0.0, 1.5), DVec3::X * 0.2);
        fixtures::camera([160, 120], [200.0, 200.0, 79.5, 59.5], from, at, DVec3::Y)
    }

    /// A bar as bright as this on a ground of 100, from row to row, its edges a pixel wide.
    fn bar(rows: [f64; 2], level: f64) -> impl Fn(f64) -> f64 {
        move |y| 100.0 + (level - 100.0) * ((y - rows[0]).min(rows[1] - y) + 0.5).clamp(0.0, 1.0)
    }

    fn picture(of: impl Fn(f64) -> f64) -> GreyPicture {
        fixtures::grey_picture([160, 120], |_, y| of(y as f64))
    }

    fn with<T>(model: &Model, down_m: f64, then: impl FnOnce(&BodySight<'_>) -> T) -> T {
        let mut pose = Pose::rest(model);
        pose.root.y -= down_m;
        let (kinematics, camera) = (Kinematics::new(model, &pose), camera());
        let view = View::new(model, &kinematics, &camera, RendererKind::Capsule, Ramp::Half);
        then(&BodySight { model, kinematics: &kinematics, camera: &camera, view: &view })
    }

    /// Rows of the limb's outline at rest.
    fn rows(model: &Model) -> [f64; 2] {
        with(model, 0.0, |sight| {
            let mut rows = [-1.0, 1.0].map(|s| sight.point(0, 0.5, s).unwrap().pixel.y);
            rows.sort_by(f64::total_cmp);
            rows
        })
    }

    #[test]
    fn an_outline_pulls_to_the_edge_of_its_own_polarity() {
        let model = builtin::single_limb();
        let strength = CueStrength { weight: 1.0, scale_m: 0.02 };
        let [top, bottom] = rows(&model);
        let bright = picture(bar([top, bottom], 180.0));
        let mut memory = EdgeMemory::default();
        with(&model, 0.0, |sight| memory.learn(sight, &bright));
        assert!(memory.0.values().all(|contrast| *contrast < -40.0), "{memory:?}");
        // The limb's start is 2.5 cm, 3.5 px too low: every place pulls to a row of the bar's edges.
        let pulls = with(&model, 0.025, |sight| memory.pulls(sight, 0, &bright, &[0], strength));
        assert_eq!(pulls.len(), 8);
        for pull in &pulls {
            let CueTarget::Line { pixel, normal, .. } = pull.target else { panic!("{pull:?}") };
            let off = (pixel.y - top).abs().min((pixel.y - bottom).abs());
            assert!(off < 0.5 && normal.y.abs() > 0.99, "{pull:?}, edges at {top} and {bottom}");
        }
        // A dark bar there has other polarities, and one that is hardly brighter another contrast: nobody pulls.
        for level in [20.0, 112.0] {
            let other = picture(bar([top, bottom], level));
            let pulls = with(&model, 0.01, |sight| memory.pulls(sight, 0, &other, &[0], strength));
            assert_eq!(pulls, [], "{level}");
        }
        let nothing = EdgeMemory::default();
        assert_eq!(with(&model, 0.0, |sight| nothing.pulls(sight, 0, &bright, &[0], strength)), []);
    }
}
