//! C3D: blocks of 512 bytes, a header, parameters, then points as IEEE floats, little endian.
//!
//! A point is x, y, z and a residual: the error of the joint that is told (95 %) in whole millimetres, 0 where nobody judged it,
//! −1 in a gap. Frames count from 1: our frame 0 is 1.

use super::frames::MotionFrames;
use super::names;
use crate::FileProblem;

const BLOCK: usize = 512;
/// A residual of 1, metres.
const RESIDUAL_UNIT_M: f64 = 1e-3;
/// The first block after the header holds parameters.
const PARAMETERS_AT: u8 = 2;
/// One byte counts the labels of a list.
const MOST_LABELS: usize = 255;
/// Bytes of a name, without the number that tells it from another.
const LONGEST_LABEL: usize = 100;

pub(super) fn to_bytes(scene: &MotionFrames<'_>) -> Result<Vec<u8>, FileProblem> {
    let frames = scene.without_gaps()?;
    let labels = labels(scene);
    let (first, last) = scene.first_and_last();
    // The data's place is among the parameters; it does not change their size.
    let blocks = parameters(scene, &labels, frames.len(), 0)?.len() / BLOCK;
    let data_at = word(usize::from(PARAMETERS_AT) + blocks);
    let mut out = header(labels.len(), [first + 1, last + 1], data_at, scene);
    out.extend(parameters(scene, &labels, frames.len(), data_at)?);
    out.reserve(frames.len() * labels.len() * 16 + BLOCK);
    let mut joints = scene.joints();
    for (frame, pose) in frames {
        match pose {
            Some(pose) => {
                for (point, trust) in joints.of(pose).zip(scene.joint_trust(frame)) {
                    for value in point.to_array() {
                        out.extend((value as f32).to_le_bytes());
                    }
                    out.extend(residual(trust.error_95_m).to_le_bytes());
                }
            }
            None => {
                let unknown = [0_f32, 0.0, 0.0, -1.0].map(f32::to_le_bytes).concat();
                out.extend(unknown.repeat(labels.len()));
            }
        }
    }
    fill_block(&mut out);
    Ok(out)
}

/// Negative, since points are floats; then it is the unit of residuals alone.
fn scale(scene: &MotionFrames<'_>) -> f64 {
    -RESIDUAL_UNIT_M * scene.unit.per_metre()
}

/// The fourth word of a point, as whole numbers: which cameras saw it in the high byte, none here, and the residual in the low one, in
/// units of −`SCALE`.
fn residual(error_m: f64) -> f32 {
    if error_m.is_nan() { 0.0 } else { (error_m / RESIDUAL_UNIT_M).round().clamp(0.0, 255.0) as f32 }
}

/// The joints' names: ASCII, and so short that a list of 255 stays below 32 KiB.
fn labels(scene: &MotionFrames<'_>) -> Vec<String> {
    let ascii = |c: char| if c.is_ascii() { c } else { '_' };
    let joints = names::joints(scene.model, scene.names, true);
    names::different(joints.iter().map(|name| name.chars().take(LONGEST_LABEL).map(ascii).collect()))
}

/// A number of 16 bits; larger ones become the largest, and `LONG_FRAMES` or `TRIAL` say more.
fn word(value: usize) -> u16 {
    u16::try_from(value).unwrap_or(u16::MAX)
}

fn fill_block(out: &mut Vec<u8>) {
    out.resize(out.len().next_multiple_of(BLOCK), 0);
}

fn header(points: usize, [first, last]: [usize; 2], data_at: u16, scene: &MotionFrames<'_>) -> Vec<u8> {
    let mut out = vec![PARAMETERS_AT, 0x50];
    for value in [word(points), 0, word(first), word(last), 0] {
        out.extend(value.to_le_bytes());
    }
    out.extend((scale(scene) as f32).to_le_bytes());
    out.extend(data_at.to_le_bytes());
    out.extend(0_u16.to_le_bytes());
    out.extend((scene.frame_rate as f32).to_le_bytes());
    fill_block(&mut out);
    out
}

