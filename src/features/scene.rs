//! The 3-D scene: what it shows and where it is seen from. Lengths are metres, in world axes.

use std::collections::VecDeque;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::{Pool, Task, once};
use backlit_tracking::body::Kinematics;
use backlit_tracking::camera::Camera;
use backlit_tracking::visual_hull::{CELLS, HullView, VisualHull};
pub(crate) use contents::{ContentsInput, Frustum, contents};
pub use drawing::{SceneDrawing, SceneOrder, Thumbnails};
use egui::Ui;
use glam::DVec3;
use serde::{Deserialize, Serialize};
pub use viewpoint::{Orbit, Upright, Viewpoint};

use crate::context::command::{Command, SceneCommand};
use crate::context::feature::Feature;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, PaneEvent, Requests, ShellRequest, priority};
use crate::session::FrameData;

mod contents;
mod drawing;
pub(crate) mod panel;
pub(crate) mod raster;
#[cfg(test)]
mod tests;
mod viewpoint;

/// The feature.
#[derive(Debug, Default)]
pub struct Scene {
    /// What is shown.
    pub(crate) preferences: ScenePreferences,
    /// Visual hulls of frames.
    pub hulls: HullCache,
    /// The picture. While a newer one is drawn, the old stays.
    pub drawing: Option<Arc<SceneDrawing>>,
    /// Makes the picture of the order with this key.
    draw: Task<u64, Arc<SceneDrawing>, { priority::SCENE }>,
    carve: Task<HullInputs, Option<Arc<VisualHull>>, { priority::HULL }>,
}

impl Scene {
    /// Whether nothing but the picture of the scene is being worked on.
    pub(crate) fn is_all_that_works(&self, pool: &Pool) -> bool {
        pool.is_idle_but(&self.draw)
    }
}

/// What is shown of the visual hull.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShownHull {
    /// Nothing; it is not carved.
    Hidden,
    /// The box that holds it.
    #[default]
    Bounds,
    /// The box, and the cubes at its surface.
    Shell,
}

impl ShownHull {
    /// All of them with their names.
    pub(crate) const ALL: [(Self, &'static str); 3] =
        [(Self::Hidden, "No visual hull"), (Self::Bounds, "Hull bounds"), (Self::Shell, "Hull voxels")];
}

/// What the scene shows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ScenePreferences {
    /// Where it is seen from; `None` from where all cameras are seen.
    #[serde(skip)]
    pub viewpoint: Option<Viewpoint>,
    /// Cameras with their frusta.
    pub cameras: bool,
    /// The pictures on the frusta.
    pub pictures: bool,
    /// Floor and axes.
    pub floor: bool,
    /// The visual hull.
    pub hull: ShownHull,
}

impl Default for ScenePreferences {
    fn default() -> Self {
        Self { viewpoint: None, cameras: true, pictures: true, floor: true, hull: ShownHull::Bounds }
    }
}

/// Hulls that are kept.
const CAPACITY: usize = 32;

/// What a hull is carved from: the same where cameras and frame are the very same.
#[derive(Debug, Clone)]
struct HullInputs {
    /// The cameras without distortion.
    cameras: Arc<Vec<Arc<Camera>>>,
    /// The frame, with the silhouettes of all of them.
    frame: Arc<FrameData>,
}

impl PartialEq for HullInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.cameras, &other.cameras) && Arc::ptr_eq(&self.frame, &other.frame)
    }
}

/// Hulls by the frame that they were carved from.
#[derive(Debug, Clone, Default)]
pub struct HullCache {
    hulls: VecDeque<(Arc<FrameData>, Option<Arc<VisualHull>>)>,
}

impl HullCache {
    /// A frame's hull: `None` while it is not carved, `Some(None)` if its silhouettes leave none.
    pub fn get(&self, frame: &Arc<FrameData>) -> Option<Option<&Arc<VisualHull>>> {
        let found = self.hulls.iter().find(|(other, _)| Arc::ptr_eq(other, frame));
        found.map(|(_, hull)| hull.as_ref())
    }

    /// Keeps a hull, and drops the oldest if there are too many.
    pub(crate) fn insert(&mut self, frame: Arc<FrameData>, hull: Option<Arc<VisualHull>>) {
        self.hulls.retain(|(other, _)| other.frame != frame.frame);
        if self.hulls.len() == CAPACITY {
            self.hulls.pop_front();
        }
        self.hulls.push_back((frame, hull));
    }
}

