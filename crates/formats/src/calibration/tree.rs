//! What YAML, XML, JSON and TOML files hold, in one form: a tree that knows its lines.

use std::path::Path;

use glam::DMat3;
use serde_json::value::RawValue;
use toml::de::{DeTable, DeValue};

use super::lens::rotation_from_vector;
use crate::json_text::{self, Entries};
use crate::text::line_at;
use crate::{FileError, FileProblem, Result, TextFormat, plain_words};

/// Deepest nesting that is read.
pub(super) const MAX_DEPTH: usize = 32;
/// Most values that are read from one file.
pub(super) const MAX_NODES: usize = 1_000_000;
/// Most keys of one table: they are looked for one after the other.
pub(super) const MAX_KEYS: usize = 4_000;

/// One value and its line.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    pub(super) line: usize,
    pub(super) value: Value,
}

#[derive(Debug, Clone)]
pub(super) enum Value {
    /// Nothing is given.
    Null,
    /// A word or number as it stands, without quotes.
    Plain(String),
    /// In quotes.
    Text(String),
    List(Vec<Tree>),
    Map(Vec<(String, Tree)>),
}

impl Tree {
    /// The entries of a map; none of anything else.
    pub(super) fn entries(&self) -> &[(String, Self)] {
        match &self.value {
            Value::Map(entries) => entries,
            _ => &[],
        }
    }

    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        self.entries().iter().find(|(found, _)| found == key).map(|(_, node)| node)
    }

    fn describe(&self) -> String {
        match &self.value {
            Value::Null => "missing".to_owned(),
            Value::Plain(text) => shortened(text),
            Value::Text(text) => format!("\"{}\"", shortened(text)),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Map(entries) => format!("a table of {}", entries.len()),
        }
    }
}

fn shortened(text: &str) -> String {
    let mut out: String = text.chars().take(40).collect();
    if out.len() < text.len() {
        out.push('…');
    }
    out
}

/// A value, its file and what it is called there.
#[derive(Debug, Clone)]
pub(super) struct Field<'a> {
    pub(super) path: &'a Path,
    /// Keys from the root, `cam0.intrinsics`; empty for the root.
    pub(super) name: String,
    pub(super) node: &'a Tree,
}

impl<'a> Field<'a> {
    pub(super) fn root(path: &'a Path, node: &'a Tree) -> Self {
        Self { path, name: String::new(), node }
    }

    fn name_of(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    /// All entries of a map, in their order.
    pub(super) fn children(&self) -> impl Iterator<Item = (&'a str, Self)> {
        let (path, node, name) = (self.path, self.node, self.name.clone());
        node.entries().iter().map(move |(key, child)| {
            let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
            (key.as_str(), Self { path, name, node: child })
        })
    }

    /// The items of a list, in their order.
    pub(super) fn items(&self) -> Vec<Self> {
        let Value::List(items) = &self.node.value else { return Vec::new() };
        let item = |(index, node)| Self { path: self.path, name: format!("{}[{index}]", self.name), node };
        items.iter().enumerate().map(item).collect()
    }

    /// The first of these keys that has a value.
    pub(super) fn find(&self, keys: &[&str]) -> Option<Self> {
        keys.iter().find_map(|key| {
            let node = self.node.get(key).filter(|node| !matches!(node.value, Value::Null))?;
            Some(Self { path: self.path, name: self.name_of(key), node })
        })
    }

    /// As [`find`](Self::find); the error names the first of the keys.
    pub(super) fn need(&self, keys: &[&str], expected: &str) -> Result<Self> {
        self.find(keys).ok_or_else(|| self.missing(keys.first().copied().unwrap_or_default(), expected))
    }

    /// The error that a key is not there.
    pub(super) fn missing(&self, key: &str, expected: &str) -> FileError {
        FileProblem::field(self.name_of(key), "missing", expected).at(self.path, self.node.line)
    }

    /// The error that something else stands here.
    pub(super) fn error(&self, found: &str, expected: &str) -> FileError {
        FileProblem::field(self.name.as_str(), found, expected).at(self.path, self.node.line)
    }

    /// The error that another count of numbers stands here.
    pub(super) fn other_count(&self, count: usize, expected: &str) -> FileError {
        self.error(&format!("{count} numbers"), expected)
    }

    pub(super) fn unexpected(&self, expected: &str) -> FileError {
        self.error(&self.node.describe(), expected)
    }

    pub(super) fn number(&self) -> Result<f64> {
        let number = match &self.node.value {
            Value::Plain(text) => text.parse::<f64>().ok().filter(|number| number.is_finite()),
            _ => None,
        };
        number.ok_or_else(|| self.unexpected("a finite number"))
    }

    /// A whole number of pixels; files may write it as 1088.0.
    pub(super) fn pixels(&self) -> Result<u64> {
        let number = self.number()?;
        if number < 0.0 || number.fract() != 0.0 || number > f64::from(u32::MAX) {
            return Err(self.unexpected("a whole number of pixels"));
        }
        Ok(number as u64)
    }

    /// A name: text, or a number as it stands.
    pub(super) fn text(&self) -> Result<&'a str> {
        match &self.node.value {
            Value::Plain(text) | Value::Text(text) => Ok(text),
            _ => Err(self.unexpected("a text")),
        }
    }

