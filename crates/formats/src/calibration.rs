//! Calibrations: several formats, one [`Rig`]. The format is told by the content.
//!
//! `tree` is what YAML, XML, JSON and TOML are brought to, `yaml` and `xml` read such texts, `lens` turns numbers into
//! lenses, and `partial` makes a rig of what one or two files say.

use std::path::{Path, PathBuf};

use backlit_tracking::camera::{Camera, Rig};

use super::{DiskFiles, FileError, FileProblem, Result, TakeFiles, text};
use partial::PartialCameras;
use tree::Field;

mod anipose;
pub mod backlit;
mod caliscope;
mod colmap;
mod easymocap;
mod kalibr;
mod lens;
mod matrices;
mod opencap;
mod opencv;
mod partial;
mod pickle;
mod qualisys;
mod ros;
mod transforms;
mod tree;
mod vicon;
pub mod write;
mod xml;
mod yaml;

/// Largest calibration file that is read, bytes.
const MAX_BYTES: u64 = 8 << 20;
/// Most cameras of one file: a `transforms.json` has one a picture.
const MAX_CAMERAS: usize = 4000;
/// How far the new picture's proportions may be from the old ones': a pixel or two of rounding.
const PROPORTION_TOLERANCE: f64 = 0.01;
/// What is looked for in a folder, in this order.
const IN_FOLDER: [&str; 8] = [
    "cameras.json",
    "intri.yml",
    "cameras.txt",
    "sparse/0/cameras.txt",
    "calibration.toml",
    "camera_array.toml",
    "camchain.yaml",
    "transforms.json",
];
/// Words of file names that go together: one file has the lenses, the other the places.
const COMPANIONS: [[&str; 2]; 4] = [
    ["intri.", "extri."],
    ["cameras.txt", "images.txt"],
    ["intrinsic", "extrinsic"],
    ["Intrinsic", "Extrinsic"],
];

/// How a calibration is to be understood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationOptions {
    /// Width and height in pixels of the pictures that the cameras are for; `None`: as the file has them.
    pub size: Option<[u64; 2]>,
    /// Metres in one unit of a file that does not say its unit.
    pub metres_per_unit: f64,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        Self { size: None, metres_per_unit: 1.0 }
    }
}

/// A rig, and what of the file it does not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The cameras that can be used.
    pub rig: Rig,
    /// Those that cannot.
    pub left_out: Vec<SkippedCamera>,
}

/// A camera of a file that is not in the rig.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SkippedCamera {
    /// As the file calls it.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// What one file holds.
enum Content {
    /// Whole cameras.
    Rig(Rig),
    /// Cameras that may lack something.
    Partial(PartialCameras),
}

/// Parses the content of a calibration of any of the formats; `path` is for the error's message, and for the name of a
/// single camera whose file does not name it.
///
/// A single camera that has a lens and no place stands at the origin. Cameras without a place beside others that have
/// one are left out, as are those that do not film.
///
/// # Errors
/// None of the formats, or not valid, or only half a calibration (see [`load_pair`]). The error names line, camera and
/// field.
pub fn parse(path: &Path, bytes: &[u8], options: CalibrationOptions) -> Result<Rig> {
    Ok(finish(path, content(path, bytes, options)?, options)?.rig)
}

/// Reads a calibration of the disk. Where the file has only lenses or only places, the other file is looked for beside
/// it: `extri.yml` for `intri.yml`, `images.txt` for `cameras.txt`, "extrinsic" for "intrinsic" in the name. Of a folder
/// the first file of a usual name is read.
pub fn read(path: &Path, options: CalibrationOptions) -> Result<Rig> {
    read_from(&DiskFiles, path, options)
}

/// As [`read`], and tells what was left out.
pub fn load(path: &Path, options: CalibrationOptions) -> Result<Calibration> {
    load_from(&DiskFiles, path, options)
}

/// Reads a calibration whose cameras are in several files, as `OpenCap` and `OpenPose` write one each; two files may also be
/// [the lenses and the places](load_pair).
pub fn load_all(paths: &[PathBuf], options: CalibrationOptions) -> Result<Calibration> {
    let parts = |path: &PathBuf| match content(path, &DiskFiles.read(path, MAX_BYTES)?, options)? {
        Content::Partial(parts) => Ok(parts),
        Content::Rig(rig) => Ok(PartialCameras::of_rig(&rig)),
    };
    match paths {
        [] => Err(FileError::new(Path::new(""), FileProblem::Missing)),
        [one] => load(one, options),
        [first, ..] => {
            let found = paths.iter().map(parts).collect::<Result<Vec<_>>>()?;
            if let ([one, other], [a, b]) = (paths, found.as_slice())
                && (a.lacks_lenses() || b.lacks_lenses())
            {
                return load_pair(one, other, options);
            }
            let mut all = PartialCameras::new(None);
            found.into_iter().for_each(|parts| all.add(parts, options));
            all.calibration(first, options)
        }
    }
}

