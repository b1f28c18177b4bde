//! Where the 3-D scene is seen from, and its visual hull.

use backlit_tracking::body::Kinematics;
use glam::DVec3;

use crate::app::Inspector;
use crate::context::command::SceneCommand;
use crate::context::pane::Pane;
use crate::features::scene::draw_job::DrawSceneJob;
use crate::features::scene::hull_job::HullJob;
use crate::features::scene::{HullLook, Orbit, SceneOrder, Upright, Viewpoint};
use crate::worker::Lane;

/// Views of a side of the body are from so far away, metres.
const BODY_FROM: f64 = 4.5;

impl Inspector {
    /// Whether the scene is on the screen.
    fn shows_scene(&self) -> bool {
        match self.shell.docking.alone {
            Some(alone) => alone == Pane::Scene,
            None => self.state.preferences.is_open(Pane::Scene, self.state.session.camera_count()),
        }
    }

    /// Has the scene drawn, if it is not being drawn. What changes meanwhile is ordered when that picture is there: the
    /// newest order follows, and a scene that never rests gets its pictures too.
    pub(crate) fn draw_scene(&mut self, order: SceneOrder) {
        if self.may_ask(Lane::Scene) && !self.worker.is_busy(Lane::Scene) {
            let earlier = self.state.session.scene_drawing.clone();
            self.worker.request(Lane::Scene, DrawSceneJob::new(order, earlier));
        }
    }

    /// Asks for the hull of the frame on the screen, where it is to be seen and not carved yet.
    pub(crate) fn request_hull(&mut self) {
        let may_carve = self.may_ask(Lane::Hull) && !self.worker.is_busy(Lane::Hull);
        if !self.shows_scene() || self.state.preferences.scene.hull == HullLook::Hidden || !may_carve {
            return;
        }
        let Some(take) = &self.state.session.take else { return };
        let Some(frame) = self.state.session.frames.get(self.state.selection.frame) else { return };
        if self.state.session.hulls.get(frame).is_none() {
            let job = HullJob { cameras: take.cameras.clone(), frame: frame.clone() };
            self.worker.request(Lane::Hull, job);
        }
    }

    /// Turns the scene to a side of the body. Opens it where it is closed.
    pub(crate) fn scene_command(&mut self, command: SceneCommand) {
        self.state.preferences.scene.viewpoint = match command {
            SceneCommand::Reset => None,
            SceneCommand::FromCamera => Some(Viewpoint::Camera(self.state.selection.camera)),
            SceneCommand::Front => self.side_of_body(|facing, _| facing),
            SceneCommand::Side => self.side_of_body(DVec3::cross),
            // Nearly: the front stays below.
            SceneCommand::Top => self.side_of_body(|facing, up| up * 1e3 + facing),
        };
        if !self.shows_scene() {
            self.pane_event(Pane::Scene, crate::context::PaneEvent::Open);
        }
    }

    /// The body from a direction, made of where it faces and where up is.
    fn side_of_body(&self, direction: impl Fn(DVec3, DVec3) -> DVec3) -> Option<Viewpoint> {
        let take = self.state.session.take.as_ref()?;
        let upright = Upright::of(&take.cameras);
        let pose = self.shown_pose();
        let kinematics = Kinematics::new(&self.document().model, pose);
        let facing = upright.facing(&self.document().model, &kinematics).unwrap_or(upright.ahead);
        let near = Orbit { target: pose.root, azimuth: 0.0, elevation: 0.0, distance: BODY_FROM };
        let orbit = match self.state.preferences.scene.viewpoint {
            Some(Viewpoint::Orbit(orbit)) => Orbit { target: pose.root, ..orbit },
            _ => near,
        };
        Some(Viewpoint::Orbit(orbit.from_side(&upright, direction(facing, upright.up))))
    }
}