    /// Whether it is switched on; not there is off.
    pub(super) fn flag(&self, keys: &[&str]) -> bool {
        let flag = self.find(keys);
        flag.and_then(|flag| flag.text().ok())
            .is_some_and(|text| matches!(text, "1" | "true" | "True" | "yes"))
    }

    /// All numbers of a list, of lists of lists, or of an OpenCV matrix with `rows`, `cols` and `data`.
    pub(super) fn numbers(&self) -> Result<Vec<f64>> {
        if let Some(data) = self.find(&["data"]) {
            let numbers = data.numbers()?;
            let side = |key| self.find(&[key]).map(|side| side.pixels()).transpose();
            if let (Some(rows), Some(columns)) = (side("rows")?, side("cols")?)
                && rows.checked_mul(columns) != Some(numbers.len() as u64)
            {
                let expected = format!("{rows} × {columns} numbers");
                return Err(data.other_count(numbers.len(), &expected));
            }
            return Ok(numbers);
        }
        let mut numbers = Vec::new();
        self.collect(&mut numbers)?;
        Ok(numbers)
    }

    fn collect(&self, numbers: &mut Vec<f64>) -> Result<()> {
        match &self.node.value {
            Value::List(_) => self.items().iter().try_for_each(|item| item.collect(numbers)),
            _ => {
                numbers.push(self.number()?);
                Ok(())
            }
        }
    }

    /// Exactly `N` numbers.
    pub(super) fn array<const N: usize>(&self) -> Result<[f64; N]> {
        let numbers = self.numbers()?;
        let count = numbers.len();
        let array: Option<[f64; N]> = numbers.try_into().ok();
        array.ok_or_else(|| self.other_count(count, &format!("{N} numbers")))
    }

    /// Three by three, row after row.
    pub(super) fn matrix(&self) -> Result<DMat3> {
        Ok(DMat3::from_cols_array(&self.array::<9>()?).transpose())
    }

    /// A rotation as a matrix or as a vector along the axis with the angle's length.
    pub(super) fn rotation(&self) -> Result<DMat3> {
        let numbers = self.numbers()?;
        match *numbers.as_slice() {
            [x, y, z] => Ok(rotation_from_vector([x, y, z])),
            _ if numbers.len() == 9 => self.matrix(),
            _ => Err(self.other_count(numbers.len(), "a 3 × 3 matrix or a vector of three numbers")),
        }
    }
}

/// The tree of a TOML text, tables in the order of the file.
pub(super) fn from_toml(path: &Path, text: &str) -> Result<Tree> {
    let table = DeTable::parse(text).map_err(|error| {
        let problem = plain_words::problem(TextFormat::Toml, None, error.message());
        problem.at(path, error.span().map(|span| line_at(text, span.start)))
    })?;
    TextLines::new(path, text).toml_table(1, table.get_ref(), 0)
}

/// The tree of a JSON text, which is known to be one.
pub(super) fn from_json(path: &Path, text: &str) -> Result<Tree> {
    TextLines::new(path, text).json(json_text::parse(path, text)?, 0)
}

