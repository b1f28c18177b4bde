//! Takes, projects and other files: asked for, read and written.

use std::path::{Path, PathBuf};
use std::process::{Command as Process, Stdio};

use anyhow::anyhow;
use backlit_document::edit::Edit;
use backlit_document::history::Version;
use backlit_document::project::{ProjectError, write_project};
use backlit_formats::atomic;
use backlit_jobs::{Outbox, Task, once, one_step};
use backlit_take::motion;
use backlit_take::source::TakeSource;
use backlit_ui::style::format;

use super::Inspector;
use super::open_job::{Opened, Opening};
use super::state::State;
use crate::context::command::{Command, FileCommand};
use crate::context::file_dialog::{DialogKind, FileDialogs};
use crate::context::write_advice::write_advice;
use crate::context::{Write, priority};

const PROJECT_EXTENSION: &str = "backlit";

/// The program that opens anything with the program that the user likes for it.
const OPENER: &str = if cfg!(target_os = "macos") {
    "open"
} else if cfg!(target_os = "windows") {
    "explorer"
} else {
    "xdg-open"
};

/// What a file dialog was asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FilePurpose {
    Take,
    Motion,
    FindTake,
    Project,
    SaveAs,
}

/// Files that are read and written, and the dialogs that ask for them.
#[derive(Debug, Default)]
pub(crate) struct Files {
    pub(crate) open: Task<(), Opened, { priority::OPEN }>,
    pub(crate) save: Task<PathBuf, Result<Version, ProjectError>, { priority::SAVE }>,
    pub(super) dropped: Task<(), anyhow::Result<(Edit, String)>, { priority::TAKE_IN }>,
    /// Tables, plots, numbers. They are written one after the other.
    writes: Vec<Task<PathBuf, anyhow::Result<()>, { priority::WRITE }>>,
    /// Names of files that were written while others still were.
    written: Vec<String>,
    dialogs: FileDialogs<FilePurpose>,
}

impl Files {
    pub(crate) fn open(&mut self, inspector: &mut Inspector, opening: Opening) {
        let may_leave = inspector.ask(|features, context, requests| {
            features.recovery.may_leave("Not opened", "open it", context, requests)
        });
        inspector.state.is_opening = may_leave;
        if may_leave {
            let job = move |out: &Outbox<Opened>| {
                let opened = opening.read(|share| out.send(Opened::Drawn(share)));
                out.send(opened);
            };
            self.open.begin(&inspector.state.pool, (), |()| one_step(job));
        }
    }

    pub(crate) fn find_take(&mut self, inspector: &mut Inspector, take: &Path) {
        if let Some(project) = inspector.state.lost_take.clone() {
            self.open(inspector, Opening::Moved { project, take: take.to_owned() });
        }
    }

    pub(crate) fn command(&mut self, inspector: &mut Inspector, command: FileCommand) {
        match command {
            FileCommand::NewTake => inspector.new_take(Vec::new()),
            FileCommand::OpenTake => self.ask(&mut inspector.state, FilePurpose::Take),
            FileCommand::OpenMotion => self.ask(&mut inspector.state, FilePurpose::Motion),
            FileCommand::OpenBuiltIn => self.open(inspector, Opening::Take(TakeSource::BuiltIn)),
            FileCommand::OpenProject => self.ask(&mut inspector.state, FilePurpose::Project),
            FileCommand::FindTake => self.ask(&mut inspector.state, FilePurpose::FindTake),
            FileCommand::SaveAs => self.ask(&mut inspector.state, FilePurpose::SaveAs),
            FileCommand::Save => match inspector.state.project.clone() {
                Some(path) => self.save_to(&inspector.state, &path),
                None => self.ask(&mut inspector.state, FilePurpose::SaveAs),
            },
            FileCommand::Quit => inspector.state.egui.send_viewport_cmd(egui::ViewportCommand::Close),
        }
    }

    pub(crate) fn save_to(&mut self, state: &State, path: &Path) {
        let history = &state.history;
        let (document, runs, version) =
            (history.document().clone(), history.runs().all().to_vec(), history.version());
        let file = path.to_owned();
        self.save.begin(&state.pool, file.clone(), |_| {
            once(move |_| write_project(&file, &document, &runs).map(|()| version))
        });
    }

    /// Writes a file that is made of results.
    pub(crate) fn write(&mut self, state: &State, write: Write) {
        let mut task = Task::default();
        let Write { path, make } = write;
        let file = path.clone();
        task.begin(&state.pool, path, |_| {
            once(move |_| match make() {
                Ok(bytes) => atomic::write(&file, &bytes)
                    .map_err(|error| anyhow!("Not written: {error}. {}", write_advice(&error))),
                Err(error) => Err(anyhow!("{} was not written: {error:#}.", file.display())),
            })
        });
        self.writes.push(task);
    }

