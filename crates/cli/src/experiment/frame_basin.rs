//! `backlit experiment basin --take`: the basin of one frame of a take, as the window's Basin pane has it.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use backlit_formats::Take;
use backlit_formats::pose_file::{self, Quaternions};
use backlit_lab::experiment::frame_basin::{Frame, FrameBasin, Options, Report, Target};
use backlit_lab::experiment::starts::{LEVELS, Level};
use backlit_lab::experiment::{ExperimentError, FitChoice, Progress};
use backlit_results::basin::{About, AnglesResult, Compared, MOST_COMPARED, name_choices};
use backlit_tracking::body::Model;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::search::start;
use clap::Args;

use super::arguments::OutputArguments;
use super::basin_map::MapAngles;
use super::files::{self, ResultFiles};
use super::waiting::Waiting;
use crate::table::Table;
use crate::take_options;

/// Metres that the root is moved a degree, where the table of levels has no such angle.
const METRES_A_DEGREE: f64 = 0.005;

/// One frame of a take in place of drawn scenes.
#[derive(Debug, Args)]
#[command(next_help_heading = "One frame of a take")]
pub(crate) struct FrameArguments {
    /// Take whose frame is used with all its cameras, instead of drawn scenes: its folder or its take.toml
    #[arg(long, value_name = "TAKE", conflicts_with_all = ["cameras", "size"])]
    pub(crate) take: Option<PathBuf>,
    /// The frame, counted from 0
    #[arg(long, value_name = "K", default_value_t = 0, requires = "take")]
    frame: usize,
    /// Turn this limb's joint alone, by the limb's name
    #[arg(long, value_name = "LIMB", requires = "take", conflicts_with = "map")]
    joint: Option<String>,
    /// Pose to draw starts around, a backlit-pose file; a fit succeeds if it ends where its own fit ends [default: the truth,
    /// where the take has reference keypoints in the frame, else the take's start]
    #[arg(long, value_name = "POSE", requires = "take")]
    about: Option<PathBuf>,
    /// How far the root is moved, centimetres, one for each angle, the last one for all that follow [default: 2, 5,
    /// 10, 15 and 20 at 5, 10, 20, 30 and 45 degrees, half a centimetre a degree at others]
    #[arg(long, value_name = "CM,…", value_delimiter = ',', requires = "take", conflicts_with = "map")]
    root: Vec<f64>,
    /// A fit has found its target when root and leaf joints are less than this off on average, millimetres
    #[arg(long, value_name = "MM", default_value_t = 20.0, requires = "take")]
    pub(crate) within: f64,
    /// Fit the same starts in other ways too, three at most: robust, report, or search, which is robust with a search
    /// for other hypotheses; a solid behind a colon if wanted: search:cylinder
    #[arg(long, value_name = "WAY,…", value_delimiter = ',', requires = "take")]
    compare: Vec<Compared>,
    /// A map instead of random starts: two angles of the body, across and up, are turned away on a grid. By limb and
    /// flexion, sideways or twist: "right forearm.flexion,right forearm.twist"
    #[arg(long, value_name = "JOINT.AXIS,JOINT.AXIS", requires = "take")]
    pub(crate) map: Option<MapAngles>,
    /// How far a map turns the angles to either side, degrees
    #[arg(long, value_name = "DEG", default_value_t = 60.0, requires = "map")]
    pub(crate) farthest: f64,
    /// Cells of a map across and up; with an odd number the pose itself is one of them
    #[arg(long, value_name = "N", default_value_t = 11, requires = "map")]
    pub(crate) cells: usize,
}

/// What is tried of a take: its frame as the fits see it, and where they are to end.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) frame: Frame,
    /// Where fits are to end.
    pub(crate) target: Target,
    /// The conditions in one line.
    pub(crate) about: About,
}

/// Tries the frame, writes and prints.
///
/// # Errors
/// Options that make no sense, a take that cannot be read, or files that cannot be written.
pub(crate) fn run(
    arguments: &FrameArguments,
    path: &Path,
    (angles, starts, seed): (&[u32], &str, u64),
    choice: FitChoice,
    output: &OutputArguments,
) -> anyhow::Result<()> {
    let starts =
        starts.parse().with_context(|| format!("--starts is {starts}; with --take expected a number"))?;
    let Subject { frame, target, about } = arguments.subject(path)?;
    let model = frame.model.clone();
    let rotation = arguments.joint.as_deref().map(|name| rotation_of(&model, name, "--joint")).transpose()?;
    let choices = arguments.choices(choice)?;
    let (levels, success_mm) = (arguments.levels(angles), arguments.within);
    let options = Options { choices, rotation, levels, starts, seed, target, success_mm };
    let basin = FrameBasin::new(frame, options.clone(), &CancelToken::new())?;
    let trials = all_of(basin.len(), |trial| basin.run(trial, &CancelToken::new()))?;
    let report = Report::of(&options, &trials);
    let result = AnglesResult { about, options, trials, report };
    let png = result.figure().png(output.theme.into())?;
    let files = ResultFiles { json: result.json()?, csv: result.csv()?, png };
    files::finish_result(output, "basin", &files, &table(&result.report))
}

