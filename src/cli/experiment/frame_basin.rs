//! `backlit experiment basin --take`: the basin of one frame of a take, as the window's Basin pane has it.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::experiment::frame_basin::{Frame, FrameBasin, Options, Report, Target};
use backlit_tracking::experiment::starts::{LEVELS, Level};
use backlit_tracking::experiment::{FitChoice, Progress};
use backlit_tracking::io::Take;
use backlit_tracking::io::pose_file::{self, Quaternions};
use backlit_tracking::track::start;
use clap::Args;

use super::arguments::OutputArguments;
use super::files;
use super::waiting::Waiting;
use crate::basin::{About, AnglesResult};
use crate::cli::table::Table;
use crate::cli::take_options;

/// Metres that the root is moved a degree, where the table of levels has no such angle.
const METRES_A_DEGREE: f64 = 0.005;

/// One frame of a take in place of drawn scenes.
#[derive(Debug, Args)]
#[command(next_help_heading = "One frame of a take")]
pub struct FrameArguments {
    /// Take whose frame is tried with all its cameras, in place of drawn scenes: its folder or its take.toml
    #[arg(long, value_name = "TAKE", conflicts_with_all = ["cameras", "size"])]
    pub take: Option<PathBuf>,
    /// The frame, counted from 0
    #[arg(long, value_name = "K", default_value_t = 0, requires = "take")]
    frame: usize,
    /// Turn this limb's joint alone, by the limb's name
    #[arg(long, value_name = "LIMB", requires = "take")]
    joint: Option<String>,
    /// Pose to draw starts about, a backlit-pose file; fits are to end where its own fit ends [default: the truth,
    /// where the take has reference keypoints in the frame, else the take's start]
    #[arg(long, value_name = "POSE", requires = "take")]
    about: Option<PathBuf>,
    /// How far the root is moved, centimetres, one for each angle, the last one for all that follow [default: 2, 5,
    /// 10, 15 and 20 at 5, 10, 20, 30 and 45 degrees, half a centimetre a degree at others]
    #[arg(long, value_name = "CM,…", value_delimiter = ',', requires = "take")]
    root: Vec<f64>,
    /// A fit has found its target when root and leaf joints are less than this off on average, millimetres
    #[arg(long, value_name = "MM", default_value_t = 20.0, requires = "take")]
    within: f64,
}

/// Tries the frame, writes and prints.
///
/// # Errors
/// Options that make no sense, a take that cannot be read, or files that cannot be written.
pub fn run(
    arguments: &FrameArguments,
    path: &std::path::Path,
    (angles, starts, seed): (&[u32], &str, u64),
    choice: FitChoice,
    output: &OutputArguments,
) -> anyhow::Result<()> {
    let footage = take_options::open(path)?;
    let take = footage.take();
    let count = take.frame_count();
    ensure!(arguments.frame < count, "there is no frame {}; the take has {count}", arguments.frame);
    let starts =
        starts.parse().with_context(|| format!("--starts is {starts}; with --take expected a number"))?;
    let cameras: Vec<usize> = (0..take.rig().count()).collect();
    let (reference, target) = arguments.reference(take)?;
    let model = take.model().clone();
    let rotation = match &arguments.joint {
        Some(name) => {
            let limb =
                model.limb_index(name).with_context(|| format!("--joint: the body has no limb {name}"))?;
            Some(model.limbs()[limb].rotation)
        }
        None => None,
    };
    let levels = arguments.levels(angles);
    let success_mm = arguments.within;
    let options = Options { choices: vec![choice], rotation, levels, starts, seed, target, success_mm };
    let views = footage.fit_views(&cameras, arguments.frame)?;
    let basin = FrameBasin::new(Frame { model, views, reference }, options.clone(), &CancelToken::new())?;
    let mut listener = Waiting::new().listener();
    let total = basin.len();
    let mut trials = Vec::with_capacity(total);
    for done in 0..total {
        listener(Progress { done, total });
        trials.push(basin.run(done, &CancelToken::new())?);
    }
    listener(Progress { done: total, total });
    let report = Report::of(&options, &trials);
    let conditions = format!("{}, frame {}, {} cameras", take.name(), arguments.frame, cameras.len());
    let about = About { frame: arguments.frame, conditions };
    let result = AnglesResult { about, options, trials, report };
    let figures = [("basin".to_owned(), result.figure())];
    files::finish(output, "basin", &result.options, &result.report, &figures, &table(&result.report))
}

impl FrameArguments {
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
    let mut table = Table::new(["start off by", "found", "%", "surely, %", "median, mm"]);
    for level in report.choices.iter().flat_map(|choice| &choice.levels) {
        let [low, high] = level.interval.map(|end| 100.0 * end);
        table.row([
            format!("{}°, {:.1} cm", level.degrees, 100.0 * level.metres),
            format!("{} of {}", level.found, level.tried),
            format!("{:.1}", 100.0 * level.success.unwrap_or_default()),
            format!("{low:.0} to {high:.0}"),
            format!("{:.1}", level.median_mm.unwrap_or_default()),
        ]);
    }
    table.to_text()
}
