//! The scene's tile: body, cameras with their pictures, floor and visual hull in three dimensions.
//!
//! | file | holds |
//! |---|---|
//! | `header` | title and the menu of views and of what is shown |
//! | `drag`, `keys` | orbit, pan, zoom, click on a camera |
//! | `canvas` | the picture, ordered again only when something in it has changed |
//! | `marks` | badges, the held joint, axes and words, over the picture |

mod canvas;
mod drag;
mod header;
pub(crate) mod keys;
mod marks;

use backlit_tracking::body::{Kinematics, Model, Pose};
use backlit_tracking::visual_hull::VisualHull;
use backlit_ui::drawing::JointId;
use backlit_ui::style::theme::size;
use egui::{Rect, Ui, pos2};
use glam::DVec3;

use crate::context::pane::Pane;
use crate::context::{Context, Requests};
use crate::features::scene::raster::SceneCamera;
use crate::features::scene::{
    ContentsInput, Frustum, Orbit, Scene, SceneDrawing, ScenePreferences, Upright, Viewpoint,
};

impl Scene {
    /// The tile, in all of the space that is left.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        siblings: &[Pane],
        requests: &mut Requests,
    ) {
        if context.session.take.is_none() {
            return;
        }
        let tile = ui.available_rect_before_wrap();
        let header = Rect::from_min_max(tile.min, pos2(tile.right(), tile.top() + size::TILE_HEADER));
        let picture = Rect::from_min_max(pos2(tile.left(), header.bottom()), tile.max);
        header::show(ui, header, &mut self.preferences, context, siblings, requests);
        let viewpoint = &mut self.preferences.viewpoint;
        let Some(stage) = Stage::new(context, *viewpoint, picture).filter(|_| picture.is_positive()) else {
            return;
        };
        let (seen_from, moves) = drag::navigate(ui, &stage, viewpoint);
        let stage = stage.seen_from(context, seen_from);
        let order = canvas::order(ui.pixels_per_point(), context, self, &stage, moves);
        self.order(context.pool, order);
        canvas::ground(ui, picture);
        let Some(drawing) = &self.drawing else { return };
        canvas::show(ui, picture, drawing);
        let seen = Seen::new(drawing, picture);
        drag::pick_camera(ui, context, &seen, requests);
        marks::show(ui, context, self, &seen);
        keys::show_focus(ui, picture);
    }
}

/// The scene as it is to be seen.
struct Stage {
    /// The picture on the screen.
    picture: Rect,
    upright: Upright,
    /// Height of the floor.
    floor: f64,
    /// Where the start pose stands.
    middle: DVec3,
    viewpoint: Viewpoint,
    eye: SceneCamera,
    /// The body on the screen.
    kinematics: Kinematics,
    root: DVec3,
    /// The camera in whose view a joint is dragged, and where that joint is.
    ray: Option<(usize, DVec3)>,
}

/// How large a body is in a pose: twice the greatest distance of its limbs' ends from their middle, metres.
fn height_of(model: &Model, pose: &Pose) -> f64 {
    let kinematics = Kinematics::new(model, pose);
    let ends = kinematics.ends();
    let middle = ends.iter().sum::<DVec3>() / ends.len().max(1) as f64;
    let thickest = model.limbs().iter().map(|limb| limb.radius).fold(0.0, f64::max);
    let farthest = ends.iter().chain([&pose.root]).map(|end| end.distance(middle)).fold(0.0, f64::max);
    2.0 * (farthest + thickest)
}

