//! What may be a name: of a limb, a body, a camera, a take.
//!
//! Names come from files of anyone and go to terminals, tables and other programs' files. What would steer a terminal or turn the
//! direction of writing is no name, so that nobody behind the constructors has to think of it.

/// Longest name, letters.
pub const LONGEST: usize = 200;

/// What is expected where a text is no name.
pub const EXPECTED: &str = "1 to 200 letters, without control characters";

/// Whether a text is a name: it has letters that can be seen, not too many, and none that is [unsafe](is_unsafe).
pub fn is_name(text: &str) -> bool {
    !text.trim().is_empty() && text.chars().count() <= LONGEST && !text.contains(is_unsafe)
}

/// Whether a letter would change how a terminal or a page shows what stands around it: controls, line separators, and what
/// turns the direction of writing (Unicode Standard Annex 9).
pub fn is_unsafe(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{feff}')
}

/// The first letters of a text that is no name, as they may be shown.
pub fn excerpt(text: &str) -> String {
    const SHOWN: usize = 60;
    let mut out = String::new();
    for letter in text.chars().take(SHOWN) {
        if is_unsafe(letter) { out.extend(letter.escape_default()) } else { out.push(letter) }
    }
    if text.chars().nth(SHOWN).is_some() {
        out.push('…');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_no_name() {
        for name in ["left hand", "Kamera 1", "手", "a\"b", "ä.png", "limb (2)"] {
            assert!(is_name(name), "{name}");
        }
        for text in ["", " ", "a\u{1b}[31m", "a\nb", "\u{9b}1m", "a\u{202e}b", "\u{7f}", "a\tb"] {
            assert!(!is_name(text), "{text:?}");
            assert!(!excerpt(text).contains(is_unsafe), "{text:?}");
        }
        assert!(is_name(&"ü".repeat(LONGEST)) && !is_name(&"ü".repeat(LONGEST + 1)));
        assert_eq!(excerpt(&"b".repeat(3_000_000)).chars().count(), 61);
        assert_eq!(excerpt("a\u{1b}"), "a\\u{1b}");
    }
}
