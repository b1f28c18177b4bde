//! Options that choose a part of a take: which frames, which cameras, where to begin.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context, bail, ensure};
use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::trc::Axes;
use backlit_formats::{Footage, Take, model_file, placement_file};
use backlit_runs::results::{self, is_project};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::camera::RigError;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::metrics::{JointErrors, ReferenceJoints};
use backlit_tracking::search::start;
use backlit_tracking::segment::SegmentOptions;
use clap::Args;
use clap::error::ErrorKind;
use serde::Serialize;

use crate::fit_options::Words;
use crate::numbers::within;
use crate::{output, person};

/// Which part of a take.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Which part of the take")]
pub(crate) struct PartArguments {
    /// Frames A to B, without B: A..B, A.., ..B; or with B: A..=B; or one frame K [default: all]
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub(crate) frames: Option<FrameSpan>,
    /// Use only every Kth frame [1 to 1000000]
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = within(1..=1_000_000_u32))]
    pub(crate) every: u32,
    /// Names of the cameras to use, with commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) cameras: Option<Vec<String>>,
}

impl PartArguments {
    pub(crate) fn frames(&self, take: &Take) -> anyhow::Result<Vec<usize>> {
        let count = take.frame_count();
        let range = self.frames.unwrap_or_default();
        let past = range.past.unwrap_or(count);
        if past > count {
            bail!(
                "--frames: the take has {count} frames, counted from 0; frame {} is not among them",
                past - 1
            );
        }
        if range.first >= past {
            bail!("--frames: there is no frame from {} up to {past}; the take has {count}", range.first);
        }
        Ok((range.first..past).step_by(self.every as usize).collect())
    }

    /// Indices of the cameras asked for, in the take's order.
    pub(crate) fn cameras(&self, take: &Take) -> anyhow::Result<Vec<usize>> {
        camera_indices(take, self.cameras.as_deref()).context("--cameras")
    }
}

/// Indices of the cameras with these names, in the take's order; of all without names.
pub(crate) fn camera_indices(take: &Take, names: Option<&[String]>) -> Result<Vec<usize>, RigError> {
    let rig = take.rig();
    let Some(names) = names else { return Ok((0..rig.count()).collect()) };
    let indices: Result<BTreeSet<usize>, _> = names.iter().map(|name| rig.index(name.trim())).collect();
    Ok(indices?.into_iter().collect())
}

/// Frames `first` to `past`, which is left out; without it to the end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct FrameSpan {
    /// The first frame.
    pub(crate) first: usize,
    /// One past the last frame.
    pub(crate) past: Option<usize>,
}

impl FromStr for FrameSpan {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected A..B, A.., ..B, A..=B or one frame";
        let number =
            |text: &str| text.parse().ok().filter(|&frame: &usize| frame < usize::MAX).ok_or(EXPECTED);
        let Some((first, last)) = text.split_once("..") else {
            let frame = number(text)?;
            return Ok(Self { first: frame, past: Some(frame + 1) });
        };
        let past = match last.strip_prefix('=') {
            Some(last) => Some(number(last)? + 1),
            None if last.is_empty() => None,
            None => Some(number(last)?),
        };
        Ok(Self { first: if first.is_empty() { 0 } else { number(first)? }, past })
    }
}

/// Where a fit begins.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Where to begin")]
pub(crate) struct StartArguments {
    /// A backlit-pose file; or reference: a pose made from the reference keypoints of the first frame; or search: found from the
    /// silhouettes [default: the take's own start, else reference, else search]
    #[arg(long, value_name = "POSE")]
    pub(crate) start: Option<PathBuf>,
    /// Noise on the start: an angle for every rotation and a distance for the root, e.g. 5deg,3cm [0 to 180deg, 0 to 100m]
    #[arg(long, value_name = "ANGLE,DISTANCE", allow_hyphen_values = true)]
    pub(crate) start_noise: Option<StartNoise>,
    /// Seed of the noise [0 to 4294967295]
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = within(0..=4_294_967_295_u64))]
    pub(crate) seed: u64,
}

impl StartArguments {
    /// Nothing asked for: the take's own start, else its reference, without noise.
    pub(crate) fn none() -> Self {
        Self { start: None, start_noise: None, seed: 0 }
    }

