//! From bytes to text, from places in a text to line numbers, and what of a file may be shown.

use std::fmt::{self, Write};
use std::path::Path;

use backlit_tracking::names::is_unsafe;

use super::{FileError, FileProblem, Result};

/// Most letters of a name, a number or a word of a file that a message repeats.
pub const MOST_SHOWN: usize = 60;

/// The bytes as text, without a byte order mark.
pub(super) fn decode<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str> {
    match str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(error) => {
            let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
            Err(FileError::new(path, FileProblem::NotText).at_line(Some(line)))
        }
    }
}

/// The line, counted from 1, that holds the byte at `offset`.
pub(super) fn line_at(text: &str, offset: usize) -> usize {
    let end = offset.min(text.len());
    1 + text.as_bytes()[..end].iter().filter(|&&byte| byte == b'\n').count()
}

/// A text's words, one by one, with their lines.
pub(super) struct Words<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    is_space: fn(char) -> bool,
    /// Of the last word, counted from 1.
    pub(super) line: usize,
    /// What is left of that line.
    pub(super) left: &'a str,
}

impl<'a> Words<'a> {
    pub(super) fn new(text: &'a str, is_space: fn(char) -> bool) -> Self {
        Self { lines: text.lines().enumerate(), is_space, line: 0, left: "" }
    }

    pub(super) fn after(&mut self) -> Option<&'a str> {
        loop {
            let left = self.left.trim_start_matches(self.is_space);
            if left.is_empty() {
                let (index, line) = self.lines.next()?;
                (self.line, self.left) = (index + 1, line);
                continue;
            }
            let end = left.find(self.is_space).unwrap_or(left.len());
            self.left = &left[end..];
            return Some(&left[..end]);
        }
    }
}

/// A text from a file as it may be shown: letters that would steer a terminal are written out, as `\u{1b}`. Names of files,
/// cameras, limbs and takes go to a terminal through this.
#[must_use]
pub fn shown(text: &str) -> SafeText<'_> {
    SafeText { text, most: usize::MAX }
}

/// As [`shown`], no more than [`MOST_SHOWN`] letters of it.
#[must_use]
pub fn cut(text: &str) -> SafeText<'_> {
    SafeText { text, most: MOST_SHOWN }
}

/// The beginning and the end of a long text, with these counts of letters.
#[must_use]
pub fn cut_middle(text: &str, [begins, ends]: [usize; 2]) -> String {
    let count = text.chars().count();
    if count <= begins + ends + 1 {
        return text.to_owned();
    }
    let head: String = text.chars().take(begins).collect();
    head + "…" + &text.chars().skip(count - ends).collect::<String>()
}

/// A text that can be shown; see [`shown`] and [`cut`].
#[derive(Debug, Clone, Copy)]
pub struct SafeText<'a> {
    text: &'a str,
    most: usize,
}

impl fmt::Display for SafeText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut safe = Safe { out: f, left: self.most };
        let written = safe.write_str(self.text);
        let left = safe.left;
        match written {
            // What was too long has ended the writing, not an error of the one who is written to.
            Err(_) if left == 0 => f.write_char('…'),
            other => other,
        }
    }
}

/// Writes texts as they may be shown, at most `left` letters; then it fails with nothing `left`.
pub(super) struct Safe<'a, 'b> {
    pub(super) out: &'a mut fmt::Formatter<'b>,
    pub(super) left: usize,
}

impl Write for Safe<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for letter in text.chars() {
            let length = if is_unsafe(letter) { letter.escape_default().count() } else { 1 };
            let Some(left) = self.left.checked_sub(length) else {
                self.left = 0;
                return Err(fmt::Error);
            };
            self.left = left;
            match letter {
                '\n' => self.out.write_char(' ')?,
                letter if is_unsafe(letter) => write!(self.out, "{}", letter.escape_default())?,
                letter => self.out.write_char(letter)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out_and_long_texts_are_cut() {
        assert_eq!(shown("a\u{1b}[31mü\u{202e}b\n").to_string(), "a\\u{1b}[31mü\\u{202e}b ");
        assert_eq!(shown("\u{9b}\u{7f}\t").to_string(), "\\u{9b}\\u{7f}\\t");
        assert_eq!(cut(&"ä".repeat(60)).to_string(), "ä".repeat(60));
        assert_eq!(cut(&"ä".repeat(61)).to_string(), "ä".repeat(60) + "…");
        assert_eq!(cut("").to_string(), "");
        assert_eq!(cut(&"\u{7f}".repeat(60)).to_string(), "\\u{7f}".repeat(10) + "…");
    }
}
