//! Numbered PNGs, an animated PNG or a GIF from one picture after another. Files are written whole or not at all; of
//! a folder of PNGs, those stay that were written before something went wrong.

use std::io::Write;
use std::path::{Path, PathBuf};

use backlit_formats::{FileError, atomic, images, reason};
use backlit_tracking::cancel::CancelToken;
use image::{DynamicImage, RgbImage};
use thiserror::Error;

use super::SeriesFormat;

/// How carefully colours are chosen for a GIF: 1 is best and slow, 30 is fast.
const GIF_SPEED: i32 = 10;
/// Shorter delays are slowed down by everything that shows a GIF, in hundredths of a second.
const GIF_LEAST_DELAY: u16 = 2;

/// How a series is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SeriesOptions {
    /// What it becomes.
    pub format: SeriesFormat,
    /// Time that a picture stays, in milliseconds.
    pub delay_ms: u32,
    /// Whether it begins again at the end.
    pub repeats: bool,
}

/// Why a series was not written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ExportError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: the folder cannot be made: {}", path.display(), reason(.source))]
    Folder { path: PathBuf, source: std::io::Error },
    #[error("{}: picture {number} is {found:?} pixels; the first one is {expected:?}", path.display())]
    Size { path: PathBuf, number: usize, found: (u32, u32), expected: (u32, u32) },
    #[error("{}: a GIF has at most 65535 pixels a side; this is {size:?}", path.display())]
    TooLarge { path: PathBuf, size: (u32, u32) },
    #[error("nothing is there to be exported")]
    Empty,
    #[error("stopped")]
    Stopped,
}

/// Writes the pictures that `paint` gives, one for each of `numbers`, to a file or to a folder of files
/// `NAME_0007.png`. `done` hears how many are written.
///
/// # Errors
/// The file system says no, or it was stopped; the error names the file.
pub fn write_series(
    path: &Path,
    name: &str,
    options: SeriesOptions,
    numbers: &[usize],
    cancel: &CancelToken,
    paint: &mut dyn FnMut(usize) -> RgbImage,
    done: &dyn Fn(usize),
) -> Result<(), ExportError> {
    let mut next = |index: usize| {
        if cancel.is_cancelled() {
            return Err(ExportError::Stopped);
        }
        let picture = paint(index);
        if cancel.is_cancelled() { Err(ExportError::Stopped) } else { Ok(picture) }
    };
    if numbers.is_empty() {
        return Err(ExportError::Empty);
    }
    if options.format == SeriesFormat::Pngs {
        std::fs::create_dir_all(path)
            .map_err(|source| ExportError::Folder { path: path.to_owned(), source })?;
        for (index, number) in numbers.iter().enumerate() {
            let picture = DynamicImage::ImageRgb8(next(index)?);
            images::write_png(&path.join(numbered(name, *number)), &picture)?;
            done(index + 1);
        }
        return Ok(());
    }
    // The encoder is asked by the writer of whole files, whose errors are those of the file system.
    let mut problem = None;
    let result = atomic::write_with(path, |out| {
        let first = next(0).map_err(|error| set_aside(&mut problem, error))?;
        let size = first.dimensions();
        let mut checked = |index: usize| {
            let picture = next(index)?;
            let found = picture.dimensions();
            if found == size {
                Ok(picture)
            } else {
                let path = path.to_owned();
                Err(ExportError::Size { path, number: index, found, expected: size })
            }
        };
        let pictures = Pictures { first, count: numbers.len(), next: &mut checked, done };
        let written = if options.format == SeriesFormat::Gif {
            write_gif(out, path, options, pictures)
        } else {
            write_animated_png(out, options, pictures)
        };
        written.map_err(|failure| match failure {
            Failure::Export(error) => set_aside(&mut problem, error),
            Failure::Io(error) => error,
        })
    });
    match problem {
        Some(problem) => Err(problem),
        None => Ok(result?),
    }
}

/// The name of a picture in a folder.
fn numbered(name: &str, number: usize) -> String {
    format!("{name}_{number:04}.png")
}

fn set_aside(problem: &mut Option<ExportError>, error: ExportError) -> std::io::Error {
    *problem = Some(error);
    std::io::Error::other("not written")
}

/// The pictures of a file that moves.
struct Pictures<'a> {
    first: RgbImage,
    count: usize,
    next: &'a mut dyn FnMut(usize) -> Result<RgbImage, ExportError>,
    done: &'a dyn Fn(usize),
}

impl Pictures<'_> {
    fn each(self, mut write: impl FnMut(RgbImage) -> std::io::Result<()>) -> Result<(), Failure> {
        write(self.first).map_err(Failure::Io)?;
        (self.done)(1);
        for index in 1..self.count {
            write((self.next)(index).map_err(Failure::Export)?).map_err(Failure::Io)?;
            (self.done)(index + 1);
        }
        Ok(())
    }
}

enum Failure {
    Export(ExportError),
    Io(std::io::Error),
}

fn write_animated_png(
    out: &mut dyn Write,
    options: SeriesOptions,
    pictures: Pictures<'_>,
) -> Result<(), Failure> {
    let (width, height) = pictures.first.dimensions();
    let count = u32::try_from(pictures.count).unwrap_or(u32::MAX);
    let delay_ms = u16::try_from(options.delay_ms).unwrap_or(u16::MAX);
    let io = |error: png::EncodingError| Failure::Io(error.into());
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(count, u32::from(!options.repeats)).map_err(io)?;
    encoder.set_frame_delay(delay_ms, 1000).map_err(io)?;
    let mut writer = encoder.write_header().map_err(io)?;
    pictures.each(|picture| Ok(writer.write_image_data(picture.as_raw())?))?;
    writer.finish().map_err(io)
}