    /// Asks for a file in a dialog of the desktop's.
    fn ask(&self, state: &mut State, asked: FilePurpose) {
        let take = state.session.take.as_ref();
        let name = take.map_or("project", |take| take.take().name());
        let dialog = match asked {
            FilePurpose::Take => ("Open take", DialogKind::Folder),
            FilePurpose::Motion => ("Play a motion", DialogKind::File(&motion::ENDINGS)),
            FilePurpose::FindTake => ("Find take", DialogKind::Folder),
            FilePurpose::Project => ("Open project", DialogKind::File(&[PROJECT_EXTENSION])),
            FilePurpose::SaveAs => {
                ("Save project", DialogKind::NewFile(format!("{name}.{PROJECT_EXTENSION}"), &[]))
            }
        };
        self.dialogs.ask(&state.egui, asked, dialog, |why| state.notices.error(why));
    }

    /// Goes on with what was opened, saved, written and chosen.
    pub(crate) fn take_in(&mut self, inspector: &mut Inspector) {
        self.take_in_opened(inspector);
        self.take_in_dropped(inspector);
        self.take_in_written(&mut inspector.state);
        for (asked, path) in self.dialogs.answers() {
            match asked {
                FilePurpose::Take | FilePurpose::Motion | FilePurpose::Project => {
                    self.open(inspector, Opening::of(&path));
                }
                FilePurpose::FindTake => self.find_take(inspector, &path),
                FilePurpose::SaveAs if path.extension().is_none() => {
                    self.save_to(&inspector.state, &path.with_extension(PROJECT_EXTENSION));
                }
                FilePurpose::SaveAs => self.save_to(&inspector.state, &path),
            }
        }
    }

    fn take_in_opened(&mut self, inspector: &mut Inspector) {
        let mut share = inspector.state.opened_share;
        for opened in inspector.state.notices.outputs("Opening the take", &mut self.open) {
            match opened {
                Opened::Drawn(drawn) => share = Some(drawn),
                Opened::Take(footage, source, project) => {
                    self.dropped.forget();
                    inspector.take_opened(&footage, source, project);
                }
                Opened::TakeMissing { project, why } => {
                    let said = format!("{why}. If it has moved, say where it is now.");
                    inspector.state.notices.error_with(said, Command::File(FileCommand::FindTake));
                    inspector.state.lost_take = Some(project);
                }
                Opened::Nothing(why) => inspector.state.notices.error(why),
            }
        }
        inspector.state.is_opening = self.open.is_busy();
        inspector.state.opened_share = share.filter(|_| inspector.state.is_opening);
    }

    fn take_in_written(&mut self, state: &mut State) {
        for saved in state.notices.outputs("Writing a file", &mut self.save) {
            let path = self.save.inputs().cloned().unwrap_or_default();
            match saved {
                Ok(version) => {
                    state.notices.info(format!("Saved to {}.", format::file_name(&path)), None);
                    state.history.mark_saved(version);
                    state.preferences.remember(path.clone());
                    state.project = Some(path);
                }
                Err(error) => {
                    let said = format!(
                        "Not saved: {error}. Your work is still here, and the file is as it was. {}",
                        write_advice(&error)
                    );
                    state.notices.error_with(said, Command::File(FileCommand::SaveAs));
                }
            }
        }
        for task in &mut self.writes {
            for written in state.notices.outputs("Writing a file", task) {
                match written {
                    Ok(()) => self.written.extend(task.inputs().map(|path| format::file_name(path))),
                    Err(said) => state.notices.error(said.to_string()),
                }
            }
        }
        self.writes.retain(Task::is_busy);
        if self.writes.is_empty() && !self.written.is_empty() {
            self.written.sort();
            state.notices.info(format!("Wrote {}.", self.written.join(", ")), None);
            self.written.clear();
        }
    }
}

impl Inspector {
    /// Lays the card of a new take over the window; folders or files that are named are looked at at once.
    pub fn new_take(&mut self, paths: Vec<PathBuf>) {
        self.ask(|features, context, requests| features.new_take.open(paths, context, requests));
    }
}

impl Opening {
    /// What a path is opened as.
    pub fn of(path: &Path) -> Self {
        // A project remembers its take, and is opened from elsewhere another day.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if path.extension().is_some_and(|extension| extension == PROJECT_EXTENSION) {
            Self::Project(path)
        } else {
            Self::Take(TakeSource::Path(path))
        }
    }
}

/// Opens a folder or a page in another program; where that cannot be done, the address goes to the clipboard.
pub(crate) fn open_outside(state: &mut State, address: String) {
    let child = Process::new(OPENER)
        .arg(&address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    match child {
        Ok(mut child) => {
            // Somebody has to hear that it has ended.
            let waits = std::thread::Builder::new().name("backlit opener".to_owned());
            let _ = waits.spawn(move || child.wait());
        }
        Err(_) => {
            state.egui.copy_text(address.clone());
            let text = format!("{OPENER} cannot be started; {address} is in the clipboard now.");
            state.notices.info(text, None);
        }
    }
}
