//! C3D (c3d.org): blocks of 512 bytes: a header, parameters, then for every frame the points and the analog samples, as floats or as
//! 16-bit integers, written by an Intel, a DEC or a MIPS processor. Frame 1 is at 0 s.

use std::collections::BTreeMap;

use super::{Recording, limited, point};
use crate::FileProblem;

const BLOCK: usize = 512;
/// Metres in one unit, by its name.
const UNITS: [(&str, f64); 5] = [("mm", 0.001), ("cm", 0.01), ("dm", 0.1), ("in", 0.0254), ("m", 1.0)];

fn problem(field: &str, found: impl ToString, expected: &str) -> FileProblem {
    FileProblem::field(field, found.to_string(), expected)
}

/// Who wrote the numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Processor {
    Intel,
    /// Floats of a VAX: words in another order, and exponents that are larger by two.
    Dec,
    Mips,
}

/// The bytes with the order of their numbers; what lies beyond the end is an error.
#[derive(Clone, Copy)]
struct Bytes<'a> {
    bytes: &'a [u8],
    processor: Processor,
}

impl Bytes<'_> {
    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], FileProblem> {
        let bytes = at.checked_add(N).and_then(|past| self.bytes.get(at..past)?.try_into().ok());
        bytes.ok_or_else(|| {
            problem("length", format!("{} bytes", self.bytes.len()), "a file that is not cut off")
        })
    }

    fn byte(&self, at: usize) -> Result<u8, FileProblem> {
        Ok(self.array::<1>(at)?[0])
    }

    fn word(&self, at: usize) -> Result<i16, FileProblem> {
        let bytes = self.array(at)?;
        Ok(if self.processor == Processor::Mips {
            i16::from_be_bytes(bytes)
        } else {
            i16::from_le_bytes(bytes)
        })
    }

    fn count(&self, at: usize) -> Result<usize, FileProblem> {
        Ok(usize::from(self.word(at)?.cast_unsigned()))
    }

    fn float(&self, at: usize) -> Result<f64, FileProblem> {
        let [a, b, c, d] = self.array(at)?;
        Ok(f64::from(match self.processor {
            Processor::Intel => f32::from_le_bytes([a, b, c, d]),
            Processor::Mips => f32::from_be_bytes([a, b, c, d]),
            Processor::Dec => f32::from_le_bytes([c, d, a, b]) / 4.0,
        }))
    }
}

/// A parameter's kind (−1 texts, 1 bytes, 2 words, 4 floats), its dimensions, and where its data begins.
#[derive(Debug, Clone)]
struct Parameter {
    kind: i8,
    dimensions: Vec<usize>,
    data_at: usize,
}

/// Parameters by `GROUP:NAME`.
struct Parameters<'a> {
    bytes: Bytes<'a>,
    all: BTreeMap<String, Parameter>,
}

impl<'a> Parameters<'a> {
    /// Parses the section that begins at a byte.
    fn parse(bytes: Bytes<'a>, start: usize) -> Result<Self, FileProblem> {
        let blocks = usize::from(bytes.byte(start + 2)?);
        let end = (start + blocks.max(1) * BLOCK).min(bytes.bytes.len());
        let (mut groups, mut found) = (BTreeMap::new(), Vec::new());
        let mut at = start + 4;
        while at + 2 < end {
            let length = usize::from(bytes.byte(at)?.cast_signed().unsigned_abs());
            let group = bytes.byte(at + 1)?.cast_signed();
            if length == 0 || group == 0 {
                break;
            }
            let name = bytes
                .bytes
                .get(at + 2..at + 2 + length)
                .map(|name| String::from_utf8_lossy(name).to_uppercase());
            let name = name.ok_or_else(|| problem("parameters", "cut off", "names of parameters"))?;
            let next_at = at + 2 + length;
            if group < 0 {
                groups.insert(group.unsigned_abs(), name);
            } else {
                let kind = bytes.byte(next_at + 2)?.cast_signed();
                let count = usize::from(bytes.byte(next_at + 3)?);
                let dimensions: Result<Vec<usize>, FileProblem> =
                    (0..count).map(|k| Ok(usize::from(bytes.byte(next_at + 4 + k)?))).collect();
                let parameter = Parameter { kind, dimensions: dimensions?, data_at: next_at + 4 + count };
                found.push((group.unsigned_abs(), name, parameter));
            }
            match bytes.count(next_at)? {
                0 => break,
                next => at = next_at + next,
            }
        }
        let named = |(group, name, parameter)| Some((format!("{}:{name}", groups.get(&group)?), parameter));
        Ok(Self { bytes, all: found.into_iter().filter_map(named).collect() })
    }

    /// The first number of a parameter.
    fn number(&self, name: &str) -> Option<f64> {
        let Parameter { kind, data_at, .. } = self.all.get(name)?;
        match kind {
            4 => self.bytes.float(*data_at).ok(),
            2 => self.bytes.count(*data_at).ok().map(|count| count as f64),
            _ => None,
        }
    }

