//! Draws a scene into a colour and a depth buffer.

use egui::Color32;
use glam::{DMat3, DVec2, DVec3};
use image::{Rgba, RgbaImage};

use super::{FlatPicture, NEAR, Pinhole, SceneCamera, SceneLine, SceneShapes};

/// Samples across and down a pixel, and those of a draft.
const SAMPLES: u32 = 2;
const DRAFT_SAMPLES: u32 = 1;

/// A line is drawn this share of its depth closer than it is, so that it shows on surfaces it lies in.
const LINE_LIFT: f64 = 0.002;

/// The picture of a scene with its depth buffer, to be kept from frame to frame.
#[derive(Debug)]
pub(crate) struct SceneFrame {
    size: [u32; 2],
    samples: u32,
    /// Samples across and down.
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) colours: Vec<[f32; 3]>,
    pub(crate) depths: Vec<f32>,
}

/// Samples `left..right` by `top..bottom`.
pub(crate) struct Bounds {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

impl SceneFrame {
    /// A black frame of `width` × `height` pixels. A draft is drawn in a quarter of the time, with one sample a pixel: for
    /// what moves.
    pub(crate) fn new(width: u32, height: u32, is_draft: bool) -> Self {
        let samples = if is_draft { DRAFT_SAMPLES } else { SAMPLES };
        let sides = [width, height].map(|pixels| (pixels * samples) as usize);
        let count = sides[0] * sides[1];
        Self {
            size: [width, height],
            samples,
            width: sides[0],
            height: sides[1],
            colours: vec![[0.0; 3]; count],
            depths: vec![f32::INFINITY; count],
        }
    }

    /// Draws `scene` on `background`, taken as opaque, and forgets what was drawn before.
    pub(crate) fn draw(&mut self, camera: &SceneCamera, background: Color32, scene: &SceneShapes<'_>) {
        self.colours.fill(channels(background));
        self.depths.fill(f32::INFINITY);
        let view = Pinhole::new(camera, self.size, self.samples);
        for limb in &scene.limbs {
            self.draw_limb(&view, limb);
        }
        for line in scene.floor.iter().flat_map(super::Floor::lines) {
            self.draw_line(&view, &line);
        }
        let depth = |picture: &FlatPicture<'_>| {
            view.in_view(picture.corner + 0.5 * (picture.across + picture.down)).z
        };
        let mut pictures: Vec<_> = scene.pictures.iter().collect();
        pictures.sort_by(|a, b| depth(b).total_cmp(&depth(a)));
        for picture in pictures {
            self.draw_picture(&view, picture);
        }
        for dot in &scene.dots {
            self.draw_dot(&view, dot);
        }
        for line in &scene.lines {
            self.draw_line(&view, line);
        }
    }

    /// The picture, opaque.
    pub(crate) fn image(&self) -> RgbaImage {
        let per_axis = self.samples as usize;
        let share = 1.0 / (per_axis * per_axis) as f32;
        RgbaImage::from_fn(self.size[0], self.size[1], |x, y| {
            let mut sum = [0.0; 3];
            for row in 0..per_axis {
                let start = (y as usize * per_axis + row) * self.width + x as usize * per_axis;
                for colour in &self.colours[start..start + per_axis] {
                    sum = std::array::from_fn(|i| sum[i] + colour[i]);
                }
            }
            let [r, g, b] = sum.map(|total| (total * share + 0.5) as u8);
            Rgba([r, g, b, 255])
        })
    }

