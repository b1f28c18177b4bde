//! The window for tests of the features: without display, with the pool that tests turn themselves.

use std::time::{Duration, Instant};

use egui_painter::Headless;

use super::{App, AppOptions, Opening};
use crate::context::notices::Severity;
use crate::context::preferences::Layout;
use crate::take::demonstration::Demonstration;
use crate::take::source::TakeSource;

/// A job that breaks down.
pub(crate) struct Breaks;

impl<O> backlit_jobs::Job<O> for Breaks {
    fn step(&mut self, _: &backlit_jobs::Outbox<O>) -> backlit_jobs::Step {
        panic!("thirteen");
    }
}

/// Runs frames until nothing is being worked on.
pub(crate) fn settle(window: &mut Headless, app: &mut App) {
    let began = Instant::now();
    window.run(2, Vec::new(), |ui| app.frame(ui));
    while !app.is_idle() {
        assert!(began.elapsed() < Duration::from_secs(60), "it waits for ever");
        window.run(1, Vec::new(), |ui| app.frame(ui));
    }
}

/// A window on the demonstration of a single limb, in a layout.
pub(crate) fn open(layout: Layout) -> (Headless, App) {
    open_take(Demonstration::SingleLimb, layout)
}

/// A window on a demonstration, in a layout.
pub(crate) fn open_take(demonstration: Demonstration, layout: Layout) -> (Headless, App) {
    open_source(TakeSource::Demonstration(demonstration), layout)
}

/// A window on any take, in a layout.
pub(crate) fn open_source(source: TakeSource, layout: Layout) -> (Headless, App) {
    let mut window = Headless::new(1100.0, 700.0, 1.0);
    let opening = Some(Opening::Take(source));
    let options = AppOptions { opening, is_inline: true, ..AppOptions::default() };
    let mut app = App::new(window.ctx.clone(), options).unwrap();
    settle(&mut window, &mut app);
    app.state.preferences.layout = layout;
    settle(&mut window, &mut app);
    (window, app)
}

/// What was said to have gone wrong.
pub(crate) fn errors(app: &App) -> Vec<&str> {
    let all = app.state.notices.all().iter();
    all.filter(|notice| notice.severity == Severity::Error).map(|notice| notice.text.as_str()).collect()
}
