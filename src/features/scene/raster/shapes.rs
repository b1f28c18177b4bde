//! Limbs and dots of a scene. Each sample's ray meets the limb itself, so that it is round at every scale; dots are squares
//! that face the viewer.

use backlit_tracking::render::RendererKind;
use egui::Color32;
use glam::DVec3;

use super::frame::{Bounds, channels, clamped_ceil, over};
use super::{Dot, NEAR, Pinhole, SceneFrame};

/// Light on a surface that is turned away from the lamp.
const AMBIENT: f64 = 0.42;

/// Direction to the lamp in the view's axes, of length one: over the viewer's left shoulder.
const TO_LAMP: DVec3 = DVec3::new(-0.40, -0.56, -0.725_534_29);

/// A limb about a segment. All points within the radius belong to a capsule: with both ends in one place it is a sphere. Of
/// a cylinder without length there is nothing to see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// The ends of the segment.
    pub ends: [DVec3; 2],
    pub(crate) radius: f64,
    /// Which solid it is.
    pub(crate) solid: RendererKind,
    /// Its colour in full light; taken as opaque.
    pub(crate) colour: Color32,
}

impl SceneFrame {
    pub(crate) fn draw_limb(&mut self, view: &Pinhole, limb: &Limb) {
        let ends = limb.ends.map(|end| view.in_view(end));
        let Some(bounds) = self.limb_bounds(view, ends, limb.radius) else { return };
        let full_light = channels(limb.colour);
        self.for_each_sample(&bounds, |sample, colour, depth| {
            let ray = view.ray(sample);
            let met = match limb.solid {
                RendererKind::Capsule | RendererKind::SphereTree { .. } => {
                    capsule_hit(ray, ends, limb.radius)
                }
                RendererKind::Cylinder => cylinder_hit(ray, ends, limb.radius),
            };
            let Some((hit, normal)) = met else { return };
            let point = ray * hit;
            if point.z < NEAR || point.z as f32 >= *depth {
                return;
            }
            let light = AMBIENT + (1.0 - AMBIENT) * normal.dot(TO_LAMP).max(0.0);
            *depth = point.z as f32;
            *colour = full_light.map(|channel| channel * light as f32);
        });
    }

    /// The samples a limb may touch: the box about its end spheres as seen, or the whole frame when one
    /// of them reaches too close to the eye for that.
    fn limb_bounds(&self, view: &Pinhole, ends: [DVec3; 2], radius: f64) -> Option<Bounds> {
        let drawable = radius > 0.0 && radius.is_finite() && ends.iter().all(|end| end.is_finite());
        if !drawable || ends.iter().all(|end| end.z + radius < NEAR) {
            return None;
        }
        if ends.iter().any(|end| end.z - radius < NEAR) {
            return Some(self.all());
        }
        let corner = |end: DVec3, side: f64, depth: f64| {
            view.on_screen(end + DVec3::new(side * radius, side * radius, depth * radius))
        };
        let corners = ends.into_iter().flat_map(|end| {
            [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(side, depth)| corner(end, side, depth))
        });
        Some(self.bounds_of(corners))
    }
}

/// Where a limb is first met: how far along the ray from the eye, in lengths of the ray (negative behind the eye), and
/// the direction that its surface faces there.
type RayHit = (f64, DVec3);

fn capsule_hit(ray: DVec3, [a, b]: [DVec3; 2], radius: f64) -> Option<RayHit> {
    let (axis, ray_ray) = (b - a, ray.length_squared());
    let sphere = |centre: DVec3| {
        let half = ray.dot(centre);
        let root = half * half - ray_ray * (centre.length_squared() - radius * radius);
        let hit = (half - root.sqrt()) / ray_ray;
        (root >= 0.0).then(|| (hit, (ray * hit - centre) / radius))
    };
    if runs_along(ray, axis) {
        return [sphere(a), sphere(b)].into_iter().flatten().reduce(|x, y| if x.0 <= y.0 { x } else { y });
    }
    let [hit, _] = tube_hits(ray, a, axis, radius)?;
    let from_a = ray * hit - a;
    let along = axis.dot(from_a) / axis.length_squared();
    if along <= 0.0 {
        sphere(a)
    } else if along >= 1.0 {
        sphere(b)
    } else {
        Some((hit, (from_a - axis * along) / radius))
    }
}

