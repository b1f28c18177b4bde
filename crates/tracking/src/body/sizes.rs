//! Which lengths and radii of a body may change, and which change together.
//!
//! A size is s = s₀ exp(θ): its logarithm is free, so that it stays above zero and a step means the same share of a
//! finger and of a thigh. Left and right share a parameter unless told otherwise.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Model, ModelError};

/// |θ| stays below this: no body is larger or smaller than its start by more than a factor of 4.5.
const LARGEST_LOG_RATIO: f64 = 1.5;

/// What a size is of its limb.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SizeKind {
    /// From its first joint to its second.
    Length,
    /// Of its capsule.
    Radius,
}

impl fmt::Display for SizeKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "length",
            Self::Radius => "radius",
        })
    }
}

/// One free size: the same of one limb, or of a limb and its mirror image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SizeParameter {
    /// The limb's name, without its side where both sides share it.
    pub name: String,
    /// Length or radius.
    pub kind: SizeKind,
    /// The limbs that have it.
    pub limbs: Vec<usize>,
}

/// Which sizes of a body are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SizeChoice {
    /// Whether left and right have the same sizes.
    pub symmetric: bool,
    /// Whether lengths are free.
    pub lengths: bool,
    /// Whether radii are free.
    pub radii: bool,
}

impl Default for SizeChoice {
    fn default() -> Self {
        Self { symmetric: true, lengths: true, radii: true }
    }
}

/// The free sizes of a body, as columns: all lengths in the order of the limbs, then all radii.
#[derive(Debug, Clone)]
pub struct Sizes {
    /// The body whose sizes are at θ = 0.
    pub start: Arc<Model>,
    /// The columns.
    pub parameters: Vec<SizeParameter>,
    /// Per limb, the parameter of its length and of its radius.
    of_limb: Vec<[Option<usize>; 2]>,
}

impl Sizes {
    /// The free sizes of a body.
    pub fn new(start: Arc<Model>, choice: SizeChoice) -> Self {
        let limbs = start.limbs();
        let mut parameters: Vec<SizeParameter> = Vec::new();
        let mut of_limb = vec![[None; 2]; limbs.len()];
        for (slot, kind, is_free) in
            [(0, SizeKind::Length, choice.lengths), (1, SizeKind::Radius, choice.radii)]
        {
            for limb in (0..limbs.len()).filter(|_| is_free) {
                let other = if choice.symmetric { start.mirrored_limb(limb) } else { limb };
                if let Some(shared) = of_limb[other][slot] {
                    let parameter: &mut SizeParameter = &mut parameters[shared];
                    parameter.limbs.push(limb);
                    let name = &limbs[limb].name;
                    parameter.name = name.split_once(' ').map_or(name.as_str(), |(_, rest)| rest).to_owned();
                    of_limb[limb][slot] = Some(shared);
                } else {
                    of_limb[limb][slot] = Some(parameters.len());
                    let name = limbs[limb].name.clone();
                    parameters.push(SizeParameter { name, kind, limbs: vec![limb] });
                }
            }
        }
        Self { start, parameters, of_limb }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.parameters.len()
    }

    /// The column of a limb's length or radius; `None` where it is held.
    pub fn column(&self, limb: usize, kind: SizeKind) -> Option<usize> {
        self.of_limb[limb][usize::from(kind == SizeKind::Radius)]
    }

    /// The body with sizes s₀ exp(θ); those that are not free are scaled by `others`.
    ///
    /// # Errors
    /// A size out of range, or θ not finite.
    pub fn model(&self, log_ratios: &[f64], others: f64) -> Result<Model, ModelError> {
        let limbs = self.start.limbs();
        self.start.with_sizes(|limb| {
            let [length, radius] =
                self.of_limb[limb].map(|column| column.map_or(others, |column| log_ratios[column]).exp());
            [limbs[limb].length * length, limbs[limb].radius * radius]
        })
    }

    /// A parameter's size in a body of these limbs, metres.
    pub fn metres(&self, parameter: usize, model: &Model) -> f64 {
        let SizeParameter { kind, ref limbs, .. } = self.parameters[parameter];
        model.limbs()[limbs[0]].size(kind)
    }
}

impl Model {
    /// The same body, larger by a factor as a whole.
    ///
    /// # Errors
    /// A size out of range.
    pub fn scaled(&self, factor: f64) -> Result<Self, ModelError> {
        let limbs = self.limbs();
        self.with_sizes(|limb| [limbs[limb].length * factor, limbs[limb].radius * factor])
    }
}

/// Keeps a logarithm of a ratio within what a body can be.
pub(crate) fn bounded(log_ratio: f64) -> f64 {
    log_ratio.clamp(-LARGEST_LOG_RATIO, LARGEST_LOG_RATIO)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::builtin;

    #[test]
    fn both_sides_share_a_size() {
        let body = Arc::new(builtin::full_body());
        let sizes = Sizes::new(body.clone(), SizeChoice::default());
        // 30 limbs: 4 in the middle, 13 pairs.
        assert_eq!(sizes.count(), 2 * (4 + 13));
        let names: Vec<&str> = sizes.parameters[..6].iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["spine", "chest", "neck", "skull", "hip", "flank"]);
        let mut theta = vec![0.0; sizes.count()];
        let right = body.limb_index("right forearm").unwrap();
        theta[sizes.column(right, SizeKind::Length).unwrap()] = 0.1;
        let longer = sizes.model(&theta, 0.0).unwrap();
        for (before, after) in body.limbs().iter().zip(longer.limbs()) {
            let expected = if before.name.ends_with("forearm") { 0.1_f64.exp() } else { 1.0 };
            assert!((after.length / before.length - expected).abs() < 1e-12, "{}", before.name);
            assert!((after.radius - before.radius).abs() < 1e-12, "{}", before.name);
        }
        let each = SizeChoice { symmetric: false, radii: false, lengths: true };
        assert_eq!(Sizes::new(body, each).count(), 30);
    }

    #[test]
    fn sizes_that_are_held_follow_the_others() {
        let body = Arc::new(builtin::upper_body());
        let choice = SizeChoice { radii: false, ..SizeChoice::default() };
        let sizes = Sizes::new(body.clone(), choice);
        let scaled = sizes.model(&vec![0.2; sizes.count()], 0.2).unwrap();
        for (before, after) in body.limbs().iter().zip(scaled.limbs()) {
            let ratio = 0.2_f64.exp();
            assert!((after.radius / before.radius - ratio).abs() < 1e-12);
            assert!((after.length / before.length - ratio).abs() < 1e-12);
        }
        assert!(sizes.model(&vec![f64::NAN; sizes.count()], 0.0).is_err());
    }
}
