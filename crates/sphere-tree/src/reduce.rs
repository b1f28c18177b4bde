//! From many spheres to few: merge, burst, share out again.
//!
//! After Bradshaw and O'Sullivan 2004. *Merge* puts one sphere in the place of two neighbours, those first whose common sphere
//! stands out least. *Burst* takes a sphere away and gives what it covered to its neighbours. Then pieces are shared out again and
//! spheres moved, in turns (as Wang et al. 2006, "Variational sphere set approximation for solid objects"), and where a sphere
//! stands out far and another is hardly needed, the first is split and the other burst.

use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeSet, BinaryHeap};

use rayon::prelude::*;

use crate::ball::{Ball, Effort};
use crate::groups::{GroupInput, SphereGroup, score};

/// Merging stops at this multiple of the wanted count; bursting does the rest.
const MERGE_TO: f64 = 1.1;

/// Rounds of sharing out again, splits and bursts among them.
const ROUNDS: usize = 10;

/// A burst pays if it leaves less than so much of the error of the sphere that is split for it.
const BURST_GAIN: f64 = 0.9;

/// Neighbours that are tried where surfaces do not touch.
const APART_NEIGHBOURS: usize = 8;

#[derive(Debug)]
struct MergePair {
    ball: Ball,
    pair: [usize; 2],
}

impl PartialEq for MergePair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for MergePair {}

impl PartialOrd for MergePair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for MergePair {
    fn cmp(&self, other: &Self) -> Ordering {
        self.ball.error().total_cmp(&other.ball.error()).then_with(|| self.pair.cmp(&other.pair))
    }
}

/// At most `count` groups (at least 1) that cover what `groups` cover.
pub(crate) fn reduce(input: GroupInput<'_>, groups: Vec<SphereGroup>, count: usize) -> Vec<SphereGroup> {
    let merged = merge(input, groups, ((count as f64 * MERGE_TO).ceil() as usize).max(count));
    let burst = burst(input, merged, count);
    let mut groups = settle(input, burst, count);
    // What is left is a component without neighbours to burst into; merging always ends.
    if groups.len() > count {
        groups = merge(input, groups, count);
    }
    groups
}

fn merge(input: GroupInput<'_>, groups: Vec<SphereGroup>, count: usize) -> Vec<SphereGroup> {
    let mut neighbours = input.neighbours(&groups);
    let mut left = groups.len();
    let mut groups: Vec<Option<SphereGroup>> = groups.into_iter().map(Some).collect();
    let candidate = |groups: &[Option<SphereGroup>], pair: [usize; 2]| {
        let [a, b] = pair.map(|index| groups[index].as_ref());
        Some(MergePair { ball: input.merged(a?, b?), pair })
    };
    let pairs: Vec<[usize; 2]> = neighbours
        .iter()
        .enumerate()
        .flat_map(|(a, all)| all.iter().filter(move |&&b| b > a).map(move |&b| [a, b]))
        .collect();
    let first: Vec<_> = pairs.par_iter().filter_map(|&pair| candidate(&groups, pair)).collect();
    let mut heap: BinaryHeap<Reverse<MergePair>> = first.into_iter().map(Reverse).collect();
    while left > count {
        let Some(Reverse(MergePair { ball, pair: [a, b] })) = heap.pop() else {
            let pairs = separate_pairs(&groups);
            let found: Vec<_> = pairs.par_iter().filter_map(|&pair| candidate(&groups, pair)).collect();
            heap.extend(found.into_iter().map(Reverse));
            continue;
        };
        if groups[a].is_none() || groups[b].is_none() {
            continue;
        }
        let (Some(one), Some(other)) = (groups[a].take(), groups[b].take()) else { continue };
        let new = groups.len();
        groups.push(Some(SphereGroup { ball, pieces: [one.pieces, other.pieces].concat() }));
        left -= 1;
        let mut around: BTreeSet<usize> = &neighbours[a] | &neighbours[b];
        around.retain(|&index| index != a && index != b && groups[index].is_some());
        around.iter().for_each(|&index| {
            neighbours[index].insert(new);
        });
        let around_list: Vec<usize> = around.iter().copied().collect();
        neighbours.push(around);
        let found: Vec<_> =
            around_list.par_iter().filter_map(|&index| candidate(&groups, [index, new])).collect();
        heap.extend(found.into_iter().map(Reverse));
    }
    groups.into_iter().flatten().collect()
}

/// Pairs of groups whose surfaces do not touch: each with those nearest to it.
fn separate_pairs(groups: &[Option<SphereGroup>]) -> Vec<[usize; 2]> {
    let all: Vec<(usize, Ball)> =
        groups.iter().enumerate().filter_map(|(index, group)| Some((index, group.as_ref()?.ball))).collect();
    let mut pairs = BTreeSet::new();
    for (a, ball) in &all {
        let mut others: Vec<(f64, usize)> = all
            .iter()
            .filter(|(b, _)| b != a)
            .map(|(b, other)| (ball.centre.distance(other.centre) - other.radius, *b))
            .collect();
        others.sort_by(|x, y| x.0.total_cmp(&y.0).then_with(|| x.1.cmp(&y.1)));
        pairs.extend(others.into_iter().take(APART_NEIGHBOURS).map(|(_, b)| [*a.min(&b), *a.max(&b)]));
    }
    pairs.into_iter().collect()
}

