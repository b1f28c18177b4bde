//! One camera's pictures, disturbed from some frame on: something is pasted over them, or the light changes.

use std::f64::consts::TAU;

use image::{Rgb, RgbImage};

/// What disturbs the pictures of one camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureDisturbance {
    /// A patch as large as an arm that stands still.
    StandingLimb,
    /// A patch as large as a body that stands still.
    StandingBody,
    /// A patch as large as an arm that goes to and fro, before the subject too.
    MovingLimb,
    /// A patch as large as a body that goes to and fro.
    MovingBody,
    /// A lamp at one side that grows brighter within a hundred frames.
    SlowLight,
    /// The same lamp, switched on.
    SuddenLight,
}

/// Width and height of patches, as shares of the picture's height.
const LIMB: [f64; 2] = [0.04, 0.16];
const BODY: [f64; 2] = [0.12, 0.42];
/// Frames in which a patch has gone to and fro, and in which a lamp has grown bright.
const PERIOD: f64 = 100.0;
/// How much brighter the lamp makes the side that is nearest.
const LAMP: f64 = 0.6;

impl PictureDisturbance {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::StandingLimb,
        Self::StandingBody,
        Self::MovingLimb,
        Self::MovingBody,
        Self::SlowLight,
        Self::SuddenLight,
    ];

    /// Disturbs a picture; `since` counts frames from the first that is disturbed.
    pub fn apply(self, picture: &mut RgbImage, since: usize) {
        let phase = since as f64 / PERIOD;
        let to_and_fro = 0.5 - 0.4 * (TAU * phase).cos();
        match self {
            Self::StandingLimb => paste(picture, LIMB, [0.22, 0.5]),
            Self::StandingBody => paste(picture, BODY, [0.22, 0.5]),
            Self::MovingLimb => paste(picture, LIMB, [to_and_fro, 0.5]),
            Self::MovingBody => paste(picture, BODY, [to_and_fro, 0.5]),
            Self::SlowLight => light(picture, LAMP * phase.min(1.0)),
            Self::SuddenLight => light(picture, LAMP),
        }
    }
}

/// Pastes a chequered patch about a place, which is a share of width and height.
fn paste(picture: &mut RgbImage, [wide, high]: [f64; 2], [x, y]: [f64; 2]) {
    let (width, height) = (f64::from(picture.width()), f64::from(picture.height()));
    let cell = (height / 60.0).max(1.0);
    for (column, row, pixel) in picture.enumerate_pixels_mut() {
        let away = [f64::from(column) - x * width, f64::from(row) - y * height];
        if away[0].abs() <= 0.5 * wide * height && away[1].abs() <= 0.5 * high * height {
            let square = away.map(|along| (along / cell).floor() as i64);
            let is_light = (square[0] + square[1]).rem_euclid(2) == 0;
            *pixel = if is_light { Rgb([214, 120, 60]) } else { Rgb([60, 90, 170]) };
        }
    }
}

/// Makes the right side brighter by this share, the left as it was.
fn light(picture: &mut RgbImage, strength: f64) {
    let width = f64::from(picture.width());
    for (column, _, pixel) in picture.enumerate_pixels_mut() {
        let gain = 1.0 + strength * f64::from(column) / width;
        *pixel = Rgb(pixel.0.map(|level| (f64::from(level) * gain).round().min(255.0) as u8));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_are_as_large_as_they_say_and_light_grows() {
        let plain = RgbImage::from_pixel(240, 320, Rgb([100; 3]));
        let changed = |disturbance: PictureDisturbance, since: usize| {
            let mut picture = plain.clone();
            disturbance.apply(&mut picture, since);
            picture.pixels().zip(plain.pixels()).filter(|(a, b)| a != b).count() as f64 / (320.0 * 320.0)
        };
        for (disturbance, [wide, high]) in [
            (PictureDisturbance::StandingLimb, LIMB),
            (PictureDisturbance::StandingBody, BODY),
            (PictureDisturbance::MovingBody, BODY),
        ] {
            let share = changed(disturbance, 50);
            assert!((share / (wide * high) - 1.0).abs() < 0.1, "{disturbance:?}: {share}");
        }
        assert_eq!(changed(PictureDisturbance::SlowLight, 0), 0.0);
        assert!(changed(PictureDisturbance::SlowLight, 100) > 0.7);
        assert_eq!(changed(PictureDisturbance::SlowLight, 100), changed(PictureDisturbance::SuddenLight, 0));
    }
}
