//! `backlit fit-body`: a person's own lengths and radii, from several frames of a take.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context, bail, ensure};
use backlit_formats::pose_file::{self, Quaternions};
use backlit_formats::{Footage, Take, model_file};
use backlit_tracking::acquisition::{AcquireOptions, Acquired, acquire};
use backlit_tracking::body::{Model, Pose, SizeChoice};
use backlit_tracking::body_fit::{
    Approach, BodyFit, BodyFitOptions, BodyFrame, BodyProgress, FirstSizes, approach, fit_body, frames, scale,
};
use backlit_tracking::body_spheres::{PosedViews, SphereBody, SphereBodyOptions, sphere_body};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::FitOptions;
use backlit_tracking::metrics::ReferenceJoints;
use backlit_tracking::search::start;
use clap::Args;

use super::fit_body_report;
use super::fit_options::{Words, one_of};
use super::person::PersonArguments;
use super::take_options::{self, FrameSpan, PartArguments};
use crate::interrupt;
use crate::numbers::within;
use crate::{output, progress};

const AFTER_HELP: &str = "\
Sizes and the poses of all chosen frames are found together: from the silhouettes, from the proportions and \
girths of people, and from the take's keypoints in these frames if it has any: its reference's, else its \
cameras'. Silhouettes that are surely too wide all round are not mistaken for girth. Left and right share \
their sizes. The body is first scaled as a whole to the lowest-numbered frame, then tracked to the others.

Several frames of a movement are better than one: a T-pose shows radii and the lengths of arms; bent elbows \
and knees show where upper and lower limbs meet. A size is marked as a guess if the silhouettes say hardly \
more about it than the proportions of people do.

Examples:
  backlit fit-body TAKE --frames 0..300 --out person.toml
  backlit fit-body TAKE --acquire --out person.toml
  backlit fit-body TAKE --count 24 --spheres 800 --out spheres.toml
  backlit fit-body TAKE --frames 3,40,85 --model full_body --without-keypoints --json";

/// What `backlit fit-body` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct FitBodyArguments {
    /// Take: its folder, its take.toml, or a project about it
    take: PathBuf,
    /// Frames: a list 3,40,85, or a range A..B of which --count frames are taken, evenly spread [default: all]
    #[arg(long, value_name = "FRAMES", allow_hyphen_values = true)]
    frames: Option<FrameChoice>,
    /// How many frames to take from a range [1 to 64]
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = within(1..=64_u32))]
    count: u32,
    /// Names of the cameras to use, with commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    cameras: Option<Vec<String>>,
    #[command(flatten)]
    person: PersonArguments,
    /// The body to begin with: a file, or the name of a built-in one [default: the take's]
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// A pose near that of the lowest-numbered frame: a backlit-pose file [default: from the reference keypoints, else the
    /// take's own start]
    #[arg(long, value_name = "POSE")]
    start: Option<PathBuf>,
    /// Use neither a start nor keypoints: grow a first body and its pose in the lowest-numbered frame, and begin the fit with them
    #[arg(long, conflicts_with = "start")]
    acquire: bool,
    /// Do not hold joints near the take's keypoints: those of its reference, else those of its cameras
    #[arg(long)]
    without_keypoints: bool,
    /// Let left and right differ
    #[arg(long)]
    asymmetric: bool,
    /// Keep the proportions of all lengths, of all radii, or of both: then the body is only scaled as a whole
    #[arg(long, value_parser = one_of(HOLDS), value_name = "KIND")]
    hold: Option<[bool; 2]>,
    /// How much the proportions of people count [default, for a body built as the built-in full one:
    /// 0.2 with keypoints, without them 14, for people in clothes; for others 1 and 20] [0.000001 to 1000000]
    #[arg(long, value_name = "FACTOR", value_parser = within(1e-6..=1e6_f64))]
    proportions: Option<f64>,
    /// Make a body of spheres, about N in all: one tree for each limb, carved from the silhouettes and fitted to them; for
    /// --renderer sphere-tree [1 to 4096]
    #[arg(long, value_name = "N", value_parser = within(1..=4096_u32))]
    spheres: Option<u32>,
    /// Levels of those trees [1 to 6]
    #[arg(long, value_name = "L", default_value_t = 2, requires = "spheres", value_parser = within(1..=6_u32))]
    levels: u32,
    /// Write the body to this file
    #[arg(long, value_name = "MODEL.toml")]
    out: Option<PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Sizes that stay in proportion: lengths, radii.
const HOLDS: Words<[bool; 2]> = &[
    ("lengths", "All lengths", [true, false]),
    ("radii", "All radii", [false, true]),
    ("both", "Both", [true, true]),
];

/// Frames by number, or a range to choose from.
#[derive(Debug, Clone, PartialEq, Eq)]
enum FrameChoice {
    List(Vec<usize>),
    Range(FrameSpan),
}

impl FromStr for FrameChoice {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if !text.contains(',') && text.contains("..") {
            return text.parse().map(Self::Range);
        }
        let numbers: Option<Vec<usize>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        numbers.map(Self::List).ok_or("expected frames with commas (3,40,85) or a range (A..B)")
    }
}

