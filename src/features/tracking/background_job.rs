//! Plates learnt again from the footage without the tracked body: one camera a step.

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_document::edit::Edit;
use backlit_formats::Footage;
use backlit_formats::plate::{self, PlateError, plate_without_body};
use backlit_jobs::{Job, Outbox, Turn};
use backlit_tracking::body::{Model, Pose};
use backlit_ui::style::format;

use super::{Applied, applied, progress, refused};
use crate::context::Context;
use crate::context::activity::WorkShare;
use crate::context::command::{Command, HistoryCommand};
use crate::context::unavailable::{Why, because};

/// The folder of the plates, beside the project's file; of each further time it has a number.
const FOLDER: &str = "background without body";
/// How often a background can be learnt again before the user has to remove old folders.
const MOST_FOLDERS: usize = 1000;
/// Of fewer frames a pixel is not free often enough.
const FEWEST_POSES: usize = 2;

#[derive(Debug)]
pub(super) struct BackgroundJob {
    footage: Arc<Footage>,
    model: Arc<Model>,
    poses: BTreeMap<usize, Pose>,
    /// Cameras that are still to be learnt.
    waiting: VecDeque<usize>,
    /// The folder of the project, in which a new one is made for the plates.
    project_folder: PathBuf,
    /// That folder, once it is there.
    folder: Option<PathBuf>,
    /// The plates, by camera.
    files: BTreeMap<usize, PathBuf>,
    /// What is still unknown: cameras' names, and the share of their pixels.
    unknown: Vec<(String, f64)>,
}

impl BackgroundJob {
    /// All cameras whose silhouettes are segmented, by the poses that were found or set; `None` where [`unavailable`] says why.
    pub(super) fn new(context: &Context<'_>) -> Option<Self> {
        let footage = context.session.take.clone()?;
        let project_folder = context.project?.parent().unwrap_or(Path::new("")).to_owned();
        let (model, poses) = (context.document().model.clone(), poses(context));
        let waiting = segmented(&footage).collect();
        let (files, unknown) = Default::default();
        Some(Self { footage, model, poses, waiting, project_folder, folder: None, files, unknown })
    }

    fn learn(&mut self, camera: usize, out: &Outbox<Applied>) -> Result<(), PlateError> {
        let name = self.footage.cameras[camera].name().to_owned();
        let all = self.files.len() + 1 + self.waiting.len();
        let number = self.files.len() + 1;
        out.send(progress(
            format!("Learning the background without the body: {name}, {number} of {all}"),
            Some(WorkShare { done: number - 1, total: all }),
        ));
        let learnt = plate_without_body(self.footage.take(), camera, &self.model, &self.poses, out.cancel())?;
        let folder = match &self.folder {
            Some(folder) => folder.clone(),
            None => self.folder.insert(new_folder(&self.project_folder)?).clone(),
        };
        let mut path = folder.join(plate::file_name(&name));
        if self.files.values().any(|other| *other == path) {
            // Names that differ in letters that files cannot have.
            path = folder.join(format!("{number} {}", plate::file_name(&name)));
        }
        learnt.write(&path)?;
        self.files.insert(camera, path);
        self.unknown.push((name, 1.0 - learnt.known_share()));
        Ok(())
    }
}

impl Job<Applied> for BackgroundJob {
    fn step(&mut self, out: &Outbox<Applied>) -> Turn {
        let Some(camera) = self.waiting.pop_front() else {
            let files = std::mem::take(&mut self.files);
            let folder = files.values().next().and_then(|path| path.parent());
            let said = said_of(&self.unknown, folder);
            // The plates take the place of the take's: one act.
            out.send(applied(move |_, _, requests| {
                requests.edit(Edit::SetPlates(files));
                requests.inform(said, Some(Command::History(HistoryCommand::Undo)));
            }));
            return Turn::Done;
        };
        match self.learn(camera, out) {
            Ok(()) => Turn::Again,
            Err(PlateError::Cancelled) => Turn::Done,
            Err(error) => {
                out.send(refused(format!("The background cannot be learnt: {error}.")));
                Turn::Done
            }
        }
    }
}

pub(super) fn unavailable(context: &Context<'_>) -> Why {
    let Some(take) = &context.session.take else { return Some("Open a take first") };
    because(
        segmented(take).next().is_none(),
        "No camera has a background: all silhouettes were made elsewhere",
    )
    .or(because(
        poses(context).len() < FEWEST_POSES,
        "There is no track yet: where the body is must be known, so track first",
    ))
    .or(because(context.project.is_none(), "Save the project first: the plates are kept beside its file"))
}

/// Cameras whose silhouettes come from a background, or would if they had one.
fn segmented(footage: &Footage) -> impl Iterator<Item = usize> + '_ {
    let cameras = footage.take().footage().iter().enumerate();
    cameras.filter(|(_, camera)| !camera.has_masks()).map(|(index, _)| index)
}

/// The poses of frames that have one of their own and are not lost.
fn poses(context: &Context<'_>) -> BTreeMap<usize, Pose> {
    let document = context.document();
    let mut poses = document.own_poses();
    let is_lost = |frame: &usize| document.estimates.get(frame).is_some_and(|found| found.lost);
    poses.retain(|frame, _| *frame < context.session.frame_count() && !is_lost(frame));
    poses
}

/// "Learnt the background of 4 cameras without the body. Unknown is 1.2 % of cam01, nothing of the others. The plates …"
fn said_of(unknown: &[(String, f64)], folder: Option<&Path>) -> String {
    let cameras = format::counted(unknown.len(), "camera");
    let parts: Vec<String> = unknown
        .iter()
        .filter(|(_, share)| *share > 0.0)
        .map(|(name, share)| format!("{} % of {name}", format::number(100.0 * share, 1)))
        .collect();
    let left =
        if parts.is_empty() { String::new() } else { format!(" Still unknown: {}.", parts.join(", ")) };
    let place = folder.map_or_else(String::new, |folder| format!(" The plates are in {}.", folder.display()));
    format!("Learnt the background of {cameras} without the body.{left}{place} Track again with it.")
}

/// Makes a folder for plates that is not there yet: those of an earlier time stay, so that they can be gone back to.
fn new_folder(project: &Path) -> Result<PathBuf, PlateError> {
    let mut path = project.join(FOLDER);
    for number in 2..=MOST_FOLDERS {
        match std::fs::create_dir(&path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
                path = project.join(format!("{FOLDER} {number}"));
            }
            Err(error) => return Err(PlateError::Folder { path, error }),
        }
    }
    Err(PlateError::Folder { path, error: std::io::ErrorKind::AlreadyExists.into() })
}
