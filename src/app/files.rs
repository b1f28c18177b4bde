//! Takes, projects and dialogs.

use std::path::{Path, PathBuf};

use super::App;
use super::state::{DialogKind, Opening};
use crate::app::open_job::{OpenJob, Opened};
use crate::context::command::{Command, FileCommand};
use crate::context::write_advice::remedy;
use crate::document::project::write_project;
use crate::jobs::{News, once};
use crate::take::source::TakeSource;

/// Ending of project files.
const PROJECT_EXTENSION: &str = "backlit";

impl App {
    /// Opens a take or a project. What is not saved is kept as a copy.
    pub(crate) fn open(&mut self, opening: Opening) {
        let may_leave = self.with(
            |features| &mut features.recovery,
            |recovery, context, requests| recovery.may_leave("Not opened", "open it", context, requests),
        );
        self.inspector.state.is_opening = may_leave;
        if !may_leave {
            return;
        }
        let job = match opening {
            Opening::Take(source) => OpenJob::Take(source),
            Opening::Ready(take) => OpenJob::Ready(take),
            Opening::Project(path) => OpenJob::Project(path),
            Opening::Moved { project, take } => OpenJob::Moved { project, take },
        };
        self.files.open.begin(&self.inspector.state.pool, (), |()| once(move |_| job.open()));
    }

    pub(crate) fn file_command(&mut self, command: FileCommand) {
        match command {
            FileCommand::OpenTake => self.ask_for_file(DialogKind::Take),
            FileCommand::OpenBuiltIn => self.open(Opening::Take(TakeSource::BuiltIn)),
            FileCommand::OpenProject => self.ask_for_file(DialogKind::Project),
            FileCommand::FindTake => self.ask_for_file(DialogKind::FindTake),
            FileCommand::Save => self.save_project(),
            FileCommand::SaveAs => self.ask_for_file(DialogKind::SaveAs),
            FileCommand::Quit => self.inspector.state.egui.send_viewport_cmd(egui::ViewportCommand::Close),
        }
    }

    /// Says that a project's take is not where it was, and offers to look for it.
    fn take_missing(&mut self, project: PathBuf, why: &str) {
        let said = format!("{why}. If it has moved, say where it is now.");
        self.inspector.state.notices.error_with(said, Command::File(FileCommand::FindTake));
        self.inspector.state.lost_take = Some(project);
    }

    /// Opens the project whose take was not there with the take in this folder.
    pub fn find_take(&mut self, take: &Path) {
        if let Some(project) = self.inspector.state.lost_take.clone() {
            self.open(Opening::Moved { project, take: take.to_owned() });
        }
    }

    /// Opens whatever a path is: a project file, a take's folder, or its take file.
    pub fn open_path(&mut self, path: &Path) {
        self.open(opening_of(path));
    }

    /// Writes the project to a file.
    pub fn save_to(&mut self, path: &Path) {
        let (document, revision) = (self.document().clone(), self.inspector.state.history.revision());
        let file = path.to_owned();
        self.files.save.begin(&self.inspector.state.pool, file.clone(), |_| {
            once(move |_| write_project(&file, &document).map(|()| revision))
        });
    }

    pub(crate) fn save_project(&mut self) {
        match self.inspector.state.project.clone() {
            Some(path) => self.save_to(&path),
            None => self.ask_for_file(DialogKind::SaveAs),
        }
    }

    /// Takes in what was opened and saved.
    pub(crate) fn take_in_files(&mut self) {
        for news in self.files.open.poll() {
            match news {
                News::Output(Opened::Take(footage, project)) => {
                    self.files.take_in.forget();
                    self.take_opened(&footage, project);
                }
                News::Output(Opened::TakeMissing { project, why }) => self.take_missing(project, &why),
                News::Output(Opened::Nothing(why)) => self.inspector.state.notices.error(why),
                News::Ended => {}
                News::Failed(failure) => self.failed("Opening the take", &failure),
            }
        }
        self.inspector.state.is_opening = self.files.open.is_busy();
        for news in self.files.save.poll() {
            let path = self.files.save.inputs().cloned().unwrap_or_default();
            match news {
                News::Output(Ok(revision)) => self.saved(path, revision),
                News::Output(Err(error)) => {
                    let said = format!(
                        "Not saved: {error}. Your work is still here, and the file is as it was. {}",
                        remedy(&error)
                    );
                    self.inspector.state.notices.error_with(said, Command::File(FileCommand::SaveAs));
                }
                News::Ended => {}
                News::Failed(failure) => self.failed("Writing a file", &failure),
            }
        }
    }

    fn saved(&mut self, path: PathBuf, revision: u64) {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        self.inspector.state.notices.info(self.inspector.state.now, format!("Saved to {name}."), None);
        self.inspector.state.history.mark_saved(revision);
        self.inspector.state.preferences.remember(path.clone());
        self.inspector.state.project = Some(path);
    }

    /// Asks for a file in a dialog of the desktop's, on a thread of its own.
    pub(crate) fn ask_for_file(&mut self, kind: DialogKind) {
        let answers = self.files.dialog_sender.clone();
        let context = self.inspector.state.egui.clone();
        let name = self
            .inspector
            .state
            .session
            .take
            .as_ref()
            .map_or_else(|| "project".to_owned(), |take| take.name.clone());
        let thread = std::thread::Builder::new().name("backlit file dialog".to_owned()).spawn(move || {
            let dialog = rfd::FileDialog::new();
            let path = match kind {
                DialogKind::Take => dialog.set_title("Open take").pick_folder(),
                DialogKind::FindTake => dialog.set_title("Find take").pick_folder(),
                DialogKind::Project => {
                    dialog.set_title("Open project").add_filter("Backlit", &[PROJECT_EXTENSION]).pick_file()
                }
                DialogKind::SaveAs => {
                    let name = format!("{name}.{PROJECT_EXTENSION}");
                    dialog.set_title("Save project").set_file_name(name).save_file()
                }
                DialogKind::Curves => export_dialog(dialog, "Export curves", &name, "csv"),
                DialogKind::Plot => export_dialog(dialog, "Export plot", &name, "png"),
            };
            if let Some(path) = path {
                // The window may be gone by now.
                let _ = answers.send((kind, path));
                context.request_repaint();
            }
        });
        if let Err(error) = thread {
            self.inspector
                .state
                .notices
                .error(format!("No file dialog can be shown: {error}. Drop the file on the window instead."));
        }
    }

    pub(crate) fn hear_dialogs(&mut self) {
        while let Ok((kind, path)) = self.files.dialog_answers.try_recv() {
            match kind {
                DialogKind::Take | DialogKind::Project => self.open_path(&path),
                DialogKind::FindTake => self.find_take(&path),
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
            }
        }
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
    // A project remembers its take, and is opened from elsewhere another day.
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    if path.extension().is_some_and(|extension| extension == PROJECT_EXTENSION) {
        Opening::Project(path)
    } else {
        Opening::Take(TakeSource::Path(path))
    }
}
