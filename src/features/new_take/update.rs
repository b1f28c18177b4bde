//! Asked for, found, written, opened.

use egui::Ui;
use std::path::{Path, PathBuf};

use backlit_jobs::{News, once};

use super::job::{self, WriteJob, Written};
use super::{Asked, NewTake, State};
use crate::context::feature::Feature;
use crate::context::file_dialog::DialogKind;
use crate::context::{Context, DesktopRequest, FeatureCard, Requests, ShellRequest};

/// Endings of calibrations, for the dialog.
const CALIBRATIONS: &[&str] = &["toml", "json", "yml", "yaml", "xml", "xcp", "txt", "pickle"];

impl Feature for NewTake {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for (asked, path) in self.dialogs.answers() {
            match asked {
                Asked::Footage => self.look_at(vec![path], context),
                Asked::Calibration => {
                    self.options.calibration = Some(path);
                    self.look_at(self.paths.clone(), context);
                }
                Asked::Out => self.out = path.display().to_string(),
            }
        }
        for news in self.look.poll() {
            match news {
                News::Output(Ok(looked)) => {
                    if self.out.is_empty() {
                        self.out = free_folder(&self.paths);
                    }
                    self.rate = looked.found.frame_rate.map_or_else(String::new, |rate| format!("{rate:.3}"));
                    self.state = State::Found(Box::new(looked));
                }
                News::Output(Err(why)) => self.state = State::Unusable(why),
                News::Ended => {}
                News::Failed(failure) => {
                    requests.failed("Looking through the folder", &failure);
                    self.state = State::Empty;
                }
            }
        }
        for news in self.write.poll() {
            match news {
                News::Output(Written::Step(text)) => {
                    if let State::Writing(_, said) = &mut self.state {
                        *said = text;
                    }
                }
                News::Output(Written::Said(text)) => requests.inform(text, None),
                News::Output(Written::Done(file)) => {
                    *self = Self::default();
                    requests.request(ShellRequest::CloseCard);
                    requests.request(DesktopRequest::OpenPath(file.parent().unwrap_or(&file).to_owned()));
                    return;
                }
                News::Output(Written::Failed(why)) => {
                    requests.complain(format!("The take was not written: {why}."));
                    self.back_to_found();
                }
                News::Ended => {}
                News::Failed(failure) => {
                    requests.failed("Writing the take", &failure);
                    self.back_to_found();
                }
            }
        }
    }

    fn card(&mut self, ui: &Ui, context: &Context<'_>, requests: &mut Requests) -> bool {
        self.show(ui, context, requests)
    }
}

impl NewTake {
    /// Lays the card over the window; folders or files that are named are looked at at once.
    pub(crate) fn open(&mut self, paths: Vec<PathBuf>, context: &Context<'_>, requests: &mut Requests) {
        requests.request(ShellRequest::OpenCard(FeatureCard::NewTake));
        if !paths.is_empty() {
            *self = Self::default();
            self.look_at(paths, context);
        }
    }

    /// Looks at what was chosen, again if it was changed.
    pub(super) fn look_at(&mut self, paths: Vec<PathBuf>, context: &Context<'_>) {
        if paths != self.paths {
            self.out.clear();
        }
        self.paths = paths;
        self.state = State::Looking;
        let inputs = (self.paths.clone(), self.options.clone());
        self.look.begin(context.pool, inputs, |(paths, options)| {
            let (paths, options) = (paths.clone(), options.clone());
            once(move |_| job::look(&paths, &options))
        });
    }

    pub(super) fn ask(&self, asked: Asked, context: &Context<'_>, requests: &mut Requests) {
        let (title, wanted) = match asked {
            Asked::Footage => ("Folder with the footage", DialogKind::Folder),
            Asked::Calibration => ("Calibration", DialogKind::File(CALIBRATIONS)),
            Asked::Out => ("Folder of the take", DialogKind::Folder),
        };
        if let Err(why) = self.dialogs.ask(context.egui, asked, title, wanted) {
            requests.complain(why.to_string());
        }
    }

    /// Writes the take that was put together.
    pub(super) fn create(&mut self, context: &Context<'_>) {
        let State::Found(looked) = std::mem::take(&mut self.state) else { return };
        let job = WriteJob { found: looked.found.clone(), out: PathBuf::from(self.out.trim()) };
        self.state = State::Writing(looked, "Writing the take".to_owned());
        self.write.begin(context.pool, (), |()| job);
    }

    pub(super) fn stop(&self) {
        self.write.stop();
    }

    fn back_to_found(&mut self) {
        self.state = match std::mem::take(&mut self.state) {
            State::Writing(looked, _) => State::Found(looked),
            other => other,
        };
    }
}

/// A folder beside the footage that is not there yet.
fn free_folder(paths: &[PathBuf]) -> String {
    let first = paths.first().map_or(Path::new(""), PathBuf::as_path);
    let beside = if first.is_dir() { first.parent() } else { first.parent().and_then(Path::parent) };
    let name = if first.is_dir() { first } else { first.parent().unwrap_or(first) };
    let name = name.file_name().map_or_else(|| "take".to_owned(), |name| name.to_string_lossy().into_owned());
    let beside = beside.unwrap_or(Path::new(""));
    let candidate = |number: usize| match number {
        0 => beside.join(format!("{name} take")),
        _ => beside.join(format!("{name} take {}", number + 1)),
    };
    let free = (0..100).map(candidate).find(|folder| !folder.exists());
    free.unwrap_or_else(|| candidate(0)).display().to_string()
}
