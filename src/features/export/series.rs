//! Numbered PNGs, an animated PNG or a GIF from one picture after another. Files are written whole or not at all; of
//! a folder of PNGs, those stay that were written before something went wrong.

use std::error::Error;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::atomic::NewFile;
use backlit_formats::{FileError, images, reason};
use image::{DynamicImage, RgbImage};
use thiserror::Error;

use super::{ExportChoices, SeriesFormat};

/// How carefully colours are chosen for a GIF: 1 is best and slow, 30 is fast.
const GIF_SPEED: i32 = 10;
/// Shorter delays are slowed down by everything that shows a GIF, in hundredths of a second.
const GIF_LEAST_DELAY: u16 = 2;

#[derive(Debug, Error)]
pub(crate) enum ExportError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: the folder cannot be made: {}", path.display(), reason(.source))]
    Folder { path: PathBuf, source: io::Error },
    #[error("{}: picture {number} is {found:?} pixels; the first one is {expected:?}", path.display())]
    Size { path: PathBuf, number: usize, found: (u32, u32), expected: (u32, u32) },
    #[error("{}: a GIF has at most 65535 pixels a side; this is {size:?}", path.display())]
    TooLarge { path: PathBuf, size: (u32, u32) },
    #[error("nothing is there to be exported")]
    Empty,
    #[error("stopped")]
    Stopped,
}

impl ExportError {
    /// What lies behind it: where a file cannot be written, what the disk said.
    pub(crate) fn cause(&self) -> &(dyn Error + 'static) {
        match self {
            Self::File(error) => error,
            Self::Folder { source, .. } => source,
            other => other,
        }
    }
}

/// Writes one picture after another to a file or to a folder of files `NAME_0007.png`.
#[derive(Debug)]
pub(crate) struct SeriesWriter {
    path: PathBuf,
    name: &'static str,
    choices: ExportChoices,
    count: usize,
    written: usize,
    animation: Option<Animation>,
}

/// A file that moves.
#[derive(Debug)]
struct Animation {
    /// Known from the first picture on, with its size.
    encoder: Option<((u32, u32), Encoder)>,
    file: NewFile,
}

type Out = BufWriter<Arc<File>>;

enum Encoder {
    Png(png::Writer<Out>),
    Gif(Box<gif::Encoder<Out>>),
}

impl SeriesWriter {
    /// Begins a series of `count` pictures. Errors: the file or the folder cannot be made, or there are no pictures.
    pub(crate) fn new(
        path: &Path,
        name: &'static str,
        choices: &ExportChoices,
        count: usize,
    ) -> Result<Self, ExportError> {
        if count == 0 {
            return Err(ExportError::Empty);
        }
        let animation = if choices.format == SeriesFormat::Pngs {
            std::fs::create_dir_all(path)
                .map_err(|source| ExportError::Folder { path: path.to_owned(), source })?;
            None
        } else {
            Some(Animation { encoder: None, file: NewFile::create(path)? })
        };
        Ok(Self { path: path.to_owned(), name, choices: choices.clone(), count, written: 0, animation })
    }

    /// Writes the next picture; the number is for its name. Errors: the file system says no, or the picture does not
    /// go with the first.
    pub(crate) fn add(&mut self, number: usize, picture: RgbImage) -> Result<(), ExportError> {
        if let Some(animation) = &mut self.animation {
            let size = picture.dimensions();
            let (expected, mut encoder) = match animation.encoder.take() {
                Some(begun) => begun,
                None => (size, Encoder::begin(&self.path, &animation.file, size, &self.choices, self.count)?),
            };
            if size != expected {
                let (path, number) = (self.path.clone(), self.written);
                return Err(ExportError::Size { path, number, found: size, expected });
            }
            encoder.add(&picture, &self.choices).map_err(|error| animation.file.error(error))?;
            animation.encoder = Some((expected, encoder));
        } else {
            let path = self.path.join(numbered(self.name, number));
            images::write_png(&path, &DynamicImage::ImageRgb8(picture))?;
        }
        self.written += 1;
        Ok(())
    }

    /// All pictures are written: a file takes its place. Errors: the file system says no.
    pub(crate) fn finish(self) -> Result<(), ExportError> {
        let Some(Animation { encoder, file }) = self.animation else { return Ok(()) };
        if let Some((_, encoder)) = encoder {
            encoder.finish().map_err(|error| file.error(error))?;
        }
        Ok(file.finish()?)
    }
}

fn numbered(name: &str, number: usize) -> String {
    format!("{name}_{number:04}.png")
}

impl Encoder {
    fn begin(
        path: &Path,
        file: &NewFile,
        size: (u32, u32),
        choices: &ExportChoices,
        count: usize,
    ) -> Result<Self, ExportError> {
        let out = BufWriter::new(file.writer());
        if choices.format == SeriesFormat::AnimatedPng {
            let begun = begin_animated_png(out, size, choices, count);
            return begun.map(Self::Png).map_err(|error| file.error(error.into()).into());
        }
        let (Ok(width), Ok(height)) = (u16::try_from(size.0), u16::try_from(size.1)) else {
            return Err(ExportError::TooLarge { path: path.to_owned(), size });
        };
        let begun = begin_gif(out, width, height, choices.repeats);
        begun.map(|encoder| Self::Gif(Box::new(encoder))).map_err(|error| file.error(of_gif(error)).into())
    }

