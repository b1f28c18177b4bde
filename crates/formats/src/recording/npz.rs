//! `NumPy`: an archive of arrays as `backlit export --to npz` and `numpy.savez` write it. Places are `joints` (or another array,
//! frames × joints × 3), names `joint_names` (or another array of as many texts), times `seconds`.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use npyz::{NpyFile, TypeChar};
use zip::ZipArchive;

use super::{MAX_BYTES, Recording, limited, point, told_rate};
use crate::FileProblem;

/// Numbers or texts of an array.
enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

struct Array {
    shape: Vec<u64>,
    values: Values,
}

fn problem(field: &str, found: impl ToString, expected: &str) -> FileProblem {
    FileProblem::field(field, found.to_string(), expected)
}

pub(super) fn parse(bytes: &[u8], frame_rate: Option<f64>) -> Result<Recording, FileProblem> {
    let mut arrays = arrays(bytes)?;
    let shape = |array: &Array| {
        (array.shape.len() == 3 && array.shape[2] == 3).then(|| (array.shape[0], array.shape[1]))
    };
    let is_places = |array: &Array| shape(array).is_some() && matches!(array.values, Values::Numbers(_));
    let key = if arrays.get("joints").is_some_and(is_places) {
        "joints".to_owned()
    } else {
        let found = arrays.keys().cloned().collect::<Vec<_>>().join(", ");
        let places = arrays.iter().find(|(_, array)| is_places(array)).map(|(key, _)| key.clone());
        places.ok_or_else(|| problem("arrays", found, "joints, of frames × joints × 3 numbers"))?
    };
    let Some((array, values)) = arrays.remove(&key).and_then(|array| match &array.values {
        Values::Numbers(values) => Some((shape(&array)?, values.clone())),
        Values::Texts(_) => None,
    }) else {
        return Err(problem(&key, "no numbers", "frames × joints × 3 numbers"));
    };
    let (frames, joints) = (array.0 as usize, array.1 as usize);
    let is_names = |array: &Array| array.shape == [joints as u64];
    let mut names = arrays.iter().filter_map(|(key, array)| match &array.values {
        Values::Texts(texts) if is_names(array) => Some((key != "joint_names", texts)),
        _ => None,
    });
    let names = names.by_ref().min_by_key(|(is_other, _)| *is_other).map(|(_, texts)| texts.clone());
    let names =
        names.ok_or_else(|| problem("joint_names", "none", "an array with the name of each joint"))?;
    let seconds = ["seconds", "time", "times", "timestamps"].iter().find_map(|key| match arrays.get(*key) {
        Some(Array { shape, values: Values::Numbers(values) }) if *shape == [frames as u64] => {
            Some(values.clone())
        }
        _ => None,
    });
    let times = match seconds {
        Some(seconds) => seconds,
        None => {
            let rate = told_rate(
                frame_rate,
                "an array seconds, or frames per second told beside the file (--frame-rate)",
            )?;
            (0..frames).map(|frame| frame as f64 / rate).collect()
        }
    };
    let row = |row: &[f64]| row.chunks_exact(3).map(|p| point([p[0], p[1], p[2]])).collect();
    let points = values.chunks_exact((3 * joints).max(1)).map(row).collect();
    Ok(Recording { names, times, points, angles: BTreeMap::new() })
}

/// The arrays of an archive by name; of a single array, which is called `joints`.
fn arrays(bytes: &[u8]) -> Result<BTreeMap<String, Array>, FileProblem> {
    if !bytes.starts_with(b"PK") {
        return Ok(array(bytes, "array")?.into_iter().map(|array| ("joints".to_owned(), array)).collect());
    }
    let broken = |error: zip::result::ZipError| problem("archive", error, "an archive of NumPy arrays");
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    let mut arrays = BTreeMap::new();
    let mut left = MAX_BYTES;
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).map_err(broken)?;
        let name = file.name().map_err(broken)?.into_owned();
        let Some(key) = name.strip_suffix(".npy").map(str::to_owned) else { continue };
        let mut content = Vec::new();
        let length = file.by_ref().take(left + 1).read_to_end(&mut content);
        let length = length.map_err(|error| problem(&key, error, "a whole array"))? as u64;
        left =
            left.checked_sub(length).ok_or_else(|| problem(&key, "more", "at most 1 GiB in all arrays"))?;
        if let Some(array) = array(&content, &key)? {
            arrays.insert(key, array);
        }
    }
    Ok(arrays)
}

/// One array; `None` of a kind that is not needed here.
fn array(bytes: &[u8], key: &str) -> Result<Option<Array>, FileProblem> {
    let bad = |error: std::io::Error| problem(key, error, "a NumPy array");
    let file = NpyFile::new(bytes).map_err(bad)?;
    let shape = file.shape().to_vec();
    let count = shape.iter().try_fold(1_u64, |count, side| count.checked_mul(*side));
    limited(count.and_then(|count| usize::try_from(count).ok()).map(|count| count / 3))?;
    if file.order() != npyz::Order::C && shape.len() > 1 {
        return Err(problem(key, "columns first", "an array in C order (numpy.ascontiguousarray)"));
    }
    let npyz::DType::Plain(kind) = file.dtype() else { return Ok(None) };
    let values = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, 8) => Values::Numbers(file.into_vec::<f64>().map_err(bad)?),
        (TypeChar::Float, 4) => {
            Values::Numbers(file.into_vec::<f32>().map_err(bad)?.into_iter().map(f64::from).collect())
        }
        (TypeChar::UnicodeStr, _) => Values::Texts(file.into_vec::<String>().map_err(bad)?),
        _ => return Ok(None),
    };
    Ok(Some(Array { shape, values }))
}
