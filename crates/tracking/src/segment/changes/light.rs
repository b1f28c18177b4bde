//! How much brighter each part of a picture became: log gain = cᵀ b(x, y), b = (1, u, v, u², uv, v²), channel by channel, with u and
//! v from −1 to 1 across the picture. The coefficients c are those of Tukey's biweight over log(i / µ), by iteratively reweighted
//! least squares (P. J. Huber, *Robust Statistics*, 1981): what is pasted over the picture or stands before it weighs nothing.

use image::RgbImage;
use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use super::super::background::Background;
use super::{BackgroundChange, ChangeKind, LearntPixels};
use crate::statistics::upper_median;

/// How many places are looked at along the longer side of a picture, about.
const PLACES: usize = 80;
/// Levels outside of these say little about a factor, or may be clipped.
const USABLE: [f32; 2] = [24.0, 245.0];
/// Fewer usable places than this say nothing.
const FEWEST: usize = 200;
const ITERATIONS: usize = 8;
/// Tukey's constant: 95 % as efficient as least squares with normal noise.
const TUKEY: f64 = 4.685;
/// No smaller deviation of a log gain is believed: noise of one place.
const LEAST_DEVIATION: f64 = 0.02;
/// Log gains are kept as multiples of this.
const UNIT: f64 = 1e-4;
/// Light has changed where log gains differ by this much across the picture.
const LEAST_SPREAD: f64 = 0.12;
/// The number of samples with changed light that are a change.
const FEWEST_SAMPLES: usize = 5;

/// The log gains of one frame, in ten-thousandths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightKey {
    /// The frame.
    pub frame: usize,
    /// The coefficients of red, green and blue.
    pub log_gains: [[i32; 6]; 3],
}

/// How much brighter each part of a picture is than its background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightField {
    coefficients: [[f64; 6]; 3],
    /// How much log gains differ across what was looked at, less a twentieth at either end.
    pub spread: f64,
}