    fn draw_picture(&mut self, view: &Pinhole, picture: &FlatPicture<'_>) {
        let corner = view.in_view(picture.corner);
        let across = view.view_from_world * picture.across;
        let down = view.view_from_world * picture.down;
        // ray · t = corner + u · across + v · down, so this matrix times the ray is (u, v, 1) / t.
        let axes = DMat3::from_cols(across, down, corner);
        let [width, height] = [picture.image.width(), picture.image.height()];
        let volume = across.length() * down.length() * corner.length();
        if !axes.is_finite() || axes.determinant().abs() <= 1e-9 * volume || width == 0 || height == 0 {
            return;
        }
        let picture_from_ray = axes.inverse();
        let corners = [corner, corner + across, corner + down, corner + across + down];
        let bounds = if corners.iter().any(|corner| corner.z < NEAR) {
            self.all()
        } else {
            self.bounds_of(corners.into_iter().map(|corner| view.on_screen(corner)))
        };
        let opacity = picture.opacity.clamp(0.0, 1.0) / 255.0;
        self.for_each_sample(&bounds, |sample, colour, depth| {
            let hit = picture_from_ray * view.ray(sample);
            let (u, v, distance) = (hit.x / hit.z, hit.y / hit.z, hit.z.recip());
            let on_picture = (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v);
            if !on_picture || distance < NEAR || distance as f32 >= *depth {
                return;
            }
            let (x, y) = ((u * f64::from(width)) as u32, (v * f64::from(height)) as u32);
            let Rgba([r, g, b, a]) = *picture.image.get_pixel(x.min(width - 1), y.min(height - 1));
            let alpha = f32::from(a) * opacity;
            *colour = over([r, g, b].map(|channel| f32::from(channel) * alpha), alpha, *colour);
            if alpha > 0.5 {
                *depth = distance as f32;
            }
        });
    }

    /// Walks along the axis in which the line is longer and draws a short run of samples across it, so the
    /// cost is that of the line's own samples. The line tests depths but leaves none.
    fn draw_line(&mut self, view: &Pinhole, line: &SceneLine) {
        let Some(ends) = clip_to_near(line.ends.map(|end| view.in_view(end))) else { return };
        let seen = ends.map(|end| view.on_screen(end));
        let is_steep = (seen[1].y - seen[0].y).abs() > (seen[1].x - seen[0].x).abs();
        let order = |p: DVec2| if is_steep { DVec2::new(p.y, p.x) } else { p };
        let [mut from, mut to] = seen.map(order);
        let mut nearness = ends.map(|end| end.z.recip());
        if from.x > to.x {
            std::mem::swap(&mut from, &mut to);
            nearness.swap(0, 1);
        }
        let [long, short] = if is_steep { [self.height, self.width] } else { [self.width, self.height] };
        let slope = (to.y - from.y) / (to.x - from.x).max(1e-9);
        let half_width = 0.5 * line.width_px * f64::from(self.samples) * slope.hypot(1.0);
        let source = channels(line.colour);
        let alpha = f32::from(line.colour.a()) / 255.0;
        let (first, last) = (clamped_ceil(from.x, long), clamped_ceil(to.x, long));
        for step in first..last {
            let share = (step as f64 - from.x) / (to.x - from.x).max(1e-9);
            let depth = (1.0 - LINE_LIFT) / (nearness[0] + (nearness[1] - nearness[0]) * share);
            let middle = from.y + slope * (step as f64 - from.x);
            let low = clamped_ceil(middle - half_width, short);
            let high = clamped_ceil(middle + half_width, short);
            for across in low..high {
                let index = if is_steep { step * self.width + across } else { across * self.width + step };
                if (depth as f32) < self.depths[index] {
                    self.colours[index] = over(source, alpha, self.colours[index]);
                }
            }
        }
    }

    pub(crate) fn all(&self) -> Bounds {
        Bounds { left: 0, top: 0, right: self.width, bottom: self.height }
    }

    pub(crate) fn bounds_of(&self, points: impl Iterator<Item = DVec2>) -> Bounds {
        let (low, high) = points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), point| {
            (low.min(point), high.max(point))
        });
        Bounds {
            left: clamped_ceil(low.x, self.width),
            top: clamped_ceil(low.y, self.height),
            right: clamped_ceil(high.x + 1.0, self.width),
            bottom: clamped_ceil(high.y + 1.0, self.height),
        }
    }

    pub(crate) fn for_each_sample(
        &mut self,
        bounds: &Bounds,
        mut draw: impl FnMut(DVec2, &mut [f32; 3], &mut f32),
    ) {
        for y in bounds.top..bounds.bottom {
            let row = y * self.width;
            for x in bounds.left..bounds.right {
                let sample = DVec2::new(x as f64, y as f64);
                draw(sample, &mut self.colours[row + x], &mut self.depths[row + x]);
            }
        }
    }
}

/// The first integer not below `value`, held within `0..=limit`.
pub(crate) fn clamped_ceil(value: f64, limit: usize) -> usize {
    value.ceil().clamp(0.0, limit as f64) as usize
}

