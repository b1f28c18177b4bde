//! All solids of a view, and the tiles that they may touch: what the bands of a picture share.
//!
//! The tiles of a tile row that need not be looked at, because some solid darkens them altogether.

use std::ops::Range;

use pulp::Simd;

use super::grid::PixelGrid;
use super::outline::{Lattice, SpansMut};
use super::solid::{LaneSolid, Outline};
use crate::render::View;

/// A part of a solid, which competes for pixels by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SolidPart {
    /// The axis between the joints, without its ends.
    Axis,
    /// A ball about the first joint or the second.
    Ball(usize),
    /// All of it.
    Whole,
}

impl Outline {
    /// The parts, each by its place among the solid's spans.
    #[inline(always)]
    pub(super) fn parts(&self) -> &'static [SolidPart] {
        match self {
            Self::Ball(_) => &[SolidPart::Ball(0)],
            Self::Parts { .. } => &[SolidPart::Axis, SolidPart::Ball(0), SolidPart::Ball(1)],
            Self::Whole(_) => &[SolidPart::Whole],
        }
    }
}

/// A view made ready for lanes.
#[derive(Debug, Clone, Default)]
pub(super) struct Ground {
    lattice: Lattice,
    /// Places of the columns of a tile row and of the rows of all tile rows on the plane z = 1, a vector a tile and a
    /// vector a tile row.
    pub xs: Vec<f32>,
    pub ys: Vec<f32>,
    pub solids: Vec<LaneSolid>,
    /// The tiles of every solid's parts on each of its tile rows, one part after the other: the first, and one past the
    /// last.
    spans: [Vec<u32>; 2],
    /// Scratch: the tiles that a solid darkens altogether.
    cores: [Vec<u32>; 2],
    /// By tile row, the tiles that any solid may touch.
    pub touched: Vec<[u32; 2]>,
    /// By tile row. Only where [`cut_spans`](Self::cut_spans) looks for them.
    pub dark: Vec<DarkTiles>,
}

impl Ground {
    /// Takes a view's solids. Spans are still to be cut.
    pub(super) fn prepare(&mut self, view: &View, grid: &PixelGrid) {
        let pinhole = &view.pinhole;
        let lattice = Lattice::new(pinhole, grid);
        let tile = grid.tile;
        let (columns, rows) = (grid.entries(), grid.tile_rows() * tile.lanes());
        if self.lattice != lattice || self.xs.len() != columns || self.ys.len() != rows {
            self.lattice = lattice;
            let place =
                |axis: usize, index: usize| (lattice.start[axis] + index as f64 * lattice.step[axis]) as f32;
            let lane = |entry: usize| (entry / tile.lanes(), entry % tile.lanes());
            self.xs.clear();
            self.xs.extend((0..columns).map(|entry| {
                let (index, lane) = lane(entry);
                place(0, index * tile.columns + lane % tile.columns)
            }));
            self.ys.clear();
            self.ys.extend((0..rows).map(|entry| {
                let (index, lane) = lane(entry);
                place(1, index * tile.rows + lane / tile.columns)
            }));
        }
        self.solids.clear();
        let mut spans = 0;
        for (index, primitive) in view.primitives.iter().enumerate() {
            let Some(mut solid) = LaneSolid::new(primitive, pinhole, grid, &lattice) else { continue };
            solid.primitive = index;
            solid.spans = spans;
            spans += padded(solid.tile_rows) * solid.outline.parts().len();
            self.solids.push(solid);
        }
        for side in &mut self.spans {
            side.resize(spans, 0);
        }
    }