fn basis([x, y]: [usize; 2], [width, height]: [usize; 2]) -> [f64; 6] {
    let along = |at: usize, side: usize| 2.0 * at as f64 / (side as f64 - 1.0).max(1.0) - 1.0;
    let (u, v) = (along(x, width), along(y, height));
    [1.0, u, v, u * u, u * v, v * v]
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl LightField {
    /// Compares a frame with its background where `is_background` says so of a pixel, counted row by row. `None` where too little
    /// is to be seen, or the frame is of another size.
    #[must_use]
    pub fn fit(
        frame: &RgbImage,
        background: &Background,
        is_background: impl Fn(usize) -> bool,
    ) -> Option<Self> {
        let size @ [width, height] = [background.width(), background.height()];
        if [frame.width() as usize, frame.height() as usize] != size {
            return None;
        }
        let levels = frame.as_raw().as_chunks::<3>().0;
        let stride = width.max(height).div_ceil(PLACES);
        let mut places: Vec<([f64; 6], [f64; 3])> = Vec::new();
        let usable = USABLE[0]..=USABLE[1];
        for y in (stride / 2..height).step_by(stride) {
            for x in (stride / 2..width).step_by(stride) {
                let pixel = y * width + x;
                let (i, mean) = (levels[pixel].map(f32::from), background.mean()[pixel]);
                let all = |levels: &[f32; 3]| levels.iter().all(|level| usable.contains(level));
                if is_background(pixel) && all(&i) && all(&mean) {
                    let ratio = [0, 1, 2].map(|c| f64::from(i[c] / mean[c]).ln());
                    places.push((basis([x, y], size), ratio));
                }
            }
        }
        if places.len() < FEWEST {
            return None;
        }
        let coefficients = [0, 1, 2].map(|channel| fit_channel(&places, channel));
        let mut across: Vec<f64> = places
            .iter()
            .map(|(basis, _)| coefficients.iter().map(|c| dot(c, basis)).sum::<f64>() / 3.0)
            .collect();
        across.sort_unstable_by(f64::total_cmp);
        let end = across.len() / 20;
        let spread = across[across.len() - 1 - end] - across[end];
        Some(Self { coefficients, spread })
    }

    /// The gains of red, green and blue at a pixel of a picture of this size.
    #[must_use]
    pub fn gains(&self, pixel: [usize; 2], size: [usize; 2]) -> [f32; 3] {
        let basis = basis(pixel, size);
        self.coefficients.map(|coefficients| dot(&coefficients, &basis).exp() as f32)
    }

    /// The light of a frame between these; `None` if there are none.
    #[must_use]
    pub fn between(keys: &[LightKey], frame: usize) -> Option<Self> {
        let after = keys.iter().find(|key| key.frame >= frame).or(keys.last())?;
        let before = keys.iter().rfind(|key| key.frame <= frame).unwrap_or(after);
        let length = after.frame.abs_diff(before.frame).max(1) as f64;
        let share = (frame.saturating_sub(before.frame) as f64 / length).min(1.0);
        let mut coefficients = [[0.0; 6]; 3];
        for (channel, mixed) in coefficients.iter_mut().enumerate() {
            for (k, mixed) in mixed.iter_mut().enumerate() {
                let ends = [before, after].map(|key| f64::from(key.log_gains[channel][k]) * UNIT);
                *mixed = ends[0] + share * (ends[1] - ends[0]);
            }
        }
        Some(Self { coefficients, spread: 0.0 })
    }

    /// The same for a frame, to be kept.
    #[must_use]
    pub fn key(&self, frame: usize) -> LightKey {
        let log_gains = self.coefficients.map(|channel| channel.map(|c| (c / UNIT).round() as i32));
        LightKey { frame, log_gains }
    }

    /// How far it is from another, as the mean difference of log gains across the picture.
    fn distance(&self, other: &Self) -> f64 {
        let ends = [0, 2, 4];
        let places = ends.into_iter().flat_map(|x| ends.map(|y| basis([x, y], [5, 5])));
        let off = |at: &[f64; 6]| {
            let channels = self.coefficients.iter().zip(&other.coefficients);
            channels.map(|(a, b)| (dot(a, at) - dot(b, at)).abs()).sum::<f64>() / 3.0
        };
        places.map(|at| off(&at)).sum::<f64>() / 9.0
    }
}

fn fit_channel(places: &[([f64; 6], [f64; 3])], channel: usize) -> [f64; 6] {
    let mut ratios: Vec<f64> = places.iter().map(|(_, ratio)| ratio[channel]).collect();
    let mut coefficients = [0.0; 6];
    coefficients[0] = upper_median(&mut ratios).unwrap_or(0.0);
    for _ in 0..ITERATIONS {
        let off = |(basis, ratio): &([f64; 6], [f64; 3])| ratio[channel] - dot(&coefficients, basis);
        let mut sizes: Vec<f64> = places.iter().map(|place| off(place).abs()).collect();
        let reach = TUKEY * (1.4826 * upper_median(&mut sizes).unwrap_or(0.0)).max(LEAST_DEVIATION);
        // A little weight on no slope keeps it solvable where few places are left.
        let mut normal = SMatrix::<f64, 6, 6>::identity();
        normal[(0, 0)] = 1e-9;
        let mut right = SVector::<f64, 6>::zeros();
        for place in places {
            let weight = (1.0 - (off(place) / reach).powi(2)).max(0.0).powi(2);
            let row = SVector::from(place.0);
            normal += weight * row * row.transpose();
            right += weight * place.1[channel] * row;
        }
        let Some(solved) = normal.cholesky().map(|factor| factor.solve(&right)) else { break };
        coefficients = solved.into();
    }
    coefficients
}

/// The change of a camera's light, from the fields of sampled frames in their order; `None` where light stays as the background has
/// it. Where it changes from one sample to the next, `field` is asked for frames between them until the step is found.
pub fn light_change<E>(
    camera: usize,
    samples: &[(usize, LightField)],
    mut field: impl FnMut(usize) -> Result<Option<LightField>, E>,
) -> Result<Option<BackgroundChange>, E> {
    let is_changed = |(_, field): &(usize, LightField)| field.spread > LEAST_SPREAD;
    if samples.iter().filter(|sample| is_changed(sample)).count() < FEWEST_SAMPLES {
        return Ok(None);
    }
    let first = samples.iter().position(is_changed).unwrap_or(0).saturating_sub(1);
    let last = samples.iter().rposition(is_changed).unwrap_or(0) + 1;
    let until = samples.get(last).map(|(frame, _)| *frame);
    let samples = &samples[first..samples.len().min(last + 1)];
    let mut light: Vec<LightKey> = Vec::new();
    for pair in samples.windows(2) {
        let [(mut low, before), (mut high, after)] = [pair[0], pair[1]];
        light.push(before.key(low));
        if before.distance(&after) < 0.5 * LEAST_SPREAD {
            continue;
        }
        while high - low > 1 {
            let middle = low.midpoint(high);
            let Some(found) = field(middle)? else { break };
            if found.distance(&before) < found.distance(&after) { low = middle } else { high = middle }
        }
        if low > pair[0].0 {
            light.push(before.key(low));
        }
        if high < pair[1].0 {
            light.push(after.key(high));
        }
    }
    light.extend(samples.last().map(|(frame, field)| field.key(*frame)));
    // The first sample is as it was, and so is what comes before a step.
    let from = match light[..] {
        _ if is_changed(&samples[0]) => samples[0].0,
        [first, second, ..] if first.log_gains == second.log_gains => second.frame + 1,
        _ => samples[0].0 + 1,
    };
    let pixels = LearntPixels::default();
    Ok(Some(BackgroundChange { camera, from, until, kind: ChangeKind::Light, pixels, light }))
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use image::Rgb;

    use super::*;

    const SIZE: [usize; 2] = [160, 120];

    fn plate() -> RgbImage {
        RgbImage::from_fn(160, 120, |x, y| Rgb([60 + (x * 7 % 50) as u8, 70 + (y * 5 % 40) as u8, 90]))
    }

    /// A lamp at the right side, of this strength, and something large and blue before the middle.
    fn lit(strength: f32) -> RgbImage {
        let mut picture = plate();
        for (x, y, pixel) in picture.enumerate_pixels_mut() {
            let gain = 1.0 + strength * x as f32 / 160.0;
            *pixel = Rgb(pixel.0.map(|level| (f32::from(level) * gain).round().min(255.0) as u8));
            if (50..90).contains(&x) && y > 30 {
                *pixel = Rgb([30, 40, 220]);
            }
        }
        picture
    }

    fn field(strength: f32) -> LightField {
        LightField::fit(&lit(strength), &Background::from_plate(&plate()), |_| true).unwrap()
    }

    #[test]
    fn a_lamp_is_found_behind_a_body() {
        let found = field(0.6);
        assert!(found.spread > 0.3, "{}", found.spread);
        for x in [0, 60, 159] {
            let expected = 1.0 + 0.6 * x as f32 / 160.0;
            for gain in found.gains([x, 60], SIZE) {
                assert!((gain / expected - 1.0).abs() < 0.03, "{x}: {gain} instead of {expected}");
            }
        }
        assert!(field(0.0).spread < 0.5 * LEAST_SPREAD);
    }

    fn change(strength: impl Fn(usize) -> f32) -> Option<BackgroundChange> {
        let samples: Vec<(usize, LightField)> = (0..20).map(|k| (5 * k, field(strength(5 * k)))).collect();
        light_change(2, &samples, |frame| Ok::<_, Infallible>(Some(field(strength(frame))))).unwrap()
    }

    #[test]
    fn light_changes_at_once_slowly_or_not_at_all() {
        assert_eq!(change(|_| 0.0), None);
        let at_once = change(|frame| if (33..71).contains(&frame) { 0.6 } else { 0.0 }).unwrap();
        assert_eq!((at_once.camera, at_once.from, at_once.kind), (2, 33, ChangeKind::Light));
        let slowly = change(|frame| 0.6 * (frame as f32 - 30.0).clamp(0.0, 40.0) / 40.0).unwrap();
        assert!((30..50).contains(&slowly.from) && slowly.until.is_none(), "{slowly:?}");
        for (change, strength, frame) in [
            (&at_once, 0.0, 32),
            (&at_once, 0.6, 33),
            (&at_once, 0.6, 70),
            (&at_once, 0.0, 71),
            (&slowly, 0.3, 50),
        ] {
            let gain = LightField::between(&change.light, frame).unwrap().gains([159, 60], SIZE)[0];
            assert!((gain / (1.0 + strength) - 1.0).abs() < 0.04, "frame {frame}: {gain}");
        }
    }

    #[test]
    fn too_little_says_nothing() {
        let background = Background::from_plate(&plate());
        assert!(LightField::fit(&lit(0.6), &background, |pixel| pixel < 40).is_none());
        assert!(LightField::fit(&RgbImage::new(8, 8), &background, |_| true).is_none());
    }
}
