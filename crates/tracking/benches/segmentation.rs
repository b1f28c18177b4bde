//! Segmentation, smoothing and distances, on one thread, beside a copy of the same number of bytes.
//!
//! `cargo bench -p backlit-tracking --bench segmentation`

#![expect(clippy::unwrap_used, reason = "a measurement without its input is none")]

mod timing;

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use backlit_tracking::segment::{Background, SegmentOptions, segment};
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
fn footage(camera: usize, width: u32, height: u32) -> (Background, RgbImage) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../assets/take/cam{}", camera + 1));
    let picture = |name: String| {
        let picture = image::open(folder.join(name)).unwrap().to_rgb8();
        resize(&picture, width, height, FilterType::Triangle)
    };
    let empty: Vec<RgbImage> = (0..6).map(|index| picture(format!("empty_{index:03}.jpg"))).collect();
    (Background::from_frames(&empty).unwrap(), picture("frame_010.jpg".to_owned()))
}

fn segmentation(cameras: usize, width: u32, height: u32) {
    let views: Vec<_> = (0..cameras).map(|camera| footage(camera, width, height)).collect();
    let masks = || -> Vec<Mask> {
        let of = |(background, frame): &(Background, RgbImage)| {
            segment(frame, background, &SegmentOptions::default()).unwrap()
        };
        views.iter().map(of).collect()
    };
    let found = masks();
    let pictures: Vec<_> = found.iter().map(Mask::to_gray).collect();
    let mut measurements: Vec<_> =
        found.iter().map(|mask| Measurement::from_mask_averaged(mask, 1)).collect();
    let bytes = vec![1_u8; cameras * (width * height) as usize];
    let mut copy = bytes.clone();
    Table::new(format!("Segmentation, {cameras} × {width} × {height}"))
        .add("memcpy, one byte a pixel", || copy.copy_from_slice(black_box(&bytes)))
        .add("smooth 3×3", || {
            for (mask, measurement) in found.iter().zip(&mut measurements) {
                measurement.average(mask, 1);
                black_box(measurement);
            }
        })
        .add("open and close alone, by imageproc", || {
            for picture in &pictures {
                let opened = morphology::open(picture, Norm::LInf, 1);
                black_box(morphology::close(&opened, Norm::LInf, 2));
            }
        })
        .add("all steps of the default options", || drop(black_box(masks())))
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
