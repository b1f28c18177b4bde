//! A body acquired from nothing: found, turned and grown limb by limb, as steps.

use backlit_tracking::acquisition::{Acquired, Round};
use backlit_tracking::body::Pose;
use backlit_ui::style::format;

use super::record::Step;
use super::way::Way;

/// A size that changes by less is the same.
const SAME: f64 = 0.005;

/// All steps of it.
pub(super) fn steps(acquired: &Acquired) -> Vec<Step> {
    let count = acquired.rounds.len();
    let mut steps = Vec::new();
    for (index, round) in acquired.rounds.iter().enumerate() {
        let Some(pose) = round.poses.first() else { continue };
        let found = match index {
            0 => format!(
                "The search finds the pose of a body {} times as large, and a fit turns all limbs",
                format::number(acquired.scale, 2)
            ),
            _ => "A fit turns all limbs of the grown body".to_owned(),
        };
        let words = format!("Round {} of {count}. {found}. Now every limb grows.", index + 1);
        steps.push(Step::new(&round.before, pose.clone(), words));
        grown(round, pose, &mut steps);
    }
    if let Some(pose) = acquired.poses.first() {
        let words = format!(
            "A fit turns all limbs a last time. {} lengths and radii were measured; the others follow these.",
            acquired.measured
        );
        steps.push(Step::new(&acquired.model, pose.clone(), words));
    }
    for step in &mut steps {
        step.legend = Way::Body.name().to_owned();
    }
    steps
}

/// Limb after limb, each with the one on the other side.
fn grown(round: &Round, pose: &Pose, steps: &mut Vec<Step>) {
    let model = &round.before;
    for (limb, measured) in round.measured.iter().enumerate() {
        let other = model.mirrored_limb(limb);
        if other < limb || *measured == [false; 2] {
            continue;
        }
        let is_done = |index: usize| index.min(model.mirrored_limb(index)) <= limb;
        let name = &model.limbs()[limb].name;
        let both = name.strip_prefix("right ").or(name.strip_prefix("left ")).filter(|_| other != limb);
        let name = both.map_or_else(|| format::capitalised(name), |part| format!("Right and left {part}"));
        let [length, radius] = round.factors(limb);
        let sizes =
            [(measured[0], length, ["longer", "shorter"]), (measured[1], radius, ["thicker", "thinner"])];
        let said = sizes.into_iter().filter(|size| size.0).map(|(_, factor, words)| change(factor, words));
        let words = format!("{name}: {}.", said.collect::<Vec<_>>().join(", "));
        let step = Step::new(&round.partly(is_done), pose.clone(), words);
        let marked = (0..model.limbs().len()).map(|index| index == limb || index == other).collect();
        steps.push(Step { marked, ..step });
    }
    steps.push(Step::new(
        &round.after,
        pose.clone(),
        "What no background stops follows the limbs that were measured, or stays.".to_owned(),
    ));
}

/// "7 % longer", "as thick as before".
fn change(factor: f64, [more, less]: [&str; 2]) -> String {
    let by = format::number(100.0 * (factor - 1.0).abs(), 0);
    match factor {
        _ if (factor - 1.0).abs() < SAME => {
            format!("as {} as before", if more == "longer" { "long" } else { "thick" })
        }
        _ if factor > 1.0 => format!("{by} % {more}"),
        _ => format!("{by} % {less}"),
    }
}
