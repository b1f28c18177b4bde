//! Plates learnt from footage: what a camera sees without the subject, as far as its frames tell.

mod without_body;

use std::path::Path;

use backlit_tracking::segment::{BackgroundError, LearningFrame, LearningOptions, learn_plate};
use image::{DynamicImage, RgbImage, Rgba, RgbaImage};

use crate::take::PlateKnowledge;
use crate::{Result, images};

pub use without_body::{PlateError, plate_without_body};

/// Most frames that a plate is learnt from.
pub(crate) const MOST_FRAMES: usize = 120;
/// The subject covers a pixel always if it does so in this share of the frames.
const ALWAYS: f64 = 0.95;

/// A plate, and what it knows of each pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Plate {
    /// What the camera sees without the subject; black where that is not known.
    pub picture: RgbImage,
    /// What is known, row by row.
    pub known: Vec<PlateKnowledge>,
}

impl Plate {
    /// Learns a plate from frames, and which pixels the subject covers always.
    pub(crate) fn learn(
        frames: &[LearningFrame<'_>],
        options: &LearningOptions,
        covered: &Covered,
    ) -> Result<Self, BackgroundError> {
        let learnt = learn_plate(frames, options)?;
        let known = learnt.known.iter().enumerate().map(|(index, &known)| match known {
            true => PlateKnowledge::Scene,
            false if covered.always(index) => PlateKnowledge::AlwaysSubject,
            false => PlateKnowledge::Nothing,
        });
        Ok(Self { known: known.collect(), picture: learnt.picture })
    }

    /// The share of the pixels in which the scene is known, 0 to 1.
    #[must_use]
    pub fn known_share(&self) -> f64 {
        let known = self.known.iter().filter(|known| **known == PlateKnowledge::Scene).count();
        known as f64 / self.known.len().max(1) as f64
    }

    /// Writes it as a PNG whose alpha channel says what is known.
    pub fn write(&self, path: &Path) -> Result<()> {
        let mut picture = RgbaImage::new(self.picture.width(), self.picture.height());
        for ((pixel, seen), known) in picture.pixels_mut().zip(self.picture.pixels()).zip(&self.known) {
            let [r, g, b] = seen.0;
            *pixel = Rgba([r, g, b, known.alpha()]);
        }
        images::write_png(path, &DynamicImage::ImageRgba8(picture))
    }
}

/// In how many frames the subject surely covers each pixel.
#[derive(Default)]
pub(crate) struct Covered {
    counts: Vec<usize>,
    frames: usize,
}

impl Covered {
    /// Counts one more frame: which of its pixels the subject surely covers, row by row.
    pub(crate) fn add(&mut self, covered: impl ExactSizeIterator<Item = bool>) {
        self.counts.resize(covered.len(), 0);
        self.frames += 1;
        self.counts.iter_mut().zip(covered).for_each(|(count, is_covered)| *count += usize::from(is_covered));
    }

    /// Whether that is so in nearly all frames.
    fn always(&self, pixel: usize) -> bool {
        let count = self.counts.get(pixel).copied().unwrap_or(0);
        self.frames > 0 && count as f64 >= ALWAYS * self.frames as f64
    }
}

/// A camera's name as the name of a plate's file.
#[must_use]
pub fn file_name(camera: &str) -> String {
    let allowed = |letter: char| letter.is_alphanumeric() || matches!(letter, '-' | '_' | '.' | ' ');
    let stem: String = camera.chars().map(|letter| if allowed(letter) { letter } else { '_' }).collect();
    format!("{stem}.png")
}
