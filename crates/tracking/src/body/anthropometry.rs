//! How real people's sizes spread about those of the built-in full body.
//!
//! A limb's length is its share of the stature times exp(e), its radius its share of the stature times exp(λ b + e): b is
//! the person's stoutness, the mean of the logarithms of ten girths over stature less that of the average person, λ how
//! much this limb follows it, e what is the limb's own. Means are the built-in body's, whose file names their sources.
//!
//! | figure | source |
//! |---|---|
//! | λ and the deviation of e of girths; shoulder breadth | 507 adults, both sexes together: G. Heinz, L. J. Peterson, R. W. Johnson, C. J. Kerk, "Exploring relationships in body dimensions", Journal of Statistics Education 11(2), 2003: each log(girth / stature) regressed on b, the mean of chest, waist, hip, thigh, biceps, forearm, knee, calf, ankle and wrist |
//! | arms and legs | ANSUR II, 4,082 men and 1,986 women: C. C. Gordon et al., "2012 Anthropometric Survey of U.S. Army Personnel", NATICK/TR-15/007, 2014 |
//!
//! | ANSUR II, cm: mean ± deviation | women | men | beyond stature |
//! |---|---|---|---|
//! | stature | 162.85 ± 6.42 | 175.62 ± 6.86 | |
//! | acromion to radiale, upper arm | 31.12 ± 1.72 | 33.52 ± 1.75 | 3.9 %, 3.4 % |
//! | radiale to stylion, forearm | 24.13 ± 1.52 | 26.79 ± 1.54 | 4.9 %, 4.2 % |
//! | trochanterion height, leg | 84.54 ± 4.47 | 90.09 ± 4.92 | 3.5 %, 3.8 % |
//! | lateral femoral epicondyle height, lower leg | 46.59 ± 2.71 | 49.17 ± 2.66 | 4.3 %, 3.7 % |
//! | acromial height | 133.51 ± 5.81 | 144.07 ± 6.33 | 1.9 %, 2.0 % |
//!
//! A hip's centre lies 0.33 times the pelvis' width + 7.3 mm from the middle (M. E. Harrington et al., "Prediction of the hip
//! joint centre in adults, children, and patients with cerebral palsy based on magnetic resonance imaging", Journal of
//! Biomechanics 40(3), 2007). Its own spread, 9 %, is our choice: about that of the widths of pelvises.
//!
//! The survey's summary has no correlations. The last column is derived by the rule that a length is its share of the
//! stature times an error of its own: its squared coefficient of variation less the stature's, square root. The trunk is
//! acromial less trochanterion height; with independent errors its own deviation is 8 % at most.
//!
//! **What no table has** keeps the wide spread of the generic prior: ends of a body of capsules (head, hands, feet, ribs,
//! flanks), necks, and heads, whose share of the stature halves between childhood and old age. Stoutness spread by 6.3 %
//! in those 507, who were active and mostly of normal weight. Half as much again is taken; that factor is our choice.

use super::{Model, SizeKind, builtin, split_side};

/// Standard deviation of stoutness, the logarithm that all girths share: 6.3 % of active people, and half as much again.
pub const STOUTNESS: f64 = 0.095;

/// How a limb's radius spreads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GirthSpread {
    /// λ: how much of the person's stoutness it takes on.
    pub by_stoutness: f64,
    /// Standard deviation of its logarithm beyond that.
    pub own: f64,
}

