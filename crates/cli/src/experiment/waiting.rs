//! A bar on the terminal while an experiment runs; nothing where standard error is no terminal.

use backlit_lab::experiment::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// The bar. It goes away with this.
#[derive(Debug)]
pub(crate) struct Waiting(ProgressBar);

impl Default for Waiting {
    fn default() -> Self {
        Self::new()
    }
}

impl Waiting {
    /// A bar that waits for the first number.
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::new(1);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} fits, {eta} left") {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// What an experiment tells how far it is.
    pub(crate) fn listener(self) -> impl FnMut(Progress) {
        move |progress| {
            self.0.set_length(progress.total as u64);
            self.0.set_position(progress.done as u64);
            if progress.done == progress.total {
                self.0.finish_and_clear();
            }
        }
    }
}