    fn add(&mut self, picture: &RgbImage, choices: &ExportChoices) -> io::Result<()> {
        match self {
            Self::Png(writer) => Ok(writer.write_image_data(picture.as_raw())?),
            Self::Gif(encoder) => encoder.write_frame(&gif_frame(picture, choices)).map_err(of_gif),
        }
    }

    fn finish(self) -> io::Result<()> {
        match self {
            Self::Png(writer) => Ok(writer.finish()?),
            Self::Gif(encoder) => encoder.into_inner().map_err(of_gif)?.flush(),
        }
    }
}

impl std::fmt::Debug for Encoder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Encoder").finish_non_exhaustive()
    }
}

fn begin_animated_png(
    out: Out,
    (width, height): (u32, u32),
    choices: &ExportChoices,
    count: usize,
) -> Result<png::Writer<Out>, png::EncodingError> {
    let delay_ms = u16::try_from(choices.delay_ms).unwrap_or(u16::MAX);
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(u32::try_from(count).unwrap_or(u32::MAX), u32::from(!choices.repeats))?;
    encoder.set_frame_delay(delay_ms, 1000)?;
    encoder.write_header()
}

fn begin_gif(
    out: Out,
    width: u16,
    height: u16,
    repeats: bool,
) -> Result<gif::Encoder<Out>, gif::EncodingError> {
    let mut encoder = gif::Encoder::new(out, width, height, &[])?;
    encoder.set_repeat(if repeats { gif::Repeat::Infinite } else { gif::Repeat::Finite(0) })?;
    Ok(encoder)
}

fn of_gif(error: gif::EncodingError) -> io::Error {
    match error {
        gif::EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}

fn gif_frame(picture: &RgbImage, choices: &ExportChoices) -> gif::Frame<'static> {
    let (width, height) = (picture.width() as u16, picture.height() as u16);
    let delay = u16::try_from(choices.delay_ms.div_ceil(10)).unwrap_or(u16::MAX).max(GIF_LEAST_DELAY);
    let frame = match exact_palette(picture) {
        Some((palette, indices)) => gif::Frame::from_palette_pixels(width, height, indices, palette, None),
        None => gif::Frame::from_rgb_speed(width, height, picture.as_raw(), GIF_SPEED),
    };
    gif::Frame { delay, ..frame }
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
    use std::io::BufReader;

    use backlit_formats::FileProblem;
    use image::Rgb;

    use super::*;
    use crate::context::write_advice::write_advice;

    const NUMBERS: [usize; 3] = [0, 5, 17];

    fn picture(index: usize) -> RgbImage {
        RgbImage::from_fn(9, 6, |x, y| Rgb([(x * 20) as u8, (y * 30) as u8, index as u8 * 100]))
    }

    fn begin(path: &Path, format: SeriesFormat, count: usize) -> Result<SeriesWriter, ExportError> {
        let choices = ExportChoices { format, delay_ms: 80, ..ExportChoices::default() };
        SeriesWriter::new(path, "step", &choices, count)
    }

    fn write(path: &Path, format: SeriesFormat) -> Result<(), ExportError> {
        let mut writer = begin(path, format, NUMBERS.len())?;
        for (index, number) in NUMBERS.into_iter().enumerate() {
            writer.add(number, picture(index))?;
        }
        writer.finish()
    }

    #[test]
    fn numbered_pictures_have_their_own_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/steps");
        write(&path, SeriesFormat::Pngs).unwrap();
        let mut names: Vec<_> = std::fs::read_dir(&path).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["step_0000.png", "step_0005.png", "step_0017.png"]);
        assert_eq!(images::read(&path.join("step_0005.png")).unwrap(), picture(1));
    }

    #[test]
    fn an_animated_png_has_all_pictures_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write(&path, SeriesFormat::AnimatedPng).unwrap();
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
        write(&path, SeriesFormat::Gif).unwrap();
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
    fn what_is_dropped_or_does_not_go_together_leaves_no_half_file() {
        let folder = tempfile::tempdir().unwrap();
        for (name, format) in [("a.png", SeriesFormat::AnimatedPng), ("a.gif", SeriesFormat::Gif)] {
            let mut writer = begin(&folder.path().join(name), format, 2).unwrap();
            writer.add(0, picture(0)).unwrap();
            let other = writer.add(1, RgbImage::new(9, 7));
            assert!(matches!(other, Err(ExportError::Size { number: 1, .. })), "{other:?}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        let message = write(&folder.path().join("no/a.gif"), SeriesFormat::Gif).unwrap_err().to_string();
        assert!(message.contains("no/a.gif"), "{message}");
        let none = begin(&folder.path().join("a.gif"), SeriesFormat::Gif, 0);
        assert!(matches!(none, Err(ExportError::Empty)));
    }

    #[test]
    fn what_the_disk_says_of_an_export_has_a_remedy() {
        let full = || io::Error::from(io::ErrorKind::StorageFull);
        let file = FileError::new(Path::new("a.png"), FileProblem::Write { error: full() });
        for error in [file.into(), ExportError::Folder { path: "a".into(), source: full() }] {
            assert!(write_advice(error.cause()).starts_with("Free some space"), "{error}");
        }
        assert!(write_advice(ExportError::Empty.cause()).contains("another place"));
    }
}
