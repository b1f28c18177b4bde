//! The take: a folder with `take.toml`, the cameras for its pictures, and plates where they were learnt.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use backlit_tracking::camera::{Camera, Rig};
use backlit_tracking::cancel::CancelToken;

use super::plates::{self, Learnt};
use super::scan::escaped;
use super::{Found, FoundCamera, ImportError, Pictures};
use crate::calibration::backlit;
use crate::take::{FILE_NAME, FORMAT};
use crate::{FileError, FileProblem, atomic};

/// Where backgrounds come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// A plate where there is one, else learnt from the footage.
    PlateOrFootage,
    /// Learnt from the footage.
    Footage,
    /// None: silhouettes come from elsewhere.
    None,
}

/// What is being done.
#[derive(Debug, Clone, PartialEq)]
pub enum ImportStep {
    /// A camera's background is being learnt.
    Learning {
        /// The camera's name.
        camera: String,
    },
    /// It has been learnt.
    Learnt {
        /// The camera's name.
        camera: String,
        /// The share of its pixels that are known, 0 to 1.
        known: f64,
    },
}

/// Writes the take and returns its file. The footage stays where it is.
///
/// # Errors
/// There is a take already, no frame rate is known, a picture cannot be read, or the folder cannot be written.
pub fn write(
    found: &Found,
    out: &Path,
    background: Background,
    cancel: &CancelToken,
    progress: &mut dyn FnMut(ImportStep),
) -> Result<PathBuf, ImportError> {
    let file = out.join(FILE_NAME);
    if file.exists() {
        return Err(ImportError::Exists(file));
    }
    let frame_rate = found.frame_rate.ok_or(ImportError::NoFrameRate)?;
    let failed = |path: &Path, error| FileError::new(path, FileProblem::Write { error });
    std::fs::create_dir_all(out).map_err(|error| failed(out, error))?;
    let rig = Rig::new(found.cameras.iter().map(|camera| camera.camera.clone()).collect());
    let rig = rig.map_err(|error| FileError::new(&found.calibration, FileProblem::Rig { error }))?;
    atomic::write(&out.join("cameras.json"), backlit::to_text(&rig).as_bytes())?;
    let (mut sources, mut heights) = (Vec::new(), Vec::new());
    for camera in &found.cameras {
        let (source, height) = background_of(found, camera, out, background, cancel, progress)?;
        sources.push(source);
        heights.push(height);
    }
    let smallest = |camera: &Camera| camera.width().min(camera.height());
    let smallest = rig.cameras().iter().map(smallest).min().unwrap_or(1);
    let text = TakeText { found, out, frame_rate, sources, reduction: plates::reduction(&heights, smallest) };
    atomic::write(&file, text.to_text().as_bytes())?;
    Ok(file)
}

/// A camera's background, as the take names it, and the person's height in its pictures where it is known.
fn background_of(
    found: &Found,
    camera: &FoundCamera,
    out: &Path,
    background: Background,
    cancel: &CancelToken,
    progress: &mut dyn FnMut(ImportStep),
) -> Result<(Option<String>, Option<f64>), ImportError> {
    let name = camera.camera.name().to_owned();
    match (&camera.plate, background) {
        (_, Background::None) => Ok((None, None)),
        (Some(plate), Background::PlateOrFootage) => Ok((Some(escaped(&relative(plate, out))), None)),
        _ => {
            if cancel.is_cancelled() {
                let reason = "stopped by you".to_owned();
                return Err(ImportError::Background { camera: name, reason });
            }
            progress(ImportStep::Learning { camera: name.clone() });
            let Learnt { plate, person_px } = plates::learn(found, camera)?;
            let folder = out.join("background");
            std::fs::create_dir_all(&folder)
                .map_err(|error| FileError::new(&folder, FileProblem::Write { error }))?;
            let file = format!("{}.png", file_name(&name));
            plates::write(&folder.join(&file), &plate)?;
            progress(ImportStep::Learnt { camera: name, known: plate.known_share() });
            Ok((Some(format!("background/{}", escaped(&file))), person_px))
        }
    }
}

/// A camera's name as the name of a file.
fn file_name(camera: &str) -> String {
    let allowed = |letter: char| letter.is_alphanumeric() || matches!(letter, '-' | '_' | '.' | ' ');
    camera.chars().map(|letter| if allowed(letter) { letter } else { '_' }).collect()
}

/// A path as seen from a folder, with slashes; whole where they share nothing.
fn relative(path: &Path, from: &Path) -> String {
    let absolute = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let (path, from) = (absolute(path), absolute(from));
    let shared = path.iter().zip(from.iter()).take_while(|(a, b)| a == b).count();
    if shared < 2 {
        return path.to_string_lossy().into_owned();
    }
    let up = from.iter().skip(shared).map(|_| "..".to_owned());
    let down = path.iter().skip(shared).map(|part| part.to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

struct TakeText<'a> {
    found: &'a Found,
    out: &'a Path,
    frame_rate: f64,
    sources: Vec<Option<String>>,
    reduction: u32,
}

impl TakeText<'_> {
    fn to_text(&self) -> String {
        let Found { project, calibration, first, count, .. } = self.found;
        let mut text = format!(
            "# Written by `backlit import` from {project}. docs/formats.md explains every line.\n\
             format = {}\nname = {}\nframe_rate = {}\nmodel = \"full_body\"\n\
             # The model is an average body: tracking finds the person's own sizes.\nsizes = \"fit\"\n",
            quoted(FORMAT),
            quoted(&self.found.name),
            self.frame_rate,
        );
        if self.reduction > 1 {
            let reduction = self.reduction;
            let _ = write!(
                text,
                "# Silhouettes and fits are made of pictures reduced by this number: the person is tall enough in them.\n\
                 reduction = {reduction}\n"
            );
        }
        let _ = write!(
            text,
            "\n[cameras]\n# From {}\ncalibration = \"cameras.json\"\n",
            relative(calibration, self.out).replace('\n', " ")
        );
        for (camera, source) in self.found.cameras.iter().zip(&self.sources) {
            let (path, from) = match &camera.pictures {
                Pictures::Video(video) => (escaped(&relative(video.path(), self.out)), 0),
                Pictures::Numbered { folder, pattern, first, .. } => {
                    (format!("{}/{pattern}", escaped(&relative(folder, self.out))), *first)
                }
            };
            let _ = write!(
                text,
                "\n[[camera]]\nname = {}\nframes = {}\nfirst = {}\ncount = {count}\n",
                quoted(camera.camera.name()),
                quoted(&path),
                from + *first as u64,
            );
            if let Some(source) = source {
                let _ = writeln!(text, "background = {}", quoted(source));
            }
        }
        if let Some(table) = &self.found.table {
            let table = relative(table, self.out).replace('\n', " ");
            let _ = write!(
                text,
                "\n# Another tool's markers, to compare with: backlit track … --reference {table}\n"
            );
        }
        text
    }
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
