//! Videos by the programs `ffprobe` (what is in the file) and `ffmpeg` (its pictures, raw through a pipe).
//!
//! The programs get the file's path as one argument of its own, never a shell, and may open nothing else: no playlist,
//! no network. They are killed when the video is dropped, when they stand still, and end by themselves when the pipe
//! does.

use std::ffi::OsString;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use image::RgbImage;
use tempfile::NamedTempFile;

use super::index::Index;
use super::orientation::Orientation;
use super::probe::{self, Probed};
use super::yuv::{Colour, Planes};
use super::{FrameRequest, Sink, VideoProblem};
use crate::files::FileParts;
use crate::images::reduced;

/// A program that gives nothing for so long is stopped.
pub(super) const PATIENCE: Duration = Duration::from_secs(60);
/// Frames that the program may be ahead.
const AHEAD: usize = 2;
/// Frames that are rather read and thrown away than looked up again.
const MAX_SKIPPED: usize = 48;
/// Containers that the programs may read: none that names other files.
const FORMATS: &str = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,ogg,flv,asf";

/// The two programs.
#[derive(Debug, Clone)]
pub(super) struct Programs {
    pub(super) ffmpeg: OsString,
    pub(super) ffprobe: OsString,
}

impl Default for Programs {
    fn default() -> Self {
        Self { ffmpeg: "ffmpeg".into(), ffprobe: "ffprobe".into() }
    }
}

/// How pictures come through the pipe.
#[derive(Debug, Clone, Copy)]
pub(super) enum Raw {
    /// RGB, turned as the file says.
    Rgb,
    /// The decoder's own planes with 2 × 2 luma samples a chroma sample; a picture that is damaged ends the pipe.
    Planes { size: [usize; 2], colour: Colour, orientation: Orientation },
}

impl Raw {
    fn options(self) -> &'static [&'static str] {
        match self {
            Self::Rgb => &[],
            Self::Planes { .. } => &["-threads", "1", "-noautorotate", "-xerror", "-err_detect", "explode"],
        }
    }

    /// How many times smaller the program makes the pictures, so that fewer bytes go through the pipe. It averages planes as
    /// [`Planes::picture`] does, to the bit, where the divisor fits the size.
    fn reduction(self, divisor: usize) -> usize {
        match self {
            Self::Planes { size, .. }
                if divisor.is_multiple_of(2) && size.iter().all(|side| side.is_multiple_of(divisor)) =>
            {
                divisor
            }
            _ => 1,
        }
    }

    /// Tells the program how pictures are written.
    fn output(self, reduction: usize, command: &mut Command) {
        let pixels = match self {
            Self::Rgb => "rgb24",
            Self::Planes { size, colour, .. } if reduction > 1 => {
                let [width, height] = size.map(|side| side / reduction);
                let scale = format!("scale={width}:{height}:flags=area+accurate_rnd+bitexact");
                command.args(["-filter_threads", "1", "-vf", &scale]);
                // Chroma is then as large as luma.
                if colour.full_range { "yuvj444p" } else { "yuv444p" }
            }
            Self::Planes { colour: Colour { full_range: true, .. }, .. } => "yuvj420p",
            Self::Planes { .. } => "yuv420p",
        };
        command.args(["-pix_fmt", pixels, "-f", "rawvideo", "pipe:1"]);
    }

    /// Bytes of a picture that is `shown` with this size.
    fn bytes(self, shown: [usize; 2], reduction: usize) -> usize {
        match self {
            Self::Rgb => shown.iter().product::<usize>() * 3,
            Self::Planes { size: [width, height], .. } if reduction == 1 => {
                width * height + 2 * width.div_ceil(2) * height.div_ceil(2)
            }
            Self::Planes { size, .. } => 3 * size.iter().map(|side| side / reduction).product::<usize>(),
        }
    }

    fn picture(
        self,
        bytes: Vec<u8>,
        shown: [usize; 2],
        divisor: usize,
        reduction: usize,
    ) -> Result<RgbImage, String> {
        match self {
            Self::Rgb => {
                let [width, height] = shown.map(|side| side as u32);
                Ok(reduced(RgbImage::from_raw(width, height, bytes).unwrap_or_default(), divisor))
            }
            Self::Planes { size, colour, orientation } => {
                let size = size.map(|side| side / reduction);
                let mut luma = bytes;
                let mut first = luma.split_off(size[0] * size[1]);
                let second = first.split_off(first.len() / 2);
                let shift = if reduction == 1 { [1; 2] } else { [0; 2] };
                let planes = Planes { size, planes: [luma, first, second], shift, colour };
                if planes.is_sound() {
                    Ok(planes.picture(orientation, divisor / reduction))
                } else {
                    Err("its planes have other sizes".to_owned())
                }
            }
        }
    }
}

