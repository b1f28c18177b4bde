//! What a camera sees without the subject: per pixel and channel a mean µ and a standard deviation σ, in grey levels, and
//! those of the gradient's magnitude, |∇B|µ and |∇B|σ, in grey levels a pixel; and mean and deviation of the grey picture.

use image::RgbImage;

use super::bit_image::BitImage;
use super::gradient;

/// Why a background could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BackgroundError {
    /// Fewer than two frames: there is no deviation to measure.
    #[error("a background needs at least two frames, or one plate; got {0} frames")]
    TooFewFrames(usize),
    /// The frames differ in size.
    #[error("frame {index} has {}×{} pixels, the first has {}×{}", found.0, found.1, expected.0, expected.1)]
    SizeMismatch {
        /// Which frame, counted from 0.
        index: usize,
        /// Width and height of the first frame.
        expected: (u32, u32),
        /// Width and height of this frame.
        found: (u32, u32),
    },
    /// More frames than these, which are all that the sums can hold.
    #[error("a background is averaged over at most {0} frames")]
    TooManyFrames(u32),
    /// Not one value a pixel.
    #[error("the known pixels of a background: got {found} values for {expected} pixels")]
    Known {
        /// How many values there were.
        found: usize,
        /// How many pixels the background has.
        expected: usize,
    },
}

/// The most frames to average: 255² times as many still fit the sums.
const MAX_FRAMES: u32 = 1 << 16;

/// A pixel of the grey picture, in grey levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GreyLevel {
    /// µ.
    pub(super) mean: f32,
    /// σ.
    pub(super) deviation: f32,
}

/// How bright a colour is, to the next whole level (BT.601).
pub(super) fn grey_of([red, green, blue]: [u8; 3]) -> u8 {
    let weighed = 299 * u32::from(red) + 587 * u32::from(green) + 114 * u32::from(blue);
    ((weighed + 500) / 1000) as u8
}

/// The scene without the subject, as one camera sees it.
///
/// Means lie in [0, 255]; deviations are finite and not negative. A plate has the deviation zero:
/// [`SegmentOptions::noise_floor`](super::SegmentOptions::noise_floor) says how far to trust either.
#[derive(Clone, Debug, PartialEq)]
pub struct Background {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) mean: Vec<[f32; 3]>,
    pub(super) deviation: Vec<[f32; 3]>,
    pub(super) gradient_mean: Vec<[f32; 3]>,
    pub(super) gradient_deviation: Vec<[f32; 3]>,
    pub(super) grey: Vec<GreyLevel>,
    is_plate: bool,
    /// The pixels of which nobody knows what the camera sees there without the subject, if there are any.
    pub(super) unknown: Option<BitImage>,
}

impl Background {
    /// One clean picture of the scene, with no knowledge of its noise.
    pub fn from_plate(plate: &RgbImage) -> Self {
        let mean: Vec<[f32; 3]> = plate.pixels().map(|pixel| pixel.0.map(f32::from)).collect();
        let none = vec![[0.0; 3]; mean.len()];
        let grey = |pixel: &image::Rgb<u8>| GreyLevel { mean: f32::from(grey_of(pixel.0)), deviation: 0.0 };
        Self {
            width: plate.width() as usize,
            height: plate.height() as usize,
            mean,
            deviation: none.clone(),
            gradient_mean: gradient::magnitudes(plate),
            gradient_deviation: none,
            grey: plate.pixels().map(grey).collect(),
            is_plate: true,
            unknown: None,
        }
    }

