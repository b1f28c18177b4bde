//! Backgrounds that change while a take is filmed are learnt again before its frames are tracked.

use std::sync::Arc;

use anyhow::{Context, ensure};
use backlit_formats::Footage;
use backlit_runs::changes::change_text;
use backlit_tracking::cancel::CancelToken;
use clap::Args;

use crate::interrupt::Interrupted;
use crate::{output, progress};

#[derive(Debug, Clone, Args)]
pub(crate) struct RelearnArguments {
    /// Do not learn backgrounds again that change while the take is filmed
    #[arg(long)]
    no_relearn: bool,
}

impl RelearnArguments {
    /// The footage with backgrounds that change, as far as three or more of these cameras show that in these frames. What was found
    /// is said on standard error.
    pub(crate) fn learn(
        &self,
        footage: Arc<Footage>,
        (cameras, frames): (&[usize], &[usize]),
        cancel: &CancelToken,
    ) -> anyhow::Result<Arc<Footage>> {
        if self.no_relearn {
            return Ok(footage);
        }
        let spinner = progress::spinner();
        let found = footage.change_survey(cameras, frames).changes(cancel, |[done, all]| {
            spinner.set_message(format!("looking for backgrounds that change: {done} of {all} frames"));
        });
        spinner.finish_and_clear();
        ensure!(!cancel.is_cancelled(), Interrupted);
        let found = found.context("looking for backgrounds that change (--no-relearn does not)")?;
        let footage = footage.with_changes(Arc::new(found.unwrap_or_default()));
        changes_text(&footage).iter().for_each(|line| output::complain(line));
        Ok(Arc::new(footage))
    }
}

/// The changes of a footage, in words.
pub(crate) fn changes_text(footage: &Footage) -> Vec<String> {
    footage.changes.iter().map(|change| change_text(change, footage.take())).collect()
}