/// A video that `ffmpeg` decodes.
#[derive(Debug)]
pub(super) struct Piped {
    programs: Programs,
    input: OsString,
    raw: Raw,
    pub(super) probed: Probed,
    pub(super) notes: Vec<String>,
    running: Option<FfmpegOutput>,
    /// Frames that came through pipes.
    pub(super) decoded: usize,
    /// The file, where the video was in memory only.
    _file: Option<NamedTempFile>,
}

impl Piped {
    /// Asks `ffprobe`. What our own index knows to be missing is left out.
    pub(super) fn open(
        parts: FileParts,
        path: &Path,
        codec: Option<String>,
        index: Option<&Index>,
        raw: Raw,
        programs: &Programs,
    ) -> Result<Self, VideoProblem> {
        let failed = |error| VideoProblem::Read { error };
        let (file, path) = match parts.memory() {
            None => (None, std::path::absolute(path).map_err(failed)?),
            Some(bytes) => {
                let mut file = NamedTempFile::new().map_err(failed)?;
                file.write_all(bytes).map_err(failed)?;
                let path = file.path().to_owned();
                (Some(file), path)
            }
        };
        let input = input(path);
        let codec = codec.unwrap_or_else(|| "in a format that Backlit does not decode".to_owned());
        let mut probed = probe::probe(programs, &input, &codec)?;
        let mut notes = Vec::new();
        if let Some(index) = index {
            // Our own index knows what is cut off, and when the first frame is shown.
            probed.seconds.truncate(index.frames.len());
            let begins = index.frames.first().map_or(0.0, |frame| frame.seconds);
            probed.seconds.iter_mut().for_each(|seconds| *seconds += begins);
            probed.zero -= begins;
            notes.clone_from(&index.notes);
        }
        Ok(Self {
            programs: programs.clone(),
            input,
            raw,
            probed,
            notes,
            running: None,
            decoded: 0,
            _file: file,
        })
    }

    /// Whether the program runs, and will soon have this frame in this size.
    pub(super) fn comes_to(&self, request: FrameRequest) -> bool {
        self.running.as_ref().is_some_and(|running| {
            running.reduction == self.raw.reduction(request.divisor)
                && (running.next..=running.next + MAX_SKIPPED).contains(&request.frame)
        })
    }

    pub(super) fn frame(
        &mut self,
        request: FrameRequest,
        sink: &mut Sink<'_>,
    ) -> Result<RgbImage, VideoProblem> {
        let comes = self.comes_to(request);
        let mut running = match self.running.take() {
            Some(running) if comes => running,
            _ => self.start(request)?,
        };
        let reduction = running.reduction;
        let failed = |reason| VideoProblem::Frame { frame: request.frame, reason };
        loop {
            let frame = running.next;
            let bytes = running.read().map_err(failed)?;
            self.decoded += 1;
            let picture =
                |bytes| self.raw.picture(bytes, self.probed.size, request.divisor, reduction).map_err(failed);
            if frame == request.frame {
                let picture = picture(bytes)?;
                self.running = Some(running);
                return Ok(picture);
            }
            if frame >= request.keep_from {
                sink(frame, picture(bytes)?);
            }
        }
    }

    /// Starts `ffmpeg` so that the frame comes first: it decodes from the key before and leaves out what is shown before
    /// the time given, here halfway between the frame and the one before it.
    fn start(&self, FrameRequest { frame, divisor, .. }: FrameRequest) -> Result<FfmpegOutput, VideoProblem> {
        let reduction = self.raw.reduction(divisor);
        let mut command = Command::new(&self.programs.ffmpeg);
        command.args(["-nostdin", "-v", "quiet"]).args(bounds()).args(self.raw.options());
        if frame > 0 {
            let seconds = &self.probed.seconds;
            let from = (seconds[frame - 1] + seconds[frame]) / 2.0 + self.probed.zero - self.probed.begins;
            command.args(["-ss", &format!("{:.6}", from.max(0.0))]);
        }
        command.arg("-i").arg(&self.input).args(["-map", "0:V:0"]);
        command.args(if self.probed.knows_fps_mode { ["-fps_mode", "passthrough"] } else { ["-vsync", "0"] });
        self.raw.output(reduction, &mut command);
        let bytes = self.raw.bytes(self.probed.size, reduction);
        FfmpegOutput::new(command, bytes, reduction, frame)
            .map_err(|error| missing(&self.programs.ffmpeg, &self.probed.codec, error))
    }
}

/// What keeps the programs to the one file.
pub(super) fn bounds() -> [&'static str; 4] {
    ["-protocol_whitelist", "file", "-format_whitelist", FORMATS]
}

/// A program that cannot be started.
pub(super) fn missing(program: &OsString, codec: &str, error: std::io::Error) -> VideoProblem {
    let (codec, program) = (codec.to_owned(), program.to_string_lossy().into_owned());
    match error.kind() {
        std::io::ErrorKind::NotFound => VideoProblem::NeedsProgram { codec, program },
        _ => VideoProblem::Program { codec, program, message: crate::reason(&error) },
    }
}

