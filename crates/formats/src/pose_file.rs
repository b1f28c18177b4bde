//! Poses: `backlit-pose 1` JSON (see `docs/formats.md`).

use std::path::Path;

use backlit_tracking::body::{Model, Pose, PoseError};
use glam::{DQuat, DVec3};
use serde::Deserialize;
use serde_json::json;

use super::json_text::{self, Entries};
use super::{DiskFiles, FileError, FileProblem, MAX_TEXT_BYTES, Result, TakeFiles, atomic, text};

/// Name and version of the pose file's format.
pub const FORMAT: &str = "backlit-pose 1";

/// Largest number in a pose: metres of the root, raw coefficients.
const MAX_NUMBER: f64 = 1e6;

/// What becomes of quaternions that are not of unit length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quaternions {
    /// They are brought to unit length.
    #[default]
    Normalised,
    /// They stay as they are: (4.15) scales the limbs by |q|².
    Raw,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseSpec {
    #[serde(rename = "format")]
    _format: String,
    root: [f64; 3],
    rotations: Entries<[f64; 4]>,
}

/// Parses the content of a pose file; `path` is for the error's message. Limbs left out are at rest.
///
/// # Errors
/// Not such a file, a limb that the model does not have or that has no rotation of its own, or a number that
/// is not one. The error names the line and the limb.
pub fn parse(path: &Path, bytes: &[u8], model: &Model, quaternions: Quaternions) -> Result<Pose> {
    let text = text::decode(path, bytes)?;
    let spec: PoseSpec = json_text::parse_versioned(path, text, FORMAT)?;
    let fail = |limb: &str, problem| {
        FileError::new(path, problem).at_line(json_text::line_of(text, &["rotations", limb]))
    };
    let mut pose = Pose::rest(model);
    check_magnitude(&spec.root).map_err(|problem| {
        FileError::new(path, problem("root".to_owned())).at_line(json_text::line_of(text, &["root"]))
    })?;
    pose.root = DVec3::from_array(spec.root);
    for (limb, coefficients) in spec.rotations.0 {
        check_magnitude(&coefficients)
            .map_err(|problem| fail(&limb, problem(format!("rotations.{limb}"))))?;
        set_rotation(model, &mut pose, "rotations", &limb, coefficients)
            .map_err(|problem| fail(&limb, problem))?;
    }
    pose.check(model).map_err(|error| {
        let line = match &error {
            PoseError::Rotation { limb, .. } => json_text::line_of(text, &["rotations", limb]),
            PoseError::Root { .. } => json_text::line_of(text, &["root"]),
            PoseError::Count { .. } => None,
        };
        FileError::new(path, FileProblem::Pose { error }).at_line(line)
    })?;
    Ok(match quaternions {
        Quaternions::Normalised => normalised(&pose),
        Quaternions::Raw => pose,
    })
}

/// Sets the rotation of a limb, w x y z, and returns its place among the rotations; `field` is for the error's message.
pub(super) fn set_rotation(
    model: &Model,
    pose: &mut Pose,
    field: &str,
    limb: &str,
    [w, x, y, z]: [f64; 4],
) -> Result<usize, FileProblem> {
    let (field, limb) = (field.to_owned(), limb.to_owned());
    match model.limb_index(&limb).map(|index| &model.limbs()[index]) {
        None => Err(FileProblem::UnknownLimb { field, limb }),
        Some(found) if !found.has_own_rotation => Err(FileProblem::RigidLimb { field, limb }),
        Some(found) => {
            pose.rotations[found.rotation] = DQuat::from_xyzw(x, y, z, w);
            Ok(found.rotation)
        }
    }
}

/// Refuses numbers so large that their squares would overflow.
fn check_magnitude(numbers: &[f64]) -> Result<(), impl FnOnce(String) -> FileProblem> {
    match numbers.iter().find(|number| number.abs() > MAX_NUMBER) {
        None => Ok(()),
        Some(&found) => Err(move |field| FileProblem::Field {
            field,
            found: format!("{found:e}"),
            expected: format!("numbers of at most {MAX_NUMBER}"),
        }),
    }
}

/// Unit quaternions stay as they are to the bit, so that a pose written and read again is the same.
fn normalised(pose: &Pose) -> Pose {
    let unit = |q: &DQuat| if (q.length_squared() - 1.0).abs() < 1e-14 { *q } else { q.normalize() };
    Pose { root: pose.root, rotations: pose.rotations.iter().map(unit).collect() }
}

/// Reads a pose file of the disk.
pub fn read(path: &Path, model: &Model, quaternions: Quaternions) -> Result<Pose> {
    parse(path, &DiskFiles.read(path, MAX_TEXT_BYTES)?, model, quaternions)
}

