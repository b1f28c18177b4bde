//! A take made of footage and a calibration: what lies in a folder, what is missing, and the take file that says so. `card` is
//! the card on which a take is put together.

mod card;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::images;
use backlit_formats::import::{self, ImportOptions, ImportStep, ImportSurvey, WriteOptions};
use backlit_jobs::{Outbox, Task, once, one_step};
use egui::{ColorImage, Ui};

use crate::context::feature::Feature;
use crate::context::file_dialog::{DialogKind, FileDialogs};
use crate::context::{Context, DesktopRequest, FeatureCard, Requests, ShellRequest, priority};

#[derive(Debug, Default)]
pub(crate) struct NewTake {
    /// Where the footage lies: folders, or files.
    paths: Vec<PathBuf>,
    options: ImportOptions,
    /// The frame rate as it is typed.
    rate: String,
    out: String,
    stage: ImportStage,
    survey: Task<(Vec<PathBuf>, ImportOptions), Result<SurveyedFolders, String>, { priority::OPEN }>,
    write: Task<(), WriteMessage, { priority::EXPORT }>,
    dialogs: FileDialogs<ImportPath>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ImportPath {
    Footage,
    Calibration,
    Out,
}

/// How far it is.
#[derive(Debug, Default)]
enum ImportStage {
    /// Nothing is chosen yet.
    #[default]
    Empty,
    Looking,
    Found(Box<SurveyedFolders>),
    /// It cannot be used; why not.
    Unusable(String),
    /// The take is being written; what is done just now.
    Writing(Box<SurveyedFolders>, String),
}

/// Height of the pictures on the card, pixels.
const PICTURE_HEIGHT: usize = 96;

/// What was found, with a picture of each camera.
#[derive(Debug, Clone)]
struct SurveyedFolders {
    found: Arc<ImportSurvey>,
    /// By camera; `None` where the first picture cannot be read.
    pictures: Vec<Option<Arc<ColorImage>>>,
}

/// Looks through folders. Errors: why no take can be made, in a sentence.
fn survey_folders(paths: &[PathBuf], options: &ImportOptions) -> Result<SurveyedFolders, String> {
    let found = import::survey(paths, options).map_err(|error| error.to_string())?;
    let picture = |camera: &import::ImportCamera| {
        let picture = camera.pictures.picture(found.first).ok()?;
        let divisor = (picture.height() as usize / PICTURE_HEIGHT).max(1);
        let small = images::reduced(picture, divisor);
        let size = [small.width() as usize, small.height() as usize];
        Some(Arc::new(ColorImage::from_rgb(size, small.as_raw())))
    };
    let pictures = found.cameras.iter().map(picture).collect();
    Ok(SurveyedFolders { found: Arc::new(found), pictures })
}

/// What is heard of the writing.
#[derive(Debug)]
enum WriteMessage {
    Step(String),
    /// Something that was done and is to be known.
    Said(String),
    Done(PathBuf),
    Failed(String),
}

fn write(found: &ImportSurvey, folder: &Path, out: &Outbox<WriteMessage>) {
    let mut say = |step: ImportStep| match step {
        ImportStep::Learning { camera } => {
            out.send(WriteMessage::Step(format!("Learning the background of {camera}")));
        }
        ImportStep::Adjusted { median_px: [before, after] } => out.send(WriteMessage::Said(format!(
            "The cameras were adjusted: keypoints were {before:.1} px off, now {after:.1} px. The take \
             keeps both calibrations."
        ))),
        ImportStep::Measuring | ImportStep::Learnt { .. } => {}
    };
    let written = import::write(found, folder, WriteOptions::default(), out.cancel(), &mut say);
    out.send(match written {
        Ok(file) => WriteMessage::Done(file),
        Err(error) => WriteMessage::Failed(error.to_string()),
    });
}

/// Endings of calibrations, for the dialog.
const CALIBRATIONS: &[&str] = &["toml", "json", "yml", "yaml", "xml", "xcp", "txt", "pickle"];

impl Feature for NewTake {
    fn update(&mut self, context: &Context<'_>, requests: &mut Requests) {
        for (asked, path) in self.dialogs.answers() {
            match asked {
                ImportPath::Footage => self.look_at(vec![path], context),
                ImportPath::Calibration => {
                    self.options.calibration = Some(path);
                    self.look_at(self.paths.clone(), context);
                }
                ImportPath::Out => self.out = path.display().to_string(),
            }
        }
        for looked in requests.outputs("Looking through the folder", &mut self.survey) {
            match looked {
                Ok(looked) => {
                    if self.out.is_empty() {
                        self.out = free_folder(&self.paths);
                    }
                    self.rate = looked.found.frame_rate.map_or_else(String::new, |rate| format!("{rate:.3}"));
                    self.stage = ImportStage::Found(Box::new(looked));
                }
                Err(why) => self.stage = ImportStage::Unusable(why),
            }
        }
        if self.survey.failure().is_some() && matches!(self.stage, ImportStage::Looking) {
            self.stage = ImportStage::Empty;
        }
        for written in requests.outputs("Writing the take", &mut self.write) {
            match written {
                WriteMessage::Step(text) => {
                    if let ImportStage::Writing(_, said) = &mut self.stage {
                        *said = text;
                    }
                }
                WriteMessage::Said(text) => requests.inform(text, None),
                WriteMessage::Done(file) => {
                    *self = Self::default();
                    requests.request(ShellRequest::CloseCard);
                    requests.request(DesktopRequest::OpenPath(file.parent().unwrap_or(&file).to_owned()));
                    return;
                }
                WriteMessage::Failed(why) => {
                    requests.complain(format!("The take was not written: {why}."));
                    self.back_to_found();
                }
            }
        }
        if self.write.failure().is_some() {
            self.back_to_found();
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
    fn look_at(&mut self, paths: Vec<PathBuf>, context: &Context<'_>) {
        if paths != self.paths {
            self.out.clear();
        }
        self.paths = paths;
        self.stage = ImportStage::Looking;
        let inputs = (self.paths.clone(), self.options.clone());
        self.survey.begin(context.pool, inputs, |(paths, options)| {
            let (paths, options) = (paths.clone(), options.clone());
            once(move |_| survey_folders(&paths, &options))
        });
    }

    fn ask(&self, asked: ImportPath, context: &Context<'_>, requests: &mut Requests) {
        let dialog = match asked {
            ImportPath::Footage => ("Folder with the footage", DialogKind::Folder),
            ImportPath::Calibration => ("Calibration", DialogKind::File(CALIBRATIONS)),
            ImportPath::Out => ("Folder of the take", DialogKind::Folder),
        };
        self.dialogs.ask(context.egui, asked, dialog, |why| requests.complain(why));
    }

    fn create(&mut self, context: &Context<'_>) {
        let ImportStage::Found(looked) = std::mem::take(&mut self.stage) else { return };
        let (found, folder) = (looked.found.clone(), PathBuf::from(self.out.trim()));
        self.stage = ImportStage::Writing(looked, "Writing the take".to_owned());
        self.write.begin(context.pool, (), |()| one_step(move |out: &Outbox<_>| write(&found, &folder, out)));
    }

    fn back_to_found(&mut self) {
        self.stage = match std::mem::take(&mut self.stage) {
            ImportStage::Writing(looked, _) => ImportStage::Found(looked),
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
