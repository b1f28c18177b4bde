//! A mask: which pixels show the subject, which do not, and which cannot be told.

use std::fmt;

use image::{GrayImage, Luma};

/// The most pixels that a mask may have (64 Mi): enough for any camera, and a guard against absurd sizes in files.
pub const MAX_PIXELS: usize = 1 << 26;

/// What a mask says about one pixel.
#[repr(u8)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Label {
    /// The pixel does not show the subject.
    #[default]
    Background = 0,
    /// The pixel shows the subject.
    Subject = 1,
    /// Nobody can tell: a shadow, dark on dark, or painted out by hand. Such a pixel weighs nothing.
    Unknown = 2,
}

impl Label {
    /// The character of this label in [`Mask::from_ascii`].
    fn to_char(self) -> char {
        match self {
            Self::Background => '.',
            Self::Subject => '#',
            Self::Unknown => '?',
        }
    }
}

/// Why a mask could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MaskError {
    /// The width or the height is zero.
    #[error("a mask needs at least one pixel, not {width} × {height}")]
    Empty {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// More than [`MAX_PIXELS`] pixels.
    #[error("a mask of {width} × {height} pixels is larger than the limit of {MAX_PIXELS} pixels")]
    TooLarge {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
    },
    /// The number of labels is not width × height.
    #[error("a mask of {width} × {height} pixels cannot have {labels} labels")]
    WrongLength {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// The number of labels given.
        labels: usize,
    },
    /// The rows of an ASCII mask differ in length.
    #[error("row {row} of the mask has {found} pixels, the first row has {expected}")]
    RaggedRow {
        /// Row, counted from 0.
        row: usize,
        /// Length of the first row.
        expected: usize,
        /// Length of this row.
        found: usize,
    },
    /// A character of an ASCII mask is none of `#`, `.` and `?`.
    #[error("row {row}, column {column} of the mask is '{character}', not one of '#', '.', '?'")]
    UnknownCharacter {
        /// Row, counted from 0.
        row: usize,
        /// Column, counted from 0.
        column: usize,
        /// The character found.
        character: char,
    },
}

/// A box of pixels, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBox {
    /// First column.
    pub x_min: usize,
    /// First row.
    pub y_min: usize,
    /// Last column.
    pub x_max: usize,
    /// Last row.
    pub y_max: usize,
}

/// A label for each pixel of one camera's frame.
///
/// Never empty and never larger than [`MAX_PIXELS`], so whoever holds one need not check again.
///
/// ```
/// use backlit_tracking::silhouette::{Label, Mask};
///
/// let mask = Mask::from_ascii("
///     ..#.
///     .##?
/// ")?;
/// assert_eq!(mask.get(1, 1), Some(Label::Subject));
/// assert_eq!(mask.count(Label::Subject), 3);
/// assert_eq!(mask.to_string(), "..#.\n.##?\n");
/// # Ok::<(), backlit_tracking::silhouette::MaskError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    width: usize,
    height: usize,
    labels: Vec<Label>,
}

impl Mask {
    /// A mask from its labels, row by row.
    ///
    /// # Errors
    ///
    /// If the size is empty or too large, or if it does not fit the number of labels.
    pub fn new(width: usize, height: usize, labels: Vec<Label>) -> Result<Self, MaskError> {
        let pixels = checked_pixels(width, height)?;
        if labels.len() != pixels {
            return Err(MaskError::WrongLength { width, height, labels: labels.len() });
        }
        Ok(Self { width, height, labels })
    }

    /// A mask of one label.
    ///
    /// # Errors
    ///
    /// If the size is empty or too large.
    pub fn filled(width: usize, height: usize, label: Label) -> Result<Self, MaskError> {
        let pixels = checked_pixels(width, height)?;
        Ok(Self { width, height, labels: vec![label; pixels] })
    }

    /// Reads rows of `#` (subject), `.` (background) and `?` (unknown). Space around a row and empty rows are ignored.
    ///
    /// # Errors
    ///
    /// If a row has another character or another length than the first, or if there is no row at all.
    pub fn from_ascii(text: &str) -> Result<Self, MaskError> {
        let mut labels = Vec::new();
        let (mut width, mut height) = (0, 0);
        for (row, line) in text.lines().map(str::trim).filter(|line| !line.is_empty()).enumerate() {
            let start = labels.len();
            for (column, character) in line.chars().enumerate() {
                labels.push(match character {
                    '.' => Label::Background,
                    '#' => Label::Subject,
                    '?' => Label::Unknown,
                    _ => return Err(MaskError::UnknownCharacter { row, column, character }),
                });
            }
            let found = labels.len() - start;
            if row == 0 {
                width = found;
            } else if found != width {
                return Err(MaskError::RaggedRow { row, expected: width, found });
            }
            height += 1;
        }
        Self::new(width, height, labels)
    }

    /// Reads a grey image in which the subject is white: 0 to 63 is background, 64 to 191 unknown, 192 to 255 subject.
    ///
    /// # Errors
    ///
    /// If the image is empty or too large.
    pub fn from_gray(image: &GrayImage) -> Result<Self, MaskError> {
        let labels = image
            .as_raw()
            .iter()
            .map(|&level| match level {
                0..=63 => Label::Background,
                64..=191 => Label::Unknown,
                192..=255 => Label::Subject,
            })
            .collect();
        Self::new(image.width() as usize, image.height() as usize, labels)
    }

