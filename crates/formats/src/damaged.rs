//! Tables of damaged files, for tests: what is changed in a good one, and what its error says.

use std::fmt::Display;

/// Checks rows `from ⇒ to ⇒ words`: the good text with the first `from` replaced by `to` is refused in words that contain these. A row
/// `text ⇒ words` is of a whole text. Cells have no spaces round them, and `\n` in them is the end of a line.
pub(crate) fn assert_refused<T, E: Display>(good: &str, read: impl Fn(&str) -> Result<T, E>, rows: &str) {
    for row in rows.lines().filter(|row| !row.trim().is_empty()) {
        let cells: Vec<String> = row.split('⇒').map(|cell| cell.trim().replace("\\n", "\n")).collect();
        let (changed, expected) = match &cells[..] {
            [whole, expected] => (whole.clone(), expected),
            [from, to, expected] => (good.replacen(from, to, 1), expected),
            _ => panic!("{row}"),
        };
        assert_ne!(changed, good, "{row}");
        let message = match read(&changed) {
            Ok(_) => panic!("{row}: this is read"),
            Err(error) => error.to_string(),
        };
        assert!(message.contains(expected), "{message:?} should contain {expected:?}");
    }
}
