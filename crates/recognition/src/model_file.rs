//! A recognizer as a file: `backlit-motions 4`, JSON. Numbers have six digits, which changes no name.

use std::ops::RangeInclusive;

use serde::Deserialize;
use serde_json::{Number, Value, json};
use thiserror::Error;

use crate::discriminant::Discriminant;
use crate::features::{FRAME_FEATURES, MEASURE_COUNT};
use crate::recognizer::Recognizer;

/// Name and version of the format.
pub const FORMAT: &str = "backlit-motions 4";

/// Most classes, axes, states and known windows of a file.
const MOST: [usize; 4] = [100, 100, 100, 1_000_000];
/// Digits of a number.
const DIGITS: i32 = 6;

/// Why a text is no recognizer.
#[derive(Debug, Error, Clone, PartialEq)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum ModelError {
    #[error("line {line}: {message}; expected a file that `backlit recognise --train` wrote")]
    Json { line: usize, message: String },
    #[error("`format` is {found}; expected \"{FORMAT}\": an older file has to be learnt again")]
    Format { found: String },
    #[error("`{field}` has {found}; expected {expected}")]
    Field { field: String, found: String, expected: String },
}

impl Recognizer {
    /// The recognizer as a file's content.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut value = json!(self);
        shorten(&mut value);
        let mut out = format!("{{\n  \"format\": {}", json!(FORMAT));
        for (key, value) in value.as_object().into_iter().flatten() {
            out.push_str(&format!(",\n  {}: {value}", json!(key)));
        }
        out + "\n}\n"
    }

    /// Reads such a content again.
    ///
    /// # Errors
    /// Not such a file, or numbers that do not go together. The error names the line or the field.
    pub fn from_text(text: &str) -> Result<Self, ModelError> {
        #[derive(Deserialize)]
        struct FormatOnly {
            format: Option<Value>,
        }
        let wrong = |error: serde_json::Error| ModelError::Json {
            line: error.line(),
            message: error.to_string().split(" at line").next().unwrap_or_default().to_owned(),
        };
        match serde_json::from_str::<FormatOnly>(text).map_err(wrong)?.format {
            Some(Value::String(format)) if format == FORMAT => {}
            other => {
                let found = other.map_or_else(|| "missing".to_owned(), |other| other.to_string());
                return Err(ModelError::Format { found: found.chars().take(60).collect() });
            }
        }
        let mut value: Value = serde_json::from_str(text).map_err(wrong)?;
        if let Some(fields) = value.as_object_mut() {
            fields.remove("format");
        }
        let message = |error: serde_json::Error| ModelError::Field {
            field: "the file".to_owned(),
            found: error.to_string(),
            expected: "the fields that `backlit recognise --train` writes".to_owned(),
        };
        let found: Self = serde_json::from_value(value).map_err(message)?;
        found.check()?;
        Ok(found)
    }

    /// Whether all sizes go together, so that naming never fails.
    fn check(&self) -> Result<(), ModelError> {
        let count = self.classes.len();
        size("classes", count, 2..=MOST[0])?;
        size("plane.mean", self.plane.mean.len(), FRAME_FEATURES..=FRAME_FEATURES)?;
        table("plane.components", &self.plane.components, 2..=2, FRAME_FEATURES)?;
        size("clouds", self.clouds.len(), count..=count)?;
        let short = axes("short", &self.short)?;
        let long = axes("long", &self.long)?;
        size("models", self.models.len(), count..=count)?;
        for (index, model) in self.models.iter().enumerate() {
            let at = |field: &str| format!("models[{index}].{field}");
            let states = model.state_count();
            size(&at("start"), states, 1..=MOST[2])?;
            for (field, rows, width) in [
                ("transitions", &model.transitions, states),
                ("means", &model.means, short),
                ("variances", &model.variances, short),
            ] {
                table(&at(field), rows, states..=states, width)?;
            }
            let all = model.start.iter().chain(model.transitions.iter().flatten());
            range(&at("transitions"), all, 0.0..=1.0)?;
            range(&at("variances"), model.variances.iter().flatten(), 1e-9..=1e9)?;
        }
        table("basis.centres", &self.basis.centres, 1..=MOST[3], long)?;
        for (field, rows, rows_count, width) in [
            ("machine.planes", &self.machine.planes, count, self.basis.centres.len() + 1),
            ("wide_machine.planes", &self.wide_machine.planes, count, MEASURE_COUNT + 1),
            ("novelty.means", &self.novelty.means, count, MEASURE_COUNT),
            ("novelty.whitening", &self.novelty.whitening, MEASURE_COUNT, MEASURE_COUNT),
        ] {
            table(field, rows, rows_count..=rows_count, width)?;
        }
        range("novelty.threshold", [&self.novelty.threshold].into_iter(), 1e-9..=1e9)?;
        range("switch_penalty", [&self.switch_penalty].into_iter(), 0.0..=1e6)?;
        if let Some(known) = &self.exemplars {
            let windows = known.places.len();
            table("exemplars.places", &known.places, 0..=MOST[3], long)?;
            size("exemplars.classes", known.classes.len(), windows..=windows)?;
            size("exemplars.weights", known.weights.len(), windows..=windows)?;
            if let Some(class) = known.classes.iter().find(|class| **class >= count) {
                let expected = format!("numbers below {count}");
                return Err(field("exemplars.classes", format!("the number {class}"), expected));
            }
        }
        Ok(())
    }
}

