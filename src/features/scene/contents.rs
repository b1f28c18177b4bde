//! Body, ghosts, cameras, floor, hull and sight ray as things to draw.

use std::sync::Arc;

use backlit_document::CameraUse;
use backlit_tracking::body::{Kinematics, Model, PlacedSphere, Pose};
use backlit_tracking::camera::Camera;
use backlit_tracking::render::RendererKind;
use backlit_tracking::visual_hull::VisualHull;
use backlit_ui::drawing::{Ghosts, body_spheres, limbs_elsewhere, rival_opacity};
use backlit_ui::style::theme::camera_colours;
use backlit_ui::style::theme::data_colours::{AGREEMENT, GHOST, JOINT, SCENE_BODY, SCENE_FLOOR, SELECTED};
use egui::Color32;
use glam::{DVec2, DVec3};

use super::raster::{Dot, Floor, Limb, SceneLine, SceneShapes};
use super::{ScenePreferences, ShownHull, Upright, Viewpoint};

/// Depth of a frustum, as a share of the middle camera's distance from the body, and its limits.
const FRUSTUM: f64 = 0.2;
const FRUSTUM_RANGE: [f64; 2] = [0.1, 1.0];
/// A cell of the floor, and cells from its middle to each side.
const CELL: f64 = 0.5;
const HALF_CELLS: u16 = 7;
/// Opacity of the frustum and the picture of a camera that is not used.
const UNUSED: f32 = 0.4;
/// Opacity of the hull's box and of a voxel in full light.
const BOX: f32 = 0.85;
const VOXEL: f32 = 0.42;
/// Width of the active camera's frustum and of others, in points.
const ACTIVE_WIDTH: f64 = 2.0;
const WIDTH: f64 = 1.0;
/// A sight ray reaches so much farther than the joint; it is solid this near to it, and dashed elsewhere.
const RAY_REACH: f64 = 1.6;
const RAY_SOLID: f64 = 0.3;
const RAY_DASH: [f64; 2] = [0.10, 0.06];
/// Width of the sight ray, in points.
const RAY_WIDTH: f64 = 1.75;

/// What there is to draw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContentsInput<'a> {
    pub(crate) preferences: &'a ScenePreferences,
    pub(crate) model: &'a Model,
    /// Where its limbs are.
    pub(crate) kinematics: &'a Kinematics,
    pub(crate) renderer: RendererKind,
    /// The level of its limbs' trees of spheres, counted from the coarsest.
    pub(crate) sphere_level: usize,
    /// What is drawn in the place of the body.
    pub(crate) ghosts: Option<&'a Ghosts>,
    /// Poses that rival the body's, with their weights.
    pub(crate) rivals: &'a [(&'a Pose, f64)],
    /// The rotation whose limbs are marked.
    pub(crate) rotation: Option<usize>,
    /// The cameras, and how they are used.
    pub(crate) cameras: &'a [Arc<Camera>],
    pub(crate) uses: &'a [CameraUse],
    pub(crate) active: usize,
    /// The hull of the frame.
    pub(crate) hull: Option<&'a VisualHull>,
    /// The camera in whose view a joint is dragged, and that joint.
    pub(crate) ray: Option<(usize, DVec3)>,
    /// Which way is up, and the floor's height.
    pub(crate) upright: Upright,
    pub(crate) floor: f64,
    /// A point above the middle of the floor.
    pub(crate) middle: DVec3,
    /// Pixels of the picture for a point of the screen.
    pub(crate) scale: f64,
}

/// A camera in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Frustum {
    pub(crate) camera: usize,
    /// Where it stands.
    pub(crate) apex: DVec3,
    /// Upper left, upper right, lower right and lower left of its picture.
    pub(crate) corners: [DVec3; 4],
    /// Opacity of its picture.
    pub(crate) opacity: f32,
}

/// What is drawn, but for the pictures on the frusta and the hull's cubes: they are dear to make.
#[derive(Debug, Clone, Default)]
pub(crate) struct Contents {
    /// Limbs, floor and lines.
    pub(crate) scene: SceneShapes<'static>,
    /// The cameras.
    pub(crate) frusta: Vec<Frustum>,
}

