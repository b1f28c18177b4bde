//! What motions of the take are called: what the timeline shows of it.

use std::ops::RangeInclusive;
use std::sync::Arc;

use backlit_ui::style::format;

/// Frames that follow each other and have one name.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NamedStretch {
    /// In plain words, in the middle of a sentence.
    pub(crate) name: String,
    /// The number of its class, which says its colour; `None` is no known motion.
    pub(crate) class: Option<usize>,
    pub(crate) frames: RangeInclusive<usize>,
    /// Mean probability of the name, 0 to 1.
    pub(crate) confidence: f64,
}

impl NamedStretch {
    /// Name, frames, and how sure that is.
    pub(crate) fn said(&self) -> String {
        let [first, last] =
            [self.frames.start(), self.frames.end()].map(|frame| format::count(*frame as i64));
        let sure = whole_percent(self.confidence);
        let how = match self.class {
            Some(_) => format!("{sure} sure"),
            None => "like no motion that was learnt".to_owned(),
        };
        format!("{}, frames {first} to {last}, {how}", format::capitalised(&self.name))
    }
}

/// A probability in whole per cent: more digits would say more than is known.
pub(crate) fn whole_percent(share: f64) -> String {
    format!("{}{}%", format::number(100.0 * share, 0), format::THIN_SPACE)
}

/// The take's motions by name.
#[derive(Debug, Clone, Default)]
pub(crate) struct MotionMarks {
    /// In the order of their frames; none where nothing is recognised.
    pub(crate) stretches: Arc<Vec<NamedStretch>>,
    /// Whether they are of an older track than the document's.
    pub(crate) is_stale: bool,
}

impl MotionMarks {
    /// The stretch that a frame is part of.
    pub(crate) fn at(&self, frame: usize) -> Option<&NamedStretch> {
        self.stretches.iter().find(|stretch| stretch.frames.contains(&frame))
    }
}
