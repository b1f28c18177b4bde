//! Rays into pictures: the empty room once a camera, then the figure, its shadows and its edges every frame.

use backlit_tracking::camera::Camera;
use backlit_tracking::silhouette::{Label, Mask, MaskError};
use glam::{DVec2, DVec3};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;

use super::figure::{Figure, STEP};
use super::noise::unit;
use super::room::Room;
use super::shading::{LAMPS, Shade, ambient, figure_light, lamp_seen, open_sky, room_colours};

/// Linear light per pixel, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Light per pixel, row by row.
    pub light: Vec<DVec3>,
}

impl Picture {
    /// A picture of one colour.
    #[must_use]
    pub fn filled(width: usize, height: usize, light: DVec3) -> Self {
        Self { width, height, light: vec![light; width * height] }
    }

    /// The pixel nearest to x, y, which may lie outside.
    pub(super) fn clamped(&self, x: isize, y: isize) -> DVec3 {
        let x = x.clamp(0, self.width as isize - 1) as usize;
        let y = y.clamp(0, self.height as isize - 1) as usize;
        self.light[y * self.width + x]
    }
}

/// What a pixel of the empty room is made of, kept apart so that the figure can shade it.
#[derive(Debug, Clone, Copy, Default)]
struct PlatePixel {
    position: DVec3,
    normal: DVec3,
    own: DVec3,
    ambient: DVec3,
    lamps: [DVec3; 3],
}

/// The empty room as one camera sees it.
#[derive(Debug, Clone)]
pub struct Plate {
    camera: Camera,
    pixels: Vec<PlatePixel>,
}

/// How far a figure's shade on the room reaches, metres.
const CONTACT_REACH: f64 = 0.35;

impl Plate {
    /// Renders the room with `samples`² rays a pixel. The same for the same room, camera and samples.
    #[must_use]
    pub fn new(room: &Room, camera: &Camera, samples: usize) -> Self {
        let rows: Vec<Vec<PlatePixel>> = (0..camera.height())
            .into_par_iter()
            .map(|y| {
                let mut random = Pcg64Mcg::seed_from_u64(y as u64 + 1);
                (0..camera.width()).map(|x| plate_pixel(room, camera, [x, y], samples, &mut random)).collect()
            })
            .collect();
        Self { camera: camera.clone(), pixels: rows.concat() }
    }

    /// The room with nobody in it.
    #[must_use]
    pub fn empty(&self) -> Picture {
        let light = self
            .pixels
            .iter()
            .map(|pixel| pixel.own + pixel.ambient + pixel.lamps.iter().copied().sum::<DVec3>());
        Picture { width: self.camera.width(), height: self.camera.height(), light: light.collect() }
    }

    /// The room with the figure in it, its edges and textures smoothed over `samples`² rays a pixel.
    #[must_use]
    pub fn with_figure(&self, figure: &Figure, samples: usize) -> Picture {
        let (width, height) = (self.camera.width(), self.camera.height());
        let light = each_pixel([width, height], |x, y| {
            let behind = self.pixels[y * width + x].shaded(figure);
            figure_over(&self.camera, figure, [x, y], samples, behind)
        });
        Picture { width, height, light }
    }

    /// The figure before the empty room in light without any shadow, one ray a pixel, and its exact silhouette: what takes
    /// seconds with shadows takes tenths. `may_be` says at which pixels the figure may be at all.
    ///
    /// # Errors
    /// The camera's pictures are larger than a mask may be.
    pub fn with_unshaded_figure(
        &self,
        figure: &Figure,
        may_be: impl Fn(usize, usize) -> bool + Sync,
    ) -> Result<(Picture, Mask), MaskError> {
        let (width, height) = (self.camera.width(), self.camera.height());
        let mut picture = self.empty();
        let mut labels = vec![Label::Background; width * height];
        let origin = self.camera.centre();
        let rows = picture.light.par_chunks_mut(width).zip(labels.par_chunks_mut(width)).enumerate();
        rows.for_each(|(y, (light, labels))| {
            for (x, (light, label)) in light.iter_mut().zip(labels).enumerate().filter(|(x, _)| may_be(*x, y))
            {
                let Some(ray) = self.camera.ray_in_world(DVec2::new(x as f64, y as f64)) else { continue };
                let Some(t) = figure.intersect(origin, ray) else { continue };
                let at = origin + ray * t;
                *light = figure_light(figure, at, ray, &Shade::none(at));
                *label = Label::Subject;
            }
        });
        Ok((picture, Mask::new(width, height, labels)?))
    }
}