    /// The pose to begin `frame` with; `None` where the take has nothing to begin with.
    pub(crate) fn known_pose(&self, take: &Take, frame: usize) -> anyhow::Result<Option<Pose>> {
        let pose = match &self.start {
            Some(word) if word == Path::new("reference") => {
                from_reference(take, frame).with_context(|| {
                    format!("--start reference: the take has no reference keypoints in frame {frame}")
                })?
            }
            Some(word) if word == Path::new("search") => return Ok(None),
            Some(path) => pose_file::read(path, take.model(), Quaternions::Normalised)?,
            None => match take.start().cloned().or_else(|| from_reference(take, frame)) {
                Some(pose) => pose,
                None => return Ok(None),
            },
        };
        Ok(Some(self.with_noise(take.model(), pose)))
    }

    /// The pose to begin `frame` with: as [`known_pose`](Self::known_pose), else found from the silhouettes.
    pub(crate) fn pose(
        &self,
        footage: &Footage,
        cameras: &[usize],
        frame: usize,
        fit: &FitOptions,
    ) -> anyhow::Result<Pose> {
        let take = footage.take();
        match self.known_pose(take, frame)? {
            Some(pose) => Ok(pose),
            None => {
                let found = person::search_start(footage, cameras, frame, fit)?;
                Ok(self.with_noise(take.model(), found))
            }
        }
    }

    /// The pose to begin with where there is no take.
    pub(crate) fn pose_of(&self, model: &Model) -> anyhow::Result<Pose> {
        let Some(path) = &self.start else {
            let message = "without a take, --start POSE is needed\n";
            return Err(clap::Error::raw(ErrorKind::MissingRequiredArgument, message).into());
        };
        Ok(self.with_noise(model, pose_file::read(path, model, Quaternions::Normalised)?))
    }

    fn with_noise(&self, model: &Model, pose: Pose) -> Pose {
        match self.start_noise {
            Some(StartNoise { angle_rad, distance_m }) => {
                start::perturb(model, &pose, angle_rad, distance_m, self.seed)
            }
            None => pose,
        }
    }
}

fn from_reference(take: &Take, frame: usize) -> Option<Pose> {
    start::from_joints(take.model(), &reference_joints(take, frame))
}

/// The take's reference keypoints of a frame; none if it has none.
pub(crate) fn reference_joints(take: &Take, frame: usize) -> ReferenceJoints {
    take.reference().map(|reference| reference.joints(frame)).unwrap_or_default()
}

/// Keypoints of another tool.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "What to compare with")]
pub(crate) struct ReferenceArguments {
    /// Keypoints to measure joint errors against, instead of the take's: a TRC of another tool, or a table
    /// frame,joint,x,y,z. Neither start nor fit uses them
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// Which of the file's axes are the world's x, y and z, as zxy or x-zy [default: xyz, or zxy of a file whose Y is up, whichever
    /// puts the markers before the cameras]
    #[arg(long, value_name = "AXES", requires = "reference", allow_hyphen_values = true, value_parser = axes)]
    reference_axes: Option<Axes>,
    /// Which frame number of the file is frame 0 of the take [0 to 1000000000] [default: that of the first row; for a CSV, 0]
    #[arg(long, value_name = "N", requires = "reference", value_parser = within(0..=1_000_000_000_u64))]
    reference_first: Option<u64>,
    /// Where the keypoints' tool puts its markers beside the joints, as --learn-placement has written it; the line "placed" is by it
    /// [default: that of the take, else learnt in frames that are not judged]
    #[arg(long, value_name = "FILE")]
    placement: Option<PathBuf>,
    /// Learn from all tracked frames where the keypoints' tool puts its markers, and write that to this file
    #[arg(long, value_name = "FILE")]
    learn_placement: Option<PathBuf>,
    /// The tool of whose keypoints --learn-placement learns, as coco or openpose
    #[arg(long, value_name = "NAME", default_value = "own", requires = "learn_placement")]
    tool: String,
}

