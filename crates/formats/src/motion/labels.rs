//! `labels.csv`: what motions of a folder are called, and who moves.

use std::path::Path;

use serde::Deserialize;

use crate::text::decode;
use crate::{DiskFiles, FileProblem, MAX_TEXT_BYTES, Result, TakeFiles, TextFormat};

/// A row: a file and its class.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct MotionLabel {
    /// The file's name, in the folder of the table.
    pub file: String,
    /// What the motion is called.
    pub class: String,
    /// Who moves.
    pub subject: String,
    /// Words for people.
    #[serde(default)]
    pub description: String,
}

/// Reads the `labels.csv` of a folder.
pub fn read_labels(path: &Path) -> Result<Vec<MotionLabel>> {
    parse_labels(path, &DiskFiles.read(path, MAX_TEXT_BYTES)?)
}

/// Parses such a table; `path` is for the error's message. Its columns are `file`, `class`, `subject` and, where there is one, `description`, in any
/// order; others are not looked at.
pub fn parse_labels(path: &Path, bytes: &[u8]) -> Result<Vec<MotionLabel>> {
    let text = decode(path, bytes)?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut labels: Vec<MotionLabel> = Vec::new();
    let wrong = |line: Option<u64>, problem: FileProblem| {
        problem.at(path, line.and_then(|line| usize::try_from(line).ok()))
    };
    for row in reader.deserialize::<MotionLabel>() {
        let label = row.map_err(|error| {
            let line = error.position().map(csv::Position::line);
            let message = format!("{}; expected columns file, class, subject, description", plain(&error));
            wrong(line, FileProblem::syntax(TextFormat::Csv, message))
        })?;
        let line = Some(labels.len() as u64 + 2);
        let fields = [("file", &label.file), ("class", &label.class), ("subject", &label.subject)];
        if let Some((field, _)) = fields.into_iter().find(|(_, value)| value.is_empty()) {
            return Err(wrong(line, FileProblem::field(field, "empty", "a word")));
        }
        if Path::new(&label.file).file_name().is_none_or(|name| name != label.file.as_str()) {
            let expected = "the name of a file in the same folder";
            return Err(wrong(line, FileProblem::field("file", label.file, expected)));
        }
        if labels.iter().any(|known| known.file == label.file) {
            return Err(wrong(line, FileProblem::Duplicate { field: label.file }));
        }
        labels.push(label);
    }
    Ok(labels)
}

/// What is wrong with a row, without its place.
fn plain(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => err.kind().to_string(),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} fields and not {expected_len}")
        }
        _ => "not a table".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    #[test]
    fn a_table_has_its_rows_and_says_what_is_wrong() {
        let read = |text: &str| parse_labels(Path::new("labels.csv"), text.as_bytes());
        let good = "file,class,subject,description\na.bvh,walk,01,\"walk, turn\"\nb.bvh,run,02,\n";
        let labels = read(good).unwrap();
        assert_eq!(labels.len(), 2);
        assert_eq!((&*labels[0].description, &*labels[1].class), ("walk, turn", "run"));
        assert_eq!(read("subject,file,class\n01,a.bvh,walk\n").unwrap()[0].class, "walk");
        assert_refused(
            good,
            read,
            r#"
            file,class\na.bvh,walk\n ⇒ line 2: is not valid CSV: missing field `subject`
            file,class,subject\na.bvh,walk\n ⇒ line 2: is not valid CSV: 2 fields and not 3
            walk, ⇒ , ⇒ line 2: `class` is empty
            b.bvh ⇒ a.bvh ⇒ line 3: `a.bvh` is given twice
            a.bvh ⇒ ../a.bvh ⇒ line 2: `file` is ../a.bvh
            "#,
        );
        assert!(read("").unwrap().is_empty());
    }
}
