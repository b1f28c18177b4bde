//! Compare: the poses beside the take's own reference and beside recordings, tracks and projects that were added; and the runs of the
//! frame's fit as a table that sorts. `work` reads and compares, `curves` is the plot over frames.

mod curves;
mod panel;
mod runs_table;
#[cfg(test)]
mod tests;
mod work;

use std::path::PathBuf;
use std::sync::Arc;

use backlit_formats::Footage;
use backlit_jobs::{Task, once};
use backlit_tracking::metrics::comparison::TrackComparison;
use egui::Ui;

use crate::context::command::{Command, CompareCommand};
use crate::context::feature::Feature;
use crate::context::file_dialog::{DialogKind, FileDialogs};
use crate::context::marks::ReferenceMark;
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, because, no_take};
use crate::context::{Context, Published, Requests, pane_title, priority};
use curves::CurveChoice;
use runs_table::Sorting;
use work::{ComparisonInputs, NamedReference};

/// The endings that are offered in the dialog.
const ENDINGS: &[&str] = &["trc", "c3d", "bvh", "mot", "csv", "npz", "npy", "json", "backlit"];

/// What the pane shows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Side {
    /// The poses beside references.
    #[default]
    References,
    /// The runs of the fit.
    Runs,
}

#[derive(Debug, Default)]
pub(crate) struct Compare {
    side: Side,
    /// Files that were added, in their order.
    paths: Vec<PathBuf>,
    reading: Task<PathBuf, (PathBuf, Result<Arc<NamedReference>, String>), { priority::COMPARE }>,
    /// What is still to be read.
    queue: Vec<PathBuf>,
    references: Vec<Arc<NamedReference>>,
    comparing: Task<ComparisonInputs, Vec<Arc<TrackComparison>>, { priority::COMPARE }>,
    /// By reference.
    found: Vec<Arc<TrackComparison>>,
    /// The reference whose figures are shown by joint and angle.
    selected: usize,
    curve: CurveChoice,
    sorting: Sorting,
    /// Times of runs are left out of a picture that must be the same every time.
    hides_times: bool,
    dialogs: FileDialogs<()>,
    marks: Arc<Vec<ReferenceMark>>,
}

impl Feature for Compare {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let answers = self.dialogs.answers();
        self.queue.extend(answers.into_iter().map(|((), path)| path));
        for (path, read) in requests.outputs("Reading a reference", &mut self.reading) {
            match read {
                Ok(reference) => {
                    self.paths.push(path);
                    self.references.push(reference);
                    self.selected = self.references.len() - 1;
                }
                Err(why) => requests.complain(why),
            }
        }
        if !self.reading.is_busy()
            && let Some(path) = self.queue.pop()
        {
            self.reading.begin(context.pool, path, |path| {
                let path = path.clone();
                once(move |_| (path.clone(), work::read(&path)))
            });
        }
        self.compare(context, requests);
        self.marks = Arc::new(self.marks_of(context));
    }

    fn publish(&self, published: &mut Published) {
        published.references = self.marks.clone();
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Compare(command) = command else { return false };
        match command {
            CompareCommand::AddReference => {
                let kind = DialogKind::File(ENDINGS);
                let ask = ("Add a reference to compare with", kind);
                self.dialogs.ask(context.egui, (), ask, |why| requests.complain(why));
            }
            CompareCommand::RemoveReferences => {
                self.references.retain(|reference| reference.is_of_take);
                (self.selected, self.paths) = (0, Vec::new());
            }
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Compare(command) = command else { return None };
        match command {
            CompareCommand::AddReference => no_take(context),
            CompareCommand::RemoveReferences => because(
                self.references.iter().all(|reference| reference.is_of_take),
                "No reference was added",
            ),
        }
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Compare)
    }

    fn pane(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        pane_title::ground(ui, |ui| self.show(ui, context, siblings, requests));
    }

    fn sentence(&self, _: &Context<'_>) -> Option<String> {
        let path = self.reading.inputs().filter(|_| self.reading.is_busy())?;
        Some(format!("Reading {}.", path.display()))
    }

    fn reset(&mut self, take: &Footage) {
        let references = NamedReference::of_take(take.take()).into_iter().map(Arc::new).collect();
        *self = Self { side: self.side, references, ..Self::default() };
    }

    fn freeze_times(&mut self) {
        self.hides_times = true;
    }

    fn at_rest(&self) -> Self {
        Self {
            side: self.side,
            paths: self.paths.clone(),
            references: self.references.clone(),
            found: self.found.clone(),
            selected: self.selected,
            curve: self.curve.clone(),
            sorting: self.sorting,
            hides_times: self.hides_times,
            marks: self.marks.clone(),
            ..Self::default()
        }
    }
}

impl Compare {
    /// Compares again where the poses or the references are others, and the pane is to be seen.
    fn compare(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for found in requests.outputs("Comparing with references", &mut self.comparing) {
            self.found = found;
        }
        if self.references.is_empty() {
            self.found.clear();
            return;
        }
        let busy = context.busy;
        if !context.shows(Pane::Compare) || busy.tracking || busy.fitting || context.drag.is_dragging() {
            return;
        }
        let Some(take) = &context.session.take else { return };
        let document = context.document();
        let parts = (&document.model, &document.estimates, &document.keys);
        // The poses are copied for the comparison: not in every frame of the window.
        if self.comparing.inputs().is_some_and(|inputs| inputs.is_of(parts, &self.references)) {
            return;
        }
        let inputs = ComparisonInputs::of(document, take.take(), &self.references);
        self.comparing.ask(context.pool, inputs, |inputs| {
            let inputs = inputs.clone();
            once(move |_| inputs.compare())
        });
    }

    /// The comparison with a reference, if it is done.
    fn found_of(&self, reference: usize) -> Option<&TrackComparison> {
        self.found.get(reference).map(|found| &**found)
    }

    /// Takes a reference away.
    fn remove(&mut self, reference: usize) {
        if reference < self.references.len() {
            self.references.remove(reference);
        }
        if reference < self.found.len() {
            self.found.remove(reference);
        }
        self.selected = self.selected.min(self.references.len().saturating_sub(1));
    }

    /// The selected reference's joints in the frame on the screen, while the pane is open.
    fn marks_of(&self, context: &Context<'_>) -> Vec<ReferenceMark> {
        let shown = context.shows(Pane::Compare) && self.side == Side::References;
        let Some(found) = self.found_of(self.selected).filter(|_| shown) else { return Vec::new() };
        let (frame, pose) = context.pictured();
        let Ok(index) = found.frames.binary_search_by_key(&frame, |compared| compared.frame) else {
            return Vec::new();
        };
        work::marks(
            self.selected,
            &context.document().model,
            pose,
            &found.joints,
            &found.frames[index].reference,
        )
    }
}
