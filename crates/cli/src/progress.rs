//! Progress on standard error; nothing where that is not a terminal.

use std::sync::Arc;
use std::time::Duration;

use backlit_runs::track::{FrameReader, ReadAhead};
use backlit_tracking::cancel::CancelToken;
use indicatif::{ProgressBar, ProgressStyle};

/// A bar for this number of frames.
pub(crate) fn bar(frames: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos} of {len} frames, {eta} left  {msg}");
    ProgressBar::new(frames as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Work of unknown length.
pub(crate) fn spinner() -> ProgressBar {
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(200));
    spinner
}

/// Hands over these frames one by one. While one is used, the next are read and segmented.
pub(crate) fn each_frame<R: FrameReader>(
    reader: &Arc<R>,
    frames: &[usize],
    mut use_frame: impl FnMut(usize, &Arc<R::Data>) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let progress = bar(frames.len());
    let mut ahead = ReadAhead::new(reader.clone(), frames.to_vec().into(), CancelToken::new());
    let result = frames.iter().try_for_each(|&frame| {
        use_frame(frame, &ahead.get(frame)?)?;
        progress.inc(1);
        Ok(())
    });
    progress.finish_and_clear();
    result
}
