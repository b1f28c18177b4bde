//! Body models: `backlit-body 1` TOML (see `docs/formats.md`).

use std::path::Path;

use backlit_tracking::body::{FORMAT, Model, ModelError, ModelSpec, builtin};

use super::toml_text::{self, TomlStep};
use super::{DiskFiles, FileError, FileProblem, Result, TakeFiles, atomic, text};

/// Largest model file that is read, bytes. The largest body is a tenth of it.
const MAX_BYTES: u64 = 1 << 20;

/// Parses the content of a model file; `path` is for the error's message.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Model> {
    let text = text::decode(path, bytes)?;
    let spec: ModelSpec = toml_text::parse_versioned(path, text, FORMAT)?;
    Model::new(&spec).map_err(|error| {
        let line = match place(&error) {
            Some((limb, field)) => toml_text::line_of(
                text,
                &[TomlStep::Key("limb"), TomlStep::Named(limb), TomlStep::Key(field)],
            ),
            None => None,
        };
        FileError::new(path, FileProblem::Model { error }).at_line(line)
    })
}

/// The limb and the field that an error is about.
fn place(error: &ModelError) -> Option<(&str, &str)> {
    match error {
        ModelError::DuplicateName { limb } => Some((limb, "name")),
        ModelError::UnknownLimb { limb, field, .. }
        | ModelError::Cycle { limb, field, .. }
        | ModelError::Size { limb, field, .. } => Some((limb, field)),
        ModelError::Direction { limb, .. } => Some((limb, "direction")),
        ModelError::Limits { limb, .. } => Some((limb, "limits")),
        ModelError::Sphere { limb, .. } => Some((limb, "spheres")),
        ModelError::Level { limb, .. } => Some((limb, "coarser")),
        ModelError::Format { .. }
        | ModelError::NoLimbs
        | ModelError::TooManyLimbs { .. }
        | ModelError::EmptyName { .. }
        | ModelError::Name { .. }
        | ModelError::BodyName { .. }
        | ModelError::Root { .. } => None,
    }
}

/// Reads a model file of the disk.
pub fn read(path: &Path) -> Result<Model> {
    parse(path, &DiskFiles.read(path, MAX_BYTES)?)
}

/// The model that a `--model` argument means: a built-in name ([`builtin::NAMES`]), else a path.
pub fn resolve(argument: &str) -> Result<Model> {
    resolve_in(&DiskFiles, Path::new(""), argument)
}

/// The same with paths relative to `folder` among `files`.
pub(super) fn resolve_in(files: &dyn TakeFiles, folder: &Path, argument: &str) -> Result<Model> {
    if let Some(text) = builtin::text(argument) {
        return parse(Path::new(argument), text.as_bytes());
    }
    let path = folder.join(argument);
    match files.read(&path, MAX_BYTES) {
        Ok(bytes) => parse(&path, &bytes),
        Err(error) if error.is_missing() => {
            let known = builtin::NAMES.join(", ");
            Err(FileError::new(&path, FileProblem::MissingModel { known }))
        }
        Err(error) => Err(error),
    }
}

/// The content of a model file. [`parse`] gives the same model again.
#[must_use]
pub fn to_text(model: &Model) -> String {
    #[expect(clippy::expect_used, reason = "a model has only strings, numbers and lists of tables")]
    toml::to_string(&model.to_spec()).expect("a model can be written as TOML")
}

