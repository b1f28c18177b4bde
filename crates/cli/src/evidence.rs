//! Silhouettes and grey levels from a folder: NAME.png for the camera NAME.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, ensure};
use backlit_formats::images;
use backlit_tracking::camera::{Camera, Rectification, Rig};
use backlit_tracking::fit::{Evidence, FitView};
use backlit_tracking::silhouette::{Label, Mask, Measurement};
use image::{DynamicImage, GrayImage};

/// What a picture says of a camera, the lens taken out of it.
type Reading = fn(GrayImage, &Rectification) -> anyhow::Result<Evidence>;

/// Reads every camera's picture: as a [`mask`] or as a [`measurement`].
pub(crate) fn read(folder: &Path, rig: &Rig, reading: Reading) -> anyhow::Result<Vec<FitView>> {
    rig.cameras().iter().map(|camera| view(folder, camera, reading)).collect()
}

fn view(folder: &Path, camera: &Camera, reading: Reading) -> anyhow::Result<FitView> {
    super::output::check_file_stem(camera.name())?;
    let path = folder.join(format!("{}.png", camera.name()));
    let picture = images::read_grey(&path)?;
    let ([found_width, found_height], [width, height]) =
        ([picture.width(), picture.height()], [camera.width(), camera.height()]);
    ensure!(
        [found_width as usize, found_height as usize] == [width, height],
        "{}: has {found_width}×{found_height} pixels; expected {width}×{height}, the size of camera \"{}\"",
        path.display(),
        camera.name()
    );
    let evidence = reading(picture, &Rectification::new(camera));
    let evidence = evidence.with_context(|| path.display().to_string())?;
    Ok(FitView { camera: Arc::new(camera.without_distortion()), evidence, weight: 1.0 })
}

/// White is the subject, middle grey unknown. Labels cannot be averaged: each ideal pixel takes the nearest, and is unknown where the lens saw nothing.
pub(crate) fn mask(picture: GrayImage, rectification: &Rectification) -> anyhow::Result<Evidence> {
    let mask = Mask::from_gray(&picture)?;
    let labels = rectification.nearest(mask.labels(), Label::Unknown).context("one label a pixel")?;
    Ok(Evidence::Mask(Arc::new(Mask::new(mask.width(), mask.height(), labels)?)))
}

/// Grey levels D as they are, 0 the subject. They are interpolated, and weigh nothing where the lens saw nothing.
pub(crate) fn measurement(picture: GrayImage, rectification: &Rectification) -> anyhow::Result<Evidence> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let colour = DynamicImage::ImageLuma8(picture).into_rgb8();
    let ideal = rectification.rectify(&colour).context("one level a pixel")?;
    let values = ideal.pixels().map(|pixel| f32::from(pixel[0])).collect();
    let weights = (0..width * height).map(|i| f32::from(rectification.has_data(i % width, i / width)));
    Ok(Evidence::Measurement(Arc::new(Measurement::new(width, height, values, weights.collect())?)))
}
