//! `backlit observability`: what the cameras see of a frame's pose, direction by direction, and sets of cameras compared.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context;
use backlit_document::observability_words as words;
use backlit_tracking::body::Pose;
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::fit::{Fit, FitView};
use backlit_tracking::observability::{
    Direction, FrameInformation, JointUncertainty, Observability, SubsetFigures,
};
use backlit_words::format;
use backlit_words::joint::joint_name;
use clap::Args;
use serde::Serialize;

use super::camera_plan::PlanArguments;
use super::fit_options::SolverArguments;
use super::numbers::within;
use super::output::{self, object};
use super::table::Table;
use super::take_options::{self, StartArguments};

const AFTER_HELP: &str = "\
Singular values of JᵀJ come from the silhouettes alone, without priors, from every pixel and with the ramp \
of the last stage. \"Known to\" is one standard deviation at the joint that moves most.

With --plan no footage is needed: bodies of the model stand, walk and reach at places on the floor, and \
silhouettes are what the model predicts. A deviation is that of a joint in its worst direction, from one moment's silhouettes \
without priors; means count no joint as more than 250 mm off. Noise is that of real footage, the same everywhere; pictures finer \
than the solver is meant for count as no finer.

Examples:
  backlit observability TAKE --frame 12
  backlit observability TAKE --frame 12 --cameras cam1,cam3 --json
  backlit observability TAKE --plan --picture plan.png
  backlit observability calibration.toml --plan --area 4x3 --floor 0
  backlit observability --plan --ring 4 --radius 3.5 --field-of-view 55 --area 3x3";

/// What `backlit observability` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct ObservabilityArguments {
    /// Take: its folder, its take.toml, or a project about it; with --plan a calibration too
    #[arg(required_unless_present = "ring")]
    take: Option<PathBuf>,
    /// The take's frame, counted from 0 [0 to 999999]
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = within(0..=999_999_usize))]
    frame: usize,
    /// Names of the cameras to use, with commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    cameras: Option<Vec<String>>,
    /// Look at the start as it is, without a fit
    #[arg(long)]
    no_fit: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    start: StartArguments,
    #[command(flatten)]
    solver: SolverArguments,
    #[command(flatten)]
    plan: PlanArguments,
}

pub(crate) fn run(arguments: &ObservabilityArguments) -> anyhow::Result<()> {
    let options = arguments.solver.options()?;
    if arguments.plan.plan {
        let cameras = arguments.cameras.as_deref();
        return arguments.plan.run((arguments.take.as_deref(), cameras), options, arguments.json);
    }
    let take = arguments.take.as_deref().context("without --plan a take is needed")?;
    let footage = take_options::open(take)?;
    let all: Vec<usize> = (0..footage.cameras.len()).collect();
    let used = take_options::camera_indices(footage.take(), arguments.cameras.as_deref())?;
    let model = Arc::clone(footage.take().model());
    let views = footage.fit_views(&all, arguments.frame)?;
    let start = arguments.start.pose(&footage, &used, arguments.frame, &options)?;
    let pose: Pose = if arguments.no_fit {
        start
    } else {
        let chosen: Vec<FitView> = used.iter().map(|&camera| views[camera].clone()).collect();
        let mut fit = Fit::new(Arc::clone(&model), chosen, start, options.clone())?;
        fit.run(&CancelToken::default(), |_| {}).pose
    };
    let views: Vec<Option<FitView>> = views.into_iter().map(Some).collect();
    let information = FrameInformation::new(&model, &views, &options, &pose)?;
    let shown = information.observe(&used);
    let subsets = information.compare_subsets(shown.noise);
    output::print_result(arguments.json, &answer(&shown, &subsets), || text(&shown, &subsets))
}

/// One standard deviation at the joint that moves most; degrees where none moves.
fn known(shown: &Observability, direction: &Direction) -> String {
    if direction.is_null {
        return "no bound".to_owned();
    }
    let (limb, moved) = direction.largest_move();
    if direction.moves_no_joint() {
        return format::degrees(direction.deviation * direction.largest_turn());
    }
    format!("{}, {}", format::length(direction.deviation * moved), joint_name(&shown.model, limb.into()))
}

fn text(shown: &Observability, subsets: &[SubsetFigures]) -> String {
    let mut table = Table::new(["direction", "of largest", "known to", ""]);
    for (index, direction) in shown.directions.iter().enumerate() {
        let value = if direction.is_null { "null".to_owned() } else { format!("{:.1e}", direction.relative) };
        let number = (index + 1).to_string();
        table.row([number, value, known(shown, direction), words::title(shown, direction)]);
    }
    let count = shown.directions.len();
    let seen = count - shown.null_count();
    let noise = shown.noise;
    let mut out = table.to_text();
    out.push_str(&format!(
        "\n{seen} of {count} directions are seen; below {:.1e} of the largest there is only rounding\n\
         residual on the outline {:.1} grey levels, errors {:.1} times those of independent pixels\n\n",
        shown.null_below,
        noise.pixel_deviation,
        noise.together.sqrt(),
    ));
    let mut table = Table::new(["cameras", "seen", "worst joint", "known to", "middle joint"]);
    for set in subsets {
        let names: Vec<String> = set.cameras.iter().map(|camera| (camera + 1).to_string()).collect();
        let seen = format!("{}/{}", set.columns - set.null_count, set.columns);
        let worst = joint_name(&shown.model, set.worst.0.into());
        table.row([names.join(" "), seen, worst, format::length(set.worst.1), format::length(set.median_m)]);
    }
    out.push_str(&table.to_text());
    out
}

/// The answer as JSON has it; what is without bound is null.
fn answer(shown: &Observability, subsets: &[SubsetFigures]) -> impl Serialize {
    let bounded = |value: f64| Some(value).filter(|value| value.is_finite());
    let direction = |direction: &Direction| {
        object! {
            value: direction.value,
            relative: direction.relative,
            null: direction.is_null,
            title: words::title(shown, direction),
            why: words::why(shown, direction),
            deviation: bounded(direction.deviation),
            step: direction.step.as_slice().to_vec(),
        }
    };
    // Covariances of what is seen, row by row, m².
    let joint = |joint: &JointUncertainty| {
        object! {
            joint: joint_name(&shown.model, joint.limb.into()),
            deviation_m: bounded(joint.worst_deviation_m()),
            covariance: joint.covariance.as_slice().to_vec(),
        }
    };
    // Cameras are counted from one.
    let subset = |set: &SubsetFigures| {
        object! {
            cameras: set.cameras.iter().map(|camera| camera + 1).collect::<Vec<_>>(),
            null: set.null_count,
            smallest: set.smallest,
            worst_joint: joint_name(&shown.model, set.worst.0.into()),
            worst_m: bounded(set.worst.1),
            middle_m: bounded(set.median_m),
        }
    };
    object! {
        columns: shown.directions.len(),
        null: shown.null_count(),
        null_below: shown.null_below,
        lever_m: shown.lever_m,
        pixel_deviation: shown.noise.pixel_deviation,
        together: shown.noise.together,
        directions: shown.directions.iter().map(direction).collect::<Vec<_>>(),
        joints: shown.joints.iter().map(joint).collect::<Vec<_>>(),
        subsets: subsets.iter().map(subset).collect::<Vec<_>>(),
    }
}
