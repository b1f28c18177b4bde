//! Which frames are on the screen, and where.

use egui::{Rangef, Rect};

/// Fewest frames between the two ends.
const LEAST: f64 = 4.0;

/// The frames on the screen: numbers of frames at the left and the right end, in between two frames while one
/// zooms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) first: f64,
    pub(crate) last: f64,
}

impl Span {
    pub(crate) fn whole(count: usize) -> Self {
        Self { first: 0.0, last: count.saturating_sub(1).max(1) as f64 }
    }

    /// Zoomed by a factor above 1, or out by one below, about a frame that stays in its place. `None` is all frames.
    pub(crate) fn zoomed(self, factor: f64, about: f64, count: usize) -> Option<Self> {
        let whole = Self::whole(count);
        let width = (self.last - self.first) / factor;
        if !width.is_finite() || width >= whole.last {
            return None;
        }
        let width = width.max(LEAST.min(whole.last));
        let share = (about - self.first) / (self.last - self.first);
        Some(Self { first: about - share * width, last: about + (1.0 - share) * width }.inside(whole))
    }

    pub(crate) fn moved(self, by: f64, count: usize) -> Self {
        Self { first: self.first + by, last: self.last + by }.inside(Self::whole(count))
    }

    /// Moved just so far that a frame is on the screen.
    pub(crate) fn containing(self, frame: usize, count: usize) -> Self {
        let frame = frame as f64;
        let by = (frame - self.last).max(0.0) + (frame - self.first).min(0.0);
        self.moved(by, count)
    }

    fn inside(self, whole: Self) -> Self {
        let by = (whole.first - self.first).max(0.0) + (whole.last - self.last).min(0.0);
        Self { first: self.first + by, last: self.last + by }
    }

    /// The frames that lie on the screen, both ends included.
    pub(crate) fn frames(self, count: usize) -> std::ops::RangeInclusive<usize> {
        let last = count.saturating_sub(1);
        (self.first.floor().max(0.0) as usize).min(last)..=(self.last.ceil().max(0.0) as usize).min(last)
    }
}

/// The part of the timeline that frames fill, and which of them are there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimeScale {
    pub(crate) span: Span,
    pub(crate) plot: Rect,
    /// Frames of the take.
    pub(crate) count: usize,
}

impl TimeScale {
    fn across(&self) -> Rangef {
        self.plot.x_range()
    }

    /// The frames that lie on the screen, both ends included.
    pub(crate) fn frames(&self) -> std::ops::RangeInclusive<usize> {
        self.span.frames(self.count)
    }

    pub(crate) fn x(&self, frame: f64) -> f32 {
        let share = (frame - self.span.first) / (self.span.last - self.span.first);
        self.across().min + self.across().span() * share as f32
    }

    /// The frame at a place, in between two frames as a rule.
    pub(crate) fn at(&self, x: f32) -> f64 {
        let share = f64::from((x - self.across().min) / self.across().span().max(1.0));
        self.span.first + share * (self.span.last - self.span.first)
    }

    pub(crate) fn frame_at(&self, x: f32) -> usize {
        let x = x.clamp(self.across().min, self.across().max);
        (self.at(x).round().max(0.0) as usize).min(self.count.saturating_sub(1))
    }

    /// Points from one frame to the next.
    pub(crate) fn step(&self) -> f32 {
        self.across().span() / (self.span.last - self.span.first) as f32
    }
}

#[cfg(test)]
mod tests {
    use egui::{pos2, vec2};

    use super::*;

    #[test]
    fn the_frame_under_the_pointer_stays_while_one_zooms() {
        let area = Rect::from_min_size(pos2(100.0, 0.0), vec2(1000.0, 50.0));
        let whole = Span::whole(5001);
        let scale = |span| TimeScale { span, plot: area, count: 5001 };
        let x = scale(whole).x(2000.0);
        let zoomed = whole.zoomed(10.0, 2000.0, 5001).unwrap();
        assert!((zoomed.last - zoomed.first - 500.0).abs() < 1e-9);
        assert!((scale(zoomed).x(2000.0) - x).abs() < 1e-3);
        assert_eq!(scale(zoomed).frame_at(x), 2000);
        assert_eq!(zoomed.zoomed(0.1, 2000.0, 5001), None, "out again is everything");
    }

    #[test]
    fn nothing_lies_outside_the_take() {
        let near_end = Span::whole(101).zoomed(5.0, 99.0, 101).unwrap();
        assert_eq!(near_end.last, 99.0 + 0.2);
        assert_eq!(near_end.moved(50.0, 101).last, 100.0);
        assert_eq!(near_end.moved(-500.0, 101).first, 0.0);
        assert_eq!(near_end.containing(3, 101), Span { first: 3.0, last: 23.0 });
        assert_eq!(near_end.containing(90, 101), near_end);
        let closest = near_end.zoomed(1e9, 90.0, 101).unwrap();
        assert!((closest.last - closest.first - LEAST).abs() < 1e-9);
        assert_eq!(Span::whole(1), Span { first: 0.0, last: 1.0 });
        assert_eq!(Span::whole(1).frames(1), 0..=0);
        assert_eq!(Span::whole(3).zoomed(2.0, 1.0, 3).unwrap(), Span::whole(3), "few frames are not zoomed");
    }
}
