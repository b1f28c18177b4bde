//! `OpenCV`'s `FileStorage` as XML, brought to the same tree as its YAML.

use std::path::Path;

use roxmltree::{Document, ParsingOptions};

use super::node::{MAX_DEPTH, MAX_KEYS, MAX_NODES, Node, Value};
use crate::{FileError, FileProblem, TextFormat};

/// Most XML nodes that are read.
const MAX_XML_NODES: u32 = 200_000;

/// Most attributes of an element: the library compares each with all the others.
const MAX_ATTRIBUTES: usize = 256;

/// The document of an XML text.
///
/// # Errors
/// Not XML, or more nodes or attributes than any calibration has.
pub(super) fn document<'a>(path: &Path, text: &'a str) -> Result<Document<'a>, FileError> {
    // No tag and no attribute holds a `<`.
    let mut line = 1;
    for tag in text.split('<') {
        if tag.bytes().filter(|&byte| byte == b'=').count() > MAX_ATTRIBUTES && !tag.starts_with('!') {
            let message = format!("more than {MAX_ATTRIBUTES} attributes in one element");
            let problem = FileProblem::Syntax { format: TextFormat::Xml, field: None, message };
            return Err(FileError::new(path, problem).at_line(Some(line)));
        }
        line += tag.bytes().filter(|&byte| byte == b'\n').count();
    }
    let limits = ParsingOptions { nodes_limit: MAX_XML_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, limits).map_err(|error| {
        let problem =
            FileProblem::Syntax { format: TextFormat::Xml, field: None, message: error.to_string() };
        FileError::new(path, problem).at_line(Some(error.pos().row as usize))
    })
}

/// The name of the outermost element, without reading the rest.
pub(super) fn root_name(text: &str) -> &str {
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = comment.find("-->").map_or("", |end| &comment[end..]);
        } else if !rest.starts_with(['?', '!']) {
            let end = rest.find(|c: char| c.is_whitespace() || c == '>' || c == '/').unwrap_or(rest.len());
            return &rest[..end];
        }
    }
    ""
}

/// The tree of a `FileStorage`.
pub(super) fn parse(path: &Path, text: &str) -> Result<Node, FileError> {
    let document = document(path, text)?;
    let mut words = 0;
    tree(path, document.root_element(), 0, &mut words)
}

fn tree(
    path: &Path,
    element: roxmltree::Node<'_, '_>,
    depth: usize,
    words: &mut usize,
) -> Result<Node, FileError> {
    let line = element.document().text_pos_at(element.range().start).row as usize;
    let syntax = |message: String| {
        let problem = FileProblem::Syntax { format: TextFormat::Xml, field: None, message };
        FileError::new(path, problem).at_line(Some(line))
    };
    if depth > MAX_DEPTH {
        return Err(syntax(format!("more than {MAX_DEPTH} levels")));
    }
    let children: Vec<_> = element.children().filter(roxmltree::Node::is_element).collect();
    let value = if children.is_empty() {
        let mut items = tokens(element.text().unwrap_or_default(), line);
        *words += items.len();
        if *words > MAX_NODES {
            return Err(syntax(format!("more than {MAX_NODES} values")));
        }
        match items.len() {
            0 => Value::Null,
            1 => items.remove(0).value,
            _ => Value::List(items),
        }
    } else if children[0].has_tag_name("_") {
        let items = children.into_iter().map(|child| tree(path, child, depth + 1, words));
        Value::List(items.collect::<Result<_, _>>()?)
    } else {
        if children.len() > MAX_KEYS {
            return Err(syntax(format!("more than {MAX_KEYS} keys in one table")));
        }
        let mut entries = Vec::with_capacity(children.len());
        let mut names = std::collections::BTreeSet::new();
        for child in children {
            let name = child.tag_name().name();
            if !names.insert(name) {
                let problem = FileProblem::Duplicate { field: name.to_owned() };
                return Err(FileError::new(path, problem).at_line(Some(line)));
            }
            entries.push((name.to_owned(), tree(path, child, depth + 1, words)?));
        }
        Value::Map(entries)
    };
    Ok(Node { line, value })
}

/// Words between spaces; those in quotes may have spaces in them.
fn tokens(text: &str, line: usize) -> Vec<Node> {
    let mut items = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (value, after) = match rest.strip_prefix('"') {
            Some(quoted) => {
                let end = quoted.find('"').unwrap_or(quoted.len());
                (Value::Text(quoted[..end].to_owned()), quoted.get(end + 1..).unwrap_or_default())
            }
            None => {
                let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
                (Value::Plain(rest[..end].to_owned()), &rest[end..])
            }
        };
        items.push(Node { line, value });
        rest = after.trim_start();
    }
    items
}
