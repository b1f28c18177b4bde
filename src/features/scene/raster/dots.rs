//! Dots of a scene: squares that face the viewer.

use super::frame::{channels, clamped_ceil, over};
use super::{Dot, NEAR, SceneFrame, View};

impl SceneFrame {
    /// Draws a square where nothing is nearer. It leaves no depth, so dots mix with each other.
    pub(crate) fn draw_dot(&mut self, view: &View, dot: &Dot) {
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
    use egui::Color32;
    use glam::DVec3;

    use super::*;
    use crate::features::scene::raster::{Ends, Limb, Scene, SceneCamera};

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
        let ball = Limb { ends: [DVec3::ZERO; 2], radius: 0.2, shape: Ends::Round, colour: Color32::RED };
        let draw = |scene: &Scene<'_>| {
            let mut frame = SceneFrame::draft(41, 41);
            frame.draw(&camera, Color32::from_rgb(200, 0, 0), scene);
            let image = frame.image();
            [image.get_pixel(20, 20).0, image.get_pixel(20, 14).0, image.get_pixel(20, 2).0]
        };
        let [middle, beside, outside] =
            draw(&Scene { limbs: vec![ball], dots: vec![dot(1.0)], ..Scene::default() });
        assert_eq!((middle[1], beside[1], outside[1]), (0, 100, 0));
        assert!(beside[0] < 110, "half of the ground shines through: {beside:?}");
        let [middle, ..] = draw(&Scene { limbs: vec![ball], dots: vec![dot(-1.0)], ..Scene::default() });
        assert_eq!(middle[1], 100);
        let nowhere = Dot { at: DVec3::splat(f64::NAN), ..dot(0.0) };
        assert_eq!(draw(&Scene { dots: vec![nowhere, dot(-9.0)], ..Scene::default() })[0][1], 0);
    }
}
