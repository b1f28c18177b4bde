//! The window's picture without a display: the real app, painted on the CPU.

use std::time::{Duration, Instant};

use anyhow::ensure;
use backlit_tracking::cancel::CancelToken;
use backlit_ui::drawing::ViewMode;
use backlit_ui::style::theme::Theme;
use egui::Vec2;
use egui_painter::Headless;
use image::RgbaImage;

use super::off_screen::export_job;
use super::{App, AppOptions, Opening, Place};
use crate::app::settings::Settings;
use crate::context::command::{Command, FitCommand, TimelineCommand, TrackingCommand};
use crate::context::notices::Severity;
use crate::context::preferences::Layout;
use crate::features::export::ExportOrder;

/// What has come to rest so often is at rest; what plays never is.
const ROUNDS: usize = 2;

#[derive(Debug, Clone)]
pub(crate) struct PictureOptions {
    pub(crate) theme: Theme,
    /// What the window is arranged for; `None` is for posing, or as a demonstration opens.
    pub(crate) layout: Option<Layout>,
    /// Size of the window in points.
    pub(crate) size: Vec2,
    pub(crate) pixels_per_point: f32,
    pub(crate) frame: usize,
    /// The joint that is held, by its name.
    pub(crate) joint: Option<String>,
    /// Steps of the fit to do on that frame: `None` runs it to the end.
    pub(crate) steps: Option<usize>,
    /// Whether to track the take from its first to its last frame before that.
    pub(crate) track: bool,
    /// How long to wait for the work, before the picture is taken as it is.
    pub(crate) patience: Duration,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            theme: Theme::Dark,
            layout: None,
            size: Vec2::new(1600.0, 1000.0),
            pixels_per_point: 1.0,
            frame: 0,
            joint: None,
            steps: Some(0),
            track: false,
            patience: Duration::from_secs(300),
        }
    }
}

/// Opens something in a window that nobody sees, goes to the frame, fits it as asked, and paints the window once
/// there is nothing more to do. Errors: it cannot be opened: the error says why.
pub(crate) fn headless_picture(
    opening: Opening,
    options: &PictureOptions,
) -> anyhow::Result<(RgbaImage, Vec<String>)> {
    let (mut window, mut app) = headless_app(opening, options)?;
    let picture = settle(&mut window, &mut app, options.patience);
    Ok((picture, faults(&app)))
}

/// What went wrong on the way, or is missing in the picture: it is written all the same.
fn faults(app: &App) -> Vec<String> {
    let notices = app.inspector.state.notices.all().iter();
    let said = notices.filter(|notice| notice.severity == Severity::Error).map(|notice| notice.text.clone());
    let session = &app.inspector.state.session;
    let frame = session.shown_frame(app.inspector.state.selection.frame);
    let cameras = frame.into_iter().flat_map(|frame| frame.cameras.iter().enumerate());
    let missing = cameras.filter_map(|(camera, shown)| {
        let problem = shown.problem.as_deref()?;
        Some(format!("camera {}: {problem}", camera + 1))
    });
    said.chain(missing).collect()
}

/// The same, but instead of the window's picture it writes what the order says: one camera's picture, or a series.
/// Errors: it cannot be opened, there is no such camera, the series is empty, or the files cannot be written.
pub(crate) fn headless_export(
    opening: Opening,
    options: &PictureOptions,
    camera: Option<usize>,
    mode: Option<ViewMode>,
    order: &ExportOrder,
) -> anyhow::Result<Vec<String>> {
    let (mut window, mut app) = headless_app(opening, options)?;
    let count = app.inspector.state.session.camera_count();
    if let Some(camera) = camera {
        ensure!(camera < count, "there is no camera {}; the take has {count}", camera + 1);
        app.inspector.state.selection.camera = camera;
    }
    if let Some(mode) = mode {
        let layout = app.inspector.state.preferences.layout;
        app.inspector.features.camera_views.show_mode(layout, mode);
    }
    let frames = app.inspector.state.session.frame_count();
    ensure!(order.frames[0] < frames, "there is no frame {}; the take has {frames}", order.frames[0]);
    settle(&mut window, &mut app, options.patience);
    let export = export_job(&app.inspector, order);
    ensure!(export.len() > 0, "there is no step: say with --iteration how many to do");
    export.finish()?;
    Ok(faults(&app))
}

