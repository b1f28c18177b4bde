//! The cameras' tiles: what each of them shows.

use std::hash::{DefaultHasher, Hash, Hasher};

use backlit_tracking::body::Kinematics;
use backlit_tracking::camera::Camera;
use egui::{Rect, Role, Ui, WidgetInfo, pos2};

use super::camera_tile::{CameraTileInput, PictureAlone, TileEvent, Wipe, camera_tile};
use crate::pane::Pane;
use crate::picture::{
    JointId, PictureInput, SightRay, ViewMode, limb_colours, project_joints, project_limbs, sight_ray,
};
use crate::showing::{Intents, Request, Showing};
use crate::theme::{self, size};
use crate::widgets::Framing;

/// What a camera's tile shows and how.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TileLook {
    /// What the picture shows.
    pub(crate) mode: ViewMode,
    /// A second mode beside it.
    pub(crate) wipe: Option<Wipe>,
    /// Which part of the picture.
    pub(crate) framing: Framing,
}

impl Default for TileLook {
    fn default() -> Self {
        Self { mode: ViewMode::Tinted, wipe: None, framing: Framing::default() }
    }
}

/// How the tiles are arranged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TilesLook<'a> {
    /// By camera.
    pub(crate) tiles: &'a [TileLook],
    /// The pane that fills the centre.
    pub(crate) alone: Option<Pane>,
    /// The two cameras that are shown where there is room for two.
    pub(crate) pair: [usize; 2],
    /// The camera in whose view a joint is dragged, and the joint.
    pub(crate) dragged: Option<(usize, JointId)>,
    /// One camera's picture and nothing else, for an export.
    pub(crate) picture_alone: Option<PictureAlone>,
}

/// What all tiles have in common.
pub(super) struct Common {
    kinematics: Kinematics,
    root: glam::DVec3,
    colours: Vec<egui::Color32>,
    /// Camera, pixel and depth of the joint that is dragged.
    ray: Option<(usize, glam::DVec2, f64)>,
}

impl Common {
    pub(super) fn new(showing: &Showing<'_>, look: &TilesLook<'_>) -> Self {
        let document = showing.document();
        let pose = showing.session.shown_pose(document, showing.selection);
        let kinematics = Kinematics::new(&document.model, pose);
        let ray = look.dragged.and_then(|(index, joint)| {
            let camera = showing.session.take.as_ref()?.cameras.get(index)?;
            let point = match joint {
                JointId::Root => pose.root,
                JointId::End(limb) => *kinematics.ends().get(limb)?,
            };
            Some((index, camera.project(point)?, camera.depth(point)))
        });
        Self { kinematics, root: pose.root, colours: limb_colours(&document.model), ray }
    }

    fn ray_in(&self, showing: &Showing<'_>, index: usize, camera: &Camera) -> Option<SightRay> {
        let (from, px, depth_m) = self.ray.filter(|(from, ..)| *from != index)?;
        let from_camera = showing.session.take.as_ref()?.cameras.get(from)?;
        sight_ray(from_camera, from, px, depth_m, camera)
    }
}

