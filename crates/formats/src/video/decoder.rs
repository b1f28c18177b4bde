//! A video that we decode, and that `ffmpeg` decodes where it is installed and many pictures are to be decoded: in a third of the time,
//! and the same to the bit. What the two do not agree on, or `ffmpeg` finds damaged, is ours to decode.

use image::RgbImage;

use super::coded::Coded;
use super::ffmpeg::{Piped, Programs, Raw};
use super::{FrameRequest, Sink, VideoProblem};
use crate::{DiskFiles, TakeFiles};

/// Starting the program takes as long as decoding this many pictures here.
const START: usize = 12;
/// The decoders are compared in the frame that is shown this many after a key frame: it is made from others.
const COMPARED: usize = 3;

/// A video of our decoder, with the program's beside it.
#[derive(Debug)]
pub(super) struct FasterOfTwo {
    pub(super) coded: Coded,
    program: Program,
    /// Pictures that were decoded here for frames in order.
    spent: usize,
    /// The frame that was asked for last.
    last: usize,
}

/// Where the program stands.
#[derive(Debug)]
enum Program {
    /// Not asked yet.
    Waiting(Programs),
    /// A picture of it, reduced by this divisor, was ours.
    Running { piped: Box<Piped>, divisor: usize },
    /// It is not installed, or of another opinion.
    Unused,
}

impl FasterOfTwo {
    pub(super) fn new(coded: Coded, programs: Option<&Programs>) -> Self {
        let program = programs.cloned().map_or(Program::Unused, Program::Waiting);
        Self { coded, program, spent: 0, last: usize::MAX }
    }

    /// Pictures decoded so far.
    pub(super) fn decoded(&self) -> usize {
        let Program::Running { piped, .. } = &self.program else { return self.coded.decoded };
        self.coded.decoded + piped.decoded
    }

    /// A frame's picture. Others that are decoded on the way go to `sink`.
    pub(super) fn frame(
        &mut self,
        request: FrameRequest,
        sink: &mut Sink<'_>,
    ) -> Result<RgbImage, VideoProblem> {
        let follows = request.frame.checked_sub(1) == Some(std::mem::replace(&mut self.last, request.frame));
        let cost = self.coded.decodes_for(request.frame);
        self.spent = cost + if follows { self.spent } else { 0 };
        let comes = matches!(&self.program, Program::Running { piped, .. } if piped.comes_to(request));
        if !comes && self.spent < START {
            return self.coded.frame(request, sink);
        }
        let mut piped = match std::mem::replace(&mut self.program, Program::Unused) {
            Program::Unused => return self.coded.frame(request, sink),
            Program::Waiting(programs) => match self.piped(&programs) {
                Some(piped) => Box::new(piped),
                None => return self.coded.frame(request, sink),
            },
            Program::Running { mut piped, divisor } if divisor == request.divisor => {
                let Ok(picture) = piped.frame(request, sink) else { return self.coded.frame(request, sink) };
                self.program = Program::Running { piped, divisor };
                return Ok(picture);
            }
            Program::Running { piped, .. } => piped,
        };
        // Other sizes come by other code of the program: each is compared once, in a frame that is soon decoded here.
        let compared = match cost {
            ..=START => request,
            _ => FrameRequest { frame: self.coded.frame_after_key(request.frame, COMPARED), ..request },
        };
        let ours = self.coded.frame(compared, sink);
        let theirs = piped.frame(compared, &mut |_, _| ());
        if let (Ok(ours), Ok(theirs)) = (&ours, theirs)
            && *ours == theirs
        {
            self.program = Program::Running { piped, divisor: request.divisor };
        }
        // It is known now who decodes: a frame beside the request may be damaged, and the request not.
        if compared.frame == request.frame { ours } else { self.frame(request, sink) }
    }

    /// The video as the program sees it, if it sees the same frames in a file of the disk.
    fn piped(&self, programs: &Programs) -> Option<Piped> {
        let (path, index) = (self.coded.path()?, &self.coded.index);
        let raw =
            Raw::Planes { size: index.size, colour: self.coded.colour()?, orientation: index.orientation };
        let parts = DiskFiles.parts(path).ok()?;
        let piped = Piped::open(parts, path, None, Some(index), raw, programs).ok()?;
        let same = piped.probed.seconds.len() == index.frames.len()
            && piped.probed.size == index.orientation.size(index.size);
        same.then_some(piped)
    }
}
