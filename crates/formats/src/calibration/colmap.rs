//! COLMAP's text: lenses in `cameras.txt`, places in `images.txt`.
//!
//! A camera of ours is an image, by its name; several may share a lens. QW QX QY QZ TX TY TZ are camera from world, of
//! no known unit. Pixel centres are at halves: cx and cy are half a pixel more than ours. Every image has a second
//! line, its points, which may be empty.

use std::path::Path;

use backlit_tracking::camera::{CameraFromWorld, Distortion, Intrinsics};
use glam::{DMat3, DQuat, DVec3};

use super::lens;
use super::partial::{PartialCamera, PartialCameras, Pinhole};
use crate::{FileError, FileProblem, Result};

/// Which of the two files a text is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Which {
    Cameras,
    Images,
}

/// Told by the first line that is no comment.
pub(super) fn which(text: &str) -> Option<Which> {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'))?;
    let words: Vec<&str> = first.split_ascii_whitespace().collect();
    words.first()?.parse::<u32>().ok()?;
    let is_model = |word: &str| {
        word.bytes().all(|byte| byte.is_ascii_uppercase() || byte == b'_')
            && word.contains(|c: char| c.is_alphabetic())
    };
    if words.len() >= 4 && is_model(words[1]) {
        return Some(Which::Cameras);
    }
    let numbers = words.iter().take(9).filter(|word| word.parse::<f64>().is_ok()).count();
    (words.len() >= 10 && numbers == 9).then_some(Which::Images)
}

pub(super) fn parts(path: &Path, text: &str, which: Which) -> Result<PartialCameras> {
    let mut parts = PartialCameras::new(None);
    let mut is_points = false;
    for (index, line) in text.lines().enumerate() {
        let row = ColmapLine { path, line: index + 1, words: line.split_ascii_whitespace().collect() };
        if line.trim_start().starts_with('#') {
            continue;
        }
        match which {
            Which::Cameras if row.words.is_empty() => {}
            Which::Cameras => parts.push(path, row.lens()?)?,
            Which::Images => {
                if !is_points && row.words.is_empty() {
                    continue;
                }
                if !is_points {
                    parts.push(path, row.image(line)?)?;
                }
                is_points = !is_points;
            }
        }
    }
    Ok(parts)
}

struct ColmapLine<'a> {
    path: &'a Path,
    line: usize,
    words: Vec<&'a str>,
}

impl ColmapLine<'_> {
    fn error(&self, field: &str, found: &str, expected: &str) -> FileError {
        FileProblem::field(field, found, expected).at(self.path, self.line)
    }

    fn word(&self, index: usize, field: &str) -> Result<&str> {
        self.words.get(index).copied().ok_or_else(|| self.error(field, "missing", "more words in the line"))
    }

    fn number(&self, index: usize, field: &str) -> Result<f64> {
        let word = self.word(index, field)?;
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| self.error(field, word, "a finite number"))
    }

    /// `CAMERA_ID MODEL WIDTH HEIGHT PARAMS`.
    fn lens(&self) -> Result<PartialCamera> {
        let side = |index, field| {
            let word = self.word(index, field)?;
            word.parse::<u64>().ok().ok_or_else(|| self.error(field, word, "a whole number of pixels"))
        };
        let mut part = PartialCamera::new(self.word(0, "CAMERA_ID")?, self.line);
        part.size = Some([side(2, "WIDTH")?, side(3, "HEIGHT")?]);
        let model = self.word(1, "MODEL")?;
        // How many focal lengths, and how many coefficients after the centre.
        let (focal, count) = match model {
            "SIMPLE_PINHOLE" => (1, 0),
            "PINHOLE" => (2, 0),
            "SIMPLE_RADIAL" | "SIMPLE_RADIAL_FISHEYE" => (1, 1),
            "RADIAL" | "RADIAL_FISHEYE" => (1, 2),
            "OPENCV" | "OPENCV_FISHEYE" => (2, 4),
            "FULL_OPENCV" => (2, 8),
            _ => {
                let expected = "a pinhole with a radial lens, OPENCV, FULL_OPENCV or a fisheye of those";
                return Err(self.error("MODEL", model, expected));
            }
        };
        let expected = 4 + focal + 2 + count;
        if self.words.len() != expected {
            let (found, wanted) = (self.words.len().saturating_sub(4), focal + 2 + count);
            let expected = format!("{wanted} numbers for {model}");
            return Err(self.error("PARAMS", &format!("{found} numbers"), &expected));
        }
        let number = |index| self.number(4 + index, &format!("PARAMS[{index}]"));
        let (fx, fy) = (number(0)?, number(focal - 1)?);
        let (cx, cy) = (number(focal)? - 0.5, number(focal + 1)? - 0.5);
        let numbers = (focal + 2..focal + 2 + count).map(number).collect::<Result<Vec<f64>, _>>()?;
        let value = |index: usize| numbers.get(index).copied().unwrap_or(0.0);
        let distortion = if model.ends_with("FISHEYE") {
            Distortion::Fisheye { k1: value(0), k2: value(1), k3: value(2), k4: value(3) }
        } else {
            let padded: Vec<f64> = (0..8).map(value).collect();
            lens::opencv_lens(&padded).unwrap_or_default()
        };
        part.lens = Some((Pinhole::Pixels(Intrinsics { fx, fy, cx, cy }), distortion));
        Ok(part)
    }

    /// `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`; a name may have spaces in it.
    fn image(&self, line: &str) -> Result<PartialCamera> {
        const NUMBERS: [&str; 7] = ["QW", "QX", "QY", "QZ", "TX", "TY", "TZ"];
        let mut numbers = [0.0; 7];
        for (index, number) in numbers.iter_mut().enumerate() {
            *number = self.number(1 + index, NUMBERS[index])?;
        }
        let [w, x, y, z, tx, ty, tz] = numbers;
        let quaternion = DQuat::from_xyzw(x, y, z, w);
        if (quaternion.length() - 1.0).abs() > 1e-3 {
            let found = format!("of length {}", quaternion.length());
            return Err(self.error("QW QX QY QZ", &found, "a unit quaternion"));
        }
        self.word(9, "NAME")?;
        let mut rest = line.trim();
        for _ in 0..9 {
            rest =
                rest.split_once(|c: char| c.is_ascii_whitespace()).map_or("", |(_, rest)| rest.trim_start());
        }
        let mut part = PartialCamera::new(rest, self.line);
        part.lens_name = Some(self.word(8, "CAMERA_ID")?.to_owned());
        part.place = Some(CameraFromWorld {
            rotation: DMat3::from_quat(quaternion.normalize()),
            translation: DVec3::new(tx, ty, tz),
        });
        Ok(part)
    }
}
