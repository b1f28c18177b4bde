//! The directions in words: a title, why the cameras do not see it, and what would help. The subject's own right and left;
//! cameras are counted from one.

use backlit_tracking::observability::{Cause, Direction, Observability, Share, Visibility};
use backlit_words::format::capitalised;

/// A part of the motion below this share is not spoken of.
const WORTH_SAYING: f64 = 0.15;
/// With this share a cause is the whole story.
const WHOLE_STORY: f64 = 0.8;
/// Limbs that are named before the rest is left out.
const NAMED_LIMBS: usize = 2;

/// One cause with all its limbs.
struct Story<'a> {
    cause: &'a Cause,
    share: f64,
    limbs: Vec<usize>,
}

/// A direction in a few words: "right forearm twist", "depth of the left hand".
pub fn title(seen: &Observability, direction: &Direction) -> String {
    let stories = stories(&direction.shares);
    let Some(first) = stories.first() else { return "nothing moves".to_owned() };
    let one = |story: &Story<'_>| {
        let limb = limb_name(seen, story.limbs[0]);
        match story.cause {
            Cause::Twist => format!("{limb} twist"),
            Cause::Depth(_) => format!("{limb} depth"),
            Cause::EndOn(_) => format!("{limb} end-on"),
            Cause::Along => format!("{limb} lengthways"),
            Cause::Covered => format!("{limb} covered"),
            Cause::Inside => format!("{limb} inside"),
            Cause::OutOfPictures => format!("{limb} out of pictures"),
            Cause::Unclear => format!("{limb} hidden motion"),
            Cause::Seen if matches!(direction.visibility(), Visibility::Hardly) => {
                format!("{limb} trade-off")
            }
            Cause::Seen => format!("{limb} motion"),
        }
    };
    match stories.get(1) {
        Some(second) if first.share < WHOLE_STORY && second.share >= WORTH_SAYING => {
            format!("{}, {}", one(first), one(second))
        }
        _ => one(first),
    }
}

/// Why the cameras do not see a direction, or how they do: a few sentences.
pub fn why(seen: &Observability, direction: &Direction) -> String {
    let visibility = direction.visibility();
    let level = match visibility {
        Visibility::Null => "No camera sees this.",
        Visibility::Hardly => "The cameras hardly see this.",
        Visibility::Somewhat => "The cameras see this somewhat.",
        Visibility::Well => "The cameras see this well.",
    };
    let stories = stories(&direction.shares);
    let Some(first) = stories.first() else { return level.to_owned() };
    let mut text = format!("{level} {}", sentence(seen, first, direction, first.share < WHOLE_STORY));
    if let Some(second) = stories.get(1)
        && first.share < WHOLE_STORY
        && second.share >= WORTH_SAYING
    {
        text.push_str(&format!(" With it, {}", clause(seen, second)));
    }
    text
}

/// What would make a direction seen, or why it does no harm.
pub fn remedy(direction: &Direction) -> &'static str {
    let stories = stories(&direction.shares);
    let visibility = direction.visibility();
    match stories.first().map(|story| story.cause) {
        None => "",
        Some(_) if matches!(visibility, Visibility::Well | Visibility::Somewhat) => "",
        Some(Cause::Twist) if direction.moves_no_joint() => {
            "Harmless: no joint moves with it. A prior for untwisted limbs holds it."
        }
        Some(Cause::Twist) => "A prior for untwisted limbs holds it; a limb that sticks out would show it.",
        Some(Cause::Depth(_)) => "A camera from the side would see it.",
        Some(Cause::EndOn(_)) => "A camera from another side would see it.",
        Some(Cause::Along) => "Seen where an end is free; priors and neighbours hold it.",
        Some(Cause::Covered | Cause::Inside) => {
            "A camera in whose picture the limb lies on the outline would see it."
        }
        Some(Cause::OutOfPictures) => "Aim a camera at it, or move back.",
        Some(Cause::Unclear | Cause::Seen) => "More cameras, or narrower ramps, tell the limbs apart.",
    }
}

fn limb_name(seen: &Observability, limb: usize) -> &str {
    seen.model.limbs().get(limb).map_or("limb", |limb| limb.name.as_str())
}

fn limb_names(seen: &Observability, story: &Story<'_>) -> String {
    let named = story.limbs.iter().take(NAMED_LIMBS);
    let named: Vec<String> = named.map(|&limb| format!("the {}", limb_name(seen, limb))).collect();
    let rest = story.limbs.len() - named.len();
    match (named.as_slice(), rest) {
        ([one], _) => one.clone(),
        (many, 0) => many.join(" and "),
        (many, _) => format!("{} and others", many.join(", ")),
    }
}

/// "Mostly the left hand moves along …", for the middle of a sentence.
fn clause(seen: &Observability, story: &Story<'_>) -> String {
    let limbs = limb_names(seen, story);
    let (is, s) = if story.limbs.len() == 1 { ("is", "s") } else { ("are", "") };
    match story.cause {
        Cause::Twist => format!("{limbs} turn{s} about {} own length.", its(story)),
        Cause::Depth(cameras) => {
            format!("{limbs} move{s} along the line of sight of {}.", names(cameras))
        }
        Cause::EndOn(cameras) => format!("{limbs} point{s} at {} and swing{s}.", names(cameras)),
        Cause::Along => format!("{limbs} slide{s} along {} own length.", its(story)),
        Cause::Covered => format!("{limbs} move{s} behind other limbs."),
        Cause::Inside => format!("{limbs} move{s} inside the silhouettes."),
        Cause::OutOfPictures => format!("{limbs} {is} outside all pictures."),
        Cause::Unclear => format!("{limbs} move{s} where {} pixels tell nothing.", its(story)),
        Cause::Seen => format!("{limbs} move{s} across the pictures."),
    }
}

