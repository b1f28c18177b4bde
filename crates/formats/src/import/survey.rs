//! What was found, camera by camera, and what is missing.

use std::path::{Path, PathBuf};

use backlit_tracking::camera::{Camera, CameraError, Rig};
use thiserror::Error;

use super::masks::{self, ImportMasks};
use super::matching::{
    FootageCandidate, FootageFiles, MatchedBy, PLATES, best_group, footage_of, is_plate, is_plate_video,
    matched, parents,
};
use super::pictures::{PictureSize, Pictures};
use super::project::{self, Project};
use super::scan::{Listing, scan};
use crate::calibration::{self, Calibration, CalibrationOptions};
use crate::{FileError, FileProblem};

/// Most files that are tried as a calibration.
const MOST_TRIED: usize = 200;
/// Words of paths that make a file likelier to be the calibration.
const LIKELY: [&str; 5] = ["calib", "camera", "extri", "intri", "transforms"];

/// What the user says beside the files.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportOptions {
    /// The calibration, where it is not to be looked for.
    pub calibration: Option<PathBuf>,
    /// Metres in one unit of a calibration that does not say its unit.
    pub metres_per_unit: f64,
    /// Frames per second, in the place of what the footage says.
    pub frame_rate: Option<f64>,
    /// How pictures of another size than the calibration's were made; `None`: as the pictures tell.
    pub picture_size: Option<PictureSize>,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self { calibration: None, metres_per_unit: 1.0, frame_rate: None, picture_size: None }
    }
}

/// A camera with its footage.
#[derive(Debug, Clone)]
pub struct ImportCamera {
    /// The camera, for pictures of the footage's size.
    pub camera: Camera,
    /// The size in pixels that the calibration is for, width first.
    pub calibrated_size: [usize; 2],
    /// How the pictures were made from those of that size.
    pub picture_size: PictureSize,
    /// The footage.
    pub pictures: Pictures,
    /// Frames per second, where the footage says it.
    pub frame_rate: Option<f64>,
    /// A picture or a video of the scene without the subject.
    pub plate: Option<PathBuf>,
    /// Silhouettes that were made elsewhere.
    pub masks: Option<ImportMasks>,
    /// Two-dimensional keypoints, a file a frame.
    pub keypoints: Option<PathBuf>,
    /// What is missing or damaged in the footage, in words.
    pub notes: Vec<String>,
}

/// What lies in the folders and files that were named.
#[derive(Debug, Clone)]
pub struct ImportSurvey {
    /// Whose project it is.
    pub project: Project,
    /// What it may be called: the folder's name.
    pub name: String,
    /// The calibration.
    pub calibration: PathBuf,
    /// The cameras that have both a calibration and footage, in the calibration's order.
    pub cameras: Vec<ImportCamera>,
    /// By what the footage was given to its cameras.
    pub matched_by: MatchedBy,
    /// Frames per second.
    pub frame_rate: Option<f64>,
    /// The first frame that is used, and how many are.
    pub first: usize,
    /// Number of frames that all cameras have.
    pub count: usize,
    /// A table of markers that another tool made of the same recording.
    pub table: Option<PathBuf>,
    /// Cameras without footage and footage that cannot be used, with the reason.
    pub left_out: Vec<(String, String)>,
}

