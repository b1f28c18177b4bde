//! Priors learnt from motion: `backlit-prior 1` JSON (see `docs/formats.md`).

use std::path::Path;
use std::sync::{Arc, LazyLock};

use backlit_tracking::prior::{
    Accelerations, BodyDirection, Clip, PosePrior, PriorError, PriorPart, StepStatistics, StudentComponent,
};
use serde::{Deserialize, Serialize};

use super::{DiskFiles, FileError, FileProblem, Result, TakeFiles, atomic, bvh, json_text, text};

/// Name and version of the file's format.
pub const FORMAT: &str = "backlit-prior 1";
/// Largest file that is read, bytes: a prior has some ten thousand numbers.
const MAX_BYTES: u64 = 8 << 20;
/// Significant digits of a number.
const DIGITS: i32 = 6;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PriorSpec {
    format: String,
    source: String,
    degrees: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    accelerations: Option<Accelerations>,
    parts: Vec<PartSpec>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PartSpec {
    name: String,
    directions: Vec<BodyDirection>,
    step: StepStatistics,
    components: Vec<StudentComponent>,
}

/// The name of the prior that comes with the program.
pub const PEOPLE: &str = "people";
const PEOPLE_TEXT: &str = include_str!("../../../assets/people_prior.json");

/// The prior that comes with the program, learnt from the CMU database; its source says more. It is read once.
#[must_use]
pub fn people() -> Arc<PosePrior> {
    static READ: LazyLock<Arc<PosePrior>> = LazyLock::new(|| {
        #[expect(clippy::expect_used, reason = "the embedded file is checked by a test")]
        let people =
            parse(Path::new("people_prior.json"), PEOPLE_TEXT.as_bytes()).expect("the built-in prior is one");
        Arc::new(people)
    });
    Arc::clone(&READ)
}

/// Reads a prior from the disk, or the built-in one by its name, [`PEOPLE`].
pub fn read_or_built_in(path: &Path) -> Result<Arc<PosePrior>> {
    if path == Path::new(PEOPLE) { Ok(people()) } else { read(path).map(Arc::new) }
}

/// Reads a prior from the disk.
pub fn read(path: &Path) -> Result<PosePrior> {
    parse(path, &DiskFiles.read(path, MAX_BYTES)?)
}

/// Parses the content of a prior's file; `path` is for the error's message.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<PosePrior> {
    let text = text::decode(path, bytes)?;
    let spec: PriorSpec = json_text::parse_versioned(path, text, FORMAT)?;
    let wrong = |error: PriorError| {
        let problem = FileProblem::Option { field: "parts".to_owned(), message: error.to_string() };
        FileError::new(path, problem).at_line(json_text::line_of(text, &["parts"]))
    };
    let part = |part: PartSpec| {
        PriorPart::new(&part.name, part.directions, part.components, part.step, spec.degrees)
    };
    let parts: Result<Vec<PriorPart>, PriorError> = spec.parts.into_iter().map(part).collect();
    let prior = PosePrior::new(&spec.source, parts.map_err(wrong)?).map_err(wrong)?;
    let Some(accelerations) = spec.accelerations else { return Ok(prior) };
    prior.with_accelerations(accelerations).map_err(|error| {
        let problem = FileProblem::Option { field: "accelerations".to_owned(), message: error.to_string() };
        FileError::new(path, problem).at_line(json_text::line_of(text, &["accelerations"]))
    })
}

/// The content of a prior's file, six digits of each number.
pub fn to_text(prior: &PosePrior) -> Result<String, serde_json::Error> {
    let part = |part: &PriorPart| PartSpec {
        name: part.name.clone(),
        directions: part.directions.clone(),
        step: StepStatistics {
            seconds: short(part.step.seconds),
            exponent: short(part.step.exponent),
            covariance: short_all(&part.step.covariance),
        },
        components: part
            .poses
            .components
            .iter()
            .map(|component| StudentComponent {
                share: short(component.share),
                mean: short_all(&component.mean),
                covariance: short_all(&component.covariance),
            })
            .collect(),
    };
    let degrees = prior.parts.first().map_or(1.0, |part| part.poses.degrees);
    let spec = PriorSpec {
        format: FORMAT.to_owned(),
        source: prior.source.clone(),
        degrees,
        accelerations: prior.accelerations.map(short_accelerations),
        parts: prior.parts.iter().map(part).collect(),
    };
    // A component a line: lists of numbers stay together.
    let text = serde_json::to_string(&spec)?;
    let text = text.replace("{\"share\"", "\n{\"share\"").replace("{\"name\"", "\n{\"name\"");
    Ok(text
        .replace("\"source\"", "\n\"source\"")
        .replace("\"parts\"", "\n\"parts\"")
        .replace("\"accelerations\"", "\n\"accelerations\"")
        + "\n")
}

/// A number rounded to `DIGITS` significant digits.
fn short(number: f64) -> f64 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    let places = DIGITS - 1 - number.abs().log10().floor() as i32;
    let scale = 10f64.powi(places.clamp(-300, 300));
    let rounded = (number * scale).round() / scale;
    if rounded.is_finite() { rounded } else { number }
}

