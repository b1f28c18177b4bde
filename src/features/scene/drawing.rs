//! All that a picture of the scene shows, so that it is drawn again only when something in it has changed; and the picture,
//! which a job draws since that takes longer than a frame of the window may.

use std::hash::{Hash, Hasher};
use std::sync::Arc;

use backlit_tracking::visual_hull::VisualHull;
use backlit_ui::style::theme::data_colours::PICTURE_GROUND;
use egui::ColorImage;
use glam::DVec3;
use image::{DynamicImage, RgbImage, RgbaImage};

use super::Frustum;
use super::contents::shell;
use super::raster::{FlatPicture, SceneCamera, SceneFrame, SceneShapes};
use crate::context::marks::FloorPicture;
use crate::session::FrameData;

/// Opacity of a picture on the floor.
const ON_FLOOR: f32 = 0.8;

/// All that a picture of the scene shows.
#[derive(Debug, Clone)]
pub struct SceneOrder {
    /// Width and height in pixels.
    pub(crate) size_px: [u32; 2],
    /// Whether it is of something that moves: drawn quickly, with rough edges.
    pub is_draft: bool,
    /// Where it is seen from.
    pub eye: SceneCamera,
    /// Limbs, floor and lines.
    pub scene: SceneShapes<'static>,
    pub(crate) frusta: Vec<Frustum>,
    /// The frame whose pictures stand on the frusta, if they are to be seen.
    pub(crate) pictures: Option<Arc<FrameData>>,
    /// Longest side of these pictures, in pixels.
    pub(crate) picture_side: u32,
    /// The hull whose cubes are to be seen.
    pub(crate) shell: Option<Arc<VisualHull>>,
    /// What lies on the floor.
    pub(crate) floor_picture: Option<Arc<FloorPicture>>,
    /// Where the held joint is. It is no part of the picture; its mark goes with it.
    pub(crate) held: Option<DVec3>,
}

impl SceneOrder {
    /// Differs when anything differs. Frames and hulls are told apart by their places in memory: a key says something
    /// only as long as its order is kept.
    pub(crate) fn key(&self) -> u64 {
        egui::util::hash(Fingerprint(self))
    }
}

struct Fingerprint<'a>(&'a SceneOrder);

impl Hash for Fingerprint<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let SceneOrder {
            size_px,
            is_draft,
            eye,
            scene,
            frusta,
            pictures,
            picture_side,
            shell,
            floor_picture,
            held,
        } = self.0;
        (size_px, is_draft, picture_side, pictures.as_ref().map(Arc::as_ptr)).hash(state);
        (shell.as_ref().map(Arc::as_ptr), held.map(bits)).hash(state);
        floor_picture.as_ref().map(Arc::as_ptr).hash(state);
        (bits(eye.position), bits(eye.target), bits(eye.up), eye.fov_y.to_bits()).hash(state);
        for limb in &scene.limbs {
            (limb.ends.map(bits), limb.radius.to_bits(), limb.solid, limb.colour).hash(state);
        }
        for line in &scene.lines {
            (line.ends.map(bits), line.width_px.to_bits(), line.colour).hash(state);
        }
        for dot in &scene.dots {
            (bits(dot.at), dot.side.to_bits(), dot.colour).hash(state);
        }
        let floor = scene.floor.map(|floor| (bits(floor.centre), floor.cell.map(bits), floor.colour));
        (scene.limbs.len(), scene.lines.len(), scene.dots.len(), floor).hash(state);
        for frustum in frusta {
            (frustum.camera, bits(frustum.apex), frustum.corners.map(bits)).hash(state);
            frustum.opacity.to_bits().hash(state);
        }
    }
}

fn bits(point: DVec3) -> [u64; 3] {
    point.to_array().map(f64::to_bits)
}

/// A picture of the scene.
#[derive(Debug, Clone)]
pub struct SceneDrawing {
    /// What it shows.
    pub order: SceneOrder,
    /// The [key](SceneOrder::key) of that.
    pub(crate) key: u64,
    /// The picture.
    pub image: Arc<ColorImage>,
    /// What stands on the frusta.
    thumbnails: Option<Arc<Thumbnails>>,
}

