//! What `ffprobe` says of a file: codec, size, when each frame is shown.

use std::ffi::OsString;
use std::io::Read;
use std::process::Command;
use std::sync::mpsc::channel;

use serde::Deserialize;

use super::ffmpeg::{PATIENCE, Process, Programs, bounds, missing};
use super::{MAX_VIDEO_FRAMES, VideoProblem};
use backlit_tracking::camera::MAX_SIDE;

/// Most bytes of an answer: 1 000 000 frames have 100 MB.
const MAX_ANSWER_BYTES: u64 = 256 << 20;
/// Most pixels of a frame, as of a picture.
const MAX_PIXELS: usize = 64 << 20;

/// A video as `ffprobe` sees it.
#[derive(Debug)]
pub(super) struct Probed {
    pub(super) codec: String,
    /// As `ffmpeg` will turn it.
    pub(super) size: [usize; 2],
    /// When frames are shown; the first one at 0.
    pub(super) seconds: Vec<f64>,
    /// What must be added to get the program's own times.
    pub(super) zero: f64,
    /// The file's own beginning in these, from which `-ss` counts.
    pub(super) begins: f64,
    /// `-fps_mode` is known (5.1 and newer), else `-vsync`.
    pub(super) knows_fps_mode: bool,
}

#[derive(Debug, Deserialize)]
struct ProbeOutput {
    #[serde(default)]
    packets: Vec<Packet>,
    #[serde(default)]
    streams: Vec<Stream>,
    #[serde(default)]
    format: Format,
    program_version: Option<Version>,
}

#[derive(Debug, Deserialize)]
struct Packet {
    pts_time: Option<String>,
    dts_time: Option<String>,
    #[serde(default)]
    flags: String,
}

#[derive(Debug, Deserialize)]
struct Stream {
    codec_name: Option<String>,
    #[serde(default)]
    width: u64,
    #[serde(default)]
    height: u64,
    #[serde(default)]
    side_data_list: Vec<SideData>,
    #[serde(default)]
    tags: Tags,
}

#[derive(Debug, Deserialize)]
struct SideData {
    rotation: Option<f64>,
}

#[derive(Debug, Deserialize, Default)]
struct Tags {
    rotate: Option<String>,
}

#[derive(Debug, Deserialize, Default)]
struct Format {
    start_time: Option<String>,
}

#[derive(Debug, Deserialize)]
struct Version {
    version: String,
}

/// Asks `ffprobe` about the file's first video stream.
pub(super) fn probe(programs: &Programs, input: &OsString, codec: &str) -> Result<Probed, VideoProblem> {
    let failed = |codec: &str, message: &str| VideoProblem::Program {
        codec: codec.to_owned(),
        program: programs.ffprobe.to_string_lossy().into_owned(),
        message: message.to_owned(),
    };
    let answer = ask(programs, input).map_err(|error| missing(&programs.ffprobe, codec, error))?;
    let answer: ProbeOutput = match answer {
        Some(bytes) => serde_json::from_slice(&bytes).map_err(|error| failed(codec, &error.to_string()))?,
        None => return Err(failed(codec, "it ends with an error, or takes too long")),
    };
    let stream = answer.streams.first().ok_or(VideoProblem::NoVideo)?;
    let codec = stream.codec_name.clone().map_or_else(|| codec.to_owned(), |name| spoken(&name));
    let mut size = [stream.width, stream.height].map(|side| usize::try_from(side).unwrap_or(usize::MAX));
    let limit = MAX_SIDE as usize;
    if size.iter().any(|&side| side == 0 || side > limit) || size[0] * size[1] > MAX_PIXELS {
        return Err(VideoProblem::Size { size, limit });
    }
    let tag = stream.tags.rotate.as_ref().and_then(|degrees| degrees.parse().ok());
    let rotation = stream.side_data_list.iter().find_map(|data| data.rotation).or(tag).unwrap_or(0.0);
    if ((rotation / 90.0).round() as i64).rem_euclid(2) == 1 {
        size.reverse();
    }
    let mut seconds = times(&answer.packets);
    let Some(&zero) = seconds.first() else { return Err(VideoProblem::NoFrames { whole: 0 }) };
    if seconds.len() > MAX_VIDEO_FRAMES {
        return Err(VideoProblem::TooManyFrames { limit: MAX_VIDEO_FRAMES });
    }
    seconds.iter_mut().for_each(|time| *time -= zero);
    let begins = answer.format.start_time.as_deref().and_then(number).unwrap_or(0.0);
    let knows_fps_mode = answer.program_version.is_none_or(|version| knows_fps_mode(&version.version));
    Ok(Probed { codec, size, seconds, zero, begins, knows_fps_mode })
}

/// The program's answer; `None` if it fails or takes too long.
fn ask(programs: &Programs, input: &OsString) -> std::io::Result<Option<Vec<u8>>> {
    let mut command = Command::new(&programs.ffprobe);
    command.args(["-v", "quiet"]).args(bounds());
    command.args(["-select_streams", "V:0", "-show_program_version", "-show_entries"]).arg(
        "stream=codec_name,width,height:stream_tags=rotate:stream_side_data=rotation:format=start_time:\
         packet=pts_time,dts_time,flags",
    );
    command.args(["-of", "json=compact=1"]).arg(input);
    let (mut process, output) = Process::start(command)?;
    let (sender, answer) = channel();
    let reading = std::thread::Builder::new().name("video".to_owned()).spawn(move || {
        let mut bytes = Vec::new();
        let read = output.take(MAX_ANSWER_BYTES).read_to_end(&mut bytes);
        // Nobody waits any more where it took too long.
        let _told = sender.send(read.map(|_| bytes));
    })?;
    let bytes = answer.recv_timeout(PATIENCE);
    let whole = bytes.is_ok() && process.success();
    drop(process);
    // The pipe has ended with the program.
    let _ended = reading.join();
    Ok(bytes.ok().filter(|_| whole).and_then(Result::ok))
}

/// Frames' times in the order in which they are shown; frames that an edit list cuts off are left out.
fn times(packets: &[Packet]) -> Vec<f64> {
    let shown = packets.iter().filter(|packet| !packet.flags.contains('D'));
    let time = |packet: &Packet| packet.pts_time.as_deref().or(packet.dts_time.as_deref()).and_then(number);
    let mut times: Vec<f64> = shown.filter_map(time).collect();
    times.sort_by(f64::total_cmp);
    times
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// From "5.1.9-0+deb12u1" or "n6.0"; what is no number is a build of its own, and new.
fn knows_fps_mode(version: &str) -> bool {
    let mut parts = version.trim_start_matches('n').split(['.', '-']).map(str::parse::<u32>);
    match (parts.next(), parts.next()) {
        (Some(Ok(major)), Some(Ok(minor))) => (major, minor) >= (5, 1) || major > 100,
        (Some(Ok(major)), _) => major > 5,
        _ => true,
    }
}

/// A codec's name as people write it.
fn spoken(name: &str) -> String {
    match name {
        "h264" => "H.264".to_owned(),
        "mjpeg" => "Motion JPEG".to_owned(),
        "mpeg4" => "MPEG-4".to_owned(),
        name => name.to_uppercase(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_tell_how_frames_pass_through() {
        for (version, knows) in [
            ("5.1.9-0+deb12u1", true),
            ("n6.0", true),
            ("4.4.2-0ubuntu0.22.04.1", false),
            ("5.0", false),
            ("7", true),
            ("N-112233-gabc", true),
        ] {
            assert_eq!(knows_fps_mode(version), knows, "{version}");
        }
    }
}