/// A text on its way to a tree, with the places where its lines end.
struct TextLines<'a> {
    path: &'a Path,
    text: &'a str,
    ends: Vec<usize>,
}

impl<'a> TextLines<'a> {
    fn new(path: &'a Path, text: &'a str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect();
        Self { path, text, ends }
    }

    fn line_at(&self, offset: usize) -> usize {
        1 + self.ends.partition_point(|end| *end < offset)
    }

    fn json(&self, raw: &'a RawValue, depth: usize) -> Result<Tree> {
        let text = raw.get();
        let line = self.line_at(text.as_ptr() as usize - self.text.as_ptr() as usize);
        self.check(TextFormat::Json, line, depth, 0)?;
        // All but keys that are given twice has been checked.
        let failed = |error: serde_json::Error| {
            let message = error.to_string();
            let key = message.strip_prefix('"').and_then(|rest| rest.rsplit_once("\" is given twice"));
            let problem = match key {
                Some((key, _)) => FileProblem::Duplicate { field: key.to_owned() },
                None => FileProblem::syntax(TextFormat::Json, message),
            };
            problem.at(self.path, line)
        };
        let value = match text.as_bytes().first() {
            Some(b'{') => {
                let entries: Entries<&RawValue> = serde_json::from_str(text).map_err(failed)?;
                self.check(TextFormat::Json, line, depth, entries.0.len())?;
                let entry = |(key, value): (String, &'a RawValue)| Ok((key, self.json(value, depth + 1)?));
                Value::Map(entries.0.into_iter().map(entry).collect::<Result<_>>()?)
            }
            Some(b'[') => {
                let items: Vec<&RawValue> = serde_json::from_str(text).map_err(failed)?;
                Value::List(
                    items.into_iter().map(|item| self.json(item, depth + 1)).collect::<Result<_, _>>()?,
                )
            }
            Some(b'"') => Value::Text(serde_json::from_str(text).map_err(failed)?),
            Some(b'n') => Value::Null,
            _ => Value::Plain(text.to_owned()),
        };
        Ok(Tree { line, value })
    }

    /// Whether a table is no deeper and has no more keys than is allowed.
    fn check(&self, format: TextFormat, line: usize, depth: usize, keys: usize) -> Result<()> {
        let message = if depth > MAX_DEPTH {
            format!("more than {MAX_DEPTH} levels")
        } else if keys > MAX_KEYS {
            format!("more than {MAX_KEYS} keys in one table")
        } else {
            return Ok(());
        };
        Err(FileProblem::syntax(format, message).at(self.path, line))
    }

    fn toml_table(&self, line: usize, table: &DeTable<'_>, depth: usize) -> Result<Tree> {
        self.check(TextFormat::Toml, line, depth, table.len())?;
        let mut keys: Vec<_> = table.iter().collect();
        keys.sort_by_key(|(key, _)| key.span().start);
        let entry = |(key, value): (&toml::Spanned<_>, &toml::Spanned<_>)| {
            let key_text: &std::borrow::Cow<'_, str> = key.get_ref();
            Ok((
                key_text.to_string(),
                self.toml_value(self.line_at(key.span().start), value.get_ref(), depth + 1)?,
            ))
        };
        Ok(Tree { line, value: Value::Map(keys.into_iter().map(entry).collect::<Result<_>>()?) })
    }

    fn toml_value(&self, line: usize, value: &DeValue<'_>, depth: usize) -> Result<Tree> {
        let value = match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            // Without underscores already; numbers of another radix are not expected in a calibration.
            DeValue::Integer(number) => Value::Plain(number.as_str().to_owned()),
            DeValue::Float(number) => Value::Plain(number.as_str().to_owned()),
            DeValue::Boolean(flag) => Value::Plain(flag.to_string()),
            DeValue::Datetime(moment) => Value::Text(moment.to_string()),
            DeValue::Array(items) => {
                let tree = |item: &toml::Spanned<DeValue<'_>>| {
                    self.toml_value(self.line_at(item.span().start), item.get_ref(), depth + 1)
                };
                Value::List(items.iter().map(tree).collect::<Result<_, _>>()?)
            }
            DeValue::Table(table) => return self.toml_table(line, table, depth),
        };
        Ok(Tree { line, value })
    }
}
