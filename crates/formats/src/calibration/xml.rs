//! XML: elements whose errors name line and attribute, and `OpenCV`'s `FileStorage`, brought to the same tree as its
//! YAML.

use std::path::Path;
use std::str::FromStr;

use roxmltree::{Document, Node, ParsingOptions};

use super::tree::{MAX_DEPTH, MAX_KEYS, MAX_NODES, Tree, Value};
use crate::{FileError, FileProblem, Result, TextFormat};

/// Most XML nodes that are read.
const MAX_XML_NODES: u32 = 200_000;

/// Most attributes of an element: the library compares each with all the others.
const MAX_ATTRIBUTES: usize = 256;

/// The document of an XML text.
pub(super) fn document<'a>(path: &Path, text: &'a str) -> Result<Document<'a>> {
    // No tag and no attribute holds a `<`.
    let mut line = 1;
    for tag in text.split('<') {
        if tag.bytes().filter(|&byte| byte == b'=').count() > MAX_ATTRIBUTES && !tag.starts_with('!') {
            return Err(syntax(path, line, format!("more than {MAX_ATTRIBUTES} attributes in one element")));
        }
        line += tag.bytes().filter(|&byte| byte == b'\n').count();
    }
    let limits = ParsingOptions { nodes_limit: MAX_XML_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, limits)
        .map_err(|error| syntax(path, error.pos().row as usize, error.to_string()))
}

fn syntax(path: &Path, line: usize, message: String) -> FileError {
    FileProblem::syntax(TextFormat::Xml, message).at(path, line)
}

/// An element and its file.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'input> {
    pub(super) path: &'a Path,
    pub(super) node: Node<'a, 'input>,
}

impl<'a> Element<'a, '_> {
    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    pub(super) fn line(&self) -> usize {
        self.node.document().text_pos_at(self.node.range().start).row as usize
    }

    /// The error that something else stands in an attribute.
    pub(super) fn error(&self, attribute: &str, found: &str, expected: &str) -> FileError {
        let field = format!("{}.{attribute}", self.node.tag_name().name());
        FileProblem::field(field, found, expected).at(self.path, self.line())
    }

    /// The number in an attribute of the first child of this name.
    pub(super) fn child_number<T: FromStr>(&self, child: &str, attribute: &str) -> Result<T> {
        let node = self.node.children().find(|node| node.has_tag_name(child));
        let text = node.and_then(|node| node.attribute(attribute));
        text.and_then(|text| text.trim().parse().ok()).ok_or_else(|| {
            let found = text.map_or_else(|| "missing".to_owned(), |text| format!("{text:?}"));
            let line = Self { node: node.unwrap_or(self.node), ..*self }.line();
            FileProblem::field(format!("{child}.{attribute}"), found, "a number").at(self.path, line)
        })
    }

    /// The `N` finite numbers of an attribute.
    pub(super) fn numbers<const N: usize>(&self, attribute: &str) -> Result<[f64; N]> {
        let text = self.attribute(attribute);
        let text = text.ok_or_else(|| self.error(attribute, "missing", &format!("{N} numbers")))?;
        self.numbers_in(attribute, text)
    }

    /// The same from a part of the attribute's text.
    pub(super) fn numbers_in<const N: usize>(&self, attribute: &str, text: &str) -> Result<[f64; N]> {
        let words = text.split_ascii_whitespace();
        let numbers: Option<Vec<f64>> =
            words.map(|word| word.parse::<f64>().ok().filter(|number| number.is_finite())).collect();
        numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| self.error(attribute, &format!("\"{text}\""), &format!("{N} finite numbers")))
    }
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
pub(super) fn parse(path: &Path, text: &str) -> Result<Tree> {
    let document = document(path, text)?;
    tree(Element { path, node: document.root_element() }, 0, &mut 0)
}

fn tree(element: Element<'_, '_>, depth: usize, words: &mut usize) -> Result<Tree> {
    let Element { path, node } = element;
    let line = element.line();
    let too_many = |most: usize, what: &str| Err(syntax(path, line, format!("more than {most} {what}")));
    if depth > MAX_DEPTH {
        return too_many(MAX_DEPTH, "levels");
    }
    let children: Vec<_> = node.children().filter(Node::is_element).collect();
    let mut inner = |node| tree(Element { path, node }, depth + 1, words);
    let value = if children.is_empty() {
        let mut items = tokens(node.text().unwrap_or_default(), line);
        *words += items.len();
        if *words > MAX_NODES {
            return too_many(MAX_NODES, "values");
        }
        match items.len() {
            0 => Value::Null,
            1 => items.remove(0).value,
            _ => Value::List(items),
        }
    } else if children[0].has_tag_name("_") {
        Value::List(children.into_iter().map(inner).collect::<Result<_, _>>()?)
    } else {
        if children.len() > MAX_KEYS {
            return too_many(MAX_KEYS, "keys in one table");
        }
        let mut entries = Vec::with_capacity(children.len());
        let mut names = std::collections::BTreeSet::new();
        for child in children {
            let name = child.tag_name().name();
            if !names.insert(name) {
                return Err(FileProblem::Duplicate { field: name.to_owned() }.at(path, line));
            }
            entries.push((name.to_owned(), inner(child)?));
        }
        Value::Map(entries)
    };
    Ok(Tree { line, value })
}

/// Words between spaces; those in quotes may have spaces in them.
fn tokens(text: &str, line: usize) -> Vec<Tree> {
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
        items.push(Tree { line, value });
        rest = after.trim_start();
    }
    items
}
