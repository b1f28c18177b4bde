//! Bodies other than the posed one as a camera sees them, in pixel coordinates: ghosts in its place, a body that sways,
//! and ellipses of its joints with the factor by which they are drawn larger than life.
//!
//! The factor depends on the deviations in the world alone: ellipses grow with the picture when that is zoomed.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::observability::{ImageEllipse, JointUncertainty};
use backlit_tracking::render::RendererKind;
use glam::{DVec2, DVec3};

use super::limbs::place_in_front;
use super::{JointId, ProjectedLimb, draggable_joints, joined_outline, joint_name, project_limbs};
use crate::style::format;

/// Opacity of the lightest of many bodies, and of the heaviest of up to `OF` bodies.
const FAINTEST: f64 = 0.05;
const OPACITY: f64 = 0.9;
const OF: f64 = 8.0;
/// One of them.
#[derive(Debug, Clone)]
pub struct Ghost {
    /// Where its limbs are.
    pub kinematics: Kinematics,
    /// Its weight, in whatever measure all have.
    pub weight: f64,
}

/// A ball or a capsule that is laid on the silhouettes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Template {
    /// Its ends; both the same for a ball.
    pub ends: [DVec3; 2],
    /// Metres.
    pub radius: f64,
}

/// All of them.
#[derive(Debug, Clone)]
pub struct Ghosts {
    /// Their body.
    pub model: Arc<Model>,
    /// The one that is drawn whole, then those that are drawn as sticks, the heaviest first.
    pub bodies: Vec<Ghost>,
    /// Per limb, whether it is drawn: others have no place yet.
    pub placed: Vec<bool>,
    /// Per limb, whether it is marked.
    pub marked: Vec<bool>,
    /// What is laid on the silhouettes to find its place.
    pub template: Option<Template>,
    /// What they are, for a legend.
    pub words: String,
}

impl Ghosts {
    /// Poses of a body with their weights; all limbs are drawn and none is marked. The first is drawn whole.
    pub fn new<'a>(model: &Arc<Model>, bodies: impl IntoIterator<Item = (&'a Pose, f64)>) -> Self {
        let ghost = |(pose, weight)| Ghost { kinematics: Kinematics::new(model, pose), weight };
        let limbs = model.limbs().len();
        Self {
            bodies: bodies.into_iter().map(ghost).collect(),
            placed: vec![true; limbs],
            marked: vec![false; limbs],
            template: None,
            words: String::new(),
            model: Arc::clone(model),
        }
    }

    /// Those that are drawn as sticks, each with its opacity, the faintest first.
    pub fn sticks(&self) -> impl Iterator<Item = (&Ghost, f32)> {
        let most = self.bodies.iter().map(|ghost| ghost.weight).fold(f64::MIN_POSITIVE, f64::max);
        // Where there are many, they are seen by lying over one another.
        let heaviest = OPACITY * (OF / self.bodies.len() as f64).sqrt().min(1.0);
        let opacity = move |weight: f64| {
            let share = (weight / most).clamp(0.0, 1.0).sqrt();
            (FAINTEST + (heaviest - FAINTEST) * share) as f32
        };
        let others = self.bodies.get(1..).unwrap_or_default().iter().rev();
        others.map(move |ghost| (ghost, opacity(ghost.weight)))
    }

    /// Limbs that are drawn.
    pub fn limbs(&self) -> impl Iterator<Item = usize> {
        self.placed.iter().enumerate().filter(|(_, placed)| **placed).map(|(limb, _)| limb)
    }
}

/// What one camera sees of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GhostMarks {
    /// Limbs of the faint ones as sticks, with their opacity.
    pub sticks: Vec<(Vec<[DVec2; 2]>, f32)>,
    /// The outline of the one that is drawn whole.
    pub outline: Vec<Vec<DVec2>>,
    /// The outline of its marked limbs.
    pub marked: Vec<Vec<DVec2>>,
    /// The outline of the template.
    pub template: Vec<Vec<DVec2>>,
    /// What they are.
    pub words: String,
}

