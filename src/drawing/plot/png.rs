//! Figures as PNG files.

use anyhow::Context;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, RgbaImage};

/// A flat picture as small as it can be: without filters and with all the time that compression takes.
///
/// # Errors
/// The picture is larger than a PNG may be.
pub(crate) fn png(picture: RgbaImage) -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::NoFilter);
    DynamicImage::ImageRgba8(picture).into_rgb8().write_with_encoder(encoder).context("a plot")?;
    Ok(bytes)
}