    /// The tiles that each part of each solid, and any of them, may touch on each tile row; with `DARK`, also those
    /// that need not be looked at because they are all dark.
    #[inline(always)]
    pub(super) fn cut_spans<S: Simd, const DARK: bool>(&mut self, simd: S, tile_rows: usize) {
        let Self { lattice, solids, spans, cores, touched, dark, .. } = self;
        touched.clear();
        touched.resize(tile_rows, [u32::MAX, 0]);
        dark.clear();
        dark.resize(tile_rows, DarkTiles::NONE);
        for solid in solids {
            let [first, last] = solid.tile_rows;
            let count = padded(solid.tile_rows);
            let all = solid.spans..solid.spans + count * solid.outline.parts().len();
            let [from, to] = &mut *spans;
            let mut parts = from[all.clone()].chunks_exact_mut(count).zip(to[all].chunks_exact_mut(count));
            let mut next = || parts.next().map_or_else(SpansMut::default, |(from, to)| [from, to]);
            match &solid.outline {
                Outline::Ball(ball) => ball.touched(simd, lattice, first, next()),
                Outline::Whole(bounds) => bounds.tiles(simd, lattice, first, next()),
                Outline::Parts { axis, core, balls: [start, end] } => {
                    axis.tiles(simd, lattice, first, next());
                    start.touched(simd, lattice, first, next());
                    end.touched(simd, lattice, first, next());
                    if let (true, Some(core)) = (DARK, core) {
                        let [from, to] = &mut *cores;
                        from.resize(count.max(from.len()), 0);
                        to.resize(count.max(to.len()), 0);
                        core.tiles(simd, lattice, first, [&mut from[..count], &mut to[..count]]);
                        for (dark, core) in dark[first..last].iter_mut().zip(from.iter().zip(to)) {
                            dark.add([*core.0, *core.1]);
                        }
                    }
                }
            }
            for part in 0..solid.outline.parts().len() {
                let start = solid.spans + part * count;
                let sides = [0, 1].map(|side| &spans[side][start..start + last - first]);
                for ((touched, &from), &to) in touched[first..last].iter_mut().zip(sides[0]).zip(sides[1]) {
                    touched[0] = touched[0].min(if from < to { from } else { u32::MAX });
                    touched[1] = touched[1].max(to);
                }
            }
        }
    }

    /// Of a band the rows of the picture that any solid may touch: the row, its columns, and its tile row in the band.
    pub(super) fn touched_rows(
        &self,
        band: &Range<usize>,
        grid: &PixelGrid,
    ) -> impl Iterator<Item = (usize, Range<usize>, usize)> {
        let side = grid.tile.rows;
        (band.start * side..(band.end * side).min(grid.rows)).filter_map(move |row| {
            let [from, to] = self.touched[row / side].map(|tile| tile as usize * grid.tile.columns);
            (from < to).then(|| (row, from..to.min(grid.columns), row / side - band.start))
        })
    }

    /// The tiles of a solid's part on those of its tile rows that are in a band, and the first of these.
    #[inline(always)]
    pub(super) fn spans(&self, solid: &LaneSolid, part: usize, band: &Range<usize>) -> (usize, [&[u32]; 2]) {
        let [first, last] = solid.tile_rows;
        let [from, to] = [band.start, band.end].map(|row| row.clamp(first, last));
        let start = solid.spans + part * padded(solid.tile_rows);
        (from, [0, 1].map(|side| &self.spans[side][start + from - first..start + to - first]))
    }
}

/// Most tile rows that are taken at once.
const MOST_LANES: usize = 16;

#[inline(always)]
fn padded([first, last]: [usize; 2]) -> usize {
    (last - first).next_multiple_of(MOST_LANES)
}

/// Runs that are known at the most; of more the longest stay.
const RUNS: usize = 4;
/// Pieces that they leave of a row, at the most.
pub(super) const MOST_PIECES: usize = RUNS + 1;
/// What is not a run: it begins behind all tiles.
const NO_RUN: [u32; 2] = [u32::MAX; 2];

/// Runs of dark tiles, the first and one past the last of each, from left to right and apart from each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DarkTiles([[u32; 2]; RUNS]);

impl DarkTiles {
    pub(super) const NONE: Self = Self([NO_RUN; RUNS]);

