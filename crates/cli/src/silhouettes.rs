//! `backlit silhouettes`: the masks of a take as pictures.

use std::path::PathBuf;

use backlit_formats::calibration;
use backlit_formats::images;
use backlit_tracking::camera::Rig;
use backlit_tracking::fit::Evidence;
use clap::Args;
use image::DynamicImage;

use super::fit_options::one_of;
use super::output;
use super::person::PersonArguments;
use super::progress;
use super::take_options::{self, PartArguments, Segmentation};
use crate::interrupt;

const AFTER_HELP: &str = "\
Writes to the folder of --out:
  NAME/frame_000000.png  the silhouette of camera NAME: white subject, black background,
                         grey 128 unknown, shadow 32 (background) or 96 (weighs nothing)
  cameras.json           the cameras of these pictures, without lens distortion

Example:
  backlit silhouettes TAKE --out masks --frames 0..10";

/// What `backlit silhouettes` is told.
#[derive(Debug, Args)]
#[command(after_help = AFTER_HELP)]
pub struct SilhouetteArguments {
    /// Take: its folder or its take.toml
    take: PathBuf,
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How they are made of the pictures
    #[arg(long, value_name = "HOW", value_parser = one_of(Segmentation::WORDS), default_value = "take")]
    segmentation: Segmentation,
    #[command(flatten)]
    part: PartArguments,
    #[command(flatten)]
    person: PersonArguments,
}

pub(crate) fn run(arguments: &SilhouetteArguments) -> anyhow::Result<()> {
    let footage = take_options::open_segmented(&arguments.take, None, arguments.segmentation)?;
    let frames = arguments.part.frames(footage.take())?;
    let indices = arguments.part.cameras(footage.take())?;
    let footage = arguments.person.follow(footage, &indices, &frames, &interrupt::listen()?)?;
    let cameras: Vec<_> = indices.iter().map(|&camera| (*footage.cameras[camera]).clone()).collect();
    for camera in &cameras {
        output::check_file_stem(camera.name())?;
        output::make_folder(&arguments.out.join(camera.name()))?;
    }
    calibration::backlit::write(&arguments.out.join("cameras.json"), &Rig::new(cameras)?)?;
    let progress = progress::bar(frames.len());
    for frame in frames {
        for view in footage.fit_views(&indices, frame)? {
            let Evidence::Mask(mask) = &view.evidence else { continue };
            let path = arguments.out.join(view.camera.name()).join(format!("frame_{frame:06}.png"));
            images::write_png(&path, &DynamicImage::ImageLuma8(mask.to_gray()))?;
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(())
}