/// Why no take can be made.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ImportError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Take(#[from] crate::TakeError),
    #[error("{}: no video and no numbered pictures are there; expected footage of each camera", .0.display())]
    NoFootage(PathBuf),
    #[error(
        "{}: no calibration is there that can be read{}; name one",
        path.display(), tried.first().map(|(_, why)| format!(" ({why})")).unwrap_or_default()
    )]
    NoCalibration { path: PathBuf, tried: Vec<(PathBuf, String)> },
    #[error(
        "{}: its cameras are {cameras}, and no footage goes with them: found {footage}; expected the cameras' names or \
         numbers in the names of files or folders, or as many files as cameras", calibration.display()
    )]
    NoMatch { calibration: PathBuf, cameras: String, footage: String },
    #[error("no camera's footage can be read; camera \"{camera}\": {reason}")]
    Unreadable { camera: String, reason: String },
    #[error("camera \"{camera}\": {error}")]
    Camera { camera: String, error: CameraError },
    #[error("nothing says how many frames a second the pictures have; give the frame rate")]
    NoFrameRate,
    #[error(
        "the frames that the project's settings choose, {first} to {last}, are not there: the footage has {count}"
    )]
    FrameRange { first: u64, last: u64, count: usize },
    #[error("{}: there is a take already; choose another folder", .0.display())]
    Exists(PathBuf),
    #[error("stopped; no take was written")]
    Cancelled,
    #[error("camera \"{camera}\": no background can be learnt: {reason}")]
    Background { camera: String, reason: String },
}

/// Looks at folders and files: footage, calibration, plates, keypoints, markers.
pub fn survey(paths: &[PathBuf], options: &ImportOptions) -> Result<ImportSurvey, ImportError> {
    let listing = scan(paths)?;
    let pointed = paths.first().cloned().unwrap_or_default();
    let folder = paths.iter().find(|path| path.is_dir()).map(PathBuf::as_path);
    let project = Project::of(folder, &listing.calibrations);
    let (mut masks, mut footage) = masks::parted(footage_of(&listing), paths);
    let are_alone = footage.is_empty();
    if are_alone {
        footage = std::mem::take(&mut masks);
    }
    if footage.is_empty() {
        return Err(ImportError::NoFootage(pointed));
    }
    let (calibration, found) = calibration_of(&listing, &footage, options, &pointed)?;
    let cameras = found.rig.cameras();
    let mut left_out: Vec<(String, String)> =
        found.left_out.iter().map(|left| (left.name.clone(), left.reason.clone())).collect();
    let names: Vec<&str> = cameras.iter().map(Camera::name).collect();
    let (own, matched_by) = best_group(&names, &footage);
    if own.iter().all(Option::is_none) {
        let found: Vec<String> = footage.iter().take(8).map(|one| one.names[0].clone()).collect();
        let (cameras, footage) = (names.join(", "), found.join(", "));
        return Err(ImportError::NoMatch { calibration, cameras, footage });
    }
    let keypoints = keypoints_of(&listing, project, &names);
    let plates = plates_of(&listing, &names);
    let silhouettes = masks::of_cameras(&names, &masks);
    let mut found = Vec::new();
    for (index, camera) in cameras.iter().enumerate() {
        let Some(own) = own[index] else {
            left_out.push((camera.name().to_owned(), "no footage goes with this camera".to_owned()));
            continue;
        };
        match open(camera, &footage[own].footage, options) {
            Ok(mut one) => {
                one.keypoints.clone_from(&keypoints[index]);
                one.plate.clone_from(&plates[index]);
                let silhouettes = if are_alone { Some(&footage[own]) } else { silhouettes[index] };
                masks::add(&mut one, silhouettes, are_alone);
                found.push(one);
            }
            Err(error) => left_out.push((camera.name().to_owned(), error.to_string())),
        }
    }
    if found.is_empty() {
        let (camera, reason) = left_out.swap_remove(0);
        return Err(ImportError::Unreadable { camera, reason });
    }
    let (first, count) = range_of(&found, folder)?;
    let rate = found.iter().find_map(|camera| camera.frame_rate);
    Ok(ImportSurvey {
        project,
        name: name_of(&pointed),
        calibration,
        matched_by,
        frame_rate: options.frame_rate.or(rate).or_else(|| project::frame_rate(folder)),
        first,
        count,
        table: listing.tables.first().cloned(),
        cameras: found,
        left_out,
    })
}