    /// From left to right.
    #[inline(always)]
    pub(super) fn runs(&self) -> impl Iterator<Item = [u32; 2]> {
        self.0.iter().copied().take_while(|run| run[0] < run[1])
    }

    /// Adds the tiles from one to before another, joined with the runs that they meet.
    #[inline(always)]
    pub(super) fn add(&mut self, [from, to]: [u32; 2]) {
        if from < to {
            self.add_some([from, to]);
        }
    }

    fn add_some(&mut self, mut added: [u32; 2]) {
        let mut apart = [NO_RUN; RUNS + 1];
        let mut count = 0;
        for run in self.runs() {
            if run[1] < added[0] || added[1] < run[0] {
                apart[count] = run;
                count += 1;
            } else {
                added = [added[0].min(run[0]), added[1].max(run[1])];
            }
        }
        let place = apart[..count].iter().take_while(|run| run[0] < added[0]).count();
        apart.copy_within(place..RUNS, place + 1);
        apart[place] = added;
        if count == RUNS {
            let shortest = (0..=RUNS).min_by_key(|&run| apart[run][1] - apart[run][0]).unwrap_or(RUNS);
            apart.copy_within(shortest + 1.., shortest);
        }
        self.0.copy_from_slice(&apart[..RUNS]);
    }
}

#[cfg(test)]
mod tests {
    use super::DarkTiles;

    fn runs_of(added: &[[u32; 2]]) -> Vec<[u32; 2]> {
        let mut dark = DarkTiles::NONE;
        added.iter().for_each(|&run| dark.add(run));
        dark.runs().collect()
    }

    #[test]
    fn runs_that_meet_are_one_and_all_are_in_order() {
        assert_eq!(runs_of(&[]), [] as [[u32; 2]; 0]);
        assert_eq!(runs_of(&[[7, 7], [9, 8]]), [] as [[u32; 2]; 0]);
        assert_eq!(runs_of(&[[20, 30], [1, 4], [10, 12]]), [[1, 4], [10, 12], [20, 30]]);
        assert_eq!(runs_of(&[[20, 30], [1, 4], [4, 20]]), [[1, 30]]);
        assert_eq!(runs_of(&[[1, 4], [6, 9], [3, 7], [12, 13]]), [[1, 9], [12, 13]]);
    }

    #[test]
    fn of_too_many_runs_the_shortest_is_forgotten() {
        let four = [[10, 20], [30, 33], [40, 50], [60, 70]];
        let with = |run: [u32; 2]| runs_of(&[four.as_slice(), &[run]].concat());
        assert_eq!(with([80, 90]), [[10, 20], [40, 50], [60, 70], [80, 90]]);
        assert_eq!(with([0, 8]), [[0, 8], [10, 20], [40, 50], [60, 70]]);
        assert_eq!(with([22, 24]), four);
        assert_eq!(with([33, 40]), [[10, 20], [30, 50], [60, 70]]);
    }

    /// Against a picture row of flags: what is said to be dark is dark, and all of it while there are few runs.
    #[test]
    fn dark_tiles_are_those_that_were_added() {
        let mut state = 7_u32;
        let mut next = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        for _ in 0..2000 {
            let (mut dark, mut flags, mut most) = (DarkTiles::NONE, [false; 64], 0);
            for _ in 0..6 {
                let from = next(60);
                let to = (from + next(12)).min(64);
                dark.add([from, to]);
                flags[from as usize..to as usize].fill(true);
                let runs = flags.chunk_by(|a, b| a == b).filter(|run| run[0]).count();
                most = most.max(runs);
            }
            let mut found = [false; 64];
            for run in dark.runs() {
                found[run[0] as usize..run[1] as usize].fill(true);
            }
            assert!(found.iter().zip(flags).all(|(&found, added)| added || !found));
            assert!(most > super::RUNS || found == flags, "{most} runs");
        }
    }
}
