//! The files of an experiment, and the table on the screen.

use std::path::PathBuf;

use anyhow::Context;
use backlit_formats::atomic;
use backlit_plot::{AsPicture, png};
use serde::Serialize;

use super::arguments::OutputArguments;
use crate::output;

/// Name and version of the files with the numbers.
const FORMAT: &str = "backlit-experiment 1";

/// An experiment's file.
#[derive(Debug, Serialize)]
struct Document<'a, O, R> {
    format: &'static str,
    experiment: &'a str,
    options: &'a O,
    report: &'a R,
}

/// Writes the files, then prints the table, or the numbers.
///
/// # Errors
/// The folder or a file cannot be written.
pub(crate) fn finish<O: Serialize, R: Serialize, P: AsPicture>(
    arguments: &OutputArguments,
    name: &str,
    options: &O,
    report: &R,
    figures: &[(String, P)],
    table: &str,
) -> anyhow::Result<()> {
    let (numbers, written) = write(arguments, name, options, report, figures)?;
    if arguments.json {
        return output::print(&numbers);
    }
    let names: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    output::print(&format!("{table}\nWritten: {}\n", names.join(", ")))
}

/// What one result becomes in files.
#[derive(Debug)]
pub(crate) struct ResultFiles {
    /// The numbers, as `NAME.json`.
    pub(crate) json: Vec<u8>,
    /// The table, as `NAME.csv`.
    pub(crate) csv: Vec<u8>,
    /// The picture, as `NAME.png`.
    pub(crate) png: Vec<u8>,
}

/// Writes a result's files, then prints the table, or the numbers.
///
/// # Errors
/// The folder or a file cannot be written.
pub(crate) fn finish_result(
    arguments: &OutputArguments,
    name: &str,
    result: &ResultFiles,
    table: &str,
) -> anyhow::Result<()> {
    output::make_folder(&arguments.out)?;
    let mut written = Vec::new();
    for (ending, bytes) in [("json", &result.json), ("csv", &result.csv), ("png", &result.png)] {
        let path = arguments.out.join(format!("{name}.{ending}"));
        atomic::write(&path, bytes)?;
        written.push(path.display().to_string());
    }
    if arguments.json {
        return output::print(&String::from_utf8_lossy(&result.json));
    }
    output::print(&format!("{table}\nWritten: {}\n", written.join(", ")))
}

/// Writes the numbers to `NAME.json` and each figure to its `NAME.png`; returns the numbers and all paths.
///
/// # Errors
/// The folder or a file cannot be written.
pub(crate) fn write<O: Serialize, R: Serialize, P: AsPicture>(
    arguments: &OutputArguments,
    name: &str,
    options: &O,
    report: &R,
    figures: &[(String, P)],
) -> anyhow::Result<(String, Vec<PathBuf>)> {
    let document = Document { format: FORMAT, experiment: name, options, report };
    output::make_folder(&arguments.out)?;
    let numbers = serde_json::to_string_pretty(&document).context("the numbers")? + "\n";
    let path = arguments.out.join(format!("{name}.json"));
    atomic::write(&path, numbers.as_bytes())?;
    let mut written = vec![path];
    for (name, figure) in figures {
        let path = arguments.out.join(format!("{name}.png"));
        atomic::write(&path, &png(figure.picture(arguments.theme.into()))?)?;
        written.push(path);
    }
    Ok((numbers, written))
}
