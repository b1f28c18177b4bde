//! Options that name keypoints to compare a track with.

use std::path::PathBuf;

use anyhow::Context;
use backlit_formats::Take;
use backlit_formats::trc::Axes;
use clap::Args;

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
    /// Which frame number of the file is frame 0 of the take [default: that of the first row; for a CSV, 0]
    #[arg(long, value_name = "N", requires = "reference")]
    reference_first: Option<u64>,
}

impl ReferenceArguments {
    /// The take with these keypoints, if any are named.
    ///
    /// # Errors
    /// They cannot be read.
    pub(crate) fn take(&self, take: &Take) -> anyhow::Result<Option<Take>> {
        let Some(path) = &self.reference else { return Ok(None) };
        let judge = take.with_reference(path, self.reference_axes, self.reference_first);
        judge.map(Some).context("--reference")
    }
}

fn axes(text: &str) -> Result<Axes, &'static str> {
    Axes::parse(text).ok_or("expected three letters that turn the file's axes, as zxy or x-zy")
}