/// Something of every pixel, row by row, from all cores.
pub(super) fn each_pixel<T: Clone + Send>(
    [width, height]: [usize; 2],
    of: impl Fn(usize, usize) -> T + Sync,
) -> Vec<T> {
    let row = |y| (0..width).map(|x| of(x, y)).collect::<Vec<T>>();
    (0..height).into_par_iter().map(row).collect::<Vec<_>>().concat()
}

impl PlatePixel {
    fn shaded(&self, figure: &Figure) -> DVec3 {
        let (centre, radius) = figure.bounding_ball();
        let near = self.position.distance(centre) < radius + CONTACT_REACH;
        let open = if near { open_sky(figure, self.position, self.normal, CONTACT_REACH) } else { 1.0 };
        // Light from the floor around still comes in below the figure.
        let mut light = self.own + self.ambient * (0.4 + 0.6 * open);
        for (lamp, arriving) in LAMPS.iter().zip(self.lamps) {
            if arriving.max_element() > 1e-4 {
                light += arriving * lamp_seen(figure, self.position, self.normal, lamp);
            }
        }
        light
    }
}

fn plate_pixel(
    room: &Room,
    camera: &Camera,
    at: [usize; 2],
    samples: usize,
    random: &mut Pcg64Mcg,
) -> PlatePixel {
    /// Random directions a ray to see how open a place is.
    const SKY_RAYS: usize = 3;
    /// How far away things still darken a place, metres.
    const SKY_REACH: f64 = 0.7;
    let origin = camera.centre();
    let mut sum = PlatePixel::default();
    let share = 1.0 / (samples * samples) as f64;
    let open_share = |position: DVec3, normal: DVec3, random: &mut Pcg64Mcg| {
        let mut open = 0.0;
        for _ in 0..SKY_RAYS {
            let around = DVec3::new(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
            let direction = (normal + around.normalize_or(normal) * 0.98).normalize();
            let hit = room.intersect(position, direction);
            open += (hit.position.distance(position) / SKY_REACH).min(1.0);
        }
        open / SKY_RAYS as f64
    };
    for offset in offsets(samples) {
        let pixel = DVec2::new(at[0] as f64, at[1] as f64) + offset;
        let Some(direction) = camera.ray_in_world(pixel) else { continue };
        let hit = room.intersect(origin, direction);
        let (colour, own) = room_colours(&hit);
        sum.own += own * share;
        let start = hit.position + hit.normal * 1e-4;
        for (sum, lamp) in sum.lamps.iter_mut().zip(&LAMPS) {
            let from = lamp.point(2.0 * unit(random) - 1.0, 2.0 * unit(random) - 1.0);
            let light = lamp.light(from, start, hit.normal);
            if light.max_element() > 0.0 && !room.blocks(start, from) {
                *sum += colour * light * share;
            }
        }
        if colour.max_element() > 0.0 {
            sum.ambient += colour * ambient(hit.normal) * (open_share(start, hit.normal, random) * share);
        }
    }
    if let Some(direction) = camera.ray_in_world(DVec2::new(at[0] as f64, at[1] as f64)) {
        let hit = room.intersect(origin, direction);
        (sum.position, sum.normal) = (hit.position, hit.normal);
    }
    sum
}

fn figure_over(camera: &Camera, figure: &Figure, at: [usize; 2], samples: usize, behind: DVec3) -> DVec3 {
    let centre = DVec2::new(at[0] as f64, at[1] as f64);
    let origin = camera.centre();
    let Some(direction) = camera.ray_in_world(centre) else { return behind };
    // Rays that pass the figure by more than a pixel's breadth need no second look.
    let breadth = 1.5 / camera.intrinsics().mean_focal_px();
    if clearance(figure, origin, direction) > breadth {
        return behind;
    }
    let mut sum = DVec3::ZERO;
    let mut shade: Option<Shade> = None;
    for offset in offsets(samples) {
        let Some(direction) = camera.ray_in_world(centre + offset) else { continue };
        sum += figure.intersect(origin, direction).map_or(behind, |t| {
            let position = origin + direction * t;
            let near = shade.filter(|shade| shade.serves(position));
            let shade = shade.insert(near.unwrap_or_else(|| Shade::new(figure, position)));
            figure_light(figure, position, direction, shade)
        });
    }
    sum / (samples * samples) as f64
}

/// The smallest angle (radians, roughly) by which a ray misses the figure; 0 for a hit.
fn clearance(figure: &Figure, origin: DVec3, direction: DVec3) -> f64 {
    let (centre, radius) = figure.bounding_ball();
    let middle = (centre - origin).dot(direction);
    if (origin + direction * middle).distance(centre) > radius {
        return f64::INFINITY;
    }
    let mut t = (middle - radius).max(0.05);
    let mut least = f64::INFINITY;
    while t < middle + radius {
        let distance = figure.distance(origin + direction * t);
        least = least.min(distance.max(0.0) / t);
        if distance < 3e-4 {
            return 0.0;
        }
        t += (distance * STEP).max(2e-3);
    }
    least
}

/// Places of the rays in a pixel, which reaches half a unit to each side.
fn offsets(samples: usize) -> impl Iterator<Item = DVec2> {
    let place = move |i: usize| (i as f64 + 0.5) / samples as f64 - 0.5;
    (0..samples * samples).map(move |i| DVec2::new(place(i % samples), place(i / samples)))
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;
    use crate::synthetic::{Build, Sensor, motion, studio};

    fn small() -> Camera {
        studio::cameras().cameras()[1].resized(24, 32).unwrap()
    }

    fn figure() -> Figure {
        let model = builtin::full_body();
        Figure::new(&model, &motion::pose(&model, 20.0), Build::default()).unwrap()
    }

    #[test]
    fn the_same_bytes_on_any_number_of_threads() {
        let bytes = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let plate = Plate::new(&Room::default(), &small(), 2);
                Sensor::default().expose(&plate.with_figure(&figure(), 2), 1.0, 5).into_raw()
            })
        };
        assert_eq!(bytes(1), bytes(3));
    }

    /// The quick picture has the exact silhouette, and is the empty room elsewhere.
    #[test]
    fn a_figure_without_shadows_has_the_same_silhouette() {
        let camera = small();
        let plate = Plate::new(&Room::default(), &camera, 1);
        let (picture, mask) = plate.with_unshaded_figure(&figure(), |_, _| true).unwrap();
        assert_eq!(mask, crate::synthetic::silhouette(&figure(), &camera).unwrap());
        let empty = plate.empty();
        let changed = empty.light.iter().zip(&picture.light).map(|(empty, light)| empty != light);
        assert!(changed.eq(mask.labels().iter().map(|label| *label == Label::Subject)));
    }

    /// The picture changes where the figure is and where its shadow falls, and hardly elsewhere.
    #[test]
    fn the_figure_stands_in_the_room_and_casts_a_shadow() {
        let camera = small();
        let plate = Plate::new(&Room::default(), &camera, 2);
        let (empty, full) = (plate.empty(), plate.with_figure(&figure(), 2));
        let mask = crate::synthetic::silhouette(&figure(), &camera).unwrap();
        let (mut subject, mut darker) = (0, 0);
        for ((before, after), label) in empty.light.iter().zip(&full.light).zip(mask.labels()) {
            assert!(before.is_finite() && after.is_finite() && after.min_element() >= 0.0);
            if *label == Label::Subject {
                subject += usize::from(before.distance(*after) > 0.02);
            } else {
                darker += usize::from(after.element_sum() < 0.9 * before.element_sum());
            }
        }
        let area = mask.count(Label::Subject);
        assert!(subject * 10 > area * 8, "{subject} of {area}");
        assert!(darker > 5, "{darker} pixels in shadow");
    }
}
