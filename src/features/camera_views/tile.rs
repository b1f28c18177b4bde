//! One camera's tile: header, picture with its marks, and a gutter where there is room.

use std::sync::Arc;

use backlit_tracking::belief::LimbTrust;
use backlit_tracking::body::Model;
use backlit_tracking::camera::Camera;
use backlit_tracking::cues::{JointKeypoint, LimbHold};
use backlit_tracking::segment::Segmentation;
use backlit_tracking::silhouette::{Overlap, Region};
use backlit_ui::drawing::{
    GhostMarks, JointId, JointMark, LimitMark, PictureInput, ProjectedLimb, ProjectedSphere, RivalMarks,
    SideMarks, SightRay, SwayMarks,
};
use backlit_ui::style::theme;
use backlit_ui::style::theme::size;
use backlit_ui::widgets::{Framing, ViewTransform};
use egui::{ColorImage, Id, Rect, StrokeKind, Ui, UiBuilder, pos2};
use glam::DVec2;

use super::pointer::{Pointer, rotation_owner};
use super::{Ellipses, TileEvent, TileView, gutter, header, legend, picture_view};
use crate::context::marks::SilhouetteTool;
use crate::context::pane::Pane;
use crate::context::view_settings::ViewSettings;
use crate::session::prediction::ComposedPicture;

/// What one camera sees of bodies.
#[derive(Clone, Debug, Default)]
pub struct BodyMarks {
    /// What is drawn in the place of the body's outline while that is of an earlier pose: the outline of `limbs`.
    pub quick_outline: Option<Vec<Vec<DVec2>>>,
    /// Limbs of the posed body: see [`project_limbs`](backlit_ui::drawing::project_limbs). Empty for none.
    pub limbs: Vec<Option<ProjectedLimb>>,
    /// Its joints: see [`project_joints`](backlit_ui::drawing::project_joints). Empty where nothing is to be dragged.
    pub joints: Vec<JointMark>,
    /// The ray of the joint that is dragged in another view.
    pub sight_ray: Option<SightRay>,
    /// Limits of joints that a drag has met.
    pub limits: Vec<LimitMark>,
    /// Left, right and face, if they are marked.
    pub sides: Option<SideMarks>,
    /// The spheres that stand for the body, the farthest first; empty where they are not outlined.
    pub spheres: Vec<ProjectedSphere>,
    /// From the end of each limb to where a prior learnt from motion would have it; empty without one.
    pub likelier: Vec<[DVec2; 2]>,
    /// The body on its way, if it sways.
    pub sway: Option<SwayMarks>,
    /// Poses that rival the one on the screen, likeliest first.
    pub rivals: Vec<Option<RivalMarks>>,
    /// Bodies in the place of the posed one.
    pub ghosts: Option<GhostMarks>,
    /// From each joint to where a reference has it, with the number of the reference.
    pub references: Vec<([DVec2; 2], usize)>,
    /// Ellipses of joints.
    pub ellipses: Ellipses,
    /// The corners of the boxes of people to choose from, the farthest first, each with its number from 0.
    pub people: Vec<(usize, [DVec2; 8])>,
}

