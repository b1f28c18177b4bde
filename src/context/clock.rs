//! The time of day where the user is. Tests bring a time and a place of their own.

use std::time::{Duration, SystemTime};

use jiff::tz::{Offset, TimeZone};
use jiff::{Timestamp, Zoned};

/// Seconds of a minute, an hour, a day.
const MINUTE: u64 = 60;
const HOUR: u64 = 60 * MINUTE;
const DAY: u64 = 24 * HOUR;

/// What time it is, and how times are said.
#[derive(Debug, Clone)]
pub struct Clock {
    /// The time at which it stands still.
    fixed: Option<SystemTime>,
    /// `None` where the system does not say in which time zone it is.
    zone: Option<TimeZone>,
}

impl Default for Clock {
    fn default() -> Self {
        Self { fixed: None, zone: TimeZone::try_system().ok() }
    }
}

impl Clock {
    /// A clock that stands still, in the time zone this many seconds east of Greenwich; `None` if there is no such zone.
    pub fn fixed(now: SystemTime, seconds_east: i32) -> Option<Self> {
        let zone = TimeZone::fixed(Offset::from_seconds(seconds_east).ok()?);
        Some(Self { fixed: Some(now), zone: Some(zone) })
    }

    pub(crate) fn now(&self) -> SystemTime {
        self.fixed.unwrap_or_else(SystemTime::now)
    }

    /// Day and time of day: "today 14:32", "Friday 09:05", "12 November 2025 14:32". Without a time zone the time is
    /// Greenwich's, and says so. `None` for times that no calendar has.
    pub(crate) fn when(&self, time: SystemTime) -> Option<String> {
        let (time, now) = (self.local(time)?, self.local(self.now())?);
        let days_ago = time.date().until(now.date()).ok()?.get_days();
        let day = match days_ago {
            0 => "today".to_owned(),
            1 => "yesterday".to_owned(),
            2..=6 => time.strftime("%A").to_string(),
            _ if time.year() == now.year() => time.strftime("%-d %B").to_string(),
            _ => time.strftime("%-d %B %Y").to_string(),
        };
        let zone = if self.zone.is_some() { "" } else { " UTC" };
        Some(format!("{day} {}{zone}", time.strftime("%H:%M")))
    }

    fn local(&self, time: SystemTime) -> Option<Zoned> {
        let zone = self.zone.clone().unwrap_or(TimeZone::UTC);
        Some(Timestamp::try_from(time).ok()?.to_zoned(zone))
    }

    /// How long ago, roughly: "12 minutes ago"; `None` for what is yet to come.
    pub(crate) fn ago(&self, time: SystemTime) -> Option<String> {
        let seconds = self.now().duration_since(time).ok().as_ref().map(Duration::as_secs)?;
        let rounded = |unit: u64| (seconds + unit / 2) / unit;
        Some(match seconds {
            0..45 => "just now".to_owned(),
            45..90 => "a minute ago".to_owned(),
            90..5400 => format!("{} minutes ago", rounded(MINUTE)),
            5400..129_600 => format!("{} hours ago", rounded(HOUR)),
            _ => format!("{} days ago", rounded(DAY)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 21 November 2026, 09:30 in Greenwich: a Saturday.
    const NOW: u64 = 1_795_253_400;

    fn at(seconds: u64) -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)
    }

    #[test]
    fn times_are_said_by_the_calendar_of_the_place() {
        let greenwich = Clock::fixed(at(NOW), 0).unwrap();
        for (before, expected) in [
            (0, "today 09:30"),
            (9 * HOUR + 30 * MINUTE, "today 00:00"),
            (9 * HOUR + 31 * MINUTE, "yesterday 23:59"),
            (2 * DAY, "Thursday 09:30"),
            (6 * DAY, "Sunday 09:30"),
            (7 * DAY, "14 November 09:30"),
            (365 * DAY, "21 November 2025 09:30"),
        ] {
            assert_eq!(greenwich.when(at(NOW - before)).unwrap(), expected);
        }
        // Half past five hours east it is 15:00, and what was 18:40 in Greenwich was today already.
        let calcutta = Clock::fixed(at(NOW), (5 * HOUR + 30 * MINUTE) as i32).unwrap();
        assert_eq!(calcutta.when(at(NOW)).unwrap(), "today 15:00");
        assert_eq!(calcutta.when(at(NOW - 14 * HOUR - 50 * MINUTE)).unwrap(), "today 00:10");
        let nowhere = Clock { zone: None, ..greenwich };
        assert_eq!(nowhere.when(at(NOW)).unwrap(), "today 09:30 UTC");
    }

    #[test]
    fn a_clock_that_was_set_back_and_impossible_times_are_no_harm() {
        let clock = Clock::fixed(at(NOW), 0).unwrap();
        assert_eq!(clock.ago(at(NOW + 1)), None);
        assert_eq!(clock.when(at(NOW + DAY)).unwrap(), "22 November 09:30");
        assert_eq!(clock.when(at(1 << 60)), None);
        assert!(Clock::fixed(at(NOW), i32::MAX).is_none());
    }

    #[test]
    fn how_long_ago_is_rounded() {
        let clock = Clock::fixed(at(NOW), 0).unwrap();
        for (before, expected) in [
            (10, "just now"),
            (60, "a minute ago"),
            (720, "12 minutes ago"),
            (2 * HOUR, "2 hours ago"),
            (40 * HOUR, "2 days ago"),
        ] {
            assert_eq!(clock.ago(at(NOW - before)).unwrap(), expected);
        }
    }
}