    /// The texts of a parameter: the first dimension is their length.
    fn texts(&self, name: &str) -> Vec<String> {
        let Some(Parameter { kind: -1, dimensions, data_at }) = self.all.get(name) else { return Vec::new() };
        let length = dimensions.first().copied().unwrap_or(1);
        let count: usize = dimensions.iter().skip(1).product();
        let text = |k: usize| {
            let at = data_at + k * length;
            Some(String::from_utf8_lossy(self.bytes.bytes.get(at..at + length)?).trim().to_owned())
        };
        (0..count).map_while(text).collect()
    }
}

/// The frames' sizes and numbers.
struct PointLayout {
    points: usize,
    analog: usize,
    frames: usize,
    first: usize,
    scale: f64,
    data_at: usize,
    metres: f64,
}

impl PointLayout {
    /// Bytes of one number.
    fn size(&self) -> usize {
        if self.scale < 0.0 { 4 } else { 2 }
    }

    fn of(bytes: Bytes<'_>, parameters: &Parameters<'_>) -> Result<Self, FileProblem> {
        let (first, last) = (bytes.count(6)?, bytes.count(8)?);
        let data_block = bytes.count(16)?;
        let unit =
            parameters.texts("POINT:UNITS").first().map(|unit| unit.to_lowercase()).unwrap_or_default();
        let metres = UNITS.iter().find(|(name, _)| unit.starts_with(name)).map_or(1.0, |(_, metres)| *metres);
        let mut layout = Self {
            points: bytes.count(2)?,
            analog: bytes.count(4)?,
            frames: 0,
            first,
            scale: bytes.float(12)?,
            data_at: data_block.saturating_sub(1) * BLOCK,
            metres,
        };
        if layout.points == 0 || data_block < 2 {
            return Err(problem(
                "points",
                layout.points,
                "a header with points and the block where they begin",
            ));
        }
        let stride = layout.size() * (4 * layout.points + layout.analog);
        let there = bytes.bytes.len().saturating_sub(layout.data_at) / stride;
        // Numbers of frames have 16 bits in the header; longer recordings tell the last elsewhere, and the file's length decides.
        let told = match parameters.number("POINT:FRAMES").or_else(|| parameters.number("POINT:LONG_FRAMES"))
        {
            _ if last > first && last < usize::from(u16::MAX) => last - first + 1,
            Some(frames) if frames > 0.0 && last < usize::from(u16::MAX) => frames as usize,
            _ => there,
        };
        layout.frames = told.min(there);
        limited(layout.frames.checked_mul(layout.points))?;
        Ok(layout)
    }
}

pub(super) fn parse(bytes: &[u8]) -> Result<Recording, FileProblem> {
    let mut bytes = Bytes { bytes, processor: Processor::Intel };
    if bytes.byte(1)? != 0x50 {
        return Err(problem("first word", format!("{:#x}", bytes.byte(1)?), "0x50, as C3D files begin"));
    }
    let start = usize::from(bytes.byte(0)?).saturating_sub(1) * BLOCK;
    bytes.processor = match bytes.byte(start + 3)? {
        84 => Processor::Intel,
        85 => Processor::Dec,
        86 => Processor::Mips,
        other => return Err(problem("processor", other, "84 (Intel), 85 (DEC) or 86 (MIPS)")),
    };
    let parameters = Parameters::parse(bytes, start)?;
    let layout = PointLayout::of(bytes, &parameters)?;
    let rate = bytes.float(20)?;
    let rate = if rate > 0.0 { rate } else { parameters.number("POINT:RATE").unwrap_or(0.0) };
    let rate = super::told_rate(Some(rate), "")?;
    let mut names = parameters.texts("POINT:LABELS");
    for more in 2.. {
        match parameters.texts(&format!("POINT:LABELS{more}")) {
            labels if labels.is_empty() => break,
            labels => names.extend(labels),
        }
    }
    names.truncate(layout.points);
    names.extend((names.len()..layout.points).map(|point| format!("point {}", point + 1)));
    let stride = layout.size() * (4 * layout.points + layout.analog);
    let read = |at: usize, k: usize| -> Result<f64, FileProblem> {
        if layout.scale < 0.0 {
            bytes.float(at + 4 * k)
        } else {
            Ok(f64::from(bytes.word(at + 2 * k)?) * layout.scale)
        }
    };
    let mut points = Vec::with_capacity(layout.frames);
    for frame in 0..layout.frames {
        let mut row = Vec::with_capacity(layout.points);
        for marker in 0..layout.points {
            let at = layout.data_at + frame * stride + marker * 4 * layout.size();
            let [x, y, z] = [read(at, 0)?, read(at, 1)?, read(at, 2)?];
            // The fourth word holds a residual, negative where the point was not seen.
            let is_seen = read(at, 3)? >= 0.0 && [x, y, z] != [0.0; 3];
            row.push(point([x, y, z].map(|value| layout.metres * value)).filter(|_| is_seen));
        }
        points.push(row);
    }
    let times =
        (0..layout.frames).map(|frame| (layout.first.saturating_sub(1) + frame) as f64 / rate).collect();
    Ok(Recording { names, times, points, angles: BTreeMap::new() })
}
