//! People of several builds: the built-in full body with other proportions, from a child to a tall adult, from slim
//! to broad.
//!
//! Statures are about the 50th percentile of the age named (child) or the 5th and 95th of adults; proportions follow
//! H. Meredith, "Changes in the stature and body weight of children" and the head heights of S. Pheasant,
//! "Bodyspace" (2nd ed., 1996), rounded: a child's head is large, its legs are short.

use backlit_tracking::body::{Model, ModelError, Pose};
use glam::DVec3;

/// Across the shoulders of the average adult, metres.
pub const BREADTH: f64 = 0.5;
/// The pelvis of the average adult, metres above the floor: people of other statures stand on the same floor.
const PELVIS_HEIGHT: f64 = 0.9;

/// A build, as factors of the built-in full body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Person {
    /// What it is called.
    pub name: &'static str,
    /// Of everything.
    pub stature: f64,
    /// Of all lengths of legs, beside the stature.
    pub legs: f64,
    /// Of all lengths of arms, beside the stature.
    pub arms: f64,
    /// Of lengths across the body: hips, ribs, clavicles, beside the stature.
    pub breadth: f64,
    /// Of the skull, length and radius, beside the stature.
    pub head: f64,
    /// Of all radii but the head's, beside the stature.
    pub girth: f64,
    /// Of the radii of trunk and hips, beside the girth.
    pub trunk_girth: f64,
}

/// A person by the factors in the order of the fields.
const fn person(name: &'static str, factors: [f64; 7]) -> Person {
    let [stature, legs, arms, breadth, head, girth, trunk_girth] = factors;
    Person { name, stature, legs, arms, breadth, head, girth, trunk_girth }
}

/// The builds of the experiment.
pub const PEOPLE: [Person; 6] = [
    person("child of six, slim", [0.66, 0.94, 0.95, 1.0, 1.3, 0.95, 1.05]),
    person("child of ten, broad", [0.8, 0.97, 0.97, 1.05, 1.15, 1.15, 1.05]),
    person("short adult, broad", [0.88, 0.96, 0.96, 1.06, 1.06, 1.2, 1.05]),
    person("average adult", [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
    person("tall adult, slim", [1.09, 1.04, 1.04, 0.97, 0.94, 0.85, 0.95]),
    person("tall adult, broad", [1.1, 0.98, 1.02, 1.08, 0.96, 1.15, 1.05]),
];

impl Person {
    /// An adult's pose, lowered to where this person's feet are on the floor.
    #[must_use]
    pub fn standing(&self, mut pose: Pose) -> Pose {
        pose.root -= DVec3::Z * (PELVIS_HEIGHT * (1.0 - self.stature));
        pose
    }

    /// The person's body, of an average adult's full body.
    ///
    /// # Errors
    /// A factor that makes a size out of range.
    pub fn of(&self, adult: &Model) -> Result<Model, ModelError> {
        let is_one = |name: &str, words: &[&str]| words.iter().any(|word| name.ends_with(word));
        let resized = adult.with_sizes(|limb| {
            let limb = &adult.limbs()[limb];
            let name = limb.name.as_str();
            let (mut length, mut radius) = (self.stature, self.stature * self.girth);
            if name == "neck" {
                // As long as the stature says and as thick as the limbs.
            } else if name == "skull" {
                length *= self.head;
                radius = self.stature * self.head;
            } else if is_one(name, &["thigh", "calf", "foot"]) {
                length *= self.legs;
            } else if is_one(name, &["arm", "hand"]) {
                length *= self.arms;
            } else {
                radius *= self.trunk_girth;
                if is_one(name, &["hip", "rib", "clavicle"]) {
                    length *= self.breadth;
                }
            }
            [limb.length * length, limb.radius * radius]
        })?;
        Ok(resized.renamed(self.name))
    }
}

#[cfg(test)]
mod tests {
    use backlit_tracking::body::builtin;

    use super::*;

    #[test]
    fn an_average_adult_is_the_built_in_body_and_others_differ() {
        let adult = builtin::full_body();
        let average = PEOPLE.iter().find(|person| person.name == "average adult").unwrap();
        assert_eq!(average.of(&adult).unwrap().renamed(adult.name()), adult);
        let child = PEOPLE[0].of(&adult).unwrap();
        let size = |model: &Model, name: &str| model.limbs()[model.limb_index(name).unwrap()].length;
        let ratio = |name: &str| size(&child, name) / size(&adult, name);
        assert!(ratio("skull") > ratio("spine") && ratio("spine") > ratio("left calf"));
    }
}
