//! The YAML that cameras are written in: OpenCV's dialect and the plain one of Kalibr and ROS.
//!
//! Only the first document is read, and tags are ignored. Anchors and texts over several lines are errors. OpenCV leaves
//! out the space behind a colon in `{ x:3 }`.

use std::collections::BTreeSet;
use std::path::Path;

use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Span};

use super::tree::{MAX_DEPTH, MAX_KEYS, MAX_NODES, Tree, Value};
use crate::{FileProblem, Result, TextFormat};

/// Parses a text.
pub(super) fn parse(path: &Path, text: &str) -> Result<Tree> {
    let mut open = OpenValues { path, open: Vec::new(), nodes: 0 };
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error: ScanError| {
            let line = error.marker().line();
            let ends = if line > text.lines().count() { "the text ends too early: " } else { "" };
            FileProblem::syntax(TextFormat::Yaml, format!("{ends}{}", error.info())).at(path, line)
        })?;
        if let Some(whole) = open.event(event, span)? {
            return Ok(whole);
        }
    }
    Ok(Tree { line: 1, value: Value::Null })
}

/// Lists and maps that have not ended yet, the outermost first.
struct OpenValues<'a> {
    path: &'a Path,
    open: Vec<OpenValue>,
    nodes: usize,
}

struct OpenValue {
    line: usize,
    value: Value,
    /// The key of a map whose value comes next, and all keys.
    key: Option<Tree>,
    keys: BTreeSet<String>,
}

