//! Frame after frame with a progress bar, the next one read while one is used.

use std::sync::mpsc::sync_channel;

use backlit_formats::Footage;
use backlit_tracking::fit::FitView;
use indicatif::{ProgressBar, ProgressStyle};

/// Hands over the evidence of these frames one by one, with a progress bar on a terminal. While one is used, the next
/// is read and segmented.
///
/// # Errors
/// The first picture that cannot be had, or what `use_frame` returns.
pub(crate) fn each_frame(
    footage: &Footage,
    cameras: &[usize],
    frames: &[usize],
    mut use_frame: impl FnMut(usize, Vec<FitView>, &ProgressBar) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let progress = progress_bar(frames.len());
    let result = std::thread::scope(|scope| {
        let (sender, receiver) = sync_channel(1);
        scope.spawn(move || {
            for &frame in frames {
                let views = footage.fit_views(cameras, frame);
                let failed = views.is_err();
                // Nobody listens any more when the fit has failed.
                if sender.send((frame, views)).is_err() || failed {
                    break;
                }
            }
        });
        for (frame, views) in receiver {
            use_frame(frame, views?, &progress)?;
            progress.inc(1);
        }
        Ok(())
    });
    progress.finish_and_clear();
    result
}

/// A bar on standard error; nothing where that is not a terminal.
fn progress_bar(frames: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos} of {len} frames, {eta} left  {msg}");
    ProgressBar::new(frames as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
