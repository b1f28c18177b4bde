//! The take: a folder with `take.toml`, the cameras for its pictures, and plates where they were learnt.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use backlit_tracking::camera::{Adjusted, Rig};
use backlit_tracking::cancel::CancelToken;

use super::scan::{Sequence, escaped};
use super::{ImportCamera, ImportError, ImportMasks, ImportSurvey, Pictures};
use super::{keypoints, plates};
use crate::calibration::backlit;
use crate::take::{FILE_NAME, FORMAT};
use crate::{FileError, FileProblem, atomic, model_file, plate, pose_file};

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

/// What is made of what was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WriteOptions {
    /// Where backgrounds come from.
    pub background: Background,
    /// Whether cameras may be adjusted where keypoints say that the calibration is off.
    pub adjust_cameras: bool,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self { background: Background::PlateOrFootage, adjust_cameras: true }
    }
}

/// What is being done.
#[derive(Debug, Clone, PartialEq)]
pub enum ImportStep {
    /// The cameras were adjusted to the keypoints.
    Adjusted {
        /// Pixels, before and after.
        median_px: [f64; 2],
    },
    /// How tall the person is in the pictures is being measured.
    Measuring,
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
pub fn write(
    found: &ImportSurvey,
    out: &Path,
    options: WriteOptions,
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
    let rig_text = |found: &ImportSurvey| {
        let rig = Rig::new(found.cameras.iter().map(|camera| camera.camera.clone()).collect());
        let rig = rig.map_err(|error| FileError::new(&found.calibration, FileProblem::Rig { error }))?;
        Ok::<String, ImportError>(backlit::to_text(&rig))
    };
    let mut adjusted = found.clone();
    let adjustment = if options.adjust_cameras { keypoints::adjusted_rig(found)? } else { None };
    if let Some(Adjusted { cameras, median_px, .. }) = &adjustment {
        atomic::write(&out.join("cameras_given.json"), rig_text(found)?.as_bytes())?;
        let found_cameras = adjusted.cameras.iter_mut().zip(cameras);
        found_cameras.for_each(|(found, camera)| found.camera = camera.clone());
        progress(ImportStep::Adjusted { median_px: *median_px });
    }
    let found = &adjusted;
    atomic::write(&out.join("cameras.json"), rig_text(found)?.as_bytes())?;
    progress(ImportStep::Measuring);
    let reduction = plates::reduction(found)?;
    let learning = Learning { found, out, background: options.background, reduction, cancel };
    let sources = found
        .cameras
        .iter()
        .map(|camera| learning.background_of(camera, progress))
        .collect::<Result<_, _>>()?;
    let body = keypoints::start(found)?;
    if let Some(body) = &body {
        model_file::write(&out.join("body.toml"), &body.model)?;
        pose_file::write(&out.join("start.json"), &body.model, &body.pose)?;
    }
    let (has_start, is_adjusted) = (body.is_some(), adjustment.is_some());
    let text = TakeText { found, out, frame_rate, sources, reduction, has_start, is_adjusted };
    atomic::write(&file, text.to_text().as_bytes())?;
    Ok(file)
}

/// How backgrounds are learnt.
struct Learning<'a> {
    found: &'a ImportSurvey,
    out: &'a Path,
    background: Background,
    reduction: usize,
    cancel: &'a CancelToken,
}

impl Learning<'_> {
    /// A camera's background, as the take names it.
    fn background_of(
        &self,
        camera: &ImportCamera,
        progress: &mut dyn FnMut(ImportStep),
    ) -> Result<Option<String>, ImportError> {
        let name = camera.camera.name().to_owned();
        match (&camera.plate, self.background) {
            (_, Background::None) => Ok(None),
            _ if camera.masks.is_some() => Ok(None),
            (Some(plate), Background::PlateOrFootage) => Ok(Some(escaped(&relative(plate, self.out)))),
            _ => {
                if self.cancel.is_cancelled() {
                    return Err(ImportError::Cancelled);
                }
                progress(ImportStep::Learning { camera: name.clone() });
                let learnt = plates::learn(self.found, camera, self.reduction)?;
                let folder = self.out.join("background");
                std::fs::create_dir_all(&folder)
                    .map_err(|error| FileError::new(&folder, FileProblem::Write { error }))?;
                let file = plate::file_name(&name);
                learnt.write(&folder.join(&file))?;
                progress(ImportStep::Learnt { camera: name, known: learnt.known_share() });
                Ok(Some(format!("background/{}", escaped(&file))))
            }
        }
    }
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
    found: &'a ImportSurvey,
    out: &'a Path,
    frame_rate: f64,
    sources: Vec<Option<String>>,
    reduction: usize,
    has_start: bool,
    is_adjusted: bool,
}