/// A camera's tile, and which cameras stand behind it; whether it is dragged away by its header.
pub(super) fn camera(
    ui: &mut Ui,
    showing: &Showing<'_>,
    look: &TilesLook<'_>,
    common: &Common,
    (index, siblings): (usize, &[usize]),
    intents: &mut Intents,
) -> bool {
    let (session, document) = (showing.session, showing.document());
    let Some(camera) = session.take.as_ref().and_then(|take| take.cameras.get(index)) else {
        return false;
    };
    let size_px = [camera.width(), camera.height()];
    let frame = session.shown_frame(showing.selection.frame).and_then(|frame| frame.cameras.get(index));
    let predicted = session.predicted.as_ref();
    let is_of_frame =
        predicted.is_some_and(|predicted| session.is_of_shown_frame(predicted, showing.selection.frame));
    let camera_prediction = predicted.and_then(|predicted| predicted.cameras.get(index));
    let prediction = camera_prediction.map(|camera| &camera.prediction);
    let picture = PictureInput {
        size: size_px,
        frame: frame.and_then(|frame| frame.image.as_deref()),
        mask: frame.and_then(|frame| frame.mask.as_deref()),
        data: camera_prediction.filter(|_| is_of_frame).and_then(|camera| camera.data.as_deref()),
        prediction,
        gradient: camera_prediction.and_then(|camera| camera.gradient.as_ref()),
        jacobian: camera_prediction.and_then(|camera| camera.jacobian.as_ref()),
        limb_colours: &common.colours,
    };
    let limbs = project_limbs(&document.model, &common.kinematics, camera, document.fit.renderer);
    let is_pinned = |joint: JointId| matches!(joint, JointId::End(limb) if document.pins.contains(&limb));
    let joints = project_joints(&document.model, &common.kinematics, common.root, camera, is_pinned);
    let ray = common.ray_in(showing, index, camera);
    let uses = document.cameras.get(index);
    let tile = look.tiles.get(index).copied().unwrap_or_default();
    let subject_px = session
        .subject
        .get(index)
        .copied()
        .flatten()
        .map(|[left, top, right, bottom]| Rect::from_min_max(pos2(left, top), pos2(right, bottom)));
    let name = format!("Camera {}", index + 1);
    let input = CameraTileInput {
        index,
        name: &name,
        is_active: showing.selection.camera == index,
        is_expanded: look.alone == Some(Pane::Camera(index)),
        siblings,
        is_linked: showing.look.linked_zoom,
        is_calibrated: true,
        mode: tile.mode,
        wipe: tile.wipe,
        framing: tile.framing,
        subject_px,
        picture,
        generation: generation(showing),
        body: &document.model,
        outlines: camera_prediction.map_or(&[], |camera| &camera.outlines),
        limbs: &limbs,
        joints: &joints,
        selected: Some(showing.selection.joint),
        sight_ray: ray.as_ref(),
        overlap: camera_prediction.and_then(|camera| camera.overlap),
        is_overlap_stale: session.is_stale,
        is_used: uses.is_some_and(|used| used.used),
        weight: uses.map_or(1.0, |used| used.weight),
        shows_hover_card: true,
    };
    if let Some(alone) = look.picture_alone {
        alone.ui(ui, &input);
        return false;
    }
    let mut is_dragged = false;
    for event in camera_tile(ui, &input) {
        match event {
            TileEvent::DragTile => is_dragged = true,
            _ => intents.request(Request::Tile(index, event)),
        }
    }
    if let Some(problem) = frame.and_then(|frame| frame.problem.as_deref()) {
        problem_strip(ui, problem);
    }
    is_dragged
}

/// Changes with the pictures on the screen.
fn generation(showing: &Showing<'_>) -> u64 {
    let mut hasher = DefaultHasher::new();
    (showing.session.generation, showing.selection.frame).hash(&mut hasher);
    hasher.finish()
}

/// Why a camera has no picture or no silhouette, under its header.
fn problem_strip(ui: &Ui, problem: &str) {
    let palette = theme::palette(ui);
    let tile = ui.max_rect();
    let top = tile.top() + size::TILE_HEADER;
    let strip = Rect::from_min_max(pos2(tile.left(), top), pos2(tile.right(), top + size::TILE_HEADER));
    let font = egui::TextStyle::Small.resolve(ui.style());
    let mut job = egui::text::LayoutJob::simple_singleline(problem.to_owned(), font, palette.warn);
    job.wrap = egui::text::TextWrapping::truncate_at_width(strip.width() - 16.0);
    let galley = ui.painter().layout_job(job);
    ui.painter().rect_filled(strip, 0.0, palette.raised);
    let at = pos2(strip.left() + 8.0, strip.center().y - galley.size().y / 2.0);
    ui.painter().galley(at, galley, palette.warn);
    let response = ui.interact(strip, ui.scope_id().with("problem"), egui::Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, problem));
    response.on_hover_text(problem);
}
