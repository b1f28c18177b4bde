//! `OpenCap`'s `cameraIntrinsics.pickle` and `cameraIntrinsicsExtrinsics.pickle`: one camera a file.
//!
//! `intrinsicMat`, `distortion` (k1 k2 p1 p2 k3), `imageSize` [[height], [width]], `rotation` (a matrix, camera from
//! world) and `translation` in millimetres. The world is the board, which lies on the floor or stands at a wall: the
//! file does not say which. Pixel centres at integers. The name is the file's, or its folder's where the file is called
//! as `OpenCap` calls it.

use std::path::Path;

use super::partial::PartialCameras;
use super::tree::{Field, Tree, Value};
use super::{opencv, pickle, stem};
use crate::Result;

/// What `OpenCap` calls its files.
const ENDINGS: [&str; 2] = ["cameraIntrinsicsExtrinsics", "cameraIntrinsics"];
/// Metres in a millimetre.
const MILLIMETRE: f64 = 0.001;

pub(super) fn parts(path: &Path, bytes: &[u8]) -> Result<PartialCameras> {
    let mut entries = Vec::new();
    for (key, array) in pickle::arrays(path, bytes)? {
        let mut numbers = array.numbers;
        if key == "imageSize" {
            // Height first.
            numbers.reverse();
        }
        // With all digits: what is written so is read as the same number again.
        let items = numbers.iter().map(|number| Tree { line: 1, value: Value::Plain(format!("{number:?}")) });
        entries.push((key, Tree { line: 1, value: Value::List(items.collect()) }));
    }
    let root = Tree { line: 1, value: Value::Map(entries) };
    let field = Field::root(path, &root);
    field.need(&["intrinsicMat"], "a 3 × 3 matrix")?;
    field.need(&["distortion"], "the lens's coefficients")?;
    let mut parts = PartialCameras::new(Some(MILLIMETRE));
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::pickle::tests::array;
    use super::super::{CalibrationOptions, parse};
    use super::*;

    const FILE: &[u8] = include_bytes!("../../fuzz/corpus/pickle/0-camera.pickle");

    #[test]
    fn millimetres_and_the_height_first() {
        let path = Path::new("Videos/Cam1/cameraIntrinsicsExtrinsics.pickle");
        let rig = parse(path, FILE, CalibrationOptions::default()).unwrap();
        let camera = &rig.cameras()[0];
        assert_eq!((camera.name(), camera.width(), camera.height()), ("Cam1", 720, 1280));
        assert_eq!((camera.intrinsics().fy, camera.intrinsics().cx), (901.0, 360.5));
        assert!(camera.centre().distance(DVec3::new(-0.1, -0.2, -3.0)) < 1e-12);
    }

    #[test]
    fn errors_name_the_field() {
        let four = [&b"}(\x8c\x08rotation"[..], &array(&[2, 2], "f8", &[0; 32])].concat();
        let (number, none) = (200.0_f64.to_le_bytes(), f64::NAN.to_le_bytes());
        for (from, to, expected) in [
            (&b"distortion"[..], &b"distortio_"[..], "`distortion` is missing"),
            (&number, &none, "`translation[1]` is NaN; expected a finite number"),
            (b"}(", &four, "`rotation` is 4 numbers"),
        ] {
            let at = FILE.windows(from.len()).position(|part| part == from).unwrap();
            let changed = [&FILE[..at], to, &FILE[at + from.len()..]].concat();
            let found = parse(Path::new("c.pickle"), &changed, CalibrationOptions::default());
            let message = found.unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    #[test]
    fn names_come_from_the_file_or_its_folder() {
        for (path, expected) in [
            ("a/Cam0/cameraIntrinsics.pickle", "Cam0"),
            ("phone,1_720_60fps_cameraIntrinsics.pickle", "phone,1"),
            ("left_cameraIntrinsicsExtrinsics.pickle", "left"),
            ("other.pickle", "other"),
        ] {
            assert_eq!(name(Path::new(path)), expected);
        }
    }
}
