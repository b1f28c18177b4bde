//! Videos that `ffmpeg` makes, of many kinds, against how it decodes them itself: the same frames, in order and anywhere.

use std::path::Path;
use std::process::{Command, Stdio};

use backlit_formats::video::Video;
use backlit_formats::{DiskFiles, TakeFiles};

use crate::videos::{has_ffmpeg, skipped};

const SIZE: [usize; 2] = [96, 64];

fn ffmpeg(arguments: &str, input: &[&str], output: &str, folder: &Path) -> Option<Vec<u8>> {
    let mut command = Command::new("ffmpeg");
    command.current_dir(folder).args(["-nostdin", "-v", "error", "-y"]).args(input);
    command.args(arguments.split_whitespace()).arg(output);
    let output = command.stdin(Stdio::null()).output().unwrap();
    output.status.success().then_some(output.stdout)
}

/// Makes the videos of the rows and compares: a file, by how much levels may differ, how it is made. Encoders that this `ffmpeg` lacks
/// are told.
fn compare(rows: &str) {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for row in rows.lines().map(str::trim).filter(|row| !row.is_empty()) {
        let mut words = row.splitn(3, ' ').map(str::trim);
        let [file, tolerance, arguments] = [(); 3].map(|()| words.next().unwrap());
        // A picture of which no two frames are alike.
        let source = "testsrc2=size=96x64:rate=30:duration=1.2";
        if ffmpeg(arguments, &["-f", "lavfi", "-i", source], file, folder.path()).is_none() {
            skipped(file, "this ffmpeg cannot make it");
            continue;
        }
        check(folder.path(), file, tolerance.parse().unwrap());
    }
}

fn check(folder: &Path, file: &str, tolerance: u8) {
    // Other layouts than 4:2:0 of 8 bits are interpolated, unless it is told not to.
    let spread = if tolerance > 0 { "-vf scale=flags=neighbor+accurate_rnd" } else { "" };
    let raw =
        ffmpeg(&format!("{spread} -vsync 0 -pix_fmt rgb24 -f rawvideo"), &["-i", file], "-", folder).unwrap();
    let frames: Vec<&[u8]> = raw.chunks_exact(SIZE[0] * SIZE[1] * 3).collect();
    let video = Video::open(&folder.join(file)).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((video.size(), video.frame_count()), (SIZE, frames.len()), "{file}");
    let times = times(folder, file);
    for (found, time) in video.seconds().iter().zip(&times) {
        let (found, time) = (found - video.seconds()[0], time - times[0]);
        assert!((found - time).abs() < 2e-3, "{file}: {found} {time}");
    }
    let agrees = |video: &Video, frame: usize| {
        let picture = video.frame(frame).unwrap_or_else(|error| panic!("{error}"));
        let off = picture.as_raw().iter().zip(frames[frame]).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(off <= Some(tolerance), "{file}, frame {frame}: off by {off:?} ({})", video.codec());
    };
    (0..frames.len()).for_each(|frame| agrees(&video, frame));
    let anywhere = Video::open(&folder.join(file)).unwrap();
    (0..12).map(|k| (frames.len() - 1) * (k * 5 % 12) / 11).for_each(|frame| agrees(&anywhere, frame));
    assert!(video.notes().is_empty(), "{file}: {:?}", video.notes());
    smaller_pictures_are_ours(&folder.join(file));
}

/// `ffmpeg` makes pictures smaller before they go through its pipe: they are those that our own decoder gives.
fn smaller_pictures_are_ours(path: &Path) {
    let Ok(ours) = Video::decoded_here(DiskFiles.parts(path).unwrap(), path) else { return };
    let both = Video::open(path).unwrap();
    for divisor in [4, 2, 3, 8, 1] {
        for frame in 0..ours.frame_count() {
            let [ours, both] = [&ours, &both].map(|video| video.frame_reduced(frame, divisor).unwrap());
            assert!(ours == both, "{}: frame {frame} at 1/{divisor}", path.display());
        }
    }
    // Without key frames it shows others where it begins in the middle, and it rounds other layouts differently; JPEGs are ours.
    let is_ours = ["refresh.mp4", "ten.mp4", "half.mp4"].iter().any(|name| path.ends_with(name));
    let is_ours = is_ours || ours.codec() != "H.264";
    assert_eq!(both.decoded_count() > ours.decoded_count(), !is_ours, "{}", path.display());
}

/// When `ffprobe` says that frames are shown.
fn times(folder: &Path, file: &str) -> Vec<f64> {
    let mut command = Command::new("ffprobe");
    command.current_dir(folder).args(["-v", "error", "-select_streams", "v:0"]);
    command.args(["-show_entries", "frame=pts_time", "-of", "csv=p=0", file]);
    let text = String::from_utf8(command.output().unwrap().stdout).unwrap();
    text.lines().filter_map(|line| line.trim_end_matches(',').parse().ok()).collect()
}

#[test]
fn h264_of_many_kinds_is_as_ffmpeg_decodes_it() {
    compare(
        "
        open.mp4 0 -c:v libx264 -g 12 -bf 3 -pix_fmt yuv420p -x264-params open-gop=1:scenecut=0
        pieces.mp4 0 -c:v libx264 -g 9 -bf 2 -pix_fmt yuv420p -movflags frag_keyframe+empty_moov
        full.mov 0 -c:v libx264 -g 9 -pix_fmt yuvj420p
        bt709.mp4 0 -c:v libx264 -pix_fmt yuv420p -colorspace bt709 -movflags faststart
        refresh.mp4 0 -c:v libx264 -g 8 -pix_fmt yuv420p -x264-params intra-refresh=1:bframes=0
        lines.mp4 0 -c:v libx264 -g 9 -pix_fmt yuv420p -x264-params interlaced=1
        plain.mp4 0 -c:v libx264 -profile:v baseline -pix_fmt yuv420p -x264-params slices=4
        ten.mp4 6 -c:v libx264 -g 9 -pix_fmt yuv420p10le
        half.mp4 6 -c:v libx264 -g 9 -pix_fmt yuv422p
        ",
    );
}