impl SceneDrawing {
    /// Draws what was ordered. The pictures on the frusta are taken from an earlier drawing of the same frame. The same
    /// order gives the same picture bit for bit, whatever was drawn before.
    pub(crate) fn new(order: SceneOrder, earlier: Option<&Self>) -> Self {
        let thumbnails = order.pictures.as_ref().map(|frame| {
            let kept = earlier.and_then(|earlier| earlier.thumbnails.as_ref());
            let fits = |kept: &&Arc<Thumbnails>| kept.are_of(frame, order.picture_side);
            kept.filter(fits).map_or_else(|| Arc::new(Thumbnails::new(frame, order.picture_side)), Arc::clone)
        });
        let image = draw(&order, thumbnails.as_deref());
        Self { key: order.key(), order, image: Arc::new(image), thumbnails }
    }
}

fn draw(order: &SceneOrder, thumbnails: Option<&Thumbnails>) -> ColorImage {
    let mut pictures = thumbnails.map_or_else(Vec::new, |thumbnails| thumbnails.on(&order.frusta));
    pictures.extend(order.floor_picture.as_deref().map(on_floor));
    let scene = SceneShapes { pictures, ..order.scene.clone() };
    let scene = match &order.shell {
        Some(hull) => SceneShapes { dots: shell(hull, order.eye.position), ..scene },
        None => scene,
    };
    let [width, height] = order.size_px;
    let mut frame = SceneFrame::new(width, height, order.is_draft);
    frame.draw(&order.eye, PICTURE_GROUND, &scene);
    ColorImage::from_rgba_premultiplied([width as usize, height as usize], frame.image().as_raw())
}

fn on_floor(picture: &FloorPicture) -> FlatPicture<'_> {
    let FloorPicture { corner, across, down, image, .. } = picture;
    FlatPicture { corner: *corner, across: *across, down: *down, image, opacity: ON_FLOOR }
}

/// A frame's pictures, at about the size that they are seen.
#[derive(Debug)]
pub struct Thumbnails {
    /// Kept so that no other frame takes its place in memory while these are.
    frame: Arc<FrameData>,
    /// Longest side, in pixels.
    side: u32,
    /// By camera.
    pictures: Vec<Option<RgbaImage>>,
}

impl Thumbnails {
    fn new(frame: &Arc<FrameData>, side: u32) -> Self {
        let small = |image: &RgbImage| {
            let longest = image.width().max(image.height()).max(1);
            let scaled = |length: u32| (length * side.min(longest) / longest).max(1);
            let small = image::imageops::thumbnail(image, scaled(image.width()), scaled(image.height()));
            DynamicImage::ImageRgb8(small).into_rgba8()
        };
        let pictures = frame.cameras.iter().map(|camera| camera.image.as_deref().map(small)).collect();
        Self { frame: frame.clone(), side, pictures }
    }

    fn are_of(&self, frame: &Arc<FrameData>, side: u32) -> bool {
        Arc::ptr_eq(&self.frame, frame) && self.side == side
    }

    fn on(&self, frusta: &[Frustum]) -> Vec<FlatPicture<'_>> {
        let picture = |frustum: &Frustum| {
            let [corner, right, _, below] = frustum.corners;
            let image = self.pictures.get(frustum.camera)?.as_ref()?;
            let opacity = frustum.opacity;
            Some(FlatPicture { corner, across: right - corner, down: below - corner, image, opacity })
        };
        frusta.iter().filter_map(picture).collect()
    }
}

#[cfg(test)]
mod tests {
    use backlit_formats::footage::CameraFrame;
    use backlit_tracking::render::RendererKind;
    use egui::Color32;
    use image::Rgb;

    use crate::features::scene::raster::Limb;

    use super::*;

