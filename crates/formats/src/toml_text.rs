//! TOML with errors that name the line.

use std::path::Path;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use super::text::line_at;
use super::{FileError, FileProblem, Result, TextFormat, plain_words};

/// Checks the `format` key, then parses the whole text.
pub(super) fn parse_versioned<T: DeserializeOwned>(
    path: &Path,
    text: &str,
    expected: &'static str,
) -> Result<T> {
    let failed = |error: &toml::de::Error, field: Option<String>| {
        let problem = plain_words::problem(TextFormat::Toml, field, error.message());
        FileError::new(path, problem).at_line(error.span().map(|span| line_at(text, span.start)))
    };
    let table = DeTable::parse(text).map_err(|error| failed(&error, None))?;
    let format = table.get_ref().get("format");
    let found = match format.map(|value| value.get_ref()) {
        Some(DeValue::String(found)) if found == expected => {
            return toml::from_str(text).map_err(|error| {
                let field = error.span().and_then(|span| field_at(table.get_ref(), span.start));
                failed(&error, field)
            });
        }
        Some(DeValue::String(found)) => format!("\"{found}\""),
        Some(other) => other.type_str().to_owned(),
        None => "missing".to_owned(),
    };
    let line = format.map(|value| line_at(text, value.span().start));
    Err(FileError::new(path, FileProblem::Format { found, expected }).at_line(line))
}

/// The field that holds the byte at `offset`, as in `limb[2].radius`: the innermost one. Of a key, the table that has it.
fn field_at(table: &DeTable<'_>, offset: usize) -> Option<String> {
    let mut waiting: Vec<(String, &DeTable<'_>)> = vec![(String::new(), table)];
    let mut innermost: Option<(usize, String)> = None;
    // Tables may have their heads far from their parents', so all are looked at.
    while let Some((path, table)) = waiting.pop() {
        for (key, value) in table.iter() {
            if key.span().contains(&offset) {
                return Some(path).filter(|path| !path.is_empty());
            }
            let dot = if path.is_empty() { "" } else { "." };
            let mut items = vec![(format!("{path}{dot}{}", key.get_ref()), value)];
            while let Some((path, value)) = items.pop() {
                let span = value.span();
                if span.contains(&offset) && innermost.as_ref().is_none_or(|(length, _)| span.len() < *length)
                {
                    innermost = Some((span.len(), path.clone()));
                }
                match value.get_ref() {
                    DeValue::Table(table) => waiting.push((path, table)),
                    DeValue::Array(array) => {
                        items.extend(
                            array.iter().enumerate().map(|(at, item)| (format!("{path}[{at}]"), item)),
                        );
                    }
                    _ => {}
                }
            }
        }
    }
    innermost.map(|(_, path)| path)
}

/// One step down into a TOML text.
#[derive(Debug, Clone, Copy)]
pub(super) enum TomlStep<'a> {
    /// The value of a key.
    Key(&'a str),
    /// The last table of an array whose `name` is this.
    Named(&'a str),
}

/// The line of the deepest of these steps that the text has.
pub(super) fn line_of(text: &str, steps: &[TomlStep<'_>]) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    let mut offset = None;
    let mut value = DeValue::Table(table.into_inner());
    for step in steps {
        let next = match (step, &value) {
            (TomlStep::Key(key), DeValue::Table(table)) => {
                table.get_key_value(*key).map(|(key, value)| (key.span(), value))
            }
            (TomlStep::Named(name), DeValue::Array(array)) => array
                .iter()
                .rfind(|item| item.get_ref().get("name").and_then(|v| v.get_ref().as_str()) == Some(name))
                .map(|item| (item.span(), item)),
            _ => None,
        };
        let Some((span, next)) = next else { break };
        offset = Some(span.start);
        value = next.get_ref().clone();
    }
    offset.map(|offset| line_at(text, offset))
}