/// The part of a segment at least [`NEAR`] in front of the eye.
fn clip_to_near([a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
    if !a.is_finite() || !b.is_finite() || (a.z < NEAR && b.z < NEAR) {
        return None;
    }
    let crossing = |behind: DVec3, before: DVec3| {
        let mut point = behind + (before - behind) * ((NEAR - behind.z) / (before.z - behind.z));
        point.z = NEAR;
        point
    };
    Some(match (a.z < NEAR, b.z < NEAR) {
        (true, _) => [crossing(a, b), b],
        (_, true) => [a, crossing(b, a)],
        _ => [a, b],
    })
}

pub(crate) fn channels(colour: Color32) -> [f32; 3] {
    [colour.r(), colour.g(), colour.b()].map(f32::from)
}

pub(crate) fn over(source: [f32; 3], alpha: f32, target: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|i| source[i] + target[i] * (1.0 - alpha))
}

#[cfg(test)]
mod tests {
    use backlit_tracking::render::RendererKind;

    use super::*;
    use crate::features::scene::raster::{Floor, Limb};

    const CAMERA: SceneCamera =
        SceneCamera { position: DVec3::new(0.0, 0.0, -4.0), target: DVec3::ZERO, up: DVec3::Y, fov_y: 0.5 };
    const RED: Color32 = Color32::from_rgb(250, 0, 0);
    const BLUE: Color32 = Color32::from_rgb(0, 0, 250);
    const GREEN: Color32 = Color32::from_rgb(0, 250, 0);

    fn capsule(ends: [(f64, f64, f64); 2], radius: f64, colour: Color32) -> Limb {
        let ends = ends.map(|(x, y, z)| DVec3::new(x, y, z));
        Limb { ends, radius, solid: RendererKind::Capsule, colour }
    }

    /// One letter a pixel: the strongest of red, green and blue.
    fn letters(scene: &SceneShapes<'_>) -> Vec<String> {
        let mut frame = SceneFrame::new(20, 10, false);
        frame.draw(&CAMERA, Color32::BLACK, scene);
        let image = frame.image();
        let letter = |x, y| {
            let [r, g, b, _] = image.get_pixel(x, y).0;
            match r.max(g).max(b) {
                0..50 => '.',
                most if most == r => 'r',
                most if most == g => 'g',
                _ => 'b',
            }
        };
        (0..10).map(|y| (0..20).map(|x| letter(x, y)).collect()).collect()
    }

    #[test]
    fn nearer_limbs_and_lines_hide_farther_ones() {
        let scene = SceneShapes {
            limbs: vec![
                capsule([(-1.2, 0.0, 0.0), (1.2, 0.0, 0.0)], 0.3, RED),
                capsule([(0.0, 0.0, -1.0), (0.0, 0.0, -1.0)], 0.4, BLUE),
            ],
            lines: vec![
                SceneLine {
                    ends: [DVec3::new(-3.0, 0.7, 0.0), DVec3::new(3.0, 0.7, 0.0)],
                    width_px: 1.0,
                    colour: GREEN,
                },
                SceneLine {
                    ends: [DVec3::new(0.8, -3.0, 1.0), DVec3::new(0.8, 3.0, 1.0)],
                    width_px: 1.0,
                    colour: GREEN,
                },
            ],
            ..SceneShapes::default()
        };
        assert_eq!(
            letters(&scene),
            [
                "......gg............",
                "gggggggggggggggggggg",
                "......ggbbb.........",
                "...rrrrgbbbbrrrrr...",
                "..rrrrrrbbbbrrrrr...",
                "..rrrrrbbbbbrrrrr...",
                "....rrggbbbb.rrr....",
                "......gg.bb.........",
                "......gg............",
                "......gg............",
            ]
        );
    }

