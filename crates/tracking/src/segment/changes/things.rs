//! What stands still, put together to things: seeds that begin together, and what belongs to them.

use image::RgbImage;

use super::still::{Run, StillPixel, StillPixels, is_same};
use super::{ChangeKind, LearntPixels};
use crate::segment::Background;

/// A thing covers this share of the picture or more.
const LEAST_SHARE: f64 = 0.004;
/// A thing is there as long as this share of its pixels is seen now and then.
const STILL_THERE: f64 = 0.2;
/// Beside a body is what touches it along more than this share of its border.
const BESIDE_BODY: f64 = 0.05;
/// A camera tells of no more things.
const MOST_THINGS: usize = 8;
/// A knock shifts a picture by no more than this share of its longer side.
const MOST_SHIFT: f64 = 1.0 / 24.0;
/// A knock changes this share of the picture or more; that share of it is then explained by a shift.
const KNOCK_SHARE: f64 = 0.04;
const EXPLAINED: f64 = 0.6;

/// Something that stands still before a camera.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StandingThing {
    /// A thing or a knock.
    pub kind: ChangeKind,
    /// The first sample in which it is there.
    pub first: usize,
    /// The last one; `None` where it stays.
    pub last: Option<usize>,
    /// Its pixels.
    pub pixels: LearntPixels,
}

impl StandingThing {
    /// The share of its pixels, 0 to 1, that a picture of the same size shows.
    #[must_use]
    pub fn shown_in(&self, picture: &RgbImage) -> f64 {
        let colours = picture.as_raw().as_chunks::<3>().0;
        let is_shown =
            |&(pixel, level): &(usize, [u8; 3])| colours.get(pixel).is_some_and(|at| is_same(*at, level));
        self.pixels.iter().filter(is_shown).count() as f64 / self.pixels.len().max(1) as f64
    }
}

impl StillPixels {
    /// What stands still and is not of the background, in the order of the samples in which it begins.
    #[must_use]
    pub fn things(&self, background: &Background) -> Vec<StandingThing> {
        let least = (LEAST_SHARE * self.pixels.len() as f64).ceil() as usize;
        let mut is_free: Vec<bool> = self.pixels.iter().map(|pixel| pixel.held.is_lasting()).collect();
        let mut things = Vec::new();
        while things.len() < MOST_THINGS {
            let mut begun = [0; Self::MOST_SAMPLES + 1];
            for (pixel, _) in
                self.pixels.iter().zip(&is_free).filter(|(pixel, is_free)| **is_free && pixel.held.is_seed())
            {
                begun[usize::from(pixel.held.first)] += 1;
            }
            let together = begun.windows(2).map(|pair| (pair[0] + pair[1], pair[0]));
            // Of equals the earliest.
            let best = together.enumerate().max_by_key(|&(at, counts)| (counts, usize::MAX - at));
            let Some((first, (count, _))) = best else { break };
            if count < least {
                break;
            }
            let pixels = self.grown(first as u8, &mut is_free);
            things.push(self.thing(first, &pixels, background));
        }
        things.sort_by_key(|thing| thing.first);
        things
    }

    /// The seeds that begin with this sample or the next, and what belongs to them; in the order of the rows.
    fn grown(&self, first: u8, is_free: &mut [bool]) -> Vec<usize> {
        let is_with = |held: &Run| (first..=first + 1).contains(&held.first);
        let is_one = |held: &Run| held.is_seed() && is_with(held);
        let mut waiting: Vec<usize> = (0..self.pixels.len())
            .filter(|&pixel| is_free[pixel] && is_one(&self.pixels[pixel].held))
            .collect();
        let mut found = Vec::new();
        let [width, height] = self.size;
        while let Some(pixel) = waiting.pop() {
            if !std::mem::replace(&mut is_free[pixel], false) {
                continue;
            }
            found.push(pixel);
            let (x, y) = (pixel % width, pixel / width);
            for y in y.saturating_sub(1)..=(y + 1).min(height - 1) {
                for x in x.saturating_sub(1)..=(x + 1).min(width - 1) {
                    let next = y * width + x;
                    let held = &self.pixels[next].held;
                    // From the first sample on, a body that stands still begins with everything.
                    let belongs = (held.is_seed() && held.first >= first) || (first > 0 && is_with(held));
                    if is_free[next] && belongs {
                        waiting.push(next);
                    }
                }
            }
        }
        found.sort_unstable();
        found
    }