/// Builds the scene.
pub(crate) fn contents(input: &ContentsInput<'_>) -> Contents {
    let limbs = input.ghosts.map_or_else(|| limbs(input), ghost_limbs);
    let mut scene = SceneShapes { limbs, ..SceneShapes::default() };
    scene.lines.extend(input.ghosts.into_iter().flat_map(|ghosts| ghost_lines(ghosts, input.scale)));
    scene.lines.extend(input.rivals.iter().flat_map(|rival| rival_lines(input, *rival)));
    if input.preferences.floor {
        scene.floor = Some(floor(input));
    }
    let frusta = if input.preferences.cameras { frusta(input) } else { Vec::new() };
    for frustum in &frusta {
        scene.lines.extend(frustum_lines(input, frustum));
    }
    if let Some(hull) = input.hull.filter(|_| input.preferences.hull != ShownHull::Hidden) {
        scene.lines.extend(box_lines(hull, input.scale));
    }
    if let Some((camera, joint)) = input.ray
        && let Some(camera) = input.cameras.get(camera)
    {
        scene.lines.extend(ray_lines(camera.centre(), joint, input.scale));
    }
    Contents { scene, frusta }
}

fn limbs(input: &ContentsInput<'_>) -> Vec<Limb> {
    let (starts, ends) = (input.kinematics.starts(), input.kinematics.ends());
    let colour = |limb: usize| {
        let is_held = input.rotation == Some(input.model.limbs()[limb].rotation);
        if is_held { SELECTED } else { SCENE_BODY }
    };
    let spheres = body_spheres(input.model, input.kinematics, input.renderer, input.sphere_level);
    let sphere = |sphere: PlacedSphere| Limb {
        ends: [sphere.centre; 2],
        radius: sphere.radius,
        solid: RendererKind::Capsule,
        colour: colour(sphere.limb),
    };
    if let RendererKind::SphereTree { .. } = input.renderer {
        return spheres.into_iter().map(sphere).collect();
    }
    let limbs = input.model.limbs().iter().enumerate();
    limbs
        .map(|(index, limb)| Limb {
            ends: [starts[index], ends[index]],
            radius: limb.radius,
            solid: input.renderer,
            colour: colour(index),
        })
        .collect()
}

fn floor(input: &ContentsInput<'_>) -> Floor {
    let Upright { up, ahead } = input.upright;
    let left = input.upright.left();
    // On whole cells, so that the grid stays while the body walks.
    let snap = |along: DVec3| (input.middle.dot(along) / CELL).round() * CELL * along;
    Floor {
        centre: snap(ahead) + snap(left) + up * input.floor,
        cell: [ahead * CELL, left * CELL],
        half_cells: HALF_CELLS,
        colour: SCENE_FLOOR,
    }
}

fn frusta(input: &ContentsInput<'_>) -> Vec<Frustum> {
    let mut distances: Vec<f64> =
        input.cameras.iter().map(|camera| camera.centre().distance(input.middle)).collect();
    distances.sort_by(f64::total_cmp);
    let typical = distances.get(distances.len() / 2).copied().unwrap_or(1.0);
    let depth = (FRUSTUM * typical).clamp(FRUSTUM_RANGE[0], FRUSTUM_RANGE[1]);
    let own = match input.preferences.viewpoint {
        Some(Viewpoint::Camera(index)) => Some(index),
        _ => None,
    };
    let frustum = |(index, camera): (usize, &Arc<Camera>)| {
        let (right, bottom) = (camera.width() as f64 - 0.5, camera.height() as f64 - 0.5);
        let mut corners = [DVec3::ZERO; 4];
        for (corner, px) in
            corners.iter_mut().zip([(-0.5, -0.5), (right, -0.5), (right, bottom), (-0.5, bottom)])
        {
            let px = DVec2::new(px.0, px.1);
            let (ray, in_world) = (camera.ray_in_camera(px)?, camera.ray_in_world(px)?);
            *corner = camera.centre() + in_world * (depth / ray.z);
        }
        let is_used = input.uses.get(index).is_none_or(|used| used.used);
        let opacity = if is_used { 1.0 } else { UNUSED };
        Some(Frustum { camera: index, apex: camera.centre(), corners, opacity })
    };
    input.cameras.iter().enumerate().filter(|(index, _)| Some(*index) != own).filter_map(frustum).collect()
}

fn frustum_lines(input: &ContentsInput<'_>, frustum: &Frustum) -> Vec<SceneLine> {
    let colour = camera_colours(frustum.camera).fill.gamma_multiply(frustum.opacity);
    let width = if frustum.camera == input.active { ACTIVE_WIDTH } else { WIDTH };
    let corners = frustum.corners;
    (0..4)
        .flat_map(|index| [[frustum.apex, corners[index]], [corners[index], corners[(index + 1) % 4]]])
        .map(|ends| SceneLine { ends, width_px: width * input.scale, colour })
        .collect()
}

