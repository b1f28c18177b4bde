//! The card: two cameras side by side, a frame, the shift of each camera, and what the silhouettes say of it.

use backlit_tracking::camera::Camera;
use backlit_tracking::synchronise::CameraOffset;
use backlit_ui::style::theme::data_colours::{AGREEMENT, PICTURE_GROUND, SELECTED, mark};
use backlit_ui::style::theme::{size, space};
use backlit_ui::style::{format, theme};
use backlit_ui::widgets::image_canvas::cached_texture;
use backlit_ui::widgets::{
    ValueSlider, button_row, camera_badge, card, choice, hint, named_row, number_field, paint_whole,
    primary_button, row_name, text_button,
};
use egui::{
    Button, CornerRadius, Id, Painter, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke, Ui, Vec2,
    WidgetInfo, vec2,
};
use glam::DVec2;

use super::Offsets;
use crate::context::Context;

/// Width of the card, of the names in it, and height of the pictures at most.
const WIDTH: f32 = 760.0;
const NAMES: f32 = 92.0;
const PICTURE: f32 = 380.0;
/// Height of all else on the smallest window.
const REST: f32 = 330.0;
/// Depths at which the line of a place is drawn, metres.
const DEPTHS: std::ops::Range<u32> = 1..120;
const DEPTH_STEP: f64 = 0.1;