/// Writes a model file; see [`atomic`].
pub fn write(path: &Path, model: &Model) -> Result<()> {
    atomic::write(path, to_text(model).as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    /// Two limbs side by side.
    const GOOD: &str = r#"format = "backlit-body 1"
name = "b"
[[limb]]
name = "a"
direction = [0, 1, 0]
length = 0.5
radius = 0.1

[[limb]]
name = "c"
direction = [0, 1, 0]
length = 0.5
radius = 0.1
"#;

    fn read_text(text: &str) -> Result<Model> {
        parse(Path::new("body.toml"), text.as_bytes())
    }

    #[test]
    fn models_survive_their_files() {
        for model in [builtin::single_limb(), builtin::upper_body(), builtin::full_body()] {
            let text = to_text(&model);
            assert_eq!(read_text(&text).unwrap(), model);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("body.toml");
        write(&path, &builtin::upper_body()).unwrap();
        assert_eq!(resolve(path.to_str().unwrap()).unwrap(), builtin::upper_body());
    }

    #[test]
    fn a_name_is_built_in_or_a_file() {
        assert_eq!(resolve("upper_body").unwrap(), builtin::upper_body());
        let message = resolve("uper_body").unwrap_err().to_string();
        assert!(message.contains("uper_body") && message.contains("single_limb, upper_body"), "{message}");
    }

    #[test]
    fn errors_name_file_line_and_field() {
        read_text(GOOD).unwrap();
        assert_refused(
            GOOD,
            read_text,
            r#"
            radius = 0.1\n ⇒ radius = 0.1\nparent = "b" ⇒ body.toml, line 8: limb "a": `parent` names "b"
            radius = 0.1\n ⇒ radius = 0.1\nparent = "a" ⇒ line 8: limb "a": `parent` = "a" makes a cycle: a → a
            radius = 0.1 ⇒ radius = nan ⇒ line 7: limb "a": `radius` is NaN
            radius = 0.1 ⇒ radius = "x" ⇒ line 7: `limb[0].radius` is "x"; expected a number
            radius = 0.1 ⇒ ⇒ line 3: `limb.radius` is missing; expected a value
            radius = 0.1 ⇒ radius = 0.0 ⇒ body.toml, line 7: limb "a": `radius`
            radius = 0.1 ⇒ radius = -1 ⇒ limb "a": `radius`
            radius = 0.1 ⇒ radius = inf ⇒ limb "a": `radius`
            radius = 0.1 ⇒ radius = 1e200 ⇒ limb "a": `radius`
            length = 0.5 ⇒ length = 0.0 ⇒ body.toml, line 6: limb "a": `length`
            length = 0.5 ⇒ length = -1 ⇒ limb "a": `length`
            length = 0.5 ⇒ length = nan ⇒ limb "a": `length`
            length = 0.5 ⇒ length = inf ⇒ limb "a": `length`
            length = 0.5 ⇒ length = 1e200 ⇒ limb "a": `length`
            radius = 0.1\n ⇒ radius = 1\nlimits = { axis = [0, 1, 0], flexion = [0, 1], sideways = [0, 1], twist = [0, 1] } ⇒ line 8: limb "a": `limits.axis`
            radius = 0.1\n ⇒ radius = 1\ncolour = 3 ⇒ line 8: in `limb[0]`: unknown field `colour`
            name = "c" ⇒ name = "a" ⇒ line 10: limb "a": `name` is used twice
            name = "b" ⇒ `format` is missing; expected "backlit-body 1"
            \nformat = "backlit-body 2"\nshape = 3 ⇒ line 2: `format` is "backlit-body 2"; expected
            format = 3 ⇒ `format` is integer; expected
            a = 1\n\nname = ⇒ line 3: is not valid TOML
            "#,
        );
        let pair = GOOD.replacen("0.1\n\n", "0.1\nparent = \"c\"\n", 1) + "parent = \"a\"\n";
        let message = read_text(&pair).unwrap_err().to_string();
        assert!(
            message.contains("line 8: limb \"a\": `parent` = \"c\" makes a cycle: a → c → a"),
            "{message}"
        );
        let bytes = [b"format = \"backlit-body 1\"\n".as_slice(), &[0xFF]].concat();
        let message = parse(Path::new("body.toml"), &bytes).unwrap_err().to_string();
        assert!(message.contains("line 2: is not UTF-8"), "{message}");
    }
}
