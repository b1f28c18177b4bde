//! Pictures: PNG, JPEG, TIFF, WebP and BMP, told apart by their content, within limits, and only whole ones.

use std::io::Cursor;
use std::path::Path;

use backlit_tracking::camera::{MAX_PIXELS, MAX_SIDE};
use image::{DynamicImage, GrayImage, ImageDecoder, ImageFormat, ImageReader, Limits, RgbImage};

use super::{DiskFiles, FileError, FileProblem, Result, TakeFiles, atomic};

/// Largest picture file that is read, bytes.
pub const MAX_PICTURE_BYTES: u64 = 256 << 20;
/// Most memory that decoding one picture may take, bytes, with what it is turned into.
const MAX_DECODED_BYTES: u64 = 480 << 20;
/// Bytes of a pixel that pictures are turned into at most: four of 8 bits.
const TURNED_BYTES: u64 = 4;

/// Decodes a picture as colour; an alpha channel is dropped, 16-bit levels are rounded to 8.
pub fn decode(path: &Path, bytes: &[u8]) -> Result<RgbImage> {
    decode_any(path, bytes).map(DynamicImage::into_rgb8)
}

/// The alpha channel, row by row: 0 is transparent, 255 opaque. `None` for a picture without one.
pub fn alpha(path: &Path, bytes: &[u8]) -> Result<Option<Vec<u8>>> {
    let picture = decode_any(path, bytes)?;
    let has_alpha = picture.color().has_alpha();
    Ok(has_alpha.then(|| picture.into_rgba8().pixels().map(|pixel| pixel[3]).collect()))
}

/// Decodes a picture as grey levels.
pub fn decode_grey(path: &Path, bytes: &[u8]) -> Result<GrayImage> {
    decode_any(path, bytes).map(DynamicImage::into_luma8)
}

/// Width and height in pixels, from the head of the file alone.
pub fn size(path: &Path, bytes: &[u8]) -> Result<[usize; 2]> {
    let (width, height) =
        reader(path, bytes)?.into_dimensions().map_err(|error| broken(path, &error.to_string()))?;
    Ok([width as usize, height as usize])
}

/// [`size`], if the file reaches its end.
pub(crate) fn whole_size(path: &Path, bytes: &[u8]) -> Result<[usize; 2]> {
    check_whole(path, bytes, reader(path, bytes)?.format())?;
    size(path, bytes)
}

/// Reads a picture of the disk as colour.
pub fn read(path: &Path) -> Result<RgbImage> {
    decode(path, &DiskFiles.read(path, MAX_PICTURE_BYTES)?)
}

/// Reads a picture of the disk as grey levels.
pub fn read_grey(path: &Path) -> Result<GrayImage> {
    decode_grey(path, &DiskFiles.read(path, MAX_PICTURE_BYTES)?)
}

/// Writes a PNG; see [`atomic`].
pub fn write_png(path: &Path, picture: &DynamicImage) -> Result<()> {
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| FileError::new(path, FileProblem::Write { error: std::io::Error::other(error) }))?;
    atomic::write(path, bytes.get_ref())
}

fn reader<'a>(path: &Path, bytes: &'a [u8]) -> Result<ImageReader<Cursor<&'a [u8]>>> {
    let format = match image::guess_format(bytes) {
        Ok(
            format @ (ImageFormat::Png
            | ImageFormat::Jpeg
            | ImageFormat::Tiff
            | ImageFormat::WebP
            | ImageFormat::Bmp),
        ) => format,
        _ => return Err(broken(path, "expected PNG, JPEG, TIFF, WebP or BMP")),
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    Ok(reader)
}

pub(crate) fn decode_any(path: &Path, bytes: &[u8]) -> Result<DynamicImage> {
    let reader = reader(path, bytes)?;
    check_whole(path, bytes, reader.format())?;
    let decoder = reader.into_decoder().map_err(|error| broken(path, &error.to_string()))?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    let bytes = decoder.total_bytes().saturating_add(TURNED_BYTES * pixels);
    if pixels > MAX_PIXELS || bytes > MAX_DECODED_BYTES {
        let found = [width as usize, height as usize];
        return Err(FileError::new(path, FileProblem::PictureTooLarge { found }));
    }
    DynamicImage::from_decoder(decoder).map_err(|error| broken(path, &error.to_string()))
}

