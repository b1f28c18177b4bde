//! `[measurement]`: the segmentation's options, and what single cameras have otherwise.

use backlit_tracking::segment::SegmentOptions;
use serde::Deserialize;
use toml::{Table, Value};

use crate::plain_words;
use crate::text::cut;

/// Tests and regions that `false` switches off: TOML has no word for nothing. All but the last are tables.
const SWITCHES: [&str; 5] = ["shadow", "dont_know", "region", "chroma", HYSTERESIS];
const HYSTERESIS: &str = "hysteresis_z";

/// What is wrong with one key of a `[measurement]` table.
pub(super) struct KeyProblem {
    pub(super) key: String,
    pub(super) message: String,
}

/// The options of a table; keys left out have their defaults.
pub(super) fn options(table: &Table) -> Result<SegmentOptions, KeyProblem> {
    // One key at a time first: then it is known which one is wrong.
    for (key, value) in table {
        let alone = Table::from_iter([(key.clone(), value.clone())]);
        parse(alone).map_err(|message| KeyProblem { key: key.clone(), message })?;
    }
    parse(table.clone()).map_err(|message| KeyProblem { key: String::new(), message })
}

fn parse(mut table: Table) -> Result<SegmentOptions, String> {
    let off = SWITCHES.map(|key| table.get(key) == Some(&Value::Boolean(false)));
    for (key, _) in SWITCHES.iter().zip(off).filter(|(_, off)| *off) {
        table.remove(*key);
    }
    // A parser would take the list's numbers for the table's, in an order that is not promised.
    if let Some((_, value)) = table
        .iter()
        .find(|(key, value)| SWITCHES.contains(&key.as_str()) && !value.is_table() && *key != HYSTERESIS)
    {
        let shown = value.to_string();
        return Err(format!("is {}; expected a table, as {{ … }}, or false", cut(&shown)));
    }
    let mut options =
        SegmentOptions::deserialize(table).map_err(|error| plain_words::plain(error.message()))?;
    let [no_shadow, no_dont_know, no_region, ..] = off;
    options.shadow = options.shadow.filter(|_| !no_shadow);
    options.dont_know = options.dont_know.filter(|_| !no_dont_know);
    options.region = options.region.filter(|_| !no_region);
    options.check().map_err(|error| error.to_string())?;
    Ok(options)
}

/// The take's table with a camera's own keys in the place of the take's.
pub(super) fn merged(take: &Table, camera: &Table) -> Table {
    let mut out = take.clone();
    for (key, value) in camera {
        match (out.get_mut(key), value) {
            (Some(Value::Table(inner)), Value::Table(more)) => inner.extend(more.clone()),
            _ => {
                out.insert(key.clone(), value.clone());
            }
        }
    }
    out
}

/// The keys of `[measurement]` that lead from some options to others, a line each.
#[must_use]
pub fn measurement_lines(before: &SegmentOptions, after: &SegmentOptions) -> String {
    let table = |options: &SegmentOptions| Table::try_from(options).unwrap_or_default();
    let (before, after) = (table(before), table(after));
    let mut lines = String::new();
    for (key, value) in after.iter().filter(|(key, value)| before.get(*key) != Some(value)) {
        lines += &format!("{key} = {}\n", shortest(value.clone()));
    }
    for key in before.keys().filter(|key| !after.contains_key(*key)) {
        lines += &format!("{key} = false\n");
    }
    lines
}

/// The same with numbers as short as options hold them.
fn shortest(value: Value) -> Value {
    match value {
        Value::Float(number) => Value::Float((number as f32).to_string().parse().unwrap_or(number)),
        Value::Table(table) => {
            Value::Table(table.into_iter().map(|(key, value)| (key, shortest(value))).collect())
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::segment::{ChromaOptions, ShadowOptions};
    use backlit_tracking::silhouette::Region;

    use super::*;

    fn table(text: &str) -> Table {
        text.parse().unwrap()
    }

    #[test]
    fn a_camera_changes_single_keys() {
        let take = table(
            "opening_px = 2\nhysteresis_z = 2.5\nchroma = {}\nshadow = false\ndont_know = { dark_level = 40.0, grow_px = 5 }",
        );
        let camera = table(
            "hysteresis_z = false\nregion = { x = 1, y = 2, width = 30, height = 40 }\ndont_know = { grow_px = 1 }",
        );
        let options = options(&merged(&take, &camera)).ok().unwrap();
        assert_eq!((options.opening_px, options.shadow, options.hysteresis_z), (2, None, None));
        assert_eq!(options.chroma, Some(ChromaOptions::default()));
        assert_eq!(options.region, Some(Region { x: 1, y: 2, width: 30, height: 40 }));
        let dont_know = options.dont_know.unwrap();
        assert_eq!((dont_know.dark_level, dont_know.grow_px), (40.0, 1));
    }

    #[test]
    fn lines_say_what_is_changed() {
        let before = SegmentOptions { hysteresis_z: Some(2.5), ..SegmentOptions::default() };
        let shadow = Some(ShadowOptions { darkest: 0.4, ..ShadowOptions::default() });
        let after = SegmentOptions {
            z_threshold: 5.5,
            shadow,
            hysteresis_z: None,
            dont_know: None,
            ..before.clone()
        };
        let lines = measurement_lines(&before, &after);
        assert!(lines.contains("z_threshold = 5.5\n") && lines.contains("darkest = 0.4,"), "{lines}");
        assert_eq!(lines.lines().count(), 4, "{lines}");
        assert_eq!(options(&merged(&table("hysteresis_z = 2.5"), &table(&lines))).ok().unwrap(), after);
        assert_eq!(measurement_lines(&before, &before), "");
    }

    #[test]
    fn the_wrong_key_is_named() {
        for (text, key) in [
            ("opening_px = 1\nclosing = 3", "closing"),
            ("opening_px = 1\nclosing_px = -3", "closing_px"),
            ("opening_px = 1\nshadow = true", "shadow"),
            ("z_threshold = nan", "z_threshold"),
            ("closing_px = 1000000000000", "closing_px"),
            ("shadow = { dark = 3 }", "shadow"),
            ("shadow = [0.1, 0.9, 20, 30]", "shadow"),
            ("region = [1, 2, 3, 4]", "region"),
            ("dont_know = 3", "dont_know"),
            ("chroma = 3", "chroma"),
            ("chroma = { z_threshold = -1.0 }", "chroma"),
            ("hysteresis_z = \"low\"", "hysteresis_z"),
        ] {
            assert_eq!(options(&table(text)).err().unwrap().key, key, "{text}");
        }
    }
}