impl GhostMarks {
    /// Projects them.
    pub fn new(ghosts: &Ghosts, camera: &Camera, renderer: RendererKind) -> Self {
        let stick = |kinematics: &Kinematics, limb: usize| {
            let place = |end: DVec3| place_in_front(camera, end);
            Some([place(kinematics.starts()[limb])?, place(kinematics.ends()[limb])?])
        };
        let sticks = |(ghost, opacity): (&Ghost, f32)| {
            (ghosts.limbs().filter_map(|limb| stick(&ghost.kinematics, limb)).collect(), opacity)
        };
        let whole = ghosts.bodies.first().map_or_else(Vec::new, |ghost| {
            let limbs = project_limbs(&ghosts.model, &ghost.kinematics, camera, renderer);
            ghosts.limbs().filter_map(|limb| Some((limb, limbs[limb]?))).collect()
        });
        let outline = |is_drawn: &dyn Fn(usize) -> bool| {
            let limbs: Vec<&ProjectedLimb> =
                whole.iter().filter(|(limb, _)| is_drawn(*limb)).map(|(_, limb)| limb).collect();
            joined_outline(&limbs)
        };
        let template = ghosts.template.and_then(|template| {
            ProjectedLimb::new(camera, template.ends, template.radius, RendererKind::Capsule)
        });
        Self {
            sticks: ghosts.sticks().map(sticks).collect(),
            outline: outline(&|_| true),
            marked: outline(&|limb| ghosts.marked[limb]),
            template: template.map_or_else(Vec::new, |limb| joined_outline(&[&limb])),
            words: ghosts.words.clone(),
        }
    }
}

/// Joints that are farther apart than this are elsewhere, metres.
const ELSEWHERE_M: f64 = 0.05;

/// The limbs of a body that are elsewhere than another body's.
pub fn limbs_elsewhere(body: &Kinematics, other: &Kinematics) -> Vec<usize> {
    let ends = body.starts().iter().zip(other.starts()).zip(body.ends().iter().zip(other.ends()));
    let is_elsewhere = |((start, other_start), (end, other_end)): ((&DVec3, &DVec3), (&DVec3, &DVec3))| {
        start.distance(*other_start).max(end.distance(*other_end)) > ELSEWHERE_M
    };
    ends.map(is_elsewhere)
        .enumerate()
        .filter(|(_, is_elsewhere)| *is_elsewhere)
        .map(|(limb, _)| limb)
        .collect()
}

/// The one of some limbs whose end is farthest from the other body's, and how far, metres.
pub fn farthest_limb(limbs: &[usize], body: &Kinematics, other: &Kinematics) -> Option<(usize, f64)> {
    let apart = |&limb: &usize| (limb, body.ends()[limb].distance(other.ends()[limb]));
    limbs.iter().map(apart).max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Opacity of a rival pose by its weight: of one that is hardly likely, and of one that is sure.
pub fn rival_opacity(weight: f64) -> f32 {
    const OPACITY: [f32; 2] = [0.45, 1.0];
    OPACITY[0] + (OPACITY[1] - OPACITY[0]) * weight as f32
}

/// What one camera sees of a pose that rivals the one on the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct RivalMarks {
    /// Its limbs that are elsewhere, as sticks.
    pub sticks: Vec<[DVec2; 2]>,
    /// The end that is farthest from the pose on the screen.
    pub farthest: DVec2,
    /// How likely it is, 0 to 1.
    pub weight: f64,
}

impl RivalMarks {
    /// Projects it; `None` where nothing of it is seen elsewhere.
    pub fn new(rival: &Kinematics, weight: f64, shown: &Kinematics, camera: &Camera) -> Option<Self> {
        let place = |end: DVec3| place_in_front(camera, end);
        let elsewhere = limbs_elsewhere(rival, shown);
        let stick = |limb: &usize| Some([place(rival.starts()[*limb])?, place(rival.ends()[*limb])?]);
        let (farthest, _) = farthest_limb(&elsewhere, rival, shown)?;
        let farthest = place(rival.ends()[farthest])?;
        Some(Self { sticks: elsewhere.iter().filter_map(stick).collect(), farthest, weight })
    }
}

/// Seams on a limb that turns about its own length: lines along it, which show the turn.
const SEAMS: u32 = 3;
/// Paths shorter than this are not drawn, pixels.
const SHORTEST_PATH_PX: f64 = 1.5;

/// A body on its way.
#[derive(Debug, Clone)]
pub struct Swaying {
    /// Where it is.
    pub now: Kinematics,
    /// Where it is along the whole way, from one end to the other.
    pub way: Vec<Kinematics>,
    /// Rotations that turn limbs about their own length, which no outline shows.
    pub twisted: Vec<usize>,
}

/// What one camera sees of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SwayMarks {
    /// The outline of the body where it is.
    pub outline: Vec<Vec<DVec2>>,
    /// Ways of the joints that have handles.
    pub paths: Vec<Vec<DVec2>>,
    /// Seams of twisting limbs: from end to end, and whether they are on the camera's side.
    pub seams: Vec<([DVec2; 2], bool)>,
}

