//! JSON with errors that name the line and the field.
//!
//! The library's errors know line and column. A small scan of the text up to there tells which field that is;
//! the same scan finds the line of a field that turns out to be wrong later.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;
use std::str::FromStr;

use serde::de::{DeserializeOwned, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::text::{decode, line_at};
use super::{FileError, FileProblem, Result, TextFormat, plain_words};

/// Checks the `format` field, then parses the whole text.
pub fn parse_versioned<T: DeserializeOwned>(path: &Path, text: &str, expected: &'static str) -> Result<T> {
    #[derive(Deserialize)]
    struct FormatOnly {
        format: Option<serde_json::Value>,
    }
    let found = match parse::<FormatOnly>(path, text)?.format {
        Some(serde_json::Value::String(format)) if format == expected => return parse(path, text),
        Some(other) => other.to_string(),
        None => "missing".to_owned(),
    };
    let line = line_of(text, &["format"]);
    Err(FileError::new(path, FileProblem::Format { found, expected }).at_line(line))
}

/// Parses a text; `path` is for the error's message.
pub fn parse<'de, T: Deserialize<'de>>(path: &Path, text: &'de str) -> Result<T> {
    serde_json::from_str(text).map_err(|error| {
        let start =
            text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum::<usize>();
        let offset = start.saturating_add(error.column().saturating_sub(1)).min(text.len());
        let full = error.to_string();
        let message = full.rsplit_once(" at line ").map_or(full.as_str(), |(message, _)| message);
        let field = field_at(text, offset);
        let problem = match not_a_number(text, offset) {
            Some(word) => {
                let message = format!("{word} is not a number; expected a finite number");
                FileProblem::Syntax { format: TextFormat::Json, field, message }
            }
            None => plain_words::problem(TextFormat::Json, field, message),
        };
        FileError::new(path, problem).at_line((error.line() > 0).then(|| error.line()))
    })
}

/// Parses a file's content, for files that are not this crate's own.
pub fn parse_bytes<T: DeserializeOwned>(path: &Path, bytes: &[u8]) -> Result<T> {
    parse(path, decode(path, bytes)?)
}

/// A map for `#[serde(deserialize_with = …)]` whose keys must differ: of two values for one key neither is the right one.
pub fn unique_keys<'de, D, K, V>(deserializer: D) -> Result<BTreeMap<K, V>, D::Error>
where
    D: Deserializer<'de>,
    K: FromStr + Ord,
    V: Deserialize<'de>,
{
    let mut map = BTreeMap::new();
    for (text, value) in Entries::<V>::deserialize(deserializer)?.0 {
        let wrong = |what: &str| serde::de::Error::custom(format_args!("\"{text}\" {what}"));
        let key = text.parse().map_err(|_error| wrong("is no key of this map; expected a frame's number"))?;
        if map.insert(key, value).is_some() {
            return Err(wrong("is given twice"));
        }
    }
    Ok(map)
}

/// NaN and infinities, which JSON does not have but some programs write.
fn not_a_number(text: &str, offset: usize) -> Option<&'static str> {
    let from = text.get(offset..)?;
    let before = text.get(..offset)?;
    [("NaN", "NaN"), ("Infinity", "Infinity")]
        .into_iter()
        .find(|(word, _)| from.starts_with(word) || (from.starts_with('-') && from[1..].starts_with(word)))
        .map(|(_, name)| name)
        .or_else(|| (before.ends_with('-') && from.starts_with("Infinity")).then_some("Infinity"))
}

/// The line of the field with these keys from the outermost object down.
#[must_use]
pub fn line_of(text: &str, keys: &[&str]) -> Option<usize> {
    let mut scan = Scan::default();
    for (offset, &byte) in text.as_bytes().iter().enumerate() {
        scan.step(text, offset, byte);
        if scan.path.len() == keys.len() && scan.path.iter().zip(keys).all(|(step, key)| step.is_key(key)) {
            return Some(line_at(text, offset));
        }
    }
    None
}

/// Steps of a path that are told of its beginning and of its end.
const STEPS_SHOWN: usize = 60;

