//! The directions in words: a title, why the cameras do not see it, and what would help. The subject's own right and left;
//! cameras are counted from one.

use super::cause::{Cause, Share};
use super::directions::{Direction, Observability};

/// A part of the motion below this share is not spoken of.
const WORTH_SAYING: f64 = 0.15;
/// With this share a cause is the whole story.
const WHOLE_STORY: f64 = 0.8;
/// One standard deviation moves no joint farther, metres, and turns none farther, radians: seen well.
const SEEN_WELL: [f64; 2] = [0.005, 0.05];
/// One standard deviation moves a joint at least so far, metres, or turns it, radians: hardly seen.
const HARDLY_SEEN: [f64; 2] = [0.03, 0.35];
/// A direction that moves no joint by this much for a radian moves none, metres.
const MOVES_NOTHING: f64 = 1e-6;
/// Limbs that are named before the rest is left out.
const NAMED_LIMBS: usize = 2;

/// How well a direction is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sight {
    /// Not at all.
    Null,
    /// So little that a pose may be far off along it.
    Hardly,
    /// Somewhat.
    Somewhat,
    /// Well.
    Well,
}

/// One cause with all its limbs.
struct Story<'a> {
    cause: &'a Cause,
    share: f64,
    limbs: Vec<usize>,
}

impl Direction {
    /// How well it is seen, by what one standard deviation moves and turns.
    #[must_use]
    pub fn sight(&self) -> Sight {
        if self.is_null {
            return Sight::Null;
        }
        let one = [self.deviation * self.largest_move().1, self.deviation * self.largest_turn()];
        if one[0] >= HARDLY_SEEN[0] || one[1] >= HARDLY_SEEN[1] {
            Sight::Hardly
        } else if one[0] > SEEN_WELL[0] || one[1] > SEEN_WELL[1] {
            Sight::Somewhat
        } else {
            Sight::Well
        }
    }

    /// Whether no joint moves with it.
    #[must_use]
    pub fn moves_no_joint(&self) -> bool {
        self.largest_move().1 < MOVES_NOTHING
    }
}

impl Observability {
    /// A direction in a few words: "right forearm twist", "depth of the left hand".
    #[must_use]
    pub fn title(&self, direction: &Direction) -> String {
        let stories = stories(&direction.shares);
        let Some(first) = stories.first() else { return "nothing moves".to_owned() };
        let one = |story: &Story<'_>| {
            let limb = self.limb(story.limbs[0]);
            match story.cause {
                Cause::Twist => format!("{limb} twist"),
                Cause::Depth(_) => format!("{limb} depth"),
                Cause::EndOn(_) => format!("{limb} end-on"),
                Cause::Along => format!("{limb} lengthways"),
                Cause::Covered => format!("{limb} covered"),
                Cause::Inside => format!("{limb} inside"),
                Cause::OutOfPictures => format!("{limb} out of pictures"),
                Cause::Unclear => format!("{limb} hidden motion"),
                Cause::Seen if matches!(direction.sight(), Sight::Hardly) => format!("{limb} trade-off"),
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
    #[must_use]
    pub fn why(&self, direction: &Direction) -> String {
        let sight = direction.sight();
        let level = match sight {
            Sight::Null => "No camera sees this.",
            Sight::Hardly => "The cameras hardly see this.",
            Sight::Somewhat => "The cameras see this somewhat.",
            Sight::Well => "The cameras see this well.",
        };
        let stories = stories(&direction.shares);
        let Some(first) = stories.first() else { return level.to_owned() };
        let mut text = format!("{level} {}", self.sentence(first, direction, first.share < WHOLE_STORY));
        if let Some(second) = stories.get(1)
            && first.share < WHOLE_STORY
            && second.share >= WORTH_SAYING
        {
            text.push_str(&format!(" With it, {}", self.clause(second)));
        }
        text
    }

    /// What would make a direction seen, or why it does no harm.
    #[must_use]
    pub fn remedy(&self, direction: &Direction) -> &'static str {
        let stories = stories(&direction.shares);
        let sight = direction.sight();
        match stories.first().map(|story| story.cause) {
            None => "",
            Some(_) if matches!(sight, Sight::Well | Sight::Somewhat) => "",
            Some(Cause::Twist) if direction.moves_no_joint() => {
                "Harmless: no joint moves with it. A prior for untwisted limbs holds it."
            }
            Some(Cause::Twist) => {
                "A prior for untwisted limbs holds it; a limb that sticks out would show it."
            }
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

    fn limb(&self, limb: usize) -> &str {
        self.model.limbs().get(limb).map_or("limb", |limb| limb.name.as_str())
    }

    fn limbs(&self, story: &Story<'_>) -> String {
        let named = story.limbs.iter().take(NAMED_LIMBS);
        let named: Vec<String> = named.map(|&limb| format!("the {}", self.limb(limb))).collect();
        let rest = story.limbs.len() - named.len();
        match (named.as_slice(), rest) {
            ([one], _) => one.clone(),
            (many, 0) => many.join(" and "),
            (many, _) => format!("{} and others", many.join(", ")),
        }
    }

    /// "Mostly the left hand moves along …", for the middle of a sentence.
    fn clause(&self, story: &Story<'_>) -> String {
        let limbs = self.limbs(story);
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
    fn sentence(&self, story: &Story<'_>, direction: &Direction, is_mixed: bool) -> String {
        let clause = self.clause(story);
        let is_weak = matches!(direction.sight(), Sight::Null | Sight::Hardly);
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
}

fn its(story: &Story<'_>) -> &'static str {
    if story.limbs.len() == 1 { "its" } else { "their" }
}

/// "camera 1", "cameras 1 and 3", "cameras 1, 2 and 4".
fn names(cameras: &[usize]) -> String {
    let numbers: Vec<String> = cameras.iter().map(|camera| (camera + 1).to_string()).collect();
    match numbers.split_last() {
        None => "no camera".to_owned(),
        Some((one, [])) => format!("camera {one}"),
        Some((last, before)) => format!("cameras {} and {last}", before.join(", ")),
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
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
    use super::*;

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
