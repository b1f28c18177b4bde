//! Takes, projects and dialogs.

use std::path::{Path, PathBuf};

use backlit_document::history::Version;
use backlit_document::project::write_project;
use backlit_jobs::{News, once};
use backlit_take::source::TakeSource;

use super::App;
use super::state::{Asked, Opening};
use crate::app::open_job::{OpenJob, Opened};
use crate::context::command::{Command, FileCommand};
use crate::context::file_dialog::Wanted;
use crate::context::write_advice::write_advice;

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
            FileCommand::NewTake => self.new_take(Vec::new()),
            FileCommand::OpenTake => self.ask_for_file(Asked::Take),
            FileCommand::OpenBuiltIn => self.open(Opening::Take(TakeSource::BuiltIn)),
            FileCommand::OpenProject => self.ask_for_file(Asked::Project),
            FileCommand::FindTake => self.ask_for_file(Asked::FindTake),
            FileCommand::Save => self.save_project(),
            FileCommand::SaveAs => self.ask_for_file(Asked::SaveAs),
            FileCommand::Quit => self.inspector.state.egui.send_viewport_cmd(egui::ViewportCommand::Close),
        }
    }

    /// Lays the card of a new take over the window; folders or files that are named are looked at at once.
    pub fn new_take(&mut self, paths: Vec<PathBuf>) {
        self.with(
            |features| &mut features.new_take,
            |new_take, context, requests| new_take.open(paths, context, requests),
        );
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
        let history = &self.inspector.state.history;
        let (document, runs, version) =
            (history.document().clone(), history.runs().all().to_vec(), history.version());
        let file = path.to_owned();
        self.files.save.begin(&self.inspector.state.pool, file.clone(), |_| {
            once(move |_| write_project(&file, &document, &runs).map(|()| version))
        });
    }

    pub(crate) fn save_project(&mut self) {
        match self.inspector.state.project.clone() {
            Some(path) => self.save_to(&path),
            None => self.ask_for_file(Asked::SaveAs),
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
                News::Output(Ok(version)) => self.saved(path, version),
                News::Output(Err(error)) => {
                    let said = format!(
                        "Not saved: {error}. Your work is still here, and the file is as it was. {}",
                        write_advice(&error)
                    );
                    self.inspector.state.notices.error_with(said, Command::File(FileCommand::SaveAs));
                }
                News::Ended => {}
                News::Failed(failure) => self.failed("Writing a file", &failure),
            }
        }
    }

    fn saved(&mut self, path: PathBuf, version: Version) {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        self.inspector.state.notices.info(self.inspector.state.now, format!("Saved to {name}."), None);
        self.inspector.state.history.mark_saved(version);
        self.inspector.state.preferences.remember(path.clone());
        self.inspector.state.project = Some(path);
    }

    /// Asks for a file in a dialog of the desktop's.
    fn ask_for_file(&mut self, asked: Asked) {
        let state = &mut self.inspector.state;
        let take = state.session.take.as_ref();
        let name = take.map_or("project", |take| take.name.as_str());
        let (title, wanted) = match asked {
            Asked::Take => ("Open take", Wanted::Folder),
            Asked::FindTake => ("Find take", Wanted::Folder),
            Asked::Project => ("Open project", Wanted::File(&[PROJECT_EXTENSION])),
            Asked::SaveAs => ("Save project", Wanted::NewFile(format!("{name}.{PROJECT_EXTENSION}"), &[])),
        };
        if let Err(why) = self.files.dialogs.ask(&state.egui, asked, title, wanted) {
            state.notices.error(why.to_string());
        }
    }

    /// Goes on with the files that were chosen.
    pub(crate) fn take_in_chosen_files(&mut self) {
        for (asked, path) in self.files.dialogs.answers() {
            match asked {
                Asked::Take | Asked::Project => self.open_path(&path),
                Asked::FindTake => self.find_take(&path),
                Asked::SaveAs => {
                    let path = if path.extension().is_none() {
                        path.with_extension(PROJECT_EXTENSION)
                    } else {
                        path
                    };
                    self.save_to(&path);
                }
            }
        }
    }
}

/// What a path is to be opened as.
pub fn opening_of(path: &Path) -> Opening {
    // A project remembers its take, and is opened from elsewhere another day.
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    if path.extension().is_some_and(|extension| extension == PROJECT_EXTENSION) {
        Opening::Project(path)
    } else {
        Opening::Take(TakeSource::Path(path))
    }
}