/// All that a tile shows. It keeps nothing but the pointer's state and its textures.
#[derive(Clone, Copy, Debug)]
pub struct TileInput<'a> {
    /// The camera's index, counted from zero. It tells tiles apart.
    pub index: usize,
    /// It is the active tile.
    pub is_active: bool,
    /// It fills the window.
    pub is_expanded: bool,
    /// Panes that stand behind this one; the header has a badge or a name for each.
    pub siblings: &'a [Pane],
    /// It zooms and pans with the other linked tiles.
    pub is_linked: bool,
    /// There is a calibration. Without one there are pictures only.
    pub is_calibrated: bool,
    /// What it shows of the picture.
    pub tile: TileView,
    /// What all views share.
    pub settings: ViewSettings,
    /// Bounds of mask and body over the take, in pixel coordinates.
    pub subject_px: Option<Rect>,
    /// Footage, data and prediction.
    pub picture: PictureInput<'a>,
    /// Pictures of it that are made already.
    pub composed: &'a [ComposedPicture],
    /// Whether some pixel is unknown, and whether some pixel is shadow, where that was looked up beside the prediction.
    pub has_unknown_and_shadow: Option<[bool; 2]>,
    /// The footage at its full size, where `picture` has a part of it.
    pub full: Option<&'a Arc<ColorImage>>,
    /// Changes whenever anything in `picture` does. Textures are made again only then.
    pub generation: u64,
    /// The calibration, for the marks of it.
    pub camera: Option<&'a Camera>,
    /// The camera with its lens, for the edge of what that saw.
    pub raw_camera: Option<&'a Camera>,
    /// The body that is posed.
    pub body: &'a Model,
    /// The body's outline: see [`body_outline`](backlit_ui::drawing::body_outline).
    pub outlines: &'a [Vec<DVec2>],
    /// What the camera sees of this body and of others.
    pub marks: &'a BodyMarks,
    /// The joint that is held; its limb is marked too.
    pub selected: Option<JointId>,
    /// The limb whose size has handles, where the settings want them.
    pub sized: Option<usize>,
    /// Whether the limits are said in words too.
    pub says_limits: bool,
    /// How prediction and mask overlap; `None` without a mask.
    pub overlap: Option<Overlap>,
    /// The overlap is of an earlier pose, and a new one is on its way.
    pub is_overlap_stale: bool,
    /// The camera is used in the fit.
    pub is_used: bool,
    /// Its weight in the fit.
    pub weight: f64,
    /// What held the limbs, where the frame was tracked with cues.
    pub held: &'a [LimbHold],
    /// The limbs that are not believed.
    pub doubts: &'a [LimbTrust],
    /// Where another tool saw joints, while the tracker looks at that too.
    pub keypoints: &'a [JointKeypoint],
    /// The pictures of another frame are being read: nothing can be taken hold of in these.
    pub is_behind: bool,
    /// What steers its silhouette.
    pub steered: SteeredSilhouette<'a>,
    /// The numbers of the pixel under the pointer are shown.
    pub shows_hover_card: bool,
}

/// What steers a camera's silhouette.
#[derive(Clone, Copy, Debug, Default)]
pub struct SteeredSilhouette<'a> {
    /// What the pointer draws instead of posing the body, and the brush's radius in pixels.
    pub(crate) tool: Option<(SilhouetteTool, f32)>,
    /// Where the subject may be, if that is limited.
    pub(crate) region: Option<Region>,
    /// How the silhouette came about, if that is known.
    pub(crate) steps: Option<&'a Segmentation>,
}

impl<'a> TileInput<'a> {
    /// The camera's name as shown: "Camera 1".
    pub(super) fn name(&self) -> String {
        format!("Camera {}", self.index + 1)
    }

    /// What people call a limb of the body.
    pub(super) fn limb_name(&self, limb: usize) -> &'a str {
        self.body.limbs().get(limb).map_or("limb", |limb| limb.name.as_str())
    }

    /// The limbs that turn together with one, as they are seen.
    pub(super) fn turning_with(&self, limb: usize) -> Vec<&'a ProjectedLimb> {
        let owner = rotation_owner(self.body, limb);
        let limbs = self.marks.limbs.iter().enumerate();
        let turns = limbs.filter(|(index, _)| rotation_owner(self.body, *index) == owner);
        turns.filter_map(|(_, limb)| limb.as_ref()).collect()
    }
}

/// What a tile remembers from frame to frame.
#[derive(Clone, Debug, Default)]
pub(super) struct TileState {
    /// Height of the legend in the last frame of the window.
    pub(crate) legend_height: f32,
    /// What the user does in this frame.
    pub(super) events: Vec<TileEvent>,
    pub(super) pointer: Pointer,
    pub(super) hovered: Option<[usize; 2]>,
    pub(super) card: Option<[usize; 2]>,
    /// The line that is being drawn, in pixels.
    pub(super) line: Vec<[f32; 2]>,
    /// A line that was drawn to its end in this frame of the window.
    pub(super) drawn: Option<Vec<[f32; 2]>>,
}