impl SwayMarks {
    /// Projects a body that sways.
    pub fn new(model: &Model, swaying: &Swaying, camera: &Camera, renderer: RendererKind) -> Self {
        let limbs: Vec<ProjectedLimb> =
            project_limbs(model, &swaying.now, camera, renderer).into_iter().flatten().collect();
        let outline = joined_outline(&limbs.iter().collect::<Vec<_>>());
        let handles = draggable_joints(model).into_iter();
        let path = |joint: JointId| -> Option<Vec<DVec2>> {
            let JointId::End(limb) = joint else { return None };
            let points: Option<Vec<DVec2>> =
                swaying.way.iter().map(|kinematics| camera.project(*kinematics.ends().get(limb)?)).collect();
            let points = points.filter(|points| points.iter().all(|px| px.is_finite()))?;
            let ends = points.first()?.distance(*points.last()?);
            (ends >= SHORTEST_PATH_PX).then_some(points)
        };
        Self { outline, paths: handles.filter_map(path).collect(), seams: seams(model, swaying, camera) }
    }
}

fn seams(model: &Model, swaying: &Swaying, camera: &Camera) -> Vec<([DVec2; 2], bool)> {
    let mut seams = Vec::new();
    for (index, limb) in model.limbs().iter().enumerate() {
        if !swaying.twisted.contains(&limb.rotation) {
            continue;
        }
        let (start, end) = (swaying.now.starts()[index], swaying.now.ends()[index]);
        let turn = swaying.now.world_rotations()[limb.rotation];
        let (across, other) = limb.direction.any_orthonormal_pair();
        for seam in 0..SEAMS {
            let (sine, cosine) = (f64::from(seam) / f64::from(SEAMS) * std::f64::consts::TAU).sin_cos();
            let outwards: DVec3 = turn * (across * cosine + other * sine);
            let ends = [start, end].map(|joint| camera.project(joint + outwards * limb.radius));
            let is_before = outwards.dot(camera.centre() - 0.5 * (start + end)) > 0.0;
            if let [Some(a), Some(b)] = ends
                && a.is_finite()
                && b.is_finite()
            {
                seams.push(([a, b], is_before));
            }
        }
    }
    seams
}

/// The ellipse of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointEllipse {
    /// Which joint.
    pub joint: JointId,
    /// One standard deviation.
    pub ellipse: ImageEllipse,
    /// One standard deviation across the camera's sight ray and along it, metres.
    pub deviations_m: [f64; 2],
    /// The same in words.
    pub text: String,
}

/// Ellipses of a body's joints before a camera.
pub fn joint_ellipses(model: &Model, joints: &[JointUncertainty], camera: &Camera) -> Vec<JointEllipse> {
    let one = |joint: &JointUncertainty| {
        let id = joint.limb.into();
        let deviations_m = joint.deviations_from(camera);
        let [across, depth] = deviations_m.map(format::deviation);
        let text = format!("{}: {across} across, {depth} in depth (1σ)", joint_name(model, id));
        Some(JointEllipse { joint: id, ellipse: joint.ellipse(camera)?, deviations_m, text })
    };
    joints.iter().filter_map(one).collect()
}

/// Standard deviations that an ellipse shows.
pub const DEVIATIONS: f64 = 2.0;
/// The factors that can be chosen.
pub const FACTORS: [u32; 8] = [1, 2, 5, 10, 20, 50, 100, 200];
/// The middle one of the ellipses has half axes of at most this, in metres of the scene: more than a joint's handle.
const MIDDLE_M: f64 = 0.12;
/// The largest one, of at most this: less than a limb.
const LARGEST_M: f64 = 0.5;