/// Reads a calibration whose lenses and places are in two files. It is an error if no camera has both.
pub fn load_pair(intrinsics: &Path, extrinsics: &Path, options: CalibrationOptions) -> Result<Calibration> {
    let parts = |path: &Path| {
        let bytes = DiskFiles.read(path, MAX_BYTES)?;
        match content(path, &bytes, options)? {
            Content::Partial(parts) => Ok(parts),
            Content::Rig(_) => {
                let expected = "only the lenses or only the places";
                Err(FileProblem::field("cameras", "a whole calibration", expected).at(path, None))
            }
        }
    };
    let (lenses, places) = (parts(intrinsics)?, parts(extrinsics)?);
    let is_swapped = lenses.lacks_lenses() && places.lacks_places();
    let (lenses, places) = if is_swapped { (places, lenses) } else { (lenses, places) };
    PartialCameras::joined(places, lenses).calibration(extrinsics, options)
}

/// As [`read`], of any files.
pub fn read_from(files: &dyn TakeFiles, path: &Path, options: CalibrationOptions) -> Result<Rig> {
    Ok(load_from(files, path, options)?.rig)
}

pub(crate) fn load_from(
    files: &dyn TakeFiles,
    path: &Path,
    options: CalibrationOptions,
) -> Result<Calibration> {
    if !files.exists(path)
        && let Some(inside) = IN_FOLDER.iter().map(|name| path.join(name)).find(|inside| files.exists(inside))
    {
        return load_from(files, &inside, options);
    }
    let found = match content(path, &files.read(path, MAX_BYTES)?, options)? {
        Content::Partial(parts) if parts.lacks_lenses() != parts.lacks_places() => parts,
        whole => return finish(path, whole, options),
    };
    let Some(other) = companions(path).into_iter().find(|other| files.exists(other)) else {
        return found.calibration(path, options);
    };
    match content(&other, &files.read(&other, MAX_BYTES)?, options)? {
        Content::Partial(beside) if found.lacks_places() && !beside.lacks_places() => {
            PartialCameras::joined(beside, found).calibration(path, options)
        }
        Content::Partial(beside) if found.lacks_lenses() && !beside.lacks_lenses() => {
            PartialCameras::joined(found, beside).calibration(path, options)
        }
        _ => found.calibration(path, options),
    }
}

/// The files that may hold what this one lacks.
fn companions(path: &Path) -> Vec<PathBuf> {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return Vec::new() };
    let mut out = Vec::new();
    for [one, other] in COMPANIONS {
        for (one, other) in [(one, other), (other, one)] {
            if name.contains(one) {
                out.push(path.with_file_name(name.replacen(one, other, 1)));
            }
        }
    }
    out
}

fn finish(path: &Path, content: Content, options: CalibrationOptions) -> Result<Calibration> {
    match content {
        Content::Rig(rig) => Ok(Calibration { rig, left_out: Vec::new() }),
        Content::Partial(parts) => parts.calibration(path, options),
    }
}

/// What the file is, by its first bytes and then by its keys.
fn content(path: &Path, bytes: &[u8], options: CalibrationOptions) -> Result<Content> {
    if bytes.len() as u64 > MAX_BYTES {
        return Err(FileError::new(path, FileProblem::TooLarge { limit: MAX_BYTES }));
    }
    if let [0x80, 2..=5, ..] = bytes {
        return opencap::parts(path, bytes).map(Content::Partial);
    }
    if bytes.starts_with(b"MATLAB 5.0 MAT-file") {
        let expected = "another format: MATLAB's files are not read";
        return Err(FileProblem::field("format", "a MATLAB file", expected).at(path, None));
    }
    let content = text::decode(path, bytes)?;
    let first = content.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let parts = match first.unwrap_or_default() {
        first if first.starts_with('<') => match xml::root_name(content) {
            "opencv_storage" => opencv::parts(&Field::root(path, &xml::parse(path, content)?))?,
            "Cameras" => vicon::parts(path, content)?,
            _ => qualisys::parts(path, content, options.size)?,
        },
        first if first.starts_with('{') => {
            if says_its_format(content) {
                return backlit::parse(path, content, options).map(Content::Rig);
            }
            let node = tree::from_json(path, content)?;
            let root = Field::root(path, &node);
            let is_matrices = node.get("cameras").is_some_and(matrices::is_one);
            if transforms::is_one(&node) {
                transforms::parts(&root)?
            } else if is_matrices || node.entries().is_empty() {
                matrices::parts(&root, options.size)?
            } else {
                opencv::parts(&root)?
            }
        }
        first if is_toml(first) => {
            let node = tree::from_toml(path, content)?;
            let root = Field::root(path, &node);
            if caliscope::is_one(&node) { caliscope::parts(&root)? } else { anipose::parts(&root)? }
        }
        first if is_yaml(first) => {
            let node = yaml::parse(path, content)?;
            let root = Field::root(path, &node);
            if kalibr::is_one(&node) {
                kalibr::parts(&root)?
            } else if ros::is_one(&node) {
                ros::parts(&root)?
            } else {
                opencv::parts(&root)?
            }
        }
        _ => match colmap::which(content) {
            Some(which) => colmap::parts(path, content, which)?,
            None => return Err(FileProblem::UnknownCalibration.at(path, None)),
        },
    };
    Ok(Content::Partial(parts))
}