/// The field that the byte at `offset` belongs to, as in `rotations.torso[2]`.
fn field_at(text: &str, offset: usize) -> Option<String> {
    let mut scan = Scan::default();
    for (offset, &byte) in text.as_bytes()[..offset].iter().enumerate() {
        scan.step(text, offset, byte);
    }
    let mut out = String::new();
    // Of a deep path the ends: the message shows no more.
    let middle = STEPS_SHOWN..scan.path.len().saturating_sub(STEPS_SHOWN);
    for (_, step) in scan.path.iter().enumerate().filter(|(index, _)| !middle.contains(index)) {
        match step {
            PathStep::Key(Some(key)) if out.is_empty() => out.push_str(key),
            PathStep::Key(Some(key)) => out.extend([".", key]),
            PathStep::Key(None) => {}
            PathStep::Index(index) => out.push_str(&format!("[{index}]")),
        }
    }
    (!out.is_empty()).then_some(out)
}

#[derive(Debug)]
enum PathStep<'a> {
    Key(Option<&'a str>),
    Index(usize),
}

impl PathStep<'_> {
    fn is_key(&self, key: &str) -> bool {
        matches!(self, Self::Key(Some(found)) if *found == key)
    }
}

/// Follows brackets, keys and commas; forgives everything else.
#[derive(Debug, Default)]
struct Scan<'a> {
    path: Vec<PathStep<'a>>,
    string_start: Option<usize>,
    escaped: bool,
}

impl<'a> Scan<'a> {
    fn step(&mut self, text: &'a str, offset: usize, byte: u8) {
        if let Some(start) = self.string_start {
            match byte {
                _ if self.escaped => self.escaped = false,
                b'\\' => self.escaped = true,
                b'"' => {
                    self.string_start = None;
                    if let Some(PathStep::Key(key @ None)) = self.path.last_mut() {
                        *key = text.get(start..offset);
                    }
                }
                _ => {}
            }
            return;
        }
        match byte {
            b'"' => self.string_start = Some(offset + 1),
            b'{' => self.path.push(PathStep::Key(None)),
            b'[' => self.path.push(PathStep::Index(0)),
            b'}' | b']' => {
                self.path.pop();
            }
            b',' => match self.path.last_mut() {
                Some(PathStep::Key(key)) => *key = None,
                Some(PathStep::Index(index)) => *index += 1,
                None => {}
            },
            _ => {}
        }
    }
}

/// An object's entries in the order of the file. A key given twice is an error.
#[derive(Debug)]
pub struct Entries<T>(
    /// Keys and values.
    pub Vec<(String, T)>,
);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for EntriesVisitor<T> {
            type Value = Entries<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut seen = std::collections::BTreeSet::new();
                let mut entries = Vec::new();
                while let Some(key) = map.next_key::<String>()? {
                    if !seen.insert(key.clone()) {
                        return Err(serde::de::Error::custom(format_args!("\"{key}\" is given twice")));
                    }
                    entries.push((key, map.next_value()?));
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(EntriesVisitor(PhantomData))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only errors are looked at")]
    struct Sample {
        name: String,
        turns: Entries<[f64; 2]>,
    }

    #[test]
    fn errors_name_line_and_field() {
        assert_refused(
            "",
            |text| parse::<Sample>(Path::new("s.json"), text),
            r#"
            {\n"name": "a",\n"turns": {"x": [1, NaN]}} ⇒ line 3: is not valid JSON: in `turns.x[1]`: NaN
            {"name": "a", "turns": {"x":\n [1, -Infinity]}} ⇒ line 2: is not valid JSON: in `turns.x[1]`: Inf
            {"name": "a", "turns": {"x": [1, null]}} ⇒ `turns.x[1]` is null; expected a number
            {"name": "a",\n "turns": {"x,\"{": ["b", 2]}} ⇒ `turns.x,\"{[0]` is "b"; expected a number
            {"name": 3} ⇒ `name` is 3; expected a text
            {\n"nmae": 3} ⇒ line 2: unknown field `nmae`
            {"turns": {"x": [1, 2], "x": [1, 2]}} ⇒ in `turns`: "x" is given twice
            {"name": "a", "turns": {"x": [1, 2 ⇒ in `turns.x[1]`: the text ends too early
            \n ⇒ the text ends too early
            "#,
        );
    }

    #[test]
    fn fields_are_found_again() {
        let text = "{\n\"a\": {\"c\": [1,\n2]},\n\"b\": {\n\"c\": 3}}";
        assert_eq!(line_of(text, &["b", "c"]), Some(5));
        assert_eq!(line_of(text, &["a", "c"]), Some(2));
        assert_eq!(line_of(text, &["c"]), None);
    }
}
