//! What parsers say of a value in their own language, in the words of `docs/formats.md`.

use crate::text::cut;
use crate::{FileProblem, TextFormat};

/// How a parser names what it wants, and how our documents do. The first that fits counts.
const KINDS: [(&str, &str); 29] = [
    ("a sequence of 3 f64", "three numbers"),
    ("a boolean", "true or false"),
    ("a string", "a text"),
    ("a borrowed string", "a text"),
    ("string or table", "a text"),
    ("a sequence", "a list"),
    ("sequence", "a list"),
    ("a map", "a table"),
    ("map", "a table"),
    ("null", "null"),
    ("unit value", "null"),
    ("u8", "a whole number from 0 to 255"),
    ("u16", "a whole number from 0 to 65535"),
    ("u32", "a whole number, 0 or above"),
    ("u64", "a whole number, 0 or above"),
    ("usize", "a whole number, 0 or above"),
    ("i32", "a whole number"),
    ("i64", "a whole number"),
    ("isize", "a whole number"),
    ("f32", "a number"),
    ("f64", "a number"),
    ("an array of length ", "a list of "),
    ("variant identifier", "one of the words that are known"),
    ("internally tagged enum ", "a table"),
    ("tuple struct Range", "two numbers"),
    ("tuple struct", "a list"),
    ("struct ", "a table"),
    ("option", "a value"),
    ("array of ", "a list of "),
];

/// What is wrong with a field of such a file, from a parser's message.
pub(crate) fn problem(format: TextFormat, field: Option<String>, message: &str) -> FileProblem {
    let message = message.trim().replace('\n', "; ");
    if let (Some((found, expected)), Some(field)) = (mismatch(&message), &field) {
        return FileProblem::Field { field: field.clone(), found, expected };
    }
    let missing = message.strip_prefix("missing field `").and_then(|rest| rest.split_once('`'));
    if let Some((name, _)) = missing {
        let whole = field.map_or_else(|| name.to_owned(), |field| format!("{field}.{name}"));
        return FileProblem::field(whole, "missing", "a value");
    }
    // Names that the format does not know stand in a text that is well formed.
    let is_well_formed =
        ["unknown field", "unknown variant", "duplicate field"].iter().any(|says| message.starts_with(says));
    let message = plain(&message);
    if is_well_formed {
        FileProblem::Schema { field, message }
    } else {
        FileProblem::Syntax { format, field, message }
    }
}

/// A parser's message in plain words, without line ends.
pub(crate) fn plain(message: &str) -> String {
    let message = message.trim().replace('\n', "; ");
    match mismatch(&message) {
        Some((found, expected)) => format!("is {found}; expected {expected}"),
        None => sentence(&message),
    }
}

/// What is there and what was expected, where a message says both.
fn mismatch(message: &str) -> Option<(String, String)> {
    if let Some(rest) = message.strip_prefix("invalid length ") {
        let (length, expected) = rest.split_once(", expected ")?;
        return Some((format!("{} long", cut(length)), kind(expected)));
    }
    let (what, rest) = message.split_once(": ")?;
    let (found, expected) = rest.rsplit_once(", expected ").or_else(|| rest.rsplit_once(" expected "))?;
    match what {
        "invalid type" | "invalid value" => Some((found_of(found), kind(expected))),
        _ => None,
    }
}

/// What a message that names no value says.
fn sentence(message: &str) -> String {
    for (says, means) in [
        ("EOF while parsing", "the text ends too early"),
        ("recursion limit exceeded", "it is nested too deeply"),
        ("value was too large", "the number is too large"),
        ("trailing characters", "there is text after the end"),
        ("wanted exactly 1 element", "expected one of the words that are known"),
    ] {
        if message.contains(says) {
            return means.to_owned();
        }
    }
    // Backticks round a name of the file, which may be long.
    let (Some(open), Some(close)) = (message.find('`'), message.rfind('`')) else {
        return message.to_owned();
    };
    let named = message.get(open + 1..close).unwrap_or_default();
    let first = named.split('`').next().unwrap_or_default();
    let rest = message.get(open + 1 + first.len()..).unwrap_or_default();
    let begins =
        message[..open].replace("unknown variant", "unknown word").replace("duplicate field", "given twice:");
    format!("{begins}`{}{}", cut(first), rest.replace(", expected", "; expected"))
}

