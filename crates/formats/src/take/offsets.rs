//! Offsets of cameras, written into a take file that is there already: all else in it stays as it is, comments too.

use std::path::Path;

use toml_edit::{DocumentMut, Item, TableLike, Value};

use super::spec::{FORMAT, TakeSpec};
use super::take::{MAX_BYTES, file_of};
use crate::text::{decode, line_at};
use crate::{DiskFiles, FileProblem, Result, TakeFiles, TextFormat, atomic, toml_text};

/// By how much a camera is to be shifted beside what its take says now.
#[derive(Debug, Clone, PartialEq)]
pub struct OffsetShift {
    /// The camera's name.
    pub camera: String,
    /// Frames of the camera's own.
    pub frames: i64,
    /// The same as seconds of its clock, with the part of a frame that `frames` has lost.
    pub seconds: f64,
}

/// Shifts cameras in a take file: `offset` and `offset_seconds` grow by the shift, and where there is neither, `offset` is
/// written, counted from `first`. Cameras whose shift is 0 frames stay as they are. Returns whether the file changed.
pub fn shift_offsets(take: &Path, shifts: &[OffsetShift]) -> Result<bool> {
    let path = file_of(take);
    let bytes = DiskFiles.read(&path, MAX_BYTES)?;
    let old = decode(&path, &bytes)?;
    let new = shifted(&path, old, shifts)?;
    if new == old {
        return Ok(false);
    }
    atomic::write(&path, new.as_bytes())?;
    Ok(true)
}

/// The text of a take file with its cameras shifted.
fn shifted(path: &Path, text: &str, shifts: &[OffsetShift]) -> Result<String> {
    // What is not a take is not written to, and what is one afterwards too.
    let _: TakeSpec = toml_text::parse_versioned(path, text, FORMAT)?;
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let line = error.span().map(|span| line_at(text, span.start));
        FileProblem::syntax(TextFormat::Toml, error.message()).at(path, line)
    })?;
    for shift in shifts.iter().filter(|shift| shift.frames != 0) {
        let cameras = document.get_mut("camera");
        let camera = cameras.and_then(|cameras| table_of(cameras, &shift.camera)).ok_or_else(|| {
            let found = format!("without a camera \"{}\"", shift.camera);
            FileProblem::field("camera", found, "one of that name").at(path, None)
        })?;
        shift_one(camera, shift);
    }
    let new = document.to_string();
    let _: TakeSpec = toml_text::parse_versioned(path, &new, FORMAT)?;
    Ok(new)
}

/// The table of a camera, whether tables or an array in one line.
fn table_of<'a>(cameras: &'a mut Item, name: &str) -> Option<&'a mut dyn TableLike> {
    fn is_named(table: &dyn TableLike, name: &str) -> bool {
        table.get("name").and_then(Item::as_str) == Some(name)
    }
    match cameras {
        Item::ArrayOfTables(tables) => tables
            .iter_mut()
            .find(|table| is_named(*table, name))
            .map(|table| -> &mut dyn TableLike { table }),
        Item::Value(Value::Array(tables)) => tables
            .iter_mut()
            .filter_map(Value::as_inline_table_mut)
            .find(|table| is_named(*table, name))
            .map(|table| -> &mut dyn TableLike { table }),
        _ => None,
    }
}

fn shift_one(camera: &mut dyn TableLike, shift: &OffsetShift) {
    let integer = |key: &str| camera.get(key).and_then(Item::as_integer);
    if let Some(frames) = integer("offset") {
        replace(camera, "offset", frames.saturating_add(shift.frames).into());
        return;
    }
    let seconds = camera.get("offset_seconds");
    let seconds =
        seconds.and_then(|item| item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64)));
    match seconds {
        // Microseconds are enough, and are read again as they are.
        Some(seconds) => {
            let sum = ((seconds + shift.seconds) * 1e6).round() / 1e6;
            replace(camera, "offset_seconds", sum.into());
        }
        None => {
            let first = integer("first").unwrap_or(0);
            camera.insert("offset", Item::Value(first.saturating_add(shift.frames).into()));
        }
    }
}

/// Another value in the place of one, with the spaces and the comment that it had.
fn replace(table: &mut dyn TableLike, key: &str, mut new: Value) {
    if let Some(Item::Value(old)) = table.get_mut(key) {
        *new.decor_mut() = old.decor().clone();
        *old = new;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAKE: &str = r#"# Written by hand.
format = "backlit-take 1"
name = "three"   # of them
frame_rate = 25
model = "upper_body"

[cameras]
calibration = "cameras.json"

[[camera]]
name = "a"
frames = "a.mp4"

# The second one.
[[camera]]
name = "b"
frames = "b/%03d.png"
first = 5
[camera.measurement]
opening_px = 2

[[camera]]
name = "c"
frames = "c.mp4"
offset =  -3   # by eye
[[camera]]
name = "d"
frames = "d.mp4"
offset_seconds = 0.25
"#;

    fn shift(camera: &str, frames: i64, seconds: f64) -> OffsetShift {
        OffsetShift { camera: camera.to_owned(), frames, seconds }
    }

    #[test]
    fn only_offsets_change() {
        let shifts =
            [shift("a", 0, 0.004), shift("b", -7, -0.28), shift("c", 12, 0.481), shift("d", 2, 0.08125)];
        let new = shifted(Path::new("take.toml"), TAKE, &shifts).unwrap();
        let expected = TAKE
            .replace("first = 5\n", "first = 5\noffset = -2\n")
            .replace("offset =  -3   # by eye", "offset =  9   # by eye")
            .replace("offset_seconds = 0.25", "offset_seconds = 0.33125");
        assert_eq!(new, expected);
    }

    #[test]
    fn cameras_in_one_line_are_found_and_what_is_no_take_is_told() {
        let head = "format = \"backlit-take 1\"\nname = \"n\"\nframe_rate = 25\nmodel = \"m\"\n";
        let text = format!(
            "{head}cameras = {{ calibration = \"c\" }}\ncamera = [{{ name = \"a\", frames = \"a.mp4\" }}]\n"
        );
        let new = shifted(Path::new("t"), &text, &[shift("a", 3, 0.12)]).unwrap();
        assert!(
            new.contains("camera = [{ name = \"a\", frames = \"a.mp4\" , offset = 3 }]")
                || new.contains("camera = [{ name = \"a\", frames = \"a.mp4\", offset = 3 }]"),
            "{new}"
        );
        let error = shifted(Path::new("t"), &text, &[shift("z", 3, 0.12)]).unwrap_err().to_string();
        assert_eq!(error, "t: `camera` is without a camera \"z\"; expected one of that name");
        let error = shifted(Path::new("t"), "format = \"other\"", &[]).unwrap_err().to_string();
        assert!(error.contains("backlit-take 1"), "{error}");
    }

    #[test]
    fn a_file_that_needs_no_change_is_not_touched() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("take.toml");
        std::fs::write(&path, TAKE).unwrap();
        assert!(!shift_offsets(folder.path(), &[shift("a", 0, 0.0)]).unwrap());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), TAKE);
        assert!(shift_offsets(folder.path(), &[shift("a", 4, 0.16)]).unwrap());
        let new = std::fs::read_to_string(&path).unwrap();
        assert_eq!(new, TAKE.replace("frames = \"a.mp4\"\n", "frames = \"a.mp4\"\noffset = 4\n"));
        assert!(shift_offsets(&folder.path().join("none.toml"), &[]).unwrap_err().is_missing());
    }
}
