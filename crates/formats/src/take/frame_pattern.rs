//! Names of numbered pictures: `cam01/frame_%03d.jpg` or `cam01/frame_{:03}.jpg`.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Most digits that a number is filled up to.
const MAX_DIGITS: usize = 20;

/// A path with one place for a number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FramePattern {
    before: String,
    digits: usize,
    after: String,
}

/// Why a text is not a pattern.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum PatternError {
    #[error("no number; expected one of %d, %03d, {{}}, {{:03}}")]
    NoNumber,
    #[error("more than one number; expected exactly one")]
    TwoNumbers,
    #[error("the number \"{found}\"; expected one of %d, %03d, {{}}, {{:03}}")]
    Number { found: String },
}

impl FramePattern {
    /// Parses `%d`, `%03d`, `{}` or `{:03}` somewhere in a path; `%%` is a percent sign.
    ///
    /// # Errors
    /// No number, more than one, or one that is written in another way.
    pub fn new(text: &str) -> Result<Self, PatternError> {
        let mut parts = vec![String::new()];
        let mut digits = 0;
        let mut rest = text;
        while let Some(at) = rest.find(['%', '{']) {
            let (before, from) = rest.split_at(at);
            let percent = from.starts_with('%');
            if let Some(last) = parts.last_mut() {
                last.push_str(before);
                if let Some(after) = from.strip_prefix("%%") {
                    last.push('%');
                    rest = after;
                    continue;
                }
            }
            let end = if percent { 'd' } else { '}' };
            let Some((number, after)) = from[1..].split_once(end) else {
                return Err(PatternError::Number { found: from.to_owned() });
            };
            let filled = if percent {
                Some(number)
            } else {
                number.strip_prefix(':').or(number.is_empty().then_some(""))
            };
            let width = match filled {
                Some("") => Some(0),
                Some(filled) => filled.strip_prefix('0').and_then(|width| width.parse().ok()),
                None => None,
            };
            digits = match width {
                Some(width) if width <= MAX_DIGITS => width,
                _ => return Err(PatternError::Number { found: from[..number.len() + 2].to_owned() }),
            };
            parts.push(String::new());
            rest = after;
        }
        if let Some(last) = parts.last_mut() {
            last.push_str(rest);
        }
        match <[String; 2]>::try_from(parts) {
            Ok([before, after]) => Ok(Self { before, digits, after }),
            Err(parts) if parts.len() < 2 => Err(PatternError::NoNumber),
            Err(_) => Err(PatternError::TwoNumbers),
        }
    }

    /// The path of the picture with this number, in `folder`.
    #[must_use]
    pub fn path(&self, folder: &Path, number: u64) -> PathBuf {
        folder.join(format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits))
    }
}

/// What stands before, in and behind the last number of a file's name.
pub(crate) fn split_number(name: &str) -> Option<(&str, &str, &str)> {
    let stem = name.rfind('.').unwrap_or(name.len());
    let end = name[..stem].rfind(|letter: char| letter.is_ascii_digit())? + 1;
    let start = name[..end]
        .rfind(|letter: char| !letter.is_ascii_digit())
        .map_or(0, |at| at + name[at..].chars().next().map_or(1, char::len_utf8));
    Some((&name[..start], &name[start..end], &name[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_spellings_name_the_same_files() {
        let name = |pattern, number| {
            let path = FramePattern::new(pattern).unwrap().path(Path::new("take"), number);
            path.to_str().unwrap().to_owned()
        };
        assert_eq!(name("cam01/frame_%03d.jpg", 7), "take/cam01/frame_007.jpg");
        assert_eq!(name("cam01/frame_{:03}.jpg", 1234), "take/cam01/frame_1234.jpg");
        assert_eq!(name("100%%/%d.png", 7), "take/100%/7.png");
        assert_eq!(name("{}.png", 7), "take/7.png");
        assert_eq!(name("/abs/ü%02d", 7), "/abs/ü07");
    }

    #[test]
    fn anything_else_is_an_error() {
        assert_eq!(FramePattern::new("frame.jpg"), Err(PatternError::NoNumber));
        assert_eq!(FramePattern::new("%d/%d.jpg"), Err(PatternError::TwoNumbers));
        for text in ["%3d", "{3}", "{:3}", "%099d", "%s", "{", "%", "a%-03d", "%ü", "{:0ü}"] {
            assert!(matches!(FramePattern::new(text), Err(PatternError::Number { .. })), "{text}");
        }
    }
}