/// The decoders fill what is missing at a file's end with grey, silently.
fn check_whole(path: &Path, bytes: &[u8], format: Option<ImageFormat>) -> Result<()> {
    let whole = match format {
        Some(ImageFormat::Jpeg) => jpeg_is_whole(bytes),
        Some(ImageFormat::Png) => png_is_whole(bytes),
        Some(ImageFormat::WebP) => says_its_length(bytes, 4, 8),
        Some(ImageFormat::Bmp) => says_its_length(bytes, 2, 0),
        // Strips and tiles have places and lengths, and the decoder reads them whole.
        _ => true,
    };
    if whole { Ok(()) } else { Err(broken(path, "the file ends too early")) }
}

/// The decoder's message, without its own words for what it was reading.
pub(crate) fn broken(path: &Path, message: &str) -> FileError {
    let told = message.split_once(" decoding ").and_then(|(_, rest)| rest.split_once(": "));
    let mut told = told.map_or(message, |(_, rest)| rest).to_owned();
    // A chunk of a PNG is told by its name.
    while let Some((before, (name, rest))) = told
        .split_once("ChunkType { type: ")
        .and_then(|(before, rest)| Some((before, rest.split_once(", critical: ")?)))
    {
        let after = rest.split_once(" }").map_or("", |(_, after)| after);
        told = format!("{before}{name}{after}");
    }
    FileError::new(path, FileProblem::Picture { message: told.trim().to_owned() })
}

/// Whether a file has the length, with `more`, that it says itself at a place. 0 is said by some writers of BMP.
fn says_its_length(bytes: &[u8], at: usize, more: usize) -> bool {
    let length =
        bytes.get(at..).and_then(<[u8]>::first_chunk).map(|bytes| u32::from_le_bytes(*bytes) as usize);
    length.is_some_and(|length| bytes.len() >= length.saturating_add(more))
}

/// Whether the chunks of a PNG reach its IEND.
fn png_is_whole(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(8..).unwrap_or_default();
    loop {
        let (Some(length), Some(kind)) = (rest.first_chunk::<4>(), rest.get(4..8)) else { return false };
        let length = u32::from_be_bytes(*length) as usize;
        let Some(next) = length.checked_add(12).and_then(|length| rest.get(length..)) else { return false };
        if kind == b"IEND" {
            return true;
        }
        rest = next;
    }
}

/// Whether the segments of a JPEG reach its end-of-image marker.
fn jpeg_is_whole(bytes: &[u8]) -> bool {
    const END_OF_IMAGE: u8 = 0xD9;
    const START_OF_SCAN: u8 = 0xDA;
    let mut at = 2;
    loop {
        // To the next marker: stuffed zeros and restarts belong to a scan's data.
        while !matches!((bytes.get(at), bytes.get(at + 1)), (Some(0xFF), Some(0x01..=0xCF | 0xD8..=0xFE)) | (_, None))
        {
            at += 1;
        }
        match (bytes.get(at + 1), bytes.get(at + 2), bytes.get(at + 3)) {
            (Some(&END_OF_IMAGE), _, _) => return true,
            (Some(&marker), Some(&high), Some(&low)) => {
                let length = usize::from(u16::from_be_bytes([high, low]));
                // A scan's data may look like anything, so only its head is skipped, as any segment is.
                at += 2 + if marker == START_OF_SCAN { length.max(2) } else { length };
            }
            _ => return false,
        }
    }
}

/// A picture with each square of `divisor`² pixels averaged to one. Columns at the right and rows at the bottom that fill
/// no square are left out; a divisor larger than a side counts as that side.
#[must_use]
pub fn reduced(picture: RgbImage, divisor: usize) -> RgbImage {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let divisor = divisor.min(width).min(height);
    if divisor <= 1 {
        return picture;
    }
    let size = [width / divisor, height / divisor];
    let out = averaged::<3>(picture.as_raw(), width, size, [divisor; 2]);
    RgbImage::from_raw(size[0] as u32, size[1] as u32, out).unwrap_or_default()
}

