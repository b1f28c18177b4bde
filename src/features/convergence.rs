//! Runs of the fit: their curves over their steps, one by one, and as files.

use std::path::Path;

use backlit_document::run::Run;
use backlit_document::runs::{BROUGHT_BACK, RunChange};
use backlit_formats::Footage;
use backlit_ui::style::theme::Theme;
use egui::Ui;
pub(crate) use quantity::{CurvePoint, Quantity, points};
use serde::{Deserialize, Serialize};

use self::picture::PlotFile;
use crate::context::command::{Command, ConvergenceCommand};
use crate::context::feature::Feature;
use crate::context::file_dialog::{DialogKind, FileDialogs};
use crate::context::pane::Pane;
use crate::context::unavailable::{Why, because};
use crate::context::{Context, FeatureRequest, Requests, SessionRequest};

mod panel;
mod picture;
mod plot;
pub(crate) mod quantity;
mod runs;
mod steps;

/// What curves are written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurvesFile {
    /// Every step of all runs.
    Table,
    /// The plot as it is shown.
    Plot,
}

/// The feature.
#[derive(Debug, Default)]
pub struct Convergence {
    /// What is chosen, kept from start to start.
    pub(crate) preferences: ConvergencePreferences,
    /// The name that is being typed: of which run, and the text so far.
    typing: Option<(usize, String)>,
    dialogs: FileDialogs<CurvesFile>,
}

/// The choices above the plot. They are kept from start to start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ConvergencePreferences {
    pub(crate) quantity: Quantity,
    pub(crate) is_log: bool,
    pub(crate) rejected: bool,
    /// Whether the plot's file has light colours whatever the window has.
    pub(crate) exports_light: bool,
}

impl Default for ConvergencePreferences {
    fn default() -> Self {
        Self { quantity: Quantity::Percent, is_log: true, rejected: true, exports_light: true }
    }
}

impl Feature for Convergence {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for (file, path) in self.dialogs.answers() {
            self.write(file, &path, context, requests);
        }
    }

    fn run(&mut self, command: Command, context: &Context<'_>, requests: &mut Requests) -> bool {
        let Command::Convergence(command) = command else { return false };
        match command {
            ConvergenceCommand::ClearRuns => clear(context, requests),
            ConvergenceCommand::RestoreRuns => {
                requests.request(SessionRequest::Runs(RunChange::Restore));
                requests.status(BROUGHT_BACK);
            }
            ConvergenceCommand::ExportCurves => self.ask_for_file(CurvesFile::Table, context, requests),
            ConvergenceCommand::ExportPlot => self.ask_for_file(CurvesFile::Plot, context, requests),
        }
        true
    }

    fn unavailable(&self, command: Command, context: &Context<'_>) -> Why {
        let Command::Convergence(command) = command else { return None };
        match command {
            ConvergenceCommand::RestoreRuns => {
                because(!context.history.has_removed_runs(), "No run was removed")
            }
            ConvergenceCommand::ClearRuns
            | ConvergenceCommand::ExportCurves
            | ConvergenceCommand::ExportPlot => because(context.runs().all().is_empty(), "There are no runs"),
        }
    }

    fn fills(&self) -> Option<Pane> {
        Some(Pane::Convergence)
    }

    fn pane(&mut self, ui: &mut Ui, context: &Context<'_>, siblings: &[Pane], requests: &mut Requests) {
        self.show(ui, context, siblings, requests);
    }

    fn reset(&mut self, _: &Footage) {
        *self = Self { preferences: self.preferences, ..Self::default() };
    }

    fn at_rest(&self) -> Self {
        Self { preferences: self.preferences, typing: self.typing.clone(), ..Self::default() }
    }
}

impl Convergence {
    fn ask_for_file(&self, file: CurvesFile, context: &Context<'_>, requests: &mut Requests) {
        let (title, name, endings): (_, _, &[&str]) = match file {
            CurvesFile::Table => ("Export curves", "curves.csv", &["csv"]),
            CurvesFile::Plot => ("Export plot", "plot.png", &["png", "svg"]),
        };
        let wanted = DialogKind::NewFile(format!("{} {name}", context.take_name()), endings);
        self.dialogs.ask(context.egui, file, (title, wanted), |why| requests.complain(why));
    }

    /// Writes curves to a file.
    pub fn write(&self, file: CurvesFile, path: &Path, context: &Context<'_>, requests: &mut Requests) {
        let runs = context.runs().all();
        match file {
            CurvesFile::Table => {
                let bytes = picture::csv(runs);
                requests.write(path, move || Ok(bytes));
            }
            CurvesFile::Plot => {
                let name = context.session.take.as_ref().map_or("", |take| take.take().name());
                let title = format!("{name}, frame {}", context.selection.frame);
                let runs: Vec<Run> = runs.iter().filter(|run| run.is_shown).cloned().collect();
                let preferences = self.preferences;
                let theme = if preferences.exports_light { Theme::Light } else { context.preferences.theme };
                let is_svg = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
                let plot = PlotFile { runs, preferences, title, theme };
                requests.write(path, move || if is_svg { Ok(plot.svg()) } else { Ok(plot.png()?) });
            }
        }
    }
}

/// Removes a run. One that is going on is stopped.
fn remove(run: &Run, context: &Context<'_>, requests: &mut Requests) {
    if context.busy.fitted_run == Some(run.number) {
        requests.request(FeatureRequest::InterruptFit);
    }
    requests.request(SessionRequest::Runs(RunChange::Remove(run.number)));
    inform(format!("Removed the run {}.", run.name), requests);
}

fn clear(context: &Context<'_>, requests: &mut Requests) {
    let count = context.runs().all().len();
    requests.request(FeatureRequest::InterruptFit);
    requests.request(SessionRequest::Runs(RunChange::Clear));
    let text = if count == 1 { "Removed the run.".to_owned() } else { format!("Removed {count} runs.") };
    inform(text, requests);
}

fn inform(text: String, requests: &mut Requests) {
    requests.inform(text, Some(Command::Convergence(ConvergenceCommand::RestoreRuns)));
}
