//! Videos: the indices of MP4, MOV and AVI, and the pictures in them, decoded here.

use std::path::Path;

use backlit_formats::FileParts;
use backlit_formats::video::Video;

use crate::engine::{Outcome, Target};
use crate::mutate::Syntax;
use crate::small_videos::{Mp4, avi};

/// Frames of one case that are decoded.
const FRAMES: usize = 6;

fn video(bytes: &[u8]) -> Outcome {
    let opened = Video::decoded_here(FileParts::in_memory(bytes.to_vec()), Path::new("film"));
    let Ok(video) = &opened else { return opened.into() };
    let count = video.frame_count();
    assert!(count > 0 && video.seconds().windows(2).all(|pair| pair[0] <= pair[1]));
    let rate = video.frame_rate();
    assert!(rate.is_none_or(|rate| rate > 0.0 && rate.is_finite()), "{rate:?}");
    let mut answer = Outcome::Read;
    for frame in (0..count.min(FRAMES)).chain([count - 1]) {
        match video.frame_reduced(frame, 2) {
            Ok(picture) => {
                // A divisor that is larger than a side counts as that side.
                let divisor = 2.min(video.size()[0].min(video.size()[1]));
                let size = video.size().map(|side| side / divisor);
                assert_eq!([picture.width() as usize, picture.height() as usize], size);
            }
            Err(error) => answer = Outcome::Refused(error.to_string()),
        }
    }
    if let Some(note) = video.notes().into_iter().next() {
        answer = Outcome::Refused(note);
    }
    answer
}

fn mp4() -> Vec<Vec<u8>> {
    let turned = Mp4 { matrix: [0, 1, -1, 0], index_first: true, ..Mp4::new(3) };
    let edited = Mp4 { edits: vec![(4, -1), (8, 40)], later: vec![40, 120, 40, 0], ..Mp4::new(4) };
    vec![Mp4::new(4).bytes(), turned.bytes(), edited.bytes()]
}

pub(super) fn targets() -> Vec<Target> {
    const BOXES: &[&str] = &[
        "moov", "trak", "mdia", "minf", "stbl", "stsd", "stts", "ctts", "stsz", "stsc", "stco", "co64",
        "elst", "avc1", "avcC", "moof", "traf", "trun", "tfhd", "mvex", "trex", "RIFF", "LIST", "movi",
        "00dc", "idx1", "MJPG", "jpeg",
    ];
    let target =
        |name, seeds| Target { name, syntax: Syntax::Binary, seeds, words: BOXES, read: video, short: 400 };
    vec![target("mp4", mp4), target("avi", || vec![avi(3, [32, 16])])]
}
