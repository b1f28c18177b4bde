//! What the numbers of a mask mean.
//!
//! A soft grey mask and one with unknown pixels look alike. They are told apart by their levels: a mask whose numbers are 0, 32,
//! 96, 128 and 255 and no others is one of ours, or a trimap, and its greys are unknown. Any other grey is a probability, or a
//! border between pixels: more than half of white is subject, and nothing but the half itself is unknown.

use std::collections::BTreeSet;
use std::fmt;
use std::path::PathBuf;

use backlit_tracking::body_fit::survey::spread_numbers;
use serde::{Deserialize, Serialize};
use thiserror::Error;
use toml::Value;

use super::Numbers;
use crate::{FileError, FileProblem, Result};

/// Masks that are looked at to tell what their numbers mean.
const LOOKED_AT: usize = 9;
/// Most masks that are looked at where those show nobody.
const MOST_LOOKED_AT: usize = 256;
/// Most ids that a take may name.
const MOST_IDS: usize = 64;
/// Levels of masks with unknown pixels; of these the first and the last are in all masks.
const CLASSES: [u16; 5] = [0, 32, 96, 128, 255];
/// Where all grey levels are below this and there are several, they are ids.
const IDS_BELOW: u16 = 64;
/// Of more ids only the first are named.
const NAMED: usize = 8;

/// What the numbers of a mask mean.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MaskValues {
    /// Grey levels or probabilities: above half of white the subject; exactly half, 127 and 128 of 255, is unknown.
    Grey,
    /// All but 0 is the subject: 0 and 1, 0 and 255.
    NonZero,
    /// The alpha channel, as grey levels.
    Alpha,
    /// Of 255, below 64 the background, below 192 unknown, else the subject, as Backlit writes masks; 32 and 96 are shadow.
    Classes,
    /// The pixels with one of these numbers are the subject: of grey levels, or of a palette.
    Ids(Vec<u16>),
}

/// Why masks cannot be understood.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum MaskProblem {
    #[error(
        "is coloured and has no transparent pixels; expected a mask of grey levels, a palette of ids or an alpha channel"
    )]
    Coloured,
    #[error("has no alpha channel; `mask_values` is \"alpha\"")]
    NoAlpha,
    #[error(
        "has the numbers {}, like a map of several people; expected which of them to use, as in \
         mask_values = {{ ids = [{}] }}",
        listed(.ids), .ids.first().copied().unwrap_or(1)
    )]
    SeveralIds { ids: Vec<u16> },
    #[error(
        "id {} is in none of the {looked_at} masks that were looked at; {}", listed(.ids),
        if found.is_empty() { "they are empty".to_owned() } else { format!("there are {}", listed(found)) }
    )]
    NoSuchId { ids: Vec<u16>, found: Vec<u16>, looked_at: usize },
}

/// Numbers in a row, the first few of many.
fn listed(ids: &[u16]) -> String {
    let named: Vec<String> = ids.iter().take(NAMED).map(u16::to_string).collect();
    named.join(", ") + if ids.len() > NAMED { ", …" } else { "" }
}

impl MaskValues {
    /// What a take file accepts.
    pub(crate) const EXPECTED: &str =
        "\"auto\", \"grey\", \"nonzero\", \"alpha\", \"classes\" or { ids = [numbers from 0 to 65535] }";

    /// What a take file says: `Some(None)` for `"auto"`, `None` for what is not accepted.
    pub(crate) fn parse(value: &Value) -> Option<Option<Self>> {
        if value.as_str() == Some("auto") {
            return Some(None);
        }
        match Self::deserialize(value.clone()).ok()? {
            Self::Ids(ids) if !(1..=MOST_IDS).contains(&ids.len()) => None,
            values => Some(Some(values)),
        }
    }
}

/// As a take file says it.
impl fmt::Display for MaskValues {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Value::try_from(self).map_err(|_error| fmt::Error)?.fmt(f)
    }
}

/// One camera's masks, to be looked at.
pub(crate) struct MaskSequence<'a> {
    pub(crate) count: usize,
    pub(crate) path: &'a dyn Fn(usize) -> PathBuf,
    pub(crate) read: &'a dyn Fn(usize) -> Result<Numbers>,
}