fn write_gif(
    out: &mut dyn Write,
    path: &Path,
    options: SeriesOptions,
    pictures: Pictures<'_>,
) -> Result<(), Failure> {
    let size = pictures.first.dimensions();
    let (Ok(width), Ok(height)) = (u16::try_from(size.0), u16::try_from(size.1)) else {
        return Err(Failure::Export(ExportError::TooLarge { path: path.to_owned(), size }));
    };
    let io = |error: gif::EncodingError| match error {
        gif::EncodingError::Io(error) => error,
        other => std::io::Error::other(other),
    };
    let mut encoder = gif::Encoder::new(out, width, height, &[]).map_err(|error| Failure::Io(io(error)))?;
    let repeat = if options.repeats { gif::Repeat::Infinite } else { gif::Repeat::Finite(0) };
    encoder.set_repeat(repeat).map_err(|error| Failure::Io(io(error)))?;
    let delay = u16::try_from(options.delay_ms.div_ceil(10)).unwrap_or(u16::MAX).max(GIF_LEAST_DELAY);
    pictures.each(|picture| {
        let frame = match exact_palette(&picture) {
            Some((palette, indices)) => {
                gif::Frame::from_palette_pixels(width, height, indices, palette, None)
            }
            None => gif::Frame::from_rgb_speed(width, height, picture.as_raw(), GIF_SPEED),
        };
        encoder.write_frame(&gif::Frame { delay, ..frame }).map_err(io)
    })
}

/// The colours of a picture that has no more than a GIF can hold, and the index of each pixel's.
fn exact_palette(picture: &RgbImage) -> Option<(Vec<u8>, Vec<u8>)> {
    let mut indices = std::collections::BTreeMap::new();
    let mut pixels = Vec::with_capacity(picture.len() / 3);
    let mut palette = Vec::new();
    for pixel in picture.pixels() {
        let next = u8::try_from(indices.len()).ok();
        let index = match indices.get(&pixel.0) {
            Some(index) => *index,
            None => {
                let index = next?;
                indices.insert(pixel.0, index);
                palette.extend(pixel.0);
                index
            }
        };
        pixels.push(index);
    }
    Some((palette, pixels))
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::fs::File;
    use std::io::BufReader;

    use image::Rgb;

    use super::*;

    const NUMBERS: [usize; 3] = [0, 5, 17];

    fn picture(index: usize) -> RgbImage {
        RgbImage::from_fn(9, 6, |x, y| Rgb([(x * 20) as u8, (y * 30) as u8, index as u8 * 100]))
    }

    fn write(path: &Path, format: SeriesFormat, cancel: &CancelToken) -> (Result<(), ExportError>, usize) {
        let options = SeriesOptions { format, delay_ms: 80, repeats: true };
        let done = Cell::new(0);
        let hear = |count| done.set(count);
        let result = write_series(path, "step", options, &NUMBERS, cancel, &mut picture, &hear);
        (result, done.get())
    }

    #[test]
    fn numbered_pictures_have_their_own_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/steps");
        let (result, done) = write(&path, SeriesFormat::Pngs, &CancelToken::default());
        result.unwrap();
        assert_eq!(done, 3);
        let mut names: Vec<_> = std::fs::read_dir(&path).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["step_0000.png", "step_0005.png", "step_0017.png"]);
        assert_eq!(images::read(&path.join("step_0005.png")).unwrap(), picture(1));
    }

    #[test]
    fn an_animated_png_has_all_pictures_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write(&path, SeriesFormat::AnimatedPng, &CancelToken::default()).0.unwrap();
        let decoder = png::Decoder::new(BufReader::new(File::open(&path).unwrap()));
        let mut reader = decoder.read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        for index in 0..3 {
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut bytes).unwrap();
            assert_eq!(bytes, picture(index).into_raw());
            let delay = reader.info().frame_control().unwrap();
            assert_eq!((delay.delay_num, delay.delay_den), (80, 1000));
        }
        // Readers that know nothing of animation see the first.
        assert_eq!(images::read(&path).unwrap(), picture(0));
    }

    #[test]
    fn a_gif_of_few_colours_keeps_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gif");
        write(&path, SeriesFormat::Gif, &CancelToken::default()).0.unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(File::open(&path).unwrap()).unwrap();
        assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
        for index in 0..3 {
            let frame = decoder.read_next_frame().unwrap().unwrap();
            assert_eq!(frame.delay, 8);
            let rgb: Vec<u8> = frame.buffer.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
            assert_eq!(rgb, picture(index).into_raw());
        }
        assert!(decoder.read_next_frame().unwrap().is_none());
    }

    #[test]
    fn what_is_stopped_leaves_no_half_file() {
        let folder = tempfile::tempdir().unwrap();
        for (name, format) in [("a.png", SeriesFormat::AnimatedPng), ("a.gif", SeriesFormat::Gif)] {
            let cancel = CancelToken::default();
            let options = SeriesOptions { format, delay_ms: 80, repeats: true };
            let mut paint = |index| {
                if index == 1 {
                    cancel.cancel();
                }
                picture(index)
            };
            let path = folder.path().join(name);
            let result = write_series(&path, "a", options, &NUMBERS, &cancel, &mut paint, &|_| {});
            assert!(matches!(result, Err(ExportError::Stopped)), "{result:?}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let message = write(&folder.path().join("no/a.gif"), SeriesFormat::Gif, &CancelToken::default());
        let message = message.0.unwrap_err().to_string();
        assert!(message.contains("no/a.gif"), "{message}");
    }
}
