//! How well a few typed letters fit a name: the palette's order.

/// A letter at the beginning of a word, right after the one before, and anywhere else.
const AT_WORD: i32 = 12;
const AFTER_LAST: i32 = 8;
const ANYWHERE: i32 = 1;
/// A word begins with all of what was typed.
const WHOLE: i32 = 40;
/// The name begins with what was typed; a letter that was skipped; a letter that is left.
const AT_START: i32 = 20;
const SKIPPED: i32 = -1;
const LONGER: i32 = 4;

/// How well `typed` fits `name`: more is better, `None` if it does not. Every word that was typed must be found, in any
/// order, its letters one after the other: "trf" and "for tra" both find "Track forward". Case does not matter.
pub(crate) fn fuzzy(typed: &str, name: &str) -> Option<i32> {
    let name: Vec<char> = name.to_lowercase().chars().collect();
    let typed = typed.to_lowercase();
    let mut sum = 0;
    for word in typed.split_whitespace() {
        let word: Vec<char> = word.chars().collect();
        let begins = |place: usize| place == 0 || !name[place - 1].is_alphanumeric();
        let is_whole = (0..name.len()).any(|place| begins(place) && name[place..].starts_with(&word));
        sum += best(&word, &name)? + if is_whole { WHOLE } else { 0 };
    }
    // Of two names that fit alike the shorter one is meant.
    Some(sum - name.len() as i32 / LONGER)
}

/// The best way to find the letters of one word.
fn best(word: &[char], name: &[char]) -> Option<i32> {
    // By place of the letter found last: the best sum so far.
    let mut sums: Vec<Option<i32>> = Vec::new();
    for (index, letter) in word.iter().enumerate() {
        let mut next: Vec<Option<i32>> = vec![None; name.len()];
        for (place, _) in name.iter().enumerate().filter(|(_, found)| *found == letter) {
            let begins = place == 0 || !name[place - 1].is_alphanumeric();
            let here = if begins { AT_WORD } else { ANYWHERE };
            next[place] = if index == 0 {
                Some(here + if place == 0 { AT_START } else { 0 })
            } else {
                let from = |before: usize| {
                    let adjacent = before + 1 == place;
                    let way = if adjacent { AFTER_LAST } else { SKIPPED * (place - before).min(10) as i32 };
                    sums[before].map(|sum| sum + way + here)
                };
                (0..place).filter_map(from).max()
            };
        }
        sums = next;
    }
    sums.into_iter().flatten().max()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first<'a>(typed: &str, names: &[&'a str]) -> &'a str {
        let scored = names.iter().filter_map(|name| Some((fuzzy(typed, name)?, *name)));
        scored.max_by_key(|(score, _)| *score).map_or("", |(_, name)| name)
    }

    #[test]
    fn letters_of_words_find_them() {
        let names =
            ["Track forward", "Track back", "Step", "Step back", "Earlier step", "Reset layout", "Robust"];
        for (typed, expected) in [
            ("trf", "Track forward"),
            ("for tra", "Track forward"),
            ("tb", "Track back"),
            ("step", "Step"),
            ("STEP B", "Step back"),
            ("es", "Earlier step"),
            ("rl", "Reset layout"),
            ("rob", "Robust"),
            ("xyzzy", ""),
        ] {
            assert_eq!(first(typed, &names), expected, "{typed}");
        }
    }

    #[test]
    fn a_word_that_is_there_beats_its_letters_strewn_about() {
        let strewn = ["Stop export", "Paste pose", "Set or clear key pose"];
        for name in strewn {
            assert!(fuzzy("step", name) < fuzzy("step", "Earlier step"), "{name}");
        }
    }

    #[test]
    fn nothing_typed_fits_everything_and_odd_letters_are_no_harm() {
        assert!(fuzzy("", "Step").is_some());
        assert_eq!(fuzzy("stepx", "Step"), None);
        assert!(fuzzy("λ", "Prediction Λ").is_some());
        assert_eq!(fuzzy("a", ""), None);
    }
}