/// The ray is in the limb where it is both in the endless tube and between the planes of the discs.
fn cylinder_hit(ray: DVec3, [a, b]: [DVec3; 2], radius: f64) -> Option<RayHit> {
    let axis = b - a;
    let (length, axis_ray) = (axis.length(), axis.dot(ray));
    let [enters, leaves] = if runs_along(ray, axis) {
        let beside = a - ray * (ray.dot(a) / ray.length_squared());
        (length > 0.0 && beside.length() <= radius).then_some([f64::NEG_INFINITY, f64::INFINITY])?
    } else {
        tube_hits(ray, a, axis, radius)?
    };
    // Infinite where the ray is parallel to the discs.
    let (at_a, at_b) = (axis.dot(a) / axis_ray, axis.dot(b) / axis_ray);
    let (first, last) = (at_a.min(at_b), at_a.max(at_b));
    if enters.max(first) > leaves.min(last) {
        None
    } else if first > enters {
        Some((first, axis * (-axis_ray.signum() / length)))
    } else {
        let from_a = ray * enters - a;
        Some((enters, (from_a - axis * (axis.dot(from_a) / (length * length))) / radius))
    }
}

/// Whether a ray is parallel to an axis, or there is none.
fn runs_along(ray: DVec3, axis: DVec3) -> bool {
    let (axis_axis, axis_ray, ray_ray) = (axis.length_squared(), axis.dot(ray), ray.length_squared());
    axis_axis * ray_ray - axis_ray * axis_ray <= 1e-12 * axis_axis * ray_ray
}

/// Where a ray that does not run along the axis enters and leaves the endless tube about it:
/// square·t² + 2·half·t + rest = 0.
fn tube_hits(ray: DVec3, a: DVec3, axis: DVec3, radius: f64) -> Option<[f64; 2]> {
    let (axis_axis, axis_ray, ray_ray) = (axis.length_squared(), axis.dot(ray), ray.length_squared());
    let square = axis_axis * ray_ray - axis_ray * axis_ray;
    let along_a = -axis.dot(a);
    let half = -axis_axis * ray.dot(a) - along_a * axis_ray;
    let rest = axis_axis * (a.length_squared() - radius * radius) - along_a * along_a;
    let root = half * half - square * rest;
    (root >= 0.0).then(|| [-1.0, 1.0].map(|sign| (sign * root.sqrt() - half) / square))
}

