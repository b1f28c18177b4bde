//! Pieces of the surface shared out among spheres: each sphere has its pieces and reaches all of them.

use std::collections::BTreeSet;

use glam::DVec3;
use rayon::prelude::*;

use crate::ball::{self, Ball, Effort};
use crate::pieces::Pieces;
use crate::surface::MeshSurface;

/// A sphere and the pieces that it has to cover; there is at least one.
#[derive(Debug, Clone)]
pub(crate) struct SphereGroup {
    pub(crate) ball: Ball,
    pub(crate) pieces: Vec<u32>,
}

/// What groups are made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GroupInput<'a> {
    pub(crate) surface: &'a MeshSurface<'a>,
    pub(crate) pieces: &'a Pieces<'a>,
}

impl GroupInput<'_> {
    fn places(&self, pieces: &[u32]) -> Vec<DVec3> {
        let points = self.pieces.points_of(pieces);
        points.into_iter().map(|point| self.pieces.points[point as usize]).collect()
    }

    /// The best sphere for some pieces, from one of `starts`.
    pub(crate) fn fit(&self, pieces: Vec<u32>, starts: &[DVec3], effort: Effort) -> SphereGroup {
        let ball = ball::fit(self.surface, &self.places(&pieces), starts, effort);
        SphereGroup { ball, pieces }
    }

    /// What a sphere would stand out if it had to cover a piece more.
    fn error_with(&self, ball: &Ball, piece: u32) -> f64 {
        self.pieces.reach(piece, ball.centre) + ball.signed
    }

    /// A sphere in the place of two, good enough to compare.
    pub(crate) fn merged(&self, a: &SphereGroup, b: &SphereGroup) -> Ball {
        let share = a.ball.radius / (a.ball.radius + b.ball.radius);
        let starts = [b.ball.centre.lerp(a.ball.centre, share), a.ball.centre, b.ball.centre];
        let places = self.places(&[&a.pieces[..], &b.pieces].concat());
        ball::fit(self.surface, &places, &starts, Effort::Quick)
    }

    /// The pieces of a sphere given to those of `others` that then stand out least, and the greatest error that results.
    pub(crate) fn burst(&self, group: &SphereGroup, others: &[&Ball]) -> Option<(f64, Vec<usize>)> {
        let mut greatest = 0.0_f64;
        let mut takers = Vec::with_capacity(group.pieces.len());
        for &piece in &group.pieces {
            let errors = others.iter().map(|ball| self.error_with(ball, piece)).enumerate();
            let (taker, error) = errors.min_by(|a, b| a.1.total_cmp(&b.1))?;
            // Who covers it anyway stands out no more.
            greatest = greatest.max(error.max(others[taker].error()));
            takers.push(taker);
        }
        Some((greatest, takers))
    }

    /// Every piece goes to the sphere that stands out least if it covers it, and the spheres move to where they stand out least for
    /// what they have then. No sphere's error becomes greater than the greatest was. Spheres without pieces are gone.
    pub(crate) fn share_again(&self, groups: &[SphereGroup]) -> Vec<SphereGroup> {
        let owners: Vec<u32> = (0..self.pieces.corners.len() as u32)
            .into_par_iter()
            .map(|piece| {
                let mut best = (f64::INFINITY, 0);
                for (index, group) in groups.iter().enumerate() {
                    if self.pieces.least_reach(piece, group.ball.centre) + group.ball.signed < best.0 {
                        let error = self.error_with(&group.ball, piece);
                        if error < best.0 {
                            best = (error, index as u32);
                        }
                    }
                }
                best.1
            })
            .collect();
        let mut owned = vec![Vec::new(); groups.len()];
        for (piece, &owner) in owners.iter().enumerate() {
            owned[owner as usize].push(piece as u32);
        }
        let all = groups.par_iter().zip(owned).filter(|(_, owned)| !owned.is_empty());
        all.map(|(group, owned)| self.fit(owned, &[group.ball.centre], Effort::Full)).collect()
    }

    /// The pieces of a group in two groups, apart along where they are longest.
    pub(crate) fn split(&self, group: &SphereGroup) -> Option<[SphereGroup; 2]> {
        if group.pieces.len() < 2 {
            return None;
        }
        let middle = |piece: u32| self.pieces.bounds[piece as usize].0;
        let farthest = |from: DVec3| {
            let squared = |piece: &&u32| middle(**piece).distance_squared(from);
            let found = group.pieces.iter().max_by(|a, b| squared(a).total_cmp(&squared(b)));
            found.map_or(from, |&piece| middle(piece))
        };
        let one = farthest(group.ball.centre);
        let other = farthest(one);
        let is_first =
            |piece: &u32| middle(*piece).distance_squared(one) <= middle(*piece).distance_squared(other);
        let (first, second): (Vec<u32>, Vec<u32>) = group.pieces.iter().partition(|piece| is_first(piece));
        if first.is_empty() || second.is_empty() {
            return None;
        }
        let starts = |end: DVec3| {
            [group.ball.centre, group.ball.centre.lerp(end, 0.5), group.ball.centre.lerp(end, 0.8)]
        };
        Some([self.fit(first, &starts(one), Effort::Full), self.fit(second, &starts(other), Effort::Full)])
    }

    /// For each group those that have pieces with common corners, ascending.
    pub(crate) fn neighbours(&self, groups: &[SphereGroup]) -> Vec<BTreeSet<usize>> {
        let mut users: Vec<Vec<u32>> = vec![Vec::new(); self.pieces.points.len()];
        for (index, group) in groups.iter().enumerate() {
            for point in self.pieces.points_of(&group.pieces) {
                users[point as usize].push(index as u32);
            }
        }
        let mut found = vec![BTreeSet::new(); groups.len()];
        for users in users {
            for &a in &users {
                found[a as usize].extend(users.iter().filter(|&&b| b != a).map(|&b| b as usize));
            }
        }
        found
    }
}

/// How good spheres are, less is better: between the mean of their errors over the pieces and the greatest of them.
pub(crate) fn score(groups: &[SphereGroup]) -> f64 {
    let count: usize = groups.iter().map(|group| group.pieces.len()).sum();
    let sum: f64 =
        groups.iter().map(|group| group.pieces.len() as f64 * group.ball.error().max(0.0).powi(4)).sum();
    (sum / count as f64).sqrt().sqrt()
}