/// Name of a limb without its side; deviation of its length's logarithm; its radius's λ and deviation.
type LimbSpread = (&'static str, Option<f64>, Option<GirthSpread>);

const fn girth(by_stoutness: f64, own: f64) -> Option<GirthSpread> {
    Some(GirthSpread { by_stoutness, own })
}

/// Limbs of which something was measured, by name without side.
const ROWS: [LimbSpread; 15] = [
    ("spine", Some(0.08), girth(1.53, 0.07)),
    ("chest", Some(0.08), girth(1.12, 0.05)),
    ("neck", None, girth(1.0, 0.1)),
    ("skull", None, girth(0.0, 0.1)),
    ("hip", Some(0.09), girth(0.78, 0.05)),
    ("flank", None, girth(1.12, 0.08)),
    ("rib", None, girth(1.12, 0.05)),
    ("side", None, girth(1.12, 0.05)),
    ("clavicle", Some(0.05), girth(0.9, 0.045)),
    ("upper arm", Some(0.037), girth(1.5, 0.06)),
    ("forearm", Some(0.045), girth(1.1, 0.047)),
    ("thigh", Some(0.037), girth(0.84, 0.07)),
    ("lower thigh", Some(0.037), girth(0.72, 0.045)),
    ("calf", Some(0.04), girth(0.86, 0.05)),
    ("lower calf", Some(0.04), girth(0.8, 0.047)),
];

/// The average person and the spread about it, for bodies that are built as the built-in full body.
#[derive(Debug, Clone)]
pub struct Anthropometry {
    average: Model,
}

impl Anthropometry {
    /// For a body with the limbs of the built-in full body, whatever their sizes; `None` for any other.
    pub fn of(model: &Model) -> Option<Self> {
        let average = builtin::full_body();
        let is_same = average.limbs().len() == model.limbs().len()
            && average.limbs().iter().zip(model.limbs()).all(|(ours, theirs)| {
                (&ours.name, ours.parent, ours.rotation) == (&theirs.name, theirs.parent, theirs.rotation)
            });
        is_same.then_some(Self { average })
    }

    /// The logarithm of the average person's size over that of `model`'s limb, both of the same stature.
    pub fn log_ratio(&self, model: &Model, limb: usize, kind: SizeKind) -> f64 {
        let size = |model: &Model| model.limbs()[limb].size(kind);
        let stature = |model: &Model| model.limbs().iter().map(|limb| limb.length).sum::<f64>();
        (size(&self.average) / stature(&self.average) * stature(model) / size(model)).ln()
    }

    /// Standard deviation of a length's logarithm about its share of the stature; `None` where no table has it.
    pub fn length(&self, limb: usize) -> Option<f64> {
        self.row(limb).and_then(|row| row.1)
    }

    /// How a radius spreads; `None` where no table has it.
    pub fn radius(&self, limb: usize) -> Option<GirthSpread> {
        self.row(limb).and_then(|row| row.2)
    }

    fn row(&self, limb: usize) -> Option<&'static LimbSpread> {
        let (_, part) = split_side(&self.average.limbs()[limb].name);
        ROWS.iter().find(|row| row.0 == part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_spread_alike_and_other_bodies_are_not_known() {
        let body = builtin::full_body();
        let people = Anthropometry::of(&body).unwrap();
        for limb in 0..body.limbs().len() {
            let other = body.mirrored_limb(limb);
            assert_eq!(people.length(limb), people.length(other));
            assert_eq!(people.radius(limb), people.radius(other));
        }
        let known = |name: &str| people.row(body.limb_index(name).unwrap()).map(|row| row.0);
        assert_eq!(known("left lower calf"), Some("lower calf"));
        assert_eq!((known("right foot"), known("left hand")), (None, None));
        assert!(ROWS.iter().all(|row| body.limbs().iter().any(|limb| limb.name.ends_with(row.0))));
        assert!(Anthropometry::of(&builtin::upper_body()).is_none());
    }

    /// A body of another size is the average one; one with longer arms is not.
    #[test]
    fn the_average_person_has_the_average_proportions_at_any_stature() {
        let body = builtin::full_body();
        let arm = body.limb_index("left upper arm").unwrap();
        let child = body.scaled(0.7).unwrap();
        let people = Anthropometry::of(&child).unwrap();
        for kind in [SizeKind::Length, SizeKind::Radius] {
            assert!((0..30).all(|limb| people.log_ratio(&child, limb, kind).abs() < 1e-12));
        }
        let long = child.with_sizes(|limb| {
            let limb_ = &child.limbs()[limb];
            [limb_.length * if limb == arm { 1.1 } else { 1.0 }, limb_.radius]
        });
        assert!(people.log_ratio(&long.unwrap(), arm, SizeKind::Length) < -0.08);
    }
}
