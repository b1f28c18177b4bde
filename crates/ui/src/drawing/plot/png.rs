//! Figures as PNG files.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ImageResult, RgbaImage};

/// A flat picture as small as it can be: without filters and with all the time that compression takes.
///
/// # Errors
/// The picture is larger than a PNG may be.
pub fn png(picture: RgbaImage) -> ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter);
    DynamicImage::ImageRgba8(picture).into_rgb8().write_with_encoder(encoder)?;
    Ok(bytes)
}
