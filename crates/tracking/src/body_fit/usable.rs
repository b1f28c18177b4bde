//! Whether silhouettes can be those of a person at all, before anything is fitted to them.

use thiserror::Error;

use crate::fit::{Evidence, FitView};
use crate::silhouette::{Label, Mask};

/// A mask of which more is unknown says nothing: with a black plate nearly all of it is.
const MOST_UNKNOWN: f64 = 0.8;
/// A subject that covers more of what is known fills the picture.
const MOST_SUBJECT: f64 = 0.6;
/// A subject with a larger share of its border beside unknown pixels has hardly an outline.
const MOST_HIDDEN: f64 = 0.8;

/// Why a silhouette cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum Unusable {
    #[error("nobody is seen")]
    Nobody,
    #[error("{:.0} % of the pixels are unknown; at most {:.0} % may be", 100.0 * share, 100.0 * MOST_UNKNOWN)]
    Unknown { share: f64 },
    #[error("the subject covers {:.0} % of the picture; at most {:.0} % can be a person", 100.0 * share, 100.0 * MOST_SUBJECT)]
    Fills { share: f64 },
    #[error("{:.0} % of the subject's border lies beside unknown pixels; at most {:.0} % may", 100.0 * share, 100.0 * MOST_HIDDEN)]
    Hidden { share: f64 },
}

/// A camera that was left out of a frame.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("camera \"{camera}\", frame {frame}: {because}")]
pub struct LeftOut {
    /// The frame.
    pub frame: usize,
    /// The camera's name.
    pub camera: String,
    /// Why.
    pub because: Unusable,
}

/// Looks at a mask by itself.
///
/// # Errors
/// What speaks against it.
pub fn check_mask(mask: &Mask) -> Result<(), Unusable> {
    let [subject, background, unknown] =
        [Label::Subject, Label::Background, Label::Unknown].map(|label| mask.count(label) as f64);
    let unknown_share = unknown / (subject + background + unknown).max(1.0);
    if unknown_share > MOST_UNKNOWN {
        return Err(Unusable::Unknown { share: unknown_share });
    }
    if subject == 0.0 {
        return Err(Unusable::Nobody);
    }
    let share = subject / (subject + background);
    if share > MOST_SUBJECT {
        return Err(Unusable::Fills { share });
    }
    let (seen, hidden) = borders(mask);
    let share = hidden as f64 / (seen + hidden).max(1) as f64;
    if share > MOST_HIDDEN { Err(Unusable::Hidden { share }) } else { Ok(()) }
}

/// The same of what a camera contributes; grey levels are taken as they are.
///
/// # Errors
/// What speaks against it.
pub fn check_view(view: &FitView) -> Result<(), Unusable> {
    match &view.evidence {
        Evidence::Mask(mask) => check_mask(mask),
        Evidence::Measurement(_) => Ok(()),
    }
}

/// A frame's views that count and can be a person's; others that count are noted.
pub(super) fn usable_views(
    frame: usize,
    mut views: Vec<FitView>,
    left_out: &mut Vec<LeftOut>,
) -> Vec<FitView> {
    let mut keep = |view: &FitView| match check_view(view) {
        Ok(()) => view.has_data(),
        Err(because) => {
            left_out.push(LeftOut { frame, camera: view.camera.name().to_owned(), because });
            false
        }
    };
    views.retain(|view| view.weight > 0.0 && keep(view));
    views
}

/// The best reason of all: a picture in which nobody is may be between others, one that cannot be right is worse.
pub(super) fn worst<'a>(mut left_out: impl Iterator<Item = &'a LeftOut> + Clone) -> Option<&'a LeftOut> {
    left_out.clone().find(|one| one.because != Unusable::Nobody).or_else(|| left_out.next())
}

/// Neighbours across and down of which one is subject and the other background, or unknown.
fn borders(mask: &Mask) -> (usize, usize) {
    let (width, labels) = (mask.width(), mask.labels());
    let (mut seen, mut hidden) = (0, 0);
    let mut meet = |a: Label, b: Label| match (a, b) {
        (Label::Subject, Label::Background) | (Label::Background, Label::Subject) => seen += 1,
        (Label::Subject, Label::Unknown) | (Label::Unknown, Label::Subject) => hidden += 1,
        _ => {}
    };
    for row in labels.chunks_exact(width.max(1)) {
        row.windows(2).for_each(|pair| meet(pair[0], pair[1]));
    }
    for (above, below) in labels.iter().zip(labels.iter().skip(width)) {
        meet(*above, *below);
    }
    (seen, hidden)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(of: impl Fn(usize, usize) -> Label) -> Mask {
        let labels = (0..40 * 60).map(|at| of(at % 40, at / 40)).collect();
        Mask::new(40, 60, labels).unwrap()
    }

    #[test]
    fn silhouettes_that_cannot_be_a_person_say_why() {
        let is_person = |x: usize, y: usize| (15..25).contains(&x) && (5..55).contains(&y);
        let person = |x, y| if is_person(x, y) { Label::Subject } else { Label::Background };
        assert_eq!(check_mask(&mask(person)), Ok(()));
        assert_eq!(check_mask(&mask(|_, _| Label::Background)), Err(Unusable::Nobody));
        let black = |x, y| if y < 55 { Label::Unknown } else { person(x, y) };
        assert!(matches!(check_mask(&mask(black)), Err(Unusable::Unknown { share }) if share > 0.9));
        let fills = |x, _| if x < 30 { Label::Subject } else { Label::Background };
        assert_eq!(check_mask(&mask(fills)), Err(Unusable::Fills { share: 0.75 }));
        // Dark clothes before a dark wall: the subject's outline is nowhere.
        let hidden = |x: usize, y: usize| match person(x, y) {
            Label::Background if (10..30).contains(&x) && y > 2 => Label::Unknown,
            label => label,
        };
        assert!(matches!(check_mask(&mask(hidden)), Err(Unusable::Hidden { share }) if share > 0.9));
        let half =
            |x: usize, y: usize| if x == 25 && is_person(24, y) { Label::Unknown } else { person(x, y) };
        assert_eq!(check_mask(&mask(half)), Ok(()));
    }
}
