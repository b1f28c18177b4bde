//! A mask: which pixels show the subject, which do not, and which cannot be told.

use std::fmt;

use image::{GrayImage, Luma};
use serde::{Deserialize, Serialize};

/// The most pixels that a mask may have (64 Mi): enough for any camera, and a guard against absurd sizes in files.
pub const MAX_PIXELS: usize = 1 << 26;

/// What a mask says about one pixel.
#[repr(u8)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Label {
    /// The pixel does not show the subject.
    #[default]
    Background = 0,
    /// The pixel shows the subject.
    Subject = 1,
    /// Nobody can tell: a shadow, dark on dark, or painted out by hand. Such a pixel weighs nothing.
    Unknown = 2,
}

/// What a pixel shows, whatever it weighs: the labels, and the subject's shadow as a class of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelClass {
    /// The scene without the subject.
    Background,
    /// The subject.
    Subject,
    /// The scene, darker or brighter than without the subject. Its label says what that counts as: background, or unknown.
    Shadow,
    /// Nobody can tell.
    Unknown,
}

/// A label, whether the pixel is marked as shadow, its character in [`Mask::from_ascii`] and its level in [`Mask::to_gray`].
const SIGNS: [(Label, bool, char, u8); 5] = [
    (Label::Background, false, '.', 0),
    (Label::Subject, false, '#', 255),
    (Label::Unknown, false, '?', 128),
    (Label::Background, true, '-', 32),
    (Label::Unknown, true, '~', 96),
];