impl ReferenceArguments {
    /// The take with these keypoints and this placement, if any are named.
    pub(crate) fn take(&self, take: &Take) -> anyhow::Result<Option<Take>> {
        let mut judge = None;
        if let Some(path) = &self.reference {
            let other = take.with_reference(path, self.reference_axes, self.reference_first);
            judge = Some(other.context("--reference")?);
        }
        if let Some(out) = &self.learn_placement {
            output::check_folder_of(out)?;
        }
        let placed = self.placement.as_ref().or(self.learn_placement.as_ref());
        if placed.is_some() && judge.as_ref().unwrap_or(take).reference().is_none() {
            bail!(
                "there are no keypoints that could be placed: the take has no [reference], and --reference names none"
            );
        }
        if let Some(path) = &self.placement {
            let placement = placement_file::read(path, take.model()).context("--placement")?;
            judge = Some(judge.as_ref().unwrap_or(take).with_placement(placement));
        }
        Ok(judge)
    }

    /// Writes where the keypoints' tool puts its markers, if that is asked for.
    pub(crate) fn learn(&self, errors: &JointErrors) -> anyhow::Result<()> {
        let Some(path) = &self.learn_placement else { return Ok(()) };
        let placement = errors.placement(self.tool.trim());
        ensure!(
            !placement.offsets.is_empty(),
            "--learn-placement: the tracked frames have too few keypoints"
        );
        Ok(placement_file::write(path, &placement)?)
    }
}

fn axes(text: &str) -> Result<Axes, &'static str> {
    Axes::parse(text).ok_or("expected three letters that turn the file's axes, as zxy or x-zy")
}

/// How silhouettes are made of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Segmentation {
    Take,
    Decided,
    Report,
}

impl Segmentation {
    /// Its words.
    pub(crate) const WORDS: Words<Self> = &[
        ("take", "As the take says", Self::Take),
        ("decided", "The same with every pixel subject or background, none unknown", Self::Decided),
        ("report", "(4.25) to the letter: grey levels, β 3.891, two classes, nothing cleaned", Self::Report),
    ];

    /// The take so segmented. Silhouettes that were made elsewhere stay.
    pub(crate) fn of(self, take: Take) -> Take {
        match self {
            Self::Take => take,
            Self::Decided => take.with_measurement(|own, _| own.decided()),
            Self::Report => take.with_measurement(SegmentOptions::report),
        }
    }
}

/// Opens a take: its folder, its take file, or a project about it.
pub(crate) fn open(path: &Path) -> anyhow::Result<Arc<Footage>> {
    open_segmented(path, None, Segmentation::Take)
}

/// The same with another body in place of the take's, if one is named: a file, or a built-in one.
pub(crate) fn open_with_model(path: &Path, model: Option<&str>) -> anyhow::Result<Arc<Footage>> {
    open_segmented(path, model, Segmentation::Take)
}

/// The same segmented in another way than the take says.
pub(crate) fn open_segmented(
    path: &Path,
    model: Option<&str>,
    segmentation: Segmentation,
) -> anyhow::Result<Arc<Footage>> {
    let model = model.map(model_file::resolve).transpose()?;
    open_with_body(path, model, segmentation)
}

/// The same with a body in place of the take's.
pub(crate) fn open_with_body(
    path: &Path,
    model: Option<Model>,
    segmentation: Segmentation,
) -> anyhow::Result<Arc<Footage>> {
    let footage = match model {
        _ if is_project(path) => of_project(path, model, segmentation)?,
        Some(model) => Footage::new(segmentation.of(with_notes_shown(Take::open_with_model(path, model)?))),
        None if path.is_dir() && !path.join("take.toml").exists() => {
            bail!("{}: has no take.toml; expected a take's folder or its take file", path.display());
        }
        None => Footage::new(segmentation.of(with_notes_shown(Take::open(path)?))),
    };
    Ok(Arc::new(footage))
}

/// The take of a project, with the project's body, start, cameras and silhouettes in the place of its own.
fn of_project(path: &Path, model: Option<Model>, segmentation: Segmentation) -> anyhow::Result<Footage> {
    let (document, take) = results::open_project(path, None)?;
    let body = model.map_or_else(|| document.model.clone(), Arc::new);
    let take = with_notes_shown(take).with_body(body);
    let take =
        take.with_context(|| format!("{}: the body has other limbs than the take's", path.display()))?;
    let measured = document.measurement.iter().cloned();
    let take = segmentation.of(take.measured_by(measured.collect()).with_start(document.pose_at(0).clone()));
    Ok(document.footage(&Footage::new(take)))
}

