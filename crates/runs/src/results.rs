//! Results that were written: the folder of a track, or a project whose poses are meant.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use backlit_document::Document;
use backlit_document::project::read_project;
use backlit_document::take_match::match_take;
use backlit_formats::Take;
use backlit_formats::export::track_read::{self, WrittenTrack};
use backlit_formats::model_file;
use backlit_formats::motion::Motion;
use backlit_tracking::camera::{Camera, up_of};
use glam::DVec3;

use crate::track_summary::IouSummary;

/// The body, where it is no built-in one.
pub const BODY: &str = "body.toml";
/// The ending of projects.
const PROJECT: &str = "backlit";

/// A body's poses with what their file tells of them.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackedMotion {
    /// The body and its poses.
    pub motion: Motion,
    /// Which way is up, of a project as its cameras say.
    pub up: Option<DVec3>,
    /// Mean overlap (IoU) of model and silhouettes by camera, as it was tracked; a project has none.
    pub overlap: BTreeMap<String, f64>,
}

/// The track file of a folder of results; a file is one itself.
#[must_use]
pub fn path_in(track: &Path) -> PathBuf {
    if track.is_dir() { track.join("track.json") } else { track.to_owned() }
}

/// Whether a file is a project, by its name.
#[must_use]
pub fn is_project(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == PROJECT)
}

/// Whether a file, or a folder, is one of ours: a project or a track.
#[must_use]
pub fn is_ours(path: &Path) -> bool {
    path.is_dir() || is_project(path) || path.extension().is_some_and(|extension| extension == "json")
}

/// Reads a track, from its file or its folder. Its body is this model, or else the one that lies beside it if it is the
/// track's, or else the built-in one that it names.
///
/// # Errors
/// As [`track_read::read`], and where the model's file cannot be read.
pub fn read(track: &Path, model: Option<&str>) -> anyhow::Result<WrittenTrack> {
    let path = path_in(track);
    let beside = path.with_file_name(BODY);
    if let Some(model) = model {
        return Ok(track_read::read(&path, Some(&model_file::resolve(model)?))?);
    }
    if !beside.is_file() {
        return Ok(track_read::read(&path, None)?);
    }
    let of_beside = track_read::read(&path, Some(&model_file::read(&beside)?));
    of_beside.or_else(|error| track_read::read(&path, None).map_err(|_error| error.into()))
}

/// Reads a track, or the poses of a project. Nothing is computed again.
///
/// # Errors
/// As [`read`]; for a project where it or its take cannot be read, or a model is given though it has its own.
pub fn read_tracked(path: &Path, model: Option<&str>) -> anyhow::Result<TrackedMotion> {
    if is_project(path) {
        ensure!(model.is_none(), "--model is for tracks; a project has its body");
        return of_project(path);
    }
    let written = read(path, model)?;
    let overlap = IouSummary::of(&written.cameras, &written.track).by_camera;
    let overlap = overlap.into_iter().filter_map(|(camera, iou)| Some((camera, iou?))).collect();
    Ok(TrackedMotion { motion: Motion::of_written(written), up: None, overlap })
}

/// A project beside the take that it is about, its own or this one. The project's cameras are in the take's order.
///
/// # Errors
/// The project or its take cannot be read, it names no take, or the take has other cameras.
pub fn open_project(path: &Path, take: Option<Take>) -> anyhow::Result<(Document, Take)> {
    let mut document = read_project(path)?.document;
    let take = take.map_or_else(|| take_of_project(path, &document), Ok)?;
    let names: Vec<&str> = take.rig().cameras().iter().map(Camera::name).collect();
    match_take(&mut document, &names, take.measurement(), take.frame_count())?;
    Ok((document, take))
}

fn take_of_project(path: &Path, document: &Document) -> anyhow::Result<Take> {
    let source = document.take.clone();
    let source = source.with_context(|| format!("{}: the project names no take", path.display()))?;
    source.named_by(path).open().context("the project's take cannot be opened")
}

/// The poses of a project as they are, and up as its cameras say.
fn of_project(path: &Path) -> anyhow::Result<TrackedMotion> {
    let document = read_project(path)?.document;
    let take = take_of_project(path, &document)?;
    let mut motion = document.motion(take.name(), take.frame_rate());
    // Poses beyond the last frame are kept and not shown.
    motion.poses.retain(|frame, _| *frame < take.frame_count());
    let rig = document.calibration.as_ref().map_or_else(|| take.rig(), |calibration| &calibration.rig);
    Ok(TrackedMotion { motion, up: up_of(rig.cameras()), overlap: BTreeMap::new() })
}
