//! `OpenCap`'s `cameraIntrinsics.pickle` and `cameraIntrinsicsExtrinsics.pickle`: one camera a file.
//!
//! `intrinsicMat`, `distortion` (k1 k2 p1 p2 k3), `imageSize` [[height], [width]], `rotation` (a matrix, camera from
//! world) and `translation` in millimetres. The world is the board, which lies on the floor or stands at a wall: the
//! file does not say which. Pixel centres at integers. The name is the file's, or its folder's where the file is called
//! as `OpenCap` calls it.

use std::path::Path;

use super::node::{Field, Node, Value};
use super::part::Parts;
use super::{opencv, pickle, stem};
use crate::FileError;

/// What `OpenCap` calls its files.
const ENDINGS: [&str; 2] = ["cameraIntrinsicsExtrinsics", "cameraIntrinsics"];
/// Metres in a millimetre.
const MILLIMETRE: f64 = 0.001;

pub(super) fn parts(path: &Path, bytes: &[u8]) -> Result<Parts, FileError> {
    let mut entries = Vec::new();
    for (key, array) in pickle::arrays(path, bytes)? {
        let mut numbers = array.numbers;
        if key == "imageSize" {
            // Height first.
            numbers.reverse();
        }
        // With all digits: what is written so is read as the same number again.
        let items = numbers.iter().map(|number| Node { line: 1, value: Value::Plain(format!("{number:?}")) });
        entries.push((key, Node { line: 1, value: Value::List(items.collect()) }));
    }
    let root = Node { line: 1, value: Value::Map(entries) };
    let field = Field::root(path, &root);
    field.need(&["intrinsicMat"], "a 3 × 3 matrix")?;
    field.need(&["distortion"], "the lens's coefficients")?;
    let mut parts = Parts::new(Some(MILLIMETRE));
    parts.push(path, opencv::camera(&field, &name(path))?)?;
    Ok(parts)
}

fn name(path: &Path) -> String {
    let stem = stem(path);
    let Some(start) = ENDINGS.iter().find_map(|ending| stem.strip_suffix(ending)) else { return stem };
    let folder = || path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let start = start.trim_end_matches('_');
    if start.is_empty() {
        return folder().unwrap_or(stem);
    }
    // A phone's name may be followed by its mode, as in `iPhone13,1_720_60fps`.
    let mut words: Vec<&str> = start.split('_').collect();
    let is_number = |word: &str| !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_digit());
    if let [_, .., lines, rate] = words.as_slice()
        && rate.strip_suffix("fps").is_some_and(is_number)
        && is_number(lines)
    {
        words.truncate(words.len() - 2);
    }
    words.join("_")
}