/// The app in its window, when all is done that the options ask for.
fn headless_app(opening: Opening, options: &PictureOptions) -> anyhow::Result<(Headless, App)> {
    let mut window = Headless::new(options.size.x, options.size.y, options.pixels_per_point);
    let layout = options.layout.unwrap_or(Layout::Pose);
    let settings = Settings { theme: options.theme, layout, ..Settings::default() };
    let mut app = App::new(
        window.ctx.clone(),
        AppOptions { settings, opening: Some(opening), ..AppOptions::default() },
    )?;
    settle(&mut window, &mut app, options.patience);
    if app.inspector.state.session.take.is_none() {
        let said = app.inspector.state.notices.all().last();
        anyhow::bail!("{}", said.map_or("nothing was opened", |notice| notice.text.as_str()));
    }
    // A demonstration has a layout of its own.
    if let Some(layout) = options.layout {
        app.inspector.state.preferences.layout = layout;
    }
    let count = app.inspector.state.session.frame_count();
    ensure!(options.frame < count, "there is no frame {}; the take has {count}", options.frame);
    if options.track {
        app.run(Command::Tracking(TrackingCommand::Forward));
        settle(&mut window, &mut app, options.patience);
        // The card about a finished track would cover a view.
        app.inspector.state.notices.close_all();
    }
    app.inspector.state.go_to_frame(options.frame);
    if let Some(joint) = &options.joint {
        let place = Place { frame: options.frame, camera: None, joint: Some(joint.clone()) };
        let state = &mut app.inspector.state;
        let selected = place.select(state.history.document(), count, &mut state.selection);
        selected.map_err(anyhow::Error::msg)?;
    }
    settle(&mut window, &mut app, options.patience);
    if options.steps.is_none() {
        app.run(Command::Fit(FitCommand::Run));
        settle(&mut window, &mut app, options.patience);
    }
    let steps = options.steps.unwrap_or(0);
    if steps > 0 && app.inspector.state.preferences.layout == Layout::Demonstrate {
        // A demonstration has run already.
        app.run(Command::Timeline(TimelineCommand::FirstFrame));
    }
    for _ in 0..steps {
        app.run(Command::Fit(FitCommand::Step));
        settle(&mut window, &mut app, options.patience);
        if app.inspector.context().run().is_none_or(|run| run.ending.is_some()) {
            break;
        }
    }
    Ok((window, app))
}

/// Runs frames until nothing is being worked on and nothing moves.
fn settle(window: &mut Headless, app: &mut App, patience: Duration) -> RgbaImage {
    let frame = || {
        window.run(1, Vec::new(), |ui| app.frame(ui));
        app.inspector.is_idle()
    };
    rest(patience, &CancelToken::default(), frame, || std::thread::sleep(Duration::from_millis(1)));
    // Times are not the picture's business.
    app.inspector.freeze_times();
    window.frames(3, Vec::new(), |ui| {
        app.frame(ui);
        app.inspector.freeze_times();
    })
}

/// Runs frames until there is nothing more to do: `frame` runs one and says whether that is so, `wait` lets work be done.
pub(crate) fn rest(
    patience: Duration,
    cancel: &CancelToken,
    mut frame: impl FnMut() -> bool,
    mut wait: impl FnMut(),
) {
    let start = Instant::now();
    for _ in 0..ROUNDS {
        while !frame() && !cancel.is_cancelled() && start.elapsed() <= patience {
            wait();
        }
        // Sizes settle over two frames, and may ask for more.
        frame();
    }
}
