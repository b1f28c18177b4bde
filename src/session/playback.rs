//! Playing frames: speed, loop, and the frame that is due at a time.
//!
//! Playing keeps time: frames whose pictures come too late are left out. It waits only for the first picture.

/// Speeds that are offered, as multiples of the take's own.
pub(crate) const SPEEDS: [f64; 7] = [0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0];

/// Frames from one to another, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FrameRange {
    pub(crate) first: usize,
    pub(crate) last: usize,
}

impl FrameRange {
    /// The range between two frames, whichever is the earlier.
    pub(crate) fn between(a: usize, b: usize) -> Self {
        Self { first: a.min(b), last: a.max(b) }
    }

    pub(crate) fn count(self) -> usize {
        self.last - self.first + 1
    }
}

/// How frames are played. Nothing here is saved or undone.
#[derive(Debug, Clone)]
pub struct Playback {
    /// Multiple of the take's own speed.
    pub(crate) speed: f64,
    /// Whether it begins again at the end.
    pub(crate) loops: bool,
    /// The frames that were marked: they are what is played and what can be cleared.
    pub(crate) range: Option<FrameRange>,
    film: Option<RunningFilm>,
}

#[derive(Debug, Clone, Copy)]
struct RunningFilm {
    /// Frame and time of the window's clock from which time is counted.
    from: usize,
    since: f64,
    /// The frame that was shown last.
    shown: usize,
}

/// What is asked of the playing of frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PlaybackChange {
    PlayOrPause,
    Pause,
    /// Play at this multiple of the take's speed.
    Speed(f64),
    /// Begin again at the end, or no more.
    ToggleLoop,
    /// Mark these frames, or none.
    Mark(Option<FrameRange>),
}

impl Default for Playback {
    fn default() -> Self {
        Self { speed: 1.0, loops: false, range: None, film: None }
    }
}

impl Playback {
    /// Whether frames are being played.
    pub fn is_playing(&self) -> bool {
        self.film.is_some()
    }

    /// Starts at a frame; at the end of what is played, from its beginning. Says where it starts.
    pub(crate) fn start(&mut self, here: usize, count: usize, now: f64) -> usize {
        let FrameRange { first, last } = self.played(count);
        let from = if (first..last).contains(&here) { here } else { first };
        self.film = Some(RunningFilm { from, since: now, shown: from });
        from
    }

    pub(crate) fn stop(&mut self) {
        self.film = None;
    }

    /// Plays faster or slower from now on.
    pub(crate) fn set_speed(&mut self, speed: f64, now: f64) {
        self.speed = speed.clamp(SPEEDS[0], SPEEDS[SPEEDS.len() - 1]);
        if let Some(film) = &mut self.film {
            (film.from, film.since) = (film.shown, now);
        }
    }

    /// Changes how frames are played. Returns the frame where playing starts, if it does.
    pub(crate) fn change(
        &mut self,
        change: PlaybackChange,
        here: usize,
        count: usize,
        now: f64,
    ) -> Option<usize> {
        match change {
            PlaybackChange::PlayOrPause if !self.is_playing() => return Some(self.start(here, count, now)),
            PlaybackChange::PlayOrPause | PlaybackChange::Pause => self.stop(),
            PlaybackChange::Speed(speed) => self.set_speed(speed, now),
            PlaybackChange::ToggleLoop => self.loops ^= true,
            PlaybackChange::Mark(range) => {
                self.range = range;
                // Frames are marked to be seen again and again.
                self.loops |= range.is_some();
            }
        }
        None
    }

    /// The next of the offered speeds.
    pub(crate) fn next_speed(&self, faster: bool) -> f64 {
        let next = if faster {
            SPEEDS.into_iter().find(|speed| *speed > self.speed)
        } else {
            SPEEDS.into_iter().rfind(|speed| *speed < self.speed)
        };
        next.unwrap_or(self.speed)
    }

    /// The frames that are played: those that are marked, else all.
    pub(crate) fn played(&self, count: usize) -> FrameRange {
        let end = count.saturating_sub(1);
        let range = self.range.unwrap_or(FrameRange { first: 0, last: end });
        FrameRange { first: range.first.min(end), last: range.last.min(end) }
    }

    /// The frame to be shown now, if the pictures of some frames are there. `here` is the frame on the screen: the
    /// user may have gone elsewhere, and the film goes on from there.
    pub(crate) fn due(
        &mut self,
        here: usize,
        count: usize,
        rate: f64,
        now: f64,
        is_there: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        let played = self.played(count);
        let film = self.film.as_mut()?;
        if here != film.shown {
            *film = RunningFilm { from: here, since: now, shown: here };
        }
        if !is_there(here) {
            // Time does not run before its picture is on the screen.
            (film.from, film.since) = (here, now);
            return None;
        }
        let passed = passed(*film, rate * self.speed, now);
        if passed == 0 {
            return None;
        }
        if !self.loops && film.from.max(played.first) + passed > played.last {
            self.film = None;
            return Some(played.last);
        }
        // The newest picture that is there, of those that are due.
        let due = (1..=passed.min(played.count())).map(|back| wrapped(film.from, passed + 1 - back, played));
        let found = due.take_while(|frame| *frame != film.shown).find(|frame| is_there(*frame));
        film.shown = found?;
        found
    }

