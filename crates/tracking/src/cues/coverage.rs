//! Which limbs silhouettes hold: those whose own boundary is seen in enough cameras.
//!
//! Limbs that turn together are one part of the body, and a part is held as a whole. Along each of its limbs, on both sides
//! of the axis as a camera sees it, the outline is looked at in a few places: a little outside of it, and half a radius
//! inside. The boundary there is the part's own, and is seen, where
//!
//! - outside, neither mask nor another part of the body is there,
//! - inside, the mask is, and no other part of the body is: without this one the silhouette would be another.
//!
//! Places where the part itself goes on outside are no outline of it and do not count. A part is seen by a camera that sees
//! enough of what counts. If enough cameras see it, silhouettes hold it, and so they hold a part between others that they
//! hold: an upper arm whose forearm is seen, a chest of whose neck and shoulders two are held. All others are *covered*: an
//! arm before the trunk, one that points at the camera from there, and one that a fit has lost into the trunk or the air.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::body::{Kinematics, Model};
use crate::camera::Camera;
use crate::render::{Ramp, RendererKind, View};
use crate::residual::cue::{Cue, CueSet};
use crate::silhouette::{Label, Mask};

/// Places along a limb, as fractions of its length.
const PLACES: [f64; 3] = [0.2, 0.5, 0.85];
/// How far inside of its outline a limb is looked at, in radii from the axis.
const INSIDE: f64 = 0.5;
/// A limb whose axis is within this sine of a ray (12°) points at the camera: it is looked at about its far end.
const END_ON: f64 = 0.2;
/// This many held parts that grow from a part hold it, or all where there are fewer.
const HOLDING_CHILDREN: usize = 2;
/// Limbs nearer to the camera's plane than this are not looked at, metres.
const NEAREST: f64 = 0.1;
/// λ/255 of the `half` ramp on a solid's outline.
const OUTLINE: f64 = 0.5;

/// When a part of the body is held by silhouettes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CoverageOptions {
    /// This many cameras must see a boundary of its own; all of them where there are fewer.
    pub enough_cameras: usize,
    /// A camera sees a part if it sees this share of its outline, 0 to 1.
    pub seen_share: f64,
    /// How far outside of the outline nothing may be, metres: masks are too wide by less than that.
    pub margin_m: f64,
}

impl Default for CoverageOptions {
    fn default() -> Self {
        Self { enough_cameras: 2, seen_share: 0.4, margin_m: 0.03 }
    }
}

/// One camera of a frame, as cues ask for it.
#[derive(Debug, Clone)]
pub struct WatchedCamera {
    /// An ideal pinhole.
    pub camera: Arc<Camera>,
    /// Its silhouette; without one the body alone says what covers what.
    pub mask: Option<Arc<Mask>>,
}

/// Which parts of the body are held by silhouettes, at one pose.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Coverage {
    /// By rotation, how many cameras see it.
    cameras: Vec<usize>,
    /// By rotation, whether silhouettes hold it.
    held: Vec<bool>,
    /// How many cameras must see a part.
    enough: usize,
    rotation_of: Vec<usize>,
}

impl Coverage {
    /// Looks at a pose through all cameras that have a silhouette.
    pub(super) fn new(
        model: &Model,
        kinematics: &Kinematics,
        views: &[WatchedCamera],
        renderer: RendererKind,
        options: &CoverageOptions,
    ) -> Self {
        let mut cameras = vec![0; model.rotation_count()];
        for view in views {
            let shares = shares_of(model, kinematics, view, renderer, options.margin_m);
            for (cameras, share) in cameras.iter_mut().zip(shares) {
                *cameras += usize::from(share > 0.0 && share >= options.seen_share);
            }
        }
        let enough = options.enough_cameras.min(views.len()).max(1);
        let held = held_parts(model, cameras.iter().map(|cameras| *cameras >= enough).collect());
        let rotation_of = model.limbs().iter().map(|limb| limb.rotation).collect();
        Self { cameras, held, enough, rotation_of }
    }

    /// Whether silhouettes hold neither the limb nor any that turns with it.
    pub(super) fn is_covered(&self, limb: usize) -> bool {
        !self.held[self.rotation_of[limb]]
    }
}

