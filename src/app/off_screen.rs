//! An inspector that nobody sees: it shows what the window shows, or only one camera's picture, and is painted on the
//! CPU. Exports are its pictures, so they are exactly what is shown.

use std::time::Duration;

use backlit_jobs::Pool;
use backlit_tracking::cancel::CancelToken;
use backlit_ui::widgets::image_canvas;
use egui::{Memory, Vec2, vec2};
use egui_painter::Headless;
use image::{DynamicImage, RgbImage};

use crate::app::Inspector;
use crate::app::headless::rest;
use crate::context::SessionRequest;
use crate::context::marks::PictureAlone;
use crate::context::pane::Pane;
use crate::features::export::choices::MAX_SIDE;
use crate::features::export::{ExportArea, ExportJob, ExportOrder, Painter, Shot};

/// How long a picture is waited for.
const PATIENCE: Duration = Duration::from_secs(300);
/// From this many pixels for a pixel of the footage on, marks grow with the picture.
const MARKS_GROW_FROM: f32 = 2.0;

/// Begins the export that was put together on its card.
pub(crate) fn begin_export(inspector: &mut Inspector) {
    let Some(order) = inspector.features.export.order.take() else { return };
    let job = export_job(inspector, &order);
    inspector.features.export.begin(job, order, &inspector.state.pool);
}

/// What an order asks for.
pub(crate) fn export_job(inspector: &Inspector, order: &ExportOrder) -> ExportJob {
    ExportJob::new(order, &inspector.context(), Box::new(OffScreen::new(inspector, order)))
}

/// Another inspector that shows the same, in a window of its own. Its tasks are done when somebody turns its pool.
fn at_rest(shown: &Inspector, egui: &egui::Context) -> Inspector {
    // Textures are the first window's: the other makes its own.
    image_canvas::forget_textures(&shown.state.egui);
    egui.memory_mut(|memory| *memory = shown.state.egui.memory(Memory::clone));
    let mut copy = Inspector::new(egui.clone(), Pool::inline(), shown.state.clock.clone());
    copy.features = shown.features.at_rest();
    copy.apply_settings(shown.settings());
    copy.state.history = shown.state.history.without_past();
    copy.state.session = shown.state.session.clone();
    copy.state.selection = shown.state.selection;
    copy.shell.docking.alone = shown.shell.docking.alone;
    copy.shell.docking.pair = shown.shell.docking.pair;
    copy
}

/// The inspector that nobody sees, in its window.
#[derive(Debug)]
pub(crate) struct OffScreen {
    window: Headless,
    inspector: Inspector,
    frame_seconds: f64,
    /// Whether there is no room yet for the legend of a picture alone.
    lacks_legend: bool,
}

impl OffScreen {
    /// What `inspector` shows, to be painted as the order says.
    fn new(inspector: &Inspector, order: &ExportOrder) -> Self {
        let (choices, camera) = (&order.choices, inspector.state.selection.camera);
        let is_view = order.part() == ExportArea::View;
        let (size, pixels_per_point) = if is_view {
            let footage = inspector.state.session.camera_size(camera).unwrap_or([1, 1]);
            let scale = choices.view_pixels_per_px(footage);
            let pixels_per_point = (scale / MARKS_GROW_FROM).max(1.0);
            (Vec2::from(footage.map(|side| side as f32)) * scale / pixels_per_point, pixels_per_point)
        } else {
            (inspector.state.egui.viewport_rect().size(), choices.window_scale)
        };
        let most = MAX_SIDE as f32 / size.max_elem().max(1.0);
        let window = Headless::new(size.x, size.y, pixels_per_point.min(most));
        let frame_seconds = inspector.state.frame_seconds;
        let mut inspector = at_rest(inspector, &window.ctx);
        if is_view {
            inspector.shell.docking.alone = Some(Pane::Camera(camera));
            let layout = inspector.state.preferences.layout;
            let picture = PictureAlone { camera, marks: choices.marks, legend: choices.legend };
            inspector.features.camera_views.show_alone(picture, layout, choices.whole_frame);
        }
        Self { window, inspector, frame_seconds, lacks_legend: is_view }
    }

    /// Runs frames until nothing is being worked on any more.
    fn settle(&mut self, cancel: &CancelToken) {
        let (window, inspector) = (&mut self.window, &mut self.inspector);
        let pool = inspector.state.pool.clone();
        let frame = || {
            window.run(1, Vec::new(), |ui| inspector.frame(ui));
            // Nobody is there to do them.
            inspector.errands.clear();
            inspector.is_idle()
        };
        rest(PATIENCE, cancel, frame, || {
            pool.turn();
            std::thread::sleep(Duration::from_millis(1));
        });
    }
}

impl Painter for OffScreen {
    fn paint(&mut self, shot: Shot, cancel: &CancelToken) -> RgbImage {
        if std::mem::take(&mut self.lacks_legend) {
            // It is as high as its words are long.
            self.settle(cancel);
            let strip = self.inspector.features.camera_views.legend_height();
            self.window.resize(self.window.size() + vec2(0.0, strip));
        }
        match shot {
            Shot::AsShown => {}
            Shot::Step(step) => self.inspector.request(SessionRequest::Step(step)),
            Shot::Frame(frame) => self.inspector.state.go_to_frame(frame),
        }
        self.settle(cancel);
        let (inspector, seconds) = (&mut self.inspector, self.frame_seconds);
        let picture = self.window.frames(2, Vec::new(), |ui| {
            inspector.state.frame_seconds = seconds;
            inspector.frame(ui);
        });
        DynamicImage::ImageRgba8(picture).into_rgb8()
    }
}