    fn order() -> SceneOrder {
        let image = RgbImage::from_fn(60, 40, |x, y| Rgb([4 * x as u8, 6 * y as u8, 90]));
        let mut camera = CameraFrame::default();
        camera.image = Some(Arc::new(image));
        let frame = FrameData { frame: 0, cameras: vec![camera], made_with: Default::default() };
        let limb = Limb {
            ends: [DVec3::ZERO, DVec3::Y],
            radius: 0.2,
            solid: RendererKind::Capsule,
            colour: Color32::LIGHT_GRAY,
        };
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.5);
        SceneOrder {
            size_px: [96, 64],
            is_draft: false,
            eye: SceneCamera {
                position: DVec3::new(0.0, 0.5, -4.0),
                target: DVec3::ZERO,
                up: DVec3::Y,
                fov_y: 0.7,
            },
            scene: SceneShapes { limbs: vec![limb], ..SceneShapes::default() },
            frusta: vec![Frustum {
                camera: 0,
                apex: DVec3::new(1.0, 0.0, 2.0),
                corners: [corner(-1.0, 0.8), corner(0.6, 0.8), corner(0.6, -0.4), corner(-1.0, -0.4)],
                opacity: 0.8,
            }],
            pictures: Some(Arc::new(frame)),
            picture_side: 30,
            shell: None,
            floor_picture: None,
            held: Some(DVec3::Y),
        }
    }

    #[test]
    fn the_same_order_gives_the_same_picture_whatever_was_drawn_before() {
        let order = order();
        let first = SceneDrawing::new(order.clone(), None);
        let turned =
            SceneOrder { eye: SceneCamera { position: DVec3::X * 5.0, ..order.eye }, ..order.clone() };
        let between = SceneDrawing::new(SceneOrder { is_draft: true, ..turned }, Some(&first));
        let again = SceneDrawing::new(order, Some(&between));
        assert_ne!(between.image, first.image);
        assert_eq!(again.image, first.image);
        assert_eq!((again.key, again.image.size), (first.key, [96, 64]));
        let shades: std::collections::HashSet<_> = first.image.pixels.iter().collect();
        assert!(shades.len() > 50, "{}", shades.len());
    }

    #[test]
    fn small_pictures_are_made_once_for_a_frame() {
        let order = order();
        let first = SceneDrawing::new(order.clone(), None);
        let same = |drawing: &SceneDrawing| {
            Arc::ptr_eq(drawing.thumbnails.as_ref().unwrap(), first.thumbnails.as_ref().unwrap())
        };
        assert!(same(&SceneDrawing::new(order.clone(), Some(&first))));
        let larger = SceneOrder { picture_side: 40, ..order.clone() };
        assert!(!same(&SceneDrawing::new(larger, Some(&first))));
        let frame = order.pictures.as_deref().cloned().map(Arc::new);
        assert!(!same(&SceneDrawing::new(SceneOrder { pictures: frame, ..order.clone() }, Some(&first))));
        let without = SceneDrawing::new(SceneOrder { pictures: None, ..order }, Some(&first));
        assert!(without.thumbnails.is_none() && without.image != first.image);
    }

    #[test]
    fn whatever_differs_gives_another_key() {
        let order = order();
        let mut others = vec![order.clone(); 9];
        others[0].size_px[0] += 1;
        others[1].is_draft = true;
        others[2].eye.fov_y += 0.1;
        others[3].scene.limbs[0].solid = RendererKind::Cylinder;
        others[4].frusta[0].opacity = 1.0;
        others[5].pictures = None;
        others[6].held = None;
        others[7].scene.limbs[0].ends[1].x = f64::NAN;
        others[8].floor_picture = Some(Arc::new(FloorPicture {
            corner: DVec3::ZERO,
            across: DVec3::X,
            down: DVec3::Z,
            image: RgbaImage::new(2, 2),
            limit_mm: 25.0,
        }));
        let mut keys: Vec<u64> = others.iter().map(SceneOrder::key).collect();
        assert_eq!(
            others[7].key(),
            keys[7],
            "what is not a number is the same as itself, or it would be drawn for ever"
        );
        keys.push(order.key());
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), 10);
    }
}