impl FitBodyArguments {
    fn frames(&self, take: &Take) -> anyhow::Result<Vec<usize>> {
        let range = match &self.frames {
            Some(FrameChoice::List(frames)) => {
                let count = take.frame_count();
                if let Some(frame) = frames.iter().find(|&&frame| frame >= count) {
                    bail!(
                        "--frames: the take has {count} frames, counted from 0; frame {frame} is not among them"
                    );
                }
                return Ok(frames.clone());
            }
            Some(FrameChoice::Range(range)) => Some(*range),
            None => None,
        };
        let part = PartArguments { frames: range, every: 1, cameras: None };
        Ok(frames::spread(&part.frames(take)?, self.count as usize))
    }

    fn options(&self, model: &Model, has_joints: bool) -> BodyFitOptions {
        let [lengths, radii] = self.hold.unwrap_or_default();
        let choice = SizeChoice { symmetric: !self.asymmetric, lengths: !lengths, radii: !radii };
        let usual = BodyFitOptions::for_people(model, has_joints);
        let weighed = self.proportions.map(|factor| BodyFitOptions::default().with_proportions(factor));
        BodyFitOptions { choice, ..weighed.unwrap_or(usual) }
    }
}

pub(crate) fn run(arguments: &FitBodyArguments) -> anyhow::Result<()> {
    if let Some(out) = &arguments.out {
        output::check_folder_of(out)?;
    }
    let footage = take_options::open(&arguments.take)?;
    let cameras =
        take_options::camera_indices(footage.take(), arguments.cameras.as_deref()).context("--cameras")?;
    let chosen = arguments.frames(footage.take())?;
    // The body is tracked from one chosen frame to the next.
    let between: Vec<usize> = match (chosen.iter().min(), chosen.iter().max()) {
        (Some(&first), Some(&last)) => (first..=last).collect(),
        _ => Vec::new(),
    };
    let footage = arguments.person.follow(footage, &cameras, &between, &interrupt::listen()?)?;
    let take = footage.take();
    let model = match &arguments.model {
        Some(argument) => Arc::new(model_file::resolve(argument)?),
        None => Arc::clone(take.model()),
    };
    // Joints are held near keypoints wherever there are some.
    let of_cameras = match arguments.without_keypoints || take.reference().is_some() {
        true => BTreeMap::new(),
        false => take.keypoint_joints(&chosen)?,
    };
    let joints = |frame: usize| match arguments.without_keypoints {
        true => ReferenceJoints::new(),
        false => joints_of(take, &model, frame, &of_cameras),
    };
    let acquired = arguments.acquire.then(|| acquired(&footage, &cameras, &model, &chosen)).transpose()?;
    let plan = match &acquired {
        Some(acquired) => approach_to(take, acquired.poses[0].clone(), Some(0.0), chosen),
        None => plan(arguments, take, &model, chosen, &joints, &of_cameras)?,
    };
    let options = arguments.options(&model, plan.frames.iter().any(|&frame| !joints(frame).is_empty()));
    let grown = acquired.map(|acquired| acquired.model);
    let (fit, frames) = follow_and_fit(
        &footage,
        &cameras,
        [&model, grown.as_ref().unwrap_or(&model)],
        &plan,
        joints,
        &options,
    )?;
    let spheres = match arguments.spheres {
        Some(count) => Some(of_spheres(&fit, frames, count as usize, arguments.levels as usize)?),
        None => None,
    };
    if let Some(out) = &arguments.out {
        model_file::write(out, spheres.as_ref().map_or(&fit.model, |spheres| &spheres.model))?;
    }
    let answer = fit_body_report::answer(&fit, spheres.as_ref());
    let text = || fit_body_report::text(&fit, spheres.as_ref(), arguments.out.as_deref());
    output::print_result(arguments.json, &answer, text)
}

/// The fitted person as spheres, from the frames of the fit.
fn of_spheres(
    fit: &BodyFit,
    frames: Vec<BodyFrame>,
    spheres: usize,
    levels: usize,
) -> anyhow::Result<SphereBody> {
    let posed = fit.frames.iter().zip(&fit.poses).filter_map(|(number, pose)| {
        let frame = frames.iter().find(|frame| frame.frame == *number)?;
        Some(PosedViews { frame: *number, views: frame.views.clone(), pose: pose.clone() })
    });
    let spinner = progress::spinner();
    let options = SphereBodyOptions { spheres, levels, ..SphereBodyOptions::default() };
    let posed = posed.collect();
    let cancel = CancelToken::new();
    let body = sphere_body(&fit.model, posed, &options, &FitOptions::default(), &cancel, |at| {
        spinner.set_message(at.doing);
    })?;
    spinner.finish_and_clear();
    Ok(body)
}

