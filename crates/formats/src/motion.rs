//! Motion for other programs: a body's poses, frame by frame, in the files that animation and biomechanics read
//! (see `docs/formats.md`).
//!
//! A motion lies in the world of its take, whose axes are anybody's. It is turned by `file_from_world`, so that `up` of
//! the [`MotionOptions`] points along the file's own, and scaled to the file's unit:
//! `p_file = scale · (file_from_world p)`. A skeleton's bones turn by `file_from_world W file_from_body⁻¹`, where W is
//! the world rotation of the bone's limb and `file_from_body` makes the rest pose stand upright in the file.
//!
//! A format is a variant of [`MotionFormat`] with its row of `FORMATS`, and a function that writes it in a file of its own.

use std::collections::BTreeMap;
use std::path::Path;

use backlit_tracking::belief::LimbTrust;
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::track::FrameEstimate;
use serde::{Deserialize, Serialize};

use super::export::TrackExport;
use super::export::track_read::WrittenTrack;
use super::{FileProblem, Result, atomic};

mod bones;
mod bvh;
mod c3d;
mod frames;
mod glb;
mod joints;
mod labels;
mod names;
mod npz;
mod options;
mod tables;

pub use joints::{JointTrack, parse_bvh, read_joints};
pub use labels::{MotionLabel, parse_labels, read_labels};
pub use options::{Axes, EulerOrder, MotionOptions, Names, Unit};

use frames::MotionFrames;

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
    /// How far its limbs may be believed, by frame, in the order of the limbs; empty where nobody judged them.
    pub trust: BTreeMap<usize, Vec<LimbTrust>>,
}

impl Motion {
    /// Poses of a body, by frame, of which nobody says how far they may be believed.
    #[must_use]
    pub fn of_poses(
        name: impl Into<String>,
        model: Model,
        frame_rate: f64,
        poses: BTreeMap<usize, Pose>,
    ) -> Self {
        Self { name: name.into(), model, frame_rate, poses, trust: BTreeMap::new() }
    }

    /// The same with how far limbs may be believed, by frame. Frames in which not all limbs were judged have nothing.
    #[must_use]
    pub fn with_trust(self, mut trust: BTreeMap<usize, Vec<LimbTrust>>) -> Self {
        trust.retain(|_, limbs| limbs.len() == self.model.limbs().len());
        Self { trust, ..self }
    }

    /// The poses of a track.
    #[must_use]
    pub fn of_track(export: &TrackExport<'_>) -> Self {
        Self::of_frames(export.name, export.model.clone(), export.frame_rate, &export.track.frames)
    }

    /// The poses of a track that was read.
    #[must_use]
    pub fn of_written(written: WrittenTrack) -> Self {
        Self::of_frames(written.name, written.model, written.frame_rate, &written.track.frames)
    }

    fn of_frames(
        name: impl Into<String>,
        model: Model,
        frame_rate: f64,
        frames: &BTreeMap<usize, FrameEstimate>,
    ) -> Self {
        let poses = frames.iter().map(|(&frame, estimate)| (frame, estimate.pose.clone())).collect();
        let trust = frames.iter().map(|(&frame, estimate)| (frame, estimate.trust.clone())).collect();
        Self::of_poses(name, model, frame_rate, poses).with_trust(trust)
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
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 7] = [Self::Bvh, Self::Glb, Self::C3d, Self::Trc, Self::Mot, Self::Npz, Self::Csv];

    fn entry(self) -> &'static FormatEntry {
        &FORMATS[self as usize]
    }

    /// How its files' names end, without the dot.
    #[must_use]
    pub fn extension(self) -> &'static str {
        self.entry().extension
    }

    /// What it is called where it is offered.
    #[must_use]
    pub fn label(self) -> &'static str {
        self.entry().label
    }

    /// The format whose files end like this.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// Axes, unit and names where none are chosen: what programs expect of such a file.
    #[must_use]
    pub fn defaults(self) -> (Axes, Unit, Names) {
        (self.entry().axes, self.entry().unit, self.entry().names)
    }
}

/// What there is to know of a format.
#[derive(Debug)]
struct FormatEntry {
    extension: &'static str,
    label: &'static str,
    axes: Axes,
    unit: Unit,
    names: Names,
    rest: RestPose,
    write: fn(&MotionFrames<'_>) -> Result<Vec<u8>, FileProblem>,
}

/// How a file's skeleton stands at rest where the file says which way is up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RestPose {
    /// As the body model has it.
    AsInBody,
    /// Upright, looking along z.
    AlongZ,
    /// Upright, looking along x.
    AlongX,
}

const fn entry(
    [extension, label]: [&'static str; 2],
    (axes, unit, names): (Axes, Unit, Names),
    rest: RestPose,
    write: fn(&MotionFrames<'_>) -> Result<Vec<u8>, FileProblem>,
) -> FormatEntry {
    FormatEntry { extension, label, axes, unit, names, rest, write }
}

/// All formats, in the order of [`MotionFormat`].
static FORMATS: [FormatEntry; 7] = [
    entry(["bvh", "BVH"], (Axes::YUp, Unit::Centimetres, Names::Anatomical), RestPose::AlongZ, bvh::to_bytes),
    entry(["trc", "TRC"], (Axes::YUp, Unit::Metres, Names::OpenSim), RestPose::AsInBody, tables::trc),
    entry(["mot", "MOT"], (Axes::YUp, Unit::Metres, Names::Anatomical), RestPose::AlongX, tables::mot),
    entry(
        ["c3d", "C3D"],
        (Axes::ZUp, Unit::Millimetres, Names::Anatomical),
        RestPose::AsInBody,
        c3d::to_bytes,
    ),
    entry(["glb", "glTF"], (Axes::YUp, Unit::Metres, Names::Anatomical), RestPose::AlongZ, glb::to_bytes),
    entry(
        ["npz", "NumPy"],
        (Axes::World, Unit::Metres, Names::Anatomical),
        RestPose::AsInBody,
        npz::to_bytes,
    ),
    entry(["csv", "CSV"], (Axes::World, Unit::Metres, Names::Anatomical), RestPose::AsInBody, tables::csv),
];

/// The bytes of a motion's file.
///
/// # Errors
/// No frame, a pose that is not the body's or not finite, a frame rate or `up` out of range, or more than the format
/// can hold. The error names the field.
pub fn to_bytes(
    format: MotionFormat,
    motion: &Motion,
    options: &MotionOptions,
) -> Result<Vec<u8>, FileProblem> {
    (format.entry().write)(&MotionFrames::new(format.entry(), motion, options)?)
}

/// Writes a motion, whole or not at all.
pub fn write(path: &Path, format: MotionFormat, motion: &Motion, options: &MotionOptions) -> Result<()> {
    let bytes = to_bytes(format, motion, options).map_err(|problem| problem.at(path, None))?;
    atomic::write(path, &bytes)
}
