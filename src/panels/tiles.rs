//! The cameras' tiles: how many, where, and what each of them shows.

use std::hash::{DefaultHasher, Hash, Hasher};

use backlit_tracking::body::Kinematics;
use backlit_tracking::camera::Camera;
use egui::{Align, Layout as Direction, Rect, RichText, Role, Ui, UiBuilder, WidgetInfo, pos2, vec2};

use super::camera_tile::{CameraTileInput, Wipe, camera_tile};
use crate::picture::{
    JointId, PictureInput, SightRay, ViewMode, limb_colours, project_joints, project_limbs, sight_ray,
};
use crate::showing::{Intents, Request, Showing};
use crate::theme::{self, size, space};
use crate::widgets::{Framing, camera_badge};

/// The centre is one row from this ratio of width to height on, and one column below this width.
const ONE_ROW_FROM: f32 = 2.2;
const ONE_COLUMN_BELOW: f32 = 560.0;
/// Where the centre is narrower, two tiles are shown and the others are tabs beneath.
const TWO_TILES_BELOW: f32 = 900.0;
/// Height of the row of tabs.
const TABS: f32 = 30.0;

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
    /// The camera that fills the centre.
    pub(crate) alone: Option<usize>,
    /// The two cameras that are shown where there is room for two.
    pub(crate) pair: [usize; 2],
    /// The camera in whose view a joint is dragged, and the joint.
    pub(crate) dragged: Option<(usize, JointId)>,
}

/// The tiles, in all of the space that is left.
pub(crate) fn ui(ui: &mut Ui, showing: &Showing<'_>, look: &TilesLook<'_>, intents: &mut Intents) {
    let mut rect = ui.available_rect_before_wrap();
    ui.painter().rect_filled(rect, 0.0, theme::palette(ui).well);
    let count = showing.session.camera_count();
    let cameras: Vec<usize> = match look.alone {
        Some(camera) => vec![camera],
        None if count > 2 && rect.width() < TWO_TILES_BELOW => {
            let strip = Rect::from_min_max(pos2(rect.left(), rect.bottom() - TABS), rect.max);
            rect.set_bottom(strip.top());
            tabs(ui, showing, look.pair, strip, intents);
            look.pair.to_vec()
        }
        None => (0..count).collect(),
    };
    let common = Common::new(showing, look);
    for (place, camera) in places(rect, cameras.len()).into_iter().zip(cameras) {
        ui.scope_builder(UiBuilder::new().max_rect(place).id_salt(("tile", camera)), |ui| {
            tile(ui, showing, look, &common, camera, intents);
        });
    }
}

/// Where the tiles lie, row by row.
fn places(rect: Rect, count: usize) -> Vec<Rect> {
    let columns = if rect.width() < ONE_COLUMN_BELOW {
        1
    } else if rect.width() > ONE_ROW_FROM * rect.height() || count <= 2 {
        count.max(1)
    } else {
        (count as f32).sqrt().ceil() as usize
    };
    let rows = count.div_ceil(columns).max(1);
    let gap = space::TILE_GAP;
    let tile = vec2(
        (rect.width() - gap * (columns - 1) as f32) / columns as f32,
        (rect.height() - gap * (rows - 1) as f32) / rows as f32,
    );
    let place = |index: usize| {
        let (column, row) = ((index % columns) as f32, (index / columns) as f32);
        let corner = rect.min + vec2(column * (tile.x + gap), row * (tile.y + gap));
        Rect::from_min_size(corner, tile)
    };
    (0..count).map(place).collect()
}

fn tabs(ui: &mut Ui, showing: &Showing<'_>, pair: [usize; 2], strip: Rect, intents: &mut Intents) {
    let palette = theme::palette(ui);
    ui.painter().rect_filled(strip, 0.0, palette.raised);
    let inner = strip.shrink2(vec2(8.0, 0.0));
    let builder = UiBuilder::new().max_rect(inner).layout(Direction::left_to_right(Align::Center));
    ui.scope_builder(builder, |ui| {
        for camera in 0..showing.session.camera_count() {
            let response = camera_badge(ui, camera);
            if pair.contains(&camera) {
                let line = response.rect.translate(vec2(0.0, 4.0));
                ui.painter().hline(line.x_range(), line.bottom(), egui::Stroke::new(2.0, palette.text));
            }
            if response.on_hover_text(format!("Show camera {}", camera + 1)).clicked() {
                intents.request(Request::Camera(camera));
            }
        }
        ui.label(RichText::new("Two views fit; the others are here").small().color(palette.text3));
    });
}

/// What all tiles have in common.
struct Common {
    kinematics: Kinematics,
    root: glam::DVec3,
    colours: Vec<egui::Color32>,
    /// Camera, pixel and depth of the joint that is dragged.
    ray: Option<(usize, glam::DVec2, f64)>,
}

impl Common {
    fn new(showing: &Showing<'_>, look: &TilesLook<'_>) -> Self {
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

fn tile(
    ui: &mut Ui,
    showing: &Showing<'_>,
    look: &TilesLook<'_>,
    common: &Common,
    index: usize,
    intents: &mut Intents,
) {
    let (session, document) = (showing.session, showing.document());
    let Some(camera) = session.take.as_ref().and_then(|take| take.cameras.get(index)) else { return };
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
        is_expanded: look.alone == Some(index),
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
    for event in camera_tile(ui, &input) {
        intents.request(Request::Tile(index, event));
    }
    if let Some(problem) = frame.and_then(|frame| frame.problem.as_deref()) {
        problem_strip(ui, problem);
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fill_the_centre_without_overlap() {
        let wide = places(Rect::from_min_size(pos2(0.0, 40.0), vec2(1276.0, 800.0)), 4);
        assert_eq!((wide[0].width(), wide[0].height()), (637.0, 399.0));
        assert_eq!(wide[3].max, pos2(1276.0, 840.0));
        let row = places(Rect::from_min_size(pos2(0.0, 40.0), vec2(1260.0, 520.0)), 4);
        assert!(row.iter().all(|place| place.top() == 40.0));
        let column = places(Rect::from_min_size(pos2(0.0, 40.0), vec2(500.0, 520.0)), 3);
        assert!(column.iter().all(|place| place.width() == 500.0));
    }
}