/// A whole sentence or two: what moves, and why that is not seen.
fn sentence(seen: &Observability, story: &Story<'_>, direction: &Direction, is_mixed: bool) -> String {
    let clause = clause(seen, story);
    let is_weak = matches!(direction.visibility(), Visibility::Null | Visibility::Hardly);
    let what = if is_mixed { format!("Mostly {clause}") } else { capitalised(&clause) };
    let why = match story.cause {
        Cause::Depth(_) if !is_weak => "What shows is its size.",
        Cause::Along if !is_weak => "What shows is its free end.",
        _ if !is_weak => "",
        Cause::Twist if direction.is_null => {
            "A round limb looks the same however it turns, and what hangs on it turns back."
        }
        Cause::Twist => "A round limb looks nearly the same however it turns.",
        Cause::Depth(cameras) if cameras.len() == 1 => {
            "No other camera sees enough of it, and along that line only its size changes."
        }
        Cause::Depth(_) => "They look along nearly the same line, and along it only the size changes.",
        Cause::EndOn(_) => "Only the near end is on the outline there.",
        Cause::Along => "Its neighbours cover the ends, and the sides stay where they are.",
        Cause::Covered => "They cover it in every picture.",
        Cause::Inside => "None of its pixels is on an outline.",
        Cause::Seen => "Each of them would be seen alone; together, one covers what the other leaves.",
        Cause::OutOfPictures | Cause::Unclear => "",
    };
    if why.is_empty() { what } else { format!("{what} {why}") }
}

fn its(story: &Story<'_>) -> &'static str {
    if story.limbs.len() == 1 { "its" } else { "their" }
}

fn names(cameras: &[usize]) -> String {
    let numbers: Vec<String> = cameras.iter().map(|camera| (camera + 1).to_string()).collect();
    match numbers.split_last() {
        None => "no camera".to_owned(),
        Some((one, [])) => format!("camera {one}"),
        Some((last, before)) => format!("cameras {} and {last}", before.join(", ")),
    }
}

/// Shares with the same cause together, the largest first; of each the limbs that are worth naming.
fn stories(shares: &[Share]) -> Vec<Story<'_>> {
    let mut stories: Vec<Story<'_>> = Vec::new();
    for Share { limb, cause, share } in shares {
        match stories.iter_mut().find(|story| story.cause == cause) {
            Some(story) => {
                story.share += share;
                if *share >= WORTH_SAYING {
                    story.limbs.push(*limb);
                }
            }
            None => stories.push(Story { cause, share: *share, limbs: vec![*limb] }),
        }
    }
    stories.sort_by(|a, b| b.share.total_cmp(&a.share));
    stories
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use backlit_lab::synthetic::{capsules, upper_body};
    use backlit_tracking::body::builtin;
    use backlit_tracking::fit::{Evidence, FitOptions, FitView};
    use backlit_tracking::observability::FrameInformation;

    use super::*;

    #[test]
    fn what_one_camera_does_not_see_is_said() {
        let model = Arc::new(builtin::upper_body());
        let pose = upper_body::motion(&model, 3);
        let camera = upper_body::cameras(1, [192, 144]).unwrap().remove(0);
        let evidence = Evidence::Mask(Arc::new(capsules::hard_mask(&model, &pose, &camera).unwrap()));
        let view = FitView { camera, evidence, weight: 1.0 };
        let seen = FrameInformation::new(&model, &[Some(view)], &FitOptions::default(), &pose)
            .unwrap()
            .observe(&[0]);
        let (null, others): (Vec<&Direction>, Vec<_>) = seen.directions.iter().partition(|d| d.is_null);
        for direction in &null {
            assert!(title(&seen, direction).ends_with("twist"));
            assert!(why(&seen, direction).starts_with("No camera sees this."));
            assert!(remedy(direction).starts_with("Harmless: no joint moves with it."));
        }
        for direction in others.into_iter().rev().take(4) {
            assert!(title(&seen, direction).contains("depth"));
        }
        let shares = vec![Share { limb: 0, cause: Cause::OutOfPictures, share: 1.0 }];
        let outside = Direction { shares, ..null[0].clone() };
        assert!(why(&seen, &outside).contains("outside all pictures"));
    }

    #[test]
    fn cameras_are_counted_from_one() {
        assert_eq!(names(&[0]), "camera 1");
        assert_eq!(names(&[0, 2]), "cameras 1 and 3");
        assert_eq!(names(&[0, 1, 3]), "cameras 1, 2 and 4");
    }

    #[test]
    fn limbs_of_one_cause_stand_together() {
        let share = |limb, cause, share| Share { limb, cause, share };
        let shares = [
            share(1, Cause::Twist, 0.4),
            share(2, Cause::Depth(vec![0]), 0.3),
            share(3, Cause::Twist, 0.2),
            share(4, Cause::Twist, 0.1),
        ];
        let found = stories(&shares);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].cause, &found[0].limbs[..]), (&Cause::Twist, &[1, 3][..]));
        assert!((found[0].share - 0.7).abs() < 1e-12);
    }
}