/// Says what a take that was opened reads outside its own folder, and what is missing in its footage.
pub(crate) fn with_notes_shown(take: Take) -> Take {
    let outside = take.outside().map(ToString::to_string);
    outside.into_iter().chain(take.notes()).for_each(|remark| note(&remark));
    take
}

/// Says what was found to be missing since a take was opened: damage in a video is known once its frames were read.
pub(crate) fn show_new_notes(take: &Take, known: &[String]) {
    take.notes().iter().filter(|remark| !known.contains(remark)).for_each(|remark| note(remark));
}

fn note(remark: &str) {
    output::complain(&format!("note: {remark}"));
}

/// Starts are turned and moved no farther.
const MOST_NOISE_RAD: f64 = std::f64::consts::PI;
const MOST_NOISE_M: f64 = 100.0;

/// How far a start is moved away.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct StartNoise {
    /// Angle of every rotation, radians.
    pub(crate) angle_rad: f64,
    /// Distance of the root, metres.
    pub(crate) distance_m: f64,
}

impl FromStr for StartNoise {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected an angle in deg or rad, up to half a turn, a comma and a distance in mm, cm or m, up \
             to 100 m: 5deg,3cm";
        let (angle, distance) = text.split_once(',').ok_or(EXPECTED)?;
        let degree = 1_f64.to_radians();
        let angle_rad = quantity(angle, &[("deg", degree), ("rad", 1.0)]).ok_or(EXPECTED)?;
        let distance_m = quantity(distance, &[("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)]).ok_or(EXPECTED)?;
        let is_near = angle_rad <= MOST_NOISE_RAD && distance_m <= MOST_NOISE_M;
        if is_near { Ok(Self { angle_rad, distance_m }) } else { Err(EXPECTED) }
    }
}

/// A finite number, 0 or more, with one of these units. The first unit that fits counts.
fn quantity(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let (number, unit) =
        units.iter().find_map(|(name, unit)| Some((text.trim().strip_suffix(name)?, unit)))?;
    let number: f64 = number.trim().parse().ok()?;
    (number.is_finite() && number >= 0.0).then_some(number * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The built-in take has several pictures of its background, so that σ is believed as it is.
    #[test]
    fn a_take_is_segmented_as_asked_for() {
        let take = backlit_take::builtin::open().unwrap();
        let of = |how: Segmentation| how.of(take.clone()).measurement().to_vec();
        assert_eq!(of(Segmentation::Take), take.measurement());
        assert!(take.measurement().iter().all(|options| options.dont_know.is_some() && !options.grey));
        let decided = of(Segmentation::Decided);
        assert!(
            decided.iter().all(|options| options.dont_know.is_none() && !options.shadow.unwrap().unknown)
        );
        let literal = of(Segmentation::Report);
        assert!(literal.iter().all(|options| options.grey && options.noise_floor == 0.0));
    }

    #[test]
    fn ranges_are_read() {
        let range = |text: &str| text.parse::<FrameSpan>().ok().map(|range| (range.first, range.past));
        assert_eq!(range("3..7"), Some((3, Some(7))));
        assert_eq!(range("3..=7"), Some((3, Some(8))));
        assert_eq!(range("3.."), Some((3, None)));
        assert_eq!(range("..7"), Some((0, Some(7))));
        assert_eq!(range("5"), Some((5, Some(6))));
        for text in ["", "a..b", "-1..2", "1...2", "3..=", "1,2", "18446744073709551615"] {
            assert_eq!(range(text), None, "{text}");
        }
    }

    #[test]
    fn noise_has_units() {
        let noise = |text: &str| text.parse::<StartNoise>().ok().map(|n| (n.angle_rad, n.distance_m));
        assert_eq!(noise("180deg, 3cm"), Some((std::f64::consts::PI, 0.03)));
        assert_eq!(noise("0.5rad,20mm"), Some((0.5, 0.02)));
        for text in
            ["5,3", "181deg,3cm", "5deg,1e9m", "5deg", "5deg,3", "5deg,-3cm", "nandeg,3cm", "3cm,5deg"]
        {
            assert_eq!(noise(text), None, "{text}");
        }
    }
}
