//! Segmentation, smoothing and distances, on one thread, beside a copy of the same number of bytes.
//!
//! `cargo bench -p backlit-tracking --bench segmentation`

#![expect(clippy::unwrap_used, reason = "a measurement without its input is none")]

mod timing;

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use backlit_tracking::segment::{Background, SegmentOptions, Segmenter, segment};
use backlit_tracking::silhouette::{Mask, Measurement, SignedDistance};
use image::RgbImage;
use image::imageops::{FilterType, resize};
use imageproc::distance_transform::Norm;
use imageproc::morphology;
use timing::Table;

/// How long each table may take.
const BUDGET: Duration = Duration::from_millis(1200);

fn main() {
    segmentation(2, 192, 144);
    segmentation(4, 640, 480);
    distances(4, 272, 480);
}

/// A camera's empty room and one frame, from the built-in take.
fn footage(camera: usize, width: u32, height: u32) -> (Arc<Background>, RgbImage) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../assets/take/cam{}", camera + 1));
    let picture = |name: String| {
        let picture = image::open(folder.join(name)).unwrap().to_rgb8();
        resize(&picture, width, height, FilterType::Triangle)
    };
    let empty: Vec<RgbImage> = (0..6).map(|index| picture(format!("empty_{index:03}.jpg"))).collect();
    (Arc::new(Background::from_frames(&empty).unwrap()), picture("frame_010.jpg".to_owned()))
}

/// Threshold, opening and closing, and nothing else.
fn plain() -> SegmentOptions {
    SegmentOptions {
        match_exposure: false,
        shadow: None,
        min_component_px: 0,
        min_group_fraction: 0.0,
        fill_holes_px: 0,
        dont_know: None,
        ..SegmentOptions::default()
    }
}

fn segmentation(cameras: usize, width: u32, height: u32) {
    let views: Vec<_> = (0..cameras).map(|camera| footage(camera, width, height)).collect();
    let ready = |options: SegmentOptions| -> Vec<Segmenter> {
        views
            .iter()
            .map(|(background, _)| Segmenter::new(background.clone(), options.clone()).unwrap())
            .collect()
    };
    let (plain, full) = (ready(plain()), ready(SegmentOptions::default()));
    let masks = |ready: &[Segmenter]| -> Vec<Mask> {
        ready.iter().zip(&views).map(|(ready, (_, frame))| ready.segment(frame).unwrap()).collect()
    };
    let found = masks(&plain);
    let pictures: Vec<_> = found.iter().map(Mask::to_gray).collect();
    let smooth = |masks: &[Mask], into: &mut [Measurement]| {
        for (mask, measurement) in masks.iter().zip(into) {
            measurement.average(mask, 1);
            black_box(measurement);
        }
    };
    let mut measurements: Vec<_> =
        found.iter().map(|mask| Measurement::from_mask_averaged(mask, 1)).collect();
    let mut others = measurements.clone();
    let bytes = vec![1_u8; cameras * (width * height) as usize];
    let mut copy = bytes.clone();
    Table::new(format!("Segmentation, {cameras} × {width} × {height}"))
        .add("memcpy, one byte a pixel", || copy.copy_from_slice(black_box(&bytes)))
        .add("threshold, open 3×3, close 5×5", || drop(black_box(masks(&plain))))
        .add("smooth 3×3", || smooth(&found, &mut measurements))
        .add("threshold, open, close, smooth", || smooth(&masks(&plain), &mut others))
        .add("open and close alone, by imageproc", || {
            for picture in &pictures {
                let opened = morphology::open(picture, Norm::LInf, 1);
                black_box(morphology::close(&opened, Norm::LInf, 2));
            }
        })
        .add("all steps of the default options", || drop(black_box(masks(&full))))
        .run(BUDGET);
}

fn distances(cameras: usize, width: u32, height: u32) {
    let masks: Vec<Mask> = (0..cameras)
        .map(|camera| {
            let (background, frame) = footage(camera, width, height);
            segment(&frame, &background, &SegmentOptions::default()).unwrap()
        })
        .collect();
    let bytes = vec![1_u8; cameras * (width * height) as usize];
    let mut copy = bytes.clone();
    let each = |make: fn(&Mask) -> SignedDistance| masks.iter().for_each(|mask| drop(black_box(make(mask))));
    Table::new(format!("Signed distance, {cameras} × {width} × {height}"))
        .add("memcpy, one byte a pixel", || copy.copy_from_slice(black_box(&bytes)))
        .add("everywhere", || each(SignedDistance::from_mask))
        .add("within 24 px", || each(|mask| SignedDistance::from_mask_within(mask, 24.0)))
        .add("within 6 px", || each(|mask| SignedDistance::from_mask_within(mask, 6.0)))
        .run(BUDGET);
}