/// What the numbers of a camera's masks mean: what is said, if the masks are so; else what masks that are spread over the
/// recording tell.
pub(crate) fn values_of(
    given: Option<&MaskValues>,
    source: &MaskSequence<'_>,
) -> Result<MaskValues, (usize, FileError)> {
    let mut seen = NumberStatistics::default();
    let few: Vec<usize> = spread_numbers(source.count, LOOKED_AT).collect();
    let many = spread_numbers(source.count, MOST_LOOKED_AT).filter(|index| !few.contains(index));
    for (order, index) in few.iter().copied().chain(many).enumerate() {
        if order >= few.len() && seen.suffices(given) {
            break;
        }
        let numbers = (source.read)(index).map_err(|error| (index, error))?;
        let failed = |error| (index, FileError::new(&(source.path)(index), FileProblem::Mask { error }));
        seen.add(&numbers, given).map_err(failed)?;
    }
    let failed = |error| (0, FileError::new(&(source.path)(0), FileProblem::Mask { error }));
    seen.values(given).map_err(failed)
}

/// What was seen in some masks.
#[derive(Debug, Default)]
struct NumberStatistics {
    masks: usize,
    numbers: BTreeSet<u16>,
    is_transparent: bool,
    is_index: bool,
    /// A mask of 16 bits that is darker than this holds ids; 0 for others.
    dark: u16,
}

impl NumberStatistics {
    fn add(&mut self, mask: &Numbers, given: Option<&MaskValues>) -> Result<(), MaskProblem> {
        self.masks += 1;
        let is_transparent = mask.alpha.as_ref().is_some_and(|alpha| alpha.iter().any(|&alpha| alpha < 255));
        match given {
            Some(MaskValues::Alpha) if mask.alpha.is_none() => return Err(MaskProblem::NoAlpha),
            Some(MaskValues::Ids(_)) if mask.is_coloured => return Err(MaskProblem::Coloured),
            None if mask.is_coloured && !is_transparent && !self.is_transparent => {
                return Err(MaskProblem::Coloured);
            }
            _ => {}
        }
        self.is_transparent |= is_transparent;
        self.is_index |= mask.is_index;
        self.dark = if mask.white == u16::MAX { u16::MAX / 4 } else { 0 };
        let mut is_there = vec![false; usize::from(u16::MAX) + 1];
        mask.numbers.iter().for_each(|&number| is_there[usize::from(number)] = true);
        self.numbers.extend((0..=u16::MAX).filter(|&number| is_there[usize::from(number)]));
        Ok(())
    }

    /// Whether further masks need not be looked at.
    fn suffices(&self, given: Option<&MaskValues>) -> bool {
        match given {
            Some(MaskValues::Ids(ids)) => ids.iter().any(|id| self.numbers.contains(id)),
            Some(_) => true,
            None => self.is_transparent || self.numbers.len() > 1,
        }
    }

    fn values(&self, given: Option<&MaskValues>) -> Result<MaskValues, MaskProblem> {
        match given {
            Some(MaskValues::Ids(ids)) if !self.suffices(given) => {
                let found = self.numbers.iter().copied().filter(|&number| number > 0).collect();
                Err(MaskProblem::NoSuchId { ids: ids.clone(), found, looked_at: self.masks })
            }
            Some(given) => Ok(given.clone()),
            None if self.is_transparent => Ok(MaskValues::Alpha),
            None => self.guess(),
        }
    }

