//! Motion for other programs: a body's poses, frame by frame, in the files that animation and biomechanics read
//! (see `docs/formats.md`).
//!
//! A motion lies in the world of its take, whose axes are anybody's. It is turned by `file_from_world`, so that `up` of
//! the [`MotionOptions`] points along the file's own, and scaled to the file's unit:
//! `p_file = scale · (file_from_world p)`. A skeleton's nodes turn by `file_from_world W file_from_body⁻¹`, where W is
//! the world rotation of the node's limb and `file_from_body` makes the rest pose stand upright in the file.
//!
//! | file | holds |
//! |---|---|
//! | `options` | [`MotionOptions`]: axes, unit, frames, names, order of angles |
//! | `names` | joints and bones as other programs call them |
//! | `scene` | the frames to write, in the file's axes and unit |
//! | `skeleton` | limbs as a tree of turning nodes |
//! | `euler` | quaternions as three angles, without jumps |
//! | `bvh` | Biovision hierarchy |
//! | `trc`, `mot` | OpenSim: markers, and coordinates |
//! | `c3d` | C3D points |
//! | `glb`, `glb_buffer`, `capsule` | glTF 2.0 with a skinned body |
//! | `npz`, `zip` | NumPy arrays |
//! | `rows` | CSV |
//! | `joints` | [`JointTrack`]: joints over time, of a track or a BVH |
//! | `labels` | `labels.csv`: what motions of a folder are called |

use std::collections::BTreeMap;
use std::path::Path;

use backlit_tracking::body::{Model, Pose};
use serde::{Deserialize, Serialize};

use super::export::TrackExport;
use super::export::track_read::WrittenTrack;
use super::{FileError, FileProblem, atomic};

mod bvh;
mod c3d;
mod capsule;
mod euler;
mod glb;
mod glb_buffer;
mod joints;
mod labels;
mod mot;
mod names;
mod npz;
mod options;
mod rows;
mod scene;
mod skeleton;
mod trc;
mod zip;

pub use joints::{JointTrack, parse_bvh, read_joints};
pub use labels::{MotionLabel, parse_labels, read_labels};
pub use options::{Axes, EulerOrder, MotionOptions, Names, Unit};

use scene::Scene;

/// Most frames between the first and the last, where a format has no gaps.
pub const MAX_FRAMES: usize = 1_000_000;

/// A body's poses by frame. Frames may be missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// What the recording is called.
    pub name: String,
    /// The body.
    pub model: Model,
    /// Frames per second.
    pub frame_rate: f64,
    /// Poses of the body, by frame.
    pub poses: BTreeMap<usize, Pose>,
}

impl Motion {
    /// The poses of a track.
    #[must_use]
    pub fn of_track(export: &TrackExport<'_>) -> Self {
        let poses = export.track.frames.iter().map(|(&frame, estimate)| (frame, estimate.pose.clone()));
        Self {
            name: export.name.to_owned(),
            model: export.model.clone(),
            frame_rate: export.frame_rate,
            poses: poses.collect(),
        }
    }

    /// The poses of a track that was read.
    #[must_use]
    pub fn of_written(written: WrittenTrack) -> Self {
        let poses = written.track.frames.into_iter().map(|(frame, estimate)| (frame, estimate.pose));
        let poses = poses.collect();
        Self { name: written.name, model: written.model, frame_rate: written.frame_rate, poses }
    }
}

/// A kind of file that a motion is written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionFormat {
    /// Biovision hierarchy: Blender, `MotionBuilder`, Maya.
    Bvh,
    /// Markers of `OpenSim`.
    Trc,
    /// Coordinates of `OpenSim`.
    Mot,
    /// C3D points: biomechanics, Vicon, Qualisys.
    C3d,
    /// Binary glTF 2.0 with a skinned body.
    Glb,
    /// `NumPy` arrays.
    Npz,
    /// One row a frame and joint.
    Csv,
}

impl MotionFormat {
    /// All of them.
    pub const ALL: [Self; 7] = [Self::Bvh, Self::Trc, Self::Mot, Self::C3d, Self::Glb, Self::Npz, Self::Csv];

    /// How its files' names end, without the dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Bvh => "bvh",
            Self::Trc => "trc",
            Self::Mot => "mot",
            Self::C3d => "c3d",
            Self::Glb => "glb",
            Self::Npz => "npz",
            Self::Csv => "csv",
        }
    }

    /// The format whose files end like this.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// Axes and unit where none are chosen: what programs expect of such a file.
    #[must_use]
    pub fn defaults(self) -> (Axes, Unit) {
        match self {
            Self::Bvh => (Axes::YUp, Unit::Centimetres),
            Self::Trc | Self::Mot | Self::Glb => (Axes::YUp, Unit::Metres),
            Self::C3d => (Axes::ZUp, Unit::Millimetres),
            Self::Npz | Self::Csv => (Axes::World, Unit::Metres),
        }
    }
}

/// The bytes of a motion's file.
///
/// # Errors
/// No frame, a pose that is not the body's or not finite, a frame rate or `up` that is none, or more than the format
/// can hold. The error names the field.
pub fn to_bytes(
    format: MotionFormat,
    motion: &Motion,
    options: &MotionOptions,
) -> Result<Vec<u8>, FileProblem> {
    let scene = Scene::new(format, motion, options)?;
    match format {
        MotionFormat::Bvh => bvh::to_bytes(&scene),
        MotionFormat::Trc => trc::to_bytes(&scene),
        MotionFormat::Mot => Ok(mot::to_bytes(&scene)),
        MotionFormat::C3d => c3d::to_bytes(&scene),
        MotionFormat::Glb => glb::to_bytes(&scene),
        MotionFormat::Npz => npz::to_bytes(&scene),
        MotionFormat::Csv => Ok(rows::to_bytes(&scene)),
    }
}

/// Writes a motion, whole or not at all.
///
/// # Errors
/// As [`to_bytes`], or the folder is missing or not writable. The error names the file.
pub fn write(
    path: &Path,
    format: MotionFormat,
    motion: &Motion,
    options: &MotionOptions,
) -> Result<(), FileError> {
    let bytes = to_bytes(format, motion, options).map_err(|problem| FileError::new(path, problem))?;
    atomic::write(path, &bytes)
}
