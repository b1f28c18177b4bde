//! The caption: why the fits differ, told from the numbers that were computed. At most [`MOST_WORDS`] words.

use backlit_tracking::render::RendererKind;
use backlit_ui::style::format;

use super::comparison::PushKey;
use super::{Comparison, Contestant, Lineup};

/// A caption is no longer than this, title left out.
pub const MOST_WORDS: usize = 70;
/// A fit has arrived below this share of its start, percent.
pub(crate) const ARRIVED_PERCENT: f64 = 5.0;
/// Fits whose ends differ by less, in percent of the start, end alike.
const ALIKE_PERCENT: f64 = 5.0;
/// A pose is the true one within this mean joint error, millimetres.
const TRUE_WITHIN_MM: f64 = 1.0;
/// A fit has few pixels that push if its share of them is less than this part of another's.
const FEW: f64 = 0.5;

/// A caption.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Story {
    /// A few words above it.
    pub title: String,
    /// Its paragraphs.
    pub paragraphs: Vec<String>,
    /// How far each is from the truth, where that is known and there is room.
    pub errors: Option<String>,
}

/// Tells a comparison. `key` says which pushes are shown.
pub fn tell(comparison: &Comparison, lineup: Lineup, key: PushKey) -> Story {
    let fits = &comparison.contestants;
    if let Some(problem) = comparison.problem() {
        return Story {
            title: "Nothing to fit".to_owned(),
            paragraphs: vec![format!("{}.", format::capitalised(problem))],
            errors: None,
        };
    }
    if comparison.last() == 0 {
        let mut paragraphs: Vec<String> = pushes_of(fits, key).into_iter().collect();
        paragraphs.push(format!("Space steps {} together, Enter runs them to the end.", lineup.all_text()));
        return Story { title: "Before the first step".to_owned(), paragraphs, errors: None };
    }
    let ends: Vec<(usize, f64)> =
        fits.iter().enumerate().filter_map(|(index, fit)| Some((index, fit.percent(fit.last())?))).collect();
    let best = ends.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let worst = ends.iter().rev().max_by(|a, b| a.1.total_cmp(&b.1));
    let (Some(&(best, least)), Some(&(worst, most))) = (best, worst) else {
        return Story {
            title: "Nothing to lower".to_owned(),
            paragraphs: vec!["The start agrees with the data already: its cost is zero.".to_owned()],
            errors: None,
        };
    };
    let is_over = comparison.is_over();
    let errors = errors_of(fits);
    if let Some(errors) = &errors
        && is_over
        && fits.iter().all(began_at_the_truth)
    {
        return from_the_truth(errors);
    }
    let title = match (most - least < ALIKE_PERCENT, most < ARRIVED_PERCENT) {
        (true, true) => format!("{} arrive", format::capitalised(lineup.all_text())),
        (true, false) if is_over => "They end alike".to_owned(),
        (true, false) => "So far they are alike".to_owned(),
        (false, _) => why(&fits[worst], is_over, has_few(&fits[best], &fits[worst], key).is_some()),
    };
    let reason = if most - least < ALIKE_PERCENT {
        pushes_of(fits, key)
    } else {
        reason(&fits[best], &fits[worst], key)
    };
    let mut paragraphs: Vec<String> = reason.into_iter().collect();
    paragraphs.push(ends_of(fits, is_over));
    let errors = errors.map(|errors| format!("Mean joint errors: {}.", errors_text(&errors)));
    Story { title, paragraphs, errors }
}

/// The mean joint error of each, millimetres, where the truth is known.
fn errors_of(fits: &[Contestant]) -> Option<Vec<(&'static str, f64)>> {
    fits.iter().map(|fit| Some((fit.entrant.subject, fit.steps.last()?.joint_error_mm?))).collect()
}

fn began_at_the_truth(fit: &Contestant) -> bool {
    let start = fit.steps.first().and_then(|start| start.joint_error_mm);
    start.is_some_and(|error| error < TRUE_WITHIN_MM)
}

