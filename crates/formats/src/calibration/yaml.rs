//! The YAML that cameras are written in: OpenCV's dialect, the plain one of Kalibr and ROS, and JSON, which is part
//! of it.
//!
//! Read are block maps and lists by indentation, flow `[…]` and `{…}` over lines, quoted and plain scalars of one
//! line, comments, `%YAML` headers of any release, and tags, which are passed over. Only the first document is read.
//! Anchors, block texts (`|`, `>`) and texts over several lines are errors.

use std::collections::BTreeSet;
use std::path::Path;

use super::node::{MAX_DEPTH, MAX_KEYS, MAX_NODES, Node, Value};
use crate::{FileError, FileProblem, TextFormat};

/// Parses a text.
///
/// # Errors
/// Not this part of YAML, too deep, or too many values. The error names the line.
pub(super) fn parse(path: &Path, text: &str) -> Result<Node, FileError> {
    let mut reader = Reader { path, bytes: text.as_bytes(), text, at: 0, line: 1, start: 0, nodes: 0 };
    reader.header();
    let node = reader.block(0, 0)?;
    reader.blank();
    if reader.at < reader.bytes.len() && !reader.at_document_end() {
        return Err(reader.error("expected the end, or a key in line with the first"));
    }
    Ok(node)
}

struct Reader<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    text: &'a str,
    at: usize,
    line: usize,
    /// Where the line starts.
    start: usize,
    nodes: usize,
}

