//! Masks made elsewhere in the place of segmentation: what they are read as, and what is told where they are wrong.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use backlit_formats::masks::MaskValues;
use backlit_formats::{Footage, MemoryFiles, Take, TakeError};
use backlit_tracking::segment::SegmentOptions;
use backlit_tracking::silhouette::{Label, Mask};
use image::{DynamicImage, GrayAlphaImage, GrayImage, ImageFormat, Luma, LumaA, RgbImage};

use crate::small_videos::{avi_of, cameras, jpeg};

const SIZE: [u32; 2] = [16, 12];
const FRAMES: u32 = 4;

/// The subject of a frame: a block that steps to the right.
fn is_subject(frame: u32, x: u32, y: u32) -> bool {
    (2 + 2 * frame..6 + 2 * frame).contains(&x) && (2..10).contains(&y)
}

fn encoded(picture: DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// A mask of a frame with one number where the subject is and another elsewhere.
fn mask(frame: u32, [subject, background]: [u8; 2]) -> Vec<u8> {
    let level = |x, y| Luma([if is_subject(frame, x, y) { subject } else { background }]);
    encoded(GrayImage::from_fn(SIZE[0], SIZE[1], level).into(), ImageFormat::Png)
}

type Files = BTreeMap<PathBuf, Vec<u8>>;

/// A take of one camera whose table has these lines, with pictures `f%d.jpg` from 0 and masks `m%d.png` from 5.
fn take(top: &str, lines: &str, change: impl FnOnce(&mut Files)) -> Result<Take, TakeError> {
    let text = format!(
        "format = \"backlit-take 1\"\nname = \"masks\"\nframe_rate = 25\nmodel = \"single_limb\"\n{top}\n[cameras]\n\
         calibration = \"cameras.json\"\n[[camera]]\nname = \"a\"\n{lines}\n"
    );
    let mut files = Files::from([
        ("take.toml".into(), text.into_bytes()),
        ("cameras.json".into(), cameras(&["a"], SIZE, 20, "")),
    ]);
    for frame in 0..FRAMES {
        files.insert(format!("f{frame}.jpg").into(), jpeg(frame as usize, SIZE));
        files.insert(format!("m{}.png", frame + 5).into(), mask(frame, [255, 0]));
    }
    change(&mut files);
    Take::from_files(Arc::new(MemoryFiles::new(files)), Path::new("take.toml"))
}

fn put(files: &mut Files, of: impl Fn(u32) -> Vec<u8>) {
    (0..FRAMES).for_each(|frame| drop(files.insert(format!("m{}.png", frame + 5).into(), of(frame))));
}

fn given(take: Take, frame: usize) -> Mask {
    Footage::new(take).given_mask(0, frame).unwrap().unwrap()
}

fn is_right(mask: &Mask, frame: u32) -> bool {
    let labels = mask.labels().iter().zip(0..);
    (mask.width(), mask.height()) == (16, 12)
        && labels.into_iter().all(|(label, at)| {
            let expected = is_subject(frame, at % 16, at / 16);
            *label == if expected { Label::Subject } else { Label::Background }
        })
}

const BESIDE: &str = "frames = \"f%d.jpg\"\nmasks = \"m%d.png\"\nmasks_first = 5";
const ALONE: &str = "masks = \"m%d.png\"\nfirst = 5";

/// The file of a frame's mask.
type Masks = dyn Fn(u32) -> Vec<u8>;

#[test]
fn masks_of_every_kind_stand_in_the_place_of_segmentation() {
    let with_alpha = |frame| {
        let pixel = |x, y| LumaA([(x * 9) as u8, if is_subject(frame, x, y) { 250 } else { 3 }]);
        encoded(GrayAlphaImage::from_fn(SIZE[0], SIZE[1], pixel).into(), ImageFormat::Png)
    };
    let soft = |frame| {
        let level = |x, y| Luma([if is_subject(frame, x, y) { 140 + x as u8 } else { 60 + 5 * y as u8 }]);
        encoded(GrayImage::from_fn(SIZE[0], SIZE[1], level).into(), ImageFormat::Png)
    };
    let people = |frame| {
        let id = |x, y| Luma([if is_subject(frame, x, y) { 3 } else { u8::from(y > 10) * 2 }]);
        encoded(GrayImage::from_fn(SIZE[0], SIZE[1], id).into(), ImageFormat::Png)
    };
    let kinds: [(&str, MaskValues, Box<Masks>); 5] = [
        ("", MaskValues::NonZero, Box::new(|frame| mask(frame, [1, 0]))),
        ("mask_values = \"auto\"", MaskValues::NonZero, Box::new(|frame| mask(frame, [255, 0]))),
        ("", MaskValues::Alpha, Box::new(with_alpha)),
        ("", MaskValues::Grey, Box::new(soft)),
        ("mask_values = { ids = [3, 9] }", MaskValues::Ids(vec![3, 9]), Box::new(people)),
    ];
    for (values, expected, of) in kinds {
        for lines in [BESIDE, ALONE] {
            let take = take("", &format!("{lines}\n{values}"), |files| put(files, &of)).unwrap();
            assert_eq!(take.frame_count(), 4);
            assert_eq!(take.mask_values(0).unwrap(), Some(&expected));
            assert_eq!(take.footage()[0].mask_path(1).unwrap(), Path::new("m6.png"));
            assert_eq!(take.footage()[0].is_masks_alone(), lines == ALONE);
            for frame in 0..4_u32 {
                assert!(is_right(&given(take.clone(), frame as usize), frame), "{expected:?} {lines}");
            }
            // No background is asked for, and the picture shows the mask where there is no footage.
            let footage = Footage::new(take);
            let views = footage.fit_views(&[0], 2).unwrap();
            assert!(views[0].has_data());
            let picture = footage.picture(0, 2).unwrap();
            let mask = footage.mask(0, 2, &picture, &SegmentOptions::default()).unwrap();
            assert!(is_right(&mask, 2));
            if lines == ALONE && expected == MaskValues::NonZero {
                assert_eq!([picture.get_pixel(7, 5)[0], picture.get_pixel(0, 0)[1]], [255, 0]);
            }
        }
    }
}

#[test]
fn unknown_pixels_are_kept_and_those_of_a_soft_mask_are_not() {
    let with = |unknown: u8, extra: u8| {
        let level = move |frame| {
            move |x, y| {
                Luma([if is_subject(frame, x, y) {
                    255
                } else if y == 11 {
                    unknown
                } else if x == 0 {
                    extra
                } else {
                    0
                }])
            }
        };
        let of =
            move |frame| encoded(GrayImage::from_fn(SIZE[0], SIZE[1], level(frame)).into(), ImageFormat::Png);
        move |values: &str| {
            let take = take("", &format!("{ALONE}\n{values}"), |files| put(files, of)).unwrap();
            given(take, 0).count(Label::Unknown)
        }
    };
    assert_eq!(with(128, 0)(""), 16, "one of ours");
    assert_eq!(with(96, 0)(""), 16, "and its shadow");
    assert_eq!(with(96, 7)(""), 0, "a net's");
    assert_eq!(with(96, 7)("mask_values = \"classes\""), 16);
    assert_eq!(with(96, 0)("mask_values = \"grey\""), 0);
}

#[test]
fn masks_follow_offsets_and_ranges_of_their_footage() {
    for (lines, first) in [("first = 1\nmasks_first = 6", 1), ("offset = 2\nmasks_first = 5", 2)] {
        let lines = format!("frames = \"f%d.jpg\"\nmasks = \"m%d.png\"\n{lines}");
        let take = take("", &lines, |_| {}).unwrap();
        assert_eq!(take.frame_count(), 4 - first as usize);
        for frame in 0..take.frame_count() {
            assert!(is_right(&given(take.clone(), frame), frame as u32 + first), "{lines} {frame}");
        }
    }
    let video = |files: &mut Files| {
        let pictures: Vec<Vec<u8>> = (0..FRAMES).map(coarse).collect();
        files.insert("m.avi".into(), avi_of(&pictures, [32, 16], b"MJPG"));
        files.insert("cameras.json".into(), cameras(&["a"], [32, 16], 20, ""));
    };
    let take = take("", "masks = \"m.avi\"\nfirst = 1", video).unwrap();
    assert_eq!((take.frame_count(), take.mask_values(0).unwrap()), (3, Some(&MaskValues::Grey)));
    assert_eq!(given(take, 1).bounds().map(|seen| seen.x_min), Some(16));
}

/// A frame of a video of masks: a block that steps by eight pixels, as JPEG's blocks are.
fn coarse(frame: u32) -> Vec<u8> {
    let picture = GrayImage::from_fn(32, 16, |x, _| Luma([if x / 8 == frame { 250 } else { 4 }]));
    encoded(picture.into(), ImageFormat::Jpeg)
}

#[test]
fn masks_are_reduced_by_area_and_rectified_as_footage_is() {
    // Of the full size, of the reduced one, and drawn for those who want the full picture.
    let small = |frame| {
        let level = |x, y| Luma([if is_subject(frame, 2 * x, 2 * y) { 255 } else { 0 }]);
        encoded(GrayImage::from_fn(8, 6, level).into(), ImageFormat::Png)
    };
    for is_small in [false, true] {
        let take = take("reduction = 2", ALONE, |files| {
            if is_small {
                put(files, small);
            }
        })
        .unwrap();
        let mask = given(take.clone(), 1);
        assert_eq!((mask.width(), mask.height(), mask.count(Label::Subject)), (8, 6, 2 * 4));
        assert_eq!(mask.count(Label::Unknown), 0);
        assert_eq!(mask.get(2, 1), Some(Label::Subject));
        assert_eq!(take.frame(0, 1).unwrap().dimensions(), (8, 6));
        let full = take.full_frame(0, 1).unwrap();
        assert_eq!((full.dimensions(), full.get_pixel(4, 2)[0], full.get_pixel(3, 2)[0]), ((16, 12), 255, 0));
    }
    let lens = r#""distortion": {"model": "opencv", "k1": -0.3, "k2": 0, "p1": 0, "p2": 0, "k3": 0},"#;
    let bent = |files: &mut Files| {
        files.insert("cameras.json".into(), cameras(&["a"], SIZE, 20, lens));
        // The footage shows the same as the masks: both are bent back alike.
        for frame in 0..FRAMES {
            let white = |x, y| image::Rgb([if is_subject(frame, x, y) { 255 } else { 0 }; 3]);
            let picture = RgbImage::from_fn(SIZE[0], SIZE[1], white);
            files.insert(format!("f{frame}.png").into(), encoded(picture.into(), ImageFormat::Png));
        }
    };
    let lines = BESIDE.replace("jpg", "png");
    let footage = Footage::new(take("", &lines, bent).unwrap());
    let (mask, picture) = (footage.given_mask(0, 1).unwrap().unwrap(), footage.picture(0, 1).unwrap());
    for (label, pixel) in mask.labels().iter().zip(picture.pixels()) {
        match label {
            // Black where the lens saw nothing.
            Label::Unknown => assert!([0, 127, 128].contains(&pixel[0]), "{}", pixel[0]),
            label => assert_eq!(*label == Label::Subject, pixel[0] >= 128),
        }
    }
    assert!(mask.count(Label::Subject) > 20);
}

#[test]
fn what_is_wrong_names_camera_frame_and_file() {
    let opened = |lines: &str, change: &dyn Fn(&mut Files)| match take("", lines, |files| change(files)) {
        Err(error) => error.to_string(),
        Ok(take) => Footage::new(take).fit_views(&[0], 1).unwrap_err().to_string(),
    };
    let nothing = |_: &mut Files| {};
    let gone = |files: &mut Files| drop(files.remove(Path::new("m7.png")));
    assert_eq!(opened(BESIDE, &gone), "camera \"a\", mask of frame 2: m7.png: there is no such file");
    let other = |path: &'static str| {
        move |files: &mut Files| {
            files.insert(path.into(), encoded(GrayImage::new(12, 16).into(), ImageFormat::Png));
        }
    };
    for lines in [BESIDE, ALONE] {
        let said = opened(lines, &other("m5.png"));
        assert_eq!(said, "camera \"a\", mask of frame 0: m5.png: has 12×16 pixels; expected 16×12");
        let said = opened(lines, &other("m6.png"));
        assert_eq!(said, "camera \"a\", mask of frame 1: m6.png: has 12×16 pixels; expected 16×12");
    }
    let cut = |files: &mut Files| files.get_mut(Path::new("m6.png")).unwrap().truncate(50);
    let said = opened(BESIDE, &cut);
    assert!(said.starts_with("camera \"a\", mask of frame 1: m6.png: is not a whole picture"), "{said}");
    let short = |files: &mut Files| {
        let pictures: Vec<Vec<u8>> = (0..3).map(|frame| jpeg(frame, SIZE)).collect();
        files.insert("m.avi".into(), avi_of(&pictures, SIZE, b"MJPG"));
    };
    let said = opened("frames = \"f%d.jpg\"\nmasks = \"m.avi\"", &short);
    assert_eq!(
        said,
        "camera \"a\", mask of frame 3: m.avi: there is no frame 3; the video has 3, counted from 0"
    );
    let said = opened(&format!("{BESIDE}\nmask_values = {{ ids = [4] }}"), &nothing);
    let expected = "camera \"a\", mask of frame 0: m5.png: id 4 is in none of the 4 masks that were looked at; there are 255";
    assert_eq!(said, expected);
    let several = |files: &mut Files| put(files, |frame| mask(frame, [3, 1]));
    let said = opened(BESIDE, &several);
    assert!(said.contains("m5.png: has the numbers 1, 3") && said.contains("{ ids = [1] }"), "{said}");
    let said = opened(&format!("{BESIDE}\nmask_values = \"alpha\""), &nothing);
    assert!(said.contains("camera \"a\", mask of frame 0: m5.png: has no alpha channel"), "{said}");
    let cases = [
        ("first = 5", "line 9: `camera` is \"a\"; expected a camera with `frames`, `masks` or both"),
        ("frames = \"f%d.jpg\"\nmask_values = \"grey\"", "line 11: `mask_values` is"),
        ("frames = \"f%d.jpg\"\nmasks_first = 2", "line 11: `masks_first` is 2; expected `masks` beside it"),
        ("masks = \"m%d.png\"\nmasks_first = 5", "line 11: `masks_first` is 5; expected `first`"),
        ("masks = \"m%d.png\"\nfirst = 5\nmask_values = \"luma\"", "line 12: `mask_values` is"),
        ("masks = \"none.avi\"", "camera \"a\", mask of frame 0: none.avi: there is no such file"),
        ("masks = \"m5.png\"", "line 10: `camera.masks` is \"m5.png\"; expected a pattern"),
    ];
    for (lines, expected) in cases {
        let said = opened(lines, &nothing);
        assert!(said.contains(expected), "{said:?} should contain {expected:?}");
    }
}
