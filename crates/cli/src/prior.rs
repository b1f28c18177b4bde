//! `backlit prior`: poses and steps learnt from motion files.

use std::path::PathBuf;

use anyhow::Context;
use backlit_formats::prior_file;
use backlit_tracking::prior::{TrainOptions, train};
use clap::Args;
use serde_json::json;

use super::numbers::within;
use super::output;
use super::table::Table;

const AFTER_HELP: &str = "\
Learns how people hold their trunk, arms and legs, and how they move from pose to pose, from the BVH files \
of a folder and its subfolders, each as it is and mirrored. Joints may have the names of the CMU database, \
of Mixamo, or those that backlit export writes. `backlit track --prior FILE` uses what was learnt, `--prior \
people` the prior that comes with the program; docs/chapter6.md says where that helps.

Examples:
  backlit prior --train motions --out people.json
  backlit prior --train motions --out people.json --components 24 --source 'my own recordings'";

/// What `backlit prior` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct PriorArguments {
    /// Folder of motion files (BVH)
    #[arg(long, value_name = "DIR")]
    train: PathBuf,
    /// File for what was learnt
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Components of the mixture that each part of the body gets [1 to 1000]
    #[arg(long, value_name = "N", default_value_t = TrainOptions::default().components, value_parser = within(1..=1000_usize))]
    components: usize,
    /// What the motions are and whom to thank for them: kept in the file
    #[arg(long, value_name = "TEXT")]
    source: Option<String>,
    /// Print what was learnt as JSON
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &PriorArguments) -> anyhow::Result<()> {
    output::check_folder_of(&arguments.out)?;
    let clips = prior_file::clips(&arguments.train)?;
    let options = TrainOptions { components: arguments.components, ..TrainOptions::default() };
    let source = arguments.source.clone().unwrap_or_else(|| arguments.train.display().to_string());
    let prior = train(&clips, &options, &source).with_context(|| format!("{}", arguments.train.display()))?;
    prior_file::write(&arguments.out, &prior)?;
    let seconds: f64 = clips.iter().map(|clip| clip.frame_seconds * clip.frames.len() as f64).sum();
    if arguments.json {
        let part = |part: &backlit_tracking::prior::PriorPart| {
            json!({
                "name": part.name,
                "directions": part.directions,
                "components": part.poses.components.len(),
                "step_exponent": part.step.exponent,
            })
        };
        let parts: Vec<_> = prior.parts.iter().map(part).collect();
        return output::print_json(&json!({ "files": clips.len(), "seconds": seconds, "parts": parts }));
    }
    let mut table = Table::new(["part", "directions", "components", "steps grow as"]);
    for part in &prior.parts {
        table.row([
            part.name.to_owned(),
            part.directions.len().to_string(),
            part.poses.components.len().to_string(),
            format!("time^{:.1}", 0.5 * part.step.exponent),
        ]);
    }
    let head = format!("{} motion files, {seconds:.0} s, each as it is and mirrored\n", clips.len());
    output::print(&format!("{head}{}{} is written\n", table.to_text(), arguments.out.display()))
}