fn box_lines(hull: &VisualHull, scale: f64) -> Vec<SceneLine> {
    let [low, high] = hull.bounds;
    let corner = |bits: usize| {
        let pick = |axis: usize| if bits >> axis & 1 == 1 { high[axis] } else { low[axis] };
        DVec3::new(pick(0), pick(1), pick(2))
    };
    let edges = (0..8_usize).flat_map(|from| {
        (0..3).filter(move |axis| from >> axis & 1 == 0).map(move |axis| [from, from | 1 << axis])
    });
    let colour = AGREEMENT.gamma_multiply(BOX);
    edges.map(|ends| SceneLine { ends: ends.map(corner), width_px: scale, colour }).collect()
}

/// The cubes that face the eye, lit from there.
pub(crate) fn shell(hull: &VisualHull, eye: DVec3) -> Vec<Dot> {
    let lit = |voxel: &backlit_tracking::visual_hull::ShellVoxel| {
        let light = voxel.normal.dot((eye - voxel.centre).normalize_or_zero()).max(0.0);
        let colour: Color32 = AGREEMENT.gamma_multiply(VOXEL * (0.35 + 0.65 * light as f32));
        (light > 0.0).then_some(Dot { at: voxel.centre, side: hull.voxel, colour })
    };
    hull.shell.iter().filter_map(lit).collect()
}

/// From the camera through the joint: dashed, and solid near the joint.
fn ray_lines(eye: DVec3, joint: DVec3, scale: f64) -> Vec<SceneLine> {
    let depth = eye.distance(joint);
    let along = (joint - eye).normalize_or_zero();
    let line = |from: f64, to: f64| SceneLine {
        ends: [eye + along * from, eye + along * to],
        width_px: RAY_WIDTH * scale,
        colour: SELECTED,
    };
    let mut lines = vec![line((depth - RAY_SOLID).max(0.0), depth + RAY_SOLID)];
    let [dash, gap] = RAY_DASH;
    let count = (RAY_REACH * depth / (dash + gap)).clamp(0.0, 400.0) as usize;
    lines.extend((0..count).map(|index| {
        let from = index as f64 * (dash + gap);
        line(from, from + dash)
    }));
    lines
}

/// Width of a faint limb, in points.
const GHOST_WIDTH: f64 = 1.5;

/// The limbs of the one that is drawn whole, as far as they have a place, and the template if it is a ball.
fn ghost_limbs(ghosts: &Ghosts) -> Vec<Limb> {
    let mut limbs = Vec::new();
    if let Some(ghost) = ghosts.bodies.first() {
        let (starts, ends) = (ghost.kinematics.starts(), ghost.kinematics.ends());
        limbs.extend(ghosts.limbs().map(|limb| Limb {
            ends: [starts[limb], ends[limb]],
            radius: ghosts.model.limbs()[limb].radius,
            solid: RendererKind::Capsule,
            colour: if ghosts.marked[limb] { SELECTED } else { SCENE_BODY },
        }));
    }
    let ball = ghosts.template.filter(|template| template.ends[0] == template.ends[1]);
    let ball = ball.map(|ball| Limb {
        ends: ball.ends,
        radius: ball.radius,
        solid: RendererKind::Capsule,
        colour: JOINT,
    });
    limbs.extend(ball);
    limbs
}

/// The limbs of a rival pose that are elsewhere.
fn rival_lines(input: &ContentsInput<'_>, (pose, weight): (&Pose, f64)) -> Vec<SceneLine> {
    let rival = Kinematics::new(input.model, pose);
    let line = |limb: usize| SceneLine {
        ends: [rival.starts()[limb], rival.ends()[limb]],
        width_px: GHOST_WIDTH * input.scale,
        colour: GHOST.gamma_multiply(rival_opacity(weight)),
    };
    limbs_elsewhere(&rival, input.kinematics).into_iter().map(line).collect()
}