impl Stage {
    fn new(context: &Context<'_>, viewpoint: Option<Viewpoint>, picture: Rect) -> Option<Self> {
        let take = context.session.take.as_ref()?;
        let document = context.document();
        let upright = Upright::of(&take.cameras);
        let middle = document.start.root;
        let aspect = f64::from(picture.width() / picture.height().max(1.0));
        let viewpoint = viewpoint.unwrap_or_else(|| {
            let eyes: Vec<DVec3> = take.cameras.iter().map(|camera| camera.centre()).collect();
            let size = height_of(&document.model, &document.start);
            Viewpoint::Orbit(Orbit::around(&upright, (middle, size), &eyes, aspect))
        });
        // A body that sways is shown on its way.
        let swayed = context.observability.swayed_pose.as_ref();
        let pose = swayed.unwrap_or(context.shown_pose());
        let mut stage = Self {
            picture,
            upright,
            floor: upright.floor(&document.model, &document.start),
            middle,
            viewpoint,
            eye: viewpoint.camera(&upright, &take.cameras, aspect),
            kinematics: Kinematics::new(&document.model, pose),
            root: pose.root,
            ray: None,
        };
        let dragged = context.drag.dragged_joint();
        stage.ray = dragged.and_then(|(camera, joint)| Some((camera, stage.position(joint)?)));
        Some(stage)
    }

    /// The same from elsewhere: what a drag asks for is ordered in the very frame.
    fn seen_from(self, context: &Context<'_>, viewpoint: Viewpoint) -> Self {
        if viewpoint == self.viewpoint {
            return self;
        }
        let cameras = context.session.take.as_ref().map_or(&[][..], |take| take.cameras.as_slice());
        let aspect = f64::from(self.picture.width() / self.picture.height().max(1.0));
        Self { viewpoint, eye: viewpoint.camera(&self.upright, cameras, aspect), ..self }
    }

    fn contents_input<'a>(
        &'a self,
        context: &Context<'a>,
        preferences: &'a ScenePreferences,
        hull: Option<&'a VisualHull>,
        scale: f32,
    ) -> ContentsInput<'a> {
        let (session, document) = (context.session, context.document());
        let rotation = match context.selection.joint {
            JointId::Root => None,
            joint @ JointId::End(_) => {
                let limb = crate::session::selection::Selection { joint, ..*context.selection }
                    .limb(&document.model);
                document.model.limbs().get(limb).map(|limb| limb.rotation)
            }
        };
        ContentsInput {
            preferences,
            model: &document.model,
            kinematics: &self.kinematics,
            renderer: document.fit.renderer,
            sphere_level: context.views.drawn_level(),
            ghosts: context.ghosts,
            rotation,
            cameras: session.take.as_ref().map_or(&[], |take| take.cameras.as_slice()),
            uses: &document.cameras,
            active: context.selection.camera,
            hull,
            ray: self.ray,
            upright: self.upright,
            floor: self.floor,
            middle: self.middle,
            scale: f64::from(scale),
        }
    }

    fn position(&self, joint: JointId) -> Option<DVec3> {
        match joint {
            JointId::Root => Some(self.root),
            JointId::End(limb) => self.kinematics.ends().get(limb).copied(),
        }
    }
}

/// The scene as it was drawn: what lies over the picture belongs to that one, until the next is there.
struct Seen<'a> {
    /// The picture on the screen.
    picture: Rect,
    eye: SceneCamera,
    frusta: &'a [Frustum],
    /// Where the held joint is.
    held: Option<DVec3>,
}

impl<'a> Seen<'a> {
    fn new(drawing: &'a SceneDrawing, picture: Rect) -> Self {
        let order = &drawing.order;
        Self { picture, eye: order.eye, frusta: &order.frusta, held: order.held }
    }

    /// Where a point appears on the screen, and its depth.
    fn on_screen(&self, point: DVec3) -> Option<egui::Pos2> {
        // In tenths of a point, so that marks do not jump by whole ones.
        const FINE: f32 = 10.0;
        let size = (self.picture.size() * FINE).round();
        let (at, _) = self.eye.project(point, [size.x.max(1.0) as u32, size.y.max(1.0) as u32])?;
        let share = egui::vec2(at.x as f32 + 0.5, at.y as f32 + 0.5) / FINE;
        Some(self.picture.min + share).filter(|at| at.is_finite())
    }
}
