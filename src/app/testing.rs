//! The window for tests of the features: without display, with the pool that tests turn themselves.

use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use backlit_jobs::Pool;
use backlit_take::demonstration::Demonstration;
use backlit_take::source::TakeSource;
use backlit_tracking::camera::{Camera, CameraFromWorld, Distortion, Intrinsics};
use egui_painter::Headless;
use glam::DVec3;

use super::{App, AppOptions, Inspector, Opening};
use crate::context::command::Command;
use crate::context::notices::Severity;
use crate::context::preferences::Layout;

/// A job that breaks down.
pub(crate) struct Breaks;

impl<O> backlit_jobs::Job<O> for Breaks {
    fn step(&mut self, _: &backlit_jobs::Outbox<O>) -> backlit_jobs::Turn {
        panic!("thirteen");
    }
}

/// A camera by the size of its picture, focal length and principal point in pixels, where it stands and looks, and what
/// is up.
pub(crate) fn camera(
    size_px: [u64; 2],
    [focal, cx, cy]: [f64; 3],
    from: DVec3,
    to: DVec3,
    up: DVec3,
) -> Arc<Camera> {
    let intrinsics = Intrinsics { fx: focal, fy: focal, cx, cy };
    let place = CameraFromWorld::looking_at(from, to, up);
    Arc::new(Camera::new("c", size_px, intrinsics, Distortion::None, place).unwrap())
}

/// A camera beside a body that stands upright at the origin.
pub(crate) fn side_camera() -> Arc<Camera> {
    camera([272, 480], [420.0, 135.5, 239.5], DVec3::new(3.0, -1.0, 1.0), DVec3::ZERO, DVec3::Z)
}

/// The window, with the inspector that it shows.
pub(crate) struct TestWindow {
    window: Headless,
    app: App,
}

impl Deref for TestWindow {
    type Target = Inspector;

    fn deref(&self) -> &Inspector {
        &self.app.inspector
    }
}

impl DerefMut for TestWindow {
    fn deref_mut(&mut self) -> &mut Inspector {
        &mut self.app.inspector
    }
}

impl TestWindow {
    pub(crate) fn frames(&mut self, count: usize) {
        self.window.run(count, Vec::new(), |ui| self.app.frame(ui));
    }

    /// Runs frames until nothing is being worked on.
    pub(crate) fn settle(&mut self) {
        let began = Instant::now();
        self.frames(2);
        while !self.is_idle() {
            assert!(began.elapsed() < Duration::from_secs(60), "it waits for ever");
            self.frames(1);
        }
    }

    pub(crate) fn run(&mut self, command: Command) {
        self.app.run(command);
    }

    /// Does a command, and all that follows from it.
    pub(crate) fn does(&mut self, command: Command) {
        self.run(command);
        self.settle();
    }

    pub(crate) fn open(&mut self, opening: Opening) {
        self.app.open(opening);
        self.settle();
    }

    /// Begins a job that breaks down, and does all that follows from it.
    pub(crate) fn break_down(&mut self, begin: impl FnOnce(&mut Inspector, &Pool)) {
        let pool = self.state.pool.clone();
        begin(self, &pool);
        self.settle();
    }

    /// What was said to have gone wrong.
    pub(crate) fn errors(&self) -> Vec<&str> {
        let all = self.state.notices.all().iter();
        all.filter(|notice| notice.severity == Severity::Error).map(|notice| notice.text.as_str()).collect()
    }
}

/// A window on the demonstration of a single limb, in a layout.
pub(crate) fn open(layout: Layout) -> TestWindow {
    open_take(Demonstration::SingleLimb, layout)
}

pub(crate) fn open_take(demonstration: Demonstration, layout: Layout) -> TestWindow {
    open_source(TakeSource::Demonstration(demonstration), layout)
}

pub(crate) fn open_source(source: TakeSource, layout: Layout) -> TestWindow {
    let window = Headless::new(1100.0, 700.0, 1.0);
    let opening = Some(Opening::Take(source));
    let options = AppOptions { opening, is_inline: true, ..AppOptions::default() };
    let app = App::new(window.ctx.clone(), options).unwrap();
    let mut window = TestWindow { window, app };
    window.settle();
    window.state.preferences.layout = layout;
    window.settle();
    window
}

/// The first pictures of the built-in take as a take of its own, with a line more in its file.
pub(crate) fn small_take(folder: &Path, line: &str) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/take");
    for file in ["cameras.json", "start.json"] {
        std::fs::copy(from.join(file), folder.join(file)).unwrap();
    }
    let text = std::fs::read_to_string(from.join("take.toml")).unwrap();
    let (cameras, rest) = text.split_once("[reference]").unwrap();
    let (_, measurement) = rest.split_once("[measurement]").unwrap();
    std::fs::write(
        folder.join("take.toml"),
        format!("{cameras}[measurement]{measurement}").replacen(
            "frame_rate",
            &format!("{line}\nframe_rate"),
            1,
        ),
    )
    .unwrap();
    for camera in ["cam1", "cam2", "cam3", "cam4"] {
        std::fs::create_dir_all(folder.join(camera)).unwrap();
        for file in std::fs::read_dir(from.join(camera)).unwrap().map(|file| file.unwrap().path()) {
            let name = file.file_name().unwrap().to_owned();
            let is_late = (8..60).any(|frame| name.to_string_lossy().contains(&format!("_{frame:03}")));
            if !is_late {
                std::fs::copy(&file, folder.join(camera).join(name)).unwrap();
            }
        }
    }
    folder.to_owned()
}
