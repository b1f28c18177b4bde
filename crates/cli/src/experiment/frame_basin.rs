//! `backlit experiment basin --take`: the basin of one frame of a take, or its map of two angles, as the window's Basin
//! pane has them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use backlit_formats::Take;
use backlit_formats::pose_file::{self, Quaternions};
use backlit_runs::basin::{
    Angle, BasinOptions, BasinResult, ComparedFit, Direction, FitChoice, LevelReport, MOST_COMPARED,
    RandomStarts, StartGrid, Starts, Subject, Target, name_choices,
};
use backlit_tracking::body::{Model, Pose};
use backlit_tracking::search::start::{self, LEVELS, Level};
use clap::Args;

use super::Run;
use super::arguments::OutputArguments;
use super::basin::count_of;
use crate::numbers::within;
use crate::output::number;
use crate::table::Table;
use crate::take_options;

/// Metres that the root is moved a degree, where the table of levels has no such angle.
const METRES_A_DEGREE: f64 = 0.005;

/// Reads two angles of the body, each by its limb: across and up.
fn two_angles(text: &str) -> Result<[(String, Angle); 2], &'static str> {
    let angle = |text: &str| {
        let (joint, axis) = text.trim().rsplit_once('.')?;
        let angle = Angle::ALL.into_iter().find(|angle| angle.name() == axis)?;
        (!joint.is_empty()).then(|| (joint.to_owned(), angle))
    };
    let angles = text.split_once(',').and_then(|(across, up)| Some([angle(across)?, angle(up)?]));
    angles.ok_or("expected two angles as JOINT.AXIS,JOINT.AXIS, with flexion, sideways or twist for AXIS")
}

/// One frame of a take in place of drawn scenes.
#[derive(Debug, Args)]
#[command(next_help_heading = "One frame of a take")]
pub(crate) struct FrameArguments {
    /// Take whose frame is used with all its cameras, instead of drawn scenes: its folder or its take.toml
    #[arg(long, value_name = "TAKE", conflicts_with_all = ["cameras", "size"])]
    pub(crate) take: Option<PathBuf>,
    /// The frame, counted from 0 [0 to 999999]
    #[arg(long, value_name = "K", default_value_t = 0, requires = "take", value_parser = within(0..=999_999_usize))]
    frame: usize,
    /// Turn this limb's joint alone, by the limb's name
    #[arg(long, value_name = "LIMB", requires = "take", conflicts_with = "map")]
    joint: Option<String>,
    /// Pose to draw starts around, a backlit-pose file; a fit succeeds if it ends where its own fit ends [default: the truth,
    /// where the take has reference keypoints in the frame, else the take's start]
    #[arg(long, value_name = "POSE", requires = "take")]
    about: Option<PathBuf>,
    /// How far the root is moved, centimetres, one for each angle, the last one for all that follow [default: 2, 5,
    /// 10, 15 and 20 at 5, 10, 20, 30 and 45 degrees, half a centimetre a degree at others] [0 to 1000]
    #[arg(long, value_name = "CM,…", value_delimiter = ',', requires = "take", conflicts_with = "map", value_parser = within(0.0..=1000.0_f64))]
    root: Vec<f64>,
    /// A fit has found its target when root and leaf joints are less than this off on average, millimetres [0 to 10000]
    #[arg(long, value_name = "MM", default_value_t = 20.0, requires = "take", value_parser = within(0.0..=10_000.0_f64))]
    within: f64,
    /// Fit the same starts in other ways too, three at most: robust, report, or search, which is robust with a search
    /// for other hypotheses; a solid behind a colon if wanted: search:cylinder
    #[arg(long, value_name = "WAY,…", value_delimiter = ',', requires = "take")]
    compare: Vec<ComparedFit>,
    /// A map instead of random starts: two angles of the body, across and up, are turned away on a grid. By limb and
    /// flexion, sideways or twist: "right forearm.flexion,right forearm.twist"
    #[arg(long, value_name = "JOINT.AXIS,JOINT.AXIS", value_parser = two_angles, requires = "take")]
    map: Option<[(String, Angle); 2]>,
    /// How far a map turns the angles to either side, degrees [0.1 to 180]
    #[arg(long, value_name = "DEG", default_value_t = 60.0, requires = "map", value_parser = within(0.1..=180.0_f64))]
    farthest: f64,
    /// Cells of a map across and up; with an odd number the pose itself is one of them [1 to 101]
    #[arg(long, value_name = "N", default_value_t = 11, requires = "map", value_parser = within(1..=101_usize))]
    cells: usize,
}

/// The rotation of a limb's joint, by the limb's name.
fn rotation_of(model: &Model, name: &str, option: &str) -> anyhow::Result<usize> {
    let limb = model.limb_index(name).with_context(|| format!("{option}: the body has no limb {name}"))?;
    Ok(model.limbs()[limb].rotation)
}

