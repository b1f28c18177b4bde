//! The sizes of one posed body: every limb grown, chains' ends found, both sides and all frames together.

use glam::DVec3;

use super::AcquireOptions;
use crate::body::{Kinematics, Model, ModelError, Pose};
use crate::statistics::median;
use crate::templates::{Segment, Silhouettes, Template, TemplateBody};

/// A chain that is bent by less, radians, does not show where its middle joint is: it keeps its proportions.
const BENT: f64 = 0.4;
/// Places of the middle joint that are tried, as factors of the upper part's length.
const JOINTS: [f64; 9] = [0.8, 0.85, 0.9, 0.95, 1.0, 1.05, 1.1, 1.15, 1.2];
/// The template of a limb is grown between these fractions of it: joints are thicker than limbs.
const BETWEEN: [f64; 2] = [0.15, 0.85];

/// Factors of every limb's length and radius; `None` where nothing was measured.
pub(super) type Factors = Vec<[Option<f64>; 2]>;

/// Measures one posed body.
pub(super) fn measured(
    frame: &TemplateBody<'_>,
    pictures: &Silhouettes,
    options: &AcquireOptions,
    pose: &Pose,
) -> Factors {
    let model = frame.model;
    let kinematics = Kinematics::new(model, pose);
    let mut factors: Factors = vec![[None; 2]; model.limbs().len()];
    for (limb, factor) in factors.iter_mut().enumerate() {
        let (from, to) = (kinematics.starts()[limb], kinematics.ends()[limb]);
        let between = BETWEEN.map(|at| from.lerp(to, at));
        let radius = model.limbs()[limb].radius;
        let template = Template { from: between[0], to: between[1], radius };
        factor[1] = grown_radius(pictures, options, &template).map(|found| found / radius);
    }
    for chain in 0..frame.parts.chains.len() {
        let segments = frame.segments(chain);
        let wide: Vec<&Segment> = segments.iter().filter(|segment| segment.is_wide).collect();
        for (rotation, factor) in chain_factors(frame, pictures, options, &kinematics, &wide) {
            for &limb in &frame.parts.groups[rotation] {
                factors[limb][0] = Some(factor);
            }
        }
    }
    factors
}

/// Factors of the lengths of a chain's long parts, by rotation.
fn chain_factors(
    frame: &TemplateBody<'_>,
    pictures: &Silhouettes,
    options: &AcquireOptions,
    kinematics: &Kinematics,
    wide: &[&Segment],
) -> Vec<(usize, f64)> {
    let Some(&last) = wide.last() else { return Vec::new() };
    let ends = |segment: &Segment| [kinematics.starts()[segment.first], kinematics.ends()[segment.last]];
    let [from, to] = ends(last);
    let model = frame.model;
    let end_radius = model.limbs()[last.last].radius;
    // What hangs on its end, as a foot does.
    let hung = model.limbs().iter().filter(|limb| limb.parent == Some(last.last)).map(|limb| limb.radius);
    let beyond = hung.fold(end_radius, f64::max);
    let template = Template { from, to, radius: end_radius };
    let Some(found) = grown_length(pictures, options, &template, beyond) else { return Vec::new() };
    let long = from.distance(to);
    let [upper] = wide[..wide.len() - 1] else { return vec![(last.rotation, found / long)] };
    let [begin, joint] = ends(upper);
    let (above, below) = (joint - begin, to - from);
    if above.angle_between(below) < BENT {
        let factor = (above.length() + found) / (above.length() + long);
        return vec![(upper.rotation, factor), (last.rotation, factor)];
    }
    let end = from + below.normalize_or_zero() * found;
    let worth = |factor: f64| {
        let joint = begin + above * factor;
        let of = |from: DVec3, to: DVec3, radius: f64| {
            let held = pictures.held(&Template { from, to, radius });
            held.subject - held.background
        };
        of(begin, joint, upper.radius) + of(joint, end, last.radius)
    };
    // Of equals the one that changes least.
    let mut best = (worth(1.0), 1.0);
    for factor in JOINTS {
        let value = worth(factor);
        if value > best.0 + 1e-9 {
            best = (value, factor);
        }
    }
    let below = end.distance(begin + above * best.1);
    vec![(upper.rotation, best.1), (last.rotation, below / long)]
}

/// The body with the medians of all factors, both sides and all frames together. What was not measured keeps its length, and its
/// radius grows as most do.
pub(super) fn resized(model: &Model, all: &[Factors]) -> Result<Model, ModelError> {
    let of = |limb: usize, kind: usize| -> Vec<f64> {
        let both = [limb, model.mirrored_limb(limb)];
        all.iter().flat_map(|factors| both.map(|limb| factors[limb][kind])).flatten().collect()
    };
    let mut radii: Vec<f64> = (0..model.limbs().len()).flat_map(|limb| of(limb, 1)).collect();
    let usual = median(&mut radii).unwrap_or(1.0);
    model.with_sizes(|limb| {
        let part = &model.limbs()[limb];
        let length = median(&mut of(limb, 0)).unwrap_or(1.0);
        [part.length * length, part.radius * median(&mut of(limb, 1)).unwrap_or(usual)]
    })
}