#[test]
fn other_kinds_are_as_ffmpeg_decodes_them() {
    compare(
        "
        all.mp4 0 -c:v libx264 -g 9 -pix_fmt yuv444p
        box.mkv 0 -c:v libx264 -g 9 -bf 2 -pix_fmt yuv420p
        stream.ts 0 -c:v libx264 -g 9 -bf 2 -pix_fmt yuv420p
        web.webm 0 -c:v libvpx-vp9 -g 9 -deadline realtime -cpu-used 8 -pix_fmt yuv420p
        new.mp4 0 -c:v libx265 -x265-params log-level=none:keyint=9 -pix_fmt yuv420p
        old.avi 0 -c:v mpeg4 -g 9 -q:v 3
        jpeg.avi 4 -c:v mjpeg -q:v 3 -pix_fmt yuvj420p
        jpeg.mov 4 -c:v mjpeg -q:v 3 -pix_fmt yuvj422p
        ",
    );
}

#[test]
fn edits_and_uneven_times_are_as_ffmpeg_has_them() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let source = ["-f", "lavfi", "-i", "testsrc2=size=96x64:rate=30:duration=1.2"];
    let x264 = "-c:v libx264 -g 10 -bf 2 -pix_fmt yuv420p";
    if ffmpeg(x264, &source, "whole.mp4", folder.path()).is_none() {
        skipped("edits", "this ffmpeg has no libx264");
        return;
    }
    // A cut without coding again begins at a key; what lies before the cut is left out by an edit.
    ffmpeg("-c copy", &["-ss", "0.5", "-i", "whole.mp4"], "cut.mp4", folder.path()).unwrap();
    check(folder.path(), "cut.mp4", 0);
    assert!(Video::open(&folder.path().join("cut.mp4")).unwrap().frame_count() < 30);
    let uneven = format!("-vf select='not(eq(mod(n\\,3)\\,1))' -vsync vfr {x264}");
    ffmpeg(&uneven, &source, "uneven.mp4", folder.path()).unwrap();
    check(folder.path(), "uneven.mp4", 0);
}

/// The decoders are compared near a key frame. What is damaged there says nothing of a later frame that is asked for.
#[test]
fn the_key_before_a_frame_is_known() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let source = ["-f", "lavfi", "-i", "testsrc2=size=96x64:rate=25:duration=2"];
    let x264 = "-c:v libx264 -g 10 -keyint_min 10 -sc_threshold 0 -pix_fmt yuv420p";
    if ffmpeg(x264, &source, "keys.mp4", folder.path()).is_none() {
        skipped("keys", "this ffmpeg has no libx264");
        return;
    }
    let video = Video::open(&folder.path().join("keys.mp4")).unwrap();
    let keys: Vec<usize> = [0, 9, 10, 11, 37, 49, 99].map(|frame| video.key_before(frame)).to_vec();
    assert_eq!(keys, [0, 0, 10, 10, 30, 40, 99]);
}

#[test]
fn a_damaged_frame_near_a_key_leaves_later_ones_whole() {
    if !has_ffmpeg() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let source = ["-f", "lavfi", "-i", "testsrc2=size=96x64:rate=30:duration=1.2"];
    let x264 = "-c:v libx264 -g 40 -bf 3 -pix_fmt yuv420p -x264-params b-pyramid=none:b-adapt=0:scenecut=0";
    if ffmpeg(x264, &source, "whole.mp4", folder.path()).is_none() {
        skipped("damage", "this ffmpeg has no libx264");
        return;
    }
    let mut command = Command::new("ffprobe");
    command.current_dir(folder.path()).args(["-v", "error", "-select_streams", "v:0"]);
    command.args(["-show_entries", "packet=pts,pos,size", "-of", "csv=p=0", "whole.mp4"]);
    let text = String::from_utf8(command.output().unwrap().stdout).unwrap();
    let number = |text: &str| text.parse::<usize>().unwrap();
    let mut packets: Vec<[usize; 3]> = text
        .lines()
        .map(|line| line.trim_end_matches(',').split(',').map(number).collect::<Vec<_>>())
        .map(|fields| fields.try_into().unwrap())
        .collect();
    packets.sort_unstable();
    // No picture is made from the third one shown after the key.
    let [_, size, place] = packets[3];
    let path = folder.path().join("damaged.mp4");
    let mut bytes = std::fs::read(folder.path().join("whole.mp4")).unwrap();
    // The length of its first part is larger than the sample.
    bytes[place..place + 4].copy_from_slice(&(size as u32 * 2).to_be_bytes());
    std::fs::write(&path, bytes).unwrap();
    let frame_of = |video: Video, frame: usize| video.frame(frame).ok();
    let here = || Video::decoded_here(DiskFiles.parts(&path).unwrap(), &path).unwrap();
    assert!(frame_of(here(), 3).is_none() && frame_of(here(), 30).is_some());
    for frame in [3, 13, 20, 30] {
        let both = Video::open(&path).unwrap();
        assert!(frame_of(both, frame) == frame_of(here(), frame), "frame {frame}");
    }
}