fn field(field: &str, found: String, expected: String) -> ModelError {
    ModelError::Field { field: field.to_owned(), found, expected }
}

fn size(name: &str, found: usize, expected: RangeInclusive<usize>) -> Result<(), ModelError> {
    if expected.contains(&found) {
        return Ok(());
    }
    let (least, most) = (expected.start(), expected.end());
    let expected = if least == most { least.to_string() } else { format!("{least} to {most}") };
    Err(field(name, format!("{found} entries"), expected))
}

/// Checks how many rows there are and how long each is.
fn table(
    name: &str,
    rows: &[Vec<f64>],
    count: RangeInclusive<usize>,
    width: usize,
) -> Result<(), ModelError> {
    size(name, rows.len(), count)?;
    rows.iter()
        .enumerate()
        .try_for_each(|(index, row)| size(&format!("{name}[{index}]"), row.len(), width..=width))
}

fn range<'a>(
    name: &str,
    mut values: impl Iterator<Item = &'a f64>,
    expected: RangeInclusive<f64>,
) -> Result<(), ModelError> {
    match values.find(|value| !expected.contains(*value)) {
        None => Ok(()),
        Some(value) => {
            let (least, most) = (expected.start(), expected.end());
            Err(field(name, format!("the number {value}"), format!("numbers from {least} to {most}")))
        }
    }
}

/// Checks axes; how many there are.
fn axes(name: &str, found: &Discriminant) -> Result<usize, ModelError> {
    for (part, length) in [("mean", found.mean.len()), ("deviation", found.deviation.len())] {
        size(&format!("{name}.{part}"), length, MEASURE_COUNT..=MEASURE_COUNT)?;
    }
    range(&format!("{name}.deviation"), found.deviation.iter(), 1e-9..=1e9)?;
    table(&format!("{name}.axes"), &found.axes, 1..=MOST[1], MEASURE_COUNT)?;
    size(&format!("{name}.origin"), found.origin.len(), found.axes.len()..=found.axes.len())?;
    Ok(found.axes.len())
}

/// Rounds every number to [`DIGITS`] digits.
fn shorten(value: &mut Value) {
    match value {
        Value::Number(number) if number.is_f64() => {
            let x = number.as_f64().unwrap_or(0.0);
            let scale = 10_f64.powi(DIGITS - 1 - x.abs().max(1e-300).log10().floor() as i32);
            let short = if x == 0.0 || !scale.is_finite() { 0.0 } else { (x * scale).round() / scale };
            if let Some(short) = Number::from_f64(short) {
                *number = short;
            }
        }
        Value::Array(values) => values.iter_mut().for_each(shorten),
        Value::Object(fields) => fields.values_mut().for_each(shorten),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{learnt, standing_and_walking};

    #[test]
    fn what_is_written_is_read_and_names_the_same() {
        let learnt = learnt();
        let text = learnt.to_text();
        let read = Recognizer::from_text(&text).unwrap();
        assert_eq!(read.to_text(), text);
        for named in &standing_and_walking() {
            let [a, b] = [&learnt, &read].map(|model| model.recognise(&named.motion).unwrap());
            for (a, b) in a.frames.iter().zip(&b.frames) {
                assert_eq!((a.class, a.frame), (b.class, b.frame));
                assert!((a.confidence - b.confidence).abs() < 1e-3);
            }
            assert_eq!(a.classes[a.frames[20].class.unwrap()], named.class);
        }
    }

    #[test]
    fn a_broken_file_says_where() {
        let text = learnt().to_text();
        for cut in (0..text.len() - 3).step_by(text.len() / 40) {
            let message = Recognizer::from_text(&text[..cut]).unwrap_err().to_string();
            assert!(message.contains("line"), "{message}");
        }
        for (from, to, expected) in [
            ("backlit-motions 4", "backlit-motions 9", "`format` is \"backlit-motions 9\""),
            ("\"classes\": [", "\"classes\": [\"x\",", "`clouds` has 2 entries; expected 3"),
            ("\"switch_penalty\": ", "\"switch_penalty\": -", "`switch_penalty` has the number -"),
            ("\"origin\":[", "\"origin\":[1,", "origin` has 2 entries; expected 1"),
            ("\"machine\"", "\"other\"", "`the file`"),
        ] {
            let changed = text.replacen(from, to, 1);
            assert_ne!(changed, text, "{from}");
            let message = Recognizer::from_text(&changed).unwrap_err().to_string();
            assert!(message.contains(expected), "{from}: {message}");
        }
    }

    #[test]
    fn the_built_in_model_is_valid_and_holds_no_window() {
        let model = Recognizer::built_in();
        assert_eq!(model.classes, ["box", "dance", "gesture", "jump", "run", "sit_bend", "walk"]);
        assert!(model.exemplars.is_none());
    }
}