    /// Mean and (sample) standard deviation over frames of the empty scene.
    ///
    /// # Errors
    /// If there are fewer than two frames or more than 65 536, or if they differ in size.
    pub fn from_frames<'a>(frames: impl IntoIterator<Item = &'a RgbImage>) -> Result<Self, BackgroundError> {
        let mut sums = BackgroundSums::default();
        frames.into_iter().try_for_each(|frame| sums.add(frame))?;
        sums.background()
    }

    /// The same, of which only the pixels that are `known` (one a pixel, row by row) are believed: the others are unknown in
    /// every mask.
    ///
    /// # Errors
    /// If there is not one value a pixel.
    pub fn with_known(self, known: &[bool]) -> Result<Self, BackgroundError> {
        if known.len() != self.width * self.height {
            return Err(BackgroundError::Known { found: known.len(), expected: self.width * self.height });
        }
        let mut unknown = BitImage::empty(self.width.max(1), self.height);
        for (y, row) in known.chunks_exact(self.width.max(1)).enumerate() {
            unknown.set_row(y, &row.iter().map(|&known| u8::from(!known)).collect::<Vec<_>>());
        }
        Ok(Self { unknown: known.contains(&false).then_some(unknown), ..self })
    }

    /// The pixels of which nobody knows what the camera sees there without the subject, if there are any.
    pub(super) fn unknown(&self) -> Option<&BitImage> {
        self.unknown.as_ref()
    }

    /// Whether it is one picture, so that no deviation is known.
    pub fn is_plate(&self) -> bool {
        self.is_plate
    }

    /// The grey picture, row by row.
    pub(super) fn grey(&self) -> &[GreyLevel] {
        &self.grey
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The mean colour µ of each pixel (red, green, blue in grey levels), row by row.
    pub fn mean(&self) -> &[[f32; 3]] {
        &self.mean
    }

    /// The standard deviation σ of each pixel and channel in grey levels, row by row.
    pub fn deviation(&self) -> &[[f32; 3]] {
        &self.deviation
    }

    /// |∇B|µ: the mean magnitude of the gradient of each pixel and channel in grey levels a pixel, row by row. Gradients are
    /// central differences; at the border the picture is continued by its outermost pixels.
    pub fn gradient_mean(&self) -> &[[f32; 3]] {
        &self.gradient_mean
    }

    /// |∇B|σ: the standard deviation of that magnitude in grey levels a pixel, row by row.
    pub fn gradient_deviation(&self) -> &[[f32; 3]] {
        &self.gradient_deviation
    }
}

/// A background that is made of one frame after the other, so that no frame need be kept.
#[derive(Debug, Default)]
pub struct BackgroundSums {
    size: (u32, u32),
    count: u32,
    levels: Vec<[u32; 3]>,
    squares: Vec<[u32; 3]>,
    /// Sum and sum of squares of the grey picture.
    greys: Vec<[u32; 2]>,
    /// Sums of the gradient's magnitude are counted from the first frame's: so a still pixel has exactly no deviation.
    first_gradient: Vec<[f32; 3]>,
    gradients: Vec<[f32; 3]>,
    gradient_squares: Vec<[f32; 3]>,
}

impl BackgroundSums {
    /// Counts one more frame of the empty scene.
    ///
    /// # Errors
    /// If it is not of the first one's size, or is one more than 65 536.
    pub fn add(&mut self, frame: &RgbImage) -> Result<(), BackgroundError> {
        if self.count == 0 {
            self.size = frame.dimensions();
            self.first_gradient = gradient::magnitudes(frame);
            let pixels = self.first_gradient.len();
            (self.levels, self.squares) = (vec![[0; 3]; pixels], vec![[0; 3]; pixels]);
            self.greys = vec![[0; 2]; pixels];
            (self.gradients, self.gradient_squares) = (vec![[0.0; 3]; pixels], vec![[0.0; 3]; pixels]);
        }
        if frame.dimensions() != self.size {
            let (index, expected, found) = (self.count as usize, self.size, frame.dimensions());
            return Err(BackgroundError::SizeMismatch { index, expected, found });
        }
        if self.count == MAX_FRAMES {
            return Err(BackgroundError::TooManyFrames(MAX_FRAMES));
        }
        self.count += 1;
        let sums = self.levels.as_flattened_mut().iter_mut().zip(self.squares.as_flattened_mut());
        for ((sum, square), &level) in sums.zip(frame.as_raw()) {
            *sum += u32::from(level);
            *square += u32::from(level).pow(2);
        }
        let (width, levels) = (self.size.0 as usize, frame.as_raw().as_chunks::<3>().0);
        for ([sum, square], &colour) in self.greys.iter_mut().zip(levels) {
            let level = u32::from(grey_of(colour));
            (*sum, *square) = (*sum + level, *square + level * level);
        }
        let sums = self.gradients.iter_mut().zip(&mut self.gradient_squares).zip(&self.first_gradient);
        for (index, ((sum, square), first)) in sums.enumerate() {
            let size = [width, self.size.1 as usize];
            let found = gradient::magnitude(levels, size, index % width, index / width);
            for channel in 0..3 {
                let off = found[channel] - first[channel];
                sum[channel] += off;
                square[channel] += off * off;
            }
        }
        Ok(())
    }