impl TakeText<'_> {
    fn to_text(&self) -> String {
        let ImportSurvey { project, calibration, first, count, .. } = self.found;
        let mut text = format!(
            "# Written by `backlit import` from {project}. docs/formats.md explains every line.\n\
             format = {}\nname = {}\nframe_rate = {}\n",
            quoted(FORMAT),
            quoted(&self.found.name),
            rounded(self.frame_rate),
        );
        text += if self.has_start {
            "# Height and pose by the keypoints of the first frame.\nmodel = \"body.toml\"\nstart = \"start.json\"\n"
        } else {
            "model = \"full_body\"\n"
        };
        text += "# The model is an average body: tracking finds the person's own sizes.\nsizes = \"fit\"\n";
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
            "\n[cameras]\n# From {}{}\ncalibration = \"cameras.json\"\n",
            relative(calibration, self.out).replace('\n', " "),
            if self.is_adjusted {
                ", adjusted to the keypoints; as it was given: cameras_given.json"
            } else {
                ""
            },
        );
        for (camera, source) in self.found.cameras.iter().zip(&self.sources) {
            let (path, from) = self.named(&camera.pictures);
            let is_alone = camera.masks.as_ref().is_some_and(|masks| masks.are_alone);
            let key = if is_alone { "masks" } else { "frames" };
            let first = from + *first as u64;
            let _ = write!(
                text,
                "\n[[camera]]\nname = {}\n{key} = {}\nfirst = {first}\ncount = {count}\n",
                quoted(camera.camera.name()),
                quoted(&path),
            );
            if let Some(masks) = &camera.masks {
                text += &self.masks(masks, first, from);
            }
            if let Some(source) = source {
                let _ = writeln!(text, "background = {}", quoted(source));
            }
            if let Some((folder, (pattern, number))) = camera
                .keypoints
                .as_ref()
                .and_then(|folder| Some((folder, crate::keypoints::pattern_of(folder).ok()??)))
            {
                let path = format!("{}/{pattern}", escaped(&relative(folder, self.out)));
                let first = number + self.found.first as u64;
                let _ = writeln!(text, "keypoints = {}\nkeypoints_first = {first}", quoted(&path));
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

    /// The path of pictures, as the take names it, and the number of the first.
    fn named(&self, pictures: &Pictures) -> (String, u64) {
        match pictures {
            Pictures::Video(video) => (escaped(&relative(video.path(), self.out)), 0),
            Pictures::Numbered(Sequence { folder, pattern, first, .. }) => {
                (format!("{}/{pattern}", escaped(&relative(folder, self.out))), *first)
            }
        }
    }

    /// Masks of a camera whose frames begin with `first`, of footage whose numbers begin with `from`.
    fn masks(&self, masks: &ImportMasks, first: u64, from: u64) -> String {
        let mut text = String::new();
        if !masks.are_alone {
            let (path, masks_from) = self.named(&masks.pictures);
            text += "# Silhouettes that were made elsewhere: the footage is not segmented.\n";
            let _ = writeln!(text, "masks = {}", quoted(&path));
            let masks_first = masks_from + (first - from);
            if masks_first != first {
                let _ = writeln!(text, "masks_first = {masks_first}");
            }
        }
        let _ = match &masks.values {
            Some(values) => writeln!(text, "mask_values = {values}"),
            None => writeln!(text, "mask_values = \"auto\""),
        };
        text
    }
}

/// A frame rate without the noise of its own computation.
fn rounded(rate: f64) -> f64 {
    (rate * 1e6).round() / 1e6
}

/// A TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