    /// Seconds until the next frame is due; `None` while nothing is played.
    pub(crate) fn next_in(&self, rate: f64, now: f64) -> Option<f64> {
        let film = self.film?;
        let rate = (rate * self.speed).max(f64::MIN_POSITIVE);
        let due = film.since + (passed(film, rate, now) + 1) as f64 / rate;
        Some((due - now).max(0.0))
    }

    /// The frame that will be due in this many seconds: it is read ahead.
    pub(crate) fn due_in(&self, seconds: f64, count: usize, rate: f64, now: f64) -> Option<usize> {
        let film = self.film?;
        let ahead = passed(film, rate * self.speed, now + seconds) + 1;
        let played = self.played(count);
        if !self.loops && film.from + ahead > played.last {
            return Some(played.last);
        }
        Some(wrapped(film.from, ahead, played))
    }
}

/// Frames that have passed since the film was started or went on.
fn passed(film: RunningFilm, rate: f64, now: f64) -> usize {
    // A whole frame is not short of one by a rounding error.
    ((now - film.since) * rate + 1e-6).max(0.0) as usize
}

/// The frame `by` frames after another, round and round in a range.
fn wrapped(from: usize, by: usize, range: FrameRange) -> usize {
    let at = from.clamp(range.first, range.last) - range.first;
    range.first + (at + by) % range.count()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 10.0;

    fn shown(playback: &mut Playback, count: usize, times: &[f64]) -> Vec<usize> {
        let mut here = playback.start(0, count, 0.0);
        times
            .iter()
            .map(|now| {
                here = playback.due(here, count, RATE, *now, |_| true).unwrap_or(here);
                here
            })
            .collect()
    }

    #[test]
    fn the_film_keeps_time_and_ends_with_the_last_frame() {
        let mut playback = Playback::default();
        assert_eq!(shown(&mut playback, 5, &[0.05, 0.1, 0.19, 0.35, 0.4, 0.5]), [0, 1, 1, 3, 4, 4]);
        assert!(!playback.is_playing());
        playback.set_speed(0.1, 0.0);
        assert_eq!(shown(&mut playback, 5, &[0.9, 1.0, 2.0]), [0, 1, 2]);
    }

    #[test]
    fn a_marked_range_is_played_round_and_round() {
        let range = Some(FrameRange::between(6, 4));
        let mut playback = Playback { loops: true, range, speed: 2.0, ..Playback::default() };
        assert_eq!(shown(&mut playback, 9, &[0.0, 0.05, 0.1, 0.15, 0.2, 0.25]), [4, 5, 6, 4, 5, 6]);
    }

    #[test]
    fn pictures_that_come_too_late_are_left_out() {
        let mut playback = Playback::default();
        playback.start(0, 100, 0.0);
        assert_eq!(playback.due(0, 100, RATE, 0.5, |frame| frame == 0 || frame > 5), None);
        assert_eq!(playback.due_in(0.1, 100, RATE, 0.5), Some(7));
        assert_eq!(playback.due(0, 100, RATE, 0.8, |frame| frame == 0 || frame == 7), Some(7));
        // The user goes elsewhere: the film goes on from there, once its picture is there.
        assert_eq!(playback.due(50, 100, RATE, 0.9, |_| false), None);
        assert_eq!(playback.due(50, 100, RATE, 1.9, |_| true), Some(60));
    }

    #[test]
    fn the_window_wakes_when_the_next_frame_is_due() {
        let mut playback = Playback::default();
        assert_eq!(playback.next_in(RATE, 0.0), None);
        playback.start(0, 100, 2.0);
        assert!((playback.next_in(RATE, 2.0).unwrap() - 0.1).abs() < 1e-9);
        assert!((playback.next_in(RATE, 2.07).unwrap() - 0.03).abs() < 1e-9, "not a whole frame later");
        playback.set_speed(0.5, 2.07);
        assert!((playback.next_in(RATE, 2.07).unwrap() - 0.2).abs() < 1e-9);
    }

    #[test]
    fn speeds_have_ends() {
        let mut playback = Playback::default();
        assert_eq!((playback.next_speed(true), playback.next_speed(false)), (1.5, 0.5));
        playback.set_speed(9.0, 0.0);
        assert_eq!((playback.speed, playback.next_speed(true)), (4.0, 4.0));
    }
}