/// All of so many fits, with a bar while they are made.
///
/// # Errors
/// That of the first fit that fails.
pub(crate) fn all_of<T>(
    total: usize,
    mut fit: impl FnMut(usize) -> Result<T, ExperimentError>,
) -> anyhow::Result<Vec<T>> {
    let mut listener = Waiting::new().listener();
    let mut found = Vec::with_capacity(total);
    for done in 0..total {
        listener(Progress { done, total });
        found.push(fit(done)?);
    }
    listener(Progress { done: total, total });
    Ok(found)
}

/// The rotation of a limb's joint, by the limb's name.
///
/// # Errors
/// The body has no such limb.
pub(crate) fn rotation_of(model: &Model, name: &str, option: &str) -> anyhow::Result<usize> {
    let limb = model.limb_index(name).with_context(|| format!("{option}: the body has no limb {name}"))?;
    Ok(model.limbs()[limb].rotation)
}

impl FrameArguments {
    /// Reads the take's frame.
    ///
    /// # Errors
    /// A take or a pose that cannot be read, or a frame that the take does not have.
    pub(crate) fn subject(&self, path: &Path) -> anyhow::Result<Subject> {
        let footage = take_options::open(path)?;
        let take = footage.take();
        let count = take.frame_count();
        ensure!(self.frame < count, "there is no frame {}; the take has {count}", self.frame);
        let cameras: Vec<usize> = (0..take.rig().count()).collect();
        let (reference, target) = self.reference(take)?;
        let model = take.model().clone();
        let views = footage.fit_views(&cameras, self.frame)?;
        let conditions = format!("{}, frame {}, {} cameras", take.name(), self.frame, cameras.len());
        let about = About { frame: self.frame, conditions };
        Ok(Subject { frame: Frame { model, views, reference }, target, about })
    }

    /// The choices of fit that are compared, named by what differs.
    ///
    /// # Errors
    /// Too many of them.
    pub(crate) fn choices(&self, first: FitChoice) -> anyhow::Result<Vec<FitChoice>> {
        ensure!(self.compare.len() <= MOST_COMPARED, "--compare: expected {MOST_COMPARED} ways at most");
        let mut choices = vec![first];
        choices.extend(self.compare.iter().map(|compared| compared.choice()));
        name_choices(&mut choices);
        Ok(choices)
    }

    fn levels(&self, angles: &[u32]) -> Vec<Level> {
        let all: Vec<u32> = LEVELS.iter().map(|level| level.degrees).collect();
        let angles = if angles.is_empty() { &all } else { angles };
        let level = |(index, &degrees): (usize, &u32)| {
            let known = || LEVELS.iter().find(|level| level.degrees == degrees).map(|level| level.metres);
            let typed = self.root.get(index).or(self.root.last()).map(|cm| 0.01 * cm);
            let metres = typed.or_else(known).unwrap_or(METRES_A_DEGREE * f64::from(degrees));
            Level { degrees, metres }
        };
        angles.iter().enumerate().map(level).collect()
    }

    /// The pose that starts are drawn about, and where fits are to end.
    fn reference(&self, take: &Take) -> anyhow::Result<(backlit_tracking::body::Pose, Target)> {
        if let Some(path) = &self.about {
            return Ok((pose_file::read(path, take.model(), Quaternions::Normalised)?, Target::Fit));
        }
        let joints = take_options::reference_joints(take, self.frame);
        if let Some(pose) = start::from_joints(take.model(), &joints) {
            return Ok((pose, Target::Reference));
        }
        let start = take.start().context("the take knows no pose of this frame: --about POSE is needed")?;
        Ok((start.clone(), Target::Fit))
    }
}

fn table(report: &Report) -> String {
    let mut table = Table::new(["fit", "start off by", "found", "%", "surely, %", "median, mm"]);
    let levels =
        report.choices.iter().flat_map(|choice| choice.levels.iter().map(move |level| (choice, level)));
    for (choice, level) in levels {
        let [low, high] = level.interval.map(|end| 100.0 * end);
        table.row([
            choice.name.clone(),
            format!("{}°, {:.1} cm", level.degrees, 100.0 * level.metres),
            format!("{} of {}", level.found, level.tried),
            format!("{:.1}", 100.0 * level.success.unwrap_or_default()),
            format!("{low:.0} to {high:.0}"),
            format!("{:.1}", level.median_mm.unwrap_or_default()),
        ]);
    }
    table.to_text()
}
