//! Standard output, standard error, and folders to write to.

use std::fs;
use std::io::{ErrorKind, Write, stderr, stdout};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use backlit_formats::text::{cut_middle, shown};
use serde::Serialize;

/// A value for JSON whose keys keep the order in which they stand here.
macro_rules! object {
    ($($(#[$attribute:meta])* $key:ident: $value:expr),* $(,)?) => {{
        #[expect(non_camel_case_types, reason = "each field has a type of its own, named after it")]
        mod ordered {
            #[derive(Debug, serde::Serialize)]
            pub(super) struct Object<$($key),*> { $($(#[$attribute])* pub(super) $key: $key),* }
        }
        ordered::Object { $($key: $value),* }
    }};
}
pub(crate) use object;

/// Prints text as it is. A reader that has heard enough (`| head`) is no error.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error).context("standard output"),
        _ => Ok(()),
    }
}

/// Prints a value as JSON.
pub fn print_json(value: &impl Serialize) -> anyhow::Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

/// Prints what a command has found: as JSON or as text.
pub(crate) fn print_result<T: Serialize>(
    json: bool,
    value: &T,
    text: impl FnOnce() -> String,
) -> anyhow::Result<()> {
    if json { print_json(value) } else { print(&text()) }
}

/// A number with this many digits, or a dash for one that is not known or not finite.
pub(crate) fn number(value: impl Into<Option<f64>>, digits: usize) -> String {
    let value = value.into().filter(|value| value.is_finite());
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
}

/// A factor as the change that it makes: "+3.0 %".
pub(crate) fn percent_change(factor: f64) -> String {
    format!("{:+.1} %", 100.0 * (factor - 1.0))
}

/// Prints a line on standard error, as [`printable`].
pub fn complain(line: &str) {
    // Where standard error is closed there is nobody to tell.
    let _ = writeln!(stderr().lock(), "{}", printable(line));
}

/// A message as people read it: a line of about 400 letters at most, the beginning and the end of a longer one. What it repeats of
/// a file or an argument cannot steer the terminal.
#[must_use]
pub fn printable(message: &str) -> String {
    cut_middle(&shown(message).to_string(), [200, 200])
}

/// The command line that the program was called with, as a shell would take it.
pub(crate) fn command_line() -> String {
    let quoted = |word: String| {
        let is_plain = |c: char| c.is_alphanumeric() || "-_./,=:+@%".contains(c);
        if !word.is_empty() && word.chars().all(is_plain) {
            word
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("backlit".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// A path from the root, where it can be told.
pub(crate) fn in_full(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Makes sure that a folder is there.
pub fn make_folder(folder: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("{}: the folder cannot be made", folder.display()))
}

/// Checks that a file's folder is there, before work is done that the file is to hold.
pub fn check_folder_of(file: &Path) -> anyhow::Result<()> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        bail!("{}: cannot be written: there is no folder {}", file.display(), folder.display());
    }
    if file.is_dir() {
        bail!("{}: is a folder; expected the name of a file", file.display());
    }
    Ok(())
}

/// Checks that a camera's name can be a file's.
pub fn check_file_stem(camera: &str) -> anyhow::Result<()> {
    let is_bad = |c: char| c.is_control() || "/\\:*?\"<>|".contains(c);
    if camera.contains(is_bad) || camera.starts_with('.') {
        bail!("camera \"{camera}\": files are named after cameras, and no file can have this name");
    }
    Ok(())
}