impl SceneFrame {
    /// Draws a square where nothing is nearer. It leaves no depth, so dots mix with each other.
    pub(crate) fn draw_dot(&mut self, view: &Pinhole, dot: &Dot) {
        let point = view.in_view(dot.at);
        if !point.is_finite() || point.z < NEAR {
            return;
        }
        let middle = view.on_screen(point);
        let half = 0.5 * dot.side * view.focal / point.z;
        let (left, right) = (middle.x - half, middle.x + half);
        let (top, bottom) = (middle.y - half, middle.y + half);
        let columns = clamped_ceil(left, self.width)..clamped_ceil(right, self.width);
        let (source, alpha) = (channels(dot.colour), f32::from(dot.colour.a()) / 255.0);
        for y in clamped_ceil(top, self.height)..clamped_ceil(bottom, self.height) {
            for index in columns.clone().map(|x| y * self.width + x) {
                if (point.z as f32) < self.depths[index] {
                    self.colours[index] = over(source, alpha, self.colours[index]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::features::scene::raster::{Limb, SceneCamera, SceneShapes};

    use super::*;

    const ENDS: [DVec3; 2] = [DVec3::new(-0.6, 0.1, 3.0), DVec3::new(0.5, -0.3, 4.2)];
    const RADIUS: f64 = 0.25;

    /// Marching a distance that is never too large finds the same points, and its slope the same directions.
    fn march(distance: impl Fn(DVec3) -> f64, hit: impl Fn(DVec3) -> Option<RayHit>) {
        let mut hits = 0;
        for row in -20..=20 {
            for column in -20..=20 {
                let ray = DVec3::new(f64::from(column) * 0.02, f64::from(row) * 0.02, 1.0);
                let mut travelled = 0.0;
                for _ in 0..2000 {
                    travelled += distance(ray * travelled) / ray.length();
                    // Past all that is there.
                    if travelled > 100.0 {
                        break;
                    }
                }
                let Some((hit, normal)) = hit(ray) else {
                    assert!(travelled > 10.0, "{column}, {row}: missed at {travelled}");
                    continue;
                };
                hits += 1;
                assert!((hit - travelled).abs() < 1e-3, "{column}, {row}: {hit} {travelled}");
                assert!((normal.length() - 1.0).abs() < 1e-6 && normal.dot(ray) < 1e-6, "{column}, {row}");
                let away = distance(ray * hit + normal * 0.01) - distance(ray * hit);
                assert!((away - 0.01).abs() < 1e-3, "{column}, {row}: {normal} {away}");
            }
        }
        assert!(hits > 100, "{hits}");
    }

    /// Along the axis in its lengths, and from it.
    fn about_axis(point: DVec3) -> (f64, f64) {
        let axis = ENDS[1] - ENDS[0];
        let along = (point - ENDS[0]).dot(axis) / axis.length_squared();
        (along, point.distance(ENDS[0] + axis * along))
    }

    #[test]
    fn capsule_hits_lie_on_the_surface() {
        let axis = ENDS[1] - ENDS[0];
        let distance =
            |point: DVec3| point.distance(ENDS[0] + axis * about_axis(point).0.clamp(0.0, 1.0)) - RADIUS;
        march(distance, |ray| capsule_hit(ray, ENDS, RADIUS));
    }

    #[test]
    fn cylinder_hits_lie_on_the_tube_or_its_flat_ends() {
        let length = ENDS[0].distance(ENDS[1]);
        let distance = |point: DVec3| {
            let (along, beside) = about_axis(point);
            let out = [((along - 0.5).abs() - 0.5) * length, beside - RADIUS];
            if out[0].max(out[1]) < 0.0 { out[0].max(out[1]) } else { out[0].max(0.0).hypot(out[1].max(0.0)) }
        };
        march(distance, |ray| cylinder_hit(ray, ENDS, RADIUS));
    }

    #[test]
    fn the_lamp_is_a_direction() {
        assert!((TO_LAMP.length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn along_the_axis_the_flat_end_is_nearer_to_the_middle_than_the_round_one() {
        let ends = [DVec3::new(0.0, 0.0, 3.0), DVec3::new(0.0, 0.0, 4.0)];
        let (round, _) = capsule_hit(DVec3::Z, ends, 0.5).unwrap();
        let (flat, normal) = cylinder_hit(DVec3::Z, ends, 0.5).unwrap();
        assert_eq!((round, flat, normal), (2.5, 3.0, -DVec3::Z));
        let beside = ends.map(|end| end + DVec3::X * 0.6);
        assert_eq!((capsule_hit(DVec3::Z, beside, 0.5), cylinder_hit(DVec3::Z, beside, 0.5)), (None, None));
        assert_eq!(cylinder_hit(DVec3::Z, [ends[0]; 2], 0.5), None, "a disc without a direction");
    }

    #[test]
    fn dots_are_hidden_by_what_is_nearer_and_mix_with_the_rest() {
        let camera = SceneCamera {
            position: DVec3::new(0.0, 0.0, -4.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
            fov_y: 0.5,
        };
        let green = Color32::from_rgba_premultiplied(0, 100, 0, 128);
        let dot = |z: f64| Dot { at: DVec3::new(0.0, 0.0, z), side: 1.0, colour: green };
        let ball =
            Limb { ends: [DVec3::ZERO; 2], radius: 0.2, solid: RendererKind::Capsule, colour: Color32::RED };
        let draw = |scene: &SceneShapes<'_>| {
            let mut frame = SceneFrame::new(41, 41, true);
            frame.draw(&camera, Color32::from_rgb(200, 0, 0), scene);
            let image = frame.image();
            [image.get_pixel(20, 20).0, image.get_pixel(20, 14).0, image.get_pixel(20, 2).0]
        };
        let [middle, beside, outside] =
            draw(&SceneShapes { limbs: vec![ball], dots: vec![dot(1.0)], ..SceneShapes::default() });
        assert_eq!((middle[1], beside[1], outside[1]), (0, 100, 0));
        assert!(beside[0] < 110, "half of the ground shines through: {beside:?}");
        let [middle, ..] =
            draw(&SceneShapes { limbs: vec![ball], dots: vec![dot(-1.0)], ..SceneShapes::default() });
        assert_eq!(middle[1], 100);
        let nowhere = Dot { at: DVec3::splat(f64::NAN), ..dot(0.0) };
        assert_eq!(draw(&SceneShapes { dots: vec![nowhere, dot(-9.0)], ..SceneShapes::default() })[0][1], 0);
    }
}
