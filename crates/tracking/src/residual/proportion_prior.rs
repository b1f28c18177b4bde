//! How far a body's proportions are from people's.
//!
//! With θ = log(size / start's size), one size g of the whole body and one stoutness b that the radii share, both unknown,
//! μ what θ is of an average person of the start's stature:
//!
//! | residual | standard deviation of |
//! |---|---|
//! | g + μ − θ of a length | a length's share of the stature; less for a limb between two others |
//! | g + μ + λ b − θ of a radius | a radius beside its length and the body's stoutness |
//! | θ of the next radius − θ of a radius, less their μ | a limb in the middle of a rigid part beside the one that grows from it: a rib and its side |
//! | −b | stoutness: slim to broad |
//! | −g | size: child to tall adult |
//! | −w | a common widening of the silhouettes, where it is unknown |
//!
//! Every residual is divided by its standard deviation. For bodies that are built as the built-in full body μ, λ and the
//! deviations are those of real people where a survey has them ([`anthropometry`](crate::body::anthropometry)). For any
//! other body, and for what no survey has, the prior is the generic one of [`Proportions`]: μ = 0, λ = 1, and lengths of
//! arm and leg bones that spread by about 4 %. Heads, whose share of the stature halves
//! between childhood and old age, and the sides and tips of a body of capsules, which no tape measures, spread by more:
//! silhouettes show them well, so that a wide prior costs nothing.

use serde::{Deserialize, Serialize};

use crate::body::anthropometry::{Anthropometry, GirthSpread, STOUTNESS};
use crate::body::{Model, SizeKind, Sizes};
use crate::optimize::NormalEquations;
use crate::statistics::upper_median;

/// Standard deviations of log-ratios: 0.05 is 5 %.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Proportions {
    /// Of the whole body's size.
    pub size: f64,
    /// Of the girth that all radii share.
    pub girth: f64,
    /// Of a length: torso, head, hands and feet, whose ends silhouettes show.
    pub length: f64,
    /// Of the length of a limb between two others, whose ends silhouettes hardly show.
    pub middle_length: f64,
    /// Of a radius.
    pub radius: f64,
    /// Of the radius of a limb in the middle of a rigid part, which silhouettes hardly show, beside that of the next limb.
    pub neighbour: f64,
    /// Whether real people's proportions and girths take the place of these where a survey has them.
    pub surveyed: bool,
}

impl Default for Proportions {
    fn default() -> Self {
        Self {
            size: 0.3,
            girth: 0.15,
            length: 0.15,
            middle_length: 0.04,
            radius: 0.2,
            neighbour: 0.1,
            surveyed: true,
        }
    }
}

impl Proportions {
    /// The prior of a body's sizes.
    pub(crate) fn prior(&self, sizes: &Sizes) -> SizePrior {
        let model = &sizes.start;
        let people = self.surveyed.then(|| Anthropometry::of(model)).flatten();
        let generic_girth = GirthSpread { by_stoutness: 1.0, own: self.radius };
        let of = |parameter: &crate::body::SizeParameter| {
            let limb = parameter.limbs[0];
            let mean = people.as_ref().map_or(0.0, |people| people.log_ratio(model, limb, parameter.kind));
            match parameter.kind {
                SizeKind::Radius => {
                    let spread = people.as_ref().and_then(|people| people.radius(limb));
                    let GirthSpread { by_stoutness, own } = spread.unwrap_or(generic_girth);
                    SizeSpread { mean, by_stoutness, deviation: own }
                }
                SizeKind::Length => {
                    let surveyed = people.as_ref().and_then(|people| people.length(limb));
                    let generic = if is_between(model, limb) { self.middle_length } else { self.length };
                    SizeSpread { mean, by_stoutness: 0.0, deviation: surveyed.unwrap_or(generic) }
                }
            }
        };
        SizePrior {
            spreads: sizes.parameters.iter().map(of).collect(),
            neighbours: neighbours(sizes).collect(),
            neighbour: self.neighbour,
            size: self.size,
            stoutness: if people.is_some() { STOUTNESS } else { self.girth },
            is_surveyed: people.is_some(),
        }
    }

    /// Whether all are finite and above zero.
    pub fn is_valid(&self) -> bool {
        let all = [self.size, self.girth, self.length, self.middle_length, self.radius, self.neighbour];
        all.iter().all(|deviation| deviation.is_finite() && *deviation > 0.0)
    }
}

/// Whether a limb links one limb to one other.
fn is_between(model: &Model, limb: usize) -> bool {
    let children = model.limbs().iter().filter(|other| other.parent == Some(limb)).count();
    model.limbs()[limb].parent.is_some() && children == 1
}