impl Reader<'_> {
    fn error(&self, message: &str) -> FileError {
        let message = message.to_owned();
        let problem = FileProblem::Syntax { format: TextFormat::Yaml, field: None, message };
        FileError::new(self.path, problem).at_line(Some(self.line))
    }

    fn peek(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(b'\n')
    }

    fn column(&self) -> usize {
        self.at - self.start
    }

    fn node(&mut self, line: usize, value: Value) -> Result<Node, FileError> {
        self.nodes += 1;
        if self.nodes > MAX_NODES {
            return Err(self.error(&format!("more than {MAX_NODES} values")));
        }
        if matches!(&value, Value::Map(entries) if entries.len() > MAX_KEYS) {
            return Err(self.error(&format!("more than {MAX_KEYS} keys in one table")));
        }
        Ok(Node { line, value })
    }

    /// Goes past spaces and a comment, not past the end of the line.
    fn spaces(&mut self) {
        while matches!(self.bytes.get(self.at), Some(b' ' | b'\t' | b'\r')) {
            self.at += 1;
        }
        let is_apart = self.at == 0 || matches!(self.bytes[self.at - 1], b' ' | b'\t' | b'\n');
        if is_apart && self.bytes.get(self.at) == Some(&b'#') {
            while self.at < self.bytes.len() && self.bytes[self.at] != b'\n' {
                self.at += 1;
            }
        }
    }

    /// Goes past spaces, comments and ends of lines.
    fn blank(&mut self) {
        loop {
            self.spaces();
            if self.bytes.get(self.at) != Some(&b'\n') {
                return;
            }
            self.at += 1;
            self.line += 1;
            self.start = self.at;
        }
    }

    fn header(&mut self) {
        loop {
            self.blank();
            let rest = &self.bytes[self.at..];
            if self.column() == 0 && (rest.starts_with(b"%") || rest.starts_with(b"---")) {
                let is_start = rest.starts_with(b"---");
                while self.at < self.bytes.len() && self.bytes[self.at] != b'\n' {
                    self.at += 1;
                }
                if !is_start {
                    continue;
                }
                self.blank();
            }
            return;
        }
    }

    fn at_document_end(&self) -> bool {
        let rest = &self.bytes[self.at..];
        self.column() == 0 && (rest.starts_with(b"---") || rest.starts_with(b"..."))
    }

    fn is_over(&self) -> bool {
        self.at >= self.bytes.len() || self.at_document_end()
    }

    fn is_dash(&self) -> bool {
        self.peek(0) == b'-' && matches!(self.peek(1), b' ' | b'\n' | b'\r' | b'\t')
    }

    /// Where the colon is, if a key stands here.
    fn key_end(&self) -> Option<usize> {
        let mut at = self.at;
        match self.peek(0) {
            b'[' | b'{' => return None,
            quote @ (b'"' | b'\'') => {
                at += 1;
                while at < self.bytes.len() && self.bytes[at] != quote {
                    at += if self.bytes[at] == b'\\' && quote == b'"' { 2 } else { 1 };
                }
            }
            _ => {}
        }
        while at < self.bytes.len() && self.bytes[at] != b'\n' {
            let next = self.bytes.get(at + 1).copied().unwrap_or(b'\n');
            match self.bytes[at] {
                b':' if matches!(next, b' ' | b'\n' | b'\r' | b'\t') => return Some(at),
                b'#' if at > 0 && self.bytes[at - 1] == b' ' => return None,
                _ => at += 1,
            }
        }
        None
    }

    /// What stands here and below, no further left than `indent`.
    fn block(&mut self, indent: usize, depth: usize) -> Result<Node, FileError> {
        if depth > MAX_DEPTH {
            return Err(self.error(&format!("more than {MAX_DEPTH} levels")));
        }
        self.blank();
        let (line, column) = (self.line, self.column());
        if self.is_over() || column < indent {
            return self.node(line, Value::Null);
        }
        if self.is_dash() {
            self.block_list(column, depth)
        } else if self.key_end().is_some() {
            self.block_map(column, depth)
        } else {
            self.inline(depth)
        }
    }

    fn block_map(&mut self, column: usize, depth: usize) -> Result<Node, FileError> {
        let first = self.line;
        let mut entries = Vec::new();
        let mut keys = BTreeSet::new();
        loop {
            self.blank();
            if self.is_over() || self.column() < column {
                break;
            }
            let Some(end) = self.key_end().filter(|_| self.column() == column) else {
                return Err(self.error("expected `key: value`, in line with the key above"));
            };
            let key = if matches!(self.peek(0), b'"' | b'\'') {
                self.quoted()?
            } else {
                self.text.get(self.at..end).unwrap_or_default().trim_end().to_owned()
            };
            if !keys.insert(key.clone()) {
                let problem = FileProblem::Duplicate { field: key };
                return Err(FileError::new(self.path, problem).at_line(Some(self.line)));
            }
            self.at = end + 1;
            entries.push((key, self.after_key(column, depth)?));
        }
        self.node(first, Value::Map(entries))
    }

    /// The value of a key that stands at `column`.
    fn after_key(&mut self, column: usize, depth: usize) -> Result<Node, FileError> {
        let line = self.line;
        self.tag();
        if !matches!(self.bytes.get(self.at), None | Some(b'\n')) {
            return self.inline(depth + 1);
        }
        self.blank();
        if self.is_over() || self.column() < column || self.column() == column && !self.is_dash() {
            return self.node(line, Value::Null);
        }
        // A list may stand in line with its key.
        self.block(column, depth + 1)
    }

    fn block_list(&mut self, column: usize, depth: usize) -> Result<Node, FileError> {
        let first = self.line;
        let mut items = Vec::new();
        loop {
            self.blank();
            if self.is_over() || self.column() != column || !self.is_dash() {
                break;
            }
            self.at += 1;
            let line = self.line;
            self.tag();
            if matches!(self.bytes.get(self.at), None | Some(b'\n')) {
                self.blank();
                if self.is_over() || self.column() <= column {
                    items.push(self.node(line, Value::Null)?);
                    continue;
                }
            }
            items.push(self.block(column + 1, depth + 1)?);
        }
        self.node(first, Value::List(items))
    }

    /// Goes past spaces and a tag such as `!!opencv-matrix`.
    fn tag(&mut self) {
        self.spaces();
        if self.peek(0) == b'!' {
            while !matches!(self.peek(0), b' ' | b'\n' | b'\r' | b'\t') {
                self.at += 1;
            }
            self.spaces();
        }
    }

    /// A value that starts in this line; nothing may follow it there.
    fn inline(&mut self, depth: usize) -> Result<Node, FileError> {
        let node = match self.peek(0) {
            b'[' | b'{' | b'"' | b'\'' => self.flow(depth)?,
            b'&' | b'*' | b'|' | b'>' => {
                return Err(self.error("anchors and texts over several lines are not read here"));
            }
            _ => self.plain(b"")?,
        };
        self.spaces();
        if !matches!(self.bytes.get(self.at), None | Some(b'\n')) {
            return Err(self.error("expected the end of the line after a value"));
        }
        Ok(node)
    }

    /// A word or number, up to one of these bytes, a comment or the end of the line.
    fn plain(&mut self, ends: &[u8]) -> Result<Node, FileError> {
        let from = self.at;
        while self.at < self.bytes.len() {
            let byte = self.bytes[self.at];
            let is_comment = byte == b'#' && self.at > from && self.bytes[self.at - 1] == b' ';
            if byte == b'\n' || is_comment || ends.contains(&byte) {
                break;
            }
            self.at += 1;
        }
        let word = self.text.get(from..self.at).unwrap_or_default().trim();
        if word.is_empty() {
            return Err(self.error("expected a value"));
        }
        let value = if matches!(word, "null" | "~") { Value::Null } else { Value::Plain(word.to_owned()) };
        self.node(self.line, value)
    }

    /// A value inside brackets, or brackets.
    fn flow(&mut self, depth: usize) -> Result<Node, FileError> {
        if depth > MAX_DEPTH {
            return Err(self.error(&format!("more than {MAX_DEPTH} levels")));
        }
        self.tag();
        let line = self.line;
        match self.peek(0) {
            b'[' => {
                let mut items = Vec::new();
                self.at += 1;
                while self.goes_on(b']', items.is_empty())? {
                    items.push(self.flow(depth + 1)?);
                }
                self.node(line, Value::List(items))
            }
            b'{' => {
                let mut entries = Vec::new();
                let mut keys = BTreeSet::new();
                self.at += 1;
                while self.goes_on(b'}', entries.is_empty())? {
                    let key = self.flow_key()?;
                    if !keys.insert(key.clone()) {
                        let problem = FileProblem::Duplicate { field: key };
                        return Err(FileError::new(self.path, problem).at_line(Some(self.line)));
                    }
                    self.blank();
                    entries.push((key, self.flow(depth + 1)?));
                }
                self.node(line, Value::Map(entries))
            }
            b'"' | b'\'' => {
                let text = self.quoted()?;
                self.node(line, Value::Text(text))
            }
            _ => self.plain(b",]}"),
        }
    }

    /// Goes past the comma between items; whether one follows before `end`, which is passed.
    fn goes_on(&mut self, end: u8, is_first: bool) -> Result<bool, FileError> {
        self.blank();
        if !is_first && self.bytes.get(self.at) == Some(&b',') {
            self.at += 1;
            self.blank();
        } else if !is_first && self.bytes.get(self.at).is_some_and(|&found| found != end) {
            return Err(self.error("expected a comma or the closing bracket"));
        }
        match self.bytes.get(self.at) {
            None => Err(self.error("the text ends inside brackets")),
            Some(&found) if found == end => {
                self.at += 1;
                Ok(false)
            }
            Some(_) => Ok(true),
        }
    }

    fn flow_key(&mut self) -> Result<String, FileError> {
        let key = if matches!(self.peek(0), b'"' | b'\'') {
            self.quoted()?
        } else {
            let from = self.at;
            while !matches!(self.peek(0), b':' | b',' | b'}' | b'\n') {
                self.at += 1;
            }
            self.text.get(from..self.at).unwrap_or_default().trim().to_owned()
        };
        self.blank();
        if self.bytes.get(self.at) != Some(&b':') {
            return Err(self.error("expected a colon after a key"));
        }
        self.at += 1;
        Ok(key)
    }

    fn quoted(&mut self) -> Result<String, FileError> {
        let quote = self.peek(0);
        let mut out = String::new();
        let mut rest = self.text.get(self.at + 1..).unwrap_or_default().char_indices();
        while let Some((index, found)) = rest.next() {
            match found {
                '\n' => break,
                '\\' if quote == b'"' => match rest.next() {
                    Some((_, 'n')) => out.push('\n'),
                    Some((_, 't')) => out.push('\t'),
                    Some((_, 'u')) => {
                        let digits: String = rest.by_ref().take(4).map(|(_, digit)| digit).collect();
                        let code = u32::from_str_radix(&digits, 16).ok().and_then(char::from_u32);
                        out.push(code.unwrap_or('\u{fffd}'));
                    }
                    Some((_, other)) => out.push(other),
                    None => break,
                },
                _ if found == char::from(quote) => {
                    self.at += 1 + index + 1;
                    return Ok(out);
                }
                _ => out.push(found),
            }
        }
        Err(self.error("a text in quotes does not end in its line"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<String, String> {
        parse(Path::new("c.yml"), text).map(|node| show(&node)).map_err(|error| error.to_string())
    }

    fn show(node: &Node) -> String {
        match &node.value {
            Value::Null => "~".to_owned(),
            Value::Plain(text) => text.clone(),
            Value::Text(text) => format!("{text:?}"),
            Value::List(items) => format!("[{}]", items.iter().map(show).collect::<Vec<_>>().join(",")),
            Value::Map(entries) => {
                let entries: Vec<_> =
                    entries.iter().map(|(key, node)| format!("{key}:{}", show(node))).collect();
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
            ("", "~"),
        ];
        for (text, expected) in cases {
            assert_eq!(read(text).unwrap(), expected, "{text:?}");
        }
    }

    #[test]
    fn errors_name_the_line() {
        let deep = "[".repeat(100);
        let cases = [
            ("a: [1, 2\n", "line 2: is not valid YAML: the text ends inside brackets"),
            ("a: 1\n  b: 2\n", "line 2: is not valid YAML: expected `key: value`, in line"),
            ("a: 1\na: 2\n", "line 2: `a` is given twice"),
            ("a: [1 2]\nb: [[1][2]]", "line 2: is not valid YAML: expected a comma"),
            ("a: &b 1\n", "line 1: is not valid YAML: anchors"),
            ("a: \"b\n", "line 1: is not valid YAML: a text in quotes"),
            (&deep, "more than 32 levels"),
        ];
        for (text, expected) in cases {
            let message = read(text).unwrap_err();
            assert!(message.contains(expected), "{message:?}: {expected:?}");
        }
    }
}