/// The largest round factor by which ellipses stay within reason, from the joints' deviations in their worst directions
/// (metres). Joints without bound do not count; 1 if there are no others.
pub fn automatic_factor(deviations_m: impl Iterator<Item = f64>) -> u32 {
    let mut deviations: Vec<f64> = deviations_m.filter(|deviation| deviation.is_finite()).collect();
    deviations.sort_by(f64::total_cmp);
    let Some(largest) = deviations.last() else { return 1 };
    let middle = deviations[deviations.len() / 2];
    let fits = |factor: &u32| {
        let scale = DEVIATIONS * f64::from(*factor);
        scale * middle <= MIDDLE_M && scale * largest <= LARGEST_M
    };
    FACTORS.into_iter().rfind(fits).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use backlit_tracking::observability::articulated_joints;
    use glam::DQuat;

    use super::*;
    use crate::drawing::input::tests;

    fn camera() -> Camera {
        let (from, to) = (DVec3::new(0.0, 0.3, 2.5), DVec3::new(0.0, 0.3, 0.0));
        tests::camera([120, 120], [100.0, 60.0, 60.0], from, to, DVec3::Y)
    }

    #[test]
    fn heavy_bodies_are_seen_and_light_ones_are_faint() {
        let model = Arc::new(builtin::upper_body());
        let poses: Vec<Pose> = (0..4)
            .map(|index| Pose { root: DVec3::X * 0.1 * f64::from(index), ..Pose::rest(&model) })
            .collect();
        let ghosts = Ghosts::new(&model, poses.iter().zip([0.5, 0.3, 0.15, 0.0]));
        let marks = GhostMarks::new(&ghosts, &camera(), RendererKind::Capsule);
        let opacities: Vec<f32> = marks.sticks.iter().map(|stick| stick.1).collect();
        assert_eq!(opacities.len(), 3, "the heaviest is drawn whole");
        assert!(opacities.is_sorted() && opacities[0] > 0.0 && opacities[2] < 1.0, "{opacities:?}");
        assert!(marks.sticks.iter().all(|stick| stick.0.len() == model.limbs().len()));
        assert!(marks.outline.iter().flatten().count() > 50);
        assert!(marks.marked.is_empty() && marks.template.is_empty());
    }

    #[test]
    fn limbs_without_a_place_are_absent_and_behind_the_camera_is_nothing() {
        let model = Arc::new(builtin::upper_body());
        let rest = Pose::rest(&model);
        let head = model.limb_index("head").unwrap();
        let mut ghosts = Ghosts::new(&model, [(&rest, 1.0), (&rest, 0.5)]);
        ghosts.placed = (0..model.limbs().len()).map(|limb| limb == head).collect();
        ghosts.marked[head] = true;
        ghosts.template = Some(Template { ends: [DVec3::new(0.0, 0.3, 0.0); 2], radius: 0.1 });
        let marks = GhostMarks::new(&ghosts, &camera(), RendererKind::Capsule);
        assert_eq!(marks.sticks[0].0.len(), 1);
        assert_eq!(marks.outline, marks.marked);
        let ball = marks.template.concat();
        assert!(ball.iter().all(|px| (px.distance(DVec2::splat(60.0)) - 4.0).abs() < 0.1), "{ball:?}");

        let behind = Pose { root: DVec3::Z * 9.0, ..rest };
        let marks =
            GhostMarks::new(&Ghosts::new(&model, [(&behind, 1.0); 2]), &camera(), RendererKind::Capsule);
        assert!(marks.outline.is_empty() && marks.sticks.iter().all(|stick| stick.0.is_empty()));
    }

    #[test]
    fn joints_with_handles_are_those_that_are_told_of() {
        for model in [builtin::upper_body(), builtin::full_body(), builtin::single_limb()] {
            let told = articulated_joints(&model).into_iter().map(JointId::End);
            let told: Vec<JointId> = std::iter::once(JointId::Root).chain(told).collect();
            assert_eq!(told, draggable_joints(&model));
        }
    }

    #[test]
    fn joints_that_move_have_paths_and_twists_have_seams() {
        let model = builtin::upper_body();
        let rest = Pose::rest(&model);
        let arm = model.limbs()[model.limb_index("right forearm").unwrap()].rotation;
        let turned = |axis: DVec3, angle: f64| {
            let mut pose = rest.clone();
            pose.rotations[arm] = DQuat::from_axis_angle(axis, angle);
            Kinematics::new(&model, &pose)
        };
        let way = vec![turned(DVec3::Z, -0.3), turned(DVec3::Z, 0.0), turned(DVec3::Z, 0.3)];
        let swaying = Swaying { now: way[2].clone(), way, twisted: Vec::new() };
        let marks = SwayMarks::new(&model, &swaying, &camera(), RendererKind::Capsule);
        assert_eq!((marks.paths.len(), marks.seams.len()), (1, 0), "only the wrist moves");
        assert!(marks.outline.iter().flatten().count() > 50);

        let still = vec![turned(DVec3::Z, 0.0); 3];
        let swaying = Swaying { now: still[0].clone(), way: still, twisted: vec![arm] };
        let marks = SwayMarks::new(&model, &swaying, &camera(), RendererKind::Capsule);
        assert_eq!((marks.paths.len(), marks.seams.len()), (0, SEAMS as usize));
        let before = marks.seams.iter().filter(|(_, is_before)| *is_before).count();
        assert!((1..=2).contains(&before), "{before}");
    }

    #[test]
    fn factors_are_round_and_leave_the_largest_ellipse_on_the_body() {
        let factor = |millimetres: &[f64]| automatic_factor(millimetres.iter().map(|mm| 1e-3 * mm));
        assert_eq!(factor(&[1.0, 2.0, 3.0]), 20);
        assert_eq!(factor(&[1.0, 2.0, 60.0]), 2, "the largest has its limit");
        assert_eq!(factor(&[1.0, 2.0, f64::INFINITY]), 20, "what has no bound does not count");
        assert_eq!(factor(&[0.0001; 3]), 200);
        assert_eq!(factor(&[90.0, 400.0]), 1);
        assert_eq!(factor(&[f64::INFINITY]), 1);
    }
}