/// The parameter section, whole blocks.
fn parameters(
    scene: &MotionFrames<'_>,
    labels: &[String],
    frames: usize,
    data_at: u16,
) -> Result<Vec<u8>, FileProblem> {
    let (first, last) = scene.first_and_last();
    let mut section = Section(vec![1, 0x50, 0, 84]);
    section.group(1, "POINT");
    section.integers(1, "USED", &[word(labels.len())]);
    section.integers(1, "FRAMES", &[word(frames)]);
    if frames > usize::from(u16::MAX) {
        section.real(1, "LONG_FRAMES", frames as f64);
    }
    section.real(1, "SCALE", scale(scene));
    section.real(1, "RATE", scene.frame_rate);
    section.integers(1, "DATA_START", &[data_at]);
    section.text(1, "UNITS", scene.unit.symbol());
    if let Some([x, y]) = scene.screen() {
        section.text(1, "X_SCREEN", x);
        section.text(1, "Y_SCREEN", y);
    }
    for (index, part) in labels.chunks(MOST_LABELS).enumerate() {
        let number = if index == 0 { String::new() } else { (index + 1).to_string() };
        section.texts(1, &format!("LABELS{number}"), part);
        section.texts(1, &format!("DESCRIPTIONS{number}"), &vec![String::new(); part.len()]);
    }
    section.group(2, "ANALOG");
    section.integers(2, "USED", &[0]);
    section.real(2, "RATE", 0.0);
    section.real(2, "GEN_SCALE", 1.0);
    section.group(3, "FORCE_PLATFORM");
    section.integers(3, "USED", &[0]);
    section.group(4, "TRIAL");
    // Two words each: the lower 16 bits first.
    let long = |frame: usize| [word(frame & 0xffff), word(frame >> 16)];
    section.integers(4, "ACTUAL_START_FIELD", &long(first + 1));
    section.integers(4, "ACTUAL_END_FIELD", &long(last + 1));
    let Section(mut out) = section;
    out.extend([0, 0]);
    fill_block(&mut out);
    let blocks = out.len() / BLOCK;
    out[2] = u8::try_from(blocks).map_err(|_error| {
        let found = format!("so many that their names fill {blocks} blocks");
        FileProblem::field("joints", found, "at most 255 blocks of names")
    })?;
    Ok(out)
}

/// Records of groups and parameters, one after the other.
struct Section(Vec<u8>);

impl Section {
    fn record(&mut self, id: i8, name: &str, content: &[u8]) {
        self.0.push(name.len() as u8);
        self.0.extend(id.to_le_bytes());
        self.0.extend(name.as_bytes());
        // How far it is from here to the next record; what follows the content is an empty description.
        self.0.extend(word(2 + content.len() + 1).to_le_bytes());
        self.0.extend(content);
        self.0.push(0);
    }

    fn group(&mut self, id: i8, name: &str) {
        self.record(-id, name, &[]);
    }

    fn integers(&mut self, id: i8, name: &str, values: &[u16]) {
        // One value has no dimensions.
        let mut content = if values.len() == 1 { vec![2, 0] } else { vec![2, 1, values.len() as u8] };
        content.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        self.record(id, name, &content);
    }

    fn real(&mut self, id: i8, name: &str, value: f64) {
        self.record(id, name, &[&[4, 0][..], &(value as f32).to_le_bytes()].concat());
    }

    fn text(&mut self, id: i8, name: &str, text: &str) {
        self.record(id, name, &[&[255, 1, text.len() as u8][..], text.as_bytes()].concat());
    }

    /// A list of texts of one length, filled with spaces.
    fn texts(&mut self, id: i8, name: &str, texts: &[String]) {
        let width = texts.iter().map(String::len).max().unwrap_or(0).clamp(1, 255);
        let mut content = vec![255, 2, width as u8, texts.len() as u8];
        for text in texts {
            let mut bytes = text.as_bytes().to_vec();
            bytes.resize(width, b' ');
            content.extend(bytes);
        }
        self.record(id, name, &content);
    }
}