/// The path as the programs take it: a file, whatever its name looks like.
fn input(path: PathBuf) -> OsString {
    let mut input = OsString::from("file:");
    input.push(path);
    input
}

/// A program that writes to a pipe. Killed and waited for when dropped.
#[derive(Debug)]
pub(super) struct Process(Child);

impl Process {
    /// Starts it with nothing to read; what it complains of is thrown away.
    pub(super) fn start(mut command: Command) -> std::io::Result<(Self, impl Read + Send + 'static)> {
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn()?;
        let output = child.stdout.take();
        let process = Self(child);
        output.map(|output| (process, output)).ok_or_else(|| std::io::Error::other("no pipe"))
    }

    /// Waits for its end.
    pub(super) fn success(&mut self) -> bool {
        self.0.wait().is_ok_and(|status| status.success())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended already.
        let _ended = self.0.kill();
        let _waited = self.0.wait();
    }
}

/// A running `ffmpeg` and the thread that reads its pipe, a few frames ahead.
#[derive(Debug)]
struct FfmpegOutput {
    /// The frame that comes next.
    next: usize,
    /// How many times smaller its pictures are.
    reduction: usize,
    frames: Option<Receiver<Vec<u8>>>,
    process: Option<Process>,
    thread: Option<JoinHandle<()>>,
}

impl FfmpegOutput {
    fn new(command: Command, bytes: usize, reduction: usize, next: usize) -> std::io::Result<Self> {
        let (process, mut output) = Process::start(command)?;
        let (sender, frames) = sync_channel(AHEAD);
        let thread = std::thread::Builder::new().name("video".to_owned()).spawn(move || {
            loop {
                let mut frame = vec![0; bytes];
                if output.read_exact(&mut frame).is_err() || sender.send(frame).is_err() {
                    return;
                }
            }
        })?;
        Ok(Self { next, reduction, frames: Some(frames), process: Some(process), thread: Some(thread) })
    }

    fn read(&mut self) -> Result<Vec<u8>, String> {
        let Some(frames) = &self.frames else { return Err("ffmpeg has ended".to_owned()) };
        match frames.recv_timeout(PATIENCE) {
            Ok(frame) => {
                self.next += 1;
                Ok(frame)
            }
            Err(RecvTimeoutError::Timeout) => {
                Err(format!("ffmpeg gave nothing for {} s", PATIENCE.as_secs()))
            }
            Err(RecvTimeoutError::Disconnected) => Err("ffmpeg gives no picture for it".to_owned()),
        }
    }
}

impl Drop for FfmpegOutput {
    fn drop(&mut self) {
        // The program ends, so the thread's pipe does; without a receiver it does not wait either.
        self.process = None;
        self.frames = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing to tell.
            let _ended = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::video::Video;

    /// An AVI file with one picture of some bytes, of a coding by its four letters.
    fn avi(letters: &[u8; 4]) -> Vec<u8> {
        let chunk = |kind: &[u8], body: &[u8]| [kind, &(body.len() as u32).to_le_bytes(), body].concat();
        let strh = [&b"vids"[..], letters, &[1; 48]].concat();
        let strf = [&[8; 16][..], letters, &[0; 20]].concat();
        let strl = [&b"strl"[..], &chunk(b"strh", &strh), &chunk(b"strf", &strf)].concat();
        let hdrl = [&b"hdrl"[..], &chunk(b"LIST", &strl)].concat();
        let movi = [&b"movi"[..], &chunk(b"00dc", &[7; 16])].concat();
        chunk(b"RIFF", &[&b"AVI "[..], &chunk(b"LIST", &hdrl), &chunk(b"LIST", &movi)].concat())
    }

    #[test]
    fn a_program_that_is_not_there_is_asked_for() {
        let missing = Programs { ffmpeg: "no-such-ffmpeg".into(), ffprobe: "no-such-ffprobe".into() };
        let message = |letters: &[u8; 4]| {
            let parts = FileParts::in_memory(avi(letters));
            Video::with_programs(parts, Path::new("v"), Arc::default(), Some(&missing))
                .unwrap_err()
                .to_string()
        };
        for (letters, codec) in [(b"VP90", "VP9"), (b"HEVC", "HEVC"), (b"AV01", "AV1"), (b"abcd", "\"abcd\"")]
        {
            let expected =
                format!("the video is {codec}, which needs the program no-such-ffprobe; install it");
            assert!(message(letters).contains(&expected), "{}", message(letters));
        }
        // So does H.264 that we cannot decode; what is wrong stands beside it.
        let found = message(b"H264");
        assert!(found.contains("the video is H.264 (avcC: too short), which needs"), "{found}");
    }

    #[test]
    fn a_program_that_stands_still_is_ended() {
        // Any program that would run for long will do.
        let mut command = Command::new("sleep");
        command.arg("1000");
        let Ok(running) = FfmpegOutput::new(command, 3, 1, 0) else { return };
        let before = std::time::Instant::now();
        drop(running);
        assert!(before.elapsed() < Duration::from_secs(10));
    }
}