/// Where the parts of a tile are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TileLayout {
    pub(super) header: Rect,
    pub(super) picture: Rect,
    pub(super) gutter: Option<Rect>,
    /// What the picture leaves free at its foot for the legend.
    pub(super) reserved: f32,
    pub(super) has_legend: bool,
}

impl TileLayout {
    /// The gutter is there when the tile is wide enough beside the whole picture, so it does not come and go
    /// with the zoom, and is there for all cameras of one format or for none.
    fn new(tile: Rect, size_px: [usize; 2]) -> Self {
        let header = Rect::from_min_max(tile.min, pos2(tile.right(), tile.top() + size::TILE_HEADER));
        let below = Rect::from_min_max(pos2(tile.left(), header.bottom()), tile.max);
        let shown = Framing::Whole.view(below, size_px, None).picture_rect(size_px).width();
        if below.width() - shown < size::GUTTER_FROM {
            let reserved = legend::RESERVED;
            return Self { header, picture: below, gutter: None, reserved, has_legend: true };
        }
        let (picture, gutter) = below.split_left_right_at_x(below.right() - size::GUTTER);
        Self { header, picture, gutter: Some(gutter), reserved: 0.0, has_legend: true }
    }
}

/// What came of a tile in a frame of the window.
#[derive(Debug)]
pub struct TileResponse {
    /// What the user did.
    pub events: Vec<TileEvent>,
    /// A line that was drawn by hand, in pixels.
    pub(crate) drawn: Option<Vec<[f32; 2]>>,
    /// How the picture lies on the screen.
    pub(crate) view: ViewTransform,
}

/// Shows a camera's tile in all of the space that `ui` has.
pub fn camera_tile(ui: &mut Ui, input: &TileInput<'_>) -> TileResponse {
    let tile = ui.available_rect_before_wrap();
    let layout = TileLayout::new(tile, input.picture.size);
    let id = ui.scope_id().with(("camera tile", input.index));
    let builder = UiBuilder::new().id_salt(("camera tile", input.index)).max_rect(tile);
    let scope = ui.scope_builder(builder, |ui| {
        ui.set_clip_rect(tile.intersect(ui.clip_rect()));
        let response = tile_contents(ui, id, &layout, input);
        ui.advance_cursor_after_rect(tile);
        response
    });
    scope.inner
}

fn tile_contents(ui: &mut Ui, id: Id, layout: &TileLayout, input: &TileInput<'_>) -> TileResponse {
    let palette = theme::palette(ui);
    let mut state = ui.data(|data| data.get_temp::<TileState>(id)).unwrap_or_default();
    let view = picture_view::show(ui, id, layout, input, &mut state);
    if let Some(gutter) = layout.gutter {
        ui.painter().rect_filled(gutter, 0.0, palette.well);
        gutter::show(ui, gutter, input, &mut state);
    }
    let mut events = std::mem::take(&mut state.events);
    header::show(ui, layout, input, &mut events);
    if input.is_active {
        let tile = layout.header.union(layout.picture).union(layout.gutter.unwrap_or(layout.picture));
        ui.painter().rect_stroke(tile, 0.0, palette.active_tile(), StrokeKind::Inside);
    }
    let drawn = state.drawn.take();
    ui.data_mut(|data| data.insert_temp(id, state));
    TileResponse { events, drawn, view }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn portrait_footage_in_a_wide_tile_leaves_a_gutter() {
        let layout = |width: f32, size_px: [usize; 2]| {
            let tile = Rect::from_min_size(pos2(5.0, 5.0), vec2(width, 400.0));
            TileLayout::new(tile, size_px)
        };
        let wide = layout(638.0, [272, 480]);
        let gutter = wide.gutter.unwrap();
        assert!((gutter.width() - 196.0).abs() < 1e-3);
        assert!((wide.picture.right() - gutter.left()).abs() < 1e-3);
        assert!((wide.header.height() - 26.0).abs() < 1e-3);
        assert_eq!(layout(386.0, [272, 480]).gutter, None);
        assert_eq!(layout(638.0, [640, 480]).gutter, None);
    }
}
