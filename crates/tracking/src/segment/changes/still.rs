//! What stands still before a camera although no other camera sees it, learnt from sampled frames one after the other.
//!
//! A *run* of a pixel are the samples in which it is subject and shows one colour, whatever hides it in between. A pixel whose run is
//! mostly unsupported by the other cameras is a seed. Seeds that begin together are a thing, with the pixels beside them that begin
//! with them too: there the other cameras see the body before it, behind it, or where they cannot tell.

use image::RgbImage;

use crate::silhouette::{Label, Mask};

/// Levels of a channel so far apart are of one colour, grey levels.
const SAME: u8 = 14;
/// The number of samples from which on a run counts.
const FEWEST_SEEN: u8 = 5;
/// The share of samples that may have missed it, as one in this number.
const MISSED_IN: u8 = 4;

/// The samples in which a pixel showed one colour.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Run {
    pub(super) sum: [u16; 3],
    pub(super) seen: u8,
    /// In how many of them no other camera saw it.
    pub(super) unsupported: u8,
    pub(super) first: u8,
    pub(super) last: u8,
    /// In how many samples between the first and the last it was not seen although no body was before it.
    pub(super) missed: u8,
    /// In how many samples since the last one a body was before it.
    pub(super) hidden: u8,
}

impl Run {
    pub(super) fn level(&self) -> [u8; 3] {
        let seen = u16::from(self.seen).max(1);
        self.sum.map(|sum| ((sum + seen / 2) / seen) as u8)
    }

    fn is_like(&self, colour: [u8; 3]) -> bool {
        self.seen > 0 && is_same(self.level(), colour)
    }

    fn add(&mut self, colour: [u8; 3], sample: u8) {
        for (sum, level) in self.sum.iter_mut().zip(colour) {
            *sum += u16::from(level);
        }
        self.missed += (sample - self.last).saturating_sub(1 + self.hidden);
        (self.seen, self.last, self.hidden) = (self.seen + 1, sample, 0);
    }

    pub(super) const fn is_lasting(&self) -> bool {
        self.seen >= FEWEST_SEEN && MISSED_IN * self.missed <= self.seen
    }

    pub(super) const fn is_seed(&self) -> bool {
        self.is_lasting() && 2 * self.unsupported as u16 >= self.seen as u16
    }
}

pub(super) fn is_same(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= SAME)
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StillPixel {
    /// The longest run, first by how often no other camera saw it.
    pub(super) held: Run,
    pub(super) newest: Run,
    /// In how many samples since the held run began the other cameras saw the body here, and the pixel showed the run or something else.
    pub(super) hides: u8,
    pub(super) is_hidden: u8,
    /// In which samples they saw the body here, a bit each.
    pub(super) body: u64,
}

/// What was seen of one camera so far.
#[derive(Debug)]
pub struct StillPixels {
    pub(super) size: [usize; 2],
    pub(super) pixels: Vec<StillPixel>,
    pub(super) samples: u8,
}

impl StillPixels {
    /// No more samples than this count.
    pub const MOST_SAMPLES: usize = 64;

    /// Nothing yet, of pictures so wide and high.
    #[must_use]
    pub fn new(size @ [width, height]: [usize; 2]) -> Self {
        Self { size, pixels: vec![StillPixel::default(); width * height], samples: 0 }
    }

    /// Looks at the next sample: its picture, its mask as if there were no other camera, and the same where subject that no other
    /// camera supports is unknown. What is of another size is left out.
    pub fn add(&mut self, picture: &RgbImage, single: &Mask, supported: &Mask) {
        let sizes = [(single.width(), single.height()), (supported.width(), supported.height())];
        let is_ours = sizes == [(self.size[0], self.size[1]); 2] && picture.len() == 3 * self.pixels.len();
        if !is_ours || usize::from(self.samples) >= Self::MOST_SAMPLES {
            return;
        }
        let (sample, colours) = (self.samples, picture.as_raw().as_chunks::<3>().0);
        self.samples += 1;
        let labels = single.labels().iter().zip(supported.labels());
        for ((pixel, &colour), (single, supported)) in self.pixels.iter_mut().zip(colours).zip(labels) {
            if *single != Label::Subject {
                continue;
            }
            let is_supported = *supported == Label::Subject;
            let StillPixel { held, newest, hides, is_hidden, body } = pixel;
            *body |= u64::from(is_supported) << sample;
            let is_held = held.is_like(colour);
            if is_supported && held.seen > 0 {
                *(if is_held { hides } else { is_hidden }) += 1;
            }
            if !is_held && !newest.is_like(colour) {
                *newest = Run { first: sample, last: sample, ..Run::default() };
            }
            if is_supported {
                *(if is_held { &mut newest.hidden } else { &mut held.hidden }) += 1;
            }
            let run = if is_held { &mut *held } else { &mut *newest };
            run.add(colour, sample);
            run.unsupported += u8::from(!is_supported);
            if (newest.unsupported, newest.seen) > (held.unsupported, held.seen) {
                *pixel = StillPixel { held: *newest, newest: *held, hides: 0, is_hidden: 0, body: *body };
            }
        }
    }
}
