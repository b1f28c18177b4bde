//! Bodies that are looked at in the place of the posed one: many, each as faint as it weighs little, or one that is put together
//! limb by limb. In world coordinates, and as one camera sees them, in pixel coordinates.

use std::sync::Arc;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::RendererKind;
use glam::{DVec2, DVec3};

use super::{ProjectedLimb, joined_outline, project_limbs};

/// Opacity of the lightest of many bodies, and of the heaviest of so many.
const FAINTEST: f64 = 0.05;
const OPACITY: f64 = 0.9;
const OF: f64 = 8.0;
/// What is nearer to the camera than this is not drawn, metres.
const NEAREST_M: f64 = 0.05;

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
        let place = |point: DVec3| {
            let px = camera.project(point).filter(|px| px.is_finite());
            px.filter(|_| camera.depth(point) > NEAREST_M)
        };
        let stick = |kinematics: &Kinematics, limb: usize| {
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
            let [start_px, end_px] = template.ends.map(place);
            let [start_depth_m, end_depth_m] = template.ends.map(|end| camera.depth(end));
            let radius = |depth: f64| template.radius * camera.intrinsics().mean_focal_px() / depth;
            Some(ProjectedLimb {
                start_px: start_px?,
                end_px: end_px?,
                start_radius_px: radius(start_depth_m),
                end_radius_px: radius(end_depth_m),
                start_depth_m,
                end_depth_m,
                has_flat_ends: false,
            })
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

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;
    use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};

    use super::*;

    fn camera() -> Camera {
        let intrinsics = Intrinsics { fx: 100.0, fy: 100.0, cx: 60.0, cy: 60.0 };
        let place =
            CameraFromWorld::looking_at(DVec3::new(0.0, 0.3, 2.5), DVec3::new(0.0, 0.3, 0.0), DVec3::Y);
        Camera::new("front", [120, 120], intrinsics, Distortion::None, place).unwrap()
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
}
