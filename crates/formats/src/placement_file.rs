//! Where a tool puts its markers: `backlit-placement 1` JSON (see `docs/formats.md`).

use std::path::Path;

use backlit_tracking::body::Model;
use backlit_tracking::metrics::{MarkerOffset, MarkerPlacement};
use backlit_tracking::names;
use glam::DVec3;
use serde::Deserialize;
use serde_json::json;

use super::json_text::{self, Entries};
use super::take::Joint;
use super::{DiskFiles, FileError, FileProblem, Result, TakeFiles, atomic, text};

/// Name and version of the file's format.
pub const FORMAT: &str = "backlit-placement 1";
/// Largest file that is read, bytes: a body has 257 joints.
pub(super) const MAX_BYTES: u64 = 1 << 20;
/// A marker farther from its joint along an axis is a mistake of units, metres.
const MAX_OFFSET: f64 = 0.5;
/// Numbers are written to a hundredth of a millimetre.
const STEPS_PER_METRE: f64 = 1e5;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PlacementSpec {
    #[serde(rename = "format")]
    _format: String,
    tool: String,
    offsets: Entries<OffsetSpec>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OffsetSpec {
    offset: [f64; 3],
    spread: f64,
    frames: usize,
}

/// Parses the content of a placement's file for a body; `path` is for the error's message.
///
/// # Errors
/// Not such a file, a joint that the body does not have, or a number out of range. The error names the line and the joint.
pub fn parse(path: &Path, bytes: &[u8], model: &Model) -> Result<MarkerPlacement> {
    let text = text::decode(path, bytes)?;
    let spec: PlacementSpec = json_text::parse_versioned(path, text, FORMAT)?;
    let fail = |keys: &[&str], problem| FileError::new(path, problem).at_line(json_text::line_of(text, keys));
    if !names::is_name(&spec.tool) {
        let problem = FileProblem::field("tool", format!("{:?}", spec.tool), names::EXPECTED);
        return Err(fail(&["tool"], problem));
    }
    let mut placement = MarkerPlacement { tool: spec.tool, ..MarkerPlacement::default() };
    for (joint, OffsetSpec { offset, spread, frames }) in spec.offsets.0 {
        if Joint::named(model, &joint).is_none() {
            let problem = FileProblem::UnknownLimb { field: "offsets".to_owned(), limb: joint.clone() };
            return Err(fail(&["offsets", &joint], problem));
        }
        let is_near = |number: &f64| number.abs() <= MAX_OFFSET;
        if !(offset.iter().all(is_near) && (0.0..=MAX_OFFSET).contains(&spread)) {
            let expected = format!("metres, at most {MAX_OFFSET}, of the spread 0 or above");
            let problem =
                FileProblem::field(format!("offsets.{joint}"), format!("{offset:?} ± {spread:?}"), expected);
            return Err(fail(&["offsets", &joint], problem));
        }
        placement.offsets.insert(joint, MarkerOffset { offset: DVec3::from_array(offset), spread, frames });
    }
    Ok(placement)
}

/// Reads a placement from the disk.
pub fn read(path: &Path, model: &Model) -> Result<MarkerPlacement> {
    parse(path, &DiskFiles.read(path, MAX_BYTES)?, model)
}

/// The content of a placement's file, a joint a line.
#[must_use]
pub fn to_text(placement: &MarkerPlacement) -> String {
    let short = |metres: f64| (metres * STEPS_PER_METRE).round() / STEPS_PER_METRE;
    let joint = |(name, of): (&String, &MarkerOffset)| {
        let offset = json!(of.offset.to_array().map(short));
        let spread = json!(short(of.spread));
        format!("{}: {{\"offset\": {offset}, \"spread\": {spread}, \"frames\": {}}}", json!(name), of.frames)
    };
    let joints: Vec<String> = placement.offsets.iter().map(joint).collect();
    let (tool, joints) = (json!(placement.tool), joints.join(",\n  "));
    format!("{{\"format\": \"{FORMAT}\",\n \"tool\": {tool},\n \"offsets\": {{\n  {joints}}}}}\n")
}

/// Writes a placement, whole or not at all.
pub fn write(path: &Path, placement: &MarkerPlacement) -> Result<()> {
    atomic::write(path, to_text(placement).as_bytes())
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;
    use crate::damaged::assert_refused;

    #[test]
    fn a_placement_survives_its_file_and_errors_name_line_and_joint() {
        let good = include_str!("../fuzz/corpus/placement/0-upper-body.json");
        let read = |text: &str| parse(Path::new("p.json"), text.as_bytes(), &builtin::upper_body());
        let placement = read(good).unwrap();
        assert_eq!((placement.tool.as_str(), placement.offsets.len()), ("BODY_25", 2));
        assert_eq!(placement.offsets["head"].offset, DVec3::new(0.0, -0.02, 0.013));
        assert_eq!(to_text(&placement), good);
        assert_refused(
            good,
            read,
            r#"
            "head" ⇒ "tail" ⇒ p.json, line 4: `offsets` names "tail", and the model has no limb
            "head" ⇒ "root" ⇒ given twice
            -0.02 ⇒ -20.0 ⇒ line 4: `offsets.head` is [0.0, -20.0, 0.013] ± 0.008; expected metres, at most 0.5
            0.008 ⇒ -0.008 ⇒ line 4: `offsets.head` is
            -0.02 ⇒ NaN ⇒ line 4: is not valid JSON: in `offsets.head.offset[1]`: NaN is not a number
            35 ⇒ -1 ⇒ line 4: `offsets.head.frames`
            BODY_25 ⇒ \t ⇒ p.json, line 2
            placement 1 ⇒ placement 2 ⇒ line 1: `format` is "backlit-placement 2"
            "#,
        );
    }
}
