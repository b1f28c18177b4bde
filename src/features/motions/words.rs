//! Classes, methods and what is missing, in plain words.

use backlit_recognition::{Method, Recognizer};

use super::Plane;
use super::job::Missing;
use crate::context::marks::whole_percent;

/// What no known motion is called.
pub(super) const UNKNOWN: &str = "unknown";

/// The words of the program's own classes; another file's classes are called as they are there.
const CLASSES: [(&str, &str); 7] = [
    ("box", "boxing"),
    ("dance", "dancing"),
    ("gesture", "gesturing"),
    ("jump", "jumping"),
    ("run", "running"),
    ("sit_bend", "sitting or bending"),
    ("walk", "walking"),
];

/// A class in the middle of a sentence.
pub(super) fn class(name: &str) -> String {
    let known = CLASSES.iter().find(|(known, _)| *known == name);
    known.map_or_else(|| name.replace('_', " "), |(_, words)| (*words).to_owned())
}

/// A method on its button, and what it does.
pub(super) const fn method(method: Method) -> (&'static str, &'static str) {
    match method {
        Method::Combined => (
            "Combined",
            "Support vectors and the distances from the motions' means, among windows of two seconds: the mean of both",
        ),
        Method::Hmm => ("Hidden Markov", "A Gaussian hidden Markov model a motion, of windows of 0.6 s"),
        Method::Svm => ("Support vectors", "Planes between the motions, among windows of two seconds"),
        Method::Nearest => ("Nearest", "What the fifteen nearest known windows of two seconds are called"),
    }
}

/// A plane on its button, and what it is.
pub(super) const fn plane(plane: Plane) -> (&'static str, &'static str) {
    match plane {
        Plane::Apart => (
            "Motions",
            "The two axes that tell motions apart best: Fisher’s discriminants of windows of 0.6 s. Regions are one \
             standard deviation wide. What lies together here may lie apart along the other axes, which count too",
        ),
        Plane::Principal => (
            "Poses",
            "The two axes along which single frames differ most, whatever the motion: principal components of joints \
             and their speeds. Names do not depend on it",
        ),
    }
}

/// The names of a plane's axes, across and up.
pub(super) fn axes(recognizer: &Recognizer, plane: Plane) -> [String; 2] {
    match plane {
        Plane::Apart => {
            let count = recognizer.short.axes.len();
            [1, 2].map(|number| format!("Discriminant {number} of {count}"))
        }
        Plane::Principal => [0, 1].map(|index| {
            let share = recognizer.plane.shares.get(index).copied().unwrap_or(0.0);
            format!("Principal component {} ({})", index + 1, whole_percent(share))
        }),
    }
}

/// Why there are no names, in whole sentences.
pub(super) fn missing(missing: &Missing) -> String {
    match missing {
        Missing::Track => {
            "No frame is tracked yet. Motions are named by what joints do over time, so the body must be \
                           followed through the take first."
                .to_owned()
        }
        Missing::Short { seconds, least } => format!(
            "Too few frames are tracked to name a motion: {seconds:.1} s without a gap. It takes {least:.1} s, and \
             two seconds are better."
        ),
        Missing::Joint(joint) => format!(
            "This body has no {joint}. Motions are named by sixteen joints of the whole body, from head to toes, as the \
             built-in full body has them."
        ),
        Missing::Model(why) => format!("The file is no model of motions: {why}."),
        Missing::Other(why) => format!("Nothing can be recognised: {why}."),
    }
}