/// Those that are seen, and those whose ends others hold: all that grow from them, or two of several.
fn held_parts(model: &Model, mut held: Vec<bool>) -> Vec<bool> {
    // Tips first.
    for &rotation in model.rotations_parents_first().iter().rev() {
        let parents = model.rotation_parents().iter().enumerate();
        let children = parents.filter(|(_, parent)| **parent == Some(rotation)).map(|(child, _)| child);
        let (mut all, mut of_them) = (0, 0);
        for child in children {
            all += 1;
            of_them += usize::from(held[child]);
        }
        held[rotation] |= of_them > 0 && of_them >= all.min(HOLDING_CHILDREN);
    }
    held
}

/// By rotation, the share of its outline that is seen.
fn shares_of(
    model: &Model,
    kinematics: &Kinematics,
    view: &WatchedCamera,
    renderer: RendererKind,
    margin: f64,
) -> Vec<f64> {
    let (camera, mask) = (&*view.camera, view.mask.as_deref());
    let drawn = View::new(model, kinematics, camera, renderer, Ramp::Half);
    let eye = Eye { model, camera, mask, drawn: &drawn, margin };
    let mut counts = vec![[0.0; 2]; model.rotation_count()];
    for (index, limb) in model.limbs().iter().enumerate() {
        let place = camera.camera_from_world();
        let ends = [kinematics.starts()[index], kinematics.ends()[index]].map(|p| place.transform(p));
        let [seen, all] = &mut counts[limb.rotation];
        eye.outline(ends, limb.radius, |inside, outside| {
            // The part itself does not go on there.
            if !eye.meets(outside, |other| other == limb.rotation) {
                // A longer limb's places stand for more of the outline.
                *all += limb.length;
                *seen += if eye.is_boundary(limb.rotation, inside, outside) { limb.length } else { 0.0 };
            }
        });
    }
    counts.into_iter().map(|[seen, all]| if all > 0.0 { seen / all } else { 0.0 }).collect()
}

/// By rotation, whether silhouettes do not hold it.
pub(crate) fn unheld(
    model: &Model,
    kinematics: &Kinematics,
    views: &[WatchedCamera],
    renderer: RendererKind,
) -> Vec<bool> {
    let coverage = Coverage::new(model, kinematics, views, renderer, &CoverageOptions::default());
    coverage.held.iter().map(|held| !held).collect()
}

struct Eye<'a> {
    model: &'a Model,
    camera: &'a Camera,
    mask: Option<&'a Mask>,
    drawn: &'a View,
    /// Metres.
    margin: f64,
}

impl Eye<'_> {
    /// Hears of places inside and outside of a limb's outline, camera axes.
    fn outline(&self, [p0, p1]: [DVec3; 2], radius: f64, mut look: impl FnMut(DVec3, DVec3)) {
        if p0.z.min(p1.z) < NEAREST {
            return;
        }
        let axis = p1 - p0;
        let mut both_sides = |at: DVec3, across: DVec3| {
            for across in [across, -across] {
                look(at + across * (INSIDE * radius), at + across * (radius + self.margin));
            }
        };
        let ray = p1.normalize();
        let across = axis.cross(ray);
        if across.length() < END_ON * axis.length() {
            let (one, other) = ray.any_orthonormal_pair();
            both_sides(p1, one);
            both_sides(p1, other);
            return;
        }
        for fraction in PLACES {
            let at = p0 + axis * fraction;
            both_sides(at, axis.cross(at).normalize_or(across.normalize()));
        }
    }

    fn is_boundary(&self, rotation: usize, inside: DVec3, outside: DVec3) -> bool {
        let is_other = |other: usize| other != rotation;
        self.is_label(outside, Label::Background)
            && self.is_label(inside, Label::Subject)
            && !self.meets(outside, is_other)
            && !self.meets(inside, is_other)
    }

    /// Whether the mask says this of a place, if there is one; what lies outside of the picture nobody says.
    fn is_label(&self, place: DVec3, label: Label) -> bool {
        let px = self.pixel(place).round();
        let is_in = px.x >= 0.0 && px.y >= 0.0;
        let [width, height] = [self.camera.width(), self.camera.height()];
        if !is_in || px.x >= width as f64 || px.y >= height as f64 {
            return false;
        }
        self.mask.is_none_or(|mask| mask.get(px.x as usize, px.y as usize) == Some(label))
    }

    /// Whether the ray through a place meets a limb of such a rotation.
    fn meets(&self, place: DVec3, rotation: impl Fn(usize) -> bool) -> bool {
        let (px, ray) = (self.pixel(place), place.normalize());
        let [x, y] = px.round().max(DVec2::ZERO).to_array().map(|coordinate| coordinate as usize);
        self.drawn.primitives.iter().any(|primitive| {
            primitive.bounds.contains(x, y)
                && rotation(self.model.limbs()[primitive.limb].rotation)
                && primitive.ramp.unclipped(primitive.squared(ray)) < OUTLINE
        })
    }

    fn pixel(&self, place: DVec3) -> DVec2 {
        self.camera.intrinsics().pixel_from_plane(place.truncate() / place.z)
    }
}

