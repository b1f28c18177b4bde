//! A second inspector that nobody sees: it shows what the first one shows, or only one camera's picture, and is
//! painted on the CPU. Exports are its pictures, so they are exactly what is shown.

use std::time::Duration;

use backlit_tracking::cancel::CancelToken;
use egui::{Memory, Vec2, vec2};
use egui_painter::Headless;
use image::{DynamicImage, RgbImage};

use crate::app::headless::rest;
use crate::app::settings::Settings;
use crate::app::{App, AppOptions};
use crate::context::pane::Pane;
use crate::document::Document;
use crate::document::history::History;
use crate::features::basin::Basin;
use crate::features::camera_views::CameraViews;
use crate::features::demonstrations::Demonstrations;
use crate::features::export::choices::MAX_SIDE;
use crate::features::export::{ExportJob, ExportOrder, Painter, PictureOf, Shot};
use crate::features::laboratory::Laboratory;
use crate::features::scene::Scene;
use crate::features::tracking::Tracking;
use crate::session::Session;
use crate::session::selection::Selection;
use crate::widgets::image_canvas;

/// How long a picture is waited for.
const PATIENCE: Duration = Duration::from_secs(300);
/// From this many pixels for a pixel of the footage on, marks grow with the picture.
const MARKS_GROW_FROM: f32 = 2.0;

/// All of an inspector that its twin needs. It can be sent to another thread.
#[derive(Debug)]
pub(crate) struct Snapshot {
    document: Document,
    session: Session,
    selection: Selection,
    settings: Settings,
    camera_views: CameraViews,
    alone: Option<Pane>,
    pair: [usize; 2],
    basin: Basin,
    scene: Scene,
    tracking: Tracking,
    laboratory: Laboratory,
    demonstrations: Demonstrations,
    frame_seconds: f64,
    memory: Memory,
}

impl App {
    /// Begins the export that was put together on its card.
    pub(crate) fn begin_export(&mut self) {
        let Some(order) = self.features.export.take_order() else { return };
        match self.export_job(&order) {
            Ok(job) => self.features.export.begin(job, order, &self.state.pool),
            Err(error) => self.state.notices.error(format!("Nothing was exported: {error}.")),
        }
    }

    /// What an order asks for.
    pub(crate) fn export_job(&self, order: &ExportOrder) -> anyhow::Result<ExportJob> {
        let context = self.context();
        let painter = Twin::new(self.snapshot(), order.picture(&context))?;
        Ok(ExportJob::new(order, &context, Box::new(painter)))
    }

    /// What a twin needs to show the same.
    pub(crate) fn snapshot(&self) -> Snapshot {
        // Textures are the first window's: its twin makes its own.
        image_canvas::forget_textures(&self.state.egui);
        Snapshot {
            document: self.document().clone(),
            session: self.state.session.at_rest(),
            selection: self.state.selection,
            settings: self.settings(),
            camera_views: self.features.camera_views.clone(),
            alone: self.shell.docking.alone,
            pair: self.shell.docking.pair,
            basin: self.features.basin.at_rest(),
            scene: self.features.scene.at_rest(),
            tracking: self.features.tracking.at_rest(),
            laboratory: self.features.laboratory.at_rest(),
            demonstrations: self.features.demonstrations.at_rest(),
            frame_seconds: self.state.frame_seconds,
            memory: self.state.egui.memory(Memory::clone),
        }
    }
}

/// The inspector that nobody sees, in its window.
#[derive(Debug)]
pub(crate) struct Twin {
    window: Headless,
    app: App,
    frame_seconds: f64,
    /// Whether there is no room yet for the legend of a picture alone.
    lacks_legend: bool,
}

impl Twin {
    /// A twin of an inspector that paints `what`.
    pub(crate) fn new(snapshot: Snapshot, what: PictureOf) -> anyhow::Result<Self> {
        let footage_size = |camera: usize| {
            let cameras = snapshot.session.take.as_ref().map(|take| take.cameras.clone())?;
            cameras.get(camera).map(|camera| vec2(camera.width() as f32, camera.height() as f32))
        };
        let (size, pixels_per_point) = match what {
            PictureOf::Window { size, scale } => (size, scale),
            PictureOf::View { picture, scale, .. } => {
                let size = footage_size(picture.camera).unwrap_or(Vec2::splat(1.0));
                let pixels_per_point = (scale / MARKS_GROW_FROM).max(1.0);
                (size * scale / pixels_per_point, pixels_per_point)
            }
        };
        let most = MAX_SIDE as f32 / size.max_elem().max(1.0);
        let window = Headless::new(size.x, size.y, pixels_per_point.min(most));
        window.ctx.memory_mut(|memory| *memory = snapshot.memory);
        let options = AppOptions { settings: snapshot.settings, ..AppOptions::default() };
        let mut app = App::new(window.ctx.clone(), options)?;
        app.state.history = History::new(snapshot.document);
        app.state.session = snapshot.session;
        app.state.selection = snapshot.selection;
        app.features.camera_views = snapshot.camera_views;
        app.shell.docking.alone = snapshot.alone;
        app.shell.docking.pair = snapshot.pair;
        app.features.basin = snapshot.basin;
        app.features.scene = snapshot.scene;
        app.features.tracking = snapshot.tracking;
        app.features.laboratory = snapshot.laboratory;
        app.features.demonstrations = snapshot.demonstrations;
        let mut lacks_legend = false;
        if let PictureOf::View { picture, whole_frame, .. } = what {
            app.shell.docking.alone = Some(Pane::Camera(picture.camera));
            let layout = app.state.preferences.layout;
            app.features.camera_views.show_alone(picture, layout, whole_frame);
            lacks_legend = true;
        }
        Ok(Self { window, app, frame_seconds: snapshot.frame_seconds, lacks_legend })
    }

    /// Makes room for the legend of a picture alone, which is as high as its words are long.
    fn make_room(&mut self, cancel: &CancelToken) {
        self.settle(cancel);
        let strip = self.app.features.camera_views.legend_height();
        self.window.resize(self.window.size() + vec2(0.0, strip));
    }

    /// Runs frames until nothing is being worked on any more.
    fn settle(&mut self, cancel: &CancelToken) {
        rest(&mut self.window, &mut self.app, PATIENCE, cancel);
    }
}

impl Painter for Twin {
    fn paint(&mut self, shot: Shot, cancel: &CancelToken) -> RgbImage {
        if std::mem::take(&mut self.lacks_legend) {
            self.make_room(cancel);
        }
        match shot {
            Shot::AsShown => {}
            Shot::Step(step) => {
                if let Some(run) = self.app.state.session.runs.get(step.run) {
                    self.app.state.selection.frame = run.frame;
                    self.app.state.selection.step = Some(step);
                }
            }
            Shot::Frame(frame) => self.app.go_to_frame(frame),
        }
        self.settle(cancel);
        let (app, seconds) = (&mut self.app, self.frame_seconds);
        let picture = self.window.frames(2, Vec::new(), |ui| {
            app.state.frame_seconds = seconds;
            app.frame(ui);
        });
        DynamicImage::ImageRgba8(picture).into_rgb8()
    }
}