impl Offsets {
    /// Shows the card, and says whether it stays.
    pub(super) fn show(&mut self, ui: &Ui, context: &Context<'_>) -> bool {
        let Some(take) = context.session.take.clone() else { return false };
        self.read_pictures(context);
        let modal = card(ui.ctx(), "offsets").show(ui.ctx(), |ui| {
            ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 4.0 * space::GUTTER_MARGIN));
            ui.spacing_mut().item_spacing.y = 6.0;
            ui.label(RichText::new("Camera offsets").text_style(theme::title()));
            let text = "Both pictures should show the same moment. Point at something in one: the line in the other is where it \
                        can be at that moment.";
            ui.label(RichText::new(text).color(theme::palette(ui).text2));
            ui.add_space(space::ROW);
            let cameras = Self::full_cameras(&take);
            self.pictures(ui, cameras);
            self.frame_row(ui, context.session.frame_count());
            self.shift_rows(ui, context, cameras);
            ui.add_space(space::WIDGET);
            self.buttons(ui, context)
        });
        let (is_cancelled, is_left) = (modal.inner, modal.should_close());
        if is_left && !is_cancelled {
            self.find.stop();
        }
        !(is_cancelled || is_left)
    }

    fn pictures(&mut self, ui: &mut Ui, cameras: &[Camera]) {
        let gap = space::WIDGET;
        let width = (ui.available_width() - gap) / 2.0;
        let height = (ui.ctx().content_rect().height() - REST).clamp(140.0, PICTURE);
        let mut pointed_at = None;
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = gap;
            for side in 0..2 {
                ui.vertical(|ui| {
                    ui.set_width(width);
                    self.camera_row(ui, side, cameras);
                    let place = self.picture(ui, side, cameras, vec2(width, height));
                    pointed_at = pointed_at.or(place.map(|place| (side, place)));
                });
            }
        });
        if self.pointed_at != pointed_at {
            self.pointed_at = pointed_at;
            ui.ctx().request_repaint();
        }
    }

    fn camera_row(&mut self, ui: &mut Ui, side: usize, cameras: &[Camera]) {
        let name = ["Left camera", "Right camera"][side];
        let chosen = self.shown[side];
        let rows: Vec<(usize, &str, String)> =
            cameras.iter().enumerate().map(|(index, camera)| (index, camera.name(), String::new())).collect();
        ui.horizontal(|ui| {
            camera_badge(ui, chosen);
            if let Some(camera) = choice(ui, name, 140.0, cameras[chosen].name(), &rows) {
                if camera == self.shown[1 - side] {
                    self.shown.swap(0, 1);
                } else {
                    self.shown[side] = camera;
                }
            }
            let number = i64::try_from(self.frame).unwrap_or(0) + self.shifts[chosen];
            hint(ui, format!("its frame {number}"));
        });
    }

    /// A picture; the place in it at which the pointer is, in pixels of the camera.
    fn picture(&self, ui: &mut Ui, side: usize, cameras: &[Camera], size: Vec2) -> Option<DVec2> {
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let camera = &cameras[self.shown[side]];
        let label = format!("Picture of {}", camera.name());
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, label.as_str()));
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, CornerRadius::ZERO, PICTURE_GROUND);
        let state = &self.sides[side];
        if let Some(problem) = &state.problem {
            let font = egui::TextStyle::Body.resolve(ui.style());
            let words = painter.layout(problem.clone(), font, AGREEMENT, size.x - 2.0 * space::GUTTER_MARGIN);
            painter.galley(rect.center() - words.size() / 2.0, words, AGREEMENT);
            return None;
        }
        let (of, image) = state.picture.as_ref()?;
        if of.camera != self.shown[side] {
            return None;
        }
        let texture = cached_texture(ui.ctx(), Id::unique(("offsets", side)), of, false, || image.clone());
        let full = vec2(camera.width() as f32, camera.height() as f32);
        let scale = (size.x / full.x).min(size.y / full.y);
        let shown = Rect::from_center_size(rect.center(), full * scale);
        paint_whole(&painter, &texture, shown);
        self.paint_line(&painter, shown, side, cameras);
        pixel_under(&response, shown, scale)
    }

    /// The line on which the place that is pointed at in the other picture can be.
    fn paint_line(&self, painter: &Painter, shown: Rect, side: usize, cameras: &[Camera]) {
        let Some((of, place)) = self.pointed_at.filter(|(of, _)| *of != side) else { return };
        let (from, to) = (&cameras[self.shown[of]], &cameras[self.shown[side]]);
        let Some(ray) = from.ray_in_world(place) else { return };
        let centre = from.centre();
        let scale = shown.width() / to.width() as f32;
        let points = DEPTHS.filter_map(|step| {
            let pixel = to.project(centre + ray * (f64::from(step) * DEPTH_STEP))?;
            Some(shown.min + vec2(pixel.x as f32 + 0.5, pixel.y as f32 + 0.5) * scale)
        });
        let points: Vec<_> = points.filter(|point| shown.expand(shown.width()).contains(*point)).collect();
        painter.with_clip_rect(shown).line(points, Stroke::new(mark::RAY_WIDTH, SELECTED));
    }

    fn frame_row(&mut self, ui: &mut Ui, count: usize) {
        named_row(ui, "Frame", NAMES, |ui| {
            let last = count.saturating_sub(1) as f64;
            let mut frame = self.frame as f64;
            let width = ui.available_width() - 84.0;
            let slider = ValueSlider::new(&mut frame, 0.0..=last.max(1.0), "Frame");
            ui.add(ValueSlider { width, ..slider });
            number_field(ui, "Frame number", &mut frame, 0, "", 0.2, 70.0);
            self.frame = frame.round().clamp(0.0, last) as usize;
        });
    }

    /// The shift of each camera, and what the silhouettes say of it.
    fn shift_rows(&mut self, ui: &mut Ui, context: &Context<'_>, cameras: &[Camera]) {
        ScrollArea::vertical().max_height(130.0).min_scrolled_height(130.0).show(ui, |ui| {
            for (index, camera) in cameras.iter().enumerate() {
                ui.horizontal(|ui| {
                    camera_badge(ui, index);
                    row_name(ui, camera.name(), NAMES - 28.0);
                    for (text, by) in [("−", -1), ("+", 1)] {
                        let name = format!("{text}1 frame of {}", camera.name());
                        let button = ui.add(Button::new(text).min_size(vec2(size::BUTTON, size::BUTTON)));
                        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, name.as_str()));
                        if button.clicked() {
                            self.shifts[index] += by;
                            self.show_with(index);
                        }
                    }
                    let mut shift = self.shifts[index] as f64;
                    let name = format!("Shift of {}", camera.name());
                    if number_field(ui, &name, &mut shift, 0, " frames", 0.1, 96.0).changed() {
                        self.shifts[index] = shift.round().clamp(-1e6, 1e6) as i64;
                        self.show_with(index);
                    }
                    let text = self.said_of(index);
                    hint(ui, text);
                });
            }
        });
        named_row(ui, "Silhouettes", NAMES, |ui| {
            if self.find.is_busy() {
                if text_button(ui, "Stop").clicked() {
                    self.find.stop();
                }
                let [done, all] = self.progress.unwrap_or_default();
                hint(ui, format!("{done} of {all} frames looked at"));
                return;
            }
            if text_button(ui, "Find offsets").clicked() {
                self.find(context);
            }
            match &self.found {
                None => hint(ui, "from the motion of the silhouettes; the person must move"),
                Some(Ok(_)) => hint(ui, "found; beside each camera stands how sure"),
                Some(Err(why)) => {
                    ui.label(RichText::new(format!("{why}.")).small().color(theme::palette(ui).warn));
                }
            }
        });
    }

    /// A camera that is shifted is shown.
    fn show_with(&mut self, camera: usize) {
        if !self.shown.contains(&camera) {
            self.shown[1] = camera;
        }
    }

    /// "the others are measured against it", "+0.050 s ± 0.004 s, 99.8 % sure".
    fn said_of(&self, camera: usize) -> String {
        let Some(Ok(found)) = &self.found else { return String::new() };
        match found.found.cameras.get(camera) {
            Some(CameraOffset::Reference) => "the others are measured against it".to_owned(),
            Some(CameraOffset::Found(offset)) => {
                let seconds = format::number(offset.seconds, 3);
                let sure = match offset.probability {
                    all if all > 0.9995 => "more than 99.9".to_owned(),
                    less => format::number(100.0 * less, 1),
                };
                format!("{seconds} s ± {} s, {sure} % sure", format::number(offset.deviation_s, 3))
            }
            Some(CameraOffset::Undecided(why)) => format!("not found: {why}"),
            None => String::new(),
        }
    }

    /// Whether the card is closed.
    fn buttons(&mut self, ui: &mut Ui, context: &Context<'_>) -> bool {
        button_row(ui, |ui| {
            let is_shifted = self.shifts.iter().any(|shift| *shift != 0);
            let write = ui.add_enabled_ui(is_shifted, |ui| primary_button(ui, "Write to the take")).inner;
            let write = write.on_disabled_hover_text("No camera is shifted");
            let tooltip = "Changes the offsets in take.toml and nothing else in it, and opens the take again";
            if write.on_hover_text(tooltip).clicked() {
                self.write(context);
            }
            text_button(ui, "Cancel").clicked()
        })
    }
}

/// The pixel of the camera that is under the pointer.
fn pixel_under(response: &Response, shown: Rect, scale: f32) -> Option<DVec2> {
    let place = response.hover_pos().filter(|place| shown.contains(*place))?;
    let pixel = (place - shown.min) / scale;
    Some(DVec2::new(f64::from(pixel.x) - 0.5, f64::from(pixel.y) - 0.5))
}