fn name_of(path: &Path) -> String {
    let absolute = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let name = if absolute.is_dir() { absolute.file_name() } else { absolute.file_stem() };
    name.map_or_else(|| "take".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// The frames that all cameras have, or those of them that the project's settings choose: the first, and how many.
fn range_of(cameras: &[ImportCamera], folder: Option<&Path>) -> Result<(usize, usize), ImportError> {
    let count = cameras.iter().map(|camera| camera.pictures.count()).min().unwrap_or(0);
    let Some([first, last]) = project::frame_range(folder) else { return Ok((0, count)) };
    match usize::try_from(first) {
        Ok(from) if from < count => {
            Ok((from, usize::try_from(last).map_or(count, |last| last.min(count)) - from))
        }
        _ => Err(ImportError::FrameRange { first, last, count }),
    }
}

/// The calibration, and its cameras: the one that is named, else the one that goes with most of the footage.
fn calibration_of(
    listing: &Listing,
    footage: &[FootageCandidate],
    options: &ImportOptions,
    pointed: &Path,
) -> Result<(PathBuf, Calibration), ImportError> {
    let how = CalibrationOptions { size: None, metres_per_unit: options.metres_per_unit };
    if let Some(path) = &options.calibration {
        return Ok((path.clone(), load_sized(path, how, footage)?));
    }
    let mut candidates: Vec<&PathBuf> = listing.calibrations.iter().collect();
    let likely = |path: &Path| {
        let text = path.to_string_lossy().to_lowercase();
        LIKELY.iter().filter(|word| text.contains(*word)).count()
    };
    candidates.sort_by_key(|path| std::cmp::Reverse(likely(path)));
    let (mut best, mut tried, mut single) = (None::<(usize, PathBuf, Calibration)>, Vec::new(), Vec::new());
    for path in candidates.into_iter().take(MOST_TRIED) {
        let found = match load_sized(path, how, footage) {
            Ok(found) => found,
            Err(error) => {
                if likely(path) > 0 {
                    tried.push((path.clone(), error.to_string()));
                }
                continue;
            }
        };
        if let [camera] = found.rig.cameras() {
            single.push((path.clone(), camera.clone()));
        }
        let names: Vec<&str> = found.rig.cameras().iter().map(Camera::name).collect();
        let count = best_group(&names, footage).0.iter().flatten().count();
        if best.as_ref().is_none_or(|best| count > best.0) {
            best = Some((count, path.clone(), found));
        }
    }
    let joined = of_files(&single);
    if joined.len() > best.as_ref().map_or(0, |best| best.0)
        && let Ok(rig) = Rig::new(joined)
    {
        return Ok((single.swap_remove(0).0, Calibration { rig, left_out: Vec::new() }));
    }
    best.map(|(_, path, found)| (path, found))
        .ok_or_else(|| ImportError::NoCalibration { path: pointed.to_owned(), tried })
}

/// Reads a calibration. Where it does not say the pictures' size, that of the footage beside it or of its name counts, else that
/// of any footage.
fn load_sized(
    path: &Path,
    how: CalibrationOptions,
    footage: &[FootageCandidate],
) -> Result<Calibration, FileError> {
    let error = match calibration::load(path, how) {
        Err(error) if matches!(&*error.problem, FileProblem::Field { field, .. } if field.ends_with(".size")) => {
            error
        }
        other => return other,
    };
    let is_beside = |one: &&FootageCandidate| one.footage.path().parent() == path.parent();
    let is_of_name = |one: &&FootageCandidate| path.file_stem().is_some_and(|stem| *stem == *one.names[0]);
    let own = footage.iter().find(is_of_name).or_else(|| footage.iter().find(is_beside));
    let Some(own) = own.or(footage.first()) else { return Err(error) };
    let picture = own.footage.open()?.picture(0)?;
    let size = Some([u64::from(picture.width()), u64::from(picture.height())]);
    calibration::load(path, CalibrationOptions { size, ..how })
}

/// Calibrations of one camera each, named after their folders, as `OpenCap` has them; or after themselves in one folder, as `OpenPose`
/// has them.
fn of_files(single: &[(PathBuf, Camera)]) -> Vec<Camera> {
    let mut cameras: Vec<Camera> = Vec::new();
    let is_one_folder = single.windows(2).all(|pair| pair[0].0.parent() == pair[1].0.parent());
    for (path, camera) in single {
        let folder = path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let folder = if is_one_folder { Some(camera.name().to_owned()) } else { folder };
        let size = [camera.width() as u64, camera.height() as u64];
        let named = folder.and_then(|name| {
            let place = *camera.camera_from_world();
            Camera::new(&name, size, *camera.intrinsics(), *camera.distortion(), place).ok()
        });
        if let Some(named) = named.filter(|named| cameras.iter().all(|other| other.name() != named.name())) {
            cameras.push(named);
        }
    }
    cameras
}

/// For each camera its folder of keypoints.
fn keypoints_of(listing: &Listing, project: Project, cameras: &[&str]) -> Vec<Option<PathBuf>> {
    let in_folder = |word: &str| -> Vec<&PathBuf> {
        let is_inside = |path: &&PathBuf| {
            path.ancestors().any(|folder| folder.file_name().is_some_and(|name| name == word))
        };
        listing.keypoints.iter().filter(is_inside).collect()
    };
    let preferred =
        project.keypoint_folders().iter().map(|word| in_folder(word)).find(|found| !found.is_empty());
    let folders = preferred.unwrap_or_else(|| listing.keypoints.iter().collect());
    let names: Vec<Vec<String>> = folders
        .iter()
        .map(|path| vec![path.file_name().unwrap_or_default().to_string_lossy().into_owned()])
        .collect();
    let own = matched(cameras, &names).0;
    own.into_iter().map(|own| own.map(|own| folders[own].clone())).collect()
}

/// For each camera its picture or video of the scene without the subject.
fn plates_of(listing: &Listing, cameras: &[&str]) -> Vec<Option<PathBuf>> {
    let pictures = listing.pictures.iter().filter(|path| is_plate(path));
    let plates: Vec<&PathBuf> =
        pictures.chain(listing.videos.iter().filter(|path| is_plate_video(path))).collect();
    let names: Vec<Vec<String>> = plates
        .iter()
        .map(|path| {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
            let own = PLATES.iter().fold(stem, |stem, word| stem.replace(word, ""));
            std::iter::once(own).chain(parents(path)).collect()
        })
        .collect();
    let (own, _) = matched(cameras, &names);
    own.into_iter().map(|own| own.map(|own| plates[own].clone())).collect()
}

/// Opens a camera's footage and makes the camera fit its pictures.
fn open(
    camera: &Camera,
    footage: &FootageFiles,
    options: &ImportOptions,
) -> Result<ImportCamera, ImportError> {
    let pictures = footage.open()?;
    let (frame_rate, notes) = match &pictures {
        Pictures::Video(video) => (video.frame_rate(), video.notes()),
        Pictures::Numbered(sequence) => (None, Vec::from_iter(sequence.gap())),
    };
    let picture = pictures.picture(0)?;
    let size = [picture.width() as usize, picture.height() as usize];
    let guess = PictureSize::guess(camera, &picture);
    let picture_size = match (guess, options.picture_size) {
        (PictureSize::Same, _) | (_, None) => guess,
        (_, Some(chosen)) => chosen,
    };
    let fitted = picture_size.camera(camera, size);
    let name = || camera.name().to_owned();
    Ok(ImportCamera {
        camera: fitted.map_err(|error| ImportError::Camera { camera: name(), error })?,
        calibrated_size: [camera.width(), camera.height()],
        picture_size,
        pictures,
        frame_rate,
        plate: None,
        masks: None,
        keypoints: None,
        notes,
    })
}