/// Per limb, whether its length and radius were measured, on either side and in any frame.
pub(super) fn are_measured(model: &Model, all: &[Factors]) -> Vec<[bool; 2]> {
    let is = |limb: usize, kind: usize| all.iter().any(|factors| factors[limb][kind].is_some());
    let either = |limb: usize| [0, 1].map(|kind| is(limb, kind) || is(model.mirrored_limb(limb), kind));
    (0..model.limbs().len()).map(either).collect()
}

/// A limb's end is felt for by a ball of this share of its radius.
const BALL: f64 = 0.8;
/// How far the ball sticks out where it is stopped, in its radii.
const STICKS_OUT: f64 = 0.18;

/// A radius, by growing; `None` where nothing stops it, or nothing of it is inside.
fn grown_radius(pictures: &Silhouettes, options: &AcquireOptions, template: &Template) -> Option<f64> {
    let enters =
        |radius: f64| pictures.held(&Template { radius, ..*template }).most_background > options.background;
    let found = grown(template.radius, options, enters)?;
    Some(found * (1.0 - options.background))
}

/// The length of a limb from one joint along a direction to where the silhouettes end, less `beyond`: what the body has there beyond
/// the joint. `None` where nothing stops it, or nothing of it is inside.
fn grown_length(
    pictures: &Silhouettes,
    options: &AcquireOptions,
    template: &Template,
    beyond: f64,
) -> Option<f64> {
    let along = (template.to - template.from).try_normalize()?;
    let ball = BALL * template.radius;
    let enters = |length: f64| {
        let centre: DVec3 = template.from + along * length;
        let ball = Template { from: centre, to: centre, radius: ball };
        pictures.held(&ball).most_background > options.background
    };
    let found = grown(template.from.distance(template.to), options, enters)?;
    Some(found + (1.0 - STICKS_OUT) * ball - beyond)
}

/// A size that shrinks while background is inside, and grows until it enters.
fn grown(begin: f64, options: &AcquireOptions, enters: impl Fn(f64) -> bool) -> Option<f64> {
    let [low, high] = options.range.map(|factor| factor * begin);
    let mut size = begin;
    while enters(size) {
        size *= 1.0 - options.step;
        if size < low {
            return None;
        }
    }
    while !enters(size * (1.0 + options.step)) {
        size *= 1.0 + options.step;
        if size > high {
            return None;
        }
    }
    Some(size)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use crate::fit::FitView;
    use crate::fixtures;

    use super::*;

    /// Two cameras' pictures of a capsule.
    fn pictures(from: DVec3, to: DVec3, radius: f64) -> Silhouettes {
        let view = |at: DVec3| {
            let intrinsics = [400.0, 400.0, 99.5, 99.5];
            let camera = fixtures::camera([200, 200], intrinsics, at, 0.5 * (from + to), DVec3::Z);
            let is_in = |x: usize, y: usize| {
                let ray = camera.ray_in_world(DVec2::new(x as f64, y as f64)).unwrap();
                let distance = |t: f64| {
                    let away = from.lerp(to, t) - at;
                    (away - ray * ray.dot(away)).length()
                };
                let least = (0..=100).map(|k| distance(f64::from(k) / 100.0)).fold(f64::INFINITY, f64::min);
                least < radius
            };
            let mask = fixtures::covered([200, 200], is_in);
            FitView::of_mask(camera, mask)
        };
        Silhouettes::new(&[view(DVec3::new(3.0, 0.2, 0.5)), view(DVec3::new(0.3, -3.0, 0.4))])
    }

    #[test]
    fn a_capsule_gets_its_own_sizes_whatever_the_template_begins_with() {
        let (from, to, radius) = (DVec3::new(0.0, 0.0, 0.2), DVec3::new(0.05, 0.02, 0.7), 0.07);
        let pictures = pictures(from, to, radius);
        let options = AcquireOptions::default();
        let along = (to - from).normalize();
        for (long, thick) in [(0.8, 0.8), (1.0, 1.3), (1.2, 1.0)] {
            let template = Template { from, to: from + (to - from) * long, radius: radius * thick };
            let inside = Template { to: from + (to - from) * 0.9, ..template };
            let found = grown_radius(&pictures, &options, &inside).unwrap();
            assert!((found / radius - 1.0).abs() < 0.06, "radius {found} of {radius}, begun at {thick}");
            let template = Template { radius, ..template };
            let found = grown_length(&pictures, &options, &template, radius).unwrap();
            assert!((found - (to - from).length()).abs() < 0.02, "length {found}, begun at {long}");
        }
        let outside = Template { from: from + along * 2.0, to: to + along * 2.0, radius };
        assert_eq!(grown_radius(&pictures, &options, &outside), None);
    }
}
