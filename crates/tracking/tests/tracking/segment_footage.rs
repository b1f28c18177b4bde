//! Segmentation of real footage: four cameras, one moving person.

use std::ops::Range;
use std::path::Path;

use backlit_tracking::segment::{Background, SegmentOptions, segment};
use backlit_tracking::silhouette::{Label, Mask};

use crate::footage::footage;

use crate::fixtures::Failures;

fn picture(path: &Path) -> image::RgbImage {
    image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).to_rgb8()
}

/// How many of the subject's pixels lie in a box.
fn subject_in(mask: &Mask, columns: Range<usize>, rows: Range<usize>) -> usize {
    let is_subject = |x, y| mask.get(x, y) == Some(Label::Subject);
    rows.map(|y| columns.clone().filter(|&x| is_subject(x, y)).count()).sum()
}

#[test]
fn a_person_is_found_whole_and_alone() {
    let Some(footage) = footage() else { return };
    // In frames 5 and 50: pixels of the subject in masks that were seen to be right, and a box (columns, rows) around the person.
    let expected = [
        ("cam01", [(8_000, (60..150), (75..305)), (9_450, (10..215), (80..305))]),
        ("cam02", [(5_600, (95..190), (90..290)), (7_500, (38..193), (93..288))]),
        ("cam03", [(9_600, (105..201), (98..341)), (8_000, (50..186), (95..312))]),
        ("cam04", [(10_500, (30..170), (110..360)), (9_500, (38..261), (94..319))]),
    ];
    let mut failures = Failures::default();
    for (camera, frames) in expected {
        let plate = picture(&footage.join(format!("background/{camera}.png")));
        let background = Background::from_plate(&plate);
        for (frame, (pixels, columns, rows)) in [5, 50].into_iter().zip(frames) {
            let image = picture(&footage.join(format!("{camera}/frame_{frame:03}.jpg")));
            let mask = segment(&image, &background, &SegmentOptions::default()).unwrap();
            let found = mask.count(Label::Subject);
            let outside = found - subject_in(&mask, columns, rows);
            let is_right = found.abs_diff(pixels) * 20 <= pixels && outside == 0;
            failures.expect(is_right, format_args!(
"{camera}, frame {frame}: {found} pixels instead of about {pixels}, {outside} outside, {:?}", mask.bounds()));
        }
    }
}