/// The limbs of the faint ones.
fn ghost_lines(ghosts: &Ghosts, scale: f64) -> impl Iterator<Item = SceneLine> {
    ghosts.sticks().flat_map(move |(ghost, opacity)| {
        let (starts, ends) = (ghost.kinematics.starts(), ghost.kinematics.ends());
        let line = move |limb: usize| SceneLine {
            ends: [starts[limb], ends[limb]],
            width_px: GHOST_WIDTH * scale,
            colour: GHOST.gamma_multiply(opacity),
        };
        ghosts.limbs().map(line)
    })
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;
    use crate::app::testing::side_camera;

    fn with<T>(
        change: impl FnOnce(&mut ContentsInput<'_>) -> T,
        preferences: ScenePreferences,
    ) -> (Contents, T) {
        let model = builtin::full_body();
        let kinematics = Kinematics::new(&model, &Pose::rest(&model));
        let cameras = [side_camera()];
        let uses = [CameraUse { name: "c".to_owned(), used: true, weight: 1.0 }];
        let upright = Upright::of(&cameras);
        let mut input = ContentsInput {
            preferences: &preferences,
            model: &model,
            kinematics: &kinematics,
            ghosts: None,
            rivals: &[],
            renderer: RendererKind::Capsule,
            sphere_level: usize::MAX,
            rotation: None,
            cameras: &cameras,
            uses: &uses,
            active: 0,
            hull: None,
            ray: None,
            upright,
            floor: 0.0,
            middle: DVec3::ZERO,
            scale: 1.0,
        };
        let result = change(&mut input);
        (contents(&input), result)
    }

    #[test]
    fn a_frustum_lies_on_the_rays_of_its_picture() {
        let (contents, ()) = with(|_| (), ScenePreferences::default());
        let [frustum] = &contents.frusta[..] else { panic!("{:?}", contents.frusta) };
        let camera = side_camera();
        let expected = [(-0.5, -0.5), (271.5, -0.5), (271.5, 479.5), (-0.5, 479.5)];
        for (corner, (x, y)) in frustum.corners.iter().zip(expected) {
            assert!(camera.project(*corner).unwrap().distance(DVec2::new(x, y)) < 1e-6);
            assert!((camera.depth(*corner) - camera.depth(frustum.corners[0])).abs() < 1e-9);
        }
        assert_eq!(contents.scene.lines.len(), 8);
        let own = ScenePreferences { viewpoint: Some(Viewpoint::Camera(0)), ..ScenePreferences::default() };
        assert!(with(|_| (), own).0.frusta.is_empty(), "a camera does not see its own picture");
    }

    #[test]
    fn limbs_have_the_renderers_shape_and_the_held_one_its_colour() {
        let preferences = ScenePreferences { cameras: false, floor: false, ..ScenePreferences::default() };
        let (contents, rotation) = with(
            |input| {
                let limb = input.model.limb_index("right forearm").unwrap();
                input.rotation = Some(input.model.limbs()[limb].rotation);
                input.rotation
            },
            preferences,
        );
        let model = builtin::full_body();
        assert_eq!(contents.scene.limbs.len(), model.limbs().len());
        let marked = contents.scene.limbs.iter().filter(|capsule| capsule.colour == SELECTED).count();
        assert_eq!(marked, model.limbs().iter().filter(|limb| Some(limb.rotation) == rotation).count());
        assert!(contents.scene.floor.is_none() && contents.scene.lines.is_empty());
        assert!(contents.scene.limbs.iter().all(|limb| limb.solid == RendererKind::Capsule));
        let (flat, ()) = with(|input| input.renderer = RendererKind::Cylinder, preferences);
        assert!(flat.scene.limbs.iter().all(|limb| limb.solid == RendererKind::Cylinder));
        let (spheres, ()) =
            with(|input| input.renderer = RendererKind::SphereTree { spheres: Some(3) }, preferences);
        assert_eq!(spheres.scene.limbs.len(), 3 * model.limbs().len());
        assert!(spheres.scene.limbs.iter().all(|sphere| sphere.ends[0] == sphere.ends[1]));
    }

    #[test]
    fn a_box_has_twelve_edges_and_a_ray_goes_through_its_joint() {
        let hull =
            VisualHull { bounds: [DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)], voxel: 0.1, shell: Vec::new() };
        let lines = box_lines(&hull, 1.0);
        let total: f64 = lines.iter().map(|line| line.ends[0].distance(line.ends[1])).sum();
        assert_eq!((lines.len(), total), (12, 24.0));
        let (eye, joint) = (DVec3::new(3.0, 0.0, 1.0), DVec3::new(0.0, 0.5, 1.2));
        let solid = ray_lines(eye, joint, 1.0)[0];
        assert!((0.5 * (solid.ends[0] + solid.ends[1])).distance(joint) < 1e-9);
    }
}