/// Why a mask could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MaskError {
    /// The width or the height is zero.
    #[error("a mask needs at least one pixel, not {} × {}", .0[0], .0[1])]
    Empty([usize; 2]),
    /// More than [`MAX_PIXELS`] pixels, by width and height.
    #[error("a mask of {} × {} pixels is larger than the limit of {MAX_PIXELS} pixels", .0[0], .0[1])]
    TooLarge([usize; 2]),
    /// The number of labels is not width × height.
    #[error("a mask of {} × {} pixels cannot have {labels} labels", size[0], size[1])]
    WrongLength {
        /// Width and height in pixels.
        size: [usize; 2],
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
    /// A character of an ASCII mask is none of `#`, `.`, `?`, `-` and `~`.
    #[error("row {row}, column {column} of the mask is '{character}', not one of '#', '.', '?', '-', '~'")]
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
#[derive(Clone, Debug)]
pub struct Mask {
    width: usize,
    height: usize,
    labels: Vec<Label>,
    /// Which pixels are marked as shadow; empty as long as none is.
    shadows: Vec<bool>,
}

impl Mask {
    /// A mask from its labels, row by row.
    ///
    /// # Errors
    /// If the size is empty or too large, or if it does not fit the number of labels.
    pub fn new(width: usize, height: usize, labels: Vec<Label>) -> Result<Self, MaskError> {
        let pixels = checked_pixels(width, height)?;
        if labels.len() != pixels {
            return Err(MaskError::WrongLength { size: [width, height], labels: labels.len() });
        }
        Ok(Self { width, height, labels, shadows: Vec::new() })
    }

    /// A mask of one label.
    ///
    /// # Errors
    /// If the size is empty or too large.
    pub fn filled(width: usize, height: usize, label: Label) -> Result<Self, MaskError> {
        let pixels = checked_pixels(width, height)?;
        Ok(Self { width, height, labels: vec![label; pixels], shadows: Vec::new() })
    }

    /// Reads rows of `#` (subject), `.` (background), `?` (unknown), `-` (shadow that counts as background) and `~` (shadow
    /// that counts as unknown). Space around a row and empty rows are ignored.
    ///
    /// # Errors
    /// If a row has another character or another length than the first, or if there is no row at all.
    pub fn from_ascii(text: &str) -> Result<Self, MaskError> {
        let (mut labels, mut shadows) = (Vec::new(), Vec::new());
        let (mut width, mut height) = (0, 0);
        for (row, line) in text.lines().map(str::trim).filter(|line| !line.is_empty()).enumerate() {
            let start = labels.len();
            for (column, character) in line.chars().enumerate() {
                let Some((label, is_shadow, ..)) = SIGNS.into_iter().find(|sign| sign.2 == character) else {
                    return Err(MaskError::UnknownCharacter { row, column, character });
                };
                if is_shadow {
                    shadows.push(labels.len());
                }
                labels.push(label);
            }
            let found = labels.len() - start;
            if row == 0 {
                width = found;
            } else if found != width {
                return Err(MaskError::RaggedRow { row, expected: width, found });
            }
            height += 1;
        }
        let mut mask = Self::new(width, height, labels)?;
        shadows.into_iter().for_each(|index| mask.mark_shadow(index));
        Ok(mask)
    }

    /// Reads a grey image in which the subject is white: 0 to 63 is background, 64 to 191 unknown, 192 to 255 subject.
    /// Exactly 32 and 96 are marked as shadow besides.
    ///
    /// # Errors
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
        let mut mask = Self::new(image.width() as usize, image.height() as usize, labels)?;
        let is_shadow = |level: &u8| SIGNS.iter().any(|sign| sign.1 && sign.3 == *level);
        for (index, _) in image.as_raw().iter().enumerate().filter(|(_, level)| is_shadow(level)) {
            mask.mark_shadow(index);
        }
        Ok(mask)
    }

    /// A grey image in which the subject is white (255), background black (0) and unknown grey (128). Shadow is 32 where it
    /// counts as background and 96 where it counts as unknown: [`from_gray`](Self::from_gray) reads the same mask.
    pub fn to_gray(&self) -> GrayImage {
        // MAX_PIXELS keeps both sides far below the range of u32.
        GrayImage::from_fn(self.width as u32, self.height as u32, |x, y| {
            Luma([self.sign(y as usize * self.width + x as usize).1])
        })
    }

    /// The character and the grey level of a pixel.
    fn sign(&self, index: usize) -> (char, u8) {
        let (label, is_shadow) = (self.labels[index], self.is_shadow(index));
        let found = SIGNS.into_iter().find(|sign| (sign.0, sign.1) == (label, is_shadow));
        found.map_or(('?', 128), |(_, _, character, level)| (character, level))
    }

    /// Marks a pixel as shadow. Its label stays: background or unknown, which is what the shadow counts as. Subject is
    /// never shadow, so there the mark means nothing.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn mark_shadow(&mut self, index: usize) {
        if self.shadows.is_empty() {
            self.shadows = vec![false; self.labels.len()];
        }
        self.shadows[index] = true;
    }

    /// Gives a pixel another label; it is no shadow any more.
    pub(super) fn paint_pixel(&mut self, index: usize, label: Label) {
        self.labels[index] = label;
        self.shadows.get_mut(index).into_iter().for_each(|is_marked| *is_marked = false);
    }

    /// Whether a pixel is marked as shadow and is not subject; false outside the mask.
    #[inline]
    pub fn is_shadow(&self, index: usize) -> bool {
        self.shadows.get(index).is_some_and(|&is_marked| is_marked) && self.labels[index] != Label::Subject
    }

    /// Whether some pixel is shadow.
    pub fn has_shadow(&self) -> bool {
        (0..self.shadows.len()).any(|index| self.is_shadow(index))
    }

    /// What a pixel shows, or none outside the mask.
    pub fn class(&self, x: usize, y: usize) -> Option<PixelClass> {
        Some(match self.get(x, y)? {
            _ if self.is_shadow(y * self.width + x) => PixelClass::Shadow,
            Label::Background => PixelClass::Background,
            Label::Subject => PixelClass::Subject,
            Label::Unknown => PixelClass::Unknown,
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
        // Runs that a byte can count: many labels are compared at once.
        let run = |labels: &[Label]| labels.iter().map(|&other| u8::from(other == label)).sum::<u8>();
        self.labels.chunks(usize::from(u8::MAX)).map(|labels| usize::from(run(labels))).sum()
    }

    /// The smallest box that holds every subject pixel, or none if there is no such pixel.
    pub fn bounds(&self) -> Option<PixelBox> {
        self.bounds_of(Label::Subject)
    }

    /// The smallest box that holds every pixel with a label.
    pub(super) fn bounds_of(&self, label: Label) -> Option<PixelBox> {
        let any = |labels: &[Label]| {
            labels.iter().map(|&other| u8::from(other == label)).fold(0, |any, one| any | one) != 0
        };
        let mut rows = self.labels.chunks_exact(self.width);
        let y_min = rows.position(any)?;
        let y_max = rows.rposition(any).map_or(y_min, |y| y_min + 1 + y);
        // All rows on top of each other: the columns with such a pixel.
        let mut columns = vec![0_u8; self.width];
        for row in self.labels.chunks_exact(self.width).take(y_max + 1).skip(y_min) {
            for (column, &other) in columns.iter_mut().zip(row) {
                *column |= u8::from(other == label);
            }
        }
        let x_min = columns.iter().position(|&column| column != 0)?;
        let x_max = columns.iter().rposition(|&column| column != 0)?;
        Some(PixelBox { x_min, y_min, x_max, y_max })
    }
}

/// The rows as [`Mask::from_ascii`] reads them, each ended by a line break.
impl PartialEq for Mask {
    fn eq(&self, other: &Self) -> bool {
        let marks = 0..self.shadows.len().max(other.shadows.len());
        (self.width, &self.labels) == (other.width, &other.labels)
            && marks.into_iter().all(|index| self.is_shadow(index) == other.is_shadow(index))
    }
}

impl Eq for Mask {}

impl fmt::Display for Mask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for y in 0..self.height {
            let row = y * self.width..(y + 1) * self.width;
            writeln!(f, "{}", row.map(|index| self.sign(index).0).collect::<String>())?;
        }
        Ok(())
    }
}

