//! Takes, projects, dialogs, and the copy of unsaved work.

use std::path::{Path, PathBuf};

use super::App;
use super::state::{DialogKind, Opening, Overlay};
use crate::document::TakeSource;
use crate::project::{read_project, write_project};
use crate::worker::{Lane, OpenJob, SaveJob};

/// Ending of project files.
const PROJECT_EXTENSION: &str = "backlit";
/// The copy of unsaved work is written this often, in seconds.
const AUTOSAVE_SECONDS: f64 = 10.0;
/// The copy's name in the data folder.
const AUTOSAVE_NAME: &str = "unsaved.backlit";

impl App {
    /// Opens a take or a project. What is not saved is kept as a copy.
    pub(super) fn open(&mut self, opening: Opening) {
        self.keep_unsaved_work();
        let job = match opening {
            Opening::Take(source) => OpenJob::Take(source),
            Opening::Ready(take) => OpenJob::Ready(take),
            Opening::Project(path) => OpenJob::Project(path),
        };
        self.worker.request(Lane::Open, job);
    }

    /// Opens whatever a path is: a project file, a take's folder, or its take file.
    pub fn open_path(&mut self, path: &Path) {
        self.open(opening_of(path));
    }

    /// Writes the project to a file.
    pub fn save_to(&mut self, path: &Path) {
        self.worker.request(Lane::Save, self.save_job(path.to_owned(), false));
    }

    pub(super) fn save_project(&mut self) {
        match self.project.clone() {
            Some(path) => self.save_to(&path),
            None => self.ask_for_file(DialogKind::SaveAs),
        }
    }

    fn save_job(&self, path: PathBuf, is_autosave: bool) -> SaveJob {
        SaveJob { document: self.document().clone(), revision: self.history.revision(), path, is_autosave }
    }

    pub(super) fn saved(&mut self, path: PathBuf, revision: u64, is_autosave: bool) {
        if is_autosave {
            return;
        }
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        self.notices.info(self.now, format!("Saved to {name}."), None);
        self.history.mark_saved(revision);
        self.look.remember(path.clone());
        self.project = Some(path);
        if !self.history.is_dirty() {
            self.forget_unsaved_work();
        }
    }

    /// Asks for a file in a dialog of the desktop's, on a thread of its own.
    pub(super) fn ask_for_file(&mut self, kind: DialogKind) {
        let answers = self.dialog_sender.clone();
        let context = self.context.clone();
        let name = self.session.take.as_ref().map_or_else(|| "project".to_owned(), |take| take.name.clone());
        let export = match &self.overlay {
            Some(Overlay::Export(dialog)) => dialog.wanted_name(),
            _ => (false, String::new()),
        };
        let thread = std::thread::Builder::new().name("backlit file dialog".to_owned()).spawn(move || {
            let dialog = rfd::FileDialog::new();
            let path = match kind {
                DialogKind::Take => dialog.set_title("Open take").pick_folder(),
                DialogKind::Project => {
                    dialog.set_title("Open project").add_filter("Backlit", &[PROJECT_EXTENSION]).pick_file()
                }
                DialogKind::Export if export.0 => dialog.set_title("Export to folder").pick_folder(),
                DialogKind::Export => dialog.set_title("Export").set_file_name(&export.1).save_file(),
                DialogKind::SaveAs => {
                    let name = format!("{name}.{PROJECT_EXTENSION}");
                    dialog.set_title("Save project").set_file_name(name).save_file()
                }
                DialogKind::Curves => export_dialog(dialog, "Export curves", &name, "csv"),
                DialogKind::Plot => export_dialog(dialog, "Export plot", &name, "png"),
                DialogKind::LaboratoryPlot => {
                    dialog.set_title("Save plot").set_file_name("laboratory.png").save_file()
                }
                DialogKind::Basin(kind) => export_dialog(dialog, "Export basin", &name, kind.extension()),
            };
            if let Some(path) = path {
                // The window may be gone by now.
                let _ = answers.send((kind, path));
                context.request_repaint();
            }
        });
        if let Err(error) = thread {
            self.notices
                .error(format!("No file dialog can be shown: {error}. Drop the file on the window instead."));
        }
    }