    /// Mean and (sample) standard deviation of all that were counted.
    ///
    /// # Errors
    /// If there are fewer than two.
    pub fn background(self) -> Result<Background, BackgroundError> {
        if self.count < 2 {
            return Err(BackgroundError::TooFewFrames(self.count as usize));
        }
        let n = f64::from(self.count);
        // Integer sums make the difference exact, so a still pixel has exactly no deviation.
        let deviation = |sum: u32, square: u32| {
            let spread = u64::from(self.count) * u64::from(square) - u64::from(sum).pow(2);
            (spread as f64 / (n * (n - 1.0))).sqrt() as f32
        };
        let grey = |&[sum, square]: &[u32; 2]| GreyLevel {
            mean: (f64::from(sum) / n) as f32,
            deviation: deviation(sum, square),
        };
        let grey = self.greys.iter().map(grey).collect();
        let levels = self.levels.iter().zip(&self.squares);
        let deviation = levels.map(|(s, q)| [0, 1, 2].map(|c| deviation(s[c], q[c]))).collect();
        drop(self.squares);
        let mean = self.levels.iter().map(|sums| sums.map(|sum| (f64::from(sum) / n) as f32)).collect();
        let (mut gradient_mean, mut gradient_deviation) = (self.first_gradient, self.gradient_squares);
        let numbers = gradient_mean.as_flattened_mut().iter_mut().zip(self.gradients.as_flattened());
        for ((mean, &sum), square) in numbers.zip(gradient_deviation.as_flattened_mut()) {
            let (sum, all) = (f64::from(sum), f64::from(*square));
            *mean = (f64::from(*mean) + sum / n) as f32;
            *square = ((all - sum * sum / n).max(0.0) / (n - 1.0)).sqrt() as f32;
        }
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let (is_plate, unknown) = (false, None);
        Ok(Background {
            width,
            height,
            mean,
            deviation,
            gradient_mean,
            gradient_deviation,
            grey,
            is_plate,
            unknown,
        })
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    #[test]
    fn frames_give_mean_and_sample_deviation() {
        let frames = [10, 20, 60].map(|level| RgbImage::from_pixel(2, 1, Rgb([level, 7, 255])));
        let background = Background::from_frames(&frames).unwrap();
        assert_eq!(background.mean(), [[30.0, 7.0, 255.0]; 2]);
        assert_eq!(background.deviation(), [[700_f32.sqrt(), 0.0, 0.0]; 2]);
    }

    #[test]
    fn a_plate_has_no_deviation() {
        let background = Background::from_plate(&RgbImage::from_pixel(2, 3, Rgb([1, 2, 3])));
        assert_eq!((background.width(), background.height()), (2, 3));
        assert_eq!(background.mean(), [[1.0, 2.0, 3.0]; 6]);
        assert_eq!(background.deviation(), [[0.0; 3]; 6]);
    }

    /// Three frames of one row whose slope is 2, 4 and 9 levels a pixel in red; green is still and steep, blue flat.
    #[test]
    fn gradients_have_their_own_mean_and_deviation() {
        let ramp = |slope: u8| RgbImage::from_fn(5, 1, |x, _| Rgb([slope * x as u8, 30 * x as u8, 77]));
        let frames = [2, 4, 9].map(ramp);
        let background = Background::from_frames(&frames).unwrap();
        // One-sided at the border, where half of the difference is left.
        assert_eq!(background.gradient_mean()[0], [2.5, 15.0, 0.0]);
        for x in 1..4 {
            assert_eq!(background.gradient_mean()[x], [5.0, 30.0, 0.0]);
            let [red, green, blue] = background.gradient_deviation()[x];
            assert!((red - 13_f32.sqrt()).abs() < 1e-6, "{red}");
            assert_eq!([green, blue], [0.0, 0.0]);
        }
        let plate = Background::from_plate(&ramp(3));
        assert_eq!((plate.gradient_mean()[2], plate.gradient_deviation()[2]), ([3.0, 30.0, 0.0], [0.0; 3]));
    }

    #[test]
    fn too_few_or_unequal_frames_are_errors() {
        let frame = RgbImage::new(2, 2);
        assert_eq!(Background::from_frames([]), Err(BackgroundError::TooFewFrames(0)));
        assert_eq!(Background::from_frames([&frame]), Err(BackgroundError::TooFewFrames(1)));
        let error = BackgroundError::SizeMismatch { index: 1, expected: (2, 2), found: (2, 3) };
        assert_eq!(Background::from_frames([&frame, &RgbImage::new(2, 3)]), Err(error));
    }
}
