//! Names are asked for when the track has changed, and at rest.

use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::once;
use backlit_tracking::camera::up_of;
use egui::Ui;
use glam::DVec3;

use super::Motions;
use super::job::{Inputs, Missing};
use crate::context::feature::Feature;
use crate::context::file_dialog::DialogKind;
use crate::context::marks::MotionMarks;
use crate::context::pane::Pane;
use crate::context::{Context, Published, Requests, pane_title};

impl Feature for Motions {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for ((), path) in self.dialogs.answers() {
            self.model = Some(path);
        }
        for found in requests.outputs("The recognition of motions", &mut self.task) {
            match found {
                Ok(found) => {
                    self.marks.stretches = Arc::new(found.stretches());
                    (self.found, self.missing) = (Some(found), None);
                }
                Err(missing) => self.forget(missing),
            }
        }
        let Some(inputs) = self.inputs(context) else { return };
        if inputs.estimates.is_empty() {
            self.task.forget();
            self.forget(Missing::Track);
            return;
        }
        let busy = context.busy;
        if !(busy.tracking || busy.fitting || context.drag.is_dragging()) {
            let name = |inputs: &Inputs| {
                let inputs = inputs.clone();
                once(move |cancel| inputs.recognise(cancel))
            };
            self.task.ask(context.pool, inputs.clone(), name);
        }
        self.marks.is_stale = self.task.is_busy() || self.task.inputs() != Some(&inputs);
    }

    fn publish(&self, published: &mut Published) {
        published.motions = self.marks.clone();
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Motions)
    }

    fn pane(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        pane_title::ground(ui, |ui| {
            self.head(ui, context, siblings, requests);
            match &self.found {
                Some(found) => self.shown(ui, found, context, requests),
                None => self.nothing(ui, context, requests),
            }
        });
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self { preferences: self.preferences, model: self.model.take(), ..Self::default() };
    }

    fn at_rest(&self) -> Self {
        Self {
            preferences: self.preferences,
            model: self.model.clone(),
            found: self.found.clone(),
            missing: self.missing.clone(),
            marks: self.marks.clone(),
            ..Self::default()
        }
    }
}

impl Motions {
    /// There are no names, and why.
    fn forget(&mut self, missing: Missing) {
        (self.found, self.missing) = (None, Some(missing));
        self.marks = MotionMarks::default();
    }

    fn inputs(&self, context: &Context<'_>) -> Option<Inputs> {
        let (document, take) = (context.document(), context.session.take.as_ref()?);
        Some(Inputs {
            body: Arc::clone(&document.model),
            estimates: Arc::clone(&document.estimates),
            frame_rate: take.take().frame_rate(),
            up: up_of(take.cameras.iter().map(|camera| &**camera)).unwrap_or(DVec3::Z),
            model: self.model.clone(),
            method: self.preferences.method,
        })
    }

    /// Asks for a file that was learnt elsewhere.
    pub(super) fn ask_for_model(&self, context: &Context<'_>, requests: &mut Requests) {
        let dialog = ("Model of motions", DialogKind::File(&["json"]));
        self.dialogs.ask(context.egui, (), dialog, |why| requests.complain(why));
    }
}