/// How one size spreads, as a logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SizeSpread {
    /// μ.
    pub mean: f64,
    /// λ; 0 for lengths.
    pub by_stoutness: f64,
    /// Standard deviation beyond size and stoutness.
    pub deviation: f64,
}

/// How all sizes of a body spread.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SizePrior {
    /// One a parameter.
    pub spreads: Vec<SizeSpread>,
    neighbours: Vec<(usize, usize)>,
    neighbour: f64,
    /// Deviation of g.
    pub size: f64,
    /// Deviation of b.
    pub stoutness: f64,
    /// Whether it knows real people's girths.
    pub is_surveyed: bool,
}

/// A body's unknown sizes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodySizes {
    /// θ, one a parameter.
    pub log_ratios: Vec<f64>,
    /// g.
    pub size: f64,
    /// b.
    pub girth: f64,
    /// w, pixels: by how much silhouettes are too wide all round.
    pub widening_px: f64,
}

impl BodySizes {
    /// A body scaled as a whole by exp(`size`).
    pub(crate) fn scaled(sizes: &Sizes, size: f64) -> Self {
        Self { log_ratios: vec![size; sizes.count()], size, girth: 0.0, widening_px: 0.0 }
    }

    /// The sizes of another body of the same limbs: its size the median of lengths, its girth what radii are beside that.
    pub(crate) fn of(sizes: &Sizes, body: &Model) -> Self {
        let log_ratio = |index: usize| (sizes.metres(index, body) / sizes.metres(index, &sizes.start)).ln();
        let log_ratios: Vec<f64> = (0..sizes.count()).map(log_ratio).collect();
        let median = |kind: SizeKind| {
            let own =
                sizes.parameters.iter().zip(&log_ratios).filter(|(parameter, _)| parameter.kind == kind);
            let mut own: Vec<f64> = own.map(|(_, theta)| *theta).collect();
            upper_median(&mut own)
        };
        let size = median(SizeKind::Length).unwrap_or(0.0);
        let girth = median(SizeKind::Radius).map_or(0.0, |radius| radius - size);
        Self { log_ratios, size, girth, widening_px: 0.0 }
    }
}

/// Adds the prior. The columns of θ stand from `first` on, g and b after them, then w if it has a deviation, in pixels.
/// `weight` is in squared grey levels; `slack` multiplies the standard deviations of proportions, not those of the others.
pub(crate) fn add(
    equations: &mut NormalEquations,
    body: &BodySizes,
    prior: &SizePrior,
    widening_deviation_px: Option<f64>,
    slack: f64,
    weight: f64,
    first: usize,
) {
    let count = prior.spreads.len();
    let (size_column, girth_column) = (first + count, first + count + 1);
    let weigh = |deviation: f64| weight / (deviation * deviation);
    for (index, (spread, theta)) in prior.spreads.iter().zip(&body.log_ratios).enumerate() {
        // The prediction is θ − μ − g − λ b, the datum 0.
        let row = [(first + index, 1.0), (size_column, -1.0), (girth_column, -spread.by_stoutness)];
        let residual = spread.mean + body.size + spread.by_stoutness * body.girth - theta;
        equations.add_row(&row, residual, weigh(slack * spread.deviation));
    }
    for &(radius, next) in &prior.neighbours {
        let off = |index: usize| body.log_ratios[index] - prior.spreads[index].mean;
        let row = [(first + radius, 1.0), (first + next, -1.0)];
        equations.add_row(&row, off(next) - off(radius), weigh(slack * prior.neighbour));
    }
    equations.add_row(&[(size_column, 1.0)], -body.size, weigh(prior.size));
    equations.add_row(&[(girth_column, 1.0)], -body.girth, weigh(prior.stoutness));
    if let Some(deviation_px) = widening_deviation_px {
        equations.add_row(&[(girth_column + 1, 1.0)], -body.widening_px, weigh(deviation_px));
    }
}

