//! Numbers as they are written on the screen.
//!
//! A true minus (U+2212) for negative numbers, a thin space (U+2009) between thousands, angles in degrees
//! with one decimal, lengths in metres with three, costs as `1.8e8`. Every function but `length` and `deviation` returns
//! `MISSING` for a number that is not finite, and none writes a negative zero.

use std::path::Path;

/// What is written for a number that is not finite.
pub const MISSING: &str = "–";

/// The minus sign of typography, U+2212.
pub const MINUS: char = '\u{2212}';

/// The space between groups of thousands, U+2009.
pub const THIN_SPACE: char = '\u{2009}';

/// The text with a capital letter: `Right wrist`.
pub fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// The text without one, for the middle of a sentence: `right wrist`.
pub fn uncapitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// So many of what has this name: `1 step`, `4 steps`.
pub fn counted(count: usize, name: &str) -> String {
    format!("{count} {name}{}", if count == 1 { "" } else { "s" })
}

/// The last part of a path, or all of one that has none.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// `value` with `decimals` digits after the point: `−8.4`.
pub fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    let text = format!("{:.decimals$}", value.abs());
    let is_zero = text.bytes().all(|byte| matches!(byte, b'0' | b'.'));
    if value < 0.0 && !is_zero { format!("{MINUS}{text}") } else { text }
}

/// A count in groups of three: `1 074`.
pub fn count(value: i64) -> String {
    let digits = value.unsigned_abs().to_string();
    let mut text = String::with_capacity(digits.len() * 2);
    if value < 0 {
        text.push(MINUS);
    }
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(THIN_SPACE);
        }
        text.push(digit);
    }
    text
}

/// Two figures and a power of ten, for costs and other numbers that span decades: `1.8e8`, `2.1e−7`.
pub fn cost(value: f64) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    format!("{value:.1e}").replace('-', "\u{2212}")
}