    fn thing(&self, first: usize, pixels: &[usize], background: &Background) -> StandingThing {
        let mut ends: Vec<u8> = pixels.iter().map(|&pixel| self.pixels[pixel].held.last).collect();
        ends.sort_unstable();
        let last = usize::from(ends[((1.0 - STILL_THERE) * (ends.len() - 1) as f64) as usize]);
        let is_beside_body = self.is_beside_body(pixels, first as u32, last as u32);
        let level = |&pixel: &usize| {
            let StillPixel { held, hides, is_hidden, .. } = &self.pixels[pixel];
            (pixel, held.level(), !is_beside_body && (*hides == 0 || hides < is_hidden))
        };
        let kind = if self.is_shifted(pixels, background) { ChangeKind::Knock } else { ChangeKind::Thing };
        StandingThing {
            kind,
            first,
            last: (last + 2 < usize::from(self.samples)).then_some(last),
            pixels: LearntPixels::new(pixels.iter().map(level)),
        }
    }

    /// Whether the body is beside these pixels in half of the samples from one to another, along a part of their border: a leg that a
    /// table hides from all other cameras stands still too.
    fn is_beside_body(&self, pixels: &[usize], first: u32, last: u32) -> bool {
        let [width, height] = self.size;
        let mut is_inside = vec![false; self.pixels.len()];
        pixels.iter().for_each(|&pixel| is_inside[pixel] = true);
        let reach = (width.max(height) / 120).max(1);
        let now = u64::MAX << first & u64::MAX >> (u64::BITS - 1 - last);
        let (mut border, mut beside) = (0_u32, 0);
        for &pixel in pixels {
            let (x, y) = (pixel % width, pixel / width);
            let at = [
                (x.checked_sub(reach), Some(y)),
                (Some(x + reach).filter(|x| *x < width), Some(y)),
                (Some(x), y.checked_sub(reach)),
                (Some(x), Some(y + reach).filter(|y| *y < height)),
            ];
            for outside in
                at.into_iter().filter_map(|(x, y)| Some(y? * width + x?)).filter(|&at| !is_inside[at])
            {
                border += 1;
                beside += u32::from(2 * (self.pixels[outside].body & now).count_ones() >= last + 1 - first);
            }
        }
        f64::from(beside) > BESIDE_BODY * f64::from(border)
    }