/// The content of a pose file, every rotation written. [`parse`] gives the same pose again.
///
/// The pose must be one of the model's.
#[must_use]
pub fn to_text(model: &Model, pose: &Pose) -> String {
    let mut out = format!("{{\n  \"format\": \"{FORMAT}\",\n  \"root\": {},\n", json!(pose.root.to_array()));
    out.push_str("  \"rotations\": {");
    for (index, (&owner, q)) in model.rotation_owners().iter().zip(&pose.rotations).enumerate() {
        let comma = if index == 0 { "" } else { "," };
        let name = json!(model.limbs()[owner].name);
        out.push_str(&format!("{comma}\n    {name}: {}", json!([q.w, q.x, q.y, q.z])));
    }
    out.push_str("\n  }\n}\n");
    out
}

/// Writes a pose file; see [`atomic`].
pub fn write(path: &Path, model: &Model, pose: &Pose) -> Result<()> {
    pose.check(model).map_err(|error| FileError::new(path, FileProblem::Pose { error }))?;
    atomic::write(path, to_text(model, pose).as_bytes())
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::{Parameters, builtin};

    use super::*;
    use crate::damaged::assert_refused;

    fn parse_text(text: &str, quaternions: Quaternions) -> Result<Pose> {
        parse(Path::new("start.json"), text.as_bytes(), &builtin::upper_body(), quaternions)
    }

    #[test]
    fn a_pose_survives_its_file() {
        let model = builtin::upper_body();
        let step: Vec<f64> = (0..27).map(|i| (f64::from(i) * 1.7).sin()).collect();
        let pose = Pose::rest(&model).retract(Parameters::Tangent, &step);
        let again = parse_text(&to_text(&model, &pose), Quaternions::Normalised).unwrap();
        assert_eq!(again.root, pose.root);
        assert!(pose.local(&again).iter().all(|x| x.abs() < 1e-15));
        assert_eq!(parse_text(&to_text(&model, &pose), Quaternions::Raw).unwrap(), pose);
    }

    #[test]
    fn limbs_left_out_are_at_rest_and_raw_quaternions_stay() {
        let text = r#"{"format": "backlit-pose 1", "root": [1, 2, 3], "rotations": {"head": [2, 0, 0, 0]}}"#;
        let rest = Pose::rest(&builtin::upper_body());
        let pose = parse_text(text, Quaternions::Normalised).unwrap();
        assert_eq!(pose, Pose { root: DVec3::new(1.0, 2.0, 3.0), ..rest });
        let raw = parse_text(text, Quaternions::Raw).unwrap();
        assert_eq!(raw.rotations.iter().filter(|q| q.w == 2.0).count(), 1);
    }

    #[test]
    fn errors_name_line_and_limb() {
        let good = "{\"format\": \"backlit-pose 1\",\n\"root\": [0, 0, 0],\n\"rotations\": {\n\"head\": [1, 0, 0, 0]}}";
        assert_refused(
            good,
            |text| parse_text(text, Quaternions::Normalised),
            r#"
            [1, 0, 0, 0] ⇒ [NaN, 0, 0, 0] ⇒ start.json, line 4: is not valid JSON: in `rotations.head[0]`: NaN is not a number
            [1, 0, 0, 0] ⇒ \n[1, null, 0, 0] ⇒ line 5: `rotations.head[1]` is null; expected a number
            [1, 0, 0, 0] ⇒ [0, 0, 0, 0] ⇒ line 4: `rotations.head` is [w x y z] = [0.0, 0.0, 0.0, 0.0]
            [1, 0, 0, 0] ⇒ [1, 0, 0] ⇒ `rotations.head
            [1, 0, 0, 0] ⇒ [1e999, 0, 0, 0] ⇒ in `rotations.head[0]`: number out of range
            head ⇒ tail ⇒ line 4: `rotations` names "tail", and the model has no limb
            head ⇒ left hip ⇒ line 4: `rotations`: "left hip" follows another
            [1, 0, 0, 0] ⇒ [1, 0, 0, 0], "head": [1, 0, 0, 0] ⇒ given twice
            [0, 0, 0] ⇒ [0, 0, 1e200] ⇒ line 2: `root` is 1e200; expected numbers of at most 1000000
            [0, 0, 0] ⇒ [0, 1e999, 0] ⇒ start.json
            [0, 0, 0] ⇒ [0, NaN, 0] ⇒ start.json
            [0, 0, 0] ⇒ [0, null, 0] ⇒ start.json
            [1, 0, 0, 0] ⇒ [1e300, 0, 0, 0] ⇒ line 4: `rotations.head` is 1e300
            [0, 0, 0] ⇒ [0, 0] ⇒ line 2: `root
            {"root": [0, 0, 0], "rotations": {}} ⇒ `format` is missing
            {\n"format": "backlit-pose 7"} ⇒ line 2: `format` is "backlit-pose 7"
            "#,
        );
    }

    #[test]
    fn a_pose_that_is_not_finite_is_not_written() {
        let model = builtin::single_limb();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.json");
        let pose = Pose { root: DVec3::NAN, ..Pose::rest(&model) };
        assert!(write(&path, &model, &pose).unwrap_err().to_string().contains("`root`"));
        write(&path, &model, &Pose::rest(&model)).unwrap();
        assert_eq!(read(&path, &model, Quaternions::Raw).unwrap(), Pose::rest(&model));
    }
}