/// Pairs of radii: of a limb that links two others of its own rigid part, and of the one that grows from it.
fn neighbours(sizes: &Sizes) -> impl Iterator<Item = (usize, usize)> {
    let (model, parameters) = (&sizes.start, &sizes.parameters);
    let (limbs, owners) = (model.limbs(), model.rotation_owners());
    let radius_of = move |limb: usize| {
        parameters.iter().position(|one| one.kind == SizeKind::Radius && one.limbs.contains(&limb))
    };
    parameters.iter().enumerate().filter_map(move |(radius, parameter)| {
        let limb = parameter.limbs[0];
        let rotation = limbs[limb].rotation;
        let is_inner = is_between(model, limb) && owners[rotation] != limb;
        let next = limbs.iter().position(|other| other.parent == Some(limb) && other.rotation == rotation)?;
        let next = radius_of(next).filter(|&next| next != radius)?;
        (parameter.kind == SizeKind::Radius && is_inner).then_some((radius, next))
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::body::{SizeChoice, builtin};

    #[test]
    fn a_body_scaled_as_a_whole_costs_only_its_size() {
        for surveyed in [false, true] {
            let sizes = Sizes::new(Arc::new(builtin::full_body()), SizeChoice::default());
            let prior = Proportions { surveyed, ..Proportions::default() }.prior(&sizes);
            let mut equations = NormalEquations::zeros(sizes.count() + 2);
            let body = BodySizes::scaled(&sizes, 0.15);
            add(&mut equations, &body, &prior, None, 1.0, 2.0, 0);
            assert!((equations.cost - 2.0 * (0.15_f64 / prior.size).powi(2)).abs() < 1e-9);
            the_gradient_is_that_of_the_cost(&sizes, &prior, &body);
        }
    }

    fn the_gradient_is_that_of_the_cost(sizes: &Sizes, prior: &SizePrior, body: &BodySizes) {
        let mut bent = body.clone();
        bent.log_ratios.iter_mut().enumerate().for_each(|(i, theta)| *theta += 0.02 * (i as f64).sin());
        (bent.girth, bent.widening_px) = (0.07, 0.6);
        let columns = sizes.count() + 3;
        let cost = |body: &BodySizes| {
            let mut equations = NormalEquations::zeros(columns);
            add(&mut equations, body, prior, Some(1.3), 0.5, 2.0, 0);
            (equations.cost, equations.jtr)
        };
        let gradient = cost(&bent).1 * -2.0;
        let h = 1e-6;
        for column in 0..columns {
            let moved = |offset: f64| {
                let mut body = bent.clone();
                match column.checked_sub(sizes.count()) {
                    None => body.log_ratios[column] += offset,
                    Some(0) => body.size += offset,
                    Some(1) => body.girth += offset,
                    Some(_) => body.widening_px += offset,
                }
                cost(&body).0
            };
            let numeric = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((numeric - gradient[column]).abs() < 1e-4 * (1.0 + numeric.abs()), "column {column}");
        }
    }

    /// A start with long arms is no reason to believe in long arms; a stout trunk comes with stout arms, not with a
    /// large head.
    #[test]
    fn people_are_the_average_whatever_the_start() {
        let adult = builtin::full_body();
        let arm = adult.limb_index("right forearm").unwrap();
        let long = adult.with_sizes(|limb| {
            let [length, radius] = [adult.limbs()[limb].length, adult.limbs()[limb].radius];
            [if adult.limbs()[limb].name.ends_with("forearm") { 1.3 * length } else { length }, radius]
        });
        let sizes = Sizes::new(Arc::new(long.unwrap()), SizeChoice::default());
        let surveyed = Proportions::default().prior(&sizes);
        let column = sizes.column(arm, SizeKind::Length).unwrap();
        assert!(surveyed.spreads[column].mean < -0.2, "{:?}", surveyed.spreads[column]);
        let generic = Proportions { surveyed: false, ..Proportions::default() }.prior(&sizes);
        assert_eq!((generic.spreads[column].mean, generic.stoutness), (0.0, Proportions::default().girth));
        let stoutness = |name: &str| {
            let limb = adult.limb_index(name).unwrap();
            surveyed.spreads[sizes.column(limb, SizeKind::Radius).unwrap()].by_stoutness
        };
        assert!(stoutness("spine") > 1.0 && stoutness("left upper arm") > 1.0);
        assert_eq!(stoutness("skull"), 0.0);
    }

    #[test]
    fn ribs_follow_the_sides_and_nothing_else_its_neighbour() {
        let sizes = Sizes::new(Arc::new(builtin::full_body()), SizeChoice::default());
        let name = |parameter: usize| {
            let name = &sizes.start.limbs()[sizes.parameters[parameter].limbs[0]].name;
            name.rsplit(' ').next().unwrap().to_owned()
        };
        let pairs: Vec<_> = neighbours(&sizes).map(|(a, b)| (name(a), name(b))).collect();
        assert_eq!(pairs, [("rib".to_owned(), "side".to_owned())]);
    }

    #[test]
    fn limbs_between_two_others_are_held_tighter() {
        let body = Arc::new(builtin::full_body());
        let between: Vec<&str> = (0..body.limbs().len())
            .filter(|&limb| is_between(&body, limb))
            .map(|limb| body.limbs()[limb].name.as_str())
            .filter(|name| !name.starts_with("left "))
            .collect();
        let expected = "neck, right rib, right clavicle, right upper arm, right forearm, right thigh, right lower thigh, \
                        right calf, right lower calf";
        assert_eq!(between.join(", "), expected);
    }
}
