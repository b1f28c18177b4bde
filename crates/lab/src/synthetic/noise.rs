//! What a camera does to light: exposure, a film-like curve, noise that grows with the signal, eight bits.

use backlit_tracking::statistics::normal;
use glam::DVec3;
use image::{Rgb, RgbImage};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::render::Picture;

/// A camera's sensor and its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Linear gain before the curve.
    pub exposure: f64,
    /// Standard deviation of the dark signal; 1 is the scene's white.
    pub read_noise: f64,
    /// Variance per unit of signal.
    pub shot_noise: f64,
    /// Share of a pixel's light that the lens spreads over each of its four neighbours.
    pub blur: f64,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { exposure: 1.45, read_noise: 0.0025, shot_noise: 1.4e-4, blur: 0.06 }
    }
}

impl Sensor {
    /// The picture that the sensor gives; the same for the same light, gain and seed.
    #[must_use]
    pub fn expose(&self, light: &Picture, gain: f64, seed: u64) -> RgbImage {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut image = RgbImage::new(light.width as u32, light.height as u32);
        for (x, y, pixel) in image.enumerate_pixels_mut() {
            let (x, y) = (x as usize, y as usize);
            let beside = [(-1, 0), (1, 0), (0, -1), (0, 1)]
                .map(|(dx, dy)| light.clamped(x as isize + dx, y as isize + dy));
            let spread = light.clamped(x as isize, y as isize) * (1.0 - 4.0 * self.blur)
                + beside.into_iter().sum::<DVec3>() * self.blur;
            let signal = spread * (self.exposure * gain);
            *pixel = Rgb(signal.to_array().map(|value| {
                let deviation = (self.read_noise * self.read_noise + self.shot_noise * value.max(0.0)).sqrt();
                code(value + deviation * normal(&mut random))
            }));
        }
        image
    }
}

/// Linear light to eight bits: a shoulder that reaches white at [`WHITE`], then the sRGB curve.
fn code(light: f64) -> u8 {
    /// Light that is rendered as full white.
    const WHITE: f64 = 2.6;
    let light = light.max(0.0);
    let rolled = (light * (1.0 + light / (WHITE * WHITE)) / (1.0 + light * 0.85)).min(1.0);
    let coded = if rolled <= 0.003_130_8 { 12.92 * rolled } else { 1.055 * rolled.powf(1.0 / 2.4) - 0.055 };
    (coded * 255.0 + 0.5) as u8
}

/// A uniform number in 0 … 1, 1 excluded.
pub(super) fn unit(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_grows_with_the_light_and_repeats_with_the_seed() {
        let deviation = |light: f64| {
            let picture = Picture::filled(64, 64, DVec3::splat(light));
            let image = Sensor::default().expose(&picture, 1.0, 3);
            assert_eq!(image, Sensor::default().expose(&picture, 1.0, 3));
            let levels: Vec<f64> = image.pixels().map(|pixel| f64::from(pixel[1])).collect();
            let mean = levels.iter().sum::<f64>() / levels.len() as f64;
            let variance = levels.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / levels.len() as f64;
            (mean, variance.sqrt())
        };
        let (mean, noise) = deviation(0.3);
        assert!((100.0..190.0).contains(&mean) && (0.5..4.0).contains(&noise), "{mean} {noise}");
        assert!(deviation(0.0).0 < 6.0 && deviation(50.0).0 > 254.0);
    }
}