impl OpenValues<'_> {
    fn error<T>(&self, line: usize, message: impl Into<String>) -> Result<T> {
        Err(FileProblem::syntax(TextFormat::Yaml, message).at(self.path, line))
    }

    /// The whole document, once it has ended.
    fn event(&mut self, event: Event<'_>, span: Span) -> Result<Option<Tree>> {
        const ANCHOR: &str = "anchors are not read here";
        const LINES: &str =
            "texts over several lines are not read here; expected `key: value`, in line with the key above";
        let line = span.start.line();
        match event {
            Event::Alias(_) => self.error(line, ANCHOR),
            Event::Scalar(_, _, anchor, _)
            | Event::SequenceStart(anchor, _)
            | Event::MappingStart(anchor, _)
                if anchor != 0 =>
            {
                self.error(line, ANCHOR)
            }
            Event::Scalar(text, style, ..) => {
                let value = match style {
                    ScalarStyle::Plain if matches!(&*text, "" | "~" | "null") => Value::Null,
                    _ if span.end.line() != line => return self.error(span.end.line(), LINES),
                    ScalarStyle::Plain => Value::Plain(text.into_owned()),
                    _ => Value::Text(text.into_owned()),
                };
                self.push(Tree { line, value })
            }
            Event::SequenceStart(..) => self.begin(line, Value::List(Vec::new())),
            Event::MappingStart(..) => self.begin(line, Value::Map(Vec::new())),
            Event::SequenceEnd | Event::MappingEnd => match self.open.pop() {
                Some(OpenValue { line, value, .. }) => self.push(Tree { line, value }),
                None => Ok(None),
            },
            _ => Ok(None),
        }
    }

    fn begin(&mut self, line: usize, value: Value) -> Result<Option<Tree>> {
        if self.open.len() >= MAX_DEPTH {
            return self.error(line, format!("more than {MAX_DEPTH} levels"));
        }
        self.open.push(OpenValue { line, value, key: None, keys: BTreeSet::new() });
        Ok(None)
    }

    /// Puts a value where it belongs; the outermost one is given back.
    fn push(&mut self, tree: Tree) -> Result<Option<Tree>> {
        self.nodes += 1;
        if self.nodes > MAX_NODES {
            return self.error(tree.line, format!("more than {MAX_NODES} values"));
        }
        let Some(open) = self.open.last_mut() else { return Ok(Some(tree)) };
        let entries = match &mut open.value {
            Value::Map(entries) => entries,
            Value::List(items) => {
                items.push(tree);
                return Ok(None);
            }
            _ => return Ok(None),
        };
        let Some(key) = open.key.take() else {
            open.key = Some(tree);
            return Ok(None);
        };
        let line = key.line;
        let (key, tree) = match (key.value, tree.value) {
            (Value::Plain(pair), Value::Null) if pair.contains(':') => {
                let (key, value) = pair.split_once(':').unwrap_or_default();
                (key.to_owned(), Tree { line, value: Value::Plain(value.to_owned()) })
            }
            (Value::Plain(key) | Value::Text(key), value) => (key, Tree { line: tree.line, value }),
            (Value::Null, value) => ("null".to_owned(), Tree { line: tree.line, value }),
            _ => return self.error(line, "expected a text as a key"),
        };
        if !open.keys.insert(key.clone()) {
            return Err(FileProblem::Duplicate { field: key }.at(self.path, line));
        }
        entries.push((key, tree));
        if entries.len() > MAX_KEYS {
            return self.error(line, format!("more than {MAX_KEYS} keys in one table"));
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    fn read(text: &str) -> Result<String, String> {
        parse(Path::new("c.yml"), text).map(|tree| show(&tree)).map_err(|error| error.to_string())
    }

    fn show(tree: &Tree) -> String {
        match &tree.value {
            Value::Null => "~".to_owned(),
            Value::Plain(text) => text.clone(),
            Value::Text(text) => format!("{text:?}"),
            Value::List(items) => format!("[{}]", items.iter().map(show).collect::<Vec<_>>().join(",")),
            Value::Map(entries) => {
                let entries: Vec<_> =
                    entries.iter().map(|(key, tree)| format!("{key}:{}", show(tree))).collect();
                format!("{{{}}}", entries.join(","))
            }
        }
    }

    #[test]
    fn both_dialects_are_read() {
        let cases = [
            (
                "%YAML:1.0\n---\nK_1: !!opencv-matrix\n   rows: 1\n   data: [ 1., 2e+3,\n       -3. ]\nn: 2\n",
                "{K_1:{rows:1,data:[1.,2e+3,-3.]},n:2}",
            ),
            ("%YAML 1.2\n---\nnames:\n   - \"1\"\n   - b # why\n...\n", "{names:[\"1\",b]}"),
            (
                "cam0:\n  T:\n  - [0, 1]\n  - [2, 3]\n  shift:\n  size: [4, 5]\r\n",
                "{cam0:{T:[[0,1],[2,3]],shift:~,size:[4,5]}}",
            ),
            ("a:\n- - 1.0\n  - 2.0\n- - 3\n  - 4\n", "{a:[[1.0,2.0],[3,4]]}"),
            ("a:\n  - x: 1\n    y: 2\n  - { x:3, y:4 }\n", "{a:[{x:1,y:2},{x:3,y:4}]}"),
            ("{\"a\": [1, {\"b\": null}], \"c\": \"d\\u0041\"}", "{a:[1,{b:~}],c:\"dA\"}"),
            ("a: 1\n---\nb: 2\n", "{a:1}"),
            ("", "~"),
        ];
        for (text, expected) in cases {
            assert_eq!(read(text).unwrap(), expected, "{text:?}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        assert!(read(&"[".repeat(100)).unwrap_err().contains("more than 32 levels"));
        assert_refused(
            "",
            read,
            r#"
            a: [1, 2\n ⇒ line 2: is not valid YAML: the text ends too early: while parsing a flow sequence
            a: 1\n  b: 2\n ⇒ line 2: is not valid YAML: texts over several lines are not read here; expected `key: value`
            a: 1\na: 2\n ⇒ line 2: `a` is given twice
            a: [1 2]\nb: [[1][2]] ⇒ line 2: is not valid YAML: while parsing a flow sequence, expected ','
            a: &b 1\n ⇒ line 1: is not valid YAML: anchors
            a: 1\nb: c\n  d\n ⇒ line 3: is not valid YAML: texts over several lines
            a: "b\n ⇒ is not valid YAML:
            "#,
        );
    }
}