impl FrameArguments {
    /// Tries the frame of the take, writes and prints.
    ///
    /// # Errors
    /// Returns an error if an option is out of range, if the take cannot be read, or if a file cannot be written.
    pub(crate) fn run(
        &self,
        take: &Path,
        (angles, starts, seed): (&[u32], &str, u64),
        choice: FitChoice,
        output: &OutputArguments,
    ) -> anyhow::Result<()> {
        let count = count_of(starts)?.context("--starts: with --take expected a number")?;
        let footage = take_options::open(take)?;
        let (take, frame) = (footage.take(), self.frame);
        let frames = take.frame_count();
        ensure!(frame < frames, "there is no frame {frame}; the take has {frames}");
        let cameras: Vec<usize> = (0..take.rig().count()).collect();
        let (reference, target) = self.reference(take)?;
        let subject =
            Subject { model: take.model().clone(), views: footage.fit_views(&cameras, frame)?, reference };
        let conditions = format!("{}, frame {frame}, {} cameras", take.name(), cameras.len());
        let options = BasinOptions {
            choices: self.choices(choice)?,
            starts: self.starts(&subject.model, angles, count, seed)?,
            target,
            success_mm: self.within,
        };
        let run = Run::listening()?;
        let result = BasinResult::new(frame, conditions, options, subject).run(&run.cancel, |fits| {
            // Who is interrupted is told below.
            let _ = run.progress(fits.done, fits.total);
        });
        run.end()?;
        let result = result?;
        let (name, text) = match result.grid() {
            Some(grid) => ("basin-map", letters(&result, grid)),
            None => ("basin", table(&result)),
        };
        let json = result.json()?;
        let printed = String::from_utf8_lossy(&json).into_owned();
        let files = [("json", json), ("csv", result.csv()?), ("png", result.png(output.theme)?)];
        output.finish(files.map(|(ending, bytes)| (format!("{name}.{ending}"), bytes)), &printed, &text)
    }

    /// The starts that are asked for: a map, or random ones.
    fn starts(&self, model: &Model, angles: &[u32], starts: usize, seed: u64) -> anyhow::Result<Starts> {
        if let Some([across, up]) = &self.map {
            let direction = |(joint, angle): &(String, Angle)| {
                rotation_of(model, joint, "--map").map(|rotation| Direction { rotation, angle: *angle })
            };
            let directions = [direction(across)?, direction(up)?];
            return Ok(Starts::Grid(StartGrid { directions, degrees: self.farthest, cells: self.cells }));
        }
        let rotation = self.joint.as_deref().map(|name| rotation_of(model, name, "--joint")).transpose()?;
        Ok(Starts::Random(RandomStarts { rotation, levels: self.levels(angles), starts, seed }))
    }

    /// The choices of fit that are compared, named by what differs.
    fn choices(&self, first: FitChoice) -> anyhow::Result<Vec<FitChoice>> {
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
    fn reference(&self, take: &Take) -> anyhow::Result<(Pose, Target)> {
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

fn table(result: &BasinResult) -> String {
    let choices = result.report.choices.iter();
    let rows = choices.flat_map(|choice| choice.levels.iter().map(move |level| (&choice.name, level)));
    Table::of(
        rows,
        &[
            ("fit", &|(name, _)| (*name).clone()),
            ("start off by", &|(_, LevelReport { level, .. })| {
                format!("{}°, {:.1} cm", level.degrees, 100.0 * level.metres)
            }),
            ("found", &|(_, one)| format!("{} of {}", one.rate.found, one.rate.tried)),
            ("%", &|(_, one)| number(100.0 * one.rate.success.unwrap_or_default(), 1)),
            ("surely, %", &|(_, one)| {
                let [low, high] = one.rate.interval.map(|end| 100.0 * end);
                format!("{low:.0} to {high:.0}")
            }),
            ("median, mm", &|(_, one)| number(one.rate.median_mm.unwrap_or_default(), 1)),
        ],
    )
}

/// Every choice's map in letters, and how many of its cells found their target.
fn letters(result: &BasinResult, grid: &StartGrid) -> String {
    let [across, up] = result.directions(grid);
    let mut text = format!(
        "Across: {across}. Up: {up}. Both from {} to {} degrees. o: ends within {} mm\n",
        -grid.degrees, grid.degrees, result.options.success_mm
    );
    for (index, choice) in result.options.choices.iter().enumerate() {
        let [tried, found] = result.counts(index);
        let _ = writeln!(text, "\n{}: {found} of {tried}", choice.name);
        for row in result.trials_of(index).chunks(grid.cells).rev() {
            let letter = |trial: &Option<_>| {
                if trial.is_some_and(|trial| result.is_found(&trial)) { "o" } else { "." }
            };
            let letters: Vec<&str> = row.iter().map(letter).collect();
            text += &(letters.join(" ") + "\n");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_read() {
        let expected = [("right forearm".to_owned(), Angle::Flexion), ("neck".to_owned(), Angle::Twist)];
        assert_eq!(two_angles("right forearm.flexion, neck.twist"), Ok(expected));
        for wrong in ["", "neck.twist", "neck.twist,neck", "neck.turn,neck.twist", ".twist,neck.twist"] {
            assert!(two_angles(wrong).is_err(), "{wrong}");
        }
    }
}