/// Where all begin at the truth, the lower cost is not the better one.
fn from_the_truth(errors: &[(&'static str, f64)]) -> Story {
    let farthest = errors.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let title = match farthest {
        Some((who, error)) if *error >= TRUE_WITHIN_MM => {
            format!("{} leaves the truth", format::capitalised(who))
        }
        _ => "They stay at the truth".to_owned(),
    };
    let first = "All began at the true pose. The cost of each is least somewhere else, and a lower cost is a worse pose.";
    let second = format!("The joints ended so far away, on average: {}.", errors_text(errors));
    Story { title, paragraphs: vec![first.to_owned(), second], errors: None }
}

fn errors_text(errors: &[(&'static str, f64)]) -> String {
    let one = |(who, error): &(&str, f64)| format!("{who} {} mm", format::number(*error, 1));
    errors.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// The title where one falls behind. Its ends are to blame only where too few pixels push.
fn why(worst: &Contestant, is_over: bool, has_few: bool) -> String {
    let (who, many) = match worst.entrant.name {
        "Cylinder" if has_few => ("the flat ends", true),
        "Capsule" if has_few => ("the round ends", true),
        "Sphere tree" if has_few => ("the spheres", true),
        _ => (worst.entrant.subject, false),
    };
    let verb = match (is_over, many) {
        (true, true) => "lose",
        (true, false) => "loses",
        (false, true) => "lag",
        (false, false) => "lags",
    };
    format!("Why {who} {verb}")
}

/// Pixels that push, and pixels in the ramp.
fn counts(fit: &Contestant, key: PushKey) -> Option<(usize, usize)> {
    let (of, pushed) = fit.pushed.as_ref()?;
    (*of == key).then_some((pushed.pushing, pushed.in_ramp))
}

fn share((pushing, in_ramp): (usize, usize)) -> f64 {
    pushing as f64 / in_ramp.max(1) as f64
}

/// Without groups: a line may not end within a number.
fn count(value: usize) -> String {
    value.to_string()
}

/// The fewest and the most pixels that push, where they differ.
fn pushes_of(fits: &[Contestant], key: PushKey) -> Option<String> {
    let all: Vec<(&Contestant, (usize, usize))> =
        fits.iter().filter_map(|fit| Some((fit, counts(fit, key)?))).collect();
    let by_share = |a: &&(&Contestant, (usize, usize)), b: &&(&Contestant, (usize, usize))| {
        share(a.1).total_cmp(&share(b.1))
    };
    let (few, many) = (all.iter().min_by(by_share)?, all.iter().max_by(by_share)?);
    let way = key.1.way();
    Some(if share(few.1) < FEW * share(many.1) {
        few_and_many(few, many, way)
    } else if many.1.0 == 0 {
        format!("No pixel in any ramp says {way}: from this camera that cannot be seen.")
    } else {
        format!(
            "About as many pixels say {way} in all of them: {} of {} for {}, {} of {} for {}.",
            count(few.1.0),
            count(few.1.1),
            few.0.entrant.subject,
            count(many.1.0),
            count(many.1.1),
            many.0.entrant.subject
        )
    })
}

fn few_and_many(
    (few, (pushing, in_ramp)): &(&Contestant, (usize, usize)),
    (many, (more, _)): &(&Contestant, (usize, usize)),
    way: &str,
) -> String {
    let pixels = match pushing {
        0 => format!("None of the {} pixels", count(*in_ramp)),
        1 => format!("Only one of {} pixels", count(*in_ramp)),
        _ => format!("Only {} of {} pixels", count(*pushing), count(*in_ramp)),
    };
    let verb = if *pushing < 2 { "says" } else { "say" };
    let ends = match few.entrant.fit.renderer {
        RendererKind::Cylinder => " Seen from the side, a flat end is all or nothing.",
        _ => "",
    };
    format!(
        "{pixels} in the ramp of {} {verb} {way}; the hatched ones say nothing.{ends} For {}, {} do.",
        few.entrant.subject,
        many.entrant.subject,
        count(*more)
    )
}

/// Pixels that push in the worst and in the best fit, if the worst has few of them.
fn has_few(best: &Contestant, worst: &Contestant, key: PushKey) -> Option<[(usize, usize); 2]> {
    let (few, many) = counts(worst, key).zip(counts(best, key))?;
    (share(few) < FEW * share(many)).then_some([few, many])
}

/// Why one falls behind another.
fn reason(best: &Contestant, worst: &Contestant, key: PushKey) -> Option<String> {
    if let Some([few, many]) = has_few(best, worst, key) {
        return Some(few_and_many(&(worst, few), &(best, many), key.1.way()));
    }
    let raised = raised(worst);
    if raised > 0 {
        let steps = if raised == 1 { "step" } else { "steps" };
        return Some(format!(
            "Enough pixels push, but {raised} {steps} of {} went too far and raised its cost.",
            worst.entrant.subject
        ));
    }
    let rejected = worst.steps.iter().filter(|step| !step.iteration.accepted).count();
    if 2 * rejected > worst.last() {
        return Some(format!(
            "{rejected} of {} steps of {} were taken back: none of them lowered its cost.",
            worst.last(),
            worst.entrant.subject
        ));
    }
    // The plot shows the cost by the last stage's ramp; each stage lowers its own.
    let rises = (1..=worst.last()).any(|step| worst.percent(step) > worst.percent(step - 1));
    let steps = if rises {
        "every step of {} lowered the cost by its stage’s ramp, if not by the last one’s that is plotted"
    } else {
        "no step of {} raised its cost"
    };
    let steps = steps.replace("{}", worst.entrant.subject);
    Some(format!(
        "As many pixels push, and {steps}: it is in another local minimum, or its shape cannot come nearer."
    ))
}

/// Steps that were taken and raised the cost that the solver lowers.
fn raised(fit: &Contestant) -> usize {
    fit.steps.iter().filter(|step| step.iteration.accepted && step.iteration.actual_decrease < 0.0).count()
}

/// Where each of them is in the end.
fn ends_of(fits: &[Contestant], is_over: bool) -> String {
    let stays = if is_over { "ends" } else { "is" };
    let one = |fit: &Contestant| {
        let percent = fit.percent(fit.last())?;
        let subject = fit.entrant.subject;
        Some(match fit.arrived(ARRIVED_PERCENT) {
            Some(step) if fit.last() > 0 => {
                format!("{subject} is below {ARRIVED_PERCENT:.0} % from step {step} on")
            }
            _ => format!("{subject} {stays} at {} %", percent_text(percent)),
        })
    };
    let parts: Vec<String> = fits.iter().filter_map(one).collect();
    format!("{}.", format::capitalised(&parts.join("; ")))
}

/// A share of the start with as many figures as can be read at a glance.
pub(crate) fn percent_text(percent: f64) -> String {
    let decimals = match percent.abs() {
        value if value >= 0.95 => 1,
        value if value >= 0.095 => 2,
        _ => 3,
    };
    format::number(percent, decimals)
}

/// Words of a caption, title left out.
pub fn words(story: &Story) -> usize {
    story.paragraphs.iter().map(|paragraph| paragraph.split_whitespace().count()).sum()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use backlit_tracking::render::Prediction;

    use super::*;
    use crate::features::laboratory::comparison::tests::comparison;
    use crate::features::laboratory::{PushAxis, Pushed};
    use backlit_document::run::RunEnding;
    use backlit_ui::drawing::Derivative;

    const KEY: PushKey = (0, PushAxis::Slide, 0);

    fn told(mismatches: [&[f64]; 3], pushing: [usize; 3], over: bool) -> Story {
        let mut found = comparison(mismatches);
        for (index, (fit, pushing)) in found.contestants.iter_mut().zip(pushing).enumerate() {
            let picture = Derivative { values: Vec::new(), scale: 1.0 };
            let prediction = Prediction::default();
            let pushed = Pushed { picture, prediction, pushing, in_ramp: 614 + 10 * index };
            fit.pushed = Some((KEY, Arc::new(pushed)));
            if over {
                fit.ending = Some(RunEnding::Solver("25 steps done".to_owned()));
            }
        }
        let story = tell(&found, Lineup::Renderers, KEY);
        assert!(words(&story) <= MOST_WORDS, "{} words: {story:?}", words(&story));
        story
    }

    #[test]
    fn the_numbers_are_in_the_words() {
        let story = told([&[100.0, 99.0, 98.0], &[10.0, 1.0, 0.1], &[20.0, 4.0, 0.5]], [26, 240, 702], true);
        assert_eq!(story.title, "Why the flat ends lose");
        let text = story.paragraphs.join(" ");
        for part in [
            "Only 26 of 614 pixels in the ramp of the cylinder say which way to slide",
            "For the capsule, 240 do",
            "The cylinder ends at 98.0 %",
            "the capsule is below 5 % from step 2 on",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }

    #[test]
    fn other_numbers_make_another_story() {
        let start = told([&[100.0], &[10.0], &[20.0]], [0, 240, 702], false);
        assert_eq!(start.title, "Before the first step");
        assert!(start.paragraphs[0].starts_with("None of the 614 pixels"), "{start:?}");

        let all = told([&[100.0, 1.0], &[10.0, 0.1], &[20.0, 0.2]], [600, 610, 620], true);
        assert_eq!(all.title, "All three arrive");
        assert!(all.paragraphs[0].starts_with("About as many pixels"), "{all:?}");

        let raised = told([&[100.0, 1.0], &[10.0, 12.0], &[20.0, 0.2]], [600, 610, 620], false);
        assert_eq!(raised.title, "Why the capsule lags");
        assert!(raised.paragraphs[0].contains("1 step of the capsule went too far"), "{raised:?}");

        let zero = told([&[0.0, 0.0], &[0.0, 0.0], &[0.0, 0.0]], [1, 1, 1], true);
        assert_eq!(zero.title, "Nothing to lower");
        let blind = told([&[10.0], &[10.0], &[10.0]], [0, 0, 0], false);
        assert!(blind.paragraphs[0].contains("cannot be seen"), "{blind:?}");
    }

    #[test]
    fn a_problem_is_said_as_it_is() {
        let mut found = comparison([&[], &[], &[]]);
        for index in 0..3 {
            found.end(index, RunEnding::Solver("no camera has a silhouette to fit".to_owned()));
        }
        let story = tell(&found, Lineup::Renderers, KEY);
        assert_eq!(story.paragraphs, ["No camera has a silhouette to fit."]);
    }
}