    fn guess(&self) -> Result<MaskValues, MaskProblem> {
        let above: Vec<u16> = self.numbers.iter().copied().filter(|&number| number > 0).collect();
        match above[..] {
            [one] if self.is_index || !CLASSES[1..4].contains(&one) => Ok(MaskValues::NonZero),
            [_, .., last] if self.is_index || last < self.dark.max(IDS_BELOW) => {
                Err(MaskProblem::SeveralIds { ids: above })
            }
            [_, ..] if above.iter().all(|number| CLASSES.contains(number)) => Ok(MaskValues::Classes),
            _ => Ok(MaskValues::Grey),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(numbers: &[u16]) -> Numbers {
        Numbers::grey(numbers.len(), numbers)
    }

    fn told_of(given: Option<&MaskValues>, masks: &[Numbers]) -> Result<MaskValues, (usize, String)> {
        let source = MaskSequence {
            count: masks.len(),
            path: &|index| PathBuf::from(format!("{index}.png")),
            read: &|index| Ok(masks[index].clone()),
        };
        values_of(given, &source).map_err(|(index, error)| (index, error.to_string()))
    }

    #[test]
    fn the_levels_tell_what_they_mean() {
        let guess = |levels: &[u16]| told_of(None, &[numbers(levels)]);
        assert_eq!(guess(&[0, 1]), Ok(MaskValues::NonZero));
        assert_eq!(guess(&[0, 255]), Ok(MaskValues::NonZero));
        assert_eq!(guess(&[0, 7]), Ok(MaskValues::NonZero));
        assert_eq!(guess(&[0, 128, 255]), Ok(MaskValues::Classes));
        assert_eq!(guess(&[0, 32, 96, 255]), Ok(MaskValues::Classes));
        assert_eq!(guess(&[0, 128]), Ok(MaskValues::Classes));
        assert_eq!(guess(&[0, 3, 40, 127, 128, 200, 254]), Ok(MaskValues::Grey));
        assert_eq!(guess(&[0]), Ok(MaskValues::Grey));
        // A palette's last number is often "void"; ids of 16 bits may be large.
        let palette = Numbers { is_index: true, ..numbers(&[0, 15, 255]) };
        assert!(told_of(None, &[palette]).unwrap_err().1.contains("the numbers 15, 255"));
        let wide = Numbers { white: u16::MAX, ..numbers(&[0, 1001, 1002]) };
        assert!(told_of(None, &[wide]).unwrap_err().1.contains("the numbers 1001, 1002"));
        let said = guess(&[0, 1, 2, 5]).unwrap_err().1;
        assert!(
            said.starts_with("0.png: has the numbers 1, 2, 5, like a map") && said.contains("ids = [1]"),
            "{said}"
        );
        let clear = Numbers { alpha: Some(vec![0, 255]), is_coloured: true, ..numbers(&[9, 70]) };
        assert_eq!(told_of(None, std::slice::from_ref(&clear)), Ok(MaskValues::Alpha));
        let opaque = Numbers { alpha: Some(vec![255, 255]), ..clear };
        assert!(told_of(None, &[opaque]).unwrap_err().1.contains("0.png: is coloured"));
    }

    #[test]
    fn people_who_come_late_are_looked_for() {
        let mut masks = vec![numbers(&[0, 0]); 300];
        masks[101] = numbers(&[0, 3]);
        masks[102] = numbers(&[0, 3]);
        assert_eq!(told_of(None, &masks), Ok(MaskValues::NonZero));
        let three = MaskValues::Ids(vec![3]);
        assert_eq!(told_of(Some(&three), &masks), Ok(three.clone()));
        let said = told_of(Some(&MaskValues::Ids(vec![4])), &masks).unwrap_err().1;
        assert_eq!(said, "0.png: id 4 is in none of the 259 masks that were looked at; there are 3");
        let said = told_of(Some(&MaskValues::Alpha), &masks).unwrap_err();
        assert_eq!(said, (0, "0.png: has no alpha channel; `mask_values` is \"alpha\"".to_owned()));
    }

    #[test]
    fn a_take_file_says_it_as_it_is_written() {
        let parse = |text: &str| {
            let table: toml::Table = format!("v = {text}").parse().unwrap();
            MaskValues::parse(&table["v"])
        };
        for values in [
            MaskValues::Grey,
            MaskValues::NonZero,
            MaskValues::Alpha,
            MaskValues::Classes,
            MaskValues::Ids(vec![3, 65535]),
        ] {
            assert_eq!(parse(&values.to_string()), Some(Some(values)));
        }
        assert_eq!(parse("\"auto\""), Some(None));
        for wrong in [
            "\"luma\"",
            "3",
            "{ ids = 3 }",
            "{ ids = [] }",
            "{ ids = [-1] }",
            "{ ids = [70000] }",
            "{ id = [1] }",
        ] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
