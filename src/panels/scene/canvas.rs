//! The scene's picture: drawn by the CPU, and only when something in it has changed.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use egui::{Color32, ColorImage, Id, Rect, Ui, pos2};
use glam::DVec3;
use image::RgbaImage;

use super::Stage;
use crate::raster::scene::{Picture, Scene, SceneCamera, SceneFrame};
use crate::scene_view::{Contents, Frustum};
use crate::session::FrameData;
use crate::showing::Showing;
use crate::theme::data_colours::PICTURE_GROUND;
use crate::widgets::image_canvas::cached_texture;

/// Longest side of a picture on a frustum, in points: about the size that it is seen.
const PICTURE_SIDE: f32 = 120.0;
/// Longest side of the scene's picture, in pixels: beyond that it is stretched.
const LONGEST: f32 = 1400.0;
/// Side of the picture of what goes on by itself, as a share of the whole one's.
const LIVE_SHARE: f32 = 0.5;

/// Draws the scene where it has changed. What `moves`, or belongs to a run that goes on, is drawn as a draft.
pub(super) fn show(ui: &Ui, showing: &Showing<'_>, stage: &Stage, contents: &Contents, moves: bool) {
    let is_live =
        moves || showing.busy.fitting || showing.busy.tracking || showing.time.playback.is_playing();
    let is_draft = is_live || stage.ray.is_some() || showing.observing.is_playing();
    let size = stage.picture.size() * ui.pixels_per_point();
    // Films and runs draw it anew many times a second beside four other pictures.
    let coarseness = if is_live { LIVE_SHARE } else { 1.0 };
    let shrink = coarseness * (LONGEST / size.max_elem()).min(1.0);
    let [width, height] = [size.x, size.y].map(|side| (side * shrink).round().max(1.0) as u32);
    let frame = showing.session.shown_frame(showing.selection.frame);
    let shows_pictures = showing.look.scene.pictures && !contents.frusta.is_empty();
    let images = frame.filter(|_| shows_pictures).map(|frame| thumbnails(ui, frame));
    let mut key = egui::util::hash((width, height, is_draft, images.as_ref().map(|images| images.serial)));
    key = egui::util::hash((key, Fingerprint(&contents.scene), EyePrint(&stage.eye)));
    let texture = cached_texture(ui.ctx(), ui.scope_id().with("scene texture"), key, false, || {
        let pictures = images.as_ref().map_or_else(Vec::new, |images| on_frusta(&contents.frusta, images));
        let mut scene = Scene { pictures, ..contents.scene.clone() };
        scene.lines.iter_mut().for_each(|line| line.width_px *= f64::from(coarseness));
        let mut frame =
            if is_draft { SceneFrame::draft(width, height) } else { SceneFrame::new(width, height) };
        frame.draw(&stage.eye, PICTURE_GROUND, &scene);
        let size = [width as usize, height as usize];
        ColorImage::from_rgba_premultiplied(size, frame.image().as_raw())
    });
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), stage.picture, uv, Color32::WHITE);
}

fn on_frusta<'a>(frusta: &[Frustum], images: &'a Thumbnails) -> Vec<Picture<'a>> {
    let picture = |frustum: &Frustum| {
        let [corner, right, _, below] = frustum.corners;
        let image = images.pictures.get(frustum.camera)?.as_ref()?;
        let opacity = frustum.opacity;
        Some(Picture { corner, across: right - corner, down: below - corner, image, opacity })
    };
    frusta.iter().filter_map(picture).collect()
}

/// A frame's pictures, small.
struct Thumbnails {
    /// Kept so that no other frame takes its place in memory while these are.
    frame: Arc<FrameData>,
    side: u32,
    /// Differs from that of all before.
    serial: u64,
    pictures: Vec<Option<RgbaImage>>,
}

fn thumbnails(ui: &Ui, frame: &Arc<FrameData>) -> Arc<Thumbnails> {
    let id = Id::unique("pictures of the scene");
    let side = (PICTURE_SIDE * ui.pixels_per_point()).round() as u32;
    let kept = ui.data(|data| data.get_temp::<Arc<Thumbnails>>(id));
    if let Some(kept) = &kept
        && Arc::ptr_eq(&kept.frame, frame)
        && kept.side == side
    {
        return kept.clone();
    }
    let small = |image: &image::RgbImage| {
        let longest = image.width().max(image.height()).max(1);
        let scaled = |length: u32| (length * side.min(longest) / longest).max(1);
        let small = image::imageops::thumbnail(image, scaled(image.width()), scaled(image.height()));
        image::DynamicImage::ImageRgb8(small).into_rgba8()
    };
    let pictures = frame.cameras.iter().map(|camera| camera.image.as_deref().map(small)).collect();
    let serial = kept.map_or(0, |kept| kept.serial + 1);
    let made = Arc::new(Thumbnails { frame: frame.clone(), side, serial, pictures });
    ui.data_mut(|data| data.insert_temp(id, made.clone()));
    made
}

fn hash_point(point: DVec3, state: &mut impl Hasher) {
    point.to_array().map(f64::to_bits).hash(state);
}

/// All that is drawn, but for pictures.
struct Fingerprint<'a>(&'a Scene<'static>);

impl Hash for Fingerprint<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let scene = self.0;
        for capsule in &scene.capsules {
            capsule.ends.iter().for_each(|end| hash_point(*end, state));
            (capsule.radius.to_bits(), capsule.colour).hash(state);
        }
        for line in &scene.lines {
            line.ends.iter().for_each(|end| hash_point(*end, state));
            (line.width_px.to_bits(), line.colour).hash(state);
        }
        for dot in &scene.dots {
            hash_point(dot.at, state);
            dot.colour.hash(state);
        }
        if let Some(floor) = &scene.floor {
            hash_point(floor.centre, state);
        }
        (scene.capsules.len(), scene.lines.len(), scene.dots.len(), scene.floor.is_some()).hash(state);
    }
}

struct EyePrint<'a>(&'a SceneCamera);

impl Hash for EyePrint<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        hash_point(self.0.position, state);
        hash_point(self.0.target, state);
        hash_point(self.0.up, state);
        self.0.fov_y.to_bits().hash(state);
    }
}