/// Averages of blocks of pixels of `N` interleaved bytes; rows of the plane are `width` pixels long.
pub(crate) fn averaged<const N: usize>(
    plane: &[u8],
    width: usize,
    size: [usize; 2],
    block: [usize; 2],
) -> Vec<u8> {
    if block == [1, 1] && width == size[0] {
        return plane[..width * size[1] * N].to_vec();
    }
    let count = (block[0] * block[1]) as u32;
    let used = size[0] * block[0] * N;
    let mut sums = vec![0_u32; used];
    let mut out = Vec::with_capacity(size[0] * size[1] * N);
    for rows in plane.chunks_exact(width * N * block[1]).take(size[1]) {
        sums.fill(0);
        for row in rows.chunks_exact(width * N) {
            for (sum, &value) in sums.iter_mut().zip(row) {
                *sum += u32::from(value);
            }
        }
        for block in sums.chunks_exact(block[0] * N) {
            let mut sum = [count / 2; N];
            for pixel in block.as_chunks::<N>().0 {
                for (sum, value) in sum.iter_mut().zip(pixel) {
                    *sum += value;
                }
            }
            out.extend(sum.map(|sum| (sum / count) as u8));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    const FORMATS: [ImageFormat; 5] =
        [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::Tiff, ImageFormat::WebP, ImageFormat::Bmp];

    fn picture() -> DynamicImage {
        RgbImage::from_fn(24, 17, |x, y| Rgb([(x * 9) as u8, (y * 13) as u8, (x * y) as u8])).into()
    }

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture().write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn pictures_are_recognised_by_content() {
        let path = Path::new("a.jpg");
        assert_eq!(decode(path, &encoded(ImageFormat::Png)).unwrap(), picture().into_rgb8());
        assert_eq!(decode(path, &encoded(ImageFormat::Jpeg)).unwrap().dimensions(), (24, 17));
        assert_eq!(size(path, &encoded(ImageFormat::Jpeg)).unwrap(), [24, 17]);
        assert_eq!(decode_grey(path, &encoded(ImageFormat::Png)).unwrap().dimensions(), (24, 17));
        for format in [ImageFormat::Tiff, ImageFormat::WebP, ImageFormat::Bmp] {
            assert_eq!(decode(path, &encoded(format)).unwrap(), picture().into_rgb8(), "{format:?}");
            assert_eq!(size(path, &encoded(format)).unwrap(), [24, 17]);
        }
        let message = decode(path, b"GIF89a").unwrap_err().to_string();
        assert!(message.contains("a.jpg") && message.contains("expected PNG, JPEG"), "{message}");
    }

    #[test]
    fn every_truncation_is_an_error_that_names_the_file() {
        for format in FORMATS {
            let bytes = encoded(format);
            for length in 0..bytes.len() {
                let message = decode(Path::new("cut.png"), &bytes[..length]).unwrap_err().to_string();
                assert!(message.contains("cut.png: is not a whole picture"), "{message}");
            }
        }
    }

    #[test]
    fn a_huge_size_in_the_head_is_refused_before_memory_is_taken() {
        let mut bytes = encoded(ImageFormat::Png);
        bytes[16..24].copy_from_slice(&[0, 0, 0x3F, 0xFF, 0, 0, 0x3F, 0xFF]);
        decode(Path::new("huge.png"), &bytes).unwrap_err();
    }

    /// 32 KB that unfold to 16,384 × 16,384 grey pixels are refused by their head, whole as they are.
    #[test]
    fn a_small_file_of_a_huge_picture_is_refused_at_once() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 16_384, 16_384);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::One);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&vec![0; 16_384 * 16_384 / 8]).unwrap();
        writer.finish().unwrap();
        assert!(bytes.len() < 200_000, "{}", bytes.len());
        let began = std::time::Instant::now();
        for result in
            [decode(Path::new("bomb.png"), &bytes).err(), alpha(Path::new("bomb.png"), &bytes).err()]
        {
            let message = result.unwrap().to_string();
            assert!(message.starts_with("bomb.png: has 16384×16384 pixels; expected at most"), "{message}");
        }
        assert!(began.elapsed() < std::time::Duration::from_secs(1), "{:?}", began.elapsed());
    }

    #[test]
    fn a_written_picture_reads_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png(&path, &picture()).unwrap();
        assert_eq!(read(&path).unwrap(), picture().into_rgb8());
    }
}