    #[test]
    fn pictures_are_upright_and_in_their_place() {
        let mut image = RgbaImage::from_pixel(2, 2, Rgba([0, 0, 250, 255]));
        image.put_pixel(0, 0, Rgba([250, 0, 0, 255]));
        image.put_pixel(1, 0, Rgba([0, 250, 0, 255]));
        // Seen from −z with y up, x runs to the left.
        let picture = FlatPicture {
            corner: DVec3::new(0.8, 0.6, 0.0),
            across: DVec3::new(-1.6, 0.0, 0.0),
            down: DVec3::new(0.0, -1.2, 0.0),
            image: &image,
            opacity: 1.0,
        };
        let hidden = capsule([(0.0, 0.0, 1.0), (0.0, 0.0, 1.0)], 0.2, RED);
        let scene = SceneShapes { limbs: vec![hidden], pictures: vec![picture], ..SceneShapes::default() };
        assert_eq!(
            letters(&scene),
            [
                "....................",
                "....................",
                "......rrrrgggg......",
                "......rrrrgggg......",
                "......rrrrgggg......",
                "......bbbbbbbb......",
                "......bbbbbbbb......",
                "......bbbbbbbb......",
                "....................",
                "....................",
            ]
        );
    }

    #[test]
    fn translucent_pictures_mix_with_what_is_behind() {
        let image = RgbaImage::from_pixel(1, 1, Rgba([200, 0, 0, 255]));
        let picture = FlatPicture {
            corner: DVec3::new(5.0, 5.0, 0.0),
            across: DVec3::new(-10.0, 0.0, 0.0),
            down: DVec3::new(0.0, -10.0, 0.0),
            image: &image,
            opacity: 0.25,
        };
        let mut frame = SceneFrame::new(6, 4, false);
        let scene = SceneShapes { pictures: vec![picture], ..SceneShapes::default() };
        frame.draw(&CAMERA, Color32::from_rgb(0, 0, 100), &scene);
        assert!(frame.image().pixels().all(|pixel| pixel.0 == [50, 0, 75, 255]));
    }

    #[test]
    fn the_floor_runs_through_the_eye_plane() {
        let floor = Floor {
            centre: DVec3::new(0.0, -0.4, 0.0),
            cell: [DVec3::X, DVec3::Z],
            half_cells: 9,
            colour: GREEN,
        };
        let scene = SceneShapes { floor: Some(floor), ..SceneShapes::default() };
        let rows = letters(&scene);
        assert!(rows[..5].iter().all(|row| !row.contains('g')), "{rows:#?}");
        assert!(rows[5..].iter().all(|row| row.contains('g')), "{rows:#?}");
        assert_eq!(floor.lines().count(), 38);
    }

    #[test]
    fn the_lit_side_faces_the_lamp() {
        let scene = SceneShapes {
            limbs: vec![capsule([(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], 0.8, RED)],
            ..SceneShapes::default()
        };
        let mut frame = SceneFrame::new(41, 41, false);
        frame.draw(&CAMERA, Color32::BLACK, &scene);
        let image = frame.image();
        let red = |x, y| image.get_pixel(x, y).0[0];
        assert!(red(13, 11) > red(27, 29) + 60, "{} {}", red(13, 11), red(27, 29));
    }

    #[test]
    fn what_is_not_finite_or_surrounds_the_eye_is_harmless() {
        let image = RgbaImage::new(0, 0);
        let nowhere = DVec3::splat(f64::NAN);
        let edge_on = FlatPicture {
            corner: CAMERA.position,
            across: DVec3::X,
            down: DVec3::Z,
            image: &image,
            opacity: 1.0,
        };
        let scene = SceneShapes {
            limbs: vec![
                Limb { ends: [nowhere, DVec3::ZERO], ..capsule(Default::default(), 0.1, RED) },
                Limb { radius: f64::NAN, ..capsule([(0.0, 0.0, -4.0), (0.0, 0.0, 0.0)], 0.1, RED) },
                capsule([(0.0, 0.0, -4.0), (0.0, 0.0, -9.0)], 0.5, RED),
                capsule([(0.0, 0.0, -9.0), (0.0, 0.0, -9.0)], 0.5, RED),
            ],
            pictures: vec![edge_on],
            lines: vec![
                SceneLine { ends: [nowhere, DVec3::ZERO], width_px: 2.0, colour: GREEN },
                SceneLine { ends: [DVec3::ZERO; 2], width_px: f64::NAN, colour: GREEN },
            ],
            ..SceneShapes::default()
        };
        assert!(letters(&scene).iter().all(|row| row == "...................."));
    }
}
