//! Silhouettes: how the one on the screen comes about, step by step; which of the take are worst; settings that suit it better; a
//! region of interest and brushes to mend them by hand. `strokes` makes edits of what is drawn, `work` is what takes its time.

mod panel;
mod steps;
mod strokes;
#[cfg(test)]
mod tests;
mod work;

use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_formats::footage::{DrawnPictures, MadeWith};
use backlit_jobs::{Task, once};
use backlit_runs::silhouettes::SilhouetteQuality;
use egui::{Key, Modifiers, Ui};

use crate::context::command::{Command, SilhouetteCommand};
use crate::context::feature::Feature;
use crate::context::marks::{SilhouetteMarks, SilhouetteSteps, SilhouetteTool, WorstSilhouette};
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, FeatureRequest, Published, Requests, pane_title, priority};
use work::WorkMessage;

/// How many of the worst silhouettes are listed.
const LISTED: usize = 20;
/// Radius of a brush that nobody has chosen, pixels.
const USUAL_RADIUS_PX: f64 = 6.0;

/// In which frames a stroke is painted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum BrushScope {
    /// In the one on the screen.
    #[default]
    Frame,
    /// In those that are marked, else in all, at the same place.
    Range,
    /// In the same frames as far as they have poses, moved with the limb that it lies on.
    Body,
}