    /// Whether these pixels show what the background has elsewhere, all as far away and in one direction.
    fn is_shifted(&self, pixels: &[usize], background: &Background) -> bool {
        let [width, height] = self.size;
        if (pixels.len() as f64) < KNOCK_SHARE * self.pixels.len() as f64 {
            return false;
        }
        let stride = pixels.len().div_ceil(2000);
        let looked: Vec<usize> = pixels.iter().copied().step_by(stride).collect();
        let most = (MOST_SHIFT * width.max(height) as f64) as i64;
        let explained = |dx: i64, dy: i64| {
            let shows = |pixel: &&usize| {
                let (x, y) = ((**pixel % width) as i64 - dx, (**pixel / width) as i64 - dy);
                if !(0..width as i64).contains(&x) || !(0..height as i64).contains(&y) {
                    return false;
                }
                let mean = background.mean()[y as usize * width + x as usize];
                is_same(self.pixels[**pixel].held.level(), mean.map(|level| level.round() as u8))
            };
            looked.iter().filter(shows).count()
        };
        let shifts = (-most..=most).flat_map(|dx| (-most..=most).map(move |dy| [dx, dy]));
        let best = shifts.map(|[dx, dy]| explained(dx, dy)).max().unwrap_or(0);
        best as f64 >= EXPLAINED * looked.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;
    use crate::silhouette::{Label, Mask};

    const SIZE: [usize; 2] = [80, 60];
    const SAMPLES: usize = 20;
    const BODY: Rgb<u8> = Rgb([30, 30, 200]);

    fn wall(x: u32, y: u32) -> Rgb<u8> {
        Rgb([100 + (3 * x % 40) as u8, 120 + (5 * y % 30) as u8, 110])
    }

    fn chequered(x: u32, y: u32) -> Rgb<u8> {
        if (x / 3 + y / 3).is_multiple_of(2) { Rgb([214, 60, 60]) } else { Rgb([230, 220, 20]) }
    }

    fn is_patch(x: usize, y: usize) -> bool {
        (10..26).contains(&x) && (20..44).contains(&y)
    }

    /// A body that goes across the picture, there and back.
    fn is_body(sample: usize, x: usize, y: usize) -> bool {
        let left = if sample <= 10 { 6 * sample } else { 6 * (20 - sample) };
        (left..left + 14).contains(&x) && (8..56).contains(&y)
    }

    /// Looks at all samples: the patch is in `shown`, and before the body if it `hides`.
    fn survey(
        shown: std::ops::Range<usize>,
        hides: bool,
        body: impl Fn(usize, usize, usize) -> bool,
    ) -> Vec<StandingThing> {
        let plate = RgbImage::from_fn(SIZE[0] as u32, SIZE[1] as u32, wall);
        let mut still = StillPixels::new(SIZE);
        for sample in 0..SAMPLES {
            let patch = |x: usize, y: usize| shown.contains(&sample) && is_patch(x, y);
            let picture = RgbImage::from_fn(SIZE[0] as u32, SIZE[1] as u32, |x, y| {
                let (is_patch, is_body) =
                    (patch(x as usize, y as usize), body(sample, x as usize, y as usize));
                match (is_patch && (hides || !is_body), is_body) {
                    (true, _) => chequered(x, y),
                    (_, true) => BODY,
                    _ => wall(x, y),
                }
            });
            let mask = |unsupported: Label| {
                let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
                let label = |(x, y)| match (body(sample, x, y), patch(x, y)) {
                    (true, _) => Label::Subject,
                    (_, true) => unsupported,
                    _ => Label::Background,
                };
                Mask::new(SIZE[0], SIZE[1], pixels.map(label).collect()).unwrap()
            };
            still.add(&picture, &mask(Label::Subject), &mask(Label::Unknown));
        }
        still.things(&Background::from_plate(&plate))
    }

    fn pixels() -> usize {
        16 * 24
    }

    #[test]
    fn what_stands_still_is_learnt_from_where_it_came_to_where_it_went() {
        for (shown, last) in [(4..SAMPLES, None), (4..15, Some(14)), (0..SAMPLES, None)] {
            let found = survey(shown.clone(), false, is_body);
            let [thing] = &found[..] else { panic!("{shown:?}: {} things", found.len()) };
            assert_eq!(
                (thing.kind, thing.first, thing.last),
                (ChangeKind::Thing, shown.start, last),
                "{shown:?}"
            );
            // The body is before some of it at first.
            assert!(thing.pixels.len() * 10 > 9 * pixels(), "{shown:?}: {} pixels", thing.pixels.len());
            for (pixel, level) in thing.pixels.iter() {
                let (x, y) = (pixel % SIZE[0], pixel / SIZE[0]);
                assert!(is_patch(x, y));
                assert_eq!(level, chequered(x as u32, y as u32).0, "{x} {y}");
            }
            let unsure = thing.pixels.unsure().count();
            assert!(unsure * 10 < thing.pixels.len(), "{shown:?}: {unsure}");
        }
    }

    #[test]
    fn what_may_hide_the_body_is_unsure() {
        let found = survey(4..SAMPLES, true, is_body);
        let [thing] = &found[..] else { panic!("{} things", found.len()) };
        assert_eq!(thing.pixels.len(), pixels());
        assert_eq!(thing.pixels.unsure().count(), pixels(), "the body goes behind all of it");
    }

    /// Legs that no other camera sees stand as still as a chair.
    #[test]
    fn what_touches_the_body_is_unsure() {
        let found = survey(4..SAMPLES, false, |_, x, y| (10..26).contains(&x) && (4..20).contains(&y));
        let [thing] = &found[..] else { panic!("{} things", found.len()) };
        assert_eq!([thing.pixels.len(), thing.pixels.unsure().count()], [pixels(); 2]);
    }

    #[test]
    fn without_a_thing_nothing_is_learnt() {
        let stands = |_, x, y| is_body(5, x, y);
        assert_eq!(survey(0..0, false, is_body), []);
        assert_eq!(survey(0..0, false, stands), []);
        // Too short to tell.
        assert_eq!(survey(9..12, false, is_body), []);
    }

    #[test]
    fn a_knock_is_told_from_a_thing() {
        let plate = RgbImage::from_fn(80, 60, |x, y| {
            Rgb([(x * 37 % 200) as u8, (y * 53 % 200) as u8, ((x / 7 * 61 + y / 5 * 41) % 255) as u8])
        });
        let shifted =
            |shift: u32| RgbImage::from_fn(80, 60, |x, y| *plate.get_pixel(x.saturating_sub(shift), y));
        let mut still = StillPixels::new(SIZE);
        for sample in 0..SAMPLES {
            let is_off = sample >= 8;
            let label = |unsupported| if is_off { unsupported } else { Label::Background };
            let mask = |unsupported| Mask::filled(SIZE[0], SIZE[1], label(unsupported)).unwrap();
            still.add(&shifted(if is_off { 2 } else { 0 }), &mask(Label::Subject), &mask(Label::Unknown));
        }
        let found = still.things(&Background::from_plate(&plate));
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].kind, found[0].first), (ChangeKind::Knock, 8));
    }
}
