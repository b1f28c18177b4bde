//! How far a body's proportions are from those of the body that the fit began with.
//!
//! With θ = log(size / start's size), one size g of the whole body and one girth b that all radii share, both unknown:
//!
//! | residual | standard deviation of |
//! |---|---|
//! | g − θ of a length | a length's share of the stature; less for a limb between two others |
//! | g + b − θ of a radius | a radius beside its length and the body's girth |
//! | θ of the next radius − θ of a radius | a limb in the middle of a rigid part beside the one that grows from it: a rib and its side |
//! | −b | girth: slim to broad |
//! | −g | size: child to tall adult |
//!
//! Every residual is divided by its standard deviation. Lengths of arm and leg bones of adults spread by about 4 %
//! about their share of the stature (C. C. Gordon et al., ANSUR II, 2014). Heads, whose share of the stature halves
//! between childhood and old age, and the sides and tips of a body of capsules, which no tape measures, spread by more:
//! silhouettes show them well, so that a wide prior costs nothing.

use serde::{Deserialize, Serialize};

use crate::body::{Model, SizeKind, Sizes};
use crate::optimize::NormalEquations;

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
}

impl Default for Proportions {
    fn default() -> Self {
        Self { size: 0.3, girth: 0.15, length: 0.15, middle_length: 0.04, radius: 0.2, neighbour: 0.1 }
    }
}

impl Proportions {
    /// The standard deviation of a parameter's log-ratio about the body's.
    #[must_use]
    pub fn of(&self, sizes: &Sizes, parameter: usize) -> f64 {
        let parameter = &sizes.parameters()[parameter];
        match parameter.kind {
            SizeKind::Radius => self.radius,
            SizeKind::Length if is_between(sizes.start(), parameter.limbs[0]) => self.middle_length,
            SizeKind::Length => self.length,
        }
    }

    /// Whether all are finite and above zero.
    #[must_use]
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

/// A body's unknown sizes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BodySizes {
    /// θ, one a parameter.
    pub log_ratios: Vec<f64>,
    /// g.
    pub size: f64,
    /// b.
    pub girth: f64,
}

impl BodySizes {
    /// A body scaled as a whole by exp(`size`).
    #[must_use]
    pub(crate) fn scaled(sizes: &Sizes, size: f64) -> Self {
        Self { log_ratios: vec![size; sizes.count()], size, girth: 0.0 }
    }
}

/// Adds the prior. The columns of θ stand from `first` on, g and b after them. `weight` is in squared grey levels;
/// `slack` multiplies the standard deviations of proportions, not those of size and girth.
pub(crate) fn add(
    equations: &mut NormalEquations,
    sizes: &Sizes,
    body: &BodySizes,
    proportions: &Proportions,
    slack: f64,
    weight: f64,
    first: usize,
) {
    let (size_column, girth_column) = (first + sizes.count(), first + sizes.count() + 1);
    for (index, parameter) in sizes.parameters().iter().enumerate() {
        let deviation = slack * proportions.of(sizes, index);
        let theta = body.log_ratios[index];
        let weight = weight / (deviation * deviation);
        // The prediction is θ − g − b, the datum 0.
        match parameter.kind {
            SizeKind::Length => {
                let row = [(first + index, 1.0), (size_column, -1.0)];
                add_row(equations, &row, body.size - theta, weight);
            }
            SizeKind::Radius => {
                let row = [(first + index, 1.0), (size_column, -1.0), (girth_column, -1.0)];
                add_row(equations, &row, body.size + body.girth - theta, weight);
            }
        }
    }
    for (radius, next) in neighbours(sizes) {
        let deviation = slack * proportions.neighbour;
        let residual = body.log_ratios[next] - body.log_ratios[radius];
        let row = [(first + radius, 1.0), (first + next, -1.0)];
        add_row(equations, &row, residual, weight / (deviation * deviation));
    }
    let weigh = |deviation: f64| weight / (deviation * deviation);
    add_row(equations, &[(size_column, 1.0)], -body.size, weigh(proportions.size));
    add_row(equations, &[(girth_column, 1.0)], -body.girth, weigh(proportions.girth));
}

/// Pairs of radii: of a limb that links two others of its own rigid part, and of the one that grows from it.
fn neighbours(sizes: &Sizes) -> impl Iterator<Item = (usize, usize)> {
    let (model, parameters) = (sizes.start(), sizes.parameters());
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

fn add_row(equations: &mut NormalEquations, row: &[(usize, f64)], residual: f64, weight: f64) {
    equations.cost += weight * residual * residual;
    for &(i, a) in row {
        equations.jtr[i] += weight * a * residual;
        for &(j, b) in row {
            equations.jtj[(i, j)] += weight * a * b;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::body::{SizeChoice, builtin};

    #[test]
    fn a_body_scaled_as_a_whole_costs_only_its_size() {
        let sizes = Sizes::new(Arc::new(builtin::full_body()), SizeChoice::default());
        let proportions = Proportions::default();
        let mut equations = NormalEquations::zeros(sizes.count() + 2);
        let body = BodySizes::scaled(&sizes, 0.15);
        add(&mut equations, &sizes, &body, &proportions, 1.0, 2.0, 0);
        assert!((equations.cost - 2.0 * (0.15_f64 / proportions.size).powi(2)).abs() < 1e-9);
        // Its gradient is that of the cost.
        let mut bent = body.clone();
        bent.log_ratios.iter_mut().enumerate().for_each(|(i, theta)| *theta += 0.02 * (i as f64).sin());
        bent.girth = 0.07;
        let cost = |body: &BodySizes| {
            let mut equations = NormalEquations::zeros(sizes.count() + 2);
            add(&mut equations, &sizes, body, &proportions, 0.5, 2.0, 0);
            (equations.cost, equations.jtr)
        };
        let gradient = cost(&bent).1 * -2.0;
        let h = 1e-6;
        for column in 0..sizes.count() + 2 {
            let moved = |offset: f64| {
                let mut body = bent.clone();
                match column.checked_sub(sizes.count()) {
                    None => body.log_ratios[column] += offset,
                    Some(0) => body.size += offset,
                    Some(_) => body.girth += offset,
                }
                cost(&body).0
            };
            let numeric = (moved(h) - moved(-h)) / (2.0 * h);
            assert!((numeric - gradient[column]).abs() < 1e-4 * (1.0 + numeric.abs()), "column {column}");
        }
    }

    #[test]
    fn ribs_follow_the_sides_and_nothing_else_its_neighbour() {
        let sizes = Sizes::new(Arc::new(builtin::full_body()), SizeChoice::default());
        let name = |parameter: usize| {
            let name = &sizes.start().limbs()[sizes.parameters()[parameter].limbs[0]].name;
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
        let expected = [
            "neck",
            "right rib",
            "right clavicle",
            "right upper arm",
            "right forearm",
            "right thigh",
            "right lower thigh",
            "right calf",
            "right lower calf",
        ];
        assert_eq!(between, expected);
    }
}