#[derive(Debug)]
pub(crate) struct SilhouetteSteering {
    tool: Option<SilhouetteTool>,
    radius_px: f64,
    scope: BrushScope,
    steps: Task<(usize, usize, MadeWith), SilhouetteSteps, { priority::SILHOUETTE_STEPS }>,
    shown: Option<Arc<SilhouetteSteps>>,
    /// The step that is shown large, by its place.
    enlarged: Option<usize>,
    work: Task<(), WorkMessage, { priority::SILHOUETTES }>,
    /// What is being done, and how much of it, of how much.
    progress: Option<(&'static str, [usize; 2])>,
    /// The worst silhouettes that are listed, the worst first.
    worst: Option<Vec<SilhouetteQuality>>,
    /// What tuning has said.
    tuned: Option<String>,
}

impl Default for SilhouetteSteering {
    fn default() -> Self {
        Self {
            tool: None,
            radius_px: USUAL_RADIUS_PX,
            scope: BrushScope::default(),
            steps: Task::default(),
            shown: None,
            enlarged: None,
            work: Task::default(),
            progress: None,
            worst: None,
            tuned: None,
        }
    }
}

impl Feature for SilhouetteSteering {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for steps in requests.outputs("Segmenting step by step", &mut self.steps) {
            self.shown = Some(Arc::new(steps));
        }
        self.take_in_work(context, requests);
        if context.shows(Pane::Silhouettes) {
            self.ask_for_steps(context);
        }
        let holds_brush = self.tool.is_some() && !context.is_covered;
        if holds_brush && context.egui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
            self.tool = None;
        }
    }

    fn publish(&self, published: &mut Published) {
        let tool = self.tool.map(|tool| (tool, self.radius_px as f32));
        let mark = |one: &SilhouetteQuality| WorstSilhouette {
            camera: one.camera,
            frame: one.frame,
            reason: one.reason(),
        };
        let worst = self.worst.iter().flatten().map(mark).collect();
        published.silhouettes = SilhouetteMarks { tool, steps: self.shown.clone(), worst };
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Silhouettes(command) = command else { return false };
        let camera = context.selection.camera;
        match command {
            SilhouetteCommand::Draw(tool) => {
                self.tool = Some(tool);
                let what = match tool {
                    SilhouetteTool::Region => {
                        "Draw a rectangle around where the subject may be, in a camera’s view"
                    }
                    SilhouetteTool::Brush(_) => "Paint in a camera’s view",
                };
                requests.status(format!("{what}. Esc puts the brush away."));
            }
            SilhouetteCommand::PutAway => self.tool = None,
            SilhouetteCommand::Erase => {
                requests.edit(Edit::EraseBrush { camera, frames: strokes::marked_or_shown(context) });
            }
            SilhouetteCommand::RemoveRegion => requests.edit(Edit::SetRegion { camera, region: None }),
            SilhouetteCommand::FindWorst => self.find_worst(context),
            SilhouetteCommand::Tune => self.tune(context),
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Silhouettes(command) = command else { return None };
        let (document, camera) = (context.document(), context.selection.camera);
        let is_drawn =
            context.session.take.as_ref().is_some_and(|take| take.drawn == Some(DrawnPictures::GreyLevels));
        let drawn = || {
            because(
                is_drawn,
                "The pictures of this demonstration are drawn grey levels: there is no silhouette to mend",
            )
        };
        let busy = || because(self.work.is_busy(), "Silhouettes are being looked through");
        match command {
            SilhouetteCommand::Draw(_) => no_take(context).or_else(drawn),
            SilhouetteCommand::PutAway => because(self.tool.is_none(), "The pointer poses the body already"),
            SilhouetteCommand::Erase => {
                let edit = Edit::EraseBrush { camera, frames: strokes::marked_or_shown(context) };
                no_take(context)
                    .or(because(!document.would_change(&edit), "Nothing is painted in this camera’s frame"))
            }
            SilhouetteCommand::RemoveRegion => {
                let has_region = document.measurement.get(camera).is_some_and(|own| own.region.is_some());
                no_take(context).or(because(!has_region, "This camera has no region of interest"))
            }
            SilhouetteCommand::FindWorst => no_take(context).or_else(drawn).or_else(busy),
            SilhouetteCommand::Tune => {
                let has_no_pose = document.estimates.is_empty() && document.keys.is_empty();
                no_take(context).or_else(drawn).or_else(busy).or(because(
                    has_no_pose,
                    "No frame has a pose yet: track some frames first, so that the body tells which settings suit it",
                ))
            }
        }
    }

    fn answer(&mut self, request: &FeatureRequest, context: &Context<'_>, requests: &mut Requests) {
        if let FeatureRequest::DrawSilhouette(camera, points) = request {
            self.draw(*camera, points, context, requests);
        }
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Silhouettes)
    }

    fn pane(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        pane_title::ground(ui, |ui| self.show(ui, context, siblings, requests));
    }

    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        let (doing, [done, all]) = self.progress?;
        Some(format!("{doing}: {done} of {all}."))
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self { radius_px: self.radius_px, ..Self::default() };
    }

    fn at_rest(&self) -> Self {
        Self {
            tool: self.tool,
            radius_px: self.radius_px,
            scope: self.scope,
            shown: self.shown.clone(),
            enlarged: self.enlarged,
            worst: self.worst.clone(),
            tuned: self.tuned.clone(),
            ..Self::default()
        }
    }
}

impl SilhouetteSteering {
    /// Asks how the silhouette of the active camera's frame comes about.
    fn ask_for_steps(&mut self, context: &Context<'_>) {
        let (camera, frame) = (context.selection.camera, context.selection.frame);
        let Some(take) = context.session.take.clone() else { return };
        let Some(data) = context.session.frames.get(frame).cloned() else { return };
        let options = context.document().measurement.get(camera).cloned().unwrap_or_default();
        let inputs = (camera, frame, data.made_with.clone());
        self.steps.ask(context.pool, inputs, move |_| {
            once(move |_| {
                let of_camera = data.cameras.get(camera);
                let steps = match of_camera.and_then(|own| own.image.as_ref()) {
                    None => Err("There is no picture for this frame".to_owned()),
                    Some(picture) => {
                        let last = of_camera.and_then(|own| own.mask.as_deref());
                        match take.stages(camera, frame, picture, &options, last) {
                            Ok(Some(steps)) => Ok(steps),
                            Ok(None) => {
                                Err("This silhouette was not made of the picture: there are no steps"
                                    .to_owned())
                            }
                            Err(error) => Err(error.to_string()),
                        }
                    }
                };
                SilhouetteSteps { camera, frame, steps }
            })
        });
    }
}