fn short_accelerations(all: Accelerations) -> Accelerations {
    let Accelerations { root, pelvis, chest, upper_arm, forearm, thigh, calf, foot } = all;
    let [root, pelvis, chest, upper_arm] = [root, pelvis, chest, upper_arm].map(short);
    let [forearm, thigh, calf, foot] = [forearm, thigh, calf, foot].map(short);
    Accelerations { root, pelvis, chest, upper_arm, forearm, thigh, calf, foot }
}

fn short_all(numbers: &[f64]) -> Vec<f64> {
    numbers.iter().copied().map(short).collect()
}

/// Writes a prior, whole or not at all.
pub fn write(path: &Path, prior: &PosePrior) -> Result<()> {
    let text = to_text(prior)
        .map_err(|error| FileError::new(path, FileProblem::Write { error: std::io::Error::other(error) }))?;
    atomic::write(path, text.as_bytes())
}

/// The people in the BVH files of a folder and its folders, in the order of their names, to be learnt from.
pub fn clips(folder: &Path) -> Result<Vec<Clip>> {
    let mut open = vec![folder.to_owned()];
    let mut files = Vec::new();
    while let Some(folder) = open.pop() {
        let failed = |error: std::io::Error| FileError::new(&folder, FileProblem::Read { error });
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let (path, kind) = (entry.path(), entry.file_type().map_err(failed)?);
            if kind.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("bvh")) {
                files.push(path);
            }
        }
    }
    files.sort();
    if files.is_empty() {
        let problem =
            FileProblem::field("--train", "a folder without BVH files", "one with motion files, .bvh");
        return Err(problem.at(folder, None));
    }
    files.iter().map(|path| bvh::read(path)?.body_points(path)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::damaged::assert_refused;

    #[test]
    fn a_prior_survives_its_file_and_what_is_none_says_where() {
        // Two poses of a leg.
        let text = include_str!("../fuzz/corpus/prior/0-leg.json");
        let read = |text: &str| parse(Path::new("p.json"), text.as_bytes());
        assert_eq!(to_text(&read(text).unwrap()).unwrap(), text);
        for cut in 0..text.len() - 2 {
            assert!(read(&text[..cut]).is_err());
        }
        assert_refused(
            text,
            read,
            r#"
            backlit-prior 1 ⇒ backlit-prior 9 ⇒ `format` is "backlit-prior 9"
            right-thigh ⇒ right-upper-leg ⇒ parts[0].directions
            right-thigh ⇒ right-calf ⇒ `directions` has 2; expected 1 to 12, each once
            "share":0.5 ⇒ "share":-0.5 ⇒ `components[0]` is not a distribution
            0.0625 ⇒ 0 ⇒ `step` is not a distribution
            "degrees":4.0 ⇒ "degrees":0 ⇒ `degrees` is 0
            "degrees":4.0 ⇒ "degrees":null ⇒ p.json, line 2: `degrees` is null
            0.04, ⇒ ⇒ `components[0]` is not a distribution
            "#,
        );
    }

    #[test]
    fn the_built_in_prior_knows_all_parts_and_whom_to_thank() {
        let prior = read_or_built_in(Path::new(PEOPLE)).unwrap();
        let names: Vec<&str> = prior.parts.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, ["trunk", "right arm", "left arm", "right leg", "left leg"]);
        assert!(prior.source.contains("mocap.cs.cmu.edu") && prior.accelerations.is_some());
        assert!(read_or_built_in(Path::new("no such file")).is_err());
    }

    /// Files of before accelerations were learnt have none.
    #[test]
    fn accelerations_survive_and_one_that_is_none_is_named() {
        let text = include_str!("../fuzz/corpus/prior/0-leg.json");
        let read = |text: &str| parse(Path::new("p.json"), text.as_bytes());
        let without = read(text).unwrap();
        assert_eq!(without.accelerations, None);
        let with = without.with_accelerations(people().accelerations.unwrap()).unwrap();
        let text = to_text(&with).unwrap();
        assert_eq!(read(&text).unwrap(), with);
        let message = read(&text.replace("\"calf\":", "\"calf\":-")).unwrap_err().to_string();
        assert!(message.contains("line 3") && message.contains("`accelerations.calf` is"), "{message}");
        assert!(read(&text.replace("\"calf\"", "\"calves\"")).is_err());
    }

    #[test]
    fn numbers_keep_six_digits() {
        assert_eq!(short(0.123_456_789), 0.123_457);
        assert_eq!(short(-1_234.567_89), -1234.57);
        assert_eq!((short(0.0), short(1e-300)), (0.0, 1e-300));
    }

    #[test]
    fn a_folder_without_motion_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        assert!(clips(folder.path()).unwrap_err().to_string().contains("without BVH files"));
        std::fs::write(
            folder.path().join("a.BVH"),
            "HIERARCHY\nROOT a\n{\n}\nMOTION\nFrames: 0\nFrame Time: 1\n",
        )
        .unwrap();
        let message = clips(folder.path()).unwrap_err().to_string();
        assert!(message.contains("a.BVH") && message.contains("waist"), "{message}");
    }
}
