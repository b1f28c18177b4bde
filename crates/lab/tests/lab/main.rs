//! What synthetic people are for, through the public face: the take that comes with the program.

#![expect(clippy::unwrap_used, reason = "helpers of tests, where a panic is the answer")]

mod builtin_take;
mod calibration_faults;
mod camera_refinement;
mod changed_backgrounds;
mod clocks;
mod credibility;
mod errata;
mod given_masks;
mod learnt_plates;
mod one_camera_disturbed;
mod own_sizes;
mod thresholds;
mod turned_round;
mod without_start;

/// A picture as the bytes of a file.
fn png(picture: impl Into<image::DynamicImage>) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.into().write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