/// The number of pixels of a size that is neither empty nor larger than [`MAX_PIXELS`].
fn checked_pixels(width: usize, height: usize) -> Result<usize, MaskError> {
    match width.checked_mul(height) {
        Some(0) => Err(MaskError::Empty([width, height])),
        Some(pixels) if pixels <= MAX_PIXELS => Ok(pixels),
        _ => Err(MaskError::TooLarge([width, height])),
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
    fn shadow_is_a_class_of_its_own_and_weighs_what_its_label_says() {
        let text = "#.-~?\n";
        let mask = Mask::from_ascii(text).unwrap();
        assert_eq!(mask.to_string(), text);
        let classes = ["Subject", "Background", "Shadow", "Shadow", "Unknown"];
        let labels = [Label::Subject, Label::Background, Label::Background, Label::Unknown, Label::Unknown];
        for x in 0..5 {
            assert_eq!(format!("{:?}", mask.class(x, 0).unwrap()), classes[x]);
            assert_eq!(mask.get(x, 0), Some(labels[x]));
        }
        assert_eq!(mask.class(5, 0), None);
        assert_eq!(mask.to_gray().into_raw(), [255, 0, 32, 96, 128]);
        assert_eq!(Mask::from_gray(&mask.to_gray()).unwrap(), mask);
        let mut other = mask.clone();
        other.labels_mut()[2] = Label::Subject;
        assert_eq!((other.class(2, 0), other.has_shadow()), (Some(PixelClass::Subject), true));
        other.labels_mut()[3] = Label::Subject;
        assert!(!other.has_shadow());
        assert_eq!(other, Mask::from_ascii("#.##?").unwrap());
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
        assert_eq!(Mask::new(0, 3, vec![]), Err(MaskError::Empty([0, 3])));
        let wrong_length = MaskError::WrongLength { size: [2, 2], labels: 3 };
        assert_eq!(Mask::new(2, 2, vec![Label::Subject; 3]), Err(wrong_length));
        let wide = usize::MAX;
        assert_eq!(Mask::filled(wide, 2, Label::Subject), Err(MaskError::TooLarge([wide, 2])));
        assert!(Mask::filled(MAX_PIXELS + 1, 1, Label::Subject).is_err());
        assert_eq!(Mask::from_ascii("\n"), Err(MaskError::Empty([0, 0])));
    }

    #[test]
    fn bad_ascii_names_the_place() {
        let unknown = MaskError::UnknownCharacter { row: 1, column: 1, character: 'x' };
        assert_eq!(Mask::from_ascii("..\n.x"), Err(unknown));
        assert_eq!(Mask::from_ascii("..\n..."), Err(MaskError::RaggedRow { row: 1, expected: 2, found: 3 }));
    }
}