/// Views of a side of the body are from so far away, metres.
const BODY_FROM: f64 = 4.5;

impl Feature for Scene {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for drawing in requests.outputs("Drawing the 3-D scene", &mut self.draw) {
            self.drawing = Some(drawing);
        }
        for hull in requests.outputs("Carving the visual hull", &mut self.carve) {
            if let Some(inputs) = self.carve.inputs() {
                self.hulls.insert(inputs.frame.clone(), hull);
            }
        }
        let (session, is_hidden) = (context.session, self.preferences.hull == ShownHull::Hidden);
        if let Some((take, frame)) = session.take.as_ref().zip(session.frames.get(context.selection.frame))
            && context.shows(Pane::Scene)
            && !(is_hidden || self.carve.is_busy())
            && self.hulls.get(frame).is_none()
        {
            let inputs = HullInputs { cameras: take.cameras.clone(), frame: frame.clone() };
            self.carve.ask(context.pool, inputs, |inputs| {
                let inputs = inputs.clone();
                once(move |cancel| {
                    let pairs = inputs.cameras.iter().zip(&inputs.frame.cameras);
                    let views: Vec<_> = pairs
                        .filter_map(|(camera, data)| {
                            Some(HullView { camera: camera.as_ref(), silhouette: data.mask.as_deref()? })
                        })
                        .collect();
                    VisualHull::carve(&views, CELLS, cancel).map(Arc::new)
                })
            });
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Scene(command) = command else { return false };
        self.preferences.viewpoint = match command {
            SceneCommand::Reset => None,
            SceneCommand::FromCamera => Some(Viewpoint::Camera(context.selection.camera)),
            SceneCommand::Front => self.side_of_body(context, |facing, _| facing),
            SceneCommand::Side => self.side_of_body(context, DVec3::cross),
            // Nearly: the front stays below.
            SceneCommand::Top => self.side_of_body(context, |facing, up| up * 1e3 + facing),
        };
        if !context.shows(Pane::Scene) {
            requests.request(ShellRequest::Pane(Pane::Scene, PaneEvent::Open));
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        if !matches!(command, Command::Scene(_)) {
            return None;
        }
        let has_no_tiles = context.preferences.layout == Layout::Demonstrate;
        no_take(context).or(because(has_no_tiles, "This layout has no tiles"))
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Scene)
    }

    fn pane(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        self.show(ui, context, siblings, requests);
    }

    fn reset(&mut self, _: &Footage) {
        let preferences = ScenePreferences { viewpoint: None, ..self.preferences };
        *self = Self { preferences, ..Self::default() };
    }

    fn at_rest(&self) -> Self {
        let (hulls, drawing) = (self.hulls.clone(), self.drawing.clone());
        Self { preferences: self.preferences, hulls, drawing, ..Self::default() }
    }
}

impl Scene {
    /// Has the scene drawn, unless its picture shows just that or another one is being drawn. What changes meanwhile is
    /// ordered when that picture is there: the newest order follows, and a scene that never rests gets its pictures too.
    fn order(&mut self, pool: &Pool, order: SceneOrder) {
        let key = order.key();
        if self.draw.is_busy() || self.drawing.as_ref().is_some_and(|drawing| drawing.key == key) {
            return;
        }
        let earlier = self.drawing.clone();
        let draw = |_: &u64| once(move |_| Arc::new(SceneDrawing::new(order, earlier.as_deref())));
        self.draw.ask(pool, key, draw);
    }

    /// The body from a direction, made of where it faces and where up is.
    fn side_of_body(
        &self,
        context: &Context<'_>,
        direction: impl Fn(DVec3, DVec3) -> DVec3,
    ) -> Option<Viewpoint> {
        let take = context.session.take.as_ref()?;
        let upright = Upright::of(&take.cameras);
        let (model, pose) = (&context.document().model, context.shown_pose());
        let facing = upright.facing(model, &Kinematics::new(model, pose)).unwrap_or(upright.ahead);
        let near = Orbit { target: pose.root, azimuth: 0.0, elevation: 0.0, distance: BODY_FROM };
        let orbit = match self.preferences.viewpoint {
            Some(Viewpoint::Orbit(orbit)) => Orbit { target: pose.root, ..orbit },
            _ => near,
        };
        Some(Viewpoint::Orbit(orbit.seen_from_side(&upright, direction(facing, upright.up))))
    }
}