fn follow_and_fit(
    footage: &Footage,
    cameras: &[usize],
    [model, followed]: [&Arc<Model>; 2],
    plan: &Approach,
    joints: impl Fn(usize) -> ReferenceJoints,
    options: &BodyFitOptions,
) -> anyhow::Result<(BodyFit, Vec<BodyFrame>)> {
    let spinner = progress::spinner();
    let cancel = CancelToken::new();
    let (size, frames) = approach(
        followed,
        plan,
        options,
        &cancel,
        |frame| -> anyhow::Result<_> { Ok(footage.fit_views(cameras, frame)?) },
        joints,
        |done, all| spinner.set_message(format!("on the way: frame {done} of {all}")),
    )?;
    let told = |progress: BodyProgress| {
        let (stage, stages) = (progress.stage + 1, progress.stages);
        spinner.set_message(format!("stage {stage} of {stages}, step {}", progress.iterations));
    };
    let grown = if Arc::ptr_eq(model, followed) { None } else { Some(followed.scaled(size.exp())?) };
    let first = grown.as_ref().map_or(FirstSizes::Scaled(size), FirstSizes::Known);
    let fit = fit_body(Arc::clone(model), frames.clone(), first, options, &cancel, told)?;
    spinner.finish_and_clear();
    let is_finite =
        fit.size.is_finite() && fit.girth.is_finite() && fit.sizes.iter().all(|size| size.found.is_finite());
    ensure!(is_finite, "no finite sizes were found: the silhouettes of these frames do not show the body");
    let name = format!("{}, fitted", model.name().trim_end_matches(", fitted"));
    Ok((BodyFit { model: fit.model.clone().renamed(&name), ..fit }, frames))
}

/// Where to begin, and how large the body is there.
fn plan(
    arguments: &FitBodyArguments,
    take: &Take,
    model: &Model,
    frames: Vec<usize>,
    joints: &impl Fn(usize) -> ReferenceJoints,
    of_cameras: &BTreeMap<usize, ReferenceJoints>,
) -> anyhow::Result<Approach> {
    let first = frames.iter().copied().min().unwrap_or(0);
    let known: Vec<ReferenceJoints> = frames.iter().map(|&frame| joints(frame)).collect();
    let size = scale::from_joints(model, &known);
    let start = match &arguments.start {
        Some(path) => pose_file::read(path, model, Quaternions::Normalised)?,
        None => {
            let scaled = model.scaled(size.unwrap_or(0.0).exp())?;
            let from_joints = || start::from_joints(&scaled, &joints_of(take, model, first, of_cameras));
            from_joints().or_else(|| own_start(take, model)).with_context(|| {
                format!(
                    "the take has neither reference keypoints in frame {first} nor a `start` for this body; give a \
                     pose with --start POSE"
                )
            })?
        }
    };
    Ok(approach_to(take, start, size, frames))
}

fn approach_to(take: &Take, start: Pose, size: Option<f64>, frames: Vec<usize>) -> Approach {
    // A twentieth of a second is near enough for tracking.
    let step = (take.frame_rate() / 20.0).round().max(1.0) as usize;
    Approach { start, size, frames, step }
}

/// A first body, grown in the smallest frame.
fn acquired(
    footage: &Footage,
    cameras: &[usize],
    model: &Arc<Model>,
    frames: &[usize],
) -> anyhow::Result<Acquired> {
    let first = frames.iter().copied().min().unwrap_or(0);
    let views = footage.fit_views(cameras, first)?;
    let acquired = acquire(model, &views, &AcquireOptions::default(), &CancelToken::new());
    acquired.with_context(|| format!("frame {first}: no first body can be grown"))
}

/// The take's reference keypoints of a frame, without a reference those of its cameras, by the limbs of another body with the
/// same names.
fn joints_of(
    take: &Take,
    model: &Model,
    frame: usize,
    of_cameras: &BTreeMap<usize, ReferenceJoints>,
) -> ReferenceJoints {
    let limbs = take.model().limbs();
    let joints = match take.reference() {
        Some(reference) => reference.joints(frame),
        None => of_cameras.get(&frame).cloned().unwrap_or_default(),
    };
    let joints = joints.into_iter();
    let named = joints.filter_map(|(limb, place)| match limb {
        Some(limb) => Some((Some(model.limb_index(&limbs[limb].name)?), place)),
        None => Some((None, place)),
    });
    named.collect()
}

/// The take's start as a pose of another body, by the names of its limbs.
fn own_start(take: &Take, model: &Model) -> Option<Pose> {
    let (start, from) = (take.start()?, take.model());
    let mut pose = Pose::rest(model);
    pose.root = start.root;
    for (rotation, &owner) in model.rotation_owners().iter().enumerate() {
        if let Some(limb) = from.limb_index(&model.limbs()[owner].name) {
            pose.rotations[rotation] = start.rotations[from.limbs()[limb].rotation];
        }
    }
    Some(pose)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_a_list_or_a_range() {
        assert_eq!("3, 40,85".parse(), Ok(FrameChoice::List(vec![3, 40, 85])));
        assert_eq!("7".parse(), Ok(FrameChoice::List(vec![7])));
        let range = FrameSpan { first: 2, past: Some(9) };
        assert_eq!("2..9".parse(), Ok(FrameChoice::Range(range)));
        for text in ["", "a", "1,,2", "-1", "1..2,3"] {
            assert!(text.parse::<FrameChoice>().is_err(), "{text}");
        }
    }
}