/// A number with as few digits as say it to four figures: `0.01`, `30`, `1.5e−6`.
pub fn short(value: f64) -> String {
    if !value.is_finite() {
        return MISSING.to_owned();
    }
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        return cost(value);
    }
    let before = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    let text = number(value, (3.0 - before).clamp(0.0, 8.0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A dimensionless ratio with three decimals: `0.804`.
pub fn ratio(value: f64) -> String {
    number(value, 3)
}

/// An angle given in radians, in degrees with one decimal: `−8.4°`.
pub fn degrees(angle_rad: f64) -> String {
    with_unit(number(angle_rad.to_degrees(), 1), "°")
}

/// A length in metres with three decimals: `1.429 m`.
pub fn metres(length: f64) -> String {
    with_unit(number(length, 3), " m")
}

/// A fraction as a percentage with one decimal: `31.7 %`.
pub fn percent(fraction: f64) -> String {
    with_unit(number(fraction * 100.0, 1), " %")
}

/// A time span given in seconds, in the unit that leaves one to three figures before the point:
/// `48 µs`, `1.9 ms`, `2.5 s`.
pub fn duration(seconds: f64) -> String {
    let magnitude = seconds.abs();
    if !seconds.is_finite() {
        MISSING.to_owned()
    } else if magnitude < 0.999_5e-3 {
        format!("{} µs", number(seconds * 1e6, 0))
    } else if magnitude < 0.999_5 {
        format!("{} ms", number(seconds * 1e3, 1))
    } else {
        format!("{} s", number(seconds, 1))
    }
}

/// Reads what these functions write, and what is typed on a keyboard: either minus, any spaces, an
/// optional unit (`°`, `%`, `m`) behind the number. The unit is dropped, not converted.
///
/// Returns `None` for anything else, and for numbers that are not finite.
pub fn parse(text: &str) -> Option<f64> {
    let plain: String =
        text.chars().filter(|c| !c.is_whitespace()).map(|c| if c == MINUS { '-' } else { c }).collect();
    let plain = plain.trim_end_matches(['°', '%', 'm']);
    plain.parse::<f64>().ok().filter(|value| value.is_finite())
}

fn with_unit(number: String, unit: &str) -> String {
    if number == MISSING { number } else { number + unit }
}

/// A length in the unit that leaves one to three figures before the point; not finite is without bound.
pub fn length(metres: f64) -> String {
    let mm = 1e3 * metres;
    if !mm.is_finite() {
        "no bound".to_owned()
    } else if mm >= 1000.0 {
        format!("{} m", number(metres, 1))
    } else {
        format!("{} mm", number(mm, usize::from(mm < 9.95)))
    }
}

/// "±2.3 mm", or that nothing bounds it.
pub fn deviation(metres: f64) -> String {
    if metres.is_finite() { format!("±{}", length(metres)) } else { length(metres) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_begin_as_they_stand_in_a_sentence() {
        assert_eq!([capitalised("right wrist"), capitalised("")], ["Right wrist", ""]);
        assert_eq!([uncapitalised("Camera 1"), uncapitalised("")], ["camera 1", ""]);
        assert_eq!(["a/b.png", ".."].map(|path| file_name(Path::new(path))), ["b.png", ".."]);
    }

    #[test]
    fn numbers_are_written_alike_everywhere() {
        for (written, expected) in [
            // A true minus, and none before zero.
            (number(-8.42, 1), "\u{2212}8.4"),
            (number(-0.04, 1), "0.0"),
            (number(-0.06, 1), "\u{2212}0.1"),
            (number(-0.0, 0), "0"),
            (number(f64::NAN, 2), MISSING),
            (number(f64::NEG_INFINITY, 2), MISSING),
            // Groups of thousands.
            (count(0), "0"),
            (count(999), "999"),
            (count(1_074), "1\u{2009}074"),
            (count(-12_345_678), "\u{2212}12\u{2009}345\u{2009}678"),
            // Two figures.
            (cost(1.76e8), "1.8e8"),
            (cost(2.1e-7), "2.1e\u{2212}7"),
            (cost(-31.0), "\u{2212}3.1e1"),
            (cost(0.0), "0"),
            (cost(f64::INFINITY), MISSING),
            // No digits to spare.
            (short(0.01), "0.01"),
            (short(30.0), "30"),
            (short(0.0), "0"),
            (short(1.5), "1.5"),
            (short(12_345.0), "12345"),
            (short(-0.25), "\u{2212}0.25"),
            (short(1.5e-6), "1.5e\u{2212}6"),
            (short(f64::NAN), MISSING),
            // Units behind them.
            (degrees(std::f64::consts::FRAC_PI_2), "90.0°"),
            (degrees(-0.1466), "\u{2212}8.4°"),
            (metres(1.4291), "1.429 m"),
            (percent(0.317), "31.7 %"),
            (ratio(0.8044), "0.804"),
            (percent(f64::NAN), MISSING),
            // Units that suit them.
            (duration(48.3e-6), "48 µs"),
            (duration(999.7e-6), "1.0 ms"),
            (duration(1.92e-3), "1.9 ms"),
            (duration(0.999_8), "1.0 s"),
            (duration(f64::NAN), MISSING),
            (length(0.0004), "0.4 mm"),
            (length(0.031), "31 mm"),
            (length(1.23), "1.2 m"),
            (length(f64::INFINITY), "no bound"),
        ] {
            assert_eq!(written, expected);
        }
        assert_eq!(count(i64::MIN).matches(THIN_SPACE).count(), 6);
    }

    #[test]
    fn parse_reads_back_what_is_written() {
        for (text, expected) in [
            (number(-8.4, 1).as_str(), Some(-8.4)),
            (&count(-12_345), Some(-12_345.0)),
            (&cost(2.1e-7), Some(2.1e-7)),
            (" -3.5 ° ", Some(-3.5)),
            ("1.429 m", Some(1.429)),
            ("31.7 %", Some(31.7)),
            ("NaN", None),
            ("inf", None),
            ("arm", None),
            ("", None),
        ] {
            assert_eq!(parse(text), expected, "{text}");
        }
    }
}