    /// A grey image in which the subject is white (255), background black (0) and unknown grey (128).
    pub fn to_gray(&self) -> GrayImage {
        // MAX_PIXELS keeps both sides far below the range of u32.
        GrayImage::from_fn(self.width as u32, self.height as u32, |x, y| {
            Luma([match self.labels[y as usize * self.width + x as usize] {
                Label::Background => 0,
                Label::Subject => 255,
                Label::Unknown => 128,
            }])
        })
    }

    /// Width in pixels, at least 1.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels, at least 1.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All labels, row by row.
    pub fn labels(&self) -> &[Label] {
        &self.labels
    }

    /// All labels, row by row, to paint in.
    pub fn labels_mut(&mut self) -> &mut [Label] {
        &mut self.labels
    }

    /// The labels of row `y`, or none below the image.
    pub fn row(&self, y: usize) -> Option<&[Label]> {
        self.labels.chunks_exact(self.width).nth(y)
    }

    /// The label of a pixel, or none outside the image.
    pub fn get(&self, x: usize, y: usize) -> Option<Label> {
        self.row(y)?.get(x).copied()
    }

    /// How many pixels have this label.
    pub fn count(&self, label: Label) -> usize {
        self.labels.iter().filter(|&&other| other == label).count()
    }

    /// The smallest box that holds every subject pixel, or none if there is no such pixel.
    pub fn bounds(&self) -> Option<PixelBox> {
        let any = |labels: &[Label]| {
            labels.iter().map(|&label| u8::from(label == Label::Subject)).fold(0, |any, one| any | one) != 0
        };
        let mut rows = self.labels.chunks_exact(self.width);
        let y_min = rows.position(any)?;
        let y_max = rows.rposition(any).map_or(y_min, |y| y_min + 1 + y);
        // All rows on top of each other: the columns with a subject.
        let mut columns = vec![0_u8; self.width];
        for row in self.labels.chunks_exact(self.width).take(y_max + 1).skip(y_min) {
            for (column, &label) in columns.iter_mut().zip(row) {
                *column |= u8::from(label == Label::Subject);
            }
        }
        let x_min = columns.iter().position(|&column| column != 0)?;
        let x_max = columns.iter().rposition(|&column| column != 0)?;
        Some(PixelBox { x_min, y_min, x_max, y_max })
    }
}

/// The rows as [`Mask::from_ascii`] reads them, each ended by a line break.
impl fmt::Display for Mask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in self.labels.chunks_exact(self.width) {
            writeln!(f, "{}", row.iter().map(|label| label.to_char()).collect::<String>())?;
        }
        Ok(())
    }
}

/// The number of pixels of a size that is neither empty nor larger than [`MAX_PIXELS`].
fn checked_pixels(width: usize, height: usize) -> Result<usize, MaskError> {
    match width.checked_mul(height) {
        Some(0) => Err(MaskError::Empty { width, height }),
        Some(pixels) if pixels <= MAX_PIXELS => Ok(pixels),
        _ => Err(MaskError::TooLarge { width, height }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ascii_survives_a_round_trip() {
        let text = "..#?\n.##.\n";
        let mask = Mask::from_ascii(text).unwrap();
        assert_eq!((mask.width(), mask.height()), (4, 2));
        assert_eq!(mask.to_string(), text);
        assert_eq!(mask.get(3, 0), Some(Label::Unknown));
        assert_eq!(mask.get(4, 0), None);
        assert_eq!(mask.get(0, 2), None);
        assert_eq!(mask.row(2), None);
    }

    #[test]
    fn gray_levels_fall_into_three_classes() {
        let image = GrayImage::from_raw(6, 1, vec![0, 63, 64, 191, 192, 255]).unwrap();
        let mask = Mask::from_gray(&image).unwrap();
        assert_eq!(mask.to_string(), "..??##\n");
        assert_eq!(Mask::from_gray(&mask.to_gray()).unwrap(), mask);
    }

    #[test]
    fn bounds_hold_every_subject_pixel_and_nothing_else() {
        let mask = Mask::from_ascii(
            "
            ......
            ..?#..
            .#..?.
            ...#..
            ......
        ",
        )
        .unwrap();
        assert_eq!(mask.bounds(), Some(PixelBox { x_min: 1, y_min: 1, x_max: 3, y_max: 3 }));
        assert_eq!(Mask::filled(3, 2, Label::Unknown).unwrap().bounds(), None);
    }

    #[test]
    fn impossible_sizes_are_errors() {
        assert_eq!(Mask::new(0, 3, vec![]), Err(MaskError::Empty { width: 0, height: 3 }));
        assert_eq!(
            Mask::new(2, 2, vec![Label::Subject; 3]),
            Err(MaskError::WrongLength { width: 2, height: 2, labels: 3 })
        );
        let wide = usize::MAX;
        assert_eq!(
            Mask::filled(wide, 2, Label::Subject),
            Err(MaskError::TooLarge { width: wide, height: 2 })
        );
        assert!(Mask::filled(MAX_PIXELS + 1, 1, Label::Subject).is_err());
        assert_eq!(Mask::from_ascii("\n"), Err(MaskError::Empty { width: 0, height: 0 }));
    }

    #[test]
    fn bad_ascii_names_the_place() {
        assert_eq!(
            Mask::from_ascii("..\n.x"),
            Err(MaskError::UnknownCharacter { row: 1, column: 1, character: 'x' })
        );
        assert_eq!(Mask::from_ascii("..\n..."), Err(MaskError::RaggedRow { row: 1, expected: 2, found: 3 }));
    }
}
