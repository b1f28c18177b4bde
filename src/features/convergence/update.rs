//! Runs in the convergence panel: named, shown, removed, brought back, exported.

use std::path::Path;

use crate::app::Inspector;
use crate::context::Write;
use crate::context::command::{Command, ConvergenceCommand};
use crate::document::run::RunEnding;
use crate::document::run_names::name_runs;
use crate::features::convergence::{CurvesRequest, picture, table};
use crate::session::RemovedRuns;
use crate::session::selection::StepRef;

impl Inspector {
    /// Names the runs anew by what differs, after there are others or others are shown.
    pub(crate) fn name_runs(&mut self) {
        name_runs(&mut self.state.session.runs);
    }

    pub(crate) fn curves_request(&mut self, request: CurvesRequest) {
        match request {
            CurvesRequest::Look(look) => self.state.preferences.curves = look,
            CurvesRequest::Rename(run, name) => {
                if let Some(run) = self.state.session.runs.get_mut(run) {
                    let name = name.trim();
                    (run.is_named, run.name) = (!name.is_empty(), name.to_owned());
                    self.name_runs();
                }
            }
            CurvesRequest::ShowOnly(only) => {
                for (index, run) in self.state.session.runs.iter_mut().enumerate() {
                    run.is_shown = index == only;
                }
                self.name_runs();
            }
            CurvesRequest::Remove(run) => self.remove_run(run),
        }
    }

    fn remove_run(&mut self, index: usize) {
        if self.state.session.live == Some(index) {
            self.interrupt_fit();
        }
        let Some(name) = self.state.session.runs.get(index).map(|run| run.name.clone()) else { return };
        self.remember_runs();
        self.state.session.runs.remove(index);
        let moved = |at: usize| if at > index { Some(at - 1) } else { (at < index).then_some(at) };
        self.state.session.live = self.state.session.live.and_then(moved);
        self.state.selection.step =
            self.state.selection.step.and_then(|at| Some(StepRef { run: moved(at.run)?, step: at.step }));
        self.name_runs();
        let back = Command::Convergence(ConvergenceCommand::RestoreRuns);
        self.state.notices.info(self.state.now, format!("Removed the run {name}."), Some(back));
    }

    pub(crate) fn clear_runs(&mut self) {
        self.interrupt_fit();
        self.remember_runs();
        let count = self.state.session.runs.len();
        self.state.selection.step = None;
        self.state.session.runs.clear();
        self.state.session.live = None;
        let text = if count == 1 { "Removed the run.".to_owned() } else { format!("Removed {count} runs.") };
        self.state.notices.info(
            self.state.now,
            text,
            Some(Command::Convergence(ConvergenceCommand::RestoreRuns)),
        );
    }

    fn remember_runs(&mut self) {
        let runs = self.state.session.runs.clone();
        self.state.session.removed = Some(RemovedRuns { runs, revision: self.state.history.revision() });
    }

    /// Whether the last thing that was done is the removal of runs: undo takes that back first.
    pub(crate) fn removed_runs_last(&self) -> bool {
        let revision = self.state.history.revision();
        self.state.session.removed.as_ref().is_some_and(|removed| removed.revision == revision)
            || (self.state.session.removed.is_some() && self.state.history.undo_text().is_none())
    }

    /// Brings back what was removed last; runs that were made since stay.
    pub(crate) fn restore_runs(&mut self) {
        let Some(removed) = self.state.session.removed.take() else { return };
        let was_live =
            self.state.session.live.and_then(|live| self.state.session.runs.get(live)).map(|run| run.number);
        let looked_at = self
            .state
            .selection
            .step
            .and_then(|at| Some((self.state.session.runs.get(at.run)?.number, at.step)));
        let mut runs = removed.runs;
        for run in std::mem::take(&mut self.state.session.runs) {
            match runs.iter_mut().find(|other| other.number == run.number) {
                Some(other) => *other = run,
                None => runs.push(run),
            }
        }
        // What was interrupted cannot go on.
        for run in runs.iter_mut().filter(|run| run.ending.is_none() && was_live != Some(run.number)) {
            run.ending = Some(RunEnding::Stopped);
        }
        let place = |number: usize| runs.iter().position(|run| run.number == number);
        self.state.session.live = was_live.and_then(place);
        self.state.selection.step =
            looked_at.and_then(|(number, step)| Some(StepRef { run: place(number)?, step }));
        self.state.session.runs = runs;
        self.name_runs();
        self.state.status = Some("Brought back the runs.".to_owned());
    }

    /// Writes every step of all runs as CSV.
    pub fn export_curves_to(&mut self, path: &Path) {
        let bytes = table::csv(&self.state.session.runs);
        self.write(Write { path: path.to_owned(), make: Box::new(move || Ok(bytes)) });
    }

    /// Writes the convergence plot, as it is shown, as a PNG.
    pub fn export_plot_to(&mut self, path: &Path) {
        let name = self.state.session.take.as_ref().map_or("", |take| take.name.as_str());
        let title = format!("{name}, frame {}", self.state.selection.frame);
        let figure = picture::figure(&self.state.session.runs, self.state.preferences.curves, &title);
        let theme = self.state.preferences.theme;
        self.write(Write { path: path.to_owned(), make: Box::new(move || figure.png(theme)) });
    }
}
