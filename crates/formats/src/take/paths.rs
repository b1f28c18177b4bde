//! Paths of a take file: numbered pictures (`cam01/frame_%03d.jpg` or `cam01/frame_{:03}.jpg`), variables (`${NAME}` and
//! `${NAME:-default}`), and what lies outside the take's folder, which a take from elsewhere should not read unseen.

use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

use backlit_tracking::body::builtin;
use thiserror::Error;
use toml::Spanned;

use super::reader::TakeReader;
use super::spec::{CalibrationSpec, ReferenceSpec, TakeSpec, ViewSpec};
use crate::Result;
use crate::files::plain;

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

/// The text with every variable replaced by its value.
pub(super) fn expand_variables(text: &str, value: &dyn Fn(&str) -> Option<String>) -> Result<String, String> {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, from)) = rest.split_once("${") {
        let Some((variable, after)) = from.split_once('}') else { break };
        out.push_str(before);
        let (name, default) = match variable.split_once(":-") {
            Some((name, default)) => (name, Some(default)),
            None => (variable, None),
        };
        // As in a shell, an empty value counts as none where there is a default.
        let found = value(name).filter(|found| default.is_none() || !found.is_empty());
        match found.as_deref().or(default) {
            Some(found) => out.push_str(found),
            None => return Err(name.to_owned()),
        }
        rest = after;
    }
    Ok(out + rest)
}

/// The process's own environment. Names that an environment cannot have are not set.
pub(super) fn variable(name: &str) -> Option<String> {
    if name.is_empty() || name.contains(['=', '\0']) {
        return None;
    }
    std::env::var(name).ok().map(from_here)
}

/// A folder that a user names from where they stand is that folder, wherever the take lies.
fn from_here(value: String) -> String {
    let path = Path::new(&value);
    if !path.is_relative() || value.is_empty() || !path.is_dir() {
        return value;
    }
    match std::path::absolute(path) {
        Ok(absolute) => absolute.to_string_lossy().into_owned(),
        Err(_) => value,
    }
}

/// What a take reads outside its own folder. Of numbered pictures the first one stands for all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outside {
    /// The first such path, in the order of the take file.
    pub first: PathBuf,
    /// How many such paths the take file names, the first one included.
    pub count: usize,
}

impl Display for Outside {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "the take reads outside its own folder: {}", self.first.display())?;
        match self.count - 1 {
            0 => Ok(()),
            1 => write!(f, ", and 1 more path that it names"),
            more => write!(f, ", and {more} more paths that it names"),
        }
    }
}

/// A path as the take file has it: below which folder, what is written there, in which field, and the number of the first file
/// where it is a pattern.
struct NamedPath<'a> {
    below: &'a Path,
    value: &'a Spanned<String>,
    field: &'static str,
    first: u64,
}

impl TakeReader<'_> {
    /// What the take file names outside its folder.
    pub(super) fn outside(&self, spec: &TakeSpec) -> Result<Option<Outside>> {
        let own = self.real(&self.folder);
        let mut found: Vec<PathBuf> = Vec::new();
        for NamedPath { below, value, field, first } in self.named(spec) {
            let text = self.expand(value, field)?;
            if field == "model" && builtin::text(&text).is_some() {
                continue;
            }
            let path = below.join(&text);
            let path = match FramePattern::new(&text) {
                Ok(pattern) if !self.files.exists(&path) => pattern.path(below, first),
                _ => path,
            };
            if !self.real(&path).starts_with(&own) {
                found.push(path);
            }
        }
        let first = found.first().cloned();
        found.sort_unstable();
        found.dedup();
        Ok(first.map(|first| Outside { first, count: found.len() }))
    }

    /// Every path of the take file. The compiler asks of each new field whether it is a path.
    fn named<'s>(&'s self, spec: &'s TakeSpec) -> Vec<NamedPath<'s>> {
        let TakeSpec {
            _format: _,
            name: _,
            frame_rate: _,
            units: _,
            // What lies in it is named; the folder itself is not read.
            footage: _,
            model,
            start,
            sizes: _,
            reduction: _,
            cameras: CalibrationSpec { calibration, size: _ },
            views,
            reference,
            measurement: _,
        } = spec;
        let own = |value, field| NamedPath { below: &self.folder, value, field, first: 0 };
        let lying = |value, field, first| NamedPath { below: &self.footage, value, field, first };
        let mut all = vec![own(model, "model")];
        all.extend(start.as_ref().map(|start| own(start, "start")));
        all.push(lying(calibration, "cameras.calibration", 0));
        for view in views {
            let ViewSpec {
                name: _,
                frames,
                masks,
                masks_first,
                mask_values: _,
                first,
                count: _,
                last: _,
                offset: _,
                offset_seconds: _,
                background,
                background_first,
                background_count: _,
                keypoints,
                keypoints_first,
                measurement: _,
            } = view;
            let first_mask = masks_first.as_ref().map_or(*first, |number| *number.get_ref());
            let first_keypoints = keypoints_first.unwrap_or(*first);
            all.extend(frames.as_ref().map(|value| lying(value, "camera.frames", *first)));
            all.extend(masks.as_ref().map(|value| lying(value, "camera.masks", first_mask)));
            all.extend(background.as_ref().map(|value| lying(value, "camera.background", *background_first)));
            all.extend(keypoints.as_ref().map(|value| lying(value, "camera.keypoints", first_keypoints)));
        }
        if let Some(ReferenceSpec { keypoints, first_frame: _, axes: _, markers: _, placement }) = reference {
            all.push(lying(keypoints, "reference.keypoints", 0));
            all.extend(placement.as_ref().map(|value| own(value, "reference.placement")));
        }
        all
    }

    /// Where a path leads: behind links of the disk as far as they are there, and without `..`.
    fn real(&self, path: &Path) -> PathBuf {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let there = whole.ancestors().find_map(|part| Some((part, self.files.behind_links(part)?)));
        let real = there.and_then(|(part, real)| Some(real.join(whole.strip_prefix(part).ok()?)));
        plain(&real.unwrap_or(whole))
    }
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

    #[test]
    fn a_relative_folder_is_taken_from_where_the_user_stands() {
        // Tests run in the package's folder.
        assert!(Path::new(&from_here("src".to_owned())).is_absolute());
        for kept in ["/data", "no such folder", ""] {
            assert_eq!(from_here(kept.to_owned()), kept);
        }
    }

    #[test]
    fn variables_and_defaults() {
        let value = |name: &str| match name {
            "DATA" => Some("/data".to_owned()),
            "EMPTY" => Some(String::new()),
            _ => None,
        };
        assert_eq!(expand_variables("${DATA}/a${DATA:-x}", &value).unwrap(), "/data/a/data");
        assert_eq!(expand_variables("${NONE:-../b}/c${EMPTY:-d}${EMPTY}", &value).unwrap(), "../b/cd");
        assert_eq!(expand_variables("a$b{c}", &value).unwrap(), "a$b{c}");
        assert_eq!(expand_variables("a${b", &value).unwrap(), "a${b");
        assert_eq!(expand_variables("${NONE}", &value).unwrap_err(), "NONE");
        assert_eq!(variable(""), None);
        assert_eq!(variable("A=B"), None);
    }
}