/// Whether a first line is a table's head or `key = value`.
fn is_toml(line: &str) -> bool {
    let head = without_comment(line).trim();
    let is_head =
        head.starts_with('[') && head.ends_with(']') && (!head.contains(',') || head.starts_with("[\""));
    let is_number = head.trim_matches(['[', ']', ' ']).parse::<f64>().is_ok();
    let is_key = |key: &str| {
        let key = key.trim();
        !key.is_empty()
            && key.chars().all(|letter| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.' | '"'))
    };
    is_head && !is_number && head.len() > 2 || line.split_once('=').is_some_and(|(key, _)| is_key(key))
}

/// A line of TOML up to a `#` that is in no quotes.
fn without_comment(line: &str) -> &str {
    let (mut is_quoted, mut is_escaped) = (false, false);
    let end = line.find(|letter: char| {
        let begins = letter == '#' && !is_quoted;
        if letter == '"' && !is_escaped {
            is_quoted = !is_quoted;
        }
        is_escaped = letter == '\\' && !is_escaped;
        begins
    });
    &line[..end.unwrap_or(line.len())]
}

/// Whether a first line is a header of YAML or `key: value`.
fn is_yaml(line: &str) -> bool {
    line.starts_with("%YAML") || line.starts_with("---") || line.ends_with(':') || line.contains(": ")
}

/// The file's name without its ending: the name of a camera that has none.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "camera".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn says_its_format(text: &str) -> bool {
    #[derive(serde::Deserialize)]
    struct FormatOnly {
        format: Option<serde::de::IgnoredAny>,
    }
    match serde_json::from_str::<FormatOnly>(text) {
        Ok(found) => found.format.is_some(),
        Err(_) => text.contains("\"backlit-cameras"),
    }
}

/// The rig of these cameras, each for pictures of the size asked for.
fn rig(path: &Path, cameras: Vec<Camera>, size: Option<[u64; 2]>) -> Result<Rig> {
    let sized = |camera: Camera| match size {
        Some(size) if size != [camera.width() as u64, camera.height() as u64] => resized(path, &camera, size),
        _ => Ok(camera),
    };
    let cameras = cameras.into_iter().map(sized).collect::<Result<_, _>>()?;
    Rig::new(cameras).map_err(|error| FileProblem::Rig { error }.at(path, None))
}

/// The camera for pictures of another size of the same proportions.
fn resized(path: &Path, camera: &Camera, [width, height]: [u64; 2]) -> Result<Camera> {
    let stretch = (width as f64 / camera.width() as f64) / (height as f64 / camera.height() as f64);
    if (stretch - 1.0).abs() > PROPORTION_TOLERANCE {
        let found = format!("for pictures of {}×{}", camera.width(), camera.height());
        let expected = format!("the proportions of {width}×{height}");
        return Err(FileProblem::field(format!("cameras.{}", camera.name()), found, expected).at(path, None));
    }
    let failed = |error| FileProblem::Camera { camera: camera.name().to_owned(), error }.at(path, None);
    camera.resized(width, height).map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_whose_name_has_any_letter_begins_a_toml() {
        for line in ["[\"#\"]", "[\"a # b\"] # c", "[\"a\\\"#\"]", "[a] # [b]", "a = 1"] {
            assert!(is_toml(line), "{line}");
        }
        assert!(!is_toml("[1, 2]") && !is_toml("camera,1"));
    }

    #[test]
    fn what_is_no_calibration_is_said_so() {
        for bytes in [&b""[..], b"camera,1,2", b"[1, 2]"] {
            let message =
                parse(Path::new("c.csv"), bytes, CalibrationOptions::default()).unwrap_err().to_string();
            assert!(message.contains("c.csv: cannot be recognised as a calibration"), "{message}");
        }
    }
}
