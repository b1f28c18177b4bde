//! Where the 3-D scene is seen from, its picture, and its visual hull.

use backlit_take::footage::Footage;
use egui::Ui;
use std::sync::Arc;

use backlit_jobs::{News, Pool, once};
use backlit_tracking::body::Kinematics;
use backlit_tracking::visual_hull::{HullOptions, HullView, VisualHull};
use glam::DVec3;

use super::ScenePreferences;
use super::hulls::HullInputs;
use super::{Orbit, Scene, SceneDrawing, SceneOrder, ShownHull, Upright, Viewpoint};
use crate::context::command::Command;
use crate::context::command::SceneCommand;
use crate::context::feature::Feature;
use crate::context::pane::Pane;
use crate::context::preferences::Layout;
use crate::context::unavailable::Why;
use crate::context::unavailable::{because, no_take};
use crate::context::{Context, PaneEvent, Requests, ShellRequest};

/// Views of a side of the body are from so far away, metres.
const BODY_FROM: f64 = 4.5;

impl Feature for Scene {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for news in self.draw.poll() {
            match news {
                News::Output(drawing) => self.drawing = Some(drawing),
                News::Failed(failure) => requests.failed("Drawing the 3-D scene", &failure),
                News::Ended => {}
            }
        }
        for news in self.carve.poll() {
            match (news, self.carve.inputs()) {
                (News::Output(hull), Some(inputs)) => self.hulls.insert(inputs.frame.clone(), hull),
                (News::Failed(failure), _) => requests.failed("Carving the visual hull", &failure),
                (News::Output(_) | News::Ended, _) => {}
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
                    VisualHull::carve(&views, &HullOptions::default(), cancel).map(Arc::new)
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
    pub(super) fn order(&mut self, pool: &Pool, order: SceneOrder) {
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
