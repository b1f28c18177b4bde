//! Why a file could not be read or written: which file, which line, which field, what was expected.

use std::fmt::{self, Write};
use std::path::{Path, PathBuf};

use backlit_tracking::body::{ModelError, PoseError};
use backlit_tracking::camera::{CameraError, MAX_PIXELS, RigError};
use backlit_tracking::track::MemoryError;
use thiserror::Error;

use crate::masks::MaskProblem;
use crate::memory::MemoryShort;
use crate::mesh::MeshProblem;
use crate::text::{Safe, cut, cut_middle, shown};
use crate::video::VideoProblem;

/// Longest text of what is wrong with a file, letters: a message is read, not searched.
const LONGEST: usize = 400;

/// What comes of a file.
pub type Result<T, E = FileError> = std::result::Result<T, E>;

/// What is wrong with a file, and where.
#[derive(Debug, Error)]
pub struct FileError {
    /// The file, as it was asked for.
    pub path: PathBuf,
    /// The line, counted from 1, where one is known.
    pub line: Option<usize>,
    /// What is wrong.
    pub problem: Box<FileProblem>,
}

impl FileError {
    /// A problem of a whole file.
    #[must_use]
    pub fn new(path: &Path, problem: FileProblem) -> Self {
        problem.at(path, None)
    }

    /// The same at a line, counted from 1.
    #[must_use]
    pub fn at_line(self, line: Option<usize>) -> Self {
        Self { line, ..self }
    }

    /// Why the system did not let the file be written, if that is what went wrong.
    #[must_use]
    pub fn write_error(&self) -> Option<&std::io::Error> {
        match &*self.problem {
            FileProblem::Write { error } => Some(error),
            _ => None,
        }
    }

    /// Whether the file does not exist.
    #[must_use]
    pub fn is_missing(&self) -> bool {
        matches!(*self.problem, FileProblem::Missing | FileProblem::MissingModel { .. })
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Letters that are written out are longer than they were.
        f.write_str(&cut_middle(&shown(&self.path.to_string_lossy()).to_string(), [80, 160]))?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        f.write_str(": ")?;
        let mut safe = Safe { out: f, left: LONGEST };
        let written = write!(safe, "{}", self.problem);
        let left = safe.left;
        // What was too long has ended the writing, not an error of the one who is written to.
        if written.is_err() && left == 0 { f.write_str("…") } else { written }
    }
}

/// Why the system refuses, in plain words; else in the system's own.
#[must_use]
pub fn reason(error: &std::io::Error) -> String {
    use std::io::ErrorKind as Kind;
    let words = match error.kind() {
        Kind::StorageFull => "the disk is full",
        Kind::QuotaExceeded => "your share of the disk is used up",
        Kind::FileTooLarge => "a file may not become that large there",
        Kind::ReadOnlyFilesystem => "the disk is read-only",
        Kind::PermissionDenied => "there is no permission",
        Kind::NotFound => "its folder is not there",
        Kind::NotADirectory => "what should be its folder is a file",
        Kind::AlreadyExists => "there is a file in its place",
        Kind::IsADirectory => "there is a folder of that name",
        Kind::InvalidFilename => "the name is too long, or not allowed there",
        _ => return error.to_string(),
    };
    words.to_owned()
}

