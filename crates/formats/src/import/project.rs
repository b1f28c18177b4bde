//! Other tools' projects, told by their files.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::{DiskFiles, TakeFiles};

/// Largest settings file that is read, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Whose project a folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Project {
    /// `Pose2Sim`: `Config.toml` with a `[project]`.
    Pose2Sim,
    /// `EasyMocap`: `intri.yml` and `extri.yml`.
    EasyMocap,
    /// Caliscope: `camera_array.toml`.
    Caliscope,
    /// `FreeMoCap`: a `…camera_calibration.toml` beside `synchronized_videos`.
    FreeMoCap,
    /// Anipose: `config.toml` with a `[calibration]`, or `calibration.toml`.
    Anipose,
    /// `OpenCap`: `sessionMetadata.yaml`, or `Videos/Cam…/cameraIntrinsicsExtrinsics.pickle`.
    OpenCap,
    /// Footage and a calibration of any kind.
    Plain,
}

impl fmt::Display for Project {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pose2Sim => "a Pose2Sim project",
            Self::EasyMocap => "an EasyMocap project",
            Self::Caliscope => "a Caliscope project",
            Self::FreeMoCap => "a FreeMoCap session",
            Self::Anipose => "an Anipose project",
            Self::OpenCap => "an OpenCap session",
            Self::Plain => "footage",
        })
    }
}

impl Project {
    /// What the files at hand tell; `folder` is where the user pointed.
    pub(super) fn of(folder: Option<&Path>, calibrations: &[PathBuf]) -> Self {
        let named = |name: &str| {
            calibrations.iter().any(|path| {
                path.file_name().and_then(|found| found.to_str()).is_some_and(|found| found.contains(name))
            })
        };
        if config(folder).is_some_and(|config| config.contains_key("project")) {
            Self::Pose2Sim
        } else if named("cameraIntrinsicsExtrinsics.pickle") || named("sessionMetadata.yaml") {
            Self::OpenCap
        } else if named("intri.yml") && named("extri.yml") {
            Self::EasyMocap
        } else if named("camera_array.toml") {
            Self::Caliscope
        } else if named("camera_calibration.toml") {
            Self::FreeMoCap
        } else if named("calibration.toml") {
            Self::Anipose
        } else {
            Self::Plain
        }
    }

    /// Names of folders and files whose keypoints come first.
    pub(super) fn keypoint_folders(self) -> &'static [&'static str] {
        match self {
            Self::Pose2Sim => &["pose-associated", "pose-sync", "pose"],
            _ => &[],
        }
    }
}

/// `Pose2Sim`'s settings.
fn config(folder: Option<&Path>) -> Option<toml::Table> {
    let bytes = DiskFiles.read(&folder?.join("Config.toml"), MAX_BYTES).ok()?;
    std::str::from_utf8(&bytes).ok()?.parse().ok()
}

/// The frame rate that `Pose2Sim`'s settings give, where they give one.
pub(super) fn frame_rate(folder: Option<&Path>) -> Option<f64> {
    let config = config(folder)?;
    let rate = config.get("project")?.get("frame_rate")?;
    rate.as_float().or_else(|| rate.as_integer().map(|rate| rate as f64)).filter(|rate| *rate > 0.0)
}

/// The frames that `Pose2Sim`'s settings choose, the last one left out, where they choose any.
pub(super) fn frame_range(folder: Option<&Path>) -> Option<[u64; 2]> {
    let config = config(folder)?;
    let range = config.get("project")?.get("frame_range")?.as_array()?;
    let [first, last] = range.as_slice() else { return None };
    let number = |value: &toml::Value| value.as_integer().and_then(|number| u64::try_from(number).ok());
    let (first, last) = (number(first)?, number(last)?);
    (first < last).then_some([first, last])
}
