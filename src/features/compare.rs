//! Compare: the poses beside the take's own reference and beside recordings, tracks and projects that were added; and the runs of the
//! frame's fit as a table that sorts. `work` reads and compares, `overlap` measures silhouettes, `curves` is the plot over frames.

mod curves;
mod overlap;
mod panel;
mod runs_table;
#[cfg(test)]
mod tests;
mod work;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use backlit_document::edit::Edit;
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
use overlap::Overlaps;
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
    /// Files that were asked for and are not the document's yet: they are once they have been read.
    asked: Vec<PathBuf>,
    /// The one that was added last, until it is selected.
    added: Option<PathBuf>,
    reading: Task<PathBuf, (PathBuf, Result<Arc<NamedReference>, String>), { priority::COMPARE }>,
    /// What files hold; `None` where one cannot be read, which was told.
    read: BTreeMap<PathBuf, Option<Arc<NamedReference>>>,
    of_take: Option<Arc<NamedReference>>,
    /// The take's own, then the document's as far as they were read.
    references: Vec<Arc<NamedReference>>,
    comparing: Task<ComparisonInputs, Vec<Arc<TrackComparison>>, { priority::COMPARE }>,
    /// By reference.
    found: Vec<Arc<TrackComparison>>,
    overlaps: Overlaps,
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
        for ((), path) in self.dialogs.answers() {
            self.add(path);
        }
        self.read(context, requests);
        self.name_references(context);
        self.compare(context, requests);
        self.measure_overlap(context, requests);
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
                requests.edit(Edit::SetReferences(Vec::new()));
            }
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Compare(command) = command else { return None };
        match command {
            CompareCommand::AddReference => no_take(context),
            CompareCommand::RemoveReferences => {
                because(context.document().references.is_empty(), "No reference was added")
            }
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
        let of_take = NamedReference::of_take(take.take()).map(Arc::new);
        *self = Self { side: self.side, of_take, ..Self::default() };
    }

    fn freeze_times(&mut self) {
        self.hides_times = true;
    }

    fn at_rest(&self) -> Self {
        Self {
            side: self.side,
            read: self.read.clone(),
            of_take: self.of_take.clone(),
            references: self.references.clone(),
            found: self.found.clone(),
            overlaps: self.overlaps.at_rest(),
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
    /// Asks for a file. It is read anew: it may be another than before.
    fn add(&mut self, path: PathBuf) {
        self.read.remove(&path);
        self.asked.push(path);
    }

    /// Reads files that were asked for, and those that the document names once the pane is to be seen, one after the other.
    fn read(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let paths = &context.document().references;
        for (path, read) in requests.outputs("Reading a reference", &mut self.reading) {
            let is_asked = self.asked.contains(&path);
            self.asked.retain(|asked| *asked != path);
            match &read {
                Err(why) => requests.complain(why.clone()),
                Ok(_) if is_asked => {
                    self.added = Some(path.clone());
                    let others = paths.iter().filter(|other| **other != path);
                    requests.edit(Edit::SetReferences(others.chain([&path]).cloned().collect()));
                }
                Ok(_) => {}
            }
            self.read.insert(path, read.ok());
        }
        let of_document: &[PathBuf] = if context.shows(Pane::Compare) { paths } else { &[] };
        let mut named = self.asked.iter().chain(of_document);
        if !self.reading.is_busy()
            && let Some(path) = named.find(|path| !self.read.contains_key(*path))
        {
            self.reading.begin(context.pool, path.clone(), |path| {
                let path = path.clone();
                once(move |_| (path.clone(), work::read(&path)))
            });
        }
    }

    /// Renews the list of references. A comparison goes with its reference.
    fn name_references(&mut self, context: &Context<'_>) {
        let of_file = |path: &PathBuf| self.read.get(path)?.clone();
        let of_document = context.document().references.iter().filter_map(of_file);
        let now: Vec<Arc<NamedReference>> = self.of_take.iter().cloned().chain(of_document).collect();
        if work::are_same(&now, &self.references) {
            return;
        }
        let found_of = |one: &Arc<NamedReference>| {
            let at = self.references.iter().position(|other| Arc::ptr_eq(one, other))?;
            self.found.get(at).cloned()
        };
        self.found = now.iter().map_while(found_of).collect();
        self.references = now;
        let last = self.references.last().and_then(|last| last.path.as_ref());
        self.selected = match self.added.take_if(|added| last == Some(added)) {
            Some(_) => self.references.len() - 1,
            None => self.selected.min(self.references.len().saturating_sub(1)),
        };
    }

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

    /// Measures the overlap of the selected reference, once it is compared.
    fn measure_overlap(&mut self, context: &Context<'_>, requests: &mut Requests) {
        let is_seen = context.shows(Pane::Compare) && self.side == Side::References;
        let selected = self.references.get(self.selected).zip(self.found.get(self.selected));
        let Some(compared) = selected.filter(|_| is_seen) else { return };
        if let Some(inputs) = self.comparing.inputs().filter(|_| !self.comparing.is_busy()) {
            self.overlaps.update(compared, inputs.motion(), context, requests);
        }
    }

    /// The comparison with a reference, if it is done.
    fn found_of(&self, reference: usize) -> Option<&TrackComparison> {
        self.found.get(reference).map(|found| &**found)
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