/// What is wrong with a file.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum FileProblem {
    #[error("there is no such file")]
    Missing,
    #[error("there is no such file, and no built-in model of that name (there are {known})")]
    MissingModel { known: String },
    #[error("cannot be read: {}", reason(.error))]
    Read { error: std::io::Error },
    #[error("cannot be written: {}", reason(.error))]
    Write { error: std::io::Error },
    #[error("is a folder or a device; expected a file")]
    NotAFile,
    #[error("has more than {limit} bytes; expected a smaller file")]
    TooLarge { limit: u64 },
    #[error("is not UTF-8 text")]
    NotText,
    #[error("is not valid {format}: {}{message}", InField(.field.as_deref()))]
    Syntax { format: TextFormat, field: Option<String>, message: String },
    #[error("{}{message}", InField(.field.as_deref()))]
    Schema { field: Option<String>, message: String },
    #[error("`format` is {}; expected \"{expected}\"", cut(.found))]
    Format { found: String, expected: &'static str },
    #[error("`{}` is {}; expected {expected}", in_short(.field), cut(.found))]
    Field { field: String, found: String, expected: String },
    #[error("`{}`: {message}", in_short(.field))]
    Option { field: String, message: String },
    #[error("`{}` is given twice; expected it once", in_short(.field))]
    Duplicate { field: String },
    #[error("`{}` names \"{}\", and the model has no limb of that name", in_short(.field), cut(.limb))]
    UnknownLimb { field: String, limb: String },
    #[error("`{field}`: \"{}\" follows another limb's rotation and has none of its own; leave it out", cut(.limb))]
    RigidLimb { field: String, limb: String },
    #[error("`{field}`: the environment variable {} is not set, and no default is given", cut(.variable))]
    Variable { field: String, variable: String },
    #[error(transparent)]
    Model { error: ModelError },
    #[error(transparent)]
    Pose { error: PoseError },
    #[error(transparent)]
    Memory { error: MemoryError },
    #[error("camera \"{}\": {error}", cut(.camera))]
    Camera { camera: String, error: CameraError },
    #[error(transparent)]
    Rig { error: RigError },
    #[error(
        "cannot be recognised as a calibration; expected backlit-cameras JSON, a file of OpenCV, Pose2Sim, Anipose, \
         Caliscope, FreeMoCap, OpenPose, Qualisys, Vicon, EasyMocap, COLMAP, Kalibr, ROS or OpenCap, transforms.json, or JSON of \
         camera matrices"
    )]
    UnknownCalibration,
    #[error("is not a whole picture: {message}")]
    Picture { message: String },
    #[error(transparent)]
    Video { error: VideoProblem },
    #[error(transparent)]
    Mask { error: MaskProblem },
    #[error(transparent)]
    Mesh { error: MeshProblem },
    #[error(
        "has {}×{} pixels; expected at most {} megapixels of 8 bits, and fewer of more", found[0], found[1],
        MAX_PIXELS >> 20
    )]
    PictureTooLarge { found: [usize; 2] },
    #[error("the pictures and backgrounds of its {cameras} cameras {error}, or set `reduction`")]
    PicturesTooLarge { cameras: usize, error: MemoryShort },
    #[error("has {}×{} pixels; expected {}×{}", found[0], found[1], expected[0], expected[1])]
    PictureSize { found: [usize; 2], expected: [usize; 2] },
}

impl FileProblem {
    /// A field that holds something else than what is expected.
    pub fn field(field: impl Into<String>, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Field { field: field.into(), found: found.into(), expected: expected.into() }
    }

    /// A text that its format does not allow.
    pub fn syntax(format: TextFormat, message: impl Into<String>) -> Self {
        Self::Syntax { format, field: None, message: message.into() }
    }

    /// The error of a file with this problem, at a line where one is known.
    #[must_use]
    pub fn at(self, path: &Path, line: impl Into<Option<usize>>) -> FileError {
        FileError { path: path.to_owned(), line: line.into(), problem: Box::new(self) }
    }
}

/// A text format that a library parses for us.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextFormat {
    /// Comma-separated values.
    Csv,
    /// JavaScript object notation.
    Json,
    /// Tom's obvious minimal language.
    Toml,
    /// Extensible markup language.
    Xml,
    /// YAML, as far as cameras are written in it.
    Yaml,
    /// Python's serialised objects: dicts of arrays.
    Pickle,
}

impl fmt::Display for TextFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(["CSV", "JSON", "TOML", "XML", "YAML", "pickle of arrays"][*self as usize])
    }
}

/// The path of a field.
fn in_short(path: &str) -> String {
    cut_middle(&shown(path).to_string(), [50, 50])
}

struct InField<'a>(Option<&'a str>);

impl fmt::Display for InField<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |field| write!(f, "in `{}`: ", in_short(field)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_of_letters_that_are_written_out_is_cut_all_the_same() {
        let said = FileError::new(Path::new(&"\u{202e}".repeat(2000)), FileProblem::Missing).to_string();
        assert!(
            said.starts_with("\\u{202e}\\u{202e}") && said.ends_with(": there is no such file"),
            "{said}"
        );
        assert!(said.chars().count() < 300, "{said}");
    }
}
