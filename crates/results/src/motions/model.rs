//! What was learnt of motions: the program's own, or a file of `backlit recognise --train`.

use std::path::Path;

use anyhow::Context;
use backlit_formats::{DiskFiles, MAX_TEXT_BYTES, TakeFiles};
use backlit_recognition::Recognizer;

/// Reads what was learnt; without a file, what comes with the program.
///
/// # Errors
/// No such file, or not such a file: the error names it, and the line or field.
pub fn read(file: Option<&Path>) -> anyhow::Result<Recognizer> {
    let Some(path) = file else { return Ok(Recognizer::built_in()) };
    let bytes = DiskFiles.read(path, MAX_TEXT_BYTES)?;
    let text = String::from_utf8(bytes).with_context(|| format!("{}: is not UTF-8 text", path.display()))?;
    Recognizer::from_text(&text).with_context(|| path.display().to_string())
}