    pub(super) fn hear_dialogs(&mut self) {
        while let Ok((kind, path)) = self.dialog_answers.try_recv() {
            match kind {
                DialogKind::Take | DialogKind::Project => self.open_path(&path),
                DialogKind::Export => {
                    if let Some(Overlay::Export(dialog)) = &mut self.overlay {
                        dialog.set_path(&path);
                    }
                }
                DialogKind::SaveAs => {
                    let path = if path.extension().is_none() {
                        path.with_extension(PROJECT_EXTENSION)
                    } else {
                        path
                    };
                    self.save_to(&path);
                }
                DialogKind::Curves => self.export_curves_to(&path),
                DialogKind::Plot => self.export_plot_to(&path),
                DialogKind::LaboratoryPlot => self.save_laboratory_plot(&path),
                DialogKind::Basin(kind) => self.export_basin_to(kind, &path),
            }
        }
    }

    fn autosave_path(&self) -> Option<PathBuf> {
        Some(self.data_folder.as_ref()?.join(AUTOSAVE_NAME))
    }

    /// Writes the copy of unsaved work from time to time.
    pub(super) fn autosave(&mut self) {
        let Some(path) = self.autosave_path() else { return };
        let revision = self.history.revision();
        let is_due =
            self.autosaved.is_none_or(|(saved, at)| saved != revision && self.now - at >= AUTOSAVE_SECONDS);
        let can_save = self.document().take.is_some() && self.history.is_dirty();
        if is_due && can_save && !self.worker.is_busy(Lane::Save) {
            self.autosaved = Some((revision, self.now));
            self.worker.request(Lane::Save, self.save_job(path, true));
        }
    }

    /// Writes the copy at once, when the window closes or another take is opened.
    pub(super) fn keep_unsaved_work(&mut self) {
        if let Some(path) = self.autosave_path()
            && self.history.is_dirty()
            && self.document().take.is_some()
            && let Err(error) = write_project(&path, self.document())
        {
            self.notices.error(format!("The copy of unsaved work was not written: {error}."));
        }
    }

    fn forget_unsaved_work(&self) {
        if let Some(path) = self.autosave_path() {
            // There may be none.
            let _ = std::fs::remove_file(path);
        }
    }

    /// Whether an earlier start has left unsaved work.
    pub(super) fn look_for_unsaved_work(&mut self) {
        let Some(path) = self.autosave_path().filter(|path| path.is_file()) else { return };
        match read_project(&path) {
            Ok(document) => {
                let place = match &document.take {
                    Some(TakeSource::Path(path)) => {
                        path.file_name().map_or_else(|| "a take".into(), |n| n.to_string_lossy().into_owned())
                    }
                    Some(TakeSource::Demonstration(which)) => {
                        format!("the demonstration \"{}\"", which.name())
                    }
                    _ => "the built-in take".to_owned(),
                };
                let frames = document.estimates.len() + document.keys.len();
                let text = format!("There is unsaved work on {place}, with {frames} poses.");
                self.recovery = Some(text);
            }
            Err(error) => self.notices.error(format!("The copy of unsaved work cannot be read: {error}.")),
        }
    }

    /// Takes the unsaved work of an earlier start, or forgets it and opens what was to be opened.
    pub(super) fn recover(&mut self, take_it: bool) {
        self.recovery = None;
        match self.autosave_path().filter(|_| take_it) {
            Some(path) => self.open(Opening::Project(path)),
            None => {
                self.forget_unsaved_work();
                if let Some(opening) = self.postponed.take() {
                    self.open(opening);
                }
            }
        }
    }

    /// Whether a path is that of the copy of unsaved work, which is nobody's project.
    pub(super) fn is_autosave(&self, path: &Path) -> bool {
        self.autosave_path().is_some_and(|autosave| autosave == path)
    }
}

/// Asks where something is to be written; the name that is offered is the take's.
fn export_dialog(dialog: rfd::FileDialog, title: &str, name: &str, extension: &str) -> Option<PathBuf> {
    let dialog = dialog.set_title(title).add_filter(extension.to_uppercase(), &[extension]);
    dialog.set_file_name(format!("{name} {}.{extension}", title.trim_start_matches("Export "))).save_file()
}

/// What a path is to be opened as.
#[must_use]
pub fn opening_of(path: &Path) -> Opening {
    if path.extension().is_some_and(|extension| extension == PROJECT_EXTENSION) {
        Opening::Project(path.to_owned())
    } else {
        Opening::Take(TakeSource::Path(path.to_owned()))
    }
}
