//! Pictures and silhouettes of a page.

use std::collections::BTreeSet;

use backlit_formats::footage::CameraFrame;
use backlit_report::{Picture, outline};
use backlit_tracking::cancel::CancelToken;
use backlit_tracking::silhouette::Label;
use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::{FilterType, resize};
use rayon::prelude::*;

use super::{PageFootage, ReportError};

/// A picture is at most this wide and high in the page, pixels.
const WIDEST: u32 = 480;
const HIGHEST: u32 = 640;
/// JPEG's quality, of 100.
const QUALITY: u8 = 72;
/// The footage may be damaged in many frames: notes name no more.
const NAMED: usize = 3;
/// At most this many frames are in memory at once.
const FRAMES_AT_A_TIME: usize = 4;

impl PageFootage<'_> {
    /// Every camera's picture and silhouette of these frames. What cannot be read is noted.
    pub(super) fn pictures(
        &self,
        frames: &BTreeSet<usize>,
        notes: &mut Vec<String>,
        cancel: &CancelToken,
    ) -> Result<Vec<Picture>, ReportError> {
        // A frame between two keys of a video takes long, a camera a thread. Keys are quick: some at a time leave no thread idle.
        let (keys, between): (Vec<usize>, Vec<usize>) =
            frames.iter().partition(|&&frame| self.sooner(frame) == frame);
        let one = |&frame: &usize| self.frame_pictures(frame, cancel);
        let mut all: Vec<Result<FramePictures, ReportError>> = between.iter().map(one).collect();
        let share = keys.len().div_ceil(FRAMES_AT_A_TIME).max(1);
        all.par_extend(keys.par_chunks(share).flat_map_iter(|frames| frames.iter().map(one)));
        let mut all = all.into_iter().collect::<Result<Vec<FramePictures>, ReportError>>()?;
        all.sort_by_key(|one| one.frame);
        let missing: Vec<String> = all.iter_mut().flat_map(|one| std::mem::take(&mut one.missing)).collect();
        let more = missing.len().saturating_sub(NAMED);
        notes.extend(missing.into_iter().take(NAMED));
        if more > 0 {
            notes.push(format!("And {more} more like these."));
        }
        Ok(all.into_iter().flat_map(|one| one.pictures).collect())
    }

    fn frame_pictures(&self, frame: usize, cancel: &CancelToken) -> Result<FramePictures, ReportError> {
        if cancel.is_cancelled() {
            return Err(ReportError::Stopped);
        }
        let loaded = self.load(frame);
        let drawn = loaded.par_iter().enumerate().map(|(camera, seen)| picture(camera, frame, seen));
        let pictures = drawn.collect::<Vec<_>>().into_iter().flatten().collect();
        let problems = loaded.into_iter().filter_map(|seen| seen.problem);
        let missing = problems.map(|why| format!("Not whole in frame {frame}: {why}.")).collect();
        Ok(FramePictures { frame, pictures, missing })
    }
}

/// Every camera's picture of a frame, and what could not be read.
struct FramePictures {
    frame: usize,
    pictures: Vec<Picture>,
    missing: Vec<String>,
}

/// What a camera saw in a frame; `None` where that is nothing.
fn picture(camera: usize, frame: usize, seen: &CameraFrame) -> Option<Picture> {
    let (size, bytes) = seen.image.as_deref().map(encoded).unwrap_or_default();
    let path = |label| seen.mask.as_deref().map_or(String::new(), |mask| outline::path(mask, label));
    let (subject, unknown) = (path(Label::Subject), path(Label::Unknown));
    let is_there = !(bytes.is_empty() && subject.is_empty());
    is_there.then_some(Picture { camera, frame, media_type: "image/jpeg", size, bytes, subject, unknown })
}

/// A picture made small enough, its width and height, and as JPEG; empty where it has no pixels.
fn encoded(picture: &RgbImage) -> ([u32; 2], Vec<u8>) {
    let (width, height) = picture.dimensions();
    let scale = (f64::from(WIDEST) / f64::from(width)).min(f64::from(HIGHEST) / f64::from(height));
    let reduced;
    let picture = if scale < 1.0 {
        let [w, h] = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
        reduced = resize(picture, w, h, FilterType::Triangle);
        &reduced
    } else {
        picture
    };
    let mut bytes = Vec::new();
    match JpegEncoder::new_with_quality(&mut bytes, QUALITY).encode_image(picture) {
        Ok(()) => (picture.dimensions().into(), bytes),
        Err(_) => Default::default(),
    }
}