/// The greatest error that results where each group is burst, and who takes its pieces.
fn burst_costs(input: GroupInput<'_>, groups: &[SphereGroup]) -> Vec<(f64, Vec<usize>)> {
    let neighbours = input.neighbours(groups);
    let cost = |(group, around): (&SphereGroup, &BTreeSet<usize>)| {
        let indices: Vec<usize> = around.iter().copied().collect();
        let balls: Vec<&Ball> = indices.iter().map(|&index| &groups[index].ball).collect();
        input.burst(group, &balls).map_or((f64::INFINITY, Vec::new()), |(error, takers)| {
            (error, takers.into_iter().map(|taker| indices[taker]).collect())
        })
    };
    groups.par_iter().zip(&neighbours).map(cost).collect()
}

/// Bursts groups that are needed least and do not touch, until `count` are left or none can be burst.
fn burst(input: GroupInput<'_>, mut groups: Vec<SphereGroup>, count: usize) -> Vec<SphereGroup> {
    while groups.len() > count {
        let costs = burst_costs(input, &groups);
        let chosen = independent_groups(&costs, groups.len() - count, f64::INFINITY);
        if chosen.is_empty() {
            return groups;
        }
        groups = without(input, groups, &costs, &chosen);
    }
    groups
}

/// Groups to burst, the cheapest first, none of which gives to or takes from another.
fn independent_groups(costs: &[(f64, Vec<usize>)], most: usize, below: f64) -> BTreeSet<usize> {
    let mut order: Vec<usize> = (0..costs.len()).filter(|&index| costs[index].0 < below).collect();
    order.sort_by(|&a, &b| costs[a].0.total_cmp(&costs[b].0).then_with(|| a.cmp(&b)));
    let (mut chosen, mut is_used) = (BTreeSet::new(), vec![false; costs.len()]);
    for index in order {
        if chosen.len() == most {
            break;
        }
        if !is_used[index] && costs[index].1.iter().all(|&taker| !is_used[taker]) {
            is_used[index] = true;
            costs[index].1.iter().for_each(|&taker| is_used[taker] = true);
            chosen.insert(index);
        }
    }
    chosen
}

/// The groups without those that are burst, whose pieces go where `costs` says.
fn without(
    input: GroupInput<'_>,
    mut groups: Vec<SphereGroup>,
    costs: &[(f64, Vec<usize>)],
    burst: &BTreeSet<usize>,
) -> Vec<SphereGroup> {
    let mut grown = BTreeSet::new();
    for &index in burst {
        let pieces = std::mem::take(&mut groups[index].pieces);
        for (piece, &taker) in pieces.into_iter().zip(&costs[index].1) {
            groups[taker].pieces.push(piece);
            grown.insert(taker);
        }
    }
    let refit = |(index, group): (usize, SphereGroup)| {
        if !grown.contains(&index) {
            return group;
        }
        let SphereGroup { ball, pieces } = group;
        input.fit(pieces, &[ball.centre], Effort::Full)
    };
    let left: Vec<(usize, SphereGroup)> =
        groups.into_iter().enumerate().filter(|(_, group)| !group.pieces.is_empty()).collect();
    left.into_par_iter().map(refit).collect()
}

/// Pieces shared out again and spheres moved; the best that was found.
fn settle(input: GroupInput<'_>, groups: Vec<SphereGroup>, count: usize) -> Vec<SphereGroup> {
    let mut best = groups.clone();
    let mut groups = groups;
    for round in 0..ROUNDS {
        groups = input.share_again(&groups);
        if groups.len() <= count && score(&groups) < score(&best) {
            best.clone_from(&groups);
        }
        if round % 2 == 1 && round + 2 < ROUNDS {
            groups = exchange(input, groups, count);
        }
    }
    best
}

/// Splits the groups that stand out most, for others that are hardly needed.
fn exchange(input: GroupInput<'_>, mut groups: Vec<SphereGroup>, count: usize) -> Vec<SphereGroup> {
    let mut order: Vec<usize> = (0..groups.len()).collect();
    order.sort_by(|&a, &b| groups[b].ball.error().total_cmp(&groups[a].ball.error()).then_with(|| a.cmp(&b)));
    let costs = burst_costs(input, &groups);
    let worst = groups[order[0]].ball.error();
    let most = (groups.len() / 10).max(1);
    let mut cheap: Vec<usize> = independent_groups(&costs, most, BURST_GAIN * worst).into_iter().collect();
    cheap.sort_by(|&a, &b| costs[a].0.total_cmp(&costs[b].0).then_with(|| a.cmp(&b)));
    let (mut burst, mut split) = (BTreeSet::new(), BTreeSet::new());
    let mut free = count - groups.len().min(count);
    let mut next = cheap.into_iter();
    for &index in &order {
        if burst.contains(&index) || groups[index].pieces.len() < 2 {
            continue;
        }
        if free > 0 {
            free -= 1;
        } else {
            let Some(victim) = next.next() else { break };
            let is_worth_it = costs[victim].0 < BURST_GAIN * groups[index].ball.error();
            if !is_worth_it || victim == index || split.contains(&victim) {
                break;
            }
            burst.insert(victim);
        }
        split.insert(index);
    }
    let parts: Vec<SphereGroup> = split
        .iter()
        .filter_map(|&index| {
            let [kept, added] = input.split(&groups[index])?;
            groups[index] = kept;
            Some(added)
        })
        .collect();
    // Who takes is still there; where it was split, one half of it takes more than it must, until pieces are shared out again.
    let mut groups = without(input, groups, &costs, &burst);
    groups.extend(parts);
    groups
}
