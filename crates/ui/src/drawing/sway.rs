//! A body that sways, and ellipses of its joints, as one camera sees them. All in pixel coordinates.

use backlit_tracking::body::{Kinematics, Model};
use backlit_tracking::camera::Camera;
use backlit_tracking::observability::{ImageEllipse, JointUncertainty};
use backlit_tracking::render::RendererKind;
use glam::{DVec2, DVec3};

use super::{JointId, ProjectedLimb, draggable_joints, joined_outline, joint_name, project_limbs};
use crate::style::format;

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

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Pose, builtin};
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
    use backlit_tracking::observability::articulated_joints;
    use glam::DQuat;

    use super::*;

    fn camera() -> Camera {
        let intrinsics = Intrinsics { fx: 100.0, fy: 100.0, cx: 60.0, cy: 60.0 };
        let place =
            CameraFromWorld::looking_at(DVec3::new(0.0, 0.3, 2.5), DVec3::new(0.0, 0.3, 0.0), DVec3::Y);
        Camera::new("front", [120, 120], intrinsics, Distortion::None, place).unwrap()
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
}
