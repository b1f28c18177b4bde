//! A bar on the terminal while an experiment runs; nothing where standard error is no terminal.

use backlit_lab::experiment::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// A bar that waits for the first number.
pub(crate) fn bar() -> ProgressBar {
    let bar = ProgressBar::new(1);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} fits, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// What an experiment of the lab tells how far it is.
pub(crate) fn listener() -> impl FnMut(Progress) {
    let bar = bar();
    move |progress| {
        bar.set_length(progress.total as u64);
        bar.set_position(progress.done as u64);
        if progress.done == progress.total {
            bar.finish_and_clear();
        }
    }
}