/// A pull counts if its loss believes it at the fitted pose by this much, 0 to 1.
const BELIEVED: f64 = 0.5;
/// This many flowed points, pieces of edge or points in space hold a part.
const FEWEST: usize = 4;

/// What held a part of the body in one frame: the limb that owns a rotation, and those that turn with it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LimbHold {
    /// The limb that owns the rotation.
    pub limb: usize,
    /// How many cameras see a boundary of its own.
    pub cameras: usize,
    /// Whether those are enough, or it lies between parts that silhouettes hold.
    pub by_silhouettes: bool,
    /// The cues that held it besides, in their order.
    pub cues: Vec<Cue>,
}

impl LimbHold {
    /// Whether nothing held it: its pose is what motion and priors make of it.
    #[must_use]
    pub fn is_unsure(&self) -> bool {
        !self.by_silhouettes && self.cues.is_empty()
    }

    /// Says of every part what held it at a fitted pose, in the order of the rotations. A cue holds a part where enough of
    /// its pulls agree with the pose: a keypoint in as many cameras as a silhouette needs, four points of the others.
    pub(super) fn of_pose(
        model: &Model,
        kinematics: &Kinematics,
        coverage: &Coverage,
        set: &CueSet,
    ) -> Vec<Self> {
        let mut counts = vec![[0; Cue::ALL.len()]; model.rotation_count()];
        for pull in &set.pulls {
            let believed = set.distance(pull, model, kinematics).is_some_and(|(_, share)| share >= BELIEVED);
            if let Some(cue) = Cue::ALL.iter().position(|cue| *cue == pull.cue)
                && believed
            {
                counts[model.limbs()[pull.limb].rotation][cue] += 1;
            }
        }
        let holds = |(cue, count): (Cue, usize)| {
            let needed = if cue == Cue::Keypoints { coverage.enough } else { FEWEST };
            (count >= needed).then_some(cue)
        };
        let of_part = |(&limb, counts): (&usize, [usize; Cue::ALL.len()])| Self {
            limb,
            cameras: coverage.cameras[coverage.rotation_of[limb]],
            by_silhouettes: !coverage.is_covered(limb),
            cues: Cue::ALL.into_iter().zip(counts).filter_map(holds).collect(),
        };
        model.rotation_owners().iter().zip(counts).map(of_part).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use crate::body::{Pose, builtin};
    use crate::fixtures;

    use super::*;

    /// Seen from the front (the body faces +y) at this many degrees to its left.
    fn camera(degrees: f64) -> Camera {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let at = DVec3::new(-3.0 * sine, 3.0 * cosine, 1.1);
        let intrinsics = [320.0, 320.0, 89.5, 129.5];
        fixtures::camera([180, 260], intrinsics, at, DVec3::new(0.0, 0.0, 0.9), DVec3::Z)
    }

    fn posed(model: &Model, turns: &[(&str, DQuat)]) -> Pose {
        fixtures::posed(model, DVec3::new(0.0, 0.0, 0.92), turns)
    }

    fn covered(model: &Model, pose: &Pose, truth: &Pose, angles: &[f64]) -> Vec<String> {
        let view = |angle: &f64| {
            let camera = Arc::new(camera(*angle));
            WatchedCamera { mask: Some(Arc::new(fixtures::mask(model, truth, &camera))), camera }
        };
        let views: Vec<WatchedCamera> = angles.iter().map(view).collect();
        let options = CoverageOptions::default();
        let coverage =
            Coverage::new(model, &Kinematics::new(model, pose), &views, RendererKind::Capsule, &options);
        let name = |&owner: &usize| model.limbs()[owner].name.clone();
        let owners = model.rotation_owners().iter();
        owners.filter(|owner| coverage.is_covered(**owner)).map(name).collect()
    }

    /// Arms hang beside the trunk, a hand's breadth off.
    fn standing() -> [(&'static str, DQuat); 4] {
        [
            ("right upper arm", DQuat::from_rotation_y(-0.5)),
            ("left upper arm", DQuat::from_rotation_y(0.5)),
            ("right thigh", DQuat::from_rotation_y(-0.15)),
            ("left thigh", DQuat::from_rotation_y(0.15)),
        ]
    }

    #[test]
    fn who_stands_with_arms_off_the_trunk_is_held_whole() {
        let model = builtin::full_body();
        let truth = posed(&model, &standing());
        let found = covered(&model, &truth, &truth, &[24.0, -13.0]);
        let limbs = |names: &[String]| {
            names.iter().filter(|name| ["arm", "thigh", "calf"].iter().any(|w| name.contains(w))).count()
        };
        assert_eq!(limbs(&found), 0, "{found:?}");
        assert!(!found.contains(&"spine".to_owned()) && !found.contains(&"chest".to_owned()), "{found:?}");
    }

    #[test]
    fn an_arm_before_the_trunk_is_covered() {
        let model = builtin::full_body();
        let mut turns = standing().to_vec();
        // Down and a little in before the belly, the elbow bent.
        turns[0].1 =
            DQuat::from_rotation_z(0.2) * DQuat::from_rotation_x(0.35) * DQuat::from_rotation_y(0.25);
        turns.push(("right forearm", DQuat::from_rotation_z(0.9) * DQuat::from_rotation_x(1.5)));
        let truth = posed(&model, &turns);
        let found = covered(&model, &truth, &truth, &[10.0, -10.0]);
        assert!(found.contains(&"right forearm".to_owned()), "{found:?}");
        assert!(!found.contains(&"left forearm".to_owned()), "{found:?}");
    }

    /// A model's arm where no silhouette has one is not held, in the air as in the trunk.
    #[test]
    fn a_lost_arm_is_covered() {
        let model = builtin::full_body();
        let truth = posed(&model, &standing());
        let mut turns = standing().to_vec();
        turns[0].1 = DQuat::from_rotation_y(-1.6);
        let in_the_air = posed(&model, &turns);
        turns[0].1 = DQuat::from_rotation_y(0.12);
        let in_the_trunk = posed(&model, &turns);
        for lost in [in_the_air, in_the_trunk] {
            let found = covered(&model, &lost, &truth, &[24.0, -13.0]);
            assert!(found.contains(&"right forearm".to_owned()), "{found:?}");
            assert!(!found.contains(&"left forearm".to_owned()), "{found:?}");
        }
    }

    /// One of two cameras is not enough, but one is where there is no other.
    #[test]
    fn as_many_cameras_as_there_are_must_see_a_limb() {
        let model = builtin::full_body();
        let truth = posed(&model, &standing());
        // From the side the left arm hides behind the trunk, or the trunk behind it.
        let both = covered(&model, &truth, &truth, &[-90.0, 0.0]);
        assert!(both.contains(&"left upper arm".to_owned()), "{both:?}");
        let one = covered(&model, &truth, &truth, &[0.0]);
        assert!(!one.contains(&"left upper arm".to_owned()), "{one:?}");
        let nobody = Coverage::new(
            &model,
            &Kinematics::new(&model, &truth),
            &[],
            RendererKind::Capsule,
            &CoverageOptions::default(),
        );
        assert!(nobody.is_covered(0));
    }
}