/// What stands there: a value without its kind.
fn found_of(found: &str) -> String {
    let value = |kind: &str| found.strip_prefix(kind).map(|value| value.trim().trim_matches('`').to_owned());
    let numbers = ["integer ", "floating point ", "boolean ", "character "];
    if let Some(number) = numbers.iter().find_map(|kind| value(kind)) {
        return cut(&number).to_string();
    }
    if let Some(text) = found.strip_prefix("string ") {
        let text = text.trim_matches('"');
        return format!("\"{}\"", cut(text));
    }
    kind(found)
}

fn kind(expected: &str) -> String {
    let named =
        KINDS.iter().find(|(says, _)| expected == *says || says.ends_with(' ') && expected.starts_with(says));
    match named {
        Some((says, means)) if means.ends_with(' ') => format!("{means}{}", cut(&expected[says.len()..])),
        Some((_, means)) => (*means).to_owned(),
        None if expected.contains("struct") || expected.contains("$__") => {
            "a value of another kind".to_owned()
        }
        None if expected.contains("f64") || expected.contains("f32") => "numbers".to_owned(),
        None => cut(expected).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;
    use toml::Spanned;

    use super::*;
    use crate::damaged::assert_refused;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only errors are looked at")]
    struct Sample {
        count: Spanned<u64>,
        wide: bool,
        place: glam::DVec3,
        size: [u64; 2],
        word: Word,
        name: Spanned<String>,
        inner: Inner,
    }

    #[derive(Debug, Deserialize)]
    enum Word {
        #[serde(rename = "m")]
        Metres,
    }

    #[derive(Debug, Deserialize)]
    #[expect(dead_code, reason = "only errors are looked at")]
    struct Inner {
        range: (f64, f64),
    }

    const GOOD: &str = "count = 3\nwide = true\nplace = [1, 2, 3]\nsize = [1, 2]\nword = \"m\"\nname = \"a\"\ninner = { range = [1, 2] }\n";

    #[test]
    fn parsers_speak_plainly() {
        toml::from_str::<Sample>(GOOD).unwrap();
        let read = |text: &str| {
            toml::from_str::<Sample>(text).map(drop).map_err(|error| {
                let message = plain(error.message());
                let mut words = message.split(|letter: char| !letter.is_alphanumeric());
                let foreign = ["u64", "f64", "struct", "DVec3", "sequence", "private"];
                assert!(words.all(|word| !foreign.contains(&word)), "{message} ({})", error.message());
                message
            })
        };
        assert_refused(
            GOOD,
            read,
            r#"
            count = 3 ⇒ count = -3 ⇒ is -3; expected a whole number, 0 or above
            count = 3 ⇒ count = 1979-05-27 ⇒ expected a whole number, 0 or above
            count = 3 ⇒ count = "x" ⇒ is "x"; expected a whole number, 0 or above
            count = 3 ⇒ count = 3.5 ⇒ is 3.5; expected a whole number, 0 or above
            true ⇒ 3 ⇒ is 3; expected true or false
            place = [1, 2, 3] ⇒ place = [1, 2] ⇒ expected
            place = [1, 2, 3] ⇒ place = true ⇒ is true; expected
            size = [1, 2] ⇒ size = [1] ⇒ is 1 long; expected a list of 2
            size = [1, 2] ⇒ size = 5 ⇒ is 5; expected a list of 2
            "m" ⇒ "mile" ⇒ unknown word `mile`
            "a" ⇒ { a = 1 } ⇒ is a table; expected a text
            { range = [1, 2] } ⇒ 7 ⇒ is 7; expected a table
            wide ⇒ wider ⇒ unknown field `wider`; expected one of
            "#,
        );
    }
}
